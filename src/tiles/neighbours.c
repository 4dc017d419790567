/* Neighbours of tetrahedra across tiles.
 *
 * Two tetrahedra are neighbours if they share a facet. The facets of a part whose latest vertex is the same meet in a
 * small table, by their other vertices (linear probing). What is left alone is a facet of the hull, or its other side
 * is of another tile. These facets go to files by a hash of the indices of their vertices, as many files as tiles. Each
 * file is sorted in memory, and each side of a pair is told the other one, in a file of its tile. So no more than the
 * borders of all tiles is written, and neighbours within a tile are found anew when they are asked for.
 *
 * Based on: Aggarwal, Vitter. The input/output complexity of sorting and related problems. CACM 1988.
 *           Knuth. The art of computer programming, volume 3. 1973, section 6.4 (linear probing). */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "store/row_files.h"
#include "tiles/work.h"
#include "triangulation/tetrahedra.h"
#include <string.h>

enum { MOST_TETRAHEDRA = 1 << 30 }; /* of a tile: a facet is 4 * tetrahedron + slot, in 32 bits */

/* --- facets of a part --- */

/* The facets whose latest vertex is the same: the other two tell them apart. The table has by a hash of these the
 * number of a facet plus 1; 0 where there is none. */
typedef struct {
    uint64_t *key;
    uint32_t *facet, *table;
    size_t count, mask, capacity[3];
} facets;

static brio_status begin_vertex(brio_context *ctx, facets *f, size_t most) {
    size_t size = 64;
    while (size < 2 * most) size *= 2;
    BRIO_FORWARD(BRIO_RESERVE(ctx, f->key, f->capacity[0], most));
    BRIO_FORWARD(BRIO_RESERVE(ctx, f->facet, f->capacity[1], most));
    BRIO_FORWARD(BRIO_RESERVE(ctx, f->table, f->capacity[2], size));
    memset(f->table, 0, size * sizeof *f->table);
    f->count = 0;
    f->mask = size - 1;
    return brio_look(ctx, most);
}

/* Joins a facet with the one that has the same vertices, or enters it. */
static inline void join_or_enter(facets *f, uint32_t a, uint32_t b, uint32_t facet, uint32_t *mate) {
    uint64_t key = a > b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
    size_t at = (size_t)(key * UINT64_C(0x9e3779b97f4a7c15) >> 32) & f->mask;
    for (; f->table[at]; at = (at + 1) & f->mask) {
        uint32_t i = f->table[at] - 1;
        if (f->key[i] != key) continue;
        mate[facet] = f->facet[i];
        mate[f->facet[i]] = facet;
        return;
    }
    f->key[f->count] = key;
    f->facet[f->count] = facet;
    f->table[at] = (uint32_t)++f->count;
}

/* Lists the tetrahedra of a part by their second vertex.   end  receives where those of each vertex end. */
static void list_seconds(const brio_tile_part *p, uint32_t *end, uint32_t *row) {
    for (size_t i = 0; i < p->num_tetrahedra; i++) end[p->tetrahedra[i][1] + 1]++;
    for (size_t v = 0; v < p->num_vertices; v++) end[v + 1] += end[v]; /* where the next vertex begins */
    for (size_t i = 0; i < p->num_tetrahedra; i++) row[end[p->tetrahedra[i][1]]++] = (uint32_t)i;
}

/* Makes use of the order of a part (part.c): a tetrahedron's first vertex is its latest, its second one the latest of
 * the others, and rows are sorted by the first. So three facets have the first for their latest vertex, and one the
 * second. */
brio_status brio_tile_match_inside(brio_context *ctx, uint32_t tile, const brio_tile_part *p, uint32_t *mate) {
    uint32_t *second = NULL, *end = NULL;
    facets f = {0};
    brio_status status = BRIO_OK;
    size_t n = p->num_tetrahedra;
    BRIO_REQUIRE(ctx, n < MOST_TETRAHEDRA, BRIO_ERR_TOO_LARGE,
                 "tile %u has %zu tetrahedra; facets of less than %d have numbers: take more tiles", tile, n,
                 MOST_TETRAHEDRA);
    memset(mate, 0xff, 4 * n * sizeof *mate); /* BRIO_NO_FACET */
    BRIO_TRY(BRIO_ALLOC(ctx, second, n + 1));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, end, p->num_vertices + 1));
    list_seconds(p, end, second);
    for (size_t v = 0, row = 0, begin = 0; v < p->num_vertices; begin = end[v++]) {
        size_t first = row;
        while (row < n && p->tetrahedra[row][0] == v) row++;
        BRIO_TRY(begin_vertex(ctx, &f, 3 * (row - first) + end[v] - begin));
        for (size_t i = first; i < row; i++) {
            const uint32_t *t = p->tetrahedra[i];
            for (int k = 1; k < 4; k++)
                join_or_enter(&f, t[k == 1 ? 2 : 1], t[k == 3 ? 2 : 3], brio_facet_of((uint32_t)i, k), mate);
        }
        for (size_t i = begin; i < end[v]; i++) {
            const uint32_t *t = p->tetrahedra[second[i]];
            join_or_enter(&f, t[2], t[3], brio_facet_of(second[i], 0), mate);
        }
    }
