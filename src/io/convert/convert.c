/* Converts a file to another format.
 *
 * The points go through the steps as a stream of blocks: source.c reads and chooses, a row writer (row_format.h) takes
 * them. Formats that are not written row by row, and files with polygons, take the way through memory: the source is
 * then one mesh. Each tile of points is such a conversion (tiles.c). */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "io/convert/conversion.h"
#include "platform/file.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- what is lost --- */

void brio_conversion_lose(const brio_conversion *c, const char *name) {
    if (c->options->lost) c->options->lost(name, c->options->lost_user);
}

static bool holds(const brio_conversion *c, unsigned what) {
    return brio_format_holds(c->format, what);
}

/* Returns whether polygons are cut. STL and GLB have triangles only: other polygons are cut into them, and those of
 * fewer corners are left out. */
static bool cuts_polygons(const brio_conversion *c, const brio_mesh *m) {
    bool triangles = c->format == BRIO_FORMAT_STL || c->format == BRIO_FORMAT_GLB;
    for (size_t f = 0; triangles && f < m->num_faces; f++)
        if (m->face_offsets[f + 1] - m->face_offsets[f] != 3) return true;
    return false;
}

/* Names the metadata that the format does not keep. A coordinate system is one thing, in whatever form; the depth of
 * colours is that of their numbers. */
static void name_metadata(const brio_conversion *c, const brio_mesh *m) {
    bool has_system = false, keeps_system = false;
    for (size_t i = 0; i < m->num_metadata; i++) {
        const char *name = m->metadata[i].name;
        bool kept = brio_format_keeps(c->format, name), system = !strncmp(name, "crs.", 4);
        has_system |= system;
        keeps_system |= kept && (!strcmp(name, "crs.wkt") || !strcmp(name, "crs.geokeys"));
        if (!kept && !system && strncmp(name, "colour.", 7) != 0) brio_conversion_lose(c, name);
    }
    bool in_comment = c->format == BRIO_FORMAT_PLY && c->write.crs_comment &&
                      (brio_mesh_metadata(m, "crs.wkt") || brio_mesh_metadata(m, "crs.code"));
    if (has_system && !keeps_system && !in_comment && !c->options->crs) brio_conversion_lose(c, "crs");
}

/* Writes the coordinate system to its file, which has no name yet. */
static brio_status write_crs(brio_conversion *c, const brio_mesh *m) {
    const brio_metadata *text = brio_mesh_metadata(m, "crs.wkt"), *code = brio_mesh_metadata(m, "crs.code");
    if (!c->options->crs || c->crs.name) return BRIO_OK;
    BRIO_EXPECT(c->ctx, text, BRIO_ERR_NO_ANSWER,
                "%s: no coordinate system as well-known text, which %s is to have%s%s", c->source.path, c->options->crs,
                code ? "; its code is " : "", code ? code->bytes : "");
    BRIO_FORWARD(brio_output_open(&c->crs, c->ctx, c->options->crs, BRIO_NO_PROGRESS));
    BRIO_FORWARD(brio_output_bytes(&c->crs, text->bytes, text->size));
    return brio_output_finish(&c->crs);
}

/* Returns whether the writer knows best which properties have a place. */
static bool asks_writer(const brio_conversion *c) {
    return c->writer.format && c->writer.format->lacks;
}

/* Names the properties that have no place in the file, or another name there, each once for the files of all tiles. */
static brio_status name_properties(brio_conversion *c, const brio_mesh *m) {
    enum { LOST = 1, RENAMED = 2 };
    if (!c->named) BRIO_FORWARD(BRIO_ALLOC_ZERO(c->ctx, c->named, m->num_properties + 1));
    for (size_t i = 0; i < m->num_properties; i++) {
        bool lost = asks_writer(c) && c->writer.format->lacks(c->writer.state, i);
        bool renamed = brio_row_writer_renames(&c->writer, m, i);
        if (lost && !(c->named[i] & LOST)) brio_conversion_lose(c, m->properties[i].name);
        if (c->options->renamed && renamed && !(c->named[i] & RENAMED))
            c->options->renamed(m->properties[i].name, c->options->renamed_user);
        c->named[i] |= (uint8_t)((lost ? LOST : 0) | (renamed ? RENAMED : 0));
    }
    return BRIO_OK;
}

