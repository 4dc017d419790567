/* Simplification: what the surface is stays what it is, no collapse goes farther than allowed, the number of faces is
 * reached or refused, boundaries stay, and what is no manifold is refused. */
#include "mesh/simplify.h"
#include "failing_allocator.h"
#include "points.h"
#include "random_surfaces.h"
#include "mesh/back_off.h"
#include "mesh/split_vertices.h"

static brio_context *ctx;

/* --- calls --- */

/* Simplifies with the same spacing everywhere; edges up to `longest` may collapse, as far as `tolerance`. */
static brio_status simplify_within(brio_context *c, brio_mesh *mesh, size_t target, double longest, double tolerance) {
    double *spacing = malloc((mesh->num_vertices + 1) * sizeof *spacing);
    for (size_t v = 0; v < mesh->num_vertices; v++) spacing[v] = 1;
    brio_collapse_options o = {.target_faces = target, .spacing = spacing, .longest = longest, .tolerance = tolerance};
    brio_status status = brio_collapse_edges(c, mesh, &o);
    free(spacing);
    return status;
}

static brio_certificate certify(const brio_mesh *mesh) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK, "%s", brio_message(ctx));
    return c;
}

static brio_mesh *copy_of(const brio_mesh *mesh) {
    return triangle_mesh(ctx, mesh->vertices, mesh->num_vertices, mesh->face_vertices, mesh->num_faces);
}

static bool same_mesh(const brio_mesh *a, const brio_mesh *b) {
    return a->num_vertices == b->num_vertices && a->num_faces == b->num_faces &&
           !memcmp(a->vertices, b->vertices, 3 * a->num_vertices * sizeof *a->vertices) &&
           !memcmp(a->face_vertices, b->face_vertices, 3 * a->num_faces * sizeof *a->face_vertices);
}

/* Whether the mesh is sound: offsets of triangles, and each vertex is used. */
static bool is_sound(const brio_mesh *mesh) {
    uint8_t *used = calloc(mesh->num_vertices + 1, 1);
    bool sound = true;
    size_t count = 0;
    for (size_t f = 0; f <= mesh->num_faces && sound; f++)
        sound = !mesh->face_offsets || mesh->face_offsets[f] == 3 * f;
    for (size_t h = 0; h < 3 * mesh->num_faces && sound; h++) {
        sound = mesh->face_vertices[h] < mesh->num_vertices;
        if (sound) used[mesh->face_vertices[h]] = 1;
    }
    for (size_t v = 0; v < mesh->num_vertices; v++) count += used[v];
    free(used);
    return sound && count == mesh->num_vertices;
}

/* --- topology --- */

static brio_mesh *two_surfaces(uint64_t seed) {
    brio_mesh *a = random_mesh(ctx, seed), *b = random_mesh(ctx, seed + 1);
    size_t vertices = a->num_vertices + b->num_vertices, faces = a->num_faces + b->num_faces;
    double *points = malloc(3 * vertices * sizeof *points);
    uint32_t *corners = malloc(3 * faces * sizeof *corners);
    memcpy(points, a->vertices, 3 * a->num_vertices * sizeof *points);
    memcpy(points + 3 * a->num_vertices, b->vertices, 3 * b->num_vertices * sizeof *points);
    memcpy(corners, a->face_vertices, 3 * a->num_faces * sizeof *corners);
    for (size_t h = 0; h < 3 * b->num_faces; h++)
        corners[3 * a->num_faces + h] = b->face_vertices[h] + (uint32_t)a->num_vertices;
    brio_mesh *both = triangle_mesh(ctx, points, vertices, corners, faces);
    free(points);
    free(corners);
    brio_mesh_free(a);
    brio_mesh_free(b);
    return both;
}

/* Whether the components have the same genera, in some order. */
static bool same_genera(const brio_certificate *a, const brio_certificate *b) {
    int more[MOST_GENUS + 1] = {0};
    for (size_t i = 0; i < a->components; i++) more[a->genera[i]]++;
    for (size_t i = 0; i < b->components; i++) more[b->genera[i]]--;
    for (int genus = 0; genus <= MOST_GENUS; genus++)
        if (more[genus]) return false;
    return true;
}

/* Surfaces of every genus, pairs of them, folded and shaken ones, as far as they can be simplified or half the way. */
static void closed_surfaces_keep_components_and_genus(void) {
    size_t collapsed = 0, stopped = 0;
    for (uint64_t seed = 0; seed < 56; seed++) {
        brio_mesh *mesh = seed % 5 == 4 ? two_surfaces(seed) : random_mesh(ctx, seed);
        size_t faces = mesh->num_faces, target = seed % 3 == 2 ? faces / 2 : 0;
        brio_certificate before = certify(mesh);
        EXPECT(simplify_within(ctx, mesh, target, 100, seed % 3 ? 100 : 0.1) == BRIO_OK, "%s", brio_message(ctx));
        brio_certificate after = certify(mesh);
        EXPECT(after.closed && after.manifold && after.oriented, "surface %llu", (unsigned long long)seed);
        EXPECT(after.components == before.components && after.genus == before.genus, "surface %llu",
               (unsigned long long)seed);
        EXPECT(is_sound(mesh) && mesh->num_faces + 1 >= target, "surface %llu", (unsigned long long)seed);
        EXPECT(same_genera(&before, &after), "surface %llu", (unsigned long long)seed);
        collapsed += faces - mesh->num_faces;
        stopped += mesh->num_faces > target;
        brio_certificate_free(&before);
        brio_certificate_free(&after);
        brio_mesh_free(mesh);
    }
    EXPECT(collapsed > 10000 && stopped > 5, "%zu faces gone, %zu surfaces stopped", collapsed, stopped);
}

