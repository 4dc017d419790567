/* Points as rows of binary numbers: three coordinates, then the properties, packed, in this machine's byte order. */
#ifndef BRIO_IO_ROWS_H
#define BRIO_IO_ROWS_H

#include "io/formats.h"

/** Writes the vertices of job->mesh. Threads encode chunks of rows; each chunk is written as a whole. */
brio_status brio_rows_write(brio_output *out, const brio_write_job *job);

#endif
