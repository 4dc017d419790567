/* Removes candidates at sharp edges.
 *
 * Triangles of the restricted Delaunay triangulation never meet at a sharp edge. So a candidate at a sharp edge belongs
 * to a fin or to the border of one. On real data an edge with one candidate can also be the rim of a hole, and literal
 * pruning would unravel the whole surface from there. Both sides of a fin are on one side of the surface. So candidates
 * between an outer and an inner tetrahedron, by the votes of the samples, are kept.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999, for the pruning.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, appendix A, for the angle.
 * Differs from the paper: candidates that the votes of the samples support are kept. */
#include "reconstruct/cocone/cocone_prune.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "reconstruct/cocone/label_boundary.h"

/* Chosen. */
enum { CHUNK = 4096 };

typedef struct {
    brio_context *ctx;
    brio_mutex stack_lock; /* held while a thread pushes */
    brio_status status;    /* the first failure that a thread reported */
    const brio_tet_labels *labels;
    const brio_cocones *cocones;
    const brio_tetrahedra *t;
    const double *points;
    uint32_t *stack; /* candidates to test */
    size_t size, capacity;
} pruning;

/* A directed edge of a facet, from corner k to the next corner, counterclockwise as seen from the facet's
 * tetrahedron. */
typedef struct {
    uint32_t facet, from, to, apex;
} facet_edge;

static facet_edge edge_of(const pruning *x, uint32_t facet, int k) {
    const uint32_t *v = x->t->tet[brio_tet_of(facet)].vertex;
    const uint8_t *corner = BRIO_FACET[brio_slot_of(facet)];
    return (facet_edge){facet, v[corner[k]], v[corner[(k + 1) % 3]], v[corner[(k + 2) % 3]]};
}

/* Returns the next candidate round the edge, starting on the side of the facet's tetrahedron. The result is the handle
 * on the far side of that candidate, so that the next call continues round the edge. */
static facet_edge next_candidate(const pruning *x, facet_edge e) {
    uint32_t facet = e.facet;
    do {
        const uint32_t *v = x->t->tet[brio_tet_of(facet)].vertex;
        int last = brio_last_slot(v, e.from, e.to, brio_slot_of(facet));
        e.apex = v[brio_slot_of(facet)];
        facet = *brio_mate(x->t, brio_facet_of(brio_tet_of(facet), last));
    } while (!brio_is_candidate(x->cocones, facet));
    e.facet = facet;
    return e;
}

/* Returns the dot product of the components of the two apexes perpendicular to the edge, times the edge's squared
 * length. Negative: the two triangles make more than a right angle. */
static double across(const pruning *x, facet_edge e, facet_edge f) {
    const double *points = x->points;
    const double *a = points + 3 * (size_t)e.from, *b = points + 3 * (size_t)e.to;
    const double *p = points + 3 * (size_t)e.apex, *q = points + 3 * (size_t)f.apex;
    double pq = 0, pe = 0, qe = 0, ee = 0;
    for (int k = 0; k < 3; k++) {
        pq += (p[k] - a[k]) * (q[k] - a[k]);
        pe += (p[k] - a[k]) * (b[k] - a[k]);
        qe += (q[k] - a[k]) * (b[k] - a[k]);
        ee += (b[k] - a[k]) * (b[k] - a[k]);
    }
    return pq * ee - pe * qe;
}

/* Returns whether the angle from one candidate to the next round their edge is more than 3 pi / 2. */
static bool is_wide(const pruning *x, facet_edge from, facet_edge to) {
    const double *points = x->points;
    if (from.facet == to.facet) return true; /* the edge has one candidate only */
    return across(x, from, to) > 0 && brio_orient3d(points + 3 * (size_t)from.from, points + 3 * (size_t)from.to,
                                                    points + 3 * (size_t)from.apex, points + 3 * (size_t)to.apex) < 0;
}

/* Returns whether an edge of a candidate is sharp. Two candidates at more than a right angle leave no room for a gap of
 * 3 pi / 2. So the first loop ends most calls early. */
