/* The least alpha whose shape is one solid with all vertices.
 *
 * Adds the tetrahedra, or in the plane the triangles, by ascending value and joins them across facets in a union-find.
 * Looks, where the value rises, at the number of sets and of vertices met so far. Rounding keeps the order of values,
 * but those beyond the normal doubles become equal. An alpha there is refused: its shape would change with the unit of
 * the points.
 *
 * Based on: Edelsbrunner, Muecke. Three-dimensional alpha shapes. TOG 1994. */
#include "alpha/alpha_complex.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/sort.h"
#include "base/union_find.h"
#include <math.h>

typedef struct {
    const uint32_t *numbers;
    size_t corners;
    const double *value;
    size_t num_finite;
    uint32_t *set;  /* #cells */
    uint8_t *added; /* #cells, then #P: whether a cell or a vertex was met */
    size_t sets, vertices;
} growth;

static void add(growth *g, uint32_t cell) {
    const uint32_t *vertex = g->numbers + 2 * g->corners * cell, *mate = vertex + g->corners;
    uint8_t *met = g->added + g->num_finite;
    g->added[cell] = 1;
    g->sets++;
    for (size_t i = 0; i < g->corners; i++) {
        uint32_t other = mate[i] >> 2;
        if (!met[vertex[i]]) g->vertices++;
        met[vertex[i]] = 1;
        if (other >= g->num_finite || !g->added[other]) continue;
        if (brio_find(g->set, cell) == brio_find(g->set, other)) continue;
        brio_unite(g->set, cell, other, true);
        g->sets--;
    }
}

static int by_index(uint32_t a, uint32_t b, const void *user) {
    (void)user;
    return (a > b) - (a < b);
}

brio_status brio_alpha_auto_of(brio_context *ctx, const brio_alpha_complex *complex, const brio_alpha_cells *cells,
                               double *alpha) {
    brio_status status = BRIO_OK;
    size_t n = complex->counts[cells->corners - 1];
    growth g = {.numbers = cells->numbers,
                .corners = cells->corners,
                .value = complex->values[cells->corners - 1],
                .num_finite = n};
    uint32_t *order = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, order, n));
    BRIO_TRY(BRIO_ALLOC(ctx, g.set, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, g.added, n + cells->num_points));
    for (uint32_t i = 0; i < n; i++) order[i] = g.set[i] = i;
    BRIO_TRY(brio_sort_rows(ctx, &(brio_row_order){g.value, 1, by_index, NULL}, order, n));
    for (size_t i = 0; i < n; i++) {
        BRIO_TRY(brio_look(ctx, 4));
        add(&g, order[i]);
        *alpha = g.value[order[i]];
        bool rises = i + 1 == n || g.value[order[i + 1]] > *alpha;
        if (rises && g.sets == 1 && g.vertices == complex->counts[0]) break;
    }
    BRIO_REQUIRE(ctx, *alpha < INFINITY, BRIO_BECAUSE(ctx, SCALE, BRIO_ERR_NO_ANSWER),
                 "the squared radii of one solid are beyond doubles: scale the points down");
    BRIO_TRY(brio_refuse_small_alpha(ctx, brio_greatest(complex->values[0], complex->counts[0]), *alpha));
done:
    brio_release(ctx, order);
    brio_release(ctx, g.set);
    brio_release(ctx, g.added);
    return status;
}

brio_status brio_alpha_auto(brio_context *ctx, const brio_alpha_complex *complex, double *alpha) {
    BRIO_DOOR;
    brio_alpha_cells cells = {.corners = 4};
    if (complex->triangulation) {
        cells.numbers = (const uint32_t *)brio_triangulation_tetrahedra(complex->triangulation);
        cells.num_points = brio_triangulation_stats(complex->triangulation)->points;
    } else {
        BRIO_EXPECT(ctx, complex->triangulation2, BRIO_ERR_ARGUMENT,
                    "the complex is of space that repeats: brio_periodic_alpha_auto takes it");
        cells.corners = 3;
        cells.numbers = (const uint32_t *)brio_triangulation2_triangles(complex->triangulation2);
        cells.num_points = brio_triangulation2_stats(complex->triangulation2)->points;
    }
    return brio_alpha_auto_of(ctx, complex, &cells, alpha);
}
