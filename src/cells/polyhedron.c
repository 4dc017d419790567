/* Convex polyhedra that planes cut.
 *
 * A cut gives every vertex one height over the plane, so that all faces agree on which side it is. Vertices on the
 * plane count as under it. Each face keeps its corners under the plane; where an edge passes the plane, the two faces
 * of the edge share one new vertex. Every new vertex ends the cut of one of its faces and begins that of the other, so
 * the cuts join to cycles, which are the new face. Rounding can move a vertex from one side of a plane to the other,
 * but never opens the polyhedron; it can make faces without area. With a judge, exact signs decide, and heights only
 * say where an edge passes the plane.
 *
 * Based on: Sutherland, Hodgman. Reentrant polygon clipping. CACM 1974. */
#include "cells/polyhedron.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/vector.h"
#include <assert.h>
#include <float.h>
#include <math.h>
#include <string.h>

static const uint32_t NONE = UINT32_MAX;

void brio_polyhedron_clear(brio_polyhedron *p) {
    p->num_vertices = p->faces.count = p->faces.num_corners = 0;
}

static void free_faces(brio_context *ctx, brio_faces *f) {
    brio_release(ctx, f->list);
    brio_release(ctx, f->corner);
}

void brio_polyhedron_free(brio_polyhedron *p) {
    free_faces(p->ctx, &p->faces);
    free_faces(p->ctx, &p->kept);
    brio_release(p->ctx, p->x);
    brio_release(p->ctx, p->name);
    brio_release(p->ctx, p->exact);
    brio_release(p->ctx, p->height);
    brio_release(p->ctx, p->after);
    brio_release(p->ctx, p->cut);
    *p = (brio_polyhedron){.ctx = p->ctx};
}

/* --- filling --- */

brio_status brio_polyhedron_add_vertex(brio_polyhedron *p, const double x[3], uint32_t name,
                                       const brio_exact_vertex *exact) {
    BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->x, p->x_capacity, p->num_vertices + 1));
    BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->name, p->name_capacity, p->num_vertices + 1));
    BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->exact, p->exact_capacity, p->num_vertices + 1));
    memcpy(p->x[p->num_vertices], x, sizeof *p->x);
    assert(exact || !p->judge); /* I2 */
    assert(p->num_vertices < NONE);
    if (exact) p->exact[p->num_vertices] = *exact;
    p->name[p->num_vertices++] = name;
    return BRIO_OK;
}

static brio_status begin_face(brio_context *ctx, brio_faces *f, int64_t neighbour) {
    brio_status status = BRIO_RESERVE(ctx, f->list, f->capacity, f->count + 1);
    if (status == BRIO_OK) f->list[f->count++] = (brio_face){neighbour, false, f->num_corners, f->num_corners};
    return status;
}

static brio_status add_corner(brio_context *ctx, brio_faces *f, uint32_t vertex) {
    brio_status status = BRIO_RESERVE(ctx, f->corner, f->corner_capacity, f->num_corners + 1);
    if (status != BRIO_OK) return status;
    f->corner[f->num_corners++] = vertex;
    assert(f->count > 0 && f->list[f->count - 1].end + 1 == f->num_corners); /* the last face grows */
    f->list[f->count - 1].end = f->num_corners;
    return BRIO_OK;
}

brio_status brio_polyhedron_add_face(brio_polyhedron *p, int64_t neighbour) {
    return begin_face(p->ctx, &p->faces, neighbour);
}

brio_status brio_polyhedron_add_corner(brio_polyhedron *p, uint32_t vertex) {
    assert(vertex < p->num_vertices);
    return add_corner(p->ctx, &p->faces, vertex);
}

