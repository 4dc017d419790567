/* The radius of a Voronoi cell inside the co-cone of its sample.
 *
 * Every facet of the Delaunay triangulation is dual to a Voronoi edge, which belongs to the cells of the facet's three
 * vertices. A quadratic equation cuts the edge with the cone about the direction to the sample's farther pole. The
 * distance from the sample is convex along the edge, so an end of a piece in the co-cone is the farthest point of it.
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. IJCGA 2002 (the
 *           co-cone).
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, corollary 23: on an r-sample the radius is at
 *           most 1.3 r / (1 - r) times the local feature size.
 * Differs from the paper: the distance to the nearer pole stands for the local feature size.
 */
#include "dual/cell_shape.h"
#include "base/team.h"
#include "base/vector.h"
#include <assert.h>
#include <math.h>

enum { SAMPLES_A_THREAD = 1 << 13, TETRAHEDRA_A_THREAD = 1 << 13 };

static const double SQUARED_SINE = 0.14644660940672624; /* derived: sin(pi / 8)^2 */

static void subtract(const double *a, const double *b, double *difference) {
    for (int k = 0; k < 3; k++) difference[k] = a[k] - b[k];
}

/* A Voronoi edge relative to a sample: the ends a and b, and the vector n from the sample to its farther pole. */
typedef struct {
    double a[3], b[3], n[3];
} seen_edge;

/* Returns whether both ends are in one of the two cones outside the co-cone. That cone is convex, so it holds the whole
 * edge. Most edges pass this test. */
static inline bool is_in_one_cone(const seen_edge *e) {
    double an = brio_dot(e->a, e->n), bn = brio_dot(e->b, e->n), limit = SQUARED_SINE * brio_dot(e->n, e->n);
    return an * bn > 0 && an * an > limit * brio_dot(e->a, e->a) && bn * bn > limit * brio_dot(e->b, e->b);
}

/* Returns the largest squared length of a point of the edge in the co-cone, or 0 when no point is in the co-cone. */
static double reach_in_cocone(const seen_edge *e) {
    const double *a = e->a, *b = e->b, *n = e->n;
    double d[3], limit = SQUARED_SINE * brio_dot(n, n), most = 0;
    subtract(b, a, d);
    /* x is in the co-cone when (x.n)^2 - limit x.x <= 0; for x = a + t d the left side is (q2 t + 2 q1) t + q0 */
    double an = brio_dot(a, n), dn = brio_dot(d, n), aa = brio_dot(a, a), ad = brio_dot(a, d), dd = brio_dot(d, d);
    double q2 = dn * dn - limit * dd, q1 = an * dn - limit * ad, q0 = an * an - limit * aa;
    if (q0 <= 0) most = aa;
    if (q2 + 2 * q1 + q0 <= 0) most = fmax(most, brio_dot(b, b));
    double discriminant = q1 * q1 - q2 * q0;
    if (discriminant < 0) return most;
    double sum = -(q1 + copysign(sqrt(discriminant), q1)), root[2] = {sum / q2, q0 / sum};
    for (int i = 0; i < 2; i++)
        if (root[i] > 0 && root[i] < 1) most = fmax(most, aa + root[i] * (2 * ad + root[i] * dd));
    return most;
}

/* Raises *most to value; other threads may raise *most meanwhile. Relaxed order is enough: no other data depends on
 * *most, and its final value is read after the parallel loop. */
