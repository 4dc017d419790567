/* Spanning subgraphs: every vertex reached, components connected, degrees bounded, work linear; spanning trees. */
#include "laboratory/subgraph/spanning_subgraph.h"
#include "failing_allocator.h"
#include "random_surfaces.h"
#include <string.h>

static brio_context *ctx;

/* --- what a subgraph is held against --- */

static uint32_t root_of(uint32_t *parent, uint32_t v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
}

/* Number of components among `n` vertices. */
static size_t components(const uint32_t *ends, size_t count, size_t n) {
    uint32_t *parent = malloc((n + 1) * sizeof *parent);
    size_t left = n;
    for (size_t v = 0; v < n; v++) parent[v] = (uint32_t)v;
    for (size_t i = 0; i < count; i++) {
        uint32_t a = root_of(parent, ends[2 * i]), b = root_of(parent, ends[2 * i + 1]);
        if (a == b) continue;
        parent[a] = b;
        left--;
    }
    free(parent);
    return left;
}

static int compare_keys(const void *a, const void *b) {
    uint64_t x, y;
    memcpy(&x, a, sizeof x);
    memcpy(&y, b, sizeof y);
    return x < y ? -1 : x > y;
}

static uint64_t *sorted_keys(const brio_edges *edges) {
    uint64_t *keys = malloc((edges->count + 1) * sizeof *keys);
    for (size_t i = 0; i < edges->count; i++) {
        uint64_t a = edges->ends[2 * i], b = edges->ends[2 * i + 1];
        keys[i] = a < b ? a << 32 | b : b << 32 | a;
    }
    qsort(keys, edges->count, sizeof *keys, compare_keys);
    return keys;
}

/* Every edge of `part` is one of `all`, and none is there twice. */
static bool is_subset(const brio_edges *part, const brio_edges *all) {
    uint64_t *p = sorted_keys(part), *a = sorted_keys(all);
    bool fine = true;
    for (size_t i = 0, j = 0; fine && i < part->count; i++) {
        while (j < all->count && a[j] < p[i]) j++;
        fine = j < all->count && a[j] == p[i] && (i == 0 || p[i - 1] != p[i]);
    }
    free(p);
    free(a);
    return fine;
}

static uint32_t max_degree(const brio_edges *edges, size_t n) {
    uint32_t *degree = calloc(n + 1, sizeof *degree), most = 0;
    for (size_t i = 0; i < 2 * edges->count; i++) {
        uint32_t d = ++degree[edges->ends[i]];
        if (d > most) most = d;
    }
    free(degree);
    return most;
}

/* The subgraph of a mesh is one of its edges, joins what the mesh joins, and has no degree above the bound. */
static brio_subgraph_stats expect_subgraph(const brio_mesh *mesh, uint32_t bound, const char *name) {
    brio_edges all, sub;
    brio_subgraph_stats stats = {0};
    EXPECT(brio_mesh_edges(ctx, mesh, &all) == BRIO_OK);
    EXPECT(brio_spanning_subgraph(ctx, mesh, &sub, &stats) == BRIO_OK, "%s: %s", name, brio_message(ctx));
    size_t n = mesh->num_vertices;
    EXPECT(is_subset(&sub, &all), "%s", name);
    EXPECT(components(sub.ends, sub.count, n) == components(all.ends, all.count, n), "%s", name);
    EXPECT(max_degree(&sub, n) == stats.max_degree, "%s", name);
    EXPECT(stats.max_degree <= bound, "%s: degree %u", name, stats.max_degree);
    brio_edges_free(&all);
    brio_edges_free(&sub);
    return stats;
}

static uint32_t bound_of(int64_t genus) {
    return genus == 0 ? 3 : 12 * (uint32_t)genus;
}

/* --- closed surfaces --- */

static void tetrahedron_and_double_triangle(void) {
    const uint32_t faces[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3}, twice[] = {0, 1, 2, 2, 1, 0};
    brio_mesh *mesh = triangle_mesh(ctx, NULL, 4, faces, 4);
    expect_subgraph(mesh, 3, "tetrahedron");
    brio_mesh_free(mesh);
    mesh = triangle_mesh(ctx, NULL, 3, twice, 2);
    brio_subgraph_stats stats = expect_subgraph(mesh, 2, "double triangle");
    EXPECT(stats.copies == 6 && stats.cut_edges == 3);
    brio_mesh_free(mesh);
}

