/* Periodic triangulations: against the triangulation of many copies, which shares no code with the lattice, the halo, or
 * the classes; cells of lattices; invariance under what may change; every number of directions. */
#include "base/rng.h"
#include "harness.h"
#include "periodic/periodic.h"
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { MOST = 200, COPIES = 4, ALL = 1, SOME = 0 };

static brio_context *ctx;

/* --- inputs: small integers times a power of two, so that all translates are exact --- */

typedef struct {
    double points[3 * MOST], weights[MOST], cell[9];
    size_t count;
    int periodic[3];
    bool weighted;
} crystal;

static int below(brio_rng *rng, int n) {
    return (int)brio_rng_below(rng, (uint32_t)n);
}

static void set_cell(crystal *c, const double *cell) {
    memcpy(c->cell, cell, sizeof c->cell);
    for (int k = 0; k < 3; k++) c->periodic[k] = 1;
}

/* Makes points of a cell; `coarse` ones tie. */
static crystal random_crystal(brio_rng *rng, const double *cell, size_t n, int grid, bool weighted) {
    crystal c = {.count = n, .weighted = weighted};
    set_cell(&c, cell);
    for (size_t p = 0; p < n; p++) {
        double share[3];
        for (int k = 0; k < 3; k++) share[k] = (double)below(rng, grid) / grid;
        for (int k = 0; k < 3; k++)
            c.points[3 * p + (size_t)k] = share[0] * cell[k] + share[1] * cell[3 + k] + share[2] * cell[6 + k];
        c.weights[p] = below(rng, 5) / 8.0;
    }
    return c;
}

static brio_periodic *build(const crystal *c) {
    brio_periodic *t = NULL;
    brio_periodic_options o = {.size = sizeof o, .cell = c->cell};
    for (int k = 0; k < 3; k++) o.open[k] = !c->periodic[k];
    brio_status status = brio_delaunay_periodic(ctx, c->points, c->weighted ? c->weights : NULL, c->count, &o, &t);
    EXPECT(status == BRIO_OK, "%s", brio_message(ctx));
    return t;
}

/* --- the oracle --- */

typedef struct {
    int32_t v[4][4]; /* point and shift, sorted; the least vertex has the shift 0; BRIO_INFINITE as -1 */
} class_key;

static int compare_rows(const void *a, const void *b) {
    const int32_t *x = a, *y = b;
    for (int k = 0; k < 4; k++)
        if (x[k] != y[k]) return x[k] < y[k] ? -1 : 1;
    return 0;
}

static int compare_keys(const void *a, const void *b) {
    return memcmp(a, b, sizeof(class_key));
}

/* Returns the key of vertices (point, shift), moved so that row `least` has the shift 0. */
static class_key key_of(int32_t (*v)[4], int least) {
    class_key key;
    int32_t from[4] = {0, v[least][1], v[least][2], v[least][3]};
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) key.v[i][k] = v[i][0] < 0 ? -1 : v[i][k] - from[k];
    qsort(key.v, 4, sizeof *key.v, compare_rows);
    return key;
}

static void position_of(const crystal *c, const int32_t *v, double *x) {
    for (int k = 0; k < 3; k++)
        x[k] = c->points[3 * v[0] + k] + v[1] * c->cell[k] + v[2] * c->cell[3 + k] + v[3] * c->cell[6 + k];
}

static int least_of(const crystal *c, int32_t (*v)[4]) {
    double best[3] = {0, 0, 0}, x[3];
    int least = -1;
    for (int i = 0; i < 4; i++) {
        if (v[i][0] < 0) continue;
        position_of(c, v[i], x);
        int before = least < 0 ? 1 : 0;
        for (int k = 0; k < 3 && !before; k++) {
            if (x[k] == best[k]) continue;
            before = x[k] < best[k] ? 1 : -1;
        }
        if (before > 0) least = i, memcpy(best, x, sizeof x);
    }
    return least;
}

