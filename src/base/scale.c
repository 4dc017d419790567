/* Numbers times a power of two, see scale.h. */
#include "base/scale.h"
#include "base/team.h"
#include <assert.h>
#include <math.h>

double brio_greatest(const double *x, size_t n) {
    double most = 0;
    for (size_t i = 0; i < n; i++) most = fmax(most, fabs(x[i]));
    return most;
}

int brio_exponent(double x) {
    int exponent = 0;
    if (isfinite(x)) frexp(x, &exponent);
    return exponent;
}

/* Skips points at the origin, which have no exponent. */
int brio_usual_exponent(const double *points, size_t num_points) {
    enum { MOST = 1000 }; /* derived: numbers below 2^MOST are finite */
    int64_t sum = 0, counted = 0;
    double most = 0;
    for (size_t i = 0; i < num_points; i++) {
        double coordinate = brio_greatest(points + 3 * i, 3);
        if (coordinate > 0) sum += brio_exponent(coordinate), counted++;
        most = fmax(most, coordinate);
    }
    int mean = counted ? (int)(sum / counted) : 0, least = brio_exponent(most) - MOST;
    return mean < least ? least : mean;
}

/* Chosen. */
enum { NUMBERS_A_THREAD = 1 << 14 };

typedef struct {
    const double *x;
    double *out;
    int exponent;
} scaling;

static void scale_part(void *user, size_t begin, size_t end, int thread) {
    const scaling *s = user;
    bool by_product =
        s->exponent > -1000 && s->exponent < 1000; /* the factor is a normal number, so the product equals ldexp */
    double factor = by_product ? brio_power_of_two(s->exponent) : 0;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        s->out[i] = (by_product ? s->x[i] * factor : ldexp(s->x[i], s->exponent)) + 0.0;
}

brio_status brio_scale(brio_context *ctx, const double *x, size_t n, int exponent, double *out) {
    assert(n == 0 || (x && out));
    scaling s = {x, out, exponent};
    return brio_for(ctx, brio_threads(ctx, n, NUMBERS_A_THREAD), n, scale_part, &s);
}

brio_status brio_scale_vertices(brio_context *ctx, double *vertices, size_t num_vertices, int exponent) {
    BRIO_FORWARD(brio_scale(ctx, vertices, 3 * num_vertices, exponent, vertices));
    for (size_t i = 0; i < 3 * num_vertices; i++)
        BRIO_EXPECT(ctx, isfinite(vertices[i]), BRIO_BECAUSE(ctx, SCALE, BRIO_ERR_NO_ANSWER),
                    "doubles cannot hold vertex %zu (counted from 0) of the result: scale the points down", i / 3);
    return BRIO_OK;
}
