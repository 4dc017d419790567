/* Samples that lie alone, far from every surface: dust in the air, reflections, points between an edge and what is
 * behind.
 *
 * A scanner's spacing grows with the distance from it, and slowly: by a few hundredths of the way from one place to
 * another. So the sampling round a sample allows it a spacing of
 *
 *     min over all samples q of (spacing of q + GROWTH * distance to q),
 *
 * measured along Delaunay edges. Threads lower the limits across all edges, in any order, until none is lowered: what
 * they end with does not depend on the order. Where two scans overlap the spacing jumps, but a sample of the coarser
 * one still has neighbours at its own spacing, on both sides along a surface. A sample is a stray if even its second
 * nearest sample is LONELY times as far away as that. The second, because strays come in pairs by chance. Where over
 * MANY of the samples are SUSPECT times as far, a scan has strays, and LIKELY is enough.
 *
 * If over MOST of the samples were strays, there would be no surface for them to be far from: then none is.
 *
 * Based on: Breunig, Kriegel, Ng, Sander. LOF: identifying density-based local outliers. SIGMOD 2000.
 * Differs from the paper: the density compared with is the highest in reach, not the mean of the neighbours, which
 * among
 *                         strays are strays. */
#include "reconstruct/labeled_delaunay/stray_samples.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include <math.h>
#include <string.h>

/* Chosen on scans with and without strays, of models that nothing else was measured on, and on random samples of closed
 * models: LONELY has none of the latter, SUSPECT one in 3,000. */
static const double GROWTH = 0.05, LONELY = 12, SUSPECT = 7, LIKELY = 4, MANY = 0.003, MOST = 0.05;

/* Chosen. */
enum { TETS_A_THREAD = 1 << 13 };

typedef struct {
    brio_context *ctx;
    const brio_tetrahedron *tet;
    size_t num_tets, num_points;
    const double *points;
    const float *second;
    double *allowed; /* #P; atomic */
    /* #P: whether `allowed` fell in the sweep before, and in this one; atomic */
    uint8_t *fell, *falls;
    bool first, back; /* the first sweep; whether a sweep goes backwards */
    bool lowered;     /* in this sweep; atomic */
} search;

/* Lowers the allowed spacing of a sample. */
static void lower(search *s, uint32_t p, double most) {
    double before;
    bool is_lower = false;
    __atomic_load(&s->allowed[p], &before, __ATOMIC_RELAXED);
    while (most < before && !is_lower)
        is_lower = __atomic_compare_exchange(&s->allowed[p], &before, &most, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED);
    if (!is_lower) return;
    __atomic_store_n(&s->falls[p], 1, __ATOMIC_RELAXED);
    __atomic_store_n(&s->lowered, true, __ATOMIC_RELAXED);
}

/* Limits the spacing at one end of an edge by that at the other. The first test lets all pass that rounding might keep
 * back. */
static inline void limit(search *s, uint32_t p, uint32_t q) {
    static const double SURE = 1 - 1e-9;
    double a, b;
    __atomic_load(&s->allowed[p], &a, __ATOMIC_RELAXED);
    __atomic_load(&s->allowed[q], &b, __ATOMIC_RELAXED);
    double square = brio_square_distance(s->points + 3 * (size_t)p, s->points + 3 * (size_t)q);
    if ((b - a) * (b - a) <= SURE * GROWTH * GROWTH * square) return;
    double least = a < b ? a : b;
    lower(s, a < b ? q : p, least + GROWTH * sqrt(square));
}

/* Returns whether a limit of a tetrahedron's samples fell since the sweep before passed the tetrahedron. */
static bool has_changed(const search *s, const uint32_t *v) {
    bool changed = s->first;
    for (int k = 0; k < 4; k++)
        changed |= v[k] < s->num_points && (s->fell[v[k]] || __atomic_load_n(&s->falls[v[k]], __ATOMIC_RELAXED));
    return changed;
}

/* Announces the tetrahedra that a sweep passes over next, from the n-th one on. */
static void expect_next(const search *s, size_t n) {
    size_t end = n + BRIO_SWEEP_STRETCH < s->num_tets ? n + BRIO_SWEEP_STRETCH : s->num_tets;
    if (n >= end) return;
    brio_expect_rows(s->ctx, BRIO_ARRAYS(BRIO_READS(s->tet)), s->back ? s->num_tets - end : n,
                     s->back ? s->num_tets - n : end);
}

/* Passes over the edges of the tetrahedra at which something changed, at first of all, each edge as often as it has
 * such tetrahedra. */
static void pass_over(void *user, size_t begin, size_t end, int thread) {
    search *s = user;
    (void)thread;
    for (size_t n = begin; n < end; n++) {
        if (n % BRIO_SWEEP_STRETCH == 0) expect_next(s, n + BRIO_SWEEP_STRETCH);
        const uint32_t *v = s->tet[s->back ? s->num_tets - 1 - n : n].vertex;
        if (!has_changed(s, v)) continue;
        for (int j = 1; j < 4; j++)
            for (int k = 0; k < j; k++)
                if (v[j] < s->num_points && v[k] < s->num_points) limit(s, v[j], v[k]);
    }
}

/* Lowers the limits until they hold across all edges. Sweeps alternate, so that limits travel both ways along the order
 * of the tetrahedra: on scans, a sweep lowers a tenth as many as the one before. */
static brio_status limit_all(brio_context *ctx, search *s) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(ctx, s->num_tets, TETS_A_THREAD);
    do {
        uint8_t *spare = s->fell;
        s->fell = s->falls, s->falls = spare;
        memset(s->falls, 0, s->num_points);
        s->lowered = false;
        BRIO_TRY(brio_for(ctx, threads, s->num_tets, pass_over, s));
        s->first = false, s->back = !s->back;
    } while (s->lowered);
done:
    return status;
}

/* Marks the samples whose second nearest sample is over `times` as far away as is allowed. Returns their number. */
static size_t mark(const search *s, double times, uint8_t *stray) {
    size_t count = 0;
    for (size_t p = 0; p < s->num_points; p++)
        count += stray[p] = s->second[p] < INFINITY && (double)s->second[p] > times * s->allowed[p];
    return count;
}

brio_status brio_find_strays(brio_context *ctx, const brio_triangulation *t, const double *points, size_t num_points,
                             const double *spacing, const float *second, uint8_t *stray) {
    brio_status status = BRIO_OK;
    search s = {.ctx = ctx,
                .tet = brio_triangulation_tetrahedra(t),
                .num_tets = brio_triangulation_stats(t)->tetrahedra,
                .num_points = num_points,
                .points = points,
                .second = second,
                .first = true};
    size_t vertices = brio_triangulation_stats(t)->vertices;
    BRIO_TRY(BRIO_ALLOC(ctx, s.allowed, num_points));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s.fell, num_points));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s.falls, num_points));
    for (size_t p = 0; p < num_points; p++) s.allowed[p] = spacing[p];
    BRIO_TRY(limit_all(ctx, &s));
    bool many = (double)mark(&s, SUSPECT, stray) > MANY * (double)vertices;
    size_t count = mark(&s, many ? LIKELY : LONELY, stray);
    if ((double)count > MOST * (double)vertices) mark(&s, INFINITY, stray);
done:
    brio_release(ctx, s.allowed);
    brio_release(ctx, s.fell);
    brio_release(ctx, s.falls);
    return status;
}
