/* Surfaces from tiles: the triangulation that parts make, and the surface, have the bits of one process, whatever the
 * points and the number of tiles. */
#include "base/context.h"
#include "brio/tiles.h"
#include "failing_allocator.h"
#include "harness.h"
#include "surface_points.h"
#include "tiles/work.h"

enum { KINDS = 8 };

/* --- the triangulation --- */

static void compare_triangulations(const brio_triangulation *a, const brio_triangulation *b, size_t n, int kind,
                                   uint32_t tiles) {
    const brio_delaunay_stats *x = brio_triangulation_stats(a), *y = brio_triangulation_stats(b);
    size_t all = x->tetrahedra + x->hull_facets;
    EXPECT(x->points == y->points && x->vertices == y->vertices && x->duplicates == y->duplicates &&
           x->dimension == y->dimension && x->hull_facets == y->hull_facets);
    EXPECT(x->tetrahedra == y->tetrahedra, "kind %d, %u tiles: %zu, not %zu", kind, tiles, y->tetrahedra,
           x->tetrahedra);
    if (x->tetrahedra != y->tetrahedra || x->hull_facets != y->hull_facets) return;
    EXPECT(!memcmp(brio_triangulation_tetrahedra(a), brio_triangulation_tetrahedra(b), all * sizeof(brio_tetrahedron)),
           "kind %d, %u tiles, %zu points", kind, tiles, n);
    EXPECT(!memcmp(brio_triangulation_representatives(a), brio_triangulation_representatives(b), n * sizeof(uint32_t)),
           "kind %d, %u tiles, %zu points", kind, tiles, n);
}

static void gather_and_compare(brio_context *ctx, const brio_triangulation *whole, size_t n, int kind, uint32_t tiles,
                               uint64_t seed) {
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = tiles};
    brio_tiles *t = NULL;
    brio_triangulation *gathered = NULL;
    EXPECT(brio_tiles_new(ctx, &o, &t) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_tiles_add(ctx, t, points, NULL, n) == BRIO_OK && brio_tiles_run(ctx, t) == BRIO_OK);
    brio_status status = brio_tiles_gather(t, points, n, seed, &gathered);
    EXPECT(status == BRIO_OK, "kind %d, %u tiles, %zu points: %s", kind, tiles, n, brio_message(ctx));
    if (status == BRIO_OK) compare_triangulations(whole, gathered, n, kind, tiles);
    brio_triangulation_free(gathered);
    brio_tiles_free(t);
}

static void parts_make_the_triangulation_of_all_points(void) {
    brio_context *ctx = new_context();
    for (uint64_t trial = 0; trial < (uint64_t)(SHORT_TESTS ? 24 : 1000); trial++) {
        brio_rng rng = brio_rng_new(trial);
        int kind = (int)(trial % KINDS);
        size_t most = trial % 4 == 3 ? 6 : trial % 5 ? 500 : 4000;
        size_t n = make_points(trial, 4 + brio_rng_below(&rng, (uint32_t)most), kind);
        uint32_t tiles = trial % 7 ? 1 + brio_rng_below(&rng, 12) : 64;
        brio_triangulation *whole = NULL;
        brio_delaunay_options o = {.size = sizeof o, .seed = trial % 5}; /* which the order depends on */
        EXPECT(brio_delaunay(ctx, points, NULL, n, &o, &whole) == BRIO_OK);
        if (brio_triangulation_stats(whole)->dimension == 3) gather_and_compare(ctx, whole, n, kind, tiles, o.seed);
        brio_triangulation_free(whole);
    }
    EXPECT(files_left() == 0);
    brio_context_free(ctx);
}

/* --- the surface --- */

static void compare_surfaces(brio_context *ctx, size_t n, int kind, uint32_t tiles,
                             const brio_surface_options *options) {
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = tiles};
    brio_mesh *whole = NULL, *tiled = NULL;
    brio_surface_stats a = {.size = sizeof a}, b = {.size = sizeof b};
    char sentence[512];
    brio_status expected = brio_surface(ctx, points, n, options, &whole, &a);
    snprintf(sentence, sizeof sentence, "%s", brio_message(ctx));
    brio_surface_options in_tiles = *options;
    in_tiles.tiles = &o;
    brio_status status = brio_surface(ctx, points, n, &in_tiles, &tiled, &b);
    EXPECT(status == expected, "kind %d, %u tiles, %zu points: %s", kind, tiles, n, brio_message(ctx));
    if (status != BRIO_OK) EXPECT(!strcmp(sentence, brio_message(ctx)), "%s / %s", sentence, brio_message(ctx));
    if (status == BRIO_OK && expected == BRIO_OK) {
        EXPECT(whole->num_vertices == tiled->num_vertices && whole->num_faces == tiled->num_faces,
               "kind %d, %u tiles, %zu points", kind, tiles, n);
        if (whole->num_vertices == tiled->num_vertices && whole->num_faces == tiled->num_faces) {
            EXPECT(!memcmp(whole->vertices, tiled->vertices, 24 * whole->num_vertices));
            EXPECT(!memcmp(whole->face_vertices, tiled->face_vertices, 12 * whole->num_faces));
        }
        EXPECT(a.samples == b.samples && a.holes == b.holes && a.energy == b.energy && a.handles == b.handles);
    }
    brio_mesh_free(whole);
    brio_mesh_free(tiled);
}

