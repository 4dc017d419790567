/* Alpha shapes of tiles: the faces, counts and certificates of one process, whatever the points and the number of
 * tiles. */
#include "base/rng.h"
#include "brio/tiles.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include <dirent.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { MOST = 4000, MOST_FACES = 60000, KINDS = 9 };

static double points[3 * MOST], weights[MOST];
static char folder[64];

static size_t files_left(void) {
    DIR *d = opendir(folder);
    size_t n = 0;
    for (struct dirent *e; d && (e = readdir(d)) != NULL;) n += e->d_name[0] != '.';
    if (d) closedir(d);
    return n;
}

/* Fills n points of a kind: uniform, clusters, a sphere, a lattice of few places, a grid, a plane with some above,
 * duplicates, two grids apart, a thick shell. */
static size_t make_points(uint64_t seed, size_t n, int kind) {
    brio_rng rng = brio_rng_new(seed);
    size_t side = (size_t)cbrt((double)n);
    switch (kind) {
    case 0:
        uniform_points(seed, n, points);
        break;
    case 1:
        clustered_points(seed, n, points);
        break;
    case 2:
        sphere_points(seed, n, points);
        break;
    case 3:
        integer_points(seed, n, 7, points);
        break;
    case 4:
        n = side * side * side;
        for (size_t i = 0; i < n; i++)
            for (size_t k = 0, at = i; k < 3; k++, at /= side) points[3 * i + k] = (double)(at % side);
        break;
    case 5:
        integer_points(seed, n, 30, points);
        for (size_t i = 0; i < n; i++)
            if (i % 9) points[3 * i + 2] = 3;
        break;
    case 6:
        uniform_points(seed, n, points);
        for (size_t i = 1; i < n; i++)
            if (i % 3 == 0) memcpy(points + 3 * i, points + 3 * brio_rng_below(&rng, (uint32_t)i), 3 * sizeof *points);
        break;
    case 7:
        integer_points(seed, n, 5, points);
        for (size_t i = 0; i < n; i += 2) points[3 * i] += 40;
        break;
    default:
        sphere_points(seed, n, points);
        for (size_t i = 0; i < 3 * n; i++) points[i] *= 1 + 0.3 * brio_rng_double(&rng);
    }
    return n;
}

/* --- one process --- */

typedef struct {
    brio_alpha_complex complex;
    brio_alpha_shape_stats stats;
    brio_certificate certificate;
    size_t vertices, num_faces;
    uint32_t (*face)[3]; /* by the indices of points, sorted */
    brio_status status;
} whole_shape;

static int compare_faces(const void *a, const void *b) {
    const uint32_t *x = a, *y = b;
    for (int k = 0; k < 3; k++)
        if (x[k] != y[k]) return x[k] < y[k] ? -1 : 1;
    return 0;
}

static void turn(uint32_t *v) {
    while (v[0] > v[1] || v[0] > v[2]) {
        uint32_t first = v[0];
        v[0] = v[1], v[1] = v[2], v[2] = first;
    }
}

/* Returns the point at a position that is a vertex of the complex. */
static uint32_t point_at(const brio_alpha_complex *c, const double *p) {
    for (size_t i = 0; i < c->counts[0]; i++)
        if (!memcmp(points + 3 * c->simplices[0][i], p, 3 * sizeof *p)) return c->simplices[0][i];
    return UINT32_MAX;
}

static void shape_of_whole(brio_context *ctx, size_t n, bool weighted, const brio_alpha_complex *complex, double alpha,
                           whole_shape *w) {
    brio_mesh *mesh = NULL;
    memset(&w->stats, 0, sizeof w->stats);
    w->num_faces = 0;
    w->status = brio_alpha_shape(ctx, points, complex, alpha, &mesh, &w->stats);
    (void)n, (void)weighted;
    if (w->status != BRIO_OK) return;
    EXPECT(brio_mesh_certificate(ctx, mesh, &w->certificate) == BRIO_OK);
    uint32_t *point = malloc((mesh->num_vertices + 1) * sizeof *point);
    for (size_t v = 0; v < mesh->num_vertices; v++) point[v] = point_at(complex, mesh->vertices + 3 * v);
    w->vertices = mesh->num_vertices;
    w->num_faces = mesh->num_faces;
    w->face = malloc((mesh->num_faces + 1) * sizeof *w->face);
    for (size_t f = 0; f < mesh->num_faces; f++) {
        for (int k = 0; k < 3; k++) w->face[f][k] = point[mesh->face_vertices[3 * f + (size_t)k]];
        turn(w->face[f]);
    }
    qsort(w->face, w->num_faces, sizeof *w->face, compare_faces);
    free(point);
    brio_mesh_free(mesh);
}

/* --- tiles --- */

