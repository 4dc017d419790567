/* Certificates of surfaces that come in parts: those of the whole mesh, whatever the parts. */
#include "base/memory.h"
#include "base/rng.h"
#include "brio/tiles.h"
#include "failing_allocator.h"
#include "harness.h"
#include "mesh/split_vertices.h"
#include "points.h"
#include <dirent.h>
#include <math.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST_VERTICES = 400, MOST_FACES = 20000, MOST_PARTS = 12 };

static double points[3 * MOST_VERTICES];
static uint32_t faces[MOST_FACES][3];
static char folder[64];

static size_t files_left(void) {
    DIR *d = opendir(folder);
    size_t n = 0;
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) n += e->d_name[0] != '.';
    if (d) closedir(d);
    return n;
}

static brio_mesh *mesh_of(brio_context *ctx, size_t num_vertices, size_t num_faces) {
    brio_mesh *mesh;
    uint64_t *offsets = malloc((num_faces + 1) * sizeof *offsets);
    for (size_t f = 0; f <= num_faces; f++) offsets[f] = 3 * f;
    EXPECT(brio_mesh_new(ctx, &mesh) == BRIO_OK && brio_mesh_set_vertices(mesh, points, num_vertices) == BRIO_OK);
    EXPECT(brio_mesh_set_faces(mesh, offsets, *faces, num_faces) == BRIO_OK);
    free(offsets);
    return mesh;
}

/* --- random surfaces --- */

static void turn(uint32_t *face) {
    uint32_t v = face[1];
    face[1] = face[2];
    face[2] = v;
}

/* A net of triangles on a torus of m by n vertices, from vertex `first` on. Returns how many faces were added at f. */
static size_t add_torus(uint32_t first, uint32_t m, uint32_t n, size_t f) {
    for (uint32_t i = 0; i < m; i++)
        for (uint32_t j = 0; j < n; j++) {
            const uint32_t k = (i + 1) % m, l = (j + 1) % n;
            const uint32_t two[2][3] = {{i * n + j, k * n + j, k * n + l}, {i * n + j, k * n + l, i * n + l}};
            for (int t = 0; t < 2; t++, f++)
                for (int c = 0; c < 3; c++) faces[f][c] = first + two[t][c];
        }
    return 2 * (size_t)m * n;
}

/* Tori of which faces are lost, turned round and repeated, and vertices merged; or faces of any three vertices. Degenerate
 * faces come about by both. */
static size_t random_surface(brio_rng *rng, size_t *num_vertices) {
    size_t n = 0;
    uint32_t v = 0;
    if (brio_rng_below(rng, 3) == 0) {
        *num_vertices = 3 + brio_rng_below(rng, 20);
        for (size_t count = 1 + brio_rng_below(rng, 40); n < count; n++)
            for (int k = 0; k < 3; k++) faces[n][k] = brio_rng_below(rng, (uint32_t)*num_vertices);
        return n;
    }
    for (uint32_t tori = 1 + brio_rng_below(rng, 3); tori > 0; tori--) {
        uint32_t a = 3 + brio_rng_below(rng, 5), b = 3 + brio_rng_below(rng, 8);
        n += add_torus(v, a, b, n);
        v += a * b;
    }
    *num_vertices = v;
    for (uint32_t lost = brio_rng_below(rng, 2) * brio_rng_below(rng, 40); lost > 0 && n > 1; lost--)
        memcpy(faces[brio_rng_below(rng, (uint32_t)n)], faces[n - 1], sizeof *faces), n--;
    for (uint32_t turned = brio_rng_below(rng, 2) * brio_rng_below(rng, 4); turned > 0; turned--)
        turn(faces[brio_rng_below(rng, (uint32_t)n)]);
    for (uint32_t again = brio_rng_below(rng, 2) * brio_rng_below(rng, 3); again > 0; again--, n++)
        memcpy(faces[n], faces[brio_rng_below(rng, (uint32_t)n)], sizeof *faces);
    for (uint32_t merged = brio_rng_below(rng, 2) * brio_rng_below(rng, 6); merged > 0; merged--) {
        uint32_t from = brio_rng_below(rng, v), to = brio_rng_below(rng, v);
        for (size_t i = 0; i < 3 * n; i++)
            if (faces[i / 3][i % 3] == from) faces[i / 3][i % 3] = to;
    }
    return n;
}

