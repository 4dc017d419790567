/* Signs of axes that agree along the sheets of a surface.
 *
 * Two samples near each other are tied: their axes tell, by log-odds, whether they have one sign (axis_agreement.h).
 * Every sample is a piece at first. In rounds, each piece is joined with the one that it is tied to most, if that tie
 * is over a limit, which falls from round to round; then the ties between each two pieces are added up. So a few wrong
 * ties in a smooth place change nothing, and what is decided last, between large pieces, is decided by all ties of the
 * seam together. A spanning tree of the best links would decide it by one.
 *
 * What is told of samples, by normals or places of scanners, adds up within a piece. Pieces stay apart that contradict
 * each other more, in log-odds, than they are tied. In the end each looks where it is told to, or else where the hull
 * does, or else as its root does.
 *
 * The root of a piece is its sample of the least hash (hash_order.h), and hashes decide between ties that weigh the
 * same. Sums are those of whole numbers. So signs depend on no number of a sample or a tetrahedron.
 *
 * Poles are not asked: they tell that the back of a sheet sees the front of what is behind it, which makes one of the
 * two look away from the scanner. In a closed surface they would be right, but there neighbours tell enough.
 *
 * Based on: Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface reconstruction from unorganized points. SIGGRAPH 1992.
 *           Boruvka. O jistem problemu minimalnim. 1926 (joining in rounds).
 *           Keuper, Levinkov, Bonneel, Lavoue, Brox, Andres. Efficient decomposition of image and mesh graphs by lifted
 *           multicuts. ICCV 2015 (ties are added up when pieces join). */
#include "reconstruct/labeled_delaunay/sheet_signs.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "base/vector.h"
#include "reconstruct/labeled_delaunay/axis_agreement.h"
#include "reconstruct/labeled_delaunay/hash_order.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* FARTHEST: in spacings, of samples that are tied: the lesser of the two, so that a stray is tied to nothing. FIRST,
 * LAST: limits, in log-odds. ALONG: hull samples with a cosine under this tell nothing of the outside. UNIT: one
 * log-odds. All chosen on scans of models that nothing else was measured on; 4 spacings tie what lies one behind the
 * other. TOLD_UNIT: one log-odds of what is told. */
static const double FARTHEST = 2.5, FIRST = 6, LAST = 1.5, ALONG = 0.5, UNIT = 1024, TOLD_UNIT = 0x1p24;

enum { TETS_A_THREAD = 1 << 12, TIES_A_THREAD = 1 << 12, SAMPLES_A_THREAD = 1 << 13, MOST_WEIGHT = 1 << 30 };

static const uint32_t NO_TIE = UINT32_MAX;

/* Ties, as two arrays, so that a sort of pairs moves the weights. */
typedef struct {
    uint64_t *pair;   /* the roots of two pieces, the less one first (pair_of) */
    uint32_t *weight; /* an int32_t: at least 0 is one sign */
    size_t count, pair_room, weight_room;
} tie_list;

/* The ties that a step leaves of a thread's part: they stand together, from `begin` on. */
typedef struct {
    size_t begin, count;
} rest;

typedef struct {
    brio_context *ctx;
    const brio_pole_vectors *v;
    const double *spacing;
    double noise;
    int bits;        /* of a root in a pair */
    tie_list *found; /* one for each thread */
    brio_status listed;
    tie_list ties;
    rest *left;     /* one for each thread */
    int threads;    /* of a step over the ties */
    uint32_t *up;   /* #P: 2 * parent, plus 1 if the parent's sign is opposite */
    uint32_t *best; /* #P: of roots, the greatest tie */
    int64_t *told;  /* #P, or NULL: of roots, the sum of what is told of their pieces, in TOLD_UNIT */
} signing;

static uint64_t pair_of(const signing *s, uint32_t p, uint32_t q) {
    return p < q ? (uint64_t)p << s->bits | q : (uint64_t)q << s->bits | p;
}
static uint32_t less_end(const signing *s, uint32_t i) {
    return (uint32_t)(s->ties.pair[i] >> s->bits);
}
static uint32_t greater_end(const signing *s, uint32_t i) {
    return (uint32_t)(s->ties.pair[i] & ((UINT64_C(1) << s->bits) - 1));
}
static int32_t weight_of(const signing *s, uint32_t i) {
    return (int32_t)s->ties.weight[i];
}

/* --- ties --- */

