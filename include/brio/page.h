/* brio/page.h: pages that show meshes in a browser, and pictures of them. */
#ifndef BRIO_PAGE_H
#define BRIO_PAGE_H

#include "explanation.h"

#ifdef __cplusplus
extern "C" {
#endif

/** A mesh on a page, with what is written beside it. Texts are UTF-8; bytes that are no UTF-8 count as Latin-1.
 *  Nothing in them is taken for HTML. Marks that turn the direction of text are shown as U+FFFD, all else as it is. */
typedef struct brio_page_layer {
    size_t size;
    const brio_mesh *mesh;
    const char *name;   /* such as the file's; NULL: a number */
    const char *report; /* NULL, or lines that the page shows beside the mesh */
    /* NULL, or how the surface came to be (brio_surface_options.explanation): a sample is picked, and the page shows
     * its cell, poles, polar balls, co-cone, labels, and the faces that were taken there. */
    const brio_explanation *explanation;
} brio_page_layer;

/** Options of a page. A field of 0 is the default. */
typedef struct brio_page_options {
    size_t size;
    const char *title;      /* NULL: the names of the layers */
    size_t most_points;     /* clouds of more points are thinned evenly to this number; 0: 5,000,000 */
    int exact;              /* 1: all numbers to the last bit; 0: if the layers have at most 250,000 vertices in all */
    int self_intersections; /* 1: finds the faces that cross others, and shows them */
    int side_by_side;       /* 1: the page opens with the layers side by side; 0: over each other */
    int reserved_int;
} brio_page_options;

/** What a page holds. */
typedef struct brio_page_stats {
    size_t size;
    uint64_t bytes;          /* of the file */
    uint64_t points_thinned; /* points that are not on the page */
    int exact;               /* 1: all numbers are there to the last bit */
    int reserved_int;
} brio_page_stats;

/** Writes a page that shows meshes: one HTML file, which asks for nothing over a network and needs a browser with
 *  WebGL 2. It shows points, faces, edges, tetrahedra with a cutting plane, properties as colours, and what
 *  brio_mesh_certificate finds: boundaries and edges of more than two faces. docs/view.md describes it.
 *  Coordinates are stored twice: in 21 bits of the largest side of the mesh's box, for pictures, and to the last bit,
 *  for what is picked. Without options.exact large layers lack the second, and the numbers of vertices and faces in
 *  the file; properties in floating point then have 16 bits of their range, and normals of meshes with faces are left
 *  out. The page says so. Arrays are compressed if the library was built with zlib, and stored otherwise.
 *  Faces of fewer than three corners are not shown.
 *  path     "-" is standard output; written as by brio_write.
 *  layers   num_layers pointers, 1 or more. An explanation takes about 800 bytes a sample.
 *  options  NULL for the defaults.   stats  NULL, or receives facts.
 *  Cost: linear, and the sort of the edges for the certificate. Memory beside the meshes, for one layer at a time: 50
 *  bytes a triangle, 45 a tetrahedron and 8 a vertex; for points 20 bytes each.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no layers, an index out of range, three tetrahedra share a facet),
 *  BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_write_page(brio_context *ctx, const char *path, const brio_page_layer *const *layers,
                                     size_t num_layers, const brio_page_options *options, brio_page_stats *stats);

/** Options of a picture. A field of 0 is the default. */
typedef struct brio_picture_options {
    size_t size;
    int width, height; /* in pixels, at most 16,384; 0: 960 and 640 */
    double from[3];    /* the direction in which the eye is; 0, 0, 0: of 49 directions the one that shows most */
    const char
        *colour; /* a property of vertices or faces, x, y or z, by a colour map, or none; NULL: the colours of the
                           mesh; else distance; of clouds also confidence, intensity, value or radius, else z.
                           Layers that show one property have one range of colours */
    int self_intersections; /* 1: finds the faces that cross others, and shows them in red */
    int side_by_side;       /* 1: the layers side by side; 0: over each other */
    int dark;               /* 1: a dark background */
    int reserved_int;
} brio_picture_options;

/** What a picture shows. */
typedef struct brio_picture_stats {
    size_t size;
    uint64_t bytes;   /* of the file */
    double from[3];   /* the direction in which the eye is, a unit vector */
    double pixel;     /* the length of a pixel in the unit of the meshes */
    double low, high; /* of the values of the colour map; 0 without one */
} brio_picture_stats;

/** Draws a picture of meshes, without a graphics card, and writes it as a PNG file. The projection is parallel, and
 * what is
 *  drawn fills the picture up to a margin; z is upright, or y where the eye looks along z. Faces are shaded, and their
 *  back sides have another colour; edges of one face are blue, of more than two pink, of two that run along it in one
 *  direction yellow. Of tetrahedra a half is left out, so that their inside is seen. Points without faces and edges are
 *  small balls.
 *  The bytes do not depend on the number of threads, nor on libraries.
 *  path     "-" is standard output; written as by brio_write.
 *  layers   num_layers pointers, 1 to 12; their reports are not used.
 *  options  NULL for the defaults.   stats  NULL, or receives facts.
 *  Cost: linear in the meshes and the pixels, and the sort of the edges for the marks; with all threads. Memory
 *  beside the meshes: 52 bytes a triangle, 40 a vertex, 3 a pixel, and 5 kB a column of pixels for each thread.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no layers or too many, the size, no layer has the property, an index out of
 *  range, three tetrahedra share a facet), BRIO_ERR_NOT_FINITE, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_write_picture(brio_context *ctx, const char *path, const brio_page_layer *const *layers,
                                        size_t num_layers, const brio_picture_options *options,
                                        brio_picture_stats *stats);

#ifdef __cplusplus
}
#endif
#endif
