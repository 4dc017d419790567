/* --tiles: points go to the library block by block, as they are read; a report, and a file for each tile. */
#include "cli/steps/tiles.h"
#include "cli/files/files.h"
#include "cli/files/lost.h"
#include "cli/files/new_file.h"
#include "cli/files/read_write.h"
#include "cli/run/interrupt.h"
#include "cli/steps/properties.h"
#include "platform/file.h"
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

static const char EXTENSION[] = ".pvtu", OF_TILES[] = ".vtu";

static bool ends_with(const char *text, const char *end) {
    size_t n = strlen(text), m = strlen(end);
    return n > m + brio_folder_length(text) && !strcasecmp(text + n - m, end);
}

brio_status cli_check_tiles(run *r, const weights_options *weights, uint64_t tiles) {
    FORWARD(cli_check_tile_count(r, tiles));
    if (weights->file)
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "--tiles: not with --weights FILE; the points can have a property weight or radius");
    return BRIO_OK;
}

/* Refuses an output that is no index, and options that its files have no place for.
 * extension  of the index: .pvtu has files .vtu. */
static brio_status check_index(run *r, const char *extension, const char *formats) {
    const common_options *c = &r->common;
    const char *output = c->output;
    char of_tiles[8];
    if (!output) return BRIO_OK;
    snprintf(of_tiles, sizeof of_tiles, ".%s", extension + 2);
    if (c->format && brio_format_of(c->format) != brio_format_of(of_tiles))
        return cli_fail_output(r, "--format %s: --tiles writes %s with a file for each tile beside it", c->format,
                               formats);
    if (!ends_with(output, extension))
        return cli_fail_output(r, "%s: --tiles writes %s with a file for each tile beside it", output, formats);
    if (c->float32)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: --float32: the files of tiles have double precision", output);
    return cli_new_folder_check(r, output, of_tiles);
}

brio_status cli_check_tile_files(run *r, const char *formats) {
    return check_index(r, EXTENSION, formats);
}

/* Returns the format of an output that is one file for all tiles; BRIO_FORMAT_AUTO: the output is none. */
static brio_format merged_format(const run *r) {
    const common_options *c = &r->common;
    brio_format format = c->output ? brio_format_of(c->format ? c->format : c->output) : BRIO_FORMAT_AUTO;
    const brio_format_info *info = brio_format_facts(format);
    return info && info->holds & BRIO_HOLDS_PARTS ? format : BRIO_FORMAT_AUTO;
}

bool cli_merges_tiles(const run *r) {
    return merged_format(r) != BRIO_FORMAT_AUTO;
}

brio_status cli_check_tile_output(run *r, const char *index) {
    const char *input = r->operands[0];
    brio_place_facts file;
    char formats[24];
    snprintf(formats, sizeof formats, ".ply, and %s", index);
    if (!cli_merges_tiles(r)) return check_index(r, index, formats);
    if (!strcmp(input, "-") || !brio_find_facts(input, &file) || file.kind != BRIO_IS_FILE)
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "%s: for one output of all tiles the input is read twice, so it must be a file; %s needs it "
                        "once",
                        strcmp(input, "-") ? input : "standard input", index);
    return strcmp(r->common.output, "-") ? cli_check_target(r, r->common.output) : BRIO_OK;
}

/* --- reading --- */

typedef struct {
    run *r;
    const weights_options *options;
    brio_tiles *tiles;
    uint64_t count;
    brio_status status;
} intake;

brio_status cli_block_weights(run *r, const weights_options *options, const brio_mesh *block, uint64_t first,
                              double **weights) {
    weights_options o = *options;
    o.first = first;
    o.quiet |= first > 0;
    return cli_weights(r, &o, block, weights);
}

static brio_status add_block(intake *in, const brio_mesh *block) {
    double *weights = NULL;
    brio_status status = BRIO_OK;
    TRY(cli_block_weights(in->r, in->options, block, in->count, &weights));
    TRY(brio_tiles_add(in->r->ctx, in->tiles, block->vertices, weights, block->num_vertices));
    in->count += block->num_vertices;
done:
    free(weights);
    return status;
}

