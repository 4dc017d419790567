/* Sibson's coordinates of a query in the plane, from its cavity.
 *
 * The cavity is the set of triangles whose circles hold the query x (Bowyer, Watson). Inserted, x would take from the
 * Voronoi cell of each vertex a of the cavity a convex polygon R(a). Its corners are the centres of the cavity's
 * triangles at a, and the centres of x with the two border edges at a. The coordinate of a is the area of R(a), divided
 * by the sum of all these areas.
 *
 * The cavity is a disk without vertices inside, so its triangles are the nodes of a tree whose branches are the edges
 * inside it. A depth-first search that crosses the edges of each triangle counterclockwise goes round this tree, meets
 * the border edges counterclockwise, and between two of them goes through the triangles at their common vertex, in
 * order. So one tour has the corners of every R(a) one after the other, clockwise. Areas are computed relative to the
 * first corner; all their parts are positive up to rounding, and nothing large cancels.
 *
 * The last step makes the coordinates reproduce x, as in locate/natural.c.
 *
 * Based on: Sibson. A vector identity for the Dirichlet tessellation. Math. Proc. Cambridge 1980. */
#include "plane/plane_natural.h"
#include "base/flat_shares.h"
#include "base/memory.h"
#include "base/scale.h"
#include "plane/plane_centre.h"
#include <assert.h>
#include <math.h>

/* --- barycentric coordinates --- */

/* Coordinates of a query in the triangle that holds it: areas divided by their sum, and refined while they do not
 * reproduce the query, as in locate/natural.c, where the reasons stand. */

enum { REFINEMENTS = 2 };

/* Returns a power of two that scales the offsets from x to these points to at most 1, or 0 if doubles cannot hold the
 *  offsets. */
static double plane_offset_scale(const brio_locator2 *l, const uint32_t *points, size_t count, const double *x) {
    double most = 0;
    int exponent;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 2; k++) most = fmax(most, fabs(l->record[points[i]][k] - x[k]));
    if (!(most < INFINITY)) return 0;
    frexp(most, &exponent);
    return exponent < -1000 ? 0x1p1000 : exponent > 1000 ? 0x1p-1020 : brio_power_of_two(-exponent);
}

/* Sets share to the solution of sum share[i] row[i] = target, sum share[i] = total: Cramer's rule. */
static bool solve(const double row[3][2], const double *target, double total, double share[3]) {
    double edge[2][2], rest[2];
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 2; i++) edge[i][k] = row[i + 1][k] - row[0][k];
        rest[k] = target[k] - total * row[0][k];
    }
    double area = brio_plane_cross(edge[0], edge[1]);
    share[1] = brio_plane_cross(rest, edge[1]) / area;
    share[2] = brio_plane_cross(edge[0], rest) / area;
    share[0] = total - share[1] - share[2];
    return isfinite(share[0]);
}

/* Sets residual to -sum share[i] row[i]. */
static void find_residual(const double row[3][2], const double share[3], double residual[2]) {
    for (int k = 0; k < 2; k++) {
        residual[k] = 0;
        for (int i = 0; i < 3; i++) residual[k] -= share[i] * row[i][k];
    }
}

/* Clears the shares that are 0 exactly or would be negative, and divides the others by their sum. */
static void normalize(unsigned zeros, double share[3]) {
    double sum = 0;
    for (int i = 0; i < 3; i++) {
        if (zeros >> i & 1 || !(share[i] > 0)) share[i] = 0;
        sum += share[i];
    }
    for (int i = 0; i < 3; i++) share[i] = sum > 0 ? share[i] / sum : 1.0 / 3;
}

void brio_plane_barycentric(const brio_locator2 *l, const brio_plane_holder *h, const double *x, double share[3]) {
    assert(h->triangle < l->num_finite && h->zeros < 7);
    const uint32_t *v = l->triangle[h->triangle].vertex;
    double row[3][2], residual[2] = {0, 0}, more[3], scale = plane_offset_scale(l, v, 3, x);
    if (__builtin_popcount(h->zeros) == 2) {
        for (int i = 0; i < 3; i++) share[i] = !(h->zeros >> i & 1);
        return;
    }
    for (int i = 0; i < 3; i++) brio_plane_offset(l, v[i], x, scale, row[i]);
    bool solved = solve((const double(*)[2])row, residual, 1, share);
    for (int n = 0; n < REFINEMENTS && solved; n++) {
        find_residual((const double(*)[2])row, share, residual);
        solved = solve((const double(*)[2])row, residual, 0, more);
        for (int i = 0; i < 3 && solved; i++) share[i] += more[i];
    }
    normalize(h->zeros, share);
    double offset[3][3] = {{row[0][0], row[0][1]}, {row[1][0], row[1][1]}, {row[2][0], row[2][1]}};
    if (!brio_shares_hold((const double(*)[3])offset, 3, share))
        brio_flat_shares((const double(*)[3])offset, 3, h->zeros, share);
}

/* --- natural coordinates --- */

