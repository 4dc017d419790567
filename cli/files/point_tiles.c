/* brio convert --tiles: a file of points for each tile, and an index of them: a virtual point cloud, .vpc, which QGIS
 * and PDAL's programs read, or .pvtp, which ParaView does.
 *
 * Based on: PDAL. Virtual point cloud (VPC), https://github.com/PDAL/wrench/blob/main/vpc-spec.md, and the STAC
 * specification 1.0.0 with its extensions for point clouds and projections; VTK file formats. */
#include "cli/files/files.h"
#include "cli/files/new_file.h"
#include "cli/files/read_write.h"
#include "cli/run/interrupt.h"
#include "platform/file.h"
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char OF_VTK[] = ".pvtp", FILES_OF_VTK[] = "vtp", USUAL_FILES[] = "laz";

static bool ends_with(const char *path, const char *end) {
    size_t name = brio_folder_length(path), n = strlen(path), m = strlen(end);
    return n > name + m && !strcasecmp(path + n - m, end);
}

static bool is_of_vtk(const run *r) {
    return ends_with(r->common.output, OF_VTK);
}

brio_status cli_check_tile_count(run *r, uint64_t tiles) {
    enum { MOST_TILES = 1 << 16 };
    if (tiles > MOST_TILES)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--tiles: %" PRIu64 " are more than %d", tiles, MOST_TILES);
    if (!r->common.scratch) return cli_fail(r, BRIO_ERR_ARGUMENT, "--tiles needs --scratch DIR, where the tiles are");
    return BRIO_OK;
}

bool cli_is_point_index(const char *path) {
    return ends_with(path, OF_VTK) || ends_with(path, CLI_JSON_INDEX);
}

const char *cli_point_tile_format(const run *r) {
    if (r->common.format) return r->common.format[0] == '.' ? r->common.format + 1 : r->common.format;
    return is_of_vtk(r) ? FILES_OF_VTK : USUAL_FILES;
}

brio_status cli_check_point_tiles(run *r, uint64_t tiles) {
    const char *output = r->common.output;
    brio_format format;
    char extension[16];
    int from_standard_input = 0;
    if (!output) return cli_fail_output(r, "no output: -o FILE is missing");
    for (int i = 0; i < r->num_operands; i++) from_standard_input += !strcmp(r->operands[i], "-");
    if (from_standard_input > 1)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "-: standard input is named twice, and has its points once");
    if (!cli_is_point_index(output))
        return cli_fail_output(r,
                               "%s: --tiles writes an index, .vpc (of .laz files, or those of --format) or .pvtp (of "
                               ".vtp files), with a file for each tile in a folder beside it",
                               output);
    FORWARD(cli_check_tile_count(r, tiles));
    FORWARD(cli_output_format(r, output, cli_point_tile_format(r), &format));
    if (is_of_vtk(r) && format != brio_format_of(FILES_OF_VTK))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: an index of .vtp files; --format %s goes with .vpc", output,
                        r->common.format);
    snprintf(extension, sizeof extension, ".%s", cli_point_tile_format(r));
    return cli_new_folder_check(r, output, extension);
}

/* --- what is known of the tiles --- */

typedef struct {
    uint64_t points;
    double low[3], high[3];
} tile_facts;

/* The tiles, as they are written. */
typedef struct {
    run *r;
    tile_facts *tile;
    uint32_t files;
    brio_property *properties; /* of the points of each file: names and types */
    size_t num_properties;
    char date[32]; /* of a LAS file: year and day of the year; "" elsewhere */
} written;

static int keep_tile(const brio_convert_tile *t, void *user) {
    written *w = user;
    const brio_metadata *date = brio_mesh_metadata(t->kind, "las.date");
    snprintf(w->date, sizeof w->date, "%s", date ? date->bytes : "");
    tile_facts *tile = &w->tile[w->files++];
    tile->points = t->points;
    memcpy(tile->low, t->low, sizeof tile->low);
    memcpy(tile->high, t->high, sizeof tile->high);
    return cli_interrupted();
}

