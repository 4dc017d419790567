/* A triangulation put together from the parts of its tiles.
 *
 * Rows of all parts are numbered one after another. Each part is made once: its rows are written behind those before
 * it, with the mates that they have in the part; facets without one are told the other side when all parts are here
 * (neighbours.c). Those that have none are of the hull, and get infinite tetrahedra; two of these are neighbours across
 * an edge of the hull, and find each other by sorting these edges. Then all are sorted into the canonical order, as if
 * they had been inserted (brio_adoption_end).
 *
 * Rows are written where they are sorted from, and the files of a tile are removed as they are read. So there is never
 * more than the tetrahedra, and what of the tiles is still to come. */
#include "base/kept.h"
#include "base/memory.h"
#include "base/sort.h"
#include "order/canonical_points.h"
#include "store/row_files.h"
#include "tiles/work.h"
#include "triangulation/tetrahedra.h"
#include <string.h>

enum { SOME = 1 << 12 /* rows at once. Chosen */, MOST_TETRAHEDRA = 1 << 30 };

brio_status brio_gather_begin(brio_gather *g, const uint64_t *first, uint32_t num_tiles, uint64_t hull_facets) {
    uint64_t all = first[num_tiles] + hull_facets;
    g->first = first, g->num_tiles = num_tiles;
    BRIO_EXPECT(g->ctx, all < MOST_TETRAHEDRA, BRIO_ERR_TOO_LARGE, "%llu tetrahedra are too many for one triangulation",
                (unsigned long long)all);
    g->num_finite = (size_t)first[num_tiles];
    g->count = (size_t)all;
    BRIO_FORWARD(brio_adoption_begin(g->ctx, &g->input, g->seed, g->count, &g->adoption));
    g->tet = brio_adoption_tetrahedra(g->adoption);
    return BRIO_ALLOC_IN_MEMORY(g->ctx, g->some, SOME);
}

void brio_gather_free(brio_gather *g) {
    brio_adoption_free(g->ctx, g->adoption);
    brio_release(g->ctx, g->some);
    g->adoption = NULL, g->some = NULL;
}

/* --- parts --- */

void brio_gather_rows(const brio_tile_part *part, const uint32_t *mate, size_t begin, size_t count,
                      brio_gather_row *rows) {
    for (size_t i = 0; i < count; i++) {
        for (int k = 0; k < 4; k++) rows[i].vertex[k] = (uint32_t)part->index[part->tetrahedra[begin + i][k]];
        memcpy(rows[i].mate, mate + 4 * (begin + i), sizeof rows[i].mate);
    }
}

brio_status brio_gather_take(brio_gather *g, uint32_t tile, uint64_t begin, const brio_gather_row *rows, size_t count) {
    const uint32_t *record = brio_adoption_records(g->adoption), before = brio_facet_of((uint32_t)g->first[tile], 0);
    uint64_t to = g->first[tile] + begin;
    for (size_t i = 0, some; i < count; i += some) {
        some = count - i < SOME ? count - i : SOME;
        for (size_t j = 0; j < some; j++)
            for (int k = 0; k < 4; k++) {
                uint32_t mate = rows[i + j].mate[k];
                bool lone = mate == BRIO_NO_FACET;
                g->some[j].vertex[k] = record[rows[i + j].vertex[k]];
                g->some[j].mate[k] = lone ? mate : before + mate;
                g->num_lone += lone;
            }
        BRIO_FORWARD(brio_block_write(g->ctx, g->tet, (to + i) * sizeof *g->tet, g->some, some * sizeof *g->some));
        BRIO_FORWARD(brio_look(g->ctx, some));
    }
    return BRIO_OK;
}

/* --- mates --- */

/* Adds the infinite tetrahedron across a facet of the hull, which is seen from outside counterclockwise. Returns its
 * facet there. */
static uint32_t add_infinite(brio_gather *g, uint32_t facet) {
    const brio_tetrahedron *inside = &g->tet[brio_tet_of(facet)];
    int slot = brio_slot_of(facet);
    uint32_t number = (uint32_t)(g->num_finite + g->num_infinite++);
    brio_tetrahedron *t = &g->tet[number];
    t->vertex[0] = inside->vertex[BRIO_FACET[slot][0]];
    t->vertex[1] = inside->vertex[BRIO_FACET[slot][2]];
    t->vertex[2] = inside->vertex[BRIO_FACET[slot][1]];
    t->vertex[3] = brio_adoption_infinite(g->adoption);
    t->mate[3] = facet;
    return brio_facet_of(number, 3);
}

/* Finds the number of a facet of a tile among all. Returns false if there is none. */
static bool find_facet(const brio_gather *g, uint32_t tile, uint32_t facet, uint32_t *number) {
    if (tile >= g->num_tiles || brio_tet_of(facet) >= g->first[tile + 1] - g->first[tile]) return false;
    *number = brio_facet_of((uint32_t)g->first[tile], 0) + facet;
    return true;
}

