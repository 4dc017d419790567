/* brio/cells.h: Voronoi cells and power cells, with volumes, faces and vertices. */
#ifndef BRIO_CELLS_H
#define BRIO_CELLS_H

#include "mesh.h"
#include "triangulation.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_cells_options {
    size_t size;
    int no_areas;         /* 1: leaves `area` out, which saves time; and so on */
    int no_centroids;     /* 1: leaves `centroid` out */
    int no_faces;         /* 1: leaves the faces out */
    int vertices;         /* 1: computes the vertices, and the faces */
    const double *box;    /* x0 y0 z0 x1 y1 z1, low before high: clips the cells */
    const double *planes; /* #planes by 4, n and d: clips the cells to n . x <= d */
    size_t num_planes;    /* box and planes together must bound a polytope with a volume */
    int no_face_sizes;    /* 1: leaves face_areas and face_normals out */
    int reserved_int;     /* 0 */
} brio_cells_options;

/** Cells and their faces, #C cells and #F faces. Cell c has the faces face_offsets[c] to face_offsets[c+1] - 1, and
 *  face f has the corners corner_offsets[f] to corner_offsets[f+1] - 1, counterclockwise seen from outside the cell.
 *  Arrays that were not asked for are NULL. A face between two cells is listed in both. Later versions may append
 *  fields. */
typedef struct brio_cells {
    size_t size; /* of the struct in the library that runs */
    brio_context *context;
    size_t num_cells;
    uint32_t *site;         /* #C, ascending: the point that owns the cell */
    double *volume;         /* #C: infinite for unbounded cells, and where doubles cannot hold it */
    uint8_t *bounded;       /* #C: 1, or 0 for a cell that reaches infinity. Clipped cells are bounded. */
    double *area;           /* #C: of the cell's surface; infinite for unbounded cells */
    double *centroid;       /* #C by 3: NaN for cells of no volume or an infinite one */
    double volume_sum;      /* of the bounded cells */
    double region_volume;   /* of the polytope that clips; infinite without one */
    uint64_t *face_offsets; /* #C + 1 */
    int64_t
        *face_neighbours; /* #F: the site on the other side, or -1 - i for wall i of the region: the box' walls low x,
                                 high x, low y, high y, low z, high z are -1 to -6, then come the planes */
    double *face_areas;   /* #F: infinite for unbounded faces */
    double *face_normals; /* #F by 3: unit vectors out of the cell */
    uint64_t *corner_offsets; /* #F + 1 */
    uint32_t *face_vertices;  /* of each corner */
    size_t num_vertices;
    double *vertices;     /* #vertices by 3 */
    int32_t *face_shifts; /* #F by 3, of brio_periodic_cells: which translate of the neighbour; else NULL */
} brio_cells;

/** Computes the Voronoi cell of every vertex or, with weights, the power cell: the points of space whose distance
 *  (power distance) from the vertex is the least. Duplicates and hidden points have no cells. Without a region (box or
 *  planes), cells of vertices on the convex hull are unbounded.
 *  Faces: two cells share a face if they meet in a polygon; cells that meet in an edge or a point, as many cells of a
 *  lattice do, share none. This is decided exactly. A face can have a computed area of 0 if it is too small for
 *  doubles. In a region, a cell that lies outside has the volume 0 and no faces. What the walls cut off is decided
 *  exactly, too: two cells share a face if a part of it with an area is in the region, and a face that lies in a wall
 *  is the wall's. Of a region of planes that are no box, which corners it has is decided by rounded coordinates.
 *  Vertices: a vertex at the centre of tetrahedra is listed once, however many tetrahedra share it; a vertex that
 *  clipping made belongs to one cell. An unbounded face lists its finite vertices in order, from the end of one ray to
 *  the end of the other; unbounded cells of points of dimension 2 or less list none.
 *  Accuracy: vertices are rounded to doubles, after an error of 2^-44 of their distance from their sites. Errors of
 *  vertices cancel in the sum of the volumes: in a region it is region_volume up to about 1e-13 relative, if all cells
 *  are there, and up to about 2^-50 times the distance from 0 or from the sites to the region, divided by its side,
 *  where that is more. Compare volume_sum with region_volume to see; more than 1 % is BRIO_ERR_NO_ANSWER.
 *  Points of dimension 2 or less have cells too: prisms, slabs, or all of space, bounded in a region alone.
 *  t  the result of brio_delaunay for these points and weights, or NULL to compute it.
 *  points, weights, num_points, and limits as brio_delaunay.   options  NULL for the defaults.
 *  out  owned by the caller, freed with brio_cells_free; NULL on error.
 *  The result has the same bits for every number of threads. The numbers of a cell and of its faces, and the order of
 *  its faces (by the neighbours' positions), have the same bits in whatever order the points are given; volumes
 *  without areas, centroids and sizes of faces differ in their last bits then, and so do vertices that more than four
 *  points make.
 *  Cost: linear in the tetrahedra, beside brio_delaunay; about 52 bytes a tetrahedron, 110 a cell, 24 a point (32 with
 *  weights), and for faces 130 a face, 70 more with vertices. Least without areas, centroids and faces, or with faces
 *  but without their sizes: then a sweep over the tetrahedra gives the volumes, and one over the stars the neighbours,
 *  in less time than brio_delaunay takes and, of evenly spread points, about 390 bytes a point, 940 with neighbours.
 *  Cells for which the bound of the sweep's error is more than 2^-36 of the
 *  volume, clipped ones and those with ties are computed as the others.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (t has another number of points; the region is empty, too flat, unbounded, or too
 *  small or, 2^600 times, too large beside the points), BRIO_ERR_NO_ANSWER (see Accuracy), and as brio_delaunay.
 *  Based on: [Aurenhammer 1987], [Choi 2003] sections 2.1 and 2.2. */
