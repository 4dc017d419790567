/* The orientation of samples: whether the pole of a sample is outside or inside.
 *
 * Every sample knows the axis of its surface normal, up to sign. Signs are chosen to agree along a spanning forest, by
 * Kruskal's algorithm. Its union-find stores for each element whether its sign is that of its parent. Three kinds of
 * links follow each other:
 * 1. Two samples see one pole in one of their cones. Links whose samples see the pole nearest to their axes come first.
 * 2. Edges of candidates between pieces that are not joined yet. Links with the most nearly parallel axes come first.
 * 3. Other tetrahedra that two samples see in their cones.
 * Finally each piece is turned so that the hull sees its outside.
 *
 * Links that agree with each other give one result in any order. So all links of the first kind, except those of the
 * worst class, are joined as they are found, and kept unless there is a contradiction. In dense samples there is none,
 * and few links are left. The remaining links are not sorted but divided into a few classes by weight. Only a class
 * with a contradiction is undone and joined again in the order of weights. Links within a piece of earlier classes
 * change nothing and are left out, even if they contradict.
 *
 * Based on: Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface reconstruction from unorganized points. SIGGRAPH 1992,
 *           for signs along a spanning tree of parallel normals. */
#include "reconstruct/cocone/sample_orientation.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include <string.h>

/* A link between two samples whose axes have equal or opposite signs: both see one tetrahedron in a cone, or they are
 * the ends of a candidate's edge. */
typedef struct {
    uint32_t a, b, tet; /* tet is NO_TET for an edge */
} sample_link;

/* KEY_BITS: of the sort key of a link. AHEAD: how far ahead links are prefetched. The last two are chosen. */
enum { KEY_BITS = 32, AHEAD = 16, LINKS_A_THREAD = 1 << 12 };

static const uint32_t NO_TET = UINT32_MAX;

/* kind[i]: the class of link i, plus OPPOSITE if the signs are opposite. */
enum { OPPOSITE = 0x80 };

typedef struct {
    brio_context *ctx;
    const brio_cocones *cocones;
    const brio_pole_vectors *dual;
    uint32_t *up;      /* #P: 2 * parent, plus 1 if the parent's sign is opposite */
    size_t num_pieces; /* pieces that the vertices form */
    sample_link *link;
    uint8_t *kind;
    size_t num_links, link_capacity, kind_capacity;
} forest;

/* Makes every sample a piece. */
static void take_apart(forest *f) {
    for (size_t p = 0; p < f->dual->num_points; p++) f->up[p] = (uint32_t)(2 * p);
    f->num_pieces = f->dual->num_vertices;
}

/* Returns 2 * root of x, plus 1 if the root's sign is opposite to that of x. Halves the path on its way. */
static inline uint32_t find_root(forest *f, uint32_t x) {
    uint32_t sign = 0;
    for (;;) {
        uint32_t up = f->up[x], next = f->up[up >> 1] ^ (up & 1);
        sign ^= next & 1;
        if (up >> 1 == next >> 1) return (next & ~UINT32_C(1)) | sign;
        f->up[x] = next;
        x = next >> 1;
    }
}

/* Makes the root of every sample its parent. */
static void flatten(forest *f) {
    for (size_t p = 0; p < f->dual->num_points; p++) f->up[p] = find_root(f, (uint32_t)p);
}

/* Joins the piece of p to a root, with the same or the opposite sign. `root` is what find_root returned for another
 * sample; it stays a root. Returns false if this contradicts earlier links. */
static inline bool join_to_root(forest *f, uint32_t root, uint32_t p, uint32_t opposite) {
    uint32_t other = find_root(f, p);
    if (root >> 1 == other >> 1) return ((root ^ other) & 1) == opposite;
    f->up[other >> 1] = root ^ (other & 1) ^ opposite;
    f->num_pieces--;
    return true;
}

static inline bool join_link(forest *f, size_t i) {
    return join_to_root(f, find_root(f, f->link[i].a), f->link[i].b, f->kind[i] >= OPPOSITE);
}

/* Returns the squared cosine of the angle between a sample's axis and its direction to the Voronoi vertex of a
 * tetrahedron. */
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

/* Returns the sort key of a link: the best link of a class has the least key. */
static uint32_t key_of(const forest *f, const sample_link *l) {
    const brio_pole_vectors *v = f->dual;
    double cosine = l->tet == NO_TET ? cosine_of(v, l->a, l->b) : 0;
    double weight = l->tet == NO_TET ? cosine * cosine : fmin(depth(v, l->tet, l->a), depth(v, l->tet, l->b));
    return (uint32_t)((weight < 1 ? 1 - weight : 0) * UINT32_MAX);
}

