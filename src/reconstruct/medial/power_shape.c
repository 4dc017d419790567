/* The power shape: the poles on one side of the surface, connected as their cells touch in the power diagram. The shape
 * approximates the medial axis of that side; together with the radii, its medial axis transform.
 *
 * The shape is the part of the regular triangulation whose vertices are all on that side, tetrahedra included. This is
 * the nerve of the cells on that side. The cells are convex, so the shape is homotopy equivalent to their union, the
 * solid that the power crust bounds. A hidden pole has no cell and is no vertex.
 *
 * Based on: Amenta, Choi, Kolluri. The power crust, unions of balls, and the medial axis transform. CGTA 2001.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, figure 3.7, step 6.
 * Differs from the paper: outer poles whose tetrahedron has a bounding point are no part of the outer shape. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/scale.h"
#include "base/versioned.h"
#include "reconstruct/medial/ball_cover.h"
#include "reconstruct/power_crust/power_crust.h"
#include "triangulation/ring.h"
#include <math.h>
#include <string.h>

enum { NO_VERTEX = UINT32_MAX };
static const double POLES_SHARE = 0.8;    /* of the progress bar */
static const double SIMPLIFY_SHARE = 0.5; /* of the bar of what follows */

typedef struct {
    brio_labeled_poles *poles;
    const brio_power_shape_options *options;
    uint32_t *number; /* #poles: the vertex of each, or NO_VERTEX */
    brio_mesh *mesh;
    uint32_t *edges, *corners, *tetrahedra;
    size_t num_edges, edge_capacity; /* indices, two for each edge */
    size_t num_corners, corner_capacity;
    size_t num_tetrahedra, tetrahedron_capacity; /* indices, four for each tetrahedron */
} builder;

/* --- simplification --- */

/* Returns whether the options ask for poles of this label. */
static bool wants(const brio_power_shape_options *o, uint8_t label) {
    return label == BRIO_LABEL_INNER ? o->sides != BRIO_SIDES_OUTER : o->sides != BRIO_SIDES_INNER;
}

static bool has_cell(const brio_labeled_poles *l, size_t p) {
    return l->diagram.representative[p] == p;
}

/* Simplifies the poles of one label. Removes the poles without a cell, because they add nothing to the union of the
 * other balls. */
static brio_status simplify_side(brio_labeled_poles *l, const brio_power_shape_options *o, uint8_t label,
                                 uint8_t *keep) {
    brio_status status = BRIO_OK;
    const brio_cover_rule rule = {o->scale, o->redundancy};
    uint32_t *balls = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(l->ctx, balls, l->poles.count));
    for (size_t p = 0; p < l->poles.count; p++) {
        if (l->label[p] != label || l->poles.bounding[p]) continue;
        if (has_cell(l, p))
            balls[count++] = (uint32_t)p;
        else
            keep[p] = 0;
    }
    brio_balls side = {l->poles.centre, l->poles.square, balls, count};
    if (o->scale_axis > 1) {
        BRIO_TRY(brio_scale_axis(l->ctx, &side, o->scale_axis, o->seed, keep));
        for (side.count = 0, count = 0; count < l->poles.count; count++)
            if (keep[count] && l->label[count] == label && !l->poles.bounding[count])
                balls[side.count++] = (uint32_t)count;
    }
    if (o->scale > 1 || o->redundancy > 0) BRIO_TRY(brio_cover_balls(l->ctx, &side, &rule, keep));
done:
    brio_release(l->ctx, balls);
    return status;
}

static brio_status simplify(brio_labeled_poles *l, const brio_power_shape_options *o, brio_power_shape_stats *stats) {
    static const uint8_t labels[2] = {BRIO_LABEL_INNER, BRIO_LABEL_OUTER};
    brio_status status = BRIO_OK;
    uint8_t *keep = NULL;
    double start = brio_seconds();
    if (!(o->scale > 1) && !(o->redundancy > 0) && !(o->scale_axis > 1)) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(l->ctx, keep, l->poles.count));
    memset(keep, 1, l->poles.count);
    for (int i = 0; i < 2; i++)
        if (wants(o, labels[i])) BRIO_TRY(simplify_side(l, o, labels[i], keep));
    for (size_t p = 0; p < l->poles.count; p++) stats->left_out += !keep[p];
    BRIO_TRY(brio_labeled_poles_keep(l, keep));
    stats->simplify_seconds = brio_seconds() - start;
