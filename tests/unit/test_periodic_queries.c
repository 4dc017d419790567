/* Alpha complexes and locations in space that repeats, against many copies and all translates. */
#include "base/rng.h"
#include "failing_allocator.h"
#include "harness.h"
#include <fcntl.h>
#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { POINTS = 12, COPIES = 3, SIDE = 2 * COPIES + 1, MOST = POINTS * SIDE * SIDE * SIDE };

static brio_context *ctx;

/* Points whose translates are all exact: sixteenths (which tie) or 2^-20ths of a cell. */
typedef struct {
    double points[3 * POINTS], weights[POINTS];
    const double *cell;
    int open[3];
    bool weighted;
    brio_periodic *t;
} sample;

static const double CUBE[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1}, TILTED[9] = {1, 0, 0, 0.5, 1, 0, 0.25, 0.5, 1};

static sample make(uint64_t seed, const double *cell, const char *directions, int grid, bool weighted) {
    sample s = {.cell = cell, .weighted = weighted};
    brio_rng rng = brio_rng_new(seed);
    for (size_t p = 0; p < POINTS; p++) {
        double share[3];
        for (int k = 0; k < 3; k++) share[k] = (double)brio_rng_below(&rng, (uint32_t)grid) / grid;
        for (size_t k = 0; k < 3; k++)
            s.points[3 * p + k] = share[0] * cell[k] + share[1] * cell[3 + k] + share[2] * cell[6 + k];
        s.weights[p] = brio_rng_below(&rng, 5) / 64.0;
    }
    brio_periodic_options o = {.size = sizeof o, .cell = cell};
    for (int k = 0; k < 3; k++) o.open[k] = s.open[k] = !strchr(directions, "xyz"[k]);
    EXPECT(brio_delaunay_periodic(ctx, s.points, weighted ? s.weights : NULL, POINTS, &o, &s.t) == BRIO_OK, "%s",
           brio_message(ctx));
    return s;
}

static void place_of(const sample *s, size_t point, const int32_t *shift, double *x) {
    for (size_t k = 0; k < 3; k++)
        x[k] = s->points[3 * point + k] + shift[0] * s->cell[k] + shift[1] * s->cell[3 + k] + shift[2] * s->cell[6 + k];
}

/* --- alpha --- */

static double copies[3 * MOST], copies_weights[MOST];
static bool in_the_middle[MOST];

static size_t copy_all(const sample *s) {
    size_t n = 0;
    int32_t c[3];
    for (c[0] = -COPIES; c[0] <= COPIES; c[0]++)
        for (c[1] = -COPIES; c[1] <= COPIES; c[1]++)
            for (c[2] = -COPIES; c[2] <= COPIES; c[2]++) {
                if ((c[0] && s->open[0]) || (c[1] && s->open[1]) || (c[2] && s->open[2])) continue;
                for (size_t p = 0; p < POINTS; p++, n++) {
                    place_of(s, p, c, copies + 3 * n);
                    copies_weights[n] = s->weights[p];
                    in_the_middle[n] = !c[0] && !c[1] && !c[2];
                }
            }
    return n;
}

static int before(const double *a, const double *b) {
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k] ? -1 : 1;
    return 0;
}

