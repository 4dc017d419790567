/* The power crust of points in a plane: closed curves through them, and the power shape of what they enclose.
 *
 *   points -> coordinates in their plane -> Delaunay triangles, infinite ones too -> greedy labels, outer and inner
 *   -> the edges between outer and inner triangles; the Voronoi edges between inner triangles
 *
 * In the plane all vertices of the Voronoi diagram are poles. The power diagram of their balls, which are the
 * circumcircles of the Delaunay triangles, is the Delaunay triangulation itself: two circumcircles have equal power on
 * the line through the edge that their triangles share, and a point has the least power in the circle of the triangle
 * that holds it. So the crust needs no second triangulation, consists of Delaunay edges, and is exact. Outer balls with
 * centres at infinity are the half-planes of the infinite triangles.
 *
 * The weight of two balls, -cos of the angle at which they meet, is -cos of the sum of the angles opposite to the edge
 * of their triangles. An infinite triangle has an angle of 0.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, figures 3.4 and 3.8.
 *           Amenta, Choi, Kolluri. The power crust. Solid Modeling 2001.
 * Differs from the paper: none of the bounding points, since the infinite triangles stand for them. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "curve/samples_mesh.h"
#include <math.h>

/* A triangle's priority when it was queued. */
typedef struct {
    double priority;
    uint32_t triangle;
} entry;

#define HEAP_ITEM entry
#define HEAP_ABOVE(a, b, user)                                                                                         \
    ((a).priority > (b).priority || ((a).priority == (b).priority && (a).triangle < (b).triangle))
#define HEAP_DOWN sink
#define HEAP_UP   rise
#include "base/heap.h"

enum { NO_SIDE = 2 };

/* A Voronoi edge up to this many times as long as its Delaunay edge is short, as in edges.c. */
static const double SHORT = 1.25;

/* The labels of triangles: 0 outer, 1 inner, NO_SIDE none yet. */
typedef struct {
    brio_context *ctx;
    const double (*at)[2];
    const brio_triangle *triangle;
    size_t count, num_finite, num_rows;
    uint8_t *side;
    double (*belief)[2]; /* of each triangle: that it is outer, and that it is inner */
    entry *heap;
    size_t queued, room;
    uint32_t (*poles)[2]; /* of each row, the triangles that are its two poles; UINT32_MAX for none */
    float *opposite;      /* of each row, how surely its poles lie on two sides */
    uint32_t *begin;      /* of each triangle, its samples in `sample`; then the end */
    uint32_t *sample;     /* the rows of which a triangle is a pole */
} crust;

static bool is_finite(const crust *c, uint32_t t) {
    return t < c->num_finite;
}

/* --- angles --- */

/* Writes the vector from row p to row q. */
static void vector(const crust *c, uint32_t p, uint32_t q, double out[2]) {
    out[0] = c->at[q][0] - c->at[p][0];
    out[1] = c->at[q][1] - c->at[p][1];
}

/* Writes cosine and sine of the angle of a triangle at its corner i; those of 0 for an infinite one. */
static void angle_at(const crust *c, uint32_t t, uint32_t i, double out[2]) {
    const uint32_t *v = c->triangle[t].vertex;
    double a[2], b[2];
    out[0] = 1, out[1] = 0;
    if (!is_finite(c, t)) return;
    vector(c, v[i], v[(i + 1) % 3], a);
    vector(c, v[i], v[(i + 2) % 3], b);
    double x = a[0] * b[0] + a[1] * b[1], y = fabs(a[0] * b[1] - a[1] * b[0]), length = hypot(x, y);
    if (length > 0) out[0] = x / length, out[1] = y / length;
}

/* Returns -cos of the angle at which the balls on both sides of edge i of triangle t meet: 1 if they are the same. */
static double depth(const crust *c, uint32_t t, uint32_t i) {
    uint32_t mate = c->triangle[t].mate[i];
    double a[2], b[2];
    angle_at(c, t, i, a);
    angle_at(c, mate / 4, mate % 4, b);
    return a[1] * b[1] - a[0] * b[0];
}

/* Writes the unit vector from the corner i of a triangle to the centre of its ball; returns the ball's radius. */
static double towards_centre(const crust *c, uint32_t t, uint32_t i, double out[2]) {
    const uint32_t *v = c->triangle[t].vertex;
    double a[2], b[2];
    vector(c, v[i], v[(i + 1) % 3], a);
    vector(c, v[i], v[(i + 2) % 3], b);
    double aa = a[0] * a[0] + a[1] * a[1], bb = b[0] * b[0] + b[1] * b[1];
    double x = b[1] * aa - a[1] * bb, y = a[0] * bb - b[0] * aa, length = hypot(x, y);
    out[0] = length > 0 ? x / length : 0;
    out[1] = length > 0 ? y / length : 0;
    return length / (2 * fabs(a[0] * b[1] - a[1] * b[0]));
}