static void raise_to(double *most, double value) {
    double now;
    __atomic_load(most, &now, __ATOMIC_RELAXED);
    while (now < value && !__atomic_compare_exchange(most, &now, &value, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
}

/* Raises square[s] to the largest squared distance from sample s to a point of the edge in the co-cone.
 * reach  at least the squared distance from s to the farther end of the edge, and barely more. */
static inline void offer_edge(const brio_shaped_cells *c, uint32_t s, const double *from, const double *to,
                              double reach, double *square) {
    double so_far;
    if (s >= c->num_samples || c->pole_of[2 * (size_t)s] == UINT32_MAX) return;
    __atomic_load(&square[s], &so_far, __ATOMIC_RELAXED);
    if (reach <= so_far) return;
    const double *sample = c->points + 3 * (size_t)s;
    seen_edge e;
    subtract(from, sample, e.a);
    subtract(to, sample, e.b);
    subtract(c->centre + 3 * (size_t)c->pole_of[2 * (size_t)s], sample, e.n);
    if (!is_in_one_cone(&e)) raise_to(&square[s], reach_in_cocone(&e));
}

/* Offers the Voronoi edges of tetrahedron t to the samples of its facets. Each Voronoi edge is offered once, by the
 * lower of its two tetrahedra. The three samples of a facet have equal distances to each end of the dual edge. */
static void offer_edges(const brio_shaped_cells *c, size_t t, double *square) {
    static const double MORE = 1 + 1e-9; /* chosen: exceeds the relative rounding error of a squared distance */
    assert(t < c->num_finite);
    const double *from = c->centre + 3 * t;
    if (isnan(from[0])) return;
    double own = brio_square_distance(from, c->points + 3 * (size_t)c->tet[t].vertex[0]);
    for (int i = 0; i < 4; i++) {
        size_t u = c->tet[t].mate[i] / 4;
        const double *to = c->centre + 3 * u;
        if (u < t || u >= c->num_finite || isnan(to[0])) continue;
        double other = brio_square_distance(to, c->points + 3 * (size_t)c->tet[t].vertex[(i + 1) % 4]);
        double reach = MORE * fmax(own, other);
        for (int k = 1; k < 4; k++) offer_edge(c, c->tet[t].vertex[(i + k) % 4], from, to, reach, square);
    }
}

static double nearer_pole_square(const brio_shaped_cells *c, size_t s) {
    uint32_t nearer = c->pole_of[2 * s + 1];
    if (nearer == UINT32_MAX) return INFINITY;
    return brio_square_distance(c->centre + 3 * (size_t)nearer, c->points + 3 * s);
}

/* --- the loops --- */

typedef struct {
    const brio_shaped_cells *c;
    double most, *shape;
} measurement;

/* Sets shape[s] to a squared radius for now: the radius at which the shape is `most`. */
static void set_least_radii(void *user, size_t begin, size_t end, int thread) {
    const measurement *m = user;
    (void)thread;
    for (size_t s = begin; s < end; s++) m->shape[s] = nearer_pole_square(m->c, s) / (m->most * m->most);
}

static void raise_radii(void *user, size_t begin, size_t end, int thread) {
    const measurement *m = user;
    (void)thread;
    for (size_t t = begin; t < end; t++) offer_edges(m->c, t, m->shape);
}

static void divide_by_radii(void *user, size_t begin, size_t end, int thread) {
    const measurement *m = user;
    (void)thread;
    for (size_t s = begin; s < end; s++) {
        double square = m->shape[s];
        m->shape[s] = square > 0 && square < INFINITY ? sqrt(nearer_pole_square(m->c, s) / square) : m->most;
    }
}

/* Relies on offer_edge skipping the edges within the radius at which the shape is `most`: such edges cannot change the result. */
brio_status brio_cell_shapes(brio_context *ctx, const brio_shaped_cells *c, double most, double *shape) {
    brio_status status = BRIO_OK;
    assert(most > 0);
    measurement m = {c, most, shape};
    int threads = brio_threads(ctx, c->num_samples, SAMPLES_A_THREAD);
    BRIO_TRY(brio_for(ctx, threads, c->num_samples, set_least_radii, &m));
    BRIO_TRY(brio_for(ctx, brio_threads(ctx, c->num_finite, TETRAHEDRA_A_THREAD), c->num_finite, raise_radii, &m));
    status = brio_for(ctx, threads, c->num_samples, divide_by_radii, &m);
done:
    return status;
}

bool brio_cell_is_bad(double shape, double density) {
    assert(0 < density && density < 1);
    return shape < (1 - density) / (1.3 * density);
}
