/* A triangulation put together from the parts of its tiles.
 *
 * Rows of all parts are numbered one after another. A part tells its vertices by the indices of points, and across each
 * facet the tile and the row of the neighbour, which is a number then. Each facet of the hull gets an infinite
 * tetrahedron; two of these are neighbours across an edge of the hull, and find each other by sorting these edges. When
 * all are here, a look at each neighbour's vertices tells through which of its facets the two meet. Then all are sorted
 * into the canonical order, as if they had been inserted (brio_delaunay_adopt).
 *
 * Everything goes along the rows, and neighbours are nearly always of the same tile. So what is in scratch files is
 * read and written in sequence. */
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "order/canonical_points.h"
#include "tiles/work.h"
#include "triangulation/tetrahedra.h"
#include <string.h>

enum { TETS_A_THREAD = 1 << 12, MOST_TETRAHEDRA = 1 << 30 };

brio_status brio_gather_new(brio_context *ctx, const uint64_t *first, uint32_t num_tiles, uint64_t hull_facets,
                            brio_gather *out) {
    uint64_t all = first[num_tiles] + hull_facets;
    *out = (brio_gather){.ctx = ctx, .first = first, .num_tiles = num_tiles};
    BRIO_EXPECT(ctx, all < MOST_TETRAHEDRA, BRIO_ERR_TOO_LARGE, "%llu tetrahedra are too many for one triangulation",
                (unsigned long long)all);
    out->num_finite = (size_t)first[num_tiles];
    out->count = (size_t)all;
    return BRIO_ALLOC(ctx, out->tet, out->count);
}

void brio_gather_free(brio_gather *g) {
    brio_release(g->ctx, g->tet);
    g->tet = NULL;
}

/* --- parts --- */

/* Adds the infinite tetrahedron across a facet of the hull, which is seen from outside counterclockwise. Returns its
 * number. */
static uint32_t add_infinite(brio_gather *g, uint32_t tet, int slot) {
    const uint32_t *v = g->tet[tet].vertex;
    size_t number = g->num_finite + g->num_infinite++;
    assert(number < g->count);
    brio_tetrahedron *t = &g->tet[number];
    t->vertex[0] = v[BRIO_FACET[slot][0]];
    t->vertex[1] = v[BRIO_FACET[slot][2]];
    t->vertex[2] = v[BRIO_FACET[slot][1]];
    t->vertex[3] = BRIO_INFINITE;
    t->mate[3] = tet;
    return (uint32_t)number;
}

brio_gather_row brio_gather_row_of(const brio_tile_part *part, const brio_tile_neighbour (*neighbours)[4], size_t i) {
    brio_gather_row row;
    for (int k = 0; k < 4; k++) row.vertex[k] = (uint32_t)part->index[part->tetrahedra[i][k]];
    memcpy(row.neighbour, neighbours[i], sizeof row.neighbour);
    return row;
}

void brio_gather_take(brio_gather *g, uint32_t tile, uint64_t row, const brio_gather_row *tetrahedron) {
    uint32_t number = (uint32_t)(g->first[tile] + row);
    brio_tetrahedron *t = &g->tet[number];
    memcpy(t->vertex, tetrahedron->vertex, sizeof t->vertex);
    for (int k = 0; k < 4; k++) {
        brio_tile_neighbour n = tetrahedron->neighbour[k];
        t->mate[k] = n.tile == BRIO_NO_TILE ? add_infinite(g, number, k) : (uint32_t)(g->first[n.tile] + n.tetrahedron);
    }
}

/* --- mates --- */

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
        g->tet[brio_tet_of(a)].mate[brio_slot_of(a)] = brio_tet_of(b);
        g->tet[brio_tet_of(b)].mate[brio_slot_of(b)] = brio_tet_of(a);
    }
done:
    brio_release(g->ctx, edge);
    brio_release(g->ctx, order);
    return status;
}

/* Returns the slot of the vertex of a neighbour that a tetrahedron does not have. */
static int slot_across(const brio_tetrahedron *t, const brio_tetrahedron *neighbour) {
    int j = 0;
    while (j < 3 && brio_slot_of_vertex(t->vertex, neighbour->vertex[j]) < 4) j++;
    return j;
}