done:
    brio_release(ctx, second);
    brio_release(ctx, end);
    brio_release(ctx, f.key);
    brio_release(ctx, f.facet);
    brio_release(ctx, f.table);
    return status;
}

/* --- facets without a neighbour in their part --- */

uint64_t brio_lone_facet_hash(const brio_lone_facet *l) {
    return brio_mix(l->index[0] ^ brio_mix(l->index[1] ^ brio_mix(l->index[2])));
}

static inline void sort_two(uint64_t *a, uint64_t *b) {
    uint64_t least = *a < *b ? *a : *b;
    *b = *a < *b ? *b : *a;
    *a = least;
}

static brio_lone_facet lone_facet_of(const brio_tile_part *p, uint32_t tile, uint32_t facet) {
    brio_lone_facet l = {.tile = tile, .facet = facet};
    const uint32_t *tet = p->tetrahedra[brio_tet_of(facet)];
    for (int k = 0; k < 3; k++) l.index[k] = p->index[tet[BRIO_FACET[brio_slot_of(facet)][k]]];
    sort_two(&l.index[0], &l.index[1]);
    sort_two(&l.index[1], &l.index[2]);
    sort_two(&l.index[0], &l.index[1]);
    return l;
}

brio_status brio_tile_lone_facets(uint32_t tile, const brio_tile_part *p, const uint32_t *mate, brio_lone_facet_fn take,
                                  void *user) {
    for (size_t f = 0; f < 4 * p->num_tetrahedra; f++) {
        if (mate[f] != BRIO_NO_FACET) continue;
        brio_lone_facet l = lone_facet_of(p, tile, (uint32_t)f);
        BRIO_FORWARD(take(user, &l));
    }
    return BRIO_OK;
}

static int compare_lone(uint32_t i, uint32_t j, const void *user) {
    const brio_lone_facet *a = (const brio_lone_facet *)user + i, *b = (const brio_lone_facet *)user + j;
    for (int k = 0; k < 3; k++)
        if (a->index[k] != b->index[k]) return a->index[k] < b->index[k] ? -1 : 1;
    return 0;
}

/* Returns whether two facets of a sorted list have the same vertices. */
static bool is_pair(const brio_lone_facet *l, const uint32_t *row, size_t i, size_t n) {
    return i + 1 < n && !compare_lone(row[i], row[i + 1], l);
}

brio_status brio_facet_pairs(brio_tiles *t, uint32_t file, brio_facet_answer_fn take, void *user, uint64_t *alone) {
    brio_lone_facet *l = NULL;
    uint32_t *row = NULL;
    size_t n = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_read(&t->folder, "lone", file, sizeof *l, (void **)&l, &n));
    BRIO_REQUIRE(t->ctx, n <= UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu facets between tiles in a file: take more tiles", n);
    BRIO_TRY(BRIO_ALLOC(t->ctx, row, n + 1));
    for (size_t i = 0; i < n; i++) row[i] = (uint32_t)i;
    BRIO_TRY(brio_sort_many_indices(t->ctx, row, n, compare_lone, l));
    for (size_t i = 0, some; i < n; i += some) {
        const brio_lone_facet *a = &l[row[i]], *b = NULL;
        some = is_pair(l, row, i, n) ? 2 : 1;
        if (some == 2) b = &l[row[i + 1]];
        *alone += !b;
        BRIO_TRY(take(user, &(brio_facet_answer){a->tile, a->facet, b ? b->tile : BRIO_NO_TILE, b ? b->facet : 0}));
        if (b) BRIO_TRY(take(user, &(brio_facet_answer){b->tile, b->facet, a->tile, a->facet}));
    }
    brio_row_files_remove(&t->folder, "lone", file);
done:
    brio_release(t->ctx, l);
    brio_release(t->ctx, row);
    return status;
}

