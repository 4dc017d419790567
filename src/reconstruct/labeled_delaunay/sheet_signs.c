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

enum { TETS_A_THREAD = 1 << 12, MOST_WEIGHT = 1 << 30 };

static const uint32_t NO_TIE = UINT32_MAX;

typedef struct {
    uint32_t a, b;  /* roots of pieces, a < b */
    int32_t weight; /* at least 0: one sign */
} tie;

/* What one thread finds. */
typedef struct {
    tie *ties;
    size_t count, capacity;
} tie_list;

typedef struct {
    brio_context *ctx;
    const brio_pole_vectors *v;
    const double *spacing;
    double noise;
    tie_list *found; /* one for each thread */
    brio_status listed;
    tie *ties;
    size_t count;
    uint32_t *up;   /* #P: 2 * parent, plus 1 if the parent's sign is opposite */
    uint32_t *best; /* #P: of roots, the greatest tie */
    int64_t *told;  /* #P, or NULL: of roots, the sum of what is told of their pieces, in TOLD_UNIT */
} signing;

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
    BRIO_TRY(BRIO_RESERVE(s->ctx, l->ties, l->capacity, l->count + 1));
    l->ties[l->count++] = p < q ? (tie){p, q, weight} : (tie){q, p, weight};
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

/* Lists the ties in the order of the tetrahedra, which the threads divide. */
static brio_status list_ties(signing *s) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(s->ctx, s->v->t.count, TETS_A_THREAD);
    BRIO_TRY(BRIO_ALLOC_ZERO(s->ctx, s->found, (size_t)threads));
    BRIO_TRY(brio_sweep(s->ctx, threads, s->v->t.count, tie_part, s, BRIO_READS(s->v->t.tet)));
    BRIO_TRY(s->listed);
    for (int i = 0; i < threads; i++) s->count += s->found[i].count;
    BRIO_REQUIRE(s->ctx, s->count < NO_TIE, BRIO_ERR_TOO_LARGE, "%zu ties between samples, 2^32 is the limit",
                 s->count);
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->ties, s->count));
    for (size_t i = 0, at = 0; i < (size_t)threads; at += s->found[i++].count)
        for (size_t k = 0; k < s->found[i].count; k++) s->ties[at + k] = s->found[i].ties[k];
done:
    for (int i = 0; s->found && i < threads; i++) brio_release(s->ctx, s->found[i].ties);
    brio_release(s->ctx, s->found);
    return status;
}

/* --- pieces --- */

/* Returns 2 * root of p, plus 1 if the root's sign is opposite to that of p. Halves the path on its way. */
static uint32_t find_root(const signing *s, uint32_t p) {
    uint32_t sign = 0;
    for (;;) {
        uint32_t up = s->up[p], next = s->up[up >> 1] ^ (up & 1);
        sign ^= next & 1;
        if (up >> 1 == next >> 1) return (next & ~UINT32_C(1)) | sign;
        s->up[p] = next;
        p = next >> 1;
    }
}

/* Lets ties hold between roots, and drops those within pieces. */
static void lift_ties(signing *s) {
    size_t count = 0;
    for (size_t i = 0; i < s->count; i++) {
        brio_along(s->ctx, i, s->count, BRIO_READS(s->ties));
        uint32_t a = find_root(s, s->ties[i].a), b = find_root(s, s->ties[i].b);
        int32_t weight = (a ^ b) & 1 ? -s->ties[i].weight : s->ties[i].weight;
        if (a >> 1 == b >> 1) continue;
        s->ties[count++] = a < b ? (tie){a >> 1, b >> 1, weight} : (tie){b >> 1, a >> 1, weight};
    }
    s->count = count;
}

static int32_t bounded(int64_t sum) {
    return (int32_t)(sum > MOST_WEIGHT ? MOST_WEIGHT : sum < -MOST_WEIGHT ? -MOST_WEIGHT : sum);
}

/* Adds up the ties between each two pieces. */
static brio_status add_ties(signing *s) {
    brio_status status = BRIO_OK;
    uint64_t *key = NULL;
    uint32_t *order = NULL;
    tie *sums = NULL;
    size_t count = 0;
    int bits = 1;
    while (s->v->num_points >> bits) bits++;
    BRIO_TRY(BRIO_ALLOC(s->ctx, key, s->count));
    BRIO_TRY(BRIO_ALLOC(s->ctx, order, s->count));
    BRIO_TRY(BRIO_ALLOC(s->ctx, sums, s->count));
    for (size_t i = 0; i < s->count; i++) {
        brio_along(s->ctx, i, s->count, BRIO_READS(s->ties), BRIO_READS(key), BRIO_READS(order));
        key[i] = (uint64_t)s->ties[i].a << bits | s->ties[i].b;
        order[i] = (uint32_t)i;
    }
    BRIO_TRY(brio_radix_sort(s->ctx, key, order, s->count, 2 * bits));
    for (size_t i = 0; i < s->count; count++) {
        int64_t sum = 0;
        size_t first = i;
        for (; i < s->count && key[i] == key[first]; i++) sum += s->ties[order[i]].weight;
        sums[count] = s->ties[order[first]];
        sums[count].weight = bounded(sum);
    }
    for (size_t i = 0; i < count; i++) {
        brio_along(s->ctx, i, count, BRIO_READS(s->ties), BRIO_READS(sums));
        s->ties[i] = sums[i];
    }
    s->count = count;
done:
    brio_release(s->ctx, key);
    brio_release(s->ctx, order);
    brio_release(s->ctx, sums);
    return status;
}

/* Returns how much of what is told of two pieces, in log-odds, is lost if they are joined, with opposite signs or
 * not. */
