/* Which way the pole of each sample lies: outside or inside.
 *
 * Every sample knows the axis of its surface normal, up to sign. The signs agree along a spanning forest of the edges
 * of candidates, those first whose axes are most nearly parallel (Kruskal, over a union-find that knows for each
 * element whether its sign is that of its root). Pieces of surface that no candidate joins are joined through
 * tetrahedra: two samples that both see a tetrahedron in one of their cones are on the same side of their surfaces, or
 * on opposite ones. What is one piece then is turned so that the hull sees its outside.
 *
 * Based on: Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface reconstruction from unorganized points. SIGGRAPH 1992,
 *           for signs along a spanning tree of parallel normals. */
#include "reconstruct/sample_orientation.h"
#include "base/memory.h"
#include "base/sort.h"

typedef struct {
    uint32_t a, b;
    uint8_t opposite; /* 1: the vectors of a and b have opposite signs */
} sample_link;

typedef struct {
    brio_context *ctx;
    const brio_cocones *cocones;
    uint32_t *parent;  /* of each sample */
    uint8_t *opposite; /* 1: the sign is not that of the parent */
    size_t num_pieces;
    sample_link *link;
    uint64_t *key; /* ascending: the best link first */
    size_t num_links, link_capacity, key_capacity;
} forest;

/* The root of x; *sign becomes 1 when its sign is not that of x. Halves the path on its way. */
static uint32_t find_root(forest *f, uint32_t x, uint8_t *sign) {
    *sign = 0;
    while (f->parent[x] != x) {
        uint32_t up = f->parent[x];
        f->opposite[x] ^= f->opposite[up];
        f->parent[x] = f->parent[up];
        *sign ^= f->opposite[x];
        x = f->parent[x];
    }
    return x;
}

static void join(forest *f, const sample_link *l) {
    uint8_t sign_a, sign_b;
    uint32_t a = find_root(f, l->a, &sign_a), b = find_root(f, l->b, &sign_b);
    if (a == b) return;
    f->parent[b] = a;
    f->opposite[b] = sign_a ^ sign_b ^ l->opposite;
    f->num_pieces--;
}

static brio_status add_link(forest *f, uint32_t a, uint32_t b, uint8_t opposite, double weight) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->link, f->link_capacity, f->num_links + 1));
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->key, f->key_capacity, f->num_links + 1));
    f->link[f->num_links] = (sample_link){a, b, opposite};
    f->key[f->num_links++] = (uint64_t)((1 - fmin(weight, 1)) * UINT32_MAX);
done:
    return status;
}

/* Order of links of the same weight: by the positions of their ends, the lesser one first. */
static int compare_links(uint32_t i, uint32_t j, const void *user) {
    const forest *f = user;
    const double *points = f->cocones->dual->points, *end[2][2];
    for (int n = 0; n < 2; n++) {
        const sample_link *l = &f->link[n == 0 ? i : j];
        bool swap = brio_lexicographic(points + 3 * (size_t)l->a, points + 3 * (size_t)l->b) > 0;
        end[n][swap] = points + 3 * (size_t)l->a;
        end[n][!swap] = points + 3 * (size_t)l->b;
    }
    int sign = brio_lexicographic(end[0][0], end[1][0]);
    if (sign == 0) sign = brio_lexicographic(end[0][1], end[1][1]);
    return sign ? sign : f->link[i].opposite - f->link[j].opposite;
}

static bool is_same_pair(const sample_link *l, const sample_link *m) {
    return l->opposite == m->opposite && ((l->a == m->a && l->b == m->b) || (l->a == m->b && l->b == m->a));
}

/* Joins along the links, the best first, and forgets them. */
static brio_status join_links(forest *f) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    size_t count = f->num_links;
    BRIO_REQUIRE(f->ctx, count < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu links between samples, 2^32 is the limit", count);
    BRIO_TRY(BRIO_ALLOC(f->ctx, order, count));
    for (size_t i = 0; i < count; i++) order[i] = (uint32_t)i;
    BRIO_TRY(brio_radix_sort(f->ctx, f->key, order, count, 32));
    for (size_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && f->key[end] == f->key[begin];) end++;
        if (end - begin == 1 || (end - begin == 2 && is_same_pair(&f->link[order[begin]], &f->link[order[begin + 1]])))
            continue; /* two candidates share an edge */
        brio_sort_indices(order + begin, end - begin, compare_links, f);
    }
    for (size_t i = 0; i < count; i++) join(f, &f->link[order[i]]);
    f->num_links = 0;
