/* The scans of a file that is written: each is a run of points that one scanner saw from one place. Formats that hold
 * scans, E57 and PTX, are shown all points before they write the first one (row_format.h, survey).
 *
 * A new scan begins where x_origin, y_origin, z_origin or the number `scan` differ from those of the point before. */
#ifndef BRIO_IO_SCANS_H
#define BRIO_IO_SCANS_H

#include "io/row_format.h"

/** A scan. */
typedef struct brio_scan {
    uint64_t points;
    double place[3];        /* of the scanner; 0 where it is not known */
    uint64_t columns, rows; /* of the grid that column_index and row_index are places in */
    uint64_t next;          /* the first cell, column by column in a grid of 2^32 rows, that the next point may have */
    bool grid;              /* whether the points have places in a grid, column by column, each place once at most */
} brio_scan;

typedef struct brio_scans {
    brio_scan *list; /* one at least, once brio_scans_settle was called */
    size_t count, capacity;
    uint64_t points; /* of all scans */
    bool split;      /* whether scans and places are those of the points; otherwise there is one scan without a place */
    bool is_part;    /* whether the file is one of several: they are one scan if a reader gave them other numbers */
    bool has_number; /* whether the points have the property scan */
    bool numbered;   /* whether the property scan is the number of the scan, so that nobody has to store it */
    double number;   /* the property scan of the last point */
    double last[3];  /* the place of the last point */
    size_t current;  /* writing: the scan of the next point */
    uint64_t done;   /* writing: points of that scan that were written */
    bool rounds;     /* writing: whether a coordinate was rounded, because it is relative to its scan's place */
    double moved;    /* writing: how far a point of the last block is at most from where a reader finds it */
} brio_scans;

/** Do the work of a format (row_format.h) whose state begins with a brio_scans, as far as all such formats share
 *  them. */
brio_status brio_scans_survey(brio_context *ctx, const brio_write_job *job, void *state);
brio_status brio_scans_share(brio_context *ctx, void *state, const void *from, size_t columns);
uint64_t brio_scans_points(const void *state);
bool brio_scans_round(const void *state);
double brio_scans_moved(const void *state, const brio_mesh *block);
#define BRIO_SCANS_ROWS                                                                                                \
    .survey = brio_scans_survey, .surveyed_points = brio_scans_points, .share = brio_scans_share,                      \
    .rounds = brio_scans_round, .moved = brio_scans_moved

/** Ends the pass over all blocks. */
brio_status brio_scans_settle(brio_context *ctx, brio_scans *s);
void brio_scans_free(brio_context *ctx, brio_scans *s);

/** Returns whether property i of a mesh is held by the scans themselves: a place, or their number. */
bool brio_scans_hold(const brio_scans *s, const brio_mesh *m, size_t i);

/** A part of a block that lies in one scan. */
typedef struct brio_scan_part {
    const brio_scan *scan;
    size_t first, end; /* vertices of the block */
    bool begins, ends; /* whether they have the scan's first and last point */
} brio_scan_part;

/** Goes to the next part of a block.   part  `end` 0 before the first one.
 *  Returns whether there is one; points beyond those that were seen are in no part. */
bool brio_scans_next(brio_scans *s, const brio_mesh *block, brio_scan_part *part);

#endif
