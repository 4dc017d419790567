/* The triangulation of a known surface: going along its edges changes nothing but the work. */
#include "failing_allocator.h"
#include "random_surfaces.h"
#include "trial.h"

static brio_context *ctx;

static const brio_location ALONG[] = {BRIO_LOCATION_TRACE, BRIO_LOCATION_NEIGHBOUR};

static uint64_t checksum(const brio_mesh *mesh, const trial_options *options, brio_delaunay_stats *stats,
                         brio_laboratory_stats *counted) {
    brio_triangulation *t = NULL;
    uint64_t sum = 0;
    brio_laboratory *lab;
    EXPECT(trial_delaunay(ctx, mesh->vertices, NULL, mesh->num_vertices, options, &t, &lab) == BRIO_OK, "%s",
           brio_message(ctx));
    if (!t) return 0;
    if (stats) *stats = *brio_triangulation_stats(t);
    if (counted) *counted = *brio_laboratory_results(lab);
    brio_laboratory_free(lab);
    EXPECT(brio_triangulation_checksum(ctx, t, mesh->vertices, &sum) == BRIO_OK);
    brio_triangulation_free(t);
    return sum;
}

static uint64_t checksum_along(const brio_mesh *mesh, brio_location location, int order, brio_subgraph kind,
                               brio_delaunay_stats *stats, brio_laboratory_stats *counted) {
    trial_options o = {0};
    brio_edges edges;
    EXPECT(brio_mesh_subgraph(ctx, mesh, kind, &edges) == BRIO_OK, "%s", brio_message(ctx));
    o.locate = location;
    o.order = order;
    o.edges = edges.ends;
    o.num_edges = edges.count;
    uint64_t sum = checksum(mesh, &o, stats, counted);
    brio_edges_free(&edges);
    return sum;
}

/* A trace in the order of its analysis, a neighbour in the order of its practice. */
static void expect_same_triangulation(const brio_mesh *mesh, brio_subgraph kind, const char *name) {
    uint64_t plain = checksum(mesh, NULL, NULL, NULL);
    EXPECT(checksum_along(mesh, BRIO_LOCATION_TRACE, BRIO_ORDER_RANDOM, kind, NULL, NULL) == plain, "%s, trace", name);
    EXPECT(checksum_along(mesh, BRIO_LOCATION_NEIGHBOUR, BRIO_ORDER_BRIO, kind, NULL, NULL) == plain, "%s, neighbour",
           name);
}

static void expect_same_in_every_order(const brio_mesh *mesh, const char *name) {
    uint64_t plain = checksum(mesh, NULL, NULL, NULL);
    for (int kind = 0; kind < BRIO_SUBGRAPH_END; kind++)
        for (int order = 0; order < TRIAL_ORDERS; order++)
            for (int i = 0; i < 2; i++)
                EXPECT(checksum_along(mesh, ALONG[i], order, (brio_subgraph)kind, NULL, NULL) == plain,
                       "%s, location %d, order %d, subgraph %d", name, (int)ALONG[i], order, kind);
}

static void random_surfaces_of_genus_0_to_6(void) {
    for (uint64_t seed = 0; seed < RANDOM_SURFACES; seed++) {
        char name[16];
        brio_mesh *mesh = random_mesh(ctx, seed);
        snprintf(name, sizeof name, "surface %d", (int)seed);
        expect_same_triangulation(mesh, (brio_subgraph)(seed % BRIO_SUBGRAPH_END), name);
        brio_mesh_free(mesh);
    }
}

/* --- meshes that are not what the analysis supposes --- */

static int in_left_half(const brio_mesh *mesh, size_t f) {
    return mesh->vertices[3 * (size_t)mesh->face_vertices[3 * f]] < 0.1;
}
static int all_but_one_in_fifty(const brio_mesh *mesh, size_t f) {
    (void)mesh;
    return f % 50 != 0;
}

/* Open pieces, and vertices without faces. */
static void open_surfaces_and_lone_vertices(void) {
    brio_mesh *mesh = random_surface(ctx, 2, 0.25, 9);
    brio_mesh *half = without_triangles(ctx, mesh, in_left_half);
    brio_mesh *crumbs = without_triangles(ctx, mesh, all_but_one_in_fifty);
    expect_same_in_every_order(half, "half");
    expect_same_in_every_order(crumbs, "crumbs");
    brio_mesh_free(half);
    brio_mesh_free(crumbs);
    brio_mesh_free(mesh);
}

/* Every triangle with vertices of its own: all positions several times, and no two triangles joined. */
static void triangle_soup(void) {
    brio_mesh *mesh = random_surface(ctx, 1, 0.25, 4);
    size_t corners = 3 * mesh->num_faces;
    double *points = malloc(3 * corners * sizeof *points);
    uint32_t *triangles = malloc(corners * sizeof *triangles);
    for (size_t h = 0; h < corners; h++) {
        triangles[h] = (uint32_t)h;
        memcpy(points + 3 * h, mesh->vertices + 3 * (size_t)mesh->face_vertices[h], 3 * sizeof *points);
    }
    brio_mesh *soup = triangle_mesh(ctx, points, corners, triangles, mesh->num_faces);
    expect_same_triangulation(soup, BRIO_SUBGRAPH_BOUNDED, "soup");
    free(points);
    free(triangles);
    brio_mesh_free(soup);
    brio_mesh_free(mesh);
}