static int32_t weigh(const signing *s, uint32_t p, uint32_t q, double distance) {
    const double *a = s->v->plane + 4 * (size_t)p, *b = s->v->plane + 4 * (size_t)q;
    const double *x = s->v->points + 3 * (size_t)p, *y = s->v->points + 3 * (size_t)q;
    double u[3], along = brio_dot(a, b);
    for (int k = 0; k < 3; k++) u[k] = y[k] - x[k];
    double mirrored = along - 2 * brio_dot(a, u) * brio_dot(b, u) / brio_dot(u, u);
    return (int32_t)lrint(UNIT * brio_axis_log_odds(along, mirrored, distance, s->noise));
}

/* Writes the two neighbours of a tetrahedron round its edge p q. */
static void neighbours_round_edge(const brio_tetrahedra *t, uint32_t tet, uint32_t p, uint32_t q, uint32_t beside[2]) {
    const brio_tetrahedron *x = &t->tet[tet];
    for (int k = 0, count = 0; k < 4; k++)
        if (x->vertex[k] != p && x->vertex[k] != q) beside[count++] = brio_tet_of(x->mate[k]);
}

/* Returns whether a tetrahedron is the first one of all round an edge: each edge is tied once. Most are not, which
 * their neighbours tell. */
static bool is_first_round_edge(const brio_tetrahedra *t, uint32_t tet, uint32_t p, uint32_t q) {
    uint32_t beside[2], before = tet;
    neighbours_round_edge(t, tet, p, q, beside);
    uint32_t now = beside[0], last = beside[1];
    if (now < tet || last < tet) return false;
    while (now != last) {
        neighbours_round_edge(t, now, p, q, beside);
        uint32_t next = beside[beside[0] == before];
        if (next < tet) return false;
        before = now, now = next;
    }
    return true;
}

static brio_status tie_edge(const signing *s, uint32_t tet, uint32_t p, uint32_t q, tie_list *l) {
    brio_status status = BRIO_OK;
    const brio_tetrahedra *t = &s->v->t;
    double unit = fmin(s->spacing[p], s->spacing[q]), most = FARTHEST * unit;
    double square = brio_square_distance(s->v->points + 3 * (size_t)p, s->v->points + 3 * (size_t)q);
    if (!(square < most * most) || !is_first_round_edge(t, tet, p, q)) return BRIO_OK;
    int32_t weight = weigh(s, p, q, sqrt(square) / unit);
    if (weight == 0) return BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(s->ctx, l->pair, l->pair_room, l->count + 1));
    BRIO_TRY(BRIO_RESERVE(s->ctx, l->weight, l->weight_room, l->count + 1));
    l->pair[l->count] = pair_of(s, p, q);
    l->weight[l->count++] = (uint32_t)weight;
done:
    return status;
}

static void tie_part(void *user, size_t begin, size_t end, int thread) {
    signing *s = user;
    const brio_tetrahedra *t = &s->v->t;
    brio_status status = BRIO_OK;
    for (uint32_t tet = (uint32_t)begin; tet < end && status == BRIO_OK; tet++)
        for (int i = 1; i < 4; i++)
            for (int k = 0; k < i && status == BRIO_OK; k++) {
                uint32_t p = t->tet[tet].vertex[i], q = t->tet[tet].vertex[k];
                if (p != t->infinite && q != t->infinite) status = tie_edge(s, tet, p, q, &s->found[thread]);
            }
    brio_report(&s->listed, status);
}

static void free_ties(brio_context *ctx, tie_list *l) {
    brio_release(ctx, l->pair);
    brio_release(ctx, l->weight);
    *l = (tie_list){0};
}

/* Lists the ties in the order of the tetrahedra, which the threads divide. */
static brio_status list_ties(signing *s) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(s->ctx, s->v->t.count, TETS_A_THREAD);
    size_t all = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(s->ctx, s->found, (size_t)threads));
    BRIO_TRY(brio_sweep(s->ctx, threads, s->v->t.count, tie_part, s, BRIO_READS(s->v->t.tet)));
    BRIO_TRY(s->listed);
    for (int i = 0; i < threads; i++) all += s->found[i].count;
    BRIO_REQUIRE(s->ctx, all < NO_TIE, BRIO_ERR_TOO_LARGE, "%zu ties between samples, 2^32 is the limit", all);
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->ties.pair, all));
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->ties.weight, all));
    for (int i = 0; i < threads; i++) {
        tie_list *l = &s->found[i];
        if (l->count) memcpy(s->ties.pair + s->ties.count, l->pair, l->count * sizeof *l->pair);
        if (l->count) memcpy(s->ties.weight + s->ties.count, l->weight, l->count * sizeof *l->weight);
        s->ties.count += l->count;
        free_ties(s->ctx, l);
    }
