/* The first triangle, and points on a line.
 *
 * Three points come first in the insertion order: the first point, the first point at another place and the first point
 * off their line. If there is none, an apex off the line is added. Then every finite triangle has the apex, and its
 * (ortho)circle meets the line in the one-dimensional (ortho)sphere of its other vertices. The symbolic perturbation
 * skips the apex. So the link of the apex is the perturbed regular triangulation of the points on the line, with the
 * same hidden points. triangulation/start.c does the same one dimension higher. */
#include "plane/plane_start.h"
#include <assert.h>
#include <math.h>
#include <string.h>

static void swap_records(brio_plane_store *s, size_t i, size_t j) {
    brio_plane_record r;
    if (i == j) return;
    memcpy(r, s->record[i], sizeof r);
    memcpy(s->record[i], s->record[j], sizeof r);
    memcpy(s->record[j], r, sizeof r);
    assert(i < s->num_points && j < s->num_points);
    uint32_t c = s->caller[i];
    s->caller[i] = s->caller[j], s->caller[j] = c;
}

/* Moves records in general position to the front. Returns their number. */
static size_t general_position(brio_plane_store *s) {
    brio_plane_record *r = s->record;
    size_t count = s->num_points > 0;
    for (size_t i = 1; i < s->num_points && count < 3; i++) {
        bool off = count == 1 ? !brio_same_place(r[0], r[i]) : brio_orient2d_sign(&s->filter, r[0], r[1], r[i]) != 0;
        if (off) swap_records(s, i, count++);
    }
    return count;
}

/* Returns a finite number different from x, about `step` away. */
static double moved(double x, double step) {
    double y = x > 0 ? x - step : x + step;
    if (y != x) return y;
    return x != 0 ? x * 0.5 : 1;
}

void brio_plane_place_apex(const double *a, const double *b, double *apex) {
    double step = fmin(fmax(fabs(b[0] - a[0]), fabs(b[1] - a[1])), 1e300);
    for (int axis = 0; axis < 2; axis++) {
        memcpy(apex, a, sizeof(brio_plane_record));
        apex[3] = 0;
        apex[axis] = moved(apex[axis], step);
        if (brio_orient2d_exact(a, b, apex)) break;
    }
}

/* Makes the triangle of three records and the three infinite triangles around it. Infinite triangle i + 1 has the edge
 * opposite to vertex i, seen from outside. */
static void first_triangle(brio_plane_store *s, uint32_t last) {
    brio_triangle *t = s->triangle;
    uint32_t own[3] = {0, 1, last};
    if (brio_orient2d_exact(s->record[0], s->record[1], s->record[last]) < 0) own[0] = 1, own[1] = 0;
    assert(brio_orient2d_exact(s->record[own[0]], s->record[own[1]], s->record[own[2]]) > 0); /* I1 */
    assert(s->capacity >= 4 && last < s->infinite);
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t j = brio_slot_after(i), k = brio_slot_before(i);
        t[0].vertex[i] = own[i];
        t[0].mate[i] = brio_edge_of(i + 1, 2);
        t[i + 1] = (brio_triangle){{own[k], own[j], s->infinite}, {brio_edge_of(k + 1, 1), brio_edge_of(j + 1, 0), i}};
    }
    s->count = 4;
    s->stats.created = 4;
}

void brio_plane_start(brio_plane_store *s) {
    bool general = s->filter.general;
    assert(s->filter.key[0] != s->filter.key[1] && s->filter.key[1] != s->filter.key[2]); /* brio_plane_input_key */
    const double(*records)[4] = (const double(*)[4])s->record;
    brio_plane_filter_for(&s->filter, records, s->num_points, general);
    size_t count = general_position(s);
    s->dimension = (int)count - 1;
    if (s->dimension <= 0) return;
    if (s->dimension == 1) {
        brio_plane_place_apex(s->record[0], s->record[1], s->record[s->num_points]);
        brio_plane_filter_for(&s->filter, records, s->num_points + 1, general);
    }
    first_triangle(s, s->dimension == 1 ? (uint32_t)s->num_points : 2);
}
