/* The arrays of an NPZ file, and what each is for. */
#ifndef BRIO_IO_NPZ_NPZ_ARRAYS_H
#define BRIO_IO_NPZ_NPZ_ARRAYS_H

#include "io/npy_header.h"
#include "io/npz/zip.h"

typedef enum {
    BRIO_NPZ_LEFT_OUT,
    BRIO_NPZ_POINTS, /* rows of coordinates, or records */
    BRIO_NPZ_X,      /* BRIO_NPZ_X + k: coordinate k of all points */
    BRIO_NPZ_Y,
    BRIO_NPZ_Z,
    BRIO_NPZ_PROPERTY,
    BRIO_NPZ_FACES,
    BRIO_NPZ_TETRAHEDRA
} brio_npz_use;

typedef struct brio_npz_array {
    const brio_zip_entry *entry;
    char name[64]; /* without .npy; empty if it is too long for a property */
    brio_npy_array header;
    brio_npz_use use;
} brio_npz_array;

typedef struct brio_npz {
    brio_zip zip;
    brio_npz_array *arrays;
    size_t num_arrays;
    uint64_t rows; /* of the points */
} brio_npz;

/** Reads the headers of all arrays. Call brio_npz_close even if this fails.   s  must outlive it.
 *  Returns as brio_zip_open. */
brio_status brio_npz_open(brio_npz *n, brio_stream *s);
void brio_npz_close(brio_npz *n);

/** Sets what each array is for.
 *  Returns BRIO_OK, or BRIO_ERR_FORMAT with a list of the arrays if it is not clear which one holds the points. */
brio_status brio_npz_choose(brio_npz *n);

#endif
