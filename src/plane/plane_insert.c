/* Incremental insertion: locate, dig the cavity, fill the cavity.
 *
 * The triangles in conflict with the point are a disk. A depth-first search that crosses the edges of each triangle
 * counterclockwise meets the edges of the disk's boundary counterclockwise. So the new triangles are made in their
 * cyclic order, and each new triangle is the mate of the next one.
 *
 * Two versions are compiled: plain records, and records with weights or a third coordinate.
 *
 * Based on: Bowyer. Computing Dirichlet tessellations. The Computer Journal 1981.
 *           Watson. Computing the n-dimensional Delaunay tessellation ... The Computer Journal 1981. */
#include "plane/plane_insert.h"
#include "base/memory.h"
#include "plane/plane_walk.h"
#include <assert.h>

#define ALWAYS_INLINE static inline __attribute__((always_inline))

static brio_status grow(brio_context *ctx, brio_plane_list *list, size_t more) {
    return BRIO_RESERVE(ctx, list->item, list->capacity, list->count + more);
}

/* Makes room for the items that one step of the search can add. */
ALWAYS_INLINE brio_status reserve(brio_context *ctx, brio_plane_list *list, size_t more) {
    return list->count + more <= list->capacity ? BRIO_OK : grow(ctx, list, more);
}

/* Returns whether triangle t conflicts with x. On the line of a hull edge, the conflict of the infinite triangle is
 * that of the triangle behind the edge: its circle meets the line where the edge's own circle does. */
ALWAYS_INLINE bool in_conflict(brio_plane_store *s, uint32_t t, const double *x, const bool general) {
    assert(t < s->count);
    const brio_plane_record *r = s->record;
    const uint32_t *v = s->triangle[t].vertex;
    if (v[2] == s->infinite) {
        int side = brio_orient2d_sign(&s->filter, r[v[0]], r[v[1]], x);
        if (side) return side > 0;
        v = s->triangle[brio_triangle_of(s->triangle[t].mate[2])].vertex;
        assert(v[2] != s->infinite); /* behind a hull edge is a finite triangle (I2) */
    }
    assert(v[0] != s->infinite && v[1] != s->infinite); /* I2 */
    s->stats.incircle_calls++;
    return brio_circle_conflict(&s->filter, r[v[0]], r[v[1]], r[v[2]], x, general);
}

/* --- points that become no vertex --- */

/* Returns the vertex of a finite triangle at the place of x, or the infinite vertex. */
ALWAYS_INLINE uint32_t vertex_at(const brio_plane_store *s, uint32_t t, const double *x) {
    const uint32_t *v = s->triangle[t].vertex;
    for (int i = 0; i < 3; i++)
        if (brio_same_place(s->record[v[i]], x)) return v[i];
    return s->infinite;
}

/* Returns whether p, coincident with vertex v, adds nothing. Of equal weights the lower index keeps the name. */
static bool absorbed(brio_plane_store *s, uint32_t p, uint32_t v) {
    assert(s->representative[p] == p && s->representative[v] == v); /* I6: p is not in yet, and v is a vertex */
    double wp = s->record[p][3], wv = s->record[v][3];
    if (wp > wv) return false;
    if (wp == wv && s->caller[p] < s->caller[v]) {
        uint32_t swap = s->caller[p];
        s->caller[p] = s->caller[v], s->caller[v] = swap;
    }
    s->representative[p] = v;
    return true;
}

/* Returns whether p, which triangle t holds or conflicts with, becomes a vertex. */
ALWAYS_INLINE bool becomes_vertex(brio_plane_store *s, uint32_t p, uint32_t t, const bool general) {
    const double *x = s->record[p];
    if (s->triangle[t].vertex[2] == s->infinite) return true;
    uint32_t v = vertex_at(s, t, x);
    if (v != s->infinite && absorbed(s, p, v)) return false;
    if (!general || !s->weighted || in_conflict(s, t, x, true)) return true;
    s->representative[p] = s->triangle[t].vertex[0];
    return false;
}

/* --- the cavity --- */

static inline void push(brio_plane_list *list, uint32_t item) {
    assert(list->count < list->capacity);
    list->item[list->count++] = item;
}

/* Adds triangle t to the cavity, entered by its edge in slot i; the edges after it will be looked at
 * counterclockwise. */
