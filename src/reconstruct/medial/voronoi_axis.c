/* The medial axis as a part of the Voronoi diagram of the samples.
 *
 *   1. The Delaunay triangulation, its Voronoi vertices, and the direction from each sample to its pole.
 *   2. The umbrella of each sample: its triangles whose Voronoi edges cross the plane normal to that direction.
 *   3. The Delaunay edges that the angle condition or the ratio condition chooses; their Voronoi facets are the axis.
 *   4. What is inside: winding numbers of the Voronoi vertices about a closed surface, the caller's or the labeled
 *      Delaunay triangulation's.
 *
 * Based on: Dey, Zhao. Approximating the medial axis from the Voronoi diagram with a convergence guarantee.
 *           Algorithmica 2004.
 * Differs from the paper: facets without end are left out, and so are facets that cross the surface, which dense
 *                         samples do not have. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/scale.h"
#include "base/vector.h"
#include "base/versioned.h"
#include "dual/pole_vectors.h"
#include "order/canonical_points.h"
#include "predicates/circumcentre.h"
#include "reconstruct/labels/label_solid.h"
#include "reconstruct/noise/sample_noise.h"
#include "triangulation/ring.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum { NO_VERTEX = UINT32_MAX };
static const double THETA = 0.39269908169872415; /* pi / 8, and */
static const double RHO = 8;                     /* 8, as the paper has them */
static const double SURFACE_SHARE = 0.5;         /* of the progress bar */

/* A triangle of an umbrella: its unit normal, its squared circumradius, and its corners other than the sample. */
typedef struct {
    double normal[3], square;
    uint32_t end[2];
} rib;

typedef struct {
    brio_context *ctx;
    brio_voronoi_axis_options o;
    brio_voronoi_axis_stats stats;
    double *points; /* #samples by 3, in canonical order, scaled by 2^-exponent */
    size_t num_samples;
    int exponent;
    brio_triangulation *t;
    brio_pole_vectors v;
    uint64_t *first; /* #samples + 1: where the umbrella of each sample begins in `rib` */
    rib *rib;
    double square_sine, square_rho;
    uint32_t *facet; /* the tetrahedra round each chosen edge, one edge after the other */
    uint64_t *end;   /* where each of these lists ends */
    size_t num_facet, facet_capacity, num_facets, end_capacity;
    uint32_t *number; /* #T: the vertex of each tetrahedron, or NO_VERTEX */
    brio_mesh *solid; /* of the points; NULL if the caller has one */
} axis;

/* --- samples --- */

static brio_status reduce_noise(axis *a) {
    bool smooth = a->o.noise == BRIO_NOISE_SMOOTH;
    if (a->o.noise == BRIO_NOISE_AUTO && !a->o.solid) {
        BRIO_FORWARD(brio_noise_level(a->ctx, a->points, a->num_samples, &a->stats.noise));
        smooth = a->stats.noise > 0;
    }
    a->stats.smoothed = smooth;
    return smooth ? brio_smooth_samples(a->ctx, a->points, a->num_samples) : BRIO_OK;
}

static brio_status take_samples(axis *a, const double *points, size_t n) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL;
    BRIO_REQUIRE(a->ctx, n > 0, BRIO_ERR_NO_ANSWER, "no points, no axis");
    BRIO_TRY(brio_refuse_points(a->ctx, points, n));
    a->num_samples = n;
    a->exponent = brio_exponent(brio_greatest(points, 3 * n));
    BRIO_TRY(BRIO_ALLOC(a->ctx, a->points, 3 * n));
    BRIO_TRY(brio_canonical_points(a->ctx, points, n, &order));
    brio_copy_points(points, order, n, a->points);
    BRIO_TRY(brio_scale(a->ctx, a->points, 3 * n, -a->exponent, a->points));
    BRIO_TRY(reduce_noise(a));
done:
    brio_release(a->ctx, order);
    return status;
}

/* Makes the surface of the points, which says what is inside. */
static brio_status make_solid(axis *a, const double *points, size_t n) {
    brio_surface_options o = {.size = sizeof o};
    o.seed = a->o.seed;
    o.noise = a->o.noise;
    o.holes = BRIO_HOLES_CLOSED;
    double start = brio_seconds();
    BRIO_FORWARD(brio_surface(a->ctx, points, n, &o, &a->solid, NULL));
    a->stats.surface_seconds = brio_seconds() - start;
    return BRIO_OK;
}

