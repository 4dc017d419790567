/* The certificate of polygon meshes: known surfaces, defects, and a brute-force reference on random meshes. */
#include "base/rng.h"
#include "failing_allocator.h"
#include <math.h>
#include <stdbool.h>
#include <string.h>

/* Most corners of a mesh under the brute-force reference. */
enum { MOST = 256 };

static brio_context *ctx;

/* A mesh of faces given as a text: vertices of a face apart by blanks, faces by commas. Vertex v lies at position v, or
 * somewhere when there are no positions. */
static brio_mesh *mesh_of(const char *faces, const double *positions) {
    uint64_t offsets[64] = {0};
    uint32_t corners[256];
    size_t num_faces = 0, count = 0, num_vertices = 0;
    for (const char *s = faces; *s;) {
        char *end;
        corners[count] = (uint32_t)strtoul(s, &end, 10);
        if (corners[count] >= num_vertices) num_vertices = corners[count] + 1;
        count++;
        while (*end == ' ') end++;
        if (*end == ',' || !*end) offsets[++num_faces] = count;
        s = *end == ',' ? end + 1 : end;
    }
    brio_mesh *mesh;
    brio_mesh_new(ctx, &mesh);
    brio_mesh_set_vertices(mesh, positions, num_vertices);
    brio_mesh_set_faces(mesh, offsets, corners, num_faces);
    return mesh;
}

static brio_certificate certificate_of(brio_mesh *mesh) {
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK, "%s", brio_message(ctx));
    brio_mesh_free(mesh);
    return c;
}

/* The certificate of a mesh; the genera are freed. */
static brio_certificate numbers_of(brio_mesh *mesh) {
    brio_certificate c = certificate_of(mesh), copy = c;
    copy.genera = NULL;
    brio_certificate_free(&c);
    return copy;
}

static brio_certificate certify(const char *faces) {
    return numbers_of(mesh_of(faces, NULL));
}

static brio_certificate certify_tetrahedron(const double *corners) {
    return numbers_of(mesh_of("0 2 1,0 1 3,1 2 3,2 0 3", corners));
}

static bool is_perfect(const brio_certificate *c) {
    return c->closed && c->manifold && c->oriented;
}

/* --- known surfaces --- */

static void empty_mesh_is_not_closed(void) {
    brio_mesh *mesh;
    brio_mesh_new(ctx, &mesh);
    brio_certificate c = certificate_of(mesh);
    EXPECT(!c.closed && c.manifold && c.oriented && c.components == 0 && c.genus == 0 && c.self_intersections == -1);
    brio_certificate_free(&c);
    brio_certificate_free(&c);
}

static void tetrahedron_has_volume_of_its_orientation(void) {
    const double corners[] = {1e6, 0, 0, 1e6 + 1, 0, 0, 1e6, 1, 0, 1e6, 0, 1};
    brio_certificate c = certificate_of(mesh_of("0 2 1,0 1 3,1 2 3,2 0 3", corners));
    EXPECT(is_perfect(&c) && c.components == 1 && c.genus == 0 && c.genera[0] == 0 && c.boundary_loops == 0);
    EXPECT(fabs(c.volume - 1.0 / 6) < 1e-15, "%.17g", c.volume);
    EXPECT(fabs(c.area - 1.5 - sqrt(3) / 2) < 1e-9, "%.17g", c.area);
    brio_certificate_free(&c);
    c = certificate_of(mesh_of("0 1 2,0 3 1,1 3 2,2 3 0", corners));
    EXPECT(fabs(c.volume + 1.0 / 6) < 1e-15, "%.17g", c.volume);
    brio_certificate_free(&c);
}