static int take_block(const brio_mesh *block, void *user) {
    intake *in = user;
    run *r = in->r;
    in->status = add_block(in, block);
    if (in->status != BRIO_OK) cli_keep_failure(r, in->status);
    return in->status != BRIO_OK;
}

static brio_status read_into(run *r, const weights_options *options, brio_tiles *tiles) {
    intake in = {r, options, tiles, 0, BRIO_OK};
    const char *path = r->operands[0];
    brio_read_options how = cli_read_options(r);
    brio_status status = brio_read_blocks(r->ctx, path, &how, take_block, &in, NULL);
    FORWARD(in.status);
    FORWARD(status);
    cli_tell_input(r, path);
    return BRIO_OK;
}

/* --- the key of a restart --- */

static uint64_t mix(uint64_t hash, uint64_t value) {
    hash ^= value + UINT64_C(0x9e3779b97f4a7c15) + (hash << 6) + (hash >> 2);
    return (hash ^ hash >> 31) * UINT64_C(0xbf58476d1ce4e5b9);
}

static uint64_t mix_text(uint64_t hash, const char *text) {
    for (; text && *text; text++) hash = mix(hash, (unsigned char)*text);
    return mix(hash, text != NULL);
}

/* Returns whether the points may be in files beside the one that is named: .node beside .ele, buffers beside .gltf. */
static bool has_files_beside(const run *r, const char *path) {
    const common_options *c = &r->common;
    brio_format format = brio_format_of(c->input_format ? c->input_format : path);
    return format == brio_format_of(".ele") || format == brio_format_of(".gltf");
}

uint64_t cli_tiles_key(const run *r, const weights_options *w, const char *path) {
    brio_place_facts file;
    const common_options *c = &r->common;
    if (!strcmp(path, "-") || !brio_find_facts(path, &file) || file.kind != BRIO_IS_FILE) return 0;
    if (has_files_beside(r, path)) return 0;
    uint64_t hash = mix_text(1, path);
    hash = mix(mix(hash, file.number), file.volume);
    hash = mix(mix(hash, file.size), (uint64_t)file.seconds);
    hash = mix(hash, (uint64_t)file.nanoseconds);
    hash = mix_text(mix_text(hash, c->input_format), c->columns);
    hash = mix(hash, (uint64_t)c->drop_invalid << 2 | (uint64_t)c->salvage << 1 | w->unweighted);
    hash = mix_text(mix(hash, (uint64_t)(int64_t)w->exponent), brio_version());
    return hash ? hash : 1;
}

/* --- report --- */

void cli_report_tiles(run *r, const brio_tiles_stats *s, uint64_t checksum) {
    facts *f = &r->facts;
    cli_fact_bool(f, "weighted", s->weighted);
    cli_fact_count(f, "points", s->points);
    cli_fact_count(f, "vertices", s->vertices);
    cli_fact_count(f, "duplicates", s->duplicates);
    cli_fact_count(f, "hidden", s->hidden);
    cli_fact_integer(f, "dimension", s->dimension);
    cli_fact_count(f, "tetrahedra", s->tetrahedra);
    cli_fact_count(f, "hull_facets", s->hull_facets);
    cli_fact_checksum(f, "checksum", checksum);
    cli_fact_count(f, "tiles", s->tiles);
    cli_fact_count(f, "resumed", s->resumed);
    cli_fact_count(f, "largest_tile", s->most_points);
    cli_fact_count(f, "scratch_bytes", s->scratch_bytes);
    cli_fact_count(f, "asked", s->asked);
    cli_fact_count(f, "found", s->found);
    cli_fact_count(f, "sampled", s->sampled);
    cli_fact_count(f, "blocks_read", s->read);
    cli_fact_count(f, "triangulated", s->triangulated);
    cli_fact_count(f, "most_rounds", s->most_rounds);
    cli_fact_count(f, "most_tetrahedra", s->most_tetrahedra);
}

static brio_status report(run *r, brio_tiles *t) {
    uint64_t checksum;
    FORWARD(brio_tiles_checksum(r->ctx, t, &checksum));
    cli_lap(r, "checksum");
    cli_report_tiles(r, brio_tiles_facts(t), checksum);
    return BRIO_OK;
}

