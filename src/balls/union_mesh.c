/* The boundary of a union of balls as a mesh: corners and points of arcs first, then patch after patch.
 *
 * An arc has points where it meets the planes of a grid, one at least. The grid is so fine that chords are near the
 * arc. Both patches of an arc have the same points. Two arcs that run side by side meet the same planes, so that their
 * chords do not cross. So the mesh is closed and manifold because the patches are (union_boundary.h, I1).
 *
 * Two arcs that are nearer to each other than their chords to them may have chords that cross. These arcs get twice as
 * many points, until nothing crosses or they have very many.
 *
 * A triangle whose corners are on a sphere of radius r, with edges of at most L, is within r - sqrt(r^2 - L^2 / 3) of
 * it: a point of the triangle, of barycentric coordinates a, b, c, has the power - (a b L1^2 + b c L2^2 + c a L3^2),
 * and a b + b c + c a is at most 1/3. */
#include "balls/union_boundary.h"
#include "base/memory.h"
#include "base/scale.h"
#include "base/vector.h"
#include <assert.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Both chosen: how often the points of an arc are doubled at most, and its points. */
enum { MOST_ROUNDS = 5, MOST_CHORDS = 1 << 12 };
static const double TURN = 6.283185307179586476925;
static const double WIDEST_STEP = 0.8; /* of a point of an arc to the next one, in radians. Chosen */

typedef struct {
    const brio_union_boundary *b;
    double error;
    brio_growing_mesh mesh;
    uint32_t *first;    /* #arcs + 1: the first vertex of each arc inside it */
    uint32_t *of_patch; /* 2 #arcs: arcs and sides, 2 arc + side, those of a patch together */
    size_t *start;      /* #patches + 1 */
    uint8_t *seen;      /* 2 #arcs */
    double *turn;       /* the points of the arc at hand, as angles from its beginning */
    size_t num_turns, turn_capacity;
    uint8_t *doubled;  /* #arcs: how often its points were */
    uint8_t *crossed;  /* #arcs: 1 if they are to be doubled */
    uint32_t *vertex;  /* the cycles of the patch at hand */
    uint32_t *arc_of;  /* the arc from each of these vertices on */
    uint8_t *crossing; /* whether the edge from it crosses another */
    size_t *cycle_end;
    size_t num_vertex, vertex_capacity, arc_of_capacity, crossing_capacity, num_cycles, cycle_capacity;
} maker;

/* Returns the longest edge on a sphere. */
static double longest_edge(double radius, double error) {
    return error < radius ? sqrt(3 * error * (2 * radius - error)) : 2 * radius;
}

/* --- arcs --- */

/* Returns the distance of the planes at which an arc has points: a power of two. */
static double step_of_planes(const maker *m, const brio_arc *a, double circle) {
    double step = WIDEST_STEP;
    for (int s = 0; s < 2; s++) {
        double longest = longest_edge(sqrt(m->b->weight[a->ball[s]]), m->error);
        if (longest < 2 * circle) step = fmin(step, 2 * asin(longest / (2 * circle)));
    }
    if (m->error < circle) step = fmin(step, 2 * acos(1 - m->error / circle));
    return ldexp(exp2(floor(log2(step * circle / sqrt(3)))), -m->doubled[a - m->b->arc]);
}

static int by_value(const void *a, const void *b) {
    double p = *(const double *)a, q = *(const double *)b;
    return (p > q) - (p < q);
}

static brio_status add_turn(maker *m, double turn, double most) {
    while (turn < 0) turn += TURN;
    while (turn >= TURN) turn -= TURN;
    if (turn >= most) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(m->b->ctx, m->turn, m->turn_capacity, m->num_turns + 1));
    m->turn[m->num_turns++] = turn;
    return BRIO_OK;
}