void brio_plane_natural_free(brio_plane_natural *n) {
    void *const block[] = {n->ahead, n->corner, n->centre, n->tour, n->border, n->point, n->offset, n->share};
    if (!n->ctx) return;
    for (size_t i = 0; i < sizeof block / sizeof *block; i++) brio_release(n->ctx, block[i]);
    *n = (brio_plane_natural){0};
}

/* --- the tour round the cavity --- */

static brio_status visit(brio_plane_natural *n, uint32_t centre) {
    brio_status status = BRIO_RESERVE(n->ctx, n->tour, n->tour_room, n->num_tour + 1);
    if (status == BRIO_OK) n->tour[n->num_tour++] = centre;
    return status;
}

/* Adds the centre of three points and visits it. */
static brio_status add_centre(brio_plane_natural *n, uint32_t a, uint32_t b, uint32_t c) {
    brio_status status = BRIO_RESERVE(n->ctx, n->corner, n->corner_room, n->num_centres + 1);
    if (status != BRIO_OK) return status;
    assert(a != b && b != c && c != a && n->num_centres < n->corner_room);
    uint32_t *corner = n->corner[n->num_centres];
    corner[0] = a, corner[1] = b, corner[2] = c;
    return visit(n, (uint32_t)n->num_centres++);
}

/* Plans to cross an edge and then to come back to a centre; without a centre, to stay. */
static brio_status plan(brio_plane_natural *n, uint32_t edge, uint32_t centre) {
    brio_status status = BRIO_RESERVE(n->ctx, n->ahead, n->ahead_room, n->num_ahead + 2);
    if (status != BRIO_OK) return status;
    if (centre != BRIO_INFINITE) n->ahead[n->num_ahead++] = (brio_plane_step){BRIO_INFINITE, centre};
    n->ahead[n->num_ahead++] = (brio_plane_step){edge, 0};
    return BRIO_OK;
}

/* Notes the border edge before the edge `outer` of a triangle outside the cavity, which sees it clockwise. */
static brio_status add_border(brio_plane_natural *n, const brio_triangle *outside, uint32_t outer) {
    uint32_t from = outside->vertex[brio_slot_before(brio_edge_slot(outer))];
    uint32_t to = outside->vertex[brio_slot_after(brio_edge_slot(outer))];
    BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->border, n->border_room, n->num_points + 1));
    BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->point, n->point_room, n->num_points + 1));
    assert(from != to);
    n->border[n->num_points] = (uint32_t)n->num_tour;
    n->point[n->num_points++] = to;
    return add_centre(n, BRIO_INFINITE, from, to);
}

static brio_status cross(brio_plane_natural *n, brio_plane_querent *q, uint32_t edge, const double *x) {
    const brio_locator2 *l = q->l;
    uint32_t t = brio_triangle_of(edge), i = brio_edge_slot(edge), centre = (uint32_t)n->num_centres;
    assert(t < l->num_triangles && i < 3);
    const brio_triangle *own = &l->triangle[t];
    const uint32_t *v = own->vertex;
    if (t >= l->num_finite ||
        !brio_circle_conflict(&q->filter, l->record[v[0]], l->record[v[1]], l->record[v[2]], x, false))
        return add_border(n, own, edge);
    BRIO_FORWARD(add_centre(n, v[0], v[1], v[2]));
    BRIO_FORWARD(plan(n, own->mate[brio_slot_before(i)], centre));
    return plan(n, own->mate[brio_slot_after(i)], centre);
}

/* Goes round the cavity from triangle t, which holds x. */
static brio_status go_round(brio_plane_natural *n, brio_plane_querent *q, uint32_t t, const double *x) {
    const brio_triangle *own = &q->l->triangle[t];
    n->num_ahead = n->num_centres = n->num_tour = n->num_points = 0;
    BRIO_FORWARD(add_centre(n, own->vertex[0], own->vertex[1], own->vertex[2]));
    BRIO_FORWARD(plan(n, own->mate[2], BRIO_INFINITE)); /* then the tour begins again */
    BRIO_FORWARD(plan(n, own->mate[1], 0));
    BRIO_FORWARD(plan(n, own->mate[0], 0));
    while (n->num_ahead) {
        brio_plane_step step = n->ahead[--n->num_ahead];
        BRIO_FORWARD(step.edge == BRIO_INFINITE ? visit(n, step.centre) : cross(n, q, step.edge, x));
    }
    return BRIO_OK;
}

/* --- areas --- */

static void corner_offset(const brio_locator2 *l, uint32_t point, const double *x, double scale, double record[4]) {
    record[0] = record[1] = record[2] = record[3] = 0;
    if (point != BRIO_INFINITE) brio_plane_offset(l, point, x, scale, record);
}