brio_status brio_facet_answers_read(brio_tiles *t, uint32_t file, brio_facet_answer **answers, size_t *n) {
    *answers = NULL;
    return brio_row_files_read(&t->folder, "joined", file, sizeof **answers, (void **)answers, n);
}

brio_status brio_facet_answers_changed(const brio_tiles *t, uint32_t file) {
    return brio_fail(t->ctx, BRIO_ERR_OPEN, "%s/joined-%u was changed from outside", t->folder.path, file);
}

/* Writes the neighbours that are of the same tile. */
static void name_inside(uint32_t tile, const uint32_t *mate, size_t num_tetrahedra,
                        brio_tile_neighbour (*neighbours)[4]) {
    for (size_t f = 0; f < 4 * num_tetrahedra; f++)
        neighbours[f / 4][f % 4] = mate[f] == BRIO_NO_FACET ? (brio_tile_neighbour){BRIO_NO_TILE, BRIO_NO_FACET}
                                                            : (brio_tile_neighbour){tile, brio_tet_of(mate[f])};
}

/* Writes those of other tiles, by the answers of a file. */
static brio_status name_across(brio_tiles *t, uint32_t file, uint64_t all_tiles, size_t num_tetrahedra,
                               brio_tile_neighbour (*neighbours)[4]) {
    brio_facet_answer *a = NULL;
    size_t n = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_facet_answers_read(t, file, &a, &n));
    for (size_t i = 0; i < n; i++) {
        bool hull = a[i].other_tile == BRIO_NO_TILE;
        uint32_t tet = brio_tet_of(a[i].facet);
        if (tet >= num_tetrahedra || (!hull && a[i].other_tile >= all_tiles))
            BRIO_TRY(brio_facet_answers_changed(t, file));
        if (!hull)
            neighbours[tet][brio_slot_of(a[i].facet)] =
                (brio_tile_neighbour){a[i].other_tile, brio_tet_of(a[i].other_facet)};
    }
done:
    brio_release(t->ctx, a);
    return status;
}

brio_status brio_tile_name_neighbours(brio_tiles *t, uint32_t file, uint32_t tile, uint64_t all_tiles,
                                      const brio_tile_part *part, brio_tile_neighbour (*neighbours)[4]) {
    uint32_t *mate = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(t->ctx, mate, 4 * part->num_tetrahedra + 1));
    BRIO_TRY(brio_tile_match_inside(t->ctx, tile, part, mate));
    name_inside(tile, mate, part->num_tetrahedra, neighbours);
    status = name_across(t, file, all_tiles, part->num_tetrahedra, neighbours);
done:
    brio_release(t->ctx, mate);
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

/* Makes the part of a tile, and puts what is lone into files. */
static brio_status divide_tile(brio_tiles *t, uint32_t tile, brio_tile_part_fn with, void *user, brio_row_files *lone) {
    brio_tile_part p = {.size = sizeof p};
    uint32_t *mate = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_tiles_part(t->ctx, t, tile, &p));
    BRIO_TRY(BRIO_ALLOC(t->ctx, mate, 4 * p.num_tetrahedra + 1));
    BRIO_TRY(brio_tile_match_inside(t->ctx, tile, &p, mate));
    BRIO_TRY(brio_tile_lone_facets(tile, &p, mate, put_lone, lone));
    if (with) status = with(user, tile, &p, mate);
done:
    brio_tile_part_free(t->ctx, &p);
    brio_release(t->ctx, mate);
    return status;
}

static brio_status divide_lone(brio_tiles *t, brio_tile_part_fn with, void *user) {
    brio_row_files lone = {0};
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_open(&t->folder, "lone", t->num_tiles, &lone));
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        BRIO_TRY(brio_progress(t->ctx, "neighbours", 0.9 * i / t->num_tiles));
        BRIO_TRY(divide_tile(t, i, with, user, &lone));
    }
    status = brio_row_files_flush(&lone);
done:
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

brio_status brio_tiles_join(brio_tiles *t, brio_tile_part_fn with, void *user) {
    brio_status status = divide_lone(t, with, user);
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
    if (!t->has_neighbours) BRIO_FORWARD(brio_tiles_join(t, NULL, NULL));
    return brio_tile_name_neighbours(t, tile, tile, t->num_tiles, part, neighbours);
}
