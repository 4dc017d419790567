/* Values of trees of solids.
 *
 * A union is the minimum of its children's values, an intersection their maximum, a difference the maximum of the first
 * and the negated others. A blend replaces the minimum by a function that differs where both values are small.
 *
 * Far from a child that does not decide, the minimum does not depend on that child. All values have slope at most about
 * 1; so in a ball of radius r a child can be left out whose value at the centre exceeds the least by 2 r and the reach
 * of the blend.
 *
 * Based on: Ricci. A constructive geometry for computer graphics. The Computer Journal 1973. Keeter. Massively parallel
 * rendering of complex closed-form implicit surfaces. SIGGRAPH 2020 (children left out, region by region). */
#include "base/vector.h"
#include "testdata/csg.h"
#include <math.h>
#include <stdint.h>

/* --- shapes --- */

/* Signed distances of simple shapes.
 *
 * Based on: Hart. Sphere tracing: a geometric method for the antialiased ray tracing of implicit surfaces. The Visual
 * Computer 1996. Schoen. Infinite periodic minimal surfaces without self-intersections. NASA TN D-5541, 1970 (the
 * gyroid). */

/** Returns about the distance from an upright screw thread round the origin with a triangular section. */
double brio_thread_distance(const double *p, const double *v); /* radius, depth, pitch, half height */

static double length2(double x, double y) {
    return sqrt(x * x + y * y);
}

/* Returns the distance from a body that is the product of two others, from the distances of those. */
static double product_distance(double a, double b) {
    return fmin(fmax(a, b), 0) + length2(fmax(a, 0), fmax(b, 0));
}

/* Returns the distance from an ellipsoid with half axes r, to first order in the distance; at most the least half axis
 * deep. With k = |p / r|, the function (k - 1) k / |p / r^2| has value 0 and slope 1 on the surface. */
static double ellipsoid_distance(const double *p, const double *r) {
    double k = 0, slope = 0, least = fmin(r[0], fmin(r[1], r[2]));
    for (int i = 0; i < 3; i++) {
        double x = p[i] / r[i];
        k += x * x;
        slope += x * x / (r[i] * r[i]);
    }
    k = sqrt(k);
    return slope > 0 ? fmax(k * (k - 1) / sqrt(slope), -least) : -least;
}

/* Returns the distance from a segment on the z axis from 0 to `height`, less a radius that runs from `low` to `high`
 * (the hull of two balls). |low - high| < height. Along the axis the nearest ball of the family is shifted by the sine
 * of the cone's angle. */
static double capsule_distance(const double *p, double height, double low, double high) {
    double b = (low - high) / height, a = sqrt(fmax(1 - b * b, 0)), q = length2(p[0], p[1]), k = p[2] * a - q * b;
    if (k < 0) return length2(q, p[2]) - low;
    if (k > a * height) return length2(q, p[2] - height) - high;
    return q * a + p[2] * b - low;
}

/* Returns the distance from a torus round the z axis. */
static double torus_distance(const double *p, double major, double minor) {
    return length2(length2(p[0], p[1]) - major, p[2]) - minor;
}

/* Returns the distance from a box with the given half sides round the origin. */
static double box_distance(const double *p, const double *half) {
    double outside = 0, most = -INFINITY;
    for (int k = 0; k < 3; k++) {
        double d = fabs(p[k]) - half[k];
        most = fmax(most, d);
        if (d > 0) outside += d * d;
    }
    return fmin(most, 0) + sqrt(outside);
}

/* Returns the distance from an upright cylinder round the origin. */
static double cylinder_distance(const double *p, double radius, double half_height) {
    return product_distance(length2(p[0], p[1]) - radius, fabs(p[2]) - half_height);
}

/* Returns the distance from a polygon in the plane. Point i of the polygon is at points[i][0], points[i][1]. The sign
 * changes with each edge that crosses the ray from the point towards +x. */
