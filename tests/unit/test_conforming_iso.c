/* Iso-surfaces of Delaunay triangles: closed, manifold, and facets of the triangulation of their vertices, ties and
 * sheets that touch included. */
#include "failing_allocator.h"
#include "iso/iso_surface.h"
#include "surfaces.h"
#include <string.h>

static brio_context *ctx;

/* --- what a surface is held against --- */

typedef struct {
    uint32_t v[3];
} triangle;

static triangle sorted(uint32_t a, uint32_t b, uint32_t c) {
    uint32_t low = a < b ? a : b, high = a < b ? b : a;
    triangle t = {{low < c ? low : c, 0, high > c ? high : c}};
    t.v[1] = a ^ b ^ c ^ t.v[0] ^ t.v[2];
    return t;
}

static int compare_triangles(const void *a, const void *b) {
    const triangle *s = a, *t = b;
    for (int k = 0; k < 3; k++)
        if (s->v[k] != t->v[k]) return s->v[k] < t->v[k] ? -1 : 1;
    return 0;
}

/* How many faces are no facets of the Delaunay triangulation of the vertices; those at the same place are one. */
static size_t faces_not_delaunay(const brio_mesh *mesh) {
    brio_triangulation *t = NULL;
    EXPECT(brio_delaunay(ctx, mesh->vertices, NULL, mesh->num_vertices, NULL, &t) == BRIO_OK);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    const uint32_t *name = brio_triangulation_representatives(t);
    size_t n = brio_triangulation_stats(t)->tetrahedra, wrong = 0;
    triangle *facets = malloc((4 * n + 1) * sizeof *facets);
    for (size_t i = 0; i < 4 * n; i++) {
        const uint32_t *v = tet[i / 4].vertex;
        facets[i] = sorted(v[(i + 1) % 4], v[(i + 2) % 4], v[(i + 3) % 4]);
    }
    qsort(facets, 4 * n, sizeof *facets, compare_triangles);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        const uint32_t *v = mesh->face_vertices + 3 * f;
        triangle face = sorted(name[v[0]], name[v[1]], name[v[2]]);
        wrong += bsearch(&face, facets, 4 * n, sizeof *facets, compare_triangles) == NULL;
    }
    free(facets);
    brio_triangulation_free(t);
    return wrong;
}

static brio_mesh *expect_conforming(const brio_implicit_grid *grid, brio_certificate *out) {
    brio_mesh *mesh = NULL;
    int64_t crossings = -1;
    brio_certificate c = {0};
    brio_status status = brio_conforming_surface(ctx, grid, &mesh);
    EXPECT(status == BRIO_OK, "%s", brio_message(ctx));
    if (status != BRIO_OK) exit(harness_end());
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    EXPECT(c.closed && c.manifold && c.oriented && c.volume > 0);
    size_t wrong = faces_not_delaunay(mesh);
    EXPECT(wrong == 0, "%zu of %zu faces", wrong, mesh->num_faces);
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &crossings) == BRIO_OK);
    EXPECT(crossings == 0, "%lld crossings", (long long)crossings);
    if (out) *out = c;
    brio_certificate_free(&c);
    return mesh;
}

/* --- smooth surfaces --- */

static void chains_of_every_genus(void) {
    for (int genus = 0; genus < 5; genus++) {
        chain shape = {.genus = genus, .radius = 0.45, .bend = {0.1, 0.2, 0.05}, .phase = {1, 2, 3}};
        brio_implicit_grid grid = {.value = chain_value, .user = &shape, .low = {-2.01, -2.02, -2.03}, .cell = 0.17};
        brio_certificate c = {0};
        for (int k = 0; k < 3; k++) grid.cells[k] = (uint32_t)((4.1 + (k == 0 ? 2 * genus : 0)) / grid.cell);
        brio_mesh *mesh = expect_conforming(&grid, &c);
        EXPECT(c.genus == genus && c.components == 1, "genus %lld, not %d", (long long)c.genus, genus);
        brio_mesh_free(mesh);
    }
}

static double ball(const double *p, const void *user) {
    (void)user;
    return sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1;
}

/* Vertices are on the surface, and the volume closes in on that of the ball with the square of the cell. */
static void vertices_are_on_the_surface(void) {
    double last = 1;
    for (uint32_t n = 10; n <= 40; n *= 2) {
        brio_implicit_grid grid = {ball, NULL, {-1.21, -1.22, -1.23}, 2.5 / n, {n, n, n}};
        brio_certificate c = {0};
        brio_mesh *mesh = expect_conforming(&grid, &c);
        for (size_t v = 0; v < mesh->num_vertices; v++)
            EXPECT(fabs(ball(mesh->vertices + 3 * v, NULL)) < grid.cell / 1000, "vertex %zu", v);
        double off = fabs(c.volume / (4.0 / 3 * 3.14159265358979) - 1);
        EXPECT(off < last / 3, "%g after %g", off, last);
        last = off;
        brio_mesh_free(mesh);
    }
}

/* --- rough ones --- */

/* Random numbers at the nodes, linear between them; `step` is what they are rounded to. */
typedef struct {
    uint32_t size;
    double *node;
} noise;

