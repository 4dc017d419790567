/* Unions of balls: volume and area by formulas, and the mesh.
 *
 * Inclusion and exclusion over the dual complex, with each term shared among the tetrahedra at its simplex, leaves
 *
 *   volume = the tetrahedra of the complex
 *          + for each corner the tetrahedron of its three centres and itself
 *          + for each ball r^3 w / 3, w being the solid angle that these tetrahedra leave at its centre
 *          - for each arc its angle / 2 pi times the volume of the intersection of its two balls
 *
 * since a triple of balls has the volume 2 (t - sum r^3 w / 3 + sum a V / 2 pi): t, w and a are the volume, the solid
 * angles and the dihedral angles of the tetrahedron of the centres and a corner, and V the volumes of the intersections
 * of two. The area of a ball on the boundary is r^2 (w - sum of a (1 - cos c)): c is the angular radius of the cap that
 * the other ball of an arc covers.
 *
 * Based on: Edelsbrunner. The union of balls and its dual shape. DCG 1995.
 * Differs from the paper: the terms of arcs and corners are summed as what their angles leave, so that no intersection
 *                         of three balls is computed, and simplices inside the complex have no terms. */
#include "balls/union_boundary.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/scale.h"
#include "base/vector.h"
#include "base/versioned.h"
#include <math.h>
#include <string.h>

static const double PI = 3.14159265358979323846;
static const double ERROR = 0.001; /* of the mesh, in diagonals of the box of the balls */

/* Returns the determinant of three points seen from a fourth one: six times the volume of the tetrahedron. */
static double determinant(const double *o, const double *p, const double *q, const double *r) {
    double a[3], b[3], c[3], n[3];
    for (int k = 0; k < 3; k++) a[k] = p[k] - o[k], b[k] = q[k] - o[k], c[k] = r[k] - o[k];
    brio_cross(b, c, n);
    return brio_dot(a, n);
}

/* Returns the solid angle of three points seen from a fourth one [Van Oosterom Strackee 1983]. */
static double solid_angle(const double *o, const double *p, const double *q, const double *r) {
    double a[3], b[3], c[3], n[3];
    for (int k = 0; k < 3; k++) a[k] = p[k] - o[k], b[k] = q[k] - o[k], c[k] = r[k] - o[k];
    double la = brio_length(a), lb = brio_length(b), lc = brio_length(c);
    brio_cross(b, c, n);
    double down = la * lb * lc + brio_dot(a, b) * lc + brio_dot(b, c) * la + brio_dot(c, a) * lb;
    double angle = 2 * atan2(fabs(brio_dot(a, n)), down);
    return angle;
}

typedef struct {
    const brio_union_boundary *b;
    double *left; /* #balls: the solid angle that the tetrahedra leave */
    double *area; /* #balls */
    double volume, total;
} measure;

/* Adds a tetrahedron of the complex, or of a corner. The last place is that of a ball if `balls` is 4. */
static void add_tetrahedron(measure *m, const uint32_t *ball, const double *const place[4], int balls) {
    m->volume += fabs(determinant(place[0], place[1], place[2], place[3])) / 6;
    for (int i = 0; i < balls; i++)
        m->left[ball[i]] -= solid_angle(place[i], place[(i + 1) % 4], place[(i + 2) % 4], place[(i + 3) % 4]);
}

static void add_complex(measure *m) {
    const brio_union_boundary *b = m->b;
    for (size_t t = 0; t < b->num_finite; t++) {
        const double *place[4];
        if (!b->tet_in[t]) continue;
        for (int i = 0; i < 4; i++) place[i] = b->centre + 3 * (size_t)b->t.tet[t].vertex[i];
        add_tetrahedron(m, b->t.tet[t].vertex, place, 4);
    }
    for (size_t c = 0; c < b->num_corners; c++) {
        const double *place[4] = {NULL, NULL, NULL, b->corner[c].place};
        for (int i = 0; i < 3; i++) place[i] = b->centre + 3 * (size_t)b->corner[c].ball[i];
        add_tetrahedron(m, b->corner[c].ball, place, 3);
    }
}

static double cap_volume(double radius, double height) {
    return PI / 3 * height * height * (3 * radius - height);
}

static void add_arc(measure *m, const brio_arc *a) {
    double axis[3], d, plane[2], lens = 0;
    plane[0] = brio_circle_plane(m->b, a->ball[0], a->ball[1], axis, &d);
    plane[1] = d - plane[0];
    for (int s = 0; s < 2; s++) {
        double radius = sqrt(m->b->weight[a->ball[s]]), height = radius - plane[s];
        lens += cap_volume(radius, height);
        m->area[a->ball[s]] -= a->angle * radius * height;
    }
    m->volume -= a->angle / (2 * PI) * lens;
}

