/* Decodes one chunk of a LAZ file after the other to LAS records. A decoder belongs to one thread. */
#ifndef BRIO_IO_LAZ_DECODER_H
#define BRIO_IO_LAZ_DECODER_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/** How the records of a file are compressed. */
typedef struct brio_laz_form {
    unsigned format;  /* of LAS points: 0 to 3, 6 to 10 */
    size_t record;    /* bytes of a record */
    size_t num_extra; /* of these, the bytes at the end that the format does not know */
    bool layered;     /* formats 6 to 10: layers, each with its own bytes */
    bool own_colours; /* layers of version 4: at a change of the channel colours and extra bytes change, too */
} brio_laz_form;

/** The most points that a byte stands for: the probabilities of the three models that every point uses make a point
 *  cost 0.008 bits or more, a byte at most 1000 points. Chosen, with a margin. */
enum { BRIO_LAZ_MOST_DENSE = 4096 };

typedef struct brio_laz_decoder brio_laz_decoder;

/** Returns the bytes of a decoder. Those that a chunk does not need are not touched. */
size_t brio_laz_decoder_bytes(const brio_laz_form *form);
/** Makes a decoder.   memory  brio_laz_decoder_bytes(form) bytes, owned by the caller. */
brio_laz_decoder *brio_laz_decoder_make(void *memory, const brio_laz_form *form);

/** Returns the bytes of a chunk of layers, or 0 if the `size` bytes are too few for the sizes of the layers.
 *  points  receives the number of points, if the sizes are there. */
uint64_t brio_laz_layers_bytes(const brio_laz_form *form, const uint8_t *bytes, size_t size, uint32_t *points);
/** Returns the bytes of a chunk of layers up to and with the sizes of the layers. */
size_t brio_laz_layers_head(const brio_laz_form *form);

/** Begins a chunk.   bytes  stay valid until the chunk is decoded.
 *  Returns false if the chunk is too short for its beginning. */
bool brio_laz_begin(brio_laz_decoder *d, const uint8_t *bytes, size_t size);
/** Decodes the next `count` records of the chunk.
 *  Returns false if the bytes ended before, or cannot come from an encoder. */
bool brio_laz_next(brio_laz_decoder *d, uint8_t *rows, size_t count);
/** Returns the bytes of the chunk that were used, for a chunk without layers. */
size_t brio_laz_used(const brio_laz_decoder *d);

#endif
