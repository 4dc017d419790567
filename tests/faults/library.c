/* fault_library [--most K]: faults at every point of calls of the library, in one process.
 *
 * For each call and each kind of fault, the fault comes at the first point, the second, and so on until the call meets none. A
 * call that meets one succeeds with the checksum of the call without, or returns the status of such a fault with a message.
 * Then the same call in the same context succeeds with that checksum. Afterwards nothing is left: no memory, no open file, no
 * file in the folder. Prints "points failures" and what failed. */
#define _GNU_SOURCE
#include "fault.h"
#include "../unit/points.h"
#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <unistd.h>

enum { N = 150, FOREVER = 1 << 30 };

static double cube[3 * N], sphere[3 * N], weights[N];
static char folder[64];
static size_t points, failures;

/* --- checksums --- */

static uint64_t mix(uint64_t sum, const void *bytes, size_t size) {
    const unsigned char *p = bytes;
    for (size_t i = 0; i < size; i++) sum = (sum ^ p[i]) * 0x100000001b3;
    return sum;
}

static uint64_t sum_of(const brio_mesh *m) {
    uint64_t sum = mix(0xcbf29ce484222325, m->vertices, 3 * m->num_vertices * sizeof *m->vertices);
    if (m->num_faces) sum = mix(sum, m->face_vertices, m->face_offsets[m->num_faces] * sizeof *m->face_vertices);
    return mix(sum, m->tetrahedra, 4 * m->num_tetrahedra * sizeof *m->tetrahedra);
}

/* --- calls --- */

typedef brio_status (*call_fn)(brio_context *ctx, uint64_t *sum);

#define TRY(call)                                                                                                      \
    do {                                                                                                               \
        status = (call);                                                                                               \
        if (status != BRIO_OK) goto done;                                                                              \
    } while (0)

static brio_status triangulate(brio_context *ctx, const double *w, uint64_t *sum) {
    brio_triangulation *t = NULL;
    brio_status status = BRIO_OK;
    TRY(brio_delaunay(ctx, cube, w, N, NULL, &t));
    TRY(brio_triangulation_check(ctx, t, cube, w, N));
    TRY(brio_triangulation_checksum(ctx, t, cube, sum));
done:
    brio_triangulation_free(t);
    return status;
}

static brio_status delaunay(brio_context *ctx, uint64_t *sum) {
    return triangulate(ctx, NULL, sum);
}

static brio_status regular(brio_context *ctx, uint64_t *sum) {
    return triangulate(ctx, weights, sum);
}

static brio_status in_scratch_files(brio_context *ctx, uint64_t *sum) {
    brio_status status = BRIO_OK;
    TRY(brio_context_set_scratch(ctx, folder));
    TRY(triangulate(ctx, weights, sum));
done:
    brio_context_set_scratch(ctx, NULL);
    return status;
}

static brio_status plane(brio_context *ctx, uint64_t *sum) {
    brio_triangulation2 *t = NULL;
    brio_diagram2 *d = NULL;
    brio_status status = BRIO_OK;
    TRY(brio_delaunay2(ctx, cube, NULL, N, NULL, &t));
    TRY(brio_voronoi2(ctx, t, cube, NULL, N, &d));
    TRY(brio_triangulation2_checksum(ctx, t, cube, sum));
done:
    brio_diagram2_free(d);
    brio_triangulation2_free(t);
    return status;
}

static brio_status locate(brio_context *ctx, uint64_t *sum) {
    brio_triangulation *t = NULL;
    brio_locator *l = NULL;
    brio_interpolation o = {0};
    brio_status status = BRIO_OK;
    uint32_t found[N];
    double values[N];
    o.values = weights;
    TRY(brio_delaunay(ctx, cube, NULL, N, NULL, &t));
    TRY(brio_locator_new(ctx, t, cube, NULL, N, &l));
    TRY(brio_locator_tetrahedra(ctx, l, sphere, N, found));
    TRY(brio_locator_interpolate(ctx, l, sphere, N, &o, values));
    *sum = mix(mix(1, found, sizeof found), values, sizeof values);
done:
    brio_locator_free(l);
    brio_triangulation_free(t);
    return status;
}

static brio_status take_mesh(brio_status status, brio_mesh *const *m, uint64_t *sum) {
    if (status == BRIO_OK) *sum = sum_of(*m);
    brio_mesh_free(*m);
    return status;
}

static brio_status labeled_delaunay(brio_context *ctx, uint64_t *sum) {
    brio_mesh *m = NULL;
    return take_mesh(brio_surface(ctx, sphere, N, &(brio_surface_options){.holes = BRIO_HOLES_CLOSED}, &m, NULL), &m,
                     sum);
}

static brio_status power_crust(brio_context *ctx, uint64_t *sum) {
    brio_mesh *m = NULL;
    return take_mesh(
        brio_surface(ctx, sphere, N, &(brio_surface_options){.method = BRIO_SURFACE_POWER_CRUST}, &m, NULL), &m, sum);
}

