/* Explanations: their arrays, which grow sample by sample. See include/brio/explanation.h. */
#include "reconstruct/explanation/explanation.h"
#include "base/memory.h"
#include <math.h>

void brio_explanation_free(brio_explanation *e) {
    if (!e) return;
    void *const arrays[] = {e->point,
                            e->place,
                            e->axis,
                            e->pole,
                            e->pole_side,
                            e->vertex_offsets,
                            e->vertices,
                            e->vertex_point,
                            e->tetrahedra,
                            e->tetrahedron_offsets,
                            e->tetrahedron_side,
                            e->tetrahedron_confidence,
                            e->tetrahedron_taken,
                            e->polygon_offsets,
                            e->polygon_kind,
                            e->corner_offsets,
                            e->corners};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) brio_release(e->context, arrays[i]);
    brio_release(e->context, e);
}

brio_status brio_explain_vertex(brio_explaining *x, const double place[3], uint32_t point) {
    brio_explanation *e = x->e;
    BRIO_EXPECT(x->ctx, x->vertices < UINT32_MAX, BRIO_ERR_TOO_LARGE,
                "an explanation of more than 2^32 vertices: explain fewer samples");
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, e->vertices, x->vertex_room, 3 * x->vertices + 3));
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, e->vertex_point, x->point_room, x->vertices + 1));
    for (size_t k = 0; k < 3; k++) e->vertices[3 * x->vertices + k] = ldexp(place[k], x->exponent);
    e->vertex_point[x->vertices++] = point;
    return BRIO_OK;
}

brio_status brio_explain_corner(brio_explaining *x, size_t v) {
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, x->e->corners, x->corner_room, x->corners + 1));
    x->e->corners[x->corners++] = (uint32_t)v;
    return BRIO_OK;
}

brio_status brio_explain_polygon(brio_explaining *x, brio_explained_polygon kind) {
    brio_explanation *e = x->e;
    size_t first = (size_t)e->corner_offsets[x->polygons];
    if (x->corners < first + 3) {
        x->corners = first;
        return BRIO_OK;
    }
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, e->polygon_kind, x->polygon_room[0], x->polygons + 1));
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, e->corner_offsets, x->polygon_room[1], x->polygons + 2));
    e->polygon_kind[x->polygons++] = (uint8_t)kind;
    e->corner_offsets[x->polygons] = x->corners;
    return BRIO_OK;
}
