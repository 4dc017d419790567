/* The checksum: ranks of vertices by a sort of all ranks, then the hashes of each rank's tetrahedra.
 *
 * Splitters divide the positions, in lexicographic order, into a part for each rank. Vertices go to the rank of their
 * part, are sorted there, and their ranks come back.
 *
 * Based on: Frazer, McKellar. Samplesort: a sampling approach to minimal storage tree sorting. JACM 1970. */
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "ranks/work.h"
#include "triangulation/triangulation.h"
#include <string.h>

/* --- rows of other ranks --- */

brio_status brio_ranks_rows(brio_ranks *r, const uint64_t *places, size_t n, brio_answer_fn answer, size_t size,
                            void *rows) {
    brio_exchange *x = &r->x;
    void *room;
    size_t *next = NULL;
    brio_status status = BRIO_OK;
    for (size_t i = 0; i < n; i++)
        BRIO_TRY(brio_exchange_put(x, brio_rank_of_place(places[i]), &places[i], sizeof places[i]));
    BRIO_TRY(brio_exchange_now(x, false));
    for (int i = 0; i < r->ranks; i++) {
        const brio_letter *m = &x->received[i];
        size_t asked = m->size / sizeof *places;
        if (!asked) continue;
        BRIO_TRY(brio_exchange_room(x, m->rank, asked * size, &room));
        BRIO_TRY(answer(r, m->bytes, asked, room));
    }
    BRIO_TRY(brio_exchange_now(x, false));
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, next, r->ranks));
    for (size_t i = 0; i < n; i++) {
        int from = brio_rank_of_place(places[i]);
        memcpy((char *)rows + i * size, (const char *)x->from[from]->bytes + size * next[from]++, size);
    }
done:
    brio_release(r->ctx, next);
    return status;
}

/* --- ranks of vertices --- */