static brio_status cocone(brio_context *ctx, uint64_t *sum) {
    brio_mesh *m = NULL;
    return take_mesh(brio_surface(ctx, sphere, N, &(brio_surface_options){.method = BRIO_SURFACE_COCONE}, &m, NULL), &m,
                     sum);
}

static brio_status power_shape(brio_context *ctx, uint64_t *sum) {
    brio_mesh *m = NULL;
    return take_mesh(brio_power_shape(ctx, sphere, N, NULL, &m, NULL, NULL), &m, sum);
}

static brio_status offset_surface(brio_context *ctx, uint64_t *sum) {
    brio_mesh *m = NULL;
    return take_mesh(
        brio_surface(ctx, sphere, N, &(brio_surface_options){.method = BRIO_SURFACE_OFFSET, .distance = 0.1}, &m, NULL),
        &m, sum);
}

static brio_status hull_simplified(brio_context *ctx, uint64_t *sum) {
    brio_mesh *m = NULL;
    brio_mesh_simplify_options o = {0};
    brio_status status = BRIO_OK;
    o.target_faces = 60;
    TRY(brio_convex_hull(ctx, sphere, N, NULL, &m, NULL));
    TRY(brio_mesh_add_normals(m));
    TRY(brio_mesh_simplify(ctx, m, &o));
done:
    return take_mesh(status, &m, sum);
}

static brio_status alpha_shape(brio_context *ctx, uint64_t *sum) {
    brio_triangulation *t = NULL;
    brio_alpha_complex complex = {0};
    brio_mesh *m = NULL;
    brio_status status = BRIO_OK;
    double alpha;
    TRY(brio_delaunay(ctx, cube, NULL, N, NULL, &t));
    TRY(brio_alpha_values(ctx, t, cube, NULL, N, &complex));
    TRY(brio_alpha_auto(ctx, &complex, &alpha));
    TRY(brio_alpha_shape(ctx, cube, &complex, alpha, &m, NULL));
done:
    brio_alpha_complex_free(&complex);
    brio_triangulation_free(t);
    return take_mesh(status, &m, sum);
}

static brio_status cells(brio_context *ctx, uint64_t *sum) {
    brio_triangulation *t = NULL;
    brio_cells *c = NULL;
    brio_status status = BRIO_OK;
    TRY(brio_delaunay(ctx, cube, weights, N, NULL, &t));
    TRY(brio_voronoi_cells(ctx, t, cube, weights, N, NULL, &c));
    *sum = mix(1, &c->volume_sum, sizeof c->volume_sum);
done:
    brio_cells_free(c);
    brio_triangulation_free(t);
    return status;
}

static brio_status sampled(brio_context *ctx, uint64_t *sum) {
    brio_status status = BRIO_OK;
    uint8_t chosen[N], outlier[N];
    size_t count;
    TRY(brio_thin(ctx, cube, N, 0.2, chosen, &count));
    TRY(brio_outliers(ctx, cube, N, 8, NULL, outlier));
    *sum = mix(mix(1, chosen, N), outlier, N);
done:
    return status;
}

static const char *path_in(const char *name, char path[128]) {
    snprintf(path, 128, "%s/%s", folder, name);
    return path;
}

/* Writes a mesh, reads it, converts it, and removes both files. */
static brio_status files(brio_context *ctx, const char *extension, uint64_t *sum) {
    char first[16], a[128], b[128];
    brio_mesh *m = NULL, *again = NULL;
    brio_status status = BRIO_OK;
    snprintf(first, sizeof first, "a.%s", extension);
    path_in(first, a), path_in("b.npy", b);
    TRY(brio_convex_hull(ctx, sphere, N, NULL, &m, NULL));
    TRY(brio_write(ctx, a, m, NULL));
    TRY(brio_read(ctx, a, NULL, &again));
    TRY(brio_convert(ctx, a, b, NULL, NULL));
done:
    brio_mesh_free(m);
    unlink(a), unlink(b);
    return take_mesh(status, &again, sum);
}

#define FILES(name)                                                                                                    \
    static brio_status files_##name(brio_context *ctx, uint64_t *sum) {                                                \
        return files(ctx, #name, sum);                                                                                 \
    }
FILES(ply)
FILES(obj)
FILES(off)
FILES(stl)
FILES(vtu)
FILES(vtp)
#undef FILES

typedef struct {
    const char *name;
    call_fn call;
} row;

