/* One cell: measures it, and records its faces. */
#include "cells/cell_record.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/vector.h"
#include <assert.h>
#include <math.h>
#include <string.h>

void brio_cell_recorder_free(brio_cell_recorder *r) {
    brio_star_cell_free(&r->star);
    brio_polyhedron_free(&r->shape);
    brio_release(r->ctx, r->own);
    brio_release(r->ctx, r->face);
    brio_release(r->ctx, r->corner);
    brio_release(r->ctx, r->vertex);
}

/* Returns a scaled length (power 1), area (2) or volume (3) in the caller's lengths. */
static inline double in_lengths(const brio_diagram *d, double x, int power) {
    double inverse = 1 / d->scale;
    for (; power > 0; power--) x *= inverse;
    return x;
}

/* --- numbers of a cell --- */

/* Numbers of a cell, scaled, relative to the site. */
typedef struct {
    double volume, area, centroid[3];
    bool bounded;
} cell_numbers;

static void store_numbers(const brio_cell_job *job, uint32_t site, const cell_numbers *n) {
    const brio_diagram *d = job->d;
    size_t cell = job->cell_of[site];
    assert(cell < job->out->num_cells);
    job->out->volume[cell] = brio_cells_held(in_lengths(d, n->volume, 3));
    job->out->bounded[cell] = n->bounded;
    if (job->areas) job->out->area[cell] = brio_cells_held(in_lengths(d, n->area, 2));
    for (size_t k = 0; k < 3 && job->centroids; k++)
        job->out->centroid[3 * cell + k] =
            in_lengths(d, d->at[3 * (size_t)site + k] + n->centroid[k], 1) + d->origin[k];
}

/* Sets the centroid from the first moments; a cell without a volume that can divide has none. */
static void set_centroid(cell_numbers *n, const double *moment) {
    bool known = n->volume > 0 && n->volume < INFINITY;
    for (int k = 0; k < 3; k++) n->centroid[k] = known ? moment[k] / n->volume : NAN;
}

/* --- faces --- */

static brio_status begin_face(brio_cell_recorder *r, int64_t neighbour, double area, const double *normal) {
    brio_status status = BRIO_RESERVE(r->ctx, r->face, r->face_capacity, r->num_faces + 1);
    if (status != BRIO_OK) return status;
    brio_cell_face *face = &r->face[r->num_faces++];
    *face = (brio_cell_face){.neighbour = neighbour, .area = area};
    memcpy(face->normal, normal, sizeof face->normal);
    return BRIO_OK;
}

static brio_status add_corner(brio_cell_recorder *r, uint32_t corner) {
    brio_status status = BRIO_RESERVE(r->ctx, r->corner, r->corner_capacity, r->num_corners + 1);
    if (status != BRIO_OK) return status;
    r->corner[r->num_corners++] = corner;
    assert(r->num_faces > 0);
    r->face[r->num_faces - 1].corners++;
    return BRIO_OK;
}

/* Writes the unit vector from a site to its neighbour. The caller's coordinates are subtracted: in scaled lengths,
 * small coordinates beside large ones are 0. A difference that doubles cannot hold is one of halves. */
static void unit_normal(const brio_diagram *d, uint32_t site, int64_t neighbour, double *n) {
    const double *from = d->points + 3 * (size_t)site, *to = d->points + 3 * (size_t)neighbour;
    double most, length;
    for (int k = 0; k < 3; k++) n[k] = to[k] - from[k];
    most = brio_greatest(n, 3);
    if (most == INFINITY) {
        for (int k = 0; k < 3; k++) n[k] = to[k] / 2 - from[k] / 2;
        most = brio_greatest(n, 3);
    }
    for (int k = 0; k < 3; k++) n[k] /= most;
    length = sqrt(brio_dot(n, n));
    for (int k = 0; k < 3; k++) n[k] /= length;
}

/* --- a cell that is not clipped --- */

static double area_of(const brio_side *s) {
    double area = 0.5 * sqrt(brio_dot(s->area, s->area));
    return s->open ? INFINITY : brio_cells_held(area);
}

static brio_status record_side(const brio_cell_job *job, brio_cell_recorder *r, const brio_side *s) {
    double normal[3];
    size_t count = 0;
    unit_normal(job->d, r->star.site, (int64_t)s->site, normal);
    BRIO_FORWARD(begin_face(r, (int64_t)s->site, brio_cells_held(in_lengths(job->d, area_of(s), 2)), normal));
    if (job->vertices) BRIO_FORWARD(brio_star_cell_polygon(&r->star, s, &count));
    for (size_t i = 0; i < count; i++) BRIO_FORWARD(add_corner(r, brio_same_centre(job->d, r->star.polygon[i])));
    return BRIO_OK;
}

static brio_status record_star(const brio_cell_job *job, brio_cell_recorder *r) {
    const brio_star_cell *c = &r->star;
    cell_numbers n = {.bounded = !c->open};
    n.volume = c->place == BRIO_PLACE_INSIDE ? brio_star_cell_volume(c) : INFINITY;
    for (size_t i = 0; i < c->num_sides; i++) {
        const brio_side *s = &c->side[i];
        if (s->vertices < 3 || s->site >= job->d->num_points) continue;
        if (job->areas) n.area += area_of(s);
        if (job->faces) BRIO_FORWARD(record_side(job, r, s));
    }
    if (c->open) n.area = INFINITY;
    set_centroid(&n, c->moment);
    store_numbers(job, c->site, &n);
    return BRIO_OK;
}