/* Products of large coordinates overflowed to NaN, those of small ones were lost. */
static void area_and_volume_at_extreme_scales(void) {
    static const double corners[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    double scaled[12];
    const brio_certificate one = certify_tetrahedron(corners);
    for (int k = -1074; k <= 1023; k++) {
        for (int i = 0; i < 12; i++) scaled[i] = ldexp(corners[i], k);
        brio_certificate c = certify_tetrahedron(scaled);
        EXPECT(c.area == ldexp(one.area, 2 * k), "2^%d: area %g", k, c.area);
        EXPECT(c.volume == ldexp(one.volume, 3 * k), "2^%d: volume %g", k, c.volume);
    }
}

static void cube_of_quads_has_volume_one(void) {
    double corners[24];
    for (int i = 0; i < 24; i++) corners[i] = i / 3 >> i % 3 & 1;
    brio_certificate c = certificate_of(mesh_of("0 2 3 1,4 5 7 6,0 1 5 4,2 6 7 3,0 4 6 2,1 3 7 5", corners));
    EXPECT(is_perfect(&c) && c.components == 1 && c.genus == 0);
    EXPECT(fabs(c.volume - 1) < 1e-15 && fabs(c.area - 6) < 1e-14, "%.17g %.17g", c.volume, c.area);
    brio_certificate_free(&c);
}

/* A torus of m by n quadrilaterals. */
static brio_mesh *torus(uint32_t m, uint32_t n) {
    uint64_t *offsets = malloc((m * n + 1) * sizeof *offsets);
    uint32_t *corners = malloc(4 * m * n * sizeof *corners);
    offsets[0] = 0;
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = 0; j < n; j++) {
            uint32_t f = i * n + j, k = (i + 1) % m, l = (j + 1) % n;
            const uint32_t quad[4] = {i * n + j, k * n + j, k * n + l, i * n + l};
            memcpy(corners + 4 * f, quad, sizeof quad);
            offsets[f + 1] = 4 * (f + 1);
        }
    brio_mesh *mesh;
    brio_mesh_new(ctx, &mesh);
    brio_mesh_set_vertices(mesh, NULL, m * n + 3); /* three of them unused */
    brio_mesh_set_faces(mesh, offsets, corners, m * n);
    free(offsets);
    free(corners);
    return mesh;
}

static void torus_has_genus_one(void) {
    brio_certificate c = certificate_of(torus(40, 30));
    EXPECT(is_perfect(&c) && c.components == 1 && c.genus == 1 && c.genera[0] == 1 && c.nonmanifold_vertices == 0);
    brio_certificate_free(&c);
}

static void genera_come_largest_component_first(void) {
    brio_mesh *small = torus(3, 3), *mesh;
    uint64_t offsets[18] = {0};
    uint32_t corners[72] = {20, 22, 21, 20, 21, 23, 21, 22, 23, 22, 20, 23};
    for (size_t f = 0; f < 4; f++) offsets[f + 1] = 3 * (f + 1);
    for (size_t f = 0; f < 9; f++) offsets[f + 5] = offsets[f + 4] + 4;
    memcpy(corners + 12, small->face_vertices, 36 * sizeof *corners);
    for (size_t i = 0; i < 12; i++) corners[48 + i] = corners[i] + 4;
    for (size_t f = 0; f < 4; f++) offsets[f + 14] = offsets[f + 13] + 3;
    brio_mesh_free(small);
    brio_mesh_new(ctx, &mesh);
    brio_mesh_set_vertices(mesh, NULL, 28);
    brio_mesh_set_faces(mesh, offsets, corners, 17);
    brio_certificate c = certificate_of(mesh);
    EXPECT(is_perfect(&c) && c.components == 3 && c.genus == 1);
    EXPECT(c.genera[0] == 1 && c.genera[1] == 0 && c.genera[2] == 0);
    brio_certificate_free(&c);
}

static void disk_has_one_loop(void) {
    brio_certificate c = certify("0 1 2 3 4 5");
    EXPECT(!c.closed && c.manifold && c.oriented && c.genus == 0 && c.boundary_edges == 6 && c.boundary_loops == 1);
    c = certify("0 1 2,0 2 3,0 3 4,0 4 1");
    EXPECT(!c.closed && c.manifold && c.oriented && c.genus == 0 && c.boundary_edges == 4 && c.boundary_loops == 1);
}

