/* Buffered output to a file that appears only when it is complete: written under a temporary name beside the target,
 * flushed to the disk, renamed (target.h). What is not a regular file (standard output, a device, a pipe) is written
 * directly. */
#ifndef BRIO_IO_OUTPUT_H
#define BRIO_IO_OUTPUT_H

#include "io/target.h"

typedef struct brio_output {
    brio_context *ctx;
    const char *name;   /* for messages */
    brio_target target; /* its temporary is NULL for what is written directly */
    int file;
    bool owned; /* the file is to be closed */
    bool waits; /* a write may block: no regular file */
    char *buffer;
    size_t used;
    uint64_t written;  /* bytes that left the buffer */
    uint64_t given;    /* of these the disk was told to take, see output.c */
    uint64_t taken;    /* of these the disk has taken */
    uint64_t expected; /* bytes in all, about; for progress */
} brio_output;

/** Opens an output, "-" being standard output. The output is to be closed even when this fails. */
brio_status brio_output_open(brio_output *out, brio_context *ctx, const char *path, uint64_t expected);

/** Writes what is in the buffer and flushes the file: after this only the rename can fail. */
brio_status brio_output_finish(brio_output *out);
/** Gives a finished file its name. */
brio_status brio_output_publish(brio_output *out);
/** Frees everything; a file that is not published disappears. */
void brio_output_close(brio_output *out);

brio_status brio_output_bytes(brio_output *out, const void *bytes, size_t size);
brio_status brio_output_string(brio_output *out, const char *text);
/** Text made like that of printf; at most 511 bytes, and without floating-point numbers, which follow the locale. */
brio_status brio_output_format(brio_output *out, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Numbers as text, each behind `before` unless that is 0. */
brio_status brio_output_double(brio_output *out, char before, double x);
brio_status brio_output_integer(brio_output *out, char before, int64_t x);
/** Scalar i of a property. */
brio_status brio_output_scalar(brio_output *out, char before, const brio_property *property, size_t i);
/** The three coordinates of a vertex, with blanks between. */
brio_status brio_output_point(brio_output *out, const double *point);

/** A comment, each of its lines behind a prefix; NULL writes nothing. */
brio_status brio_output_comment(brio_output *out, const char *prefix, const char *comment);

#endif