/* Adds the outward unit normal of an infinite triangle's edge. */
static void add_normal(const crust *c, uint32_t t, double out[2]) {
    const uint32_t *v = c->triangle[t].vertex;
    uint32_t i = v[0] == BRIO_INFINITE ? 0 : v[1] == BRIO_INFINITE ? 1 : 2;
    double along[2];
    vector(c, v[(i + 1) % 3], v[(i + 2) % 3], along);
    double length = hypot(along[0], along[1]);
    if (length > 0) out[0] -= along[1] / length, out[1] += along[0] / length;
}

/* --- the poles of samples --- */

/* For each corner i of each finite triangle t. */
#define FOR_CORNERS(c, t, i)                                                                                           \
    for (uint32_t t = 0; t < (c)->num_finite; t++)                                                                     \
        for (uint32_t i = 0; i < 3; i++)

/* What is known of the poles of a row. */
typedef struct {
    double direction[2]; /* of the first pole */
    double radius[2];
    double cosine; /* between the two */
} pole_pair;

static void first_poles(crust *c, pole_pair *pair) {
    double direction[2];
    for (uint32_t t = (uint32_t)c->num_finite; t < c->count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t p = c->triangle[t].vertex[i];
            if (p == BRIO_INFINITE) continue;
            c->poles[p][0] = t;
            pair[p].radius[0] = INFINITY;
            add_normal(c, t, pair[p].direction);
        }
    FOR_CORNERS(c, t, i) {
        uint32_t p = c->triangle[t].vertex[i];
        double radius = towards_centre(c, t, i, direction);
        if (!(radius > pair[p].radius[0])) continue;
        c->poles[p][0] = t;
        pair[p].radius[0] = radius;
        pair[p].direction[0] = direction[0], pair[p].direction[1] = direction[1];
    }
}

static void second_poles(crust *c, pole_pair *pair) {
    double direction[2];
    FOR_CORNERS(c, t, i) {
        uint32_t p = c->triangle[t].vertex[i];
        double radius = towards_centre(c, t, i, direction), *first = pair[p].direction;
        double cosine = (direction[0] * first[0] + direction[1] * first[1]) / hypot(first[0], first[1]);
        if (!(cosine < 0 && radius > pair[p].radius[1])) continue;
        c->poles[p][1] = t;
        pair[p].radius[1] = radius;
        pair[p].cosine = cosine;
    }
}

/* Finds the two poles of each row, and lists the rows of each triangle. */
static brio_status find_poles(crust *c) {
    brio_status status = BRIO_OK;
    pole_pair *pair = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, pair, c->num_rows));
    BRIO_TRY(BRIO_ALLOC(c->ctx, c->poles, c->num_rows));
    BRIO_TRY(BRIO_ALLOC(c->ctx, c->opposite, c->num_rows));
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, c->begin, c->count + 2));
    BRIO_TRY(BRIO_ALLOC(c->ctx, c->sample, 2 * c->num_rows));
    for (size_t p = 0; p < c->num_rows; p++) c->poles[p][0] = c->poles[p][1] = UINT32_MAX;
    first_poles(c, pair);
    second_poles(c, pair);
    BRIO_TRY(brio_look(c->ctx, 8 * c->num_rows));
    for (size_t p = 0; p < c->num_rows; p++) {
        c->opposite[p] = (float)-pair[p].cosine;
        if (c->poles[p][1] != UINT32_MAX)
            for (int k = 0; k < 2; k++) c->begin[c->poles[p][k] + 2]++;
    }
    for (size_t t = 0; t < c->count; t++) c->begin[t + 2] += c->begin[t + 1];
    for (uint32_t p = 0; p < c->num_rows; p++)
        if (c->poles[p][1] != UINT32_MAX)
            for (int k = 0; k < 2; k++) c->sample[c->begin[c->poles[p][k] + 1]++] = p;
done:
    brio_release(c->ctx, pair);
    return status;
}

/* --- labels, figure 3.8 --- */

static double priority_of(const double belief[2]) {
    double more = fmax(belief[0], belief[1]);
    return belief[0] > 0 && belief[1] > 0 ? fabs(belief[0] - belief[1]) - 1 : more;
}

static brio_status push(crust *c, uint32_t t) {
    BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->heap, c->room, c->queued + 1));
    c->queued++;
    rise(c->heap, c->queued - 1, (entry){priority_of(c->belief[t]), t}, NULL);
    return BRIO_OK;
}

/* Raises the belief of a triangle in a side, if it has no label and the belief is lower. */
static brio_status offer(crust *c, uint32_t t, int side, double strength) {
    if (c->side[t] != NO_SIDE || !(strength > c->belief[t][side])) return BRIO_OK;
    c->belief[t][side] = strength;
    return push(c, t);
}

