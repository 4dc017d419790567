/* The primitives of a glTF file as triangles and edges.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "io/glb/glb_mesh.h"
#include <inttypes.h>

typedef struct {
    const brio_glb_file *file;
    brio_builder *builder;
    brio_glb_column indices;
    bool indexed, flip;
    uint64_t first, count; /* vertices */
} primitive;

/* Returns corner i as a vertex of the mesh. */
static brio_status corner(const primitive *p, uint64_t i, double *vertex) {
    brio_status status = BRIO_OK;
    double index = p->indexed ? brio_glb_raw(&p->indices, i, 0) : (double)i;
    BRIO_REQUIRE(p->file->ctx, index < (double)p->count, BRIO_ERR_FORMAT,
                 "%s: index %" PRIu64 " (counted from 0) of a primitive: vertex %.17g, it has %" PRIu64, p->file->name,
                 i, index, p->count);
    *vertex = (double)p->first + index;
done:
    return status;
}

static brio_status add_triangle(const primitive *p, uint64_t a, uint64_t b, uint64_t c) {
    brio_status status = BRIO_OK;
    const uint64_t order[3] = {a, p->flip ? c : b, p->flip ? b : c};
    double vertex = 0;
    for (int i = 0; i < 3; i++) {
        BRIO_TRY(corner(p, order[i], &vertex));
        BRIO_TRY(brio_builder_corner(p->builder, vertex));
    }
    BRIO_TRY(brio_builder_face(p->builder));
done:
    return status;
}

static brio_status add_edge(const primitive *p, uint64_t a, uint64_t b) {
    brio_status status = BRIO_OK;
    double ends[2];
    BRIO_TRY(corner(p, a, &ends[0]));
    BRIO_TRY(corner(p, b, &ends[1]));
    BRIO_TRY(brio_builder_edge(p->builder, ends));
done:
    return status;
}

static brio_status add_lines(const primitive *p, brio_glb_mode mode, uint64_t n) {
    brio_status status = BRIO_OK;
    uint64_t step = mode == BRIO_GLB_LINES ? 2 : 1;
    for (uint64_t i = 0; i + 1 < n; i += step) BRIO_TRY(add_edge(p, i, i + 1));
    if (mode == BRIO_GLB_LINE_LOOP && n > 1) BRIO_TRY(add_edge(p, n - 1, 0));
done:
    return status;
}

static brio_status add_triangles(const primitive *p, brio_glb_mode mode, uint64_t n) {
    brio_status status = BRIO_OK;
    uint64_t step = mode == BRIO_GLB_TRIANGLES ? 3 : 1;
    for (uint64_t i = 0; i + 2 < n; i += step) {
        uint64_t odd = mode == BRIO_GLB_TRIANGLE_STRIP ? i % 2 : 0;
        if (mode == BRIO_GLB_TRIANGLE_FAN)
            BRIO_TRY(add_triangle(p, 0, i + 1, i + 2));
        else
            BRIO_TRY(add_triangle(p, i, i + 1 + odd, i + 2 - odd));
    }
done:
    return status;
}

brio_status brio_glb_add_cells(const brio_glb_file *file, brio_builder *b, const brio_glb_primitive *given,
                               const uint64_t vertices[2], bool flip) {
    brio_status status = BRIO_OK;
    primitive p = {.file = file, .builder = b, .flip = flip, .first = vertices[0], .count = vertices[1]};
    p.indexed = given->indices != BRIO_GLB_NONE;
    if (p.indexed) BRIO_TRY(brio_glb_column_of(file, given->indices, "indices", &p.indices));
    bool whole = !p.indexed || (p.indices.components == 1 && p.indices.type != BRIO_GLB_FLOAT);
    BRIO_REQUIRE(file->ctx, whole, BRIO_ERR_FORMAT, "%s: accessors[%u]: indices are no whole numbers", file->name,
                 given->indices);
    uint64_t n = p.indexed ? p.indices.count : p.count;
    BRIO_REQUIRE(
        file->ctx, (given->mode != BRIO_GLB_TRIANGLES || n % 3 == 0) && (given->mode != BRIO_GLB_LINES || n % 2 == 0),
        BRIO_ERR_FORMAT, "%s: a primitive of mode %d has %" PRIu64 " corners", file->name, (int)given->mode, n);
    if (given->mode == BRIO_GLB_POINTS) return BRIO_OK;
    BRIO_TRY(given->mode < BRIO_GLB_TRIANGLES ? add_lines(&p, given->mode, n) : add_triangles(&p, given->mode, n));
done:
    return status;
}
