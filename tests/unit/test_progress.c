/* Progress is told by work, not by points: between two reports the library does a bounded amount of it, so that a caller
 * who wants to stop is heard. Where the callback stops the work, everything is given back. */
#include "brio/testdata.h"
#include "points.h"
#include "mesh/collapse.h"
#include "triangulation/inserter.h"
#include "harness.h"
#include "surface_calls.h"
#include "surfaces.h"
#include "trial.h"
#include <float.h>

static brio_context *ctx;

typedef struct {
    size_t reports, late; /* late: with at least the fraction `from` */
    size_t allowed;       /* before the work is stopped */
    double from;
} watch;

static int look(const char *stage, double fraction, void *user) {
    watch *w = user;
    EXPECT(fraction >= 0 && fraction <= 1, "%s %g", stage, fraction);
    w->late += fraction >= w->from && !strcmp(stage, "insert");
    return w->reports++ >= w->allowed;
}

static uint64_t work_of(const brio_delaunay_stats *s) {
    return s->created + s->insphere_calls + s->walk_steps + 64 * s->exact_calls;
}

static brio_delaunay_stats triangulate(const double *p, size_t n, brio_location locate, watch *w, uint64_t *searched) {
    trial_options options = {0};
    brio_laboratory *lab;
    brio_triangulation *t = NULL;
    brio_delaunay_stats stats = {0};
    options.locate = locate;
    options.order = BRIO_ORDER_INPUT;
    brio_context_set_progress(ctx, look, w);
    EXPECT(trial_delaunay(ctx, p, NULL, n, &options, &t, &lab) == BRIO_OK, "%s", brio_message(ctx));
    brio_context_set_progress(ctx, NULL, NULL);
    if (t) stats = *brio_triangulation_stats(t), *searched = brio_laboratory_results(lab)->history_tests;
    brio_laboratory_free(lab);
    brio_triangulation_free(t);
    return stats;
}

/* Points on two lines, of which each pair makes a tetrahedron: few points, much work. */
static void few_points_of_much_work_are_reported(void) {
    enum { N = 1200 };
    double *p = malloc(3 * N * sizeof *p);
    for (size_t i = 0; i < N; i++)
        for (size_t k = 0; k < 3; k++) p[3 * i + k] = k == i % 2 ? (double)(i / 2) + 0.37 : k == 2 && i % 2 ? 500 : 0;
    const brio_location ways[] = {BRIO_LOCATION_WALK, BRIO_LOCATION_JUMP, BRIO_LOCATION_HIERARCHY,
                                  BRIO_LOCATION_HISTORY};
    for (size_t i = 0; i < sizeof ways / sizeof *ways; i++) {
        watch w = {.allowed = SIZE_MAX, .from = 0};
        uint64_t searched = 0;
        brio_delaunay_stats stats = triangulate(p, N, ways[i], &w, &searched);
        uint64_t due = (work_of(&stats) + searched) / (2 * BRIO_INSERT_WORK);
        EXPECT(due > 2 && w.late >= due, "%zu reports of %llu", w.late, (unsigned long long)due);
    }
    free(p);
}

static brio_status count_report(void *user) {
    ++*(size_t *)user;
    return BRIO_OK;
}

/* Collapses in one block: 65,536 tries had one report, and each can take tens of microseconds. */
static void collapses_are_reported(void) {
    size_t reports = 0, collapses = 0;
    brio_mesh *mesh = flat_grid(ctx, 100, 100);
    uint32_t n = (uint32_t)mesh->num_vertices, *list = malloc(n * sizeof *list);
    brio_collapse_options o = {.target_faces = 2, .longest = INFINITY, .tolerance = INFINITY};
    brio_collapse_mesh m;
    for (uint32_t v = 0; v < n; v++) list[v] = v;
    EXPECT(brio_collapse_mesh_new(ctx, mesh, &o, &m) == BRIO_OK, "%s", brio_message(ctx));
    for (uint32_t h = 0; h < 3 * m.num_faces; h++)
        if (m.mate[h] >= h) brio_collapse_measure(&m, h);
    brio_collapse_pass pass = {list, n, n, FLT_MAX, n, n};
    EXPECT(brio_collapse_blocks(&m, &pass, count_report, &reports, &collapses) == BRIO_OK);
    EXPECT(collapses > 8000 && reports >= collapses / 2048, "%zu reports of %zu collapses", reports, collapses);
    brio_collapse_mesh_free(&m);
    brio_mesh_free(mesh);
    free(list);
}

