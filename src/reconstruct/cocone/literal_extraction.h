/* The co-cone's candidates, pruned and walked on as the dissertation has it. */
#ifndef BRIO_RECONSTRUCT_LITERAL_EXTRACTION_H
#define BRIO_RECONSTRUCT_LITERAL_EXTRACTION_H

#include "reconstruct/cocone/cocone_candidates.h"

/** Makes faces of the candidates: of all, of those left at no sharp edge, or of those that a walk on the outside of
 *  each component of these meets. A walk's faces are counterclockwise as seen from outside; others lie either way.
 *  extraction  not BRIO_EXTRACTION_LABELS.   cocones  loses the candidates that are pruned.
 *  pruned      receives their number.
 *  faces       *num_faces by 3, owned by the caller (brio_release), on failure too.
 *  Returns BRIO_OK, BRIO_ERR_NO_MEMORY. */
brio_status brio_extract_literally(brio_context *ctx, const brio_cocones *cocones, brio_extraction extraction,
                                   size_t *pruned, uint32_t **faces, size_t *num_faces);

#endif
