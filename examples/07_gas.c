/* A gas: particles fly in a box and bounce off its walls; some leave, others come in. The triangulation lives through all
 * steps, and at the end it is the one that is built of the particles that are left. Then the same without walls: what
 * leaves the box comes back on its other side. */
#include "common.h"

enum { NUM_PARTICLES = 2000, STEPS = 50, EXCHANGED = 5 };

static uint32_t drawn = 1;

/* Returns a number in [0, 1), the same on every machine. */
static double draw(void) {
    drawn = drawn * 1664525u + 1013904223u;
    return drawn * 0x1p-32;
}

/* Moves a coordinate; what flies through a wall comes back. */
static void fly(double *x, double *v) {
    *x += *v;
    if (*x < 0 || *x > 1) {
        *x = *x < 0 ? -*x : 2 - *x;
        *v = -*v;
    }
}

static double position[3 * NUM_PARTICLES], velocity[3 * NUM_PARTICLES];
static uint32_t particle[NUM_PARTICLES]; /* the triangulation's index of each */

/* A particle leaves, and another one comes in. */
static void exchange(brio_context *ctx, brio_dynamic *gas, size_t i) {
    CHECK(ctx, brio_dynamic_remove(gas, &particle[i], 1));
    for (size_t c = 0; c < 3; c++) position[3 * i + c] = draw();
    CHECK(ctx, brio_dynamic_insert(gas, position + 3 * i, NULL, 1, &particle[i]));
}

/* Particles fly on in a box that repeats. */
static void fly_in_space_that_repeats(brio_context *ctx) {
    static const double box[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    const brio_periodic_options options = {.size = sizeof options, .cell = box};
    brio_dynamic_periodic *gas = NULL;
    brio_periodic *built = NULL;
    brio_dynamic_periodic_stats facts = {.size = sizeof facts};
    const brio_image *neighbours;
    size_t count;
    uint64_t lived, anew;
    static double left[3 * NUM_PARTICLES];
    CHECK(ctx, brio_dynamic_periodic_new(ctx, position, NULL, NUM_PARTICLES, &options, &gas));
    for (int step = 0; step < STEPS; step++) {
        for (size_t i = 0; i < 3 * NUM_PARTICLES; i++) position[i] += velocity[i];
        CHECK(ctx, brio_dynamic_periodic_move(gas, NULL, position, NULL, NUM_PARTICLES));
    }
    CHECK(ctx, brio_dynamic_periodic_neighbours(gas, 0, &neighbours, &count));
    printf("in space that repeats, particle 0 has %zu neighbours\n", count);
    CHECK(ctx, brio_dynamic_periodic_facts(gas, &facts));
    printf("some particles were taken out and put in again: %s\n", yes(facts.replaced > 0));
    brio_dynamic_periodic_points(gas, NULL, left, NULL);
    CHECK(ctx, brio_dynamic_periodic_checksum(ctx, gas, &lived));
    CHECK(ctx, brio_delaunay_periodic(ctx, left, NULL, facts.points, &options, &built));
    CHECK(ctx, brio_periodic_checksum(ctx, built, &anew));
    printf("the same as built of the particles: %s\n", yes(lived == anew));
    CHECK(ctx, brio_dynamic_periodic_check(ctx, gas));
    printf("passes the exact check: yes\n");
    brio_periodic_free(built);
    brio_dynamic_periodic_free(gas);
}

int main(void) {
    brio_context *ctx = NULL;
    brio_dynamic *gas = NULL;
    brio_triangulation *built = NULL;
    brio_dynamic_stats facts = {.size = sizeof facts};
    uint64_t lived, anew;
    static double left[3 * NUM_PARTICLES];
    CHECK(ctx, brio_context_new(NULL, &ctx));
    for (size_t i = 0; i < 3 * NUM_PARTICLES; i++) {
        position[i] = draw();
        velocity[i] = 1e-3 * (draw() - 0.5);
    }
    CHECK(ctx, brio_dynamic_new(ctx, position, NULL, NUM_PARTICLES, 0, &gas));
    for (uint32_t i = 0; i < NUM_PARTICLES; i++) particle[i] = i;

    for (int step = 0; step < STEPS; step++) {
        for (size_t i = 0; i < 3 * NUM_PARTICLES; i++) fly(&position[i], &velocity[i]);
        CHECK(ctx, brio_dynamic_move(gas, particle, position, NULL, NUM_PARTICLES));
        for (int k = 0; k < EXCHANGED; k++) exchange(ctx, gas, (size_t)(draw() * NUM_PARTICLES));
    }

    CHECK(ctx, brio_dynamic_facts(gas, &facts));
    printf("%zu particles, %zu indices given out\n", facts.points, facts.indices);
    printf("built anew on the way: %s\n", yes(facts.anew > 0));
    brio_dynamic_points(gas, NULL, left, NULL);
    CHECK(ctx, brio_dynamic_checksum(ctx, gas, &lived));
    CHECK(ctx, brio_delaunay(ctx, left, NULL, facts.points, NULL, &built));
    CHECK(ctx, brio_triangulation_checksum(ctx, built, left, &anew));
    printf("the same as built of the particles: %s\n", yes(lived == anew));
    CHECK(ctx, brio_dynamic_check(ctx, gas));
    printf("passes the exact check: yes\n");

    brio_triangulation_free(built);
    brio_dynamic_free(gas);
    fly_in_space_that_repeats(ctx);
    brio_context_free(ctx);
    return 0;
}
