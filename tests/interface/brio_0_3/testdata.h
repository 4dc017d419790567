/* brio/testdata.h: points and solids to try things on. They are a library beside libbrio, which the program, the tests
 * and the examples are linked with, and which is not installed. */
#ifndef BRIO_TESTDATA_H
#define BRIO_TESTDATA_H

#include "mesh.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef enum brio_kind {
    BRIO_KIND_CUBE = 0,     /* uniform in the unit cube */
    BRIO_KIND_BALL = 1,     /* uniform in the unit ball */
    BRIO_KIND_SPHERE = 2,   /* uniform on the unit sphere */
    BRIO_KIND_TORUS = 3,    /* uniform by area on the torus of radii 1 and 0.4 */
    BRIO_KIND_CYLINDER = 4, /* uniform on the side of the cylinder of radius 1 and height 4 */
    BRIO_KIND_GRID = 5,     /* the first n points of the smallest cubic integer grid that has n */
    BRIO_KIND_SCAN = 6,     /* a simulated laser scan of a sculpture of genus 3 */
    BRIO_KIND_CLUSTERS = 7, /* uniform in 256 balls in the unit cube, whose radii are log-uniform from 1e-7 to 0.1 */
    BRIO_KIND_MOMENT = 8,   /* (t, t^2, t^3), t uniform in [0, 1): about n^2 / 2 tetrahedra */
    BRIO_KIND_DEPTH = 9,    /* a frame of a depth camera, row by row, in mm, its depths rounded to 1 mm */
    BRIO_KIND_END
} brio_kind;

typedef struct brio_generate_options {
    size_t size;
    uint64_t seed;
    double noise; /* scan: standard deviation along the ray, in spacings of the samples; 0: 0.05; negative: none */
    int views;    /* scan: number of sensor positions; 0: 12 */
    int reserved_int;
} brio_generate_options;

/** Makes n points of a kind; the same seed gives the same points. A scan has about n points, as many as its rays hit,
 *  and the property "view".   options  NULL for the defaults.   out  owned by the caller.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (also where noise moves points of a scan farther than doubles can hold),
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_generate(brio_context *ctx, brio_kind kind, size_t n, const brio_generate_options *options,
                                   brio_mesh **out);

/** Returns the bytes that brio_generate needs for n points. */
BRIO_API uint64_t brio_estimate_generate(size_t num_points);

/** Makes the surface that BRIO_KIND_SCAN scans: a closed triangle mesh from a grid of `resolution` cells along the
 *  longest side of its box (4 to 32,768; 0: 160).
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
BRIO_API brio_status brio_generate_truth(brio_context *ctx, size_t resolution, brio_mesh **out);

/** Families of random solids. */
typedef enum brio_solid_kind {
    BRIO_SOLID_IMPLICIT = 0, /* organic: smooth blends of balls, tubes, rings and sheets, hollowed, trimmed, textured */
    BRIO_SOLID_MACHINED = 1, /* parts with sharp edges: plates, housings, turned parts, gears, frames */
    BRIO_SOLID_END
} brio_solid_kind;

/** Makes the surface of a random solid, to judge surface reconstruction by. It is a closed, manifold, oriented mesh of
 *  triangles, centred, in a box of diagonal 1. It has one to three components, seldom a void; its genus is what the
 *  certificate counts. Where an even sampling of 20,000 points has the spacing s, walls, gaps and bars are at least 1.2
 *  s thick, most of them 3 to 10 s. Sharp edges and corners are on edges and vertices of the mesh.
 *  The seed determines the solid, and with the resolution the mesh, for any number of threads.
 *  resolution  cells along the longest side of the box, 16 to 1,024; 0: 144.   out  owned by the caller.
 *  Cost: some seconds; about 8 R^2 triangles at resolution R.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_ANSWER (the resolution is too coarse to show anything),
 *  BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Ricci 1973], [Doi Koide 1991], [Ohtake Belyaev 2002]. */
BRIO_API brio_status brio_generate_solid(brio_context *ctx, brio_solid_kind kind, uint64_t seed, size_t resolution,
                                         brio_mesh **out);

#ifdef __cplusplus
}
#endif
#endif