done:
    brio_release(f->ctx, order);
    return status;
}

/* --- links through tetrahedra --- */

/* Cosine of the angle at which a sample sees a tetrahedron's Voronoi vertex from its axis. */
static double depth(const brio_pole_vectors *v, size_t tet, size_t p) {
    const double *axis = v->vector + 3 * p;
    double to[3];
    brio_towards_centre(v, tet, p, to);
    double length = sqrt(to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
    return fabs(to[0] * axis[0] + to[1] * axis[1] + to[2] * axis[2]) / length;
}

/* Links a sample to the others of a tetrahedron, one of its poles. */
static brio_status link_pole(forest *f, uint32_t p, uint32_t tet) {
    brio_status status = BRIO_OK;
    const uint32_t *v = f->cocones->dual->t.tet[tet].vertex;
    int side = brio_side_of(f->cocones, tet, brio_slot_of_vertex(v, p));
    for (int i = 0; i < 4; i++) {
        int other = v[i] == p || v[i] == BRIO_INFINITE ? BRIO_SIDE_COCONE : brio_side_of(f->cocones, tet, i);
        if (other == BRIO_SIDE_COCONE || side == BRIO_SIDE_COCONE) continue;
        const uint32_t *poles = f->cocones->dual->pole + 2 * (size_t)v[i];
        if (v[i] < p && (poles[0] == tet || poles[1] == tet)) continue; /* that one has linked the two */
        double weight = fmin(depth(f->cocones->dual, tet, p), depth(f->cocones->dual, tet, v[i]));
        BRIO_TRY(add_link(f, p, v[i], side != other, weight));
    }
done:
    return status;
}

static brio_status link_poles(forest *f) {
    brio_status status = BRIO_OK;
    const brio_pole_vectors *v = f->cocones->dual;
    for (size_t i = 0; i < 2 * v->num_points; i++)
        if (v->pole[i] != BRIO_INFINITE) BRIO_TRY(link_pole(f, (uint32_t)(i / 2), v->pole[i]));
done:
    return status;
}

/* --- links along candidates --- */

static brio_status link_edge(forest *f, uint32_t p, uint32_t q) {
    const double *u = f->cocones->dual->vector + 3 * (size_t)p, *v = f->cocones->dual->vector + 3 * (size_t)q;
    double cosine = u[0] * v[0] + u[1] * v[1] + u[2] * v[2];
    return add_link(f, p, q, cosine < 0, fabs(cosine));
}

static brio_status link_candidates(forest *f, size_t num_candidates) {
    brio_status status = BRIO_OK;
    const brio_tetrahedra *t = &f->cocones->dual->t;
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->link, f->link_capacity, 3 * num_candidates));
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->key, f->key_capacity, 3 * num_candidates));
    for (size_t tet = 0; tet < t->count; tet++)
        for (int i = 0; f->cocones->candidates[tet] && i < 4; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i);
            if (!brio_is_candidate(f->cocones, facet) || *brio_mate(t, facet) < facet) continue;
            for (int k = 0; k < 3; k++)
                BRIO_TRY(
                    link_edge(f, t->tet[tet].vertex[BRIO_FACET[i][k]], t->tet[tet].vertex[BRIO_FACET[i][(k + 1) % 3]]));
        }
done:
    return status;
}

/* --- links between pieces --- */

static brio_status link_across(forest *f, size_t tet) {
    brio_status status = BRIO_OK;
    const uint32_t *v = f->cocones->dual->t.tet[tet].vertex;
    uint32_t root[4];
    int side[4];
    for (int i = 0; i < 4; i++) {
        uint8_t sign;
        side[i] = v[i] == BRIO_INFINITE ? BRIO_SIDE_COCONE : brio_side_of(f->cocones, tet, i);
        if (side[i] == BRIO_SIDE_COCONE) continue;
        root[i] = find_root(f, v[i], &sign);
        for (int j = 0; j < i; j++) {
            if (side[j] == BRIO_SIDE_COCONE || root[i] == root[j]) continue;
            double weight = fmin(depth(f->cocones->dual, tet, v[i]), depth(f->cocones->dual, tet, v[j]));
            BRIO_TRY(add_link(f, v[i], v[j], side[i] != side[j], weight));
        }
    }
done:
    return status;
}

