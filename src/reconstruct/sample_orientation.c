/* Which way the pole of each sample lies: outside or inside.
 *
 * Every sample knows the axis of its surface normal, up to sign. The signs agree along a spanning forest (Kruskal, over
 * a union-find that knows for each element whether its sign is that of its root). First come the links between samples
 * that see the same pole in one of their cones and so are on the same side of their surfaces, or on opposite ones, those
 * first that see it nearest to their axes; then, between the pieces of surface that are left, the edges of candidates,
 * those first whose axes are most nearly parallel; then all other tetrahedra that two samples see in their cones. What
 * is one piece then is turned so that the hull sees its outside.
 *
 * Links that agree with each other can be joined in any order with the same result. So they are not sorted but dealt
 * into a few classes by weight, and only a class with a contradiction is undone and joined again in the order of
 * weights. Links within a piece of the classes before can change nothing and are left out, contradictions among them
 * too.
 *
 * Based on: Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface reconstruction from unorganized points. SIGGRAPH 1992,
 *           for signs along a spanning tree of parallel normals. */
#include "reconstruct/sample_orientation.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/sort.h"
#include <string.h>

/* Two samples whose axes have the same sign, or opposite ones, by what they see of a tetrahedron or, along the edge of a
 * candidate, of each other. */
typedef struct {
    uint32_t a, b, tet; /* tet is NO_TET on an edge */
} sample_link;

enum { KEY_BITS = 32, LINKS_OF_POLE = 3, AHEAD = 16 };

static const uint32_t NO_TET = UINT32_MAX;

/* What is kept of a link beside its ends: its class, and a bit for opposite signs; or NO_LINK. */
enum { OPPOSITE = 0x80, NO_LINK = 0xff };

typedef struct {
    brio_context *ctx;
    const brio_cocones *cocones;
    uint32_t *parent;  /* of each sample */
    uint8_t *opposite; /* 1: the sign is not that of the parent */
    size_t num_pieces; /* of the vertices */
    sample_link *link;
    uint8_t *kind;
    size_t num_links, link_capacity, kind_capacity;
} forest;

