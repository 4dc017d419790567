/* The region that cells are clipped to.
 *
 * A cube is cut by the planes of the region. The cube grows until the result stays clear of its walls; a last cut
 * starts from a box that fits the result, so that its vertices are accurate. Six planes of a box are taken as they
 * are. */
#include "cells/diagram.h"
#include "base/memory.h"
#include "base/vector.h"
#include <math.h>
#include <string.h>

/* Chosen: a polytope that reaches beyond 2^MOST_DOUBLINGS times the largest distance of a plane from 0 counts as
 * unbounded. */
enum { MOST_DOUBLINGS = 40 };

static brio_status take_planes(brio_context *ctx, const double *planes, const double origin[3], double scale,
                               brio_region *r) {
    BRIO_FORWARD(BRIO_ALLOC(ctx, r->plane, r->num_planes));
    BRIO_FORWARD(BRIO_ALLOC(ctx, r->given, r->num_planes));
    BRIO_FORWARD(BRIO_ALLOC(ctx, r->terms, r->num_planes));
    memcpy(r->given, planes, r->num_planes * sizeof *r->given);
    for (size_t i = 0; i < r->num_planes; i++) {
        const double *from = planes + 4 * i;
        double terms = fabs(from[3]);
        for (int k = 0; k < 3; k++) terms += fabs(from[k] * origin[k]);
        double most = fmax(fabs(from[0]), fmax(fabs(from[1]), fabs(from[2]))), n[3];
        for (int k = 0; k < 3; k++) n[k] = from[k] / most;
        double length = sqrt(brio_dot(n, n));
        for (int k = 0; k < 3; k++) r->plane[i][k] = n[k] / length;
        r->plane[i][3] = (from[3] - brio_dot(from, origin)) / most / length * scale;
        r->terms[i] = terms / most / length * scale;
        BRIO_EXPECT(ctx, isfinite(r->plane[i][3]), BRIO_ERR_ARGUMENT, "plane %zu of the region is too far", i);
    }
    return BRIO_OK;
}

/* Writes the bounding box of the corners of a polyhedron. Returns whether a face is a wall of the box it came from,
 * which is no plane of the region. */
static bool find_bounds(const brio_polyhedron *p, int64_t walls, double low[3], double high[3]) {
    const brio_faces *f = &p->faces;
    bool open = false;
    for (int k = 0; k < 3; k++) low[k] = INFINITY, high[k] = -INFINITY;
    for (size_t i = 0; i < f->count; i++) {
        open |= f->list[i].neighbour < walls;
        for (size_t c = f->list[i].begin; c < f->list[i].end; c++)
            for (int k = 0; k < 3; k++) {
                low[k] = fmin(low[k], p->x[f->corner[c]][k]);
                high[k] = fmax(high[k], p->x[f->corner[c]][k]);
            }
    }
    return open;
}

/* Cuts the region out of a box. The box' own walls become neighbours below -num_planes. */
static brio_status cut_out(brio_region *r, const double low[3], const double high[3]) {
    BRIO_FORWARD(brio_polyhedron_set_box(&r->shape, low, high));
    for (int f = 0; f < 6; f++) r->shape.faces.list[f].neighbour -= (int64_t)r->num_planes;
    for (size_t i = 0; i < r->num_planes; i++)
        BRIO_FORWARD(brio_polyhedron_cut(&r->shape, r->plane[i], -1 - (int64_t)i));
    return BRIO_OK;
}

/* Cuts the region out of ever larger cubes; writes its bounds. A region without an end is cut by the walls of every
 * cube, until it is too thin beside a cube for doubles and seems to be empty. */
static brio_status search(brio_context *ctx, brio_region *r, double low[3], double high[3]) {
    static const char *const UNBOUNDED = "the region is unbounded, or reaches too far beside its width for doubles";
    int64_t walls = -(int64_t)r->num_planes;
    double half = 0;
    bool open = true;
    for (size_t i = 0; i < r->num_planes; i++) half = fmax(half, fabs(r->plane[i][3]));
    half = half > 0 ? 2 * half : 1;
    for (int n = 0; open && n < MOST_DOUBLINGS; n++, half *= 4) {
        const double least[3] = {-half, -half, -half}, most[3] = {half, half, half};
        BRIO_FORWARD(cut_out(r, least, most));
        BRIO_EXPECT(ctx, r->shape.faces.count > 0, BRIO_ERR_ARGUMENT, "%s",
                    n > 0 ? UNBOUNDED : "the region is empty, or too small beside the points for doubles");
        open = find_bounds(&r->shape, walls, low, high);
    }
    BRIO_EXPECT(ctx, !open, BRIO_ERR_ARGUMENT, "%s", UNBOUNDED);
    return BRIO_OK;
}

/* Returns whether plane i is the wall of a box, for i from 0 to 5 in the order of the neighbours of
 * brio_polyhedron_set_box. */
static bool is_box(const brio_region *r) {
    for (size_t i = 0; i < r->num_planes; i++)
        for (size_t k = 0; k < 3; k++)
            if (i > 5 || r->plane[i][k] != (k != i / 2 ? 0 : i % 2 ? 1 : -1)) return false;
    return r->num_planes == 6;
}