/* The least surface of its kind has no edge to collapse. */
static void tetrahedron_is_left_alone(void) {
    const double points[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    brio_mesh *mesh = triangle_mesh(ctx, points, 4, triangles, 4), *copy = copy_of(mesh);
    EXPECT(simplify_within(ctx, mesh, 0, 100, 100) == BRIO_OK);
    EXPECT(same_mesh(mesh, copy));
    brio_mesh_free(mesh);
    brio_mesh_free(copy);
}

/* --- the number of faces --- */

static void number_of_faces_is_reached(void) {
    brio_mesh *whole = random_surface(ctx, 0, 0.2, 1);
    size_t faces = whole->num_faces;
    for (size_t target = faces / 4; target <= faces + 2; target += faces / 8 + 1) {
        brio_mesh *mesh = copy_of(whole);
        EXPECT(simplify_within(ctx, mesh, target, 100, 100) == BRIO_OK);
        if (target >= faces)
            EXPECT(same_mesh(mesh, whole), "nothing to do");
        else
            EXPECT(mesh->num_faces == target - target % 2, "%zu faces, %zu wanted", mesh->num_faces, target);
        brio_mesh_free(mesh);
    }
    brio_mesh_free(whole);
}

static void long_edges_do_not_collapse(void) {
    brio_mesh *whole = random_surface(ctx, 1, 0.2, 2), *mesh = copy_of(whole);
    double least = INFINITY;
    for (uint32_t h = 0; h < 3 * whole->num_faces; h++) {
        const double *a = whole->vertices + 3 * (size_t)whole->face_vertices[h];
        const double *b = whole->vertices + 3 * (size_t)whole->face_vertices[brio_next_corner(h)];
        least = fmin(
            least, sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2])));
    }
    EXPECT(simplify_within(ctx, mesh, 0, 0.999 * least, 1e9) == BRIO_OK && same_mesh(mesh, whole));
    EXPECT(simplify_within(ctx, mesh, 0, 100, 1e9) == BRIO_OK && mesh->num_faces < whole->num_faces / 2);
    brio_mesh_free(mesh);
    brio_mesh_free(whole);
}

static void unused_vertices_are_dropped(void) {
    const double points[21] = {9, 9, 9, 0, 0, 0, 1, 0, 0, 8, 8, 8, 0, 1, 0, 0, 0, 1, 7, 7, 7};
    const uint32_t triangles[12] = {1, 4, 2, 1, 2, 5, 2, 4, 5, 4, 1, 5};
    brio_mesh *mesh = triangle_mesh(ctx, points, 7, triangles, 4);
    EXPECT(simplify_within(ctx, mesh, 0, 100, 100) == BRIO_OK && mesh->num_vertices == 4 && is_sound(mesh));
    EXPECT(mesh->vertices[0] == 0 && mesh->vertices[3] == 1 && mesh->vertices[7] == 1 && mesh->vertices[11] == 1);
    brio_mesh_free(mesh);
}

/* --- distance --- */