static void surfaces_have_the_bits_of_one_process(void) {
    brio_context *ctx = new_context();
    static const int of_surfaces[] = {2, 5, 6, 3, 0, 7, 4};
    for (uint64_t trial = 0; trial < (uint64_t)(SHORT_TESTS ? 14 : 500); trial++) {
        brio_rng rng = brio_rng_new(trial + 77);
        int kind = of_surfaces[trial % 7];
        size_t n = make_points(trial, 10 + brio_rng_below(&rng, trial % 3 ? 700 : 3000), kind);
        brio_surface_options options = {.size = sizeof options,
                                        .holes = trial % 4 == 3 ? BRIO_HOLES_CLOSED : BRIO_HOLES_AUTO};
        EXPECT(brio_context_set_scratch(ctx, trial % 2 ? folder : NULL) == BRIO_OK);
        compare_surfaces(ctx, n, kind, 1 + brio_rng_below(&rng, 12), &options);
        EXPECT((ctx->scratch != NULL) == (trial % 2 == 1)); /* tiles do without it, and leave it as it was */
    }
    EXPECT(files_left() == 0);
    brio_context_free(ctx);
}

/* Tiles made the triangulation of the default seed, so that some surfaces were others. */
static void tiles_have_the_seed_of_the_surface(void) {
    brio_context *ctx = new_context();
    for (uint64_t seed = 0; seed < 8; seed++) {
        brio_surface_options options = {.size = sizeof options, .seed = seed};
        compare_surfaces(ctx, make_points(seed, 200, 4), 4, 3, &options);
        compare_surfaces(ctx, make_points(seed, 200, 8), 8, 3, &options); /* in a plane */
    }
    brio_context_free(ctx);
}

/* What cannot be triangulated in tiles, or bounds no solid, ends as without tiles. */
static void points_without_a_solid_have_the_same_sentence(void) {
    brio_context *ctx = new_context();
    brio_surface_options options = {.size = sizeof options};
    uniform_points(5, 200, points);
    for (size_t i = 0; i < 200; i++) points[3 * i + 2] = 1;
    for (size_t n = 0; n <= 200; n += n < 6 ? 1 : 97) compare_surfaces(ctx, n, -1, 3, &options);
    points[7] = NAN;
    compare_surfaces(ctx, 50, -2, 3, &options);
    brio_context_free(ctx);
}

