/* Encodes one chunk of a LAZ file after the other from LAS records. A packer belongs to one thread. */
#ifndef BRIO_IO_LAZ_PACKER_H
#define BRIO_IO_LAZ_PACKER_H

#include "io/las/laz_decoder.h"
#include "io/las/laz_items.h"
#include "io/las/laz_pen.h"

typedef struct brio_laz_packer brio_laz_packer;

/** Returns how many points a chunk of records should have: as LASzip's, or fewer if the records are long. */
uint32_t brio_laz_chunk_points(const brio_laz_form *form);

/** Returns the bytes of a packer. Those that a chunk does not need are not touched. */
size_t brio_laz_packer_bytes(const brio_laz_form *form);
/** Makes a packer.   memory  brio_laz_packer_bytes(form) bytes, owned by the caller. */
brio_laz_packer *brio_laz_packer_make(void *memory, const brio_laz_form *form);

/** Encodes a chunk.
 *  count  1 to brio_laz_chunk_points(form).   bytes  receives the chunk, valid until the next call.
 *  Returns its bytes. */
size_t brio_laz_pack(brio_laz_packer *packer, const uint8_t *rows, size_t count, const uint8_t **bytes);

/* The items: each the counterpart of its _next function, which makes the same changes to the models. */
void brio_laz_point10_put(brio_laz_point10 *p, brio_laz_pen *pen, brio_laz_arena *arena, const uint8_t *row);
void brio_laz_time_put(brio_laz_time *t, brio_laz_pen *pen, brio_laz_arena *arena, uint32_t may_stay, uint64_t time);
void brio_laz_colour_put(brio_laz_colour_models *m, brio_laz_pen *pen, brio_laz_arena *arena, uint16_t last[3],
                         const uint16_t colour[3]);
void brio_laz_infrared_put(brio_laz_infrared_models *m, brio_laz_pen *pen, brio_laz_arena *arena, uint16_t *last,
                           uint16_t value);
/** Returns whether the channel changed. */
bool brio_laz_point14_put(brio_laz_point14 *p, brio_laz_pen *layers, brio_laz_arena *arena, const uint8_t *row);

#endif
