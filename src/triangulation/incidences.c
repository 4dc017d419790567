/* Neighbourhoods of the vertices of a finished triangulation, as arrays: a tetrahedron of each vertex, all tetrahedra
 * of each vertex, all neighbours of each vertex, all edges.
 *
 * The tetrahedra of the vertices are sorted by counting. The neighbours of a vertex are the vertices of its tetrahedra,
 * sorted, each once; threads divide the vertices. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "triangulation/triangulation.h"
#include <assert.h>

/* VERTICES_A_THREAD, GROUP (vertices between two reports of progress): chosen. */
enum { VERTICES_A_THREAD = 1 << 12, VERTICES_A_CHUNK = 256, GROUP = 1 << 16 };

void brio_triangulation_vertex_tetrahedra(const brio_triangulation *t, uint32_t *tetrahedra) {
    BRIO_DOOR;
    for (size_t p = 0; p < t->stats.points; p++) tetrahedra[p] = BRIO_INFINITE;
    for (size_t i = t->stats.tetrahedra; i-- > 0;)
        for (int k = 0; k < 4; k++) tetrahedra[t->tet[i].vertex[k]] = (uint32_t)i;
}

void brio_edges_free(brio_edges *edges) {
    if (!edges || !edges->context) return;
    brio_release(edges->context, edges->ends);
    *edges = (brio_edges){0};
}

void brio_incidences_free(brio_incidences *incidences) {
    if (!incidences || !incidences->context) return;
    brio_release(incidences->context, incidences->offsets);
    brio_release(incidences->context, incidences->items);
    *incidences = (brio_incidences){0};
}

/* Turns offsets[p + 1] from the length of list p into its end. */
static void add_up(brio_incidences *lists) {
    assert(lists->offsets[0] == 0);
    for (size_t p = 0; p < lists->count; p++) lists->offsets[p + 1] += lists->offsets[p];
}

/* --- tetrahedra --- */

static brio_status list_tetrahedra(brio_context *ctx, const brio_triangulation *t, brio_incidences *out) {
    brio_status status = BRIO_OK;
    size_t n = t->stats.points;
    *out = (brio_incidences){.count = n, .context = ctx};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->offsets, n + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, out->items, 4 * t->stats.tetrahedra));
    for (size_t i = 0; i < 4 * t->stats.tetrahedra; i++) out->offsets[t->tet[i / 4].vertex[i % 4] + 1]++;
    add_up(out);
    for (size_t i = 0; i < 4 * t->stats.tetrahedra; i++)
        out->items[out->offsets[t->tet[i / 4].vertex[i % 4]]++] = (uint32_t)(i / 4);
    for (size_t p = n; p > 0; p--) out->offsets[p] = out->offsets[p - 1]; /* each offset moved to its list's end */
    assert(out->offsets[n] == 4 * t->stats.tetrahedra);
    out->offsets[0] = 0;
done:
    if (status != BRIO_OK) brio_incidences_free(out);
    return status;
}

brio_status brio_triangulation_incident_tetrahedra(brio_context *ctx, const brio_triangulation *t,
                                                   brio_incidences *out) {
    BRIO_DOOR;
    return list_tetrahedra(ctx, t, out);
}

/* --- neighbours --- */

typedef struct {
    const brio_triangulation *t;
    const brio_incidences *tets;
    brio_incidences *out;
    uint64_t *key; /* of each thread, `room` keys */
    size_t room;
    size_t first; /* vertex of the group that is done */
} neighbour_job;

/* Writes the neighbours of a point to key, in ascending order. Returns their number. */
static size_t sort_neighbours(const neighbour_job *job, size_t p, uint64_t *key) {
    size_t count = 0, distinct = 0;
    for (uint64_t i = job->tets->offsets[p]; i < job->tets->offsets[p + 1]; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t v = job->t->tet[job->tets->items[i]].vertex[k];
            if (v != p) key[count++] = v;
        }
    assert(count <= job->room);
    brio_sort_keys(key, count);
    for (size_t i = 0; i < count; i++)
        if (i == 0 || key[i] != key[i - 1]) key[distinct++] = key[i];
    return distinct;
}

