/* Triangles that span holes of the samples.
 *
 * The disc in a Delaunay triangle's plane whose border is the triangle's circle holds no sample: an empty ball through the
 * three samples cuts the plane there. So a triangle along the surface whose circle has a radius of more than K spacings
 * lies in a hole of that radius. The triangles that fill one hole all have such circles, also those at its rim with short
 * sides. But so have slivers along a sharp edge, whose discs are in the air. So wide triangles that meet across edges go
 * together, and only if one of them has a side of over K spacings.
 *
 * A part of a closed manifold is a manifold with boundary, except at vertices with several fans of triangles. There all
 * fans except the longest go, too, until nothing changes.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, section 3.3.4 (holes left open where large balls
 *           bulge out of the surface). */
#include "reconstruct/labeled_delaunay/open_holes.h"
#include "base/memory.h"
#include "base/sort.h"
#include "mesh/twins.h"
#include "reconstruct/cocone/triangle.h"
#include <math.h>

enum triangle_state { KEPT = 0, WIDE, GONE };

typedef struct {
    brio_context *ctx;
    const brio_hole_rule *rule;
    const uint32_t *faces;
    size_t num_faces;
    uint32_t *twin;  /* 3 #F: half-edges, as mesh/twins.h has them */
    uint32_t *start; /* #P: a half-edge from each point that has one */
    uint8_t *state;  /* #F: triangle_state */
    uint32_t *queue; /* triangles of a hole, then points to look at */
    size_t size, capacity;
} opening;

/* --- wide triangles --- */

/* Returns the largest spacing of the samples of a triangle, times K, squared. */
static double bound_of(const opening *o, size_t face) {
    double most = 0;
    for (size_t k = 0; k < 3; k++) most = fmax(most, o->rule->spacing[o->faces[3 * face + k]]);
    return o->rule->most * most * o->rule->most * most;
}

static const double *corner(const opening *o, size_t face, size_t k) {
    return o->rule->points + 3 * (size_t)o->faces[3 * face + k];
}

static bool is_wide(const opening *o, size_t face) {
    return brio_circle_square(corner(o, face, 0), corner(o, face, 1), corner(o, face, 2)) > bound_of(o, face);
}

static bool is_long(const opening *o, size_t face) {
    double square[3];
    brio_cross_square(corner(o, face, 0), corner(o, face, 1), corner(o, face, 2), square);
    return fmax(square[0], fmax(square[1], square[2])) > bound_of(o, face);
}

/* Lists the wide triangles that meet across edges, from one of them on, and takes each out of the wide ones. Returns
 * whether a side is long. */
static bool list_wide(opening *o, uint32_t face) {
    bool any = false;
    o->size = 0;
    o->state[face] = KEPT;
    o->queue[o->size++] = face;
    for (size_t n = 0; n < o->size; n++) {
        any |= is_long(o, o->queue[n]);
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t other = o->twin[3 * o->queue[n] + k] / 3;
            if (o->state[other] != WIDE) continue;
            o->state[other] = KEPT;
            o->queue[o->size++] = other;
        }
    }
    return any;
}

static void find_holes(opening *o) {
    for (size_t f = 0; f < o->num_faces; f++) o->state[f] = is_wide(o, f) ? WIDE : KEPT;
    for (uint32_t f = 0; f < o->num_faces; f++)
        if (o->state[f] == WIDE && list_wide(o, f))
            for (size_t n = 0; n < o->size; n++) o->state[o->queue[n]] = GONE;
}

/* --- one fan a vertex --- */

/* A run of triangles that stay, counterclockwise round a vertex from the triangle of half-edge `first` on. */
typedef struct {
    uint32_t first;
    size_t length;
} fan;

/* Returns the next half-edge from the start of h, counterclockwise. */
static uint32_t turn(const opening *o, uint32_t h) {
    return o->twin[brio_previous_corner(h)];
}

/* Returns the point at which the fan begins. */
static uint32_t rim_of(const opening *o, fan f) {
    return o->faces[brio_next_corner(f.first)];
}

static bool is_better(const opening *o, fan a, fan b) {
    return a.length != b.length ? a.length > b.length : rim_of(o, a) < rim_of(o, b);
}

