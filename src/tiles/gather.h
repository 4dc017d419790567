/* A triangulation put together from the parts of its tiles. */
#ifndef BRIO_TILES_GATHER_H
#define BRIO_TILES_GATHER_H

#include "brio/tiles.h"
#include "triangulation/triangulation.h"

/** Tetrahedra that come part after part. Facets of the hull have infinite ones, which follow. */
typedef struct {
    brio_context *ctx;
    const uint64_t *first; /* #tiles + 1: of each tile, its first tetrahedron among all */
    uint32_t num_tiles;
    size_t num_finite, count; /* count: the infinite ones, too */
    size_t num_infinite;      /* that are here */
    brio_tetrahedron *tet;    /* count; until all are here, a mate is a tetrahedron */
} brio_gather;

/** Makes room.
 *  first  kept.   hull_facets  of all.   out  freed with brio_gather_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_TOO_LARGE (over 2^30 tetrahedra), BRIO_ERR_NO_MEMORY. */
brio_status brio_gather_new(brio_context *ctx, const uint64_t *first, uint32_t num_tiles, uint64_t hull_facets,
                            brio_gather *out);
void brio_gather_free(brio_gather *g);

/** Takes the part of a tile.   neighbours  as brio_tiles_neighbours names them.   Parts may come in any order. */
void brio_gather_part(brio_gather *g, uint32_t tile, const brio_tile_part *part,
                      const brio_tile_neighbour (*neighbours)[4]);

/** Makes what brio_delaunay makes of the points, once all parts are here.
 *  points  num_points by 3, by the indices of the parts.   duplicates  points at the position of another one.
 *  Cost: sorts the tetrahedra, in files where the context has a scratch folder.
 *  Returns what brio_delaunay returns. */
brio_status brio_gather_end(brio_gather *g, const double *points, size_t num_points, uint64_t duplicates,
                            brio_triangulation **out);

/** Makes what brio_delaunay makes of the points of all tiles of one process, whose dimension is 3.
 *  points  num_points by 3: those that were added.   Returns what brio_delaunay returns. */
brio_status brio_tiles_gather(brio_tiles *t, const double *points, size_t num_points, brio_triangulation **out);

/** Lets a context's triangulations be made in tiles.
 *  options  kept: neither stars nor a key.   Returns BRIO_OK, BRIO_ERR_ARGUMENT. */
brio_status brio_triangulate_in_tiles(brio_context *ctx, const brio_tiles_options *options, brio_triangulator *out);

#endif
