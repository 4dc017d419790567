/* The bytes of one array after the other, however they are encoded: raw or as base 64, compressed or not, or numbers as
 * text. */
#ifndef BRIO_IO_VTK_DECODER_H
#define BRIO_IO_VTK_DECODER_H

#include "io/base64.h"
#include "io/vtk/vtk_header.h"
#include "io/vtk/vtk_zlib.h"

/* The blocks of a compressed array: all have block_size bytes when inflated, except the last one. */
typedef struct brio_vtk_blocks {
    uint64_t *packed; /* bytes of each block in the file */
    size_t capacity;
    uint64_t count, next; /* next: the block to begin after the present one */
    uint64_t block_size, last_size;
    uint64_t in_left, out_left; /* of the present block */
    bool open;                  /* whether there is a present block */
} brio_vtk_blocks;

typedef struct brio_vtk_decoder {
    brio_stream *stream;
    const brio_vtk_header *header;
    /* of the array that is open */
    const brio_vtk_array *array;
    brio_vtk_encoding encoding;
    bool swap;     /* whether the numbers are in the other byte order than this machine's */
    uint64_t left; /* bytes; UINT64_MAX for text, whose end is its end */
    brio_base64 base64;
    brio_vtk_blocks blocks;
    brio_vtk_zlib *zlib;
    char *input; /* compressed bytes that were base 64 */
    size_t input_begin, input_end;
} brio_vtk_decoder;

/** Opens the array whose first byte is the next one of the stream.
 *  encoding  how it is encoded.
 *  bytes     receives the size of the array, held against the size of the file; UINT64_MAX for text.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, as the next function. */
brio_status brio_vtk_decoder_open(brio_vtk_decoder *d, const brio_vtk_array *array, brio_vtk_encoding encoding,
                                  uint64_t *bytes);

/** Decodes the next bytes of the array, whole numbers, in the file's byte order if `swap` is set.
 *  got  receives their number, less than `size` only at the end of the array. */
brio_status brio_vtk_decoder_take(brio_vtk_decoder *d, void *to, size_t size, size_t *got);

/** Reads a number of a type of arrays from a word. Returns false if it is none, or the type cannot hold it. */
bool brio_vtk_parse(const char *word, int type, void *to);

void brio_vtk_decoder_free(brio_vtk_decoder *d);

#endif