brio_status brio_polyhedron_set_box(brio_polyhedron *p, const double low[3], const double high[3]) {
    /* bit k of a corner: the high side in coordinate k */
    static const uint8_t CORNER[6][4] = {{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4},
                                         {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}};
    brio_polyhedron_clear(p);
    for (int v = 0; v < 8; v++) {
        double x[3] = {v & 1 ? high[0] : low[0], v & 2 ? high[1] : low[1], v & 4 ? high[2] : low[2]};
        const brio_exact_vertex walls = {{v & 1 ? -2 : -1, v & 2 ? -4 : -3, v & 4 ? -6 : -5},
                                         (v & 1) ^ (v >> 1 & 1) ^ (v >> 2) ? 1 : -1};
        BRIO_FORWARD(brio_polyhedron_add_vertex(p, x, BRIO_NO_NAME, &walls));
    }
    for (int f = 0; f < 6; f++) {
        BRIO_FORWARD(brio_polyhedron_add_face(p, -1 - f));
        for (int i = 0; i < 4; i++) BRIO_FORWARD(brio_polyhedron_add_corner(p, CORNER[f][i]));
    }
    return BRIO_OK;
}

brio_status brio_polyhedron_copy(brio_polyhedron *p, const brio_polyhedron *from, const double origin[3]) {
    const brio_faces *f = &from->faces;
    brio_polyhedron_clear(p);
    for (size_t v = 0; v < from->num_vertices; v++) {
        double x[3] = {from->x[v][0] - origin[0], from->x[v][1] - origin[1], from->x[v][2] - origin[2]};
        BRIO_FORWARD(brio_polyhedron_add_vertex(p, x, BRIO_NO_NAME, &from->exact[v]));
    }
    for (size_t i = 0; i < f->count; i++) {
        const brio_face *face = &f->list[i];
        BRIO_FORWARD(brio_polyhedron_add_face(p, face->neighbour));
        for (size_t c = face->begin; c < face->end; c++) BRIO_FORWARD(brio_polyhedron_add_corner(p, f->corner[c]));
    }
    return BRIO_OK;
}

/* --- cutting --- */

/* Gives a height the sign that the judge says. */
static double judged(const brio_polyhedron *p, size_t v, double height, int64_t plane) {
    assert(v < p->num_vertices);
    const brio_exact_vertex *e = &p->exact[v];
    int side = p->judge->side(p->judge->user, e->plane, e->orientation, plane);
    if (side == 0) return 0;
    return side > 0 ? fmax(height, DBL_MIN) : fmin(height, -DBL_MIN);
}

/* Computes the heights of all vertices over a plane. The height of a vertex that was cut off before is NaN. Returns 1
 * if a vertex is over the plane and one under it, 0 if none is over it, -1 if none is under it. */
static int find_heights(brio_polyhedron *p, const double plane[4], int64_t neighbour) {
    bool over = false, under = false;
    for (size_t v = 0; v < p->num_vertices; v++) {
        bool dropped = isnan(p->x[v][0]);
        p->height[v] = dropped ? (double)NAN : brio_dot(plane, p->x[v]) - plane[3];
        if (p->judge && !dropped) p->height[v] = judged(p, v, p->height[v], neighbour);
        over |= p->height[v] > 0;
        under |= p->height[v] < 0;
        p->after[v] = NONE;
    }
    return !over ? 0 : under ? 1 : -1;
}

/* Finds or makes the vertex where the edge between `in` and `out` passes the plane. The edge is of two faces, which ask
 * one
 * after the other.   planes  the neighbours of the face that asks, and of the plane */
static brio_status cut_edge(brio_polyhedron *p, uint32_t in, uint32_t out, const int64_t planes[2], uint32_t *vertex) {
    for (size_t i = p->num_cut; i-- > 0;)
        if (p->cut[i].in == in && p->cut[i].out == out) {
            *vertex = p->cut[i].vertex;
            p->exact[*vertex].plane[2] = planes[0];
            return BRIO_OK;
        }
    assert(!(p->height[in] > 0) && p->height[out] > 0);
    const brio_exact_vertex exact = {{planes[0], planes[1], planes[0]}, 0};
    double x[3], share = p->height[in] / (p->height[in] - p->height[out]);
    for (int k = 0; k < 3; k++) x[k] = p->x[in][k] + share * (p->x[out][k] - p->x[in][k]);
    *vertex = (uint32_t)p->num_vertices;
    BRIO_FORWARD(brio_polyhedron_add_vertex(p, x, BRIO_NO_NAME, &exact));
    BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->height, p->height_capacity, p->num_vertices));
    BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->after, p->after_capacity, p->num_vertices));
    BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->cut, p->cut_capacity, p->num_cut + 1));
    p->height[*vertex] = 0;
    p->after[*vertex] = NONE;
    p->cut[p->num_cut++] = (brio_cut_vertex){in, out, *vertex};
    return BRIO_OK;
}