/* --- cells --- */

/* Exponents of volumes of which doubles hold a share of 2^-53 and sums of cells. */
enum { LEAST_VOLUME = -900, MOST_VOLUME = 1020 };

bool cli_volume_is_held(double volume) {
    return volume > 0 && isfinite(volume) && ilogb(volume) >= LEAST_VOLUME && ilogb(volume) <= MOST_VOLUME;
}

brio_status cli_read_box(run *r, const char *text, double box[6]) {
    const char *rest = text;
    for (int i = 0; i < 6; i++) {
        char *end;
        box[i] = strtod(rest, &end);
        if (end == rest || !isfinite(box[i]) || *end != (i < 5 ? ',' : 0))
            return cli_fail(r, BRIO_ERR_ARGUMENT, "--box: '%s' is not x0,y0,z0,x1,y1,z1", text);
        rest = end + 1;
    }
    for (int k = 0; k < 3; k++)
        if (!(box[k] < box[3 + k]))
            return cli_fail(r, BRIO_ERR_ARGUMENT, "--box: %c from %g to %g is empty", "xyz"[k], box[k], box[3 + k]);
    return BRIO_OK;
}

void cli_report_tile_cells(run *r, const brio_tiles_stats *s, const brio_tiles_cells_stats *cells) {
    facts *f = &r->facts;
    cli_fact_bool(f, "weighted", s->weighted);
    cli_fact_count(f, "points", s->points);
    cli_fact_count(f, "duplicates", s->duplicates);
    cli_fact_count(f, "hidden", s->hidden);
    cli_fact_integer(f, "dimension", s->dimension);
    cli_fact_count(f, "cells", cells->cells);
    cli_fact_count(f, "bounded", cells->bounded);
    cli_fact_count(f, "faces", cells->faces);
    cli_fact_real(f, "volume", cells->volume_sum);
    if (isfinite(cells->region_volume)) {
        double error = fabs(cells->volume_sum / cells->region_volume - 1);
        if (cells->outside) cli_warn(r, WARNING_OUTSIDE, (size_t)cells->outside, (size_t)s->vertices, r->operands[0]);
        cli_fact_real(f, "box_volume", cells->region_volume);
        cli_fact_real(f, "box_error", cli_volume_is_held(cells->region_volume) ? error : NAN);
    }
    cli_fact_count(f, "tiles", s->tiles);
    cli_fact_count(f, "resumed", s->resumed);
    cli_fact_count(f, "largest_tile", s->most_points);
    cli_fact_count(f, "scratch_bytes", s->scratch_bytes);
}

/* --- output --- */

brio_status cli_write_part(run *r, const brio_tile_part *p, bool weighted, const char *path) {
    brio_tile_part part = *p;
    brio_mesh *mesh = NULL;
    brio_write_options how = {.size = sizeof how, .ascii = r->common.ascii, .compress = r->common.compress};
    double *values;
    void *data;
    brio_status status = BRIO_OK;
    TRY(brio_mesh_new(r->ctx, &mesh));
    TRY(brio_mesh_set_vertices(mesh, part.points, part.num_vertices));
    TRY(brio_mesh_set_tetrahedra(mesh, *part.tetrahedra, 4, part.num_tetrahedra));
    TRY(brio_mesh_add_property(mesh, "point", BRIO_SCALAR_FLOAT64, &data));
    values = data;
    for (size_t i = 0; i < part.num_vertices; i++) values[i] = (double)part.index[i];
    if (weighted) {
        TRY(brio_mesh_add_property(mesh, "weight", BRIO_SCALAR_FLOAT64, &data));
        if (part.num_vertices) memcpy(data, part.weights, part.num_vertices * sizeof *part.weights);
    }
    status = brio_write(r->ctx, path, mesh, &how);
done:
    brio_mesh_free(mesh);
    return status;
}

static brio_status write_tile(run *r, brio_tiles *t, uint32_t tile, bool weighted, const char *path) {
    brio_tile_part part = {.size = sizeof part};
    FORWARD(brio_tiles_part(r->ctx, t, tile, &part));
    brio_status status = cli_write_part(r, &part, weighted, path);
    brio_tile_part_free(r->ctx, &part);
    return status;
}

