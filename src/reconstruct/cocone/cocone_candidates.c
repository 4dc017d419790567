/* The co-cone test.
 *
 * The co-cone of a sample p is the complement of the double cone about the direction v to its pole: the points x with
 * the angle between x - p and v in [pi/2 - theta, pi/2 + theta]. The Voronoi edge dual to a triangle is the segment
 * between the centres of its two tetrahedra, or a ray if the triangle is on the hull. Each cone is convex, so the edge
 * misses the co-cone exactly if both its ends lie in the same cone; the end of a ray is its direction. So the test
 * needs two bits for each tetrahedron and each of its vertices (`sides`).
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.2. */
#include "reconstruct/cocone/cocone_candidates.h"
#include "base/memory.h"
#include "base/team.h"

/* BLOCK: tetrahedra whose facets are listed before their mates are read. Both chosen. */
enum { BLOCK = 64, TETS_A_THREAD = 1 << 12 };

brio_status brio_cocones_new(brio_context *ctx, const brio_pole_vectors *dual, brio_cocones *out) {
    *out = (brio_cocones){.dual = dual};
    return BRIO_ALLOC_ZERO(ctx, out->candidates, dual->t.count);
}

void brio_cocones_free(brio_context *ctx, brio_cocones *c) {
    brio_release(ctx, c->candidates);
    *c = (brio_cocones){0};
}

/* Returns whether the Voronoi edge of a facet meets the co-cones of all its samples that are no boundary samples. With
 * boundary NULL, of all its samples. */
static inline bool meets_all(const brio_cocones *c, uint32_t facet, const uint8_t *boundary) {
    const uint32_t *v = c->dual->t.tet[brio_tet_of(facet)].vertex;
    for (int k = 0; k < 3; k++) {
        uint32_t p = v[BRIO_FACET[brio_slot_of(facet)][k]];
        if (p == BRIO_INFINITE) return false;
        if (!(boundary && boundary[p]) && !brio_meets_cocone(c, facet, p)) return false;
    }
    return true;
}

/* counts[low byte of `sides`][i]: how many samples of facet i see the Voronoi vertex in their cone to the pole and,
 * times 16, in their opposite cone. */
typedef uint8_t side_counts[256][4];

static void count_sides(side_counts counts) {
    for (int sides = 0; sides < 256; sides++)
        for (int i = 0; i < 4; i++) {
            counts[sides][i] = 0;
            for (int k = 0; k < 3; k++) counts[sides][i] += (uint8_t)brio_slot_sides((unsigned)sides, BRIO_FACET[i][k]);
        }
}

/* Returns true only if both ends of a facet's Voronoi edge lie in the same cone of one of its samples. `here` and
 * `there` are the counts of the facet and of its mate. If they add up to 4 or more for one of the cones, one of the
 * three samples sees both ends in that cone. This settles most facets far from the surface without reading the mate's
 * vertices. */
static inline bool misses_surely(uint8_t here, uint8_t there) {
    return (here + there) & 0x44;
}

/* Returns whether the Voronoi edge of a facet meets the co-cones of all its samples, none of which is infinite. The
 * mate has the same vertices in the opposite order, so the place of one of them gives the places of the others. Of the
 * two bits of a side at most one is set, so a common bit means a common cone. */
static inline bool meets_every(const brio_pole_vectors *v, uint32_t facet, uint32_t mate) {
    static const uint8_t ROUND[5] = {0, 1, 2, 0, 1};
    const brio_tetrahedron *here = &v->t.tet[brio_tet_of(facet)], *there = &v->t.tet[brio_tet_of(mate)];
    const uint8_t *a = BRIO_FACET[brio_slot_of(facet)], *b = BRIO_FACET[brio_slot_of(mate)];
    unsigned x = v->sides[brio_tet_of(facet)], y = v->sides[brio_tet_of(mate)];
    uint32_t first = here->vertex[a[0]];
    int k = (there->vertex[b[1]] == first) + 2 * (there->vertex[b[2]] == first);
    return !((brio_slot_sides(x, a[0]) & brio_slot_sides(y, b[k])) |
             (brio_slot_sides(x, a[1]) & brio_slot_sides(y, b[ROUND[k + 2]])) |
             (brio_slot_sides(x, a[2]) & brio_slot_sides(y, b[ROUND[k + 1]])));
}

