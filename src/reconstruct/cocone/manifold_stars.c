/* Labels whose boundary is a manifold.
 *
 * Round a sample, tetrahedra are triangles on a sphere. The boundary is one fan at the sample exactly if the outer
 * tetrahedra of its star are connected across facets, and the inner ones are, too. Then they meet in one closed curve
 * on that sphere. By Jordan's theorem the curve nowhere touches itself, so its edges have two faces each.
 *
 * At every other sample, the largest outer piece and the largest inner piece of the star keep their labels, and the
 * smaller pieces change theirs. The samples of changed tetrahedra are tested again. A sample that is mended more than
 * PATIENCE times is given up: its whole star becomes outer, for good. So the work ends for every input. It goes in
 * rounds, each in the order of positions, so that the result does not depend on the numbers of the samples.
 *
 * I1  A fixed tetrahedron is outer. */
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "reconstruct/cocone/label_boundary.h"
#include "reconstruct/cocone/manifold_extraction.h"
#include "mesh/edge_rings.h"
#include "triangulation/star.h"
#include <stdlib.h>
#include <string.h>

/* AHEAD: the tetrahedron this many facets ahead is prefetched. All chosen, except NO_PIECE. */
enum { AHEAD = 16, PATIENCE = 8, SAMPLES_A_THREAD = 1 << 10, NO_PIECE = UINT32_MAX };

/* A part of a star that is connected across facets. */
typedef struct {
    uint8_t label;
    bool fixed;
    uint64_t weight;
    double mark[4]; /* the row of the lexicographically largest of its centres, which decides ties */
} piece;

typedef struct {
    brio_context *ctx;
    brio_tet_labels *labels;
    const brio_pole_vectors *dual;
    const brio_tetrahedra *t;
    uint32_t *tet_of_vertex; /* #P: a finite tetrahedron at each vertex; not set for points that are no vertices */
    uint8_t *visits;         /* #P: how often the star of the sample was mended */
    uint8_t *waiting;        /* #P: 1 if the sample is in the queue */
    uint8_t *fixed;          /* #T: 1 if the tetrahedron is outer for good */
    uint32_t *piece_of;      /* #T: the piece of each tetrahedron of the star at hand */
    brio_star star;
    piece *pieces;
    uint32_t *stack;
    size_t num_pieces, piece_capacity, stack_capacity;
    uint32_t *queue; /* samples to test */
    size_t size, queue_capacity;
    size_t changed;
} repair;

/* --- which samples to look at --- */

static brio_status enqueue(repair *r, uint32_t v) {
    brio_status status = BRIO_OK;
    if (v == BRIO_INFINITE || r->waiting[v]) return BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(r->ctx, r->queue, r->queue_capacity, r->size + 1));
    r->queue[r->size++] = v;
    r->waiting[v] = 1;
done:
    return status;
}

/* A facet of the boundary at a sample: corner after the sample << 32 | corner before the sample, counterclockwise from
 * outside. */
typedef uint64_t fan_corner;

/* Returns the index of the fan corner that begins at vertex `at`, or `count` if there is none. */
static size_t corner_that_begins(const fan_corner *fan, size_t count, bool sorted, uint32_t at) {
    size_t low = 0, high = count;
    if (!sorted) {
        while (low < count && fan[low] >> 32 != at) low++;
        return low;
    }
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (fan[middle] >> 32 < at)
            low = middle + 1;
        else
            high = middle;
    }
    return low < count && fan[low] >> 32 == at ? low : count;
}

/* Returns whether the facets at a sample are one closed fan: following each facet by the one that begins where it ends
 * returns to the first facet only after all others. */
static bool is_one_fan(fan_corner *fan, size_t count) {
    enum { FEW = 16 };
    if (count > FEW) brio_sort_keys(fan, count);
    uint32_t first = (uint32_t)(fan[0] >> 32), at = (uint32_t)fan[0];
    for (size_t n = 1; n < count; n++) {
        size_t next = at == first ? count : corner_that_begins(fan, count, count > FEW, at);
        if (next == count) return false;
        at = (uint32_t)fan[next];
    }
    return at == first;
}

/* Stores the corners of the boundary by sample: those of sample v end before corner[end[v]]. */
static void deal_corners(const repair *r, const uint32_t *facets, size_t count, uint32_t *end, fan_corner *corner) {
    size_t n = r->dual->num_points;
    uint32_t sum = 0;
    for (int writing = 0; writing < 2; writing++) {
        for (size_t f = 0; f < count; f++) {
            if (f + AHEAD < count) __builtin_prefetch(&r->t->tet[brio_tet_of(facets[f + AHEAD])]);
            const uint32_t *v = r->t->tet[brio_tet_of(facets[f])].vertex;
            const uint8_t *slot = BRIO_FACET[brio_slot_of(facets[f])];
            for (int k = 0; k < 3; k++) {
                uint32_t p = v[slot[k]], after = v[slot[(k + 1) % 3]], before = v[slot[(k + 2) % 3]];
                if (p == BRIO_INFINITE) continue;
                if (writing) corner[end[p]] = (uint64_t)after << 32 | before;
                end[p]++;
            }
        }
        for (size_t v = 0; v < n && !writing; v++) {
            uint32_t degree = end[v];
            end[v] = sum;
            sum += degree;
        }
    }
}

