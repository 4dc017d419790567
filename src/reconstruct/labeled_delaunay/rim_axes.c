/* Axes of samples at the rims of open sheets: the eigenvector of the largest eigenvalue of the sum of n n^T over the
 * normals n of the sample's hull facets, each weighted by the facet's angle at the sample. */
#include "reconstruct/labeled_delaunay/rim_axes.h"
#include "base/memory.h"
#include "base/vector.h"
#include <math.h>

/* A sum of weighted normals shorter than this part of the weights is an accident: two halves of the normals are then over
 * 120 degrees apart. Chosen. */
static const double SHORT = 0.5;

/* SQUARINGS: of the matrix, each of which squares the ratio of its eigenvalues. */
enum { NOT_ON_HULL = 0, SQUARINGS = 10 };

typedef struct {
    double weight, sum[3], square[3][3];
} bundle;

/* Returns the angle of a hull facet at its corner in slot i. */
static double angle_at(const brio_pole_vectors *v, const uint32_t *vertex, int i) {
    const double *o = v->points + 3 * (size_t)vertex[i], *a = v->points + 3 * (size_t)vertex[(i + 1) % 3],
                 *b = v->points + 3 * (size_t)vertex[(i + 2) % 3];
    double p[3], q[3], normal[3];
    for (int k = 0; k < 3; k++) p[k] = a[k] - o[k], q[k] = b[k] - o[k];
    brio_cross(p, q, normal);
    return atan2(sqrt(brio_dot(normal, normal)), brio_dot(p, q));
}

static void add_normal(bundle *b, const double *normal, double weight) {
    b->weight += weight;
    for (int i = 0; i < 3; i++) {
        b->sum[i] += weight * normal[i];
        for (int j = 0; j < 3; j++) b->square[i][j] += weight * normal[i] * normal[j];
    }
}

/* Divides a matrix by its largest entry, and squares it. */
static void square_matrix(double m[3][3]) {
    double most = 0, out[3][3];
    for (int i = 0; i < 3; i++) most = fmax(most, m[i][i]);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[i][j] = (m[i][0] * m[0][j] + m[i][1] * m[1][j] + m[i][2] * m[2][j]) / (most * most);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) m[i][j] = out[i][j];
}

/* Writes the axis of a bundle of normals, a unit vector: the longest column of a high power of the matrix. */
static void main_axis(bundle *b, double axis[3]) {
    int longest = 0;
    for (int i = 0; i < SQUARINGS; i++) square_matrix(b->square);
    for (int i = 1; i < 3; i++)
        if (b->square[i][i] > b->square[longest][longest]) longest = i;
    double length = sqrt(brio_dot(b->square[longest], b->square[longest]));
    for (int k = 0; k < 3; k++) axis[k] = b->square[longest][k] / length;
}

static void mend_axis(brio_pole_vectors *v, size_t p, bundle *b) {
    double *plane = v->plane + 4 * p;
    if (!(b->weight > 0) || sqrt(brio_dot(b->sum, b->sum)) >= SHORT * b->weight) return;
    main_axis(b, plane);
    plane[3] = -brio_dot(plane, v->points + 3 * p);
}

brio_status brio_mend_rim_axes(brio_context *ctx, brio_pole_vectors *v) {
    brio_status status = BRIO_OK;
    uint32_t *place = NULL; /* #P: 1 + the bundle of the sample, or NOT_ON_HULL */
    bundle *bundles = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, place, v->num_points));
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int i = 0; i < 3; i++) {
            uint32_t p = v->t.tet[tet].vertex[i];
            if (place[p] == NOT_ON_HULL) place[p] = (uint32_t)++count;
        }
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, bundles, count));
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int i = 0; i < 3; i++) {
            const uint32_t *vertex = v->t.tet[tet].vertex;
            add_normal(&bundles[place[vertex[i]] - 1], v->centre + 4 * tet, angle_at(v, vertex, i));
        }
    for (size_t p = 0; p < v->num_points; p++)
        if (place[p] != NOT_ON_HULL) mend_axis(v, p, &bundles[place[p] - 1]);
done:
    brio_release(ctx, place);
    brio_release(ctx, bundles);
    return status;
}