/* A star of many triangles over another: the mesh has two vertices of any degree. */
static void vertex_of_large_degree(void) {
    enum { N = 1000 };
    static uint32_t faces[6 * N];
    for (uint32_t i = 0; i < N; i++) {
        const uint32_t j = (i + 1) % N, both[6] = {i, j, N, j, i, N + 1};
        memcpy(faces + 6 * i, both, sizeof both);
    }
    brio_mesh *mesh = triangle_mesh(ctx, NULL, N + 2, faces, 2 * N);
    expect_subgraph(mesh, 3, "double pyramid");
    brio_mesh_free(mesh);
}

static void random_surfaces_of_genus_0_to_6(void) {
    uint32_t most[MOST_GENUS + 1] = {0};
    for (uint64_t seed = 0; seed < RANDOM_SURFACES; seed++) {
        char name[32];
        int genus = genus_of_random_mesh(seed);
        brio_certificate c = {0};
        brio_mesh *mesh = random_mesh(ctx, seed);
        snprintf(name, sizeof name, "genus %d, seed %d", genus, (int)seed);
        EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
        EXPECT(c.closed && c.manifold && c.genus == genus && c.components == 1, "%s: %lld", name, (long long)c.genus);
        brio_certificate_free(&c);
        brio_subgraph_stats stats = expect_subgraph(mesh, bound_of(genus), name);
        EXPECT(stats.vertices == mesh->num_vertices, "%s", name);
        EXPECT(stats.steps < 60 * mesh->num_vertices, "%s: %llu steps", name, (unsigned long long)stats.steps);
        /* the cut is a graph of 2 g cycles; copies of vertices beyond one: its edges less its vertices, plus one */
        if (genus) EXPECT(stats.copies > mesh->num_vertices && stats.cut_edges > 4, "%s", name);
        if (stats.max_degree > most[genus]) most[genus] = stats.max_degree;
        brio_mesh_free(mesh);
    }
    for (int genus = 0; genus <= MOST_GENUS; genus++)
        fprintf(stderr, "       genus %d: degree %u, at most %u\n", genus, most[genus], bound_of(genus));
}

/* Reads a model that is kept beside the project; NULL when it is not there. */
static brio_mesh *read_model(const char *name) {
    const char *folders[] = {getenv("BRIO_SHARED"), "../shared", "../../shared", "../../../shared"};
    brio_mesh *mesh = NULL;
    for (size_t i = 0; !mesh && i < sizeof folders / sizeof *folders; i++) {
        char path[512];
        if (!folders[i]) continue;
        snprintf(path, sizeof path, "%s/data/model/%s.ply", folders[i], name);
        brio_read(ctx, path, NULL, &mesh);
    }
    return mesh;
}

static void models_when_present(void) {
    const char *names[] = {"bunny",   "rocker_arm", "knot2",   "mechpart", "cheese",
                           "fandisk", "armadillo",  "bracket", "club",     "anchor_truth"};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        brio_mesh *mesh = read_model(names[i]);
        brio_certificate c = {0};
        if (!mesh) continue;
        EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
        EXPECT(c.manifold && c.oriented, "%s", names[i]);
        int64_t most = 0;
        for (size_t k = 0; k < c.components; k++) most = c.genera[k] > most ? c.genera[k] : most;
        brio_subgraph_stats s = expect_subgraph(mesh, c.closed ? bound_of(most) : 12, names[i]);
        fprintf(stderr, "       %s: genus %d, %s, degree %u, %zu cut edges\n", names[i], (int)c.genus,
                c.closed ? "closed" : "open", s.max_degree, s.cut_edges);
        brio_certificate_free(&c);
        brio_mesh_free(mesh);
    }
}

/* --- boundaries, components, pinched vertices --- */

static int in_left_half(const brio_mesh *mesh, size_t f) {
    return mesh->vertices[3 * (size_t)mesh->face_vertices[3 * f]] < 0.1;
}
static int by_thirteens(const brio_mesh *mesh, size_t f) {
    (void)mesh;
    return f % 13 == 5;
}
static int all_but_one_in_fifty(const brio_mesh *mesh, size_t f) {
    (void)mesh;
    return f % 50 != 0;
}

static void surfaces_with_boundary(void) {
    for (int genus = 0; genus < 4; genus++) {
        brio_mesh *mesh = random_surface(ctx, genus, 0.25, (uint64_t)genus);
        brio_mesh *half = without_triangles(ctx, mesh, in_left_half);
        brio_mesh *sieve = without_triangles(ctx, mesh, by_thirteens);
        brio_mesh *crumbs = without_triangles(ctx, mesh, all_but_one_in_fifty);
        expect_subgraph(half, UINT32_MAX, "half");
        expect_subgraph(sieve, UINT32_MAX, "sieve");
        expect_subgraph(crumbs, UINT32_MAX, "crumbs");
        brio_mesh_free(half);
        brio_mesh_free(sieve);
        brio_mesh_free(crumbs);
        brio_mesh_free(mesh);
    }
}