/* Returns the classes of the copies' tetrahedra whose least vertex is in the middle copy. */
static class_key *classes_of_copies(const crystal *c, int copies, size_t *count) {
    size_t side = 2 * (size_t)copies + 1, n = c->count * side * side * side, at = 0;
    double *points = malloc(3 * n * sizeof *points), *weights = malloc(n * sizeof *weights);
    int32_t(*name)[4] = malloc(n * sizeof *name), s[3];
    brio_triangulation *t = NULL;
    for (s[0] = -copies; s[0] <= copies; s[0]++)
        for (s[1] = -copies; s[1] <= copies; s[1]++)
            for (s[2] = -copies; s[2] <= copies; s[2]++) {
                if ((s[0] && !c->periodic[0]) || (s[1] && !c->periodic[1]) || (s[2] && !c->periodic[2])) continue;
                for (size_t p = 0; p < c->count; p++, at++) {
                    int32_t v[4] = {(int32_t)p, s[0], s[1], s[2]};
                    memcpy(name[at], v, sizeof v);
                    position_of(c, v, points + 3 * at);
                    weights[at] = c->weights[p];
                }
            }
    EXPECT(brio_delaunay(ctx, points, c->weighted ? weights : NULL, at, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    const brio_delaunay_stats *f = brio_triangulation_stats(t);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    size_t all = f->tetrahedra + f->hull_facets;
    class_key *keys = calloc(all + 1, sizeof *keys);
    *count = 0;
    for (size_t i = 0; i < all; i++) {
        int32_t v[4][4];
        for (int k = 0; k < 4; k++) {
            if (tet[i].vertex[k] == BRIO_INFINITE)
                memset(v[k], 0xff, sizeof v[k]);
            else
                memcpy(v[k], name[tet[i].vertex[k]], sizeof v[k]);
        }
        int least = least_of(c, v);
        if (v[least][1] || v[least][2] || v[least][3]) continue;
        keys[(*count)++] = key_of(v, least);
    }
    qsort(keys, *count, sizeof *keys, compare_keys);
    brio_triangulation_free(t);
    free(points), free(weights), free(name);
    return keys;
}

static class_key *classes_of(const crystal *c, const brio_periodic *t, size_t *count) {
    const brio_periodic_stats *f = brio_periodic_facts(t);
    const brio_tetrahedron *tet = brio_periodic_tetrahedra(t);
    const brio_image *image = brio_periodic_images(t);
    *count = f->tetrahedra + f->hull_facets;
    class_key *keys = calloc(*count + 1, sizeof *keys);
    for (size_t i = 0; i < *count; i++) {
        int32_t v[4][4];
        for (int k = 0; k < 4; k++) {
            memset(v[k], 0xff, sizeof v[k]);
            if (tet[i].vertex[k] == BRIO_INFINITE) continue;
            const brio_image *m = &image[tet[i].vertex[k]];
            int32_t row[4] = {(int32_t)m->point, m->shift[0], m->shift[1], m->shift[2]};
            memcpy(v[k], row, sizeof row);
        }
        int least = least_of(c, v);
        EXPECT(tet[i].vertex[least] < c->count, "the least vertex of tetrahedron %zu is a translate", i);
        keys[i] = key_of(v, least);
    }
    qsort(keys, *count, sizeof *keys, compare_keys);
    return keys;
}

static void compare_with_copies(const crystal *c, const brio_periodic *t, int copies, const char *what) {
    size_t ours, theirs;
    class_key *a = classes_of(c, t, &ours), *b = classes_of_copies(c, copies, &theirs);
    EXPECT(ours == theirs, "%s: %zu classes, %zu of the copies", what, ours, theirs);
    EXPECT(ours != theirs || !memcmp(a, b, ours * sizeof *a), "%s: other classes", what);
    free(a), free(b);
}

static void check(const brio_periodic *t, const char *what) {
    EXPECT(brio_periodic_check(ctx, t) == BRIO_OK, "%s: %s", what, brio_message(ctx));
}

/* --- cells of lattices and skewed ones --- */

static const double CELLS[][9] = {
    {1, 0, 0, 0, 1, 0, 0, 0, 1},    {4, 0, 0, 0, 2, 0, 0, 0, 1},  {0, 1, 1, 1, 0, 1, 1, 1, 0},
    {-1, 1, 1, 1, -1, 1, 1, 1, -1}, {8, 0, 0, 3, 7, 0, 1, 2, 9},  {1, 0, 0, 50, 1, 0, 20, 30, 1},
    {1, 0, 0, 0, 16, 0, 0, 0, 16},  {16, 0, 0, 0, 1, 0, 0, 0, 1}, {3, 1, 0, -1, 3, 1, 0, -1, 5},
    {64, 1, 0, 63, 1, 1, 0, 1, 2},
};
enum { NUM_CELLS = sizeof CELLS / sizeof *CELLS };

static void is_the_triangulation_of_many_copies(void) {
    brio_rng rng = brio_rng_new(3);
    for (int round = 0; round < (SHORT_TESTS ? 1 : 6); round++)
        for (int i = 0; i < NUM_CELLS; i++)
            for (int n = 1; n <= (BRIEF_TESTS ? 5 : 9); n += 4)
                for (int weighted = 0; weighted < 2; weighted++) {
                    bool skewed = i == 5 || i == 6 || i == 7 || i == 9;
                    if (skewed) continue; /* the copies would be too few, or too many */
                    crystal c = random_crystal(&rng, CELLS[i], (size_t)n, n == 5 ? 4 : 64, weighted);
                    brio_periodic *t = build(&c);
                    char what[64];
                    snprintf(what, sizeof what, "cell %d, %d points, weights %d", i, n, weighted);
                    if (t) compare_with_copies(&c, t, n > 5 ? 2 : 3, what), check(t, what);
                    brio_periodic_free(t);
                }
}

static void any_cell_fills_its_volume(void) {
    brio_rng rng = brio_rng_new(5);
    for (int i = 0; i < NUM_CELLS; i++)
        for (int n = 1; n <= 50; n = 3 * n + 1)
            for (int weighted = 0; weighted < 2; weighted++) {
                crystal c = random_crystal(&rng, CELLS[i], (size_t)n, n % 2 ? 64 : 4, weighted);
                brio_periodic *t = build(&c);
                brio_cells *cells = NULL;
                char what[64];
                snprintf(what, sizeof what, "cell %d, %d points, weights %d", i, n, weighted);
                if (!t) continue;
                check(t, what);
                EXPECT(brio_periodic_cells(ctx, t, NULL, &cells) == BRIO_OK, "%s: %s", what, brio_message(ctx));
                double volume = brio_periodic_facts(t)->cell_volume;
                if (cells)
                    EXPECT(fabs(cells->volume_sum / volume - 1) < 1e-12, "%s: %.17g of %g", what, cells->volume_sum,
                           volume);
                brio_cells_free(cells);
                brio_periodic_free(t);
            }
}

/* Cells that meet may all be shown at other translates: a table that had room for twice the vertices was full. Corners
 * are as far from their site as from the neighbour behind the face. */
static void cells_of_skewed_domains_that_meet_move_apart(void) {
    brio_rng rng = brio_rng_new(11);
    brio_cells_options o = {.size = sizeof o, .vertices = 1};
    for (int rank = 1; rank <= 3; rank++)
        for (int i = 0; i < NUM_CELLS; i++) {
            crystal c = random_crystal(&rng, CELLS[i], MOST, 1 << 20, false);
            for (int k = 0; k < 3; k++) c.periodic[k] = k < rank;
            brio_periodic *t = build(&c);
            brio_cells *cells = NULL;
            if (!t) continue;
            EXPECT(brio_periodic_cells(ctx, t, &o, &cells) == BRIO_OK, "cell %d, rank %d: %s", i, rank,
                   brio_message(ctx));
            double worst = 0;
            for (size_t n = 0; cells && n < cells->num_cells; n++)
                for (uint64_t f = cells->face_offsets[n]; f < cells->face_offsets[n + 1]; f++)
                    for (uint64_t at = cells->corner_offsets[f]; at < cells->corner_offsets[f + 1]; at++) {
                        const double *site = c.points + 3 * (size_t)cells->site[n], *corner;
                        double own = 0, other = 0;
                        if (cells->face_neighbours[f] < 0) continue;
                        EXPECT(cells->face_vertices[at] < cells->num_vertices);
                        corner = cells->vertices + 3 * (size_t)cells->face_vertices[at];
                        for (int k = 0; k < 3; k++) {
                            double beyond = c.points[3 * (size_t)cells->face_neighbours[f] + (size_t)k];
                            for (int j = 0; j < 3; j++)
                                beyond += cells->face_shifts[3 * f + (size_t)j] * c.cell[3 * j + k];
                            own += (corner[k] - site[k]) * (corner[k] - site[k]);
                            other += (corner[k] - beyond) * (corner[k] - beyond);
                        }
                        worst = fmax(worst, fabs(own - other) / fmax(own, other));
                    }
            EXPECT(worst < 1e-6, "cell %d, rank %d: %g", i, rank, worst);
            brio_cells_free(cells);
            brio_periodic_free(t);
        }
}

/* Volumes and neighbours alone, from a sweep, against cells with everything: also where points are hidden, tie, or have
 * neighbours that are translates of themselves, and where cells are thin. Each face is seen from both of its cells. */
static void neighbours_alone_are_those_of_whole_cells(void) {
    brio_rng rng = brio_rng_new(57);
    brio_cells_options o = {.size = sizeof o, .no_areas = 1, .no_centroids = 1, .no_face_sizes = 1};
    size_t swept = 0;
    for (int round = 0; round < 8 * NUM_CELLS; round++) {
        int i = round % NUM_CELLS, kind = round / NUM_CELLS, n = kind < 6 ? 1 + 9 * kind : 60;
        crystal c = random_crystal(&rng, CELLS[i], (size_t)n, kind % 2 ? 4 : 1 << 20, kind % 3 == 0);
        for (int k = 0; k < 3 && kind > 5; k++) c.periodic[k] = k < 8 - kind; /* slabs and wires */
        brio_periodic *t = build(&c);
        brio_cells *whole = NULL, *alone = NULL;
        if (!t) continue;
        brio_context_set_threads(ctx, 1 + round % 3);
        EXPECT(brio_periodic_cells(ctx, t, NULL, &whole) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_periodic_cells(ctx, t, &o, &alone) == BRIO_OK, "%s", brio_message(ctx));
        if (whole && alone) {
            size_t m = whole->num_cells, faces = (size_t)whole->face_offsets[m];
            int64_t shifts[3] = {0, 0, 0};
            EXPECT(alone->num_cells == m && !memcmp(alone->site, whole->site, m * sizeof *whole->site), "%d", round);
            EXPECT(!memcmp(alone->face_offsets, whole->face_offsets, (m + 1) * sizeof *whole->face_offsets), "%d",
                   round);
            EXPECT(!memcmp(alone->face_neighbours, whole->face_neighbours, faces * sizeof(int64_t)), "%d", round);
            EXPECT(!memcmp(alone->face_shifts, whole->face_shifts, 3 * faces * sizeof(int32_t)), "%d", round);
            for (size_t f = 0; f < 3 * faces; f++) shifts[f % 3] += alone->face_shifts[f];
            EXPECT(shifts[0] == 0 && shifts[1] == 0 && shifts[2] == 0, "%d: a face is seen from one side", round);
            for (size_t k = 0; k < m; k++)
                EXPECT(alone->volume[k] == whole->volume[k] ||
                           fabs(alone->volume[k] - whole->volume[k]) <= 1e-11 * whole->volume[k],
                       "%d, cell %zu: %.17g %.17g", round, k, alone->volume[k], whole->volume[k]);
            swept += m;
        }
        brio_cells_free(whole);
        brio_cells_free(alone);
        brio_periodic_free(t);
    }
    brio_context_set_threads(ctx, 0);
    EXPECT(swept > 1000, "%zu cells", swept);
}

static void faces_of_lattices_are_right(void) {
    static const struct {
        double cell[9];
        int faces;
    } lattices[] = {
        {{1, 0, 0, 0, 1, 0, 0, 0, 1}, 6},
        {{0, 1, 1, 1, 0, 1, 1, 1, 0}, 12},
        {{-1, 1, 1, 1, -1, 1, 1, 1, -1}, 14},
        {{0, 2.025, 2.025, 2.025, 0, 2.025, 2.025, 2.025, 0}, 12},
    };
    static const double zero[3] = {0, 0, 0};
    for (size_t i = 0; i < sizeof lattices / sizeof *lattices; i++) {
        crystal c = {.count = 1};
        set_cell(&c, lattices[i].cell);
        memcpy(c.points, zero, sizeof zero);
        brio_periodic *t = build(&c);
        brio_cells *cells = NULL;
        EXPECT(t && brio_periodic_cells(ctx, t, NULL, &cells) == BRIO_OK, "%s", brio_message(ctx));
        if (!cells) continue;
        EXPECT((int)cells->face_offsets[1] == lattices[i].faces, "lattice %zu: %d faces", i,
               (int)cells->face_offsets[1]);
        brio_cells_free(cells);
        brio_periodic_free(t);
    }
}

/* A conventional cell of 4 atoms of fcc with an edge that is no dyadic number: every cell has 12 faces. */
static void fractions_of_the_cell_stay_exact(void) {
    static const double shares[4][3] = {{0, 0, 0}, {0, .5, .5}, {.5, 0, .5}, {.5, .5, 0}};
    double a = 4.0495;
    for (int skew = 0; skew < 3; skew++) {
        crystal c = {.count = 4};
        double cell[9] = {a, 0, 0, skew * a, a, 0, -7 * skew * a, 3 * skew * a, a};
        set_cell(&c, cell);
        for (int p = 0; p < 4; p++)
            for (int k = 0; k < 3; k++) c.points[3 * p + k] = shares[p][k] * a + 0.1;
        brio_periodic *t = build(&c);
        brio_cells *cells = NULL;
        EXPECT(t && brio_periodic_cells(ctx, t, NULL, &cells) == BRIO_OK, "%s", brio_message(ctx));
        if (!cells) continue;
        for (size_t n = 0; n < 4; n++) {
            EXPECT(cells->face_offsets[n + 1] - cells->face_offsets[n] == 12, "skew %d: %d faces", skew,
                   (int)(cells->face_offsets[n + 1] - cells->face_offsets[n]));
            EXPECT(fabs(cells->volume[n] / (a * a * a / 4) - 1) < 1e-13, "%.17g", cells->volume[n] / (a * a * a / 4));
        }
        brio_cells_free(cells);
        brio_periodic_free(t);
    }
}

/* --- invariance --- */

static void origins_and_representatives_do_not_matter(void) {
    brio_rng rng = brio_rng_new(7);
    for (int kind = 0; kind < 4; kind++) {
        crystal c =
            random_crystal(&rng, CELLS[kind == 3 ? 8 : kind], kind < 2 ? 30 : 8, kind == 1 ? 4 : 1 << 20, kind == 2);
        brio_periodic *t = build(&c);
        uint64_t first, sum;
        EXPECT(brio_periodic_checksum(ctx, t, &first) == BRIO_OK, "%s", brio_message(ctx));
        brio_periodic_free(t);
        for (int round = 0; round < (BRIEF_TESTS ? 8 : SHORT_TESTS ? 25 : 250); round++) {
            crystal d = c;
            double origin[3];
            for (int k = 0; k < 3; k++) origin[k] = brio_rng_double(&rng) * 10 - 5; /* not on the grid */
            for (size_t p = 0; p < c.count; p++) {
                size_t q = (p + (size_t)round) % c.count; /* another order, too */
                d.weights[q] = c.weights[p];
                int s[3] = {below(&rng, 9) - 4, below(&rng, 9) - 4, below(&rng, 9) - 4};
                for (int k = 0; k < 3; k++)
                    d.points[3 * q + (size_t)k] = c.points[3 * p + (size_t)k] + origin[k] + s[0] * c.cell[k] +
                                                  s[1] * c.cell[3 + k] + s[2] * c.cell[6 + k];
            }
            t = build(&d);
            EXPECT(brio_periodic_checksum(ctx, t, &sum) == BRIO_OK && sum == first, "kind %d, round %d", kind, round);
            brio_periodic_free(t);
        }
    }
}

static void checksum_tells_triangulations_apart(void) {
    brio_rng rng = brio_rng_new(9);
    crystal c = random_crystal(&rng, CELLS[0], 20, 1 << 20, false);
    uint64_t one, other;
    brio_periodic *t = build(&c);
    EXPECT(brio_periodic_checksum(ctx, t, &one) == BRIO_OK, "%s", brio_message(ctx));
    brio_periodic_free(t);
    c.points[0] += 0.25;
    t = build(&c);
    EXPECT(brio_periodic_checksum(ctx, t, &other) == BRIO_OK && one != other, "the same");
    brio_periodic_free(t);
}

/* --- fewer directions; larger sets --- */

static void slabs_and_wires_are_those_of_many_copies(void) {
    brio_rng rng = brio_rng_new(11);
    for (int round = 0; round < (BRIEF_TESTS ? 1 : SHORT_TESTS ? 2 : 10); round++)
        for (int i = 0; i < 3; i++)
            for (int directions = 1; directions < 7; directions++)
                for (int weighted = 0; weighted < 2; weighted++) {
                    crystal c = random_crystal(&rng, CELLS[i == 2 ? 8 : i], 6, round % 2 ? 4 : 64, weighted);
                    for (int k = 0; k < 3; k++) c.periodic[k] = directions >> k & 1;
                    brio_periodic *t = build(&c);
                    char what[64];
                    snprintf(what, sizeof what, "cell %d, directions %d, weights %d", i, directions, weighted);
                    if (t && brio_periodic_facts(t)->dimension == 3)
                        compare_with_copies(&c, t, 6, what), check(t, what);
                    brio_periodic_free(t);
                }
}

/* Points of a slab: the layer at its faces needs translates from all over the cell. */
static void halos_do_not_matter(void) {
    size_t n = BRIEF_TESTS ? 800 : SHORT_TESTS ? 2000 : 20000;
    brio_rng rng = brio_rng_new(13);
    double *points = malloc(3 * n * sizeof *points);
    for (int directions = 1; directions < 8; directions++)
        for (int clustered = 0; clustered < 2; clustered++) {
            int open[3] = {!(directions & 1), !(directions >> 1 & 1), !(directions >> 2 & 1)};
            double cell[9] = {1, 0, 0, 0.25, 1, 0, 0, 0.125, 1};
            uint64_t sum[3];
            for (size_t i = 0; i < 3 * n; i++) points[i] = pow(brio_rng_double(&rng), clustered ? 4 : 1);
            for (int h = 0; h < 3; h++) {
                brio_periodic_options o = {.size = sizeof o, .cell = cell, .halo = h == 0 ? 0.5 : h == 1 ? 2.5 : 12};
                memcpy(o.open, open, sizeof open);
                brio_periodic *t = NULL;
                EXPECT(brio_delaunay_periodic(ctx, points, NULL, n, &o, &t) == BRIO_OK, "%s", brio_message(ctx));
                if (!t) continue;
                EXPECT(brio_periodic_checksum(ctx, t, &sum[h]) == BRIO_OK, "%s", brio_message(ctx));
                check(t, "halo");
                if (h == 0) EXPECT(brio_periodic_facts(t)->completed > 0, "nothing was completed");
                brio_periodic_free(t);
            }
            EXPECT(sum[0] == sum[1] && sum[1] == sum[2], "directions %d, clustered %d", directions, clustered);
        }
    free(points);
}

/* --- extremes --- */

/* Skewed cells and points far away: what an image says is where it is, or the input is refused. Sums of shifts did not
 * fit into 32 bits. */
static void shifts_fit_or_are_refused(void) {
    size_t made = 0, refused = 0;
    for (int bits = 10; bits <= 34; bits++)
        for (int sign = -1; sign <= 1; sign++) {
            double far = ldexp(1, bits), cell[9] = {1, 0, 0, far, 1, 0, far, 0, 1};
            double points[6] = {0, 0, 0, sign * far + 0.5, 0.5, 0.5};
            brio_periodic_options o = {.size = sizeof o, .cell = cell};
            brio_periodic *t = NULL;
            brio_status status = brio_delaunay_periodic(ctx, points, NULL, 2, &o, &t);
            EXPECT(status == BRIO_OK || status == BRIO_ERR_ARGUMENT, "%s", brio_message(ctx));
            refused += status != BRIO_OK;
            if (status != BRIO_OK) continue;
            made++;
            const brio_image *image = brio_periodic_images(t);
            size_t wrong = 0;
            for (size_t i = 0; i < brio_periodic_facts(t)->images; i++) {
                const int32_t *s = image[i].shift;
                double x = points[3 * image[i].point] + s[0] + far * s[1] + far * s[2];
                wrong += fabs(x - brio_periodic_positions(t)[3 * i]) > 1;
            }
            EXPECT(wrong == 0, "2^%d, %d: %zu images are elsewhere", bits, sign, wrong);
            brio_periodic_free(t);
        }
    EXPECT(made > 20 && refused > 0, "%zu made, %zu refused", made, refused);
}

/* The check returned BRIO_OK without a look where there are no tetrahedra. */
static void flat_points_are_checked(void) {
    static const double points[3][9] = {{0}, {0, 0, 0, .5, 0, 0, .25, 0, 0}, {0, 0, 0, .5, .5, 0, .5, .5, 0}};
    static const double slab[9] = {1, 0, 0, 0, 1, 0};
    for (int i = 0; i < 3; i++)
        for (int directions = 1; directions <= 3; directions++) {
            double cell[9];
            memcpy(cell, slab, sizeof cell);
            cell[8] = 1;
            brio_periodic_options o = {.size = sizeof o, .cell = cell, .open = {0, directions < 2, directions < 3}};
            brio_periodic *t = NULL;
            EXPECT(brio_delaunay_periodic(ctx, points[i], NULL, i ? 3 : 1, &o, &t) == BRIO_OK, "%s", brio_message(ctx));
            if (!t) continue;
            brio_periodic_stats *s = (brio_periodic_stats *)brio_periodic_facts(t);
            int right = s->dimension;
            EXPECT(right == (i == 2 && directions < 2 ? 2 : directions), "%d: dimension %d", i, right);
            for (int said = 1; said <= 2; said++) {
                s->dimension = said;
                brio_status status = brio_periodic_check(ctx, t);
                EXPECT((status == BRIO_OK) == (said == right), "%d: dimension %d of %d: %s", i, said, right,
                       brio_message(ctx));
            }
            s->dimension = right;
            check(t, "flat");
            s->vertices++;
            EXPECT(brio_periodic_check(ctx, t) == BRIO_ERR_CHECK, "%d: a vertex too many", i);
            brio_periodic_free(t);
        }
}

/* Some reduced bases of face-centred lattices were refused: the bound on the translates that matter was too coarse. */
static void every_basis_of_a_lattice_has_a_result(void) {
    brio_rng rng = brio_rng_new(29);
    static const int lattices[] = {2, 3, 4, 8};
    for (int round = 0; round < (BRIEF_TESTS ? 20 : 100); round++) {
        double cell[9];
        memcpy(cell, CELLS[lattices[round % 4]], sizeof cell);
        for (int step = 0; step < 12; step++) {
            int to = below(&rng, 3), from = (to + 1 + below(&rng, 2)) % 3, n = below(&rng, 5) - 2;
            for (int k = 0; k < 3; k++) cell[3 * to + k] += n * cell[3 * from + k];
        }
        crystal c = random_crystal(&rng, cell, 1 + (size_t)round % 3, 64, false);
        brio_periodic *t = build(&c);
        if (t) check(t, "a basis");
        brio_periodic_free(t);
    }
}

/* Turns lengths of a box in space, at random: three vectors that are upright to each other, up to rounding. */
static void turned_box(brio_rng *rng, const double *lengths, double *cell) {
    for (int i = 0; i < 3; i++) {
        double *v = cell + 3 * i;
        for (int k = 0; k < 3; k++) v[k] = brio_rng_double(rng) - 0.5;
        for (int pass = 0; pass < 2; pass++)
            for (int j = 0; j < i; j++) {
                const double *u = cell + 3 * j;
                double share = v[0] * u[0] + v[1] * u[1] + v[2] * u[2];
                for (int k = 0; k < 3; k++) v[k] -= share * u[k];
            }
        double length = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        for (int k = 0; k < 3; k++) v[k] /= length;
    }
    for (int i = 0; i < 9; i++) cell[i] *= lengths[i / 3];
}

/* Bounds from vectors that are nearly parallel were rounded below what tetrahedra need; the check lost digits of needles.
 * Where two directions repeat there are two layers. */
static void long_turned_cells_have_all_translates(void) {
    brio_rng rng = brio_rng_new(37);
    for (int round = 0; round < 240; round++) {
        int directions = 2 + round / 6 % 2;
        crystal c = {.count = directions < 3 ? 2 : 1};
        double cell[9], least = 2, far = pow(10, 1 + round % 6);
        turned_box(&rng, (double[3]){1, directions < 3 ? far : 1, directions < 3 ? 1 : far}, cell);
        set_cell(&c, cell);
        c.periodic[2] = directions > 2;
        for (int k = 0; k < 3; k++) c.points[3 + k] = 0.25 * cell[k] + cell[6 + k];
        brio_periodic *t = build(&c);
        if (!t) continue;
        for (int i = 0; i < directions; i++) least = fmin(least, t->lattice.range[i]);
        EXPECT(least >= 1, "round %d: the vertices of a tetrahedron differ by a vector, not by %.17g of it", round,
               least);
        check(t, "a long cell");
        brio_periodic_free(t);
    }
}

/* A cell 10^10 times as long as it is wide is not reduced any more when it is on its grid. The translates that would
 * matter were made without end. */
static void needles_beyond_the_grid_are_refused(void) {
    static const double cell[9] = {-0.11287830639753071, 0.95309757510075299, -0.28082645936928735,
                                   -7672399729.1987352,  -2631957368.359724,  -5848682142.7162657,
                                   -0.63134880367253166, 0.14944235158894678, 0.76096364673539352};
    static const double points[6] = {0, 0, 0, -0.65956838027191433, 0.38771674536413503, 0.69075703189307169};
    brio_periodic_options o = {.size = sizeof o, .cell = cell, .open = {0, 0, 1}};
    brio_periodic *t = NULL;
    EXPECT(brio_delaunay_periodic(ctx, points, NULL, 2, &o, &t) == BRIO_ERR_ARGUMENT && !t, "%s", brio_message(ctx));
    brio_periodic_free(t);
}

/* Makes the triangulation of a cell of twice the length into one that covers the plain cell's space twice: each class is
 * there twice, and all looks right from near. `twice` has points n to 2n - 1 at those of `once` moved by its vector a.
 * Returns the triangulation, whose arrays the caller frees, or whose tetrahedra are NULL on error. */
static brio_periodic cover_twice(const brio_periodic *once, const brio_periodic *twice) {
    brio_periodic out = *once;
    size_t n = once->stats.points, count = twice->stats.tetrahedra + twice->stats.hull_facets;
    out.stats.tetrahedra = twice->stats.tetrahedra, out.stats.hull_facets = twice->stats.hull_facets;
    out.tet = malloc(count * sizeof *out.tet);
    EXPECT(brio_images_new(ctx, &once->lattice, (const double(*)[3])twice->images.x, NULL, n, &out.images) == BRIO_OK);
    for (size_t t = 0; t < count; t++) {
        out.tet[t] = twice->tet[t];
        uint32_t *v = out.tet[t].vertex;
        int32_t shift[4][3], from[3];
        for (int k = 0; k < 4; k++) {
            if (v[k] == BRIO_INFINITE) continue;
            const brio_image *i = &twice->images.list[v[k]];
            memcpy(shift[k], i->shift, sizeof shift[k]);
            shift[k][0] = 2 * shift[k][0] + (i->point >= n);
        }
        memcpy(from, shift[brio_images_least(&twice->images, v, 4)], sizeof from);
        for (int k = 0; k < 4; k++) {
            if (v[k] == BRIO_INFINITE) continue;
            uint32_t point = twice->images.list[v[k]].point % (uint32_t)n;
            for (int a = 0; a < 3; a++) shift[k][a] -= from[a];
            EXPECT(brio_images_find(&out.images, point, shift[k], &v[k]) == BRIO_OK);
        }
    }
    return out;
}

/* With fewer than three directions the check did not find that space was covered twice. Squares of small cells' sides
 * are no doubles. */
static void space_is_covered_once(void) {
    enum { FEW = 12 };
    static const double cells[2][9] = {{1, 0, 0, 0.25, 4, 0, 0, 0.5, 4}, {2, 0, 0, 0.25, 4, 0, 0, 0.5, 4}};
    brio_rng rng = brio_rng_new(17);
    for (int directions = 1; directions <= 3; directions++) {
        crystal c[2] = {random_crystal(&rng, cells[0], FEW, 64, false)};
        c[1] = c[0];
        set_cell(&c[1], cells[1]);
        c[1].count = 2 * FEW;
        memcpy(c[1].points + 3 * FEW, c[0].points, 3 * FEW * sizeof(double));
        for (size_t p = FEW; p < 2 * FEW; p++) c[1].points[3 * p]++;
        for (size_t i = 0; i < 3 * MOST + 9; i++)
            for (int j = 0; j < 2; j++)
                *(i < 9 ? &c[j].cell[i] : &c[j].points[i - 9]) *= directions == 1 ? 0x1p-300 : 0x1p-200;
        brio_periodic *t[2];
        for (int i = 0; i < 2; i++) {
            for (int k = 0; k < 3; k++) c[i].periodic[k] = k < directions;
            t[i] = build(&c[i]);
            check(t[i], "covered once");
        }
        brio_periodic wrong = cover_twice(t[0], t[1]);
        EXPECT(brio_periodic_check(ctx, &wrong) == BRIO_ERR_CHECK && strstr(brio_message(ctx), "fill their space 2"),
               "%d directions: %s", directions, brio_message(ctx));
        brio_images_free(&wrong.images);
        free(wrong.tet);
        for (int i = 0; i < 2; i++) brio_periodic_free(t[i]);
    }
}

static void no_points_have_a_result(void) {
    crystal c = {.count = 0};
    set_cell(&c, CELLS[4]);
    for (int directions = 1; directions < 8; directions++) {
        for (int k = 0; k < 3; k++) c.periodic[k] = directions >> k & 1;
        brio_periodic *t = build(&c);
        brio_cells *cells = NULL;
        if (!t) continue;
        check(t, "no points");
        EXPECT(brio_periodic_facts(t)->tetrahedra == 0 && brio_periodic_facts(t)->images == 0, "tetrahedra");
        EXPECT(brio_periodic_cells(ctx, t, NULL, &cells) == BRIO_OK && cells->num_cells == 0, "%s", brio_message(ctx));
        brio_cells_free(cells);
        brio_periodic_free(t);
    }
}

static void wrong_options_are_refused(void) {
    static const double point[3] = {0, 0, 0}, cell[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
    double flat[9] = {1, 0, 0, 2, 0, 0, 0, 0, 1}, other[9] = {1, 0, 0, NAN, 1, 0, 0, 0, 1};
    brio_periodic_options wrong[] = {
        {.cell = NULL},
        {.cell = flat},
        {.cell = other},
        {.cell = cell, .halo = NAN},
        {.cell = cell, .halo = -1},
        {.cell = cell, .open = {1, 1, 1}},
        {.cell = cell, .reserved_int = 1},
    };
    for (size_t i = 0; i < sizeof wrong / sizeof *wrong; i++) {
        brio_periodic *t = NULL;
        wrong[i].size = sizeof wrong[i];
        EXPECT(brio_delaunay_periodic(ctx, point, NULL, 1, &wrong[i], &t) == BRIO_ERR_ARGUMENT && !t, "options %zu", i);
        brio_periodic_free(t);
    }
    brio_periodic_options o = {
        .size = sizeof o, .cell = other, .open = {0, 1, 0}}; /* what is not read may be anything */
    brio_periodic *t = NULL;
    EXPECT(brio_delaunay_periodic(ctx, point, NULL, 1, &o, &t) == BRIO_OK, "%s", brio_message(ctx));
    brio_periodic_free(t);
}

SUITE(test_periodic) {
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return 1;
    RUN(neighbours_alone_are_those_of_whole_cells);
    RUN(faces_of_lattices_are_right);
    RUN(is_the_triangulation_of_many_copies);
    RUN(any_cell_fills_its_volume);
    RUN(cells_of_skewed_domains_that_meet_move_apart);
    RUN(fractions_of_the_cell_stay_exact);
    RUN(origins_and_representatives_do_not_matter);
    RUN(checksum_tells_triangulations_apart);
    RUN(slabs_and_wires_are_those_of_many_copies);
    RUN(halos_do_not_matter);
    RUN(shifts_fit_or_are_refused);
    RUN(flat_points_are_checked);
    RUN(every_basis_of_a_lattice_has_a_result);
    RUN(long_turned_cells_have_all_translates);
    RUN(needles_beyond_the_grid_are_refused);
    RUN(space_is_covered_once);
    RUN(no_points_have_a_result);
    RUN(wrong_options_are_refused);
    brio_context_free(ctx);
    return harness_end();
}
