/* Finds the plane or the line of points in space, and coordinates in it.
 *
 * Three points span the frame: the lexicographically first point, the point farthest from that, and the point farthest
 * from the line through both. No rounding makes the points of a plane leave it by more than ROUNDING times the greatest
 * coordinate, so points that are nearer are in the plane, as those of a file of decimals are. Points off the plane get
 * the plane of least squares: the two main axes of the points about their mean. Sums go along the canonical order of
 * the points, so that the frame does not depend on the order of the input.
 *
 * A plane of constant x, y or z has the other two coordinates as they are. Based on: Pearson. On lines and planes of
 * closest fit to systems of points in space. Philosophical Magazine 1901. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rotate.h"
#include "base/scale.h"
#include "base/vector.h"
#include "base/versioned.h"
#include "order/canonical_points.h"
#include "plane/plane_frame.h"
#include <math.h>
#include <string.h>

enum { SWEEPS = 30 }; /* of rotations; chosen: ten diagonalise any matrix of doubles */

/* Points times a power of two, such that the greatest coordinate is below 1, and the frame in these units. */
typedef struct {
    const double *points;
    size_t count;
    double rounding; /* distances up to this are 0 */
    brio_plane_frame frame;
} fit;

/* --- the frame of three points --- */

static void subtract(const double *a, const double *b, double *out) {
    for (int k = 0; k < 3; k++) out[k] = a[k] - b[k];
}

/* Returns the length of p - origin without its parts along the first `axes` axes. */
static double distance_from(const fit *f, const double *p, int axes) {
    double rest[3];
    subtract(p, f->frame.origin, rest);
    for (int a = 0; a < axes; a++) {
        double along = brio_dot(rest, f->frame.axis[a]);
        for (int k = 0; k < 3; k++) rest[k] -= along * f->frame.axis[a][k];
    }
    return sqrt(brio_dot(rest, rest));
}

/* Returns the point farthest from what is spanned so far; among equally far ones the lexicographically first. */
static const double *farthest(const fit *f, int axes, double *distance) {
    const double *best = f->points;
    *distance = -1;
    for (size_t i = 0; i < f->count; i++) {
        const double *p = f->points + 3 * i;
        double d = distance_from(f, p, axes);
        if (d < *distance || (d == *distance && brio_lexicographic(p, best) >= 0)) continue;
        *distance = d;
        best = p;
    }
    return best;
}

/* Sets an axis to the direction of p from what is spanned so far. */
static void set_axis(fit *f, int axis, const double *p) {
    double rest[3];
    subtract(p, f->frame.origin, rest);
    for (int pass = 0; pass < 2; pass++)
        for (int a = 0; a < axis; a++) {
            double along = brio_dot(rest, f->frame.axis[a]);
            for (int k = 0; k < 3; k++) rest[k] -= along * f->frame.axis[a][k];
        }
    double length = sqrt(brio_dot(rest, rest));
    for (int k = 0; k < 3; k++) f->frame.axis[axis][k] = rest[k] / length;
}

static void span(fit *f) {
    const double *first = f->points;
    for (size_t i = 1; i < f->count; i++)
        if (brio_lexicographic(f->points + 3 * i, first) < 0) first = f->points + 3 * i;
    memcpy(f->frame.origin, first, sizeof f->frame.origin);
    for (f->frame.dimension = 0; f->frame.dimension < 2; f->frame.dimension++) {
        const double *p = farthest(f, f->frame.dimension, &f->frame.thickness);
        if (f->frame.thickness <= f->rounding) return;
        set_axis(f, f->frame.dimension, p);
    }
    farthest(f, 2, &f->frame.thickness);
    f->frame.dimension = 2 + (f->frame.thickness > f->rounding);
}

/* --- the frame of two coordinates --- */

/* Returns the last coordinate that is the same for all points, or -1. */
static int constant_of(const fit *f) {
    int constant = -1;
    for (int k = 0; k < 3; k++) {
        size_t i = 1;
        while (i < f->count && f->points[3 * i + k] == f->points[k]) i++;
        if (i == f->count) constant = k;
    }
    return constant;
}

static void take_coordinates(fit *f, int first, int second) {
    memset(f->frame.origin, 0, sizeof f->frame.origin);
    memset(f->frame.axis, 0, sizeof f->frame.axis);
    f->frame.axis[0][first] = 1;
    if (second >= 0) f->frame.axis[1][second] = 1;
}

