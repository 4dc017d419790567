/* One reading of a file, or of bytes in memory: of all of it into a mesh, or block by block into a sink. */
#ifndef BRIO_IO_READ_JOB_H
#define BRIO_IO_READ_JOB_H

#include "io/formats.h"

typedef struct brio_bytes {
    const void *bytes;
    size_t size;
} brio_bytes;

typedef struct brio_read_job {
    const char *path;
    const brio_bytes *memory; /* NULL, or what is read: the path is then only a name, "-" for none */
    brio_format format;       /* BRIO_FORMAT_AUTO becomes the format that was found */
    const char *columns;      /* as in brio_read_options */
    bool flat;                /* as in brio_read_options */
    bool drop_invalid;        /* as in brio_read_options */
    bool salvage;
    bool origins;              /* in: whether they are wanted; out: whether they were added */
    bool scans;                /* in: whether places of scanners and in their grids are wanted */
    uint64_t dropped, missing; /* points left out, and points that a file lacks, as in brio_read_options */
    const brio_sink *sink;     /* NULL: the mesh receives everything */
    uint64_t announced;        /* set before the sink's first call, as in brio_builder */
    bool streamed;             /* whether the sink received the vertices */
    brio_mesh *mesh;           /* what was read, owned by the caller, or NULL if it was streamed */
    char version[64];
    char (*left_out)[64]; /* names of what is in the file and not in the mesh, owned by the job: brio_read_job_free */
    size_t num_left_out;
    brio_read_notes notes; /* of brio_read_options; without their size */
} brio_read_job;

/** Frees what a job owns, except its mesh. */
void brio_read_job_free(brio_context *ctx, brio_read_job *job);

/** Reads a file. On failure job->mesh is NULL.   Returns what brio_read and the sink return. */
brio_status brio_read_file(brio_context *ctx, brio_read_job *job);

#endif
