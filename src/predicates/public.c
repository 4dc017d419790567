/* The predicates of the public header. Points are rows of three doubles, and each call sets bounds for its own
 * points. */
#include "brio/brio.h"
#include "base/float_state.h"
#include "predicates/predicates.h"

typedef struct {
    double p[5][4];
    brio_filter filter;
} records;

static void records_set(records *r, const double *const points[5], int count, const double *weights) {
    double low[4], extent[4];
    for (int i = 0; i < count; i++) {
        for (int k = 0; k < 3; k++) r->p[i][k] = points[i][k] + 0.0;
        r->p[i][3] = weights ? weights[i] : 0;
    }
    for (int k = 0; k < 4; k++) {
        double high = low[k] = r->p[0][k];
        for (int i = 1; i < count; i++) low[k] = fmin(low[k], r->p[i][k]), high = fmax(high, r->p[i][k]);
        extent[k] = high - low[k];
    }
    brio_filter_set(&r->filter, extent, extent[3], weights != NULL);
}

int brio_orient3d(const double *a, const double *b, const double *c, const double *d) {
    BRIO_DOOR;
    records r;
    records_set(&r, (const double *const[5]){a, b, c, d}, 4, NULL);
    return brio_orient3d_sign(&r.filter, r.p[0], r.p[1], r.p[2], r.p[3]);
}

int brio_insphere(const double *a, const double *b, const double *c, const double *d, const double *e,
                  const double *weights) {
    BRIO_DOOR;
    records r;
    records_set(&r, (const double *const[5]){a, b, c, d, e}, 5, weights);
    return brio_insphere_sign(&r.filter, r.p[0], r.p[1], r.p[2], r.p[3], r.p[4], r.filter.weighted);
}

int brio_insphere_perturbed(const double *a, const double *b, const double *c, const double *d, const double *e,
                            const double *weights) {
    BRIO_DOOR;
    records r;
    records_set(&r, (const double *const[5]){a, b, c, d, e}, 5, weights);
    return brio_conflict(&r.filter, r.p[0], r.p[1], r.p[2], r.p[3], r.p[4], r.filter.weighted) ? 1 : -1;
}