/* --- umbrellas --- */

/* Returns whether the Voronoi vertex of a tetrahedron is above the plane of a sample. */
static bool is_above(const axis *a, size_t tet, uint32_t sample) {
    double to[3];
    brio_towards_centre(&a->v, tet, sample, to);
    return brio_dot(to, a->v.plane + 4 * (size_t)sample) > 0;
}

/* Makes the rib of a sample at a facet handle. */
static rib make_rib(const axis *a, uint32_t handle, uint32_t sample) {
    rib r;
    double u[3], v[3], w[3];
    int count = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t q = a->v.t.tet[brio_tet_of(handle)].vertex[BRIO_FACET[brio_slot_of(handle)][k]];
        if (q != sample) r.end[count++] = q;
    }
    assert(count == 2);
    const double *p = a->points + 3 * (size_t)sample;
    const double *q = a->points + 3 * (size_t)r.end[0], *s = a->points + 3 * (size_t)r.end[1];
    for (int k = 0; k < 3; k++) u[k] = q[k] - p[k], v[k] = s[k] - p[k], w[k] = s[k] - q[k];
    brio_cross(u, v, r.normal);
    double twice = brio_length(r.normal);
    for (int k = 0; k < 3; k++) r.normal[k] = twice > 0 ? r.normal[k] / twice : 0;
    r.square = brio_dot(u, u) * brio_dot(v, v) * brio_dot(w, w) / (4 * twice * twice);
    return r;
}

/* Calls for each facet and each of its samples whose umbrella has it: counts it, or with `at` puts it there. */
static brio_status visit_ribs(axis *a, uint64_t *count, uint64_t *at) {
    for (uint32_t h = 0; h < 4 * a->v.num_finite; h++) {
        uint32_t tet = brio_tet_of(h), mate = brio_tet_of(*brio_mate(&a->v.t, h));
        if (h % BRIO_LOOK_EVERY == 0) BRIO_FORWARD(brio_look(a->ctx, BRIO_LOOK_EVERY));
        if (mate < tet) continue; /* infinite tetrahedra come last */
        for (int k = 0; k < 3; k++) {
            uint32_t p = a->v.t.tet[tet].vertex[BRIO_FACET[brio_slot_of(h)][k]];
            if (is_above(a, tet, p) == is_above(a, mate, p)) continue;
            if (at)
                a->rib[at[p]++] = make_rib(a, h, p);
            else
                count[p + 1]++;
        }
    }
    return BRIO_OK;
}

static brio_status find_umbrellas(axis *a) {
    brio_status status = BRIO_OK;
    uint64_t *at = NULL;
    size_t n = a->num_samples;
    BRIO_TRY(BRIO_ALLOC_ZERO(a->ctx, a->first, n + 1));
    BRIO_TRY(visit_ribs(a, a->first, NULL));
    for (size_t p = 0; p < n; p++) a->first[p + 1] += a->first[p];
    BRIO_TRY(BRIO_ALLOC(a->ctx, a->rib, a->first[n]));
    BRIO_TRY(BRIO_ALLOC(a->ctx, at, n));
    memcpy(at, a->first, n * sizeof *at);
    BRIO_TRY(visit_ribs(a, NULL, at));
done:
    brio_release(a->ctx, at);
    return status;
}

/* --- conditions --- */

typedef struct {
    bool umbrella, angle, ratio;
} verdict;

/* Judges the edge from p to q by the umbrella of p. */
static verdict judge(const axis *a, uint32_t p, uint32_t q) {
    verdict v = {false, true, true};
    double e[3];
    for (size_t k = 0; k < 3; k++) e[k] = a->points[3 * (size_t)q + k] - a->points[3 * (size_t)p + k];
    double square = brio_dot(e, e);
    for (uint64_t i = a->first[p]; i < a->first[p + 1]; i++) {
        const rib *r = &a->rib[i];
        double along = brio_dot(e, r->normal);
        v.umbrella = v.umbrella || r->end[0] == q || r->end[1] == q;
        v.angle = v.angle && along * along > a->square_sine * square; /* less than pi / 2 - theta from the normal */
        v.ratio = v.ratio && square > a->square_rho * r->square;
    }
    if (a->first[p] == a->first[p + 1]) v.angle = v.ratio = false;
    return v;
}