/* Adds to `kept` what a face has under the plane, or nothing. The new face runs along the cut of this face the other
 * way: from where the cycle of corners comes back under the plane to where it left. */
static brio_status keep_face(brio_polyhedron *p, const brio_face *face, int64_t neighbour) {
    const uint32_t *corner = p->faces.corner;
    const int64_t planes[2] = {face->neighbour, neighbour};
    bool under = false;
    uint32_t left = NONE, back = NONE, between;
    BRIO_FORWARD(begin_face(p->ctx, &p->kept, face->neighbour));
    for (size_t c = face->begin; c < face->end; c++) {
        uint32_t u = corner[c], v = corner[c + 1 < face->end ? c + 1 : face->begin];
        assert(u < p->num_vertices && v < p->num_vertices);
        bool over = p->height[u] > 0, next_over = p->height[v] > 0;
        under |= p->height[u] < 0;
        if (!over) BRIO_FORWARD(add_corner(p->ctx, &p->kept, u));
        if (over == next_over) continue;
        BRIO_FORWARD(over ? cut_edge(p, v, u, planes, &between) : cut_edge(p, u, v, planes, &between));
        BRIO_FORWARD(add_corner(p->ctx, &p->kept, between));
        if (!over)
            left = between;
        else if (left == NONE)
            back = between;
        else
            p->after[between] = left;
    }
    if (back != NONE) p->after[back] = left;
    brio_face *kept = &p->kept.list[p->kept.count - 1];
    kept->flat = p->judge && (face->flat || !under);
    if (kept->begin == p->kept.num_corners) p->kept.count--;
    return BRIO_OK;
}

/* Marks the vertices that are cut off, so that later cuts do not look at them. */
static void drop_vertices(brio_polyhedron *p) {
    for (size_t v = 0; v < p->num_vertices; v++)
        if (p->height[v] > 0) p->x[v][0] = NAN;
}

/* Adds the cycles of cut vertices as faces. There is one, unless rounding made a corner not convex. */
static brio_status close_cut(brio_polyhedron *p, int64_t neighbour) {
    for (size_t i = 0; i < p->num_cut; i++) {
        uint32_t v = p->cut[i].vertex;
        if (p->after[v] == NONE) continue;
        BRIO_FORWARD(begin_face(p->ctx, &p->kept, neighbour));
        for (uint32_t next; p->after[v] != NONE; v = next) {
            next = p->after[v];
            p->after[v] = NONE;
            BRIO_FORWARD(add_corner(p->ctx, &p->kept, v));
        }
        assert(v == p->cut[i].vertex); /* a cycle (I1) */
    }
    return BRIO_OK;
}

/* Finds what the new vertices are exactly, now that both faces of their edges are known. */
static void orient_cut(brio_polyhedron *p) {
    for (size_t i = 0; i < p->num_cut && p->judge; i++) {
        brio_exact_vertex *e = &p->exact[p->cut[i].vertex];
        e->orientation = p->judge->orientation(p->judge->user, e->plane);
    }
}

/* Gives a face in a plane, under which all else lies, to the plane: the neighbour of the face becomes the plane's. */
static void take_face_in_plane(brio_polyhedron *p, int64_t neighbour) {
    for (size_t i = 0; i < p->faces.count; i++) {
        brio_face *face = &p->faces.list[i];
        bool on = !face->flat;
        for (size_t c = face->begin; c < face->end; c++) on &= p->height[p->faces.corner[c]] == 0;
        if (on && face->neighbour >= 0 && neighbour < 0) face->neighbour = neighbour;
    }
}