/* The centre of a sphere comes last, and destroys all that is there. It begins a run of 8,192 points, so that one report
 * comes before it and all others of its fraction come from inside its insertion. */
static void one_insertion_of_a_huge_star_is_reported(void) {
    enum { N = 12 * 8192 + 1 };
    double *p = malloc(3 * N * sizeof *p);
    uniform_points(6, N, p);
    for (size_t i = 0; i < N; i++) {
        double *q = p + 3 * i, length = 0;
        for (int c = 0; c < 3; c++) length += (q[c] - 0.5) * (q[c] - 0.5);
        for (int c = 0; c < 3; c++) q[c] = i + 1 < N ? 0.5 + (q[c] - 0.5) / sqrt(length) : 0.5;
    }
    watch w = {.allowed = SIZE_MAX, .from = (N - 1.0) / N};
    uint64_t searched;
    triangulate(p, N, BRIO_LOCATION_JUMP, &w, &searched);
    size_t inside = w.late - 2; /* without the one before, and that of the end */
    EXPECT(inside >= 2 && inside < N, "%zu reports", inside);
    free(p);
}

/* --- cancelled --- */

typedef brio_status (*work_fn)(const double *p, size_t n);

static brio_status triangulate_and_check(const double *p, size_t n) {
    brio_triangulation *t = NULL;
    brio_status status = brio_delaunay(ctx, p, NULL, n, NULL, &t);
    if (status == BRIO_OK) status = brio_triangulation_check(ctx, t, p, NULL, n);
    brio_triangulation_free(t);
    return status;
}

static brio_status make_power_crust(const double *p, size_t n) {
    brio_mesh *mesh = NULL;
    int64_t crossings;
    brio_status status = make_crust(ctx, p, n, NULL, &mesh, NULL, NULL);
    if (status == BRIO_OK) status = brio_mesh_self_intersections(ctx, mesh, &crossings);
    brio_mesh_free(mesh);
    return status;
}

static brio_status run_cocone(const double *p, size_t n) {
    brio_mesh *mesh = NULL;
    brio_status status = make_cocone(ctx, p, n, NULL, &mesh, NULL);
    brio_mesh_free(mesh);
    return status;
}

static brio_status list_edges(const double *p, size_t n) {
    brio_triangulation *t = NULL;
    brio_edges list = {0};
    brio_status status = brio_delaunay(ctx, p, NULL, n, NULL, &t);
    if (status == BRIO_OK) status = brio_triangulation_edges(ctx, t, &list);
    brio_edges_free(&list);
    brio_triangulation_free(t);
    return status;
}

static void expect_cancelled_at_each_report(work_fn work, const double *p, size_t n, int threads) {
    brio_context_set_threads(ctx, threads);
    for (size_t allowed = 0;; allowed += BRIEF_TESTS ? 1 + allowed / 3 : SHORT_TESTS ? 1 + allowed / 6 : 1) {
        watch w = {.allowed = allowed, .from = 2};
        brio_context_set_progress(ctx, look, &w);
        brio_status status = work(p, n);
        brio_context_set_progress(ctx, NULL, NULL);
        EXPECT(brio_context_memory(ctx) == 0, "%zu bytes after %zu reports", brio_context_memory(ctx), allowed);
        if (status == BRIO_OK) break;
        EXPECT(status == BRIO_ERR_CANCELLED && w.reports == allowed + 1, "%d after %zu reports", (int)status, allowed);
    }
    brio_context_set_threads(ctx, 1);
}

