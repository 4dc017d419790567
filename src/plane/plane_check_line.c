/* The check of points on a line, at one place, or of none.
 *
 * An apex off the line makes a triangle of two points on the line. Its (ortho)circle meets the line in the
 * one-dimensional (ortho)sphere of the two points (plane_start.c), so the in-circle test decides conflicts on the line.
 * The listed vertices are the regular triangulation of the line when
 *   1  their order is strictly lexicographic, which is the order along the line;
 *   2  each is not in conflict with the two before it: the lifted vertices are convex;
 *   3  every other point lies between two neighbours (closed), and is at one of them and not heavier, or is not in
 *      conflict with them.
 * "In conflict" has ties broken by the symbolic perturbation. */
#include "base/memory.h"
#include "base/sort.h"
#include "plane/plane_check.h"
#include "plane/plane_start.h"
#include "predicates/predicates.h"

typedef struct {
    brio_plane_judge *j;
    const brio_plane_record *record;
    const uint32_t *line;
    size_t count; /* of vertices */
    uint32_t *hidden;
    size_t num_hidden;
} workspace;

static int compare(const workspace *w, uint32_t p, uint32_t q) {
    return brio_plane_lexicographic(&w->j->filter, w->record[p], w->record[q]);
}

/* Returns whether point x conflicts with the edge from vertex i of the line to the next one. */
static bool in_conflict(const workspace *w, size_t i, uint32_t x) {
    const double *a = w->record[w->line[i]], *b = w->record[w->line[i + 1]], *apex = w->record[w->j->num_points];
    brio_plane_filter *f = &w->j->filter;
    if (brio_orient2d_sign(f, a, b, apex) < 0) {
        const double *swap = a;
        a = b, b = swap;
    }
    return brio_circle_conflict(f, a, b, apex, w->record[x], f->general);
}

/* Runs tests 1 and 2. */
static brio_status check_vertices(const workspace *w) {
    const brio_plane_judge *j = w->j;
    for (size_t i = 0; i < w->count; i++) {
        uint32_t v = w->line[i];
        BRIO_EXPECT(j->ctx, v < j->num_points && j->t->representative[v] == v, BRIO_ERR_CHECK,
                    "vertex %u of the line does not represent itself", v);
        BRIO_EXPECT(j->ctx, i == 0 || compare(w, w->line[i - 1], v) < 0, BRIO_ERR_CHECK,
                    "vertices %u and %u of the line are out of order", w->line[i - 1], v);
        BRIO_EXPECT(j->ctx, i < 2 || !in_conflict(w, i - 2, v), BRIO_ERR_CHECK,
                    "vertex %u is inside the circle of vertices %u and %u", v, w->line[i - 2], w->line[i - 1]);
    }
    return BRIO_OK;
}