static void count_neighbours(void *user, size_t begin, size_t end, int thread) {
    const neighbour_job *job = user;
    for (size_t p = job->first + begin; p < job->first + end; p++)
        job->out->offsets[p + 1] = sort_neighbours(job, p, job->key + job->room * (size_t)thread);
}

static void write_neighbours(void *user, size_t begin, size_t end, int thread) {
    const neighbour_job *job = user;
    uint64_t *key = job->key + job->room * (size_t)thread;
    for (size_t p = job->first + begin; p < job->first + end; p++) {
        size_t count = sort_neighbours(job, p, key);
        assert(job->out->offsets[p] + count == job->out->offsets[p + 1]); /* as it was counted */
        for (size_t i = 0; i < count; i++) job->out->items[job->out->offsets[p] + i] = (uint32_t)key[i];
    }
}

static size_t longest_list(const brio_incidences *lists) {
    uint64_t longest = 0;
    for (size_t p = 0; p < lists->count; p++) {
        uint64_t length = lists->offsets[p + 1] - lists->offsets[p];
        longest = length > longest ? length : longest;
    }
    return (size_t)longest;
}

/* Does all vertices, a group at a time. */
static brio_status for_all(brio_context *ctx, neighbour_job *job, int threads, brio_part_fn part) {
    size_t n = job->out->count;
    for (job->first = 0; job->first < n; job->first += GROUP) {
        size_t count = n - job->first < GROUP ? n - job->first : GROUP;
        BRIO_FORWARD(brio_for_chunks(ctx, threads, count, VERTICES_A_CHUNK, part, job));
        BRIO_FORWARD(brio_progress(ctx, "neighbours", (double)(job->first + count) / (double)n));
    }
    return BRIO_OK;
}

static brio_status list_neighbours(brio_context *ctx, const brio_triangulation *t, brio_incidences *out) {
    brio_status status = BRIO_OK;
    brio_incidences tets = {0};
    size_t n = t->stats.points;
    int threads = brio_threads(ctx, n, VERTICES_A_THREAD);
    brio_bar bar = brio_progress_bar(ctx);
    neighbour_job job = {.t = t, .tets = &tets, .out = out};
    *out = (brio_incidences){.count = n, .context = ctx};
    BRIO_TRY(list_tetrahedra(ctx, t, &tets));
    job.room = 3 * longest_list(&tets);
    BRIO_TRY(BRIO_ALLOC(ctx, job.key, job.room * (size_t)threads));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->offsets, n + 1));
    brio_progress_part(ctx, bar, 0.1, 0.5);
    BRIO_TRY(for_all(ctx, &job, threads, count_neighbours));
    add_up(out);
    BRIO_TRY(BRIO_ALLOC(ctx, out->items, (size_t)out->offsets[n]));
    brio_progress_part(ctx, bar, 0.5, 1);
    BRIO_TRY(for_all(ctx, &job, threads, write_neighbours));
done:
    brio_progress_part(ctx, bar, 0, 1);
    brio_incidences_free(&tets);
    brio_release(ctx, job.key);
    if (status != BRIO_OK) brio_incidences_free(out);
    return status;
}

brio_status brio_triangulation_neighbours(brio_context *ctx, const brio_triangulation *t, brio_incidences *out) {
    BRIO_DOOR;
    return list_neighbours(ctx, t, out);
}

/* --- edges --- */

brio_status brio_triangulation_edges(brio_context *ctx, const brio_triangulation *t, brio_edges *out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_incidences lists = {0};
    *out = (brio_edges){.context = ctx};
    BRIO_TRY(list_neighbours(ctx, t, &lists));
    BRIO_TRY(BRIO_ALLOC(ctx, out->ends, (size_t)lists.offsets[lists.count])); /* each edge is in two lists */
    for (size_t p = 0; p < lists.count; p++)
        for (uint64_t i = lists.offsets[p]; i < lists.offsets[p + 1]; i++) {
            if (lists.items[i] < p) continue;
            out->ends[2 * out->count] = (uint32_t)p;
            out->ends[2 * out->count++ + 1] = lists.items[i];
        }
    assert(2 * out->count == lists.offsets[lists.count]);
done:
    brio_incidences_free(&lists);
    return status;
}
