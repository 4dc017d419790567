/* Centres of circles in the plane, see plane_centre.h. The corners are sorted, and the first one is raised by about the
 * size of the triangle, so the bits of a centre depend on the positions alone. */
#include "plane/plane_centre.h"
#include <assert.h>
#include <float.h>
#include <math.h>

static inline bool comes_before(const double *p, const double *q) {
    return p[0] != q[0] ? p[0] < q[0] : p[1] < q[1];
}

/* Returns half the greatest difference of two coordinates, but not 0. */
static double height_of(const double *const corner[3]) {
    double most = DBL_MIN;
    for (int i = 1; i < 3; i++)
        for (int k = 0; k < 2; k++) most = fmax(most, fabs(corner[i][k] * 0.5 - corner[0][k] * 0.5));
    return most;
}

void brio_plane_circles_add(brio_plane_circles *b, const double *p, const double *q, const double *r) {
    assert(b->count < BRIO_CENTRE_BATCH);
    const double *corner[3] = {p, q, r};
    for (int i = 1; i < 3; i++)
        for (int j = i; j > 0 && comes_before(corner[j], corner[j - 1]); j--) {
            const double *swap = corner[j];
            corner[j] = corner[j - 1], corner[j - 1] = swap;
        }
    size_t first = 4 * b->count;
    for (uint32_t i = 0; i < 4; i++) {
        const double *from = corner[i % 3];
        double *to = b->point[first + i];
        to[0] = from[0], to[1] = from[1], to[2] = 0;
        b->weight[first + i] = from[3];
        b->vertex[b->count][i] = (uint32_t)first + i;
    }
    b->point[first + 3][2] = height_of(corner);
    b->count++;
}

void brio_plane_circles_solve(brio_plane_circles *b, bool weighted, double (*centre)[3]) {
    if (!b->count) return;
    brio_centres(
        &(brio_centre_batch){*b->point, weighted ? b->weight : NULL, (const uint32_t(*)[4])b->vertex, b->count},
        *centre, NULL);
    b->count = 0;
}