static void annulus_has_two_loops(void) {
    brio_certificate c = certify("0 1 4 3,1 2 5 4,2 0 3 5");
    EXPECT(!c.closed && c.manifold && c.oriented && c.components == 1 && c.genus == 0);
    EXPECT(c.boundary_edges == 6 && c.boundary_loops == 2);
}

static void torus_without_a_face_keeps_its_genus(void) {
    brio_mesh *mesh = torus(5, 6);
    mesh->num_faces--;
    brio_certificate c = certificate_of(mesh);
    EXPECT(!c.closed && c.manifold && c.genus == 1 && c.boundary_loops == 1 && c.boundary_edges == 4);
    brio_certificate_free(&c);
}

static void moebius_strip_cannot_be_oriented(void) {
    brio_certificate c = certify("0 1 4 3,1 2 5 4,2 3 0 5");
    EXPECT(!c.closed && c.manifold && !c.oriented && c.flipped_edges == 1 && c.boundary_loops == 1 && c.genus == 0);
}

/* --- defects --- */

static void shared_vertex_is_not_manifold_and_joins_nothing(void) {
    brio_certificate c = certify("0 2 1,0 1 3,1 2 3,2 0 3,0 5 4,0 4 6,4 5 6,5 0 6");
    EXPECT(c.closed && !c.manifold && c.oriented && c.components == 2 && c.genus == 0);
    EXPECT(c.nonmanifold_vertices == 1 && c.nonmanifold_edges == 0);
}

static void bow_tie_has_two_loops(void) {
    brio_certificate c = certify("0 1 2,0 3 4");
    EXPECT(!c.manifold && c.nonmanifold_vertices == 1 && c.components == 2 && c.boundary_loops == 2 && c.genus == 0);
}

static void pinched_component_counts_its_vertex_once(void) {
    brio_certificate whole = certify("0 1 4 3,1 2 5 4,2 6 7 5"), pinched = certify("0 1 4 3,1 2 5 4,2 6 0 5");
    EXPECT(whole.manifold && whole.boundary_loops == 1 && whole.genus == 0);
    EXPECT(!pinched.manifold && pinched.nonmanifold_vertices == 1 && pinched.components == 1);
    EXPECT(pinched.boundary_loops == 1 && pinched.genus == 0); /* (2 - 0 - 1) / 2, rounded down */
}

static void three_triangles_on_an_edge_are_one_component(void) {
    brio_certificate c = certify("0 1 2,1 0 3,0 1 4");
    EXPECT(!c.closed && !c.manifold && c.nonmanifold_edges == 1 && c.components == 1 && c.boundary_edges == 6);
    EXPECT(c.flipped_edges == 0 && c.nonmanifold_vertices == 2 && c.boundary_loops == 1 && c.genus == 0);
}

static void two_tetrahedra_on_an_edge_are_not_closed(void) {
    brio_certificate c = certify("0 2 1,0 1 3,1 2 3,2 0 3,0 5 1,0 1 4,1 5 4,5 0 4");
    EXPECT(!c.closed && !c.manifold && c.nonmanifold_edges == 1 && c.components == 1 && c.boundary_edges == 0);
}

static void flipped_face_flips_its_edges(void) {
    brio_certificate c = certify("0 1 2,0 1 3,1 2 3,2 0 3");
    EXPECT(c.closed && c.manifold && !c.oriented && c.flipped_edges == 3);
}

static void degenerate_faces_are_not_manifold(void) {
    brio_certificate c = certify("0 1");
    EXPECT(!c.manifold && c.nonmanifold_vertices == 2 && c.components == 1);
    c = certify("3");
    EXPECT(!c.closed && !c.manifold && c.nonmanifold_vertices == 1);
    c = certify("0 1 2 0 3 4");
    EXPECT(!c.manifold && c.nonmanifold_vertices == 1);
    c = certify("0 1 1 2,0 2 1");
    EXPECT(!c.manifold && c.nonmanifold_vertices == 1);
}

