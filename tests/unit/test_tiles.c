/* Triangulations in tiles: the same checksum and counts as without, whatever the points and the number of tiles. */
#include "base/memory.h"
#include "brio/tiles.h"
#include "harness.h"
#include "points.h"
#include <dirent.h>
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST = 20000, KINDS = 10 };

static double points[3 * MOST], weights[MOST];
static char folder[64];

/* Fills points of a kind; returns their number, at most n. */
static size_t make_points(uint64_t seed, size_t n, int kind) {
    size_t side = (size_t)cbrt((double)n);
    brio_rng rng = brio_rng_new(seed);
    switch (kind) {
    case 0:
        uniform_points(seed, n, points);
        return n;
    case 1:
        clustered_points(seed, n, points);
        return n;
    case 2:
        sphere_points(seed, n, points);
        return n;
    case 3:
        integer_points(seed, n, 9, points);
        return n;
    case 4: /* a grid */
        n = side * side * side;
        for (size_t i = 0; i < n; i++) {
            points[3 * i] = (double)(i % side), points[3 * i + 1] = (double)(i / side % side);
            points[3 * i + 2] = (double)(i / side / side);
        }
        return n;
    case 5: /* a scan */
        side = (size_t)sqrt((double)n);
        depth_points(seed, side, points);
        return side * side;
    case 6: /* ground, with a few points above */
        for (size_t i = 0; i < n; i++) {
            double *p = points + 3 * i;
            p[0] = brio_rng_double(&rng) * 100, p[1] = brio_rng_double(&rng) * 100;
            p[2] = sin(p[0] / 9) + cos(p[1] / 7) + (i % 50 ? 0 : 10 * brio_rng_double(&rng));
        }
        return n;
    case 7: /* most in a plane */
        uniform_points(seed, n, points);
        for (size_t i = 0; i < n; i++)
            if (i % 97) points[3 * i + 2] = points[3 * i];
        return n;
    case 8: /* most on a line */
        integer_points(seed, n, 1000, points);
        for (size_t i = 0; i < n; i++)
            if (i % 31) points[3 * i + 1] = 2 * points[3 * i], points[3 * i + 2] = 5;
        return n;
    default: /* two skew circles */
        for (size_t i = 0; i < n; i++) {
            double a = brio_rng_double(&rng) * 6.283185307179586;
            points[3 * i] = cos(a), points[3 * i + 1] = i % 2 ? sin(a) : 0, points[3 * i + 2] = i % 2 ? 0 : 2 + sin(a);
        }
        return n;
    }
}

static brio_tiles *tiles_of(brio_context *ctx, uint32_t tiles, size_t n, bool weighted, uint64_t key) {
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = tiles, .weighted = weighted, .key = key};
    brio_tiles *t;
    EXPECT(brio_tiles_new(ctx, &o, &t) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; !brio_tiles_has_points(t) && i < n; i += 777) {
        size_t some = n - i < 777 ? n - i : 777;
        EXPECT(brio_tiles_add(ctx, t, points + 3 * i, weighted ? weights + i : NULL, some) == BRIO_OK);
    }
    return t;
}

static size_t files_left(void) {
    DIR *d = opendir(folder);
    size_t n = 0;
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) n += e->d_name[0] != '.';
    if (d) closedir(d);
    return n;
}

typedef struct {
    brio_delaunay_stats stats;
    uint64_t checksum;
} expected;

static expected without_tiles(brio_context *ctx, size_t n, bool weighted) {
    brio_triangulation *t;
    expected e;
    brio_delaunay_options o = {.size = sizeof o, .leave_hidden = 1};
    EXPECT(brio_delaunay(ctx, points, weighted ? weights : NULL, n, &o, &t) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_triangulation_checksum(ctx, t, points, &e.checksum) == BRIO_OK);
    e.stats = *brio_triangulation_stats(t);
    brio_triangulation_free(t);
    return e;
}

static void compare(brio_context *ctx, brio_tiles *t, const expected *e, int kind, uint32_t tiles) {
    const brio_tiles_stats *s = brio_tiles_facts(t);
    const brio_delaunay_stats *d = &e->stats;
    uint64_t checksum = 0;
    brio_status status = brio_tiles_run(ctx, t);
    EXPECT(status == BRIO_OK, "kind %d, %u tiles: %s", kind, tiles, brio_message(ctx));
    if (status != BRIO_OK) return;
    EXPECT(brio_tiles_checksum(ctx, t, &checksum) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(checksum == e->checksum && s->tetrahedra == d->tetrahedra && s->hull_facets == d->hull_facets,
           "kind %d, %u tiles, %zu points: %llu tetrahedra, not %zu", kind, tiles, d->points,
           (unsigned long long)s->tetrahedra, d->tetrahedra);
    EXPECT(s->points == d->points && s->vertices == d->vertices && s->duplicates == d->duplicates &&
               s->hidden == d->hidden && s->dimension == d->dimension,
           "kind %d, %u tiles: %llu vertices, %llu duplicates, %llu hidden, not %zu, %zu, %zu", kind, tiles,
           (unsigned long long)s->vertices, (unsigned long long)s->duplicates, (unsigned long long)s->hidden,
           d->vertices, d->duplicates, d->hidden);
}

static void compare_once(uint64_t seed, size_t n, int kind, bool weighted, uint32_t tiles) {
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, n < 2000 ? 1 : 2);
    n = make_points(seed, n, kind);
    if (weighted) integer_weights(seed, n, kind == 3 || kind == 4 ? 5 : 2, weights);
    expected e = without_tiles(ctx, n, weighted);
    if (e.stats.dimension == 3 || !weighted) {
        brio_tiles *t = tiles_of(ctx, tiles, n, weighted, 0);
        compare(ctx, t, &e, kind, tiles);
        brio_tiles_free(t);
    }
    EXPECT(files_left() == 0, "%zu files are left", files_left());
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void small_sets(void) {
    brio_rng rng = brio_rng_new(3);
    for (int i = 0; i < (BRIEF_TESTS ? 40 : SHORT_TESTS ? 150 : 1000); i++)
        compare_once(brio_rng_next(&rng), 1 + brio_rng_below(&rng, i % 4 ? 300 : 1500), i % KINDS, i / KINDS % 2,
                     1 + brio_rng_below(&rng, 12));
}

static void larger_sets(void) {
    static const uint32_t tiles[] = {1, 2, 3, 5, 8, 16, 64};
    for (int kind = 0; kind < KINDS; kind++)
        for (int weighted = 0; weighted < 2; weighted++)
            for (size_t i = 0; i < sizeof tiles / sizeof *tiles; i++)
                if (!SHORT_TESTS || (i + (size_t)kind + (size_t)weighted) % 7 == 0)
                    compare_once(9, BRIEF_TESTS ? 1500 : SHORT_TESTS ? 4000 : MOST, kind, weighted, tiles[i]);
}

SUITE(test_tiles) {
    snprintf(folder, sizeof folder, "/tmp/brio-test-tiles-%ld", (long)getpid());
    EXPECT(mkdir(folder, 0700) == 0);
    RUN(small_sets);
    RUN(larger_sets);
    rmdir(folder);
    return harness_end();
}
