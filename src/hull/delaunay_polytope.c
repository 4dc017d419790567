/* The convex hull as the infinite tetrahedra of a Delaunay triangulation. It needs no point inside the hull, so it also
 * serves hulls so flat that doubles hold none. */
#include "base/memory.h"
#include "hull/polytope.h"
#include <assert.h>

/* Makes triangle abc of each infinite tetrahedron (a, b, c, infinite); its mate across edge i, opposite to vertex i, is
 * the mate of facet i, which is a handle of an infinite tetrahedron, too. */
static void take_triangles(const brio_triangulation *t, brio_polytope *out) {
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    size_t finite = brio_triangulation_stats(t)->tetrahedra;
    for (size_t f = 0; f < out->count; f++)
        for (int i = 0; i < 3; i++) {
            assert(tet[finite + f].vertex[3] == BRIO_INFINITE && tet[finite + f].mate[i] >> 2 >= finite);
            out->triangle[f].vertex[i] = tet[finite + f].vertex[i];
            out->triangle[f].mate[i] = tet[finite + f].mate[i] - 4 * (uint32_t)finite;
        }
}

/* Finds the lowest record at each vertex, among those that it represents; there are no hidden points. */
static void name_lowest(const brio_triangulation *t, const brio_hull_records *records, uint32_t *same) {
    const uint32_t *vertex = brio_triangulation_representatives(t);
    for (uint32_t r = 0; r < records->count; r++) same[r] = r;
    for (uint32_t r = 0; r < records->count; r++)
        if (records->index[r] < records->index[same[vertex[r]]]) same[vertex[r]] = r;
}

brio_status brio_polytope_by_delaunay(brio_context *ctx, const brio_hull_records *records, brio_polytope *out) {
    brio_status status = BRIO_OK;
    size_t n = records->count;
    brio_triangulation *t = NULL;
    double *points = NULL;
    *out = (brio_polytope){0};
    BRIO_TRY(BRIO_ALLOC(ctx, points, 3 * n));
    for (size_t i = 0; i < 3 * n; i++) points[i] = records->record[i / 3][i % 3];
    BRIO_TRY(brio_delaunay(ctx, points, NULL, n, NULL, &t));
    out->count = out->capacity = brio_triangulation_stats(t)->hull_facets;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->triangle, out->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->same, n));
    take_triangles(t, out);
    name_lowest(t, records, out->same);
done:
    if (status != BRIO_OK) brio_polytope_free(ctx, out);
    brio_triangulation_free(t);
    brio_release(ctx, points);
    return status;
}