/* Names the parts of a mesh that the format cannot hold. */
static void name_losses(brio_conversion *c, const brio_mesh *m) {
    if (c->told) return;
    c->told = true;
    if (m->num_faces && !holds(c, BRIO_HOLDS_FACES)) brio_conversion_lose(c, "faces");
    if (m->num_tetrahedra && !holds(c, BRIO_HOLDS_TETRAHEDRA)) brio_conversion_lose(c, "tetrahedra");
    if (m->num_edges && !holds(c, BRIO_HOLDS_EDGES)) brio_conversion_lose(c, "edges");
    if (cuts_polygons(c, m)) brio_conversion_lose(c, "polygons of more than three corners");
    bool nameless = holds(c, BRIO_HOLDS_PROPERTIES) && !holds(c, BRIO_HOLDS_NAMES);
    if (m->num_properties && nameless) brio_conversion_lose(c, "names of properties");
    for (size_t i = 0; i < m->num_properties && !asks_writer(c); i++)
        if (!brio_format_holds_property(c->format, m, i)) brio_conversion_lose(c, m->properties[i].name);
    for (size_t i = 0; i < m->num_face_properties && m->num_faces; i++) {
        char name[64 + sizeof " of faces"];
        snprintf(name, sizeof name, "%s of faces", m->face_properties[i].name);
        if (!brio_format_holds_face_property(c->format, m, i)) brio_conversion_lose(c, name);
    }
    name_metadata(c, m);
}

/* Returns whether a property is rounded. GLB has no doubles and no signed integers of 32 bits. */
static bool rounds_property(const brio_conversion *c, const brio_mesh *m, const brio_property *p) {
    bool wide = p->type == BRIO_SCALAR_FLOAT64 || p->type == BRIO_SCALAR_INT32 || p->type == BRIO_SCALAR_UINT32;
    for (size_t v = 0; c->format == BRIO_FORMAT_GLB && wide && v < m->num_vertices; v++) {
        double x = brio_property_value(p, v);
        if (!isnan(x) && (double)(float)x != x) return true;
    }
    return false;
}

static void find_rounding(brio_conversion *c, const brio_mesh *m) {
    brio_channels colour = brio_colour_of(m);
    for (size_t i = 0; i < m->num_properties && !c->rounded; i++)
        c->rounded = !brio_channels_have(&colour, &m->properties[i]) && rounds_property(c, m, &m->properties[i]);
    for (size_t i = 0; i < 3 * m->num_vertices && !c->rounded && brio_is_single(c->format, &c->write); i++)
        c->rounded = fabs(m->vertices[i]) <= 0x1.ffffffp127 && (double)(float)m->vertices[i] != m->vertices[i];
}

/* Names what was rounded, and what the reader passed over, before the last file gets its name. */
static void name_rest(const brio_conversion *c) {
    if (c->more) return;
    if (c->rounded || c->moved > 0 || c->source.job.notes.rounded) brio_conversion_lose(c, "precision");
    if (c->dulled) brio_conversion_lose(c, "colour depth");
    if (c->source.torn) brio_conversion_lose(c, "faces of dropped points");
    for (size_t i = 0; i < c->source.job.num_left_out; i++) brio_conversion_lose(c, c->source.job.left_out[i]);
}

/* --- passes --- */

/* Ends a pass at once if the depth of colours shows only in all blocks, which can be read again. */
static brio_status refuse_open(brio_conversion *c, const brio_mesh *block) {
    c->open =
        !c->source.job.mesh && brio_source_rereadable(c->source.path) && brio_row_writer_is_open(&c->writer, block);
    return c->open ? BRIO_ERR_CANCELLED : BRIO_OK;
}

static brio_status look(void *user, const brio_mesh *block) {
    brio_conversion *c = user;
    brio_row_writer_look(&c->writer, block);
    return BRIO_OK;
}

brio_status brio_conversion_survey(void *user, const brio_mesh *block) {
    brio_conversion *c = user;
    brio_status status = refuse_open(c, block);
    return status == BRIO_OK ? brio_row_writer_survey(&c->writer, block) : status;
}

static brio_status count(void *user, const brio_mesh *block) {
    brio_conversion *c = user;
    c->counted += block->num_vertices;
    return BRIO_OK;
}