/* Counts the fans at a point, and finds the best of them. Returns 0 if all triangles stay. */
static size_t count_fans(const opening *o, uint32_t p, fan *best) {
    uint32_t begin = o->start[p], h;
    size_t fans = 0;
    while (o->state[begin / 3] != GONE) { /* to a gap, so that no fan is met in two parts */
        begin = turn(o, begin);
        if (begin == o->start[p]) return 0;
    }
    fan now = {0};
    h = begin;
    do {
        h = turn(o, h);
        if (o->state[h / 3] != GONE) {
            if (now.length++ == 0) now.first = h;
        } else if (now.length > 0) {
            if (fans++ == 0 || is_better(o, now, *best)) *best = now;
            now.length = 0;
        }
    } while (h != begin);
    return fans;
}

static brio_status push_corners(opening *o, uint32_t face) {
    brio_status status = BRIO_RESERVE(o->ctx, o->queue, o->capacity, o->size + 3);
    for (size_t k = 0; status == BRIO_OK && k < 3; k++) o->queue[o->size++] = o->faces[3 * (size_t)face + k];
    return status;
}

/* Removes the triangles at a point outside one fan. */
static brio_status keep_fan(opening *o, fan kept) {
    brio_status status = BRIO_OK;
    uint32_t h = kept.first;
    for (size_t n = 0; n == 0 || h != kept.first; n++, h = turn(o, h)) {
        if (n < kept.length || o->state[h / 3] == GONE) continue;
        o->state[h / 3] = GONE;
        BRIO_TRY(push_corners(o, h / 3));
    }
done:
    return status;
}

static int compare_points(uint32_t p, uint32_t q, const void *user) {
    (void)user;
    return (p > q) - (p < q);
}

/* Removes all fans except the best at each point. Works in rounds, each in the order of the points. */
static brio_status drop_small_fans(opening *o) {
    brio_status status = BRIO_OK;
    fan best = {0};
    o->size = 0;
    for (uint32_t f = 0; f < o->num_faces; f++)
        if (o->state[f] == GONE) BRIO_TRY(push_corners(o, f));
    for (size_t begin = 0, end; begin < o->size; begin = end) {
        end = o->size;
        brio_sort_indices(o->queue + begin, end - begin, compare_points, NULL);
        for (size_t n = begin; n < end; n++)
            if (count_fans(o, o->queue[n], &best) > 1) BRIO_TRY(keep_fan(o, best));
    }
done:
    return status;
}

/* --- all of it --- */

static brio_status link_faces(opening *o, size_t num_points) {
    brio_status status = BRIO_OK;
    brio_mesh mesh = {.context = o->ctx, .num_vertices = num_points, .num_faces = o->num_faces};
    uint32_t *corners = NULL;
    BRIO_TRY(BRIO_ALLOC(o->ctx, mesh.face_offsets, o->num_faces + 1));
    BRIO_TRY(BRIO_ALLOC(o->ctx, corners, 3 * o->num_faces));
    for (size_t f = 0; f <= o->num_faces; f++) mesh.face_offsets[f] = 3 * f;
    for (size_t h = 0; h < 3 * o->num_faces; h++) corners[h] = o->faces[h];
    mesh.face_vertices = corners;
    BRIO_TRY(brio_mesh_twins(o->ctx, &mesh, &o->twin));
    BRIO_TRY(BRIO_ALLOC(o->ctx, o->start, num_points));
    for (uint32_t h = 0; h < 3 * o->num_faces; h++) o->start[o->faces[h]] = h;
done:
    brio_release(o->ctx, mesh.face_offsets);
    brio_release(o->ctx, corners);
    return status;
}

brio_status brio_leave_holes_open(brio_context *ctx, const brio_hole_rule *rule, uint32_t *faces, size_t *num_faces) {
    brio_status status = BRIO_OK;
    opening o = {.ctx = ctx, .rule = rule, .faces = faces, .num_faces = *num_faces};
    size_t kept = 0;
    BRIO_TRY(link_faces(&o, rule->num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, o.state, o.num_faces));
    BRIO_TRY(BRIO_RESERVE(ctx, o.queue, o.capacity, o.num_faces));
    find_holes(&o);
    BRIO_TRY(drop_small_fans(&o));
    for (size_t f = 0; f < o.num_faces; f++) {
        if (o.state[f] == GONE) continue;
        for (size_t k = 0; k < 3; k++) faces[3 * kept + k] = faces[3 * f + k];
        kept++;
    }
    *num_faces = kept;
done:
    brio_release(ctx, o.twin);
    brio_release(ctx, o.start);
    brio_release(ctx, o.state);
    brio_release(ctx, o.queue);
    return status;
}
