/* Writes the compressed points of a LAZ file: items, chunks, and the table of chunks. */
#ifndef BRIO_IO_LAZ_WRITE_H
#define BRIO_IO_LAZ_WRITE_H

#include "io/las/laz_decoder.h"
#include "io/las/laz_items.h"
#include "io/las/laz_pen.h"
#include "io/output.h"

/* --- one chunk --- */

/* Encodes one chunk of a LAZ file after the other from LAS records. A packer belongs to one thread. */

typedef struct brio_laz_packer brio_laz_packer;

/** Returns how many points a chunk of records should have: as LASzip's, or fewer if the records are long. */
uint32_t brio_laz_chunk_points(const brio_laz_form *form);

/** Returns the bytes of a packer. Those that a chunk does not need are not touched. */
size_t brio_laz_packer_bytes(const brio_laz_form *form);

/** Encodes a chunk.
 *  count  1 to brio_laz_chunk_points(form).   bytes  receives the chunk, valid until the next call.
 *  Returns its bytes. */
size_t brio_laz_pack(brio_laz_packer *packer, const uint8_t *rows, size_t count, const uint8_t **bytes);

/* Encode items: each function is the counterpart of its _next function, and makes the same changes to the models. */
void brio_laz_point10_put(brio_laz_point10 *p, brio_laz_pen *pen, brio_laz_arena *arena, const uint8_t *row);
void brio_laz_time_put(brio_laz_time *t, brio_laz_pen *pen, brio_laz_arena *arena, uint32_t may_stay, uint64_t time);
void brio_laz_colour_put(brio_laz_colour_models *m, brio_laz_pen *pen, brio_laz_arena *arena, uint16_t last[3],
                         const uint16_t colour[3]);
void brio_laz_infrared_put(brio_laz_infrared_models *m, brio_laz_pen *pen, brio_laz_arena *arena, uint16_t *last,
                           uint16_t value);
/** Returns whether the channel changed. */
bool brio_laz_point14_put(brio_laz_point14 *p, brio_laz_pen *layers, brio_laz_arena *arena, const uint8_t *row);

/* --- all chunks --- */

/* Writes the compressed points of a LAZ file: chunks, and their table. */

/** All bytes 0 before brio_laz_write_begin. */
typedef struct brio_laz_writer {
    brio_laz_form form;
    uint32_t chunk; /* points of one */
    int threads;
    struct brio_laz_worker *workers;
    uint8_t *rows; /* of a chunk for each thread */
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
/** Writes the last chunk and the table. The table's place is put in front of the chunks or, in a pipe, behind the
 *  table. */
brio_status brio_laz_write_end(brio_laz_writer *w, brio_output *out);
void brio_laz_write_free(brio_laz_writer *w, brio_context *ctx);

#endif
