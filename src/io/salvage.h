/* Keeps the whole rows of a file that ends early, where the caller asked for that (brio_builder.salvage). */
#ifndef BRIO_IO_SALVAGE_H
#define BRIO_IO_SALVAGE_H

#include "io/builder.h"
#include "io/stream.h"

/** Looks at the row s->row that was read, or could not be, because the file ended within it. A last line without its end is
 *  such a row unless the file announces no row behind it: its last number may have lost digits.
 *  before  the number of vertices before the row; what the row added disappears.
 *  points  whether the rows are the points, which b->missing then counts; other rows are named as left out.
 *  status  of the row; becomes that of this function if the row is given up.
 *  Returns whether the row and all behind it are given up. */
bool brio_salvage(brio_builder *b, brio_stream *s, uint64_t before, bool points, brio_status *status);

#endif
