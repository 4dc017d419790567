/* The predicates of the plane in the public header. Points are rows of two doubles, and each call sets bounds for its
 * own points. */
#include "base/float_state.h"
#include "brio/brio.h"
#include "predicates/plane.h"
#include <math.h>

typedef struct {
    double p[4][4];
    brio_plane_filter filter;
} records;

static void records_set(records *r, const double *const points[4], int count, const double *weights) {
    double extent[4];
    for (int i = 0; i < count; i++) {
        r->p[i][0] = points[i][0] + 0.0, r->p[i][1] = points[i][1] + 0.0;
        r->p[i][2] = 0, r->p[i][3] = weights ? weights[i] : 0;
    }
    for (int k = 0; k < 4; k++) {
        double low = r->p[0][k], high = low;
        for (int i = 1; i < count; i++) low = fmin(low, r->p[i][k]), high = fmax(high, r->p[i][k]);
        extent[k] = high - low;
    }
    brio_plane_filter_set(&r->filter, extent, weights != NULL);
}

int brio_orient2d(const double *a, const double *b, const double *c) {
    BRIO_DOOR;
    records r;
    records_set(&r, (const double *const[4]){a, b, c}, 3, NULL);
    return brio_orient2d_sign(&r.filter, r.p[0], r.p[1], r.p[2]);
}

int brio_incircle(const double *a, const double *b, const double *c, const double *d, const double *weights) {
    BRIO_DOOR;
    records r;
    records_set(&r, (const double *const[4]){a, b, c, d}, 4, weights);
    return brio_incircle_sign(&r.filter, r.p[0], r.p[1], r.p[2], r.p[3], r.filter.general);
}

int brio_incircle_perturbed(const double *a, const double *b, const double *c, const double *d, const double *weights) {
    BRIO_DOOR;
    records r;
    records_set(&r, (const double *const[4]){a, b, c, d}, 4, weights);
    return brio_circle_conflict(&r.filter, r.p[0], r.p[1], r.p[2], r.p[3], r.filter.general) ? 1 : -1;
}