static int compare(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Sorts values, and expects them to be equal but for rounding. */
static void same_values(double *a, size_t na, double *b, size_t nb, size_t k, uint64_t seed) {
    EXPECT(na == nb, "%d: dimension %zu: %zu simplices, not %zu", (int)seed, k, na, nb);
    qsort(a, na, sizeof *a, compare), qsort(b, nb, sizeof *b, compare);
    for (size_t i = 0; i < na && i < nb; i++)
        if (!(fabs(a[i] - b[i]) <= 1e-13)) {
            EXPECT(false, "%d: dimension %zu: %.17g, not %.17g", (int)seed, k, a[i], b[i]);
            break;
        }
}

/* Expects that every face of a simplex that is in the list has no greater value. */
static void grows(const brio_periodic_alpha *a) {
    const brio_alpha_complex *c = a->complex;
    for (size_t k = 1; k < 4; k++)
        for (size_t n = 0; n < c->counts[k]; n++)
            for (size_t m = 0; m < c->counts[k - 1]; m++) {
                size_t shared = 0;
                for (size_t i = 0; i < k; i++)
                    for (size_t j = 0; j <= k; j++)
                        shared += c->simplices[k - 1][m * k + i] == c->simplices[k][n * (k + 1) + j];
                EXPECT(shared < k || c->values[k - 1][m] <= c->values[k][n]);
            }
}

/* Expects that each simplex begins with an image in the domain: so one stands for each class, always the same. */
static void stand_for_their_classes(const sample *s, const brio_periodic_alpha *a) {
    const brio_alpha_complex *c = a->complex;
    size_t wrong = 0;
    for (size_t k = 0; k < 4; k++)
        for (size_t n = 0; n < c->counts[k]; n++) {
            const uint32_t *v = c->simplices[k] + n * (k + 1);
            uint32_t least = v[0];
            for (size_t i = 1; i <= k; i++) {
                wrong += v[i - 1] >= v[i];
                if (before(a->positions + 3 * (size_t)v[i], a->positions + 3 * (size_t)least) < 0) least = v[i];
            }
            wrong += least >= brio_periodic_facts(s->t)->points;
        }
    EXPECT(wrong == 0, "%zu simplices", wrong);
}

/* Expects an order in which values and, among equals, dimensions grow, and a file with a line for each simplex. */
static void has_an_order(const brio_periodic_alpha *a) {
    static uint32_t order[1 << 16];
    static uint8_t seen[1 << 16];
    static const char path[] = "periodic-filtration.txt";
    const brio_alpha_complex *c = a->complex;
    size_t total = 0, before_k = 0, wrong = 0, last_k = 0, lines = 0;
    double last = -INFINITY;
    for (size_t k = 0; k < 4; k++) total += c->counts[k];
    EXPECT(total <= 1 << 16 && brio_alpha_order(ctx, c, order) == BRIO_OK, "%s", brio_message(ctx));
    memset(seen, 0, sizeof seen);
    for (size_t i = 0; i < total && order[i] < total; i++) {
        size_t k = 0;
        for (before_k = 0; order[i] - before_k >= c->counts[k]; k++) before_k += c->counts[k];
        double value = c->values[k][order[i] - before_k];
        wrong += seen[order[i]]++ || value < last || (value == last && k < last_k);
        last = value, last_k = k;
    }
    for (size_t i = 0; i < total; i++) wrong += seen[i] != 1;
    EXPECT(wrong == 0, "%zu of %zu", wrong, total);
    EXPECT(brio_write_filtration(ctx, path, c, order, BRIO_FILTRATION_GUDHI) == BRIO_OK, "%s", brio_message(ctx));
    FILE *f = fopen(path, "r");
    for (int ch; f && (ch = getc(f)) != EOF;) lines += ch == '\n';
    EXPECT(f && lines == total, "%zu lines of %zu simplices", lines, total);
    if (f) fclose(f);
    remove(path);
#ifdef F_GETFD
    int standard_input = fcntl(0, F_GETFD); /* which a refused order closed */
#endif
    order[0] = (uint32_t)total;
    EXPECT(brio_write_filtration(ctx, path, c, order, BRIO_FILTRATION_GUDHI) == BRIO_ERR_ARGUMENT);
#ifdef F_GETFD
    EXPECT(fcntl(0, F_GETFD) == standard_input);
#endif
}

static void compare_with_copies(uint64_t seed, sample s) {
    static double mine[1 << 16], theirs[1 << 16];
    brio_periodic_alpha *a = NULL;
    brio_triangulation *t = NULL;
    brio_alpha_complex c = {.size = sizeof c};
    size_t n = copy_all(&s);
    const double *weights = s.weighted ? copies_weights : NULL;
    EXPECT(brio_periodic_alpha_values(ctx, s.t, &a) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_delaunay(ctx, copies, weights, n, NULL, &t) == BRIO_OK);
    EXPECT(brio_alpha_values(ctx, t, copies, weights, n, &c) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t k = 0; a && k < 4; k++) {
        size_t found = 0;
        for (size_t i = 0; i < c.counts[k]; i++) {
            const uint32_t *v = c.simplices[k] + i * (k + 1);
            uint32_t least = v[0];
            for (size_t j = 1; j <= k; j++)
                if (before(copies + 3 * (size_t)v[j], copies + 3 * (size_t)least) < 0) least = v[j];
            if (in_the_middle[least] && found < 1 << 16) theirs[found++] = c.values[k][i];
        }
        memcpy(mine, a->complex->values[k], a->complex->counts[k] * sizeof *mine);
        same_values(mine, a->complex->counts[k], theirs, found, k, seed);
    }
    const size_t *counts = a->complex->counts;
    EXPECT(counts[0] + counts[2] == counts[1] + counts[3], "the Euler characteristic");
    EXPECT(counts[3] == brio_periodic_facts(s.t)->tetrahedra);
    grows(a);
    stand_for_their_classes(&s, a);
    has_an_order(a);
    brio_periodic_alpha_free(a);
    brio_alpha_complex_free(&c);
    brio_triangulation_free(t);
    brio_periodic_free(s.t);
}

static void alpha_is_that_of_many_copies(void) {
    compare_with_copies(1, make(1, CUBE, "xyz", 1 << 20, false));
    compare_with_copies(2, make(2, TILTED, "xyz", 1 << 20, true));
    compare_with_copies(3, make(3, CUBE, "xyz", 4, false));
    compare_with_copies(4, make(4, TILTED, "xy", 1 << 20, false));
    compare_with_copies(5, make(5, CUBE, "y", 8, true));
}

static void flat_points_have_no_alpha_complex(void) {
    brio_periodic_options o = {.size = sizeof o, .cell = CUBE, .open = {0, 0, 1}};
    const double point[3] = {0, 0, 0};
    brio_periodic *t = NULL;
    brio_periodic_alpha *a = NULL;
    EXPECT(brio_delaunay_periodic(ctx, point, NULL, 1, &o, &t) == BRIO_OK);
    EXPECT(brio_periodic_alpha_values(ctx, t, &a) == BRIO_ERR_NO_ANSWER && !a);
    brio_periodic_free(t);
}

/* --- shapes --- */

/* A directed edge of a surface that repeats: sheets, and the shift of the end relative to the beginning. */
typedef struct {
    uint32_t sheet[2];
    int32_t shift[3];
} surface_edge;

static int compare_edges(const void *a, const void *b) {
    return memcmp(a, b, sizeof(surface_edge));
}

/* Expects that each directed edge is there once, and once the other way: the surface is a closed oriented manifold. */
static void is_closed(const brio_mesh *m) {
    const uint32_t *sheet = brio_mesh_property(m, "sheet")->data;
    const int32_t *shift[3] = {brio_mesh_property(m, "shift_a")->data, brio_mesh_property(m, "shift_b")->data,
                               brio_mesh_property(m, "shift_c")->data};
    size_t count = 3 * m->num_faces, wrong = 0;
    surface_edge *edge[2];
    for (int way = 0; way < 2; way++) {
        edge[way] = calloc(count + 1, sizeof **edge);
        for (size_t c = 0; c < count; c++) {
            uint32_t v[2] = {m->face_vertices[c], m->face_vertices[c % 3 == 2 ? c - 2 : c + 1]};
            for (int k = 0; k < 2; k++) edge[way][c].sheet[k] = sheet[v[k ^ way]];
            for (int k = 0; k < 3; k++) edge[way][c].shift[k] = shift[k][v[1 ^ way]] - shift[k][v[way]];
        }
        qsort(edge[way], count, sizeof **edge, compare_edges);
    }
    for (size_t c = 1; c < count; c++) wrong += !compare_edges(&edge[0][c - 1], &edge[0][c]);
    EXPECT(wrong == 0, "%zu of %zu edges are there twice", wrong, count);
    EXPECT(!memcmp(edge[0], edge[1], count * sizeof **edge), "an edge has no other side");
    free(edge[0]), free(edge[1]);
}

/* Returns whether the tetrahedra of at most alpha are one set that has all vertices. */
static bool is_one_solid(const sample *s, const double *value, double alpha) {
    const brio_tetrahedron *tet = brio_periodic_tetrahedra(s->t);
    const brio_image *image = brio_periodic_images(s->t);
    size_t n = brio_periodic_facts(s->t)->tetrahedra, first = n, met = 0;
    bool seen[POINTS] = {false}, *in = calloc(n + 1, 1), all = true;
    for (size_t i = 0; i < n; i++)
        if (value[i] <= alpha) first = i;
    if (first < n) in[first] = true;
    for (bool grows = true; grows;) {
        grows = false;
        for (size_t i = 0; i < n; i++)
            for (int k = 0; k < 4 && !in[i] && value[i] <= alpha; k++)
                if ((tet[i].mate[k] >> 2) < n && in[tet[i].mate[k] >> 2]) in[i] = grows = true;
    }
    for (size_t i = 0; i < n; i++) {
        all &= in[i] || value[i] > alpha;
        for (int k = 0; k < 4 && in[i]; k++) seen[image[tet[i].vertex[k]].point] = true;
    }
    for (size_t p = 0; p < POINTS; p++) met += seen[p];
    free(in);
    return all && met == brio_periodic_facts(s->t)->vertices;
}

static void has_shapes(sample s) {
    brio_periodic_alpha *a = NULL;
    double least = 0;
    EXPECT(brio_periodic_alpha_values(ctx, s.t, &a) == BRIO_OK, "%s", brio_message(ctx));
    const double *value = a->complex->values[3];
    EXPECT(brio_periodic_alpha_auto(ctx, a, &least) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(is_one_solid(&s, value, least) && !is_one_solid(&s, value, nextafter(least, -INFINITY)), "auto: %g", least);
    for (size_t i = 0; i < a->complex->counts[3]; i += 3) {
        brio_mesh *m = NULL;
        brio_periodic_shape_stats f = {.size = sizeof f};
        EXPECT(brio_periodic_alpha_shape(ctx, a, value[i], &m, &f) == BRIO_OK, "%s", brio_message(ctx));
        if (!m) continue;
        is_closed(m);
        double volume = brio_periodic_facts(s.t)->cell_volume;
        bool full = f.tetrahedra == a->complex->counts[3] && !brio_periodic_facts(s.t)->hull_facets;
        EXPECT(full ? m->num_faces == 0 && fabs(f.volume / volume - 1) < 1e-12 : m->num_faces > 0, "%g", f.volume);
        EXPECT((f.components == 0) == (m->num_faces == 0) && f.euler <= 2 * (int64_t)f.components, "a surface");
        brio_mesh_free(m);
    }
    brio_periodic_alpha_free(a);
    brio_periodic_free(s.t);
}

static void surfaces_that_repeat_are_closed(void) {
    has_shapes(make(11, CUBE, "xyz", 1 << 20, false));
    has_shapes(make(12, TILTED, "xyz", 1 << 20, true));
    has_shapes(make(13, CUBE, "xyz", 4, false));
    has_shapes(make(14, TILTED, "xy", 1 << 20, false));
    has_shapes(make(15, CUBE, "y", 8, false));
}

/* In a cell so wide that nothing repeats, shapes are those of open space. */
static void shapes_in_a_wide_cell_are_the_usual_ones(void) {
    enum { N = 300 };
    static const double wide[9] = {64, 0, 0, 0, 64, 0, 0, 0, 64};
    double points[3 * N];
    brio_rng rng = brio_rng_new(19);
    for (size_t i = 0; i < 3 * N; i++) points[i] = brio_rng_below(&rng, 1 << 20) / (double)(1 << 20);
    brio_periodic_options o = {.size = sizeof o, .cell = wide};
    brio_periodic *p = NULL;
    brio_periodic_alpha *a = NULL;
    brio_triangulation *t = NULL;
    brio_alpha_complex c = {.size = sizeof c};
    EXPECT(brio_delaunay_periodic(ctx, points, NULL, N, &o, &p) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_periodic_alpha_values(ctx, p, &a) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_delaunay(ctx, points, NULL, N, NULL, &t) == BRIO_OK);
    EXPECT(brio_alpha_values(ctx, t, points, NULL, N, &c) == BRIO_OK);
    for (double alpha = 0.005; alpha < 0.05; alpha *= 1.2) {
        brio_mesh *m[2] = {NULL, NULL};
        brio_periodic_shape_stats ours = {.size = sizeof ours};
        brio_alpha_shape_stats usual = {.size = sizeof usual};
        EXPECT(brio_periodic_alpha_shape(ctx, a, alpha, &m[0], &ours) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_alpha_shape(ctx, points, &c, alpha, &m[1], &usual) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(m[0]->num_faces == m[1]->num_faces && m[0]->num_vertices == m[1]->num_vertices &&
                   ours.split == usual.split && ours.singular_edges == usual.singular_edges,
               "%g: %zu and %zu faces, %zu and %zu vertices", alpha, m[0]->num_faces, m[1]->num_faces,
               m[0]->num_vertices, m[1]->num_vertices);
        brio_mesh_free(m[0]), brio_mesh_free(m[1]);
    }
    EXPECT(brio_periodic_alpha_shape(ctx, a, NAN, &(brio_mesh *){NULL}, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_periodic_alpha_shape(ctx, a, 0, &(brio_mesh *){NULL}, NULL) == BRIO_ERR_NO_ANSWER);
    EXPECT(brio_alpha_auto(ctx, a->complex, &(double){0}) == BRIO_ERR_ARGUMENT, "the complex of a space that repeats");
    brio_alpha_complex_free(&c);
    brio_triangulation_free(t);
    brio_periodic_alpha_free(a);
    brio_periodic_free(p);
}

static void simplices_have_names_by_points_where_they_differ(void) {
    enum { N = 200 };
    double points[3 * N];
    brio_rng rng = brio_rng_new(23);
    for (size_t i = 0; i < 3 * N; i++) points[i] = brio_rng_double(&rng);
    for (size_t n = 5; n <= N; n += N - 5) {
        brio_periodic_options o = {.size = sizeof o, .cell = CUBE};
        brio_periodic *t = NULL;
        brio_periodic_alpha *a = NULL;
        brio_alpha_complex c = {.size = sizeof c};
        EXPECT(brio_delaunay_periodic(ctx, points, NULL, n, &o, &t) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_periodic_alpha_values(ctx, t, &a) == BRIO_OK, "%s", brio_message(ctx));
        brio_status status = brio_periodic_alpha_by_points(ctx, a, &c);
        EXPECT(status == (n < N ? BRIO_ERR_NO_ANSWER : BRIO_OK), "%s", brio_message(ctx));
        size_t wrong = 0;
        for (size_t k = 0; k < 4 && status == BRIO_OK; k++)
            for (size_t i = 0; i < c.counts[k]; i++)
                for (size_t j = 0; j <= k; j++) {
                    const uint32_t *v = c.simplices[k] + i * (k + 1), *w = a->complex->simplices[k] + i * (k + 1);
                    bool found = false;
                    for (size_t l = 0; l <= k; l++) found |= a->images[w[l]].point == v[j];
                    wrong += !found || (j > 0 && v[j - 1] >= v[j]) || c.values[k][i] != a->complex->values[k][i];
                }
        EXPECT(wrong == 0 && (status != BRIO_OK || c.counts[0] == n), "%zu corners", wrong);
        brio_alpha_complex_free(&c);
        brio_periodic_alpha_free(a);
        brio_periodic_free(t);
    }
}

static brio_status run_shapes(brio_context *own) {
    enum { N = 60 };
    static double points[3 * N];
    brio_rng rng = brio_rng_new(31);
    for (size_t i = 0; i < 3 * N; i++) points[i] = brio_rng_double(&rng);
    brio_periodic_options o = {.size = sizeof o, .cell = CUBE};
    brio_periodic *t = NULL;
    brio_periodic_alpha *a = NULL;
    brio_alpha_complex c = {.size = sizeof c};
    brio_mesh *m = NULL;
    double alpha = 0;
    uint64_t bytes;
    brio_status status = brio_estimate_periodic(own, points, NULL, N, &o, &bytes);
    if (status == BRIO_OK) status = brio_delaunay_periodic(own, points, NULL, N, &o, &t);
    if (status == BRIO_OK) status = brio_periodic_check(own, t);
    if (status == BRIO_OK) status = brio_periodic_alpha_values(own, t, &a);
    if (status == BRIO_OK) status = brio_periodic_alpha_auto(own, a, &alpha);
    if (status == BRIO_OK) status = brio_periodic_alpha_shape(own, a, alpha, &m, NULL);
    if (status == BRIO_OK) status = brio_periodic_alpha_by_points(own, a, &c);
    if (status == BRIO_ERR_NO_ANSWER) status = BRIO_OK; /* simplices that have the same points */
    brio_alpha_complex_free(&c);
    brio_mesh_free(m);
    brio_periodic_alpha_free(a);
    brio_periodic_free(t);
    return status;
}

static void memory_that_runs_out(void) {
    expect_clean_failures(run_shapes);
}

/* Cells from whole stars, and cells by a sweep, which leaves those on a grid to whole stars. */
static brio_status run_cells(brio_context *own) {
    enum { N = 60 };
    static double points[3 * N];
    brio_rng rng = brio_rng_new(32);
    for (size_t i = 0; i < 3 * N; i++) points[i] = brio_rng_double(&rng);
    for (size_t i = 0; i < N; i++) points[i] = floor(4 * points[i]) / 4;
    brio_periodic_options o = {.size = sizeof o, .cell = CUBE};
    brio_periodic *t = NULL;
    brio_status status = brio_delaunay_periodic(own, points, NULL, N, &o, &t);
    for (int whole = 0; whole < 2 && status == BRIO_OK; whole++) {
        brio_cells_options co = {
            .size = sizeof co, .vertices = whole, .no_face_sizes = !whole, .no_areas = !whole, .no_centroids = !whole};
        brio_cells *cells = NULL;
        status = brio_periodic_cells(own, t, &co, &cells);
        brio_cells_free(cells);
    }
    brio_periodic_free(t);
    return status;
}

/* Where memory ran out while tetrahedra were unfolded, those that were there were lost. */
static void memory_that_runs_out_in_cells(void) {
    expect_clean_failures(run_cells);
}

/* --- locations --- */

static double power(const sample *s, size_t p, const int32_t *shift, const double *q) {
    double x[3], sum = s->weighted ? -s->weights[p] : 0;
    place_of(s, p, shift, x);
    for (int k = 0; k < 3; k++) sum += (x[k] - q[k]) * (x[k] - q[k]);
    return sum;
}

static double volume(const double *a, const double *b, const double *c, const double *d) {
    double u[3], v[3], w[3];
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], v[k] = c[k] - a[k], w[k] = d[k] - a[k];
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) + u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/* Expects that the translate of a tetrahedron holds q. */
static void holds(const sample *s, const brio_image *at, const double *q) {
    double x[4][3];
    const brio_tetrahedron *tet = &brio_periodic_tetrahedra(s->t)[at->point];
    for (int i = 0; i < 4; i++)
        for (size_t k = 0; k < 3; k++) {
            x[i][k] = brio_periodic_positions(s->t)[3 * (size_t)tet->vertex[i] + k];
            for (size_t a = 0; a < 3; a++) x[i][k] += at->shift[a] * s->cell[3 * a + k];
        }
    EXPECT(volume(q, x[1], x[2], x[3]) >= -1e-12 && volume(x[0], q, x[2], x[3]) >= -1e-12 &&
           volume(x[0], x[1], q, x[3]) >= -1e-12 && volume(x[0], x[1], x[2], q) >= -1e-12);
}

static void nearest_is(const sample *s, const brio_image *found, const double *q) {
    double least = INFINITY;
    int32_t from[3], c[3];
    for (int k = 0; k < 3; k++) from[k] = s->open[k] ? 0 : found->shift[k];
    for (size_t p = 0; p < POINTS; p++)
        for (c[0] = from[0] - 2 * !s->open[0]; c[0] <= from[0] + 2 * !s->open[0]; c[0]++)
            for (c[1] = from[1] - 2 * !s->open[1]; c[1] <= from[1] + 2 * !s->open[1]; c[1]++)
                for (c[2] = from[2] - 2 * !s->open[2]; c[2] <= from[2] + 2 * !s->open[2]; c[2]++)
                    least = fmin(least, power(s, p, c, q));
    EXPECT(power(s, found->point, found->shift, q) <= least + 1e-12, "%g, not %g",
           power(s, found->point, found->shift, q), least);
}

/* Asks about places in many cells. Where all directions repeat, all are inside. */
static void locate_in(uint64_t seed, sample s, bool all_inside) {
    enum { QUERIES = 600 };
    static double q[3 * QUERIES];
    static brio_image tets[QUERIES], vertices[QUERIES];
    brio_periodic_locator *l = NULL;
    brio_rng rng = brio_rng_new(seed);
    size_t inside = 0;
    for (size_t i = 0; i < 3 * QUERIES; i++) q[i] = brio_rng_below(&rng, 1 << 20) * 0x1p-17 - 3;
    EXPECT(brio_periodic_locator_new(ctx, s.t, &l) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_periodic_locator_tetrahedra(ctx, l, q, QUERIES, tets) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_periodic_locator_least_power(ctx, l, q, QUERIES, vertices) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t i = 0; i < QUERIES; i++) {
        nearest_is(&s, &vertices[i], q + 3 * i);
        inside += tets[i].point != BRIO_INFINITE;
        if (tets[i].point != BRIO_INFINITE) holds(&s, &tets[i], q + 3 * i);
    }
    EXPECT(all_inside ? inside == QUERIES : inside > 0 && inside < QUERIES, "%zu of %d inside", inside, (int)QUERIES);
    q[4] = NAN;
    EXPECT(brio_periodic_locator_tetrahedra(ctx, l, q, QUERIES, tets) == BRIO_ERR_NOT_FINITE);
    q[4] = 1e300;
    EXPECT(all_inside ? brio_periodic_locator_tetrahedra(ctx, l, q, QUERIES, tets) == BRIO_ERR_ARGUMENT : true);
    brio_periodic_locator_free(l);
    brio_periodic_free(s.t);
}

static void places_are_in_their_tetrahedra(void) {
    locate_in(1, make(11, CUBE, "xyz", 1 << 20, false), true);
    locate_in(2, make(12, TILTED, "xyz", 1 << 20, true), true);
    locate_in(3, make(13, CUBE, "xyz", 4, false), true);
    locate_in(4, make(14, TILTED, "xy", 1 << 20, false), false);
    locate_in(5, make(15, CUBE, "z", 16, true), false);
}

/* --- contexts --- */

static int count_call(const char *stage, double done, void *user) {
    (void)stage, (void)done;
    ++*(int *)user;
    return 0;
}

/* The context that made a triangulation may work for another thread while somebody asks about the triangulation. */
static void queries_leave_the_context_of_the_triangulation_alone(void) {
    static const double q[3] = {0.25, 0.5, 0.75};
    sample s = make(16, TILTED, "xyz", 1 << 20, true);
    brio_context *own = NULL;
    brio_periodic_locator *l = NULL;
    brio_periodic_alpha *a = NULL;
    brio_cells *cells = NULL;
    brio_image found;
    uint64_t sum;
    int calls = 0;
    size_t before = brio_context_memory(ctx);
    EXPECT(brio_context_new(NULL, &own) == BRIO_OK);
    brio_context_set_progress(ctx, count_call, &calls);
    EXPECT(brio_periodic_locator_new(own, s.t, &l) == BRIO_OK, "%s", brio_message(own));
    EXPECT(brio_context_memory(ctx) == before, "the locator");
    EXPECT(brio_periodic_locator_tetrahedra(own, l, q, 1, &found) == BRIO_OK, "%s", brio_message(own));
    EXPECT(brio_periodic_locator_least_power(own, l, q, 1, &found) == BRIO_OK, "%s", brio_message(own));
    EXPECT(brio_periodic_alpha_values(own, s.t, &a) == BRIO_OK, "%s", brio_message(own));
    EXPECT(brio_periodic_cells(own, s.t, NULL, &cells) == BRIO_OK, "%s", brio_message(own));
    EXPECT(brio_periodic_check(own, s.t) == BRIO_OK, "%s", brio_message(own));
    EXPECT(brio_periodic_checksum(own, s.t, &sum) == BRIO_OK, "%s", brio_message(own));
    EXPECT(brio_context_memory(ctx) == before && calls == 0, "%zu bytes more, %d calls",
           brio_context_memory(ctx) - before, calls);
    brio_context_set_progress(ctx, NULL, NULL);
    brio_cells_free(cells);
    brio_periodic_alpha_free(a);
    brio_periodic_locator_free(l);
    brio_context_free(own);
    brio_periodic_free(s.t);
}

SUITE(test_periodic_queries) {
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return 1;
    RUN(alpha_is_that_of_many_copies);
    RUN(flat_points_have_no_alpha_complex);
    RUN(surfaces_that_repeat_are_closed);
    RUN(shapes_in_a_wide_cell_are_the_usual_ones);
    RUN(simplices_have_names_by_points_where_they_differ);
    RUN(memory_that_runs_out);
    RUN(memory_that_runs_out_in_cells);
    RUN(places_are_in_their_tetrahedra);
    RUN(queries_leave_the_context_of_the_triangulation_alone);
    brio_context_free(ctx);
    return harness_end();
}
