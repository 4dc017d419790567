/* A simulated depth camera. */
#ifndef BRIO_TESTDATA_DEPTH_H
#define BRIO_TESTDATA_DEPTH_H

#include <stddef.h>
#include <stdint.h>

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