/* Finds the angles at which an arc, centre + u cos + v sin, meets the planes x, y, z = i step; or its middle. */
static brio_status find_turns(maker *m, const brio_arc *a, double circle, const double *centre, const double *u,
                              const double *v) {
    double step = circle > 0 ? step_of_planes(m, a, circle) : 0;
    m->num_turns = 0;
    for (int k = 0; k < 3 && step > 0; k++) {
        double reach = hypot(u[k], v[k]), phase = atan2(v[k], u[k]), last = floor((centre[k] + reach) / step);
        for (double i = ceil((centre[k] - reach) / step); i <= last; i++) {
            double turn = acos(fmin(fmax((i * step - centre[k]) / reach, -1), 1));
            BRIO_FORWARD(add_turn(m, phase + turn, a->angle));
            BRIO_FORWARD(add_turn(m, phase - turn, a->angle));
        }
    }
    for (size_t i = 0; m->num_turns < 3 && i < 3 && (!i || a->corner[0] == BRIO_NO_CORNER); i++)
        BRIO_FORWARD(add_turn(m, a->angle * (0.5 + (double)i) / 3, TURN));
    if (m->num_turns > 1) qsort(m->turn, m->num_turns, sizeof *m->turn, by_value);
    return BRIO_OK;
}

static brio_status add_arc_points(maker *m, const brio_arc *a) {
    const brio_union_boundary *b = m->b;
    const uint32_t on[3] = {a->ball[0], a->ball[1], BRIO_NO_CORNER};
    double axis[3], centre[3], u[3], v[3], distance, x = brio_circle_plane(b, a->ball[0], a->ball[1], axis, &distance);
    double circle = sqrt(fmax(0, b->weight[a->ball[0]] - x * x));
    for (size_t k = 0; k < 3; k++) centre[k] = b->centre[3 * (size_t)a->ball[0] + k] + x * axis[k];
    if (a->corner[0] != BRIO_NO_CORNER) {
        for (int k = 0; k < 3; k++) u[k] = b->corner[a->corner[0]].place[k] - centre[k];
    } else {
        double any[3] = {0};
        any[fabs(axis[0]) < 0.6 ? 0 : 1] = 1;
        brio_cross(axis, any, u);
    }
    double along = brio_dot(u, axis);
    for (int k = 0; k < 3; k++) u[k] -= along * axis[k];
    double length = brio_length(u);
    for (int k = 0; k < 3; k++) u[k] *= length > 0 ? circle / length : 0;
    brio_cross(axis, u, v);
    BRIO_FORWARD(find_turns(m, a, circle, centre, u, v));
    for (size_t i = 0; i < m->num_turns; i++) {
        double turn = m->turn[i], place[3];
        uint32_t number;
        for (int k = 0; k < 3; k++) place[k] = centre[k] + cos(turn) * u[k] + sin(turn) * v[k];
        BRIO_FORWARD(brio_grow_vertex(&m->mesh, place, on, &number));
    }
    return BRIO_OK;
}

static brio_status add_arcs(maker *m) {
    const brio_union_boundary *b = m->b;
    uint32_t number;
    m->mesh.num_vertices = 0;
    for (size_t c = 0; c < b->num_corners; c++)
        BRIO_FORWARD(brio_grow_vertex(&m->mesh, b->corner[c].place, b->corner[c].ball, &number));
    for (size_t a = 0; a < b->num_arcs; a++) {
        m->first[a] = (uint32_t)m->mesh.num_vertices;
        BRIO_FORWARD(add_arc_points(m, &b->arc[a]));
        if (a % 1024 == 0) BRIO_FORWARD(brio_look(b->ctx, 1024));
    }
    m->first[b->num_arcs] = (uint32_t)m->mesh.num_vertices;
    return BRIO_OK;
}

/* --- cycles --- */

/* Sorts the sides of arcs by their patches. */
static brio_status sort_sides(maker *m) {
    const brio_union_boundary *b = m->b;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(b->ctx, m->start, b->num_patches + 2));
    BRIO_FORWARD(BRIO_ALLOC(b->ctx, m->of_patch, 2 * b->num_arcs));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(b->ctx, m->seen, 2 * b->num_arcs));
    for (size_t i = 0; i < 2 * b->num_arcs; i++) m->start[b->arc[i / 2].patch[i % 2] + 2]++;
    for (size_t p = 0; p < b->num_patches; p++) m->start[p + 2] += m->start[p + 1];
    for (size_t i = 0; i < 2 * b->num_arcs; i++) m->of_patch[m->start[b->arc[i / 2].patch[i % 2] + 1]++] = (uint32_t)i;
    return BRIO_OK;
}

