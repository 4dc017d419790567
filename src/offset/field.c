/* Points on an offset surface.
 *
 * The offset at a smooth place is reached in one step: the point at the distance from the nearest point of the surface,
 * in the direction away from it. Where another part of the surface is nearer to the point than the distance, the step
 * is repeated from there: projections onto the balls in turn, which end where none is violated.
 *
 * Creases lie where balls about different parts meet. Their tangent planes are found from several places around; the
 * point of least squared distance from the planes is on the crease up to the curvature of the sheets. The search starts
 * anew around that point, closer each time, until the distance is right.
 *
 * Based on: Kobbelt, Botsch, Schwanecke, Seidel. Feature sensitive surface extraction from volume data. SIGGRAPH 2001
 * (the point of least squared distance from tangent planes). */
#include "offset/work.h"
#include "base/least_squares.h"
#include "base/vector.h"
#include <math.h>
#include <string.h>

enum { MOST_STEPS = 24, ROUNDS = 6, PLANES = 4 };

static const double SAME_SHEET = 0.995; /* cosine between normals of one sheet; chosen: 6 degrees */
static const double CLOSER = 0.25;      /* what a round leaves of the distance to the planes' places; chosen */
static const double ABOVE = 0.3;        /* of that distance: how far above the sheet the places are; chosen */
static const double DETERMINED = 0.01;  /* share of the largest eigenvalue below which planes leave a direction free;
                                            chosen */

bool brio_offset_is_beyond(const brio_offset_field *f, const double *p) {
    return (brio_winding_number(f->solid, p) == 0) == f->inwards;
}

/* Writes the direction in which p lies from its nearest point `nearest` of the surface, or the opposite one for a point
 * of the far side. Returns false for a point of the surface. */
static bool direction_of(const brio_offset_field *f, const double *p, const double *nearest, double square, double *u) {
    double length = sqrt(square);
    if (!(length > 0x1p-40 * f->distance)) return false;
    if (brio_offset_is_beyond(f, p)) length = -length;
    for (int k = 0; k < 3; k++) u[k] = (p[k] - nearest[k]) / length;
    return true;
}

bool brio_offset_reach(const brio_offset_field *f, const double *p, double tolerance, double *out, double *normal) {
    double x[3] = {p[0], p[1], p[2]}, nearest[3];
    size_t triangle;
    double square = brio_closest_point(&f->solid->tree, x, nearest, &triangle);
    for (int step = 0; step < MOST_STEPS; step++) {
        if (!direction_of(f, x, nearest, square, normal)) return false;
        for (int k = 0; k < 3; k++) x[k] = nearest[k] + f->distance * normal[k];
        square = brio_closest_point(&f->solid->tree, x, nearest, &triangle);
        if (sqrt(square) < f->distance - tolerance) continue;
        memcpy(out, x, sizeof x);
        return !brio_offset_is_beyond(f, x);
    }
    return false;
}

/* --- creases --- */

typedef struct {
    double place[3], normal[3];
} plane;

/* Adds the tangent plane at the point of the offset nearest to p. Returns false for points that are covered. */
static bool add_plane(const brio_offset_field *f, const double *p, plane *out) {
    double nearest[3];
    size_t triangle;
    double square = brio_closest_point(&f->solid->tree, p, nearest, &triangle), length = sqrt(square);
    if (length < f->distance * (1 - 0x1p-40)) return false;
    for (int k = 0; k < 3; k++) {
        out->normal[k] = (p[k] - nearest[k]) / length;
        out->place[k] = nearest[k] + f->distance * out->normal[k];
    }
    return true;
}

static bool of_one_sheet(const plane *planes, int count) {
    for (int i = 1; i < count; i++)
        if (brio_dot(planes[0].normal, planes[i].normal) < SAME_SHEET) return false;
    return true;
}

/* Writes the point of least squared distance from the planes that is closest to the mean of their places. */
static void meet(const plane *planes, int count, double *z) {
    double mean[3] = {0, 0, 0}, a[6] = {0}, b[3] = {0, 0, 0}, x[3];
    for (int i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) mean[k] += planes[i].place[k] / count;
    for (int i = 0; i < count; i++) {
        double away[3];
        for (int k = 0; k < 3; k++) away[k] = planes[i].place[k] - mean[k];
        brio_add_equation(planes[i].normal, brio_dot(planes[i].normal, away), a, b);
    }
    brio_solve_determined(a, b, DETERMINED, x);
    for (int k = 0; k < 3; k++) z[k] = mean[k] + x[k];
}

/* Writes a place above the sheet of a plane, close to z. */
static void place_near(const plane *p, const double *z, const double *up, double share, double *out) {
    double along[3], length;
    for (int k = 0; k < 3; k++) along[k] = p->place[k] - z[k];
    length = brio_length(along);
    for (int k = 0; k < 3; k++) out[k] = z[k] + share * (along[k] + ABOVE * length * up[k]);
}

bool brio_offset_crease(const brio_offset_field *f, const double *x, const double *const at[3], double tolerance,
                        double *out) {
    plane planes[PLANES];
    int count = 0;
    double nearest[3];
    size_t triangle;
    count += add_plane(f, x, &planes[count]);
    for (int i = 0; i < 3; i++) {
        double p[3];
        for (int k = 0; k < 3; k++) p[k] = 0.4 * x[k] + 0.6 * at[i][k];
        count += add_plane(f, p, &planes[count]);
    }
    for (int round = 0; round < ROUNDS; round++) {
        double up[3] = {0, 0, 0};
        if (count < 2 || of_one_sheet(planes, count)) return false;
        meet(planes, count, out);
        double short_of = sqrt(brio_closest_point(&f->solid->tree, out, nearest, &triangle)) - f->distance;
        if (fabs(short_of) <= tolerance) return !brio_offset_is_beyond(f, out);
        for (int i = 0; i < count; i++)
            for (int k = 0; k < 3; k++) up[k] += planes[i].normal[k] / count;
        plane next[PLANES];
        int kept = 0;
        for (int i = 0; i < count; i++) {
            double p[3];
            place_near(&planes[i], out, up, CLOSER, p);
            kept += add_plane(f, p, &next[kept]);
        }
        memcpy(planes, next, sizeof planes);
        count = kept;
    }
    return false;
}
