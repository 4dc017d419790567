/* Location in triangulations of the plane. */
#ifndef BRIO_PYTHON_PLANE_H
#define BRIO_PYTHON_PLANE_H

#include "native.h"
#include <stdint.h>

enum { NO_TRIANGLE = -1, LOST = -2 };

/** A triangulation of the plane for queries: its triangles, a copy of its points, and a grid of squares, each with a
 *  triangle nearby where a walk begins. */
typedef struct {
    const brio_triangle *triangles;
    size_t count, hull, points;
    double *xy;
    size_t side; /* squares along a side of the grid */
    uint32_t *start;
    double low[2], scale[2];
} plane_locator;

/** Returns the triangle of lowest index whose closure holds x, NO_TRIANGLE outside the hull, or LOST if the points are not
 *  those of the triangulation. */
int32_t plane_find(const plane_locator *l, const double *x);

/** The sign of det [b-a, c-a]. */
int plane_turn(const double *a, const double *b, const double *c);

static inline const double *plane_corner(const plane_locator *l, uint32_t t, int i) {
    return l->xy + 2 * (size_t)l->triangles[t].vertex[i];
}

/** The sentence for a status of the functions of the plane. */
const char *plane_sentence(brio_status status);

PyObject *plane_interpolate(PyObject *module, PyObject *args);

/** Of the other slots of a triangle, the one after i and the one before. */
static inline int slot_after(int i) {
    return i == 2 ? 0 : i + 1;
}
static inline int slot_before(int i) {
    return i == 0 ? 2 : i - 1;
}

#endif