typedef struct {
    const uint32_t *end; /* #P: where the corners of each sample end */
    fan_corner *corner;
    uint8_t *singular;
} fan_marks;

static void mark_singular(void *user, size_t first, size_t last, int thread) {
    const fan_marks *m = user;
    (void)thread;
    for (size_t v = first; v < last; v++) {
        size_t begin = v ? m->end[v - 1] : 0;
        m->singular[v] = m->end[v] > begin && !is_one_fan(m->corner + begin, m->end[v] - begin);
    }
}

/* Queues the samples where the boundary is not one fan. */
static brio_status enqueue_singular(repair *r, const uint32_t *facets, size_t count) {
    brio_status status = BRIO_OK;
    size_t n = r->dual->num_points;
    uint32_t *end = NULL;
    fan_corner *corner = NULL;
    uint8_t *singular = NULL;
    BRIO_REQUIRE(r->ctx, 3 * count < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu triangles, 2^32 / 3 is the limit", count);
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, end, n));
    BRIO_TRY(BRIO_ALLOC(r->ctx, corner, 3 * count));
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, singular, n));
    deal_corners(r, facets, count, end, corner);
    fan_marks marks = {end, corner, singular};
    BRIO_TRY(brio_for(r->ctx, brio_threads(r->ctx, n, SAMPLES_A_THREAD), n, mark_singular, &marks));
    for (size_t v = 0; v < n; v++)
        if (singular[v]) BRIO_TRY(enqueue(r, (uint32_t)v));
done:
    brio_release(r->ctx, end);
    brio_release(r->ctx, corner);
    brio_release(r->ctx, singular);
    return status;
}

/* --- one star --- */

/* Lets a tetrahedron of a piece be its mark, if its centre is the largest so far. */
static void take_mark(const repair *r, uint32_t tet, piece *p) {
    double centre[4];
    brio_centre_row(r->dual, tet, centre);
    if (brio_lexicographic(centre, p->mark) > 0) memcpy(p->mark, centre, sizeof centre);
}

/* Collects the piece of the star of v that contains tetrahedron `first`. */
static brio_status collect_piece(repair *r, uint32_t v, uint32_t first) {
    brio_status status = BRIO_OK;
    piece p = {.label = r->labels->label[first]};
    size_t size = 1;
    BRIO_TRY(BRIO_RESERVE(r->ctx, r->pieces, r->piece_capacity, r->num_pieces + 1));
    BRIO_TRY(BRIO_RESERVE(r->ctx, r->stack, r->stack_capacity, r->star.size));
    r->stack[0] = first;
    r->piece_of[first] = (uint32_t)r->num_pieces;
    brio_centre_row(r->dual, first, p.mark);
    while (size > 0) {
        uint32_t tet = r->stack[--size];
        p.fixed |= r->fixed[tet];
        take_mark(r, tet, &p);
        p.weight += 1 + (uint64_t)abs(brio_tet_vote(r->labels, tet));
        for (int i = 0; i < 4; i++) {
            uint32_t other = brio_tet_of(r->t->tet[tet].mate[i]);
            if (r->t->tet[tet].vertex[i] == v || r->labels->label[other] != p.label) continue;
            if (r->piece_of[other] != NO_PIECE) continue;
            r->piece_of[other] = (uint32_t)r->num_pieces;
            r->stack[size++] = other;
        }
    }
    r->pieces[r->num_pieces++] = p;
done:
    return status;
}

static brio_status collect_pieces(repair *r, uint32_t v) {
    brio_status status = BRIO_OK;
    r->num_pieces = 0;
    BRIO_TRY(brio_star_collect(r->ctx, r->t, v, r->tet_of_vertex[v], SIZE_MAX, &r->star));
    for (size_t n = 0; n < r->star.size; n++) r->piece_of[r->star.tet[n]] = NO_PIECE;
    for (size_t n = 0; n < r->star.size; n++)
        if (r->piece_of[r->star.tet[n]] == NO_PIECE) BRIO_TRY(collect_piece(r, v, r->star.tet[n]));
done:
    return status;
}

/* Returns whether to keep the label of piece a rather than b. */
static bool is_better(const piece *a, const piece *b) {
    if (a->fixed != b->fixed) return a->fixed;
    return a->weight != b->weight ? a->weight > b->weight : brio_lexicographic(a->mark, b->mark) > 0;
}

