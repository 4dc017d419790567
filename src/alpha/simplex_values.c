/* Values of single simplices, and of vertices, in alpha filtrations.
 *
 * Vertex a is attached when a neighbour b has power distance |a - b|^2 - wb below -wa from a. Otherwise the vertex is
 * Gabriel and has the value -wa, or a lower one of its edges, which rounding may cause.
 *
 * Based on: Edelsbrunner. The union of balls and its dual shape. DCG 1995. */
#include "alpha/alpha_complex.h"
#include "alpha/simplex_values.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/scale.h"
#include "predicates/double_double.h"
#include "predicates/predicates.h"
#include <assert.h>
#include <float.h>
#include <math.h>

/* --- squared radii --- */

/* Squared radii in double-doubles.
 *
 * The vertices are taken relative to the first one, a, exactly, and scaled by a power of two to at most 1. Let U, V, W
 * be the others and b_i = |U_i|^2 - (w_i - w_a). The centre is a + y with y in the span of U, V, W and 2 U_i y = b_i;
 * the squared radius is |y|^2 - w_a. */

typedef struct {
    brio_dd row[3][3]; /* U, V, W */
    brio_dd b[3];
    int exponent; /* true coordinates are 2^exponent times these */
} simplex;

static double largest_difference(const double *const *p, int count) {
    double most = 0;
    for (int i = 1; i < count; i++)
        for (int k = 0; k < 3; k++) most = fmax(most, fabs(p[i][k] - p[0][k]));
    return fmin(most, 0x1p1023);
}

/* Returns x 2^exponent. */
BRIO_INLINE brio_dd scaled(brio_dd x, int exponent) {
    if (exponent >= -1022 && exponent <= 1023) { /* ldexp is a call */
        double factor = brio_power_of_two(exponent);
        return (brio_dd){x.hi * factor, x.lo * factor};
    }
    return (brio_dd){ldexp(x.hi, exponent), ldexp(x.lo, exponent)};
}

BRIO_INLINE brio_dd dot(const brio_dd *x, const brio_dd *y, const bool fma) {
    return dd_sum3(dd_multiply(x[0], y[0], fma), dd_multiply(x[1], y[1], fma), dd_multiply(x[2], y[2], fma));
}

BRIO_INLINE void cross(const brio_dd *x, const brio_dd *y, brio_dd *out, const bool fma) {
    out[0] = dd_minor(x[1], y[2], x[2], y[1], fma);
    out[1] = dd_minor(x[2], y[0], x[0], y[2], fma);
    out[2] = dd_minor(x[0], y[1], x[1], y[0], fma);
}

/* Returns x / y, up to a few roundings of double-doubles. */
BRIO_INLINE brio_dd divide(brio_dd x, brio_dd y, const bool fma) {
    double first = x.hi / y.hi;
    if (!(fabs(first) < INFINITY)) return (brio_dd){first, 0};
    brio_dd rest = dd_subtract(x, dd_multiply(y, (brio_dd){first, 0}, fma));
    return dd_fast_two_sum(first, rest.hi / y.hi);
}

BRIO_INLINE void take(simplex *s, const double *const *p, int count, const bool fma) {
    assert(2 <= count && count <= 4);
    frexp(largest_difference(p, count), &s->exponent);
    for (int i = 0; i + 1 < count; i++) {
        for (int k = 0; k < 3; k++) s->row[i][k] = scaled(dd_difference(p[i + 1][k], p[0][k]), -s->exponent);
        brio_dd weight = scaled(dd_difference(p[i + 1][3], p[0][3]), -2 * s->exponent);
        s->b[i] = dd_subtract(dot(s->row[i], s->row[i], fma), weight);
    }
}

/* Returns |y|^2 = b^2 / (4 U^2). */
BRIO_INLINE brio_dd square_of_edge(const simplex *s, const bool fma) {
    brio_dd square = divide(dd_multiply(s->b[0], s->b[0], fma), dot(s->row[0], s->row[0], fma), fma);
    return scaled(square, -2);
}