static bool is_chosen(axis *a, uint32_t p, uint32_t q) {
    verdict at_p = judge(a, p, q), at_q = judge(a, q, p);
    bool angle = (at_p.angle && !at_p.umbrella) || (at_q.angle && !at_q.umbrella);
    bool ratio = (at_p.ratio && !at_p.umbrella) || (at_q.ratio && !at_q.umbrella);
    a->stats.edges += !at_p.umbrella && !at_q.umbrella;
    a->stats.by_angle += angle;
    a->stats.by_ratio += ratio;
    return angle || ratio;
}

/* Lists the tetrahedra round an edge, unless one of them has no centre. */
static brio_status list_facet(axis *a, uint32_t tet, int i, int j) {
    size_t start = a->num_facet;
    uint32_t at = tet;
    brio_ring ring = brio_ring_second(&a->v.t, tet, i, j);
    for (bool more = true; more; at = ring.tet) {
        if (at >= a->v.num_finite || isnan(a->v.centre[4 * (size_t)at])) {
            a->num_facet = start;
            a->stats.unbounded++;
            return BRIO_OK;
        }
        BRIO_FORWARD(BRIO_RESERVE(a->ctx, a->facet, a->facet_capacity, a->num_facet + 1));
        a->facet[a->num_facet++] = at;
        more = a->num_facet - start == 1 || brio_ring_next(&ring);
    }
    BRIO_FORWARD(BRIO_RESERVE(a->ctx, a->end, a->end_capacity, a->num_facets + 1));
    a->end[a->num_facets++] = a->num_facet;
    return BRIO_OK;
}

static brio_status choose_facets(axis *a) {
    for (uint32_t tet = 0; tet < a->v.num_finite; tet++) {
        if (tet % BRIO_LOOK_EVERY == 0)
            BRIO_FORWARD(brio_progress(a->ctx, "facets", (double)tet / (double)a->v.num_finite));
        const uint32_t *v = a->v.t.tet[tet].vertex;
        for (int i = 0; i < 4; i++)
            for (int j = i + 1; j < 4; j++)
                if (brio_ring_size(&a->v.t, tet, i, j) && is_chosen(a, v[i], v[j]))
                    BRIO_FORWARD(list_facet(a, tet, i, j));
    }
    return BRIO_OK;
}

/* --- sides --- */

/* Numbers the Voronoi vertices of the facets, in the order of their tetrahedra. Returns how many there are. */
static brio_status number_vertices(axis *a, size_t *count) {
    *count = 0;
    BRIO_FORWARD(BRIO_ALLOC(a->ctx, a->number, a->v.num_finite));
    memset(a->number, 0xff, a->v.num_finite * sizeof *a->number);
    for (size_t i = 0; i < a->num_facet; i++) a->number[a->facet[i]] = 0;
    for (size_t t = 0; t < a->v.num_finite; t++)
        if (a->number[t] != NO_VERTEX) a->number[t] = (uint32_t)(*count)++;
    return BRIO_OK;
}

static brio_status label_vertices(const axis *a, size_t count, uint8_t **label) {
    brio_status status = BRIO_OK;
    brio_poles vertices = {.count = count};
    const brio_mesh *solid = a->o.solid ? a->o.solid : a->solid;
    BRIO_TRY(BRIO_ALLOC(a->ctx, vertices.centre, 3 * count));
    BRIO_TRY(BRIO_ALLOC(a->ctx, *label, count));
    for (size_t t = 0; t < a->v.num_finite; t++)
        if (a->number[t] != NO_VERTEX)
            memcpy(vertices.centre + 3 * (size_t)a->number[t], a->v.centre + 4 * t, 3 * sizeof(double));
    BRIO_TRY(brio_label_by_solid(a->ctx, &vertices, a->exponent, solid, *label));
done:
    brio_release(a->ctx, vertices.centre);
    return status;
}