/* Joins a facet with what it is told. Returns false if that cannot be. */
static bool join_facet(brio_gather *g, const brio_facet_answer *a) {
    uint32_t facet, other;
    if (!find_facet(g, a->tile, a->facet, &facet)) return false;
    uint32_t *mate = &g->tet[brio_tet_of(facet)].mate[brio_slot_of(facet)];
    if (*mate != BRIO_NO_FACET) return false;
    if (a->other_tile == BRIO_NO_TILE) {
        if (g->num_finite + g->num_infinite == g->count) return false;
        other = add_infinite(g, facet);
    } else if (!find_facet(g, a->other_tile, a->other_facet, &other)) {
        return false;
    }
    *mate = other;
    g->num_lone--;
    return true;
}

/* Takes the answers to a tile from a file. */
static brio_status join_tile(brio_gather *g, brio_tiles *t, uint32_t tile) {
    brio_facet_answer *answer = NULL;
    size_t n = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_facet_answers_read(t, tile, &answer, &n));
    for (size_t i = 0; i < n; i++)
        if (!join_facet(g, &answer[i])) BRIO_TRY(brio_facet_answers_changed(t, tile));
    status = brio_look(g->ctx, n);
done:
    brio_release(g->ctx, answer);
    return status;
}

brio_status brio_gather_join(brio_gather *g, brio_tiles *t) {
    for (uint32_t i = 0; i < g->num_tiles; i++) {
        BRIO_FORWARD(join_tile(g, t, i));
        brio_row_files_remove(&t->folder, "joined", i);
    }
    return BRIO_OK;
}

/* --- the hull --- */

typedef struct {
    uint64_t vertices; /* of an edge of the hull: the greater one in the upper half */
    uint32_t facet;    /* of an infinite tetrahedron */
} hull_edge;

static int compare_edges(uint32_t i, uint32_t j, const void *user) {
    const hull_edge *edge = user;
    return (edge[i].vertices > edge[j].vertices) - (edge[i].vertices < edge[j].vertices);
}

static hull_edge edge_at(const brio_gather *g, size_t i) {
    uint32_t tet = (uint32_t)(g->num_finite + i / 3);
    int slot = (int)(i % 3);
    uint64_t a = g->tet[tet].vertex[(slot + 1) % 3], b = g->tet[tet].vertex[(slot + 2) % 3];
    return (hull_edge){a > b ? a << 32 | b : b << 32 | a, brio_facet_of(tet, slot)};
}

/* Joins the infinite tetrahedra across the edges of the hull. */
static brio_status join_hull(brio_gather *g) {
    brio_status status = BRIO_OK;
    size_t n = 3 * g->num_infinite;
    hull_edge *edge = NULL;
    uint32_t *order = NULL;
    BRIO_TRY(BRIO_ALLOC(g->ctx, edge, n));
    BRIO_TRY(BRIO_ALLOC(g->ctx, order, n));
    for (size_t i = 0; i < n; i++) {
        edge[i] = edge_at(g, i);
        order[i] = (uint32_t)i;
    }
    BRIO_TRY(brio_sort_many_indices(g->ctx, order, n, compare_edges, edge));
    for (size_t i = 0; i + 1 < n; i += 2) {
        uint32_t a = edge[order[i]].facet, b = edge[order[i + 1]].facet;
        BRIO_REQUIRE(g->ctx, edge[order[i]].vertices == edge[order[i + 1]].vertices, BRIO_ERR_INTERNAL,
                     "an edge of the hull has one facet");
        g->tet[brio_tet_of(a)].mate[brio_slot_of(a)] = b;
        g->tet[brio_tet_of(b)].mate[brio_slot_of(b)] = a;
    }
done:
    brio_release(g->ctx, edge);
    brio_release(g->ctx, order);
    return status;
}

/* --- the points that are no vertices --- */

/* Lists of each point the one of least index at its position.   *vertex_of  the caller's. */
static brio_status name_vertices(brio_context *ctx, const brio_input *input, uint32_t **vertex_of) {
    brio_status status = BRIO_OK;
    size_t n = input->count;
    uint32_t *order = NULL, *named = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, *vertex_of, n));
    BRIO_TRY(brio_canonical_points(ctx, input->points, n, &order));
    BRIO_TRY(BRIO_ALLOC(ctx, named, n));
    memcpy(named, order, n * sizeof *named);
    brio_name_coincident(input->points, n, named);
    for (size_t i = 0; i < n; i++) (*vertex_of)[order[i]] = named[i];
done:
    brio_release(ctx, order);
    brio_release(ctx, named);
    return status;
}