/* Measures the union, in the unit of the boundary. */
static void measure_all(measure *m, uint8_t *exposed) {
    const brio_union_boundary *b = m->b;
    for (size_t p = 0; p < b->num_patches; p++) exposed[b->patch[p]] = 1;
    for (size_t i = 0; i < b->num_balls; i++) m->left[i] = 4 * PI;
    add_complex(m);
    for (size_t i = 0; i < b->num_balls; i++) {
        if (!exposed[i]) continue;
        m->area[i] = b->weight[i] * m->left[i];
        m->volume += b->weight[i] * sqrt(b->weight[i]) * m->left[i] / 3;
    }
    for (size_t a = 0; a < b->num_arcs; a++) add_arc(m, &b->arc[a]);
    for (size_t i = 0; i < b->num_balls; i++) m->area[i] = fmax(m->area[i], 0), m->total += m->area[i];
}

static brio_status take_measures(const brio_union_boundary *b, size_t num_points, double *areas,
                                 brio_ball_union_stats *s) {
    brio_status status = BRIO_OK;
    measure m = {.b = b};
    uint8_t *exposed = NULL;
    BRIO_TRY(BRIO_ALLOC(b->ctx, m.left, b->num_balls));
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, m.area, b->num_balls));
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, exposed, b->num_balls));
    measure_all(&m, exposed);
    if (areas) memset(areas, 0, num_points * sizeof *areas);
    for (size_t i = 0; i < b->num_balls; i++) {
        if (areas) areas[b->of_ball[i]] = ldexp(m.area[i], 2 * b->exponent);
        s->exposed += exposed[i];
    }
    s->volume = ldexp(m.volume, 3 * b->exponent);
    s->area = ldexp(m.total, 2 * b->exponent);
done:
    brio_release(b->ctx, m.left);
    brio_release(b->ctx, m.area);
    brio_release(b->ctx, exposed);
    return status;
}

static void count_parts(const brio_union_boundary *b, brio_ball_union_stats *s) {
    s->balls = b->num_balls;
    s->patches = b->num_patches;
    s->arcs = b->num_arcs;
    s->corners = b->num_corners;
    s->components = b->components;
    s->voids = b->voids;
    s->tunnels = (size_t)((int64_t)(b->components + b->voids) - b->euler);
}

/* Returns the diagonal of the box of the balls, in the caller's unit. */
static double diagonal(const brio_union_boundary *b) {
    double sum = 0;
    for (size_t k = 0; k < 3; k++) {
        double low = INFINITY, high = -INFINITY;
        for (size_t i = 0; i < b->num_balls; i++) {
            double radius = sqrt(b->weight[i]);
            low = fmin(low, b->centre[3 * i + k] - radius);
            high = fmax(high, b->centre[3 * i + k] + radius);
        }
        sum += (high - low) * (high - low);
    }
    return ldexp(sqrt(sum), b->exponent);
}

static brio_status make_mesh(const brio_union_boundary *b, double error, brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL;
    BRIO_TRY(brio_mesh_new(b->ctx, &mesh));
    BRIO_TRY(brio_union_mesh(b, error, mesh));
    *out = mesh;
    mesh = NULL;
done:
    brio_mesh_free(mesh);
    return status;
}

brio_status brio_ball_union(brio_context *ctx, const double *centres, const double *weights, size_t num_points,
                            const brio_ball_union_options *options, double *areas, brio_mesh **out,
                            brio_ball_union_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_ball_union_options o = {0};
    brio_ball_union_stats s = {0};
    brio_union_boundary b = {.ctx = ctx};
    double start = brio_seconds();
    if (out) *out = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_ball_union_stats, stats));
    BRIO_TRY(BRIO_TAKE(ctx, brio_ball_union_options, options, &o));
    BRIO_REQUIRE(ctx, o.error >= 0 && isfinite(o.error), BRIO_ERR_ARGUMENT, "error %g, expected 0 or a positive number",
                 o.error);
    BRIO_TRY(brio_union_boundary_find(ctx, centres, weights, num_points, o.seed ? o.seed : BRIO_SEED, &b));
    s.delaunay_seconds = brio_seconds() - start;
    count_parts(&b, &s);
    BRIO_TRY(take_measures(&b, num_points, areas, &s));
    s.measure_seconds = brio_seconds() - start - s.delaunay_seconds;
    s.error = o.error > 0 ? o.error : ERROR * diagonal(&b);
    if (out) BRIO_TRY(make_mesh(&b, s.error, out));
    s.mesh_seconds = brio_seconds() - start - s.delaunay_seconds - s.measure_seconds;
    BRIO_GIVE(brio_ball_union_stats, stats, &s);
done:
    brio_union_boundary_free(&b);
    return status;
}