done:
    brio_release(l->ctx, keep);
    return status;
}

/* --- the shape --- */

static brio_status make_vertices(builder *b) {
    brio_status status = BRIO_OK;
    const brio_labeled_poles *l = b->poles;
    size_t count = 0;
    void *radii, *sides;
    BRIO_TRY(BRIO_ALLOC(l->ctx, b->number, l->poles.count));
    for (size_t p = 0; p < l->poles.count; p++) {
        bool artificial = l->label[p] == BRIO_LABEL_OUTER && l->poles.bounding[p];
        b->number[p] = wants(b->options, l->label[p]) && has_cell(l, p) && !artificial ? (uint32_t)count++ : NO_VERTEX;
    }
    BRIO_TRY(brio_mesh_set_vertices(b->mesh, NULL, count));
    BRIO_TRY(brio_mesh_add_property(b->mesh, "radius", BRIO_SCALAR_FLOAT64, &radii));
    BRIO_TRY(brio_mesh_add_property(b->mesh, "side", BRIO_SCALAR_INT8, &sides));
    for (size_t p = 0; p < l->poles.count; p++) {
        size_t v = b->number[p];
        if (v == NO_VERTEX) continue;
        memcpy(b->mesh->vertices + 3 * v, l->poles.centre + 3 * p, 3 * sizeof(double));
        ((double *)radii)[v] = ldexp(sqrt(l->poles.square[p]), l->exponent);
        ((int8_t *)sides)[v] = l->label[p] == BRIO_LABEL_INNER ? -1 : 1;
    }
    BRIO_TRY(brio_scale_vertices(l->ctx, b->mesh->vertices, count, l->exponent));
done:
    return status;
}

/* Returns whether two poles are in the shape and on one side. */
static bool joined(const builder *b, uint32_t p, uint32_t q) {
    return p != BRIO_INFINITE && q != BRIO_INFINITE && b->number[p] != NO_VERTEX && b->number[q] != NO_VERTEX &&
           b->poles->label[p] == b->poles->label[q];
}

static brio_status add_edges(builder *b, uint32_t tet) {
    brio_status status = BRIO_OK;
    const brio_tetrahedra *power = &b->poles->diagram.power;
    const uint32_t *v = power->tet[tet].vertex;
    for (int i = 0; i < 4; i++)
        for (int j = i + 1; j < 4; j++) {
            if (!joined(b, v[i], v[j]) || !brio_ring_size(power, tet, i, j)) continue;
            BRIO_TRY(BRIO_RESERVE(b->poles->ctx, b->edges, b->edge_capacity, b->num_edges + 2));
            uint32_t p = b->number[v[i]], q = b->number[v[j]];
            b->edges[b->num_edges++] = p < q ? p : q;
            b->edges[b->num_edges++] = p < q ? q : p;
        }
done:
    return status;
}

/* Adds the triangles between this tetrahedron and tetrahedra of higher number, so that each triangle is added once. */
static brio_status add_triangles(builder *b, uint32_t tet) {
    brio_status status = BRIO_OK;
    const brio_tetrahedron *t = &b->poles->diagram.power.tet[tet];
    for (int i = 0; i < 4; i++) {
        const uint8_t *slot = BRIO_FACET[i];
        uint32_t p = t->vertex[slot[0]], q = t->vertex[slot[1]], r = t->vertex[slot[2]];
        if (brio_tet_of(t->mate[i]) < tet || !joined(b, p, q) || !joined(b, q, r)) continue;
        BRIO_TRY(BRIO_RESERVE(b->poles->ctx, b->corners, b->corner_capacity, b->num_corners + 3));
        b->corners[b->num_corners++] = b->number[p];
        b->corners[b->num_corners++] = b->number[q];
        b->corners[b->num_corners++] = b->number[r];
    }
done:
    return status;
}