ALWAYS_INLINE void dig_triangle(brio_plane_store *s, uint32_t t, uint32_t i, const bool general) {
    assert(t < s->count && i < 3 && !(general && s->dug && s->dug[t])); /* each triangle is dug once */
    const uint32_t *mate = s->triangle[t].mate;
    push(&s->cavity, t);
    if (general && s->dug) s->dug[t] = 1;
    push(&s->ahead, mate[brio_slot_before(i)]);
    push(&s->ahead, mate[brio_slot_after(i)]);
}

/* Finds the cavity of x and its boundary, from triangle t in conflict. */
ALWAYS_INLINE brio_status dig(brio_plane_store *s, uint32_t t, const double *x, const bool general) {
    s->ahead.count = s->cavity.count = s->boundary.count = 0;
    BRIO_FORWARD(reserve(s->ctx, &s->ahead, 3));
    BRIO_FORWARD(reserve(s->ctx, &s->cavity, 1));
    push(&s->ahead, s->triangle[t].mate[0]);
    dig_triangle(s, t, 0, general);
    uint32_t first = s->ahead.item[0]; /* edge 0 comes first */
    s->ahead.item[0] = s->ahead.item[1], s->ahead.item[1] = s->ahead.item[2], s->ahead.item[2] = first;
    while (s->ahead.count) {
        uint32_t g = s->ahead.item[--s->ahead.count], u = brio_triangle_of(g);
        if (general && s->dug && s->dug[u]) continue; /* an edge inside the cavity, around a hidden vertex */
        BRIO_FORWARD(reserve(s->ctx, &s->ahead, 2));
        BRIO_FORWARD(reserve(s->ctx, &s->cavity, 1));
        BRIO_FORWARD(reserve(s->ctx, &s->boundary, 1));
        if (in_conflict(s, u, x, general))
            dig_triangle(s, u, brio_edge_slot(g), general);
        else
            push(&s->boundary, g);
    }
    assert(s->boundary.count >= 3 && s->cavity.count > 0); /* a disk */
    assert((general && s->weighted) || s->boundary.count == s->cavity.count + 2);
    return BRIO_OK;
}

/* Gives the vertices inside the cavity a representative: the boundary's vertices are marked by their own names, which
 * differ from p. */
static void hide_inner_vertices(brio_plane_store *s, uint32_t p) {
    uint32_t *representative = s->representative;
    for (size_t i = 0; i < s->cavity.count; i++)
        for (int k = 0; k < 3; k++) representative[s->triangle[s->cavity.item[i]].vertex[k]] = p;
    for (size_t i = 0; i < s->boundary.count; i++) {
        uint32_t g = s->boundary.item[i];
        uint32_t v = s->triangle[brio_triangle_of(g)].vertex[brio_slot_before(brio_edge_slot(g))];
        representative[v] = v;
    }
}

/* Lists the slots of the new triangles in the cavity's list: slots of the cavity, unused ones, then fresh ones. */
static brio_status take_slots(brio_plane_store *s) {
    size_t need = s->boundary.count;
    if (s->cavity.count > need) BRIO_FORWARD(grow(s->ctx, &s->unused, s->cavity.count - need));
    while (s->cavity.count > need) push(&s->unused, s->cavity.item[--s->cavity.count]);
    BRIO_FORWARD(reserve(s->ctx, &s->cavity, need - s->cavity.count));
    while (s->cavity.count < need)
        push(&s->cavity, s->unused.count ? s->unused.item[--s->unused.count] : (uint32_t)s->count++);
    assert(s->count <= s->capacity);
    assert(s->cavity.count == s->boundary.count);
    return BRIO_OK;
}

/* Turns a triangle with the infinite vertex in slot 1 so that it is in slot 2. */
static void turn(brio_plane_store *s, uint32_t t) {
    brio_triangle *own = &s->triangle[t], old = *own;
    assert(own->vertex[1] == s->infinite);
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t to = brio_slot_after(i), g = old.mate[i];
        own->vertex[to] = old.vertex[i];
        own->mate[to] = g;
        s->triangle[brio_triangle_of(g)].mate[brio_edge_slot(g)] = brio_edge_of(t, to);
    }
}