static void disks_have_degree_three(void) {
    for (uint32_t n = 1; n < 12; n++) {
        brio_mesh *mesh = flat_grid(ctx, n, 13 - n);
        brio_subgraph_stats stats = expect_subgraph(mesh, 3, "grid");
        EXPECT(stats.copies == mesh->num_vertices && stats.cut_edges == 26, "%zu copies", stats.copies);
        brio_mesh_free(mesh);
    }
}

static void no_faces_and_lone_vertices(void) {
    brio_mesh *mesh = NULL;
    const uint32_t face[] = {4, 7, 2};
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    brio_subgraph_stats stats = expect_subgraph(mesh, 0, "empty");
    EXPECT(stats.vertices == 0);
    brio_mesh_free(mesh);
    mesh = triangle_mesh(ctx, NULL, 10, face, 1);
    stats = expect_subgraph(mesh, 2, "one triangle");
    EXPECT(stats.vertices == 3 && stats.copies == 3);
    brio_mesh_free(mesh);
}

/* Two tetrahedra that share a vertex, and two triangles that share one. */
static void pinched_vertices(void) {
    const uint32_t closed[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 3, 5, 4, 3, 4, 6, 4, 5, 6, 5, 3, 6};
    const uint32_t open[] = {0, 1, 2, 2, 3, 4};
    brio_mesh *mesh = triangle_mesh(ctx, NULL, 7, closed, 8);
    expect_subgraph(mesh, 6, "two tetrahedra");
    brio_mesh_free(mesh);
    mesh = triangle_mesh(ctx, NULL, 5, open, 2);
    expect_subgraph(mesh, 4, "bow tie");
    brio_mesh_free(mesh);
}

/* --- refusals --- */

static void expect_refusal(const uint32_t *faces, size_t count, const char *part) {
    brio_edges edges;
    brio_mesh *mesh = triangle_mesh(ctx, NULL, 5, faces, count);
    EXPECT(brio_spanning_subgraph(ctx, mesh, &edges, NULL) == BRIO_ERR_NO_ANSWER);
    EXPECT(strstr(brio_message(ctx), part), "%s", brio_message(ctx));
    EXPECT(edges.ends == NULL && edges.count == 0);
    brio_mesh_free(mesh);
}

static void meshes_that_are_no_surface(void) {
    const uint32_t three[] = {0, 1, 2, 1, 0, 3, 0, 1, 4}, flipped[] = {0, 1, 2, 0, 1, 3}, twice[] = {0, 1, 1};
    const uint32_t outside[] = {0, 1, 5}, square[] = {0, 1, 2, 3};
    const uint64_t offsets[] = {0, 4};
    expect_refusal(three, 3, "vertices 0 and 1 has more than two faces");
    expect_refusal(flipped, 2, "faces 0 and 1 disagree");
    expect_refusal(twice, 1, "face 0 has a vertex twice");
    brio_edges edges;
    brio_mesh *mesh = triangle_mesh(ctx, NULL, 5, outside, 1);
    EXPECT(brio_spanning_subgraph(ctx, mesh, &edges, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_mesh_edges(ctx, mesh, &edges) == BRIO_ERR_ARGUMENT);
    brio_mesh_free(mesh);
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, NULL, 5) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, square, 1) == BRIO_OK);
    EXPECT(brio_spanning_subgraph(ctx, mesh, &edges, NULL) == BRIO_ERR_NO_ANSWER);
    EXPECT(strstr(brio_message(ctx), "face 0 has 4 corners"), "%s", brio_message(ctx));
    EXPECT(brio_mesh_edges(ctx, mesh, &edges) == BRIO_OK && edges.count == 4);
    brio_edges_free(&edges);
    brio_mesh_free(mesh);
}

/* --- work --- */

