/* Manifold surfaces as boundaries between labeled tetrahedra. */
#ifndef BRIO_RECONSTRUCT_MANIFOLD_EXTRACTION_H
#define BRIO_RECONSTRUCT_MANIFOLD_EXTRACTION_H

#include "reconstruct/cocone/label_boundary.h"

/** Changes labels until the boundary between outer and inner tetrahedra is a manifold at every sample. The infinite
 *  tetrahedra of watertight labels stay outer.
 *  facets  receives the boundary, as brio_boundary_facets lists it; its array is owned by the caller (brio_release), on
 *          failure too.
 *  changed  receives the number of changes.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_make_manifold(brio_context *ctx, brio_tet_labels *l, brio_facets *facets, size_t *changed);

/** Lists the triangles between outer and inner tetrahedra, all of them or the candidates only, counterclockwise as seen
 *  from outside. Of candidates that meet in a sample as several fans only the largest fan is kept.
 *  facets  from brio_make_manifold.
 *  faces  *num_faces by 3, owned by the caller (brio_release), on failure too.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_extract_faces(brio_context *ctx, const brio_tet_labels *l, bool candidates_only,
                               const brio_facets *facets, uint32_t **faces, size_t *num_faces);

#endif
