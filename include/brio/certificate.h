/* brio/certificate.h: what is wrong with a mesh, and how far it is from points and from other meshes. */
#ifndef BRIO_CERTIFICATE_H
#define BRIO_CERTIFICATE_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What the connectivity of a mesh's polygons says about the surface. Vertices at the same position count as distinct.
 *  Components are sets of faces joined across edges. The genus is the sum over the components of
 *  (2 - chi - boundary loops) / 2. */
typedef struct brio_certificate {
    size_t size;
    brio_context *context; /* that `genera` belongs to */
    int closed;            /* there are faces, none of fewer than three corners, and every edge has two of them */
    int manifold;          /* no edge has more than two faces; the faces at each vertex form one fan */
    int oriented;          /* the two faces of an edge run along it in opposite directions */
    size_t components;
    int64_t genus;
    int64_t *genera; /* of each component, the component with the most faces first; owned by the certificate */
    size_t boundary_edges, boundary_loops;
    size_t nonmanifold_edges, nonmanifold_vertices, flipped_edges;
    int64_t self_intersections; /* -1: not counted; a place for what brio_mesh_self_intersections counts */
    double area, volume;        /* volume is positive when the faces are seen counterclockwise from outside */
} brio_certificate;

/** Certifies the polygons of a mesh. Cost O(F log F).   out  zeros at first; freed with
 *  brio_certificate_free, also before it receives another certificate.
 *  Returns BRIO_OK (whatever the certificate says), BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_certificate(brio_context *ctx, const brio_mesh *mesh, brio_certificate *out);

/** Counts, exactly, the pairs of faces that meet in more than common corners and edges: faces that cross each other,
 *  touch, or overlap in one plane. Corners at equal positions are common corners. A polygon counts as the fan of
 *  triangles from its first corner; triangles of area 0 meet nothing.
 *  Cost: near-linear for faces of about equal size; 100 bytes a face.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_mesh_self_intersections(brio_context *ctx, const brio_mesh *mesh, int64_t *pairs);

/** Frees what a certificate owns and sets all fields but `size` to 0; NULL is accepted. */
BRIO_API void brio_certificate_free(brio_certificate *certificate);

/* --- surfaces that come in parts --- */

/** Some faces of a surface, each of which is in one part. */
typedef struct brio_faces_part {
    size_t size;
    size_t num_vertices, num_faces;
    const double *points;       /* #V by 3 */
    const uint64_t *index;      /* #V: numbers of the vertices, the same in all parts. No two rows of a part have one */
    const uint8_t *shared;      /* #V: not 0: other parts may have faces at this vertex. NULL: at each one */
    const uint32_t (*faces)[3]; /* #F: rows of points */
} brio_faces_part;

typedef struct brio_parts_options {
    size_t size;
    const char *scratch; /* a folder with room for 32 bytes for each face at a shared vertex, with sheets 104 */
    uint32_t buckets;    /* files into which these faces are divided, and of which one is in memory at a time; 0: 64 */
    int sheets;          /* not 0: the faces bound a solid, and where its parts touch in a vertex or an edge only, each
                            sheet of the surface has its own vertices, as brio_alpha_shape makes them. Then the surface
                            is closed, manifold and oriented */
    double low[3], high[3]; /* a box about all vertices. Areas and volumes are scaled by its size, volumes summed about
                               its centre, on which they depend where the surface is not closed. Zeros: about the
                               origin, and not scaled */
} brio_parts_options;

typedef struct brio_parts_stats {
    size_t size;
    uint64_t faces;
    uint64_t vertices; /* that faces use; with sheets, those of each sheet */
    uint64_t split;    /* with sheets: vertices beyond the indices that faces use */
    uint64_t scratch_bytes;
} brio_parts_stats;

/** A certificate of a surface that is in no memory as a whole.
 *
 *     brio_parts_options o = {.size = sizeof o, .scratch = "/var/tmp"};
 *     brio_parts_certificate_new(ctx, &o, &c);
 *     while (...) brio_parts_certificate_add(ctx, c, &part);
 *     brio_parts_certificate_end(ctx, c, &certificate, NULL);
 *     brio_parts_certificate_free(c); */
typedef struct brio_parts_certificate brio_parts_certificate;

