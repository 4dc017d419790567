/* Sharp edges of iso-surfaces, by moving dual and primal vertices in turn.
 *
 * Each triangle has a dual vertex: its centroid, moved along the gradient onto the zero set, with the normal there.
 * Each vertex moves to the point of least squared distance from the tangent planes at the dual vertices of its
 * triangles. On a crease these planes have two directions, at a corner three. The least squares are solved in the
 * directions in which the planes determine the point; in the others the vertex takes the mean of its dual vertices,
 * which evens the mesh out. Where the surface is strongly curved the planes meet beside it; so vertices are moved onto
 * the zero set last.
 *
 * A triangle is turned over when its normal disagrees with the normal at its dual vertex. Vertices of such triangles
 * take their old places again, until no triangle is worse than before.
 *
 * Based on: Ohtake, Belyaev. Dual/primal mesh optimization for polygonized implicit surfaces. Solid Modeling 2002.
 * Differs from the paper: Newton steps find the zero set; a vertex starts from the mean of its dual vertices in place
 * of a separate resampling; moves that turn triangles over are taken back. */
#include "iso/dual_optimize.h"
#include "base/least_squares.h"
#include "base/team.h"
#include "base/vector.h"
#include "mesh/twins.h"
#include <math.h>
#include <string.h>

enum {
    NEWTON_STEPS = 4,
    MOST_REPAIRS = 12,
    MOST_SWEEPS = 4,
    ITEMS_A_THREAD = 1 << 8,
    BATCH = 1 << 14 /* triangles or vertices between two reports of progress */
};

static const double STEP = 1e-3;        /* of differences, in cells; chosen */
static const double ON_SURFACE = 1e-4;  /* distance from the zero set that is none, in cells; chosen */
static const double DETERMINED = 0.03;  /* eigenvalues below this share of the largest give no direction; chosen:
                                            creases of 20 degrees and more are sharp */
static const double BENT = 0.9;         /* cosine between normals of neighbours below which there is a crease; chosen */
static const double LONGEST_MOVE = 1.5; /* of a vertex from the mean of its dual vertices, in cells; chosen */
static const double TURNED = 0.2;       /* cosine between normals below which a triangle is turned over; chosen */

typedef struct {
    const brio_implicit_grid *grid;
    brio_mesh *mesh;
    uint64_t *start;    /* #V + 1: where a vertex's triangles begin */
    uint32_t *incident; /* triangles of each vertex */
    uint32_t *twin;     /* of each half-edge */
    double *dual;       /* #F by 6: dual vertex and normal */
    double *old;        /* #V by 3: positions before the round */
    uint8_t *back;      /* #V: takes its old position again */
    size_t first;       /* triangle or vertex of the batch in work */
} optimizer;

/* --- the function --- */

static double value_at(const optimizer *o, const double *p) {
    return o->grid->value(p, o->grid->user);
}

/* Writes the gradient, from values at four corners of a tetrahedron. */
static void gradient_at(const optimizer *o, const double *p, double *g) {
    static const double corner[4][3] = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}};
    double h = STEP * o->grid->cell;
    g[0] = g[1] = g[2] = 0;
    for (int i = 0; i < 4; i++) {
        double q[3];
        for (int k = 0; k < 3; k++) q[k] = p[k] + h * corner[i][k];
        double f = value_at(o, q);
        for (int k = 0; k < 3; k++) g[k] += f * corner[i][k] / (4 * h);
    }
}

static bool normalise(double *g) {
    double length = sqrt(brio_dot(g, g));
    if (!(length > 1e-6)) return false;
    for (int k = 0; k < 3; k++) g[k] /= length;
    return true;
}

/* Moves p onto the zero set, at most one cell a step. Writes the normal when `normal` is not NULL; it is 0 where the
 * function has none. */
static void project(const optimizer *o, double *p, double *normal) {
    double g[3] = {0, 0, 0};
    for (int step = 0; step < NEWTON_STEPS; step++) {
        double f = value_at(o, p);
        if (fabs(f) < ON_SURFACE * o->grid->cell) break;
        gradient_at(o, p, g);
        double square = brio_dot(g, g), limit = o->grid->cell / fmax(sqrt(square), 1e-6);
        double t = fmin(fmax(f / fmax(square, 0.05), -limit), limit);
        for (int k = 0; k < 3; k++) p[k] -= t * g[k];
    }
    if (!normal) return;
    gradient_at(o, p, normal);
    if (!normalise(normal)) normal[0] = normal[1] = normal[2] = 0;
}

