/* The tetrahedra of one tile for the caller: their vertices, with positions and indices. In the tile's file their order
 * depends on the threads, and that of the halo on the rounds in which its points were found. Here vertices are numbered
 * by their places, and tetrahedra are turned by these numbers and sorted by the first three, which no two of them share
 * in this order, for they are positive. So a part depends on the points and the tiles alone. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/versioned.h"
#include "tiles/work.h"
#include "triangulation/canonical_turn.h"
#include <string.h>

static int compare_places(uint32_t i, uint32_t j, const void *user) {
    const uint64_t *place = user;
    return place[i] < place[j] ? -1 : place[i] > place[j];
}

/* Reads the points of the halo, as a brio_halo_fn. */
static brio_status read_halo(void *user, const uint64_t *halo, size_t n, brio_set_point *points) {
    brio_tiles *t = user;
    brio_store_file f = {.file = -1};
    uint32_t *order = NULL;
    uint64_t *place = NULL;
    brio_set_point *sorted = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_store_open(&t->folder, "points", &f));
    BRIO_TRY(BRIO_ALLOC(t->ctx, order, n + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, place, n + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, sorted, n + 1));
    for (uint32_t i = 0; i < n; i++) order[i] = i;
    BRIO_TRY(brio_sort_many_indices(t->ctx, order, n, compare_places, halo));
    for (size_t i = 0; i < n; i++) place[i] = halo[order[i]] - t->first_place;
    BRIO_TRY(brio_tile_rows(&f, place, n, sizeof *sorted, sorted));
    for (size_t i = 0; i < n; i++) points[order[i]] = sorted[i];
done:
    brio_store_close(&f);
    brio_release(t->ctx, order);
    brio_release(t->ctx, place);
    brio_release(t->ctx, sorted);
    return status;
}

brio_halo_reader brio_tile_own_halo(brio_tiles *t) {
    return (brio_halo_reader){read_halo, t};
}

/* Marks the rows of the vertices, and lists those of the halo by their places.   *count  receives their number. */
static brio_status list_vertices(brio_context *ctx, const brio_tile_result *r, const brio_tile *facts, uint32_t *number,
                                 uint32_t *listed, size_t *count) {
    memset(number, 0, (facts->points + facts->halo) * sizeof *number);
    for (size_t i = 0; i < facts->tetrahedra; i++)
        for (int k = 0; k < 4; k++) number[r->tetrahedra[i][k]] = 1;
    *count = 0;
    for (uint32_t i = 0; i < facts->halo; i++)
        if (number[facts->points + i]) listed[(*count)++] = i;
    return brio_sort_many_indices(ctx, listed, *count, compare_places, r->halo);
}

/* Gives the vertices of the tetrahedra consecutive numbers, in the order of their places, and turns each tetrahedron by
 * them. In which round a point was found has no trace then. */
static brio_status number_vertices(brio_context *ctx, brio_tile_result *r, const brio_tile *facts, uint32_t *number,
                                   size_t *used) {
    uint32_t *listed = NULL;
    size_t count = 0;
    brio_status status = BRIO_OK;
    *used = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, listed, facts->halo + 1));
    BRIO_TRY(list_vertices(ctx, r, facts, number, listed, &count));
    for (size_t p = 0; p < facts->points; p++) number[p] = number[p] ? (uint32_t)(*used)++ : UINT32_MAX;
    for (size_t i = 0; i < facts->halo; i++) number[facts->points + i] = UINT32_MAX;
    for (size_t i = 0; i < count; i++) number[facts->points + listed[i]] = (uint32_t)(*used)++;
    for (size_t i = 0; i < facts->tetrahedra; i++) {
        uint32_t v[4];
        uint8_t turn;
        for (int k = 0; k < 4; k++) v[k] = number[r->tetrahedra[i][k]];
        brio_turn_key(v, BRIO_INFINITE, &turn);
        for (int k = 0; k < 4; k++) r->tetrahedra[i][k] = v[BRIO_TURNED[turn][k]];
    }
done:
    brio_release(ctx, listed);
    return status;
}

/* The tetrahedra of one first vertex while they are sorted. */
typedef struct {
    uint64_t *key;
    uint32_t *row, *sorted;
    size_t capacity[3];
} bucket;

/* Writes the tetrahedra whose rows are listed in b->row by their second and third vertex. Returns false where two have
 * the same: then a row of few is listed nowhere, and the file is not what was written. */
static bool write_bucket(bucket *b, uint32_t (*from)[4], size_t n, uint32_t (*to)[4]) {
    for (size_t i = 0; i < n; i++) b->key[i] = (uint64_t)from[b->row[i]][1] << 32 | from[b->row[i]][2];
    memset(b->sorted, 0xff, n * sizeof *b->sorted);
    brio_sort_names(b->key, b->row, n, b->sorted);
    for (size_t i = 0; i < n; i++) {
        if (b->sorted[i] == UINT32_MAX) return false;
        memcpy(to[i], from[b->sorted[i]], sizeof *to);
    }
    return true;
}

static brio_status was_changed(const brio_tiles *t, uint32_t tile) {
    return brio_fail(t->ctx, BRIO_ERR_OPEN, "%s/tile-%u was changed from outside", t->folder.path, tile);
}

