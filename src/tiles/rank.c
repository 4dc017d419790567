/* The checksum: ranks of vertices in lexicographic order, by a merge of the sorted vertices of all tiles.
 *
 * Each tile's vertices are sorted in memory and written as a run. All runs are read side by side, a heap tells which
 * vertex is next, and its rank is appended to a file beside its run. Each tile then brings its ranks to its places, so
 * that the ranks of vertices of other tiles are read by place.
 *
 * Based on: Aggarwal, Vitter. The input/output complexity of sorting and related problems. CACM 1988. */
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "base/team.h"
#include "tiles/work.h"
#include "triangulation/triangulation.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { AT_ONCE = 1 << 11, LEAST_AT_ONCE = 1 << 5, ALL_AT_ONCE = 1 << 20 }; /* vertices of runs. Chosen */
enum { HASHES_A_THREAD = 1 << 14 };

/* A vertex of a run. */
typedef struct {
    double x[3];
    uint64_t offset; /* of its place in the tile */
} run_vertex;

typedef struct {
    brio_store_file in, out;
    run_vertex *vertex; /* those at hand */
    size_t at, count, room;
    uint64_t read; /* of the run, up to those at hand included */
    uint64_t *rank;
    size_t num_ranks;
} run;

/* --- runs --- */

static int compare_points(uint32_t i, uint32_t j, const void *user) {
    const brio_set_point *p = user;
    return brio_lexicographic(p[i].record, p[j].record);
}

static brio_status append_run(brio_store_file *f, const brio_set_point *points, const uint32_t *row, size_t n) {
    run_vertex some[AT_ONCE / 4];
    size_t k = 0;
    for (size_t i = 0; i < n; i++) {
        memcpy(some[k].x, points[row[i]].record, sizeof some[k].x);
        some[k++].offset = row[i];
        if (k < AT_ONCE / 4 && i + 1 < n) continue;
        BRIO_FORWARD(brio_store_append(f, some, k * sizeof *some));
        k = 0;
    }
    return BRIO_OK;
}

/* Writes the vertices of a tile in lexicographic order. */
static brio_status write_run(brio_tiles *t, uint32_t tile) {
    const brio_tile *facts = &t->tile[tile];
    brio_tile_result result = {0};
    brio_set_point *points = NULL;
    uint32_t *row = NULL;
    brio_store_file f = {.file = -1};
    brio_status status = BRIO_OK;
    size_t n = 0;
    char name[32];
    snprintf(name, sizeof name, "run-%u", tile);
    BRIO_TRY(brio_store_create(&t->folder, name, &f));
    BRIO_TRY(brio_tile_result_read(t, tile, false, &result));
    BRIO_TRY(BRIO_ALLOC(t->ctx, points, facts->points + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, row, facts->points + 1));
    BRIO_TRY(brio_tile_points(t, facts->place, facts->points, points));
    for (uint32_t i = 0; i < facts->points; i++)
        if (result.is_vertex[i]) row[n++] = i;
    BRIO_TRY(brio_sort_rows(t->ctx, &(brio_row_order){points->record, 5, compare_points, points}, row, n));
    status = append_run(&f, points, row, n);
done:
    brio_store_close(&f);
    brio_tile_result_free(t, &result);
    brio_release(t->ctx, points);
    brio_release(t->ctx, row);
    return status;
}

/* --- merge --- */

static brio_status next_vertices(const brio_tiles *t, uint32_t tile, run *r) {
    uint64_t left = t->tile[tile].vertices - r->read;
    r->at = 0;
    r->count = left < r->room ? (size_t)left : r->room;
    BRIO_FORWARD(brio_store_read(&r->in, r->read * sizeof *r->vertex, r->vertex, r->count * sizeof *r->vertex));
    r->read += r->count;
    return BRIO_OK;
}

static brio_status flush_ranks(run *r) {
    brio_status status = brio_store_append(&r->out, r->rank, r->num_ranks * sizeof *r->rank);
    r->num_ranks = 0;
    return status;
}

static bool comes_first(const run *runs, uint32_t a, uint32_t b) {
    return brio_lexicographic(runs[a].vertex[runs[a].at].x, runs[b].vertex[runs[b].at].x) < 0;
}

static void sift(const run *runs, uint32_t *heap, size_t n, size_t root) {
    uint32_t moved = heap[root];
    for (size_t child; (child = 2 * root + 1) < n; root = child) {
        if (child + 1 < n && comes_first(runs, heap[child + 1], heap[child])) child++;
        if (!comes_first(runs, heap[child], moved)) break;
        heap[root] = heap[child];
    }
    heap[root] = moved;
}

static brio_status merge_heap(brio_tiles *t, run *runs, uint32_t *heap, size_t n) {
    uint64_t rank = 0;
    for (size_t i = n / 2; i-- > 0;) sift(runs, heap, n, i);
    while (n > 0) {
        run *r = &runs[heap[0]];
        r->rank[r->num_ranks++] = rank++;
        if (r->num_ranks == r->room) BRIO_FORWARD(flush_ranks(r));
        if (++r->at == r->count) BRIO_FORWARD(next_vertices(t, heap[0], r));
        if (!r->count) heap[0] = heap[--n];
        if (n) sift(runs, heap, n, 0);
        if (rank % (1 << 16) == 0)
            BRIO_FORWARD(brio_progress(t->ctx, "rank", 0.4 + 0.3 * (double)rank / (double)t->stats.vertices));
    }
    return BRIO_OK;
}

