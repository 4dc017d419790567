/* Boundary samples, found by the shape of their Voronoi cells.
 *
 * The cell of a sample in the middle of a well-sampled surface is long along the normal and thin across it. Its height
 * is the distance to the pole on the side away from the farther pole. Its radius is the distance to the farthest point
 * of the cell's edges in the co-cone. The cell is thin if the height is large against the radius. A sample is interior
 * if its cell is thin and the axes of its neighbours within the co-cone are nearly parallel to its own. A sample with a
 * thin cell is interior, too, if one interior neighbour has a nearly parallel axis. All other samples are boundary
 * samples.
 *
 * Based on: Dey, Giesen. Detecting undersampling in surface reconstruction. SoCG 2001. */
#include "reconstruct/cocone/boundary_samples.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/vector.h"
#include <math.h>

/* Limits for interior samples: radius over height, and the cosine of the angle between axes (pi / 6). A ratio of 0.8
 * finds the rim of the club (63 boundary edges, 56 in truth) and of holes cut into closed models. Closed models stay
 * closed, except for a hundredth of their samples. A ratio of 0.6 opens many sharp places, 1.2 misses the holes. */
static const double MOST_RATIO = 0.8, LEAST_COSINE = 0.8660254037844386;

/* If sample `from` is interior, sample `to` is, too. */
typedef struct {
    uint32_t from, to;
} follower;

typedef struct {
    brio_context *ctx;
    const brio_cocones *cocones;
    const brio_pole_vectors *dual;
    double *radius;    /* #P: the radius of the sample's cell */
    uint8_t *thin;     /* #P: 1 if the cell is thin */
    uint8_t *interior; /* #P: 1 if the sample is interior */
    follower *pair;
    size_t num_pairs, pair_capacity;
} detection;

/* --- radius --- */

/* Returns the distance from the sample at which the ray from `in`, in the co-cone, along `way` leaves the co-cone. This
 * is |x| for x = in + t way, t being the positive root of (x . axis)^2 = sine^2 |x|^2. All vectors are relative to the
 * sample. */
static double border_distance(const double *axis, double sine, const double *in, const double *way) {
    double along = brio_dot(in, axis), slope = brio_dot(way, axis), s = sine * sine;
    double a = slope * slope - s * brio_dot(way, way), b = along * slope - s * brio_dot(in, way);
    double c = fmin(along * along - s * brio_dot(in, in), 0), root = sqrt(fmax(b * b - a * c, 0));
    double t = b > 0 ? -c / (b + root) : a > 0 ? (root - b) / a : 0;
    double x[3] = {in[0] + t * way[0], in[1] + t * way[1], in[2] + t * way[2]};
    return sqrt(brio_dot(x, x));
}

/* Returns the greatest distance from p of the part of a Voronoi edge in the co-cone of p, which the edge meets. The
 * edge joins the Voronoi vertices of two tetrahedra, the first of them finite. */
static double reach(const brio_cocones *c, uint32_t p, const uint32_t tet[2]) {
    const brio_pole_vectors *v = c->dual;
    const double *axis = v->plane + 4 * (size_t)p;
    double end[2][3], way[3], back[3], middle[3], sine = sin(v->theta);
    bool inside[2], ray = tet[1] >= v->num_finite;
    for (int i = 0; i < 2; i++) {
        brio_towards_centre(v, tet[i], p, end[i]);
        inside[i] = brio_side_of(v, tet[i], brio_slot_of_vertex(v->t.tet[tet[i]].vertex, p)) == BRIO_SIDE_COCONE;
    }
    if (isnan(end[0][0] + end[1][0]) || (ray && inside[1])) return INFINITY;
    for (int k = 0; k < 3; k++) way[k] = ray ? end[1][k] : end[1][k] - end[0][k], back[k] = -way[k];
    double t = inside[0] ? 0 : inside[1] ? 1 : -brio_dot(end[0], axis) / brio_dot(way, axis);
    for (int k = 0; k < 3; k++) middle[k] = end[0][k] + t * way[k];
    double first = inside[0] ? sqrt(brio_dot(end[0], end[0])) : border_distance(axis, sine, middle, back);
    double second = inside[1] ? sqrt(brio_dot(end[1], end[1])) : border_distance(axis, sine, middle, way);
    return fmax(first, second);
}

/* --- neighbours --- */

static double axis_cosine(const brio_cocones *c, uint32_t p, uint32_t q) {
    const double *u = c->dual->plane + 4 * (size_t)p, *v = c->dual->plane + 4 * (size_t)q;
    return fabs(brio_dot(u, v));
}

/* Called for a facet whose Voronoi edge meets the co-cone of corner[0]. */
typedef brio_status (*visit_fn)(detection *d, uint32_t facet, const uint32_t corner[3]);

