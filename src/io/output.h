/* Buffered output to a file that appears only when it is complete. The output is written to a file without a name in
 * the target's folder, flushed to the disk and named (platform/target.h). A target that is no regular file (standard
 * output, a device, a pipe) is written directly, and so is a descriptor that is open (/dev/stdout, /dev/fd/7)
 * whatever it leads to.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED. */
#ifndef BRIO_IO_OUTPUT_H
#define BRIO_IO_OUTPUT_H

#include "base/context.h"
#include "platform/target.h"

typedef struct brio_output {
    brio_context *ctx;
    const char *name;   /* for messages */
    brio_target target; /* target.is_new is false if the output is written directly */
    int file;
    bool owned; /* whether to close the file */
    bool waits; /* whether a write may block: the target is no regular file */
    char *buffer;
    size_t used;
    uint64_t written;  /* bytes written to the file */
    uint64_t given;    /* of these, the bytes that write_back (output.c) has asked the disk to take */
    uint64_t taken;    /* of these, the bytes that the disk has taken */
    uint64_t expected; /* estimate of all bytes, for progress */
} brio_output;

/** In place of an estimate: reports no progress. */
#define BRIO_NO_PROGRESS UINT64_MAX

/** Opens an output; "-" is standard output. Call brio_output_close even if this fails.
 *  expected  an estimate of all bytes, for progress. */
brio_status brio_output_open(brio_output *out, brio_context *ctx, const char *path, uint64_t expected);

/** Returns whether a path names one open descriptor or device: there are no files beside it. */
bool brio_output_is_single(const char *path);

/** Returns the open descriptor that a path of an output leads to: that of standard output for "-", that of
 *  brio_path_descriptor otherwise, or -1. */
int brio_open_descriptor(const char *path);

/** Returns the number of bytes that were given to the output. */
static inline uint64_t brio_output_offset(const brio_output *out) {
    return out->written + out->used;
}
/** Returns whether bytes that were written can be replaced: whether the output is a new file. */
static inline bool brio_output_can_patch(const brio_output *out) {
    return out->target.is_new;
}
/** Replaces bytes that were written. */
brio_status brio_output_patch(brio_output *out, uint64_t offset, const void *bytes, size_t size);

/** Writes the buffer and flushes the file to the disk. After this only the rename can fail. */
brio_status brio_output_finish(brio_output *out);
/** Gives a finished file its name. */
brio_status brio_output_publish(brio_output *out);
/** Gives `count` finished files their names: all of them or, where the file system can exchange names, none. */
brio_status brio_output_publish_all(brio_output *const *outs, int count);
/** Frees everything. A file that was not published disappears. */
void brio_output_close(brio_output *out);

/** Write bytes, or a text that ends with a 0. */
brio_status brio_output_bytes(brio_output *out, const void *bytes, size_t size);
brio_status brio_output_string(brio_output *out, const char *text);
/** Writes text as printf does: at most 511 bytes, no floating-point numbers, because printf prints these by the
 *  locale. */
brio_status brio_output_format(brio_output *out, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Write a number as text. The character `before` comes first, unless it is 0. */
brio_status brio_output_double(brio_output *out, char before, double x);
brio_status brio_output_integer(brio_output *out, char before, int64_t x);
/** Writes scalar i of a property. */
brio_status brio_output_scalar(brio_output *out, char before, const brio_property *property, size_t i);
/** Writes the three coordinates of a vertex, separated by blanks. */
brio_status brio_output_point(brio_output *out, const double *point);

/** Writes a comment, each line behind `prefix`. comment NULL writes nothing. */
brio_status brio_output_comment(brio_output *out, const char *prefix, const char *comment);

#endif