static brio_status write_block(void *user, const brio_mesh *block) {
    brio_conversion *c = user;
    brio_mesh shown = *block;
    BRIO_FORWARD(refuse_open(c, block));
    BRIO_FORWARD(write_crs(c, block));
    name_losses(c, block);
    find_rounding(c, block);
    if (!holds(c, BRIO_HOLDS_FACES)) shown.num_faces = 0;
    if (!holds(c, BRIO_HOLDS_TETRAHEDRA)) shown.num_tetrahedra = 0;
    /* the file announces as many points as all blocks have, if every one stays */
    if (!c->writer.begun && c->writer.job.points == BRIO_COUNT_UNKNOWN) {
        if (c->source.job.mesh)
            c->writer.job.points = block->num_vertices;
        else if (!c->options->crop && !c->source.chosen && !c->source.job.drop_invalid)
            c->writer.job.points = c->source.job.announced;
    }
    bool first = !c->writer.begun;
    BRIO_FORWARD(brio_row_writer_write(&c->writer, c->to, &shown));
    if (first) BRIO_FORWARD(name_properties(c, &shown));
    c->stats.points += block->num_vertices;
    if (c->source.job.mesh) {
        c->stats.faces = shown.num_faces;
        c->stats.tetrahedra = shown.num_tetrahedra;
        c->stats.edges = holds(c, BRIO_HOLDS_EDGES) ? shown.num_edges : 0;
    }
    return BRIO_OK;
}

/* Returns whether the output is a new file, of which the beginning can be written last. */
static bool can_patch(const char *path) {
    brio_place_facts facts;
    return brio_open_descriptor(path) < 0 && (!brio_find_facts(path, &facts) || facts.kind == BRIO_IS_FILE);
}

/* Returns whether a pass comes first because the output begins with the number of points, and its beginning cannot be
 * written last. */
static bool must_count(const brio_conversion *c) {
    return !can_patch(c->to) && c->writer.format->counts;
}

/* Goes through the points. A pass that ends at its first block because the depth of colours is open is followed by one
 * that looks at them all, and does not count. */
static brio_status go_through(brio_conversion *c, const brio_sink *sink) {
    brio_status status = brio_source_pass(&c->source, sink);
    const brio_sink looks = {look, c};
    if (!c->open) return status;
    c->open = false;
    c->source.passes--;
    BRIO_TRY(brio_source_pass(&c->source, &looks));
    brio_row_writer_end_look(&c->writer);
    BRIO_TRY(brio_source_pass(&c->source, sink));
done:
    return status;
}

/* Goes through the points before the first one is written, as often as the format needs. */
static brio_status prepare(brio_conversion *c, brio_bar bar) {
    const brio_sink surveys = {brio_conversion_survey, c}, counts = {count, c};
    brio_progress_part(c->ctx, bar, 0, 0.5);
    while (c->writer.surveys) {
        BRIO_FORWARD(go_through(c, &surveys));
        brio_row_writer_end_survey(&c->writer);
        c->writer.job.points = brio_row_writer_surveyed_points(&c->writer);
    }
    if (must_count(c)) {
        BRIO_FORWARD(brio_source_pass(&c->source, &counts));
        c->writer.job.points = c->counted;
    }
    return BRIO_OK;
}

/* Writes with the passes that the format needs. */
brio_status brio_conversion_stream(brio_conversion *c) {
    brio_status status = BRIO_OK;
    brio_bar bar = brio_progress_bar(c->ctx);
    const brio_sink sink = {write_block, c};
    const brio_write_job job = {.options = &c->write, .points = BRIO_COUNT_UNKNOWN, .expected = BRIO_NO_PROGRESS};
    BRIO_TRY(brio_row_writer_new(&c->writer, c->ctx, c->format, &job));
    c->writer.colours = c->colours;
    if (c->all.format) BRIO_TRY(brio_row_writer_share(&c->writer, &c->all));
    if (c->source.rows) c->writer.job.points = c->source.num_rows;
    bool prepared = c->writer.surveys || must_count(c);
    if (prepared) BRIO_TRY(prepare(c, bar));
    brio_progress_part(c->ctx, bar, prepared ? 0.5 : 0, 1);
    BRIO_TRY(go_through(c, &sink));
    if (prepared && c->writer.job.points != c->writer.points) BRIO_TRY(brio_source_changed(&c->source));
    c->rounded |= c->writer.format->rounds && c->writer.format->rounds(c->writer.state);
    name_rest(c);
    brio_mesh last = {.num_vertices = 0};
    if (c->source.job.mesh) last = *c->source.job.mesh;
    if (!holds(c, BRIO_HOLDS_FACES)) last.num_faces = 0;
    if (!holds(c, BRIO_HOLDS_TETRAHEDRA)) last.num_tetrahedra = 0;
    BRIO_TRY(brio_row_writer_end(&c->writer, &last));
done:
    brio_progress_part(c->ctx, bar, 0, 1);
    c->colours = c->writer.colours;
    brio_row_writer_free(&c->writer);
    c->writer = (brio_row_writer){.ctx = c->ctx};
    return status;
}

