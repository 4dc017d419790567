/* Conflict tests of several tetrahedra with one point. */
#ifndef BRIO_TRIANGULATION_CONFLICT_H
#define BRIO_TRIANGULATION_CONFLICT_H

#include "triangulation/tetrahedra.h"

enum { BRIO_BATCH = 8 };

/** Bit i of the result: whether p conflicts with the tetrahedron of facet handle facets[i], i < count. All BRIO_BATCH
 *  entries must be handles of valid tetrahedra. Same answers as brio_in_conflict. */
typedef unsigned (*brio_conflicts_fn)(const brio_tetrahedra *t, brio_filter *f, const uint32_t facets[BRIO_BATCH],
                                      size_t count, const double *p);

/** The fastest version that this processor runs. */
brio_conflicts_fn brio_conflicts_choose(bool weighted);

/** The versions with vector instructions; NULL where the compiler does not know them. */
brio_conflicts_fn brio_conflicts_avx2(bool weighted);
brio_conflicts_fn brio_conflicts_avx512(bool weighted);

#endif