/* Writes an index.   type  of the data set in VTK.   extension  of the files.   weight  whether they have weights. */
static brio_status write_index(run *r, const new_folder *folder, uint32_t files, const char *type,
                               const char *extension, bool weighted) {
    new_file f = {.target.folder = -1};
    brio_status status = BRIO_OK;
    TRY(cli_new_file_open(r, folder->index, &f));
    fprintf(f.file,
            "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s" CLI_XML_HEAD "%s GhostLevel=\"0\">\n"
            "<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n"
            "<PPointData>\n<PDataArray type=\"Float64\" Name=\"point\"/>\n",
            type, type);
    if (weighted) fprintf(f.file, "<PDataArray type=\"Float64\" Name=\"weight\"/>\n");
    fprintf(f.file, "</PPointData>\n");
    for (uint32_t i = 0; i < files; i++) {
        fprintf(f.file, "<Piece Source=\"");
        cli_write_attribute(f.file, folder->path + brio_folder_length(folder->path));
        fprintf(f.file, "/%u%s\"/>\n", i, extension);
    }
    fprintf(f.file, "</%s>\n</VTKFile>\n", type);
    status = cli_new_file_publish(r, folder->index, &f);
done:
    cli_new_file_close(&f);
    return status;
}

brio_status cli_write_tiles_index(run *r, const new_folder *folder, uint32_t tiles, bool weighted) {
    return write_index(r, folder, tiles, "PUnstructuredGrid", OF_TILES, weighted);
}

brio_status cli_write_faces_index(run *r, const new_folder *folder, uint32_t files) {
    return write_index(r, folder, files, "PPolyData", ".vtp", false);
}

/* Writes a file for each tile, then the index. Without the index there is no output: on failure the tiles are removed,
 * and an older output stays as it was. */
static brio_status write_tiles(run *r, brio_tiles *t, uint32_t tiles, bool weighted) {
    char path[BRIO_PATH_MOST + 32];
    new_folder folder = {.lock = -1};
    brio_status status = BRIO_OK;
    TRY(cli_new_folder_open(r, r->common.output, OF_TILES, &folder));
    folder.most_files = tiles;
    for (uint32_t i = 0; i < tiles; i++) {
        snprintf(path, sizeof path, "%s/%u%s", folder.path, i, OF_TILES);
        TRY(write_tile(r, t, i, weighted, path));
    }
    TRY(cli_new_folder_name(r, &folder));
    status = cli_write_tiles_index(r, &folder, tiles, weighted);
done:
    cli_new_folder_close(&folder, status == BRIO_OK);
    cli_lap(r, "write");
    return status;
}

/* --- one file --- */

void cli_merging_begin(tile_merging *m, run *r, const weights_options *weights) {
    const common_options *c = &r->common;
    *m = (tile_merging){.r = r, .options = *weights, .key = cli_tiles_key(r, weights, r->operands[0])};
    m->options.quiet = true; /* the first reading has said all */
    m->how = (brio_write_options){.size = sizeof m->how,
                                  .format = merged_format(r),
                                  .ascii = c->ascii,
                                  .float32 = c->float32,
                                  .comment = "brio " BRIO_VERSION,
                                  .moved = &m->moved,
                                  .colours_rounded = &m->rounded};
}

/* Refuses and settles what the points tell, before the long work. */
static brio_status settle_merging(tile_merging *m, const brio_tiles *t) {
    run *r = m->r;
    brio_read_options from = cli_read_options(r);
    const brio_convert_options o = {.from = &from};
    m->all = brio_tiles_facts(t)->points;
    if (m->all > UINT32_MAX)
        return cli_fail(r, BRIO_ERR_TOO_LARGE,
                        "%s: %" PRIu64 " points; indices of this format reach 2^32 - 1: .pvtu has a file for each tile",
                        r->common.output, m->all);
    return cli_settle_conversion(r, 1, &o, &m->how, &m->merged);
}