static int keep_properties(const brio_mesh *block, void *user) {
    written *w = user;
    w->properties = calloc(block->num_properties + 1, sizeof *w->properties);
    for (; w->properties && w->num_properties < block->num_properties; w->num_properties++)
        w->properties[w->num_properties] = block->properties[w->num_properties];
    return 1;
}

/* Finds the properties as the first file has them: a format lacks some, and has others by other names and types. */
static brio_status find_properties(written *w, const char *folder) {
    char path[BRIO_PATH_MOST + 32];
    snprintf(path, sizeof path, "%s/0.%s", folder, cli_point_tile_format(w->r));
    brio_status status = brio_read_blocks(w->r->ctx, path, NULL, keep_properties, w, NULL);
    if (w->properties) return BRIO_OK; /* BRIO_ERR_CANCELLED, as the first block is enough */
    return status == BRIO_OK || status == BRIO_ERR_CANCELLED ? cli_fail(w->r, BRIO_ERR_NO_MEMORY, "out of memory")
                                                             : status;
}

/* --- the virtual point cloud --- */

/* Returns PDAL's name of a field of LAS, by which readers know it; all other names stay. */
static const char *pdal_name(const char *name) {
    static const char *const names[][2] = {{"intensity", "Intensity"},
                                           {"return_number", "ReturnNumber"},
                                           {"number_of_returns", "NumberOfReturns"},
                                           {"scan_direction_flag", "ScanDirectionFlag"},
                                           {"edge_of_flight_line", "EdgeOfFlightLine"},
                                           {"classification", "Classification"},
                                           {"classification_flags", "ClassFlags"},
                                           {"synthetic", "Synthetic"},
                                           {"key_point", "KeyPoint"},
                                           {"withheld", "Withheld"},
                                           {"overlap", "Overlap"},
                                           {"scanner_channel", "ScanChannel"},
                                           {"scan_angle_rank", "ScanAngleRank"},
                                           {"scan_angle", "ScanAngleRank"},
                                           {"user_data", "UserData"},
                                           {"point_source_id", "PointSourceId"},
                                           {"gps_time", "GpsTime"},
                                           {"red", "Red"},
                                           {"green", "Green"},
                                           {"blue", "Blue"},
                                           {"nir", "Infrared"},
                                           {"nx", "NormalX"},
                                           {"ny", "NormalY"},
                                           {"nz", "NormalZ"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strcmp(name, names[i][0])) return names[i][1];
    return name;
}

static void write_schema(FILE *f, const char *name, int size, const char *type) {
    fprintf(f, "{\"name\": \"");
    cli_write_text_of_json(f, name);
    fprintf(f, "\", \"size\": %d, \"type\": \"%s\"}", size, type);
}

static void write_property(FILE *f, const brio_property *p) {
    static const struct {
        int size;
        const char *type;
    } types[] = {[BRIO_SCALAR_INT8] = {1, "signed"},      [BRIO_SCALAR_UINT8] = {1, "unsigned"},
                 [BRIO_SCALAR_INT16] = {2, "signed"},     [BRIO_SCALAR_UINT16] = {2, "unsigned"},
                 [BRIO_SCALAR_INT32] = {4, "signed"},     [BRIO_SCALAR_UINT32] = {4, "unsigned"},
                 [BRIO_SCALAR_FLOAT32] = {4, "floating"}, [BRIO_SCALAR_FLOAT64] = {8, "floating"}};
    fprintf(f, ", ");
    write_schema(f, pdal_name(p->name), types[p->type].size, types[p->type].type);
}

static void write_polygon(FILE *f, const tile_facts *t) {
    const double *a = t->low, *b = t->high;
    fprintf(f,
            "{\"type\": \"Polygon\", \"coordinates\": [[[%.17g, %.17g], [%.17g, %.17g], [%.17g, %.17g], [%.17g, "
            "%.17g], [%.17g, %.17g]]]}",
            a[0], a[1], b[0], a[1], b[0], b[1], a[0], b[1], a[0], a[1]);
}

static void write_box(FILE *f, const tile_facts *t) {
    fprintf(f, "[%.17g, %.17g, %.17g, %.17g, %.17g, %.17g]", t->low[0], t->low[1], t->low[2], t->high[0], t->high[1],
            t->high[2]);
}

/* Writes the day on which a LAS file says that it was made, as wrench does for the time of the points. */
static void write_day(FILE *f, const char *date) {
    static const int days[] = {31, 28, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31};
    int year = 0, day = 0, month = 0;
    bool known = sscanf(date, "%d-%d", &year, &day) == 2 && year > 0 && year < 10000 && day > 0;
    bool leap = (year % 4 == 0 && year % 100 != 0) || year % 400 == 0;
    for (; known && month < 12 && day > days[month] + (month == 1 && leap); month++)
        day -= days[month] + (month == 1 && leap);
    if (known && month < 12)
        fprintf(f, "\"%04d-%02d-%02dT00:00:00Z\"", year, month + 1, day);
    else
        fprintf(f, "null");
}

static void write_schemas(FILE *f, const written *w) {
    for (int k = 0; k < 3; k++) {
        if (k) fprintf(f, ", ");
        write_schema(f, (const char *[]){"X", "Y", "Z"}[k], 8, "floating");
    }
    for (size_t i = 0; i < w->num_properties; i++) write_property(f, &w->properties[i]);
}

/* Writes the feature of a tile. Its boxes are in the coordinates of the points, and no coordinate system is named: see
 * decision 039. */
static void write_feature(FILE *f, const written *w, const char *folder, uint32_t number) {
    const tile_facts *t = &w->tile[number];
    const char *format = cli_point_tile_format(w->r);
    fprintf(f,
            "{\"type\": \"Feature\", \"stac_version\": \"1.0.0\",\n\"stac_extensions\": "
            "[\"https://stac-extensions.github.io/pointcloud/v1.0.0/schema.json\", "
            "\"https://stac-extensions.github.io/projection/v1.1.0/schema.json\"],\n\"id\": \"%" PRIu32
            "\", \"geometry\": ",
            number);
    write_polygon(f, t);
    fprintf(f, ",\n\"bbox\": ");
    write_box(f, t);
    fprintf(f, ",\n\"properties\": {\"datetime\": ");
    write_day(f, w->date);
    fprintf(f, ", \"pc:count\": %" PRIu64 ", \"pc:type\": \"other\", \"pc:encoding\": \"%s\",\n\"pc:schemas\": [",
            t->points, format);
    write_schemas(f, w);
    fprintf(f, "],\n\"proj:wkt2\": \"\", \"proj:geometry\": ");
    write_polygon(f, t);
    fprintf(f, ",\n\"proj:bbox\": ");
    write_box(f, t);
    fprintf(f, "},\n\"links\": [],\n\"assets\": {\"data\": {\"href\": \"./");
    cli_write_text_of_json(f, folder + brio_folder_length(folder));
    fprintf(f, "/%" PRIu32 ".%s\", \"roles\": [\"data\"]}}}", number, format);
}

static void write_cloud(FILE *f, const written *w, const char *folder) {
    fprintf(f, CLI_JSON_HEAD);
    for (uint32_t i = 0; i < w->files; i++) {
        if (i) fprintf(f, ",\n");
        write_feature(f, w, folder, i);
    }
    fprintf(f, "\n]}\n");
}

/* --- the index of VTK --- */

/* Reads the next tag of a file of XML, without its brackets. Returns false behind the last one. */
static bool next_tag(FILE *f, char *tag, size_t size) {
    int c = getc(f);
    size_t n = 0;
    while (c != EOF && c != '<') c = getc(f);
    while ((c = getc(f)) != EOF && c != '>')
        if (n + 1 < size) tag[n++] = (char)c;
    tag[n] = 0;
    return c != EOF;
}

/* Copies what a file says of its arrays of points into an index. */
static bool copy_arrays(FILE *from, FILE *to) {
    char tag[1024];
    while (next_tag(from, tag, sizeof tag)) {
        const char *type = strstr(tag, "type="), *rest = strstr(tag, " format=");
        if (!strcmp(tag, "Points") || !strcmp(tag, "PointData")) fprintf(to, "<P%s>\n", tag);
        if (!strcmp(tag, "/Points") || !strcmp(tag, "/PointData")) fprintf(to, "</P%s>\n", tag + 1);
        if (!strncmp(tag, "DataArray ", 10) && type && rest && rest > type)
            fprintf(to, "<PDataArray %.*s/>\n", (int)(rest - type), type);
        if (!strcmp(tag, "/PointData")) return true;
    }
    return false;
}

static brio_status write_pieces(FILE *f, const written *w, const char *folder) {
    char path[BRIO_PATH_MOST + 32];
    snprintf(path, sizeof path, "%s/0.%s", folder, cli_point_tile_format(w->r));
    FILE *first = brio_open_stream(path, "rb");
    if (!first) return cli_fail(w->r, BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
    fprintf(f, "<?xml version=\"1.0\"?>\n<VTKFile type=\"PPolyData" CLI_XML_HEAD "PPolyData GhostLevel=\"0\">\n");
    bool copied = copy_arrays(first, f);
    fclose(first);
    if (!copied) return cli_fail(w->r, BRIO_ERR_WRITE, "%s: cannot read it again", path);
    for (uint32_t i = 0; i < w->files; i++) {
        fprintf(f, "<Piece Source=\"");
        cli_write_attribute(f, folder + brio_folder_length(folder));
        fprintf(f, "/%" PRIu32 ".%s\"/>\n", i, FILES_OF_VTK);
    }
    fprintf(f, "</PPolyData>\n</VTKFile>\n");
    return BRIO_OK;
}

/* --- the run --- */

static brio_status write_index(run *r, written *w, const new_folder *folder) {
    new_file f = {.target.folder = -1};
    brio_status status = BRIO_OK;
    TRY(cli_new_file_open(r, folder->index, &f));
    if (!is_of_vtk(r)) TRY(find_properties(w, folder->path));
    if (is_of_vtk(r))
        TRY(write_pieces(f.file, w, folder->path));
    else
        write_cloud(f.file, w, folder->path);
    status = cli_new_file_publish(r, folder->index, &f);
done:
    cli_new_file_close(&f);
    return status;
}

brio_status cli_point_tiles(run *r, uint64_t tiles, brio_convert_options *o, brio_convert_stats *stats) {
    char pattern[BRIO_PATH_MOST + 32], extension[16];
    new_folder folder = {.lock = -1};
    written w = {.r = r};
    brio_status status = BRIO_OK;
    w.tile = calloc(tiles, sizeof *w.tile);
    if (!w.tile) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory");
    snprintf(extension, sizeof extension, ".%s", cli_point_tile_format(r));
    TRY(cli_new_folder_open(r, r->common.output, extension, &folder));
    folder.most_files = (uint32_t)tiles;
    snprintf(pattern, sizeof pattern, "%s/#%s", folder.path, extension);
    o->tiles = (uint32_t)tiles;
    o->num_more = (uint32_t)r->num_operands - 1;
    o->more = (const char *const *)r->operands + 1;
    o->scratch = r->common.scratch;
    o->tile = keep_tile;
    o->tile_user = &w;
    if (!o->drop_outliers && !(o->thin > 0)) TRY(brio_context_set_scratch(r->ctx, NULL)); /* blocks are in memory */
    TRY(brio_convert(r->ctx, r->operands[0], pattern, o, stats));
    TRY(cli_check_interrupt(r));
    TRY(cli_new_folder_name(r, &folder));
    status = write_index(r, &w, &folder);
done:
    cli_new_folder_close(&folder, status == BRIO_OK);
    free(w.properties);
    free(w.tile);
    return status;
}