/* Three sheets at an edge: no subgraph of bounded degree, but a tree. */
static void non_manifold_mesh(void) {
    enum { N = 40 };
    double points[3 * 4 * N];
    uint32_t triangles[3 * 2 * 3 * (N - 1)], *t = triangles;
    brio_edges edges;
    for (uint32_t i = 0; i < N; i++)
        for (uint32_t k = 0; k < 4; k++) {
            double *p = points + 3 * (4 * i + k), a = 2.1 * k;
            p[0] = i, p[1] = k ? cos(a) : 0, p[2] = k ? sin(a) : 0;
        }
    for (uint32_t i = 0; i + 1 < N; i++)
        for (uint32_t k = 1; k < 4; k++, t += 6) {
            uint32_t a = 4 * i, b = a + 4;
            const uint32_t both[6] = {a, b, b + k, a, b + k, a + k};
            memcpy(t, both, sizeof both);
        }
    brio_mesh *mesh = triangle_mesh(ctx, points, 4 * N, triangles, 6 * (N - 1));
    EXPECT(brio_mesh_subgraph(ctx, mesh, BRIO_SUBGRAPH_BOUNDED, &edges) == BRIO_ERR_NO_ANSWER && !edges.ends);
    for (int kind = BRIO_SUBGRAPH_MINIMUM; kind < BRIO_SUBGRAPH_END; kind++)
        expect_same_triangulation(mesh, (brio_subgraph)kind, "three sheets");
    brio_mesh_free(mesh);
}

/* Points in a plane have no tetrahedra, on a grid every sphere holds many on it. */
static void flat_mesh(void) {
    brio_mesh *mesh = flat_grid(ctx, 9, 12);
    expect_same_triangulation(mesh, BRIO_SUBGRAPH_BOUNDED, "flat");
    for (size_t v = 0; v < mesh->num_vertices; v++) mesh->vertices[3 * v + 2] = (double)(v % 4);
    expect_same_triangulation(mesh, BRIO_SUBGRAPH_BOUNDED, "grid");
    brio_mesh_free(mesh);
}

static void unknown_kind_of_subgraph(void) {
    brio_mesh *mesh = flat_grid(ctx, 2, 2);
    brio_edges edges;
    EXPECT(brio_mesh_subgraph(ctx, mesh, BRIO_SUBGRAPH_END, &edges) == BRIO_ERR_ARGUMENT && !edges.ends);
    brio_mesh_free(mesh);
}

/* --- work --- */

typedef struct {
    double size, traced, searched; /* of a point: tetrahedra, intersections, nodes of the history */
} work;

static work work_of(const brio_mesh *mesh, brio_location location) {
    brio_delaunay_stats s = {0};
    brio_laboratory_stats lab = {0};
    double n = (double)mesh->num_vertices;
    checksum_along(mesh, location, BRIO_ORDER_RANDOM, BRIO_SUBGRAPH_BOUNDED, &s, &lab);
    return (work){(double)s.tetrahedra / n, (double)lab.trace_intersections / n, (double)lab.history_tests / n};
}

/* The history alone grows with the logarithm of the number of points; traced, it does not. */
static void searches_stay_short_when_traced(void) {
    const double cells[] = {0.2, 0.1, 0.05};
    work traced[3], searched[3];
    for (int i = 0; i < 3; i++) {
        brio_mesh *mesh = random_surface(ctx, 1, cells[i], 11);
        traced[i] = work_of(mesh, BRIO_LOCATION_TRACE);
        searched[i] = work_of(mesh, BRIO_LOCATION_HISTORY);
        fprintf(stderr, "       %zu vertices: %.2f intersections and %.1f nodes a point, history alone %.1f nodes\n",
                mesh->num_vertices, traced[i].traced, traced[i].searched, searched[i].searched);
        brio_mesh_free(mesh);
    }
    double grown = searched[2].searched - searched[0].searched;
    EXPECT(grown > 10 && traced[2].searched - traced[0].searched < grown / 6);
    EXPECT(4 * traced[2].searched < searched[2].searched && traced[2].traced < 1.1 * traced[0].traced);
}

/* --- memory --- */

static brio_status everything(brio_context *failing) {
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL;
    brio_edges edges = {0};
    brio_triangulation *t = NULL;
    chain c = {.genus = 1, .radius = 0.4};
    brio_implicit_grid grid = {chain_value, &c, {-2.1, -2.1, -1}, 0.3, {14, 14, 8}};
    if (SHORT_TESTS) grid = (brio_implicit_grid){chain_value, &c, {-2, -2, -1}, 0.5, {8, 8, 4}};
    BRIO_TRY(brio_marched_surface(failing, &grid, &mesh));
    for (int kind = 0; kind < BRIO_SUBGRAPH_END; kind++) {
        trial_options o = {0};
        BRIO_TRY(brio_mesh_subgraph(failing, mesh, (brio_subgraph)kind, &edges));
        o.locate = ALONG[kind % 2];
        o.edges = edges.ends;
        o.num_edges = edges.count;
        BRIO_TRY(trial_delaunay(failing, mesh->vertices, NULL, mesh->num_vertices, &o, &t, NULL));
        brio_edges_free(&edges);
        brio_triangulation_free(t);
        t = NULL;
    }
done:
    brio_edges_free(&edges);
    brio_triangulation_free(t);
    brio_mesh_free(mesh);
    return status;
}

static void memory_fails_cleanly(void) {
    expect_clean_failures(everything);
}

SUITE(test_known_surface) {
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return HARNESS_SKIP;
    brio_context_set_threads(ctx, 1);
    RUN(random_surfaces_of_genus_0_to_6);
    RUN(open_surfaces_and_lone_vertices);
    RUN(triangle_soup);
    RUN(non_manifold_mesh);
    RUN(flat_mesh);
    RUN(unknown_kind_of_subgraph);
    RUN(searches_stay_short_when_traced);
    RUN(memory_fails_cleanly);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
