/* Many calls of the library in one process, for a long time: memory and open files do not grow.
 *
 * soak MINUTES [BOUND]: prints every half minute, and ten times in short runs, the rounds done, the resident memory and the open
 * files. Fails when after the warm-up, a fifth of the time, memory has grown by more than BOUND MiB (default 16), or a file more
 * is open. A round triangulates, queries, reconstructs, writes, reads, makes cells and hulls, by one and by several threads, and
 * fails in all these: cancelled, out of memory, with input that is refused. */
#include "brio/brio.h"
#include <dirent.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { POINTS = 1500, QUERIES = 500, WAYS = 4 };

typedef struct {
    uint64_t random;
    char folder[64], file[96];
    size_t rounds, failures; /* failures: calls that did not succeed, as most ways want it */
    int left;                /* reports of progress until the call is cancelled; negative: never */
} soak;

static double number(soak *s) {
    s->random = s->random * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (double)(s->random >> 11) * 0x1p-53;
}

/* Points on a torus. */
static void draw(soak *s, double *points, size_t n) {
    for (size_t i = 0; i < n; i++) {
        double a = 2 * number(s) - 1, b = 2 * number(s) - 1, c = a * a + b * b, d = 2 * number(s) - 1,
               e = 2 * number(s) - 1, f = d * d + e * e;
        double cosine = (a * a - b * b) / c, sine = 2 * a * b / c, r = 1 + 0.4 * (d * d - e * e) / f;
        points[3 * i] = r * cosine;
        points[3 * i + 1] = r * sine;
        points[3 * i + 2] = 0.4 * 2 * d * e / f;
    }
}

static int progress(const char *stage, double fraction, void *user) {
    soak *s = user;
    (void)stage;
    (void)fraction;
    return s->left >= 0 && s->left-- == 0;
}

static void count(soak *s, brio_status status) {
    s->failures += status != BRIO_OK;
    if (status == BRIO_ERR_INTERNAL) abort();
}

static void triangulate(soak *s, brio_context *ctx, const double *points, const double *queries) {
    static uint32_t found[QUERIES];
    brio_triangulation *t = NULL;
    brio_locator *locator = NULL;
    brio_cells *cells = NULL;
    brio_alpha_complex complex = {0};
    brio_status status = brio_delaunay(ctx, points, NULL, POINTS, NULL, &t);
    count(s, status);
    if (status == BRIO_OK) {
        count(s, brio_triangulation_check(ctx, t, points, NULL, POINTS));
        status = brio_locator_new(ctx, t, points, NULL, POINTS, &locator);
        count(s, status);
        if (status == BRIO_OK) count(s, brio_locator_tetrahedra(ctx, locator, queries, QUERIES, found));
        if (status == BRIO_OK) count(s, brio_locator_nearest(ctx, locator, queries, QUERIES, 1, found));
        count(s, brio_voronoi_cells(ctx, t, points, NULL, POINTS, NULL, &cells));
        status = brio_alpha_values(ctx, t, points, NULL, POINTS, &complex);
        count(s, status);
        if (status == BRIO_OK) brio_alpha_complex_free(&complex);
    }
    brio_locator_free(locator);
    brio_cells_free(cells);
    brio_triangulation_free(t);
}

static void write_and_read(soak *s, brio_context *ctx, const brio_mesh *mesh) {
    static const char *const extensions[] = {"ply", "obj", "off", "stl", "vtp", "las", "npy", "xyz"};
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++) {
        brio_mesh *read = NULL;
        snprintf(s->file, sizeof s->file, "%s/soak.%s", s->folder, extensions[i]);
        count(s, brio_write(ctx, s->file, mesh, NULL));
        count(s, brio_read(ctx, s->file, NULL, &read));
        brio_mesh_free(read);
    }
}