/* Adds the tetrahedron if its poles are in the shape. Tetrahedra of the regular triangulation are positive, so those of
 * the shape are, too. */
static brio_status add_tetrahedron(builder *b, uint32_t tet) {
    brio_status status = BRIO_OK;
    const uint32_t *v = b->poles->diagram.power.tet[tet].vertex;
    for (int i = 1; i < 4; i++)
        if (!joined(b, v[0], v[i])) return BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(b->poles->ctx, b->tetrahedra, b->tetrahedron_capacity, b->num_tetrahedra + 4));
    for (int i = 0; i < 4; i++) b->tetrahedra[b->num_tetrahedra++] = b->number[v[i]];
done:
    return status;
}

static brio_status set_triangles(builder *b) {
    brio_status status = BRIO_OK;
    uint64_t *offsets = NULL;
    size_t n = b->num_corners / 3;
    if (n == 0) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(b->poles->ctx, offsets, n + 1));
    for (size_t f = 0; f <= n; f++) offsets[f] = 3 * f;
    BRIO_TRY(brio_mesh_set_faces(b->mesh, offsets, b->corners, n));
done:
    brio_release(b->poles->ctx, offsets);
    return status;
}

static brio_status make_shape(brio_labeled_poles *l, const brio_power_shape_options *o, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    builder b = {.poles = l, .options = o, .mesh = mesh};
    BRIO_TRY(make_vertices(&b));
    BRIO_REQUIRE(l->ctx, mesh->num_vertices > 0, BRIO_ERR_NO_ANSWER,
                 "no pole with a cell is on the side that was asked for");
    for (size_t tet = 0; tet < l->diagram.num_finite; tet++) {
        if (tet % 65536 == 0) BRIO_TRY(brio_progress(l->ctx, "shape", (double)tet / (double)l->diagram.num_finite));
        BRIO_TRY(add_edges(&b, (uint32_t)tet));
        BRIO_TRY(add_triangles(&b, (uint32_t)tet));
        BRIO_TRY(add_tetrahedron(&b, (uint32_t)tet));
    }
    if (b.num_edges) BRIO_TRY(brio_mesh_set_edges(mesh, b.edges, b.num_edges / 2));
    BRIO_TRY(set_triangles(&b));
    if (b.num_tetrahedra) BRIO_TRY(brio_mesh_set_tetrahedra(mesh, b.tetrahedra, 4, b.num_tetrahedra / 4));
done:
    brio_release(l->ctx, b.number);
    brio_release(l->ctx, b.edges);
    brio_release(l->ctx, b.corners);
    brio_release(l->ctx, b.tetrahedra);
    return status;
}

/* --- the whole --- */

static brio_status check_options(brio_context *ctx, const brio_power_shape_options *o) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, (unsigned)o->sides < BRIO_SIDES_END, BRIO_ERR_ARGUMENT, "no such side: %d", (int)o->sides);
    BRIO_REQUIRE(ctx, o->scale >= 1 && isfinite(o->scale), BRIO_ERR_ARGUMENT,
                 "scale %g, expected a finite number, 1 or more", o->scale);
    BRIO_REQUIRE(ctx, o->scale_axis >= 1 && isfinite(o->scale_axis), BRIO_ERR_ARGUMENT,
                 "scale of the scale axis %g, expected a finite number, 1 or more", o->scale_axis);
    BRIO_REQUIRE(ctx, o->redundancy >= 0 && isfinite(o->redundancy), BRIO_ERR_ARGUMENT,
                 "redundancy %g, expected a finite number, 0 or more", o->redundancy);
done:
    return status;
}

/* Counts the poles by label, before any is left out. */
static void count_poles(const brio_labeled_poles *l, brio_power_shape_stats *s) {
    s->poles = l->stats;
    s->poles.inner = s->poles.outer = 0;
    for (size_t p = 0; p < l->poles.count; p++) {
        s->poles.inner += l->label[p] == BRIO_LABEL_INNER;
        s->poles.outer += l->label[p] == BRIO_LABEL_OUTER;
        s->unlabeled += l->label[p] == BRIO_LABEL_NONE;
    }
}