/* Both sides of its one edge belong to one face, which counted as two faces of the edge. */
static void faces_of_fewer_than_three_corners_close_nothing(void) {
    brio_certificate c = certify("0 1");
    EXPECT(!c.closed && !c.manifold && c.boundary_edges == 0 && c.nonmanifold_edges == 0);
    c = certify("0,0");
    EXPECT(!c.closed && !c.manifold);
    c = certify("0 2 1,0 1 3,1 2 3,2 0 3,4 5");
    EXPECT(!c.closed && !c.manifold && c.components == 2);
    c = certify("0 1 2 1"); /* a polygon with a slit, glued to itself */
    EXPECT(c.closed && !c.manifold && c.nonmanifold_vertices == 1);
}

static void face_without_corners_is_not_manifold(void) {
    brio_mesh *mesh;
    const uint64_t offsets[2] = {0, 0};
    const uint32_t none = 0;
    brio_mesh_new(ctx, &mesh);
    brio_mesh_set_faces(mesh, offsets, &none, 1);
    brio_certificate c = certificate_of(mesh);
    EXPECT(!c.closed && !c.manifold && c.components == 1);
    brio_certificate_free(&c);
}

static void unsound_faces_are_refused(void) {
    brio_certificate c = {0};
    brio_mesh *mesh = mesh_of("0 1 2,0 2 3", NULL);
    mesh->face_vertices[4] = 4;
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_ERR_ARGUMENT && c.genera == NULL);
    EXPECT(strstr(brio_message(ctx), "face 1: vertex 4") != NULL, "%s", brio_message(ctx));
    mesh->face_vertices[4] = 2;
    mesh->face_offsets[1] = 7;
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_ERR_ARGUMENT);
    mesh->face_offsets[1] = 3;
    mesh->face_offsets[0] = 1;
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_ERR_ARGUMENT);
    brio_mesh_free(mesh);
}

/* A fan of n triangles round one edge and a wheel round one vertex: every list is as long as it can be. */
static void crowded_edge_and_vertex_cost_little(void) {
    enum { N = 200000 };
    uint64_t *offsets = malloc((2 * N + 1) * sizeof *offsets);
    uint32_t *corners = malloc(6 * N * sizeof *corners);
    offsets[0] = 0;
    for (uint32_t f = 0; f < N; f++) {
        const uint32_t book[3] = {0, 1, 2 + f}, wheel[3] = {N + 2, N + 3 + f, N + 3 + (f + 1) % N};
        memcpy(corners + 3 * f, book, sizeof book);
        memcpy(corners + 3 * (N + f), wheel, sizeof wheel);
    }
    for (size_t f = 0; f < 2 * N; f++) offsets[f + 1] = 3 * (f + 1);
    brio_mesh *mesh;
    brio_mesh_new(ctx, &mesh);
    brio_mesh_set_vertices(mesh, NULL, 2 * N + 3);
    brio_mesh_set_faces(mesh, offsets, corners, 2 * N);
    free(offsets);
    free(corners);
    brio_certificate c = certificate_of(mesh);
    EXPECT(c.components == 2 && c.nonmanifold_edges == 1 && c.nonmanifold_vertices == 2 && c.boundary_loops == 2);
    EXPECT(c.boundary_edges == 3 * N);
    brio_certificate_free(&c);
}

/* --- brute force --- */

typedef struct {
    size_t corners, faces;
    uint32_t start[MOST], end[MOST]; /* vertices of half-edge h */
    size_t face[MOST], next[MOST];
    size_t fan[MOST], joined[MOST], component[MOST], loop[MOST]; /* labels: of corners twice, faces, half-edges */
} reference;

static bool same_edge(const reference *r, size_t h, size_t g) {
    return (r->start[h] == r->start[g] && r->end[h] == r->end[g]) ||
           (r->start[h] == r->end[g] && r->end[h] == r->start[g]);
}

