/* The local feature size, from the poles.
 *
 * Poles converge to the medial axis as the sampling gets denser, so the distance to the nearest pole estimates the
 * distance to the medial axis.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999. */
#include "dual/feature_size.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include "query/nearest_points.h"
#include <string.h>

enum { SAMPLES_A_THREAD = 512, CHUNK = 256 };

static inline double least(double a, double b) {
    return b < a ? b : a;
}

/* Returns the squared distance from sample p to the nearest pole. The poles of p itself bound the search. */
static double nearest_of(const brio_point_tree *t, const brio_pole_vectors *v, size_t p) {
    double best = INFINITY;
    for (int side = 0; side < 2; side++) {
        size_t own = v->pole[2 * p + (size_t)side];
        if (own < v->num_finite) best = least(best, brio_square_distance(v->points + 3 * p, v->centre + 4 * own));
    }
    return brio_nearest_square(t, v->points + 3 * p, best);
}

/* Allocates *poles and fills it with the centres of the finite poles, each pole once; adds their number to *count. */
static brio_status collect_poles(brio_context *ctx, const brio_pole_vectors *v, double **poles, size_t *count) {
    brio_status status = BRIO_OK;
    uint8_t *is_pole = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, is_pole, v->num_finite));
    for (size_t i = 0; i < 2 * v->num_points; i++)
        if (v->pole[i] < v->num_finite) *count += !is_pole[v->pole[i]], is_pole[v->pole[i]] = 1;
    BRIO_TRY(BRIO_ALLOC(ctx, *poles, 3 * *count));
    for (size_t tet = 0, n = 0; tet < v->num_finite; tet++)
        if (is_pole[tet]) memcpy(*poles + 3 * n++, v->centre + 4 * tet, 3 * sizeof **poles);
done:
    brio_release(ctx, is_pole);
    return status;
}

typedef struct {
    const brio_pole_vectors *v;
    brio_point_tree tree; /* of the poles */
    double *size;
} sizes;

static void find_part(void *user, size_t begin, size_t end, int thread) {
    const sizes *s = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        bool vertex = s->v->pole[2 * p] != BRIO_INFINITE;
        s->size[p] = vertex ? sqrt(nearest_of(&s->tree, s->v, p)) : 0;
    }
}

brio_status brio_feature_sizes(brio_context *ctx, const brio_pole_vectors *v, double **size) {
    brio_status status = BRIO_OK;
    sizes s = {.v = v};
    double *poles = NULL;
    size_t count = 0;
    *size = NULL;
    BRIO_TRY(collect_poles(ctx, v, &poles, &count));
    BRIO_TRY(brio_point_tree_new(ctx, poles, count, &s.tree));
    BRIO_TRY(BRIO_ALLOC(ctx, s.size, v->num_points));
    int threads = brio_threads(ctx, v->num_points, SAMPLES_A_THREAD);
    BRIO_TRY(brio_for_chunks(ctx, threads, v->num_points, CHUNK, find_part, &s));
    *size = s.size;
done:
    brio_point_tree_free(ctx, &s.tree);
    brio_release(ctx, poles);
    return status;
}