/* --- dual and primal vertices --- */

static const double *corner_of(const optimizer *o, size_t f, int i) {
    return o->mesh->vertices + 3 * (size_t)o->mesh->face_vertices[3 * f + (size_t)i];
}

static void place_dual(void *user, size_t begin, size_t end, int thread) {
    optimizer *o = user;
    (void)thread;
    for (size_t f = o->first + begin; f < o->first + end; f++) {
        double *d = o->dual + 6 * f;
        const double *a = corner_of(o, f, 0), *b = corner_of(o, f, 1), *c = corner_of(o, f, 2);
        for (int k = 0; k < 3; k++) d[k] = (a[k] + b[k] + c[k]) / 3;
        project(o, d, d + 3);
    }
}

/* Returns whether a triangle is a tooth: two neighbours lie in about one plane, and it lies in another. Then writes the
 * mean of the neighbours' dual vertices and normals. */
static bool is_tooth(const optimizer *o, size_t f, double *mean) {
    for (int i = 0; i < 3; i++) {
        const double *n = o->dual + 6 * f + 3, *a = o->dual + 6 * (size_t)(o->twin[3 * f + (size_t)i] / 3);
        const double *b = o->dual + 6 * (size_t)(o->twin[3 * f + (size_t)(i + 1) % 3] / 3);
        if (brio_dot(n, a + 3) > BENT || brio_dot(n, b + 3) > BENT || brio_dot(a + 3, b + 3) < BENT) continue;
        for (int k = 0; k < 6; k++) mean[k] = 0.5 * (a[k] + b[k]);
        return normalise(mean + 3);
    }
    return false;
}

/* Joins teeth. Along a crease, triangles that straddle it fall to one side or the other. Where they alternate, the
 * vertices of both sides would move onto the crease, and the triangles between would vanish. So teeth join their
 * neighbours' side. */
static void join_teeth(optimizer *o) {
    bool changed = true;
    for (int sweep = 0; sweep < MOST_SWEEPS && changed; sweep++) {
        changed = false;
        for (size_t f = 0; f < o->mesh->num_faces; f++) {
            double mean[6];
            if (!is_tooth(o, f, mean)) continue;
            memcpy(o->dual + 6 * f, mean, sizeof mean);
            changed = true;
        }
    }
}

static void place_primal(void *user, size_t begin, size_t end, int thread) {
    optimizer *o = user;
    (void)thread;
    for (size_t v = o->first + begin; v < o->first + end; v++) {
        double mean[3] = {0, 0, 0}, a[6] = {0}, b[3] = {0, 0, 0}, x[3], *p = o->mesh->vertices + 3 * v;
        double count = (double)(o->start[v + 1] - o->start[v]);
        for (uint64_t i = o->start[v]; i < o->start[v + 1]; i++)
            for (int k = 0; k < 3; k++) mean[k] += o->dual[6 * (size_t)o->incident[i] + (size_t)k] / count;
        for (uint64_t i = o->start[v]; i < o->start[v + 1]; i++) {
            const double *d = o->dual + 6 * (size_t)o->incident[i], *n = d + 3;
            double height = n[0] * (d[0] - mean[0]) + n[1] * (d[1] - mean[1]) + n[2] * (d[2] - mean[2]);
            brio_add_equation(n, height, a, b);
        }
        brio_solve_determined(a, b, DETERMINED, x);
        double length = sqrt(brio_dot(x, x)), limit = LONGEST_MOVE * o->grid->cell;
        for (int k = 0; k < 3; k++) p[k] = mean[k] + (length > limit ? limit / length : 1) * x[k];
        project(o, p, NULL);
    }
}

/* --- triangles that turn over --- */

static double cosine(const optimizer *o, size_t f) {
    const double *p = corner_of(o, f, 0), *q = corner_of(o, f, 1), *r = corner_of(o, f, 2);
    const double *normal = o->dual + 6 * f + 3;
    double u[3], w[3], n[3];
    for (int k = 0; k < 3; k++) u[k] = q[k] - p[k], w[k] = r[k] - p[k];
    brio_cross(u, w, n);
    return normalise(n) ? brio_dot(n, normal) : -1;
}

