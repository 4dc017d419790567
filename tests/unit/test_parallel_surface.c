/* Surfaces by any number of threads: the same mesh, statistics, certificate and file to the last byte. */
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include "trial.h"
#include <string.h>
#include <unistd.h>

enum { N = BRIEF_TESTS ? 2500 : 6000, MOST_THREADS = SHORT_TESTS ? 3 : 8 };

static double points[3 * N];

/* Everything that a run gives but its times and its memory. */
typedef struct {
    brio_surface_stats stats;
    brio_certificate certificate;
    brio_mesh *mesh;
    char *file;
    long file_size;
} result;

static void forget_times(brio_surface_stats *s) {
    s->delaunay_seconds = s->poles_seconds = s->poles.power_seconds = s->poles.label_seconds = s->crust_seconds =
        s->simplify_seconds = s->noise_seconds = 0;
}

static void read_back(const char *path, result *r) {
    FILE *f = fopen(path, "rb");
    EXPECT(f != NULL);
    fseek(f, 0, SEEK_END);
    r->file_size = ftell(f);
    rewind(f);
    r->file = malloc((size_t)r->file_size + 1);
    EXPECT(fread(r->file, 1, (size_t)r->file_size, f) == (size_t)r->file_size);
    fclose(f);
}

static void run(brio_context *ctx, size_t n, const brio_surface_options *o, int threads, result *r) {
    char path[] = "/tmp/brio-test-XXXXXX.ply";
    int file = mkstemps(path, 4);
    EXPECT(file >= 0);
    close(file);
    brio_context_set_threads(ctx, threads);
    *r = (result){.mesh = NULL};
    EXPECT(make_crust(ctx, points, n, o, &r->mesh, NULL, &r->stats) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_mesh_certificate(ctx, r->mesh, &r->certificate) == BRIO_OK);
    EXPECT(brio_write(ctx, path, r->mesh, NULL) == BRIO_OK, "%s", brio_message(ctx));
    forget_times(&r->stats);
    read_back(path, r);
    unlink(path);
}

static void result_free(result *r) {
    brio_certificate_free(&r->certificate);
    brio_mesh_free(r->mesh);
    free(r->file);
}

static void expect_same(const result *a, const result *b, int threads) {
    const brio_mesh *m = a->mesh, *n = b->mesh;
    EXPECT(m->num_vertices == n->num_vertices && m->num_faces == n->num_faces, "%d threads", threads);
    if (m->num_vertices != n->num_vertices || m->num_faces != n->num_faces) return;
    EXPECT(!memcmp(m->vertices, n->vertices, 3 * m->num_vertices * sizeof *m->vertices), "%d threads", threads);
    EXPECT(!memcmp(m->face_offsets, n->face_offsets, (m->num_faces + 1) * sizeof *m->face_offsets));
    EXPECT(!memcmp(m->face_vertices, n->face_vertices, m->face_offsets[m->num_faces] * sizeof *m->face_vertices));
    EXPECT(!memcmp(&a->stats, &b->stats, sizeof a->stats), "statistics of %d threads", threads);
    brio_certificate c = a->certificate, d = b->certificate;
    EXPECT(c.components == d.components && !memcmp(c.genera, d.genera, c.components * sizeof *c.genera));
    c.genera = d.genera = NULL;
    EXPECT(!memcmp(&c, &d, sizeof c), "certificate of %d threads", threads);
    EXPECT(a->file_size == b->file_size && !memcmp(a->file, b->file, (size_t)a->file_size), "%d threads", threads);
}

static void expect_one_answer_with(size_t n, const brio_surface_options *options, int labeling) {
    brio_context *ctx = new_context();
    brio_surface_options usual = CRUST_OPTIONS, *o = &usual;
    brio_laboratory *lab;
    if (options) usual = *options;
    EXPECT(trial_labeling(ctx, labeling, &o->poles, &lab) == BRIO_OK);
    result one, many;
    run(ctx, n, o, 1, &one);
    for (int threads = SHORT_TESTS ? 3 : 2; threads <= MOST_THREADS; threads += threads < 3 ? 1 : 5) {
        run(ctx, n, o, threads, &many);
        expect_same(&one, &many, threads);
        result_free(&many);
    }
    result_free(&one);
    brio_laboratory_free(lab);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void expect_one_answer(size_t n, const brio_surface_options *o) {
    expect_one_answer_with(n, o, BRIO_LABELING_GLOBAL);
}

static void every_number_of_threads_gives_the_same_surface(void) {
    torus_points(1, N, points);
    expect_one_answer(N, NULL);
}

static void anything_is_the_same_by_threads(void) {
    brio_surface_options o = CRUST_OPTIONS;
    clustered_points(2, 1000, points);
    o.polygons = 0;
    expect_one_answer(1000, &o);
    integer_points(3, 1000, 8, points);
    o.open = 4;
    expect_one_answer(1000, &o);
}

/* All inner poles but one are hidden, or duplicates. */
static void sphere_is_the_same_by_threads(void) {
    sphere_points(4, 1500, points);
    expect_one_answer(1500, NULL);
}

static void every_labeling_is_the_same_by_threads(void) {
    clustered_points(5, 700, points);
    for (int labeling = 0; labeling < TRIAL_LABELINGS; labeling++) expect_one_answer_with(700, NULL, labeling);
}

SUITE(test_parallel_surface) {
    RUN(every_number_of_threads_gives_the_same_surface);
    RUN(anything_is_the_same_by_threads);
    RUN(sphere_is_the_same_by_threads);
    RUN(every_labeling_is_the_same_by_threads);
    return harness_end();
}