static size_t faces_of_edge(const reference *r, size_t h) {
    size_t count = 0;
    for (size_t g = 0; g < r->corners; g++) count += same_edge(r, h, g);
    return count;
}

static bool lower(size_t *a, size_t *b) {
    if (*a == *b) return false;
    *a = *b = *a < *b ? *a : *b;
    return true;
}

static reference reference_of(const brio_mesh *mesh) {
    static reference r;
    memset(&r, 0, sizeof r);
    r.faces = mesh->num_faces;
    r.corners = mesh->face_offsets[mesh->num_faces];
    for (size_t f = 0; f < r.faces; f++)
        for (size_t h = mesh->face_offsets[f]; h < mesh->face_offsets[f + 1]; h++) {
            r.face[h] = f;
            r.next[h] = h + 1 < mesh->face_offsets[f + 1] ? h + 1 : mesh->face_offsets[f];
            r.start[h] = mesh->face_vertices[h];
            r.end[h] = mesh->face_vertices[r.next[h]];
        }
    for (size_t i = 0; i < MOST; i++) r.fan[i] = r.joined[i] = r.component[i] = r.loop[i] = i;
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t h = 0; h < r.corners; h++)
            for (size_t g = 0; g < r.corners; g++) {
                if (!same_edge(&r, h, g)) continue;
                bool same_way = r.start[h] == r.start[g];
                changed |= lower(&r.component[r.face[h]], &r.component[r.face[g]]);
                size_t g_at_start = same_way ? g : r.next[g], g_at_end = same_way ? r.next[g] : g;
                changed |= lower(&r.joined[h], &r.joined[g_at_start]);
                changed |= lower(&r.joined[r.next[h]], &r.joined[g_at_end]);
                if (faces_of_edge(&r, h) > 2) continue;
                changed |= lower(&r.fan[h], &r.fan[g_at_start]);
                changed |= lower(&r.fan[r.next[h]], &r.fan[g_at_end]);
            }
    }
    return r;
}

static bool touch(const reference *r, size_t h, size_t g) {
    size_t a = r->joined[h], b = r->joined[r->next[h]], c = r->joined[g], d = r->joined[r->next[g]];
    return a == c || a == d || b == c || b == d;
}

static void label_loops(reference *r) {
    for (bool changed = true; changed;) {
        changed = false;
        for (size_t h = 0; h < r->corners; h++)
            for (size_t g = 0; g < r->corners; g++)
                if (faces_of_edge(r, h) == 1 && faces_of_edge(r, g) == 1 && touch(r, h, g))
                    changed |= lower(&r->loop[h], &r->loop[g]);
    }
}

static int64_t floor_half(int64_t x) {
    return (int64_t)floor((double)x / 2);
}

/* The genus of the component whose first face is f, and its boundary loops. */
static int64_t genus_by_counting(const reference *r, size_t f, size_t num_vertices, size_t *loops) {
    int64_t vertices = 0, edges = 0, faces = 0, boundary = 0;
    for (size_t g = 0; g < r->faces; g++) faces += r->component[g] == f;
    for (uint32_t v = 0; v < num_vertices; v++) {
        bool used = false;
        for (size_t h = 0; h < r->corners; h++) used |= r->component[r->face[h]] == f && r->start[h] == v;
        vertices += used;
    }
    for (size_t h = 0; h < r->corners; h++) {
        if (r->component[r->face[h]] != f) continue;
        bool first = true;
        for (size_t g = 0; g < h; g++) first &= !same_edge(r, g, h);
        edges += first;
        boundary += faces_of_edge(r, h) == 1 && r->loop[h] == h;
    }
    *loops += (size_t)boundary;
    return floor_half(2 - (vertices - edges + faces) - boundary);
}