static void what_tiles_have_not_is_refused(void) {
    brio_context *ctx = new_context();
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = 2, .stars = 1};
    brio_surface_options options = {.size = sizeof options, .tiles = &o};
    brio_surface_stats stats = {.size = sizeof stats};
    brio_mesh *mesh = NULL;
    uniform_points(5, 200, points);
    EXPECT(brio_surface(ctx, points, 200, &options, &mesh, &stats) == BRIO_ERR_ARGUMENT && !mesh);
    o.stars = 0;
    options.method = BRIO_SURFACE_POWER_CRUST;
    EXPECT(brio_surface(ctx, points, 200, &options, &mesh, &stats) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(strstr(brio_message(ctx), "tiles is an option of BRIO_SURFACE_LABELED"), "%s", brio_message(ctx));
    options.method = BRIO_SURFACE_LABELED;
    o.scratch = "/nowhere/at/all";
    EXPECT(brio_surface(ctx, points, 200, &options, &mesh, &stats) == BRIO_ERR_OPEN && !mesh);
    EXPECT(brio_surface(ctx, points, 200, NULL, &mesh, &stats) == BRIO_OK); /* by one process again */
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* Points that are given twice need no memory of a tile. */
static void shares_of_tiles_that_are_too_large_are_refused_before_the_work(void) {
    brio_context *ctx = new_context();
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = 2};
    brio_surface_options options = {.size = sizeof options, .tiles = &o};
    brio_surface_stats stats = {.size = sizeof stats};
    brio_mesh *mesh = NULL;
    uniform_points(5, 3000, points);
    brio_context_set_memory_limit(ctx, 500000);
    EXPECT(brio_surface(ctx, points, 3000, &options, &mesh, &stats) == BRIO_ERR_NO_MEMORY && !mesh);
    EXPECT(strstr(brio_message(ctx), "each tile needs about 0.8 MB"), "%s", brio_message(ctx));
    EXPECT(strstr(brio_message(ctx), "take about 2 times as many tiles") && files_left() == 0, "%s", brio_message(ctx));
    for (size_t i = 300; i < 3000; i++) memcpy(points + 3 * i, points + 3 * (i % 300), 3 * sizeof *points);
    (void)brio_surface(ctx, points, 3000, &options, &mesh, &stats);
    EXPECT(!strstr(brio_message(ctx), "each tile needs"), "%s", brio_message(ctx));
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* A handle of a facet has room for 2^30 tetrahedra, infinite ones among them. */
static void more_tetrahedra_than_handles_are_refused(void) {
    brio_context *ctx = new_context();
    const uint64_t first[] = {0, 5, (UINT64_C(1) << 30) - 7};
    brio_gather g = {.ctx = ctx, .input = {points, NULL, make_points(1, 100, 4)}};
    brio_context_set_memory_limit(ctx, 1000000);
    EXPECT(brio_gather_begin(&g, first, 2, 7) == BRIO_ERR_TOO_LARGE, "%s", brio_message(ctx));
    EXPECT(brio_gather_begin(&g, first, 2, 6) == BRIO_ERR_NO_MEMORY, "%s", brio_message(ctx));
    brio_gather_free(&g);
    brio_context_free(ctx);
}

/* --- failures --- */

static brio_status make_a_surface(brio_context *ctx, size_t n) {
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = 3};
    brio_surface_options options = {.size = sizeof options, .noise = BRIO_NOISE_KEEP, .tiles = &o};
    brio_surface_stats stats = {.size = sizeof stats};
    brio_mesh *mesh = NULL;
    brio_status status = brio_surface(ctx, points, n, &options, &mesh, &stats);
    EXPECT((status == BRIO_OK) == (mesh != NULL));
    brio_mesh_free(mesh);
    return status;
}

static void no_memory_is_a_status(void) {
    failing_memory memory = {0, 0};
    brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
    brio_context *ctx;
    brio_status status = BRIO_ERR_NO_MEMORY;
    EXPECT(brio_context_new(&allocator, &ctx) == BRIO_OK);
    brio_context_set_threads(ctx, 1);
    size_t bytes = brio_context_memory(ctx), n = make_points(3, 150, 2);
    memcpy(points + 3 * (n - 1), points, 3 * sizeof *points);
    for (size_t k = 1; k < 4000 && status != BRIO_OK; k += 1 + k / 40) {
        memory.left = k;
        status = make_a_surface(ctx, n);
        EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_MEMORY, "request %zu: %s", k, brio_message(ctx));
        EXPECT(brio_context_memory(ctx) == bytes && files_left() == 0, "request %zu", k);
    }
    memory.left = 0;
    EXPECT(status == BRIO_OK && make_a_surface(ctx, n) == BRIO_OK);
    brio_context_free(ctx);
}

static int stop_late(const char *stage, double fraction, void *user) {
    int *left = user;
    (void)stage, (void)fraction;
    return (*left)-- <= 0;
}

static void cancelled_surfaces_leave_nothing(void) {
    brio_context *ctx = new_context();
    brio_status status = BRIO_ERR_CANCELLED;
    size_t bytes = brio_context_memory(ctx), n = make_points(3, 1500, 2);
    for (int calls = 0; calls < 4000 && status != BRIO_OK; calls += 1 + calls / 4) {
        int left = calls;
        brio_context_set_progress(ctx, stop_late, &left);
        status = make_a_surface(ctx, n);
        EXPECT(status == BRIO_ERR_CANCELLED || status == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_context_memory(ctx) == bytes && files_left() == 0);
    }
    EXPECT(status == BRIO_OK);
    brio_context_free(ctx);
}

SUITE(test_tiles_surface) {
    snprintf(folder, sizeof folder, "/tmp/brio-test-tiles-surface-%ld", (long)getpid());
    EXPECT(mkdir(folder, 0700) == 0);
    RUN(parts_make_the_triangulation_of_all_points);
    RUN(surfaces_have_the_bits_of_one_process);
    RUN(tiles_have_the_seed_of_the_surface);
    RUN(points_without_a_solid_have_the_same_sentence);
    RUN(what_tiles_have_not_is_refused);
    RUN(shares_of_tiles_that_are_too_large_are_refused_before_the_work);
    RUN(more_tetrahedra_than_handles_are_refused);
    RUN(no_memory_is_a_status);
    RUN(cancelled_surfaces_leave_nothing);
    rmdir(folder);
    return harness_end();
}
