/* Methods for surfaces: what each is, and the function that makes its surface. */
#ifndef BRIO_RECONSTRUCT_METHOD_H
#define BRIO_RECONSTRUCT_METHOD_H

#include "base/context.h"

/** Makes a surface, as brio_surface describes it, in an empty mesh: adds the property "sample" and, where
 *  options.normals asks for them, writes the normals of the points. The source of a method repeats the declaration that
 *  stands above the table, so that the compiler holds the function against it.
 *  options  all its own, with the defaults that methods share.   stats  zeros. */
typedef brio_status brio_method_fn(brio_context *ctx, const double *points, size_t num_points,
                                   const brio_surface_options *options, brio_mesh *mesh, brio_surface_stats *stats);

/** A row of the table of methods. */
typedef struct {
    brio_surface_method_info info;
    const char *enumerator; /* as messages of the library call it */
    brio_method_fn *make;
    double bytes_a_point; /* measured at the peak, the points not included */
    /* Returns the bytes of the peak where options change it; NULL: bytes_a_point holds for all. */
    double (*bytes)(double points, const brio_surface_options *options);
} brio_method_row;

/** The samples that are explained where the caller says no number. */
enum { BRIO_MOST_EXPLAINED = 5000 };

/** Returns the row of a method, or NULL for a number that names none. */
const brio_method_row *brio_method_row_of(brio_surface_method method);

/** Returns the bytes that a method takes at its peak. */
double brio_method_bytes(const brio_method_row *row, double points, const brio_surface_options *options);

#endif