/* Returns the first vertex of the line that is not before p, or the number of vertices. */
static size_t place_on_line(const workspace *w, uint32_t p) {
    size_t low = 0, high = w->count;
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (compare(w, w->line[middle], p) < 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static bool is_nearer(const workspace *w, uint32_t p, size_t i, size_t k) {
    const double *u = w->record[w->line[i]], *v = w->record[w->line[k]];
    int sign = brio_power_compare(w->record[p], u, v);
    return (sign ? sign : brio_plane_lexicographic(&w->j->filter, u, v)) < 0;
}

/* Returns the vertex of least power distance, by descent from the i-th one. */
static uint32_t nearest_vertex(const workspace *w, uint32_t p, size_t i) {
    while (i > 0 && is_nearer(w, p, i - 1, i)) i--;
    while (i + 1 < w->count && is_nearer(w, p, i + 1, i)) i++;
    return w->line[i];
}

/* Runs test 3 on point p, whose place is at or before the i-th vertex. */
static brio_status check_point(workspace *w, uint32_t p, size_t i) {
    const brio_plane_judge *j = w->j;
    BRIO_EXPECT(j->ctx, i < w->count, BRIO_ERR_CHECK, "point %u is outside the hull", BRIO_POINT(j->ctx, p));
    uint32_t v = w->line[i], right = v;
    if (compare(w, v, p) == 0) {
        double more = w->record[p][3] - w->record[v][3];
        BRIO_EXPECT(j->ctx, more < 0 || (more == 0 && v <= p), BRIO_ERR_CHECK,
                    "point %u should represent its duplicate %u", BRIO_POINT(j->ctx, p), v);
    } else {
        BRIO_EXPECT(j->ctx, i > 0, BRIO_ERR_CHECK, "point %u is outside the hull", BRIO_POINT(j->ctx, p));
        BRIO_EXPECT(j->ctx, !in_conflict(w, i - 1, p), BRIO_ERR_CHECK,
                    "point %u is inside the circle of vertices %u and %u", BRIO_POINT(j->ctx, p), w->line[i - 1], v);
        w->hidden[w->num_hidden++] = p;
        right = nearest_vertex(w, p, i);
    }
    BRIO_EXPECT(j->ctx, j->t->representative[p] == right, BRIO_ERR_CHECK, "point %u is represented by %u instead of %u",
                BRIO_POINT(j->ctx, p), j->t->representative[p], right);
    return BRIO_OK;
}

static int compare_places(uint32_t p, uint32_t q, const void *user) {
    return compare(user, p, q);
}

static brio_status check_counts(workspace *w, size_t vertices) {
    const brio_delaunay2_stats *s = &w->j->t->stats;
    size_t hidden = 0;
    BRIO_FORWARD(brio_sort_many_indices(w->j->ctx, w->hidden, w->num_hidden, compare_places, w));
    for (size_t i = 0; i < w->num_hidden; i++) hidden += i == 0 || compare(w, w->hidden[i - 1], w->hidden[i]) != 0;
    size_t duplicates = s->points - vertices - hidden;
    BRIO_EXPECT(w->j->ctx,
                s->vertices == vertices && s->duplicates == duplicates && s->hidden == hidden && s->triangles == 0 &&
                    s->hull_edges == 0,
                BRIO_ERR_CHECK, "%zu vertices, %zu duplicates and %zu hidden points are counted as %zu, %zu and %zu",
                vertices, duplicates, hidden, s->vertices, s->duplicates, s->hidden);
    return BRIO_OK;
}

/* Checks that the heaviest point represents the others; among equal weights, the one with the lowest index. */
static brio_status check_one_place(workspace *w) {
    brio_status status = BRIO_OK;
    const brio_plane_judge *j = w->j;
    uint32_t best = 0;
    for (uint32_t p = 1; p < j->num_points; p++)
        if (w->record[p][3] > w->record[best][3]) best = p;
    for (uint32_t p = 0; p < j->num_points; p++)
        BRIO_REQUIRE(j->ctx, j->t->representative[p] == best, BRIO_ERR_CHECK,
                     "point %u is represented by %u instead of %u", BRIO_POINT(j->ctx, p), j->t->representative[p],
                     best);
    status = check_counts(w, j->num_points > 0);
done:
    return status;
}

brio_status brio_plane_check_line(brio_plane_judge *j, brio_plane_record *record) {
    brio_status status = BRIO_OK;
    workspace w = {.j = j, .record = (const brio_plane_record *)record, .line = j->t->line};
    if (j->t->stats.dimension < 1) return check_one_place(&w);
    w.count = j->t->stats.vertices;
    BRIO_REQUIRE(j->ctx, w.count > 1 && w.count <= j->num_points && w.count == j->t->line_count, BRIO_ERR_CHECK,
                 "%zu vertices of %zu points on a line", w.count, j->num_points);
    size_t second = 1;
    while (brio_same_place(record[0], record[second])) second++;
    brio_plane_place_apex(record[0], record[second], record[j->num_points]);
    brio_plane_filter_for(&j->filter, w.record, j->num_points + 1, j->filter.general);
    BRIO_TRY(BRIO_ALLOC(j->ctx, w.hidden, j->num_points));
    BRIO_TRY(check_vertices(&w));
    for (uint32_t p = 0; p < j->num_points; p++) BRIO_TRY(check_point(&w, p, place_on_line(&w, p)));
    status = check_counts(&w, w.count);
done:
    brio_release(j->ctx, w.hidden);
    return status;
}