#ifndef NDEBUG
/* Returns whether the directed edges of all faces cancel (I1), up to collisions of a hash. */
static bool edges_are_paired(const brio_polyhedron *p) {
    uint64_t sum = 0;
    for (size_t f = 0; f < p->faces.count; f++) {
        const brio_face *face = &p->faces.list[f];
        if (face->end > p->faces.num_corners || face->begin >= face->end) return false;
        for (size_t c = face->begin; c < face->end; c++) {
            uint64_t u = p->faces.corner[c], v = p->faces.corner[c + 1 < face->end ? c + 1 : face->begin];
            if (u >= p->num_vertices) return false;
            sum += brio_mix(u << 32 | v) - brio_mix(v << 32 | u);
        }
    }
    return sum == 0;
}
#endif

brio_status brio_polyhedron_cut(brio_polyhedron *p, const double plane[4], int64_t neighbour) {
    BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->height, p->height_capacity, p->num_vertices));
    BRIO_FORWARD(BRIO_RESERVE(p->ctx, p->after, p->after_capacity, p->num_vertices));
    int side = find_heights(p, plane, neighbour);
    if (side < 0) p->faces.count = p->faces.num_corners = 0;
    if (side == 0 && p->judge) take_face_in_plane(p, neighbour);
    if (side <= 0) return BRIO_OK;
    p->kept.count = p->kept.num_corners = p->num_cut = 0;
    for (size_t f = 0; f < p->faces.count; f++) BRIO_FORWARD(keep_face(p, &p->faces.list[f], neighbour));
    orient_cut(p);
    BRIO_FORWARD(close_cut(p, neighbour));
    drop_vertices(p);
    brio_faces old = p->faces;
    p->faces = p->kept;
    p->kept = old;
    assert(edges_are_paired(p)); /* I1 */
    return BRIO_OK;
}

/* --- measures --- */

void brio_polyhedron_area(const brio_polyhedron *p, const brio_face *face, double area[3]) {
    const uint32_t *corner = p->faces.corner;
    double u[3], v[3], cross[3];
    area[0] = area[1] = area[2] = 0;
    if (face->begin == face->end) return;
    const double *first = p->x[corner[face->begin]];
    for (size_t c = face->begin + 1; c + 1 < face->end; c++) {
        for (int k = 0; k < 3; k++) u[k] = p->x[corner[c]][k] - first[k], v[k] = p->x[corner[c + 1]][k] - first[k];
        brio_cross(u, v, cross);
        for (int k = 0; k < 3; k++) area[k] += 0.5 * cross[k];
    }
}

/* Adds the moments of the pyramids from the origin over the triangles of a face. */
static void add_moment(const brio_polyhedron *p, const brio_face *face, double *moment) {
    const uint32_t *corner = p->faces.corner;
    const double *a = p->x[corner[face->begin]];
    for (size_t c = face->begin + 1; c + 1 < face->end; c++) {
        const double *b = p->x[corner[c]], *d = p->x[corner[c + 1]];
        double cross[3];
        brio_cross(b, d, cross);
        double volume = brio_dot(a, cross) / 6;
        for (int k = 0; k < 3; k++) moment[k] += volume * (a[k] + b[k] + d[k]) / 4;
    }
}

double brio_polyhedron_volume(const brio_polyhedron *p, double *moment) {
    const brio_faces *f = &p->faces;
    double volume = 0, area[3];
    for (size_t i = 0; i < f->count; i++) {
        const brio_face *face = &f->list[i];
        if (face->begin == face->end) continue;
        brio_polyhedron_area(p, face, area);
        volume += brio_dot(area, p->x[f->corner[face->begin]]) / 3;
        if (moment) add_moment(p, face, moment);
    }
    return volume;
}