/* Compares links of equal weight by the positions of their ends, the lesser end first. */
static int compare_links(uint32_t i, uint32_t j, const void *user) {
    const forest *f = user;
    const double *points = f->dual->points, *end[2][2];
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

/* Returns whether a link belongs to a class and joins two pieces that were apart before the class.   before  f->up,
 * flat, before the class. */
static inline bool is_of(const forest *f, size_t i, int class, const uint32_t *before) {
    return (f->kind[i] & ~OPPOSITE) == class && before[f->link[i].a] >> 1 != before[f->link[i].b] >> 1;
}

/* Joins the links of a class in any order. Returns false at a contradiction. */
static bool join_unsorted(forest *f, int class, const uint32_t *before) {
    for (size_t i = 0; i < f->num_links; i++)
        if (is_of(f, i, class, before) && !join_link(f, i)) return false;
    return true;
}

/* The links of a class, and their keys. */
typedef struct {
    const forest *f;
    uint32_t *link;
    uint64_t *key;
} keyed_links;

static void find_keys(void *user, size_t begin, size_t end, int thread) {
    const keyed_links *k = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) k->key[i] = key_of(k->f, &k->f->link[k->link[i]]);
}

/* Joins the links of a class in the order of their weights. Links that contradict earlier ones are ignored. */
static brio_status join_sorted(forest *f, int class, const uint32_t *before) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    uint64_t *keys = NULL;
    size_t count = 0, capacity = 0;
    for (size_t i = 0; i < f->num_links; i++) {
        if (!is_of(f, i, class, before)) continue;
        BRIO_TRY(BRIO_RESERVE(f->ctx, order, capacity, count + 1));
        order[count++] = (uint32_t)i;
    }
    BRIO_TRY(BRIO_ALLOC(f->ctx, keys, count));
    BRIO_TRY(brio_for(f->ctx, brio_threads(f->ctx, count, LINKS_A_THREAD), count, find_keys,
                      &(keyed_links){f, order, keys}));
    BRIO_TRY(brio_radix_sort(f->ctx, keys, order, count, KEY_BITS));
    for (size_t begin = 0, end; begin < count; begin = end) {
        for (end = begin + 1; end < count && keys[end] == keys[begin];) end++;
        brio_sort_indices(order + begin, end - begin, compare_links, f);
    }
    for (size_t i = 0; i < count; i++) {
        if (i + 2 * AHEAD < count) __builtin_prefetch(&f->link[order[i + 2 * AHEAD]]);
        if (i + AHEAD < count) __builtin_prefetch(&f->up[f->link[order[i + AHEAD]].a]);
        if (i + AHEAD < count) __builtin_prefetch(&f->up[f->link[order[i + AHEAD]].b]);
        join_link(f, order[i]);
    }
done:
    brio_release(f->ctx, order);
    brio_release(f->ctx, keys);
    return status;
}

/* Joins all links, the best class first, and empties the list of links. */
static brio_status join_links(forest *f) {
    brio_status status = BRIO_OK;
    size_t n = f->dual->num_points;
    uint32_t *before = NULL; /* f->up, flat, before the class at hand */
    BRIO_REQUIRE(f->ctx, f->num_links < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu links between samples, 2^32 is the limit",
                 f->num_links);
    if (f->num_links > 0) BRIO_TRY(BRIO_ALLOC(f->ctx, before, n));
    for (int class = 0; class < BRIO_DEPTHS && f->num_links > 0 && f->num_pieces > 1; class ++) {
        size_t pieces = f->num_pieces;
        memcpy(before, f->up, n * sizeof *before);
        if (!join_unsorted(f, class, before)) {
            f->num_pieces = pieces;
            memcpy(f->up, before, n * sizeof *before);
            BRIO_TRY(join_sorted(f, class, before));
        }
        if (f->num_pieces < pieces) flatten(f);
    }
    f->num_links = 0;
done:
    brio_release(f->ctx, before);
    return status;
}

/* Returns whether two samples are in different pieces. The forest must be flat. */
static inline bool are_apart(const forest *f, uint32_t p, uint32_t q) {
    return f->up[p] >> 1 != f->up[q] >> 1;
}

