/* Triangulations in tiles: the same checksum and counts as without, whatever the points and the number of tiles. */
#include "base/memory.h"
#include "base/sort.h"
#include "brio/tiles.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include <dirent.h>
#include <fcntl.h>
#include <inttypes.h>
#include <pthread.h>
#include <sched.h>
#include <sys/resource.h>
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
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = tiles, .key = key, .stars = 1};
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
    for (int i = 0; i < (BRIEF_TESTS ? 20 : SHORT_TESTS ? 50 : 1000); i++)
        compare_once(brio_rng_next(&rng), 1 + brio_rng_below(&rng, i % 4 ? 300 : 1500), i % KINDS, i / KINDS % 2,
                     1 + brio_rng_below(&rng, 12));
}

static void larger_sets(void) {
    static const uint32_t tiles[] = {1, 2, 3, 5, 8, 16, 64};
    for (int kind = 0; kind < KINDS; kind++)
        for (int weighted = 0; weighted < 2; weighted++)
            for (size_t i = 0; i < sizeof tiles / sizeof *tiles; i++)
                if (!SHORT_TESTS || (i + (size_t)kind + (size_t)weighted) % 7 == 0)
                    compare_once(9, BRIEF_TESTS ? 500 : SHORT_TESTS ? 1500 : MOST, kind, weighted, tiles[i]);
}

/* Blocks that are added as a whole once ended the search of balls whose own points in conflict were elsewhere. */
static void points_nearly_on_a_sphere(void) {
    compare_once(1, BRIEF_TESTS ? 2000 : 5000, 2, false, 3);
}

