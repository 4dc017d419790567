/* The size of a triangulation, told from the surroundings of a few points.
 *
 * What the triangulation is like near a point depends on the points near it, and there these are triangulated as they
 * are: a random sample would not do, since it keeps neither the noise of a scan, nor a lattice, nor what a weight hides.
 * Where the number of tetrahedra a point still grows with the size of the surroundings, as on exact curved surfaces, it
 * is drawn out with the logarithm of the number of points. */
#include "sample.h"
#include "cloud.h"
#include <math.h>
#include <stdlib.h>

enum { ALL = 2048, BALLS = 12, BALL_MOST = 4096, BALL_AIM = 1500, BALL_LEAST = 400 };

#define USUAL 6.8 /* tetrahedra a point of uniform points */
#define GROWS                                                                                                          \
    0.1 /* share of the tetrahedra a point that a ball has more than its half; in space the border makes 0.03 */

static uint64_t mix(uint64_t x) {
    x = (x ^ x >> 31) * UINT64_C(0x9e3779b97f4a7c15);
    return x ^ x >> 29;
}

/* One of each of `count` equal parts of the points. */
static size_t nth_choice(size_t i, size_t count, size_t points) {
    double part = (double)points / (double)count, within = (double)(mix(i + 1) >> 11) * 0x1p-53;
    size_t at = (size_t)(((double)i + within) * part);
    return at < points ? at : points - 1;
}

static void copy_point(const brio_mesh *mesh, size_t from, double *to) {
    for (size_t c = 0; c < 3; c++) to[c] = mesh->vertices[3 * from + c];
}

static brio_status no_memory(run *r) {
    return cli_fail(r, BRIO_ERR_NO_MEMORY, "no memory for a sample of the points");
}

/* --- balls --- */

typedef struct {
    double centre[3], radius2;
    size_t count;
    uint32_t member[BALL_MOST];
} ball;

static double distance2(const double *p, const double *q) {
    double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    return x * x + y * y + z * z;
}

static void gather_ball(const brio_mesh *mesh, ball *b) {
    b->count = 0;
    for (size_t i = 0; i < mesh->num_vertices; i++)
        if (distance2(mesh->vertices + 3 * i, b->centre) <= b->radius2) {
            if (b->count < BALL_MOST) b->member[b->count] = (uint32_t)i;
            b->count++;
        }
}

/* A ball about a point with some hundreds or thousands of points; false when there is none. */
static bool find_ball(const brio_mesh *mesh, size_t centre, ball *b) {
    enum { TRIES = 16 };
    double low[3], high[3];
    cli_cloud_box(mesh->vertices, mesh->num_vertices, low, high);
    copy_point(mesh, centre, b->centre);
    b->radius2 = distance2(low, high) * BALL_AIM / (double)mesh->num_vertices;
    for (int i = 0; i < TRIES; i++) {
        gather_ball(mesh, b);
        if (b->count >= BALL_LEAST && b->count <= BALL_MOST) return true;
        b->radius2 *= (double)BALL_AIM / (double)(b->count ? b->count : 1);
    }
    return false;
}

/* What was counted about the inner points of balls: those within half of the radius. */
typedef struct {
    double points, hidden, tetrahedra;
} tally;

/* Each tetrahedron counts for its finite vertices alike. */
static void count_inner(const brio_triangulation *t, const char *inner, tally *sum) {
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    for (size_t i = 0; i < s->tetrahedra + s->hull_facets; i++) {
        int finite = tet[i].vertex[3] == BRIO_INFINITE ? 3 : 4;
        for (int v = 0; v < finite; v++)
            if (inner[tet[i].vertex[v]]) sum->tetrahedra += 1.0 / finite;
    }
}

/* Triangulates the points of a ball within radius2 of its centre and counts the inner ones. */
static brio_status count_ball(run *r, const brio_mesh *mesh, const double *weights, const ball *b, double radius2,
                              tally *sum) {
    double *points = malloc(b->count * 3 * sizeof *points), *own = malloc(b->count * sizeof *own);
    char *inner = malloc(b->count);
    brio_triangulation *t = NULL;
    size_t n = 0;
    brio_status status = points && own && inner ? BRIO_OK : no_memory(r);
    if (status != BRIO_OK) goto done;
    for (size_t i = 0; i < b->count; i++) {
        double d = distance2(mesh->vertices + 3 * (size_t)b->member[i], b->centre);
        if (d > radius2) continue;
        copy_point(mesh, b->member[i], points + 3 * n);
        own[n] = weights ? weights[b->member[i]] : 0;
        inner[n++] = d <= radius2 / 4;
    }
    TRY(brio_delaunay(r->ctx, points, weights ? own : NULL, n, NULL, &t));
    const uint32_t *representative = brio_triangulation_representatives(t);
    for (size_t i = 0; i < n; i++) {
        sum->points += inner[i];
        sum->hidden += inner[i] && representative[i] != i;
    }
    count_inner(t, inner, sum);
done:
    brio_triangulation_free(t);
    free(points);
    free(own);
    free(inner);
    return status;
}

/* Counts the surroundings of some points, and half as far round them. */
static brio_status count_surroundings(run *r, const brio_mesh *mesh, const double *weights, tally *far, tally *near) {
    brio_status status = BRIO_OK;
    ball *b = malloc(sizeof *b);
    if (!b) return no_memory(r);
    for (size_t i = 0; i < BALLS; i++) {
        if (!find_ball(mesh, nth_choice(i, BALLS, mesh->num_vertices), b)) continue;
        TRY(count_ball(r, mesh, weights, b, b->radius2, far));
        TRY(count_ball(r, mesh, weights, b, b->radius2 / 4, near));
    }
done:
    free(b);
    return status;
}

/* --- both --- */

static brio_status size_of_all(run *r, const brio_mesh *mesh, const double *weights, triangulation_size *size) {
    brio_triangulation *t = NULL;
    brio_status status = brio_delaunay(r->ctx, mesh->vertices, weights, mesh->num_vertices, NULL, &t);
    if (status != BRIO_OK) return status;
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    *size = (triangulation_size){(double)(s->tetrahedra + s->hull_facets), (double)s->hidden};
    brio_triangulation_free(t);
    return BRIO_OK;
}

brio_status cli_sample_size(run *r, const brio_mesh *mesh, const double *weights, triangulation_size *size) {
    brio_status status = BRIO_OK;
    tally far = {0}, near = {0};
    double points = (double)mesh->num_vertices;
    brio_context_set_threads(r->ctx, 1); /* for so few points */
    if (mesh->num_vertices <= ALL) {
        status = size_of_all(r, mesh, weights, size);
        goto done;
    }
    TRY(count_surroundings(r, mesh, weights, &far, &near));
    if (far.points == 0 || near.points == 0) { /* nearly all in a few positions */
        *size = (triangulation_size){points * USUAL, 0};
        goto done;
    }
    double ratio = far.tetrahedra / far.points, growth = ratio - near.tetrahedra / near.points;
    if (growth > GROWS * ratio)
        ratio += growth * log(points * BALLS / (4 * far.points)) / log(far.points / near.points);
    *size = (triangulation_size){points * ratio, weights ? points * far.hidden / far.points : 0};
done:
    brio_context_set_threads(r->ctx, r->common.threads);
    return status;
}