static int part_of(const brio_ranks *r, const double *position) {
    int low = 0, high = r->ranks - 1; /* the number of splitters that are not above it */
    while (low < high) {
        int middle = (low + high) / 2;
        if (brio_lexicographic(r->splitter[middle], position) <= 0)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

static brio_status put_vertices(brio_ranks *r, uint32_t tile) {
    const brio_tile *facts = &r->t->tile[tile];
    brio_tile_result result = {0};
    brio_set_point *points = NULL;
    brio_status status = BRIO_OK;
    if (!facts->points) return BRIO_OK;
    BRIO_TRY(brio_tile_result_read(r->t, tile, false, &result));
    BRIO_TRY(BRIO_ALLOC(r->ctx, points, facts->points + 1));
    BRIO_TRY(brio_tile_points(r->t, facts->place, facts->points, points));
    for (uint32_t i = 0; i < facts->points; i++) {
        if (!result.is_vertex[i]) continue;
        points[i].name = facts->place + i;
        BRIO_TRY(brio_exchange_put(&r->x, part_of(r, points[i].record), &points[i], sizeof *points));
    }
done:
    brio_tile_result_free(r->t, &result);
    brio_release(r->ctx, points);
    return status;
}

/* Brings the vertices of this rank's part together. */
static brio_status gather_part(brio_ranks *r, brio_found *part) {
    for (uint32_t i = 0; i < r->t->num_tiles; i++) {
        BRIO_FORWARD(put_vertices(r, i));
        BRIO_FORWARD(brio_exchange_now(&r->x, false));
        for (int k = 0; k < r->ranks; k++) {
            const brio_letter *m = r->x.from[k];
            size_t n = m->size / sizeof *part->point;
            BRIO_FORWARD(BRIO_RESERVE(r->ctx, part->point, part->capacity, part->count + n));
            if (n) memcpy(part->point + part->count, m->bytes, m->size);
            part->count += n;
        }
    }
    return BRIO_OK;
}

static int compare_points(uint32_t i, uint32_t j, const void *user) {
    const brio_set_point *p = user;
    return brio_lexicographic(p[i].record, p[j].record);
}

static brio_status send_ranks(brio_ranks *r, const brio_found *part) {
    uint64_t below = 0, count = part->count;
    uint32_t *row = NULL;
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(r->ctx, count < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%llu vertices to sort on one rank: take more ranks",
                 (unsigned long long)count);
    BRIO_TRY(BRIO_ALLOC(r->ctx, row, count + 1));
    for (size_t i = 0; i < count; i++) row[i] = (uint32_t)i;
    if (count)
        BRIO_TRY(
            brio_sort_rows(r->ctx, &(brio_row_order){part->point->record, 5, compare_points, part->point}, row, count));
    BRIO_TRY(brio_exchange_all(&r->x, &count, sizeof count));
    for (int i = 0; i < r->rank; i++) below += *(const uint64_t *)r->x.from[i]->bytes;
    for (size_t i = 0; i < count; i++) {
        uint64_t pair[2] = {part->point[row[i]].name, below + i};
        BRIO_TRY(brio_exchange_put(&r->x, brio_rank_of_place(pair[0]), pair, sizeof pair));
    }
    status = brio_exchange_now(&r->x, false);
done:
    brio_release(r->ctx, row);
    return status;
}

static brio_status rank_vertices(brio_ranks *r) {
    brio_found part = {.ctx = r->ctx};
    brio_status status = BRIO_OK;
    uint64_t points = 0;
    for (uint32_t i = 0; i < r->t->num_tiles; i++) points += r->t->tile[i].points;
    brio_release(r->ctx, r->rank_of);
    r->rank_of = NULL;
    BRIO_TRY(gather_part(r, &part));
    BRIO_TRY(send_ranks(r, &part));
    BRIO_TRY(BRIO_ALLOC(r->ctx, r->rank_of, points + 1));
    for (int i = 0; i < r->ranks; i++) {
        const uint64_t *pair = r->x.from[i]->bytes;
        for (size_t k = 0; k < r->x.from[i]->size / 16; k++)
            r->rank_of[pair[2 * k] - r->t->first_place] = pair[2 * k + 1];
    }
done:
    brio_release(r->ctx, part.point);
    return status;
}

/* --- sums --- */

static brio_status answer_ranks(brio_ranks *r, const uint64_t *places, size_t n, void *rows) {
    uint64_t *rank = rows;
    for (size_t i = 0; i < n; i++) rank[i] = r->rank_of[places[i] - r->t->first_place];
    return BRIO_OK;
}

static brio_status add_hashes(brio_ranks *r, uint32_t tile, uint64_t *sum) {
    const brio_tile *facts = &r->t->tile[tile];
    const uint64_t *own = r->rank_of + (facts->place - r->t->first_place);
    brio_tile_result result = {0};
    uint64_t *halo = NULL, rank[4];
    brio_status status = BRIO_OK;
    if (facts->points) BRIO_TRY(brio_tile_result_read(r->t, tile, true, &result));
    BRIO_TRY(BRIO_ALLOC(r->ctx, halo, facts->halo + 1));
    BRIO_TRY(brio_ranks_rows(r, result.halo, facts->halo, answer_ranks, sizeof *halo, halo));
    for (size_t i = 0; i < facts->tetrahedra; i++) {
        for (int k = 0; k < 4; k++) {
            uint32_t v = result.tetrahedra[i][k];
            BRIO_REQUIRE(r->ctx, v < facts->points + facts->halo, BRIO_ERR_OPEN, "%s/tile-%u was changed from outside",
                         r->t->folder.path, tile);
            rank[k] = v < facts->points ? own[v] : halo[v - facts->points];
        }
        *sum += brio_tetrahedron_hash(rank);
        BRIO_TRY(brio_look(r->ctx, 1));
    }
done:
    brio_tile_result_free(r->t, &result);
    brio_release(r->ctx, halo);
    return status;
}

brio_status brio_ranks_sum(brio_ranks *r, uint64_t *checksum) {
    uint64_t sum = 0, all = brio_mix(r->facts.vertices);
    BRIO_EXPECT(r->ctx, r->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    if (r->facts.dimension == 3) {
        BRIO_FORWARD(brio_exchange_now(&r->x, !r->rank_of)); /* a call before may have failed on some ranks alone */
        if (r->x.any) BRIO_FORWARD(rank_vertices(r));
        for (uint32_t i = 0; i < r->t->num_tiles; i++) {
            BRIO_FORWARD(brio_progress(r->ctx, "checksum", 0.5 + 0.5 * i / r->t->num_tiles));
            BRIO_FORWARD(add_hashes(r, i, &sum));
        }
    }
    BRIO_FORWARD(brio_exchange_all(&r->x, &sum, sizeof sum));
    for (int i = 0; i < r->ranks; i++) all += *(const uint64_t *)r->x.from[i]->bytes;
    *checksum = all;
    return BRIO_OK;
}
