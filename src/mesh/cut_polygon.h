/* Polygons cut into triangles. */
#ifndef BRIO_MESH_CUT_POLYGON_H
#define BRIO_MESH_CUT_POLYGON_H

#include "base/context.h"

/** Cuts a polygon into count - 2 triangles between its corners, which it covers once where it is flat and does not
 *  cross itself: the fan from the first corner, where none of its triangles is turned over; else ears, cut off one
 *  after another. Polygons of more than 256 corners are cut into fans.
 *  vertices  of the mesh.   corners  count of them, at least 3; the polygon's vertices.   triangles  count - 2.
 *  room      count numbers of work space. */
void brio_cut_polygon(const double *vertices, const uint32_t *corners, size_t count, uint32_t *room,
                      uint32_t (*triangles)[3]);

#endif