static void free_runs(brio_tiles *t, run *runs) {
    for (uint32_t i = 0; runs && i < t->num_tiles; i++) {
        brio_store_close(&runs[i].in);
        brio_store_close(&runs[i].out);
        brio_release(t->ctx, runs[i].vertex);
        brio_release(t->ctx, runs[i].rank);
    }
    brio_release(t->ctx, runs);
}

/* Returns how many vertices of each run are at hand, and ranks wait for its file. */
static size_t room_of_run(const brio_context *ctx, size_t runs) {
    enum { SIZE = sizeof(run_vertex) + sizeof(uint64_t) };
    return brio_waiting_bytes(ctx, runs, LEAST_AT_ONCE * SIZE, AT_ONCE * SIZE, (size_t)ALL_AT_ONCE * SIZE) / SIZE;
}

double brio_tiles_merge_bytes(const brio_context *ctx, size_t runs) {
    size_t rows = room_of_run(ctx, runs) * (sizeof(run_vertex) + sizeof(uint64_t));
    return (double)runs * (double)(sizeof(run) + sizeof(uint32_t) + rows + 2 * BRIO_BLOCK_HEADER);
}

/* Opens a tile's run, and the file of its ranks. */
static brio_status open_run(brio_tiles *t, uint32_t tile, run *r) {
    char name[32];
    r->room = room_of_run(t->ctx, t->num_tiles);
    snprintf(name, sizeof name, "run-%u", tile);
    BRIO_FORWARD(brio_store_open(&t->folder, name, &r->in));
    brio_store_shut(&r->in);
    snprintf(name, sizeof name, "ranked-%u", tile);
    BRIO_FORWARD(brio_store_create(&t->folder, name, &r->out));
    brio_store_shut(&r->out);
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, r->vertex, r->room));
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, r->rank, r->room));
    return next_vertices(t, tile, r);
}

static brio_status merge_runs(brio_tiles *t) {
    run *runs = NULL;
    uint32_t *heap = NULL;
    brio_status status = BRIO_OK;
    size_t n = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, runs, t->num_tiles));
    for (uint32_t i = 0; i < t->num_tiles; i++) runs[i].in.file = runs[i].out.file = -1;
    BRIO_TRY(BRIO_ALLOC(t->ctx, heap, t->num_tiles));
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        if (!t->tile[i].vertices) continue;
        BRIO_TRY(open_run(t, i, &runs[i]));
        heap[n++] = i;
    }
    BRIO_TRY(merge_heap(t, runs, heap, n));
    for (uint32_t i = 0; i < t->num_tiles; i++)
        if (t->tile[i].vertices) BRIO_TRY(flush_ranks(&runs[i]));
done:
    free_runs(t, runs);
    brio_release(t->ctx, heap);
    return status;
}

/* --- ranks by place --- */

/* Appends the ranks of a tile's points to the file of ranks: of points that are no vertices, UINT64_MAX. */
static brio_status place_ranks(brio_tiles *t, uint32_t tile, brio_store_file *ranks) {
    const brio_tile *facts = &t->tile[tile];
    brio_store_file in = {.file = -1}, from = {.file = -1};
    run_vertex some[AT_ONCE / 8];
    uint64_t rank[AT_ONCE / 8], *placed = NULL;
    brio_status status = BRIO_OK;
    char name[32];
    BRIO_TRY(BRIO_ALLOC(t->ctx, placed, facts->points + 1));
    memset(placed, 0xff, facts->points * sizeof *placed);
    if (facts->vertices) {
        snprintf(name, sizeof name, "run-%u", tile);
        BRIO_TRY(brio_store_open(&t->folder, name, &in));
        snprintf(name, sizeof name, "ranked-%u", tile);
        BRIO_TRY(brio_store_open(&t->folder, name, &from));
    }
    for (uint64_t v = 0; v < facts->vertices; v += AT_ONCE / 8) {
        size_t n = facts->vertices - v < AT_ONCE / 8 ? (size_t)(facts->vertices - v) : AT_ONCE / 8;
        BRIO_TRY(brio_store_read(&in, v * sizeof *some, some, n * sizeof *some));
        BRIO_TRY(brio_store_read(&from, v * sizeof *rank, rank, n * sizeof *rank));
        for (size_t i = 0; i < n; i++) {
            BRIO_REQUIRE(t->ctx, some[i].offset < facts->points, BRIO_ERR_OPEN, "%s/run-%u was changed from outside",
                         t->folder.path, tile);
            placed[some[i].offset] = rank[i];
        }
        BRIO_TRY(brio_look(t->ctx, n));
    }
    BRIO_TRY(brio_store_append(ranks, placed, facts->points * sizeof *placed));
done:
    brio_store_close(&in);
    brio_store_close(&from);
    snprintf(name, sizeof name, "run-%u", tile);
    brio_store_remove(&t->folder, name);
    snprintf(name, sizeof name, "ranked-%u", tile);
    brio_store_remove(&t->folder, name);
    brio_release(t->ctx, placed);
    return status;
}