/* Returns whether a triangle is turned over by the moves of its vertices; marks these vertices. */
static bool mark_turned(optimizer *o) {
    bool any = false;
    for (size_t f = 0; f < o->mesh->num_faces; f++) {
        const uint32_t *corner = o->mesh->face_vertices + 3 * f;
        if (o->back[corner[0]] && o->back[corner[1]] && o->back[corner[2]]) continue;
        if (cosine(o, f) >= TURNED) continue;
        for (int i = 0; i < 3; i++) o->back[corner[i]] = 1;
        any = true;
    }
    return any;
}

static void take_back_turned(optimizer *o) {
    memset(o->back, 0, o->mesh->num_vertices);
    for (int repair = 0; repair < MOST_REPAIRS && mark_turned(o); repair++)
        for (size_t v = 0; v < o->mesh->num_vertices; v++)
            if (o->back[v]) memcpy(o->mesh->vertices + 3 * v, o->old + 3 * v, 3 * sizeof(double));
}

/* --- all of it --- */

static brio_status make_workspace(brio_context *ctx, optimizer *o) {
    size_t n = o->mesh->num_vertices, m = o->mesh->num_faces;
    const uint32_t *corner = o->mesh->face_vertices;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, o->start, n + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, o->incident, 3 * m));
    BRIO_FORWARD(BRIO_ALLOC(ctx, o->dual, 6 * m));
    BRIO_FORWARD(BRIO_ALLOC(ctx, o->old, 3 * n));
    BRIO_FORWARD(BRIO_ALLOC(ctx, o->back, n));
    BRIO_FORWARD(brio_mesh_twins(ctx, o->mesh, &o->twin));
    for (size_t i = 0; i < 3 * m; i++) o->start[corner[i] + 1]++;
    for (size_t v = 0; v < n; v++) o->start[v + 1] += o->start[v];
    for (size_t i = 3 * m; i-- > 0;) o->incident[--o->start[corner[i] + 1]] = (uint32_t)(i / 3);
    for (size_t v = 0; v < n; v++) o->start[v] = o->start[v + 1];
    o->start[n] = 3 * m;
    return BRIO_OK;
}

/* Calls body for all of n items, batch by batch; reports progress from `from` to `to`. */
static brio_status in_batches(brio_context *ctx, optimizer *o, size_t n, brio_part_fn body, const double part[2]) {
    for (o->first = 0; o->first < n; o->first += BATCH) {
        size_t count = n - o->first < BATCH ? n - o->first : BATCH;
        double share = (double)o->first / (double)n;
        BRIO_FORWARD(brio_progress(ctx, "optimize", part[0] + share * (part[1] - part[0])));
        BRIO_FORWARD(brio_for_chunks(ctx, brio_threads(ctx, count, ITEMS_A_THREAD), count, ITEMS_A_THREAD, body, o));
    }
    return BRIO_OK;
}

brio_status brio_dual_optimize(brio_context *ctx, const brio_implicit_grid *grid, brio_mesh *mesh, int rounds) {
    brio_status status = BRIO_OK;
    optimizer o = {.grid = grid, .mesh = mesh};
    size_t n = mesh->num_vertices, m = mesh->num_faces;
    BRIO_TRY(make_workspace(ctx, &o));
    for (int round = 0; round < rounds; round++) {
        const double begin = (double)round / rounds, middle = (round + 0.7) / rounds, end = (round + 1.0) / rounds;
        memcpy(o.old, mesh->vertices, 3 * n * sizeof *o.old);
        BRIO_TRY(in_batches(ctx, &o, m, place_dual, (const double[2]){begin, middle}));
        join_teeth(&o);
        BRIO_TRY(in_batches(ctx, &o, n, place_primal, (const double[2]){middle, end}));
        take_back_turned(&o);
    }
    BRIO_TRY(brio_progress(ctx, "optimize", 1));
done:
    brio_release(ctx, o.start);
    brio_release(ctx, o.incident);
    brio_release(ctx, o.twin);
    brio_release(ctx, o.dual);
    brio_release(ctx, o.old);
    brio_release(ctx, o.back);
    return status;
}