done:
    for (int i = 0; s->found && i < threads; i++) free_ties(s->ctx, &s->found[i]);
    brio_release(s->ctx, s->found);
    return status;
}

/* --- steps over the ties ---
 *
 * Each thread goes along its part of the ties, and moves what is left to the beginning of its part; then the parts move
 * together. */

static brio_status step_over_ties(signing *s, brio_part_fn step) {
    brio_status status = BRIO_OK;
    tie_list *l = &s->ties;
    size_t at = 0;
    s->threads = brio_threads(s->ctx, l->count, TIES_A_THREAD);
    BRIO_TRY(BRIO_ALLOC_ZERO(s->ctx, s->left, (size_t)s->threads));
    BRIO_TRY(brio_sweep(s->ctx, s->threads, l->count, step, s, BRIO_WRITES(l->pair), BRIO_WRITES(l->weight)));
    for (int t = 0; t < s->threads; at += s->left[t++].count) {
        const rest *left = &s->left[t];
        memmove(l->pair + at, l->pair + left->begin, left->count * sizeof *l->pair);
        memmove(l->weight + at, l->weight + left->begin, left->count * sizeof *l->weight);
    }
    l->count = at;
done:
    brio_release(s->ctx, s->left);
    return status;
}

/* Keeps a tie of a thread's part. A pair that is where it belongs is not written: the next thread may look at it. */
static void keep_tie(const signing *s, rest *left, uint64_t pair, int32_t weight) {
    size_t at = left->begin + left->count++;
    if (s->ties.pair[at] != pair) s->ties.pair[at] = pair;
    s->ties.weight[at] = (uint32_t)weight;
}

/* Returns 2 * root of p, plus 1 if the root's sign is opposite to that of p. Halves the path on its way: while no piece
 * is joined, threads may call this together, since what they write of a sample leads to the same root. */
static uint32_t find_root(const signing *s, uint32_t p) {
    uint32_t sign = 0;
    for (;;) {
        uint32_t up = __atomic_load_n(&s->up[p], __ATOMIC_RELAXED);
        uint32_t next = __atomic_load_n(&s->up[up >> 1], __ATOMIC_RELAXED) ^ (up & 1);
        sign ^= next & 1;
        if (up >> 1 == next >> 1) return (next & ~UINT32_C(1)) | sign;
        __atomic_store_n(&s->up[p], next, __ATOMIC_RELAXED);
        p = next >> 1;
    }
}

/* Lets ties hold between roots, and drops those within pieces. */
static void lift_part(void *user, size_t begin, size_t end, int thread) {
    const signing *s = user;
    rest *left = &s->left[thread];
    left->begin = brio_part(s->ties.count, thread, s->threads);
    for (uint32_t i = (uint32_t)begin; i < end; i++) {
        uint32_t a = find_root(s, less_end(s, i)), b = find_root(s, greater_end(s, i));
        int32_t weight = weight_of(s, i);
        if (a >> 1 != b >> 1) keep_tie(s, left, pair_of(s, a >> 1, b >> 1), (a ^ b) & 1 ? -weight : weight);
    }
}

static int32_t bounded(int64_t sum) {
    return (int32_t)(sum > MOST_WEIGHT ? MOST_WEIGHT : sum < -MOST_WEIGHT ? -MOST_WEIGHT : sum);
}

/* Adds up the ties of each pair: they are one after another. Who finds the first adds all. */
static void add_part(void *user, size_t begin, size_t end, int thread) {
    const signing *s = user;
    const uint64_t *pair = s->ties.pair;
    rest *left = &s->left[thread];
    size_t i = begin;
    while (i > 0 && i < end && pair[i] == pair[i - 1]) i++;
    if (left->count == 0) left->begin = i;
    while (i < end) {
        int64_t sum = 0;
        uint64_t of = pair[i];
        for (; i < s->ties.count && pair[i] == of; i++) sum += weight_of(s, (uint32_t)i);
        keep_tie(s, left, of, bounded(sum));
    }
}

#ifndef NDEBUG
static bool pairs_ascend(const tie_list *l) {
    for (size_t i = 1; i < l->count; i++)
        if (l->pair[i - 1] >= l->pair[i]) return false;
    return true;
}
#endif