#ifndef NDEBUG
/* Returns whether the new triangles, which are listed in the cavity's list, keep I1 to I3. */
static bool star_is_valid(const brio_plane_store *s, uint32_t p) {
    brio_plane_filter filter = s->filter; /* a copy, which counts apart */
    for (size_t n = 0; n < s->cavity.count; n++) {
        uint32_t t = s->cavity.item[n];
        const uint32_t *v = s->triangle[t].vertex;
        if (v[0] == s->infinite || v[1] == s->infinite || (v[0] != p && v[1] != p && v[2] != p)) return false;
        if (v[2] != s->infinite && brio_orient2d_sign(&filter, s->record[v[0]], s->record[v[1]], s->record[v[2]]) <= 0)
            return false;
        for (uint32_t i = 0; i < 3; i++) {
            uint32_t g = s->triangle[t].mate[i], j = brio_edge_slot(g);
            const brio_triangle *other = &s->triangle[brio_triangle_of(g)];
            if (other->mate[j] != brio_edge_of(t, i)) return false;
            if (other->vertex[brio_slot_after(j)] != v[brio_slot_before(i)]) return false;
            if (other->vertex[brio_slot_before(j)] != v[brio_slot_after(i)]) return false;
        }
    }
    return true;
}
#endif

/* Fills the cavity with the star of p. */
ALWAYS_INLINE brio_status fill(brio_plane_store *s, uint32_t p, const bool general) {
    size_t old = s->cavity.count, n = s->boundary.count;
    uint32_t to_turn = BRIO_NO_TRIANGLE;
    if (general && s->dug) {
        for (size_t i = 0; i < old; i++) s->dug[s->cavity.item[i]] = 0;
        if (old + 2 != n) hide_inner_vertices(s, p);
    }
    s->stats.destroyed += old;
    s->stats.created += n;
    brio_status status = take_slots(s);
    if (status != BRIO_OK) return status;
    const uint32_t *slot = s->cavity.item, *boundary = s->boundary.item;
    uint32_t before = slot[n - 1];
    for (size_t i = 0; i < n; i++) {
        uint32_t g = boundary[i], j = brio_edge_slot(g), t = slot[i], next = slot[i + 1 < n ? i + 1 : 0];
        brio_triangle *outer = &s->triangle[brio_triangle_of(g)];
        uint32_t from = outer->vertex[brio_slot_before(j)], to = outer->vertex[brio_slot_after(j)];
        outer->mate[j] = brio_edge_of(t, 0);
        s->triangle[t] = (brio_triangle){{p, from, to}, {g, brio_edge_of(next, 2), brio_edge_of(before, 1)}};
        assert(from != p && to != p && from != to);
        assert(from != s->infinite ||
               to_turn == BRIO_NO_TRIANGLE); /* two new triangles are infinite, one of them to be turned */
        if (from == s->infinite) to_turn = t;
        before = t;
    }
    if (to_turn != BRIO_NO_TRIANGLE) turn(s, to_turn);
    s->start = slot[0];
    assert(star_is_valid(s, p));
    return BRIO_OK;
}

ALWAYS_INLINE brio_status insert_all(brio_plane_store *s, size_t begin, size_t end, const bool general) {
    brio_plane_view view = {s->triangle, (const brio_plane_record *)s->record, s->infinite};
    assert(begin <= end && end <= s->num_points && s->start < s->count);
    for (size_t p = begin; p < end; p++) {
        const double *x = s->record[p];
        assert(s->representative[p] == p); /* I6: p is not in yet */
        uint32_t t = brio_plane_walk(&view, &s->filter, s->start, x, &s->stats.walk_steps);
        s->start = t;
        if (!becomes_vertex(s, (uint32_t)p, t, general)) continue;
        BRIO_FORWARD(dig(s, t, x, general));
        BRIO_FORWARD(fill(s, (uint32_t)p, general));
    }
    return BRIO_OK;
}

static brio_status insert_plain(brio_plane_store *s, size_t begin, size_t end) {
    return insert_all(s, begin, end, false);
}

static brio_status insert_general(brio_plane_store *s, size_t begin, size_t end) {
    return insert_all(s, begin, end, true);
}

brio_status brio_plane_insert(brio_plane_store *s, size_t begin, size_t end) {
    return s->filter.general ? insert_general(s, begin, end) : insert_plain(s, begin, end);
}
