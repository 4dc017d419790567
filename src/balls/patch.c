/* The triangles of one patch of a sphere: a region bounded by cycles of points, which are on circles of that sphere.
 *
 *   1. The points go to the plane, from a place of the sphere outside the patch (a stereographic projection). There the
 *      patch is a polygon with holes.
 *   2. Holes are joined to the outline by bridges, the shortest ones first that cross nothing.
 *   3. Ears are cut off, the one with the shortest new edge first: so narrow patches are crossed, not followed.
 *   4. Edges inside the patch are halved until they are short. The new vertices are on the sphere.
 *
 * The result is a disk with the right holes whatever the positions are. Where edges of the cycles cross in the plane,
 * which happens where arcs meet at less than their rounding, triangles may be turned over.
 *
 * Based on: Meisters. Polygons have ears. AMM 1975. */
#include "balls/union_boundary.h"
#include "base/memory.h"
#include "base/vector.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum { NONE = UINT32_MAX, MOST_PASSES = 40, BISECTIONS = 40 };
static const double SAME = 1e-9; /* chosen: of the radius; corners are known less well where spheres hardly cross */

/* A place in the outline. A vertex at which a bridge ends has several. */
typedef struct {
    double x, y;
    uint32_t vertex, next, previous;
    double worth; /* of the ear here; 0: there is none */
} slot;

typedef struct {
    brio_growing_mesh *m;
    const brio_patch_outline *o;
    double e1[3], e2[3]; /* of the plane */
    slot *slot;
    size_t num_slots;
    uint32_t *corners; /* three vertices for each triangle */
    size_t num_corners, capacity;
} work;

/* --- the plane --- */

static void make_frame(work *w) {
    const double *u = w->o->covered;
    int least = fabs(u[0]) < fabs(u[1]) ? 0 : 1;
    if (fabs(u[2]) < fabs(u[least])) least = 2;
    double a[3] = {least == 0, least == 1, least == 2}, back[3] = {-u[0], -u[1], -u[2]};
    brio_cross(u, a, w->e1);
    double length = brio_length(w->e1);
    for (int k = 0; k < 3; k++) w->e1[k] /= length;
    brio_cross(back, w->e1, w->e2);
}

static void to_plane(const work *w, const double *place, double *x, double *y) {
    double v[3];
    for (int k = 0; k < 3; k++) v[k] = place[k] - w->o->centre[k];
    double length = brio_length(v), depth = 1 - brio_dot(v, w->o->covered) / length;
    if (!(depth > 0x1p-50)) depth = 0x1p-50;
    *x = brio_dot(v, w->e1) / length / depth;
    *y = brio_dot(v, w->e2) / length / depth;
}

static void from_plane(const work *w, double x, double y, double place[3]) {
    double square = x * x + y * y, scale = 2 / (1 + square), up = (square - 1) / (1 + square);
    for (int k = 0; k < 3; k++)
        place[k] = w->o->centre[k] + w->o->radius * (scale * (x * w->e1[k] + y * w->e2[k]) + up * w->o->covered[k]);
}

static double area(const slot *a, const slot *b, const slot *c) {
    return (b->x - a->x) * (c->y - a->y) - (b->y - a->y) * (c->x - a->x);
}

/* Returns whether two places are one up to rounding, as corners at which more than three spheres meet are. */
static bool same_place(const slot *a, const slot *b) {
    double x = a->x - b->x, y = a->y - b->y, scale = SAME * (1 + a->x * a->x + a->y * a->y);
    return a->vertex == b->vertex || x * x + y * y <= scale * scale;
}

/* --- holes --- */

/* Links the slots of each cycle in rings. */
static void link_cycles(work *w) {
    size_t first = 0;
    for (size_t c = 0; c < w->o->num_cycles; c++) {
        size_t end = w->o->cycle_end[c];
        for (size_t i = first; i < end; i++) {
            slot *s = &w->slot[i];
            s->vertex = w->o->vertex[i];
            to_plane(w, w->m->place + 3 * (size_t)s->vertex, &s->x, &s->y);
            s->next = (uint32_t)(i + 1 < end ? i + 1 : first);
            s->previous = (uint32_t)(i > first ? i - 1 : end - 1);
        }
        first = end;
    }
    w->num_slots = first;
}

static double cycle_area(const work *w, size_t first, size_t end) {
    double sum = 0;
    for (size_t i = first; i < end; i++) {
        const slot *a = &w->slot[i], *b = &w->slot[a->next];
        sum += a->x * b->y - a->y * b->x;
    }
    return sum;
}

