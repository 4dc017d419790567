/* Samples that lie alone, far from every surface: dust in the air, reflections, points between an edge and what is
 * behind.
 *
 * A scanner's spacing grows with the distance from it, and slowly: by a few hundredths of the way from one place to
 * another. So the sampling round a sample allows it a spacing of
 *
 *     min over all samples q of (spacing of q + GROWTH * distance to q),
 *
 * measured along Delaunay edges. Where two scans overlap the spacing jumps, but a sample of the coarser one still has
 * neighbours at its own spacing, on both sides along a surface. A sample is a stray if even its second nearest sample
 * is LONELY times as far away as that. The second, because strays come in pairs by chance. Where over MANY of the
 * samples are SUSPECT times as far, a scan has strays, and LIKELY is enough.
 *
 * If over MOST of the samples were strays, there would be no surface for them to be far from: then none is.
 *
 * Based on: Breunig, Kriegel, Ng, Sander. LOF: identifying density-based local outliers. SIGMOD 2000.
 * Differs from the paper: the density compared with is the highest in reach, not the mean of the neighbours, which
 * among
 *                         strays are strays. */
#include "reconstruct/labeled_delaunay/stray_samples.h"
#include "base/memory.h"
#include "base/vector.h"
#include <math.h>

/* Chosen on scans with and without strays, of models that nothing else was measured on, and on random samples of closed
 * models: LONELY has none of the latter, SUSPECT one in 3,000. */
static const double GROWTH = 0.05, LONELY = 12, SUSPECT = 7, LIKELY = 4, MANY = 0.003, MOST = 0.05;

/* Chosen. SWEEPS: growth passes along most edges in the first two. */
enum { SWEEPS = 8 };

typedef struct {
    const brio_tetrahedron *tet;
    size_t num_tets, num_points;
    const double *points;
    const float *second;
    double *allowed; /* #P */
    uint8_t *last;   /* #P: the last sweep in which `allowed` changed */
} search;

/* Limits the spacing at q by that at p. Returns whether that changed it. */
static bool limit(const search *s, uint32_t p, uint32_t q, double square) {
    double more = s->allowed[q] - s->allowed[p], before = s->allowed[q];
    if (more <= 0 || more * more <= GROWTH * GROWTH * square) return false;
    s->allowed[q] = s->allowed[p] + GROWTH * sqrt(square);
    return s->allowed[q] != before; /* by rounding, it may stay */
}

/* Returns whether a limit of a tetrahedron's samples has changed since the sweep before passed the tetrahedron. */
static bool has_changed(const search *s, const uint32_t *v, int sweep) {
    bool changed = sweep == 0;
    for (int k = 0; k < 4; k++) changed |= v[k] < s->num_points && s->last[v[k]] + 1 >= sweep;
    return changed;
}

/* Passes over the edges of the tetrahedra at which something changed, at first of all, each edge as often as it has
 * such tetrahedra. Writes whether a limit changed. */
static brio_status pass_over(brio_context *ctx, const search *s, int sweep, bool *changed) {
    brio_status status = BRIO_OK;
    *changed = false;
    for (size_t n = 0; n < s->num_tets; n++) {
        const uint32_t *v = s->tet[sweep % 2 == 1 ? s->num_tets - 1 - n : n].vertex;
        BRIO_TRY(brio_look(ctx, sweep == 0 ? 4 : 1));
        if (!has_changed(s, v, sweep)) continue;
        for (int j = 1; j < 4; j++)
            for (int k = 0; k < j; k++) {
                if (v[j] >= s->num_points || v[k] >= s->num_points) continue;
                double square = brio_square_distance(s->points + 3 * (size_t)v[j], s->points + 3 * (size_t)v[k]);
                if (limit(s, v[j], v[k], square)) s->last[v[k]] = (uint8_t)sweep, *changed = true;
                if (limit(s, v[k], v[j], square)) s->last[v[j]] = (uint8_t)sweep, *changed = true;
            }
    }
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
    search s = {.tet = brio_triangulation_tetrahedra(t),
                .num_tets = brio_triangulation_stats(t)->tetrahedra,
                .num_points = num_points,
                .points = points,
                .second = second};
    size_t vertices = brio_triangulation_stats(t)->vertices;
    BRIO_TRY(BRIO_ALLOC(ctx, s.allowed, num_points));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s.last, num_points));
    for (size_t p = 0; p < num_points; p++) s.allowed[p] = spacing[p];
    bool changed = true;
    for (int sweep = 0; sweep < SWEEPS && changed; sweep++) BRIO_TRY(pass_over(ctx, &s, sweep, &changed));
    bool many = (double)mark(&s, SUSPECT, stray) > MANY * (double)vertices;
    size_t count = mark(&s, many ? LIKELY : LONELY, stray);
    if ((double)count > MOST * (double)vertices) mark(&s, INFINITY, stray);
done:
    brio_release(ctx, s.allowed);
    brio_release(ctx, s.last);
    return status;
}