/* A run goes on with what one before left: all points, and the tiles that it had finished. */
static void a_run_is_resumed(void) {
    brio_context *ctx = new_context();
    char left[128] = "", kept[160];
    size_t n = make_points(4, 3000, 1);
    expected e = without_tiles(ctx, n, false);
    brio_tiles *t = tiles_of(ctx, 4, n, false, 99);
    compare(ctx, t, &e, 1, 4);
    EXPECT(brio_tiles_facts(t)->resumed == 0);
    DIR *d = opendir(folder);
    for (struct dirent *f; d && (f = readdir(d)) != NULL;)
        if (f->d_name[0] != '.') snprintf(left, sizeof left, "%s/%.60s", folder, f->d_name);
    if (d) closedir(d);
    snprintf(kept, sizeof kept, "%s-kept", folder);
    EXPECT(rename(left, kept) == 0); /* as if the process were killed: nothing is removed */
    brio_tiles_free(t);
    EXPECT(rename(kept, left) == 0);
    snprintf(kept, sizeof kept, "%.110s/tile-2", left);
    EXPECT(truncate(kept, 100) == 0); /* not whole: made again */
    t = tiles_of(ctx, 4, n, false, 99);
    EXPECT(brio_tiles_has_points(t));
    compare(ctx, t, &e, 1, 4);
    EXPECT(brio_tiles_facts(t)->resumed == 3, "%u tiles", brio_tiles_facts(t)->resumed);
    brio_tiles_free(t);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* All parts together have each tetrahedron once, and name the points by their indices. */
static void parts_are_the_whole(void) {
    brio_context *ctx = new_context();
    size_t n = make_points(4, 2000, 0), count = 0;
    expected e = without_tiles(ctx, n, false);
    brio_tiles *t = tiles_of(ctx, 5, n, false, 0);
    uint64_t sum = 0;
    compare(ctx, t, &e, 0, 5);
    for (uint32_t i = 0; i < 5; i++) {
        brio_tile_part p = {.size = sizeof p};
        EXPECT(brio_tiles_part(ctx, t, i, &p) == BRIO_OK, "%s", brio_message(ctx));
        for (size_t v = 0; v < p.num_vertices; v++)
            EXPECT(p.index[v] < n && !memcmp(p.points + 3 * v, points + 3 * p.index[v], 3 * sizeof *points));
        for (size_t k = 0; k < p.num_tetrahedra; k++) {
            uint64_t product = 1;
            for (int c = 0; c < 4; c++) product += brio_mix(p.index[p.tetrahedra[k][c]]);
            sum += brio_mix(product);
        }
        count += p.num_tetrahedra;
        brio_tile_part_free(ctx, &p);
    }
    brio_triangulation *whole;
    EXPECT(brio_delaunay(ctx, points, NULL, n, NULL, &whole) == BRIO_OK);
    for (size_t k = 0; k < e.stats.tetrahedra; k++) {
        uint64_t product = 1;
        for (int c = 0; c < 4; c++) product += brio_mix(brio_triangulation_tetrahedra(whole)[k].vertex[c]);
        sum -= brio_mix(product);
    }
    EXPECT(count == e.stats.tetrahedra && sum == 0, "%zu tetrahedra", count);
    brio_triangulation_free(whole);
    brio_tiles_free(t);
    brio_context_free(ctx);
}

/* Returns the hash of a facet and of the vertex across it; `apex` is that vertex, or UINT64_MAX behind the hull. */
static uint64_t hash_of_side(const uint64_t tet[4], int facet, uint64_t apex) {
    uint64_t sum = 0;
    for (int k = 0; k < 4; k++) sum += k == facet ? 0 : brio_mix(tet[k]);
    return brio_mix(sum ^ brio_mix(apex + brio_mix(tet[facet])));
}

static uint64_t sides_of_the_whole(const brio_triangulation *t) {
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    uint64_t sum = 0;
    for (size_t i = 0; i < brio_triangulation_stats(t)->tetrahedra; i++)
        for (int k = 0; k < 4; k++) {
            const uint32_t *v = tet[i].vertex, mate = tet[i].mate[k], apex = tet[mate / 4].vertex[mate % 4];
            uint64_t name[4] = {v[0], v[1], v[2], v[3]};
            sum += hash_of_side(name, k, apex == BRIO_INFINITE ? UINT64_MAX : apex);
        }
    return sum;
}

/* Returns the index of the vertex of a tetrahedron that is not in a facet of another one; counts what is wrong. */
static uint64_t apex_of(const brio_tile_part *p, uint32_t tet, const uint64_t from[4], int facet, size_t *wrong) {
    uint64_t apex = UINT64_MAX;
    int others = 0;
    if (tet >= p->num_tetrahedra) return ++*wrong;
    for (int c = 0; c < 4; c++) {
        uint64_t name = p->index[p->tetrahedra[tet][c]];
        bool shared = false;
        for (int k = 0; k < 4; k++) shared |= k != facet && from[k] == name;
        if (!shared) apex = name, others++;
    }
    *wrong += others != 1;
    return apex;
}

enum { MOST_PARTS = 64 };

/* Neighbours, whatever tile they are of, are those of the whole. */
static void compare_sides(uint64_t seed, size_t n, int kind, bool weighted, uint32_t tiles, size_t *across) {
    static brio_tile_part part[MOST_PARTS];
    static brio_tile_neighbour(*neighbour[MOST_PARTS])[4];
    brio_context *ctx = new_context();
    brio_triangulation *whole;
    brio_delaunay_options o = {.size = sizeof o, .leave_hidden = 1};
    uint64_t sum = 0;
    size_t hull = 0, wrong = 0;
    n = make_points(seed, n, kind);
    if (weighted) integer_weights(seed, n, 5, weights);
    EXPECT(brio_delaunay(ctx, points, weighted ? weights : NULL, n, &o, &whole) == BRIO_OK, "%s", brio_message(ctx));
    brio_tiles *t = tiles_of(ctx, tiles, n, weighted, 0);
    bool flat = weighted && brio_triangulation_stats(whole)->dimension < 3; /* refused */
    if (!flat) EXPECT(brio_tiles_run(ctx, t) == BRIO_OK, "%s", brio_message(ctx));
    for (uint32_t i = 0; i < tiles && !flat; i++) {
        part[i] = (brio_tile_part){.size = sizeof part[i]};
        EXPECT(brio_tiles_part(ctx, t, i, &part[i]) == BRIO_OK, "%s", brio_message(ctx));
        neighbour[i] = calloc(part[i].num_tetrahedra + 1, sizeof *neighbour[i]);
        EXPECT(brio_tiles_neighbours(ctx, t, i, &part[i], neighbour[i]) == BRIO_OK, "%s", brio_message(ctx));
    }
    for (uint32_t i = 0; i < tiles && !flat; i++)
        for (size_t k = 0; k < part[i].num_tetrahedra; k++)
            for (int c = 0; c < 4; c++) {
                brio_tile_neighbour other = neighbour[i][k][c];
                uint64_t name[4], apex = UINT64_MAX;
                for (int v = 0; v < 4; v++) name[v] = part[i].index[part[i].tetrahedra[k][v]];
                hull += other.tile == BRIO_NO_TILE;
                *across += other.tile != BRIO_NO_TILE && other.tile != i;
                if (other.tile != BRIO_NO_TILE && other.tile >= tiles)
                    wrong++;
                else if (other.tile != BRIO_NO_TILE)
                    apex = apex_of(&part[other.tile], other.tetrahedron, name, c, &wrong);
                sum += hash_of_side(name, c, apex);
            }
    EXPECT(!wrong &&
               (flat || (sum == sides_of_the_whole(whole) && hull == brio_triangulation_stats(whole)->hull_facets)),
           "kind %d, %u tiles, %zu points: %zu wrong, %zu on the hull, not %zu", kind, tiles, n, wrong, hull,
           brio_triangulation_stats(whole)->hull_facets);
    for (uint32_t i = 0; i < tiles && !flat; i++) {
        free(neighbour[i]);
        brio_tile_part_free(ctx, &part[i]);
    }
    brio_triangulation_free(whole);
    brio_tiles_free(t);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0, "%zu files are left", files_left());
    brio_context_free(ctx);
}

