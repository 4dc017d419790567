/* brio/tiles.h: Delaunay and regular triangulations of more points than fit in memory, tile after tile on a disk.
 *
 * Points are added in blocks and go to files of a scratch folder. A k-d tree over a sample divides them into tiles of
 * about as many points. Each tile is triangulated with those points of other tiles that its tetrahedra need, which its
 * spheres tell. The tetrahedra are those that brio_delaunay makes of all points, ties and hidden points included.
 * docs/tiles.md says what it costs; docs/decisions/017-tiles.md why it is right.
 *
 *     brio_tiles_options o = {.size = sizeof o, .scratch = "/var/tmp", .tiles = 16};
 *     brio_tiles *t;
 *     brio_tiles_new(ctx, &o, &t);
 *     while (...) brio_tiles_add(ctx, t, points, NULL, count);
 *     brio_tiles_run(ctx, t);
 *     brio_tiles_checksum(ctx, t, &checksum);
 *     brio_tiles_free(t);
 */
#ifndef BRIO_TILES_H
#define BRIO_TILES_H

#include "cells.h"
#include "certificate.h"
#include "triangulation.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_tiles brio_tiles;

typedef struct brio_tiles_options {
    size_t size;
    const char *scratch; /* a folder with room for about 190 bytes a point; for cells in order 240, with faces 850 */
    uint32_t tiles;      /* how many, at most 65,536; 0 means 8 */
    int stars;           /* not 0: keeps what cells and alpha shapes need: 16 bytes for each tetrahedron of two tiles.
                            Memory and disk are counted before the work: 1: cells in order with their faces; 2: as they
                            are computed, and alpha shapes, which need no disk; 3: in order without faces; 4: alpha
                            shapes whose faces go to a certificate of parts meanwhile */
    uint64_t key;        /* 0: no run goes on with what a killed process left. Else a number that tells this input and
                            this way to read it from others. After a process was killed, the next run in the same
                            folder with the same key and number of tiles goes on with its files */
} brio_tiles_options;

/** Facts of a triangulation in tiles. The first ones are those of brio_delaunay_stats. */
typedef struct brio_tiles_stats {
    size_t size;
    uint64_t points, vertices, duplicates, hidden;
    int dimension, weighted;
    uint32_t tiles; /* that hold points */
    uint64_t tetrahedra, hull_facets;
    uint64_t asked;           /* spheres and half-spaces for which a tile asked others */
    uint64_t found;           /* points that a tile got from others because they were inside such a sphere */
    uint64_t sampled;         /* points of the coarse samples that tiles begin with */
    uint64_t read;            /* blocks of points that a tile read from others */
    uint64_t triangulated;    /* points in all triangulations of all rounds */
    uint32_t most_rounds;     /* of a tile */
    uint32_t resumed;         /* tiles that a run before had finished */
    uint64_t most_points;     /* in one triangulation */
    uint64_t most_tetrahedra; /* in one triangulation */
    uint64_t scratch_bytes;   /* the most that were in the scratch folder */
    double divide_seconds, triangulate_seconds, rank_seconds;
    double low[3], high[3]; /* the box of all points, after brio_tiles_run; by ranks zeros */
} brio_tiles_stats;

/** The tetrahedra that belong to one tile: those whose lexicographically least vertex is one of its points. */
typedef struct brio_tile_part {
    size_t size;
    size_t num_vertices;       /* those of the tetrahedra */
    double *points;            /* #V by 3 */
    double *weights;           /* #V, or NULL */
    uint64_t *index;           /* #V: in the order in which points were added */
    uint32_t (*tetrahedra)[4]; /* #T: rows of points; positive */
    size_t num_tetrahedra;
} brio_tile_part;

/** Makes an empty set of points, and a folder in the scratch folder.
 *  Memory: about 9 MB, and 1 kB a tile; more waits for the files of tiles, at most 40 MB and a part of the limit.
 *  out  owned by the caller: brio_tiles_free; NULL on error.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_OPEN (not a writable folder, in use by another process, or laid
 *  there by another user),
 *  BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY (also where the memory limit of the context is too low for the number of
 *  tiles). */
BRIO_API brio_status brio_tiles_new(brio_context *ctx, const brio_tiles_options *options, brio_tiles **out);

/** Returns 1 if a run before left all points in the folder, so that none are to be added; else 0. */
BRIO_API int brio_tiles_has_points(const brio_tiles *t);