/* The plane of a triangle: its unit normal and the offset; returns its area. */
static double plane_of(const brio_mesh *mesh, size_t f, double plane[4]) {
    const double *p[3];
    double u[3], v[3], size = 0;
    for (size_t i = 0; i < 3; i++) p[i] = mesh->vertices + 3 * (size_t)mesh->face_vertices[3 * f + i];
    for (int k = 0; k < 3; k++) u[k] = p[1][k] - p[0][k], v[k] = p[2][k] - p[0][k];
    for (int k = 0; k < 3; k++) plane[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    for (int k = 0; k < 3; k++) size += plane[k] * plane[k];
    size = sqrt(size);
    for (int k = 0; k < 3; k++) plane[k] /= size;
    plane[3] = plane[0] * p[0][0] + plane[1] * p[0][1] + plane[2] * p[0][2];
    return size / 2;
}

/* Whether a position is a vertex of the mesh. */
static bool has_position(const brio_mesh *mesh, const double *p) {
    for (size_t v = 0; v < mesh->num_vertices; v++)
        if (mesh->vertices[3 * v] == p[0] && !memcmp(mesh->vertices + 3 * v, p, 3 * sizeof *p)) return true;
    return false;
}

/* The root-mean-square distance, weighted by area, of the point that two vertices of `whole` became in `mesh`, from the
 * planes of the triangles at each of the two; -1 when not just one collapse came between the two meshes. */
static double distance_of_one_collapse(const brio_mesh *whole, const brio_mesh *mesh) {
    const double *point = NULL;
    double sum = 0, area = 0, plane[4];
    size_t gone = 0;
    for (size_t v = 0; v < mesh->num_vertices; v++)
        if (!has_position(whole, mesh->vertices + 3 * v)) point = mesh->vertices + 3 * v;
    if (!point || whole->num_vertices != mesh->num_vertices + 1) return -1;
    for (uint32_t v = 0; v < whole->num_vertices; v++) {
        if (has_position(mesh, whole->vertices + 3 * (size_t)v)) continue;
        gone++;
        for (size_t h = 0; h < 3 * whole->num_faces; h++) {
            if (whole->face_vertices[h] != v) continue;
            double a = plane_of(whole, h / 3, plane), d = -plane[3];
            for (int k = 0; k < 3; k++) d += plane[k] * point[k];
            sum += a * d * d;
            area += a;
        }
    }
    return gone == 2 ? sqrt(sum / area) : -1;
}

/* One collapse after the other, each held against the planes of the mesh before it, until none is left: none goes
 * farther than the tolerance, and some go most of the way. */
static void no_collapse_is_farther_than_the_tolerance(void) {
    for (uint64_t seed = 0; seed < 6; seed += BRIEF_TESTS ? 5 : 1) {
        brio_mesh *mesh = random_surface(ctx, (int)(seed % 2), 0.25, seed);
        double tolerance = 0.05 * (double)(1 + seed / 2), farthest = 0;
        size_t collapses = 0;
        for (double d = 0; d >= 0; collapses++) {
            brio_mesh *before = copy_of(mesh);
            EXPECT(simplify_within(ctx, mesh, mesh->num_faces - 2, 100, tolerance) == BRIO_OK);
            d = distance_of_one_collapse(before, mesh);
            EXPECT(d <= tolerance * (1 + 1e-9), "surface %llu: %g, allowed %g", (unsigned long long)seed, d, tolerance);
            EXPECT(d >= 0 || same_mesh(mesh, before), "surface %llu", (unsigned long long)seed);
            farthest = fmax(farthest, d);
            brio_mesh_free(before);
        }
        EXPECT(collapses > 50 && farthest > 0.8 * tolerance, "surface %llu: %zu collapses, %g of %g",
               (unsigned long long)seed, collapses, farthest, tolerance);
        brio_mesh_free(mesh);
    }
}

/* Each vertex lies within the tolerance of some plane that it stands for, so that of a convex surface no vertex comes
 * inside its planes by more. The distance of the surfaces is at most 2.3 tolerances here; where a vertex forgets the
 * planes that it stands for, it is 5 and more. */
static void sphere_is_not_cut_deeper_than_the_tolerance(void) {
    brio_mesh *whole = random_surface(ctx, 0, 0.1, 3);
    size_t most = SIZE_MAX;
    for (size_t v = 0; v < whole->num_vertices; v++) { /* a sphere exactly */
        double *p = whole->vertices + 3 * v, r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        for (int k = 0; k < 3; k++) p[k] /= r;
    }
    for (double tolerance = 1e-4; tolerance < 0.1; tolerance *= 4) {
        brio_mesh *mesh = copy_of(whole);
        double nearest = INFINITY;
        for (size_t f = 0; f < whole->num_faces; f++) {
            double plane[4];
            plane_of(whole, f, plane);
            nearest = fmin(nearest, fabs(plane[3]));
        }
        EXPECT(simplify_within(ctx, mesh, 0, 100, tolerance) == BRIO_OK);
        for (size_t v = 0; v < mesh->num_vertices; v++) {
            const double *p = mesh->vertices + 3 * v;
            double r = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
            EXPECT(r >= nearest - tolerance - 1e-12, "%g of %g, tolerance %g", r, nearest, tolerance);
            EXPECT(r <= 1 + 4 * sqrt(tolerance), "%g, tolerance %g", r, tolerance);
        }
        EXPECT(mesh->num_faces < most && is_sound(mesh), "%zu faces, tolerance %g", mesh->num_faces, tolerance);
        brio_distance d = {0};
        EXPECT(brio_mesh_distance(ctx, mesh, whole, 20000, 1, &d) == BRIO_OK);
        EXPECT(d.hausdorff < 4 * tolerance, "%g, tolerance %g", d.hausdorff, tolerance);
        most = mesh->num_faces;
        brio_mesh_free(mesh);
    }
    brio_mesh_free(whole);
}

/* --- boundaries --- */

/* The boundary edges of a mesh as pairs of positions, sorted. */
typedef struct {
    double end[6];
} boundary_edge;

static int compare_edges(const void *a, const void *b) {
    return memcmp(a, b, sizeof(boundary_edge));
}

static size_t boundary_of(const brio_mesh *mesh, boundary_edge **out) {
    size_t count = 0, corners = 3 * mesh->num_faces;
    boundary_edge *list = malloc((corners + 1) * sizeof *list);
    const uint32_t *v = mesh->face_vertices;
    for (uint32_t h = 0; h < corners; h++) {
        bool inside = false;
        for (uint32_t g = 0; g < corners && !inside; g++)
            inside = v[g] == v[brio_next_corner(h)] && v[brio_next_corner(g)] == v[h];
        if (inside) continue;
        memcpy(list[count].end, mesh->vertices + 3 * (size_t)v[h], 3 * sizeof(double));
        memcpy(list[count++].end + 3, mesh->vertices + 3 * (size_t)v[brio_next_corner(h)], 3 * sizeof(double));
    }
    qsort(list, count, sizeof *list, compare_edges);
    *out = list;
    return count;
}

/* Whether a triangle has a corner below a plane. */
static int is_low(const brio_mesh *mesh, size_t f) {
    for (size_t i = 0; i < 3; i++) {
        const double *p = mesh->vertices + 3 * (size_t)mesh->face_vertices[3 * f + i];
        if (p[2] + 0.3 * p[0] < -0.1) return 1;
    }
    return 0;
}

/* The edges of the boundary are the same to the last bit, and so are its loops, the components and the genus. */
static void boundaries_stay(void) {
    for (uint64_t seed = 0; seed < 8; seed++) {
        brio_mesh *closed = random_surface(ctx, (int)(seed % 3), 0.25, seed);
        brio_mesh *mesh = without_triangles(ctx, closed, is_low);
        boundary_edge *before, *after;
        EXPECT(brio_mesh_split_vertices(ctx, mesh) == BRIO_OK); /* where the cut touches itself */
        size_t faces = mesh->num_faces, count = boundary_of(mesh, &before);
        brio_certificate a = certify(mesh);
        EXPECT(simplify_within(ctx, mesh, 0, 100, 100) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(count > 0 && mesh->num_faces < faces - faces / 4, "%zu of %zu faces", mesh->num_faces, faces);
        EXPECT(boundary_of(mesh, &after) == count && !memcmp(before, after, count * sizeof *after));
        brio_certificate b = certify(mesh);
        EXPECT(b.manifold && b.oriented && b.components == a.components && b.boundary_loops == a.boundary_loops);
        EXPECT(b.genus == a.genus && is_sound(mesh));
        free(before);
        free(after);
        brio_certificate_free(&a);
        brio_certificate_free(&b);
        brio_mesh_free(mesh);
        brio_mesh_free(closed);
    }
}

/* Whether a triangle is outside of a comb of three teeth. */
static int is_between_teeth(const brio_mesh *mesh, size_t f) {
    double x = 0, y = 0;
    for (size_t i = 0; i < 3; i++) {
        const double *p = mesh->vertices + 3 * (size_t)mesh->face_vertices[3 * f + i];
        x += p[0] / 3, y += p[1] / 3;
    }
    return y > 3 && (int)x / 4 % 2 == 1;
}

/* Inner vertices of a plane go; no triangle turns over, so that the areas still add up. The plane is a comb with vertices
 * close together at one side, so that many collapses would turn a triangle over. */
static void plane_is_covered_once(void) {
    for (uint32_t width = 13; width <= 20; width++) {
        brio_mesh *grid = flat_grid(ctx, width, 12), *mesh = without_triangles(ctx, grid, is_between_teeth);
        size_t faces = mesh->num_faces;
        double before = 0, after = 0, plane[4];
        for (size_t v = 0; v < mesh->num_vertices; v++) {
            double *p = mesh->vertices + 3 * v;
            p[1] *= p[1] * p[1] / 100, p[0] += 0.3 * p[1];
        }
        for (size_t f = 0; f < faces; f++) before += plane_of(mesh, f, plane);
        EXPECT(simplify_within(ctx, mesh, 0, 100, 100) == BRIO_OK);
        EXPECT(mesh->num_faces < faces * 3 / 4, "%zu of %zu", mesh->num_faces, faces);
        for (size_t f = 0; f < mesh->num_faces; f++) {
            after += plane_of(mesh, f, plane);
            EXPECT(plane[2] > 0.5, "triangle %zu turned over", f);
        }
        EXPECT(fabs(after - before) < 1e-9 * before, "%g, %g before", after, before);
        brio_mesh_free(grid);
        brio_mesh_free(mesh);
    }
}

/* --- refusals --- */

static void expect_refusal(const char *what, size_t num_vertices, const uint32_t *triangles, size_t count) {
    brio_mesh *mesh = triangle_mesh(ctx, NULL, num_vertices, triangles, count), *copy = copy_of(mesh);
    EXPECT(simplify_within(ctx, mesh, 0, 100, 100) == BRIO_ERR_ARGUMENT, "%s", what);
    EXPECT(same_mesh(mesh, copy), "%s: nothing was changed", what);
    brio_mesh_free(mesh);
    brio_mesh_free(copy);
}

static void what_is_no_manifold_is_refused(void) {
    const uint32_t three_at_an_edge[] = {0, 1, 2, 1, 0, 3, 0, 1, 4};
    const uint32_t turned_over[] = {0, 1, 2, 0, 1, 3};
    const uint32_t closed_at_a_vertex[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 5, 4, 0, 4, 6, 4, 5, 6, 5, 0, 6};
    const uint32_t open_at_a_vertex[] = {0, 1, 2, 0, 3, 4};
    const uint32_t open_and_closed_at_a_vertex[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 4, 5};
    expect_refusal("three at an edge", 5, three_at_an_edge, 3);
    expect_refusal("turned over", 4, turned_over, 2);
    expect_refusal("two closed surfaces at a vertex", 7, closed_at_a_vertex, 8);
    expect_refusal("two open surfaces at a vertex", 5, open_at_a_vertex, 2);
    expect_refusal("an open and a closed surface at a vertex", 6, open_and_closed_at_a_vertex, 5);
    brio_mesh *mesh = triangle_mesh(ctx, NULL, 3, (const uint32_t[]){0, 1, 2}, 1);
    mesh->face_vertices[2] = 9;
    EXPECT(simplify_within(ctx, mesh, 0, 100, 100) == BRIO_ERR_ARGUMENT, "a vertex that does not exist");
    brio_mesh_free(mesh);
}

/* A face with a vertex twice passed for a boundary and a fan, and the mesh for a manifold. */
static void triangle_with_a_vertex_twice_is_refused(void) {
    const uint32_t alone[] = {0, 0, 1}, in_a_surface[] = {0, 1, 2, 0, 0, 1, 0, 2, 3};
    expect_refusal("alone", 2, alone, 1);
    EXPECT(strstr(brio_message(ctx), "face 0 has vertex 0 twice"), "%s", brio_message(ctx));
    expect_refusal("in a surface", 4, in_a_surface, 3);
}

static void polygons_are_refused(void) {
    const double points[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    const uint64_t offsets[2] = {0, 4};
    brio_mesh *mesh = NULL;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, points, 4) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, (const uint32_t[]){0, 1, 2, 3}, 1) == BRIO_OK);
    EXPECT(simplify_within(ctx, mesh, 0, 100, 100) == BRIO_ERR_ARGUMENT);
    brio_mesh_free(mesh);
}