static double noise_value(const double *p, const void *user) {
    const noise *n = user;
    uint32_t low[3];
    double t[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        low[k] = (uint32_t)fmin(fmax(floor(p[k]), 0), n->size - 2);
        t[k] = p[k] - low[k];
    }
    for (unsigned c = 0; c < 8; c++) {
        size_t at = 0;
        double weight = 1;
        for (int k = 2; k >= 0; k--) {
            unsigned bit = c >> k & 1;
            at = at * n->size + low[k] + bit;
            weight *= bit ? t[k] : 1 - t[k];
        }
        sum += weight * n->node[at];
    }
    return sum;
}

static noise noise_new(uint32_t size, double step, uint64_t seed) {
    noise n = {size, malloc((size_t)size * size * size * sizeof(double))};
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < (size_t)size * size * size; i++) {
        uint32_t at[3] = {(uint32_t)(i % size), (uint32_t)(i / size % size), (uint32_t)(i / size / size)};
        bool border = false;
        for (int k = 0; k < 3; k++) border |= at[k] == 0 || at[k] == size - 1;
        double value = 2 * brio_rng_double(&rng) - 1;
        if (step > 0) value = step * (floor(value / step) + 0.5);
        n.node[i] = border ? 1 : value;
    }
    return n;
}

/* No two nodes agree, and every way for sheets to touch occurs. */
static void noise_of_every_roughness(void) {
    const double steps[] = {0, 0.25, 1};
    for (uint64_t seed = 0; seed < 12; seed++) {
        noise n = noise_new(9, steps[seed % 3], seed);
        brio_implicit_grid grid = {noise_value, &n, {0, 0, 0}, 1, {8, 8, 8}};
        brio_mesh_free(expect_conforming(&grid, NULL));
        free(n.node);
    }
}

/* Nodes on the surface count as outside, and no vertex is at a node. */
static void nodes_on_the_surface(void) {
    noise n = noise_new(7, 0, 3);
    for (size_t i = 0; i < 343; i += 2)
        if (n.node[i] < 0.5) n.node[i] = 0;
    brio_implicit_grid grid = {noise_value, &n, {0, 0, 0}, 1, {6, 6, 6}};
    brio_mesh *mesh = expect_conforming(&grid, NULL);
    for (size_t v = 0; v < mesh->num_vertices; v++) {
        double off = 0;
        for (size_t k = 0; k < 3; k++)
            off = fmax(off, fabs(mesh->vertices[3 * v + k] - rint(mesh->vertices[3 * v + k])));
        EXPECT(off > 0.0009, "vertex %zu", v);
    }
    brio_mesh_free(mesh);
    free(n.node);
}

/* --- far from zero --- */

typedef struct {
    noise n;
    double low[3], cell;
} placed_noise;

static double placed_value(const double *p, const void *user) {
    const placed_noise *n = user;
    double q[3];
    for (int k = 0; k < 3; k++) q[k] = (p[k] - n->low[k]) / n->cell;
    return noise_value(q, &n->n);
}

/* Rounded, vertices met the corners at the ends of their edges, and the surface had a boundary. The last cells are four
 * doubles wide. */
static void grids_far_from_zero_close(void) {
    const double far[] = {0.1, 1e3, 1e9, 8933530927104.0, 0x1.8p52};
    for (size_t i = 0; i < sizeof far / sizeof *far; i++)
        for (uint64_t seed = 0; seed < 6; seed++) {
            double cell = i == 4 ? 4 : 5.0 / 7;
            placed_noise place = {noise_new(7, 0, seed), {0, far[i], -far[i]}, cell};
            brio_implicit_grid grid = {placed_value, &place, {0, far[i], -far[i]}, cell, {6, 6, 6}};
            brio_mesh_free(expect_conforming(&grid, NULL));
            free(place.n.node);
        }
}

static void cells_too_small_for_doubles_are_refused(void) {
    placed_noise place = {noise_new(7, 0, 1), {0, 0x1p53, 0}, 1};
    brio_implicit_grid grid = {placed_value, &place, {0, 0x1p53, 0}, 1, {6, 6, 6}};
    brio_mesh *mesh = NULL;
    EXPECT(brio_conforming_surface(ctx, &grid, &mesh) == BRIO_ERR_NO_ANSWER && !mesh, "%s", brio_message(ctx));
    free(place.n.node);
}

/* --- refusals, and memory --- */

static void grids_too_large_and_no_grids_are_refused(void) {
    const struct {
        uint32_t cells[3];
        double cell;
        brio_status status;
    } cases[] = {{{UINT32_MAX, 4, 4}, 0.1, BRIO_ERR_TOO_LARGE}, {{1 << 20, 1 << 20, 4}, 0.1, BRIO_ERR_TOO_LARGE},
                 {{4, 4, UINT32_MAX}, 0.1, BRIO_ERR_TOO_LARGE}, {{4, 0, 4}, 0.1, BRIO_ERR_ARGUMENT},
                 {{4, 4, 4}, NAN, BRIO_ERR_ARGUMENT},           {{4, 4, 4}, 1e308, BRIO_ERR_ARGUMENT}};
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        brio_implicit_grid grid = {.value = ball, .cell = cases[i].cell};
        brio_mesh *mesh = NULL;
        memcpy(grid.cells, cases[i].cells, sizeof grid.cells);
        EXPECT(brio_conforming_surface(ctx, &grid, &mesh) == cases[i].status && !mesh, "%zu", i);
        EXPECT(brio_marched_surface(ctx, &grid, &mesh) == cases[i].status && !mesh, "%zu", i);
    }
}