static bool vertex_is_bad(const reference *r, uint32_t v, bool *twice_in_face) {
    size_t fan = SIZE_MAX;
    bool bad = false;
    for (size_t h = 0; h < r->corners; h++) {
        if (r->start[h] != v) continue;
        bad |= fan != SIZE_MAX && fan != r->fan[h];
        fan = r->fan[h];
        size_t size = 0, times = 0;
        for (size_t g = 0; g < r->corners; g++) {
            size += r->face[g] == r->face[h];
            times += r->face[g] == r->face[h] && r->start[g] == v;
        }
        *twice_in_face |= times > 1 || size < 3;
    }
    return bad || *twice_in_face;
}

static void compare_with_reference(const brio_mesh *mesh, uint64_t number) {
    reference r = reference_of(mesh);
    label_loops(&r);
    size_t boundary = 0, crowded = 0, flipped = 0, components = 0, loops = 0, vertices = 0;
    int64_t genus = 0;
    for (size_t h = 0; h < r.corners; h++) {
        size_t count = faces_of_edge(&r, h);
        bool first = true;
        for (size_t g = 0; g < h; g++) first &= !same_edge(&r, g, h);
        boundary += count == 1;
        crowded += count > 2 && first;
        for (size_t g = 0; g < h; g++) flipped += count == 2 && same_edge(&r, g, h) && r.start[g] == r.start[h];
    }
    for (uint32_t v = 0; v < mesh->num_vertices; v++) {
        bool twice = false;
        vertices += vertex_is_bad(&r, v, &twice);
    }
    brio_certificate c = {0};
    EXPECT(brio_mesh_certificate(ctx, mesh, &c) == BRIO_OK);
    for (size_t f = 0; f < r.faces; f++)
        if (r.component[f] == f) {
            components++;
            genus += genus_by_counting(&r, f, mesh->num_vertices, &loops);
        }
    int64_t sum = 0;
    for (size_t i = 0; i < c.components; i++) sum += c.genera[i];
    EXPECT(c.boundary_edges == boundary && c.nonmanifold_edges == crowded, "mesh %d", (int)number);
    EXPECT(c.flipped_edges == flipped, "mesh %d: %zu, not %zu", (int)number, c.flipped_edges, flipped);
    EXPECT(c.nonmanifold_vertices == vertices, "mesh %d: %zu, not %zu", (int)number, c.nonmanifold_vertices, vertices);
    EXPECT(c.components == components, "mesh %d: %zu, not %zu", (int)number, c.components, components);
    EXPECT(c.boundary_loops == loops, "mesh %d: %zu, not %zu", (int)number, c.boundary_loops, loops);
    EXPECT(c.genus == genus && sum == genus, "mesh %d: %d, not %d", (int)number, (int)c.genus, (int)genus);
    bool thin = false;
    for (size_t f = 0; f < r.faces; f++) thin |= mesh->face_offsets[f + 1] - mesh->face_offsets[f] < 3;
    EXPECT(c.closed == (!boundary && !crowded && !thin) && c.oriented == !flipped, "mesh %d", (int)number);
    EXPECT(c.manifold == (!crowded && !vertices), "mesh %d", (int)number);
    brio_certificate_free(&c);
}

static void random_polygons_agree_with_brute_force(void) {
    for (uint64_t number = 0; number < 1500; number++) {
        brio_rng rng = brio_rng_new(number);
        uint64_t offsets[16] = {0};
        uint32_t corners[80], num_vertices = 2 + brio_rng_below(&rng, 9);
        size_t num_faces = 1 + brio_rng_below(&rng, 12);
        for (size_t f = 0; f < num_faces; f++) {
            offsets[f + 1] = offsets[f] + 1 + brio_rng_below(&rng, number % 2 ? 4 : 6);
            for (size_t h = offsets[f]; h < offsets[f + 1]; h++) corners[h] = brio_rng_below(&rng, num_vertices);
        }
        brio_mesh *mesh;
        brio_mesh_new(ctx, &mesh);
        brio_mesh_set_vertices(mesh, NULL, num_vertices);
        brio_mesh_set_faces(mesh, offsets, corners, num_faces);
        compare_with_reference(mesh, number);
        brio_mesh_free(mesh);
    }
}

