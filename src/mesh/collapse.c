/* One edge collapse.
 *
 * An edge may collapse into a point chosen by quadric errors when
 * - both its ends are inside the surface;
 * - the link condition holds, so that the topology of the surface stays: the ends have exactly two common neighbours,
 *   and not both ends have degree three;
 * - no triangle round the edge turns over or loses its area. Needles stay allowed: the crust is full of them, and each
 *   collapse of a needle is a step to better shapes;
 * - with a guard, no triangle crosses another one that it did not cross before (collapse_guard.c).
 *
 * Based on: Garland, Heckbert. Surface simplification using quadric error metrics. SIGGRAPH 1997. Dey, Edelsbrunner,
 * Guha, Nekhayev. Topology preserving edge contraction. Publ. Inst. Math. Beograd 1999 (the link condition). */
#include "mesh/collapse.h"
#include "base/vector.h"
#include "mesh/collapse_guard.h"
#include <math.h>
#include <string.h>

/* A collapse may turn a triangle by at most the angle with this cosine; chosen. */
static const double LEAST_COSINE = 0.2;

/* --- the point of a collapse, and its error --- */

/* Writes the best point for the edge of h to `point`. Returns the squared distance of that point from the planes,
 * weighted by area. */
static double best_point(const brio_collapse_mesh *m, uint32_t h, brio_quadric *sum, double *point) {
    uint32_t u = m->vertex[h], v = brio_collapse_end(m, h);
    const double *a = brio_collapse_at(m, u), *b = brio_collapse_at(m, v);
    double candidate[3][3], least = INFINITY;
    brio_quadric_sum(&m->quadric[u], &m->quadric[v], sum);
    for (int k = 0; k < 3; k++) candidate[0][k] = a[k], candidate[1][k] = b[k], candidate[2][k] = 0.5 * (a[k] + b[k]);
    if (brio_quadric_minimum(sum, point) && brio_square_distance(point, candidate[2]) <= brio_square_distance(a, b))
        return brio_quadric_at(sum, point);
    for (int i = 0; i < 3; i++) {
        double error = brio_quadric_at(sum, candidate[i]);
        if (error >= least) continue;
        least = error;
        memcpy(point, candidate[i], sizeof candidate[i]);
    }
    return least;
}

static bool too_long(const brio_collapse_mesh *m, uint32_t u, uint32_t v, double spacing) {
    double longest = m->options->longest * spacing;
    return longest < INFINITY &&
           brio_square_distance(brio_collapse_at(m, u), brio_collapse_at(m, v)) > longest * longest;
}

/* Returns the error of the edge of h in the unit of m->error, INFINITY if the edge may not be tried. */
static float error_of(const brio_collapse_mesh *m, uint32_t h) {
    uint32_t u = m->vertex[h], v = brio_collapse_end(m, h);
    double spacing = m->spacing ? fmin(m->spacing[u], m->spacing[v]) : 1, allowed = m->options->tolerance * spacing;
    if ((m->marks[u] | m->marks[v]) & BRIO_COLLAPSE_BOUNDARY || too_long(m, u, v, spacing)) return INFINITY;
    brio_quadric sum;
    double point[3], error = best_point(m, h, &sum, point);
    /* without a tolerance the bound of an edge without area is no number, and the edge may be tried */
    return error > allowed * allowed * sum.area ? INFINITY : (float)(error * m->unit);
}

uint32_t brio_collapse_measure(brio_collapse_mesh *m, uint32_t h) {
    uint32_t mate = m->mate[h], name = h < mate ? h : mate, other = h < mate ? mate : h;
    m->error[other] = INFINITY;
    m->error[name] = error_of(m, name);
    return name;
}

/* --- what a collapse must not do --- */

/* Sets or clears the mark SEEN of the neighbours of h's start. Returns their number. */
static uint32_t mark_neighbours(const brio_collapse_mesh *m, uint32_t h, bool seen) {
    uint32_t degree = 0, g = h;
    do {
        uint8_t *marks = &m->marks[brio_collapse_end(m, g)];
        *marks = (uint8_t)(seen ? *marks | BRIO_COLLAPSE_SEEN : *marks & ~BRIO_COLLAPSE_SEEN);
        degree++;
    } while ((g = brio_collapse_turn(m, g)) != h);
    return degree;
}

/* Returns whether the ends of h have exactly two common neighbours, the apexes of the edge's two triangles, and not
 * both ends have degree three. */