brio_status brio_conversion_write(void *user, const brio_mesh *mesh) {
    brio_conversion *c = user;
    brio_mesh shown = *mesh;
    double moved = 0;
    brio_write_options o = c->write;
    o.format = c->format;
    o.moved = &moved;
    BRIO_FORWARD(write_crs(c, mesh));
    name_losses(c, mesh);
    find_rounding(c, mesh);
    if (!holds(c, BRIO_HOLDS_FACES)) shown.num_faces = 0;
    if (!holds(c, BRIO_HOLDS_TETRAHEDRA)) shown.num_tetrahedra = 0;
    if (!holds(c, BRIO_HOLDS_EDGES)) shown.num_edges = 0;
    c->stats.points += shown.num_vertices;
    c->stats.faces = shown.num_faces;
    c->stats.tetrahedra = shown.num_tetrahedra;
    c->stats.edges = shown.num_edges;
    BRIO_FORWARD(brio_write_with_colours(c->ctx, c->to, &shown, &o, &c->colours));
    c->moved = fmax(c->moved, moved);
    name_rest(c);
    return BRIO_OK;
}

/* --- the whole --- */

/* Returns whether input and output are one file, or one FIFO, from which the conversion would wait for what it
 * writes. */
static bool is_one_file(const brio_conversion *c) {
    brio_place_facts a, b;
    bool standard = !strcmp(c->source.path, "-");
    bool from = standard ? brio_find_facts_open(BRIO_INPUT, &a) : brio_find_facts(c->source.path, &a);
    bool to = strcmp(c->to, "-") ? brio_find_facts(c->to, &b) : brio_find_facts_open(BRIO_OUTPUT, &b);
    if (!from || !to || !brio_is_same_file(&a, &b)) return false;
    return a.kind == BRIO_IS_PIPE || (a.kind == BRIO_IS_FILE && !standard);
}

static brio_status check(brio_conversion *c) {
    const brio_convert_options *o = c->options;
    const char *from = c->source.path;
    BRIO_EXPECT(c->ctx, o->thin >= 0 && isfinite(o->thin), BRIO_ERR_ARGUMENT, "a spacing of %g, expected 0 or more",
                o->thin);
    BRIO_EXPECT(c->ctx, o->drop_outliers >= 0, BRIO_ERR_ARGUMENT, "outliers by %d neighbours", o->drop_outliers);
    for (int k = 0; k < 3 && o->crop; k++)
        BRIO_EXPECT(c->ctx, o->box[k] <= o->box[k + 3], BRIO_ERR_ARGUMENT, "a box from %g to %g along %c", o->box[k],
                    o->box[k + 3], "xyz"[k]);
    BRIO_EXPECT(c->ctx, o->tiles <= BRIO_MOST_TILES, BRIO_ERR_ARGUMENT, "%u tiles; at most %d", o->tiles,
                BRIO_MOST_TILES);
    BRIO_EXPECT(c->ctx, !o->tiles || o->scratch, BRIO_ERR_ARGUMENT, "tiles need a scratch folder");
    BRIO_EXPECT(c->ctx, !o->tiles || strchr(c->to, '#'), BRIO_ERR_ARGUMENT,
                "%s: files of tiles need a # in their name, where their number is to be", c->to);
    BRIO_EXPECT(c->ctx, o->tiles || !o->num_more, BRIO_ERR_ARGUMENT, "several inputs are for tiles");
    BRIO_EXPECT(c->ctx, !o->tiles || !o->merge, BRIO_ERR_ARGUMENT,
                "vertices are merged with all of them in memory, so not into tiles");
    BRIO_EXPECT(c->ctx, !is_one_file(c), BRIO_ERR_ARGUMENT, "%s and %s are the same file", from, c->to);
    return BRIO_OK;
}

static brio_status ignore(void *user, const brio_mesh *mesh) {
    (void)user, (void)mesh;
    return BRIO_OK;
}

/* Merges the vertices that stay, which are in memory afterwards. */
static brio_status merge(brio_conversion *c) {
    const brio_sink none = {ignore, NULL};
    brio_merge_stats found = {.size = sizeof found};
    if (!c->source.job.mesh) BRIO_FORWARD(brio_source_pass(&c->source, &none));
    BRIO_FORWARD(brio_mesh_merge_vertices(c->source.job.mesh, c->options->merge_distance, &found));
    c->stats.merged = found.vertices;
    c->stats.degenerate = found.faces + found.tetrahedra + found.edges;
    return BRIO_OK;
}

