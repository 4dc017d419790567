/* Where the fan of a face starts: no triangle of it turns over where some start allows that. */
#include "harness.h"
#include "base/rng.h"
#include "reconstruct/power_crust/fan_start.h"
#include <math.h>
#include <stdbool.h>

static const double UP[3] = {0, 0, 1};

/* Returns twice the least signed area of the triangles of the fan from the first corner. */
static double least_area(const double *p, const uint32_t *corner, size_t size) {
    double least = INFINITY;
    for (size_t i = 1; i + 1 < size; i++) {
        const double *a = p + 3 * corner[0], *b = p + 3 * corner[i], *c = p + 3 * corner[i + 1];
        least = fmin(least, (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
    }
    return least;
}

/* Returns whether the corners are start, start + 1, ... round the polygon. */
static bool is_turned(const uint32_t *corner, size_t size) {
    for (size_t i = 0; i < size; i++)
        if (corner[i] != (corner[0] + i) % size) return false;
    return true;
}

static void good_fans_stay(void) {
    double p[3 * 5];
    uint32_t corner[5] = {0, 1, 2, 3, 4};
    for (int i = 0; i < 5; i++) p[3 * i] = cos(1.2566 * i), p[3 * i + 1] = sin(1.2566 * i), p[3 * i + 2] = 0;
    brio_turn_to_fan_start(p, corner, 5, UP);
    EXPECT(corner[0] == 0 && is_turned(corner, 5));
}

/* Squares with a corner pushed in across the line through its neighbours, at every place of the list. */
static void fans_start_where_no_triangle_turns_over(void) {
    static const double square[5][2] = {{0, 0}, {0.5, 1e-14}, {1, 0}, {1, 1}, {0, 1}};
    for (uint32_t shift = 0; shift < 5; shift++) {
        double p[3 * 5];
        uint32_t corner[5] = {0, 1, 2, 3, 4};
        for (uint32_t i = 0; i < 5; i++)
            p[3 * i] = square[(i + shift) % 5][0], p[3 * i + 1] = square[(i + shift) % 5][1], p[3 * i + 2] = 0;
        brio_turn_to_fan_start(p, corner, 5, UP);
        EXPECT(is_turned(corner, 5) && least_area(p, corner, 5) > 0, "shift %d", (int)shift);
    }
}

/* Whatever the polygon is, the corners keep their cyclic order; where no start is good, the worst triangle is the best
 * that any start allows. */
static void polygons_of_any_shape_keep_their_order(void) {
    brio_rng rng = brio_rng_new(1);
    for (int trial = 0; trial < 3000; trial++) {
        size_t size = 3 + (size_t)trial % 10;
        double p[3 * 12];
        uint32_t corner[12], other[12];
        for (size_t i = 0; i < size; i++) {
            corner[i] = (uint32_t)i;
            for (size_t k = 0; k < 3; k++) p[3 * i + k] = k < 2 ? floor(4 * brio_rng_double(&rng)) : 0;
        }
        brio_turn_to_fan_start(p, corner, size, UP);
        EXPECT(is_turned(corner, size), "trial %d", trial);
        double least = fmin(0, least_area(p, corner, size));
        for (uint32_t start = 0; start < size; start++) {
            for (uint32_t i = 0; i < size; i++) other[i] = (start + i) % (uint32_t)size;
            EXPECT(least >= fmin(0, least_area(p, other, size)), "trial %d", trial);
        }
    }
}

static void numbers_that_overflow_are_no_trouble(void) {
    double p[3 * 4] = {0, 0, 0, 1e300, 0, 0, 1e300, 1e300, 0, 0, 1e300, 0}, far[3] = {INFINITY, 1e300, -1e300};
    uint32_t corner[4] = {0, 1, 2, 3};
    brio_turn_to_fan_start(p, corner, 4, far);
    EXPECT(is_turned(corner, 4));
}

SUITE(test_fan_start) {
    RUN(good_fans_stay);
    RUN(fans_start_where_no_triangle_turns_over);
    RUN(polygons_of_any_shape_keep_their_order);
    RUN(numbers_that_overflow_are_no_trouble);
    return harness_end();
}
