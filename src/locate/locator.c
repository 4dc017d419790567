/* Makes the object that queries read (locator.h): sorts the vertices into a k-d tree, and copies the tetrahedra with
 * the places of their vertices. */
#include "locate/locator.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/team.h"
#include "base/vector.h"
#include "plane/plane_frame.h"
#include "query/nearest_points.h"
#include "triangulation/records.h"
#include "triangulation/triangulation.h"
#include <math.h>
#include <string.h>

enum { TETRAHEDRA_A_THREAD = 1 << 14 };

/* --- vertices --- */

/* Copies the positions of the vertices, and lists the vertices in the order of their indices. */
static size_t list_vertices(const brio_triangulation *t, const brio_record *record, double *rows, uint32_t *vertex) {
    size_t count = 0;
    for (size_t p = 0; p < t->stats.points; p++) {
        if (t->representative[p] != p) continue;
        memcpy(rows + 3 * count, record[p], 3 * sizeof *rows);
        vertex[count++] = (uint32_t)p;
    }
    return count;
}

/* Moves the points of a tree into records. */
static brio_status take_tree(brio_locator *l, brio_point_tree *tree, const uint32_t *vertex,
                             const brio_record *record) {
    brio_status status = BRIO_ALLOC(l->ctx, l->record, l->num_vertices);
    if (status != BRIO_OK) return status;
    for (size_t v = 0; v < l->num_vertices; v++) {
        uint32_t point = vertex[tree->index[v]];
        memcpy(l->record[v], tree->point[v], sizeof *tree->point);
        l->record[v][3] = record[point][3];
        tree->index[v] = point;
    }
    l->name = tree->index;
    l->axis = tree->axis;
    tree->index = NULL;
    tree->axis = NULL;
    return BRIO_OK;
}

static brio_status sort_vertices(brio_locator *l, const brio_triangulation *t, const brio_record *record) {
    brio_status status = BRIO_OK;
    double *rows = NULL;
    uint32_t *vertex = NULL;
    brio_point_tree tree = {0};
    BRIO_TRY(BRIO_ALLOC(l->ctx, rows, 3 * l->num_vertices));
    BRIO_TRY(BRIO_ALLOC(l->ctx, vertex, l->num_vertices));
    list_vertices(t, record, rows, vertex);
    l->scale = brio_scale_to_one(brio_usual_exponent(rows, l->num_vertices));
    BRIO_TRY(brio_point_tree_new(l->ctx, rows, l->num_vertices, &tree));
    BRIO_TRY(take_tree(l, &tree, vertex, record));
done:
    brio_point_tree_free(l->ctx, &tree);
    brio_release(l->ctx, rows);
    brio_release(l->ctx, vertex);
    return status;
}

/* Returns the greatest weight of a range and sets it for the ranges in it. The recursion is as deep as the tree. */
static double find_most(brio_locator *l, size_t begin, size_t end) {
    double most = -INFINITY;
    if (end - begin <= BRIO_TREE_LEAF) {
        for (size_t v = begin; v < end; v++) most = fmax(most, l->record[v][3]);
        return most;
    }
    size_t middle = begin + (end - begin) / 2;
    most = fmax(find_most(l, begin, middle), find_most(l, middle + 1, end));
    return l->most[middle] = fmax(most, l->record[middle][3]);
}

static void find_box(brio_locator *l) {
    double extent[3] = {0};
    for (int k = 0; k < 3; k++) {
        l->low[k] = INFINITY, l->high[k] = -INFINITY;
        for (size_t v = 0; v < l->num_vertices; v++) {
            l->low[k] = fmin(l->low[k], l->record[v][k]);
            l->high[k] = fmax(l->high[k], l->record[v][k]);
        }
        extent[k] = l->high[k] - l->low[k];
    }
    brio_filter_set(&l->filter, extent, 0, false);
}

/* --- tetrahedra --- */

typedef struct {
    brio_locator *l;
    const brio_tetrahedron *from;
    const uint32_t *place; /* of each of the caller's points that is a vertex */
} copy_job;

static void copy_tetrahedra(void *user, size_t begin, size_t end, int thread) {
    const copy_job *job = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        brio_tetrahedron tet = job->from[i];
        for (int k = 0; k < 4; k++)
            if (tet.vertex[k] != BRIO_INFINITE) tet.vertex[k] = job->place[tet.vertex[k]];
        job->l->t.tet[i] = tet;
    }
}

static void find_vertex_tetrahedra(brio_locator *l) {
    for (size_t i = l->num_finite; i-- > 0;)
        for (int k = 0; k < 4; k++) l->vertex_tet[l->t.tet[i].vertex[k]] = (uint32_t)i;
}

static brio_status take_tetrahedra(brio_locator *l, const brio_triangulation *t) {
    brio_status status = BRIO_OK;
    uint32_t *place = NULL;
    l->t = (brio_tetrahedra){.infinite = BRIO_INFINITE, .record = (const brio_record *)l->record};
    if (!l->num_finite) return BRIO_OK;
    l->t.count = t->stats.tetrahedra + t->stats.hull_facets;
    BRIO_TRY(BRIO_ALLOC(l->ctx, l->t.tet, l->t.count));
    BRIO_TRY(BRIO_ALLOC(l->ctx, l->vertex_tet, l->num_vertices));
    BRIO_TRY(BRIO_ALLOC(l->ctx, place, l->num_points));
    for (size_t v = 0; v < l->num_vertices; v++) place[l->name[v]] = (uint32_t)v;
    copy_job job = {l, t->tet, place};
    BRIO_TRY(
        brio_for(l->ctx, brio_threads(l->ctx, l->t.count, TETRAHEDRA_A_THREAD), l->t.count, copy_tetrahedra, &job));
    find_vertex_tetrahedra(l);
done:
    brio_release(l->ctx, place);
    return status;
}