static void mesh_of_nothing_stays_nothing(void) {
    brio_mesh *mesh = NULL;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK);
    EXPECT(simplify_within(ctx, mesh, 0, 100, 100) == BRIO_OK && mesh->num_faces == 0 && mesh->num_vertices == 0);
    brio_mesh_free(mesh);
}

/* --- ends in the middle --- */

static int cancel(const char *stage, double fraction, void *user) {
    int *calls_left = user;
    (void)fraction;
    return !strcmp(stage, "simplify") && --*calls_left == 0;
}

/* At the first report, and at one in the middle of the work. */
static void cancelled_work_leaves_nothing(void) {
    for (int calls = 1; calls <= 2; calls++) {
        brio_context *own = new_context();
        brio_mesh *mesh = flat_grid(own, 290, 290);
        size_t memory = brio_context_memory(own);
        int calls_left = calls;
        brio_context_set_progress(own, cancel, &calls_left);
        EXPECT(simplify_within(own, mesh, 0, 100, 100) == BRIO_ERR_CANCELLED && calls_left == 0);
        EXPECT(brio_context_memory(own) == memory);
        brio_mesh_free(mesh);
        EXPECT(brio_context_memory(own) == 0);
        brio_context_free(own);
    }
}

static brio_status simplify_a_grid(brio_context *c) {
    enum { SIDE = 6, VERTICES = (SIDE + 1) * (SIDE + 1) };
    double points[3 * VERTICES];
    uint32_t triangles[6 * SIDE * SIDE];
    uint64_t offsets[2 * SIDE * SIDE + 1];
    brio_mesh *mesh = NULL;
    size_t count = 0;
    for (uint32_t i = 0; i < VERTICES; i++) {
        points[3 * i] = i % (SIDE + 1), points[3 * i + 1] = (double)(i / (SIDE + 1));
        points[3 * i + 2] = 0.1 * (points[3 * i] - 3) * points[3 * i + 1];
        if (i % (SIDE + 1) == SIDE || i / (SIDE + 1) == SIDE) continue;
        const uint32_t corners[6] = {i, i + 1, i + SIDE + 2, i, i + SIDE + 2, i + SIDE + 1};
        for (int k = 0; k < 6; k++) triangles[count++] = corners[k];
    }
    for (size_t f = 0; f <= count / 3; f++) offsets[f] = 3 * f;
    brio_status status = brio_mesh_new(c, &mesh);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(mesh, points, VERTICES);
    if (status == BRIO_OK) status = brio_mesh_set_faces(mesh, offsets, triangles, count / 3);
    brio_mesh_simplify_options o = {0};
    o.tolerance = 100;
    if (status == BRIO_OK) status = brio_mesh_simplify(c, mesh, &o);
    if (status == BRIO_OK) EXPECT(mesh->num_faces < count / 3);
    brio_mesh_free(mesh);
    return status;
}