/* --- progress --- */

/* What happens between two reports: evaluations of the function; how many reports there may be. */
typedef struct {
    size_t evaluations, most, reports, allowed;
    double fraction;
} watch;

static double watched_ball(const double *p, const void *user) {
    watch *w;
    memcpy(&w, user, sizeof(watch *));
    w->evaluations++;
    return ball((const double[3]){p[0], p[1], 100 * p[2]}, NULL);
}

static int look(const char *stage, double fraction, void *user) {
    watch *w = user;
    EXPECT(!strcmp(stage, "surface") && fraction >= 0 && fraction <= 1, "%s %g", stage, fraction);
    EXPECT(fraction >= w->fraction - 1e-9, "%g after %g", fraction, w->fraction);
    w->fraction = fraction;
    if (w->evaluations > w->most) w->most = w->evaluations;
    w->evaluations = 0;
    return w->reports++ >= w->allowed;
}

/* A flat ellipsoid, in layers of n by n cells. */
static brio_status make_watched(watch *w, uint32_t n, bool conforming) {
    brio_mesh *mesh = NULL;
    uint32_t layers = (uint32_t)(0.03 * n / 2.5) + 1;
    brio_implicit_grid grid = {watched_ball, &w, {-1.21, -1.22, -0.0123}, 2.5 / n, {n, n, layers}};
    brio_context_set_progress(ctx, look, w);
    brio_status status =
        conforming ? brio_conforming_surface(ctx, &grid, &mesh) : brio_marched_surface(ctx, &grid, &mesh);
    brio_context_set_progress(ctx, NULL, NULL);
    EXPECT((status == BRIO_OK) == (mesh != NULL));
    brio_mesh_free(mesh);
    return status;
}

/* A layer of a grid is not bounded, so that a report for each layer could not be waited for. */
static void work_between_reports_is_bounded(void) {
    for (int conforming = 0; conforming < 2; conforming++) {
        watch w = {.allowed = SIZE_MAX};
        EXPECT(make_watched(&w, SHORT_TESTS ? 200 : 400, conforming) == BRIO_OK);
        EXPECT(w.most <= 2 * BRIO_IMPLICIT_WORK && w.reports > 50, "%zu evaluations, %zu reports", w.most, w.reports);
    }
}

static void cancelled_at_each_report(void) {
    for (int conforming = 0; conforming < 2; conforming++) {
        brio_status status = BRIO_ERR_CANCELLED;
        for (size_t allowed = 0; status != BRIO_OK; allowed++) {
            watch w = {.allowed = allowed};
            status = make_watched(&w, 40, conforming);
            EXPECT(status == BRIO_OK || (status == BRIO_ERR_CANCELLED && w.reports == allowed + 1));
            EXPECT(brio_context_memory(ctx) == 0, "%zu reports", allowed);
        }
    }
}

static void nothing_inside_and_inside_on_the_border(void) {
    brio_implicit_grid empty = {ball, NULL, {2, 2, 2}, 0.1, {4, 4, 4}}, open = {ball, NULL, {0, 0, 0}, 0.1, {4, 4, 4}};
    brio_mesh *mesh = NULL;
    EXPECT(brio_conforming_surface(ctx, &empty, &mesh) == BRIO_OK && mesh->num_faces == 0);
    brio_mesh_free(mesh);
    EXPECT(brio_conforming_surface(ctx, &open, &mesh) == BRIO_ERR_ARGUMENT && !mesh);
}

static brio_status work(brio_context *failing) {
    brio_mesh *mesh = NULL;
    brio_implicit_grid grid = {ball, NULL, {-1.21, -1.22, -1.23}, 0.5, {5, 5, 5}};
    brio_status status = brio_conforming_surface(failing, &grid, &mesh);
    brio_mesh_free(mesh);
    return status;
}

static void memory_fails_cleanly(void) {
    expect_clean_failures(work);
}

SUITE(test_conforming_iso) {
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return HARNESS_SKIP;
    brio_context_set_threads(ctx, 1);
    RUN(chains_of_every_genus);
    RUN(vertices_are_on_the_surface);
    RUN(noise_of_every_roughness);
    RUN(nodes_on_the_surface);
    RUN(grids_far_from_zero_close);
    RUN(cells_too_small_for_doubles_are_refused);
    RUN(grids_too_large_and_no_grids_are_refused);
    RUN(work_between_reports_is_bounded);
    RUN(cancelled_at_each_report);
    RUN(nothing_inside_and_inside_on_the_border);
    RUN(memory_fails_cleanly);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