static double polygon_distance(double x, double y, const double (*points)[4], uint32_t count) {
    double square = INFINITY, sign = 1;
    for (uint32_t i = 0, j = count - 1; i < count; j = i++) {
        const double *a = points[i], *b = points[j];
        double ex = b[0] - a[0], ey = b[1] - a[1], wx = x - a[0], wy = y - a[1];
        double t = fmin(fmax((wx * ex + wy * ey) / (ex * ex + ey * ey), 0), 1);
        double dx = wx - t * ex, dy = wy - t * ey;
        square = fmin(square, dx * dx + dy * dy);
        if ((y >= a[1]) == (y < b[1]) && (y >= a[1]) == (ex * wy > ey * wx)) sign = -sign;
    }
    return sign * sqrt(square);
}

/* Returns the distance from a polygon in the plane of x and y, extruded to |z| <= half. */
static double prism_distance(const double *p, double half, const double (*points)[4], uint32_t count) {
    return product_distance(polygon_distance(p[0], p[1], points, count), fabs(p[2]) - half);
}

/* Returns the distance from a polyline of balls: point i is a centre in [0] to [2], with its radius in [3]. Radii run
 *  linearly between the points; the value exceeds the distance by a factor of at most sqrt(1 + slope^2). */
static double strand_distance(const double *p, const double (*points)[4], uint32_t count) {
    double least = INFINITY;
    for (uint32_t i = 0; i + 1 < count; i++) {
        const double *a = points[i], *b = points[i + 1];
        double e[3], w[3];
        for (int k = 0; k < 3; k++) e[k] = b[k] - a[k], w[k] = p[k] - a[k];
        double t = fmin(fmax(brio_dot(w, e) / brio_dot(e, e), 0), 1);
        for (int k = 0; k < 3; k++) w[k] -= t * e[k];
        least = fmin(least, sqrt(brio_dot(w, w)) - a[3] - t * (b[3] - a[3]));
    }
    return least;
}

/* Returns about the distance from a vessel round the z axis, between z = v[0] and z = v[1]. Its radius is v[2] times 1
 * + the sum of v[3 + i] sin(pi (i + 1) t + v[6 + i]), i = 0 to 2, t being (z - v[9]) / v[10]. Divides the distance
 * from the profile along the radius by the secant of the profile's slope. */
static double vessel_distance(const double *p, const double *v) {
    double t = (p[2] - v[9]) / v[10], radius = 1, slope = 0;
    for (int i = 0; i < 3; i++) {
        double frequency = 3.14159265358979324 * (i + 1), angle = frequency * t + v[6 + i];
        radius += v[3 + i] * sin(angle);
        slope += v[3 + i] * frequency * cos(angle);
    }
    double side = (length2(p[0], p[1]) - v[2] * radius) / length2(1, v[2] * slope / v[10]);
    return fmax(side, fmax(v[0] - p[2], p[2] - v[1]));
}

double brio_thread_distance(const double *p, const double *v) {
    double turn = p[2] / v[2] - atan2(p[1], p[0]) / 6.28318530717958648, depth = 2 * fabs(turn - rint(turn)) * v[1];
    double side = (length2(p[0], p[1]) - v[0] + depth) / length2(1, 2 * v[1] / v[2]);
    return fmax(side, fabs(p[2]) - v[3]);
}

/* Returns about the distance from a periodic sheet, the gyroid of period 2 pi / frequency. */
static double gyroid_distance(const double *p, double frequency) {
    double x = frequency * p[0], y = frequency * p[1], z = frequency * p[2];
    return (sin(x) * cos(y) + sin(y) * cos(z) + sin(z) * cos(x)) / (1.5 * frequency);
}

/* --- trees --- */

static const double FULL_TURN = 6.28318530717958648;

/* Where the values are taken: all nodes, or those whose bits are set. With `mark`, the bits of nodes are set. */
typedef struct {
    const brio_csg *tree;
    const uint64_t *need;
    uint64_t *mark;
    double radius; /* of the ball that is marked */
} visit;

static double value(const visit *w, uint32_t node, const double *p);

/* --- blends --- */

static double blend_min(brio_csg_blend blend, double a, double b, double reach) {
    double least = fmin(a, b), h;
    switch (blend) {
    case BRIO_BLEND_SHARP:
        break;
    case BRIO_BLEND_SMOOTH:
        h = fmax(reach - fabs(a - b), 0) / reach;
        return least - h * h * h * reach / 6;
    case BRIO_BLEND_ROUND:
        if (a >= reach || b >= reach) break;
        return reach - sqrt((reach - a) * (reach - a) + (reach - b) * (reach - b));
    case BRIO_BLEND_CHAMFER:
        return fmin(least, (a + b - reach) * 0.70710678118654752);
    }
    return least;
}

