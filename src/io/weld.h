/* Vertices by their positions: corners at the same position become one vertex. */
#ifndef BRIO_IO_WELD_H
#define BRIO_IO_WELD_H

#include "io/builder.h"

typedef struct brio_weld {
    uint32_t *slots; /* vertex + 1 by the hash of its position; 0: none. At most half of the slots are used. */
    size_t size;     /* a power of two */
} brio_weld;

/** Finds the vertex at a position in the mesh under construction, or adds it.
 *  weld  {0} before the first call; freed by brio_weld_free.
 *  Returns BRIO_OK, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_weld_vertex(brio_weld *weld, brio_builder *b, const double *point, uint32_t *vertex);
void brio_weld_free(brio_context *ctx, brio_weld *weld);

#endif