/* Adds a link. */
static brio_status add_link(forest *f, sample_link link, bool opposite, int class) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->link, f->link_capacity, f->num_links + 1));
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->kind, f->kind_capacity, f->num_links + 1));
    f->link[f->num_links] = link;
    f->kind[f->num_links++] = (uint8_t)(class | (opposite ? OPPOSITE : 0));
done:
    return status;
}

/* Returns the class of a link between the samples in slots i and j of a tetrahedron, the worse of the two. */
static inline int class_of(const brio_pole_vectors *v, size_t tet, int i, int j) {
    int a = brio_depth_class(v, tet, i), b = brio_depth_class(v, tet, j);
    return a > b ? a : b;
}

/* --- links through poles --- */

/* Joins the samples that see a tetrahedron in a cone, except samples of the worst class. Returns false at a
 * contradiction. */
static bool join_samples_of(forest *f, size_t tet) {
    const uint32_t *v = f->dual->t.tet[tet].vertex;
    unsigned sides = f->dual->sides[tet], antipole = brio_antipole_slots(sides);
    unsigned left = (brio_pole_slots(sides) | antipole) & ~brio_shallow_slots(sides);
    if ((left & (left - 1)) == 0) return true;
    int first = __builtin_ctz(left);
    uint32_t root = find_root(f, v[first]) ^ (antipole >> first & 1);
    while (left &= left - 1) {
        int other = __builtin_ctz(left);
        if (!join_to_root(f, root, v[other], antipole >> other & 1)) return false;
    }
    return true;
}

/* Joins the samples of each pole. If there is a contradiction, undoes all of this. */
static brio_status join_at_poles(forest *f) {
    brio_status status = BRIO_OK;
    const brio_pole_vectors *v = f->dual;
    uint8_t *is_pole = NULL; /* #T */
    bool agree = true;
    BRIO_TRY(BRIO_ALLOC_ZERO(f->ctx, is_pole, v->t.count));
    for (size_t i = 0; i < 2 * v->num_points; i++)
        if (v->pole[i] != BRIO_INFINITE) is_pole[v->pole[i]] = 1;
    for (size_t tet = 0; tet < v->t.count && agree; tet++)
        if (is_pole[tet]) agree = join_samples_of(f, tet);
    if (!agree) take_apart(f);
    flatten(f);
done:
    brio_release(f->ctx, is_pole);
    return status;
}

/* Links sample p to the samples of other pieces in tetrahedron tet, a pole of p, that see tet in a cone. */
static brio_status link_pole(forest *f, uint32_t p, uint32_t tet) {
    brio_status status = BRIO_OK;
    const brio_pole_vectors *d = f->dual;
    const uint32_t *v = d->t.tet[tet].vertex;
    int slot = brio_slot_of_vertex(v, p), side = brio_side_of(d, tet, slot);
    for (int i = 1; i < 4 && side != BRIO_SIDE_COCONE; i++) {
        int at = (slot + i) & 3, other = brio_side_of(d, tet, at); /* BRIO_SIDE_COCONE for the infinite vertex */
        if (other == BRIO_SIDE_COCONE || !are_apart(f, p, v[at])) continue;
        const uint32_t *poles = d->pole + 2 * (size_t)v[at];
        if (v[at] < p && (poles[0] == tet || poles[1] == tet)) continue; /* the call for v[at] has added it */
        BRIO_TRY(add_link(f, (sample_link){p, v[at], tet}, side != other, class_of(d, tet, slot, at)));
    }
done:
    return status;
}

static brio_status link_poles(forest *f) {
    brio_status status = BRIO_OK;
    const brio_pole_vectors *v = f->dual;
    size_t poles = 2 * v->num_points;
    for (size_t i = 0; i < poles && f->num_pieces > 1; i++) {
        if (i + AHEAD < poles && v->pole[i + AHEAD] != BRIO_INFINITE) __builtin_prefetch(&v->t.tet[v->pole[i + AHEAD]]);
        if (v->pole[i] != BRIO_INFINITE) BRIO_TRY(link_pole(f, (uint32_t)(i / 2), v->pole[i]));
    }
done:
    return status;
}

/* --- links along candidates --- */

static brio_status link_edge(forest *f, uint32_t p, uint32_t q) {
    double cosine = cosine_of(f->dual, p, q), square = 1 - cosine * cosine;
    if (!are_apart(f, p, q)) return BRIO_OK;
    int class = (square > 0x1p-8) + (square > 0x1p-6) + (square > 0x1p-4);
    return add_link(f, (sample_link){p, q, NO_TET}, cosine < 0, class);
}

