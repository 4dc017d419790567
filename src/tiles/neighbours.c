/* Neighbours of tetrahedra across tiles.
 *
 * Two tetrahedra are neighbours if they share a facet. The facets of a part are put into buckets by their least vertex,
 * and those of a bucket are sorted: equal ones are next to each other. What is left alone is a facet of the hull, or
 * its other side is of another tile. These facets go to files by a hash of the indices of their vertices, as many files
 * as tiles. Each file is sorted in memory, and each side of a pair is told the other one, in a file of its tile. So no
 * more than the borders of all tiles is written, and neighbours within a tile are found anew when they are asked for.
 *
 * Based on: Aggarwal, Vitter. The input/output complexity of sorting and related problems. CACM 1988. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "store/row_files.h"
#include "tiles/work.h"
#include "triangulation/canonical_turn.h"
#include "triangulation/tetrahedra.h"
#include <string.h>

enum { MOST_TETRAHEDRA = 1 << 30 }; /* of a tile: a facet is 4 * tetrahedron + slot, in 32 bits */

/* --- facets of a part --- */

static void sort_three(uint32_t v[3]) {
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2 - i; k++)
            if (v[k] > v[k + 1]) {
                uint32_t swap = v[k];
                v[k] = v[k + 1], v[k + 1] = swap;
            }
}

/* Writes the rows of the vertices of a facet, in ascending order. */
static inline void vertices_of(const brio_tile_part *p, uint32_t facet, uint32_t v[3]) {
    const uint32_t *tet = p->tetrahedra[brio_tet_of(facet)];
    for (int k = 0; k < 3; k++) v[k] = tet[BRIO_FACET[brio_slot_of(facet)][k]];
    sort_three(v);
}

/* Lists the facets of a part by their least vertex.   end  receives where those of each vertex end. */
static void list_facets(const brio_tile_part *p, size_t *end, uint32_t *facet) {
    uint32_t v[3];
    for (size_t f = 0; f < 4 * p->num_tetrahedra; f++) {
        vertices_of(p, (uint32_t)f, v);
        end[v[0] + 1]++;
    }
    for (size_t i = 0; i < p->num_vertices; i++) end[i + 1] += end[i]; /* where the next vertex begins */
    for (size_t f = 0; f < 4 * p->num_tetrahedra; f++) {
        vertices_of(p, (uint32_t)f, v);
        facet[end[v[0]]++] = (uint32_t)f;
    }
}

/* Returns the two vertices of a facet that are not its least one, as a number. */
static uint64_t key_of(const brio_tile_part *p, uint32_t facet) {
    uint32_t v[3];
    vertices_of(p, facet, v);
    return (uint64_t)v[1] << 32 | v[2];
}

static void join_facets(uint32_t tile, uint32_t a, uint32_t b, brio_tile_neighbour (*neighbours)[4]) {
    neighbours[brio_tet_of(a)][brio_slot_of(a)] = (brio_tile_neighbour){tile, brio_tet_of(b)};
    neighbours[brio_tet_of(b)][brio_slot_of(b)] = (brio_tile_neighbour){tile, brio_tet_of(a)};
}

/* Joins the facets of one vertex, of which at most two are alike. Few of them are compared each with each. */
static void match(uint32_t tile, uint64_t *key, uint32_t *facet, size_t n, brio_tile_neighbour (*neighbours)[4]) {
    enum { FEW = 64 }; /* chosen: a vertex is the least one of 27 in the mean */
    size_t reach = n;
    if (n > FEW) brio_heap_sort(key, facet, n), reach = 2;
    for (size_t i = 0; i < n; i++)
        for (size_t j = i + 1; j < n && j < i + reach; j++)
            if (key[i] == key[j]) join_facets(tile, facet[i], facet[j], neighbours);
}

