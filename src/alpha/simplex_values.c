/* Values of single simplices, and of vertices, in alpha filtrations.
 *
 * Vertex a is attached when a neighbour b has power distance |a - b|^2 - wb below -wa from a. Otherwise the vertex is
 * Gabriel and has the value -wa, or a lower one of its edges, which rounding may cause.
 *
 * Based on: Edelsbrunner. The union of balls and its dual shape. DCG 1995. */
#include "alpha/simplex_values.h"
#include "alpha/alpha_complex.h"
#include "alpha/squared_radius.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/scale.h"
#include "predicates/predicates.h"
#include <assert.h>
#include <float.h>
#include <math.h>

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
            assert(place[own] < c->counts[0] && place[other] < c->counts[0]);
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

brio_status brio_refuse_small_alpha(brio_context *ctx, const brio_alpha_complex *c, double alpha) {
    if (fabs(alpha) >= DBL_MIN || brio_greatest(c->values[0], c->counts[0]) >= DBL_MIN) return BRIO_OK;
    BRIO_EXPECT(ctx, false, BRIO_ERR_NO_ANSWER,
                "squared radii of at most alpha = %g are beyond doubles: scale the points up", alpha);
    return BRIO_OK;
}
