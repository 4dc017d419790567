/* Edges collapse in passes, those of least error first.
 *
 * A pass has a limit: a quarter of the edges that may be tried have errors of at most the limit, or fewer when the
 * number of faces comes near its target. A pass divides the vertices into blocks along a curve and collapses, in each
 * block, edges up to the limit in the order of their errors (collapse_blocks.c). Edges at the borders of blocks wait:
 * passes use two curves in turns, whose blocks have different borders. So all parts of the surface reach one error
 * together, as they do with one queue, and what a pass does at borders is not farther behind than the limits of two
 * passes. The last few collapses, and all collapses of small meshes, are a pass of one block.
 *
 * The limits come from a histogram of errors, whose classes differ by less than 1%, and not from a share of the blocks'
 * own edges: so they do not depend on threads.
 *
 * Collapses in blocks look at the surface near them, not at other sheets of it. Where triangles of the result cross,
 * all is done once more, as one block, with a guard that sees every sheet (collapse_guard.h).
 *
 * Based on: Garland, Heckbert. Surface simplification using quadric error metrics. SIGGRAPH 1997.
 * Differs from the paper: blocks instead of one queue; see also collapse.c and collapse_mesh.h. */
#include "mesh/simplify.h"
#include "base/memory.h"
#include "base/team.h"
#include "mesh/collapse.h"
#include "mesh/collapse_guard.h"
#include "mesh/crossing_faces.h"
#include <float.h>
#include <string.h>

enum {
    BLOCK = 1 << 12,   /* vertices; the data of a block and its heap fit into the cache of a processor; chosen */
    ALONE = 4 * BLOCK, /* a mesh of so many vertices is one block; chosen */
    LAST_SHARE = 64,   /* one block collapses the rest when less than vertices / LAST_SHARE is left to do; chosen */
    CLASSES = 1 << 15, /* of errors: all values of the 15 bits below a float's sign */
    EDGES_A_THREAD = 1 << 14, /* chosen */
};

/* A pass tries at most TRIED of the edges. Its limit is chosen so that it will probably make a share PACE of the
 * collapses to the target, and it makes at most a share MOST of them. All three chosen. */
static const double TRIED = 0.25, PACE = 0.6, MOST = 0.9;
static const double FIRST_YIELD = 1.0 / 3, LEAST_YIELD = 0.02;

typedef struct {
    brio_collapse_mesh m;
    uint32_t *order[2]; /* the vertices that are left, along both curves */
    size_t count;       /* how many are left */
    size_t excess;      /* collapses to the target */
    size_t all;         /* excess at the beginning */
    size_t *classes;    /* CLASSES: edges of each class of errors */
    double yield;       /* collapses of the last pass for each edge up to its limit */
} simplifier;

/* --- classes of errors --- */

static uint32_t class_of(float error) {
    uint32_t bits;
    memcpy(&bits, &error, sizeof bits);
    return bits >> 16;
}

/* Returns the largest error of a class. */
static float end_of_class(uint32_t class) {
    uint32_t bits = class << 16 | 0xffff;
    float error;
    memcpy(&error, &bits, sizeof error);
    return error;
}

typedef struct {
    const brio_collapse_mesh *m;
    uint32_t *counts; /* #threads by CLASSES */
} counting;

static void count_classes(void *user, size_t begin, size_t end, int thread) {
    const counting *c = user;
    uint32_t *counts = c->counts + (size_t)thread * CLASSES;
    for (size_t h = begin; h < end; h++)
        if (c->m->error[h] <= FLT_MAX) counts[class_of(c->m->error[h])]++;
}

/* Counts the edges that may be tried, by class. Writes the number of all. */
static brio_status count_edges(simplifier *s, size_t *edges) {
    brio_status status = BRIO_OK;
    brio_context *ctx = s->m.ctx;
    size_t n = 3 * s->m.num_faces;
    int threads = brio_threads(ctx, n, EDGES_A_THREAD);
    counting c = {.m = &s->m};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, c.counts, (size_t)threads * CLASSES));
    BRIO_TRY(brio_for(ctx, threads, n, count_classes, &c));
    *edges = 0;
    for (size_t i = 0; i < CLASSES; i++) {
        s->classes[i] = 0;
        for (size_t t = 0; t < (size_t)threads; t++) s->classes[i] += c.counts[t * CLASSES + i];
        *edges += s->classes[i];
    }
done:
    brio_release(ctx, c.counts);
    return status;
}

