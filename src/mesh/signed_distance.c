/* Distances of points from a surface, with the side on which they are.
 *
 * The nearest point of the surface is found in a hierarchy of boxes. Of a closed surface the winding number tells the
 * side, exactly. Of any other, the triangles at the nearest point do: if they all have the point on one side, which is
 * exact, it is that one; otherwise it is the side of the mean of their normals, weighted by their angles at that point.
 *
 * Based on: Baerentzen, Aanaes. Signed distance computation using the angle weighted pseudonormal. IEEE TVCG 2005.
 * Differs from the paper: the triangles at a point are found by their distance from it, not by edges and vertices, so
 * that faces that do not share vertices, and edges of more than two faces, are met alike. */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/team.h"
#include "base/vector.h"
#include "mesh/edge_rings.h"
#include "mesh/solid.h"
#include "predicates/predicates.h"
#include <stdlib.h>
#include <string.h>

/* HUGE_EXPONENT: sizes beyond need another unit, as in distance.c. BATCH: points between two reports. Chosen. */
enum { HUGE_EXPONENT = 100, BATCH = 1 << 15, POINTS_A_CHUNK = 64, MOST_LEVELS = 64 };

/* Two triangles have one nearest point if their squared distances differ by less than this share, and the points by
 * less than the second one, of the distance. A corner is where that point is within the third share of a triangle's
 * size. Chosen: far over rounding. */
static const double SAME_SQUARE = 1e-12, SAME_POINT = 1e-7, SAME_CORNER = 1e-9;

typedef struct {
    brio_solid solid; /* only its tree if the surface is not closed */
    bool closed;
    const double *points;
    double *distance;
    size_t first;
} measurement;

/* What the triangles at the nearest point say. */
typedef struct {
    const brio_triangle_tree *tree;
    const double *p, *closest;
    double square;
    double normal[3]; /* sum of unit normals, by angles */
    bool above, below;
} sides;

static double angle_between(const double *a, const double *b) {
    double n[3];
    brio_cross(a, b, n);
    return atan2(brio_length(n), brio_dot(a, b));
}

/* Returns the angle of a triangle at a point of it: that at a corner, half a turn on a side, a whole one inside. */
static double angle_at(const double *const t[3], const double *at) {
    double w[3][3], length[3], most = 0;
    static const double PI = 3.14159265358979323846;
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) w[i][k] = t[i][k] - at[k];
        length[i] = brio_length(w[i]);
        most = fmax(most, length[i]);
    }
    for (int i = 0; i < 3; i++)
        if (length[i] <= SAME_CORNER * most) return angle_between(w[(i + 1) % 3], w[(i + 2) % 3]);
    for (int i = 0; i < 3; i++)
        if (angle_between(w[i], w[(i + 1) % 3]) > PI - SAME_POINT) return PI;
    return 2 * PI;
}

/* Adds the side on which a triangle has the point, if its nearest point is the one. */
static void add_side(sides *s, size_t triangle) {
    const double *t[3];
    double closest[3], u[3], v[3], n[3], length;
    for (int k = 0; k < 3; k++) t[k] = s->tree->vertices + 3 * (size_t)s->tree->triangles[triangle][k];
    brio_closest_on_triangle(s->tree, triangle, s->p, closest);
    if (brio_square_distance(s->p, closest) > s->square * (1 + SAME_SQUARE)) return;
    if (brio_square_distance(closest, s->closest) > s->square * SAME_POINT * SAME_POINT) return;
    int side = brio_orient3d(t[0], t[1], t[2], s->p);
    s->above |= side > 0;
    s->below |= side < 0;
    for (int k = 0; k < 3; k++) u[k] = t[1][k] - t[0][k], v[k] = t[2][k] - t[0][k];
    brio_cross(u, v, n);
    length = brio_length(n);
    for (int k = 0; k < 3 && length > 0; k++) s->normal[k] += n[k] / length * angle_at(t, s->closest);
}

static bool box_is_within(const brio_box *box, const double *p, double square) {
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        double d = fmax(fmax(box->low[k] - p[k], p[k] - box->high[k]), 0);
        sum += d * d;
    }
    return sum <= square;
}

