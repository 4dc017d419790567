/* The inner loops of the insertion, in versions for several instruction sets. */
#ifndef BRIO_TRIANGULATION_ENGINE_H
#define BRIO_TRIANGULATION_ENGINE_H

#include "triangulation/locate_walk.h"

typedef struct brio_inserter brio_inserter;

enum { BRIO_BATCH = 8, BRIO_SOUND_BATCH = 64 };

typedef struct {
    /** Bit i of the result: whether p conflicts with the tetrahedron of facet handle facets[i], i < count. All
     *  BRIO_BATCH entries must be handles of valid tetrahedra. Same answers as brio_in_conflict. */
    unsigned (*conflicts)(const brio_tetrahedra *t, brio_filter *f, const uint32_t facets[BRIO_BATCH], size_t count,
                          const double *p);
    /** Finds all tetrahedra in conflict with record p, from one of them, which the thread owns, and the border of their
     *  union. *deferred becomes true, and everything is as before, when one of them may be another thread's. */
    brio_status (*dig)(brio_inserter *ins, uint32_t first, uint32_t p, bool *deferred);
    /** brio_locate_walk. */
    uint32_t (*walk)(const brio_tetrahedra *t, brio_zone *zone, brio_filter *f, brio_walk *walk, const double *p,
                     uint64_t most_steps);
    /** brio_locate_abreast. */
    void (*walk_abreast)(const brio_tetrahedra *t, brio_filter *f, brio_walk walks[BRIO_ABREAST],
                         const double (*points)[4], unsigned which, uint32_t *found);
    /** Bit i of the result, i < count: tets[i], a finite tetrahedron, is certainly positive, and no vertex behind a
     *  facet that it shares with a finite tetrahedron of higher number is in conflict with it. A bit of 0 says nothing.
     *  count     a multiple of BRIO_BATCH, at most BRIO_SOUND_BATCH.
     *  slack[i]  for a bit of 1: this stays so while each of these points is nearer than that to where it is. */
    uint64_t (*sound)(const brio_tetrahedra *t, const brio_filter *f, const uint32_t *tets, size_t count,
                      double *slack);
} brio_engine;

/** Returns the version for the instruction set in use. */
const brio_engine *brio_engine_choose(bool weighted);

/** The versions, without and with weights. */
extern const brio_engine brio_engine_plain[2], brio_engine_avx2[2], brio_engine_avx512[2];

#endif
