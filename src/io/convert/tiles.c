/* Converts a file to many: points of any number become tiles of about as many points each.
 *
 * The points that stay go to a scratch file (rows.h), which is divided. What all files have in common is found in the
 * points of all before: the depth of colours, and the grid and the fields of LAS. So the files together are what one
 * file of all would be. Then each tile is the source of a conversion. */
#include "base/memory.h"
#include "io/convert/conversion.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- what is taken --- */

/* Returns the bytes of memory beside a tile: of all tiles while they are divided, a block as rows, in arrays, as it was
 * read and as it is written, and the buffers of a reader and a writer, measured. */
static double bytes_beside(const brio_conversion *c) {
    return 2e6 + brio_rows_divide_bytes(&c->rows, c->options->tiles) + 4.0 * BRIO_BLOCK_ROWS * (double)c->rows.size;
}

/* Returns the bytes of a point of a tile that is in memory as a whole: of its row, of the same compressed with VTK's
 * three indices, and of four numbers of a colour in another depth. */
static double bytes_of_point(const brio_conversion *c) {
    return 2 * (double)c->rows.size + 12 + 32;
}

static brio_status require_least_memory(const brio_conversion *c) {
    double limit = (double)brio_memory_limit(c->ctx), need = bytes_beside(c);
    BRIO_EXPECT(c->ctx, need <= limit, BRIO_ERR_NO_MEMORY,
                "points in tiles need about %.0f MB, for any number of points, of the %.0f MB that are allowed",
                need / 1e6, limit / 1e6);
    return BRIO_OK;
}

/* Returns whether two files say the same by some metadata, or nothing by them. */
static bool say_same(const brio_mesh *a, const brio_mesh *b, const char *name) {
    const brio_metadata *x = brio_mesh_metadata(a, name), *y = brio_mesh_metadata(b, name);
    return (!x && !y) || (x && y && x->size == y->size && !memcmp(x->bytes, y->bytes, x->size));
}

static bool are_in_one_system(const brio_mesh *a, const brio_mesh *b) {
    bool same_code = say_same(a, b, "crs.code");
    if (brio_mesh_metadata(a, "crs.code") && brio_mesh_metadata(b, "crs.code")) return same_code;
    return same_code && say_same(a, b, "crs.wkt") && say_same(a, b, "crs.geokeys");
}

/* Refuses points that do not go into files with those of the first block. */
static brio_status require_kind(const brio_conversion *c, const brio_mesh *block) {
    const char *name = c->source.path;
    const brio_property *other = brio_rows_differ(&c->rows, block);
    BRIO_EXPECT(c->ctx, !other, BRIO_ERR_FORMAT,
                "%s: other properties than the points before: %s is not in both, or of another type", name,
                other->name);
    BRIO_EXPECT(c->ctx, are_in_one_system(c->rows.kind, block), BRIO_ERR_FORMAT,
                "%s: another coordinate system than that of the points before", name);
    BRIO_EXPECT(c->ctx, say_same(c->rows.kind, block, "colour.depth"), BRIO_ERR_FORMAT,
                "%s: colours of another depth than those before", name);
    return BRIO_OK;
}

/* Takes a block into the scratch file, the first one when the disk has room for all that are announced. */
static brio_status keep_block(void *user, const brio_mesh *block) {
    brio_conversion *c = user;
    const brio_source *s = &c->source;
    uint64_t points = block->num_vertices;
    if (!c->rows.kind) {
        BRIO_FORWARD(brio_rows_begin(&c->rows, block));
        BRIO_FORWARD(require_least_memory(c));
        if (s->job.announced != BRIO_COUNT_UNKNOWN && !c->options->crop) points = s->job.announced;
        BRIO_FORWARD(brio_rows_require_room(&c->rows, s->path, 2 * points)); /* as they came, and in tiles */
        if (block->num_faces) brio_conversion_lose(c, "faces");
        if (block->num_tetrahedra) brio_conversion_lose(c, "tetrahedra");
        if (block->num_edges) brio_conversion_lose(c, "edges");
    }
    BRIO_FORWARD(require_kind(c, block));
    return brio_rows_append(&c->rows, block);
}