static brio_status run(brio_conversion *c) {
    brio_status status = BRIO_OK;
    const brio_sink whole = {brio_conversion_write, c};
    const brio_bar bar = brio_progress_bar(c->ctx);
    bool choose = c->options->drop_outliers || c->options->thin > 0;
    const brio_row_format *format = brio_row_format_of(c->format);
    bool once = !choose && !(format && format->survey) && (can_patch(c->to) || (format && !format->counts));
    c->source.whole = !format || c->options->merge || (!brio_source_rereadable(c->source.path) && !once);
    double started = brio_seconds();
    brio_progress_part(c->ctx, bar, 0, 0.6);
    if (choose) BRIO_TRY(brio_source_choose(&c->source));
    if (c->options->merge) BRIO_TRY(merge(c));
    brio_progress_part(c->ctx, bar, choose || c->options->merge ? 0.6 : 0, 1);
    c->stats.select_seconds = brio_seconds() - started;
    status = format ? brio_conversion_stream(c) : brio_source_pass(&c->source, &whole);
done:
    brio_progress_part(c->ctx, bar, 0, 1);
    return status;
}

brio_status brio_convert(brio_context *ctx, const char *from, const char *to, const brio_convert_options *options,
                         brio_convert_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_convert_options o = {0};
    brio_conversion c = {.ctx = ctx, .to = to, .options = &o, .stats = {.size = sizeof c.stats}};
    c.rows = (brio_rows){.ctx = ctx, .file = -1};
    c.source = (brio_source){.ctx = ctx, .path = from, .options = &o};
    c.writer = (brio_row_writer){.ctx = ctx};
    c.crs = (brio_output){.ctx = ctx, .target.folder = -1, .file = -1};
    double started = brio_seconds();
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_convert_stats, stats));
    BRIO_TRY(BRIO_TAKE(ctx, brio_convert_options, options, &o));
    BRIO_TRY(check(&c));
    brio_read_options read = {0};
    if (o.from) BRIO_TRY(BRIO_TAKE(ctx, brio_read_options, o.from, &read));
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_read_notes, read.notes));
    if (o.to) BRIO_TRY(BRIO_TAKE(ctx, brio_write_options, o.to, &c.write));
    double *moved = c.write.moved;
    c.write.moved = &c.moved;
    int *rounded = c.write.colours_rounded;
    c.write.colours_rounded = &c.dulled;
    c.format = c.write.format == BRIO_FORMAT_AUTO && strcmp(to, "-") ? brio_format_of(to) : c.write.format;
    BRIO_TRY(brio_check_written(ctx, to, c.format));
    BRIO_TRY(brio_check_compress(ctx, to, c.format, &c.write));
    c.source.job = (brio_read_job){.path = from,
                                   .format = read.format,
                                   .columns = read.columns,
                                   .flat = read.flat,
                                   .drop_invalid = read.drop_invalid,
                                   .salvage = read.salvage,
                                   .scans = brio_format_row_of(c.format)->scans,
                                   .announced = BRIO_COUNT_UNKNOWN};
    c.colours = brio_format_colours(c.format);
    BRIO_TRY(o.tiles ? brio_conversion_tiles(&c) : run(&c));
    if (rounded) *rounded = c.dulled;
    if (moved) *moved = c.moved;
    if (c.crs.name) BRIO_TRY(brio_output_publish(&c.crs));
    c.stats.streamed = c.source.job.streamed;
    c.stats.points_read = c.source.points_read;
    if (read.dropped) *read.dropped = c.source.job.dropped;
    if (read.missing) *read.missing = c.source.job.missing;
    c.stats.outliers = c.source.outliers;
    c.stats.thinned = c.source.thinned;
    c.stats.passes = c.source.passes;
    c.stats.seconds = brio_seconds() - started;
    BRIO_GIVE(brio_read_notes, read.notes, &c.source.job.notes);
    BRIO_GIVE(brio_convert_stats, stats, &c.stats);
done:
    if (c.crs.name) brio_output_close(&c.crs);
    brio_row_writer_free(&c.writer);
    brio_row_writer_free(&c.all);
    brio_rows_free(&c.rows);
    brio_release(ctx, c.named);
    brio_source_free(&c.source);
    return status;
}