/* Returns the square of a vector divided by 2 d. */
BRIO_INLINE brio_dd square_of_quotient(const brio_dd *x, brio_dd d, const bool fma) {
    brio_dd y[3];
    for (int k = 0; k < 3; k++) y[k] = divide(x[k], d, fma);
    return scaled(dot(y, y, fma), -2);
}

/* Returns |y|^2 of y = (b (V x N) + c (N x U)) / (2 N^2), N = U x V; for an edge of length 0 in doubles, NaN. */
BRIO_INLINE brio_dd square_of_facet(const simplex *s, const bool fma) {
    brio_dd normal[3], one[3], other[3];
    cross(s->row[0], s->row[1], normal, fma);
    cross(s->row[1], normal, one, fma);
    cross(normal, s->row[0], other, fma);
    for (int k = 0; k < 3; k++) one[k] = dd_add(dd_multiply(s->b[0], one[k], fma), dd_multiply(s->b[1], other[k], fma));
    return square_of_quotient(one, dot(normal, normal, fma), fma);
}

/* Returns |y|^2 of y = (b (V x W) + c (W x U) + d (U x V)) / (2 U (V x W)). */
BRIO_INLINE brio_dd square_of_tetrahedron(const simplex *s, const bool fma) {
    brio_dd vw[3], wu[3], uv[3], sum[3];
    cross(s->row[1], s->row[2], vw, fma);
    cross(s->row[2], s->row[0], wu, fma);
    cross(s->row[0], s->row[1], uv, fma);
    for (int k = 0; k < 3; k++)
        sum[k] = dd_sum3(dd_multiply(s->b[0], vw[k], fma), dd_multiply(s->b[1], wu[k], fma),
                         dd_multiply(s->b[2], uv[k], fma));
    return square_of_quotient(sum, dot(s->row[0], vw, fma), fma);
}

BRIO_INLINE double squared_radius(const double *const *p, int count, const bool fma) {
    simplex s;
    take(&s, p, count, fma);
    brio_dd square = count == 2   ? square_of_edge(&s, fma)
                     : count == 3 ? square_of_facet(&s, fma)
                                  : square_of_tetrahedron(&s, fma);
    square = scaled(square, 2 * s.exponent);
    if (!(square.hi < INFINITY)) return INFINITY;
    double power = dd_subtract(square, (brio_dd){p[0][3], 0}).hi;
    return isnan(power) ? INFINITY : power; /* a sum beyond doubles has no second part */
}

BRIO_TARGET_FMA static double squared_radius_fma(const double *const *p, int count) {
    return squared_radius(p, count, true);
}

/* Returns the squared radius of the smallest sphere that is orthogonal to the `count` weighted vertices of a simplex, 2
 *  to 4; without weights, of the smallest circumscribed sphere. INFINITY where doubles cannot hold it. The result
 *  depends on the order of the vertices in its last bits only.
 *  p  the vertices, x y z weight; the weights are 0 without weights. */
static double brio_squared_radius(const double *const *p, int count) {
    return brio_have_fma() ? squared_radius_fma(p, count) : squared_radius(p, count, false);
}

/* --- lists of simplices --- */

brio_status brio_records_take(brio_context *ctx, const double *points, int coordinates, const double *weights,
                              size_t num_points, brio_records *out) {
    out->weighted = weights != NULL;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, out->of, num_points));
    for (size_t i = 0; i < num_points; i++) {
        for (int k = 0; k < coordinates; k++) out->of[i][k] = points[(size_t)coordinates * i + (size_t)k];
        if (weights) out->of[i][3] = weights[i];
    }
    BRIO_FORWARD(
        brio_refuse_records(ctx, (const double(*)[4])out->of, NULL, num_points)); /* they may have changed meanwhile */
    return BRIO_OK;
}

void brio_put_simplex(const uint32_t *from, int count, uint32_t *to) {
    assert(1 <= count && count <= 4);
    for (int n = 0; n < count; n++) {
        int at = n;
        for (; at > 0 && to[at - 1] > from[n]; at--) to[at] = to[at - 1];
        assert(at == 0 || to[at - 1] < from[n]); /* no vertex twice */
        to[at] = from[n];
    }
}

