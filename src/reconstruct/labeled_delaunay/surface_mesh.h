/* From triangles of samples to the mesh that the caller receives. */
#ifndef BRIO_RECONSTRUCT_SURFACE_MESH_H
#define BRIO_RECONSTRUCT_SURFACE_MESH_H

#include "base/context.h"

/** A surface whose vertices are samples. The struct owns nothing but the faces. */
typedef struct {
    size_t num_points;     /* of the caller */
    size_t num_samples;    /* at most #P */
    const double *points;  /* #P by 3: the caller's */
    const uint32_t *order; /* #S: the caller's index of each sample */
    const double *placed;  /* #S by 3: the samples in order, times 2^-exponent */
    int exponent;
    bool moved;              /* whether the samples in `placed` are elsewhere than the caller's points */
    const double *spacing;   /* #S: in order, of the unit of `placed` */
    const float *confidence; /* #S: in order, or NULL */
    const uint8_t *bridge;   /* #F */
    const float *size;       /* #F: the radius of the circle of each triangle, by the usual one */
    bool simplify;           /* whether edges are collapsed */
    uint32_t *faces;         /* #F by 3; the mesh takes them */
    size_t num_faces;
} brio_sample_surface;

/** Fills an empty mesh. The vertices are numbered in the caller's order.
 *  samples  NULL, or #P: receives for each vertex the index of its sample, ascending; of a simplified surface, the
 *           sample whose vertex it was before its edges collapsed.
 *  used     receives the number of samples that faces use.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_surface_mesh(brio_sample_surface *s, brio_mesh *mesh, uint32_t *samples, size_t *used);

#endif