static void cancelled_at_each_report_everything_is_given_back(void) {
    enum { N = BRIEF_TESTS ? 600 : 1200 };
    double *p = malloc(3 * N * sizeof *p);
    uniform_points(6, N, p);
    for (size_t i = 0; i < N; i++) {
        double *q = p + 3 * i, length = 0;
        for (int c = 0; c < 3; c++) length += (q[c] - 0.5) * (q[c] - 0.5);
        for (int c = 0; c < 3; c++) q[c] = 0.5 + (q[c] - 0.5) / sqrt(length);
    }
    for (int threads = 1; threads <= 2; threads++) {
        expect_cancelled_at_each_report(triangulate_and_check, p, N, threads);
        expect_cancelled_at_each_report(make_power_crust, p, N, threads);
        expect_cancelled_at_each_report(run_cocone, p, N, threads);
        expect_cancelled_at_each_report(list_edges, p, N, threads);
    }
    free(p);
}

/* --- forwards --- */

typedef struct {
    double last;
    char stage[64];
    size_t back;
    const char *name;
} march;

static int look_forwards(const char *stage, double fraction, void *user) {
    march *m = user;
    bool back = fraction < m->last;
    if (back && !m->back) EXPECT(0, "%s: %s %g after %s %g", m->name, stage, fraction, m->stage, m->last);
    m->back += back;
    m->last = fraction;
    snprintf(m->stage, sizeof m->stage, "%s", stage);
    return 0;
}

enum { SAMPLES = 4000 };

static brio_mesh *scan;

