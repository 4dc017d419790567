/* How a surface came to be at its samples, from the triangulation that it was made of.
 *
 * For each sample: its star of tetrahedra with their labels, and its cell, a face for each edge at the sample: the
 * centres of the tetrahedra round the edge, in turn. Poles and axes are found as they were for the surface, by the same
 * code, so they have the same bits.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, figures 2.10 and 3.4. */
#include "base/memory.h"
#include "base/sort.h"
#include "base/vector.h"
#include "reconstruct/explanation/explanation.h"
#include "reconstruct/labels/label.h"
#include "triangulation/ring.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    brio_context *ctx;
    const brio_explained *s;
    brio_explaining x;
    brio_pole_vectors found;       /* if the method has none */
    const brio_pole_vectors *dual; /* those of the method, or `found` */
    brio_incidences stars;
    uint64_t *face_first; /* #samples + 1: of the faces at each sample in `face` */
    uint32_t *face;
    uint64_t *opposite; /* of the faces at the sample at work: the edges opposite to it, sorted */
    size_t opposites, opposite_room;
    uint32_t *row; /* #points: among the vertices of a sample; of one before the sample at work if it is below `next` */
    double length; /* of cut rays */
    uint32_t sample, centres, next; /* the one at work; its first vertex that is a centre; its first vertex */
} work;

/* --- which samples --- */

static bool is_sample(const work *w, size_t p) {
    return w->stars.offsets[p + 1] > w->stars.offsets[p];
}

/* Chooses the samples: all, or as many as there is room for, evenly along their order. Until they are explained
 * `point` has their numbers. */
static brio_status choose(work *w) {
    brio_explanation *e = w->x.e;
    size_t most = w->s->options->explained, n = 0, at = 0;
    for (size_t p = 0; p < w->s->num_samples; p++) n += is_sample(w, p);
    e->all_samples = n;
    e->num_samples = n < most ? n : most;
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, e->point, e->num_samples + 1));
    for (size_t p = 0, i = 0; p < w->s->num_samples && at < e->num_samples; p++)
        if (is_sample(w, p) && i++ == (uint64_t)at * n / e->num_samples) e->point[at++] = (uint32_t)p;
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, e->place, 3 * e->num_samples + 1));
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, e->axis, 3 * e->num_samples + 1));
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, e->pole, 8 * e->num_samples + 1));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->ctx, e->pole_side, 2 * e->num_samples + 1));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->ctx, e->vertex_offsets, e->num_samples + 1));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->ctx, e->tetrahedron_offsets, e->num_samples + 1));
    return BRIO_ALLOC_ZERO(w->ctx, e->polygon_offsets, e->num_samples + 1);
}

/* Lists the faces of the surface at each sample. */
static brio_status list_faces(work *w) {
    const uint32_t *corner = w->s->faces;
    size_t corners = corner ? 3 * w->s->num_faces : 0, n = w->s->num_samples;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->ctx, w->face_first, n + 2));
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, w->face, corners + 1));
    for (size_t i = 0; i < corners; i++) w->face_first[corner[i] + 2]++;
    for (size_t p = 0; p < n; p++) w->face_first[p + 2] += w->face_first[p + 1];
    for (size_t i = 0; i < corners; i++) w->face[w->face_first[corner[i] + 1]++] = (uint32_t)(i / 3);
    return BRIO_OK;
}