static brio_status add_to_cycle(maker *m, uint32_t vertex, uint32_t arc) {
    BRIO_FORWARD(BRIO_RESERVE(m->b->ctx, m->vertex, m->vertex_capacity, m->num_vertex + 1));
    BRIO_FORWARD(BRIO_RESERVE(m->b->ctx, m->arc_of, m->arc_of_capacity, m->num_vertex + 1));
    BRIO_FORWARD(BRIO_RESERVE(m->b->ctx, m->crossing, m->crossing_capacity, m->num_vertex + 1));
    m->arc_of[m->num_vertex] = arc;
    m->vertex[m->num_vertex++] = vertex;
    return BRIO_OK;
}

/* Follows an arc with the patch of its ball `side` on the left: forwards for ball 1, backwards for ball 0. */
static brio_status follow_arc(maker *m, uint32_t arc, int side) {
    const brio_arc *a = &m->b->arc[arc];
    uint32_t low = m->first[arc], count = m->first[arc + 1] - low;
    if (a->corner[0] != BRIO_NO_CORNER) BRIO_FORWARD(add_to_cycle(m, a->corner[!side], arc));
    for (uint32_t i = 0; i < count; i++) BRIO_FORWARD(add_to_cycle(m, side ? low + i : low + count - 1 - i, arc));
    return BRIO_OK;
}

/* Follows a cycle from a side of an arc. At a corner it goes on along the circle of its ball and the third one. */
static brio_status follow_cycle(maker *m, uint32_t from) {
    const brio_union_boundary *b = m->b;
    uint32_t at = from, ball = b->arc[from / 2].ball[from % 2];
    do {
        const brio_arc *a = &b->arc[at / 2];
        int side = (int)(at % 2), k = 0;
        m->seen[at] = 1;
        BRIO_FORWARD(follow_arc(m, at / 2, side));
        if (a->corner[0] == BRIO_NO_CORNER) break;
        const brio_corner *c = &b->corner[a->corner[side]];
        while (c->ball[k] != a->ball[!side]) k++;
        assert(k < 3);
        at = 2 * c->arc[k] + (b->arc[c->arc[k]].ball[1] == ball);
    } while (at != from);
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, m->cycle_end, m->cycle_capacity, m->num_cycles + 1));
    m->cycle_end[m->num_cycles++] = m->num_vertex;
    return BRIO_OK;
}

/* --- patches --- */

/* Finds the direction of the middle of the widest cap that another ball covers. */
static void find_covered(const maker *m, size_t patch, double covered[3]) {
    const brio_union_boundary *b = m->b;
    double least = INFINITY;
    for (size_t i = m->start[patch]; i < m->start[patch + 1]; i++) {
        const brio_arc *a = &b->arc[m->of_patch[i] / 2];
        int side = m->of_patch[i] % 2;
        double axis[3], distance, x = brio_circle_plane(b, a->ball[side], a->ball[!side], axis, &distance);
        if (x < least) least = x, memcpy(covered, axis, 3 * sizeof *axis);
    }
}

/* Follows the cycles of a patch. */
static brio_status outline_patch(maker *m, size_t patch, brio_patch_outline *o) {
    const brio_union_boundary *b = m->b;
    uint32_t ball = b->patch[patch];
    m->num_vertex = m->num_cycles = 0;
    for (size_t i = m->start[patch]; i < m->start[patch + 1]; i++) m->seen[m->of_patch[i]] = 0;
    for (size_t i = m->start[patch]; i < m->start[patch + 1]; i++)
        if (!m->seen[m->of_patch[i]]) BRIO_FORWARD(follow_cycle(m, m->of_patch[i]));
    *o = (brio_patch_outline){.ball = ball, .centre = b->centre + 3 * (size_t)ball, .radius = sqrt(b->weight[ball])};
    find_covered(m, patch, o->covered);
    o->longest = longest_edge(o->radius, m->error);
    o->vertex = m->vertex, o->cycle_end = m->cycle_end, o->num_cycles = m->num_cycles;
    return BRIO_OK;
}

/* Marks the arcs whose chords cross in a patch. */
static brio_status mark_crossed(maker *m, size_t patch) {
    brio_patch_outline o;
    BRIO_FORWARD(outline_patch(m, patch, &o));
    if (!o.num_cycles) return BRIO_OK;
    BRIO_FORWARD(brio_patch_crossings(&m->mesh, &o, m->crossing));
    for (size_t i = 0; i < m->num_vertex; i++)
        if (m->crossing[i]) m->crossed[m->arc_of[i]] = 1;
    return BRIO_OK;
}