/* The root of x; *sign becomes 1 when its sign is not that of x. Halves the path on its way. */
static inline uint32_t find_root(forest *f, uint32_t x, uint8_t *sign) {
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

/* Lets every sample know its root at once. */
static void flatten(forest *f) {
    for (size_t p = 0; p < f->cocones->dual->num_points; p++) {
        uint8_t sign;
        uint32_t root = find_root(f, (uint32_t)p, &sign);
        f->parent[p] = root;
        f->opposite[p] = sign;
    }
}

/* Whether a link agrees with those before it. */
static inline bool join(forest *f, size_t i) {
    uint8_t sign_a, sign_b, opposite = f->kind[i] >= OPPOSITE;
    uint32_t a = f->link[i].a, b = f->link[i].b;
    if (f->parent[a] == f->parent[b]) return (f->opposite[a] ^ f->opposite[b]) == opposite;
    a = find_root(f, a, &sign_a), b = find_root(f, b, &sign_b);
    if (a == b) return (sign_a ^ sign_b) == opposite;
    f->parent[b] = a;
    f->opposite[b] = sign_a ^ sign_b ^ opposite;
    f->num_pieces--;
    return true;
}

/* Square of the cosine of the angle at which a sample sees the Voronoi vertex of a tetrahedron from its axis. */
static double depth(const brio_pole_vectors *v, size_t tet, size_t p) {
    const double *axis = v->plane + 4 * p;
    double to[3];
    brio_towards_centre(v, tet, p, to);
    double along = to[0] * axis[0] + to[1] * axis[1] + to[2] * axis[2];
    return along * along / (to[0] * to[0] + to[1] * to[1] + to[2] * to[2]);
}

static double cosine_of(const brio_pole_vectors *v, size_t p, size_t q) {
    const double *a = v->plane + 4 * p, *b = v->plane + 4 * q;
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* What sorts the links of a class, the best first. */
static uint32_t key_of(const forest *f, const sample_link *l) {
    const brio_pole_vectors *v = f->cocones->dual;
    double cosine = l->tet == NO_TET ? cosine_of(v, l->a, l->b) : 0;
    double weight = l->tet == NO_TET ? cosine * cosine : fmin(depth(v, l->tet, l->a), depth(v, l->tet, l->b));
    return (uint32_t)((weight < 1 ? 1 - weight : 0) * UINT32_MAX);
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
    return sign ? sign : (int)f->kind[i] - (int)f->kind[j];
}

/* Whether a link is one of a class, and between pieces that were apart before it; others can change nothing. */
static inline bool is_of(const forest *f, size_t i, int class, const uint32_t *root) {
    return (f->kind[i] & ~OPPOSITE) == class && root[f->link[i].a] != root[f->link[i].b];
}

/* Joins along the links of a class in any order; false at a contradiction. */
static bool join_unsorted(forest *f, int class, const uint32_t *root) {
    for (size_t i = 0; i < f->num_links; i++)
        if (is_of(f, i, class, root) && !join(f, i)) return false;
    return true;
}

static brio_status join_sorted(forest *f, int class, const uint32_t *root) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    uint64_t *keys = NULL;
    size_t count = 0, capacity = 0;
    for (size_t i = 0; i < f->num_links; i++) {
        if (!is_of(f, i, class, root)) continue;
        BRIO_TRY(BRIO_RESERVE(f->ctx, order, capacity, count + 1));
        order[count++] = (uint32_t)i;
    }
    BRIO_TRY(BRIO_ALLOC(f->ctx, keys, count));
    for (size_t i = 0; i < count; i++) keys[i] = key_of(f, &f->link[order[i]]);
    BRIO_TRY(brio_radix_sort(f->ctx, keys, order, count, KEY_BITS));
    for (size_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && keys[end] == keys[begin];) end++;
        brio_sort_indices(order + begin, end - begin, compare_links, f);
    }
    for (size_t i = 0; i < count; i++) {
        if (i + 2 * AHEAD < count) __builtin_prefetch(&f->link[order[i + 2 * AHEAD]]);
        if (i + AHEAD < count) __builtin_prefetch(&f->parent[f->link[order[i + AHEAD]].a]);
        if (i + AHEAD < count) __builtin_prefetch(&f->parent[f->link[order[i + AHEAD]].b]);
        join(f, order[i]);
    }
done:
    brio_release(f->ctx, order);
    brio_release(f->ctx, keys);
    return status;
}

/* Joins along the links, the best first, and forgets them. */
static brio_status join_links(forest *f) {
    brio_status status = BRIO_OK;
    size_t n = f->cocones->dual->num_points;
    uint32_t *root = NULL; /* of each sample, before the class at hand */
    uint8_t *opposite = NULL;
    BRIO_REQUIRE(f->ctx, f->num_links < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu links between samples, 2^32 is the limit",
                 f->num_links);
    BRIO_TRY(BRIO_ALLOC(f->ctx, root, n));
    BRIO_TRY(BRIO_ALLOC(f->ctx, opposite, n));
    for (int class = 0; class < BRIO_DEPTHS && f->num_links > 0 && f->num_pieces > 1; class ++) {
        size_t pieces = f->num_pieces;
        memcpy(root, f->parent, n * sizeof *root);
        memcpy(opposite, f->opposite, n * sizeof *opposite);
        if (!join_unsorted(f, class, root)) {
            f->num_pieces = pieces;
            memcpy(f->parent, root, n * sizeof *root);
            memcpy(f->opposite, opposite, n * sizeof *opposite);
            BRIO_TRY(join_sorted(f, class, root));
        }
        flatten(f);
    }
    f->num_links = 0;
done:
    brio_release(f->ctx, root);
    brio_release(f->ctx, opposite);
    return status;
}