typedef struct {
    brio_context *ctx;
    brio_parts_certificate *certificate;
    uint32_t (*face)[3];
    size_t count;
    int64_t last; /* tile */
} collected;

static int take(const brio_faces_part *part, uint32_t tile, void *user) {
    collected *c = user;
    EXPECT((int64_t)tile > c->last && part->num_faces > 0);
    c->last = tile;
    for (size_t f = 0; f < part->num_faces; f++, c->count++) {
        for (int k = 0; k < 3; k++) c->face[c->count][k] = (uint32_t)part->index[part->faces[f][k]];
        turn(c->face[c->count]);
        for (int k = 0; k < 3; k++)
            EXPECT(!memcmp(part->points + 3 * part->faces[f][k], points + 3 * part->index[part->faces[f][k]], 24));
    }
    return brio_parts_certificate_add(c->ctx, c->certificate, part) != BRIO_OK;
}

static brio_tiles *tiles_of(brio_context *ctx, uint32_t tiles, size_t n, bool weighted) {
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = tiles, .stars = 2};
    brio_tiles *t = NULL;
    brio_status status = brio_tiles_new(ctx, &o, &t);
    for (size_t i = 0; status == BRIO_OK && i < n; i += 777)
        status = brio_tiles_add(ctx, t, points + 3 * i, weighted ? weights + i : NULL, n - i < 777 ? n - i : 777);
    if (status == BRIO_OK) status = brio_tiles_run(ctx, t);
    if (status == BRIO_OK) return t;
    brio_tiles_free(t);
    return NULL;
}

static brio_parts_certificate *certificate_of(brio_context *ctx, size_t n) {
    brio_parts_options o = {.size = sizeof o, .scratch = folder, .sheets = 1, .buckets = 5};
    brio_parts_certificate *c = NULL;
    for (int k = 0; k < 3; k++) o.low[k] = INFINITY, o.high[k] = -INFINITY;
    for (size_t i = 0; i < 3 * n; i++) {
        o.low[i % 3] = fmin(o.low[i % 3], points[i]);
        o.high[i % 3] = fmax(o.high[i % 3], points[i]);
    }
    EXPECT(brio_parts_certificate_new(ctx, &o, &c) == BRIO_OK, "%s", brio_message(ctx));
    return c;
}

static void compare(brio_context *ctx, brio_tiles *t, size_t n, double alpha, const whole_shape *w, const char *what) {
    static uint32_t faces[MOST_FACES][3];
    brio_tiles_alpha_stats s = {.size = sizeof s};
    brio_parts_stats p = {.size = sizeof p};
    brio_certificate certificate = {0};
    collected c = {ctx, certificate_of(ctx, n), faces, 0, -1};
    brio_status status = brio_tiles_alpha(ctx, t, alpha, take, &c, &s);
    const brio_alpha_shape_stats *e = &w->stats;
    EXPECT(status == w->status, "%s: %s, not %s", what, brio_status_string(status), brio_status_string(w->status));
    EXPECT(s.tetrahedra == e->tetrahedra && s.uncovered == e->uncovered &&
               s.singular_vertices == e->singular_vertices && s.singular_edges == e->singular_edges &&
               s.singular_facets == e->singular_facets,
           "%s, alpha %.17g: %d tetrahedra, %d, %d and %d singular, not %zu, %zu, %zu and %zu", what, alpha,
           (int)s.tetrahedra, (int)s.singular_vertices, (int)s.singular_edges, (int)s.singular_facets, e->tetrahedra,
           e->singular_vertices, e->singular_edges, e->singular_facets);
    for (int k = 0; k < 4; k++) EXPECT(s.counts[k] == w->complex.counts[k], "%s: dimension %d", what, k);
    if (status == BRIO_OK) {
        qsort(faces, c.count, sizeof *faces, compare_faces);
        EXPECT(c.count == w->num_faces && s.faces == c.count && !memcmp(faces, w->face, c.count * sizeof *faces),
               "%s: %zu faces, not %zu", what, c.count, w->num_faces);
        EXPECT(brio_parts_certificate_end(ctx, c.certificate, &certificate, &p) == BRIO_OK, "%s", brio_message(ctx));
        const brio_certificate *one = &w->certificate;
        EXPECT(certificate.closed && certificate.manifold && certificate.oriented && p.vertices == w->vertices &&
                   p.split == e->split && certificate.components == one->components && certificate.genus == one->genus,
               "%s, alpha %.17g: %d vertices, %d split, %zu components of genus %d, not %zu, %zu, %zu, %d", what, alpha,
               (int)p.vertices, (int)p.split, certificate.components, (int)certificate.genus, w->vertices, e->split,
               one->components, (int)one->genus);
        for (size_t i = 0; i < one->components && i < certificate.components; i++)
            EXPECT(certificate.genera[i] == one->genera[i], "%s", what);
        EXPECT(fabs(certificate.area - one->area) <= 1e-12 * one->area &&
                   fabs(certificate.volume - one->volume) <= 1e-12 * (one->volume + one->area),
               "%s: %.17g %.17g, not %.17g %.17g", what, certificate.area, certificate.volume, one->area, one->volume);
    }
    brio_certificate_free(&certificate);
    brio_parts_certificate_free(c.certificate);
}