/** Appends points.
 *  points  num_points by 3.   weights  num_points, or NULL: in all calls, or in none.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NOT_FINITE, BRIO_ERR_WRITE (the disk is full), BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_tiles_add(brio_context *ctx, brio_tiles *t, const double *points, const double *weights,
                                    size_t num_points);

/** Divides the points into tiles, and triangulates these. Call once, after all points were added. After a failure while
 *  tiles are triangulated, a further call goes on with those that are missing; after one before that, it is refused.
 *  Where all points are in a plane there are no tetrahedra; the counts are those of brio_delaunay. With weights such
 *  points are refused.
 *  Memory: about 520 bytes a point of the largest tile, and at most two bytes for each of all points. Points whose
 *  spheres reach everything, as those on one sphere, need the memory of all points. A tile has less than 2^31 points.
 *  Returns BRIO_OK, BRIO_ERR_NO_ANSWER (points in a plane, with weights), BRIO_ERR_TOO_LARGE, BRIO_ERR_WRITE (the
 *  disk is full, or before the work, has less room than about 195 bytes a point, with cells in order 240 or 850),
 *  BRIO_ERR_OPEN (a scratch file was cut or removed), BRIO_ERR_NO_MEMORY (also where the memory limit of the context
 *  is too low for the largest tile; the sentence says how many tiles would do), BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_tiles_run(brio_context *ctx, brio_tiles *t);

/** Returns the facts. The view is valid until brio_tiles_free. */
BRIO_API const brio_tiles_stats *brio_tiles_facts(const brio_tiles *t);

/** Computes what brio_triangulation_checksum returns for the triangulation of all points.
 *  Cost: sorts all vertices, tile by tile, and merges them; 40 bytes a vertex of disk.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (brio_tiles_run did not end well), BRIO_ERR_WRITE, BRIO_ERR_OPEN,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_tiles_checksum(brio_context *ctx, brio_tiles *t, uint64_t *checksum);

/** Reads the tetrahedra of a tile. All parts together are the triangulation; each tetrahedron is in one of them.
 *  tile  below the number of tiles that was asked for.   out  freed with brio_tile_part_free.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_OPEN, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_tiles_part(brio_context *ctx, brio_tiles *t, uint32_t tile, brio_tile_part *out);
BRIO_API void brio_tile_part_free(brio_context *ctx, brio_tile_part *part);

/** No tile: on the other side of a facet of the hull. */
#define BRIO_NO_TILE UINT32_MAX

/** The tetrahedron on the other side of a facet. */
typedef struct brio_tile_neighbour {
    uint32_t tile;        /* whose part has it; BRIO_NO_TILE: the facet is one of the hull */
    uint32_t tetrahedron; /* its row there */
} brio_tile_neighbour;

/** Names the neighbours of a tile's tetrahedra, also those of other tiles.
 *  The rows are those of brio_tiles_part, which are the same in every call and for every number of threads.
 *  part  of the tile, as brio_tiles_part made it.
 *  neighbours  #T by 4, the caller's: entry i receives the neighbour across the facet opposite to vertex i.
 *  Cost: the first call reads the parts of all tiles, and writes 96 bytes for each facet between two tiles, 48 for one
 *  of the hull. Each call goes once along the facets of its tile. Memory: 20 bytes a tetrahedron of a tile; in the
 *  first call a part, too, and at most 4 MB, or 1 kB a tile. The files stay until brio_tiles_free. If the first call
 *  fails to make them, it removes them, and a further call tries again.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no result; no part of this tile), BRIO_ERR_TOO_LARGE (more than 2^30 tetrahedra
 *  of a tile), BRIO_ERR_WRITE (the disk is full), BRIO_ERR_OPEN (a scratch file was cut or changed),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Aggarwal Vitter 1988]. */
BRIO_API brio_status brio_tiles_neighbours(brio_context *ctx, brio_tiles *t, uint32_t tile, const brio_tile_part *part,
                                           brio_tile_neighbour (*neighbours)[4]);

/** Receives some cells. `site` has the index of each cell's point, in the order in which points were added; in place of
 *  cells->site. Neighbours of faces are such indices, too. Both are valid during the call.
 *  Returns 0, or another number to end the run. */
typedef int (*brio_tile_cells_fn)(const brio_cells *cells, const uint64_t *site, void *user);

