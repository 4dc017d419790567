/* The least alpha whose shape is one solid with all vertices.
 *
 * Adds the tetrahedra by ascending value and joins them across facets in a union-find. Looks, where the value rises, at
 * the number of sets and of vertices met so far.
 *
 * Based on: Edelsbrunner, Muecke. Three-dimensional alpha shapes. TOG 1994. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/union_find.h"
#include "triangulation/view.h"

typedef struct {
    const brio_tetrahedra *t;
    const double *value;
    size_t num_finite;
    uint32_t *set;  /* #T */
    uint8_t *added; /* #T, then #P: whether a tetrahedron or a vertex was met */
    size_t sets, vertices;
} growth;

static void add(growth *g, uint32_t tet) {
    const brio_tetrahedron *own = &g->t->tet[tet];
    uint8_t *met = g->added + g->num_finite;
    g->added[tet] = 1;
    g->sets++;
    for (int i = 0; i < 4; i++) {
        uint32_t other = brio_tet_of(own->mate[i]);
        if (!met[own->vertex[i]]) g->vertices++;
        met[own->vertex[i]] = 1;
        if (other >= g->num_finite || !g->added[other]) continue;
        if (brio_find(g->set, tet) == brio_find(g->set, other)) continue;
        brio_unite(g->set, tet, other, true);
        g->sets--;
    }
}

static int by_index(uint32_t a, uint32_t b, const void *user) {
    (void)user;
    return (a > b) - (a < b);
}

brio_status brio_alpha_auto(brio_context *ctx, const brio_alpha_complex *complex, double *alpha) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    const brio_tetrahedra tets = brio_tetrahedra_of(complex->triangulation);
    size_t n = complex->counts[3], points = brio_triangulation_stats(complex->triangulation)->points;
    growth g = {&tets, complex->values[3], n, NULL, NULL, 0, 0};
    uint32_t *order = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, order, n));
    BRIO_TRY(BRIO_ALLOC(ctx, g.set, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, g.added, n + points));
    for (uint32_t i = 0; i < n; i++) order[i] = g.set[i] = i;
    BRIO_TRY(brio_sort_rows(ctx, &(brio_row_order){g.value, 1, by_index, NULL}, order, n));
    for (size_t i = 0; i < n; i++) {
        add(&g, order[i]);
        *alpha = g.value[order[i]];
        bool rises = i + 1 == n || g.value[order[i + 1]] > *alpha;
        if (rises && g.sets == 1 && g.vertices == complex->counts[0]) break;
    }
done:
    brio_release(ctx, order);
    brio_release(ctx, g.set);
    brio_release(ctx, g.added);
    return status;
}