static bool boxes_meet(const slot *a, const slot *b, const slot *c, const slot *d) {
    return fmax(a->x, b->x) >= fmin(c->x, d->x) && fmax(c->x, d->x) >= fmin(a->x, b->x) &&
           fmax(a->y, b->y) >= fmin(c->y, d->y) && fmax(c->y, d->y) >= fmin(a->y, b->y);
}

static bool crosses(const slot *a, const slot *b, const slot *c, const slot *d) {
    if (!boxes_meet(a, b, c, d)) return false;
    if (same_place(a, c) || same_place(a, d) || same_place(b, c) || same_place(b, d)) return false;
    return (area(a, b, c) > 0) != (area(a, b, d) > 0) && (area(c, d, a) > 0) != (area(c, d, b) > 0);
}

/* Returns whether a bridge crosses no edge. Edges are counted from all slots, whose `next` are edges of cycles and
 * bridges. */
static bool is_clear(const work *w, const slot *a, const slot *b) {
    for (size_t i = 0; i < w->num_slots; i++)
        if (crosses(a, b, &w->slot[i], &w->slot[w->slot[i].next])) return false;
    return true;
}

/* Finds the shortest bridge from the outline (`joined` 1) to a hole: one that crosses nothing, if there is one. */
static void find_bridge(const work *w, const uint8_t *joined, uint32_t *from, uint32_t *to) {
    double least = INFINITY, any = INFINITY;
    for (uint32_t i = 0; i < w->num_slots; i++) {
        for (uint32_t j = 0; joined[i] && j < w->num_slots; j++) {
            if (joined[j]) continue;
            double x = w->slot[i].x - w->slot[j].x, y = w->slot[i].y - w->slot[j].y, square = x * x + y * y;
            if (square < any && least == INFINITY) any = square, *from = i, *to = j;
            if (square < least && is_clear(w, &w->slot[i], &w->slot[j])) least = square, *from = i, *to = j;
        }
    }
}

/* Joins the cycle of slot j to that of slot i by a bridge there and back. */
static void add_bridge(work *w, uint8_t *joined, uint32_t i, uint32_t j) {
    uint32_t a = (uint32_t)w->num_slots, b = a + 1; /* copies of i and j on the way back */
    for (uint32_t at = j; !joined[at]; at = w->slot[at].next) joined[at] = 1;
    w->slot[a] = w->slot[i];
    w->slot[b] = w->slot[j];
    w->slot[w->slot[i].next].previous = a;
    w->slot[w->slot[j].previous].next = b;
    w->slot[i].next = j;
    w->slot[b].next = a;
    w->slot[a].previous = b;
    w->slot[b].previous = w->slot[j].previous;
    w->slot[j].previous = i;
    joined[a] = joined[b] = 1;
    w->num_slots += 2;
}

static brio_status join_holes(work *w) {
    brio_status status = BRIO_OK;
    uint8_t *joined = NULL;
    size_t first = 0, outline = 0;
    double most = -INFINITY;
    BRIO_TRY(BRIO_ALLOC_ZERO(w->m->ctx, joined, w->num_slots + 2 * w->o->num_cycles));
    for (size_t c = 0; c < w->o->num_cycles; first = w->o->cycle_end[c++]) {
        double its = cycle_area(w, first, w->o->cycle_end[c]);
        if (its > most) most = its, outline = first;
    }
    for (uint32_t at = (uint32_t)outline; !joined[at]; at = w->slot[at].next) joined[at] = 1;
    for (size_t c = 1; c < w->o->num_cycles; c++) {
        uint32_t from = 0, to = 0;
        find_bridge(w, joined, &from, &to);
        add_bridge(w, joined, from, to);
        BRIO_TRY(brio_look(w->m->ctx, w->num_slots));
    }
done:
    brio_release(w->m->ctx, joined);
    return status;
}

/* --- ears --- */

static double square_side(const slot *a, const slot *b) {
    return (a->x - b->x) * (a->x - b->x) + (a->y - b->y) * (a->y - b->y);
}

/* Returns how good the ear at a slot is: the inverse of the square of its new edge, on the sphere; 0
 * where another point of the outline is in it, or the corners are not distinct. */
static double ear_worth(const work *w, uint32_t at) {
    const slot *b = &w->slot[at], *a = &w->slot[b->previous], *c = &w->slot[b->next];
    double twice = area(a, b, c);
    if (!(twice > 0) || a->vertex == c->vertex) return 0;
    for (uint32_t i = c->next; i != b->previous; i = w->slot[i].next) {
        const slot *p = &w->slot[i];
        if (same_place(p, a) || same_place(p, b) || same_place(p, c)) continue;
        if (area(a, b, p) >= 0 && area(b, c, p) >= 0 && area(c, a, p) >= 0) return 0;
    }
    return (1 + a->x * a->x + a->y * a->y) * (1 + c->x * c->x + c->y * c->y) / (square_side(c, a) + 1e-300);
}