/* Returns the least end of a class up to which there are `wanted` edges, FLT_MAX when there are fewer in all. Writes
 * how many there are up to it. */
static float limit_for(const simplifier *s, double wanted, size_t *edges) {
    *edges = 0;
    for (uint32_t i = 0; i < CLASSES; i++) {
        *edges += s->classes[i];
        if (*edges && (double)*edges >= wanted) return end_of_class(i);
    }
    return FLT_MAX;
}

/* --- passes --- */

static brio_status report(void *user) {
    const simplifier *s = user;
    return brio_progress(s->m.ctx, "simplify", 1 - (double)s->excess / (double)s->all);
}

/* Drops the vertices that have vanished from both orders. */
static void drop_vanished(simplifier *s) {
    for (int i = 0; i < 2; i++) {
        size_t count = 0;
        for (size_t j = 0; j < s->count; j++)
            if (s->m.half_edge[s->order[i][j]] != BRIO_COLLAPSE_NONE) s->order[i][count++] = s->order[i][j];
        if (i == 1) s->count = count;
    }
}

static brio_status run_pass(simplifier *s, const brio_collapse_pass *pass, size_t *collapses) {
    BRIO_FORWARD(brio_collapse_blocks(&s->m, pass, report, s, collapses));
    s->excess -= *collapses;
    drop_vanished(s);
    return BRIO_OK;
}

/* Runs passes of many blocks while there is enough to do for them. */
static brio_status collapse_in_blocks(simplifier *s) {
    size_t edges, tried, collapses;
    for (int turn = 0; s->count > ALONE && s->excess > s->count / LAST_SHARE; turn = !turn) {
        BRIO_FORWARD(count_edges(s, &edges));
        if (edges < s->count / LAST_SHARE) break;
        double wanted = PACE * (double)s->excess / s->yield, most = TRIED * (double)edges;
        float limit = limit_for(s, wanted < most ? wanted : most, &tried);
        double share = MOST * (double)s->excess / (double)tried;
        brio_collapse_pass pass = {s->order[turn], s->count, BLOCK, limit, share, s->excess};
        BRIO_FORWARD(run_pass(s, &pass, &collapses));
        if (collapses < s->count / LAST_SHARE) break;
        s->yield = (double)collapses / (double)tried;
        if (s->yield < LEAST_YIELD) s->yield = LEAST_YIELD;
    }
    return BRIO_OK;
}

/* Makes the collapses that are left in one block. First its heap has no more edges than will probably do. */
static brio_status collapse_the_rest(simplifier *s) {
    size_t edges, tried, collapses;
    for (int time = 0; time < 2 && s->excess && s->count; time++) {
        BRIO_FORWARD(count_edges(s, &edges));
        float limit = time ? FLT_MAX : limit_for(s, 4 * (double)s->excess / s->yield, &tried);
        if (limit == FLT_MAX) time = 1;
        brio_collapse_pass pass = {s->order[0], s->count, s->count, limit, (double)s->excess, s->excess};
        BRIO_FORWARD(run_pass(s, &pass, &collapses));
    }
    return BRIO_OK;
}

/* --- beginning --- */

static void measure_edges(void *user, size_t begin, size_t end, int thread) {
    brio_collapse_mesh *m = user;
    (void)thread;
    for (size_t h = begin; h < end; h++)
        if (m->mate[h] >= h) brio_collapse_measure(m, (uint32_t)h);
}

static brio_status prepare(simplifier *s) {
    brio_context *ctx = s->m.ctx;
    size_t half_edges = 3 * s->m.num_faces;
    s->count = s->m.num_vertices;
    s->yield = FIRST_YIELD;
    s->order[1] = s->m.second_order;
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->order[0], s->count));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->classes, CLASSES));
    for (size_t v = 0; v < s->count; v++) s->order[0][v] = (uint32_t)v;
    return brio_for(ctx, brio_threads(ctx, half_edges, EDGES_A_THREAD), half_edges, measure_edges, &s->m);
}

/* --- triangles that cross --- */