/* Visits every facet once for each corner whose co-cone its Voronoi edge meets. That corner comes first. */
static brio_status visit_meetings(detection *d, visit_fn visit) {
    brio_status status = BRIO_OK;
    const brio_tetrahedra *t = &d->dual->t;
    for (size_t tet = 0; tet < t->count; tet++) {
        BRIO_TRY(brio_look(d->ctx, 8));
        for (int i = 0; i < 4; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i), v[3];
            if (*brio_mate(t, facet) < facet || (i != 3 && t->tet[tet].vertex[3] == BRIO_INFINITE)) continue;
            for (int k = 0; k < 3; k++) {
                for (int m = 0; m < 3; m++) v[m] = t->tet[tet].vertex[BRIO_FACET[i][(k + m) % 3]];
                if (brio_meets_cocone(d->cocones, facet, v[0])) BRIO_TRY(visit(d, facet, v));
            }
        }
    }
done:
    return status;
}

static brio_status measure(detection *d, uint32_t facet, const uint32_t corner[3]) {
    uint32_t p = corner[0], tet[2] = {brio_tet_of(facet), brio_tet_of(*brio_mate(&d->dual->t, facet))};
    if (tet[0] >= d->dual->num_finite) tet[0] = tet[1], tet[1] = brio_tet_of(facet);
    d->radius[p] = fmax(d->radius[p], reach(d->cocones, p, tet));
    for (int m = 1; m < 3; m++)
        if (axis_cosine(d->cocones, p, corner[m]) < LEAST_COSINE) d->interior[p] = 0;
    return BRIO_OK;
}

static double height(const brio_pole_vectors *v, size_t p) {
    uint32_t pole = v->pole[2 * p + 1];
    double to[3];
    if (pole == BRIO_INFINITE) return INFINITY;
    brio_towards_centre(v, pole, p, to);
    return sqrt(brio_dot(to, to));
}

/* Lists the samples with thin cells that become interior if corner[0] is. */
static brio_status follow(detection *d, uint32_t facet, const uint32_t corner[3]) {
    brio_status status = BRIO_OK;
    (void)facet;
    for (int m = 1; m < 3; m++) {
        uint32_t from = corner[0], to = corner[m];
        if (d->interior[to] || !d->thin[to] || axis_cosine(d->cocones, from, to) < LEAST_COSINE) continue;
        BRIO_TRY(BRIO_RESERVE(d->ctx, d->pair, d->pair_capacity, d->num_pairs + 1));
        d->pair[d->num_pairs++] = (follower){from, to};
    }
done:
    return status;
}

/* Makes followers of interior samples interior, breadth first. A table gives the followers of each sample. */
static brio_status spread(detection *d) {
    brio_status status = BRIO_OK;
    size_t n = d->dual->num_points, size = 0;
    size_t *first = NULL;
    uint32_t *to = NULL, *queue = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, first, n + 1));
    BRIO_TRY(BRIO_ALLOC(d->ctx, to, d->num_pairs));
    BRIO_TRY(BRIO_ALLOC(d->ctx, queue, n));
    for (size_t i = 0; i < d->num_pairs; i++) first[d->pair[i].from + 1]++;
    brio_counts_to_places(first + 1, 1, n, 0); /* filling moves each place to the end of its list */
    for (size_t i = 0; i < d->num_pairs; i++) to[first[d->pair[i].from + 1]++] = d->pair[i].to;
    for (size_t p = 0; p < n; p++)
        if (d->interior[p]) queue[size++] = (uint32_t)p;
    for (size_t head = 0; head < size; head++)
        for (size_t i = first[queue[head]]; i < first[queue[head] + 1]; i++)
            if (!d->interior[to[i]]) d->interior[to[i]] = 1, queue[size++] = to[i];
done:
    brio_release(d->ctx, first);
    brio_release(d->ctx, to);
    brio_release(d->ctx, queue);
    return status;
}

static brio_status detect(detection *d, size_t n) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, d->radius, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(d->ctx, d->thin, n));
    BRIO_TRY(BRIO_ALLOC(d->ctx, d->interior, n));
    for (size_t p = 0; p < n; p++) d->interior[p] = 1;
    BRIO_TRY(visit_meetings(d, measure));
    for (size_t p = 0; p < n; p++) {
        d->thin[p] = d->radius[p] < INFINITY && d->radius[p] <= MOST_RATIO * height(d->dual, p);
        d->interior[p] &= d->thin[p];
    }
    BRIO_TRY(visit_meetings(d, follow));
    BRIO_TRY(spread(d));
done:
    return status;
}

brio_status brio_boundary_samples(brio_context *ctx, const brio_cocones *c, uint8_t **boundary, size_t *count) {
    brio_status status = BRIO_OK;
    const brio_pole_vectors *v = c->dual;
    detection d = {.ctx = ctx, .cocones = c, .dual = v};
    *boundary = NULL;
    *count = 0;
    BRIO_TRY(detect(&d, v->num_points));
    for (size_t p = 0; p < v->num_points; p++) { /* points that are no vertices have no cell */
        d.interior[p] = !d.interior[p] && (v->pole[2 * p] != BRIO_INFINITE);
        *count += d.interior[p];
    }
    *boundary = d.interior;
    d.interior = NULL;
done:
    brio_release(ctx, d.radius);
    brio_release(ctx, d.thin);
    brio_release(ctx, d.interior);
    brio_release(ctx, d.pair);
    return status;
}