/* Returns the slot whose ear is cut next: the best one, or where there is none the one of least area with three
 * distinct corners. */
static uint32_t next_ear(const work *w, uint32_t start) {
    uint32_t best = NONE, spare = NONE;
    double most = 0, least = INFINITY;
    uint32_t i = start;
    do {
        const slot *b = &w->slot[i], *a = &w->slot[b->previous], *c = &w->slot[b->next];
        double turned = fabs(area(a, b, c));
        if (b->worth > most) most = b->worth, best = i;
        if (a->vertex != c->vertex && turned < least) least = turned, spare = i;
        i = b->next;
    } while (i != start);
    return best != NONE ? best : spare != NONE ? spare : start;
}

static brio_status cut_ear(work *w, uint32_t at) {
    slot *b = &w->slot[at], *a = &w->slot[b->previous], *c = &w->slot[b->next];
    a->next = b->next;
    c->previous = b->previous;
    if (a->vertex == c->vertex || a->vertex == b->vertex || b->vertex == c->vertex) return BRIO_OK; /* there and back */
    BRIO_FORWARD(BRIO_RESERVE(w->m->ctx, w->corners, w->capacity, w->num_corners + 3));
    w->corners[w->num_corners++] = a->vertex;
    w->corners[w->num_corners++] = b->vertex;
    w->corners[w->num_corners++] = c->vertex;
    return BRIO_OK;
}

static brio_status cut_ears(work *w) {
    uint32_t start = 0;
    size_t left = w->num_slots;
    for (uint32_t i = 0; i < left; i++) w->slot[i].worth = ear_worth(w, i);
    for (; left > 2; left--) {
        uint32_t ear = next_ear(w, start);
        if (!(w->slot[ear].worth > 0)) { /* ears that were blocked may be free now */
            uint32_t i = ear;
            do w->slot[i].worth = ear_worth(w, i), i = w->slot[i].next;
            while (i != ear);
            ear = next_ear(w, ear);
        }
        uint32_t before = w->slot[ear].previous, after = w->slot[ear].next;
        BRIO_FORWARD(cut_ear(w, ear));
        w->slot[before].worth = ear_worth(w, before);
        w->slot[after].worth = ear_worth(w, after);
        start = before;
        BRIO_FORWARD(brio_look(w->m->ctx, left));
    }
    return BRIO_OK;
}

/* --- short edges --- */

/* An edge of the triangles: its ends, how many triangles have it, and its middle, or NONE. */
typedef struct {
    uint32_t end[2], triangles, middle;
} edge;

typedef struct {
    edge *at;
    size_t mask;
} edge_table;

static edge *find_edge(const edge_table *t, uint32_t u, uint32_t v) {
    uint32_t low = u < v ? u : v, high = u < v ? v : u;
    size_t h = (((uint64_t)low << 32 | high) * 0x9E3779B97F4A7C15u) >> 20;
    for (;; h++) {
        edge *e = &t->at[h & t->mask];
        if (!e->triangles || (e->end[0] == low && e->end[1] == high)) {
            e->end[0] = low, e->end[1] = high;
            return e;
        }
    }
}

static brio_status make_edges(const work *w, edge_table *t) {
    size_t size = 16;
    while (size < 2 * w->num_corners) size *= 2;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(w->m->ctx, t->at, size));
    t->mask = size - 1;
    for (size_t c = 0; c < w->num_corners; c++) {
        edge *e = find_edge(t, w->corners[c], w->corners[c % 3 == 2 ? c - 2 : c + 1]);
        e->triangles++;
        e->middle = NONE;
    }
    return BRIO_OK;
}

/* Returns whether both ends are on one circle: then another patch may have an edge with the same ends. */
static bool on_one_circle(const work *w, const edge *e) {
    const uint32_t *p = w->m->on[e->end[0]], *q = w->m->on[e->end[1]];
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (p[i] != BRIO_NO_CORNER && p[i] == q[j] && p[i] != w->o->ball) return true;
    return false;
}

/* Places the middle of an edge: the point of its line in the plane, or of its arc if the patch is the whole sphere,
 * that is as far from one end as from the other. */
