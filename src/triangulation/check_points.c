/* The check of the points that are no vertex: test 7 of check.c. For a result of brio_delaunay it also checks which
 * vertex represents each point, and the numbers of vertices, duplicates and hidden points.
 *
 * Each point is located exactly. A walk that draws its next facet at random ends with probability one in every
 * triangulation [Devillers Pion Teillaud 2002], however ties are broken. Among coincident points of equal weight,
 * tetrahedra from another program may use any as the vertex. In a result of brio_delaunay the vertex must be the one
 * with the lowest index. */
#include "base/memory.h"
#include "base/sort.h"
#include "triangulation/check.h"
#include "triangulation/locate_walk.h"
#include "triangulation/nearest_vertex.h"
#include "triangulation/triangulation.h"
#include <assert.h>

typedef struct {
    brio_judge *j;
    const brio_triangulation *result; /* may be NULL */
    uint32_t *vertex_tet;             /* a tetrahedron of each vertex; BRIO_NO_TET for other points */
    brio_walk walk;
    brio_nearest nearest; /* for the representatives of hidden points */
    uint32_t *hidden;
    size_t num_hidden; /* number of hidden points; coincident points count each */
    size_t num_vertices;
} workspace;

static brio_status find_vertices(workspace *w) {
    const brio_judge *j = w->j;
    BRIO_FORWARD(BRIO_ALLOC(j->ctx, w->vertex_tet, j->num_points));
    for (size_t p = 0; p < j->num_points; p++) w->vertex_tet[p] = BRIO_NO_TET;
    for (size_t tet = 0; tet < j->t.count; tet++)
        for (int i = 0; i < 4; i++) {
            uint32_t v = j->t.tet[tet].vertex[i];
            if (v != BRIO_INFINITE) w->vertex_tet[v] = (uint32_t)tet;
        }
    for (size_t p = 0; p < j->num_points; p++) w->num_vertices += w->vertex_tet[p] != BRIO_NO_TET;
    return BRIO_OK;
}

/* Checks that every representative is a vertex, or left open, and that every vertex represents itself. */
static brio_status check_vertices(workspace *w) {
    const brio_judge *j = w->j;
    for (size_t p = 0; p < j->num_points; p++) {
        uint32_t v = w->result->representative[p];
        bool vertex = w->vertex_tet[p] != BRIO_NO_TET, open = v == BRIO_INFINITE && w->result->leaves_hidden;
        BRIO_EXPECT(j->ctx, open || (v < j->num_points && w->vertex_tet[v] != BRIO_NO_TET), BRIO_ERR_CHECK,
                    "point %zu is represented by %u, which is no vertex", BRIO_POINT(j->ctx, p), v);
        BRIO_EXPECT(j->ctx, !vertex || v == p, BRIO_ERR_CHECK, "vertex %zu is represented by %u", p, v);
    }
    return BRIO_OK;
}

/* Returns the vertex of a tetrahedron at position x, or BRIO_INFINITE. */
static uint32_t vertex_at(const brio_judge *j, uint32_t tet, const double *x) {
    const uint32_t *v = j->t.tet[tet].vertex;
    for (int i = 0; i < 4; i++)
        if (brio_same_position(j->t.record[v[i]], x)) return v[i];
    return BRIO_INFINITE;
}

/* Checks point p, which is at the position of vertex v. */
static brio_status check_duplicate(workspace *w, uint32_t p, uint32_t v) {
    const brio_judge *j = w->j;
    double more = j->weighted ? j->t.record[p][3] - j->t.record[v][3] : 0;
    BRIO_EXPECT(j->ctx, more <= 0, BRIO_ERR_CHECK, "point %u is heavier than vertex %u at the same position",
                BRIO_POINT(j->ctx, p), v);
    if (!w->result) return BRIO_OK;
    BRIO_EXPECT(j->ctx, more < 0 || v < p, BRIO_ERR_CHECK, "point %u should represent its duplicate %u",
                BRIO_POINT(j->ctx, p), v);
    BRIO_EXPECT(j->ctx, w->result->representative[p] == v, BRIO_ERR_CHECK,
                "point %u is a duplicate of vertex %u, but vertex %u represents it", BRIO_POINT(j->ctx, p), v,
                w->result->representative[p]);
    return BRIO_OK;
}