/* Lets ties hold between the pieces that there are now, one between each two. */
static brio_status lift_ties(signing *s) {
    BRIO_FORWARD(step_over_ties(s, lift_part));
    BRIO_FORWARD(brio_radix_sort(s->ctx, s->ties.pair, s->ties.weight, s->ties.count, 2 * s->bits));
    BRIO_FORWARD(step_over_ties(s, add_part));
    assert(pairs_ascend(&s->ties));
    return BRIO_OK;
}

/* --- pieces --- */

/* Returns how much of what is told of two pieces, in log-odds, is lost if they are joined, with opposite signs or
 * not. */
static double lost(const signing *s, uint32_t a, uint32_t b, bool opposite) {
    if (!s->told) return 0;
    int64_t both = s->told[a] + (opposite ? -s->told[b] : s->told[b]);
    return (double)(llabs(s->told[a]) + llabs(s->told[b]) - llabs(both)) / TOLD_UNIT;
}

static bool is_worth(const signing *s, uint32_t i) {
    return abs(weight_of(s, i)) > UNIT * lost(s, less_end(s, i), greater_end(s, i), weight_of(s, i) < 0);
}

/* Returns whether sample p has a less hash than q. */
static bool comes_before(const signing *s, uint32_t p, uint32_t q) {
    return brio_compare_hashes(p, q, s->v->points) < 0;
}

/* Returns whether a tie of a root is better than another one of it. Of two that weigh the same the other end decides:
 * this is the order of the pairs, the less end first, so ties that weigh the same make no circles. */
static bool is_better(const signing *s, uint32_t root, uint32_t i, uint32_t than) {
    int32_t weight = abs(weight_of(s, i)), other = abs(weight_of(s, than));
    if (weight != other) return weight > other;
    return comes_before(s, less_end(s, i) ^ greater_end(s, i) ^ root, less_end(s, than) ^ greater_end(s, than) ^ root);
}

