/* A finished triangulation in the form that the kernel's functions read. */
#ifndef BRIO_TRIANGULATION_VIEW_H
#define BRIO_TRIANGULATION_VIEW_H

#include "triangulation/tetrahedra.h"

/** Returns the tetrahedra of a triangulation, with the caller's indices and without records. No code changes them
 *  through the view, although the type, which code that builds triangulations uses, too, would allow it. */
static inline brio_tetrahedra brio_tetrahedra_of(const brio_triangulation *t) {
    const brio_delaunay_stats *stats = brio_triangulation_stats(t);
    return (brio_tetrahedra){.tet = (brio_tetrahedron *)brio_triangulation_tetrahedra(t),
                             .count = stats->tetrahedra + stats->hull_facets,
                             .infinite = BRIO_INFINITE};
}

#endif
