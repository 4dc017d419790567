/* Normals of the points that a surface was made from.
 *
 * A point that a vertex stands for takes the vertex's normal, and so do its duplicates. Every other point takes the
 * normal of the surface where the surface is nearest: the mean of the normals of a triangle's corners, weighted by how
 * near the corners are (barycentric coordinates). */
#include "base/finite.h"
#include "base/float_state.h"
#include "base/scale.h"
#include "base/vector.h"
#include "mesh/closest_point.h"
#include "mesh/vertex_normals.h"
#include "order/canonical_points.h"
#include "query/nearest_points.h"
#include "reconstruct/cocone/triangle.h"
#include <math.h>
#include <string.h>

/* EVERY: points between two looks at the progress. */
enum { NO_VERTEX = UINT32_MAX, EVERY = 1 << 14 };

typedef struct {
    brio_context *ctx;
    size_t num_points;
    uint32_t *vertex; /* #P: the vertex of each point, or NO_VERTEX */
    uint32_t *known;  /* the points that have one, ascending */
    size_t num_known;
    const double *of_vertex; /* #V by 3: normals */
    int exponent;            /* the points times 2^-exponent are at most 1, so that squares do not overflow */
    double *points;          /* #P by 3: scaled */
    double *normals;         /* #P by 3 */
} point_set;

static bool is_zero(const double *n) {
    return n[0] == 0 && n[1] == 0 && n[2] == 0;
}

static brio_status list_known(point_set *s, const brio_mesh *mesh, const uint32_t *samples) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->vertex, s->num_points));
    BRIO_TRY(BRIO_ALLOC(s->ctx, s->known, s->num_points));
    for (size_t p = 0; p < s->num_points; p++) s->vertex[p] = NO_VERTEX;
    for (uint32_t v = 0; v < mesh->num_vertices; v++) {
        uint32_t p = samples ? samples[v] : v;
        BRIO_REQUIRE(s->ctx, p < s->num_points, BRIO_ERR_ARGUMENT, "vertex %u: there is no point %d", v, (int)p);
        if (!is_zero(s->of_vertex + 3 * (size_t)v)) s->vertex[p] = v;
    }
    for (uint32_t p = 0; p < s->num_points; p++)
        if (s->vertex[p] != NO_VERTEX) s->known[s->num_known++] = p;
    BRIO_REQUIRE(s->ctx, s->num_known > 0, BRIO_ERR_NO_ANSWER, "no vertex of the surface has a normal");
done:
    return status;
}

static brio_status scale_to_one(point_set *s, const double *coordinates, size_t count, double **scaled) {
    brio_status status = BRIO_ALLOC(s->ctx, *scaled, 3 * count);
    return status == BRIO_OK ? brio_scale(s->ctx, coordinates, 3 * count, -s->exponent, *scaled) : status;
}

/* Gives duplicates of known points their vertices. */
static brio_status find_twins(const point_set *s) {
    brio_status status = BRIO_OK;
    brio_point_tree tree = {0};
    brio_near_point near[BRIO_NEAR_ROOM];
    double *position = NULL;
    BRIO_TRY(BRIO_ALLOC(s->ctx, position, 3 * s->num_known));
    for (size_t i = 0; i < s->num_known; i++)
        memcpy(position + 3 * i, s->points + 3 * (size_t)s->known[i], 3 * sizeof *position);
    BRIO_TRY(brio_point_tree_new(s->ctx, position, s->num_known, &tree));
    for (size_t p = 0; p < s->num_points; p++) {
        if (p % EVERY == 0) BRIO_TRY(brio_progress(s->ctx, "normals", 0.5 * (double)p / (double)s->num_points));
        if (s->vertex[p] != NO_VERTEX || !brio_nearest_points(&tree, s->points + 3 * p, 1, 0, near)) continue;
        s->vertex[p] = s->vertex[s->known[tree.index[near[0].place]]];
    }
done:
    brio_point_tree_free(s->ctx, &tree);
    brio_release(s->ctx, position);
    return status;
}

static void normalise(double *n) {
    double length = sqrt(brio_dot(n, n));
    for (int k = 0; k < 3 && length > 0; k++) n[k] /= length;
}

/* Writes the normal of the surface at its point nearest to p. */
static void normal_at(const point_set *s, const brio_triangle_tree *tree, const double *p, double *normal) {
    double at[3];
    size_t triangle;
    brio_closest_point(tree, p, at, &triangle);
    const uint32_t *v = tree->triangles[triangle];
    normal[0] = normal[1] = normal[2] = 0;
    for (int i = 0; i < 3; i++) {
        double weight = brio_triangle_area(at, tree->vertices + 3 * (size_t)v[(i + 1) % 3],
                                           tree->vertices + 3 * (size_t)v[(i + 2) % 3]);
        for (size_t k = 0; k < 3; k++) normal[k] += weight * s->of_vertex[3 * (size_t)v[i] + k];
    }
    normalise(normal);
    if (is_zero(normal)) memcpy(normal, s->of_vertex + 3 * (size_t)v[0], 3 * sizeof *normal);
}

/* Fills the normals of the points that have no vertex. */
static brio_status ask_surface(point_set *s, const brio_mesh *surface) {
    brio_status status = BRIO_OK;
    brio_triangle_tree tree = {0};
    brio_mesh scaled = *surface;
    scaled.vertices = NULL;
    BRIO_TRY(scale_to_one(s, surface->vertices, surface->num_vertices, &scaled.vertices));
    BRIO_TRY(brio_triangle_tree_new(s->ctx, &scaled, &tree));
    for (size_t p = 0; p < s->num_points; p++) {
        if (p % EVERY == 0) BRIO_TRY(brio_progress(s->ctx, "normals", 0.5 + 0.5 * (double)p / (double)s->num_points));
        if (s->vertex[p] == NO_VERTEX) normal_at(s, &tree, s->points + 3 * p, s->normals + 3 * p);
    }
done:
    brio_triangle_tree_free(s->ctx, &tree);
    brio_release(s->ctx, scaled.vertices);
    return status;
}

brio_status brio_point_normals(brio_context *ctx, const double *points, size_t num_points, const brio_mesh *surface,
                               const uint32_t *samples, double *normals) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    double *of_vertex = NULL;
    point_set s = {.ctx = ctx, .num_points = num_points, .normals = normals};
    BRIO_TRY(brio_refuse_points(ctx, points, num_points));
    BRIO_TRY(brio_refuse_vertices(ctx, surface->vertices, surface->num_vertices, "the surface"));
    BRIO_TRY(brio_vertex_normals(surface, &of_vertex));
    s.of_vertex = of_vertex;
    BRIO_TRY(list_known(&s, surface, samples));
    s.exponent = brio_exponent(brio_greatest(points, 3 * num_points));
    if (s.num_known < num_points) {
        BRIO_TRY(scale_to_one(&s, points, num_points, &s.points));
        BRIO_TRY(find_twins(&s));
        BRIO_TRY(ask_surface(&s, surface));
    }
    for (size_t p = 0; p < num_points; p++)
        if (s.vertex[p] != NO_VERTEX) memcpy(normals + 3 * p, of_vertex + 3 * (size_t)s.vertex[p], 3 * sizeof *normals);
done:
    brio_release(ctx, of_vertex);
    brio_release(ctx, s.vertex);
    brio_release(ctx, s.known);
    brio_release(ctx, s.points);
    return status;
}