/** Begins a certificate, and makes a folder in the scratch folder.
 *  out  owned by the caller: brio_parts_certificate_free; NULL on error.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (no scratch folder; a box that is not finite, or has no room),
 *  BRIO_ERR_OPEN (not a writable folder), BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_parts_certificate_new(brio_context *ctx, const brio_parts_options *options,
                                                brio_parts_certificate **out);

/** Adds a part. Of it nothing is kept but counts, at most 72 bytes for each patch of its faces, and what goes to the
 *  scratch folder.
 *  Cost: 55 bytes a face of the part while it is added, with sheets 95. With all threads. After a failure it takes no
 *  more parts.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range; a certificate that has ended; with sheets, faces that
 *  bound no solid), BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE (2^32 patches or more), BRIO_ERR_WRITE (the disk is full),
 *  BRIO_ERR_OPEN, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_parts_certificate_add(brio_context *ctx, brio_parts_certificate *c,
                                                const brio_faces_part *part);

/** Finds the certificate of all faces. It is that of brio_mesh_certificate, of one mesh whose vertices are the indices;
 *  with sheets, of that mesh as brio_alpha_shape splits it. Area and volume are exact sums of the triangles' rounded
 *  ones: equal for all ways to make parts and all numbers of threads, and to brio_mesh_certificate within rounding.
 *  out  zeros at first; freed with brio_certificate_free.   stats  NULL, or receives what was counted.
 *  Cost: reads the scratch files once, a file at a time: 90 bytes a face of it, with sheets 205.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (it has ended; with sheets, faces that bound no solid), BRIO_ERR_OPEN (a scratch
 *  file was cut or changed), BRIO_ERR_WRITE, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Aggarwal Vitter 1988]. */
BRIO_API brio_status brio_parts_certificate_end(brio_context *ctx, brio_parts_certificate *c, brio_certificate *out,
                                                brio_parts_stats *stats);

/** Frees everything, and removes the files; NULL is accepted. */
BRIO_API void brio_parts_certificate_free(brio_parts_certificate *c);

/* --- distances --- */

/** Distances between two surfaces, in the unit of the coordinates. */
typedef struct brio_distance {
    size_t size;
    double mean, rms, p95, hausdorff; /* from random points of each surface to the nearest point of the other one */
    double normal_consistency;        /* mean |cos| of the angle between the normals at a point and its nearest point */
    double diagonal;                  /* of the bounding box of mesh b */
} brio_distance;

/** Compares two surfaces. Takes `samples` random points of each (0: 100,000), uniform by area, and computes their exact
 *  distances from the triangles of the other surface.   out  zeros at first.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (a mesh without triangles, or whose faces have no area), BRIO_ERR_NOT_FINITE,
 *  BRIO_ERR_NO_ANSWER (doubles cannot hold the distances), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_mesh_distance(brio_context *ctx, const brio_mesh *a, const brio_mesh *b, size_t samples,
                                        uint64_t seed, brio_distance *out);

/** Measures how far points are from a surface: exactly the nearest point of its faces, and the side. Of a closed
 *  surface points inside have negative distances, by the winding number, exactly, whichever way its faces look. Of any
 *  other surface points behind the faces have: by the triangles at the nearest point, and where these disagree by their
 *  normals, weighted by angles. Vertices at one position count as one.   distance  #P, written.
 *  Cost: O(log F) expected a point, with all threads; 50 bytes a triangle.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range, or no face of three corners), BRIO_ERR_NOT_FINITE,
 *  BRIO_ERR_NO_ANSWER (doubles cannot hold the distances), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Baerentzen Aanaes 2005]. */
BRIO_API brio_status brio_mesh_signed_distances(brio_context *ctx, const brio_mesh *mesh, const double *points,
                                                size_t num_points, double *distance);

/** What of a surface points do not show, and what of the points a surface leaves. Lengths are in spacings of the points
 *  there: the spacing of a square grid with as many points within the distance of the sixth nearest one. */
typedef struct brio_coverage {
    size_t size;
    double far_share;    /* of the area: what is farther than five spacings from all points */
    size_t bridges;      /* sets of faces, joined across edges, that are over 2.5 spacings away somewhere, one over 5 */
    double bridge_share; /* of the area: that of the bridges */
    double
        bridge_radius; /* of the largest bridge, by area: how far it is from all points, and where; 0: there is none */
    double bridge_centre[3];
    size_t left_out; /* points that are farther than two spacings from the surface */
} brio_coverage;

/** Compares a surface, of any origin, with the points that it is to go through. Polygons count as fans.
 *  bridge  NULL, or #F: receives 1 for faces of bridges.   out  zeros at first.
 *  Cost: about ten nearest points a point and a face; 90 bytes a point and 110 a face.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range, no faces or no points), BRIO_ERR_NOT_FINITE,
 *  BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_mesh_coverage(brio_context *ctx, const brio_mesh *mesh, const double *points,
                                        size_t num_points, uint8_t *bridge, brio_coverage *out);

/** Finds the points that brio_coverage.left_out counts.
 *  left_out  NULL, or #P: receives 1 for points that are left out, 0 for others.   count  receives their number.
 *  Cost and errors as brio_mesh_coverage, without what the faces take. */
BRIO_API brio_status brio_mesh_left_out(brio_context *ctx, const brio_mesh *mesh, const double *points,
                                        size_t num_points, uint8_t *left_out, size_t *count);

#ifdef __cplusplus
}
#endif
#endif
