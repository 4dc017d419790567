/* The size of a completion, estimated from a sample of the points.
 *
 * Points beside gaps that reach out of the domain are completed. A sample of all points has these gaps, too, where they
 * are wide beside its spacing; narrower ones have few points that are completed. How many there are grows with a power
 * of the number of points: 2/3 beside bodies that points fill, 1 on surfaces. Two samples show the power. */
#include "estimate/triangulation_size.h"
#include "base/memory.h"
#include "periodic/periodic.h"
#include <math.h>
#include <string.h>

/* Chosen. MOST_TETRAHEDRA: 32 a point of 32,768 translates; a sample of a curve can have its square. */
enum { SAMPLE = 4096, RATIO = 4, MOST_TETRAHEDRA = 1 << 20 };

static const double LEAST_POWER = 2.0 / 3, MOST_POWER = 1;

typedef struct {
    brio_context *ctx;
    const double *points, *weights;
    size_t num_points;
    const brio_periodic_options *options;
} periodic_set;

/* Finds the size for one point of each of `count` equal parts of all points. 0 points of a sample that is too large. */
static brio_status try_sample(const periodic_set *s, size_t count, brio_completion_size *size) {
    brio_status status = BRIO_OK;
    double *points = NULL, *weights = NULL;
    brio_periodic_trial trial = {.max_tetrahedra = MOST_TETRAHEDRA};
    BRIO_TRY(BRIO_ALLOC(s->ctx, points, 3 * count + 1));
    if (s->weights) BRIO_TRY(BRIO_ALLOC(s->ctx, weights, count + 1));
    for (size_t i = 0; i < count; i++) {
        size_t p = brio_sample_of(i, count, s->num_points);
        memcpy(points + 3 * i, s->points + 3 * p, 3 * sizeof *points);
        if (weights) weights[i] = s->weights[p];
    }
    status = brio_periodic_try(s->ctx, points, weights, count, s->options, &trial);
    if (status == BRIO_ERR_TOO_LARGE) status = BRIO_OK;
    *size = (brio_completion_size){(double)trial.most_completed, trial.flat};
done:
    brio_release(s->ctx, points);
    brio_release(s->ctx, weights);
    return status;
}

static brio_status try_samples(const periodic_set *s, brio_completion_size *size) {
    brio_completion_size fewer = {0};
    size_t count = s->num_points < SAMPLE ? s->num_points : SAMPLE;
    BRIO_FORWARD(try_sample(s, count, size));
    if (count == s->num_points || size->points == 0) return BRIO_OK;
    BRIO_FORWARD(try_sample(s, count / RATIO, &fewer));
    double power = fewer.points > 0 ? log(size->points / fewer.points) / log(RATIO) : MOST_POWER;
    power = fmin(fmax(power, LEAST_POWER), MOST_POWER);
    size->points *= pow((double)s->num_points / (double)count, power);
    return BRIO_OK;
}

brio_status brio_estimate_completion(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                     const brio_periodic_options *options, brio_completion_size *size) {
    const periodic_set s = {ctx, points, weights, num_points, options};
    brio_aside aside = brio_aside_begin(ctx);
    *size = (brio_completion_size){0};
    brio_status status = try_samples(&s, size);
    brio_aside_end(ctx, &aside);
    return status;
}