static brio_status link_candidates(forest *f) {
    brio_status status = BRIO_OK;
    const brio_tetrahedra *t = &f->dual->t;
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
    const uint32_t *v = f->dual->t.tet[tet].vertex;
    const brio_pole_vectors *d = f->dual;
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < i && brio_side_of(d, tet, i) != BRIO_SIDE_COCONE; j++) {
            if (brio_side_of(d, tet, j) == BRIO_SIDE_COCONE || !are_apart(f, v[i], v[j])) continue;
            BRIO_TRY(add_link(f, (sample_link){v[i], v[j], (uint32_t)tet},
                              brio_side_of(d, tet, i) != brio_side_of(d, tet, j), class_of(d, tet, i, j)));
        }
done:
    return status;
}

static brio_status link_pieces(forest *f) {
    brio_status status = BRIO_OK;
    for (size_t tet = 0; f->num_pieces > 1 && tet < f->dual->t.count; tet++) BRIO_TRY(link_across(f, tet));
done:
    return status;
}

/* --- signs --- */

/* Counts for each root how often its piece looks outwards on the hull, minus how often it looks inwards. */
static void count_outwards(const forest *f, int64_t *outwards) {
    const brio_pole_vectors *v = f->dual;
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int i = 0; i < 3; i++) {
            int side = brio_side_of(v, tet, i);
            uint32_t p = v->t.tet[tet].vertex[i];
            bool along = (side == BRIO_SIDE_POLE) == !(f->up[p] & 1);
            if (side != BRIO_SIDE_COCONE) outwards[f->up[p] >> 1] += along ? 1 : -1;
        }
}

/* Decides for each piece whether to turn it. A piece is turned so that most of its part of the hull looks outwards.
 * Where the counts are even, the sample of least position keeps its sign. */
static void choose_turns(const forest *f, const int64_t *outwards, uint32_t *least, uint8_t *turn) {
    const double *points = f->dual->points;
    size_t n = f->dual->num_points;
    for (size_t p = 0; p < n; p++) least[p] = (uint32_t)p;
    for (size_t p = 0; p < n; p++) {
        uint32_t root = f->up[p] >> 1;
        if (brio_lexicographic(points + 3 * p, points + 3 * (size_t)least[root]) < 0) least[root] = (uint32_t)p;
    }
    for (size_t p = 0; p < n; p++)
        if (f->up[p] >> 1 == p) turn[p] = outwards[p] ? outwards[p] < 0 : f->up[least[p]] & 1;
}

static brio_status sign_samples(const forest *f, uint8_t *turned) {
    brio_status status = BRIO_OK;
    size_t n = f->dual->num_points;
    int64_t *outwards = NULL;
    uint32_t *least = NULL; /* of each root: the sample of its piece with the least position */
    uint8_t *turn = NULL;   /* of each root: 1 if its piece is turned */
    BRIO_TRY(BRIO_ALLOC_ZERO(f->ctx, outwards, n));
    BRIO_TRY(BRIO_ALLOC(f->ctx, least, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(f->ctx, turn, n));
    count_outwards(f, outwards);
    choose_turns(f, outwards, least, turn);
    for (size_t p = 0; p < n; p++) turned[p] = (uint8_t)(f->up[p] & 1) ^ turn[f->up[p] >> 1];
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
    forest f = {.ctx = ctx, .cocones = c, .dual = c->dual};
    *turned = NULL;
    BRIO_REQUIRE(ctx, n < UINT32_C(1) << 31, BRIO_ERR_TOO_LARGE, "%zu points; the co-cone takes less than 2^31", n);
    BRIO_TRY(BRIO_ALLOC(ctx, f.up, n));
    take_apart(&f);
    BRIO_TRY(join_at_poles(&f));
    BRIO_TRY(link_poles(&f));
    BRIO_TRY(join_links(&f));
    BRIO_TRY(link_candidates(&f));
    BRIO_TRY(join_links(&f));
    BRIO_TRY(link_pieces(&f));
    BRIO_TRY(join_links(&f));
    BRIO_TRY(BRIO_ALLOC(ctx, *turned, n));
    BRIO_TRY(sign_samples(&f, *turned));
done:
    brio_release(ctx, f.up);
    brio_release(ctx, f.link);
    brio_release(ctx, f.kind);
    if (status != BRIO_OK) {
        brio_release(ctx, *turned);
        *turned = NULL;
    }
    return status;
}
