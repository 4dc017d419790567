/* Manifold surfaces as boundaries between labelled tetrahedra. */
#ifndef BRIO_RECONSTRUCT_MANIFOLD_EXTRACTION_H
#define BRIO_RECONSTRUCT_MANIFOLD_EXTRACTION_H

#include "reconstruct/tetrahedron_labels.h"

/** Changes labels until the boundary between outer and inner tetrahedra is a manifold at every sample. The infinite
 *  tetrahedra of watertight labels stay outer.
 *  changed  receives the number of changes.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_make_manifold(brio_context *ctx, brio_tet_labels *l, size_t *changed);

/** Writes the triangles between outer and inner tetrahedra, all of them or the candidates only, as faces of a mesh that
 *  are seen counterclockwise from outside. Of candidates that meet in a sample as several fans only the largest fan is
 *  kept. The labels have been through brio_make_manifold.   mesh  without faces; its vertices are the samples.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_extract_faces(brio_context *ctx, const brio_tet_labels *l, bool candidates_only, brio_mesh *mesh);

#endif