static void refused_memory_is_a_status_and_leaves_nothing(void) {
    expect_clean_failures(simplify_a_grid);
}

/* --- brio_mesh_simplify --- */

static brio_status simplify_to(brio_mesh *mesh, size_t target_faces, double tolerance) {
    brio_mesh_simplify_options o = {0};
    o.target_faces = target_faces;
    o.tolerance = tolerance;
    return brio_mesh_simplify(ctx, mesh, &o);
}

static void larger_tolerances_leave_fewer_faces(void) {
    for (uint64_t seed = 1; seed <= (BRIEF_TESTS ? 7 : 20); seed++) {
        brio_mesh *mesh = random_mesh(ctx, seed);
        brio_certificate before = certify(mesh);
        size_t last = mesh->num_faces;
        for (double tolerance = 1e-6; tolerance < 1; tolerance *= 10) {
            brio_mesh *copy = copy_of(mesh);
            EXPECT(simplify_to(copy, 0, tolerance) == BRIO_OK, "%s", brio_message(ctx));
            brio_certificate after = certify(copy);
            EXPECT(copy->num_faces <= last && is_sound(copy), "%g: %zu, %zu", tolerance, copy->num_faces, last);
            EXPECT(after.manifold && after.oriented && after.components == before.components &&
                   after.genus == before.genus && after.boundary_edges == before.boundary_edges);
            last = copy->num_faces;
            brio_certificate_free(&after);
            brio_mesh_free(copy);
        }
        EXPECT(last < mesh->num_faces);
        brio_certificate_free(&before);
        brio_mesh_free(mesh);
    }
}

