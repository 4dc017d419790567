/* Convex polyhedra that planes cut.
 *
 * A polyhedron is a list of faces, each a cycle of corners seen counterclockwise from outside. Corners are indices of
 * vertices, so that faces share vertices. Coordinates are relative to an origin of the owner's choice.
 *
 * I1  Every directed edge of a face is, reversed, an edge of exactly one other face. Vertices may coincide.
 * I2  With a judge, a vertex is the point of three planes, whose normals are independent, and its coordinates are this
 *     point, rounded. Then every decision of a cut is exact. Without one, coordinates decide.
 * I3  With a judge, a face is flat if and only if it has no area: it is kept for I1 alone.
 *
 * A polyhedron keeps its memory when it is filled again. One thread owns it. */
#ifndef BRIO_CELLS_POLYHEDRON_H
#define BRIO_CELLS_POLYHEDRON_H

#include "base/context.h"

/** The name of a vertex that a cut made. Other names are the owner's. */
#define BRIO_NO_NAME UINT32_MAX

/** The exact planes of a polyhedron; what the names of planes mean is the judge's. */
typedef struct brio_judge {
    /** Returns the sign of the determinant of the normals of three planes. */
    int (*orientation)(const void *user, const int64_t planes[3]);
    /** Returns 1 if the point of three planes is over a plane, -1 if it is under, 0 if it is on it.
     *  orientation  of the three planes, not 0. */
    int (*side)(const void *user, const int64_t planes[3], int orientation, int64_t plane);
    const void *user;
} brio_judge;

/** What a vertex is exactly: I2. */
typedef struct brio_exact_vertex {
    int64_t plane[3];
    int orientation;
} brio_exact_vertex;

typedef struct brio_face {
    int64_t neighbour; /* whose face: the owner's number; for a judge the plane */
    bool flat;         /* I3 */
    size_t begin, end; /* its corners */
} brio_face;

/** Faces and their corners. */
typedef struct brio_faces {
    brio_face *list;
    uint32_t *corner;
    size_t count, num_corners, capacity, corner_capacity;
} brio_faces;

/** A vertex between the vertices `in` and `out`, on the plane that cuts. */
typedef struct brio_cut_vertex {
    uint32_t in, out, vertex;
} brio_cut_vertex;

typedef struct brio_polyhedron {
    brio_context *ctx;
    double (*x)[3];
    uint32_t *name;           /* of each vertex */
    const brio_judge *judge;  /* NULL: coordinates decide */
    brio_exact_vertex *exact; /* of each vertex: I2; says nothing without a judge */
    size_t num_vertices;
    brio_faces faces;
    /* workspace of a cut */
    brio_faces kept;
    double *height;  /* of each vertex over the plane: positive for vertices that are cut off */
    uint32_t *after; /* of each vertex: the next corner of the new face */
    brio_cut_vertex *cut;
    size_t num_cut, x_capacity, name_capacity, exact_capacity, height_capacity, after_capacity, cut_capacity;
} brio_polyhedron;

/** Empties a polyhedron and keeps its memory. */
void brio_polyhedron_clear(brio_polyhedron *p);
void brio_polyhedron_free(brio_polyhedron *p);

/* The functions below that return a status return BRIO_OK or BRIO_ERR_NO_MEMORY. */

/** Adds a vertex.   exact  what the vertex is (I2); NULL without a judge. */
brio_status brio_polyhedron_add_vertex(brio_polyhedron *p, const double x[3], uint32_t name,
                                       const brio_exact_vertex *exact);
/** Begins a face; the corners that follow are its corners. */
brio_status brio_polyhedron_add_face(brio_polyhedron *p, int64_t neighbour);
brio_status brio_polyhedron_add_corner(brio_polyhedron *p, uint32_t vertex);

/** Fills a polyhedron with a box; its faces have the neighbours -1 to -6: low x, high x, low y, high y, low z, high
 *  z. */
brio_status brio_polyhedron_set_box(brio_polyhedron *p, const double low[3], const double high[3]);

/** Fills `p` with a copy of `from`, each vertex moved by -origin. The vertices have no names; what they are exactly
 *  stays. */
brio_status brio_polyhedron_copy(brio_polyhedron *p, const brio_polyhedron *from, const double origin[3]);

/** Cuts off what is over a plane: the points x with plane[0..2] . x > plane[3]. The face that closes the cut has the
 *  given neighbour. Nothing over the plane: no change. Nothing under it: the polyhedron becomes empty. With a judge the
 *  neighbour is the name of the exact plane, of which `plane` is the rounded one. */
brio_status brio_polyhedron_cut(brio_polyhedron *p, const double plane[4], int64_t neighbour);

/** Writes the area of a face times its unit normal. */
void brio_polyhedron_area(const brio_polyhedron *p, const brio_face *face, double area[3]);

/** Returns the volume, and adds to moment[0..2] the integral of the position over the polyhedron, unless moment is
 *  NULL. */
double brio_polyhedron_volume(const brio_polyhedron *p, double *moment);

#endif
