/* Sizes of triangles, and what of them stays, on shapes whose samples are known. */
#include "base/memory.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/open_surface/face_sizes.h"
#include "reconstruct/open_surface/hole_cut.h"
#include <math.h>
#include <string.h>

enum { MOST = 4096 };
static double point[3 * MOST];
static float outside[MOST][3], scanner[MOST][3];
static uint32_t face[3 * MOST];
static double radius[MOST], usual[MOST];
static uint8_t part[MOST];
static size_t num_points, num_faces;

static uint32_t add_point(double x, double y, double z, const double out[3], const double to[3]) {
    point[3 * num_points] = x, point[3 * num_points + 1] = y, point[3 * num_points + 2] = z;
    for (int k = 0; k < 3; k++) outside[num_points][k] = (float)out[k], scanner[num_points][k] = (float)to[k];
    return (uint32_t)num_points++;
}

static void add_face(uint32_t a, uint32_t b, uint32_t c) {
    face[3 * num_faces] = a, face[3 * num_faces + 1] = b, face[3 * num_faces + 2] = c;
    num_faces++;
}

static void add_cell(uint32_t a, uint32_t b, uint32_t c, uint32_t d) {
    add_face(a, b, c), add_face(a, c, d);
}

/* Measures the triangles and cuts the holes of a surface that is known to be open.   holes  freed by the caller, on
 * failure too. */
static brio_status list_holes(brio_context *ctx, bool knows_outside, bool knows_scanner, brio_hole_list *holes) {
    brio_status status = BRIO_OK;
    brio_triangle_net net = {.ctx = ctx};
    const brio_hole_rule rule = {.choice = BRIO_HOLES_SEEN, .proven = true};
    BRIO_TRY(brio_triangle_net_new(ctx, point, num_points, face, num_faces, &net));
    net.outside = knows_outside ? (const float(*)[3])outside : NULL;
    net.scanner = knows_scanner ? (const float(*)[3])scanner : NULL;
    BRIO_TRY(brio_face_sizes(&net, radius, usual));
    BRIO_TRY(brio_cut_holes(&net, radius, usual, &rule, part, holes));
done:
    brio_triangle_net_free(&net);
    return status;
}

static brio_status measure(brio_context *ctx, bool knows_outside, bool knows_scanner) {
    brio_hole_list holes = {.ctx = ctx};
    brio_status status = list_holes(ctx, knows_outside, knows_scanner, &holes);
    brio_hole_list_free(&holes);
    return status;
}