#define ROW(call)                                                                                                      \
    { #call, call }
static const row rows[] = {ROW(delaunay),         ROW(regular),         ROW(plane),       ROW(locate),
                           ROW(labeled_delaunay), ROW(power_crust),     ROW(cocone),      ROW(power_shape),
                           ROW(offset_surface),   ROW(hull_simplified), ROW(alpha_shape), ROW(cells),
                           ROW(sampled),          ROW(files_ply),       ROW(files_obj),   ROW(files_off),
                           ROW(files_stl),        ROW(files_vtu),       ROW(files_vtp),   ROW(in_scratch_files)};

enum { ROWS = sizeof rows / sizeof *rows };

/* --- faults --- */

typedef struct {
    const char *name;
    int kind, detail, span;
} fault_row;

static const fault_row kinds[] = {{"memory", FAULT_MEMORY, 0, 1},
                                  {"memory from then on", FAULT_MEMORY, 0, FOREVER},
                                  {"mapping", FAULT_ERROR, FAULT_MAP, 1},
                                  {"mappings from then on", FAULT_ERROR, FAULT_MAP, FOREVER},
                                  {"open", FAULT_ERROR, FAULT_OPEN, 1},
                                  {"read", FAULT_ERROR, FAULT_READ, 1},
                                  {"write", FAULT_ERROR, FAULT_WRITE, 1},
                                  {"full disk", FAULT_ERROR, FAULT_WRITE, FOREVER},
                                  {"another call", FAULT_ERROR, FAULT_OTHER, 1},
                                  {"short", FAULT_SHORT, 0, 1},
                                  {"EINTR", FAULT_INTERRUPT, 0, 1}};

enum { KINDS = sizeof kinds / sizeof *kinds };

static void arm(const fault_row *f, int64_t k) {
    fault->detail = f->detail, fault->k = k, fault->last = k + f->span - 1;
    fault->count = 0, fault->struck = 0, fault->call = -1, fault->path[0] = 0;
    fault->kind = f->kind;
}

static size_t entries(const char *path) {
    DIR *d = opendir(path);
    size_t n = 0;
    while (d && readdir(d)) n++;
    if (d) closedir(d);
    return n;
}

/* What is left when a context is gone. */
typedef struct {
    int64_t live;
    size_t files, open;
} left;

static left what_is_left(void) {
    left l = {.files = entries(folder), .open = entries("/proc/self/fd")};
    l.live = fault->live;
    return l;
}

static void failed(const row *r, const fault_row *f, int64_t k, const char *what) {
    failures++;
    printf("FAILED %s, %s, k = %lld, call %lld of %s: %s\n", r->name, f->name, (long long)k, (long long)fault->call,
           fault->path, what);
}

static bool is_refusal(brio_status status) {
    return status == BRIO_ERR_NO_MEMORY || status == BRIO_ERR_OPEN || status == BRIO_ERR_WRITE;
}

/* One fault; false when the call met none. */
static bool try_point(const row *r, const fault_row *f, int64_t k, uint64_t expected) {
    left before = what_is_left();
    brio_context *ctx = NULL;
    uint64_t sum = 0, again = 0;
    arm(f, k);
    brio_status status = brio_context_new(NULL, &ctx);
    if (status == BRIO_OK) brio_context_set_threads(ctx, 1), status = r->call(ctx, &sum);
    fault->kind = FAULT_NONE;
    bool struck = fault->struck > 0;
    if (status == BRIO_OK && sum != expected) failed(r, f, k, "another result");
    if (status != BRIO_OK && !is_refusal(status)) failed(r, f, k, brio_status_string(status));
    if (status != BRIO_OK && ctx && !brio_message(ctx)[0]) failed(r, f, k, "no message");
    if (ctx && (r->call(ctx, &again) != BRIO_OK || again != expected)) failed(r, f, k, "the next call fails");
    brio_context_free(ctx);
    left after = what_is_left();
    if (after.live != before.live) failed(r, f, k, "memory stays");
    if (after.open != before.open) failed(r, f, k, "a file stays open");
    if (after.files != before.files) failed(r, f, k, "a file stays");
    points += struck;
    return struck;
}

static void try_row(const row *r, int64_t most) {
    uint64_t expected = 0;
    brio_context *ctx = NULL;
    if (brio_context_new(NULL, &ctx) != BRIO_OK || r->call(ctx, &expected) != BRIO_OK)
        failed(r, &kinds[0], 0, ctx ? brio_message(ctx) : "no context");
    brio_context_free(ctx);
    for (int i = 0; i < KINDS; i++)
        for (int64_t k = 1; k <= most && try_point(r, &kinds[i], k, expected); k++) {}
}

int main(int argc, char **argv) {
    int64_t most = argc == 3 && !strcmp(argv[1], "--most") ? atoll(argv[2]) : FOREVER;
    setvbuf(stdout, NULL, _IOLBF, 0);
    snprintf(folder, sizeof folder, "%s/brio-faults-XXXXXX", access("/dev/shm", W_OK) ? "/tmp" : "/dev/shm");
    if (!mkdtemp(folder)) return 2;
    if (!fault_see_calls()) {
        printf("skipped: calls of the system cannot be seen here\n");
        rmdir(folder);
        return 77;
    }
    uniform_points(1, N, cube);
    sphere_points(2, N, sphere);
    for (int i = 0; i < N; i++) weights[i] = i % 5 * 0.001;
    for (int i = 0; i < ROWS; i++) {
        size_t before = points;
        try_row(&rows[i], most);
        printf("%6zu points: %s\n", points - before, rows[i].name);
    }
    rmdir(folder);
    printf("%zu points, %zu failures\n", points, failures);
    return failures ? 1 : 0;
}