/* --- parts of them --- */

typedef struct {
    uint32_t parts;
    uint8_t part[MOST_FACES];       /* of each face */
    uint64_t number[MOST_VERTICES]; /* of each vertex, in place of its row */
    int flags; /* whether parts say what is shared: 0 never, 1 where it is, 2 sometimes too often */
} division;

/* Divides faces at random, or by slabs of space so that most vertices are in one part. */
static void divide(brio_rng *rng, size_t num_vertices, size_t n, division *d) {
    bool slabs = brio_rng_below(rng, 2);
    d->parts = 1 + brio_rng_below(rng, MOST_PARTS);
    d->flags = (int)brio_rng_below(rng, 3);
    for (size_t f = 0; f < n; f++)
        d->part[f] = (uint8_t)(slabs ? faces[f][0] * d->parts / num_vertices : brio_rng_below(rng, d->parts));
    for (size_t v = 0; v < num_vertices; v++) d->number[v] = v;
    for (size_t v = num_vertices - 1; v > 0; v--) {
        size_t w = brio_rng_below(rng, (uint32_t)v + 1);
        uint64_t swap = d->number[v];
        d->number[v] = d->number[w], d->number[w] = swap;
    }
    for (size_t v = 0; v < num_vertices; v++) d->number[v] = d->number[v] * UINT64_C(0x100000001) + 7;
}

/* Tells whether a vertex of a part has faces in other parts. */
static bool is_shared(const division *d, size_t n, uint32_t v, uint32_t part) {
    for (size_t f = 0; f < n; f++)
        if (d->part[f] != part && (faces[f][0] == v || faces[f][1] == v || faces[f][2] == v)) return true;
    return false;
}

static brio_status add_part(brio_context *ctx, brio_parts_certificate *c, const division *d, size_t num_vertices,
                            size_t n, uint32_t part) {
    static double at[3 * MOST_VERTICES];
    static uint64_t index[MOST_VERTICES];
    static uint8_t shared[MOST_VERTICES];
    static uint32_t mine[MOST_FACES][3], row[MOST_VERTICES];
    brio_faces_part p = {.size = sizeof p, .points = at, .index = index, .faces = (const uint32_t(*)[3])mine};
    memset(row, 0xff, num_vertices * sizeof *row);
    p.shared = d->flags ? shared : NULL;
    for (size_t f = 0; f < n; f++) {
        if (d->part[f] != part) continue;
        for (int k = 0; k < 3; k++) {
            uint32_t v = faces[f][(k + (int)part) % 3];
            if (row[v] == UINT32_MAX) {
                row[v] = (uint32_t)p.num_vertices++;
                memcpy(at + 3 * row[v], points + 3 * v, 3 * sizeof *at);
                index[row[v]] = d->number[v];
                shared[row[v]] = is_shared(d, n, v, part) || (d->flags == 2 && v % 3 == 0);
            }
            mine[p.num_faces][k] = row[v];
        }
        p.num_faces++;
    }
    return brio_parts_certificate_add(ctx, c, &p);
}

static brio_status certify_parts(brio_context *ctx, const division *d, size_t num_vertices, size_t n, int sheets,
                                 brio_certificate *out, brio_parts_stats *stats) {
    brio_parts_options o = {.size = sizeof o, .scratch = folder, .sheets = sheets};
    brio_parts_certificate *c = NULL;
    o.buckets = 1 + d->parts * 5 % 7;
    for (int k = 0; k < 3; k++) { /* the box of the vertices that faces use, as brio_mesh_certificate takes it */
        o.low[k] = INFINITY, o.high[k] = -INFINITY;
        for (size_t i = 0; i < 3 * n; i++) {
            o.low[k] = fmin(o.low[k], points[3 * faces[i / 3][i % 3] + k]);
            o.high[k] = fmax(o.high[k], points[3 * faces[i / 3][i % 3] + k]);
        }
    }
    brio_status status = brio_parts_certificate_new(ctx, &o, &c);
    for (uint32_t part = 0; part < d->parts && status == BRIO_OK; part++)
        status = add_part(ctx, c, d, num_vertices, n, part);
    if (status == BRIO_OK) status = brio_parts_certificate_end(ctx, c, out, stats);
    brio_parts_certificate_free(c);
    return status;
}