/* Replaces the numbers of neighbours by handles of their facets. Reads nothing that another thread writes. */
static void find_mates(void *user, size_t begin, size_t end, int thread) {
    brio_gather *g = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        brio_tetrahedron *t = &g->tet[i];
        for (int k = 0; k < 4; k++) {
            uint32_t other = t->mate[k];
            t->mate[k] = brio_facet_of(other, slot_across(t, &g->tet[other]));
        }
    }
}

/* --- the points that are no vertices --- */

/* Writes of each point the one of least index at its position. */
static brio_status name_vertices(brio_context *ctx, const double *points, size_t num_points, uint64_t duplicates,
                                 uint32_t *vertex_of) {
    brio_status status = BRIO_OK;
    uint32_t *order = NULL, *named = NULL;
    for (size_t p = 0; p < num_points; p++) vertex_of[p] = (uint32_t)p;
    if (duplicates == 0) return BRIO_OK;
    BRIO_TRY(brio_canonical_points(ctx, points, num_points, &order));
    BRIO_TRY(BRIO_ALLOC(ctx, named, num_points));
    memcpy(named, order, num_points * sizeof *named);
    brio_name_coincident(points, num_points, named);
    for (size_t i = 0; i < num_points; i++) vertex_of[order[i]] = named[i];
done:
    brio_release(ctx, order);
    brio_release(ctx, named);
    return status;
}

brio_status brio_gather_end(brio_gather *g, const double *points, size_t num_points, uint64_t duplicates, uint64_t seed,
                            brio_triangulation **out) {
    brio_status status = BRIO_OK;
    brio_context *ctx = g->ctx;
    uint32_t *vertex_of = NULL;
    *out = NULL;
    BRIO_REQUIRE(ctx, g->num_finite + g->num_infinite == g->count, BRIO_ERR_INTERNAL, "%zu facets of the hull of %zu",
                 g->num_infinite, g->count - g->num_finite);
    BRIO_TRY(join_hull(g));
    BRIO_TRY(brio_sweep(ctx, brio_threads(ctx, g->count, TETS_A_THREAD), g->count, find_mates, g, BRIO_WRITES(g->tet)));
    BRIO_TRY(BRIO_ALLOC(ctx, vertex_of, num_points));
    BRIO_TRY(name_vertices(ctx, points, num_points, duplicates, vertex_of));
    status = brio_delaunay_adopt(ctx, &(brio_input){points, NULL, num_points},
                                 &(brio_adopted){g->tet, g->count, vertex_of, seed}, out);
done:
    brio_release(ctx, vertex_of);
    return status;
}

/* --- the tiles of one process --- */

static brio_status take_tile(brio_gather *g, brio_tiles *t, uint32_t tile) {
    brio_tile_part part = {.size = sizeof part};
    brio_tile_neighbour(*neighbours)[4] = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_tiles_part(t->ctx, t, tile, &part));
    BRIO_TRY(BRIO_ALLOC(t->ctx, neighbours, part.num_tetrahedra + 1));
    BRIO_TRY(brio_tiles_neighbours(t->ctx, t, tile, &part, neighbours));
    for (size_t i = 0; i < part.num_tetrahedra; i++) {
        brio_gather_row row = brio_gather_row_of(&part, (const brio_tile_neighbour(*)[4])neighbours, i);
        brio_gather_take(g, tile, i, &row);
    }
done:
    brio_tile_part_free(t->ctx, &part);
    brio_release(t->ctx, neighbours);
    return status;
}

brio_status brio_tiles_gather(brio_tiles *t, const double *points, size_t num_points, uint64_t seed,
                              brio_triangulation **out) {
    brio_context *ctx = t->ctx;
    brio_status status = BRIO_OK;
    uint64_t *first = NULL;
    brio_gather g = {.ctx = ctx};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, first, t->num_tiles + 1));
    for (uint32_t i = 0; i < t->num_tiles; i++) first[i + 1] = first[i] + t->tile[i].tetrahedra;
    BRIO_TRY(brio_gather_new(ctx, first, t->num_tiles, t->stats.hull_facets, &g));
    for (uint32_t i = 0; i < t->num_tiles; i++) BRIO_TRY(take_tile(&g, t, i));
    status = brio_gather_end(&g, points, num_points, t->stats.duplicates, seed, out);
done:
    brio_gather_free(&g);
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
