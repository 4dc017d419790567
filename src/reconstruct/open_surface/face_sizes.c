/* How large the triangles of a surface are, and how large they should be.
 *
 * The circle of a triangle along the surface holds no sample. So its radius says how far apart the samples are there,
 * and a triangle much larger than usual spans a place without samples. What is usual is read off the surface itself, so
 * that it follows a density that changes along the surface:
 *   1. A sample's size is the lower quarter of the radii round it, weighted by the angles of the triangles at the
 *      sample. At the rim of a hole, at least a quarter of the angle belongs to triangles that samples carry.
 *   2. A size is not larger than the 0.7 quantile of the sizes of its neighbours: samples with holes all round them,
 *      and strays, take the size of the surface that they hang on.
 *   3. Along an edge a size grows by at most GROWTH times its length: the far end of a membrane, where no surface is,
 *      is not excused by sizes that only the membrane has.
 *   4. A triangle's usual radius is the middle of the sizes of its three samples. Where a dense scan of one side meets
 *      a coarse scan of the next, two of the three are often dense, and are on the other side. They tell nothing of
 *      this one. So if a triangle lies along the sheets of only one or two of its samples, the coarsest of these
 *      counts. If it lies along all three, so may a gap in the sheet; the coarsest counts only if the places of
 *      scanners are known, which tell what nobody saw (hole_cut.c).
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999 (empty balls along the surface measure
 * the
 *           sampling). */
#include "reconstruct/open_surface/face_sizes.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "base/vector.h"
#include "mesh/twins.h"
#include "reconstruct/cocone/triangle.h"
#include <math.h>

/* Chosen on scans of models that nothing else was measured on. */
static const double LOWER = 0.25, AMONG_NEIGHBOURS = 0.7, GROWTH = 0.35;

/* A triangle lies along the sheet of a sample if the cosine between its normal and what the sample takes for the
 * outside is over TANGENT. Chosen on scans of models that nothing else was measured on. */
static const double TANGENT = 0.7;

/* Chosen. */
enum { ITEMS_A_THREAD = 1 << 12 };

typedef struct {
    const brio_triangle_net *net;
    double *radius, *usual; /* #F */
    size_t *first;          /* #P + 1, as brio_net_leaving lists them; sorted here */
    uint32_t *leaving;      /* 3 #F */
    double *own, *size;     /* #P: after step 1, after step 2 */
} sizing;

static void measure_radii(void *user, size_t begin, size_t end, int thread) {
    const sizing *s = user;
    (void)thread;
    for (size_t f = begin; f < end; f++)
        s->radius[f] = sqrt(brio_circle_square(brio_net_corner(s->net, 3 * f), brio_net_corner(s->net, 3 * f + 1),
                                               brio_net_corner(s->net, 3 * f + 2)));
}

/* Returns the angle of a triangle at the start of a half-edge. */
static double angle_at(const brio_triangle_net *n, uint32_t h) {
    const double *o = brio_net_corner(n, h), *p = brio_net_corner(n, brio_next_corner(h)),
                 *q = brio_net_corner(n, brio_previous_corner(h));
    double u[3], v[3], normal[3];
    for (int k = 0; k < 3; k++) u[k] = p[k] - o[k], v[k] = q[k] - o[k];
    brio_cross(u, v, normal);
    return atan2(brio_length(normal), brio_dot(u, v));
}

static int compare_radii(uint32_t g, uint32_t h, const void *user) {
    const sizing *s = user;
    double a = s->radius[g / 3], b = s->radius[h / 3];
    return a != b ? (a > b) - (a < b) : (g > h) - (g < h);
}

static void measure_samples(void *user, size_t begin, size_t end, int thread) {
    const sizing *s = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        uint32_t *h = s->leaving + s->first[p];
        size_t count = s->first[p + 1] - s->first[p], i = 0;
        double all = 0, sum = 0;
        brio_sort_indices(h, count, compare_radii, s);
        for (size_t k = 0; k < count; k++) all += angle_at(s->net, h[k]);
        for (; i < count; i++)
            if ((sum += angle_at(s->net, h[i])) >= LOWER * all) break;
        s->own[p] = count ? s->radius[h[i < count ? i : count - 1] / 3] : 0;
    }
}

static uint32_t head_of(const sizing *s, uint32_t h) {
    return s->net->faces[brio_next_corner(h)];
}

static int compare_heads(uint32_t g, uint32_t h, const void *user) {
    const sizing *s = user;
    double a = s->own[head_of(s, g)], b = s->own[head_of(s, h)];
    return a != b ? (a > b) - (a < b) : (g > h) - (g < h);
}

