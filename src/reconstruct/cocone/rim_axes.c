/* Axes of samples at the rims of open sheets.
 *
 * The Voronoi cell of a sample at a rim is endless on both sides of the sheet and beyond the rim. The sum of the
 * normals of its hull facets is then an accident: it often points along the sheet. Which side a scanner was on tells
 * nothing about such an axis. Where the nearest samples are nearly in a plane, the normal of that plane is the axis of
 * the sheet. Elsewhere, as at the edges of solids, the axis stays.
 *
 * Based on: Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Surface reconstruction from unorganized points. SIGGRAPH
 * 1992. */
#include "reconstruct/cocone/rim_axes.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include "query/nearest_points.h"
#include <math.h>

/* NEAREST: samples that a plane is fitted to, the sample itself among them. SQUARINGS: of a matrix, each of which
 * squares the ratios of its eigenvalues. All chosen. */
enum { NEAREST = 12, SQUARINGS = 10, SAMPLES_A_THREAD = 1 << 8 };

/* FLAT: the least variance of the samples of a sheet, in the middle one. FAR: the cosine between axis and normal.
 * Chosen. */
static const double FLAT = 0.1, FAR = 0.8;

typedef struct {
    brio_pole_vectors *v;
    const brio_point_tree *tree;
    const uint32_t *sample; /* those on the hull */
} mender;

/* Writes the sum of d d^T over the differences d of the points from their mean. */
static void sum_squares(const brio_point_tree *tree, const brio_near_point *near, size_t count, double m[3][3]) {
    double mean[3] = {0, 0, 0};
    for (size_t n = 0; n < count; n++)
        for (int k = 0; k < 3; k++) mean[k] += tree->point[near[n].place][k] / (double)count;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            m[i][j] = 0;
            for (size_t n = 0; n < count; n++) {
                const double *p = tree->point[near[n].place];
                m[i][j] += (p[i] - mean[i]) * (p[j] - mean[j]);
            }
        }
}

/* Divides a matrix by its largest entry on the diagonal, and squares it. */
static void square_matrix(double m[3][3]) {
    double most = fmax(m[0][0], fmax(m[1][1], m[2][2])), out[3][3];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            out[i][j] = (m[i][0] * m[0][j] + m[i][1] * m[1][j] + m[i][2] * m[2][j]) / (most * most);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) m[i][j] = out[i][j];
}

/* Writes the direction of least variance: the longest column of a high power of the trace less the matrix. */
static void least_direction(const double m[3][3], double direction[3]) {
    double trace = m[0][0] + m[1][1] + m[2][2], power[3][3];
    int longest = 0;
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) power[i][j] = (i == j ? trace : 0) - m[i][j];
    for (int i = 0; i < SQUARINGS; i++) square_matrix(power);
    for (int i = 1; i < 3; i++)
        if (power[i][i] > power[longest][longest]) longest = i;
    double length = sqrt(brio_dot(power[longest], power[longest]));
    for (int k = 0; k < 3; k++) direction[k] = power[longest][k] / length;
}

/* Returns the least variance in the middle one.   normal  of the least variance. */
static double flatness(const double m[3][3], const double normal[3]) {
    double least = 0, trace = m[0][0] + m[1][1] + m[2][2], minors = 0;
    for (int i = 0; i < 3; i++) least += normal[i] * brio_dot(m[i], normal);
    for (int i = 0; i < 3; i++) minors += m[i][i] * m[(i + 1) % 3][(i + 1) % 3] - m[i][(i + 1) % 3] * m[(i + 1) % 3][i];
    double sum = trace - least, product = minors - least * sum, root = sum * sum - 4 * product;
    return least / ((sum - sqrt(fmax(root, 0))) / 2); /* of the two others, with this sum and product, the lesser */
}

static void mend_axes(void *user, size_t begin, size_t end, int thread) {
    const mender *r = user;
    brio_near_point near[BRIO_NEAR_ROOM];
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        uint32_t p = r->sample[i];
        const double *x = r->v->points + 3 * (size_t)p;
        double *plane = r->v->plane + 4 * (size_t)p, m[3][3], normal[3];
        size_t count = brio_nearest_points(r->tree, x, NEAREST, INFINITY, near);
        brio_sort_near_points(r->tree, near, count);
        sum_squares(r->tree, near, count, m);
        least_direction((const double(*)[3])m, normal);
        if (!(flatness((const double(*)[3])m, normal) < FLAT) || fabs(brio_dot(normal, plane)) >= FAR) continue;
        for (int k = 0; k < 3; k++) plane[k] = normal[k];
        plane[3] = -brio_dot(normal, x);
    }
}

brio_status brio_mend_rim_axes(brio_context *ctx, brio_pole_vectors *v) {
    brio_status status = BRIO_OK;
    brio_point_tree tree = {0};
    uint8_t *on_hull = NULL; /* #P */
    uint32_t *sample = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, on_hull, v->num_points));
    for (size_t tet = v->num_finite; tet < v->t.count; tet++)
        for (int i = 0; i < 3; i++) on_hull[v->t.tet[tet].vertex[i]] = 1;
    for (size_t p = 0; p < v->num_points; p++) count += on_hull[p];
    BRIO_TRY(BRIO_ALLOC(ctx, sample, count));
    for (uint32_t p = 0, at = 0; p < v->num_points; p++)
        if (on_hull[p]) sample[at++] = p;
    BRIO_TRY(brio_point_tree_new(ctx, v->points, v->num_points, &tree));
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, count, SAMPLES_A_THREAD), count, mend_axes, &(mender){v, &tree, sample}));
done:
    brio_point_tree_free(ctx, &tree);
    brio_release(ctx, on_hull);
    brio_release(ctx, sample);
    return status;
}
