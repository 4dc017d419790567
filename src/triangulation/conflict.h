/* Conflict tests of several tetrahedra with one point. */
#ifndef BRIO_TRIANGULATION_CONFLICT_H
#define BRIO_TRIANGULATION_CONFLICT_H

#include "triangulation/tetrahedra.h"

enum { BRIO_BATCH = 4 };

/** Bit i of the result: whether p conflicts with tets[i], i < BRIO_BATCH. Entries beyond what is asked for must be
 *  valid tetrahedra too. Same answers as brio_in_conflict; uses vector instructions where the processor has them. */
typedef unsigned (*brio_conflicts_fn)(const brio_tetrahedra *t, brio_filter *f, const uint32_t tets[BRIO_BATCH],
                                      const double *p);

/** The fastest version that this processor runs. */
brio_conflicts_fn brio_conflicts_choose(bool weighted);

#endif