static void compare(const brio_certificate *c, const brio_certificate *w, uint64_t seed) {
    EXPECT(c->closed == w->closed && c->manifold == w->manifold && c->oriented == w->oriented, "set %d: %d %d %d",
           (int)seed, c->closed, c->manifold, c->oriented);
    EXPECT(c->boundary_edges == w->boundary_edges && c->boundary_loops == w->boundary_loops,
           "set %d: %zu in %zu loops, not %zu in %zu", (int)seed, c->boundary_edges, c->boundary_loops,
           w->boundary_edges, w->boundary_loops);
    EXPECT(c->nonmanifold_edges == w->nonmanifold_edges && c->nonmanifold_vertices == w->nonmanifold_vertices &&
               c->flipped_edges == w->flipped_edges,
           "set %d: %zu %zu %zu, not %zu %zu %zu", (int)seed, c->nonmanifold_edges, c->nonmanifold_vertices,
           c->flipped_edges, w->nonmanifold_edges, w->nonmanifold_vertices, w->flipped_edges);
    EXPECT(c->components == w->components && c->genus == w->genus, "set %d: %zu of genus %d, not %zu of %d", (int)seed,
           c->components, (int)c->genus, w->components, (int)w->genus);
    for (size_t i = 0; i < c->components && i < w->components; i++)
        EXPECT(c->genera[i] == w->genera[i], "set %d, component %zu", (int)seed, i);
    EXPECT(fabs(c->area - w->area) <= 1e-12 * w->area && fabs(c->volume - w->volume) <= 1e-12 * (1 + w->area),
           "set %d: %.17g %.17g, not %.17g %.17g", (int)seed, c->area, c->volume, w->area, w->volume);
    EXPECT(c->self_intersections == -1);
}

