/* Polygons cut into triangles, by ears where a fan will not do.
 *
 * An ear is a corner whose triangle with its neighbours is turned as the polygon is and holds no other corner. The
 * polygon is seen along the axis of the longest side of its normal; every sign there is exact. What is left of a
 * polygon without an ear, which crosses itself, becomes a fan.
 *
 * Based on: Meisters. Polygons have ears. American Mathematical Monthly 1975. */
#include "mesh/cut_polygon.h"
#include "mesh/extent.h"
#include <math.h>
#include <string.h>

enum { MOST_EARS = 256 /* corners of a polygon that is cut into ears, whose cost may be their cube; chosen */ };

/* A polygon seen along an axis. */
typedef struct {
    const double *vertices;
    int x, y; /* the other axes, in the order in which the polygon is counterclockwise */
} view;

static int turn(const view *w, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t corner[3] = {a, b, c};
    double p[3][2];
    for (int i = 0; i < 3; i++) {
        p[i][0] = w->vertices[3 * (size_t)corner[i] + (size_t)w->x];
        p[i][1] = w->vertices[3 * (size_t)corner[i] + (size_t)w->y];
    }
    return brio_orient2d(p[0], p[1], p[2]);
}

static view view_of(const double *vertices, const uint32_t *corners, size_t count) {
    double normal[3] = {0, 0, 0}, most = 0;
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < 3; k++) most = fmax(most, fabs(vertices[3 * (size_t)corners[i] + k]));
    double scale = most > 0 ? ldexp(1, most >= 1 ? -ilogb(most) - 1 : 0) : 1;
    for (size_t i = 2; i < count; i++) {
        double n[3];
        brio_scaled_normal(vertices + 3 * (size_t)corners[0], vertices + 3 * (size_t)corners[i - 1],
                           vertices + 3 * (size_t)corners[i], scale, n);
        for (int k = 0; k < 3; k++) normal[k] += n[k];
    }
    int axis = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(normal[k]) > fabs(normal[axis])) axis = k;
    view w = {vertices, (axis + 1) % 3, (axis + 2) % 3};
    if (normal[axis] < 0) w.x = (axis + 2) % 3, w.y = (axis + 1) % 3;
    return w;
}

static bool holds(const view *w, const uint32_t t[3], uint32_t p) {
    if (p == t[0] || p == t[1] || p == t[2]) return false;
    return turn(w, t[0], t[1], p) >= 0 && turn(w, t[1], t[2], p) >= 0 && turn(w, t[2], t[0], p) >= 0;
}

/* Returns whether corner i of those left is an ear. */
static bool is_ear(const view *w, const uint32_t *left, size_t count, size_t i) {
    const uint32_t t[3] = {left[(i + count - 1) % count], left[i], left[(i + 1) % count]};
    if (turn(w, t[0], t[1], t[2]) <= 0) return false;
    for (size_t j = 0; j < count; j++)
        if (holds(w, t, left[j])) return false;
    return true;
}

static void cut_fan(const uint32_t *corners, size_t count, uint32_t (*triangles)[3]) {
    for (size_t i = 2; i < count; i++) {
        triangles[i - 2][0] = corners[0];
        triangles[i - 2][1] = corners[i - 1];
        triangles[i - 2][2] = corners[i];
    }
}

void brio_cut_polygon(const double *vertices, const uint32_t *corners, size_t count, uint32_t *room,
                      uint32_t (*triangles)[3]) {
    bool is_turned = false;
    cut_fan(corners, count, triangles);
    if (count == 3 || count > MOST_EARS) return;
    view w = view_of(vertices, corners, count);
    for (size_t i = 0; i + 2 < count; i++) is_turned |= turn(&w, triangles[i][0], triangles[i][1], triangles[i][2]) < 0;
    if (!is_turned) return;
    memcpy(room, corners, count * sizeof *room);
    size_t first = 0, misses = 0;
    while (count > 3 && misses < count) {
        size_t i = first % count;
        if (!is_ear(&w, room, count, i)) {
            first = i + 1;
            misses++;
            continue;
        }
        (*triangles)[0] = room[(i + count - 1) % count];
        (*triangles)[1] = room[i];
        (*triangles)[2] = room[(i + 1) % count];
        triangles++;
        memmove(room + i, room + i + 1, (--count - i) * sizeof *room);
        misses = 0;
    }
    cut_fan(room, count, triangles);
}