/* Counts the pairs of triangles that are left and cross. */
static brio_status count_crossings(const brio_collapse_mesh *m, int64_t *pairs) {
    brio_status status = BRIO_OK;
    brio_mesh left = {.size = sizeof left, .context = m->ctx, .num_vertices = m->num_vertices, .vertices = m->position};
    BRIO_TRY(BRIO_ALLOC(m->ctx, left.face_vertices, 3 * m->num_faces));
    BRIO_TRY(BRIO_ALLOC(m->ctx, left.face_offsets, m->num_faces + 1));
    left.face_offsets[0] = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        if (m->vertex[3 * f] == BRIO_COLLAPSE_NONE) continue;
        memcpy(left.face_vertices + 3 * left.num_faces, m->vertex + 3 * f, 3 * sizeof *m->vertex);
        left.num_faces++;
        left.face_offsets[left.num_faces] = 3 * left.num_faces;
    }
    BRIO_TRY(brio_crossing_faces(m->ctx, &left, NULL, NULL, pairs));
done:
    brio_release(m->ctx, left.face_vertices);
    brio_release(m->ctx, left.face_offsets);
    return status;
}

/* Collapses edges of a mesh, whose arrays s->m takes over, but does not write the result.
 * guarded  whether each collapse is tested. */
static brio_status collapse(simplifier *s, brio_mesh *mesh, bool guarded) {
    brio_context *ctx = mesh->context;
    const brio_collapse_options *options = s->m.options;
    *s = (simplifier){0};
    BRIO_FORWARD(brio_collapse_mesh_new(ctx, mesh, options, &s->m));
    if (mesh->num_faces <= options->target_faces) return BRIO_OK;
    s->all = s->excess = (mesh->num_faces - options->target_faces + 1) / 2;
    BRIO_FORWARD(report(s));
    BRIO_FORWARD(prepare(s));
    if (guarded)
        BRIO_FORWARD(brio_collapse_guard_new(&s->m, &s->m.guard));
    else
        BRIO_FORWARD(collapse_in_blocks(s));
    BRIO_FORWARD(collapse_the_rest(s));
    if (guarded) BRIO_FORWARD(brio_collapse_guard_status(s->m.guard));
    return BRIO_OK;
}

static void free_simplifier(simplifier *s, brio_context *ctx) {
    brio_release(ctx, s->order[0]);
    brio_release(ctx, s->classes);
    s->order[0] = NULL;
    s->classes = NULL;
    brio_collapse_mesh_free(&s->m);
}

/* A copy of what collapses change of a mesh. */
typedef struct {
    double *vertices;
    uint32_t *face_vertices;
} original;

static brio_status collapse_again(simplifier *s, brio_mesh *mesh, const original *o) {
    const brio_collapse_options *options = s->m.options;
    free_simplifier(s, mesh->context);
    s->m.options = options;
    memcpy(mesh->vertices, o->vertices, 3 * mesh->num_vertices * sizeof *o->vertices);
    memcpy(mesh->face_vertices, o->face_vertices, 3 * mesh->num_faces * sizeof *o->face_vertices);
    return collapse(s, mesh, true);
}

brio_status brio_collapse_edges(brio_context *ctx, brio_mesh *mesh, const brio_collapse_options *options) {
    brio_status status = BRIO_OK;
    simplifier s = {.m.options = options};
    bool embedded = options->embedded && mesh->num_faces > options->target_faces;
    original o = {NULL, NULL};
    int64_t pairs = 0;
    const brio_bar bar = brio_progress_bar(ctx);
    if (embedded) {
        size_t corners = (size_t)mesh->face_offsets[mesh->num_faces];
        BRIO_TRY(BRIO_ALLOC(ctx, o.vertices, 3 * mesh->num_vertices));
        BRIO_TRY(BRIO_ALLOC(ctx, o.face_vertices, corners));
        memcpy(o.vertices, mesh->vertices, 3 * mesh->num_vertices * sizeof *o.vertices);
        memcpy(o.face_vertices, mesh->face_vertices, corners * sizeof *o.face_vertices);
    }
    if (embedded) brio_progress_part(ctx, bar, 0, 0.5);
    BRIO_TRY(collapse(&s, mesh, false));
    if (embedded) {
        brio_progress_part(ctx, bar, 0.5, 0.6);
        BRIO_TRY(count_crossings(&s.m, &pairs));
    }
    brio_progress_part(ctx, bar, pairs ? 0.6 : 0, 1);
    if (pairs) BRIO_TRY(collapse_again(&s, mesh, &o));
    brio_release(ctx, s.order[0]);
    s.order[0] = NULL;
    BRIO_TRY(brio_collapse_mesh_write(&s.m, mesh));
done:
    brio_progress_part(ctx, bar, 0, 1);
    brio_release(ctx, o.vertices);
    brio_release(ctx, o.face_vertices);
    free_simplifier(&s, ctx);
    return status;
}