static void random_parts_are_the_whole(void) {
    static division d;
    brio_context *ctx = new_context();
    for (uint64_t seed = 0; seed < (SHORT_TESTS ? 60 : 1000); seed++) {
        brio_rng rng = brio_rng_new(seed);
        brio_certificate whole = {0}, parts = {0};
        brio_parts_stats s = {.size = sizeof s};
        size_t num_vertices, n = random_surface(&rng, &num_vertices), used = 0;
        static uint8_t met[MOST_VERTICES];
        uniform_points(seed, num_vertices, points);
        divide(&rng, num_vertices, n, &d);
        brio_context_set_threads(ctx, 1 + (int)(seed % 3));
        brio_mesh *mesh = mesh_of(ctx, num_vertices, n);
        EXPECT(brio_mesh_certificate(ctx, mesh, &whole) == BRIO_OK);
        brio_mesh_free(mesh);
        EXPECT(certify_parts(ctx, &d, num_vertices, n, 0, &parts, &s) == BRIO_OK, "%s", brio_message(ctx));
        compare(&parts, &whole, seed);
        memset(met, 0, sizeof met);
        for (size_t i = 0; i < 3 * n; i++) met[faces[i / 3][i % 3]] = 1;
        for (size_t v = 0; v < num_vertices; v++) used += met[v];
        EXPECT(s.faces == n && s.vertices == used && s.split == 0, "set %d", (int)seed);
        brio_certificate_free(&whole);
        brio_certificate_free(&parts);
    }
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- solids --- */

/* The boundary of random tetrahedra of a triangulation, which touch in all ways. */
static size_t random_solid(brio_context *ctx, brio_rng *rng, size_t num_vertices, int kind) {
    brio_triangulation *t = NULL;
    size_t n = 0;
    double share = 0.1 + 0.8 * brio_rng_double(rng);
    if (kind == 0)
        uniform_points(brio_rng_next(rng), num_vertices, points);
    else
        integer_points(brio_rng_next(rng), num_vertices, kind == 1 ? 4 : 6, points);
    EXPECT(brio_delaunay(ctx, points, NULL, num_vertices, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    size_t count = brio_triangulation_stats(t)->tetrahedra;
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    uint8_t *inside = malloc(count + 1);
    for (size_t i = 0; i < count; i++) inside[i] = brio_rng_double(rng) < share;
    for (size_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 4 && inside[i]; k++) {
            static const uint8_t OUTWARDS[4][3] = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
            uint32_t other = tet[i].mate[k] / 4;
            if (other < count && inside[other]) continue;
            for (int c = 0; c < 3; c++) faces[n][c] = tet[i].vertex[OUTWARDS[k][c]];
            n++;
        }
    free(inside);
    brio_triangulation_free(t);
    return n;
}

/* Sheets were split one after the other, so that it took all faces to know how. */
static void sheets_of_parts_are_those_of_the_whole(void) {
    static division d;
    brio_context *ctx = new_context();
    size_t splits = 0;
    for (uint64_t seed = 0; seed < (SHORT_TESTS ? 60 : 1000); seed++) {
        brio_rng rng = brio_rng_new(seed);
        brio_certificate whole = {0}, parts = {0};
        brio_parts_stats s = {.size = sizeof s};
        size_t num_vertices = 8 + brio_rng_below(&rng, 150);
        size_t n = random_solid(ctx, &rng, num_vertices, (int)(seed % 3));
        if (!n) continue;
        divide(&rng, num_vertices, n, &d);
        brio_context_set_threads(ctx, 1 + (int)(seed % 3));
        brio_mesh *mesh = mesh_of(ctx, num_vertices, n);
        EXPECT(brio_mesh_split_sheets(ctx, mesh) == BRIO_OK && brio_mesh_certificate(ctx, mesh, &whole) == BRIO_OK);
        EXPECT(certify_parts(ctx, &d, num_vertices, n, 1, &parts, &s) == BRIO_OK, "%s", brio_message(ctx));
        compare(&parts, &whole, seed);
        EXPECT(parts.closed && parts.manifold && parts.oriented);
        EXPECT(s.vertices == mesh->num_vertices && s.faces == n, "set %d: %llu vertices, not %zu", (int)seed,
               (unsigned long long)s.vertices, mesh->num_vertices);
        splits += s.split;
        brio_mesh_free(mesh);
        brio_certificate_free(&whole);
        brio_certificate_free(&parts);
    }
    EXPECT(splits > 100, "%zu vertices are split", splits);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* --- sums --- */

/* Area and volume have the same bits for all parts, corners that are first, and threads. */
static void sums_do_not_depend_on_parts(void) {
    static division d;
    brio_context *ctx = new_context();
    brio_rng rng = brio_rng_new(3);
    double area = 0, volume = 0;
    size_t num_vertices = 300, n = random_solid(ctx, &rng, num_vertices, 0);
    divide(&rng, num_vertices, n, &d);
    for (int i = 0; i < 12; i++) {
        brio_certificate c = {0};
        d.parts = 1 + (uint32_t)i;
        for (size_t f = 0; f < n; f++) d.part[f] = (uint8_t)brio_rng_below(&rng, d.parts);
        brio_context_set_threads(ctx, 1 + i % 4);
        EXPECT(certify_parts(ctx, &d, num_vertices, n, 0, &c, NULL) == BRIO_OK);
        if (i == 0) area = c.area, volume = c.volume;
        EXPECT(c.area == area && c.volume == volume && volume > 0, "%.17g %.17g", c.area, c.volume);
        brio_certificate_free(&c);
    }
    brio_context_free(ctx);
}

/* --- failures --- */

static brio_status certify_tori(brio_context *ctx) {
    static division d;
    brio_certificate c = {0};
    size_t n = add_torus(0, 5, 6, 0);
    n += add_torus(29, 4, 4, n); /* they touch in a vertex */
    brio_rng rng = brio_rng_new(5);
    uniform_points(1, 45, points);
    divide(&rng, 45, n, &d);
    d.parts = 3;
    for (size_t f = 0; f < n; f++) d.part[f] %= 3;
    brio_status status = certify_parts(ctx, &d, 45, n - 2, 0, &c, NULL);
    brio_certificate_free(&c);
    return status;
}

static brio_status certify_solid(brio_context *ctx) {
    static division d;
    static const uint32_t solid[16][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3},
                                          {1, 0, 4}, {0, 1, 5}, {4, 0, 5}, {1, 4, 5}}; /* two tetrahedra at an edge */
    brio_certificate c = {0};
    brio_rng rng = brio_rng_new(5);
    const double at[18] = {0, 0, 0, 1, 0, 0, 0.5, 1, 0, 0.5, 1, 1, 0.5, -1, 0, 0.5, -1, -1};
    memcpy(points, at, sizeof at);
    memcpy(faces, solid, sizeof solid);
    divide(&rng, 6, 8, &d);
    d.parts = 2;
    for (size_t f = 0; f < 8; f++) d.part[f] = f % 2;
    brio_status status = certify_parts(ctx, &d, 6, 8, 1, &c, NULL);
    EXPECT(status != BRIO_OK || (c.components == 2 && c.genus == 0), "%zu components", c.components);
    brio_certificate_free(&c);
    return status;
}

static void no_memory_is_a_status(void) {
    expect_clean_failures(certify_tori);
    expect_clean_failures(certify_solid);
    EXPECT(files_left() == 0);
}

static int stop_late(const char *stage, double fraction, void *user) {
    int *calls = user;
    (void)stage, (void)fraction;
    return --*calls < 0;
}

static void cancelled_certificates_leave_nothing(void) {
    static division d;
    brio_status status = BRIO_ERR_CANCELLED;
    for (int calls = 0; calls < 100 && status != BRIO_OK; calls++) {
        brio_context *ctx = new_context();
        brio_certificate c = {0};
        brio_rng rng = brio_rng_new(5);
        int left = calls;
        size_t n = add_torus(0, 19, 20, 0);
        uniform_points(1, 380, points);
        divide(&rng, 380, n, &d);
        brio_context_set_progress(ctx, stop_late, &left);
        status = certify_parts(ctx, &d, 380, n, 0, &c, NULL);
        EXPECT(status == BRIO_ERR_CANCELLED || (status == BRIO_OK && left >= 0), "%s", brio_message(ctx));
        brio_certificate_free(&c);
        EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
    EXPECT(status == BRIO_OK);
}

static void a_full_disk_is_a_status(void) {
    static division d;
    brio_context *ctx = new_context();
    brio_certificate c = {0};
    brio_rng rng = brio_rng_new(5);
    struct rlimit old, little;
    size_t n = add_torus(0, 19, 20, 0);
    uniform_points(1, 380, points);
    divide(&rng, 380, n, &d);
    d.flags = 0;
    EXPECT(getrlimit(RLIMIT_FSIZE, &old) == 0);
    void (*before)(int) = signal(SIGXFSZ, SIG_IGN);
    for (rlim_t most = 16; most <= 2048; most *= 2) {
        little = (struct rlimit){most, old.rlim_max};
        EXPECT(setrlimit(RLIMIT_FSIZE, &little) == 0);
        brio_status status = certify_parts(ctx, &d, 380, n, 0, &c, NULL);
        EXPECT(setrlimit(RLIMIT_FSIZE, &old) == 0);
        EXPECT(status == BRIO_ERR_WRITE && strstr(brio_message(ctx), "brio-faces-"), "%s", brio_message(ctx));
        EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0 && !c.genera);
    }
    signal(SIGXFSZ, before);
    brio_context_free(ctx);
}

static void write_file(const char *path, const char *name) {
    char file[200];
    snprintf(file, sizeof file, "%s/%s", path, name);
    FILE *f = fopen(file, "w");
    EXPECT(f && fputs("half a face", f) >= 0 && fclose(f) == 0);
}

/* What a killed process left had a name that no later process took. */
static void the_files_of_a_killed_process_stayed(void) {
    brio_context *ctx = new_context();
    brio_parts_options o = {.size = sizeof o, .scratch = folder};
    brio_parts_certificate *c, *second;
    char left[128];
    for (int killed = 1; killed <= 2; killed++) {
        snprintf(left, sizeof left, "%s/brio-faces-%d", folder, killed);
        EXPECT(mkdir(left, 0700) == 0);
        write_file(left, "lock");
        write_file(left, "faces-77");
    }
    strcat(left, "/faces-77");
    EXPECT(brio_parts_certificate_new(ctx, &o, &c) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_parts_certificate_new(ctx, &o, &second) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(files_left() == 2, "%zu folders of two certificates", files_left());
    EXPECT(access(left, F_OK) != 0);
    brio_parts_certificate_free(c);
    brio_parts_certificate_free(second);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

/* What waits for the files of 256 buckets took 12 MB, whatever the limit was: a shape in tiles ended when its tiles had
 * been triangulated. */
static void little_memory_was_taken_by_what_waits(void) {
    brio_context *ctx = new_context();
    brio_parts_options o = {.size = sizeof o, .scratch = folder, .buckets = 256};
    brio_parts_certificate *c;
    brio_context_set_memory_limit(ctx, 8 << 20);
    EXPECT(brio_parts_certificate_new(ctx, &o, &c) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_context_memory(ctx) < 2 << 20, "%zu bytes", brio_context_memory(ctx));
    brio_parts_certificate_free(c);
    brio_context_free(ctx);
}

static void wrong_calls_are_refused(void) {
    brio_context *ctx = new_context(), *other = new_context();
    brio_parts_options o = {.size = sizeof o};
    brio_parts_certificate *c;
    brio_certificate out = {0};
    const double at[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, far[9] = {0, 0, 0, 1, 0, 0, 0, NAN, 0};
    const uint64_t index[3] = {5, 6, 7};
    const uint32_t good[2][3] = {{0, 1, 2}, {0, 1, 2}}, bad[1][3] = {{0, 1, 3}};
    brio_faces_part p = {sizeof p, 3, 1, at, index, NULL, good};
    EXPECT(brio_parts_certificate_new(ctx, &o, &c) == BRIO_ERR_ARGUMENT && !c);
    o.scratch = "/nowhere/at/all";
    EXPECT(brio_parts_certificate_new(ctx, &o, &c) == BRIO_ERR_OPEN && !c);
    o.scratch = folder, o.low[1] = 2;
    EXPECT(brio_parts_certificate_new(ctx, &o, &c) == BRIO_ERR_ARGUMENT && !c);
    o.low[1] = 0, o.buckets = 1 << 20;
    EXPECT(brio_parts_certificate_new(ctx, &o, &c) == BRIO_ERR_ARGUMENT && !c);
    o.buckets = 0;
    EXPECT(brio_parts_certificate_new(ctx, &o, &c) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_parts_certificate_add(other, c, &p) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_parts_certificate_end(other, c, &out, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_parts_certificate_end(ctx, c, &out, NULL) == BRIO_OK && !out.closed && out.manifold && !out.components);
    brio_certificate_free(&out);
    EXPECT(brio_parts_certificate_end(ctx, c, &out, NULL) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_parts_certificate_add(ctx, c, &p) == BRIO_ERR_ARGUMENT);
    brio_parts_certificate_free(c);
    for (int i = 0; i < 3; i++) { /* after a failure a part may be half counted */
        o.sheets = i == 2;
        EXPECT(brio_parts_certificate_new(ctx, &o, &c) == BRIO_OK);
        p.points = i == 1 ? far : at, p.faces = i == 0 ? bad : good, p.num_faces = i == 2 ? 2 : 1;
        brio_status status = brio_parts_certificate_add(ctx, c, &p);
        if (i == 2 && status == BRIO_OK) status = brio_parts_certificate_end(ctx, c, &out, NULL); /* no solid */
        EXPECT(status == (i == 1 ? BRIO_ERR_NOT_FINITE : BRIO_ERR_ARGUMENT), "%d: %s", i, brio_message(ctx));
        EXPECT(brio_parts_certificate_end(ctx, c, &out, NULL) == BRIO_ERR_ARGUMENT);
        brio_parts_certificate_free(c);
    }
    brio_parts_certificate_free(NULL);
    brio_certificate_free(&out);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    brio_context_free(other);
}

SUITE(test_parts_certificate) {
    snprintf(folder, sizeof folder, "/tmp/brio-test-parts-%ld", (long)getpid());
    EXPECT(mkdir(folder, 0700) == 0);
    RUN(random_parts_are_the_whole);
    RUN(sheets_of_parts_are_those_of_the_whole);
    RUN(sums_do_not_depend_on_parts);
    RUN(no_memory_is_a_status);
    RUN(cancelled_certificates_leave_nothing);
    RUN(a_full_disk_is_a_status);
    RUN(the_files_of_a_killed_process_stayed);
    RUN(little_memory_was_taken_by_what_waits);
    RUN(wrong_calls_are_refused);
    rmdir(folder);
    return harness_end();
}
