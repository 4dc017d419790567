/* The numbers of an accessor of a glTF file. */
#ifndef BRIO_IO_GLB_COLUMN_H
#define BRIO_IO_GLB_COLUMN_H

#include "io/glb/glb_scene.h"

/* A file: what its JSON says, and its binary chunk. */
typedef struct brio_glb_file {
    brio_context *ctx;
    const char *name;
    brio_glb_scene scene;
    char *binary; /* NULL: there is none */
    uint64_t binary_size;
    uint64_t bytes; /* of JSON and binary data together */
} brio_glb_file;

/* Rows of numbers, all of which lie in a buffer. */
typedef struct brio_glb_column {
    const char *first;
    uint64_t stride, count;
    int type, components;
    bool normalized;
} brio_glb_column;

/** Finds the numbers of an accessor, and checks that all of them lie in their buffer.
 *  what  what the accessor is for, for the message.
 *  Returns BRIO_OK or BRIO_ERR_FORMAT. */
brio_status brio_glb_column_of(const brio_glb_file *file, uint32_t accessor, const char *what, brio_glb_column *out);

/** Returns a number as it is in the file, or with its scale: of normalized integers a number from 0 or -1 to 1. */
double brio_glb_raw(const brio_glb_column *column, uint64_t row, int component);
double brio_glb_scaled(const brio_glb_column *column, uint64_t row, int component);

#endif