static brio_status surface(brio_surface_options o) {
    brio_mesh *mesh = NULL;
    brio_status status = make_labeled(ctx, scan->vertices, scan->num_vertices, &o, &mesh, NULL, NULL);
    brio_mesh_free(mesh);
    return status;
}
static brio_status plain_surface(void) {
    return surface((brio_surface_options)LABELED_OPTIONS);
}
static brio_status every_option_of_surfaces(void) {
    brio_surface_options o = LABELED_OPTIONS;
    o.simplify = 1, o.confidence = 1, o.open = 4, o.noise = BRIO_NOISE_SMOOTH;
    return surface(o);
}
static brio_status power_crust(void) {
    brio_surface_options o = CRUST_OPTIONS;
    brio_mesh *mesh = NULL;
    double *normals = malloc((3 * scan->num_vertices + 1) * sizeof *normals);
    o.simplify = 1;
    brio_status status = make_crust(ctx, scan->vertices, scan->num_vertices, &o, &mesh, normals, NULL);
    brio_mesh_free(mesh);
    free(normals);
    return status;
}
static brio_status offset(void) {
    brio_mesh *mesh = NULL;
    brio_status status = make_offset(ctx, scan->vertices, scan->num_vertices, 0.05, NULL, &mesh, NULL);
    brio_mesh_free(mesh);
    return status;
}
static brio_status power_shape(void) {
    brio_mesh *mesh = NULL, *crust = NULL;
    brio_status status = brio_power_shape(ctx, scan->vertices, scan->num_vertices, NULL, &mesh, &crust, NULL);
    brio_mesh_free(mesh);
    brio_mesh_free(crust);
    return status;
}
static brio_status cocone(bool tight, uint32_t pieces) {
    brio_surface_options o = COCONE_OPTIONS;
    brio_mesh *mesh = NULL;
    o.method = tight ? BRIO_SURFACE_TIGHT_COCONE : BRIO_SURFACE_COCONE;
    o.pieces = pieces;
    brio_status status = make_cocone(ctx, scan->vertices, scan->num_vertices, &o, &mesh, NULL);
    brio_mesh_free(mesh);
    return status;
}
static brio_status plain_cocone(void) {
    return cocone(false, 0);
}
static brio_status tight_cocone(void) {
    return cocone(true, 0);
}
static brio_status cocone_of_pieces(void) {
    return cocone(false, 4);
}
static brio_status triangulation(void) {
    brio_triangulation *t = NULL;
    brio_status status = brio_delaunay(ctx, scan->vertices, NULL, scan->num_vertices, NULL, &t);
    brio_triangulation_free(t);
    return status;
}
static brio_status triangulation_by_history(void) {
    brio_triangulation *t = NULL;
    trial_options o = {0};
    o.locate = BRIO_LOCATION_HISTORY;
    brio_status status = trial_delaunay(ctx, scan->vertices, NULL, scan->num_vertices, &o, &t, NULL);
    brio_triangulation_free(t);
    return status;
}
static brio_status thinning(void) {
    size_t chosen;
    uint8_t *kept = malloc(scan->num_vertices);
    brio_status status = brio_thin(ctx, scan->vertices, scan->num_vertices, 0.02, kept, &chosen);
    free(kept);
    return status;
}
static brio_status outliers(void) {
    uint8_t *found = malloc(scan->num_vertices);
    brio_status status = brio_outliers(ctx, scan->vertices, scan->num_vertices, 8, NULL, found);
    free(found);
    return status;
}
static brio_status solid(void) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_generate_solid(ctx, BRIO_SOLID_MACHINED, 1, 24, &mesh);
    brio_mesh_free(mesh);
    return status;
}
static brio_status small_scan(void) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_generate(ctx, BRIO_KIND_SCAN, 1000, NULL, &mesh);
    brio_mesh_free(mesh);
    return status;
}
static brio_status cells(void) {
    brio_cells *out = NULL;
    brio_cells_options o = {0};
    o.vertices = 1;
    brio_status status = brio_voronoi_cells(ctx, NULL, scan->vertices, NULL, scan->num_vertices, &o, &out);
    brio_cells_free(out);
    return status;
}
static brio_status hull(void) {
    brio_mesh *mesh = NULL;
    brio_status status = brio_convex_hull(ctx, scan->vertices, scan->num_vertices, NULL, &mesh, NULL);
    brio_mesh_free(mesh);
    return status;
}
static brio_status edges(void) {
    brio_triangulation *t = NULL;
    brio_edges list = {0};
    brio_progress_fn report = ctx->progress;
    void *user = ctx->progress_user;
    brio_context_set_progress(ctx, NULL, NULL); /* another call of the library, with its bar */
    brio_status status = brio_delaunay(ctx, scan->vertices, NULL, scan->num_vertices, NULL, &t);
    brio_context_set_progress(ctx, report, user);
    if (status == BRIO_OK) status = brio_triangulation_edges(ctx, t, &list);
    brio_edges_free(&list);
    brio_triangulation_free(t);
    return status;
}
static const struct {
    const char *name;
    brio_status (*run)(void);
} WAYS[] = {{"surface", plain_surface},
            {"surface with every option", every_option_of_surfaces},
            {"power crust", power_crust},
            {"offset surface", offset},
            {"power shape", power_shape},
            {"co-cone", plain_cocone},
            {"tight co-cone", tight_cocone},
            {"co-cone of pieces", cocone_of_pieces},
            {"cells", cells},
            {"hull", hull},
            {"triangulation", triangulation},
            {"triangulation by history", triangulation_by_history},
            {"thinning", thinning},
            {"outliers", outliers},
            {"edges", edges},
            {"solid", solid},
            {"scan", small_scan}};

/* A surface that is simplified began anew at the end. */
static void progress_never_runs_backwards(void) {
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, SAMPLES, NULL, &scan) == BRIO_OK);
    for (size_t i = 0; i < sizeof WAYS / sizeof *WAYS; i++) {
        march m = {.name = WAYS[i].name};
        brio_context_set_progress(ctx, look_forwards, &m);
        EXPECT(WAYS[i].run() == BRIO_OK, "%s: %s", m.name, brio_message(ctx));
        brio_context_set_progress(ctx, NULL, NULL);
        EXPECT(!m.back, "%s: %zu steps back", m.name, m.back);
    }
    brio_mesh_free(scan);
}

SUITE(test_progress) {
    if (brio_context_new(NULL, &ctx) != BRIO_OK) return HARNESS_SKIP;
    brio_context_set_threads(ctx, 1);
    RUN(few_points_of_much_work_are_reported);
    RUN(collapses_are_reported);
    RUN(one_insertion_of_a_huge_star_is_reported);
    RUN(cancelled_at_each_report_everything_is_given_back);
    RUN(progress_never_runs_backwards);
    brio_context_free(ctx);
    return harness_end();
}