static brio_status has_changed(const tile_merging *m) {
    return cli_fail(m->r, BRIO_ERR_FORMAT, "%s: the file changed between two readings", m->r->operands[0]);
}

/* Names the properties of the blocks, as brio delaunay without tiles does: weights are one. */
static brio_status name_properties(tile_merging *m, const brio_mesh *block, bool weighted) {
    size_t n = block->num_properties;
    bool overruled = m->options.exponent != NO_EXPONENT || m->options.unweighted;
    brio_mesh named = *block;
    m->property = calloc(n + 1, sizeof *m->property);
    if (!m->property) return cli_fail(m->r, BRIO_ERR_NO_MEMORY, "out of memory");
    if (n) memcpy(m->property, block->properties, n * sizeof *m->property);
    m->num_properties = n;
    named.properties = m->property;
    if (overruled) cli_set_aside(m->r, &named, "weight");
    if (overruled) cli_set_aside(m->r, &named, "radius");
    m->adds_weight = weighted && !brio_mesh_property(&named, "weight");
    if (m->adds_weight) m->property[n] = (brio_property){.name = "weight", .type = BRIO_SCALAR_FLOAT64};
    return BRIO_OK;
}

static brio_status write_block(tile_merging *m, const brio_mesh *block) {
    double *weights = NULL;
    brio_mesh shown = *block;
    brio_status status = BRIO_OK;
    TRY(cli_block_weights(m->r, &m->options, block, m->count, &weights));
    if (!m->property) TRY(name_properties(m, block, weights != NULL));
    if (block->num_vertices > m->all - m->count || block->num_properties != m->num_properties) TRY(has_changed(m));
    for (size_t i = 0; i < m->num_properties; i++) m->property[i].data = block->properties[i].data;
    if (m->adds_weight) m->property[m->num_properties].data = weights;
    shown.properties = m->property;
    shown.num_properties = m->num_properties + m->adds_weight;
    TRY(brio_mesh_parts_vertices(m->r->ctx, m->parts, &shown));
    m->count += block->num_vertices;
done:
    free(weights);
    return status;
}

static int look_again(const brio_mesh *block, void *user) {
    tile_merging *m = user;
    return !brio_mesh_parts_look(m->parts, block);
}

/* Writes a block. Ends at the first one if all have to be looked at before. */
static int take_again(const brio_mesh *block, void *user) {
    tile_merging *m = user;
    bool first = !m->property && !m->looks;
    if (first) m->looks = brio_mesh_parts_look(m->parts, block);
    if (first && m->looks) return 1;
    m->status = write_block(m, block);
    if (m->status != BRIO_OK) cli_keep_failure(m->r, m->status);
    return m->status != BRIO_OK;
}

static brio_status write_points_again(tile_merging *m) {
    run *r = m->r;
    brio_read_options how = cli_read_options(r);
    brio_status status = brio_read_blocks(r->ctx, r->operands[0], &how, take_again, m, NULL);
    if (m->looks) {
        FORWARD(brio_read_blocks(r->ctx, r->operands[0], &how, look_again, m, NULL));
        status = brio_read_blocks(r->ctx, r->operands[0], &how, take_again, m, NULL);
    }
    FORWARD(m->status);
    FORWARD(status);
    bool same = m->count == m->all && cli_tiles_key(r, &m->options, r->operands[0]) == m->key;
    return same ? BRIO_OK : has_changed(m);
}

/* Tiles whose tetrahedra are written. */
typedef struct {
    brio_tiles *t;
    uint32_t tiles;
} written_tiles;

static brio_status write_tile_tetrahedra(run *r, brio_mesh_parts *parts, brio_tiles *t, uint32_t tile) {
    brio_tile_part part = {.size = sizeof part};
    brio_status status = BRIO_OK;
    TRY(brio_tiles_part(r->ctx, t, tile, &part));
    for (size_t i = 0; i < part.num_tetrahedra; i++)
        for (int k = 0; k < 4; k++) part.tetrahedra[i][k] = (uint32_t)part.index[part.tetrahedra[i][k]];
    TRY(brio_mesh_parts_tetrahedra(r->ctx, parts, part.num_tetrahedra ? *part.tetrahedra : NULL, part.num_tetrahedra));
done:
    brio_tile_part_free(r->ctx, &part);
    return status;
}