/* Adds what a reader said of an input to what it said of those before. */
static brio_status add_findings(brio_context *ctx, brio_read_job *all, const brio_read_job *job) {
    all->dropped += job->dropped;
    all->missing += job->missing;
    all->streamed &= job->streamed;
    all->notes.numbered |= job->notes.numbered;
    if (!all->notes.rounded) {
        int numbered = all->notes.numbered;
        all->notes = job->notes;
        all->notes.numbered = numbered;
    }
    for (size_t i = 0, k; i < job->num_left_out; i++) {
        for (k = 0; k < all->num_left_out && strcmp(all->left_out[k], job->left_out[i]); k++) {}
        if (k < all->num_left_out) continue;
        BRIO_FORWARD(BRIO_RESIZE(ctx, all->left_out, all->num_left_out + 1));
        memcpy(all->left_out[all->num_left_out++], job->left_out[i], sizeof *all->left_out);
    }
    return BRIO_OK;
}

/* Takes the points of all inputs into the scratch file. */
static brio_status take_inputs(brio_conversion *c, brio_bar bar) {
    brio_source *s = &c->source;
    const brio_sink keeps = {keep_block, c};
    const brio_read_job how = s->job;
    const char *first = s->path;
    brio_read_job all = {.streamed = true};
    brio_status status = BRIO_OK;
    uint64_t points_read = 0;
    double part = 0.4 / (1 + c->options->num_more);
    for (uint32_t i = 0; i <= c->options->num_more; i++) {
        brio_progress_part(c->ctx, bar, part * i, part * (i + 1));
        s->job = how;
        s->job.path = s->path = i ? c->options->more[i - 1] : first;
        s->has_facts = false;
        BRIO_TRY(brio_source_pass(s, &keeps));
        points_read += s->points_read;
        BRIO_TRY(add_findings(c->ctx, &all, &s->job));
        brio_read_job_free(c->ctx, &s->job);
        brio_mesh_free(s->job.mesh); /* of a format that is not read in blocks */
        s->job.mesh = NULL;
    }
    s->points_read = points_read;
    s->job = all;
    all.left_out = NULL;
done:
    s->path = first;
    brio_read_job_free(c->ctx, &all);
    return status;
}

static brio_status look_at_colours(void *user, const brio_mesh *block) {
    brio_conversion *c = user;
    brio_colour_look(&c->colours, block);
    return BRIO_OK;
}

/* Finds what all files have in common. */
static brio_status find_common(brio_conversion *c) {
    const brio_row_format *format = brio_row_format_of(c->format);
    const brio_write_job job = {.options = &c->write, .points = BRIO_COUNT_UNKNOWN, .expected = BRIO_NO_PROGRESS};
    const brio_sink looks = {look_at_colours, c}, surveys = {brio_conversion_survey, c};
    if (brio_colour_is_open(&c->colours, c->rows.kind)) {
        BRIO_FORWARD(brio_source_pass(&c->source, &looks));
        c->colours.points.looked = true;
    }
    if (!format || !format->share) return BRIO_OK;
    BRIO_FORWARD(brio_row_writer_new(&c->writer, c->ctx, c->format, &job));
    c->writer.colours = c->colours;
    while (c->writer.surveys) {
        BRIO_FORWARD(brio_source_pass(&c->source, &surveys));
        brio_row_writer_end_survey(&c->writer);
    }
    c->all = c->writer;
    c->writer = (brio_row_writer){.ctx = c->ctx};
    return BRIO_OK;
}

/* Refuses tiles that are in memory as a whole and do not fit. */
static brio_status require_memory(const brio_conversion *c) {
    double limit = (double)brio_memory_limit(c->ctx), most = (double)c->stats.largest_tile;
    double each = brio_row_format_of(c->format) ? 0 : bytes_of_point(c);
    double beside = bytes_beside(c), need = beside + most * each, all = (double)c->rows.count;
    if (need <= limit) return BRIO_OK;
    return brio_fail(c->ctx, BRIO_ERR_NO_MEMORY,
                     "the largest of %u tiles has %.0f points, and needs about %.0f MB of the %.0f MB that are "
                     "allowed: take about %.0f tiles",
                     c->options->tiles, most, need / 1e6, limit / 1e6,
                     fmin(ceil(1.2 * all * each / (limit - beside)), BRIO_MOST_TILES));
}

/* Makes the name of a tile's file: the number in place of the last # of the pattern.   out  owned by the caller. */
static brio_status name_tile(brio_context *ctx, const char *pattern, unsigned number, char **out) {
    const char *place = strrchr(pattern, '#');
    size_t size = strlen(pattern) + 16;
    BRIO_FORWARD(BRIO_ALLOC(ctx, *out, size));
    snprintf(*out, size, "%.*s%u%s", (int)(place - pattern), pattern, number, place + 1);
    return BRIO_OK;
}