/* Leaves out the facets that are not on a side that is wanted, or on both. */
static void drop_facets(axis *a, const uint8_t *label) {
    size_t kept = 0, to = 0, from = 0;
    for (size_t f = 0; f < a->num_facets; f++) {
        size_t end = a->end[f];
        uint8_t first = label[a->number[a->facet[from]]];
        bool whole = true,
             wanted = a->o.sides == BRIO_SIDES_BOTH || (first == BRIO_LABEL_INNER) == (a->o.sides == BRIO_SIDES_INNER);
        for (size_t i = from; i < end; i++) whole = whole && label[a->number[a->facet[i]]] == first;
        a->stats.across += !whole;
        for (; whole && wanted && from < end; from++) a->facet[to++] = a->facet[from];
        if (whole && wanted) a->end[kept++] = to;
        from = end;
    }
    a->num_facets = kept;
    a->num_facet = to;
}

/* --- the mesh --- */

/* Places a vertex, at a centre as accurate as those of poles; what was chosen went by rougher ones. */
static void place_vertex(const axis *a, size_t tet, double *place, double *radius) {
    const uint32_t(*corners)[4] = (const uint32_t(*)[4]) & a->v.t.tet[tet].vertex;
    brio_centres(&(brio_centre_batch){a->points, NULL, corners, 1}, place, NULL);
    *radius = ldexp(sqrt(brio_square_distance(place, a->points + 3 * (size_t)corners[0][0])), a->exponent);
}

static brio_status make_vertices(const axis *a, const uint32_t *old, const uint8_t *label, size_t count,
                                 brio_mesh *mesh) {
    void *radii, *sides;
    BRIO_FORWARD(brio_mesh_set_vertices(mesh, NULL, count));
    BRIO_FORWARD(brio_mesh_add_property(mesh, "radius", BRIO_SCALAR_FLOAT64, &radii));
    BRIO_FORWARD(brio_mesh_add_property(mesh, "side", BRIO_SCALAR_INT8, &sides));
    for (size_t t = 0; t < a->v.num_finite; t++) {
        uint32_t v = a->number[t];
        if (v == NO_VERTEX) continue;
        place_vertex(a, t, mesh->vertices + 3 * (size_t)v, (double *)radii + v);
        ((int8_t *)sides)[v] = label[old[t]] == BRIO_LABEL_INNER ? -1 : 1;
    }
    return brio_scale_vertices(a->ctx, mesh->vertices, count, a->exponent);
}

static brio_status make_faces(axis *a, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    uint64_t *offsets = NULL;
    BRIO_TRY(BRIO_ALLOC(a->ctx, offsets, a->num_facets + 1));
    offsets[0] = 0;
    memcpy(offsets + 1, a->end, a->num_facets * sizeof *offsets);
    for (size_t i = 0; i < a->num_facet; i++) a->facet[i] = a->number[a->facet[i]];
    BRIO_TRY(brio_mesh_set_faces(mesh, offsets, a->facet, a->num_facets));
done:
    brio_release(a->ctx, offsets);
    return status;
}

static brio_status make_axis(axis *a, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    uint8_t *label = NULL;
    uint32_t *all = NULL;
    size_t count;
    double start = brio_seconds();
    BRIO_TRY(number_vertices(a, &count));
    BRIO_TRY(label_vertices(a, count, &label));
    drop_facets(a, label);
    BRIO_REQUIRE(a->ctx, a->num_facets > 0, BRIO_ERR_NO_ANSWER,
                 "no Voronoi facet on the side that was asked for is part of the axis");
    all = a->number;
    BRIO_TRY(number_vertices(a, &count));
    BRIO_TRY(make_vertices(a, all, label, count, mesh));
    BRIO_TRY(make_faces(a, mesh));
    a->stats.facets = a->num_facets;
    a->stats.label_seconds = brio_seconds() - start;
done:
    brio_release(a->ctx, label);
    brio_release(a->ctx, all);
    return status;
}

/* --- all of it --- */