double brio_own_value(const brio_records *records, const uint32_t *vertex, int count) {
    assert(2 <= count && count <= 4 && vertex[0] < vertex[1]); /* ascending */
    const double *p[4];
    for (int i = 0; i < count; i++) p[i] = records->of[vertex[i]];
    return brio_squared_radius(p, count);
}

bool brio_is_inside(const brio_records *records, const uint32_t *vertex, int count, uint32_t other) {
    assert((count == 2 || count == 3) && vertex[0] < vertex[1]); /* ascending */
    const double *p[4];
    for (int i = 0; i < count; i++) p[i] = records->of[vertex[i]];
    p[count] = records->of[other];
    return brio_attached(p, count, records->weighted);
}

brio_status brio_alpha_room(brio_context *ctx, brio_alpha_complex *c) {
    size_t total = 0, corners = 0;
    for (size_t k = 0; k < 4; k++) {
        total += c->counts[k];
        corners += c->counts[k] * (k + 1);
    }
    BRIO_EXPECT(ctx, total < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu simplices; at most 2^32 - 2", total);
    BRIO_FORWARD(BRIO_ALLOC(ctx, c->simplices[0], corners));
    BRIO_FORWARD(BRIO_ALLOC(ctx, c->values[0], total));
    BRIO_FORWARD(BRIO_ALLOC(ctx, c->solid[0], total));
    BRIO_FORWARD(BRIO_ALLOC(ctx, c->gabriel[0], total));
    for (size_t k = 1; k < 4; k++) {
        c->simplices[k] = c->simplices[k - 1] + c->counts[k - 1] * k;
        c->values[k] = c->values[k - 1] + c->counts[k - 1];
        c->solid[k] = c->solid[k - 1] + c->counts[k - 1];
        c->gabriel[k] = c->gabriel[k - 1] + c->counts[k - 1];
    }
    assert(c->values[3] + c->counts[3] == c->values[0] + total); /* the four arrays are one */
    return BRIO_OK;
}

brio_status brio_find_vertex_values(brio_context *ctx, brio_alpha_complex *c, const brio_records *records,
                                    const uint32_t *place) {
    double *least = c->values[0], *solid = c->solid[0];
    for (size_t v = 0; v < c->counts[0]; v++) {
        least[v] = solid[v] = INFINITY;
        c->gabriel[0][v] = 1;
    }
    for (size_t n = 0; n < c->counts[1]; n++) {
        BRIO_FORWARD(brio_look(ctx, 2));
        for (int i = 0; i < 2; i++) {
            uint32_t own = c->simplices[1][2 * n + (size_t)i], other = c->simplices[1][2 * n + (size_t)!i];
            if (place[own] == BRIO_INFINITE) continue; /* not own */
            assert(place[own] < c->counts[0]);
            const double *a = records->of[own], *b = records->of[other];
            least[place[own]] = fmin(least[place[own]], c->values[1][n]);
            solid[place[own]] = fmin(solid[place[own]], c->solid[1][n]);
            if (records->weighted && brio_power_compare(a, b, a) < 0) c->gabriel[0][place[own]] = 0;
        }
    }
    for (size_t v = 0; v < c->counts[0]; v++)
        if (c->gabriel[0][v]) least[v] = fmin(least[v], 0 - records->of[c->simplices[0][v]][3]);
    return BRIO_OK;
}

brio_status brio_refuse_small_alpha(brio_context *ctx, double greatest, double alpha) {
    if (fabs(alpha) >= DBL_MIN || greatest >= DBL_MIN) return BRIO_OK;
    BRIO_EXPECT(ctx, false, BRIO_BECAUSE(ctx, SCALE, BRIO_ERR_NO_ANSWER),
                "squared radii of at most alpha = %g are beyond doubles: scale the points up", alpha);
    return BRIO_OK;
}