static void reconstruct(soak *s, brio_context *ctx, const double *points) {
    brio_mesh *mesh = NULL;
    brio_certificate certificate = {0};
    brio_status status = brio_surface(ctx, points, POINTS, NULL, &mesh, NULL);
    count(s, status);
    if (status == BRIO_OK) {
        status = brio_mesh_certificate(ctx, mesh, &certificate);
        count(s, status);
        if (status == BRIO_OK) brio_certificate_free(&certificate);
        write_and_read(s, ctx, mesh);
        count(s, brio_mesh_simplify(ctx, mesh, NULL));
    }
    brio_mesh_free(mesh);
    mesh = NULL;
    count(s, brio_surface(ctx, points, POINTS / 4, &(brio_surface_options){.method = BRIO_SURFACE_POWER_CRUST}, &mesh,
                          NULL));
    brio_mesh_free(mesh);
    mesh = NULL;
    count(s, brio_surface(ctx, points, POINTS, &(brio_surface_options){.method = BRIO_SURFACE_COCONE}, &mesh, NULL));
    brio_mesh_free(mesh);
    mesh = NULL;
    count(s, brio_convex_hull(ctx, points, POINTS, NULL, &mesh, NULL));
    brio_mesh_free(mesh);
}

/* The ways: as it should be; cancelled; in little memory; with a point that is no number, and scratch files. */
static int one_round(soak *s) {
    static double points[3 * POINTS], queries[3 * QUERIES];
    brio_context *ctx = NULL;
    int way = (int)(s->rounds % WAYS);
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return 1;
    brio_context_set_threads(ctx, 1 + (int)(s->rounds / WAYS % 4));
    draw(s, points, POINTS);
    draw(s, queries, QUERIES);
    s->left = way == 1 ? (int)(40 * number(s)) : -1;
    brio_context_set_progress(ctx, progress, s);
    if (way == 2) brio_context_set_memory_limit(ctx, (size_t)(4e6 * number(s)));
    if (way == 3) points[(size_t)(3 * POINTS * number(s))] = NAN;
    if (way == 3 && s->rounds % 8 == 3) count(s, brio_context_set_scratch(ctx, s->folder)), points[0] = 0;
    triangulate(s, ctx, points, queries);
    reconstruct(s, ctx, points);
    brio_context_set_scratch(ctx, NULL); /* whose name is the context's */
    size_t left = brio_context_memory(ctx);
    brio_context_free(ctx);
    s->rounds++;
    if (left) fprintf(stderr, "round %zu: %zu bytes are not freed\n", s->rounds, left);
    return left != 0;
}

static double resident_mib(void) {
    unsigned long all = 0, resident = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (!f) return 0;
    int got = fscanf(f, "%lu %lu", &all, &resident);
    fclose(f);
    return got == 2 ? (double)resident * (double)sysconf(_SC_PAGESIZE) / 0x1p20 : 0;
}

static int open_files(void) {
    int files = -1; /* the folder itself is one of them */
    DIR *folder = opendir("/proc/self/fd");
    if (!folder) return 0;
    for (struct dirent *entry; (entry = readdir(folder));) files += entry->d_name[0] != '.';
    closedir(folder);
    return files;
}

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

/* Returns whether nothing grew. */
static int run(soak *s, double duration, double bound) {
    double start = seconds(), every = duration / 10 < 30 ? duration / 10 : 30, due = 0, warm = 0, most = 0;
    int files = -1, status = 0;
    for (double now = 0; now < duration && !status; now = seconds() - start) {
        status = one_round(s);
        double mib = resident_mib();
        if (now < duration / 5) {
            warm = mib > warm ? mib : warm;
            files = open_files();
        }
        most = mib > most ? mib : most;
        if (now < due) continue;
        due += every;
        printf("%8.0f s %8zu rounds %8zu calls failed %8.1f MiB %4d files\n", now, s->rounds, s->failures, mib,
               open_files());
        fflush(stdout);
    }
    printf("warm %.1f MiB, most %.1f MiB, %d files, at last %d\n", warm, most, files, open_files());
    return !status && most <= warm + bound && open_files() <= files;
}

int main(int argc, char **argv) {
    soak s = {.random = 1, .folder = "/tmp/brio-soak-XXXXXX"};
    double minutes = argc > 1 ? atof(argv[1]) : 1, bound = argc > 2 ? atof(argv[2]) : 16;
    if (!mkdtemp(s.folder)) return 2;
    int fine = run(&s, 60 * minutes, bound);
    DIR *folder = opendir(s.folder);
    for (struct dirent *entry; folder && (entry = readdir(folder));) {
        snprintf(s.file, sizeof s.file, "%s/%.20s", s.folder, entry->d_name);
        if (entry->d_name[0] != '.') unlink(s.file);
    }
    if (folder) closedir(folder);
    rmdir(s.folder);
    puts(fine ? "nothing grew" : "FAILED");
    return !fine;
}
