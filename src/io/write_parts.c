/* Writes points and tetrahedra, or triangles, part by part, for meshes in no memory as a whole: brio/files.h. A format
 * with BRIO_HOLDS_PARTS is one of rows (row_format.h) with tetrahedra behind its points. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "io/row_format.h"
#include <inttypes.h>
#include <string.h>

struct brio_mesh_parts {
    brio_context *ctx;
    char *path;
    brio_write_options options;
    brio_row_writer writer;
    uint64_t num_vertices, num_cells; /* announced */
    uint64_t vertices, cells;         /* written */
    bool of_faces;                    /* cells are triangles, not tetrahedra */
    bool looks;                       /* blocks were looked at */
};

static const char *name_of(bool of_faces) {
    return of_faces ? "triangles" : "tetrahedra";
}

/* What is announced of a file. */
typedef struct {
    uint64_t num_vertices, num_cells;
    bool of_faces;
} announced;

static brio_status check(brio_context *ctx, const char *path, const brio_write_options *o, brio_format format,
                         const announced *a) {
    char others[BRIO_FORMAT_LIST];
    BRIO_FORWARD(brio_check_written(ctx, path, format));
    brio_format_list(1, BRIO_HOLDS_PARTS, others, sizeof others);
    BRIO_EXPECT(ctx, brio_format_holds(format, BRIO_HOLDS_PARTS), BRIO_ERR_ARGUMENT,
                "%s: points and %s are written part by part to %s only", path, name_of(a->of_faces), others);
    BRIO_FORWARD(brio_check_compress(ctx, path, format, o));
    BRIO_EXPECT(ctx, a->num_vertices <= UINT32_MAX, BRIO_ERR_TOO_LARGE,
                "%s: %" PRIu64 " points; indices of this format reach 2^32 - 1", path, a->num_vertices);
    BRIO_EXPECT(ctx, a->num_cells <= SIZE_MAX / 4, BRIO_ERR_TOO_LARGE, "%s: %" PRIu64 " %s", path, a->num_cells,
                name_of(a->of_faces));
    return BRIO_OK;
}

static brio_status begin(brio_context *ctx, const char *path, const brio_write_options *options, const announced *a,
                         brio_mesh_parts **out) {
    brio_mesh_parts *p = NULL;
    brio_write_options o = {0};
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_TAKE(ctx, brio_write_options, options, &o));
    brio_format format = o.format == BRIO_FORMAT_AUTO && strcmp(path, "-") ? brio_format_of(path) : o.format;
    BRIO_TRY(check(ctx, path, &o, format, a));
    if (o.moved) *o.moved = 0;
    if (o.colours_rounded) *o.colours_rounded = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, p, 1));
    *p = (brio_mesh_parts){.ctx = ctx, .options = o, .writer.ctx = ctx};
    p->num_vertices = a->num_vertices, p->num_cells = a->num_cells, p->of_faces = a->of_faces;
    BRIO_TRY(BRIO_ALLOC(ctx, p->path, strlen(path) + 1));
    strcpy(p->path, path);
    const brio_write_job job = {.options = &p->options, .points = a->num_vertices, .expected = BRIO_NO_PROGRESS};
    BRIO_TRY(brio_row_writer_new(&p->writer, ctx, format, &job));
    *out = p;
    p = NULL;
done:
    brio_mesh_parts_free(p);
    return status;
}

brio_status brio_mesh_parts_new(brio_context *ctx, const char *path, const brio_write_options *options,
                                uint64_t num_vertices, uint64_t num_tetrahedra, brio_mesh_parts **out) {
    BRIO_DOOR;
    return begin(ctx, path, options, &(announced){num_vertices, num_tetrahedra, false}, out);
}

brio_status brio_mesh_parts_new_faces(brio_context *ctx, const char *path, const brio_write_options *options,
                                      uint64_t num_vertices, uint64_t num_faces, brio_mesh_parts **out) {
    BRIO_DOOR;
    return begin(ctx, path, options, &(announced){num_vertices, num_faces, true}, out);
}

int brio_mesh_parts_look(brio_mesh_parts *p, const brio_mesh *block) {
    BRIO_DOOR;
    if (p->writer.begun || !brio_row_writer_is_open(&p->writer, block)) return 0;
    brio_row_writer_look(&p->writer, block);
    p->looks = true;
    return 1;
}

