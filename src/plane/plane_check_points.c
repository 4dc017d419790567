/* The check of the points that are no vertex: test 7 of plane_check.c, representatives and counts. Each point is
 * located exactly: the triangles have passed tests 1 to 6, so the visibility walk ends. */
#include "base/memory.h"
#include "base/sort.h"
#include "plane/plane_check.h"
#include "plane/plane_nearest.h"

typedef struct {
    brio_plane_judge *j;
    uint32_t *corner; /* a triangle of each vertex; BRIO_NO_TRIANGLE for other points */
    uint32_t *hidden;
    size_t num_hidden; /* coincident points count each */
    size_t num_vertices;
    uint64_t steps;
} workspace;

static brio_status find_vertices(workspace *w) {
    const brio_plane_judge *j = w->j;
    BRIO_FORWARD(BRIO_ALLOC(j->ctx, w->corner, j->num_points));
    for (size_t p = 0; p < j->num_points; p++) w->corner[p] = BRIO_NO_TRIANGLE;
    for (size_t t = 0; t < j->count; t++)
        for (int i = 0; i < 3; i++) {
            uint32_t v = j->view.triangle[t].vertex[i];
            if (v != BRIO_INFINITE) w->corner[v] = (uint32_t)t;
        }
    for (size_t p = 0; p < j->num_points; p++) w->num_vertices += w->corner[p] != BRIO_NO_TRIANGLE;
    return BRIO_OK;
}

/* Checks that every representative is a vertex and that every vertex represents itself. */
static brio_status check_vertices(workspace *w) {
    const brio_plane_judge *j = w->j;
    for (size_t p = 0; p < j->num_points; p++) {
        uint32_t v = j->t->representative[p];
        bool vertex = w->corner[p] != BRIO_NO_TRIANGLE;
        BRIO_EXPECT(j->ctx, v < j->num_points && w->corner[v] != BRIO_NO_TRIANGLE, BRIO_ERR_CHECK,
                    "point %zu is represented by %u, which is no vertex", BRIO_POINT(j->ctx, p), v);
        BRIO_EXPECT(j->ctx, !vertex || v == p, BRIO_ERR_CHECK, "vertex %zu is represented by %u", p, v);
    }
    return BRIO_OK;
}

/* Checks point p, which is at the place of vertex v. */
static brio_status check_duplicate(workspace *w, uint32_t p, uint32_t v) {
    const brio_plane_judge *j = w->j;
    double more = j->view.record[p][3] - j->view.record[v][3];
    BRIO_EXPECT(j->ctx, more <= 0, BRIO_ERR_CHECK, "point %u is heavier than vertex %u at the same position",
                BRIO_POINT(j->ctx, p), v);
    BRIO_EXPECT(j->ctx, more < 0 || v < p, BRIO_ERR_CHECK, "point %u should represent its duplicate %u",
                BRIO_POINT(j->ctx, p), v);
    BRIO_EXPECT(j->ctx, j->t->representative[p] == v, BRIO_ERR_CHECK,
                "point %u is a duplicate of vertex %u, but vertex %u represents it", BRIO_POINT(j->ctx, p), v,
                j->t->representative[p]);
    return BRIO_OK;
}

/* Checks point p, which is in triangle t and at the position of no vertex. Without weights p is inside the circle, so
 * the check fails. */
static brio_status check_hidden(workspace *w, uint32_t p, uint32_t t) {
    brio_plane_judge *j = w->j;
    brio_plane_nearest nearest = {&j->view, &j->filter, j->num_points, w->corner};
    BRIO_FORWARD(brio_plane_check_circle(j, t, p));
    w->hidden[w->num_hidden++] = p;
    uint32_t best = brio_plane_nearest_vertex(&nearest, t, j->view.record[p]);
    BRIO_EXPECT(j->ctx, j->t->representative[p] == best, BRIO_ERR_CHECK,
                "hidden point %u is represented by %u instead of %u", BRIO_POINT(j->ctx, p), j->t->representative[p],
                best);
    return BRIO_OK;
}

static brio_status check_point(workspace *w, uint32_t p) {
    brio_status status = BRIO_OK;
    brio_plane_judge *j = w->j;
    const double *x = j->view.record[p];
    uint32_t start = w->corner[j->t->representative[p]];
    uint32_t t = brio_plane_walk(&j->view, &j->filter, start, x, &w->steps);
    const uint32_t *v = j->view.triangle[t].vertex;
    BRIO_REQUIRE(j->ctx, v[2] != BRIO_INFINITE, BRIO_ERR_CHECK, "point %u is outside the hull", BRIO_POINT(j->ctx, p));
    for (int i = 0; i < 3; i++)
        if (brio_same_place(j->view.record[v[i]], x)) return check_duplicate(w, p, v[i]);
    status = check_hidden(w, p, t);
done:
    return status;
}

static int compare_places(uint32_t p, uint32_t q, const void *user) {
    const brio_plane_judge *j = user;
    return brio_plane_lexicographic(&j->filter, j->view.record[p], j->view.record[q]);
}

/* Checks the counts. Coincident hidden points count once. */
static brio_status check_counts(workspace *w) {
    const brio_plane_judge *j = w->j;
    const brio_delaunay2_stats *s = &j->t->stats;
    size_t hidden = 0;
    BRIO_FORWARD(brio_sort_many_indices(j->ctx, w->hidden, w->num_hidden, compare_places, j));
    for (size_t i = 0; i < w->num_hidden; i++)
        hidden += i == 0 || !brio_same_place(j->view.record[w->hidden[i - 1]], j->view.record[w->hidden[i]]);
    size_t duplicates = j->num_points - w->num_vertices - hidden;
    BRIO_EXPECT(j->ctx, s->vertices == w->num_vertices && s->duplicates == duplicates && s->hidden == hidden,
                BRIO_ERR_CHECK, "%zu vertices, %zu duplicates and %zu hidden points are counted as %zu, %zu and %zu",
                w->num_vertices, duplicates, hidden, s->vertices, s->duplicates, s->hidden);
    return BRIO_OK;
}

brio_status brio_plane_check_points(brio_plane_judge *j) {
    brio_status status = BRIO_OK;
    workspace w = {.j = j};
    BRIO_TRY(find_vertices(&w));
    BRIO_TRY(check_vertices(&w));
    BRIO_TRY(BRIO_ALLOC(j->ctx, w.hidden, j->num_points - w.num_vertices));
    for (size_t p = 0; p < j->num_points; p++)
        if (w.corner[p] == BRIO_NO_TRIANGLE) BRIO_TRY(check_point(&w, (uint32_t)p));
    BRIO_TRY(check_counts(&w));
done:
    brio_release(j->ctx, w.corner);
    brio_release(j->ctx, w.hidden);
    return status;
}