/* Returns whether child c of n counts with its value negated: the tree then is a minimum throughout. */
static bool counts_negated(const brio_csg_node *n, uint32_t c) {
    return n->kind == BRIO_CSG_COMMON || (n->kind == BRIO_CSG_CUT && c == n->first);
}

/* Marks the children that a point of the ball can need, with all below them. */
static void mark_children(const visit *w, const brio_csg_node *n, const double *p) {
    const visit plain = {w->tree, NULL, NULL, 0};
    double least = INFINITY, reach = n->blend == BRIO_BLEND_SHARP ? 0 : n->v[0];
    int count = 0;
    for (uint32_t c = n->first; c; c = w->tree->nodes[c].next, count++) {
        double v = value(&plain, c, p);
        least = fmin(least, counts_negated(n, c) ? -v : v);
    }
    double gap = 2 * w->radius + reach * (1 + count / 6.0), level = w->radius + 2 * reach;
    for (uint32_t c = n->first; c; c = w->tree->nodes[c].next) {
        double v = value(&plain, c, p);
        if (counts_negated(n, c)) v = -v;
        if (v > least + gap && (reach == 0 || v > level)) continue;
        w->mark[c / 64] |= UINT64_C(1) << c % 64;
        value(w, c, p);
    }
}

/* Returns whether the bounding ball of a strand shows that its value is not below `least`, so that the minimum is known
 * without the value. */
static bool is_beyond(const brio_csg_node *n, const brio_csg_node *child, const double *p, double least) {
    if (child->kind != BRIO_CSG_STRAND || n->kind != BRIO_CSG_UNION || n->blend != BRIO_BLEND_SHARP) return false;
    double reach = fmax(least, 0) + child->v[3];
    return brio_square_distance(p, child->v) * 0.999999 > reach * reach;
}

static double combine(const visit *w, const brio_csg_node *n, const double *p) {
    double least = INFINITY;
    if (w->mark) mark_children(w, n, p);
    for (uint32_t c = n->first; c; c = w->tree->nodes[c].next) {
        if (w->need && !(w->need[c / 64] >> c % 64 & 1)) continue;
        if (is_beyond(n, &w->tree->nodes[c], p, least)) continue;
        const visit plain = {w->tree, w->need, NULL, 0};
        double v = value(&plain, c, p);
        least = blend_min(n->blend, least, counts_negated(n, c) ? -v : v, n->v[0]);
    }
    return n->kind == BRIO_CSG_UNION ? least : -least;
}

/* --- changes of place --- */

/* Returns the value of the only child. */
static double below(const visit *w, const brio_csg_node *n, const double *p) {
    if (w->mark) w->mark[n->first / 64] |= UINT64_C(1) << n->first % 64;
    return value(w, n->first, p);
}

static double placed(const visit *w, const brio_csg_node *n, const double *p) {
    double d[3] = {p[0] - n->v[9], p[1] - n->v[10], p[2] - n->v[11]}, q[3];
    for (int k = 0; k < 3; k++) q[k] = n->v[k] * d[0] + n->v[3 + k] * d[1] + n->v[6 + k] * d[2];
    return below(w, n, q);
}

/* Returns the value of copies round an axis. Of the copies, the two that are nearest by angle decide. */
static double ring(const visit *w, const brio_csg_node *n, const double *p) {
    double sector = FULL_TURN / n->v[0], turn = atan2(p[1], p[0]) / sector, near = rint(turn);
    double other = turn < near ? near - 1 : near + 1, least = INFINITY;
    for (int i = 0; i < 2; i++) {
        double angle = -sector * (i ? other : near), c = cos(angle), s = sin(angle);
        least = fmin(least, below(w, n, (const double[3]){c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]}));
    }
    return least;
}

/* Returns the value of copies on a grid. Of the copies along an axis, the nearest one decides: the child is symmetric
 * in x and in y. */
static double grid(const visit *w, const brio_csg_node *n, const double *p) {
    double q[3] = {p[0], p[1], p[2]};
    for (int k = 0; k < 2; k++) {
        double most = n->v[2 * k], step = n->v[2 * k + 1];
        if (most > 0) q[k] -= step * fmin(fmax(rint(p[k] / step), -most), most);
    }
    return below(w, n, q);
}