/* Lets a root have tie i if it is its best one so far. Threads may call this together. */
static void offer(const signing *s, uint32_t root, uint32_t i) {
    uint32_t best = __atomic_load_n(&s->best[root], __ATOMIC_RELAXED);
    while ((best == NO_TIE || is_better(s, root, i, best)) &&
           !__atomic_compare_exchange_n(&s->best[root], &best, i, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
}

static void offer_part(void *user, size_t begin, size_t end, int thread) {
    const signing *s = user;
    (void)thread;
    for (uint32_t i = (uint32_t)begin; i < end; i++)
        if (is_worth(s, i)) offer(s, less_end(s, i), i), offer(s, greater_end(s, i), i);
}

/* Joins the pieces of tie i, if it is still worth that. Returns whether it is. */
static bool join(const signing *s, uint32_t i) {
    int32_t weight = weight_of(s, i);
    uint32_t a = find_root(s, less_end(s, i)), b = find_root(s, greater_end(s, i));
    uint32_t opposite = (a & 1) ^ (b & 1) ^ (weight < 0);
    if (a >> 1 == b >> 1 || abs(weight) <= UNIT * lost(s, a >> 1, b >> 1, opposite)) return false;
    bool first = comes_before(s, a >> 1, b >> 1);
    uint32_t up = (first ? a : b) >> 1, down = (first ? b : a) >> 1;
    s->up[down] = up << 1 | opposite;
    if (s->told) s->told[up] += opposite ? -s->told[down] : s->told[down];
    return true;
}

/* Lists the roots whose best tie is over a limit. Where things are told, what is joined first changes what is worth
 * joining: so the best ties come first, and of those that weigh the same the root of the least hash. */
static brio_status list_best(const signing *s, double limit, uint32_t *root, size_t *count) {
    brio_status status = BRIO_OK;
    uint64_t *key = NULL;
    *count = 0;
    for (size_t p = 0; p < s->v->num_points; p++)
        if (s->best[p] != NO_TIE && abs(weight_of(s, s->best[p])) >= UNIT * limit) root[(*count)++] = (uint32_t)p;
    if (!s->told) goto done;
    BRIO_TRY(BRIO_ALLOC(s->ctx, key, *count));
    for (size_t i = 0; i < *count; i++) key[i] = brio_position_hash(s->v->points + 3 * (size_t)root[i]);
    BRIO_TRY(brio_radix_sort(s->ctx, key, root, *count, 64));
    for (size_t i = 0; i < *count; i++) key[i] = (uint64_t)(MOST_WEIGHT - abs(weight_of(s, s->best[root[i]])));
    BRIO_TRY(brio_radix_sort(s->ctx, key, root, *count, 32));
done:
    brio_release(s->ctx, key);
    return status;
}

/* Joins each piece with the one that it is tied to most.   joined  receives how many pieces vanish. */
static brio_status join_pieces(signing *s, double limit, size_t *joined) {
    brio_status status = BRIO_OK;
    uint32_t *root = NULL;
    size_t count, ties = s->ties.count;
    *joined = 0;
    for (size_t p = 0; p < s->v->num_points; p++) s->best[p] = NO_TIE;
    BRIO_TRY(brio_sweep(s->ctx, brio_threads(s->ctx, ties, TIES_A_THREAD), ties, offer_part, s,
                        BRIO_READS(s->ties.pair), BRIO_READS(s->ties.weight)));
    BRIO_TRY(BRIO_ALLOC(s->ctx, root, s->v->num_points));
    BRIO_TRY(list_best(s, limit, root, &count));
    for (size_t i = 0; i < count; i++) *joined += join(s, s->best[root[i]]);
done:
    brio_release(s->ctx, root);
    return status;
}

static brio_status join_all(signing *s) {
    brio_status status = BRIO_OK;
    size_t joined;
    for (double limit = FIRST; limit >= LAST; limit /= 2)
        for (;;) {
            BRIO_TRY(join_pieces(s, limit, &joined));
            if (joined == 0) break;
            BRIO_TRY(lift_ties(s));
        }
done:
    return status;
}

/* --- signs --- */

/* Counts for each root how often its piece looks outwards on the hull, minus how often it looks inwards. */
static void count_outwards(const signing *s, int64_t *outwards) {
    const brio_pole_vectors *v = s->v;
    double to[3];
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int i = 0; i < 3; i++) {
            uint32_t p = v->t.tet[tet].vertex[i], root = find_root(s, p);
            brio_towards_centre(v, tet, p, to);
            double along = brio_dot(to, v->plane + 4 * (size_t)p);
            if (fabs(along) > ALONG) outwards[root >> 1] += (along < 0) == (root & 1) ? 1 : -1;
        }
}

/* What is written of the samples. */
typedef struct {
    const signing *s;
    const int64_t *outwards;
    uint8_t *turned, *alone;
} signs;

static void write_signs(void *user, size_t begin, size_t end, int thread) {
    const signs *w = user;
    const signing *s = w->s;
    (void)thread;
    for (uint32_t p = (uint32_t)begin; p < end; p++) {
        uint32_t sign = find_root(s, p), root = sign >> 1;
        bool is_told = s->told && s->told[root] != 0;
        bool opposite = is_told ? s->told[root] < 0 : w->outwards[root] < 0;
        w->turned[p] = (uint8_t)((sign & 1) ^ opposite);
        if (root == p) continue;
        __atomic_store_n(&w->alone[p], 0, __ATOMIC_RELAXED);
        __atomic_store_n(&w->alone[root], 0, __ATOMIC_RELAXED);
    }
}

brio_status brio_sign_sheets(brio_context *ctx, const brio_pole_vectors *v, const brio_sheet_samples *samples,
                             uint8_t *turned, uint8_t *alone) {
    brio_status status = BRIO_OK;
    const float *told = samples->told;
    size_t n = v->num_points;
    signing s = {.ctx = ctx, .v = v, .spacing = samples->spacing, .noise = samples->noise, .bits = 1};
    int64_t *outwards = NULL;
    BRIO_REQUIRE(ctx, n < UINT32_C(1) << 31, BRIO_ERR_TOO_LARGE, "%zu points; signs of axes take less than 2^31", n);
    BRIO_TRY(BRIO_ALLOC(ctx, s.up, n));
    BRIO_TRY(BRIO_ALLOC(ctx, s.best, n));
    if (told) BRIO_TRY(BRIO_ALLOC(ctx, s.told, n));
    while (n >> s.bits) s.bits++;
    for (size_t p = 0; p < n; p++) s.up[p] = (uint32_t)(2 * p);
    for (size_t p = 0; p < n && told; p++) s.told[p] = (int64_t)(TOLD_UNIT * (double)told[p]);
    BRIO_TRY(list_ties(&s));
    BRIO_TRY(join_all(&s));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, outwards, n));
    count_outwards(&s, outwards);
    memset(alone, 1, n);
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, n, SAMPLES_A_THREAD), n, write_signs,
                      &(signs){.s = &s, .outwards = outwards, .turned = turned, .alone = alone}));
done:
    brio_release(ctx, s.up);
    brio_release(ctx, s.best);
    free_ties(ctx, &s.ties);
    brio_release(ctx, outwards);
    brio_release(ctx, s.told);
    return status;
}