static void measure(work *w) {
    double low[3], high[3];
    for (size_t k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
    for (size_t i = 0; i < 3 * w->s->num_samples; i++) {
        low[i % 3] = fmin(low[i % 3], w->s->points[i]);
        high[i % 3] = fmax(high[i % 3], w->s->points[i]);
    }
    w->length = sqrt(brio_square_distance(low, high)) / 2;
}

/* --- tetrahedra --- */

static int8_t side_of(const work *w, uint32_t tet) {
    if (!w->s->label || w->s->label[tet] == BRIO_LABEL_NONE) return 0;
    return (w->s->label[tet] == BRIO_LABEL_OUTER) != w->s->inverted ? 1 : -1;
}

static uint64_t edge_key(uint32_t a, uint32_t b) {
    return a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
}

/* Lists the edges opposite to the sample in the faces at it: there may be as many as there are samples. */
static brio_status list_opposites(work *w) {
    uint64_t from = w->face_first[w->sample], to = w->face_first[w->sample + 1];
    BRIO_FORWARD(BRIO_RESERVE(w->ctx, w->opposite, w->opposite_room, (size_t)(to - from) + 1));
    w->opposites = 0;
    for (uint64_t i = from; i < to; i++) {
        const uint32_t *f = w->s->faces + 3 * (size_t)w->face[i];
        int k = f[0] == w->sample ? 0 : f[1] == w->sample ? 1 : 2;
        w->opposite[w->opposites++] = edge_key(f[(k + 1) % 3], f[(k + 2) % 3]);
    }
    brio_sort_keys(w->opposite, w->opposites);
    return BRIO_OK;
}

static int compare_keys(const void *p, const void *q) {
    uint64_t a = *(const uint64_t *)p, b = *(const uint64_t *)q;
    return (a > b) - (a < b);
}

/* Returns whether the surface has the triangle of the sample, a and b. */
static bool is_taken(const work *w, uint32_t a, uint32_t b) {
    uint64_t key = edge_key(a, b);
    return w->opposites > 0 && bsearch(&key, w->opposite, w->opposites, sizeof key, compare_keys) != NULL;
}

/* Returns the row of a sample among the vertices of the sample at work; adds it if it is not there. */
static brio_status find_vertex(work *w, uint32_t v, uint32_t *row) {
    *row = w->row[v];
    if (*row >= w->next && *row != UINT32_MAX) return BRIO_OK;
    *row = w->row[v] = (uint32_t)w->x.vertices;
    return brio_explain_vertex(&w->x, w->s->points + 3 * (size_t)v,
                               v < w->s->num_samples ? w->s->order[v] : UINT32_MAX);
}

static brio_status add_tetrahedron(work *w, uint32_t tet) {
    brio_explaining *x = &w->x;
    brio_explanation *e = x->e;
    const uint32_t *v = w->dual->t.tet[tet].vertex;
    int slot = brio_slot_of_vertex(v, w->sample);
    const uint32_t corner[4] = {w->sample, v[BRIO_FACET[slot][1]], v[BRIO_FACET[slot][0]], v[BRIO_FACET[slot][2]]};
    size_t n = x->tetrahedra;
    uint8_t taken = 0;
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, e->tetrahedra, x->tetrahedron_room[0], 4 * n + 4));
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, e->tetrahedron_side, x->tetrahedron_room[1], n + 1));
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, e->tetrahedron_confidence, x->tetrahedron_room[2], n + 1));
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, e->tetrahedron_taken, x->tetrahedron_room[3], n + 1));
    for (size_t i = 0; i < 4; i++) BRIO_FORWARD(find_vertex(w, corner[i], &e->tetrahedra[4 * n + i]));
    for (int i = 1; i < 4; i++) taken |= (uint8_t)(is_taken(w, corner[1 + i % 3], corner[1 + (i + 1) % 3]) << i);
    e->tetrahedron_side[n] = side_of(w, tet);
    e->tetrahedron_confidence[n] = w->s->confidence ? w->s->confidence[tet] : NAN;
    e->tetrahedron_taken[n] = taken;
    x->tetrahedra++;
    return BRIO_OK;
}

/* --- the cell --- */

/* Adds the end of the ray that an infinite tetrahedron cuts off a face, as a corner. */
static brio_status add_ray(work *w, uint32_t tet) {
    const double *from = w->dual->centre + 4 * (size_t)brio_tet_of(*brio_mate(&w->dual->t, brio_facet_of(tet, 3)));
    const double *along = w->dual->centre + 4 * (size_t)tet;
    double end[3];
    for (int k = 0; k < 3; k++) end[k] = from[k] + w->length * along[k];
    if (isnan(end[0])) return BRIO_OK;
    BRIO_FORWARD(brio_explain_vertex(&w->x, end, UINT32_MAX));
    return brio_explain_corner(&w->x, w->x.vertices - 1);
}

