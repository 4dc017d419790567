/* brio: exact three-dimensional Delaunay and regular triangulations of very large point sets, and surface
 * reconstruction with guarantees on top of them.   MIT licence.
 *
 * The headers of this folder are the manual. This one has the words, promises and rules that hold in all of them, and
 * includes them; each can be included alone. A program that makes a surface from a scan:
 *
 *     #include <brio/brio.h>
 *     #include <stdio.h>
 *
 *     int main(void) {
 *         brio_context *ctx;
 *         brio_mesh *scan = NULL, *surface = NULL;
 *         if (brio_context_new(NULL, &ctx) != BRIO_OK) return 1;
 *         brio_status status = brio_read(ctx, "scan.ply", NULL, &scan);
 *         if (!status) status = brio_surface(ctx, scan->vertices, scan->num_vertices, NULL, &surface, NULL);
 *         if (!status) status = brio_write(ctx, "surface.ply", surface, NULL);
 *         if (status) fprintf(stderr, "%s\n", brio_message(ctx));
 *         brio_mesh_free(surface);
 *         brio_mesh_free(scan);
 *         brio_context_free(ctx);
 *         return status != BRIO_OK;
 *     }
 *
 * It is linked with what pkg-config --libs brio says (--static for libbrio.a, which needs the libraries that brio was
 * built with). NULL in place of options, or a struct of options that is all zeros, stands for the defaults. More:
 *
 *     closed, for a printer        brio_surface_options o = {.holes = BRIO_HOLES_CLOSED}; and brio_write to "part.stl"
 *     is it closed, its volume     brio_mesh_certificate(ctx, surface, &certificate), certificate.h
 *     the colours of the scan      brio_mesh_carry_properties(ctx, scan, brio_mesh_property(surface, "sample")->data,
 *                                  surface), mesh.h
 *     tetrahedra of points         brio_delaunay, triangulation.h; which of them holds a position: queries.h
 *
 * Shapes of arrays:
 *   #P, #V, #F, #T, #E, #Q   the number of points, vertices, faces (or facets), tetrahedra (triangles in the plane),
 *               edges, queries
 *   #P by 3     that many rows of three numbers, row after row in one array: coordinate k of point i is
 *               points[3 * i + k]
 *
 * Words, used in one meaning throughout:
 *   points      the rows of the input
 *   duplicates  points minus distinct positions. Among coincident points the one with the greatest weight represents
 *               the others; among equal weights, the one with the lowest index.
 *   vertices    distinct positions that own a Voronoi cell or, with weights, a power cell
 *   hidden      distinct positions that own no cell. There are none without weights. Each hidden point is represented
 *               by the vertex of least power distance; among equal distances, by the lexicographically first one.
 *               points = vertices + duplicates + hidden
 *   infinite    The infinite vertex BRIO_INFINITE closes the convex hull: every hull facet belongs to one infinite
 *               tetrahedron, whose fourth vertex is BRIO_INFINITE.
 *   facet       The handle 4*t + i names the facet of tetrahedron t opposite to its vertex i. Two handles that name the
 *               same triangle from its two sides are mates.
 *   positive    A tetrahedron (a, b, c, d) is positive when det [b-a, c-a, d-a] > 0.
 *   samples     points on a surface, known or not
 *   spacing     the distance from a sample to its neighbours: what the sampling can tell apart
 *   hull        the convex hull: the smallest convex set that holds all points
 *   Voronoi and power cells, poles   in cells.h and surface.h
 *
 * Promises.
 *   - The sign of every predicate is right for all finite doubles.
 *   - A point set has one set of tetrahedra: it does not depend on the order of the points, the insertion order, the
 *     location strategy or the number of threads. Ties are broken by a symbolic perturbation of the lifted coordinate
 *     whose key is the lexicographic position of the point [Devillers Teillaud 2011]. -0.0 equals 0.0.
 *   - The library reads the caller's arrays during a call. It does not keep, reorder or change them. Some functions
 *     bear that another thread changes the points, the weights or the queries meanwhile, whatever it writes: the result
 *     is then that of some numbers, or an error. They are brio_delaunay, brio_delaunay2, brio_delaunay2_flat and their
 *     checks, brio_points_hash, brio_convex_hull, brio_voronoi_cells without a triangulation, brio_voronoi2, brio_thin,
 *     brio_outliers, and the functions of brio_locator and brio_locator2. For all other functions, and for values,
 *     options and meshes, the arrays must not change. (To C, a change that is no atomic store is undefined even so.)
 *   - The library never prints, exits or aborts. Every function that can fail returns a status, and the context keeps
 *     a sentence that explains the failure.
 *   - The caller's floating-point state (rounding mode, subnormal numbers, traps) does not change a result: each
 *     function sets the state that it needs and restores the caller's state before it returns. Callbacks run in the
 *     library's state.
 *   - A stack of 64 KiB suffices in the calling thread.
 * Rules.
 *   - A function that makes an object takes `brio_X **out`, and the caller frees the object by brio_X_free. Results in
 *     a struct of the caller (brio_certificate, brio_edges, brio_incidences, brio_alpha_complex) begin as zeros, and
 *     are freed by the function of their name. What a function returns as a pointer to const is a view of an object,
 *     valid until that is freed or changed. Arrays that a function fills are the caller's.
 *   - A pointer is not NULL unless its function says that it may be; arrays of 0 elements may be NULL. An object must
 *     not be used after it or its context was freed.
 *   - After an error every out pointer to an object is NULL, and statistics and results hold nothing to be freed.
 *   - A context serves one call at a time. Functions of a mesh that take no context use the mesh's own, and count as a
 *     call with it; so do the functions that free. Several threads may read one mesh, triangulation or locator.
 *   - Callbacks call no function with the context but brio_message and brio_context_memory. They do not leave by
 *     longjmp or by an exception.
*/
#ifndef BRIO_H
#define BRIO_H

#include "context.h"          /* status, context, versions */
#include "surface.h"          /* surfaces from points */
#include "explanation.h"      /* how a surface came to be at its samples */
#include "files.h"            /* reading, writing, converting */
#include "mesh.h"             /* meshes and their properties */
#include "certificate.h"      /* of a mesh: closed, components, genus, area, volume, what is wrong; distances */
#include "page.h"             /* pages that show meshes in a browser */
#include "points.h"           /* thinning, outliers, samples of a mesh */
#include "triangulation.h"    /* Delaunay and regular triangulations */
#include "tiles.h"            /* triangulations of more points than fit in memory */
#include "ranks.h"            /* the same by many processes */
#include "dynamic.h"          /* triangulations that live: points inserted, removed, moved */
#include "queries.h"          /* location, nearest vertices, interpolation */
#include "cells.h"            /* Voronoi and power cells */
#include "periodic.h"         /* triangulations and cells of space that repeats */
#include "dynamic_periodic.h" /* the same in space that repeats */
#include "shapes.h"           /* convex hulls, alpha shapes, restricted triangulations */
#include "balls.h"            /* unions of balls */
#include "offset.h"           /* offsets of closed meshes */
#include "medial.h"           /* medial axes */
#include "iso.h"              /* iso-surfaces of maps and atoms */
#include "plane.h"            /* triangulations of the plane */
#include "curve.h"            /* curves of points in a plane */
#include "predicates.h"       /* exact signs */
#include "estimate.h"         /* memory that a call will take */

#endif
