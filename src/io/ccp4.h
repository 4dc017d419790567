/* Maps of densities in the CCP4 and MRC formats. */
#ifndef BRIO_IO_CCP4_H
#define BRIO_IO_CCP4_H

#include "io/stream.h"
#include "iso/volume.h"

/** Reads a map of mode 0 (8-bit), 1 (16-bit), 2 (32-bit float) or 6 (unsigned 16-bit), in either byte order and any
 *  order of axes. The volume has the axes x, y, z and the unit of the cell.
 *  out  freed with brio_volume_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT (with file and byte offset), BRIO_ERR_NOT_FINITE (with the first
 *  such value and their number), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_ccp4_read(brio_stream *s, brio_volume *out);

#endif