/** Facts of all cells. */
typedef struct brio_tiles_cells_stats {
    size_t size;
    uint64_t cells, bounded, faces; /* a face between two cells counts twice */
    uint64_t outside;               /* sites that are not in the box */
    double volume_sum;              /* of the bounded cells, in the order in which they come */
    double region_volume;           /* infinite without a region */
} brio_tiles_cells_stats;

/** Computes the cells of all vertices, tile after tile, in parts of some thousands. The numbers of each cell and its
 *  faces are those of brio_voronoi_cells of all points, bit for bit, where that is asked for more than volumes.
 *  options  as there. `vertices` of a part are those of its cells; not with `ordered`.
 *  ordered  1: cells come in ascending order of their sites, and volume_sum is that of brio_voronoi_cells. They are
 *           sorted in the scratch folder: 56 bytes a cell and, with faces, 40 a face (about 620 a cell). 2: the same,
 *           but of the faces there are face_offsets alone, for who wants no more than their number. 0: as they are
 *           computed.
 *  Memory: about 300 bytes a point of the largest tile, and 60 MB for cells at hand, or 3,600 bytes a point of a tile
 *  of less than 16,384. With `ordered` and faces then about 350 bytes a point of the largest tile.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no result, or without `stars`; a wrong region), BRIO_ERR_NO_ANSWER (points in a
 *  plane; a region that the cells do not fill), BRIO_ERR_WRITE, BRIO_ERR_OPEN, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED (also where the function ended it). */
BRIO_API brio_status brio_tiles_cells(brio_context *ctx, brio_tiles *t, const brio_cells_options *options, int ordered,
                                      brio_tile_cells_fn take, void *user);

/** Returns the facts of the last call of brio_tiles_cells that ended well. The view is valid until brio_tiles_free. */
BRIO_API const brio_tiles_cells_stats *brio_tiles_cells_facts(const brio_tiles *t);

/* --- alpha shapes --- */

/** Receives the faces of an alpha shape that belong to a tile: those whose vertex of least index is a point of it. Of
 *  the part, `index` has the order in which points were added. Valid during the call.
 *  Returns 0, or another number to end the run. */
typedef int (*brio_tile_faces_fn)(const brio_faces_part *part, uint32_t tile, void *user);

/** Facts of an alpha shape of all points; the names are those of brio_alpha_shape_stats and brio_alpha_complex. */
typedef struct brio_tiles_alpha_stats {
    size_t size;
    uint64_t counts[4];  /* simplices of the triangulation, by dimension */
    uint64_t tetrahedra; /* in the complex */
    uint64_t faces;      /* of the boundary */
    uint64_t uncovered;  /* vertices that are in no tetrahedron of the complex */
    uint64_t singular_vertices, singular_edges, singular_facets;
} brio_tiles_alpha_stats;

/** Makes the boundary of an alpha shape or a weighted one, tile after tile: the faces of brio_alpha_shape, seen
 *  counterclockwise from outside, by the indices of their points. Values of simplices have the same bits as those of
 *  brio_alpha_values, so also an alpha that is one of them gives the same shape. Where parts of the solid touch,
 *  vertices are not doubled: a brio_parts_certificate with `sheets` counts them.
 *  alpha  a number; the least alpha of one solid is not found here.
 *  take   NULL: nothing is to be known but the facts. Called for tiles with faces alone, in ascending order.
 *  Memory: about 300 bytes a point of the largest tile, 60 MB for the values of 16,384 points at a time, and 40 bytes a
 *  face of a tile. With all threads. Disk: none.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no result, or without `stars`; alpha is NaN), BRIO_ERR_NO_ANSWER (points in a
 *  plane; no tetrahedron has a value of at most alpha, or alpha is closer to 0 than brio_alpha_auto finds one: known
 *  when all tiles are done), BRIO_ERR_OPEN, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED (also where the
 *  function ended it).
 *  Based on: [Edelsbrunner Muecke 1994], [Edelsbrunner 1995] for weights. */
BRIO_API brio_status brio_tiles_alpha(brio_context *ctx, brio_tiles *t, double alpha, brio_tile_faces_fn take,
                                      void *user, brio_tiles_alpha_stats *stats);

/** Frees everything, and removes all files; NULL is accepted. */
BRIO_API void brio_tiles_free(brio_tiles *t);

#ifdef __cplusplus
}
#endif
#endif