static brio_status find_balls(brio_labeled_poles *l, const double *points, size_t num_points,
                              const brio_power_shape_options *o) {
    brio_status status = BRIO_OK;
    brio_pole_request request;
    BRIO_TRY(check_options(l->ctx, o));
    BRIO_TRY(brio_pole_request_of(l->ctx, &o->poles, o->noise, o->seed, &request));
    BRIO_TRY(brio_labeled_poles_find(l->ctx, points, num_points, &request, l));
done:
    return status;
}

static brio_status make_both(brio_labeled_poles *l, const brio_power_shape_options *o, brio_mesh *shape,
                             brio_mesh *crust, brio_power_shape_stats *s) {
    brio_status status = BRIO_OK;
    const brio_surface_options surface = {.polygons = 1};
    brio_surface_stats unused;
    const brio_bar bar = brio_progress_bar(l->ctx);
    const double end = crust ? 0.75 : 1;
    count_poles(l, s);
    brio_progress_part(l->ctx, bar, 0, SIMPLIFY_SHARE);
    BRIO_TRY(simplify(l, o, s));
    brio_progress_part(l->ctx, bar, SIMPLIFY_SHARE, end);
    double start = brio_seconds();
    BRIO_TRY(make_shape(l, o, shape));
    s->shape_seconds = brio_seconds() - start;
    s->edges = shape->num_edges;
    s->triangles = shape->num_faces;
    s->tetrahedra = shape->num_tetrahedra;
    if (!crust) goto done;
    brio_labeled_poles_close_hull(l);
    brio_progress_part(l->ctx, bar, end, 1);
    BRIO_TRY(brio_make_crust(l, &surface, crust, NULL, &unused));
done:
    brio_progress_part(l->ctx, bar, 0, 1);
    return status;
}

brio_status brio_power_shape(brio_context *ctx, const double *points, size_t num_points,
                             const brio_power_shape_options *options, brio_mesh **shape, brio_mesh **crust,
                             brio_power_shape_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_power_shape_options o = {0};
    brio_power_shape_stats s = {0};
    brio_labeled_poles l = {.ctx = ctx};
    brio_mesh *shape_mesh = NULL, *crust_mesh = NULL;
    const brio_bar bar = brio_progress_bar(ctx);
    *shape = NULL;
    if (crust) *crust = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_power_shape_stats, stats));
    BRIO_TRY(BRIO_TAKE(ctx, brio_power_shape_options, options, &o));
    if (!o.seed) o.seed = BRIO_SEED;
    if (o.scale == 0) o.scale = 1;
    if (o.scale_axis == 0) o.scale_axis = 1;
    BRIO_TRY(brio_mesh_new(ctx, &shape_mesh));
    if (crust) BRIO_TRY(brio_mesh_new(ctx, &crust_mesh));
    brio_progress_part(ctx, bar, 0, POLES_SHARE);
    BRIO_TRY(find_balls(&l, points, num_points, &o));
    brio_progress_part(ctx, bar, POLES_SHARE, 1);
    BRIO_TRY(make_both(&l, &o, shape_mesh, crust_mesh, &s));
    *shape = shape_mesh;
    if (crust) *crust = crust_mesh;
    shape_mesh = crust_mesh = NULL;
done:
    s.samples = l.found.samples;
    s.noise = l.found.noise;
    s.smoothed = l.found.smoothed;
    s.noise_seconds = l.found.noise_seconds;
    s.delaunay_seconds = l.found.delaunay_seconds;
    s.poles_seconds = l.found.poles_seconds;
    BRIO_GIVE(brio_power_shape_stats, stats, &s);
    brio_progress_part(ctx, bar, 0, 1);
    brio_mesh_free(shape_mesh);
    brio_mesh_free(crust_mesh);
    brio_labeled_poles_free(&l);
    return status;
}