static brio_status write_tetrahedra(run *r, brio_mesh_parts *parts, void *user) {
    const written_tiles *w = user;
    for (uint32_t i = 0; i < w->tiles; i++) FORWARD(write_tile_tetrahedra(r, parts, w->t, i));
    return BRIO_OK;
}

brio_status cli_merging_write(tile_merging *m, const tile_cells *cells) {
    run *r = m->r;
    const char *output = r->common.output;
    brio_status status = BRIO_OK;
    TRY(cli_check_interrupt(r));
    cli_interrupt_writing(strcmp(output, "-") != 0);
    if (cells->of_faces)
        TRY(brio_mesh_parts_new_faces(r->ctx, output, &m->how, m->all, cells->count, &m->parts));
    else
        TRY(brio_mesh_parts_new(r->ctx, output, &m->how, m->all, cells->count, &m->parts));
    TRY(write_points_again(m));
    TRY(cells->write(r, m->parts, cells->user));
    TRY(brio_mesh_parts_finish(r->ctx, m->parts));
    cli_tell_moved(r, output, m->moved, m->merged);
    if (m->rounded) cli_warn(r, WARNING_COLOURS, output);
done:
    brio_mesh_parts_free(m->parts);
    cli_interrupt_writing(false);
    free(m->property);
    cli_lap(r, "write");
    return status;
}

/* --- the run --- */

/* Reads the input, unless a run before has. */
static brio_status read_tiles(run *r, const weights_options *weights, uint64_t tiles, int stars, brio_tiles **out) {
    brio_tiles_options o = {.size = sizeof o, .scratch = r->common.scratch, .tiles = (uint32_t)tiles, .stars = stars};
    o.key = cli_tiles_key(r, weights, r->operands[0]);
    FORWARD(brio_context_set_scratch(r->ctx, NULL)); /* a tile is in memory */
    FORWARD(brio_tiles_new(r->ctx, &o, out));
    if (!brio_tiles_has_points(*out)) FORWARD(read_into(r, weights, *out));
    cli_lap(r, "read");
    return BRIO_OK;
}

static brio_status run_tiles(run *r, brio_tiles *t) {
    FORWARD(brio_tiles_run(r->ctx, t));
    const brio_tiles_stats *s = brio_tiles_facts(t);
    cli_stage(r, "divide", s->divide_seconds);
    cli_stage(r, "insert", s->triangulate_seconds);
    r->lap = cli_clock();
    return BRIO_OK;
}

brio_status cli_triangulate_merging(run *r, tile_merging *merging, const weights_options *weights, uint64_t tiles,
                                    int stars, brio_tiles **out) {
    FORWARD(read_tiles(r, weights, tiles, stars, out));
    if (merging) FORWARD(settle_merging(merging, *out));
    return run_tiles(r, *out);
}

brio_status cli_triangulate_tiles(run *r, const weights_options *weights, uint64_t tiles, int stars, brio_tiles **out) {
    return cli_triangulate_merging(r, NULL, weights, tiles, stars, out);
}

brio_status cli_tiles(run *r, const weights_options *weights, uint64_t tiles) {
    brio_tiles *t = NULL;
    brio_status status = BRIO_OK;
    bool merges = cli_merges_tiles(r);
    tile_merging m;
    cli_merging_begin(&m, r, weights);
    TRY(cli_triangulate_merging(r, merges ? &m : NULL, weights, tiles, 0, &t));
    TRY(report(r, t));
    written_tiles all = {t, (uint32_t)tiles};
    const tile_cells cells = {false, brio_tiles_facts(t)->tetrahedra, write_tetrahedra, &all};
    if (merges)
        TRY(cli_merging_write(&m, &cells));
    else if (r->common.output)
        TRY(write_tiles(r, t, (uint32_t)tiles, brio_tiles_facts(t)->weighted));
    status = cli_show_tiles(r, t, (uint32_t)tiles);
done:
    brio_tiles_free(t);
    return status;
}
