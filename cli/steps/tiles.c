/* --tiles: points go to the library block by block, as they are read; a report, and a file for each tile. */
#include "cli/steps/tiles.h"
#include "cli/files/files.h"
#include "cli/files/new_file.h"
#include "cli/files/read_write.h"
#include "platform/file.h"
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_TILES = 1 << 16 };

static const char EXTENSION[] = ".pvtu", OF_TILES[] = ".vtu";

static bool ends_with(const char *text, const char *end) {
    size_t n = strlen(text), m = strlen(end);
    return n > m && !strcmp(text + n - m, end);
}

brio_status cli_check_tiles(run *r, const weights_options *weights, uint64_t tiles) {
    if (tiles > MOST_TILES)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--tiles: %" PRIu64 " are more than %d", tiles, MOST_TILES);
    if (!r->common.scratch) return cli_fail(r, BRIO_ERR_ARGUMENT, "--tiles needs --scratch DIR, where the tiles are");
    if (weights->file)
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "--tiles: not with --weights FILE; the points can have a property weight or radius");
    return BRIO_OK;
}

brio_status cli_check_tile_files(run *r) {
    const char *output = r->common.output;
    if (output && (!ends_with(output, EXTENSION) || !strcmp(output + brio_folder_length(output), EXTENSION)))
        return cli_fail_output(r, "%s: --tiles writes .pvtu, with a file for each tile beside it", output);
    return output ? cli_new_folder_check(r, output, OF_TILES) : BRIO_OK;
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
    o.estimate = first > 0; /* its words are said once */
    if (o.exponent != NO_EXPONENT) return cli_modular_weights(r, o.exponent, first, block->num_vertices, weights);
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

brio_status cli_write_tiles_index(run *r, const char *folder, uint32_t tiles, bool weighted) {
    new_file f = {0};
    brio_status status = BRIO_OK;
    TRY(cli_new_file_open(r, r->common.output, &f));
    fprintf(f.file, "<?xml version=\"1.0\"?>\n<VTKFile type=\"PUnstructuredGrid\" version=\"1.0\" "
                    "byte_order=\"LittleEndian\" header_type=\"UInt64\">\n<PUnstructuredGrid GhostLevel=\"0\">\n"
                    "<PPoints>\n<PDataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\"/>\n</PPoints>\n"
                    "<PPointData>\n<PDataArray type=\"Float64\" Name=\"point\"/>\n");
    if (weighted) fprintf(f.file, "<PDataArray type=\"Float64\" Name=\"weight\"/>\n");
    fprintf(f.file, "</PPointData>\n");
    for (uint32_t i = 0; i < tiles; i++) {
        fprintf(f.file, "<Piece Source=\"");
        cli_write_attribute(f.file, folder + brio_folder_length(folder));
        fprintf(f.file, "/%u.vtu\"/>\n", i);
    }
    fprintf(f.file, "</PUnstructuredGrid>\n</VTKFile>\n");
    status = cli_new_file_publish(r, r->common.output, &f);
done:
    cli_new_file_close(&f);
    return status;
}

/* Writes a file for each tile, then the index. Without the index there is no output: on failure the tiles are removed,
 * and an older output stays as it was. */
static brio_status write_tiles(run *r, brio_tiles *t, uint32_t tiles, bool weighted) {
    char path[BRIO_PATH_MOST + 32];
    new_folder folder = {.lock = -1};
    brio_status status = BRIO_OK;
    TRY(cli_new_folder_open(r, r->common.output, OF_TILES, &folder));
    for (uint32_t i = 0; i < tiles; i++) {
        snprintf(path, sizeof path, "%s/%u%s", folder.path, i, OF_TILES);
        TRY(write_tile(r, t, i, weighted, path));
    }
    TRY(cli_new_folder_name(r, &folder));
    status = cli_write_tiles_index(r, folder.path, tiles, weighted);
done:
    cli_new_folder_close(&folder, status == BRIO_OK);
    cli_lap(r, "write");
    return status;
}

/* --- the run --- */

brio_status cli_triangulate_tiles(run *r, const weights_options *weights, uint64_t tiles, bool stars,
                                  brio_tiles **out) {
    brio_tiles_options o = {.size = sizeof o, .scratch = r->common.scratch, .tiles = (uint32_t)tiles, .stars = stars};
    o.key = cli_tiles_key(r, weights, r->operands[0]);
    FORWARD(brio_context_set_scratch(r->ctx, NULL)); /* a tile is in memory */
    FORWARD(brio_tiles_new(r->ctx, &o, out));
    if (!brio_tiles_has_points(*out)) FORWARD(read_into(r, weights, *out));
    cli_lap(r, "read");
    FORWARD(brio_tiles_run(r->ctx, *out));
    const brio_tiles_stats *s = brio_tiles_facts(*out);
    cli_stage(r, "divide", s->divide_seconds);
    cli_stage(r, "insert", s->triangulate_seconds);
    r->lap = cli_clock();
    return BRIO_OK;
}

brio_status cli_tiles(run *r, const weights_options *weights, uint64_t tiles) {
    brio_tiles *t = NULL;
    brio_status status = BRIO_OK;
    TRY(cli_triangulate_tiles(r, weights, tiles, false, &t));
    TRY(report(r, t));
    if (r->common.output) TRY(write_tiles(r, t, (uint32_t)tiles, brio_tiles_facts(t)->weighted));
done:
    brio_tiles_free(t);
    return status;
}