brio_status brio_gather_end(brio_gather *g, uint64_t duplicates, brio_triangulation **out) {
    brio_status status = BRIO_OK;
    brio_context *ctx = g->ctx;
    uint32_t *vertex_of = NULL;
    *out = NULL;
    BRIO_REQUIRE(ctx, g->num_finite + g->num_infinite == g->count && !g->num_lone, BRIO_ERR_INTERNAL,
                 "%zu facets of the hull of %zu; %zu facets have no other side", g->num_infinite,
                 g->count - g->num_finite, g->num_lone);
    BRIO_TRY(join_hull(g));
    brio_release(ctx, g->some);
    g->some = NULL;
    if (duplicates) BRIO_TRY(name_vertices(ctx, &g->input, &vertex_of));
    status = brio_adoption_end(ctx, g->adoption, vertex_of, out);
done:
    brio_release(ctx, vertex_of);
    return status;
}

/* --- the tiles of one process --- */

typedef struct {
    brio_gather gather;
    brio_tiles *t;
    brio_gather_row *some;
} taking;

/* Takes a part, as a brio_tile_part_fn. Its file is not needed any more. */
static brio_status take_part(void *user, uint32_t tile, const brio_tile_part *part, const uint32_t *mate) {
    taking *own = user;
    brio_tile_result_remove(own->t, tile);
    for (size_t i = 0, some; i < part->num_tetrahedra; i += some) {
        some = part->num_tetrahedra - i < SOME ? part->num_tetrahedra - i : SOME;
        brio_gather_rows(part, mate, i, some, own->some);
        BRIO_FORWARD(brio_gather_take(&own->gather, tile, i, own->some, some));
    }
    return BRIO_OK;
}

/* Takes all parts, and what their facets are told. Tiles are in memory, as they were when they were triangulated. */
static brio_status take_all(taking *own) {
    brio_tiles *t = own->t;
    char *scratch = t->ctx->scratch;
    t->ctx->scratch = NULL;
    brio_keep_begin(t->ctx);
    brio_status status = brio_tiles_join(t, take_part, own);
    t->has_result = false;
    brio_store_remove(&t->folder, "points");
    if (status == BRIO_OK) status = brio_gather_join(&own->gather, t);
    brio_keep_end(t->ctx);
    t->ctx->scratch = scratch;
    return status;
}

brio_status brio_tiles_gather(brio_tiles *t, const double *points, size_t num_points, uint64_t seed,
                              brio_triangulation **out) {
    brio_context *ctx = t->ctx;
    brio_status status = BRIO_OK;
    uint64_t *first = NULL;
    taking own = {.gather = {.ctx = ctx, .input = {points, NULL, num_points}, .seed = seed}, .t = t};
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, first, t->num_tiles + 1));
    for (uint32_t i = 0; i < t->num_tiles; i++) first[i + 1] = first[i] + t->tile[i].tetrahedra;
    BRIO_TRY(brio_gather_begin(&own.gather, first, t->num_tiles, t->stats.hull_facets));
    BRIO_TRY(BRIO_ALLOC_IN_MEMORY(ctx, own.some, SOME));
    BRIO_TRY(take_all(&own));
    status = brio_gather_end(&own.gather, t->stats.duplicates, out);
done:
    brio_release(ctx, own.some);
    brio_gather_free(&own.gather);
    brio_release(ctx, first);
    return status;
}

/* Triangulates the tiles in memory, one after another, also where the arrays of the surface are in scratch files: what
 * the context's limit leaves is for one tile then. */
static brio_status run_in_memory(brio_tiles *t) {
    char *scratch = t->ctx->scratch;
    t->ctx->scratch = NULL;
    brio_status status = brio_tiles_run(t->ctx, t);
    t->ctx->scratch = scratch;
    return status;
}

/* Triangulates points in tiles. */
static brio_status make(void *user, brio_context *ctx, const double *points, size_t num_points, uint64_t seed,
                        brio_triangulation **out) {
    const brio_delaunay_options of_one = {.size = sizeof of_one, .seed = seed};
    brio_status status = BRIO_OK;
    brio_tiles *t = NULL;
    *out = NULL;
    BRIO_TRY(brio_tiles_new(ctx, user, &t));
    BRIO_TRY(brio_tiles_add(ctx, t, points, NULL, num_points));
    BRIO_TRY(run_in_memory(t));
    status = t->stats.dimension < 3 ? brio_delaunay(ctx, points, NULL, num_points, &of_one, out)
                                    : brio_tiles_gather(t, points, num_points, seed, out);
done:
    brio_tiles_free(t);
    return status;
}

brio_status brio_triangulate_in_tiles(brio_context *ctx, const brio_tiles_options *options, brio_triangulator *out) {
    BRIO_EXPECT(ctx, !options->stars && !options->key, BRIO_ERR_ARGUMENT,
                "tiles of a surface have neither stars nor a key");
    *out = (brio_triangulator){(void *)options, make};
    return BRIO_OK;
}