static brio_status write_tile(brio_conversion *c, const brio_row_tile *t) {
    brio_mesh *mesh = NULL;
    brio_status status = BRIO_OK;
    c->source.first = t->first;
    c->source.num_rows = t->count;
    if (brio_row_format_of(c->format)) return brio_conversion_stream(c);
    BRIO_TRY(brio_rows_mesh(&c->rows, t->first, t->count, &mesh));
    status = brio_conversion_write(c, mesh);
done:
    brio_mesh_free(mesh);
    return status;
}

static brio_status tell_tile(const brio_conversion *c, const brio_row_tile *t) {
    brio_convert_tile told = {.size = sizeof told, .path = c->to, .points = t->count, .kind = c->rows.kind};
    memcpy(told.low, t->low, sizeof told.low);
    memcpy(told.high, t->high, sizeof told.high);
    bool goes_on = !c->options->tile || !c->options->tile(&told, c->options->tile_user);
    return goes_on ? BRIO_OK : brio_fail(c->ctx, BRIO_ERR_CANCELLED, "cancelled");
}

/* Writes a file for each tile that has points, or one without points if none has any. */
static brio_status write_tiles(brio_conversion *c, const brio_row_tile *tile, brio_bar bar) {
    const char *pattern = c->to;
    brio_status status = BRIO_OK;
    char *path = NULL;
    uint64_t done = 0;
    unsigned files = 0;
    for (uint32_t i = 0; i < c->options->tiles; i++) {
        double all = (double)c->rows.count + 1;
        if (!tile[i].count && (c->rows.count || i)) continue;
        BRIO_TRY(name_tile(c->ctx, pattern, files++, &path));
        brio_progress_part(c->ctx, bar, 0.6 + 0.4 * (double)done / all,
                           0.6 + 0.4 * (double)(done + tile[i].count) / all);
        done += tile[i].count;
        c->to = path;
        c->more = done < c->rows.count;
        BRIO_TRY(write_tile(c, &tile[i]));
        BRIO_TRY(tell_tile(c, &tile[i]));
        c->stats.tiles += tile[i].count > 0;
        brio_release(c->ctx, path);
        path = NULL;
    }
done:
    c->to = pattern;
    brio_release(c->ctx, path);
    return status;
}

static void lap(double *seconds, double *since) {
    double now = brio_seconds();
    *seconds = now - *since;
    *since = now;
}

brio_status brio_conversion_tiles(brio_conversion *c) {
    brio_status status = BRIO_OK;
    brio_row_tile *tile = NULL;
    brio_source *s = &c->source;
    const brio_bar bar = brio_progress_bar(c->ctx);
    double now = brio_seconds();
    BRIO_REQUIRE(c->ctx, c->format != BRIO_FORMAT_STL, BRIO_ERR_ARGUMENT,
                 "files of tiles have points alone, and an STL file has triangles alone");
    BRIO_TRY(BRIO_ALLOC(c->ctx, tile, c->options->tiles));
    c->rows.folder = c->options->scratch;
    BRIO_TRY(take_inputs(c, bar));
    s->rows = &c->rows;
    s->num_rows = c->rows.count;
    lap(&c->stats.read_seconds, &now);
    brio_progress_part(c->ctx, bar, 0.4, 0.5);
    if (c->options->drop_outliers || c->options->thin > 0) BRIO_TRY(brio_source_choose(s));
    lap(&c->stats.select_seconds, &now);
    brio_progress_part(c->ctx, bar, 0.5, 0.6);
    BRIO_TRY(brio_rows_require_room(&c->rows, s->path, c->rows.count));
    BRIO_TRY(find_common(c));
    BRIO_TRY(brio_rows_divide(&c->rows, s->chosen, c->options->tiles, tile));
    brio_release(c->ctx, s->chosen);
    s->chosen = NULL;
    for (uint32_t i = 0; i < c->options->tiles; i++)
        if (tile[i].count > c->stats.largest_tile) c->stats.largest_tile = tile[i].count;
    c->stats.scratch_bytes = c->rows.most;
    BRIO_TRY(require_memory(c));
    lap(&c->stats.divide_seconds, &now);
    status = write_tiles(c, tile, bar);
done:
    brio_progress_part(c->ctx, bar, 0, 1);
    brio_release(c->ctx, tile);
    return status;
}