/* Adds a link between samples of different pieces. */
static brio_status add_link(forest *f, sample_link link, bool opposite, int class) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->link, f->link_capacity, f->num_links + 1));
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->kind, f->kind_capacity, f->num_links + 1));
    f->link[f->num_links] = link;
    f->kind[f->num_links++] = (uint8_t)(class | (opposite ? OPPOSITE : 0));
done:
    return status;
}

/* The class of a link between two samples through a tetrahedron. */
static inline int class_of(const brio_pole_vectors *v, size_t tet, int i, int j) {
    int a = brio_depth_class(v, tet, i), b = brio_depth_class(v, tet, j);
    return a > b ? a : b;
}

/* --- links through poles --- */

/* Links a sample to the others of a tetrahedron, one of its poles. */
static inline void link_pole(const brio_pole_vectors *d, uint32_t p, uint32_t tet, sample_link *link, uint8_t *kind) {
    const uint32_t *v = d->t.tet[tet].vertex;
    int slot = brio_slot_of_vertex(v, p), side = brio_side_of(d, tet, slot);
    for (int i = 0; i < LINKS_OF_POLE; i++) {
        int at = (slot + 1 + i) & 3, other = brio_side_of(d, tet, at); /* of the infinite vertex: BRIO_SIDE_COCONE */
        kind[i] = NO_LINK;
        if (other == BRIO_SIDE_COCONE || side == BRIO_SIDE_COCONE) continue;
        const uint32_t *poles = d->pole + 2 * (size_t)v[at];
        if (v[at] < p && (poles[0] == tet || poles[1] == tet)) continue; /* that one has linked the two */
        kind[i] = (uint8_t)(class_of(d, tet, slot, at) | (side != other ? OPPOSITE : 0));
        link[i] = (sample_link){p, v[at], tet};
    }
}

static brio_status link_poles(forest *f) {
    brio_status status = BRIO_OK;
    const brio_pole_vectors *v = f->cocones->dual;
    size_t poles = 2 * v->num_points;
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->link, f->link_capacity, LINKS_OF_POLE * poles));
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->kind, f->kind_capacity, LINKS_OF_POLE * poles));
    f->num_links = LINKS_OF_POLE * poles;
    BRIO_OMP(parallel for schedule(static) num_threads(brio_context_threads(f->ctx)))
    for (size_t i = 0; i < poles; i++) {
        if (i + AHEAD < poles && v->pole[i + AHEAD] != BRIO_INFINITE) __builtin_prefetch(&v->t.tet[v->pole[i + AHEAD]]);
        sample_link *link = f->link + LINKS_OF_POLE * i;
        uint8_t *kind = f->kind + LINKS_OF_POLE * i;
        if (v->pole[i] != BRIO_INFINITE)
            link_pole(v, (uint32_t)(i / 2), v->pole[i], link, kind);
        else
            for (int j = 0; j < LINKS_OF_POLE; j++) kind[j] = NO_LINK;
    }
done:
    return status;
}

/* --- links along candidates --- */

static brio_status link_edge(forest *f, uint32_t p, uint32_t q) {
    double cosine = cosine_of(f->cocones->dual, p, q), square = 1 - cosine * cosine;
    if (f->parent[p] == f->parent[q]) return BRIO_OK;
    int class = (square > 0x1p-8) + (square > 0x1p-6) + (square > 0x1p-4);
    return add_link(f, (sample_link){p, q, NO_TET}, cosine < 0, class);
}

static brio_status link_candidates(forest *f) {
    brio_status status = BRIO_OK;
    const brio_tetrahedra *t = &f->cocones->dual->t;
    for (size_t tet = 0; f->num_pieces > 1 && tet < t->count; tet++)
        for (int i = 0; f->cocones->candidates[tet] && i < 4; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i);
            const uint32_t *v = t->tet[tet].vertex;
            const uint8_t *corner = BRIO_FACET[i];
            if (!brio_is_candidate(f->cocones, facet) || *brio_mate(t, facet) < facet) continue;
            for (int k = 0; k < 3; k++) BRIO_TRY(link_edge(f, v[corner[k]], v[corner[(k + 1) % 3]]));
        }