/* Tori with faces lost, faces turned round, and vertices merged. */
static void damaged_tori_agree_with_brute_force(void) {
    for (uint64_t number = 0; number < 150; number++) {
        brio_rng rng = brio_rng_new(number);
        brio_mesh *mesh = torus(3 + (uint32_t)number % 2, 4);
        for (uint32_t lost = brio_rng_below(&rng, 6); lost > 0; lost--) {
            size_t f = brio_rng_below(&rng, (uint32_t)mesh->num_faces), last = --mesh->num_faces;
            memmove(mesh->face_vertices + 4 * f, mesh->face_vertices + 4 * last, 4 * sizeof *mesh->face_vertices);
        }
        if (number % 3 == 0) {
            uint32_t *quad = mesh->face_vertices + 4 * brio_rng_below(&rng, (uint32_t)mesh->num_faces), v = quad[1];
            quad[1] = quad[3];
            quad[3] = v;
        }
        for (uint32_t merged = brio_rng_below(&rng, 3); merged > 0; merged--) {
            uint32_t v = brio_rng_below(&rng, 12), w = brio_rng_below(&rng, 12);
            for (size_t h = 0; h < 4 * mesh->num_faces; h++)
                if (mesh->face_vertices[h] == v) mesh->face_vertices[h] = w;
        }
        compare_with_reference(mesh, number);
        brio_mesh_free(mesh);
    }
}

/* --- memory --- */

static brio_status certify_tetrahedra_that_touch(brio_context *context) {
    static const uint64_t offsets[] = {0, 3, 6, 9, 12, 15, 18, 21, 24};
    static const uint32_t corners[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 5, 4, 0, 4, 6, 4, 5, 6, 5, 0, 6};
    brio_mesh *mesh = NULL;
    brio_certificate c = {0};
    brio_status status = brio_mesh_new(context, &mesh);
    if (status == BRIO_OK) status = brio_mesh_set_vertices(mesh, NULL, 7);
    if (status == BRIO_OK) status = brio_mesh_set_faces(mesh, offsets, corners, 8);
    if (status == BRIO_OK) status = brio_mesh_certificate(context, mesh, &c);
    brio_certificate_free(&c);
    brio_mesh_free(mesh);
    return status;
}

static void no_memory_is_a_status(void) {
    expect_clean_failures(certify_tetrahedra_that_touch);
}

SUITE(test_certificate) {
    brio_context_new(NULL, &ctx);
    RUN(empty_mesh_is_not_closed);
    RUN(tetrahedron_has_volume_of_its_orientation);
    RUN(area_and_volume_at_extreme_scales);
    RUN(cube_of_quads_has_volume_one);
    RUN(torus_has_genus_one);
    RUN(genera_come_largest_component_first);
    RUN(disk_has_one_loop);
    RUN(annulus_has_two_loops);
    RUN(torus_without_a_face_keeps_its_genus);
    RUN(moebius_strip_cannot_be_oriented);
    RUN(shared_vertex_is_not_manifold_and_joins_nothing);
    RUN(bow_tie_has_two_loops);
    RUN(pinched_component_counts_its_vertex_once);
    RUN(three_triangles_on_an_edge_are_one_component);
    RUN(two_tetrahedra_on_an_edge_are_not_closed);
    RUN(flipped_face_flips_its_edges);
    RUN(degenerate_faces_are_not_manifold);
    RUN(faces_of_fewer_than_three_corners_close_nothing);
    RUN(face_without_corners_is_not_manifold);
    RUN(unsound_faces_are_refused);
    RUN(crowded_edge_and_vertex_cost_little);
    RUN(random_polygons_agree_with_brute_force);
    RUN(damaged_tori_agree_with_brute_force);
    RUN(no_memory_is_a_status);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return harness_end();
}