static void measure_well(bool knows_outside, bool knows_scanner) {
    brio_context *ctx = new_context();
    EXPECT(measure(ctx, knows_outside, knows_scanner) == BRIO_OK);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static size_t count_gone(size_t begin, size_t end) {
    size_t count = 0;
    for (size_t f = begin; f < end; f++) count += part[f] == BRIO_TRIANGLE_GONE;
    return count;
}

static const double RIGHT[3] = {1, 0, 0}, UP[3] = {0, 0, 1};

/* --- rows --- */

static void rows_six_spacings_apart_are_no_holes(void) {
    enum { ROWS = 12, LONG = 60 };
    num_points = num_faces = 0;
    for (int i = 0; i < ROWS; i++)
        for (int j = 0; j < LONG; j++) add_point(6 * i + 1.5 * sin(7.3 * j + i), j + 0.5 * (i % 2), 0, UP, UP);
    for (uint32_t i = 0; i + 1 < ROWS; i++)
        for (uint32_t j = 0; j + 1 < LONG; j++) {
            uint32_t a = i * LONG + j;
            add_cell(a, a + LONG, a + LONG + 1, a + 1);
        }
    for (int known = 0; known < 3; known++) {
        measure_well(known > 0, known > 1);
        EXPECT(count_gone(0, num_faces) == 0, "%zu of %zu", count_gone(0, num_faces), num_faces);
    }
}

/* --- half a cylinder --- */

/* Adds columns of samples along z, on a circle, and the triangles between them. Then joins the last column to the first:
 * the back, which nobody saw. Returns the number of triangles of the front. */
static size_t add_cylinder(uint32_t columns, uint32_t rows, const double *angle, double step, double lean) {
    num_points = num_faces = 0;
    for (uint32_t i = 0; i < columns; i++) {
        bool rim = i == 0 || i + 1 == columns;
        double to = angle[i] + (rim ? (i ? lean : -lean) : 0), out[3] = {cos(to), sin(to), 0};
        for (uint32_t j = 0; j < rows; j++) add_point(cos(angle[i]), sin(angle[i]), step * j, out, RIGHT);
    }
    size_t front = 0;
    for (uint32_t i = 0; i < columns; i++) {
        if (i + 1 == columns) front = num_faces;
        for (uint32_t j = 0; j + 1 < rows; j++) {
            uint32_t a = i * rows + j, b = (i + 1) % columns * rows + j;
            add_cell(a, b, b + 1, a + 1);
        }
    }
    return front;
}

/* The scanner is far away: samples are evenly spaced as it sees them, and three times as far apart at the sides. */
static void half_a_cylinder_is_open_at_the_back_and_nowhere_else(void) {
    enum { COLUMNS = 40 };
    double angle[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) angle[i] = asin(0.98 * (2.0 * i / (COLUMNS - 1) - 1));
    size_t front = add_cylinder(COLUMNS, 40, angle, 0.05, 0);
    for (int known = 0; known < 3; known++) {
        measure_well(known > 0, known > 1);
        EXPECT(count_gone(0, front) == 0, "%zu of %zu", count_gone(0, front), front);
        EXPECT(count_gone(front, num_faces) == num_faces - front, "%zu", count_gone(front, num_faces));
    }
}

/* The axes at the rim lean to the back. Its triangles are hardly wider than usual: only the scanner tells. Returns the
 * number of triangles of the front. */
static size_t add_limb(void) {
    enum { COLUMNS = 5 };
    double angle[COLUMNS];
    for (int i = 0; i < COLUMNS; i++) angle[i] = (40 * i - 80) * 3.14159265358979 / 180;
    return add_cylinder(COLUMNS, 12, angle, 0.7, 0.8);
}

static void no_scanner_saw_the_back_of_a_thin_limb(void) {
    size_t front = add_limb();
    measure_well(true, false);
    EXPECT(count_gone(0, num_faces) == 0, "%zu", count_gone(0, num_faces));
    measure_well(true, true);
    EXPECT(count_gone(0, front) == 0, "%zu", count_gone(0, front));
    EXPECT(count_gone(front, num_faces) == num_faces - front, "%zu", count_gone(front, num_faces));
    for (size_t p = 0; p < num_points; p++) scanner[p][0] = 0;
    measure_well(true, true);
    EXPECT(count_gone(0, num_faces) == 0, "scanners that are not known tell nothing");
}

/* Adds a wheel of the size of the limb, closed by triangles to two samples `far` away: a hole, as large as that. */
static void add_huge_hole(double far) {
    enum { RIM = 12 };
    const double unknown[3] = {0, 0, 0};
    uint32_t hub = add_point(100, 0, 0, UP, unknown), rim = hub + 1, x = rim + RIM, y = x + 1;
    for (int i = 0; i < RIM; i++) {
        double to = i * 3.14159265358979 / 6;
        add_point(100 + cos(to), sin(to), 0, UP, unknown);
    }
    add_point(far, 0, 0, UP, unknown);
    add_point(0, far, 0, UP, unknown);
    for (uint32_t i = 0; i < RIM; i++) {
        uint32_t next = (i + 1) % RIM;
        add_face(hub, rim + i, rim + next);
        add_face(rim + next, rim + i, i < RIM / 2 ? x : y);
    }
    add_face(x, rim, y);
    add_face(rim + RIM / 2, x, y);
}

/* Once all areas were sums in one unit, which the largest triangle of all gave. */
static void a_hole_does_not_depend_on_a_huge_one_elsewhere(void) {
    brio_context *ctx = new_context();
    brio_hole_list alone = {.ctx = ctx}, beside = {.ctx = ctx};
    static uint8_t part_alone[MOST];
    size_t front = add_limb(), all = num_faces;
    EXPECT(list_holes(ctx, true, true, &alone) == BRIO_OK && alone.count == 1);
    EXPECT(count_gone(0, front) == 0 && count_gone(front, all) == all - front);
    memcpy(part_alone, part, all);
    for (double far = 1e8; far < 1e13; far *= 100) {
        add_limb();
        add_huge_hole(far);
        EXPECT(list_holes(ctx, true, true, &beside) == BRIO_OK && beside.count == 2);
        const brio_hole *a = alone.hole, *b = beside.hole;
        EXPECT(b[1].usual_area > far * far && b[1].open, "%g", b[1].usual_area);
        EXPECT(a->area == b->area && a->usual_area == b->usual_area, "%g, %g", b->area, b->usual_area);
        EXPECT(a->facing == b->facing && a->viewing == b->viewing, "%g, %g", b->facing, b->viewing);
        EXPECT(a->widest == b->widest && a->open == b->open && a->unlikely == b->unlikely);
        EXPECT(memcmp(part_alone, part, all) == 0, "%zu of %zu", count_gone(0, all), count_gone(front, all));
        brio_hole_list_free(&beside);
    }
    brio_hole_list_free(&alone);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- a dense side and a coarse one --- */

enum { DENSE = 61, COARSE = 11, DEEP = 8 };

/* Rows a tenth apart end in an edge. On the other side of it samples are 0.6 apart, in the plane x = 0. The triangles from the
 * edge to these, without eight at each end, are *begin to the value that is returned. */
static size_t add_sides(bool bent, size_t *begin) {
    num_points = num_faces = 0;
    for (int i = 0; i < DEEP; i++)
        for (int j = 0; j < DENSE; j++) {
            double depth = 0.1 * (DEEP - 1 - i);
            add_point(bent ? -depth : 0, 0.1 * j, bent ? 0 : depth, bent ? UP : RIGHT, bent ? UP : RIGHT);
        }
    for (int i = 0; i < DEEP; i++)
        for (int j = 0; j < COARSE; j++) add_point(0, 0.6 * j, -0.5 - 0.6 * i, RIGHT, RIGHT);
    const uint32_t edge = (DEEP - 1) * DENSE, coarse = DEEP * DENSE;
    for (uint32_t i = 0; i + 1 < DEEP; i++)
        for (uint32_t j = 0; j + 1 < DENSE; j++) {
            uint32_t a = i * DENSE + j;
            add_cell(a, a + DENSE, a + DENSE + 1, a + 1);
        }
    for (uint32_t i = 0; i + 1 < DEEP; i++)
        for (uint32_t j = 0; j + 1 < COARSE; j++) {
            uint32_t a = coarse + i * COARSE + j;
            add_cell(a, a + COARSE, a + COARSE + 1, a + 1);
        }
    *begin = num_faces;
    for (uint32_t j = 0; j + 1 < DENSE; j++) {
        uint32_t near = (j + 3) / 6;
        add_face(edge + j, coarse + near, edge + j + 1);
        if (j % 6 == 2) add_face(coarse + near, coarse + near + 1, edge + j + 1);
    }
    *begin += 8;
    return num_faces - 8;
}

static double least_usual(size_t begin, size_t end) {
    double least = INFINITY;
    for (size_t f = begin; f < end; f++) least = fmin(least, usual[f]);
    return least;
}

/* The circle of a triangle of the dense side has the radius 0.0707. */
static void a_coarse_side_is_judged_by_its_own_samples(void) {
    size_t begin, end = add_sides(true, &begin);
    measure_well(true, false);
    EXPECT(least_usual(begin, end) > 0.2, "%g", least_usual(begin, end));
    EXPECT(count_gone(begin, end) == 0, "%zu", count_gone(begin, end));
    measure_well(false, false);
    EXPECT(least_usual(begin, end) < 0.08, "%g", least_usual(begin, end));
    end = add_sides(false, &begin);
    measure_well(true, false);
    EXPECT(least_usual(begin, end) < 0.08, "a gap in one sheet may be one: %g", least_usual(begin, end));
    measure_well(true, true);
    EXPECT(least_usual(begin, end) > 0.2, "the scanner tells: %g", least_usual(begin, end));
}

static brio_status measure_sides(brio_context *ctx) {
    return measure(ctx, true, true);
}

static void every_failed_allocation_is_a_status(void) {
    size_t begin;
    add_sides(true, &begin);
    expect_clean_failures(measure_sides);
}

SUITE(test_face_sizes) {
    RUN(rows_six_spacings_apart_are_no_holes);
    RUN(half_a_cylinder_is_open_at_the_back_and_nowhere_else);
    RUN(no_scanner_saw_the_back_of_a_thin_limb);
    RUN(a_hole_does_not_depend_on_a_huge_one_elsewhere);
    RUN(a_coarse_side_is_judged_by_its_own_samples);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