/* Squares of 2^600 are no doubles. */
static void size_of_the_mesh_does_not_matter(void) {
    for (int exponent = -600; exponent <= 600; exponent += 150) {
        brio_mesh *a = random_mesh(ctx, 3), *b = copy_of(a);
        for (size_t i = 0; i < 3 * b->num_vertices; i++) b->vertices[i] = ldexp(b->vertices[i], exponent);
        EXPECT(simplify_to(a, a->num_faces / 3, 0.1) == BRIO_OK);
        EXPECT(simplify_to(b, b->num_faces / 3, ldexp(0.1, exponent)) == BRIO_OK);
        for (size_t i = 0; i < 3 * b->num_vertices; i++) b->vertices[i] = ldexp(b->vertices[i], -exponent);
        EXPECT(same_mesh(a, b), "2^%d: %zu faces, %zu", exponent, a->num_faces, b->num_faces);
        brio_mesh_free(a);
        brio_mesh_free(b);
    }
}

/* Errors were counted in a unit of the largest coordinate of all vertices, so that a far one made them all 0. */
static void unused_vertex_far_away_does_not_matter(void) {
    brio_mesh *a = random_mesh(ctx, 3);
    size_t n = a->num_vertices;
    double *points = malloc(3 * (n + 1) * sizeof *points);
    memcpy(points, a->vertices, 3 * n * sizeof *points);
    points[3 * n] = 1e20, points[3 * n + 1] = points[3 * n + 2] = 0;
    brio_mesh *b = triangle_mesh(ctx, points, n + 1, a->face_vertices, a->num_faces);
    free(points);
    EXPECT(simplify_to(a, a->num_faces / 3, 0) == BRIO_OK && simplify_to(b, b->num_faces / 3, 0) == BRIO_OK);
    EXPECT(same_mesh(a, b), "%zu faces, %zu", a->num_faces, b->num_faces);
    brio_mesh_free(a);
    brio_mesh_free(b);
}

/* A component without area beside one with area; edges without area were never tried. */
static void component_at_one_position_collapses(void) {
    brio_mesh *a = random_mesh(ctx, 3);
    size_t n = a->num_vertices, f = a->num_faces;
    double *points = malloc(6 * n * sizeof *points);
    uint32_t *triangles = malloc(6 * f * sizeof *triangles);
    memcpy(points, a->vertices, 3 * n * sizeof *points);
    for (size_t i = 3 * n; i < 6 * n; i++) points[i] = 5;
    for (size_t i = 0; i < 3 * f; i++) {
        triangles[i] = a->face_vertices[i];
        triangles[3 * f + i] = a->face_vertices[i] + (uint32_t)n;
    }
    brio_mesh *both = triangle_mesh(ctx, points, 2 * n, triangles, 2 * f);
    EXPECT(simplify_to(both, f / 2, 0) == BRIO_OK && both->num_faces <= f / 2 + 1, "%zu of %zu faces", both->num_faces,
           2 * f);
    brio_mesh_free(a);
    brio_mesh_free(both);
    free(points);
    free(triangles);
}

static void what_is_refused_stays(void) {
    brio_mesh *mesh = random_mesh(ctx, 5), *copy = copy_of(mesh);
    EXPECT(simplify_to(copy, 0, 0) == BRIO_ERR_ARGUMENT && simplify_to(copy, 10, -1) == BRIO_ERR_ARGUMENT &&
           simplify_to(copy, 10, INFINITY) == BRIO_ERR_ARGUMENT && same_mesh(mesh, copy));
    copy->vertices[4] = NAN;
    EXPECT(simplify_to(copy, 10, 0) == BRIO_ERR_NOT_FINITE);
    copy->vertices[4] = mesh->vertices[4];
    copy->face_vertices[0] = copy->face_vertices[3] = (uint32_t)copy->num_vertices;
    EXPECT(simplify_to(copy, 10, 0) == BRIO_ERR_ARGUMENT);
    copy->face_vertices[0] = mesh->face_vertices[0], copy->face_vertices[3] = mesh->face_vertices[3];
    EXPECT(same_mesh(mesh, copy));
    brio_mesh_free(copy);
    brio_mesh_free(mesh);
}