/* Returns the vertex that is the centre of a tetrahedron of the star. */
static size_t centre_vertex(const work *w, uint32_t tet) {
    const uint64_t *offset = w->stars.offsets + w->sample;
    size_t low = 0, high = (size_t)(offset[1] - offset[0]);
    while (high - low > 1) {
        size_t middle = (low + high) / 2;
        if (w->stars.items[offset[0] + middle] <= tet)
            low = middle;
        else
            high = middle;
    }
    return w->centres + low;
}

/* Adds a corner of a face: the centre of a tetrahedron, or the end of a ray. */
static brio_status add_corner(work *w, uint32_t tet) {
    if (tet >= w->dual->num_finite) return add_ray(w, tet);
    return isnan(w->dual->centre[4 * (size_t)tet]) ? BRIO_OK : brio_explain_corner(&w->x, centre_vertex(w, tet));
}

/* Adds the face of the cell that is dual to the edge from slot i to slot j of a tetrahedron, unless another tetrahedron
 * round the edge adds it. */
static brio_status add_face(work *w, uint32_t tet, int i, int j) {
    const brio_tetrahedra *t = &w->dual->t;
    if (!brio_ring_size(t, tet, i, j)) return BRIO_OK;
    brio_ring ring = brio_ring_second(t, tet, i, j);
    BRIO_FORWARD(add_corner(w, tet));
    do { BRIO_FORWARD(add_corner(w, ring.tet)); } while (brio_ring_next(&ring));
    return brio_explain_polygon(&w->x, BRIO_EXPLAINED_CELL);
}

static brio_status add_cell(work *w, const uint32_t *star, size_t count) {
    const brio_tetrahedra *t = &w->dual->t;
    w->centres = (uint32_t)w->x.vertices;
    for (size_t n = 0; n < count; n++)
        BRIO_FORWARD(brio_explain_vertex(&w->x, w->dual->centre + 4 * (size_t)star[n], UINT32_MAX));
    for (size_t n = 0; n < count; n++) {
        int slot = brio_slot_of_vertex(t->tet[star[n]].vertex, w->sample);
        for (int j = 0; j < 4; j++)
            if (j != slot) BRIO_FORWARD(add_face(w, star[n], slot, j));
    }
    return BRIO_OK;
}

/* --- poles --- */

static void read_poles(const work *w, double pole[8], int8_t side[2]) {
    const brio_pole_vectors *d = w->dual;
    for (int i = 0; i < 2; i++) {
        uint32_t tet = d->pole[2 * (size_t)w->sample + (size_t)i];
        double *row = pole + 4 * i;
        for (int k = 0; k < 4; k++) row[k] = NAN;
        side[i] = 0;
        if (tet == BRIO_INFINITE) continue;
        memcpy(row, d->centre + 4 * (size_t)tet, 3 * sizeof *row);
        row[3] = tet < d->num_finite ? sqrt(d->centre[4 * (size_t)tet + 3]) : INFINITY;
        side[i] = side_of(w, tet);
    }
}

/* Writes the axis: that of the method, or the direction to the farther pole. */
static void write_axis(const work *w, const double *pole, double *axis) {
    const double *plane = w->dual->plane + 4 * (size_t)w->sample, *from = w->s->points + 3 * (size_t)w->sample;
    for (int k = 0; k < 3; k++) {
        if (w->s->outside)
            axis[k] = (double)w->s->outside[w->sample][k];
        else if (w->s->more)
            axis[k] = pole[k] - from[k];
        else
            axis[k] = plane[k];
    }
    double length = sqrt(brio_dot(axis, axis));
    for (int k = 0; k < 3 && w->s->more; k++) axis[k] /= length;
}

