/* Manifold surfaces as boundaries between labeled tetrahedra. */
#ifndef BRIO_RECONSTRUCT_MANIFOLD_EXTRACTION_H
#define BRIO_RECONSTRUCT_MANIFOLD_EXTRACTION_H

#include "reconstruct/cocone/label_boundary.h"

/** Changes labels until the boundary between outer and inner tetrahedra is a manifold at every sample. With
 *  labels->watertight infinite tetrahedra stay outer.
 *  facets   receives the boundary, as brio_boundary_facets lists it; facets->facet is owned by the caller
 *           (brio_release), on failure too.
 *  changed  receives the number of labels changed.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE, BRIO_ERR_CANCELLED. */
brio_status brio_make_manifold(brio_context *ctx, brio_tet_labels *labels, brio_facets *facets, size_t *changed);

/** Lists triangles between outer and inner tetrahedra, counterclockwise as seen from outside. Lists all of them, or the
 *  candidates and what fills small gaps between these. Where the triangles at a sample form several fans, keeps the
 *  largest fan only.
 *  facets  from brio_make_manifold.
 *  faces   *num_faces by 3, owned by the caller (brio_release), on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_extract_faces(brio_context *ctx, const brio_tet_labels *labels, bool candidates_only,
                               const brio_facets *facets, uint32_t **faces, size_t *num_faces);

#endif