static brio_status settle(crust *c, uint32_t t, int side, double strength) {
    c->side[t] = (uint8_t)side;
    for (uint32_t i = 0; i < 3; i++)
        BRIO_FORWARD(offer(c, c->triangle[t].mate[i] / 4, side, strength * depth(c, t, i)));
    for (uint32_t k = c->begin[t]; k < c->begin[t + 1]; k++) {
        uint32_t p = c->sample[k], other = c->poles[p][c->poles[p][0] == t];
        BRIO_FORWARD(offer(c, other, !side, strength * c->opposite[p]));
    }
    return brio_look(c->ctx, 1);
}

/* Labels all triangles. Both infinite ones of a row on the hull stand for its first pole; the list has the last one.
 * All of these are outer. */
static brio_status label_all(crust *c) {
    for (size_t t = 0; t < c->count; t++) c->side[t] = is_finite(c, (uint32_t)t) ? NO_SIDE : 0;
    for (uint32_t t = (uint32_t)c->num_finite; t < c->count; t++) BRIO_FORWARD(settle(c, t, 0, 1));
    while (c->queued) {
        entry top = c->heap[0], last = c->heap[--c->queued];
        if (c->queued) sink(c->heap, 0, c->queued, last, NULL);
        const double *belief = c->belief[top.triangle];
        if (c->side[top.triangle] != NO_SIDE || priority_of(belief) != top.priority) continue;
        int side = belief[1] > belief[0];
        BRIO_FORWARD(settle(c, top.triangle, side, belief[side]));
    }
    for (size_t t = 0; t < c->count; t++)
        if (c->side[t] == NO_SIDE) c->side[t] = 0;
    return BRIO_OK;
}

/* --- the result --- */

/* Returns whether the edge opposite to corner i of triangle t is met here first. */
static bool is_first(const crust *c, uint32_t t, uint32_t i) {
    return 4 * t + i < c->triangle[t].mate[i];
}

static brio_status make_crust(const crust *c, const brio_flat_points *flat, const uint32_t *representative,
                              const double *points, brio_mesh **out) {
    brio_status status = BRIO_OK;
    uint32_t *vertex = NULL, *edges = NULL;
    size_t count = 0;
    BRIO_TRY(BRIO_ALLOC(c->ctx, vertex, c->num_rows));
    BRIO_TRY(BRIO_ALLOC(c->ctx, edges, 6 * c->num_finite));
    for (size_t p = 0; p < c->num_rows; p++) vertex[flat->order[p]] = representative[p] == p ? 0 : BRIO_INFINITE;
    BRIO_TRY(brio_samples_mesh(c->ctx, points, c->num_rows, vertex, out));
    for (uint32_t t = 0; t < c->num_finite; t++)
        for (uint32_t i = 0; i < 3; i++) {
            if (c->side[t] != 1 || c->side[c->triangle[t].mate[i] / 4] == 1) continue;
            edges[2 * count] = vertex[flat->order[c->triangle[t].vertex[(i + 1) % 3]]];
            edges[2 * count++ + 1] = vertex[flat->order[c->triangle[t].vertex[(i + 2) % 3]]];
        }
    BRIO_TRY(brio_mesh_set_edges(*out, edges, count));
done:
    brio_release(c->ctx, vertex);
    brio_release(c->ctx, edges);
    return status;
}

/* Writes the centre of a triangle's ball in space; returns the radius. */
static double centre_in_space(const crust *c, const brio_flat_points *flat, uint32_t t, double out[3]) {
    const brio_plane_frame *f = &flat->frame;
    double direction[2], radius = towards_centre(c, t, 0, direction), at[2];
    for (int k = 0; k < 2; k++) at[k] = c->at[c->triangle[t].vertex[0]][k] + radius * direction[k];
    for (int k = 0; k < 3; k++)
        out[k] = ldexp(f->origin[k] + at[0] * f->axis[0][k] + at[1] * f->axis[1][k], flat->exponent);
    return ldexp(radius, flat->exponent);
}

static brio_status fill_shape(const crust *c, const brio_flat_points *flat, const uint32_t *number, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    uint32_t *edges = NULL;
    size_t count = 0;
    void *radius;
    BRIO_TRY(BRIO_ALLOC(c->ctx, edges, 3 * mesh->num_vertices));
    BRIO_TRY(brio_mesh_add_property(mesh, "radius", BRIO_SCALAR_FLOAT64, &radius));
    for (uint32_t t = 0; t < c->num_finite; t++) {
        if (c->side[t] != 1) continue;
        ((double *)radius)[number[t]] = centre_in_space(c, flat, t, mesh->vertices + 3 * (size_t)number[t]);
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t other = c->triangle[t].mate[i] / 4;
            if (c->side[other] != 1 || !is_first(c, t, i)) continue;
            edges[2 * count] = number[t];
            edges[2 * count++ + 1] = number[other];
        }
    }
    BRIO_TRY(brio_mesh_set_edges(mesh, edges, count));