brio_status brio_tile_match_inside(brio_context *ctx, uint32_t tile, const brio_tile_part *p,
                                   brio_tile_neighbour (*neighbours)[4]) {
    uint32_t *facet = NULL;
    size_t *end = NULL, room = 0;
    uint64_t *key = NULL;
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, p->num_tetrahedra <= MOST_TETRAHEDRA, BRIO_ERR_TOO_LARGE,
                 "tile %u has %zu tetrahedra; facets of at most %d have numbers: take more tiles", tile,
                 p->num_tetrahedra, MOST_TETRAHEDRA);
    memset(neighbours, 0xff, p->num_tetrahedra * sizeof *neighbours); /* BRIO_NO_TILE */
    BRIO_TRY(BRIO_ALLOC(ctx, facet, 4 * p->num_tetrahedra + 1));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, end, p->num_vertices + 1));
    list_facets(p, end, facet);
    for (size_t v = 0, begin = 0; v < p->num_vertices; begin = end[v++]) {
        size_t n = end[v] - begin;
        BRIO_TRY(BRIO_RESERVE(ctx, key, room, n));
        for (size_t i = 0; i < n; i++) key[i] = key_of(p, facet[begin + i]);
        match(tile, key, facet + begin, n, neighbours);
        BRIO_TRY(brio_look(ctx, n));
    }
done:
    brio_release(ctx, facet);
    brio_release(ctx, end);
    brio_release(ctx, key);
    return status;
}

/* --- facets without a neighbour in their part --- */

uint64_t brio_lone_facet_hash(const brio_lone_facet *l) {
    return brio_mix(l->index[0] ^ brio_mix(l->index[1] ^ brio_mix(l->index[2])));
}

static brio_lone_facet lone_facet_of(const brio_tile_part *p, uint32_t tile, uint32_t facet) {
    brio_lone_facet l = {.tile = tile, .facet = facet};
    uint32_t v[3];
    vertices_of(p, facet, v);
    for (int k = 0; k < 3; k++) l.index[k] = p->index[v[k]];
    brio_sort_keys(l.index, 3);
    return l;
}

brio_status brio_tile_lone_facets(brio_context *ctx, uint32_t tile, const brio_tile_part *p, brio_lone_facet_fn take,
                                  void *user) {
    brio_tile_neighbour(*neighbours)[4] = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(ctx, neighbours, p->num_tetrahedra + 1));
    BRIO_TRY(brio_tile_match_inside(ctx, tile, p, neighbours));
    for (size_t f = 0; f < 4 * p->num_tetrahedra; f++) {
        if (neighbours[f / 4][f % 4].tile != BRIO_NO_TILE) continue;
        brio_lone_facet l = lone_facet_of(p, tile, (uint32_t)f);
        BRIO_TRY(take(user, &l));
    }
done:
    brio_release(ctx, neighbours);
    return status;
}

static int compare_lone(uint32_t i, uint32_t j, const void *user) {
    const brio_lone_facet *a = (const brio_lone_facet *)user + i, *b = (const brio_lone_facet *)user + j;
    for (int k = 0; k < 3; k++)
        if (a->index[k] != b->index[k]) return a->index[k] < b->index[k] ? -1 : 1;
    return 0;
}

brio_status brio_facet_pairs(brio_tiles *t, uint32_t file, brio_facet_answer_fn take, void *user, uint64_t *alone) {
    brio_lone_facet *l = NULL;
    uint32_t *row = NULL;
    size_t n = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_read(&t->folder, "lone", file, sizeof *l, (void **)&l, &n));
    BRIO_REQUIRE(t->ctx, n <= UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu facets between tiles in a file: take more tiles", n);
    BRIO_TRY(BRIO_ALLOC(t->ctx, row, n + 1));
    *alone += n;
    for (size_t i = 0; i < n; i++) row[i] = (uint32_t)i;
    BRIO_TRY(brio_sort_many_indices(t->ctx, row, n, compare_lone, l));
    for (size_t i = 1; i < n; i++) {
        const brio_lone_facet *a = &l[row[i - 1]], *b = &l[row[i]];
        if (compare_lone(row[i - 1], row[i], l)) continue;
        *alone -= 2;
        BRIO_TRY(take(user, &(brio_facet_answer){a->tile, a->facet, {b->tile, brio_tet_of(b->facet)}}));
        BRIO_TRY(take(user, &(brio_facet_answer){b->tile, b->facet, {a->tile, brio_tet_of(a->facet)}}));
    }
    brio_row_files_remove(&t->folder, "lone", file);
done:
    brio_release(t->ctx, l);
    brio_release(t->ctx, row);
    return status;
}

