/* Whether the samples end where a hole begins.
 *
 * Where a scan ends, its samples end: a sample at the rim has neighbours along the surface on one side of it alone.
 * Where labels are wrong, a surface goes astray, and what it spans has samples in front of it and behind, but is as
 * wide as a hole. There the sheet that the surface left goes on beyond the rim. So the neighbours of samples at the rim
 * are counted, as far as they are near the tangent plane of the triangles that stay: those in the direction of the
 * hole, within 60 degrees, and those in the opposite direction.
 *
 * Based on: Bendels, Schnabel, Klein. Detecting holes in point set surfaces. WSCG 2006 (a sample is at a boundary if a
 *           half of the disc round it is empty). */
#include "reconstruct/open_surface/hole_rim.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/vector.h"
#include <math.h>

/* NEAR: neighbours of a sample. FLAT: usual radii from the tangent plane. Chosen; flat from 24 to 48 and from 1 to
 * 1.5. */
enum { NEAR = 24 };
static const double FLAT = 1.5, WITHIN = 0.5 /* cosine of 60 degrees */;

/* The part of a surface at a sample, without the holes. */
typedef struct {
    double normal[3], outward[3]; /* unit vectors; outwards, and to where the surface ends */
    double usual;
    size_t triangles;
} rim_sample;

brio_status brio_rim_view_new(const brio_triangle_net *n, const double *usual, brio_rim_view *out) {
    brio_status status = BRIO_OK;
    *out = (brio_rim_view){.net = n, .usual = usual};
    BRIO_TRY(brio_net_leaving(n, &out->first, &out->leaving));
    BRIO_TRY(brio_point_boxes_new(n->ctx, n->points, n->num_points, &out->boxes));
done:
    return status;
}

void brio_rim_view_free(brio_rim_view *v) {
    if (!v->net) return;
    brio_release(v->net->ctx, v->first);
    brio_release(v->net->ctx, v->leaving);
    brio_point_boxes_free(v->net->ctx, &v->boxes);
}

static void normalize(double *u) {
    double length = brio_length(u);
    for (int k = 0; k < 3; k++) u[k] = length > 0 ? u[k] / length : 0;
}

/* Adds a triangle at a sample p. */
static void add_triangle(const brio_rim_view *v, size_t f, const double *p, rim_sample *s) {
    const brio_triangle_net *n = v->net;
    const double *a = brio_net_corner(n, 3 * f), *b = brio_net_corner(n, 3 * f + 1), *c = brio_net_corner(n, 3 * f + 2);
    double u[3], w[3], normal[3], back[3], scale = 1 / (v->usual[f] * v->usual[f]);
    for (int k = 0; k < 3; k++) u[k] = b[k] - a[k], w[k] = c[k] - a[k], back[k] = p[k] - (a[k] + b[k] + c[k]) / 3;
    brio_cross(u, w, normal);
    normalize(back);
    for (int k = 0; k < 3; k++) s->normal[k] += scale * normal[k], s->outward[k] += back[k];
    s->usual += v->usual[f];
    s->triangles++;
}

static rim_sample look_at(const brio_rim_view *v, uint32_t p, const uint8_t *in_hole) {
    rim_sample s = {{0, 0, 0}, {0, 0, 0}, 0, 0};
    for (size_t i = v->first[p]; i < v->first[p + 1]; i++)
        if (!in_hole[v->leaving[i] / 3]) add_triangle(v, v->leaving[i] / 3, v->net->points + 3 * (size_t)p, &s);
    normalize(s.normal);
    double along = brio_dot(s.outward, s.normal);
    for (int k = 0; k < 3; k++) s.outward[k] -= along * s.normal[k];
    normalize(s.outward);
    s.usual /= s.triangles ? (double)s.triangles : 1;
    return s;
}

static void count_neighbours(const brio_rim_view *v, uint32_t p, const rim_sample *s, size_t *beyond, size_t *before) {
    brio_near_point near[BRIO_NEAR_ROOM];
    const double *x = v->net->points + 3 * (size_t)p;
    size_t count = brio_nearest_in_boxes(&v->boxes, p, NEAR, near);
    for (size_t i = 0; i < count; i++) {
        const double *y = v->boxes.point[near[i].place];
        double d[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]}, length = brio_length(d), along = brio_dot(d, s->outward);
        if (!(length > 0) || fabs(brio_dot(d, s->normal)) > FLAT * s->usual) continue;
        if (along > WITHIN * length) ++*beyond;
        if (along < -WITHIN * length) ++*before;
    }
}

static int compare_samples(uint32_t p, uint32_t q, const void *user) {
    (void)user;
    return (p > q) - (p < q);
}

brio_status brio_rim_beyond(const brio_rim_view *v, const uint32_t *hole, size_t count, const uint8_t *in_hole,
                            double *beyond) {
    brio_status status = BRIO_OK;
    const brio_triangle_net *n = v->net;
    uint32_t *sample = NULL;
    size_t ahead = 0, behind = 0;
    BRIO_TRY(BRIO_ALLOC(n->ctx, sample, 3 * count));
    for (size_t i = 0; i < 3 * count; i++) sample[i] = n->faces[3 * (size_t)hole[i / 3] + i % 3];
    brio_sort_indices(sample, 3 * count, compare_samples, NULL);
    for (size_t i = 0; i < 3 * count; i++) {
        if (i > 0 && sample[i] == sample[i - 1]) continue;
        rim_sample s = look_at(v, sample[i], in_hole);
        if (s.triangles > 0) count_neighbours(v, sample[i], &s, &ahead, &behind);
    }
    *beyond = behind > 0 ? (double)ahead / (double)behind : 1;
done:
    brio_release(n->ctx, sample);
    return status;
}