static bool passes(const brio_cocones *c, uint32_t facet, uint32_t mate) {
    if (!c->boundary) return meets_every(c->dual, facet, mate);
    return meets_all(c, facet, c->boundary) && (!brio_is_among_boundary(c, facet) || meets_all(c, facet, NULL));
}

/* Returns whether `passes` must test a facet: it is lower than its mate, and the counts do not settle it.
 * here  the facet's count.   all  mask of the bits of `sides` that count. */
static inline bool is_open(const brio_pole_vectors *v, const side_counts counts, uint8_t all, uint32_t facet,
                           uint8_t here) {
    uint32_t mate = v->t.tet[brio_tet_of(facet)].mate[brio_slot_of(facet)];
    uint8_t there = counts[v->sides[brio_tet_of(mate)] & all][brio_slot_of(mate)];
    return (facet < mate) & !misses_surely(here, there);
}

/* Lists the facets of tetrahedra from to to - 1 that `passes` must test, and prefetches their mates. */
static size_t list_open_facets(const brio_cocones *c, const side_counts counts, size_t from, size_t to,
                               uint32_t *open) {
    const brio_pole_vectors v = *c->dual;
    uint8_t all = c->boundary ? 0 : 0xff; /* with boundary samples no count settles a facet */
    size_t count = 0;
    for (size_t tet = from; tet < to; tet++) {
        const uint8_t *here = counts[v.sides[tet] & all];
        /* facets 0 to 2 of an infinite tetrahedron have the infinite vertex */
        for (int i = tet < v.num_finite ? 0 : 3; i < 4; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i);
            open[count] = facet; /* written in any case, because no processor could predict a branch here */
            count += is_open(&v, counts, all, facet, here[i]);
        }
    }
    for (size_t n = 0; n < count; n++) __builtin_prefetch(&v.t.tet[brio_tet_of(*brio_mate(&v.t, open[n]))]);
    return count;
}

/* Marks a facet as a candidate.   alone  no other thread marks facets. */
static inline void mark(const brio_cocones *c, uint32_t facet, bool alone) {
    uint8_t *candidates = &c->candidates[brio_tet_of(facet)], bit = (uint8_t)(1 << brio_slot_of(facet));
    if (alone)
        *candidates |= bit;
    else
        __atomic_fetch_or(candidates, bit, __ATOMIC_RELAXED);
}

/* Marks the candidates among the facets of tetrahedra from to to - 1 that are lower than their mates. Returns their
 * number. */
static size_t select_from(const brio_cocones *c, const side_counts counts, size_t from, size_t to, bool alone) {
    uint32_t open[4 * BLOCK];
    size_t found = 0, count = list_open_facets(c, counts, from, to, open);
    for (size_t n = 0; n < count; n++) {
        uint32_t mate = *brio_mate(&c->dual->t, open[n]);
        if (!passes(c, open[n], mate)) continue;
        mark(c, open[n], alone);
        mark(c, mate, alone);
        found++;
    }
    return found;
}

typedef struct {
    const brio_cocones *cocones;
    side_counts counts;
    size_t found;
    bool alone;
} selection;

static void select_part(void *user, size_t begin, size_t end, int thread) {
    selection *s = user;
    size_t found = 0;
    (void)thread;
    for (size_t from = begin; from < end; from += BLOCK)
        found += select_from(s->cocones, (const uint8_t(*)[4])s->counts, from, from + BLOCK < end ? from + BLOCK : end,
                             s->alone);
    __atomic_fetch_add(&s->found, found, __ATOMIC_RELAXED);
}

brio_status brio_cocones_select(brio_context *ctx, brio_cocones *c, size_t *count) {
    size_t size = c->dual->t.count;
    int threads = brio_threads(ctx, size, TETS_A_THREAD);
    selection s = {.cocones = c, .alone = threads == 1};
    count_sides(s.counts);
    brio_status status = brio_for(ctx, threads, size, select_part, &s);
    *count = s.found;
    return status;
}