done:
    brio_release(c->ctx, edges);
    return status;
}

static brio_status make_shape(const crust *c, const brio_flat_points *flat, brio_mesh **out) {
    brio_status status = BRIO_OK;
    uint32_t *number = NULL, count = 0;
    BRIO_TRY(BRIO_ALLOC(c->ctx, number, c->num_finite));
    for (uint32_t t = 0; t < c->num_finite; t++) number[t] = c->side[t] == 1 ? count++ : 0;
    BRIO_TRY(brio_mesh_new(c->ctx, out));
    BRIO_TRY(brio_mesh_set_vertices(*out, NULL, count));
    BRIO_TRY(fill_shape(c, flat, number, *out));
done:
    brio_release(c->ctx, number);
    return status;
}

/* --- the interface --- */

static void crust_free(crust *c) {
    brio_release(c->ctx, c->side);
    brio_release(c->ctx, c->belief);
    brio_release(c->ctx, c->heap);
    brio_release(c->ctx, c->poles);
    brio_release(c->ctx, c->opposite);
    brio_release(c->ctx, c->begin);
    brio_release(c->ctx, c->sample);
}

static brio_status label_triangles(crust *c) {
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->side, c->count));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(c->ctx, c->belief, c->count));
    BRIO_FORWARD(find_poles(c));
    return label_all(c);
}

/* Returns whether the edge opposite to corner i of triangle t has a short Voronoi edge: half the sum of the cotangents
 * of the two angles opposite to it is the ratio of the two. */
static bool is_fat(const crust *c, uint32_t t, uint32_t i) {
    uint32_t mate = c->triangle[t].mate[i];
    double a[2], b[2];
    angle_at(c, t, i, a);
    angle_at(c, mate / 4, mate % 4, b);
    return a[0] * b[1] + b[0] * a[1] < 2 * SHORT * a[1] * b[1];
}

static void count_sides(const crust *c, brio_planar_crust_stats *s) {
    for (uint32_t t = 0; t < c->num_finite; t++) {
        s->inner += c->side[t] == 1;
        s->confused += c->belief[t][0] > 0 && c->belief[t][1] > 0;
        for (uint32_t i = 0; i < 3 && c->side[t] == 1; i++)
            s->fat += c->side[c->triangle[t].mate[i] / 4] != 1 && is_fat(c, t, i);
    }
    s->poles = c->num_finite;
    s->outer = s->poles - s->inner;
}

brio_status brio_planar_crust(brio_context *ctx, const double *points, size_t num_points, brio_mesh **out,
                              brio_mesh **shape, brio_planar_crust_stats *stats) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_planar_crust_stats mine = {.points = num_points};
    brio_flat_points flat = {.frame = {0}};
    brio_triangulation2 *t = NULL;
    crust c = {.ctx = ctx, .num_rows = num_points};
    *out = NULL;
    if (shape) *shape = NULL;
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_planar_crust_stats, stats));
    double start = brio_seconds();
    BRIO_TRY(brio_flat_points_take(ctx, points, num_points, &flat));
    BRIO_TRY(brio_delaunay2(ctx, *flat.at, NULL, num_points, NULL, &t));
    const brio_delaunay2_stats *s = brio_triangulation2_stats(t);
    BRIO_REQUIRE(ctx, s->dimension == 2, BRIO_ERR_NO_ANSWER, "the points are on a line: nothing is inside");
    mine.delaunay_seconds = brio_seconds() - start;
    c.at = (const double(*)[2])flat.at;
    c.triangle = brio_triangulation2_triangles(t);
    c.num_finite = s->triangles;
    c.count = s->triangles + s->hull_edges;
    BRIO_TRY(label_triangles(&c));
    count_sides(&c, &mine);
    BRIO_REQUIRE(ctx, mine.inner > 0, BRIO_BECAUSE(ctx, NO_INSIDE, BRIO_ERR_NO_ANSWER),
                 "no inside found: no pole is inner");
    BRIO_TRY(make_crust(&c, &flat, brio_triangulation2_representatives(t), points, out));
    if (shape) BRIO_TRY(make_shape(&c, &flat, shape));
    mine.samples = (*out)->num_vertices;
    mine.edges = (*out)->num_edges;
    mine.crust_seconds = brio_seconds() - start - mine.delaunay_seconds;
    BRIO_GIVE(brio_planar_crust_stats, stats, &mine);
done:
    if (status != BRIO_OK) {
        brio_mesh_free(*out);
        *out = NULL;
        if (shape) brio_mesh_free(*shape), *shape = NULL;
    }
    brio_triangulation2_free(t);
    crust_free(&c);
    brio_flat_points_free(ctx, &flat);
    return status;
}
