/* Gives the vertices of a mesh the properties of points: of the points that they are, or of the nearest ones.
 *
 * The nearest point is found in a tree of the distinct positions, in coordinates that are scaled by a power of two so
 * that squares do not overflow. Each position stands for the point of lowest index there.
 *
 * Based on: Friedman, Bentley, Finkel. An algorithm for finding best matches in logarithmic expected time. ACM TOMS
 * 1977. */
#include "base/utf8.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/team.h"
#include "mesh/properties.h"
#include "order/canonical_points.h"
#include "query/nearest_points.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

/* BLOCK: vertices between two looks at the progress. Both chosen. */
enum { BLOCK = 1 << 18, VERTICES_A_THREAD = 1 << 8 };

/* --- nearest points --- */

typedef struct {
    brio_context *ctx;
    int exponent;    /* coordinates times 2^-exponent are at most 1 */
    uint32_t *index; /* of the point at each distinct position */
    brio_point_tree tree;
    const double *queries; /* scaled, from `first` on */
    size_t first;
    uint32_t *nearest; /* #V: indices of points */
} nearest_search;

/* Lists one index for each position, in canonical order; returns their number. */
static size_t list_positions(uint32_t *order, const double *points, size_t count) {
    size_t distinct = 0;
    brio_name_coincident(points, count, order);
    for (size_t i = 0; i < count; i++)
        if (!i || order[i] != order[distinct - 1]) order[distinct++] = order[i];
    return distinct;
}

static brio_status make_tree(nearest_search *s, const brio_mesh *points) {
    brio_status status = BRIO_OK;
    double *rows = NULL;
    BRIO_TRY(brio_canonical_points(s->ctx, points->vertices, points->num_vertices, &s->index));
    size_t distinct = list_positions(s->index, points->vertices, points->num_vertices);
    BRIO_TRY(BRIO_ALLOC(s->ctx, rows, 3 * distinct));
    brio_copy_points(points->vertices, s->index, distinct, rows);
    BRIO_TRY(brio_point_tree_scaled(s->ctx, rows, distinct, -s->exponent, &s->tree));
done:
    brio_release(s->ctx, rows);
    return status;
}

static void search(void *user, size_t begin, size_t end, int thread) {
    const nearest_search *s = user;
    brio_near_point near[BRIO_NEAR_ROOM];
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        brio_nearest_points(&s->tree, s->queries + 3 * i, 1, INFINITY, near);
        s->nearest[s->first + i] = s->index[s->tree.index[near[0].place]];
    }
}

static brio_status search_all(nearest_search *s, const brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    double *queries = NULL;
    size_t n = mesh->num_vertices;
    BRIO_TRY(BRIO_ALLOC(s->ctx, queries, 3 * (n < BLOCK ? n : BLOCK)));
    s->queries = queries;
    for (s->first = 0; s->first < n; s->first += BLOCK) {
        size_t count = n - s->first < BLOCK ? n - s->first : BLOCK;
        BRIO_TRY(brio_progress(s->ctx, "properties", (double)s->first / (double)n));
        BRIO_TRY(brio_scale(s->ctx, mesh->vertices + 3 * s->first, 3 * count, -s->exponent, queries));
        BRIO_TRY(brio_for(s->ctx, brio_threads(s->ctx, count, VERTICES_A_THREAD), count, search, s));
    }
done:
    brio_release(s->ctx, queries);
    return status;
}

static brio_status find_nearest(brio_context *ctx, const brio_mesh *points, const brio_mesh *mesh, uint32_t *nearest) {
    brio_status status = BRIO_OK;
    nearest_search s = {.ctx = ctx, .nearest = nearest};
    BRIO_REQUIRE(ctx, points->num_vertices || !mesh->num_vertices, BRIO_ERR_ARGUMENT,
                 "no points, whose properties %zu vertices could take", mesh->num_vertices);
    BRIO_TRY(brio_refuse_points(ctx, points->vertices, points->num_vertices));
    BRIO_TRY(brio_refuse_points(ctx, mesh->vertices, mesh->num_vertices));
    s.exponent = brio_exponent(fmax(brio_greatest(points->vertices, 3 * points->num_vertices),
                                    brio_greatest(mesh->vertices, 3 * mesh->num_vertices)));
    BRIO_TRY(make_tree(&s, points));
    BRIO_TRY(search_all(&s, mesh));
done:
    brio_point_tree_free(ctx, &s.tree);
    brio_release(ctx, s.index);
    return status;
}

/* --- copies --- */

/* Finds a name that the mesh has not: NAME, input_NAME, input_NAME_2 and so on, NAME cut so that the whole fits. */
static void find_name(const brio_mesh *mesh, const char *name, char out[64]) {
    char input[80];
    snprintf(input, sizeof input, "input_%s", name);
    brio_utf8_copy(out, 64, brio_mesh_property(mesh, name) ? input : name);
    for (size_t n = 2; brio_mesh_property(mesh, out); n++) brio_numbered_name(out, 64, input, n);
}

/* Copies property i of the points, which may be the mesh itself: adding one then moves it. */
static brio_status copy_property(const brio_mesh *points, size_t i, const uint32_t *samples, brio_mesh *mesh) {
    char name[64];
    void *data;
    find_name(mesh, points->properties[i].name, name);
    brio_status status = brio_mesh_add_property(mesh, name, points->properties[i].type, &data);
    if (status != BRIO_OK) return status;
    const brio_property *p = &points->properties[i];
    size_t size = brio_scalar_size(p->type);
    for (size_t v = 0; v < mesh->num_vertices; v++)
        memcpy((char *)data + v * size, (const char *)p->data + samples[v] * size, size);
    return BRIO_OK;
}

static brio_status check_samples(brio_context *ctx, const uint32_t *samples, size_t num_vertices, size_t num_points) {
    for (size_t v = 0; v < num_vertices; v++)
        BRIO_EXPECT(ctx, samples[v] < num_points, BRIO_ERR_ARGUMENT, "vertex %zu: there is no point %d", v,
                    (int)samples[v]);
    return BRIO_OK;
}

brio_status brio_mesh_carry_properties(brio_context *ctx, const brio_mesh *points, const uint32_t *samples,
                                       brio_mesh *mesh) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    uint32_t *nearest = NULL;
    size_t before = mesh->num_properties, count = points->num_properties;
    if (samples) {
        BRIO_TRY(check_samples(ctx, samples, mesh->num_vertices, points->num_vertices));
    } else if (points->num_properties) {
        BRIO_TRY(BRIO_ALLOC(ctx, nearest, mesh->num_vertices));
        BRIO_TRY(find_nearest(ctx, points, mesh, nearest));
    }
    for (size_t i = 0; i < count; i++) BRIO_TRY(copy_property(points, i, samples ? samples : nearest, mesh));
done:
    if (status != BRIO_OK) brio_mesh_drop_properties(mesh, before);
    brio_release(ctx, nearest);
    return status;
}