/* Returns the side of an open surface on which a point is: 1 in front of its faces, -1 behind them. */
static int side_of(const brio_triangle_tree *tree, const double *p, const double *closest, double square) {
    sides s = {.tree = tree, .p = p, .closest = closest, .square = square};
    struct {
        size_t node, low, high;
    } stack[MOST_LEVELS], r;
    int depth = 0;
    stack[depth].node = stack[depth].low = 0;
    stack[depth++].high = tree->num_triangles;
    while (depth > 0) {
        r = stack[--depth];
        if (!box_is_within(&tree->boxes[r.node], p, square * (1 + SAME_SQUARE))) continue;
        if (r.high - r.low <= BRIO_LEAF_TRIANGLES) {
            for (size_t t = r.low; t < r.high; t++) add_side(&s, t);
            continue;
        }
        size_t middle = r.low + (r.high - r.low) / 2;
        stack[depth].node = 2 * r.node + 1, stack[depth].low = r.low, stack[depth++].high = middle;
        stack[depth].node = 2 * r.node + 2, stack[depth].low = middle, stack[depth++].high = r.high;
    }
    if (s.above != s.below) return s.above ? 1 : -1;
    double way[3] = {p[0] - closest[0], p[1] - closest[1], p[2] - closest[2]};
    return brio_dot(way, s.normal) < 0 ? -1 : 1;
}

static void measure_points(void *user, size_t begin, size_t end, int thread) {
    const measurement *m = user;
    (void)thread;
    for (size_t i = m->first + begin; i < m->first + end; i++) {
        const double *p = m->points + 3 * i;
        double closest[3];
        size_t triangle;
        double square = brio_closest_point(&m->solid.tree, p, closest, &triangle);
        if (square > 0) {
            bool inside =
                m->closed ? brio_winding_number(&m->solid, p) != 0 : side_of(&m->solid.tree, p, closest, square) < 0;
            m->distance[i] = inside ? -sqrt(square) : sqrt(square);
        } else {
            m->distance[i] = 0;
        }
    }
}

/* Prepares the surface: as a solid if it is closed. */
static brio_status take_surface(brio_context *ctx, const brio_mesh *mesh, measurement *m) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_mesh_check_faces(ctx, mesh));
    BRIO_TRY(brio_refuse_vertices(ctx, mesh->vertices, mesh->num_vertices, "the surface"));
    BRIO_REQUIRE(ctx, mesh->num_faces, BRIO_ERR_ARGUMENT, "a surface without faces");
    status = brio_solid_new(ctx, mesh, &m->solid);
    m->closed = status == BRIO_OK;
    if (status != BRIO_ERR_NO_ANSWER) return status;
    brio_solid_free(ctx, &m->solid);
    BRIO_TRY(brio_triangle_tree_new(ctx, mesh, &m->solid.tree));
done:
    return status;
}

static brio_status measure(brio_context *ctx, measurement *m, size_t num_points) {
    for (; m->first < num_points; m->first += BATCH) {
        size_t count = num_points - m->first < BATCH ? num_points - m->first : BATCH;
        BRIO_FORWARD(brio_progress(ctx, "distance", (double)m->first / (double)num_points));
        BRIO_FORWARD(
            brio_for_chunks(ctx, brio_threads(ctx, count, POINTS_A_CHUNK), count, POINTS_A_CHUNK, measure_points, m));
    }
    return BRIO_OK;
}

/* Measures in a unit of 2^exponent. */
static brio_status measure_scaled(brio_context *ctx, const brio_mesh *mesh, const double *points, size_t num_points,
                                  int exponent, measurement *m) {
    brio_status status = BRIO_OK;
    brio_mesh scaled = *mesh;
    double *vertices = NULL, *places = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, vertices, 3 * mesh->num_vertices));
    BRIO_TRY(BRIO_ALLOC(ctx, places, 3 * num_points));
    brio_scale(ctx, mesh->vertices, 3 * mesh->num_vertices, -exponent, vertices);
    brio_scale(ctx, points, 3 * num_points, -exponent, places);
    scaled.vertices = vertices;
    m->points = places;
    BRIO_TRY(take_surface(ctx, &scaled, m));
    BRIO_TRY(measure(ctx, m, num_points));
    for (size_t i = 0; i < num_points; i++) {
        m->distance[i] = ldexp(m->distance[i], exponent);
        BRIO_REQUIRE(ctx, isfinite(m->distance[i]), BRIO_ERR_NO_ANSWER, "doubles cannot hold the distances");
    }
done:
    brio_release(ctx, vertices);
    brio_release(ctx, places);
    return status;
}

brio_status brio_mesh_signed_distances(brio_context *ctx, const brio_mesh *mesh, const double *points,
                                       size_t num_points, double *distance) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    measurement m = {.points = points, .distance = distance};
    BRIO_TRY(brio_refuse_vertices(ctx, points, num_points, "the points"));
    int exponent = brio_exponent(
        fmax(brio_greatest(mesh->vertices, 3 * mesh->num_vertices), brio_greatest(points, 3 * num_points)));
    if (abs(exponent) > HUGE_EXPONENT) {
        BRIO_TRY(measure_scaled(ctx, mesh, points, num_points, exponent, &m));
    } else {
        BRIO_TRY(take_surface(ctx, mesh, &m));
        BRIO_TRY(measure(ctx, &m, num_points));
    }
done:
    brio_solid_free(ctx, &m.solid);
    return status;
}