static void steps_grow_linearly(void) {
    for (int genus = 0; genus <= 2; genus += 2) {
        double least = 1e9, most = 0;
        const double cells[] = {0.2, 0.1, 0.05, 0.025};
        for (int i = 0; i < 4; i++) {
            brio_mesh *mesh = random_surface(ctx, genus, cells[i], 11);
            brio_edges edges;
            brio_subgraph_stats stats;
            EXPECT(brio_spanning_subgraph(ctx, mesh, &edges, &stats) == BRIO_OK);
            double steps = (double)stats.steps / (double)mesh->num_vertices;
            fprintf(stderr, "       genus %d, %zu vertices: %.2f steps a vertex\n", genus, mesh->num_vertices, steps);
            least = fmin(least, steps);
            most = fmax(most, steps);
            brio_edges_free(&edges);
            brio_mesh_free(mesh);
        }
        EXPECT(most < 1.05 * least && most < 100, "%g to %g steps a vertex", least, most);
    }
}

/* A double pyramid of n sides: work for a vertex of degree n is to be paid once. */
static void steps_stay_linear_round_a_large_vertex(void) {
    for (uint32_t n = 1000; n <= 64000; n *= 4) {
        uint32_t *faces = malloc(6 * n * sizeof *faces);
        for (uint32_t i = 0; i < n; i++) {
            const uint32_t j = (i + 1) % n, both[6] = {i, j, n, j, i, n + 1};
            memcpy(faces + 6 * i, both, sizeof both);
        }
        brio_mesh *mesh = triangle_mesh(ctx, NULL, n + 2, faces, 2 * n);
        brio_subgraph_stats stats = expect_subgraph(mesh, 3, "double pyramid");
        EXPECT(stats.steps < 80 * (uint64_t)n, "%llu steps", (unsigned long long)stats.steps);
        brio_mesh_free(mesh);
        free(faces);
    }
}

/* --- trees --- */

static void breadth_first_tree_is_in_order(void) {
    brio_mesh *mesh = random_surface(ctx, 2, 0.2, 5);
    brio_edges all, tree, sub, subtree;
    size_t n = mesh->num_vertices;
    EXPECT(brio_mesh_edges(ctx, mesh, &all) == BRIO_OK && all.count == 3 * mesh->num_faces / 2);
    EXPECT(brio_breadth_first_tree(ctx, &all, n, &tree) == BRIO_OK);
    EXPECT(tree.count == n - 1 && is_subset(&tree, &all) && components(tree.ends, tree.count, n) == 1);
    uint8_t *seen = calloc(n, 1);
    seen[0] = 1;
    for (size_t i = 0; i < tree.count; i++) {
        EXPECT(seen[tree.ends[2 * i]] && !seen[tree.ends[2 * i + 1]], "edge %zu", i);
        seen[tree.ends[2 * i + 1]] = 1;
    }
    free(seen);
    EXPECT(brio_spanning_subgraph(ctx, mesh, &sub, NULL) == BRIO_OK);
    EXPECT(brio_breadth_first_tree(ctx, &sub, n, &subtree) == BRIO_OK && subtree.count == n - 1);
    EXPECT(is_subset(&subtree, &sub) && max_degree(&subtree, n) <= 24);
    brio_edges_free(&all);
    brio_edges_free(&tree);
    brio_edges_free(&sub);
    brio_edges_free(&subtree);
    brio_mesh_free(mesh);
}

static double length(const double *points, const uint32_t *ends) {
    const double *a = points + 3 * (size_t)ends[0], *b = points + 3 * (size_t)ends[1];
    return sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
}

static double total_length(const double *points, const brio_edges *edges) {
    double sum = 0;
    for (size_t i = 0; i < edges->count; i++) sum += length(points, edges->ends + 2 * i);
    return sum;
}

/* Prim's algorithm without any structure. */
static double prim(const double *points, const brio_edges *edges, size_t n) {
    uint8_t *in = calloc(n, 1);
    double sum = 0;
    in[0] = 1;
    for (size_t step = 1; step < n; step++) {
        double best = INFINITY;
        size_t at = 0;
        for (size_t i = 0; i < edges->count; i++) {
            const uint32_t *e = edges->ends + 2 * i;
            if (in[e[0]] == in[e[1]] || length(points, e) >= best) continue;
            best = length(points, e);
            at = i;
        }
        sum += best;
        in[edges->ends[2 * at]] = in[edges->ends[2 * at + 1]] = 1;
    }
    free(in);
    return sum;
}