/* Returns the piece that keeps a label, or NO_PIECE.   fixed  receives the number of fixed pieces of that label. */
static uint32_t piece_to_keep(const repair *r, uint8_t label, size_t *fixed) {
    uint32_t best = NO_PIECE;
    *fixed = 0;
    for (uint32_t i = 0; i < r->num_pieces; i++) {
        if (r->pieces[i].label != label) continue;
        *fixed += r->pieces[i].fixed;
        if (best == NO_PIECE || is_better(&r->pieces[i], &r->pieces[best])) best = i;
    }
    return best;
}

static brio_status relabel(repair *r, uint32_t tet, uint8_t label) {
    brio_status status = BRIO_OK;
    if (r->labels->label[tet] == label) return BRIO_OK;
    r->labels->label[tet] = label;
    r->changed++;
    for (int i = 0; i < 4; i++) BRIO_TRY(enqueue(r, r->t->tet[tet].vertex[i]));
done:
    return status;
}

/* Changes labels in a star so that it has one outer and one inner piece. Where this is impossible, or was tried
 * PATIENCE times, the whole star becomes outer. */
static brio_status mend_star(repair *r, uint32_t v) {
    brio_status status = BRIO_OK;
    size_t fixed_outer, fixed_inner;
    BRIO_TRY(collect_pieces(r, v));
    uint32_t outer = piece_to_keep(r, BRIO_LABEL_OUTER, &fixed_outer);
    uint32_t inner = piece_to_keep(r, BRIO_LABEL_INNER, &fixed_inner);
    if (r->num_pieces <= 1 || (r->num_pieces == 2 && outer != NO_PIECE && inner != NO_PIECE)) goto done;
    bool give_up = fixed_outer > 1 || ++r->visits[v] > PATIENCE;
    for (size_t n = 0; n < r->star.size; n++) {
        uint32_t tet = r->star.tet[n], in = r->piece_of[tet];
        uint8_t other = r->labels->label[tet] == BRIO_LABEL_OUTER ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
        if (give_up)
            BRIO_TRY(relabel(r, tet, BRIO_LABEL_OUTER));
        else if (in != outer && in != inner)
            BRIO_TRY(relabel(r, tet, other));
        r->fixed[tet] |= give_up;
    }
done:
    return status;
}

/* --- all --- */

static brio_status prepare(repair *r) {
    brio_status status = BRIO_OK;
    const brio_pole_vectors *v = r->dual;
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->tet_of_vertex, v->num_points));
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, r->visits, v->num_points));
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, r->fixed, r->t->count));
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->piece_of, r->t->count));
    BRIO_TRY(brio_star_new(r->ctx, r->t->count, &r->star));
    for (size_t tet = 0; tet < v->num_finite; tet++) {
        brio_along(r->ctx, tet, v->num_finite, BRIO_READS(r->t->tet));
        for (int i = 0; i < 4; i++) r->tet_of_vertex[r->t->tet[tet].vertex[i]] = (uint32_t)tet;
    }
    for (size_t tet = v->num_finite; tet < r->t->count; tet++) r->fixed[tet] = r->labels->watertight;
done:
    return status;
}

static brio_status mend_stars(repair *r) {
    brio_status status = BRIO_OK;
    for (size_t begin = 0, end; begin < r->size; begin = end) {
        end = r->size;
        brio_sort_by_position(r->dual->points, r->queue + begin, end - begin);
        for (size_t n = begin; n < end; n++) {
            r->waiting[r->queue[n]] = 0;
            BRIO_TRY(mend_star(r, r->queue[n]));
        }
    }
done:
    return status;
}

brio_status brio_make_manifold(brio_context *ctx, brio_tet_labels *labels, brio_facets *facets, size_t *changed) {
    brio_status status = BRIO_OK;
    repair r = {.ctx = ctx, .labels = labels, .dual = labels->dual, .t = &labels->dual->t};
    BRIO_TRY(brio_boundary_facets(ctx, labels, facets));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, r.waiting, labels->dual->num_points));
    BRIO_TRY(enqueue_singular(&r, facets->facet, facets->count));
    BRIO_TRY(brio_progress(ctx, "manifold", 0.5));
    if (r.size > 0) BRIO_TRY(prepare(&r));
    BRIO_TRY(mend_stars(&r));
    *changed = r.changed;
    if (r.changed > 0) {
        brio_release(ctx, facets->facet);
        BRIO_TRY(brio_boundary_facets(ctx, labels, facets));
    }
done:
    brio_release(ctx, r.tet_of_vertex);
    brio_release(ctx, r.visits);
    brio_release(ctx, r.waiting);
    brio_release(ctx, r.fixed);
    brio_release(ctx, r.piece_of);
    brio_release(ctx, r.pieces);
    brio_release(ctx, r.stack);
    brio_release(ctx, r.queue);
    brio_star_free(ctx, &r.star);
    return status;
}