done:
    return status;
}

/* --- links between pieces --- */

static brio_status link_across(forest *f, size_t tet) {
    brio_status status = BRIO_OK;
    const uint32_t *v = f->cocones->dual->t.tet[tet].vertex;
    const brio_pole_vectors *d = f->cocones->dual;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i && brio_side_of(d, tet, i) != BRIO_SIDE_COCONE; j++) {
            if (brio_side_of(d, tet, j) == BRIO_SIDE_COCONE || f->parent[v[i]] == f->parent[v[j]]) continue;
            BRIO_TRY(add_link(f, (sample_link){v[i], v[j], (uint32_t)tet},
                              brio_side_of(d, tet, i) != brio_side_of(d, tet, j), class_of(d, tet, i, j)));
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
static void count_outwards(const forest *f, int64_t *outwards) {
    const brio_pole_vectors *v = f->cocones->dual;
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int i = 0; i < 3; i++) {
            int side = brio_side_of(v, tet, i);
            uint32_t p = v->t.tet[tet].vertex[i];
            bool along = (side == BRIO_SIDE_POLE) == (f->opposite[p] == 0);
            if (side != BRIO_SIDE_COCONE) outwards[f->parent[p]] += along ? 1 : -1;
        }
}

/* Whether the pieces are to be turned so that most of what they have on the hull looks outwards; where that is even, so
 * that the sample of least position keeps its sign. */
static void choose_turns(const forest *f, const int64_t *outwards, uint32_t *least, uint8_t *turn) {
    const double *points = f->cocones->dual->points;
    size_t n = f->cocones->dual->num_points;
    for (size_t p = 0; p < n; p++) least[p] = (uint32_t)p;
    for (size_t p = 0; p < n; p++) {
        uint32_t root = f->parent[p];
        if (brio_lexicographic(points + 3 * p, points + 3 * (size_t)least[root]) < 0) least[root] = (uint32_t)p;
    }
    for (size_t p = 0; p < n; p++)
        if (f->parent[p] == p) turn[p] = outwards[p] ? outwards[p] < 0 : f->opposite[least[p]];
}

static brio_status sign_samples(const forest *f, uint8_t *turned) {
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
    for (size_t p = 0; p < n; p++) turned[p] = f->opposite[p] ^ turn[f->parent[p]];
    BRIO_TRY(brio_progress(f->ctx, "orientation", 1));
done:
    brio_release(f->ctx, outwards);
    brio_release(f->ctx, least);
    brio_release(f->ctx, turn);
    return status;
}

brio_status brio_orient_samples(brio_context *ctx, const brio_cocones *c, uint8_t **turned) {
    brio_status status = BRIO_OK;
    size_t n = c->dual->num_points;
    forest f = {.ctx = ctx, .cocones = c, .num_pieces = c->dual->num_vertices};
    *turned = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, f.parent, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f.opposite, n));
    for (size_t p = 0; p < n; p++) f.parent[p] = (uint32_t)p;
    BRIO_TRY(link_poles(&f));
    BRIO_TRY(join_links(&f));
    BRIO_TRY(link_candidates(&f));
    BRIO_TRY(join_links(&f));
    BRIO_TRY(link_pieces(&f));
    BRIO_TRY(join_links(&f));
    BRIO_TRY(BRIO_ALLOC(ctx, *turned, n));
    BRIO_TRY(sign_samples(&f, *turned));
done:
    brio_release(ctx, f.parent);
    brio_release(ctx, f.opposite);
    brio_release(ctx, f.link);
    brio_release(ctx, f.kind);
    if (status != BRIO_OK) {
        brio_release(ctx, *turned);
        *turned = NULL;
    }
    return status;
}