static brio_status link_pieces(forest *f) {
    brio_status status = BRIO_OK;
    for (size_t tet = 0; f->num_pieces > 1 && tet < f->cocones->dual->t.count; tet++) BRIO_TRY(link_across(f, tet));
done:
    return status;
}

/* --- signs --- */

/* Of each root: how often its piece looks outwards on the hull, less how often it looks inwards. */
static void count_outwards(forest *f, int64_t *outwards) {
    const brio_pole_vectors *v = f->cocones->dual;
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int i = 0; i < 3; i++) {
            int side = brio_side_of(f->cocones, tet, i);
            uint8_t sign;
            uint32_t root = find_root(f, v->t.tet[tet].vertex[i], &sign);
            if (side != BRIO_SIDE_COCONE) outwards[root] += (side == BRIO_SIDE_POLE) == (sign == 0) ? 1 : -1;
        }
}

/* Whether the pieces are to be turned so that most of what they have on the hull looks outwards; where that is even, so
 * that the sample of least position keeps its sign. */
static void choose_turns(forest *f, const int64_t *outwards, uint32_t *least, uint8_t *turn) {
    const double *points = f->cocones->dual->points;
    size_t n = f->cocones->dual->num_points;
    uint8_t sign;
    for (size_t p = 0; p < n; p++) least[p] = (uint32_t)p;
    for (size_t p = 0; p < n; p++) {
        uint32_t root = find_root(f, (uint32_t)p, &sign);
        if (brio_lexicographic(points + 3 * p, points + 3 * (size_t)least[root]) < 0) least[root] = (uint32_t)p;
    }
    for (size_t p = 0; p < n; p++) {
        if (f->parent[p] != p) continue;
        find_root(f, least[p], &sign);
        turn[p] = outwards[p] ? outwards[p] < 0 : sign;
    }
}

static brio_status sign_samples(forest *f, uint8_t *turned) {
    brio_status status = BRIO_OK;
    size_t n = f->cocones->dual->num_points;
    int64_t *outwards = NULL;
    uint32_t *least = NULL; /* of each root: the sample of least position */
    uint8_t *turn = NULL;   /* of each root */
    BRIO_TRY(BRIO_ALLOC_ZERO(f->ctx, outwards, n));
    BRIO_TRY(BRIO_ALLOC(f->ctx, least, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(f->ctx, turn, n));
    count_outwards(f, outwards);
    choose_turns(f, outwards, least, turn);
    for (size_t p = 0; p < n; p++) {
        uint8_t sign;
        uint32_t root = find_root(f, (uint32_t)p, &sign);
        turned[p] = sign ^ turn[root];
    }
    BRIO_TRY(brio_progress(f->ctx, "orientation", 1));
done:
    brio_release(f->ctx, outwards);
    brio_release(f->ctx, least);
    brio_release(f->ctx, turn);
    return status;
}

brio_status brio_orient_samples(brio_context *ctx, const brio_cocones *c, size_t num_candidates, uint8_t **turned) {
    brio_status status = BRIO_OK;
    size_t n = c->dual->num_points;
    forest f = {.ctx = ctx, .cocones = c, .num_pieces = n};
    *turned = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, f.parent, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f.opposite, n));
    for (size_t p = 0; p < n; p++) f.parent[p] = (uint32_t)p;
    BRIO_TRY(link_poles(&f));
    BRIO_TRY(join_links(&f));
    BRIO_TRY(link_candidates(&f, num_candidates));
    BRIO_TRY(join_links(&f));
    BRIO_TRY(link_pieces(&f));
    BRIO_TRY(join_links(&f));
    BRIO_TRY(BRIO_ALLOC(ctx, *turned, n));
    BRIO_TRY(sign_samples(&f, *turned));
done:
    brio_release(ctx, f.parent);
    brio_release(ctx, f.opposite);
    brio_release(ctx, f.link);
    brio_release(ctx, f.key);
    if (status != BRIO_OK) {
        brio_release(ctx, *turned);
        *turned = NULL;
    }
    return status;
}
