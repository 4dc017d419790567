/* A simulated depth camera: a frame of a room with spheres, whose depths are rounded.
 *
 * The camera looks along z. Each pixel sees the nearest of the wall, the floor and the spheres, with noise that grows
 * with the square of the depth, as triangulation with a projector has it. The depth is rounded to whole millimetres,
 * and the other coordinates follow from the pixel. So neighbouring pixels lie on planes of equal depth, many of them at
 * the corners of squares: thousands of points on common circles, and rays that share a centre.
 *
 * Based on: Khoshelham, Oude Elberink. Accuracy and resolution of Kinect depth data for indoor mapping applications.
 * Sensors 2012 (noise and quantisation). */
#include "testdata/scan.h"
#include "base/rng.h"
#include <math.h>

/* Millimetres, and the tangent of half of the frame's view from side to side; those of common cameras. */
static const double WALL = 4000, FLOOR = 1200, HALF_VIEW = 0.55, NOISE = 1.5e-6;

static size_t width_of(size_t n) {
    size_t width = 4;
    while (width * (width * 3 / 4) < n) width += 4;
    return width;
}

brio_depth_frame brio_depth_frame_of(size_t n, uint64_t seed) {
    brio_depth_frame frame = {.width = width_of(n), .seed = seed};
    brio_rng rng = brio_rng_new(brio_mix(~seed));
    frame.height = frame.width * 3 / 4;
    for (int i = 0; i < BRIO_DEPTH_SPHERES; i++) {
        double z = 1500 + 2000 * brio_rng_double(&rng), side = 2 * brio_rng_double(&rng) - 1;
        double up = 2 * brio_rng_double(&rng) - 1, radius = 100 + 300 * brio_rng_double(&rng);
        double *s = frame.sphere[i];
        s[0] = HALF_VIEW * side * z, s[1] = 0.75 * HALF_VIEW * up * z, s[2] = z, s[3] = radius;
    }
    return frame;
}

/* Returns the depth at which the ray (x, y, 1) meets a sphere first, or the wall's. */
static double depth_of_sphere(const double *s, double x, double y) {
    double a = x * x + y * y + 1, b = x * s[0] + y * s[1] + s[2];
    double c = s[0] * s[0] + s[1] * s[1] + s[2] * s[2] - s[3] * s[3], inside = b * b - a * c;
    return inside > 0 ? (b - sqrt(inside)) / a : WALL;
}

void brio_depth_point(const brio_depth_frame *frame, size_t i, double *p) {
    brio_rng rng = brio_rng_new(brio_mix(frame->seed) + i);
    double pixel = 2 * HALF_VIEW / (double)frame->width;
    size_t row = i / frame->width;
    double x = ((double)(i % frame->width) + 0.5) * pixel - HALF_VIEW;
    double y = ((double)row + 0.5 - 0.5 * (double)frame->height) * pixel;
    double z = y > 0 ? fmin(WALL, FLOOR / y) : WALL, noise = 0;
    for (int k = 0; k < BRIO_DEPTH_SPHERES; k++) z = fmin(z, depth_of_sphere(frame->sphere[k], x, y));
    for (int k = 0; k < 4; k++) noise += brio_rng_double(&rng) - 0.5; /* nearly normal, of deviation 0.58 */
    z = floor(z + NOISE * z * z * noise / 0.58 + 0.5);
    p[0] = x * z, p[1] = y * z, p[2] = z;
}