static void neighbours_across_tiles_are_those_of_the_whole(void) {
    static const uint32_t TILES[] = {1, 2, 3, 5, 12, 64};
    for (int kind = 0; kind < KINDS; kind++) {
        size_t across = 0;
        for (size_t i = 0; i < sizeof TILES / sizeof *TILES; i++)
            for (int weighted = 0; weighted < 2; weighted++)
                compare_sides((uint64_t)(kind + 1) * (i + 1), kind == 2 ? 300 : 1500, kind, weighted, TILES[i],
                              &across);
        EXPECT(across > 100, "kind %d", kind);
    }
    for (uint64_t seed = 1; seed <= (BRIEF_TESTS ? 20 : SHORT_TESTS ? 50 : 1000); seed++) {
        size_t across = 0;
        compare_sides(seed, 4 + seed % 60, (int)(seed % KINDS), seed % 3 == 0, 1 + seed % 12, &across);
    }
}

static void wrong_calls_for_neighbours_are_refused(void) {
    brio_context *ctx = new_context();
    brio_tile_neighbour some[4];
    brio_tile_part p = {.size = sizeof p}, none = {.size = sizeof none};
    brio_tiles *t = tiles_of(ctx, 2, make_points(5, 500, 0), false, 0);
    EXPECT(brio_tiles_neighbours(ctx, t, 0, &none, &some) == BRIO_ERR_ARGUMENT && strstr(brio_message(ctx), "not tri"));
    EXPECT(brio_tiles_run(ctx, t) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_tiles_neighbours(ctx, t, 2, &none, &some) == BRIO_ERR_ARGUMENT && strstr(brio_message(ctx), "2 of 2"));
    EXPECT(brio_tiles_part(ctx, t, 1, &p) == BRIO_OK, "%s", brio_message(ctx));
    p.num_tetrahedra--;
    EXPECT(brio_tiles_neighbours(ctx, t, 1, &p, &some) == BRIO_ERR_ARGUMENT && strstr(brio_message(ctx), "which has"));
    brio_tile_part_free(ctx, &p);
    brio_tiles_free(t);
    brio_context_free(ctx);
}

/* Writes the path of the one folder in the scratch folder. Returns how many files it has. */
static size_t find_run(char path[1024]) {
    size_t n = 0;
    DIR *d = opendir(folder);
    for (struct dirent *e; d && (e = readdir(d)) != NULL;)
        if (e->d_name[0] != '.') snprintf(path, 1024, "%s/%s", folder, e->d_name);
    if (d) closedir(d);
    d = opendir(path);
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) n += e->d_name[0] != '.';
    if (d) closedir(d);
    return n;
}