/* Writes a polar ball in lengths of the points. One that doubles cannot hold is a pole at infinity. */
static void write_pole(const work *w, const double *pole, double *out) {
    const double *from = w->s->points + 3 * (size_t)w->sample;
    bool finite = pole[3] != INFINITY;
    for (int k = 0; k < 4; k++) out[k] = finite ? ldexp(pole[k], w->s->exponent) : pole[k];
    for (int k = 0; k < 4; k++) finite &= !isinf(out[k]);
    if (finite || pole[3] == INFINITY) return;
    for (int k = 0; k < 3; k++) out[k] = (pole[k] - from[k]) / pole[3];
    out[3] = INFINITY;
}

static brio_status explain_sample(work *w, size_t i) {
    brio_explanation *e = w->x.e;
    uint32_t s = w->sample = e->point[i];
    double pole[8];
    const uint32_t *star = w->stars.items + w->stars.offsets[s];
    size_t count = (size_t)(w->stars.offsets[s + 1] - w->stars.offsets[s]);
    w->next = (uint32_t)w->x.vertices;
    BRIO_FORWARD(list_opposites(w));
    for (size_t n = 0; n < count; n++) BRIO_FORWARD(add_tetrahedron(w, star[n]));
    BRIO_FORWARD(add_cell(w, star, count));
    read_poles(w, pole, e->pole_side + 2 * i);
    if (w->s->more) BRIO_FORWARD(w->s->more(w->s->user, &w->x, s, pole, e->pole_side + 2 * i));
    write_axis(w, pole, e->axis + 3 * i);
    for (size_t k = 0; k < 8; k += 4) write_pole(w, pole + k, e->pole + 8 * i + k);
    for (size_t k = 0; k < 3; k++) e->place[3 * i + k] = ldexp(w->s->points[3 * (size_t)s + k], w->s->exponent);
    e->point[i] = w->s->order[s];
    e->vertex_offsets[i + 1] = w->x.vertices;
    e->tetrahedron_offsets[i + 1] = w->x.tetrahedra;
    e->polygon_offsets[i + 1] = w->x.polygons;
    return brio_look(w->ctx, 100 + count);
}

static brio_status prepare(work *w) {
    const brio_explained *s = w->s;
    brio_explanation *e;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->ctx, e, 1));
    w->x.e = e;
    *e = (brio_explanation){.size = sizeof *e, .context = w->ctx, .method = s->options->method, .theta = s->theta};
    BRIO_FORWARD(BRIO_RESERVE(w->ctx, e->corner_offsets, w->x.polygon_room[1], 1));
    e->corner_offsets[0] = 0;
    if (!s->dual)
        BRIO_FORWARD(brio_pole_vectors_find(w->ctx, s->delaunay, s->points, s->num_points, s->theta, &w->found));
    w->dual = s->dual ? s->dual : &w->found;
    BRIO_FORWARD(brio_triangulation_incident_tetrahedra(w->ctx, s->delaunay, &w->stars));
    measure(w);
    BRIO_FORWARD(BRIO_ALLOC(w->ctx, w->row, s->num_points + 1));
    memset(w->row, 0xff, (s->num_points + 1) * sizeof *w->row);
    BRIO_FORWARD(choose(w));
    return list_faces(w);
}

brio_status brio_explain(brio_context *ctx, const brio_explained *s) {
    brio_status status = BRIO_OK;
    work w = {.ctx = ctx, .s = s, .x = {.ctx = ctx, .exponent = s->exponent}};
    if (!s->options->explanation) return BRIO_OK;
    BRIO_TRY(prepare(&w));
    for (size_t i = 0; i < w.x.e->num_samples; i++) BRIO_TRY(explain_sample(&w, i));
    *s->options->explanation = w.x.e;
    w.x.e = NULL;
done:
    brio_explanation_free(w.x.e);
    brio_incidences_free(&w.stars);
    brio_pole_vectors_free(ctx, &w.found);
    brio_release(ctx, w.face_first);
    brio_release(ctx, w.face);
    brio_release(ctx, w.opposite);
    brio_release(ctx, w.row);
    return status;
}
