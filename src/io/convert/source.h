/* The points of a conversion: a file that can be gone through several times, with a choice among its points. */
#ifndef BRIO_IO_CONVERT_SOURCE_H
#define BRIO_IO_CONVERT_SOURCE_H

#include "io/convert/rows.h"
#include "io/read_job.h"
#include "platform/file.h"

typedef struct brio_source {
    brio_context *ctx;
    const char *path;
    const brio_convert_options *options;
    bool whole;           /* whether the first pass keeps the file in memory */
    bool torn;            /* whether faces, tetrahedra or edges lost corners to the choice among points */
    brio_read_job job;    /* of the last pass; job.mesh is the file in memory */
    uint64_t points_read; /* of a pass, before the choice */
    uint8_t *chosen;      /* of the points in the box: 1 for those that stay; NULL: all stay */
    uint64_t num_boxed;   /* points in the box, if `chosen` was made */
    uint64_t outliers, thinned;
    int passes;
    const brio_rows *rows;    /* NULL, or the points are rows of these, and the file is not read again: */
    uint64_t first, num_rows; /* from this one on, as many */
    brio_place_facts facts;   /* of a file that can be read again, as the first pass found it, if has_facts */
    bool has_facts;
} brio_source;

/** Returns whether a path names a file that can be read again. */
bool brio_source_rereadable(const char *path);

/** Goes through the points that stay: hands them to the sink, block by block, or as one mesh if the file is in memory.
 *  Returns what brio_read and the sink return. */
brio_status brio_source_pass(brio_source *s, const brio_sink *sink);

/** Chooses points: drops outliers, then thins. Goes through the file once. */
brio_status brio_source_choose(brio_source *s);

/** Returns BRIO_ERR_FORMAT: the passes found different things in the file. */
brio_status brio_source_changed(const brio_source *s);

void brio_source_free(brio_source *s);

#endif