/* Doubles the points of the arcs that are marked. Returns how many there are; patches at none of them need no look. */
static size_t double_crossed(maker *m, uint8_t *look) {
    const brio_union_boundary *b = m->b;
    size_t count = 0;
    memset(look, 0, b->num_patches);
    for (size_t a = 0; a < b->num_arcs; a++) {
        if (!m->crossed[a]) continue;
        m->crossed[a] = 0;
        if (m->first[a + 1] - m->first[a] > MOST_CHORDS / 2) continue;
        m->doubled[a]++;
        look[b->arc[a].patch[0]] = look[b->arc[a].patch[1]] = 1;
        count++;
    }
    return count;
}

/* Places the points of all arcs, so dense that chords do not cross. */
static brio_status place_arcs(maker *m) {
    const brio_union_boundary *b = m->b;
    brio_status status = BRIO_OK;
    uint8_t *look = NULL;
    BRIO_TRY(BRIO_ALLOC(b->ctx, m->first, b->num_arcs + 1));
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, m->doubled, b->num_arcs));
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, m->crossed, b->num_arcs));
    BRIO_TRY(BRIO_ALLOC(b->ctx, look, b->num_patches));
    memset(look, 1, b->num_patches);
    for (int round = 0; round < MOST_ROUNDS; round++) {
        BRIO_TRY(add_arcs(m));
        for (size_t p = 0; p < b->num_patches; p++)
            if (look[p]) BRIO_TRY(mark_crossed(m, p));
        if (!double_crossed(m, look)) break;
    }
    BRIO_TRY(add_arcs(m));
done:
    brio_release(b->ctx, look);
    return status;
}

static brio_status add_patch(maker *m, size_t patch) {
    brio_patch_outline o;
    BRIO_FORWARD(outline_patch(m, patch, &o));
    return brio_patch_triangles(&m->mesh, &o);
}

static brio_status give_mesh(maker *m, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    const brio_union_boundary *b = m->b;
    uint64_t *offsets = NULL;
    void *ball;
    size_t n = m->mesh.num_triangles;
    BRIO_TRY(BRIO_ALLOC(b->ctx, offsets, n + 1));
    for (size_t f = 0; f <= n; f++) offsets[f] = 3 * f;
    BRIO_TRY(brio_mesh_set_vertices(mesh, m->mesh.place, m->mesh.num_vertices));
    BRIO_TRY(brio_mesh_set_faces(mesh, offsets, m->mesh.corners, n));
    BRIO_TRY(brio_scale_vertices(b->ctx, mesh->vertices, mesh->num_vertices, b->exponent));
    BRIO_TRY(brio_mesh_add_face_property(mesh, "ball", BRIO_SCALAR_UINT32, &ball));
    for (size_t f = 0; f < n; f++) ((uint32_t *)ball)[f] = b->of_ball[m->mesh.of_ball[f]];
done:
    brio_release(b->ctx, offsets);
    return status;
}

brio_status brio_union_mesh(const brio_union_boundary *b, double error, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    maker m = {.b = b, .error = ldexp(error, -b->exponent), .mesh = {.ctx = b->ctx}};
    BRIO_TRY(sort_sides(&m));
    BRIO_TRY(place_arcs(&m));
    for (size_t p = 0; p < b->num_patches; p++) {
        if (p % 256 == 0) BRIO_TRY(brio_progress(b->ctx, "mesh", (double)p / (double)b->num_patches));
        BRIO_TRY(add_patch(&m, p));
    }
    BRIO_TRY(give_mesh(&m, mesh));
done:
    brio_release(b->ctx, m.mesh.place);
    brio_release(b->ctx, m.mesh.on);
    brio_release(b->ctx, m.mesh.corners);
    brio_release(b->ctx, m.mesh.of_ball);
    brio_release(b->ctx, m.first);
    brio_release(b->ctx, m.of_patch);
    brio_release(b->ctx, m.start);
    brio_release(b->ctx, m.seen);
    brio_release(b->ctx, m.turn);
    brio_release(b->ctx, m.doubled);
    brio_release(b->ctx, m.crossed);
    brio_release(b->ctx, m.arc_of);
    brio_release(b->ctx, m.crossing);
    brio_release(b->ctx, m.vertex);
    brio_release(b->ctx, m.cycle_end);
    return status;
}
