/* Writes points and tetrahedra part by part, for meshes that are in no memory as a whole: see brio/files.h. A format
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
    uint64_t num_vertices, num_tetrahedra; /* announced */
    uint64_t vertices, tetrahedra;         /* written */
    bool looks;                            /* blocks were looked at */
};

static brio_status check(brio_context *ctx, const char *path, const brio_write_options *o, brio_format format,
                         uint64_t num_vertices, uint64_t num_tetrahedra) {
    char others[BRIO_FORMAT_LIST];
    BRIO_FORWARD(brio_check_written(ctx, path, format));
    brio_format_list(1, BRIO_HOLDS_PARTS, others, sizeof others);
    BRIO_EXPECT(ctx, brio_format_holds(format, BRIO_HOLDS_PARTS), BRIO_ERR_ARGUMENT,
                "%s: points and tetrahedra are written part by part to %s only", path, others);
    BRIO_FORWARD(brio_check_compress(ctx, path, format, o));
    BRIO_EXPECT(ctx, num_vertices <= UINT32_MAX, BRIO_ERR_TOO_LARGE,
                "%s: %" PRIu64 " points; indices of this format reach 2^32 - 1", path, num_vertices);
    BRIO_EXPECT(ctx, num_tetrahedra <= SIZE_MAX / 4, BRIO_ERR_TOO_LARGE, "%s: %" PRIu64 " tetrahedra", path,
                num_tetrahedra);
    return BRIO_OK;
}

brio_status brio_mesh_parts_new(brio_context *ctx, const char *path, const brio_write_options *options,
                                uint64_t num_vertices, uint64_t num_tetrahedra, brio_mesh_parts **out) {
    BRIO_DOOR;
    brio_mesh_parts *p = NULL;
    brio_write_options o = {0};
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_TAKE(ctx, brio_write_options, options, &o));
    brio_format format = o.format == BRIO_FORMAT_AUTO && strcmp(path, "-") ? brio_format_of(path) : o.format;
    BRIO_TRY(check(ctx, path, &o, format, num_vertices, num_tetrahedra));
    if (o.moved) *o.moved = 0;
    if (o.colours_rounded) *o.colours_rounded = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, p, 1));
    *p = (brio_mesh_parts){
        .ctx = ctx, .options = o, .num_vertices = num_vertices, .num_tetrahedra = num_tetrahedra, .writer.ctx = ctx};
    BRIO_TRY(BRIO_ALLOC(ctx, p->path, strlen(path) + 1));
    strcpy(p->path, path);
    const brio_write_job job = {.options = &p->options, .points = num_vertices, .expected = BRIO_NO_PROGRESS};
    BRIO_TRY(brio_row_writer_new(&p->writer, ctx, format, &job));
    *out = p;
    p = NULL;
done:
    brio_mesh_parts_free(p);
    return status;
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
    BRIO_EXPECT(ctx, !p->tetrahedra, BRIO_ERR_ARGUMENT, "%s: tetrahedra are behind all points", p->path);
    BRIO_EXPECT(ctx, block->num_vertices <= p->num_vertices - p->vertices, BRIO_ERR_ARGUMENT,
                "%s: more points than the %" PRIu64 " that were announced", p->path, p->num_vertices);
    BRIO_FORWARD(brio_refuse_not_finite(ctx, block->vertices, NULL, block->num_vertices, p->path));
    if (p->looks) brio_row_writer_end_look(&p->writer);
    shown.num_faces = shown.num_edges = 0;
    shown.num_tetrahedra = (size_t)p->num_tetrahedra; /* which the head announces */
    shown.tetrahedra = NULL;
    BRIO_FORWARD(brio_row_writer_write(&p->writer, p->path, &shown));
    p->vertices += block->num_vertices;
    return BRIO_OK;
}

brio_status brio_mesh_parts_tetrahedra(brio_context *ctx, brio_mesh_parts *p, const uint32_t *tetrahedra,
                                       size_t count) {
    BRIO_DOOR;
    BRIO_EXPECT(ctx, p->vertices == p->num_vertices && p->writer.begun, BRIO_ERR_ARGUMENT,
                "%s: tetrahedra come behind all %" PRIu64 " points", p->path, p->num_vertices);
    BRIO_EXPECT(ctx, count <= p->num_tetrahedra - p->tetrahedra, BRIO_ERR_ARGUMENT,
                "%s: more tetrahedra than the %" PRIu64 " that were announced", p->path, p->num_tetrahedra);
    for (size_t i = 0; i < 4 * count; i++)
        BRIO_EXPECT(ctx, tetrahedra[i] < p->num_vertices, BRIO_ERR_ARGUMENT,
                    "tetrahedron %" PRIu64 " has vertex %u of %" PRIu64, p->tetrahedra + i / 4, tetrahedra[i],
                    p->num_vertices);
    const brio_mesh part = {.context = ctx, .num_tetrahedra = count, .tetrahedra = (uint32_t *)tetrahedra};
    BRIO_FORWARD(brio_row_writer_cells(&p->writer, &part));
    p->tetrahedra += count;
    return BRIO_OK;
}

brio_status brio_mesh_parts_finish(brio_context *ctx, brio_mesh_parts *p) {
    BRIO_DOOR;
    const brio_mesh nothing = {.context = ctx};
    if (!p->num_vertices && !p->writer.begun) BRIO_FORWARD(brio_mesh_parts_vertices(ctx, p, &nothing));
    BRIO_EXPECT(ctx, p->vertices == p->num_vertices && p->tetrahedra == p->num_tetrahedra, BRIO_ERR_ARGUMENT,
                "%s: %" PRIu64 " points and %" PRIu64 " tetrahedra; %" PRIu64 " and %" PRIu64 " were announced",
                p->path, p->vertices, p->tetrahedra, p->num_vertices, p->num_tetrahedra);
    return brio_row_writer_end(&p->writer, &nothing);
}

void brio_mesh_parts_free(brio_mesh_parts *p) {
    if (!p) return;
    brio_row_writer_free(&p->writer);
    brio_release(p->ctx, p->path);
    brio_release(p->ctx, p);
}