static bool link_condition(const brio_collapse_mesh *m, uint32_t h) {
    uint32_t mate = m->mate[h], first = mark_neighbours(m, h, true), second = 0, common = 0, g = mate;
    do {
        common += (m->marks[brio_collapse_end(m, g)] & BRIO_COLLAPSE_SEEN) != 0;
        second++;
    } while ((g = brio_collapse_turn(m, g)) != mate);
    mark_neighbours(m, h, false);
    return common == 2 && first >= 3 && second >= 3 && first + second > 6;
}

static void normal_of(const double *a, const double *b, const double *c, double *n) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k];
    brio_cross(u, v, n);
}

static void normal_before(const brio_collapse_mesh *m, uint32_t h, double *n) {
    normal_of(brio_collapse_at(m, m->vertex[h]), brio_collapse_at(m, brio_collapse_end(m, h)),
              brio_collapse_at(m, m->vertex[brio_collapse_before(h)]), n);
}

static void add_normals(const brio_collapse_mesh *m, uint32_t h, double *sum) {
    uint32_t g = h;
    do {
        double n[3];
        normal_before(m, g, n);
        for (int k = 0; k < 3; k++) sum[k] += n[k];
    } while ((g = brio_collapse_turn(m, g)) != h);
}

/* Returns whether the triangle of g keeps its side when its first corner moves to `point`: its new normal agrees with
 * its old normal. If the old normal disagrees with `together`, the new normal must agree with `together`. Where nothing
 * has area, as among vertices at one position, no side is known, and no triangle may get area. */
static bool keeps_its_side(const brio_collapse_mesh *m, uint32_t g, const double *point, const double *together) {
    const double *b = brio_collapse_at(m, brio_collapse_end(m, g));
    const double *c = brio_collapse_at(m, m->vertex[brio_collapse_before(g)]);
    double old[3], new[3];
    normal_before(m, g, old);
    normal_of(point, b, c, new);
    const double *side = brio_dot(old, together) > 0 ? old : together;
    double size = sqrt(brio_dot(new, new)), before = sqrt(brio_dot(side, side));
    if (!(size > 0) || !(before > 0)) return !(size > 0) && !(brio_dot(old, old) > 0);
    return brio_dot(new, side) >= LEAST_COSINE * size * before;
}

/* Returns whether all triangles round the start of h, except the two at the edge of h, keep their sides. */
static bool keep_their_sides(const brio_collapse_mesh *m, uint32_t h, const double *point, const double *together) {
    uint32_t last = brio_collapse_next(m->mate[h]);
    for (uint32_t g = brio_collapse_turn(m, h); g != h; g = brio_collapse_turn(m, g))
        if (g != last && !keeps_its_side(m, g, point, together)) return false;
    return true;
}

static bool allowed(const brio_collapse_mesh *m, uint32_t h, const double *point) {
    double together[3] = {0, 0, 0};
    if (!link_condition(m, h)) return false;
    add_normals(m, h, together);
    add_normals(m, m->mate[h], together);
    return keep_their_sides(m, h, point, together) && keep_their_sides(m, m->mate[h], point, together);
}

/* --- the collapse --- */

static void glue(brio_collapse_mesh *m, uint32_t g, uint32_t h) {
    m->mate[g] = h;
    m->mate[h] = g;
    m->half_edge[m->vertex[g]] = g;
    m->half_edge[m->vertex[h]] = h;
}

/* Removes the triangle of h: its two sides other than h become one edge. */
static void close_triangle(brio_collapse_mesh *m, uint32_t h) {
    uint32_t first = h - h % 3;
    glue(m, m->mate[brio_collapse_next(h)], m->mate[brio_collapse_before(h)]);
    for (uint32_t i = 0; i < 3; i++) m->vertex[first + i] = BRIO_COLLAPSE_NONE, m->error[first + i] = INFINITY;
}

uint32_t brio_collapse_try(brio_collapse_mesh *m, uint32_t h) {
    uint32_t mate = m->mate[h], gone = m->vertex[h], kept = m->vertex[mate], g = h;
    brio_quadric sum;
    double point[3];
    best_point(m, h, &sum, point);
    if (!allowed(m, h, point)) return BRIO_COLLAPSE_NONE;
    if (m->guard && !brio_collapse_guard_allows(m, h, point)) return BRIO_COLLAPSE_NONE;
    if (m->guard) brio_collapse_guard_before(m);
    do m->vertex[g] = kept;
    while ((g = brio_collapse_turn(m, g)) != h);
    close_triangle(m, h);
    close_triangle(m, mate);
    memcpy(m->position + 3 * (size_t)kept, point, sizeof point);
    m->quadric[kept] = sum;
    if (m->spacing) m->spacing[kept] = fmin(m->spacing[kept], m->spacing[gone]);
    m->half_edge[gone] = BRIO_COLLAPSE_NONE;
    if (m->guard) brio_collapse_guard_after(m);
    return kept;
}
