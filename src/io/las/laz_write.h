/* Writes the compressed points of a LAZ file: chunks, and their table. */
#ifndef BRIO_IO_LAZ_WRITE_H
#define BRIO_IO_LAZ_WRITE_H

#include "io/las/laz_packer.h"
#include "io/output.h"

/** All bytes 0 before brio_laz_write_begin. */
typedef struct brio_laz_writer {
    brio_laz_form form;
    uint32_t chunk; /* points of one */
    int threads;
    struct brio_laz_worker *workers;
    uint8_t *rows; /* of as many chunks as there are threads */
    size_t num_rows;
    uint32_t *sizes; /* of the chunks that were written */
    size_t num_chunks, chunk_capacity;
    uint64_t place; /* where the file says where the table is */
} brio_laz_writer;

/* All return BRIO_OK, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */

/** Begins where the points do. */
brio_status brio_laz_write_begin(brio_laz_writer *w, brio_output *out, const brio_laz_form *form);
/** Takes records, and writes the chunks that are full. */
brio_status brio_laz_write_rows(brio_laz_writer *w, brio_output *out, const uint8_t *rows, size_t count);
/** Writes the last chunk and the table. The table's place is put in front of the chunks or, in a pipe, behind the table. */
brio_status brio_laz_write_end(brio_laz_writer *w, brio_output *out);
void brio_laz_write_free(brio_laz_writer *w, brio_context *ctx);

#endif