/* Checks point p, which is in tetrahedron tet and at the position of no vertex. Without weights p is inside the
 * sphere, so the check fails. */
static brio_status check_hidden(workspace *w, uint32_t p, uint32_t tet) {
    brio_judge *j = w->j;
    uint32_t best = BRIO_INFINITE;
    BRIO_FORWARD(brio_check_sphere(j, tet, p));
    if (!w->result) return BRIO_OK;
    assert(w->num_hidden < j->num_points - w->num_vertices);
    w->hidden[w->num_hidden++] = p;
    if (!w->result->leaves_hidden) BRIO_FORWARD(brio_nearest_vertex(&w->nearest, tet, j->t.record[p], &best));
    BRIO_EXPECT(j->ctx, w->result->representative[p] == best, BRIO_ERR_CHECK,
                "hidden point %u is represented by %u instead of %u", BRIO_POINT(j->ctx, p),
                w->result->representative[p], best);
    return BRIO_OK;
}

static brio_status check_point(workspace *w, uint32_t p) {
    brio_status status = BRIO_OK;
    brio_judge *j = w->j;
    const double *x = j->t.record[p];
    uint32_t known = w->result ? w->result->representative[p] : BRIO_INFINITE;
    if (known != BRIO_INFINITE) w->walk.start = w->vertex_tet[known];
    uint32_t tet = brio_locate_walk(&j->t, NULL, &j->filter, &w->walk, x, UINT64_MAX);
    w->walk.start = tet;
    BRIO_TRY(brio_look(j->ctx, 16));
    BRIO_REQUIRE(j->ctx, !brio_is_infinite(&j->t, tet), BRIO_ERR_CHECK, "point %u is outside the hull",
                 BRIO_POINT(j->ctx, p));
    uint32_t v = vertex_at(j, tet, x);
    status = v != BRIO_INFINITE ? check_duplicate(w, p, v) : check_hidden(w, p, tet);
done:
    return status;
}

static int compare_positions(uint32_t p, uint32_t q, const void *record) {
    return brio_lexicographic(((const brio_record *)record)[p], ((const brio_record *)record)[q]);
}

/* Checks the counts. Coincident hidden points count once. */
static brio_status check_counts(workspace *w) {
    const brio_record *r = w->j->t.record;
    const brio_delaunay_stats *s = &w->result->stats;
    size_t hidden = 0;
    BRIO_FORWARD(brio_sort_rows(w->j->ctx, &(brio_row_order){*r, 4, compare_positions, r}, w->hidden, w->num_hidden));
    for (size_t i = 0; i < w->num_hidden; i++)
        hidden += i == 0 || !brio_same_position(r[w->hidden[i - 1]], r[w->hidden[i]]);
    size_t duplicates = w->j->num_points - w->num_vertices - hidden;
    BRIO_EXPECT(w->j->ctx, s->vertices == w->num_vertices && s->duplicates == duplicates && s->hidden == hidden,
                BRIO_ERR_CHECK, "%zu vertices, %zu duplicates and %zu hidden points are counted as %zu, %zu and %zu",
                w->num_vertices, duplicates, hidden, s->vertices, s->duplicates, s->hidden);
    return BRIO_OK;
}

brio_status brio_check_points(brio_judge *j, const brio_triangulation *result) {
    brio_status status = BRIO_OK;
    workspace w = {.j = j, .result = result};
    BRIO_TRY(find_vertices(&w));
    if (result) {
        BRIO_TRY(check_vertices(&w));
        BRIO_TRY(BRIO_ALLOC(j->ctx, w.hidden, j->num_points - w.num_vertices));
    }
    if (result && j->weighted && w.num_vertices < j->num_points)
        BRIO_TRY(brio_nearest_new(j->ctx, &j->t, j->num_points, w.vertex_tet, &w.nearest));
    for (size_t p = 0; p < j->num_points; p++)
        if (w.vertex_tet[p] == BRIO_NO_TET) BRIO_TRY(check_point(&w, (uint32_t)p));
    if (result) BRIO_TRY(check_counts(&w));
done:
    brio_nearest_free(&w.nearest);
    brio_release(j->ctx, w.vertex_tet);
    brio_release(j->ctx, w.hidden);
    return status;
}