static double determinant(const brio_region *r, const int64_t walls[3]) {
    double cross[3];
    brio_cross(r->plane[-1 - walls[0]], r->plane[-1 - walls[1]], cross);
    return brio_dot(cross, r->plane[-1 - walls[2]]);
}

/* Adds a wall to those of a corner. Of all walls that meet there, three that are far from dependent stay. */
static void add_wall(const brio_region *r, brio_exact_vertex *e, int64_t wall) {
    int known = 0;
    int64_t best[3];
    while (known < 3 && e->plane[known]) known++;
    memcpy(best, e->plane, sizeof best);
    if (known < 3) best[known] = wall;
    double most = known == 3 ? fabs(determinant(r, e->plane)) : 0;
    for (int k = 0; k < 3 && known == 3; k++) {
        int64_t other[3] = {e->plane[0], e->plane[1], e->plane[2]};
        other[k] = wall;
        double size = fabs(determinant(r, other));
        if (size > most) memcpy(best, other, sizeof best);
        most = fmax(most, size);
    }
    memcpy(e->plane, best, sizeof best);
    if (known >= 2) e->orientation = determinant(r, e->plane) > 0 ? 1 : -1;
}

/* Says of each corner in which walls it lies. */
static void name_corners(brio_region *r) {
    brio_polyhedron *p = &r->shape;
    const brio_faces *f = &p->faces;
    for (size_t v = 0; v < p->num_vertices; v++) p->exact[v] = (brio_exact_vertex){{0, 0, 0}, 0};
    for (size_t i = 0; i < f->count; i++)
        for (size_t c = f->list[i].begin; c < f->list[i].end; c++)
            add_wall(r, &p->exact[f->corner[c]], f->list[i].neighbour);
}

/* Returns the volume of the polytope, from pyramids with their apex in its middle. */
static double volume_of(const brio_region *r) {
    const brio_faces *f = &r->shape.faces;
    double volume = 0, area[3], to[3];
    for (size_t i = 0; i < f->count; i++) {
        const brio_face *face = &f->list[i];
        brio_polyhedron_area(&r->shape, face, area);
        for (int k = 0; k < 3; k++) to[k] = r->shape.x[f->corner[face->begin]][k] - r->middle[k];
        volume += brio_dot(area, to) / 3;
    }
    return volume;
}

brio_status brio_region_new(brio_context *ctx, const double *planes, size_t num_planes, const double origin[3],
                            double scale, brio_region *r) {
    double low[3], high[3];
    *r = (brio_region){.num_planes = num_planes, .shape.ctx = ctx};
    if (!num_planes) return BRIO_OK;
    BRIO_FORWARD(take_planes(ctx, planes, origin, scale, r));
    if (is_box(r)) {
        for (int k = 0; k < 3; k++) low[k] = -r->plane[2 * k][3], high[k] = r->plane[2 * k + 1][3];
        BRIO_EXPECT(ctx, low[0] < high[0] && low[1] < high[1] && low[2] < high[2], BRIO_ERR_ARGUMENT,
                    "the region is empty, or too small beside the points for doubles");
        BRIO_FORWARD(brio_polyhedron_set_box(&r->shape, low, high));
        r->box = true;
        memcpy(r->low, low, sizeof low);
        memcpy(r->high, high, sizeof high);
    } else {
        BRIO_FORWARD(search(ctx, r, low, high));
        double outer[2][3], found[2][3];
        for (int k = 0; k < 3; k++) {
            double more = (high[k] - low[k]) / 8;
            outer[0][k] = low[k] - more, outer[1][k] = high[k] + more;
        }
        BRIO_FORWARD(cut_out(r, outer[0], outer[1]));
        /* so flat that rounding leaves a wall of the box */
        BRIO_EXPECT(ctx, !find_bounds(&r->shape, -(int64_t)num_planes, found[0], found[1]), BRIO_ERR_ARGUMENT,
                    "the region is too flat");
        name_corners(r);
    }
    for (int k = 0; k < 3; k++) {
        r->middle[k] = low[k] / 2 + high[k] / 2;
        r->reach = fmax(r->reach, high[k] - low[k]);
    }
    r->volume = r->box ? (high[0] - low[0]) * (high[1] - low[1]) * (high[2] - low[2]) : volume_of(r);
    BRIO_EXPECT(ctx, r->volume > 0, BRIO_ERR_ARGUMENT,
                "the region is empty, or too small beside the points for doubles");
    return BRIO_OK;
}

void brio_region_free(brio_region *r) {
    if (!r->num_planes) return;
    brio_release(r->shape.ctx, r->plane);
    brio_release(r->shape.ctx, r->given);
    brio_release(r->shape.ctx, r->terms);
    brio_polyhedron_free(&r->shape);
    r->num_planes = 0;
}

bool brio_region_is_over(const brio_region *r, size_t i, const double *x) {
    return brio_dot(r->plane[i], x) > r->plane[i][3];
}
