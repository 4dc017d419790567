/* A simulated laser scanner. */
#ifndef BRIO_TESTDATA_SCAN_H
#define BRIO_TESTDATA_SCAN_H

#include <stddef.h>
#include <stdint.h>
#include "brio/testdata.h"
#include "base/memory.h"

/** Scans the sculpture with about n rays that hit. The options are valid. The vertices are listed view by view and row
 *  by row. The property "view" (uint16) is the index of the sensor position. */
brio_status brio_scan(brio_context *ctx, size_t n, const brio_generate_options *options, brio_mesh **out);

enum { BRIO_DEPTH_SPHERES = 8 };

/** What all pixels of a frame share. */
typedef struct {
    size_t width, height; /* of the frame, in pixels */
    uint64_t seed;
    double sphere[BRIO_DEPTH_SPHERES][4]; /* centre, radius */
} brio_depth_frame;

/** Returns a frame of n pixels, four to three, the last row perhaps not full. */
brio_depth_frame brio_depth_frame_of(size_t n, uint64_t seed);

/** Writes the point of pixel i, row by row, in millimetres. */
void brio_depth_point(const brio_depth_frame *frame, size_t i, double *p);

#endif
