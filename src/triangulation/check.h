/* Parts of the exact check. */
#ifndef BRIO_TRIANGULATION_CHECK_H
#define BRIO_TRIANGULATION_CHECK_H

#include "triangulation/tetrahedra.h"

/** Checks a complete structure of tetrahedra over num_points records (view with BRIO_INFINITE); *canonical tells
 *  whether ties are broken as brio_delaunay does. BRIO_ERR_CHECK says what is wrong. */
brio_status brio_check_tetrahedra(brio_context *ctx, const brio_tetrahedra *t, size_t num_points, bool weighted,
                                  bool *canonical);

/** Dimension of the affine hull of records, exact: -1 for none, to 3. */
int brio_dimension(const brio_record *record, size_t num_points);

/** Checks which points of a flat input are vertices. */
brio_status brio_check_flat(brio_context *ctx, const brio_triangulation *t, const double *points,
                            const double *weights);

#endif