static void place_middle(const work *w, const double *p, const double *q, double middle[3]) {
    if (!w->o->num_cycles) {
        double v[3];
        for (int k = 0; k < 3; k++) v[k] = 0.5 * (p[k] + q[k]) - w->o->centre[k];
        double length = brio_length(v);
        for (int k = 0; k < 3; k++) middle[k] = w->o->centre[k] + v[k] * (w->o->radius / length);
        return;
    }
    double a[2], b[2], low = 0, high = 1;
    to_plane(w, p, &a[0], &a[1]);
    to_plane(w, q, &b[0], &b[1]);
    for (int i = 0; i < BISECTIONS; i++) {
        double t = 0.5 * (low + high);
        from_plane(w, a[0] + t * (b[0] - a[0]), a[1] + t * (b[1] - a[1]), middle);
        if (brio_square_distance(middle, p) < brio_square_distance(middle, q))
            low = t;
        else
            high = t;
    }
}

static brio_status halve_edges(work *w, const edge_table *t, size_t *halved) {
    const uint32_t on[3] = {w->o->ball, BRIO_NO_CORNER, BRIO_NO_CORNER};
    *halved = 0;
    for (size_t c = 0; c < w->num_corners; c++) { /* in the order of the triangles, not of the table */
        edge *e = find_edge(t, w->corners[c], w->corners[c % 3 == 2 ? c - 2 : c + 1]);
        const double *p = w->m->place + 3 * (size_t)e->end[0], *q = w->m->place + 3 * (size_t)e->end[1];
        double middle[3];
        if (e->triangles < 2 || e->middle != NONE) continue;
        if (brio_square_distance(p, q) <= w->o->longest * w->o->longest && !on_one_circle(w, e)) continue;
        place_middle(w, p, q, middle);
        BRIO_FORWARD(brio_grow_vertex(w->m, middle, on, &e->middle));
        ++*halved;
    }
    return BRIO_OK;
}

static void put(uint32_t *to, uint32_t a, uint32_t b, uint32_t c) {
    to[0] = a, to[1] = b, to[2] = c;
}

/* Cuts a triangle along the middles of its edges. Returns the number of its parts. */
static size_t cut_triangle(const brio_growing_mesh *m, const uint32_t *v, const uint32_t *mid, uint32_t *to) {
    int count = 0, first = 0;
    for (int k = 0; k < 3; k++) count += mid[k] != NONE;
    if (count == 0) return put(to, v[0], v[1], v[2]), 1;
    if (count == 3) {
        for (int k = 0; k < 3; k++) put(to + 3 * k, v[k], mid[k], mid[(k + 2) % 3]);
        return put(to + 9, mid[0], mid[1], mid[2]), 4;
    }
    while (count == 1 ? mid[first] == NONE : mid[first] != NONE) first++;
    int a = first, b = (first + 1) % 3, c = (first + 2) % 3; /* edge k runs from corner k to the next one */
    if (count == 1) return put(to, v[a], mid[a], v[c]), put(to + 3, mid[a], v[b], v[c]), 2;
    put(to, mid[b], v[c], mid[c]); /* edge a is whole */
    const double *p = m->place;
    if (brio_square_distance(p + 3 * (size_t)v[a], p + 3 * (size_t)mid[b]) <
        brio_square_distance(p + 3 * (size_t)v[b], p + 3 * (size_t)mid[c]))
        put(to + 3, v[a], v[b], mid[b]), put(to + 6, v[a], mid[b], mid[c]);
    else
        put(to + 3, v[a], v[b], mid[c]), put(to + 6, v[b], mid[b], mid[c]);
    return 3;
}

static brio_status cut_triangles(work *w, const edge_table *t) {
    uint32_t *corners = NULL;
    size_t capacity = 0, count = 0;
    brio_status status = BRIO_OK;
    for (size_t f = 0; f < w->num_corners; f += 3) {
        uint32_t mid[3];
        for (size_t k = 0; k < 3; k++) mid[k] = find_edge(t, w->corners[f + k], w->corners[f + (k + 1) % 3])->middle;
        BRIO_TRY(BRIO_RESERVE(w->m->ctx, corners, capacity, count + 12));
        count += 3 * cut_triangle(w->m, w->corners + f, mid, corners + count);
    }
    uint32_t *old = w->corners;
    w->corners = corners, w->num_corners = count, w->capacity = capacity;
    corners = old;
done:
    brio_release(w->m->ctx, corners);
    return status;
}

static brio_status shorten_edges(work *w) {
    size_t halved = 1;
    for (int pass = 0; halved && pass < MOST_PASSES; pass++) {
        edge_table t = {0};
        brio_status status = make_edges(w, &t);
        if (status == BRIO_OK) status = halve_edges(w, &t, &halved);
        if (status == BRIO_OK && halved) status = cut_triangles(w, &t);
        brio_release(w->m->ctx, t.at);
        BRIO_FORWARD(status);
        BRIO_FORWARD(brio_look(w->m->ctx, w->num_corners));
    }
    return BRIO_OK;
}