/* Takes coordinates as they are where the plane or the line has them. */
static void straighten(fit *f) {
    int constant = constant_of(f);
    for (int k = 0; k < 3 && f->frame.dimension == 1; k++)
        if (fabs(f->frame.axis[0][k]) == 1) take_coordinates(f, k, -1);
    if (f->frame.dimension == 2 && constant >= 0) take_coordinates(f, (constant + 1) % 3, (constant + 2) % 3);
}

/* --- the plane of least squares --- */

/* Sets the axis to column k of v; its greatest part is positive. */
static void take_column(fit *f, int axis, double v[3][3], int k) {
    int most = 0;
    for (int i = 1; i < 3; i++)
        if (fabs(v[i][k]) > fabs(v[most][k])) most = i;
    for (int i = 0; i < 3; i++) f->frame.axis[axis][i] = v[most][k] < 0 ? -v[i][k] : v[i][k];
}

static brio_status least_squares(brio_context *ctx, fit *f) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    double mean[3] = {0, 0, 0}, m[3][3] = {{0}}, v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, offset[3];
    BRIO_TRY(brio_canonical_points(ctx, f->points, f->count, &order));
    for (size_t i = 0; i < f->count; i++)
        for (int k = 0; k < 3; k++) mean[k] += f->points[3 * (size_t)order[i] + k] / (double)f->count;
    for (size_t i = 0; i < f->count; i++) {
        subtract(f->points + 3 * (size_t)order[i], mean, offset);
        for (int j = 0; j < 3; j++)
            for (int k = 0; k < 3; k++) m[j][k] += offset[j] * offset[k] / (double)f->count;
    }
    for (int n = 0; n < SWEEPS; n++)
        for (int j = 0; j < 3; j++) brio_rotate(m, v, j, (j + 1) % 3);
    int least = m[1][1] < m[0][0] ? 1 : 0, most = m[1][1] > m[0][0] ? 1 : 0;
    if (m[2][2] < m[least][least]) least = 2;
    if (m[2][2] > m[most][most]) most = 2;
    if (least == most) least = 2, most = 0; /* all alike: any two axes */
    memcpy(f->frame.origin, mean, sizeof mean);
    take_column(f, 0, v, most);
    take_column(f, 1, v, 3 - least - most);
    f->frame.thickness = 0;
    for (size_t i = 0; i < f->count; i++)
        f->frame.thickness = fmax(f->frame.thickness, distance_from(f, f->points + 3 * i, 2));
done:
    brio_release(ctx, order);
    return status;
}

/* --- the interface --- */

brio_status brio_plane_fit(brio_context *ctx, const double *points, size_t num_points, brio_plane_frame *frame) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    double *rows = NULL;
    fit f = {.count = num_points, .frame = {.size = sizeof f.frame, .dimension = -1}};
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_plane_frame, frame));
    BRIO_TRY(brio_refuse_points(ctx, points, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, rows, 3 * num_points));
    double greatest = brio_greatest(points, 3 * num_points);
    int exponent = brio_exponent(greatest);
    BRIO_TRY(brio_scale(ctx, points, 3 * num_points, -exponent, rows));
    f.points = rows;
    f.rounding = BRIO_FLAT_ROUNDING * ldexp(greatest, -exponent);
    if (num_points) span(&f);
    if (f.frame.dimension == 3) BRIO_TRY(least_squares(ctx, &f));
    straighten(&f);
    for (int k = 0; k < 3; k++) f.frame.origin[k] = ldexp(f.frame.origin[k], exponent);
    f.frame.thickness = ldexp(f.frame.thickness, exponent);
    BRIO_GIVE(brio_plane_frame, frame, &f.frame);
done:
    brio_release(ctx, rows);
    return status;
}

void brio_plane_project(const brio_plane_frame *frame, const double *points, size_t num_points, double *out) {
    BRIO_DOOR;
    double offset[3];
    for (size_t i = 0; i < num_points; i++) {
        subtract(points + 3 * i, frame->origin, offset);
        for (int a = 0; a < 2; a++)
            out[2 * i + (size_t)a] = frame->dimension > a ? brio_dot(offset, frame->axis[a]) : 0;
    }
}