brio_status brio_facet_answers_take(brio_tiles *t, uint32_t file, uint64_t all_tiles, const brio_tile_part *p,
                                    brio_tile_neighbour (*neighbours)[4]) {
    brio_facet_answer *a = NULL;
    size_t n = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_read(&t->folder, "joined", file, sizeof *a, (void **)&a, &n));
    for (size_t i = 0; i < n; i++) {
        uint32_t tet = brio_tet_of(a[i].facet);
        BRIO_REQUIRE(t->ctx, tet < p->num_tetrahedra && a[i].neighbour.tile < all_tiles, BRIO_ERR_OPEN,
                     "%s/joined-%u was changed from outside", t->folder.path, file);
        neighbours[tet][brio_slot_of(a[i].facet)] = a[i].neighbour;
    }
done:
    brio_release(t->ctx, a);
    return status;
}

void brio_facet_files_remove(brio_tiles *t) {
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        brio_row_files_remove(&t->folder, "lone", i);
        brio_row_files_remove(&t->folder, "joined", i);
    }
}

/* --- one process --- */

static brio_status put_lone(void *user, const brio_lone_facet *l) {
    brio_row_files *lone = user;
    return brio_row_files_put(lone, (uint32_t)(brio_lone_facet_hash(l) % lone->count), l, sizeof *l);
}

static brio_status put_answer(void *user, const brio_facet_answer *a) {
    return brio_row_files_put(user, a->tile, a, sizeof *a);
}

static brio_status divide_lone(brio_tiles *t) {
    brio_row_files lone = {0};
    brio_tile_part p = {.size = sizeof p};
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_open(&t->folder, "lone", t->num_tiles, &lone));
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        BRIO_TRY(brio_progress(t->ctx, "neighbours", 0.9 * i / t->num_tiles));
        BRIO_TRY(brio_tiles_part(t->ctx, t, i, &p));
        BRIO_TRY(brio_tile_lone_facets(t->ctx, i, &p, put_lone, &lone));
        brio_tile_part_free(t->ctx, &p);
    }
    status = brio_row_files_flush(&lone);
done:
    brio_tile_part_free(t->ctx, &p);
    brio_row_files_close(&lone);
    return status;
}

static brio_status join_lone(brio_tiles *t) {
    brio_row_files joined = {0};
    uint64_t alone = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_open(&t->folder, "joined", t->num_tiles, &joined));
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        BRIO_TRY(brio_progress(t->ctx, "neighbours", 0.9 + 0.1 * i / t->num_tiles));
        BRIO_TRY(brio_facet_pairs(t, i, put_answer, &joined, &alone));
    }
    BRIO_TRY(brio_row_files_flush(&joined));
    BRIO_REQUIRE(t->ctx, alone == t->stats.hull_facets, BRIO_ERR_OPEN,
                 "%s: files were changed from outside: %llu facets of %llu on the hull", t->folder.path,
                 (unsigned long long)alone, (unsigned long long)t->stats.hull_facets);
done:
    brio_row_files_close(&joined);
    return status;
}

/* Finds all neighbours that are of another tile. After a failure its files give their room back. */
static brio_status join_tiles(brio_tiles *t) {
    brio_status status = divide_lone(t);
    if (status == BRIO_OK) status = join_lone(t);
    t->has_neighbours = status == BRIO_OK;
    t->stats.scratch_bytes = t->folder.most;
    if (status == BRIO_OK) return BRIO_OK;
    brio_facet_files_remove(t);
    return status;
}

brio_status brio_tiles_neighbours(brio_context *ctx, brio_tiles *t, uint32_t tile, const brio_tile_part *part,
                                  brio_tile_neighbour (*neighbours)[4]) {
    BRIO_DOOR;
    BRIO_EXPECT(ctx, ctx == t->ctx, BRIO_ERR_ARGUMENT, "the tiles are of another context");
    BRIO_EXPECT(ctx, t->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    BRIO_EXPECT(ctx, tile < t->num_tiles, BRIO_ERR_ARGUMENT, "tile %u of %u", tile, t->num_tiles);
    BRIO_EXPECT(ctx, part->num_tetrahedra == t->tile[tile].tetrahedra, BRIO_ERR_ARGUMENT,
                "%zu tetrahedra of tile %u, which has %llu", part->num_tetrahedra, tile,
                (unsigned long long)t->tile[tile].tetrahedra);
    if (!part->num_tetrahedra) return BRIO_OK;
    if (!t->has_neighbours) BRIO_FORWARD(join_tiles(t));
    BRIO_FORWARD(brio_tile_match_inside(ctx, tile, part, neighbours));
    return brio_facet_answers_take(t, tile, t->num_tiles, part, neighbours);
}