static brio_status check_options(axis *a) {
    brio_voronoi_axis_options *o = &a->o;
    BRIO_EXPECT(a->ctx, (unsigned)o->sides < BRIO_SIDES_END, BRIO_ERR_ARGUMENT, "no such side: %d", (int)o->sides);
    BRIO_EXPECT(a->ctx, (unsigned)o->noise < BRIO_NOISE_END, BRIO_ERR_ARGUMENT, "no such way with noise: %d",
                (int)o->noise);
    BRIO_EXPECT(a->ctx, o->theta >= 0 && o->theta < 1.5707963267948966, BRIO_ERR_ARGUMENT,
                "theta %g, expected 0 or an angle below pi / 2", o->theta);
    BRIO_EXPECT(a->ctx, o->rho >= 0 && isfinite(o->rho), BRIO_ERR_ARGUMENT,
                "rho %g, expected 0 or a positive finite number", o->rho);
    if (!o->seed) o->seed = BRIO_SEED;
    double sine = sin(o->theta > 0 ? o->theta : THETA), rho = o->rho > 0 ? o->rho : RHO;
    a->square_sine = sine * sine;
    a->square_rho = rho * rho;
    return BRIO_OK;
}

static brio_status triangulate(axis *a) {
    brio_delaunay_options o = {.size = sizeof o, .seed = a->o.seed};
    double start = brio_seconds();
    BRIO_FORWARD(brio_delaunay(a->ctx, a->points, NULL, a->num_samples, &o, &a->t));
    a->stats.samples = brio_triangulation_stats(a->t)->vertices;
    BRIO_EXPECT(a->ctx, brio_triangulation_stats(a->t)->dimension == 3, BRIO_ERR_NO_ANSWER,
                "%zu distinct points span no solid", a->stats.samples);
    BRIO_FORWARD(brio_pole_vectors_find(a->ctx, a->t, a->points, a->num_samples, THETA, &a->v));
    a->stats.delaunay_seconds = brio_seconds() - start;
    return BRIO_OK;
}

static brio_status find_axis(axis *a, const double *points, size_t num_points, brio_mesh *mesh) {
    const brio_bar bar = brio_progress_bar(a->ctx);
    brio_status status = BRIO_OK;
    BRIO_TRY(check_options(a));
    BRIO_TRY(take_samples(a, points, num_points));
    brio_progress_part(a->ctx, bar, 0, SURFACE_SHARE);
    if (!a->o.solid) BRIO_TRY(make_solid(a, points, num_points));
    brio_progress_part(a->ctx, bar, SURFACE_SHARE, 0.9);
    BRIO_TRY(triangulate(a));
    double start = brio_seconds();
    BRIO_TRY(find_umbrellas(a));
    BRIO_TRY(choose_facets(a));
    a->stats.choose_seconds = brio_seconds() - start;
    brio_progress_part(a->ctx, bar, 0.9, 1);
    BRIO_TRY(make_axis(a, mesh));
done:
    brio_progress_part(a->ctx, bar, 0, 1);
    return status;
}

static void free_axis(axis *a) {
    brio_pole_vectors_free(a->ctx, &a->v);
    brio_triangulation_free(a->t);
    brio_mesh_free(a->solid);
    brio_release(a->ctx, a->points);
    brio_release(a->ctx, a->first);
    brio_release(a->ctx, a->rib);
    brio_release(a->ctx, a->facet);
    brio_release(a->ctx, a->end);
    brio_release(a->ctx, a->number);
}

brio_status brio_voronoi_axis(brio_context *ctx, const double *points, size_t num_points,
                              const brio_voronoi_axis_options *options, brio_mesh **out,
                              brio_voronoi_axis_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    axis a = {.ctx = ctx};
    brio_mesh *mesh = NULL;
    *out = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_voronoi_axis_stats, stats));
    BRIO_TRY(BRIO_TAKE(ctx, brio_voronoi_axis_options, options, &a.o));
    BRIO_TRY(brio_mesh_new(ctx, &mesh));
    BRIO_TRY(find_axis(&a, points, num_points, mesh));
    *out = mesh;
    mesh = NULL;
done:
    BRIO_GIVE(brio_voronoi_axis_stats, stats, &a.stats);
    brio_mesh_free(mesh);
    free_axis(&a);
    return status;
}