/* --- a clipped cell --- */

/* Returns the number of a vertex of the shape as a corner: its tetrahedron, or its place among the cell's own. */
static brio_status corner_of(const brio_cell_job *job, brio_cell_recorder *r, uint32_t v, uint32_t *num_own,
                             uint32_t *corner) {
    const double *site = job->d->at + 3 * (size_t)r->star.site;
    *corner = r->shape.name[v];
    assert(*corner == BRIO_NO_NAME || *corner < job->d->t.count); /* bit 31 is 0: a tetrahedron */
    if (*corner != BRIO_NO_NAME) return BRIO_OK;
    if (r->own[v] == UINT32_MAX) {
        BRIO_FORWARD(BRIO_RESERVE(r->ctx, r->vertex, r->vertex_capacity, r->num_vertices + 1));
        for (int k = 0; k < 3; k++) r->vertex[r->num_vertices][k] = r->shape.x[v][k] + site[k];
        r->num_vertices++;
        r->own[v] = (*num_own)++;
    }
    assert(!(r->own[v] & BRIO_OWN_VERTEX)); /* bit 31 is the mark, bits 0 to 30 are the number */
    *corner = BRIO_OWN_VERTEX | r->own[v];
    return BRIO_OK;
}

/* Returns whether the corner after corner c is at the same position, as where a plane passes through a vertex. */
static bool is_repeated(const brio_polyhedron *p, const brio_face *face, size_t c) {
    const uint32_t *corner = p->faces.corner;
    const double *x = p->x[corner[c]], *next = p->x[corner[c + 1 < face->end ? c + 1 : face->begin]];
    return x[0] == next[0] && x[1] == next[1] && x[2] == next[2];
}

static brio_status record_face(const brio_cell_job *job, brio_cell_recorder *r, const brio_face *face, double area,
                               uint32_t *num_own) {
    double normal[3];
    uint32_t corner;
    if (face->neighbour >= 0)
        unit_normal(job->d, r->star.site, face->neighbour, normal);
    else
        memcpy(normal, job->region->plane[-1 - face->neighbour], sizeof normal);
    BRIO_FORWARD(begin_face(r, face->neighbour, in_lengths(job->d, area, 2), normal));
    size_t apart = 0;
    for (size_t c = face->begin; c < face->end; c++) apart += !is_repeated(&r->shape, face, c);
    for (size_t c = face->begin; c < face->end && job->vertices; c++) {
        if (apart > 2 && is_repeated(&r->shape, face, c)) continue; /* a polygon has three corners */
        BRIO_FORWARD(corner_of(job, r, r->shape.faces.corner[c], num_own, &corner));
        BRIO_FORWARD(add_corner(r, corner));
    }
    return BRIO_OK;
}

static brio_status record_shape(const brio_cell_job *job, brio_cell_recorder *r) {
    const brio_polyhedron *p = &r->shape;
    cell_numbers n = {.bounded = true};
    double moment[3] = {0, 0, 0};
    uint32_t num_own = 0;
    BRIO_FORWARD(BRIO_RESERVE(r->ctx, r->own, r->own_capacity, p->num_vertices));
    for (size_t v = 0; v < p->num_vertices; v++) r->own[v] = UINT32_MAX;
    n.volume = brio_polyhedron_volume(p, job->centroids ? moment : NULL);
    for (size_t f = 0; f < p->faces.count && (job->areas || job->faces); f++) {
        double vector[3], area;
        brio_polyhedron_area(p, &p->faces.list[f], vector);
        area = sqrt(brio_dot(vector, vector));
        if (p->faces.list[f].flat) continue;
        if (!(area >= 0)) area = 0; /* of corners that doubles cannot tell apart */
        n.area += area;
        if (job->faces) BRIO_FORWARD(record_face(job, r, &p->faces.list[f], area, &num_own));
    }
    set_centroid(&n, moment);
    store_numbers(job, r->star.site, &n);
    return BRIO_OK;
}

brio_status brio_cell_record(const brio_cell_job *job, brio_cell_recorder *r, uint32_t site) {
    size_t faces = r->num_faces, corners = r->num_corners, vertices = r->num_vertices;
    BRIO_FORWARD(brio_star_cell_fill(&r->star, site, job->centroids));
    if (job->region->num_planes && r->star.place != BRIO_PLACE_INSIDE) {
        BRIO_FORWARD(brio_clip_cell(&r->star, job->region, &r->shape));
        BRIO_FORWARD(record_shape(job, r));
    } else {
        BRIO_FORWARD(record_star(job, r));
    }
    if (!job->place) return BRIO_OK;
    job->place[job->cell_of[site]] = (brio_cell_place){.face = faces,
                                                       .corner = corners,
                                                       .vertex = vertices,
                                                       .num_faces = (uint32_t)(r->num_faces - faces),
                                                       .num_vertices = (uint32_t)(r->num_vertices - vertices),
                                                       .num_corners = r->num_corners - corners,
                                                       .thread = (int)(r - job->recorder)};
    return BRIO_OK;
}