BRIO_API brio_status brio_voronoi_cells(brio_context *ctx, const brio_triangulation *t, const double *points,
                                        const double *weights, size_t num_points, const brio_cells_options *options,
                                        brio_cells **out);

/** Frees cells with all their arrays; NULL is accepted. */
BRIO_API void brio_cells_free(brio_cells *cells);

/** File formats of cells. BRIO_CELLS_FORMAT_AUTO decides by the extension. */
typedef enum brio_cells_format {
    BRIO_CELLS_FORMAT_AUTO = 0,
    BRIO_CELLS_FORMAT_VTU = 1,       /* polyhedra of VTK; cells have `vertices`. Left out are unbounded and empty
                                  cells, and those with a vertex that doubles cannot hold. */
    BRIO_CELLS_FORMAT_NPY = 2,       /* a table of NumPy, a structured array of one dimension */
    BRIO_CELLS_FORMAT_CSV = 3,       /* a text with a header */
    BRIO_CELLS_FORMAT_FACES_CSV = 4, /* the faces as a text with a header; never chosen by the extension */
    BRIO_CELLS_FORMAT_END
} brio_cells_format;

/** Returns the format of a file name or of an extension with or without its dot; BRIO_CELLS_FORMAT_AUTO if it is
 *  unknown. */
BRIO_API brio_cells_format brio_cells_format_of(const char *path);

/** Writes cells to a file, with the care of brio_write. CSV and NPY have a row for each cell: site, volume, area, faces
 *  (their number), bounded, cx, cy, cz (the centroid). FACES_CSV has a row for each face of each cell: site, neighbour,
 *  area, nx, ny, nz. VTU has site, volume, area and faces as data of the cells. The cells
 *  have areas, centroids and faces; for VTU also vertices.
 *  comment  a line for the header of a VTU file; NULL: none.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an unknown format, or an array is missing), BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_cells_write(brio_context *ctx, const char *path, const brio_cells *cells,
                                      brio_cells_format format, const char *comment);

/** Makes a mesh of cells, to be looked at: a polygon for each face of each cell, with the properties "site" (uint32)
 *  and "volume" (float64) of the cell. Cells share no vertices: each is a closed solid, seen counterclockwise from
 *  outside. Cells without end, of no volume, and with vertices that doubles cannot hold are not there.
 *  cells     with vertices (brio_cells_options.vertices).
 *  most      of more cells an even choice of this number; 0: all.
 *  shrink    0, or how much each cell shrinks towards its middle, below 1: 0.1 shows gaps between them.
 *  left_out  NULL, or receives the number of cells that are not there.   out  owned by the caller.
 *  Cost: linear, 8 bytes a vertex beside the mesh.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_cells_mesh(brio_context *ctx, const brio_cells *cells, size_t most, double shrink,
                                     size_t *left_out, brio_mesh **out);

/** A file of cells that is written part after part: as brio_cells_write writes all cells at once. */
typedef struct brio_cells_table brio_cells_table;

/** Begins a file. It appears when it is complete.
 *  format     NPY, CSV or FACES_CSV.   num_cells  how many cells will come; only NPY needs it.
 *  out        owned by the caller: brio_cells_table_free; NULL on error.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_cells_table_new(brio_context *ctx, const char *path, brio_cells_format format,
                                          uint64_t num_cells, brio_cells_table **out);

/** Begins a piece of such a file: some successive rows, for who writes pieces side by side and puts them together.
 *  num_cells  of all pieces.   is_first  whether what stands before all rows is in it.
 *  The others as brio_cells_table_new has them, and so are the statuses. */
BRIO_API brio_status brio_cells_table_piece(brio_context *ctx, const char *path, brio_cells_format format,
                                            uint64_t num_cells, int is_first, brio_cells_table **out);

/** Appends the rows of cells, which have areas, centroids and faces.
 *  site  the number of each cell's site, in place of cells->site; NULL: those.   Returns as brio_cells_table_new. */
BRIO_API brio_status brio_cells_table_add(brio_context *ctx, brio_cells_table *table, const brio_cells *cells,
                                          const uint64_t *site);

/** Ends the file and gives it its name. Returns as brio_cells_table_new; BRIO_ERR_ARGUMENT where other numbers of cells
 *  came than were announced. */
BRIO_API brio_status brio_cells_table_finish(brio_context *ctx, brio_cells_table *table);

/** Frees the table. A file that was not finished disappears. NULL is accepted. */
BRIO_API void brio_cells_table_free(brio_cells_table *table);

#ifdef __cplusplus
}
#endif
#endif