static double lost(const signing *s, uint32_t a, uint32_t b, bool opposite) {
    if (!s->told) return 0;
    int64_t both = s->told[a] + (opposite ? -s->told[b] : s->told[b]);
    return (double)(llabs(s->told[a]) + llabs(s->told[b]) - llabs(both)) / TOLD_UNIT;
}

static bool is_worth(const signing *s, uint32_t i) {
    return abs(s->ties[i].weight) > UNIT * lost(s, s->ties[i].a, s->ties[i].b, s->ties[i].weight < 0);
}

/* Returns whether sample p has a less hash than q. */
static bool comes_before(const signing *s, uint32_t p, uint32_t q) {
    return brio_compare_hashes(p, q, s->v->points) < 0;
}

static uint32_t other_end(const tie *x, uint32_t root) {
    return x->a == root ? x->b : x->a;
}

/* Lets a root have tie i if it is its best one so far. Of two that weigh the same the other end decides: this is the
 * order of the pairs, the less end first, so ties that weigh the same make no circles. */
static void offer(const signing *s, uint32_t root, uint32_t i) {
    const tie *x = &s->ties[i], *best = s->best[root] == NO_TIE ? NULL : &s->ties[s->best[root]];
    if (!best || abs(x->weight) > abs(best->weight) ||
        (abs(x->weight) == abs(best->weight) && comes_before(s, other_end(x, root), other_end(best, root))))
        s->best[root] = i;
}

/* Joins the pieces of a tie, if it is still worth that. Returns whether it is. */
static bool join(const signing *s, tie x) {
    uint32_t a = find_root(s, x.a), b = find_root(s, x.b);
    uint32_t opposite = (a & 1) ^ (b & 1) ^ (x.weight < 0);
    if (a >> 1 == b >> 1 || abs(x.weight) <= UNIT * lost(s, a >> 1, b >> 1, opposite)) return false;
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
        if (s->best[p] != NO_TIE && abs(s->ties[s->best[p]].weight) >= UNIT * limit) root[(*count)++] = (uint32_t)p;
    if (!s->told) goto done;
    BRIO_TRY(BRIO_ALLOC(s->ctx, key, *count));
    for (size_t i = 0; i < *count; i++) key[i] = brio_position_hash(s->v->points + 3 * (size_t)root[i]);
    BRIO_TRY(brio_radix_sort(s->ctx, key, root, *count, 64));
    for (size_t i = 0; i < *count; i++) key[i] = (uint64_t)(MOST_WEIGHT - abs(s->ties[s->best[root[i]]].weight));
    BRIO_TRY(brio_radix_sort(s->ctx, key, root, *count, 32));
done:
    brio_release(s->ctx, key);
    return status;
}

/* Joins each piece with the one that it is tied to most.   joined  receives how many pieces vanish. */
static brio_status join_pieces(const signing *s, double limit, size_t *joined) {
    brio_status status = BRIO_OK;
    uint32_t *root = NULL;
    size_t count;
    *joined = 0;
    for (size_t p = 0; p < s->v->num_points; p++) s->best[p] = NO_TIE;
    for (uint32_t i = 0; i < s->count; i++) {
        brio_along(s->ctx, i, s->count, BRIO_READS(s->ties));
        if (is_worth(s, i)) offer(s, s->ties[i].a, i), offer(s, s->ties[i].b, i);
    }
    BRIO_TRY(BRIO_ALLOC(s->ctx, root, s->v->num_points));
    BRIO_TRY(list_best(s, limit, root, &count));
    for (size_t i = 0; i < count; i++) *joined += join(s, s->ties[s->best[root[i]]]);
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
            lift_ties(s);
            BRIO_TRY(add_ties(s));
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

brio_status brio_sign_sheets(brio_context *ctx, const brio_pole_vectors *v, const brio_sheet_samples *samples,
                             uint8_t *turned, uint8_t *alone) {
    brio_status status = BRIO_OK;
    const float *told = samples->told;
    size_t n = v->num_points;
    signing s = {.ctx = ctx, .v = v, .spacing = samples->spacing, .noise = samples->noise};
    int64_t *outwards = NULL;
    BRIO_REQUIRE(ctx, n < UINT32_C(1) << 31, BRIO_ERR_TOO_LARGE, "%zu points; signs of axes take less than 2^31", n);
    BRIO_TRY(BRIO_ALLOC(ctx, s.up, n));
    BRIO_TRY(BRIO_ALLOC(ctx, s.best, n));
    if (told) BRIO_TRY(BRIO_ALLOC(ctx, s.told, n));
    for (size_t p = 0; p < n; p++) s.up[p] = (uint32_t)(2 * p);
    for (size_t p = 0; p < n && told; p++) s.told[p] = (int64_t)(TOLD_UNIT * (double)told[p]);
    BRIO_TRY(list_ties(&s));
    BRIO_TRY(join_all(&s));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, outwards, n));
    count_outwards(&s, outwards);
    memset(alone, 1, n);
    for (uint32_t p = 0; p < n; p++) {
        uint32_t root = find_root(&s, p);
        bool is_told = s.told && s.told[root >> 1] != 0;
        bool opposite = is_told ? s.told[root >> 1] < 0 : outwards[root >> 1] < 0;
        turned[p] = (uint8_t)((root & 1) ^ opposite);
        if (root >> 1 != p) alone[p] = alone[root >> 1] = 0;
    }
done:
    brio_release(ctx, s.up);
    brio_release(ctx, s.best);
    brio_release(ctx, s.ties);
    brio_release(ctx, outwards);
    brio_release(ctx, s.told);
    return status;
}