/* Computes the centres. *found becomes false where doubles do not hold them. */
static brio_status find_centres(brio_plane_natural *n, const brio_locator2 *l, const double *x, bool *found) {
    brio_plane_circles batch; /* no initializer, which would clear all of it */
    double scale = plane_offset_scale(l, n->point, n->num_points, x), record[3][4];
    batch.count = 0;
    BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->centre, n->centre_room, n->num_centres));
    BRIO_FORWARD(BRIO_RESERVE(n->ctx, n->offset, n->offset_room, n->num_points));
    for (size_t k = 0; k < n->num_points; k++) brio_plane_offset(l, n->point[k], x, scale, n->offset[k]);
    for (size_t c = 0; c < n->num_centres; c++) {
        for (int i = 0; i < 3; i++) corner_offset(l, n->corner[c][i], x, scale, record[i]);
        brio_plane_circles_add(&batch, record[0], record[1], record[2]);
        if (batch.count == BRIO_CENTRE_BATCH || c + 1 == n->num_centres)
            brio_plane_circles_solve(&batch, false, n->centre + c + 1 - batch.count);
    }
    *found = scale > 0;
    for (size_t c = 0; c < n->num_centres; c++) *found &= isfinite(n->centre[c][0]);
    return BRIO_OK;
}

/* Returns twice the area that x takes from the point at the end of border edge k. */
static double area_at(const brio_plane_natural *n, size_t k) {
    assert(k < n->num_points);
    size_t at = n->border[k], end = n->border[k + 1 < n->num_points ? k + 1 : 0];
    const double *first = n->centre[n->tour[at]];
    double last[2] = {0, 0}, area = 0;
    while (at != end) {
        at = at + 1 < n->num_tour ? at + 1 : 0;
        assert(n->tour[at] < n->num_centres);
        const double *c = n->centre[n->tour[at]];
        double next[2] = {c[0] - first[0], c[1] - first[1]};
        area -= brio_plane_cross(last, next);
        last[0] = next[0], last[1] = next[1];
    }
    return area;
}

/* Sets the shares to the areas. Sets *sum to their sum. */
static brio_status add_areas(brio_plane_natural *n, double *sum) {
    brio_status status = BRIO_RESERVE(n->ctx, n->share, n->share_room, n->num_points);
    *sum = 0;
    if (status != BRIO_OK) return status;
    for (size_t k = 0; k < n->num_points; k++) {
        double area = area_at(n, k);
        *sum += n->share[k] = area > 0 ? area : 0;
    }
    return BRIO_OK;
}

/* --- the last step --- */

/* Makes the shares reproduce x: multiplies each by 1 + g . (offset - r), r being their mean. Returns false if that
 * takes a change that is no rounding error. */
static bool correct(brio_plane_natural *n) {
    static const double MOST = 1e-4; /* chosen, as in locate/natural.c */
    double r[2] = {0, 0}, m[2][2] = {{0, 0}, {0, 0}};
    for (size_t k = 0; k < n->num_points; k++)
        for (int i = 0; i < 2; i++) {
            r[i] += n->share[k] * n->offset[k][i];
            for (int j = 0; j < 2; j++) m[i][j] += n->share[k] * n->offset[k][i] * n->offset[k][j];
        }
    if (r[0] == 0 && r[1] == 0) return true;
    for (int i = 0; i < 2; i++)
        for (int j = 0; j < 2; j++) m[i][j] -= r[i] * r[j];
    double determinant = brio_plane_cross(m[0], m[1]);
    double g[2] = {(r[1] * m[0][1] - r[0] * m[1][1]) / determinant, (r[0] * m[1][0] - r[1] * m[0][0]) / determinant};
    for (size_t k = 0; k < n->num_points; k++) {
        double change = g[0] * (n->offset[k][0] - r[0]) + g[1] * (n->offset[k][1] - r[1]);
        if (!(fabs(change) <= MOST)) return false;
        n->share[k] *= 1 + change;
    }
    return true;
}

/* Returns whether the shares reproduce x, as brio_shares_hold does. */
static bool reproduces(const brio_plane_natural *n) {
    double r[2] = {0, 0}, most = 0;
    for (size_t k = 0; k < n->num_points; k++) {
        const double *offset = n->offset[k];
        for (int i = 0; i < 2; i++) r[i] += n->share[k] * offset[i];
        most = fmax(most, offset[0] * offset[0] + offset[1] * offset[1]);
    }
    return r[0] * r[0] + r[1] * r[1] <= BRIO_SHARES_NEAR * most;
}

static bool divide_by_sum(brio_plane_natural *n, double sum) {
    if (!(sum > 0 && sum < INFINITY)) return false;
    for (size_t k = 0; k < n->num_points; k++) n->share[k] /= sum;
    return true;
}

brio_status brio_plane_natural_coordinates(brio_plane_natural *n, brio_plane_querent *q, const brio_plane_holder *h,
                                           const double *x, bool *found) {
    double sum;
    assert(h->triangle < q->l->num_finite && !q->l->weighted);
    BRIO_FORWARD(go_round(n, q, h->triangle, x));
    assert(n->num_ahead == 0 && n->num_points >= 3 && n->num_tour >= n->num_centres); /* the border is a cycle */
    BRIO_FORWARD(find_centres(n, q->l, x, found));
    if (!*found) return BRIO_OK;
    BRIO_FORWARD(add_areas(n, &sum));
    *found = divide_by_sum(n, sum) && correct(n) && correct(n) && reproduces(n);
    return BRIO_OK;
}