/* Files of facets stayed when the call that wrote them failed, on a disk that may have been full. */
static void neighbours_are_named_after_failures(void) {
    enum { TILES = 3 };
    failing_memory memory = {0, 0};
    brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
    brio_context *ctx;
    brio_tile_part p = {.size = sizeof p};
    brio_status status = BRIO_ERR_NO_MEMORY;
    char path[1024] = "";
    EXPECT(brio_context_new(&allocator, &ctx) == BRIO_OK);
    brio_context_set_threads(ctx, 1);
    brio_tiles *t = tiles_of(ctx, TILES, make_points(5, 400, 0), false, 0);
    EXPECT(brio_tiles_run(ctx, t) == BRIO_OK && brio_tiles_part(ctx, t, 1, &p) == BRIO_OK, "%s", brio_message(ctx));
    brio_tile_neighbour(*some)[4] = calloc(p.num_tetrahedra, sizeof *some);
    brio_tile_neighbour(*again)[4] = calloc(p.num_tetrahedra, sizeof *again);
    size_t bytes = brio_context_memory(ctx), files = find_run(path), k = 1, removed = 0;
    for (; k < 2000 && status != BRIO_OK; k++) {
        memory.left = k;
        status = brio_tiles_neighbours(ctx, t, 1, &p, some);
        size_t now = find_run(path);
        EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_MEMORY, "request %zu: %s", k, brio_message(ctx));
        EXPECT(brio_context_memory(ctx) == bytes && (now == files || now == files + TILES),
               "request %zu: %zu files, not %zu", k, now, files);
        removed += status != BRIO_OK && now == files;
    }
    memory.left = 0;
    EXPECT(status == BRIO_OK && removed > 20, "%zu requests, %zu times without files", k, removed);
    EXPECT(brio_tiles_neighbours(ctx, t, 1, &p, again) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(!memcmp(some, again, p.num_tetrahedra * sizeof *some));
    free(some), free(again);
    brio_tile_part_free(ctx, &p);
    brio_tiles_free(t);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* Facets of a tile that was changed met no other side, and were named facets of the hull. */
static void neighbours_of_changed_tiles_are_refused(void) {
    brio_context *ctx = new_context();
    brio_tile_part p = {.size = sizeof p};
    uint32_t v[4];
    char path[1024] = "", file[1100];
    brio_tiles *t = tiles_of(ctx, 2, make_points(5, 2000, 0), false, 0);
    EXPECT(brio_tiles_run(ctx, t) == BRIO_OK && brio_tiles_part(ctx, t, 0, &p) == BRIO_OK, "%s", brio_message(ctx));
    find_run(path);
    snprintf(file, sizeof file, "%s/tile-1", path);
    FILE *f = fopen(file, "r+b");
    EXPECT(f && fseek(f, 4096, SEEK_SET) == 0 && fread(v, sizeof v, 1, f) == 1, "%s", file);
    v[0] = v[0] == 7 ? 8 : 7;
    EXPECT(f && fseek(f, 4096, SEEK_SET) == 0 && fwrite(v, sizeof v, 1, f) == 1);
    if (f) fclose(f);
    brio_tile_neighbour(*some)[4] = calloc(p.num_tetrahedra, sizeof *some);
    EXPECT(brio_tiles_neighbours(ctx, t, 0, &p, some) == BRIO_ERR_OPEN &&
               strstr(brio_message(ctx), "changed from outside"),
           "%s", brio_message(ctx));
    free(some);
    brio_tile_part_free(ctx, &p);
    brio_tiles_free(t);
    brio_context_free(ctx);
}

/* Points without tetrahedra have parts without rows, and no neighbours. */
static void neighbours_where_there_are_no_tetrahedra(void) {
    static const size_t COUNT[] = {0, 1, 2, 3, 5, 400};
    for (int plane = 0; plane < 2; plane++)
        for (size_t i = 0; i < sizeof COUNT / sizeof *COUNT; i++) {
            brio_context *ctx = new_context();
            make_points(3, 400, 0);
            for (size_t k = 0; k < COUNT[i]; k++) points[3 * k + 2] = 1, points[3 * k + 1] *= plane;
            brio_tiles *t = tiles_of(ctx, 3, COUNT[i], false, 0);
            EXPECT(brio_tiles_run(ctx, t) == BRIO_OK, "%s", brio_message(ctx));
            for (uint32_t tile = 0; tile < 3; tile++) {
                brio_tile_part p = {.size = sizeof p};
                brio_tile_neighbour none[1][4] = {{{7, 7}}};
                EXPECT(brio_tiles_part(ctx, t, tile, &p) == BRIO_OK && !p.num_tetrahedra, "%s", brio_message(ctx));
                EXPECT(brio_tiles_neighbours(ctx, t, tile, &p, none) == BRIO_OK && none[0][0].tile == 7, "%s",
                       brio_message(ctx));
                brio_tile_part_free(ctx, &p);
            }
            brio_tiles_free(t);
            EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
            brio_context_free(ctx);
        }
}

/* Hashes the parts of all tiles, every byte of them. */
static uint64_t hash_parts(size_t n, int threads) {
    brio_context *ctx = new_context();
    uint64_t hash = 0;
    brio_context_set_threads(ctx, threads);
    brio_tiles *t = tiles_of(ctx, 2, n, false, 0);
    EXPECT(brio_tiles_run(ctx, t) == BRIO_OK, "%s", brio_message(ctx));
    for (uint32_t i = 0; i < 2; i++) {
        brio_tile_part p = {.size = sizeof p};
        EXPECT(brio_tiles_part(ctx, t, i, &p) == BRIO_OK, "%s", brio_message(ctx));
        const uint32_t *v = *p.tetrahedra;
        for (size_t k = 0; k < p.num_vertices; k++) hash = brio_hash(hash, p.index[k]);
        for (size_t k = 0; k < 4 * p.num_tetrahedra; k++) hash = brio_hash(hash, v[k]);
        brio_tile_part_free(ctx, &p);
    }
    EXPECT(brio_tiles_facts(t)->asked > 0);
    brio_tiles_free(t);
    brio_context_free(ctx);
    return hash;
}

/* Of a few tetrahedra around a vertex that are all the same, most were listed nowhere, and rows beyond all were read. */
static void a_tile_with_one_tetrahedron_many_times_is_refused(void) {
    static const uint32_t same[4] = {0, 1, 2, 3};
    brio_context *ctx = new_context();
    brio_tile_part p = {.size = sizeof p};
    char path[1024] = "";
    brio_tiles *t = tiles_of(ctx, 1, make_points(5, 2000, 0), false, 0);
    EXPECT(brio_tiles_run(ctx, t) == BRIO_OK, "%s", brio_message(ctx));
    DIR *d = opendir(folder);
    for (struct dirent *e; d && (e = readdir(d)) != NULL;)
        if (e->d_name[0] != '.') snprintf(path, sizeof path, "%s/%s/tile-0", folder, e->d_name);
    if (d) closedir(d);
    FILE *f = fopen(path, "r+b");
    EXPECT(f && fseek(f, 4096, SEEK_SET) == 0, "%s", path);
    for (int i = 0; f && i < 20; i++) EXPECT(fwrite(same, sizeof same, 1, f) == 1);
    if (f) fclose(f);
    EXPECT(brio_tiles_part(ctx, t, 0, &p) == BRIO_ERR_OPEN && strstr(brio_message(ctx), "changed from outside"));
    brio_tiles_free(t);
    brio_context_free(ctx);
}

/* Hashes the corners of all cells. */
static int hash_corners(const brio_cells *cells, const uint64_t *site, void *user) {
    uint64_t *hash = user, faces = cells->face_offsets[cells->num_cells];
    (void)site;
    for (size_t i = 0; i < 3 * cells->num_vertices; i++) *hash = brio_hash(*hash, brio_double_key(cells->vertices[i]));
    for (uint64_t i = 0; i < cells->corner_offsets[faces]; i++) *hash = brio_hash(*hash, cells->face_vertices[i]);
    return 0;
}

static uint64_t hash_cells(size_t n, int threads) {
    brio_context *ctx = new_context();
    const brio_cells_options o = {.size = sizeof o, .vertices = 1};
    uint64_t hash = 0;
    brio_context_set_threads(ctx, threads);
    brio_tiles *t = tiles_of(ctx, 2, n, false, 0);
    EXPECT(brio_tiles_run(ctx, t) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_tiles_cells(ctx, t, &o, 0, hash_corners, &hash) == BRIO_OK, "%s", brio_message(ctx));
    brio_tiles_free(t);
    brio_context_free(ctx);
    return hash;
}

static void vertices_of_cells_do_not_depend_on_threads(void) {
    size_t n = make_points(5, 8000, 0);
    uint64_t one = hash_cells(n, 1);
    EXPECT(hash_cells(n, 4) == one);
    EXPECT(hash_cells(n, 3) == one);
}

/* The file of a tile is the same for every number of threads. */
static void parts_do_not_depend_on_threads(void) {
    size_t n = make_points(5, MOST, 0);
    uint64_t one = hash_parts(n, 1);
    EXPECT(hash_parts(n, 4) == one);
    EXPECT(hash_parts(n, 3) == one);
}

/* --- cells --- */

/* Cells of all points, which those of tiles are compared with. */
typedef struct {
    const brio_cells *whole;
    int ordered;
    uint64_t seen, differ;
} cell_comparison;

static bool same_cell(const brio_cells *a, size_t i, const brio_cells *b, size_t j) {
    uint64_t f = a->face_offsets[i], g = b->face_offsets[j], n = a->face_offsets[i + 1] - f;
    return !memcmp(&a->volume[i], &b->volume[j], sizeof(double)) && !memcmp(&a->area[i], &b->area[j], sizeof(double)) &&
           !memcmp(&a->centroid[3 * i], &b->centroid[3 * j], 3 * sizeof(double)) && a->bounded[i] == b->bounded[j] &&
           b->face_offsets[j + 1] - g == n &&
           (!b->face_neighbours || (!memcmp(&a->face_neighbours[f], &b->face_neighbours[g], n * sizeof(int64_t)) &&
                                    !memcmp(&a->face_areas[f], &b->face_areas[g], n * sizeof(double)) &&
                                    !memcmp(&a->face_normals[3 * f], &b->face_normals[3 * g], 3 * n * sizeof(double))));
}

static int compare_cells(const brio_cells *cells, const uint64_t *site, void *user) {
    cell_comparison *c = user;
    c->differ += !cells->face_neighbours != (c->ordered == 2);
    for (size_t i = 0; c->whole && i < cells->num_cells; i++) {
        size_t at = 0, end = c->whole->num_cells;
        while (at + 1 < end) { /* sites ascend */
            size_t middle = (at + end) / 2;
            if (c->whole->site[middle] <= site[i])
                at = middle;
            else
                end = middle;
        }
        bool right = c->whole->num_cells && c->whole->site[at] == site[i] && same_cell(c->whole, at, cells, i);
        c->differ += !right || (c->ordered && at != c->seen);
        c->seen++;
    }
    return 0;
}

static void compare_all_cells(uint64_t seed, size_t n, int kind, bool weighted, uint32_t tiles, int ordered) {
    static const double BOX[6] = {-0.3, -0.25, -0.5, 0.75, 4, 3.5};
    brio_context *ctx = new_context();
    n = make_points(seed, n, kind);
    if (weighted) integer_weights(seed, n, kind == 3 || kind == 4 ? 5 : 2, weights);
    brio_cells_options o = {.size = sizeof o, .box = seed % 2 ? BOX : NULL};
    brio_cells *whole = NULL;
    brio_status status = brio_voronoi_cells(ctx, NULL, points, weighted ? weights : NULL, n, &o, &whole);
    brio_tiles *t = tiles_of(ctx, tiles, n, weighted, 0);
    if (brio_tiles_run(ctx, t) == BRIO_OK && brio_tiles_facts(t)->dimension == 3) {
        cell_comparison c = {.whole = whole, .ordered = ordered};
        brio_status tiled = brio_tiles_cells(ctx, t, &o, ordered, compare_cells, &c);
        EXPECT(tiled == status, "kind %d, %u tiles: %s", kind, tiles, brio_message(ctx));
        if (status == BRIO_OK) {
            EXPECT(c.seen == whole->num_cells && c.differ == 0,
                   "kind %d, weighted %d, %u tiles, %zu points: %llu of %zu cells, %llu differ", kind, weighted, tiles,
                   n, (unsigned long long)c.seen, whole->num_cells, (unsigned long long)c.differ);
            const brio_tiles_cells_stats s = *brio_tiles_cells_facts(t);
            EXPECT(s.faces == whole->face_offsets[whole->num_cells] && s.region_volume == whole->region_volume);
            EXPECT(!ordered || !memcmp(&s.volume_sum, &whole->volume_sum, sizeof(double)));
        }
    }
    brio_cells_free(whole);
    brio_tiles_free(t);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static int compare_neighbours(const brio_cells *cells, const uint64_t *site, void *user) {
    cell_comparison *c = user;
    for (size_t i = 0; i < cells->num_cells; i++) {
        size_t at = 0;
        while (at + 1 < c->whole->num_cells && c->whole->site[at] != site[i]) at++;
        double volume = c->whole->volume[at], off = cells->volume[i] - volume;
        c->differ += volume < INFINITY ? !(fabs(off) <= 1e-9 * volume) : cells->volume[i] != volume;
        c->seen++;
        if (!cells->face_offsets) continue;
        uint64_t f = cells->face_offsets[i], n = cells->face_offsets[i + 1] - f, g = c->whole->face_offsets[at];
        c->differ += cells->face_areas || cells->face_normals || c->whole->face_offsets[at + 1] - g != n;
        if (!cells->face_neighbours || c->differ) continue;
        c->differ += memcmp(&cells->face_neighbours[f], &c->whole->face_neighbours[g], n * sizeof(int64_t)) != 0;
    }
    return 0;
}

/* Sweeps of tiles took points of other tiles for translates; and in order, sizes of faces that were not there. */
static void tiles_read_what_was_left_out(void) {
    for (int i = 0; i < 16; i++) {
        brio_context *ctx = new_context();
        size_t n = make_points((uint64_t)i, 200, i / 4);
        brio_cells_options o = {.size = sizeof o, .no_areas = 1, .no_centroids = 1, .no_face_sizes = 1};
        brio_cells *whole = NULL;
        o.no_faces = i % 4 == 3;
        brio_tiles *t = tiles_of(ctx, 3, n, false, 0);
        brio_status status = brio_voronoi_cells(ctx, NULL, points, NULL, n, NULL, &whole);
        if (brio_tiles_run(ctx, t) == BRIO_OK && brio_tiles_facts(t)->dimension == 3 && status == BRIO_OK) {
            cell_comparison c = {.whole = whole};
            EXPECT(brio_tiles_cells(ctx, t, &o, i % 3, compare_neighbours, &c) == BRIO_OK, "%s", brio_message(ctx));
            EXPECT(c.seen == whole->num_cells && c.differ == 0, "%d: %llu of %zu cells, %llu differ", i,
                   (unsigned long long)c.seen, whole->num_cells, (unsigned long long)c.differ);
        }
        brio_cells_free(whole);
        brio_tiles_free(t);
        brio_context_free(ctx);
    }
}

static void cells_are_those_of_the_whole(void) {
    static const uint32_t tiles[] = {1, 2, 3, 7};
    brio_rng rng = brio_rng_new(11);
    for (int i = 0; i < (BRIEF_TESTS ? 24 : SHORT_TESTS ? 60 : 800); i++)
        compare_all_cells(brio_rng_next(&rng), 1 + brio_rng_below(&rng, i % 5 ? 250 : 1200), i % KINDS, i / KINDS % 2,
                          tiles[(i + i / 4) % 4], i % 3);
}

static int count_calls(const brio_cells *cells, const uint64_t *site, void *user) {
    (void)cells, (void)site;
    return ++*(int *)user > 0;
}

static void wrong_calls_for_cells_are_refused(void) {
    brio_context *ctx = new_context();
    brio_cells_options o = {.size = sizeof o, .vertices = 1};
    int calls = 0;
    size_t n = make_points(6, 500, 0);
    brio_tiles *t = tiles_of(ctx, 2, n, false, 0);
    EXPECT(brio_tiles_cells(ctx, t, NULL, 0, count_calls, &calls) == BRIO_ERR_ARGUMENT &&
           strstr(brio_message(ctx), "not triangulated"));
    EXPECT(brio_tiles_run(ctx, t) == BRIO_OK);
    EXPECT(brio_tiles_cells(ctx, t, &o, 1, count_calls, &calls) == BRIO_ERR_ARGUMENT && calls == 0);
    EXPECT(brio_tiles_cells(ctx, t, NULL, 3, count_calls, &calls) == BRIO_ERR_ARGUMENT && calls == 0);
    EXPECT(brio_tiles_cells(ctx, t, &o, 0, count_calls, &calls) == BRIO_ERR_CANCELLED && calls == 1);
    EXPECT(brio_tiles_cells(ctx, t, NULL, 1, count_calls, &calls) == BRIO_ERR_CANCELLED && calls == 2);
    brio_tiles_free(t);
    brio_tiles_options without = {.size = sizeof without, .scratch = folder, .tiles = 2};
    EXPECT(brio_tiles_new(ctx, &without, &t) == BRIO_OK && brio_tiles_add(ctx, t, points, NULL, n) == BRIO_OK &&
           brio_tiles_run(ctx, t) == BRIO_OK);
    EXPECT(brio_tiles_cells(ctx, t, NULL, 0, count_calls, &calls) == BRIO_ERR_ARGUMENT &&
           strstr(brio_message(ctx), "no stars"));
    brio_tiles_free(t);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void wrong_calls_are_refused(void) {
    brio_context *ctx = new_context();
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = 2, .key = 5};
    brio_tiles *t, *again;
    double p[6] = {0, 0, 0, 1, NAN, 0}, w[2] = {0, 1};
    uint64_t sum;
    EXPECT(brio_tiles_new(ctx, &o, &t) == BRIO_OK);
    EXPECT(brio_tiles_new(ctx, &o, &again) == BRIO_ERR_OPEN && strstr(brio_message(ctx), "in use"));
    EXPECT(brio_tiles_add(ctx, t, p, NULL, 2) == BRIO_ERR_NOT_FINITE && strstr(brio_message(ctx), "point 1: y is NaN"));
    EXPECT(brio_tiles_add(ctx, t, p, w, 1) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_tiles_checksum(ctx, t, &sum) == BRIO_ERR_ARGUMENT);
    brio_tiles_free(t);
    o.scratch = "/nowhere/at/all";
    EXPECT(brio_tiles_new(ctx, &o, &t) == BRIO_ERR_OPEN && !t);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* Flat inputs: as without tiles; with weights, refused. */
static void flat_points(void) {
    brio_context *ctx = new_context();
    size_t n = 500;
    integer_points(5, n, 20, points);
    integer_weights(5, n, 3, weights);
    for (size_t i = 0; i < n; i++) points[3 * i + 1] = 7;
    expected e = without_tiles(ctx, n, false);
    brio_tiles *t = tiles_of(ctx, 3, n, false, 0);
    compare(ctx, t, &e, -1, 3);
    brio_tiles_free(t);
    t = tiles_of(ctx, 3, n, true, 0);
    EXPECT(brio_tiles_run(ctx, t) == BRIO_ERR_NO_ANSWER && strstr(brio_message(ctx), "in a plane"));
    brio_tiles_free(t);
    for (size_t i = 0; i < 3 * n; i++) points[i] = 1; /* one position */
    e = without_tiles(ctx, n, false);
    t = tiles_of(ctx, 3, n, false, 0);
    compare(ctx, t, &e, -2, 3);
    brio_tiles_free(t);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static int stop_late(const char *stage, double fraction, void *user) {
    int *calls = user;
    (void)stage, (void)fraction;
    return --*calls < 0;
}

static void cancelled_runs_leave_nothing(void) {
    for (int calls = 1; calls < 400; calls += calls + 1) {
        brio_context *ctx = new_context();
        int left = calls;
        size_t n = make_points(6, 2000, 0);
        brio_tiles *t = tiles_of(ctx, 3, n, false, 7);
        brio_context_set_progress(ctx, stop_late, &left);
        brio_status status = brio_tiles_run(ctx, t);
        EXPECT(status == BRIO_ERR_CANCELLED || (status == BRIO_OK && left >= 0), "%s", brio_message(ctx));
        brio_tiles_free(t);
        EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
}

/* What a cancelled run had counted of its tile stayed, and a second run counted it again. */
static void a_tile_was_counted_twice(void) {
    brio_context *ctx = new_context();
    size_t n = make_points(8, 2000, 0), again = 0;
    expected e = without_tiles(ctx, n, false);
    for (int calls = 1; calls < 400; calls += calls / 2 + 1) {
        int left = calls;
        brio_tiles *t = tiles_of(ctx, 3, n, false, calls % 2 ? 7 : 0);
        brio_context_set_progress(ctx, stop_late, &left);
        brio_status status = brio_tiles_run(ctx, t);
        brio_context_set_progress(ctx, NULL, NULL);
        if (status == BRIO_ERR_CANCELLED && brio_tiles_has_points(t))
            compare(ctx, t, &e, 0, 3), again++;
        else if (status == BRIO_ERR_CANCELLED) /* points were on their way */
            EXPECT(brio_tiles_run(ctx, t) == BRIO_ERR_ARGUMENT && strstr(brio_message(ctx), "add them anew"));
        brio_tiles_free(t);
        EXPECT(files_left() == 0);
    }
    EXPECT(again > 2, "%zu runs went on", again);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* Half-spaces met whole blocks in vain, and blocks near the hull were added as wholes: 31,000 points were found then. */
static void half_spaces_took_whole_blocks(void) {
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    uniform_points(1, 20000, points);
    brio_tiles *t = tiles_of(ctx, 8, 20000, false, 0);
    EXPECT(brio_tiles_run(ctx, t) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_tiles_facts(t)->found < 20000, "%llu found", (unsigned long long)brio_tiles_facts(t)->found);
    brio_tiles_free(t);
    brio_context_free(ctx);
}

/* Each tile had one descriptor, then two: 600 tiles ended after all the work. */
static void many_tiles_ran_out_of_descriptors(void) {
    enum { TILES = 100, MOST_FILES = 50 };
    struct rlimit limit, few;
    EXPECT(getrlimit(RLIMIT_NOFILE, &limit) == 0);
    few = limit;
    few.rlim_cur = MOST_FILES;
    EXPECT(setrlimit(RLIMIT_NOFILE, &few) == 0);
    compare_once(3, 3000, 0, false, TILES);
    setrlimit(RLIMIT_NOFILE, &limit);
}

/* The name of the folder can be guessed. All files of the folder that a link of this name led to were removed. */
static void a_link_emptied_another_folder(void) {
    brio_context *ctx = new_context();
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = 4, .key = 11};
    char name[160], other[96], precious[128];
    brio_tiles *t;
    snprintf(other, sizeof other, "%s/other", folder);
    snprintf(precious, sizeof precious, "%s/precious", other);
    snprintf(name, sizeof name, "%s/brio-tiles-%016" PRIx64, folder, brio_hash(o.key, o.tiles));
    EXPECT(mkdir(other, 0700) == 0 && symlink(other, name) == 0);
    close(open(precious, O_CREAT | O_WRONLY, 0600));
    EXPECT(brio_tiles_new(ctx, &o, &t) == BRIO_ERR_OPEN && !t, "%s", brio_message(ctx));
    EXPECT(unlink(precious) == 0 && unlink(name) == 0 && rmdir(other) == 0);
    EXPECT(brio_tiles_new(ctx, &o, &t) == BRIO_OK, "the name is the right one: %s", brio_message(ctx));
    brio_tiles_free(t);
    brio_context_free(ctx);
}

static int inside, together;

static void *come_and_go(void *context) {
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = 2, .key = 5};
    brio_context *ctx = context;
    for (int i = 0; i < 4000; i++) {
        brio_tiles *t;
        if (brio_tiles_new(ctx, &o, &t) != BRIO_OK) continue;
        if (__atomic_add_fetch(&inside, 1, __ATOMIC_SEQ_CST) > 1) __atomic_store_n(&together, 1, __ATOMIC_SEQ_CST);
        sched_yield();
        __atomic_sub_fetch(&inside, 1, __ATOMIC_SEQ_CST);
        brio_tiles_free(t);
    }
    return NULL;
}

/* The lock was ended before its file was removed. Who took it in between had a file without a name, and a third run
 * locked another one. */
static void two_runs_had_one_folder(void) {
    pthread_t thread[4];
    brio_context *ctx[4];
    for (int i = 0; i < 4; i++) ctx[i] = new_context();
    for (int i = 0; i < 4; i++) EXPECT(pthread_create(&thread[i], NULL, come_and_go, ctx[i]) == 0);
    for (int i = 0; i < 4; i++) pthread_join(thread[i], NULL);
    for (int i = 0; i < 4; i++) brio_context_free(ctx[i]);
    EXPECT(!together);
    EXPECT(files_left() == 0, "%zu files are left", files_left());
}

SUITE(test_tiles) {
    snprintf(folder, sizeof folder, "/tmp/brio-test-tiles-%ld", (long)getpid());
    EXPECT(mkdir(folder, 0700) == 0);
    RUN(small_sets);
    RUN(larger_sets);
    RUN(points_nearly_on_a_sphere);
    RUN(a_run_is_resumed);
    RUN(parts_are_the_whole);
    RUN(neighbours_across_tiles_are_those_of_the_whole);
    RUN(wrong_calls_for_neighbours_are_refused);
    RUN(neighbours_are_named_after_failures);
    RUN(neighbours_of_changed_tiles_are_refused);
    RUN(neighbours_where_there_are_no_tetrahedra);
    RUN(parts_do_not_depend_on_threads);
    RUN(a_tile_with_one_tetrahedron_many_times_is_refused);
    RUN(vertices_of_cells_do_not_depend_on_threads);
    RUN(cells_are_those_of_the_whole);
    RUN(tiles_read_what_was_left_out);
    RUN(wrong_calls_for_cells_are_refused);
    RUN(wrong_calls_are_refused);
    RUN(flat_points);
    RUN(cancelled_runs_leave_nothing);
    RUN(a_tile_was_counted_twice);
    RUN(half_spaces_took_whole_blocks);
    RUN(many_tiles_ran_out_of_descriptors);
    RUN(a_link_emptied_another_folder);
    RUN(two_runs_had_one_folder);
    rmdir(folder);
    return harness_end();
}
