/* A mesh of triangles whose edges collapse, as half-edges.
 *
 * Half-edge h of triangle h / 3 starts at vertex[h]; mate[h] is the half-edge of the same edge in the neighbouring
 * triangle. The half-edge with the smaller index names the edge.
 *
 * I1  vertex[h] is NONE in triangles that have vanished, and half_edge[v] is NONE when v has vanished.
 * I2  mate[mate[h]] == h; at the boundary mate[h] == h.
 * I3  error[h] is finite only if h names an edge that may be tried: neither end is on the boundary, the edge is not too
 *     long, its best point is within the tolerance, and no try has failed since one of its ends last changed.
 * I4  Vertices and triangles are numbered along a curve through space; vertex_name and face_name are their indices in
 *     the caller's mesh. */
#ifndef BRIO_MESH_COLLAPSE_MESH_H
#define BRIO_MESH_COLLAPSE_MESH_H

#include "mesh/simplify.h"
#include <stdbool.h>

/* --- quadrics --- */

/* Quadric errors: the sum of squared distances from planes, weighted by area, as a polynomial in the point.
 *
 * Based on: Garland, Heckbert. Surface simplification using quadric error metrics. SIGGRAPH 1997.
 * Differs from the paper: area weights the planes, and a small term draws each corner towards its original position. */

/** q(x) = x'Ax - 2 b'x + c, A = (xx, xy, xz, yy, yz, zz); `area` is the sum of the weights. */
typedef struct {
    double a[6], b[3], c, area;
} brio_quadric;

static inline void brio_quadric_sum(const brio_quadric *p, const brio_quadric *q, brio_quadric *sum) {
    for (int i = 0; i < 6; i++) sum->a[i] = p->a[i] + q->a[i];
    for (int i = 0; i < 3; i++) sum->b[i] = p->b[i] + q->b[i];
    sum->c = p->c + q->c;
    sum->area = p->area + q->area;
}

/** Returns the value at a point, or 0 if rounding makes the value negative. */
static inline double brio_quadric_at(const brio_quadric *q, const double *x) {
    const double *a = q->a;
    double ax = a[0] * x[0] + a[1] * x[1] + a[2] * x[2], ay = a[1] * x[0] + a[3] * x[1] + a[4] * x[2];
    double az = a[2] * x[0] + a[4] * x[1] + a[5] * x[2];
    double value = x[0] * (ax - 2 * q->b[0]) + x[1] * (ay - 2 * q->b[1]) + x[2] * (az - 2 * q->b[2]) + q->c;
    return value > 0 ? value : 0;
}

/** Writes the point of least value. Returns false when the quadric does not determine the point to about half the
 *  digits of a double. */
static inline bool brio_quadric_minimum(const brio_quadric *q, double *x) {
    const double *a = q->a, *b = q->b;
    double m[6] = {a[3] * a[5] - a[4] * a[4], a[2] * a[4] - a[1] * a[5], a[1] * a[4] - a[2] * a[3],
                   a[0] * a[5] - a[2] * a[2], a[1] * a[2] - a[0] * a[4], a[0] * a[3] - a[1] * a[1]};
    double det = a[0] * m[0] + a[1] * m[1] + a[2] * m[2], trace = a[0] + a[3] + a[5];
    if (!(det > 1e-8 * trace * trace * trace)) return false;
    x[0] = (m[0] * b[0] + m[1] * b[1] + m[2] * b[2]) / det;
    x[1] = (m[1] * b[0] + m[3] * b[1] + m[4] * b[2]) / det;
    x[2] = (m[2] * b[0] + m[4] * b[1] + m[5] * b[2]) / det;
    return true;
}

enum { BRIO_COLLAPSE_NONE = UINT32_MAX };

/* The bits of a vertex's mark. INSIDE: all neighbours belong to the vertex's block. SEEN: 0 between calls. */
enum { BRIO_COLLAPSE_BOUNDARY = 1, BRIO_COLLAPSE_INSIDE = 2, BRIO_COLLAPSE_SEEN = 4 };

typedef struct brio_collapse_guard brio_collapse_guard;

typedef struct {
    brio_context *ctx;
    const brio_collapse_options *options;
    size_t num_vertices, num_faces; /* at the beginning */
    double *position;               /* #V by 3; the caller's array */
    uint32_t *vertex, *mate;        /* #half-edges; vertex is the caller's array */
    float *error;                   /* #half-edges: in a unit in which the largest coordinate is about 1 */
    double unit;                    /* what an error is multiplied by to be in that unit */
    uint32_t *half_edge;            /* #V: a half-edge that starts at the vertex */
    uint8_t *marks;                 /* #V */
    double *spacing;                /* #V, or NULL: all 1 */
    brio_quadric *quadric;          /* #V */
    uint32_t *vertex_name, *face_name;
    uint32_t *second_order;     /* #V: the vertices along another curve */
    brio_collapse_guard *guard; /* collapses that make triangles cross are not tried; NULL: they are */
} brio_collapse_mesh;

static inline uint32_t brio_collapse_next(uint32_t h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}

static inline uint32_t brio_collapse_before(uint32_t h) {
    return h % 3 == 0 ? h + 2 : h - 1;
}

/** Returns the next half-edge round the start of h. */
static inline uint32_t brio_collapse_turn(const brio_collapse_mesh *m, uint32_t h) {
    return m->mate[brio_collapse_before(h)];
}

static inline uint32_t brio_collapse_end(const brio_collapse_mesh *m, uint32_t h) {
    return m->vertex[brio_collapse_next(h)];
}

static inline const double *brio_collapse_at(const brio_collapse_mesh *m, uint32_t v) {
    return m->position + 3 * (size_t)v;
}

/** Takes over the arrays of a mesh that is checked first: as brio_collapse_edges. Errors are not set.
 *  Returns the statuses of brio_collapse_edges; the caller calls brio_collapse_mesh_free in any case. */
brio_status brio_collapse_mesh_new(brio_context *ctx, brio_mesh *mesh, const brio_collapse_options *options,
                                   brio_collapse_mesh *out);

/** Writes what is left over the arrays of the caller's mesh, in the caller's order, and frees m's other arrays. */
brio_status brio_collapse_mesh_write(brio_collapse_mesh *m, brio_mesh *mesh);

void brio_collapse_mesh_free(brio_collapse_mesh *m);

#endif