static brio_status rank_vertices(brio_tiles *t) {
    brio_store_file ranks = {.file = -1};
    brio_status status = BRIO_OK;
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        BRIO_TRY(brio_progress(t->ctx, "rank", 0.4 * i / t->num_tiles));
        BRIO_TRY(write_run(t, i));
    }
    BRIO_TRY(merge_runs(t));
    BRIO_TRY(brio_store_create(&t->folder, "ranks", &ranks));
    for (uint32_t i = 0; i < t->num_tiles; i++) BRIO_TRY(place_ranks(t, i, &ranks));
    t->has_ranks = true;
done:
    brio_store_close(&ranks);
    return status;
}

/* --- sums --- */

static int compare_places(uint32_t i, uint32_t j, const void *user) {
    const uint64_t *place = user;
    return place[i] < place[j] ? -1 : place[i] > place[j];
}

/* Reads the ranks of a tile's points, and behind them those of its halo. */
static brio_status read_ranks(brio_tiles *t, uint32_t tile, const brio_tile_result *result, uint64_t *rank) {
    const brio_tile *facts = &t->tile[tile];
    brio_store_file ranks = {.file = -1};
    uint32_t *order = NULL;
    uint64_t *place = NULL, *found = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_store_open(&t->folder, "ranks", &ranks));
    BRIO_TRY(brio_store_read(&ranks, facts->place * sizeof *rank, rank, facts->points * sizeof *rank));
    BRIO_TRY(BRIO_ALLOC(t->ctx, order, facts->halo + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, place, facts->halo + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, found, facts->halo + 1));
    for (uint32_t i = 0; i < facts->halo; i++) order[i] = i;
    BRIO_TRY(brio_sort_many_indices(t->ctx, order, facts->halo, compare_places, result->halo));
    for (size_t i = 0; i < facts->halo; i++) place[i] = result->halo[order[i]];
    BRIO_TRY(brio_tile_rows(&ranks, place, facts->halo, sizeof *found, found));
    for (size_t i = 0; i < facts->halo; i++) rank[facts->points + order[i]] = found[i];
done:
    brio_store_close(&ranks);
    brio_release(t->ctx, order);
    brio_release(t->ctx, place);
    brio_release(t->ctx, found);
    return status;
}

typedef struct {
    const brio_tile_result *result;
    const uint64_t *rank;
    size_t num_ranks;
    uint64_t sum;  /* atomic */
    int is_broken; /* atomic */
} hashing;

static void hash_some(void *user, size_t begin, size_t end, int thread) {
    hashing *h = user;
    uint64_t sum = 0;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        const uint32_t *v = h->result->tetrahedra[i];
        uint64_t r[4];
        for (int k = 0; k < 4; k++) {
            if (v[k] >= h->num_ranks) {
                __atomic_store_n(&h->is_broken, 1, __ATOMIC_RELAXED);
                return;
            }
            r[k] = h->rank[v[k]];
        }
        sum += brio_tetrahedron_hash(r);
    }
    __atomic_add_fetch(&h->sum, sum, __ATOMIC_RELAXED);
}

static brio_status add_hashes(brio_tiles *t, uint32_t tile, uint64_t *sum) {
    const brio_tile *facts = &t->tile[tile];
    brio_tile_result result = {0};
    uint64_t *rank = NULL;
    brio_status status = BRIO_OK;
    size_t n = facts->points + facts->halo;
    BRIO_TRY(brio_tile_result_read(t, tile, true, &result));
    BRIO_TRY(BRIO_ALLOC(t->ctx, rank, n + 1));
    BRIO_TRY(read_ranks(t, tile, &result, rank));
    hashing h = {.result = &result, .rank = rank, .num_ranks = n};
    int threads = brio_threads(t->ctx, facts->tetrahedra, HASHES_A_THREAD);
    BRIO_TRY(brio_for(t->ctx, threads, facts->tetrahedra, hash_some, &h));
    BRIO_REQUIRE(t->ctx, !h.is_broken, BRIO_ERR_OPEN, "%s/tile-%u was changed from outside", t->folder.path, tile);
    *sum += h.sum;
done:
    brio_tile_result_free(t, &result);
    brio_release(t->ctx, rank);
    return status;
}

brio_status brio_tiles_sum(brio_tiles *t, uint64_t *checksum) {
    uint64_t sum = brio_mix(t->stats.vertices);
    if (t->stats.dimension < 3) {
        *checksum = sum;
        return BRIO_OK;
    }
    if (!t->has_ranks) BRIO_FORWARD(rank_vertices(t));
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        BRIO_FORWARD(brio_progress(t->ctx, "checksum", 0.7 + 0.3 * i / t->num_tiles));
        if (t->tile[i].points) BRIO_FORWARD(add_hashes(t, i, &sum));
    }
    *checksum = sum;
    return BRIO_OK;
}