/* Sorts the tetrahedra of a part. */
static brio_status sort_tetrahedra(const brio_tiles *t, uint32_t tile, brio_tile_part *p) {
    brio_context *ctx = t->ctx;
    brio_status status = BRIO_OK;
    bucket b = {0};
    size_t n = p->num_tetrahedra;
    uint32_t(*sorted)[4] = NULL, *end = NULL, *order = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, sorted, n + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, order, n + 1));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, end, p->num_vertices + 1));
    for (size_t i = 0; i < n; i++) end[p->tetrahedra[i][0] + 1]++;
    for (size_t v = 0; v < p->num_vertices; v++) end[v + 1] += end[v]; /* where the next vertex begins */
    for (size_t i = 0; i < n; i++) order[end[p->tetrahedra[i][0]]++] = (uint32_t)i;
    for (size_t v = 0, begin = 0; v < p->num_vertices; begin = end[v++]) {
        size_t some = end[v] - begin;
        if (!some) continue;
        BRIO_TRY(BRIO_RESERVE(ctx, b.key, b.capacity[0], some));
        BRIO_TRY(BRIO_RESERVE(ctx, b.row, b.capacity[1], some));
        BRIO_TRY(BRIO_RESERVE(ctx, b.sorted, b.capacity[2], some));
        memcpy(b.row, order + begin, some * sizeof *b.row);
        if (!write_bucket(&b, p->tetrahedra, some, sorted + begin)) BRIO_TRY(was_changed(t, tile));
        BRIO_TRY(brio_look(ctx, some));
    }
    brio_release(ctx, p->tetrahedra);
    p->tetrahedra = sorted;
    sorted = NULL;
done:
    brio_release(ctx, sorted);
    brio_release(ctx, end);
    brio_release(ctx, order);
    brio_release(ctx, b.key);
    brio_release(ctx, b.row);
    brio_release(ctx, b.sorted);
    return status;
}

static brio_status fill(brio_tiles *t, const brio_set_point *points, const uint32_t *number, size_t n,
                        brio_tile_part *p) {
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, p->points, 3 * p->num_vertices + 1));
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, p->index, p->num_vertices + 1));
    if (t->weighted) BRIO_FORWARD(BRIO_ALLOC(t->ctx, p->weights, p->num_vertices + 1));
    for (size_t i = 0; i < n; i++) {
        size_t v = number[i];
        if (number[i] == UINT32_MAX) continue;
        memcpy(p->points + 3 * v, points[i].record, 3 * sizeof *p->points);
        p->index[v] = points[i].name;
        if (t->weighted) p->weights[v] = points[i].record[3];
    }
    return BRIO_OK;
}

brio_status brio_tile_part_make(brio_tiles *t, uint32_t tile, const brio_halo_reader *halo, brio_tile_part *p) {
    const brio_tile *facts = &t->tile[tile];
    brio_tile_result result = {0};
    brio_set_point *points = NULL;
    uint32_t *number = NULL;
    brio_status status = BRIO_OK;
    size_t n = facts->points + facts->halo;
    if (!facts->tetrahedra) return BRIO_OK;
    BRIO_TRY(brio_tile_result_read(t, tile, true, &result));
    for (size_t i = 0; i < facts->tetrahedra; i++)
        for (int k = 0; k < 4; k++)
            if (result.tetrahedra[i][k] >= n) BRIO_TRY(was_changed(t, tile));
    BRIO_TRY(BRIO_ALLOC(t->ctx, points, n + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, number, n + 1));
    BRIO_TRY(brio_tile_points(t, facts->place, facts->points, points));
    BRIO_TRY(halo->read(halo->user, result.halo, facts->halo, points + facts->points));
    p->num_tetrahedra = facts->tetrahedra;
    BRIO_TRY(number_vertices(t->ctx, &result, facts, number, &p->num_vertices));
    BRIO_TRY(fill(t, points, number, n, p));
    p->tetrahedra = result.tetrahedra;
    result.tetrahedra = NULL;
    status = sort_tetrahedra(t, tile, p);
done:
    brio_tile_result_free(t, &result);
    brio_release(t->ctx, points);
    brio_release(t->ctx, number);
    return status;
}

brio_status brio_tiles_part(brio_context *ctx, brio_tiles *t, uint32_t tile, brio_tile_part *out) {
    BRIO_DOOR;
    brio_tile_part p = {.size = sizeof p};
    BRIO_FORWARD(BRIO_CHECK_RESULT(ctx, brio_tile_part, out));
    BRIO_EXPECT(ctx, ctx == t->ctx, BRIO_ERR_ARGUMENT, "the tiles are of another context");
    BRIO_EXPECT(ctx, t->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    BRIO_EXPECT(ctx, tile < t->num_tiles, BRIO_ERR_ARGUMENT, "tile %u of %u", tile, t->num_tiles);
    brio_halo_reader halo = brio_tile_own_halo(t);
    brio_status status = brio_tile_part_make(t, tile, &halo, &p);
    if (status != BRIO_OK)
        brio_tile_part_free(ctx, &p);
    else
        BRIO_GIVE(brio_tile_part, out, &p);
    return status;
}

void brio_tile_part_free(brio_context *ctx, brio_tile_part *part) {
    brio_release(ctx, part->points);
    brio_release(ctx, part->weights);
    brio_release(ctx, part->index);
    brio_release(ctx, part->tetrahedra);
    part->points = part->weights = NULL, part->index = NULL, part->tetrahedra = NULL;
    part->num_vertices = part->num_tetrahedra = 0;
}