static void minimum_spanning_tree_is_minimal(void) {
    for (int e = -200; e <= 200; e += 200) {
        brio_mesh *mesh = random_surface(ctx, 1, 0.25, 3);
        brio_edges all, tree;
        size_t n = mesh->num_vertices;
        for (size_t i = 0; i < 3 * n; i++) mesh->vertices[i] = ldexp(mesh->vertices[i], e);
        EXPECT(brio_mesh_edges(ctx, mesh, &all) == BRIO_OK);
        EXPECT(brio_minimum_spanning_tree(ctx, &all, mesh->vertices, n, &tree) == BRIO_OK);
        EXPECT(tree.count == n - 1 && is_subset(&tree, &all) && components(tree.ends, tree.count, n) == 1);
        double found = total_length(mesh->vertices, &tree), least = prim(mesh->vertices, &all, n);
        EXPECT(fabs(found - least) <= 1e-12 * least, "%g, not %g", found, least);
        EXPECT(max_degree(&tree, n) <= 12);
        brio_edges_free(&all);
        brio_edges_free(&tree);
        brio_mesh_free(mesh);
    }
}

/* Lengths whose squares overflow, and lengths whose squares vanish. */
static void minimum_spanning_tree_of_any_scale(void) {
    const double unit[] = {0, 0, 0, 1, 0, 0, 3, 0, 0, 7, 0, 0};
    uint32_t ends[] = {0, 3, 1, 3, 0, 1, 1, 2, 0, 2};
    const brio_edges graph = {.count = 5, .ends = ends};
    for (int e = -1060; e <= 1020; e += 260) {
        double points[12];
        brio_edges tree;
        for (int i = 0; i < 12; i++) points[i] = ldexp(unit[i], e);
        EXPECT(brio_minimum_spanning_tree(ctx, &graph, points, 4, &tree) == BRIO_OK && tree.count == 3);
        const uint32_t expected[] = {0, 1, 1, 2, 1, 3};
        EXPECT(!memcmp(tree.ends, expected, sizeof expected), "2^%d", e);
        brio_edges_free(&tree);
    }
}

static void trees_refuse_vertices_that_are_not_there(void) {
    uint32_t ends[] = {0, 4};
    const double points[12] = {0};
    const brio_edges graph = {.count = 1, .ends = ends};
    brio_edges tree;
    EXPECT(brio_breadth_first_tree(ctx, &graph, 4, &tree) == BRIO_ERR_ARGUMENT && !tree.ends);
    EXPECT(brio_minimum_spanning_tree(ctx, &graph, points, 4, &tree) == BRIO_ERR_ARGUMENT && !tree.ends);
    EXPECT(strstr(brio_message(ctx), "edge 0: vertex 4 of 4"), "%s", brio_message(ctx));
}

/* --- memory --- */

static brio_status everything(brio_context *failing) {
    brio_status status = BRIO_OK;
    brio_mesh *mesh = NULL;
    brio_edges all = {0}, sub = {0}, tree = {0}, shortest = {0};
    brio_subgraph_stats stats;
    chain c = {.genus = 1, .radius = 0.4};
    brio_implicit_grid grid = {chain_value, &c, {-2.1, -2.1, -1}, 0.3, {14, 14, 8}};
    BRIO_TRY(brio_marched_surface(failing, &grid, &mesh));
    BRIO_TRY(brio_mesh_edges(failing, mesh, &all));
    BRIO_TRY(brio_spanning_subgraph(failing, mesh, &sub, &stats));
    BRIO_TRY(brio_breadth_first_tree(failing, &all, mesh->num_vertices, &tree));
    BRIO_TRY(brio_minimum_spanning_tree(failing, &all, mesh->vertices, mesh->num_vertices, &shortest));
done:
    brio_edges_free(&all);
    brio_edges_free(&sub);
    brio_edges_free(&tree);
    brio_edges_free(&shortest);
    brio_mesh_free(mesh);
    return status;
}

static void memory_fails_cleanly(void) {
    expect_clean_failures(everything);
}

SUITE(test_spanning_subgraph) {
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return HARNESS_SKIP;
    RUN(tetrahedron_and_double_triangle);
    RUN(vertex_of_large_degree);
    RUN(random_surfaces_of_genus_0_to_6);
    RUN(models_when_present);
    RUN(surfaces_with_boundary);
    RUN(disks_have_degree_three);
    RUN(no_faces_and_lone_vertices);
    RUN(pinched_vertices);
    RUN(meshes_that_are_no_surface);
    RUN(steps_grow_linearly);
    RUN(steps_stay_linear_round_a_large_vertex);
    RUN(breadth_first_tree_is_in_order);
    RUN(minimum_spanning_tree_is_minimal);
    RUN(minimum_spanning_tree_of_any_scale);
    RUN(trees_refuse_vertices_that_are_not_there);
    RUN(memory_fails_cleanly);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