/* --- triangles that cross --- */

static int64_t crossings_of(const brio_mesh *mesh) {
    int64_t pairs = -1;
    EXPECT(brio_mesh_self_intersections(ctx, mesh, &pairs) == BRIO_OK);
    return pairs;
}

/* The hulls of 2,000 points of a sphere and of the same points `shrunk`. */
static brio_mesh *two_spheres(double shrunk) {
    enum { N = 2000 };
    double *points = malloc(2 * 3 * N * sizeof *points);
    brio_mesh *hull = NULL;
    sphere_points(3, N, points);
    EXPECT(brio_convex_hull(ctx, points, N, NULL, &hull, NULL) == BRIO_OK);
    size_t n = hull->num_vertices, f = hull->num_faces;
    uint32_t *corners = malloc(6 * f * sizeof *corners);
    for (size_t i = 0; i < 3 * n; i++) points[i] = hull->vertices[i], points[3 * n + i] = shrunk * hull->vertices[i];
    for (size_t t = 0; t < f; t++) {
        const uint32_t *c = hull->face_vertices + 3 * t;
        for (size_t k = 0; k < 3; k++) corners[3 * t + k] = c[k], corners[3 * (f + t) + k] = (uint32_t)n + c[2 - k];
    }
    brio_mesh *both = triangle_mesh(ctx, points, 2 * n, corners, 2 * f);
    brio_mesh_free(hull);
    free(points);
    free(corners);
    return both;
}

/* A shell thinner than the triangles that are left: its sides ran through each other. */
static void sides_of_a_shell_do_not_come_to_cross(void) {
    brio_mesh *free_of_care = two_spheres(0.995), *careful = two_spheres(0.995), *again = two_spheres(0.995);
    brio_collapse_options o = {.target_faces = 160, .longest = INFINITY, .tolerance = INFINITY};
    EXPECT(crossings_of(careful) == 0);
    EXPECT(brio_collapse_edges(ctx, free_of_care, &o) == BRIO_OK && crossings_of(free_of_care) > 10);
    EXPECT(simplify_to(careful, 1600, 0) == BRIO_OK && crossings_of(careful) == 0);
    EXPECT(careful->num_faces == 1600, "%zu faces", careful->num_faces);
    brio_certificate c = certify(careful);
    EXPECT(c.closed && c.manifold && c.oriented && c.components == 2 && c.genus == 0);
    brio_certificate_free(&c);
    brio_context_set_threads(ctx, 3);
    EXPECT(simplify_to(again, 1600, 0) == BRIO_OK && same_mesh(careful, again));
    brio_context_set_threads(ctx, 0);
    brio_mesh_free(free_of_care);
    brio_mesh_free(careful);
    brio_mesh_free(again);
}

/* Spheres that cross already, or coincide, which leaves nothing to do: whatever crosses does not become more. */
static void crossings_do_not_become_more(void) {
    for (int i = 0; i < 3; i++) {
        brio_mesh *mesh = two_spheres((double[]){-1, -0.9999, 1}[i]);
        int64_t before = crossings_of(mesh);
        EXPECT(before > 0 && simplify_to(mesh, 2000, 0) == BRIO_OK);
        EXPECT(crossings_of(mesh) <= before, "%lld pairs of %lld", (long long)crossings_of(mesh), (long long)before);
        EXPECT(mesh->num_faces >= 2000 && (i == 2 || mesh->num_faces < 7900), "%zu faces", mesh->num_faces);
        brio_mesh_free(mesh);
    }
}

/* --- any mesh --- */

/* A grid of quads with a fin that meets it along its middle row, a face turned round, one with a corner twice. */
static brio_mesh *quads_with_a_fin(void) {
    enum { N = 12 };
    brio_mesh *mesh = NULL;
    double points[3 * (N + 1) * (N + 3)];
    uint64_t offsets[N * N + N + 3] = {0};
    uint32_t corners[4 * (N * N + N + 2)];
    size_t n = 0, c = 0, f = 0;
    void *number;
    for (int y = 0; y <= N; y++)
        for (int x = 0; x <= N; x++, n++) points[3 * n] = x, points[3 * n + 1] = y, points[3 * n + 2] = 0.01 * x * y;
    for (int x = 0; x <= N; x++, n++) points[3 * n] = x, points[3 * n + 1] = N / 2, points[3 * n + 2] = 3;
    for (uint32_t y = 0; y <= N; y++)
        for (uint32_t x = 0; x < N; x++) {
            uint32_t at = (y < N ? y : N / 2) * (N + 1) + x, up = y < N ? at + N + 1 : (N + 1) * (N + 1) + x;
            const uint32_t quad[4] = {at, at + 1, up + 1, up};
            for (uint32_t k = 0; k < 4; k++) corners[c++] = quad[f == 30 ? 3 - k : k];
            offsets[++f] = c;
        }
    memcpy(corners + c, (uint32_t[]){0, 1, 0}, 3 * sizeof *corners);
    offsets[++f] = c + 3;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, points, n) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, corners, f) == BRIO_OK);
    EXPECT(brio_mesh_add_face_property(mesh, "number", BRIO_SCALAR_INT32, &number) == BRIO_OK);
    for (int32_t i = 0; i < (int32_t)f; i++) ((int32_t *)number)[i] = i;
    return mesh;
}