static bool is_sharp(const pruning *x, facet_edge first) {
    const uint8_t *boundary = x->cocones->boundary;
    facet_edge e = first;
    if (boundary && boundary[e.from] && boundary[e.to]) return false;
    do {
        facet_edge next = next_candidate(x, e);
        if (next.facet != first.facet && across(x, first, next) < 0) return false;
        e = next;
    } while (e.facet != first.facet);
    do {
        facet_edge next = next_candidate(x, e);
        if (is_wide(x, e, next)) return true;
        e = next;
    } while (e.facet != first.facet);
    return false;
}

static bool has_sharp_edge(const pruning *x, uint32_t facet) {
    return is_sharp(x, edge_of(x, facet, 0)) || is_sharp(x, edge_of(x, facet, 1)) || is_sharp(x, edge_of(x, facet, 2));
}

/* Returns whether the samples voted a candidate's two tetrahedra outer and inner. */
static inline bool is_surface(const pruning *x, uint32_t facet) {
    uint8_t here = x->labels->label[brio_tet_of(facet)], there = x->labels->label[brio_tet_of(*brio_mate(x->t, facet))];
    return here != there && here != BRIO_LABEL_NONE && there != BRIO_LABEL_NONE;
}

static brio_status push(pruning *x, uint32_t facet) {
    brio_status status = BRIO_OK;
    if (is_surface(x, facet)) return BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(x->ctx, x->stack, x->capacity, x->size + 1));
    x->stack[x->size++] = facet;
done:
    return status;
}

/* Removes a candidate, and pushes the other candidates at its edges. */
static brio_status drop(pruning *x, uint32_t facet) {
    brio_status status = BRIO_OK;
    for (int k = 0; k < 3; k++) {
        facet_edge first = edge_of(x, facet, k);
        for (facet_edge e = next_candidate(x, first); e.facet != facet; e = next_candidate(x, e))
            BRIO_TRY(push(x, e.facet));
    }
    brio_drop_candidate(x->cocones, facet);
done:
    return status;
}

/* Compares facets by their handles. */
static int compare_facets(uint32_t f, uint32_t g, const void *user) {
    (void)user;
    return (f > g) - (f < g);
}

/* Pushes the candidates that have a sharp edge. The final set of candidates does not depend on the order of removals,
 * except for rounding, because edges only become sharper. The stack is sorted afterwards, so that rounding does not
 * depend on the threads either. */
static void find_sharp(void *user, size_t begin, size_t end, int thread) {
    pruning *x = user;
    (void)thread;
    for (size_t tet = begin; tet < end; tet++)
        for (unsigned left = x->cocones->candidates[tet]; left; left &= left - 1) {
            uint32_t facet = brio_facet_of((uint32_t)tet, __builtin_ctz(left));
            if (*brio_mate(x->t, facet) < facet || is_surface(x, facet) || !has_sharp_edge(x, facet)) continue;
            brio_mutex_lock(&x->stack_lock);
            brio_status own = push(x, facet);
            brio_mutex_unlock(&x->stack_lock);
            brio_report(&x->status, own);
        }
}

brio_status brio_cocone_prune(brio_context *ctx, const brio_tet_labels *labels, size_t *dropped) {
    brio_status status = BRIO_OK;
    pruning x = {.ctx = ctx,
                 .labels = labels,
                 .cocones = labels->cocones,
                 .t = &labels->dual->t,
                 .points = labels->dual->points};
    *dropped = 0;
    brio_mutex_new(&x.stack_lock);
    BRIO_TRY(brio_for_chunks(ctx, brio_threads(ctx, x.t->count, CHUNK), x.t->count, CHUNK, find_sharp, &x));
    BRIO_TRY(x.status);
    if (x.size > 0) brio_sort_indices(x.stack, x.size, compare_facets, NULL);
    while (x.size > 0) {
        uint32_t facet = x.stack[--x.size];
        if (!brio_is_candidate(x.cocones, facet) || !has_sharp_edge(&x, facet)) continue;
        BRIO_TRY(drop(&x, facet));
        ++*dropped;
    }
done:
    brio_mutex_free(&x.stack_lock);
    brio_release(ctx, x.stack);
    return status;
}