/* --- points in a plane --- */

/* Returns whether all tetrahedra may be flat up to the rounding of coordinates: brio_plane_fit then decides. In usual
 * triangulations one of the first is not. */
static bool may_be_flat(const brio_locator *l, const brio_triangulation *t, const brio_record *record) {
    double greatest = 0;
    for (int k = 0; k < 3; k++) greatest = fmax(greatest, fmax(fabs(l->low[k]), fabs(l->high[k])));
    for (size_t i = 0; i < l->num_finite; i++) {
        const uint32_t *v = t->tet[i].vertex;
        double edge[3][3], normal[3], square = 0;
        for (int j = 0; j < 3; j++) {
            for (int k = 0; k < 3; k++) edge[j][k] = record[v[j + 1]][k] / greatest - record[v[0]][k] / greatest;
            square = fmax(square, brio_dot(edge[j], edge[j]));
        }
        brio_cross(edge[0], edge[1], normal);
        if (fabs(brio_dot(normal, edge[2])) > 4 * BRIO_FLAT_ROUNDING * square) return false;
    }
    return true;
}

/* Makes the locator of points that are in a plane, in the coordinates of the plane. */
static brio_status make_flat(brio_locator *l, const brio_triangulation *whole, const brio_record *record) {
    brio_status status = BRIO_OK;
    double *points = NULL, *places = NULL, *weights = NULL;
    brio_triangulation2 *t = NULL;
    size_t n = l->num_points;
    if (!may_be_flat(l, whole, record)) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(l->ctx, points, 3 * n));
    BRIO_TRY(BRIO_ALLOC(l->ctx, places, 2 * n));
    if (l->weighted) BRIO_TRY(BRIO_ALLOC(l->ctx, weights, n));
    for (size_t i = 0; i < n; i++) {
        memcpy(points + 3 * i, record[i], 3 * sizeof *points);
        if (weights) weights[i] = record[i][3];
    }
    l->frame.size = sizeof l->frame;
    BRIO_TRY(brio_plane_fit(l->ctx, points, n, &l->frame));
    if (l->frame.dimension == 3) goto done;
    brio_plane_project(&l->frame, points, n, places);
    BRIO_TRY(brio_delaunay2(l->ctx, places, weights, n, NULL, &t));
    BRIO_TRY(brio_locator2_new(l->ctx, t, places, weights, n, &l->flat));
done:
    brio_triangulation2_free(t);
    brio_release(l->ctx, points);
    brio_release(l->ctx, places);
    brio_release(l->ctx, weights);
    return status;
}

/* --- the object --- */

/* Copies the points, which must be those of the triangulation: with others a walk might not end. Another thread of the
 * caller may write to the caller's arrays meanwhile; what counts is the copy. */
static brio_status copy_points(brio_context *ctx, const brio_triangulation *t, const brio_input *in,
                               brio_record **record) {
    uint64_t hash = 0;
    BRIO_EXPECT(ctx, in->count == t->stats.points, BRIO_ERR_ARGUMENT,
                "%zu points were given, the triangulation has %zu", in->count, t->stats.points);
    BRIO_FORWARD(brio_records_new(ctx, in, NULL, 0, &hash, record));
    BRIO_EXPECT(ctx, hash == t->points_hash, BRIO_ERR_ARGUMENT,
                "the points are not those of the triangulation, or were changed since");
    return BRIO_OK;
}

static brio_status fill(brio_locator *l, const brio_triangulation *t, const brio_input *in) {
    brio_status status = BRIO_OK;
    brio_record *record = NULL;
    BRIO_TRY(copy_points(l->ctx, t, in, &record));
    BRIO_TRY(brio_progress(l->ctx, "locator", 0));
    BRIO_TRY(sort_vertices(l, t, (const brio_record *)record));
    find_box(l);
    BRIO_TRY(make_flat(l, t, (const brio_record *)record));
    brio_release(l->ctx, record);
    record = NULL;
    if (l->weighted) {
        BRIO_TRY(BRIO_ALLOC(l->ctx, l->most, l->num_vertices));
        find_most(l, 0, l->num_vertices);
    }
    BRIO_TRY(brio_progress(l->ctx, "locator", 0.5));
    BRIO_TRY(take_tetrahedra(l, t));
    BRIO_TRY(brio_progress(l->ctx, "locator", 1));
done:
    brio_release(l->ctx, record);
    return status;
}

brio_status brio_locator_new(brio_context *ctx, const brio_triangulation *t, const double *points,
                             const double *weights, size_t num_points, brio_locator **out) {
    BRIO_DOOR;
    brio_locator *l = NULL;
    brio_status status = BRIO_OK;
    brio_input in = {points, weights, num_points};
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, l, 1));
    l->ctx = ctx;
    l->num_points = num_points;
    l->num_vertices = t->stats.vertices;
    l->num_finite = t->stats.tetrahedra;
    l->weighted = weights != NULL;
    l->engine = brio_engine_choose(false);
    BRIO_TRY(fill(l, t, &in));
    *out = l;
    l = NULL;
done:
    brio_locator_free(l);
    return status;
}

void brio_locator_free(brio_locator *l) {
    if (!l) return;
    brio_release(l->ctx, l->record);
    brio_release(l->ctx, l->name);
    brio_release(l->ctx, l->axis);
    brio_release(l->ctx, l->most);
    brio_release(l->ctx, l->vertex_tet);
    brio_release(l->ctx, l->t.tet);
    brio_locator2_free(l->flat);
    brio_release(l->ctx, l);
}