brio_status brio_mesh_parts_vertices(brio_context *ctx, brio_mesh_parts *p, const brio_mesh *block) {
    BRIO_DOOR;
    brio_mesh shown = *block;
    BRIO_EXPECT(ctx, !p->cells, BRIO_ERR_ARGUMENT, "%s: %s are behind all points", p->path, name_of(p->of_faces));
    BRIO_EXPECT(ctx, block->num_vertices <= p->num_vertices - p->vertices, BRIO_ERR_ARGUMENT,
                "%s: more points than the %" PRIu64 " that were announced", p->path, p->num_vertices);
    BRIO_FORWARD(brio_refuse_not_finite(ctx, block->vertices, NULL, block->num_vertices, p->path));
    if (p->looks) brio_row_writer_end_look(&p->writer);
    shown.num_faces = p->of_faces ? (size_t)p->num_cells : 0; /* which the head announces */
    shown.num_tetrahedra = p->of_faces ? 0 : (size_t)p->num_cells;
    shown.num_edges = shown.num_face_properties = 0;
    shown.tetrahedra = NULL;
    BRIO_FORWARD(brio_row_writer_write(&p->writer, p->path, &shown));
    p->vertices += block->num_vertices;
    return BRIO_OK;
}

/* Refuses cells before all points are there, more than were announced, or with points that are not there.
 * rows  count by `corners`. */
static brio_status check_cells(brio_context *ctx, const brio_mesh_parts *p, const uint32_t *rows, size_t corners,
                               size_t count) {
    const char *name = name_of(p->of_faces);
    BRIO_EXPECT(ctx, p->of_faces == (corners == 3), BRIO_ERR_ARGUMENT, "%s: %s were announced", p->path, name);
    BRIO_EXPECT(ctx, p->vertices == p->num_vertices && p->writer.begun, BRIO_ERR_ARGUMENT,
                "%s: %s come behind all %" PRIu64 " points", p->path, name, p->num_vertices);
    BRIO_EXPECT(ctx, count <= p->num_cells - p->cells, BRIO_ERR_ARGUMENT,
                "%s: more %s than the %" PRIu64 " that were announced", p->path, name, p->num_cells);
    for (size_t i = 0; i < corners * count; i++)
        BRIO_EXPECT(ctx, rows[i] < p->num_vertices, BRIO_ERR_ARGUMENT, "%s %" PRIu64 " has vertex %u of %" PRIu64,
                    p->of_faces ? "triangle" : "tetrahedron", p->cells + i / corners, rows[i], p->num_vertices);
    return BRIO_OK;
}

brio_status brio_mesh_parts_tetrahedra(brio_context *ctx, brio_mesh_parts *p, const uint32_t *tetrahedra,
                                       size_t count) {
    BRIO_DOOR;
    BRIO_FORWARD(check_cells(ctx, p, tetrahedra, 4, count));
    const brio_mesh part = {.context = ctx, .num_tetrahedra = count, .tetrahedra = (uint32_t *)tetrahedra};
    BRIO_FORWARD(brio_row_writer_cells(&p->writer, &part));
    p->cells += count;
    return BRIO_OK;
}

brio_status brio_mesh_parts_faces(brio_context *ctx, brio_mesh_parts *p, const uint32_t (*faces)[3], size_t count) {
    BRIO_DOOR;
    uint64_t *offsets;
    BRIO_FORWARD(check_cells(ctx, p, count ? *faces : NULL, 3, count));
    BRIO_FORWARD(BRIO_ALLOC(ctx, offsets, count + 1));
    for (size_t i = 0; i <= count; i++) offsets[i] = 3 * i;
    const brio_mesh part = {.context = ctx,
                            .num_faces = count,
                            .face_offsets = offsets,
                            .face_vertices = count ? (uint32_t *)*faces : NULL};
    brio_status status = brio_row_writer_cells(&p->writer, &part);
    brio_release(ctx, offsets);
    if (status == BRIO_OK) p->cells += count;
    return status;
}

brio_status brio_mesh_parts_finish(brio_context *ctx, brio_mesh_parts *p) {
    BRIO_DOOR;
    const brio_mesh nothing = {.context = ctx};
    if (!p->num_vertices && !p->writer.begun) BRIO_FORWARD(brio_mesh_parts_vertices(ctx, p, &nothing));
    BRIO_EXPECT(ctx, p->vertices == p->num_vertices && p->cells == p->num_cells, BRIO_ERR_ARGUMENT,
                "%s: %" PRIu64 " points and %" PRIu64 " %s; %" PRIu64 " and %" PRIu64 " were announced", p->path,
                p->vertices, p->cells, name_of(p->of_faces), p->num_vertices, p->num_cells);
    return brio_row_writer_end(&p->writer, &nothing);
}

void brio_mesh_parts_free(brio_mesh_parts *p) {
    if (!p) return;
    brio_row_writer_free(&p->writer);
    brio_release(p->ctx, p->path);
    brio_release(p->ctx, p);
}
