/* Flat tetrahedra within the surface.
 *
 * Four neighbouring samples of a surface often make a flat tetrahedron that lies within it, all of whose facets are
 * candidates: two of them are one way to cover the quadrilateral of the samples, two the other. Both are manifolds of
 * candidates, so any choice keeps the guarantee; that of less area is nearer to a smooth surface and has the steadier
 * normals (on knot2, by 1 % of the distance to the true surface).
 *
 * Works in rounds: a tetrahedron changes sides when its gain is larger than that of every neighbour. So within a round
 * no change touches another and the order of the tetrahedra is of no importance. */
#include "reconstruct/cocone/flat_tetrahedra.h"
#include "base/memory.h"
#include "reconstruct/cocone/label_boundary.h"
#include "reconstruct/cocone/triangle.h"

enum { ROUNDS = 4 };

/* Far above rounding: what is equal but for rounding counts as equal. */
static const double SIGNIFICANT = 1e-9;

typedef struct {
    const brio_tet_labels *labels;
    const brio_tetrahedra *t;
    uint32_t *tet; /* the tetrahedra that may change, ascending */
    size_t count;
    double *gain;   /* of each of these: the area that its change saves; 0 where it may not change */
    size_t *change; /* those that change in this round */
} flattening;

static double area(const flattening *x, uint32_t facet) {
    const uint32_t *v = x->t->tet[brio_tet_of(facet)].vertex;
    const double *corner[3];
    for (int k = 0; k < 3; k++)
        corner[k] = x->labels->cocones->dual->points + 3 * (size_t)v[BRIO_FACET[brio_slot_of(facet)][k]];
    return brio_triangle_area(corner[0], corner[1], corner[2]);
}

/* Whether one pair of candidates gives way to another when a tetrahedron changes sides. */
static bool may_change(const flattening *x, uint32_t tet) {
    int leaving = 0;
    for (int i = 0; i < 4; i++) {
        bool leaves = brio_is_boundary(x->labels, brio_facet_of(tet, i));
        if (!leaves && !brio_is_candidate(x->labels->cocones, brio_facet_of(tet, i))) return false;
        leaving += leaves;
    }
    return leaving == 2;
}

/* The area that is saved when a tetrahedron changes sides; 0 for one that may not. */
static double gain_of(const flattening *x, uint32_t tet) {
    double saved = 0, all = 0;
    if (!may_change(x, tet)) return 0;
    for (int i = 0; i < 4; i++) {
        double size = area(x, brio_facet_of(tet, i));
        saved += brio_is_boundary(x->labels, brio_facet_of(tet, i)) ? size : -size;
        all += size;
    }
    return saved > SIGNIFICANT * all ? saved : 0;
}

/* The place of a tetrahedron among those that may change; x->count when it is none of them. */
static size_t place_of(const flattening *x, uint32_t tet) {
    size_t low = 0, high = x->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (x->tet[middle] < tet)
            low = middle + 1;
        else
            high = middle;
    }
    return low < x->count && x->tet[low] == tet ? low : x->count;
}

static bool is_best(const flattening *x, size_t n) {
    bool best = x->gain[n] > 0;
    for (int i = 0; i < 4 && best; i++) {
        size_t other = place_of(x, brio_tet_of(x->t->tet[x->tet[n]].mate[i]));
        best = other == x->count || x->gain[n] > (1 + SIGNIFICANT) * x->gain[other];
    }
    return best;
}

static brio_status collect(brio_context *ctx, flattening *x) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(ctx, x->tet, x->labels->num_undecided));
    for (size_t n = 0; n < x->labels->num_undecided; n++) {
        uint32_t tet = x->labels->undecided[n];
        bool finite = tet < x->labels->cocones->dual->num_finite;
        if (finite && x->labels->cocones->candidates[tet]) x->tet[x->count++] = tet;
    }
done:
    return status;
}

/* Finds the gains of a tetrahedron and its neighbours anew. */
static void update_gains(const flattening *x, size_t n) {
    x->gain[n] = gain_of(x, x->tet[n]);
    for (int i = 0; i < 4; i++) {
        uint32_t tet = brio_tet_of(x->t->tet[x->tet[n]].mate[i]);
        size_t other = place_of(x, tet);
        if (other < x->count) x->gain[other] = gain_of(x, tet);
    }
}

/* One round; the number of changes. */
static size_t change_best(flattening *x) {
    size_t changes = 0;
    for (size_t n = 0; n < x->count; n++)
        if (is_best(x, n)) x->change[changes++] = n;
    for (size_t i = 0; i < changes; i++) {
        uint8_t *label = &x->labels->label[x->tet[x->change[i]]];
        *label = *label == BRIO_LABEL_OUTER ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    }
    for (size_t i = 0; i < changes; i++) update_gains(x, x->change[i]);
    return changes;
}

brio_status brio_flatten(brio_context *ctx, const brio_tet_labels *l) {
    brio_status status = BRIO_OK;
    flattening x = {.labels = l, .t = &l->cocones->dual->t};
    BRIO_TRY(collect(ctx, &x));
    BRIO_TRY(BRIO_ALLOC(ctx, x.gain, x.count));
    BRIO_TRY(BRIO_ALLOC(ctx, x.change, x.count));
    for (size_t n = 0; n < x.count; n++) x.gain[n] = gain_of(&x, x.tet[n]);
    for (int round = 0; round < ROUNDS; round++)
        if (change_best(&x) == 0) break;
done:
    brio_release(ctx, x.tet);
    brio_release(ctx, x.gain);
    brio_release(ctx, x.change);
    return status;
}