static void any_mesh_is_simplified(void) {
    brio_mesh *mesh = quads_with_a_fin();
    brio_mesh_simplify_options o = {0};
    brio_certificate before = certify(mesh);
    o.target_faces = 40;
    EXPECT(brio_mesh_simplify(ctx, mesh, &o) == BRIO_ERR_ARGUMENT);
    o.any = 1;
    EXPECT(brio_mesh_simplify(ctx, mesh, &o) == BRIO_OK, "%s", brio_message(ctx));
    brio_certificate after = certify(mesh);
    /* one is an edge of the face with a corner twice */
    EXPECT(before.nonmanifold_edges == 13 && after.nonmanifold_edges == 12, "%zu and %zu edges",
           before.nonmanifold_edges, after.nonmanifold_edges);
    EXPECT(after.components == 1 && after.area > 0.98 * before.area && after.area < 1.02 * before.area);
    EXPECT(is_sound(mesh) && mesh->num_faces < 2 * 157 / 2 && mesh->num_properties == 0, "%zu faces", mesh->num_faces);
    const brio_property *number = brio_mesh_face_property(mesh, "number");
    for (size_t f = 1; f < mesh->num_faces; f++)
        EXPECT(brio_property_value(number, f - 1) <= brio_property_value(number, f) &&
               brio_property_value(number, f) < 156);
    brio_certificate_free(&before);
    brio_certificate_free(&after);
    brio_mesh_free(mesh);
}

static void edges_of_its_own_are_refused(void) {
    brio_mesh *mesh = random_mesh(ctx, 5);
    const uint32_t edge[2] = {0, 1};
    EXPECT(brio_mesh_set_edges(mesh, edge, 1) == BRIO_OK);
    EXPECT(simplify_to(mesh, 10, 0) == BRIO_ERR_ARGUMENT);
    brio_mesh_free(mesh);
}

/* --- vertices that go back --- */

static void vertices_go_back_until_nothing_crosses(void) {
    brio_mesh *mesh = two_spheres(0.99);
    size_t n = mesh->num_vertices, moved = 0, there = 0;
    double *before = malloc(3 * n * sizeof *before), *after = malloc(3 * n * sizeof *after);
    brio_rng rng = brio_rng_new(8);
    memcpy(before, mesh->vertices, 3 * n * sizeof *before);
    for (size_t i = 0; i < 3 * n; i++) mesh->vertices[i] += 0.02 * (brio_rng_double(&rng) - 0.5);
    memcpy(after, mesh->vertices, 3 * n * sizeof *after);
    EXPECT(crossings_of(mesh) > 100);
    EXPECT(brio_back_off(ctx, mesh, before, &moved) == BRIO_OK && crossings_of(mesh) == 0);
    for (size_t v = 0; v < n; v++) there += !memcmp(mesh->vertices + 3 * v, after + 3 * v, 3 * sizeof *after);
    EXPECT(moved > 0 && there == n - moved && there > n / 10, "%zu of %zu went back", moved, n);
    free(before);
    free(after);
    brio_mesh_free(mesh);
}

SUITE(test_simplify) {
    ctx = new_context();
    RUN(closed_surfaces_keep_components_and_genus);
    RUN(tetrahedron_is_left_alone);
    RUN(number_of_faces_is_reached);
    RUN(long_edges_do_not_collapse);
    RUN(unused_vertices_are_dropped);
    RUN(no_collapse_is_farther_than_the_tolerance);
    RUN(sphere_is_not_cut_deeper_than_the_tolerance);
    RUN(boundaries_stay);
    RUN(plane_is_covered_once);
    RUN(what_is_no_manifold_is_refused);
    RUN(triangle_with_a_vertex_twice_is_refused);
    RUN(polygons_are_refused);
    RUN(mesh_of_nothing_stays_nothing);
    RUN(cancelled_work_leaves_nothing);
    RUN(larger_tolerances_leave_fewer_faces);
    RUN(size_of_the_mesh_does_not_matter);
    RUN(unused_vertex_far_away_does_not_matter);
    RUN(component_at_one_position_collapses);
    RUN(what_is_refused_stays);
    RUN(refused_memory_is_a_status_and_leaves_nothing);
    RUN(sides_of_a_shell_do_not_come_to_cross);
    RUN(crossings_do_not_become_more);
    RUN(any_mesh_is_simplified);
    RUN(edges_of_its_own_are_refused);
    RUN(vertices_go_back_until_nothing_crosses);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