static void limit_samples(void *user, size_t begin, size_t end, int thread) {
    const sizing *s = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        uint32_t *h = s->leaving + s->first[p];
        size_t count = s->first[p + 1] - s->first[p];
        brio_sort_indices(h, count, compare_heads, s);
        s->size[p] = count ? fmin(s->own[p], s->own[head_of(s, h[(size_t)(AMONG_NEIGHBOURS * (double)count)])]) : 0;
    }
}

typedef struct {
    const sizing *s;
    bool back;    /* whether a sweep goes backwards */
    bool lowered; /* atomic */
} growing;

/* Lowers the size at the head of a half-edge to what the size at its start allows. Sizes are atomic. */
static void limit_head(growing *g, uint32_t h) {
    const brio_triangle_net *n = g->s->net;
    uint32_t p = n->faces[h], q = head_of(g->s, h);
    double at, before;
    __atomic_load(&g->s->size[p], &at, __ATOMIC_RELAXED);
    __atomic_load(&g->s->size[q], &before, __ATOMIC_RELAXED);
    if (!(before > at)) return;
    double most = at + GROWTH * sqrt(brio_square_distance(n->points + 3 * (size_t)p, n->points + 3 * (size_t)q));
    while (before > most) {
        if (!__atomic_compare_exchange(&g->s->size[q], &before, &most, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
            continue;
        __atomic_store_n(&g->lowered, true, __ATOMIC_RELAXED);
        return;
    }
}

static void limit_part(void *user, size_t begin, size_t end, int thread) {
    growing *g = user;
    size_t last = 3 * g->s->net->num_faces - 1;
    (void)thread;
    for (size_t i = begin; i < end; i++) limit_head(g, (uint32_t)(g->back ? last - i : i));
}

/* Limits how fast sizes grow along edges: sweeps alternate until all limits hold. The sizes that they end with do not
 * depend on the order. Limits travel along most edges in two sweeps. */
static brio_status limit_growth(const sizing *s) {
    brio_status status = BRIO_OK;
    size_t count = 3 * s->net->num_faces;
    growing g = {.s = s};
    do {
        g.lowered = false;
        BRIO_TRY(brio_for(s->net->ctx, brio_threads(s->net->ctx, count, ITEMS_A_THREAD), count, limit_part, &g));
        g.back = !g.back;
    } while (g.lowered);
done:
    return status;
}

static double middle_of(double a, double b, double c) {
    return fmax(fmin(a, b), fmin(fmax(a, b), c));
}

/* Returns what is usual for a triangle. */
static double usual_of(const sizing *s, size_t f) {
    const brio_triangle_net *n = s->net;
    const uint32_t *v = n->faces + 3 * f;
    double normal[3], coarsest = 0, usual = middle_of(s->size[v[0]], s->size[v[1]], s->size[v[2]]);
    int along = 0;
    if (!n->outside) return usual;
    brio_net_normal(n, f, normal);
    for (size_t i = 0; i < 3; i++)
        if (brio_net_facing_at(n, normal, 3 * f + i) > TANGENT) along++, coarsest = fmax(coarsest, s->size[v[i]]);
    return along < 3 || n->scanner ? fmax(usual, coarsest) : usual;
}

static void measure_usual(void *user, size_t begin, size_t end, int thread) {
    const sizing *s = user;
    (void)thread;
    for (size_t f = begin; f < end; f++) s->usual[f] = usual_of(s, f);
}

brio_status brio_face_sizes(const brio_triangle_net *n, double *radius, double *usual) {
    brio_status status = BRIO_OK;
    sizing s = {.net = n, .radius = radius, .usual = usual};
    int by_faces = brio_threads(n->ctx, n->num_faces, ITEMS_A_THREAD),
        by_points = brio_threads(n->ctx, n->num_points, ITEMS_A_THREAD);
    BRIO_TRY(brio_net_leaving(n, &s.first, &s.leaving));
    BRIO_TRY(BRIO_ALLOC(n->ctx, s.own, n->num_points));
    BRIO_TRY(BRIO_ALLOC(n->ctx, s.size, n->num_points));
    BRIO_TRY(brio_for(n->ctx, by_faces, n->num_faces, measure_radii, &s));
    BRIO_TRY(brio_for(n->ctx, by_points, n->num_points, measure_samples, &s));
    BRIO_TRY(brio_for(n->ctx, by_points, n->num_points, limit_samples, &s));
    BRIO_TRY(limit_growth(&s));
    BRIO_TRY(brio_for(n->ctx, by_faces, n->num_faces, measure_usual, &s));
done:
    brio_release(n->ctx, s.first);
    brio_release(n->ctx, s.leaving);
    brio_release(n->ctx, s.own);
    brio_release(n->ctx, s.size);
    return status;
}