/* --- all of it --- */

brio_status brio_grow_vertex(brio_growing_mesh *m, const double place[3], const uint32_t on[3], uint32_t *number) {
    BRIO_EXPECT(m->ctx, m->num_vertices < UINT32_MAX - 1, BRIO_ERR_TOO_LARGE, "the mesh has over 2^32 - 2 vertices");
    BRIO_FORWARD(BRIO_RESERVE(m->ctx, m->place, m->place_capacity, 3 * m->num_vertices + 3));
    BRIO_FORWARD(BRIO_RESERVE(m->ctx, m->on, m->on_capacity, m->num_vertices + 1));
    memcpy(m->place + 3 * m->num_vertices, place, 3 * sizeof *place);
    memcpy(m->on[m->num_vertices], on, 3 * sizeof *on);
    *number = (uint32_t)m->num_vertices++;
    return BRIO_OK;
}

/* Makes an octahedron of the sphere. */
static brio_status make_octahedron(work *w) {
    const uint32_t on[3] = {w->o->ball, BRIO_NO_CORNER, BRIO_NO_CORNER};
    uint32_t v[6];
    for (int i = 0; i < 6; i++) {
        double place[3] = {w->o->centre[0], w->o->centre[1], w->o->centre[2]};
        place[i / 2] += i % 2 ? -w->o->radius : w->o->radius;
        BRIO_FORWARD(brio_grow_vertex(w->m, place, on, &v[i]));
    }
    BRIO_FORWARD(BRIO_RESERVE(w->m->ctx, w->corners, w->capacity, 24));
    for (int i = 0; i < 8; i++) {
        uint32_t x = v[i & 1], y = v[2 + (i >> 1 & 1)], z = v[4 + (i >> 2)];
        bool turned = (i & 1) ^ (i >> 1 & 1) ^ (i >> 2);
        put(w->corners + w->num_corners, x, turned ? z : y, turned ? y : z);
        w->num_corners += 3;
    }
    return BRIO_OK;
}

brio_status brio_patch_crossings(brio_growing_mesh *m, const brio_patch_outline *o, uint8_t *crossing) {
    brio_status status = BRIO_OK;
    work w = {.m = m, .o = o};
    make_frame(&w);
    BRIO_TRY(BRIO_ALLOC(m->ctx, w.slot, o->cycle_end[o->num_cycles - 1]));
    link_cycles(&w);
    for (size_t i = 0; i < w.num_slots; i++) {
        const slot *a = &w.slot[i], *b = &w.slot[a->next];
        crossing[i] = 0;
        for (size_t j = 0; j < i; j++)
            if (crosses(a, b, &w.slot[j], &w.slot[w.slot[j].next])) crossing[i] = crossing[j] = 1;
        BRIO_TRY(brio_look(m->ctx, 1 + i / 64));
    }
done:
    brio_release(m->ctx, w.slot);
    return status;
}

static brio_status give_triangles(work *w) {
    brio_growing_mesh *m = w->m;
    size_t count = w->num_corners / 3;
    BRIO_FORWARD(BRIO_RESERVE(m->ctx, m->corners, m->corner_capacity, m->num_corners + w->num_corners));
    BRIO_FORWARD(BRIO_RESERVE(m->ctx, m->of_ball, m->ball_capacity, m->num_triangles + count));
    memcpy(m->corners + m->num_corners, w->corners, w->num_corners * sizeof *w->corners);
    for (size_t i = 0; i < count; i++) m->of_ball[m->num_triangles + i] = w->o->ball;
    m->num_corners += w->num_corners;
    m->num_triangles += count;
    return BRIO_OK;
}

brio_status brio_patch_triangles(brio_growing_mesh *m, const brio_patch_outline *o) {
    brio_status status = BRIO_OK;
    work w = {.m = m, .o = o};
    if (!o->num_cycles) {
        BRIO_TRY(make_octahedron(&w));
    } else {
        make_frame(&w);
        BRIO_TRY(BRIO_ALLOC(m->ctx, w.slot, o->cycle_end[o->num_cycles - 1] + 2 * o->num_cycles));
        link_cycles(&w);
        BRIO_TRY(join_holes(&w));
        BRIO_TRY(cut_ears(&w));
    }
    BRIO_TRY(shorten_edges(&w));
    BRIO_TRY(give_triangles(&w));
done:
    brio_release(m->ctx, w.slot);
    brio_release(m->ctx, w.corners);
    return status;
}
