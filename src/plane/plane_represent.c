/* Gives each point that owns no cell the vertex that represents it.
 *
 * Without weights such a point is a duplicate, and insertion has named its vertex. With weights the point that hid it may
 * have been hidden later, and a vertex at its place may have come after it. So each such point is located in the finished
 * triangulation. A point at the place of a vertex is a duplicate; any other point is hidden, and descent finds its vertex
 * of least power distance. The apex of points on a line is skipped: the edges along the line suffice. */
#include "plane/plane_represent.h"
#include "base/memory.h"
#include "base/sort.h"
#include "plane/plane_nearest.h"
#include <assert.h>

typedef struct {
    brio_plane_store *store;
    brio_plane_view view;
    uint32_t *corner; /* a triangle of each vertex */
    uint32_t *hidden;
    size_t num_hidden;
} workspace;

/* Finds a triangle of each vertex. Overwrites slots without a triangle: they have no vertices. */
static void find_corners(workspace *w) {
    brio_plane_store *s = w->store;
    for (size_t i = 0; i < s->unused.count; i++)
        for (int k = 0; k < 3; k++) s->triangle[s->unused.item[i]].vertex[k] = s->infinite;
    for (size_t t = 0; t < s->count; t++)
        for (int k = 0; k < 3; k++) w->corner[s->triangle[t].vertex[k]] = (uint32_t)t;
}

static void represent_one(workspace *w, uint32_t p) {
    brio_plane_store *s = w->store;
    const double *x = s->record[p];
    uint32_t start = w->corner[brio_plane_alive(s, p)];
    uint32_t t = brio_plane_walk(&w->view, &s->filter, start, x, &s->stats.walk_steps);
    assert(t < s->count && start < s->count);
    const uint32_t *v = s->triangle[t].vertex;
    for (int i = 0; i < 3; i++)
        if (v[i] < s->num_points && brio_same_place(s->record[v[i]], x)) {
            s->representative[p] = v[i];
            s->stats.duplicates++;
            return;
        }
    brio_plane_nearest nearest = {&w->view, &s->filter, s->num_points, w->corner};
    s->representative[p] = brio_plane_nearest_vertex(&nearest, t, x);
    assert(s->representative[p] < s->num_points);
    w->hidden[w->num_hidden++] = p;
}

static int compare_places(uint32_t p, uint32_t q, const void *user) {
    const brio_plane_store *s = user;
    return brio_plane_lexicographic(&s->filter, s->record[p], s->record[q]);
}

/* Counts hidden points at one place once. */
static void count_hidden(workspace *w) {
    brio_plane_store *s = w->store;
    brio_sort_indices(w->hidden, w->num_hidden, compare_places, s);
    for (size_t i = 0; i < w->num_hidden; i++) {
        bool again = i > 0 && brio_same_place(s->record[w->hidden[i - 1]], s->record[w->hidden[i]]);
        if (again)
            s->stats.duplicates++;
        else
            s->stats.hidden++;
    }
}

static brio_status represent_weighted(brio_plane_store *s) {
    workspace w = {s, {s->triangle, (const brio_plane_record *)s->record, s->infinite}, NULL, NULL, 0};
    brio_status status = BRIO_OK;
    size_t not_vertices = 0;
    for (uint32_t p = 0; p < s->num_points; p++) not_vertices += s->representative[p] != p;
    if (!not_vertices) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(s->ctx, w.hidden, not_vertices));
    BRIO_TRY(BRIO_ALLOC(s->ctx, w.corner, s->num_points + 2));
    find_corners(&w);
    for (uint32_t p = 0; p < s->num_points; p++)
        if (s->representative[p] != p) represent_one(&w, p);
    count_hidden(&w);
done:
    brio_release(s->ctx, w.corner);
    brio_release(s->ctx, w.hidden);
    return status;
}

/* Represents points that are all at one place: the heaviest represents the others; among equal weights, the one with the
 * lowest index. */
static void represent_coincident(brio_plane_store *s) {
    uint32_t best = 0;
    for (uint32_t p = 1; p < s->num_points; p++) {
        double more = s->record[p][3] - s->record[best][3];
        if (more > 0 || (more == 0 && s->caller[p] < s->caller[best])) best = p;
    }
    for (uint32_t p = 0; p < s->num_points; p++) s->representative[p] = best;
    s->stats.duplicates = s->num_points - 1;
}

brio_status brio_plane_represent(brio_plane_store *s) {
    brio_status status = BRIO_OK;
    if (s->dimension == 0)
        represent_coincident(s);
    else if (s->weighted && s->dimension > 0)
        status = represent_weighted(s);
    else
        for (uint32_t p = 0; p < s->num_points; p++) s->stats.duplicates += s->representative[p] != p;
    assert(s->stats.duplicates + s->stats.hidden <= s->num_points);
    s->stats.vertices = s->num_points - s->stats.duplicates - s->stats.hidden;
    return status;
}
