/* A page: the program's text, and its layers, a mesh each.
 *
 * A layer is a row of blocks (block.h), then one description as JSON. The blocks, n the number of vertices on the page:
 *
 *     x y z                     n numbers of 21 bits: coordinates in steps from the least corner of the mesh's box
 *     exact-x exact-y exact-z   n doubles: coordinates
 *     vertices faces            numbers of the vertices and faces in the mesh
 *     triangles                 brio_page_triangles; corners: how many each face has, if some are no triangles
 *     boundary-0 boundary-1     ends of boundary edges; also nonmanifold-, flipped-, edges-
 *     crossing                  1 for faces that cross others
 *     tetrahedra-0 to -3        corners; hull-0 to -2: those of facets with one tetrahedron
 *     v0 v1 f0 f1 ...           properties of vertices and faces
 *     e-point e-place-0 ...     how the surface came to be (explanation.c), of each sample; e-vertices, e-tetrahedra
 *                               and e-polygons are the lengths of its lists, e-corners those of polygons
 *
 * Without brio_page_how.exact the blocks of exact coordinates and of numbers are missing. Properties in floating point
 * are whole numbers of 16 bits then: 0 for NaN and infinities, 1 to 65535 from the least to the greatest value.
 *
 * All name vertices as the page numbers them (sent_order.h). The description has what the numbers mean, all counts, the
 * properties' names and types, and the certificate. Blocks that nothing needs are not there. */
#ifndef BRIO_PAGE_PAGE_H
#define BRIO_PAGE_PAGE_H

#include "io/output.h"

/** The page without data, from web/page.html: what stands before the data, and what behind them. cmake/page.cmake
 *  makes them when brio is built. */
extern const unsigned char brio_page_head[], brio_page_tail[];
extern const size_t brio_page_head_size, brio_page_tail_size;

/** How a mesh is written. */
typedef struct {
    size_t number; /* of the layer, from 0 on */
    const char *name, *report;
    const brio_explanation *explanation; /* or NULL */
    size_t most_points;
    bool exact;              /* to the last bit: brio_page_options */
    bool self_intersections; /* finds the faces that cross others */
} brio_page_how;

/** Writes a layer.   thinned  receives the number of points that are left out.
 *  Returns what brio_write_page returns. */
brio_status brio_page_layer_write(brio_output *out, const brio_mesh *mesh, const brio_page_how *how, uint64_t *thinned);

/** Write how a surface came to be: its blocks, and its part of the description. Nothing for none. */
brio_status brio_page_explanation(brio_output *out, const brio_page_how *how);
brio_status brio_page_describe_explanation(brio_output *out, const brio_explanation *e);

/** Writes a text as a JSON string that may stand in an element of HTML: no <, no & in it. text NULL writes null. */
brio_status brio_page_json(brio_output *out, const char *text);

#endif