/* Compares the shapes of some alphas, most of them exactly the values of simplices. */
static void compare_once(uint64_t seed, size_t n, int kind, bool weighted, uint32_t tiles) {
    brio_context *ctx = new_context();
    brio_rng rng = brio_rng_new(seed);
    brio_triangulation *t = NULL;
    whole_shape w = {0};
    char what[80];
    brio_context_set_threads(ctx, 1 + (int)(seed % 3));
    n = make_points(seed, n, kind);
    if (weighted) integer_weights(seed, n, kind == 3 || kind == 4 ? 5 : 2, weights);
    for (size_t i = 0; i < n; i++) weights[i] *= kind % 2 ? 1 : 0.01;
    snprintf(what, sizeof what, "seed %d, kind %d, %zu points, %u tiles%s", (int)seed, kind, n, tiles,
             weighted ? ", weights" : "");
    EXPECT(brio_delaunay(ctx, points, weighted ? weights : NULL, n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    brio_status status = brio_alpha_values(ctx, t, points, weighted ? weights : NULL, n, &w.complex);
    brio_tiles *in_tiles = tiles_of(ctx, tiles, n, weighted);
    for (int i = 0; i < 3 && status == BRIO_OK && in_tiles; i++) {
        int k = i == 0 ? 3 : (int)brio_rng_below(&rng, 4);
        double alpha = w.complex.values[k][brio_rng_below(&rng, (uint32_t)w.complex.counts[k])];
        if (i == 2) alpha *= 1.1;
        shape_of_whole(ctx, n, weighted, &w.complex, alpha, &w);
        compare(ctx, in_tiles, n, alpha, &w, what);
        brio_certificate_free(&w.certificate);
        free(w.face);
        w.face = NULL;
    }
    EXPECT((in_tiles != NULL) == (status == BRIO_OK) || !weighted, "%s: %s", what, brio_message(ctx));
    brio_alpha_complex_free(&w.complex);
    brio_triangulation_free(t);
    brio_tiles_free(in_tiles);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0, "%s", what);
    brio_context_free(ctx);
}

static void small_sets(void) {
    for (uint64_t seed = 0; seed < (SHORT_TESTS ? 60 : 1000); seed++) {
        brio_rng rng = brio_rng_new(seed);
        size_t n = 8 + brio_rng_below(&rng, seed % 5 ? 60 : 400);
        uint32_t tiles = 1 + brio_rng_below(&rng, 12);
        compare_once(seed, n, (int)(seed % KINDS), seed / KINDS % 2, tiles);
    }
}

static void larger_sets(void) {
    for (int kind = 0; kind < KINDS; kind++)
        if (kind != 2) compare_once(40 + (uint64_t)kind, SHORT_TESTS ? 1000 : MOST, kind, kind % 2, kind < 3 ? 64 : 5);
}

/* --- calls --- */

static int refuse(const brio_faces_part *part, uint32_t tile, void *user) {
    (void)part, (void)tile, (void)user;
    return 1;
}

static void wrong_calls_are_refused(void) {
    brio_context *ctx = new_context(), *other = new_context();
    size_t n = make_points(1, 300, 0);
    brio_tiles_alpha_stats s = {.size = sizeof s};
    brio_tiles *t = tiles_of(ctx, 2, n, false), *none = NULL;
    brio_tiles_options o = {.size = sizeof o, .scratch = folder, .tiles = 2};
    EXPECT(brio_tiles_alpha(other, t, 1, NULL, NULL, &s) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_tiles_alpha(ctx, t, NAN, NULL, NULL, &s) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_tiles_alpha(ctx, t, 1, refuse, NULL, &s) == BRIO_ERR_CANCELLED);
    EXPECT(brio_tiles_alpha(ctx, t, -1, NULL, NULL, &s) == BRIO_ERR_NO_ANSWER);
    EXPECT(brio_tiles_alpha(ctx, t, 1, NULL, NULL, NULL) == BRIO_OK);
    s.size = 3;
    EXPECT(brio_tiles_alpha(ctx, t, 1, NULL, NULL, &s) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_tiles_new(ctx, &o, &none) == BRIO_OK && brio_tiles_add(ctx, none, points, NULL, n) == BRIO_OK);
    EXPECT(brio_tiles_alpha(ctx, none, 1, NULL, NULL, NULL) == BRIO_ERR_ARGUMENT); /* not triangulated */
    EXPECT(brio_tiles_run(ctx, none) == BRIO_OK);
    EXPECT(brio_tiles_alpha(ctx, none, 1, NULL, NULL, NULL) == BRIO_ERR_ARGUMENT); /* without stars */
    brio_tiles_free(none);
    brio_tiles_free(t);
    for (size_t i = 0; i < n; i++) points[3 * i] = 0;
    t = tiles_of(ctx, 2, n, false);
    EXPECT(brio_tiles_alpha(ctx, t, 1, NULL, NULL, NULL) == BRIO_ERR_NO_ANSWER, "%s", brio_message(ctx));
    brio_tiles_free(t);
    EXPECT(files_left() == 0 && brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    brio_context_free(other);
}

/* Squared radii of points this near each other have few bits or none. */
static void tiny_points_are_refused(void) {
    brio_context *ctx = new_context();
    size_t n = make_points(1, 100, 0);
    for (size_t i = 0; i < 3 * n; i++) points[i] *= 0x1p-530;
    brio_tiles *t = tiles_of(ctx, 2, n, false);
    EXPECT(brio_tiles_alpha(ctx, t, 0, NULL, NULL, NULL) == BRIO_ERR_NO_ANSWER, "%s", brio_message(ctx));
    brio_tiles_free(t);
    brio_context_free(ctx);
}

static brio_status make_a_shape(brio_context *ctx) {
    size_t n = make_points(3, 60, 3);
    brio_tiles *t = tiles_of(ctx, 2, n, false);
    brio_status status = t ? brio_tiles_alpha(ctx, t, 2, NULL, NULL, NULL) : BRIO_ERR_NO_MEMORY;
    brio_tiles_free(t);
    return status;
}

static int ignore(const brio_faces_part *part, uint32_t tile, void *user) {
    (void)tile;
    *(size_t *)user += part->num_faces;
    return 0;
}

static void no_memory_is_a_status(void) {
    failing_memory memory = {0, 0};
    brio_allocator allocator = {failing_alloc, failing_realloc, failing_free, &memory};
    brio_context *ctx;
    brio_status status = BRIO_ERR_NO_MEMORY;
    EXPECT(brio_context_new(&allocator, &ctx) == BRIO_OK);
    brio_context_set_threads(ctx, 1);
    brio_tiles *t = tiles_of(ctx, 2, make_points(3, 60, 3), false);
    size_t bytes = brio_context_memory(ctx), faces = 0;
    for (size_t k = 1; k < 500 && status != BRIO_OK; k++) {
        memory.left = k;
        status = brio_tiles_alpha(ctx, t, 2, ignore, &faces, NULL);
        EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_MEMORY, "request %zu: %s", k, brio_message(ctx));
        EXPECT(brio_context_memory(ctx) == bytes, "request %zu", k);
    }
    memory.left = 0;
    EXPECT(status == BRIO_OK && make_a_shape(ctx) == BRIO_OK);
    brio_tiles_free(t);
    brio_context_free(ctx);
}

static int stop_late(const char *stage, double fraction, void *user) {
    int *calls = user;
    (void)stage, (void)fraction;
    return --*calls < 0;
}

static void cancelled_shapes_leave_nothing(void) {
    brio_context *ctx = new_context();
    brio_tiles *t = tiles_of(ctx, 3, make_points(3, 1500, 0), false);
    brio_status status = BRIO_ERR_CANCELLED;
    size_t bytes = brio_context_memory(ctx), faces = 0;
    for (int calls = 0; calls < 400 && status != BRIO_OK; calls += 1 + calls / 4) {
        int left = calls;
        brio_context_set_progress(ctx, stop_late, &left);
        status = brio_tiles_alpha(ctx, t, 0.01, ignore, &faces, NULL);
        EXPECT(status == BRIO_ERR_CANCELLED || status == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_context_memory(ctx) == bytes);
    }
    EXPECT(status == BRIO_OK);
    brio_context_set_progress(ctx, NULL, NULL);
    brio_tiles_free(t);
    EXPECT(files_left() == 0);
    brio_context_free(ctx);
}

SUITE(test_tiles_alpha) {
    snprintf(folder, sizeof folder, "/tmp/brio-test-tiles-alpha-%ld", (long)getpid());
    EXPECT(mkdir(folder, 0700) == 0);
    RUN(small_sets);
    RUN(larger_sets);
    RUN(wrong_calls_are_refused);
    RUN(tiny_points_are_refused);
    RUN(no_memory_is_a_status);
    RUN(cancelled_shapes_leave_nothing);
    rmdir(folder);
    return harness_end();
}