static double twisted(const visit *w, const brio_csg_node *n, const double *p) {
    double angle = -n->v[0] * p[2], c = cos(angle), s = sin(angle);
    return below(w, n, (const double[3]){c * p[0] - s * p[1], s * p[0] + c * p[1], p[2]}) / n->v[1];
}

/* Returns the value with three crossed waves; the division keeps the slope at most 1. */
static double waved(const visit *w, const brio_csg_node *n, const double *p) {
    double a = n->v[0], f = n->v[1], wave = 1;
    for (int k = 0; k < 3; k++) wave *= sin(f * p[k] + n->v[2 + k]);
    return (below(w, n, p) + a * wave) / (1 + a * f);
}

/* --- all kinds --- */

static double shape(const brio_csg *tree, const brio_csg_node *n, const double *p) {
    const double *v = n->v;
    switch (n->kind) {
    case BRIO_CSG_BALL:
        return sqrt(brio_dot(p, p)) - v[0];
    case BRIO_CSG_ELLIPSOID:
        return ellipsoid_distance(p, v);
    case BRIO_CSG_CAPSULE:
        return capsule_distance(p, v[0], v[1], v[2]);
    case BRIO_CSG_TORUS:
        return torus_distance(p, v[0], v[1]);
    case BRIO_CSG_BOX:
        return box_distance(p, v);
    case BRIO_CSG_CYLINDER:
        return cylinder_distance(p, v[0], v[1]);
    case BRIO_CSG_PRISM:
        return prism_distance(p, v[0], tree->points + n->point, n->points);
    case BRIO_CSG_LATHE:
        return polygon_distance(sqrt(p[0] * p[0] + p[1] * p[1]), p[2], tree->points + n->point, n->points);
    case BRIO_CSG_STRAND:
        return strand_distance(p, tree->points + n->point, n->points);
    case BRIO_CSG_VESSEL:
        return vessel_distance(p, v);
    case BRIO_CSG_THREAD:
        return brio_thread_distance(p, v);
    case BRIO_CSG_GYROID:
        return gyroid_distance(p, v[0]);
    default:
        return p[2];
    }
}

static double value(const visit *w, uint32_t node, const double *p) {
    const brio_csg_node *n = &w->tree->nodes[node];
    double f;
    switch (n->kind) {
    case BRIO_CSG_UNION:
    case BRIO_CSG_COMMON:
    case BRIO_CSG_CUT:
        return combine(w, n, p);
    case BRIO_CSG_SHELL:
        f = below(w, n, p);
        return fmax(f, -f - n->v[0]);
    case BRIO_CSG_SHEET:
        return fabs(below(w, n, p)) - n->v[0];
    case BRIO_CSG_GROW:
        return below(w, n, p) - n->v[0];
    case BRIO_CSG_FLAT:
        return fmax(below(w, n, (const double[3]){p[0], p[1], 0}), fabs(p[2]) - n->v[0]);
    case BRIO_CSG_WAVES:
        return waved(w, n, p);
    case BRIO_CSG_MOVE:
        return below(w, n, (const double[3]){p[0] - n->v[0], p[1] - n->v[1], p[2] - n->v[2]});
    case BRIO_CSG_PLACE:
        return placed(w, n, p);
    case BRIO_CSG_MIRROR:
        return below(w, n, (const double[3]){fabs(p[0]), p[1], p[2]});
    case BRIO_CSG_RING:
        return ring(w, n, p);
    case BRIO_CSG_GRID:
        return grid(w, n, p);
    case BRIO_CSG_TWIST:
        return twisted(w, n, p);
    default:
        return shape(w->tree, n, p);
    }
}

double brio_csg_value(const brio_csg *tree, const double *p, const uint64_t *need) {
    return value(&(visit){tree, need, NULL, 0}, tree->root, p);
}

double brio_csg_mark(const brio_csg *tree, const double *centre, double radius, uint64_t *need) {
    need[tree->root / 64] |= UINT64_C(1) << tree->root % 64;
    return value(&(visit){tree, NULL, need, radius}, tree->root, centre);
}
