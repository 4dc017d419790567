/* The convex hull by insertion of the points, one after the other.
 *
 * A walk finds the triangle in whose cone the point is; the cones have their apex at a fixed point inside the hull. If
 * the point is beyond no triangle that the walk sees, it is in the hull. Otherwise all triangles that the point is
 * beyond are removed, and the point is joined to the edges of the hole. Both take constant expected time where the
 * points come in a biased randomized insertion order.
 *
 * Degenerate inputs need no perturbation. "Beyond" is strict, so the removed triangles are those of whole facets and
 * form a disk; an edge of the hole is never collinear with the point, because the point is strictly beyond the facet on
 * one side of the edge and not on that facet's plane. Points on the hull change nothing.
 *
 * The walk ends: along the line from the centre to the point, each step goes to a facet that is met no later. Among
 * triangles of one plane it could go round, so each step begins with a random edge [Devillers Pion Teillaud 2002].
 *
 * Based on: Clarkson, Shor. Applications of random sampling in computational geometry, II. DCG 1989.
 *           Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 * Differs from the papers: a walk finds the triangles that a point is beyond; there is no conflict graph. */
#include "hull/polytope.h"
#include "base/memory.h"
#include "base/rng.h"
#include <assert.h>
#include <string.h>

enum { MOST_TRIANGLES = 1 << 30, INSERTIONS_A_CALL = 1 << 14 };
static const uint32_t UNMARKED = UINT32_MAX;

typedef struct {
    brio_context *ctx;
    brio_polytope *p;
    const double (*record)[4];
    const uint32_t *index;
    const double *centre; /* strictly inside */
    brio_filter filter;
    uint32_t last; /* a triangle near the last point */
    brio_rng rng;
    uint32_t *hole, *border, *stack; /* removed triangles; outer handles of the hole's edges; handles to be crossed */
    uint32_t *unused;                /* places without a triangle */
    size_t num_hole, num_border, num_stack, num_unused;
    size_t hole_capacity, border_capacity, stack_capacity, unused_capacity;
} builder;

static bool is_beyond(builder *b, uint32_t triangle, const double *point) {
    const uint32_t *v = b->p->triangle[triangle].vertex;
    assert(triangle < b->p->count && v[0] != v[1] && v[1] != v[2] && v[2] != v[0]);
    b->p->beyond_calls++;
    return brio_orient3d_sign(&b->filter, b->record[v[0]], b->record[v[1]], b->record[v[2]], point) > 0;
}

/* Walks to a triangle that the point is beyond. Returns false when the point is in the hull; b->last is then the
 * triangle in whose cone the point is. */
static bool walk(builder *b, const double *point) {
    const brio_hull_triangle *t = b->p->triangle;
    while (!is_beyond(b, b->last, point)) {
        const uint32_t *v = t[b->last].vertex;
        uint32_t first = brio_rng_below(&b->rng, 3), i = 0;
        for (; i < 3; i++) {
            uint32_t e = (first + i) % 3;
            const double *from = b->record[v[(e + 1) % 3]], *to = b->record[v[(e + 2) % 3]];
            if (brio_orient3d_sign(&b->filter, b->centre, from, to, point) >= 0) continue;
            b->last = t[b->last].mate[e] >> 2;
            b->p->walk_steps++;
            break;
        }
        if (i == 3) return false;
    }
    return true;
}

static brio_status remove_triangle(builder *b, uint32_t triangle, uint32_t mark) {
    assert(b->p->triangle[triangle].mark != mark); /* removed once */
    b->p->triangle[triangle].mark = mark;
    brio_status status = BRIO_RESERVE(b->ctx, b->hole, b->hole_capacity, b->num_hole + 1);
    if (status == BRIO_OK) b->hole[b->num_hole++] = triangle;
    return status;
}

/* Removes the triangles that record r is beyond, from b->last on. The removed triangles are a disk and the edges of
 * each are crossed counterclockwise, so the border is found in its order along the hole. */
static brio_status dig(builder *b, uint32_t r) {
    const brio_hull_triangle *t = b->p->triangle;
    b->num_hole = b->num_border = 0;
    b->num_stack = 3;
    for (uint32_t i = 0; i < 3; i++) b->stack[i] = 4 * b->last + 2 - i;
    BRIO_FORWARD(remove_triangle(b, b->last, r));
    while (b->num_stack > 0) {
        uint32_t handle = b->stack[--b->num_stack], mate = t[handle >> 2].mate[handle & 3];
        assert(t[mate >> 2].mate[mate & 3] == handle); /* I2 */
        if (t[mate >> 2].mark == r) continue;
        if (is_beyond(b, mate >> 2, b->record[r])) {
            BRIO_FORWARD(remove_triangle(b, mate >> 2, r));
            BRIO_FORWARD(BRIO_RESERVE(b->ctx, b->stack, b->stack_capacity, b->num_stack + 2));
            b->stack[b->num_stack++] = brio_hull_next(brio_hull_next(mate));
            b->stack[b->num_stack++] = brio_hull_next(mate);
        } else {
            BRIO_FORWARD(BRIO_RESERVE(b->ctx, b->border, b->border_capacity, b->num_border + 1));
            b->border[b->num_border++] = mate;
        }
    }
    assert(b->num_border >= 3 && b->num_border <= b->num_hole + 2); /* a disk */
    return BRIO_OK;
}

/* Makes the hole as many places as the border has edges: a hole of n triangles with k vertices inside has n + 2 - 2 k
 * edges. Places that are too many become unused. */
static brio_status find_places(builder *b) {
    brio_polytope *p = b->p;
    BRIO_EXPECT(b->ctx, p->count < MOST_TRIANGLES - 2, BRIO_ERR_TOO_LARGE, "the convex hull has over 2^30 triangles");
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, p->triangle, p->capacity, p->count + 2));
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, b->hole, b->hole_capacity, b->num_hole + 2));
    BRIO_FORWARD(BRIO_RESERVE(b->ctx, b->unused, b->unused_capacity, b->num_unused + b->num_hole));
    while (b->num_hole < b->num_border)
        b->hole[b->num_hole++] = b->num_unused > 0 ? b->unused[--b->num_unused] : (uint32_t)p->count++;
    while (b->num_hole > b->num_border) b->unused[b->num_unused++] = b->hole[--b->num_hole];
    return BRIO_OK;
}

#ifndef NDEBUG
/* Returns whether the new triangles keep I2: mates name each other and the same edge, the other way round. */
static bool star_is_closed(const builder *b, uint32_t r) {
    const brio_hull_triangle *t = b->p->triangle;
    for (size_t n = 0; n < b->num_border; n++)
        for (uint32_t e = 0; e < 3; e++) {
            uint32_t handle = 4 * b->hole[n] + e, mate = t[b->hole[n]].mate[e];
            if (t[b->hole[n]].vertex[2] != r || t[mate >> 2].mate[mate & 3] != handle) return false;
            if (brio_hull_origin(b->p, mate) != brio_hull_origin(b->p, brio_hull_next(handle))) return false;
            if (brio_hull_origin(b->p, handle) != brio_hull_origin(b->p, brio_hull_next(mate))) return false;
        }
    return true;
}
#endif

/* Joins record r to the border. */
static brio_status fill(builder *b, uint32_t r) {
    brio_polytope *p = b->p;
    p->destroyed += b->num_hole;
    p->created += b->num_border;
    BRIO_FORWARD(find_places(b));
    for (size_t i = 0; i < b->num_border; i++) {
        uint32_t own = b->hole[i], outer = b->border[i];
        uint32_t next = b->hole[i + 1 < b->num_border ? i + 1 : 0], before = b->hole[i ? i - 1 : b->num_border - 1];
        uint32_t to = brio_hull_origin(p, outer), from = brio_hull_origin(p, brio_hull_next(outer));
        p->triangle[own] = (brio_hull_triangle){{from, to, r}, {4 * next + 1, 4 * before, outer}, UNMARKED};
        assert(own < p->capacity && from != to && from != r && to != r);
        p->triangle[outer >> 2].mate[outer & 3] = 4 * own + 2;
    }
    assert(b->num_hole == b->num_border && star_is_closed(b, r));
    b->last = b->hole[0];
    return BRIO_OK;
}

/* Notes that record r shares the position of a vertex of b->last, if so. */
static void note_coincident(builder *b, uint32_t r) {
    const uint32_t *v = b->p->triangle[b->last].vertex;
    for (int i = 0; i < 3; i++) {
        uint32_t *same = &b->p->same[v[i]];
        if (b->index[r] < b->index[*same] && brio_same_position(b->record[v[i]], b->record[r])) *same = r;
    }
}

static brio_status insert(builder *b, uint32_t r) {
    if (!walk(b, b->record[r])) {
        note_coincident(b, r);
        return BRIO_OK;
    }
    brio_status status = dig(b, r);
    return status == BRIO_OK ? fill(b, r) : status;
}

/* Makes the tetrahedron of the corners. */
static brio_status begin(builder *b, const uint32_t corner[4]) {
    static const uint8_t FACE[4][3] = {{1, 3, 2}, {0, 2, 3}, {0, 3, 1}, {0, 1, 2}}; /* seen from slot i */
    uint32_t c[4];
    memcpy(c, corner, sizeof c);
    if (brio_orient3d_exact(b->record[c[0]], b->record[c[1]], b->record[c[2]], b->record[c[3]]) < 0)
        c[2] = corner[3], c[3] = corner[2];
    brio_status status = BRIO_RESERVE(b->ctx, b->p->triangle, b->p->capacity, 4);
    if (status != BRIO_OK) return status;
    b->p->count = b->p->created = 4;
    for (uint32_t i = 0; i < 4; i++) {
        brio_hull_triangle *t = &b->p->triangle[i];
        const uint8_t slot[3] = {FACE[i][0], FACE[i][2], FACE[i][1]};
        t->mark = UNMARKED;
        for (uint32_t e = 0; e < 3; e++) { /* across the edge opposite to slot j is face j, where slot i is opposite */
            uint32_t j = slot[e];
            uint32_t at = FACE[j][0] == i ? 0 : FACE[j][2] == i ? 1 : 2;
            t->vertex[e] = c[j];
            t->mate[e] = 4 * j + at;
        }
    }
    return BRIO_OK;
}

/* Sets record[n] to the centroid of the corners. Returns whether it is strictly inside them. */
static bool place_centre(builder *b, double *centre, const uint32_t corner[4]) {
    for (int k = 0; k < 4; k++) centre[k] = 0;
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) centre[k] += 0.25 * b->record[corner[i]][k];
    for (uint32_t i = 0; i < 4; i++) {
        const uint32_t *v = b->p->triangle[i].vertex;
        if (brio_orient3d_exact(b->record[v[0]], b->record[v[1]], b->record[v[2]], centre) >= 0) return false;
    }
    return true;
}

/* Moves triangles from the end to the unused places. */
static void close_gaps(builder *b) {
    brio_polytope *p = b->p;
    for (size_t i = 0; i < b->num_unused; i++) p->triangle[b->unused[i]].vertex[0] = BRIO_INFINITE;
    for (size_t i = 0; i < b->num_unused; i++) {
        while (p->count > 0 && p->triangle[p->count - 1].vertex[0] == BRIO_INFINITE) p->count--;
        uint32_t to = b->unused[i];
        assert(to < p->capacity);
        if (to >= p->count) continue;
        p->triangle[to] = p->triangle[--p->count];
        for (uint32_t e = 0; e < 3; e++) {
            uint32_t mate = p->triangle[to].mate[e];
            p->triangle[mate >> 2].mate[mate & 3] = 4 * to + e;
        }
    }
}

static brio_status insert_all(builder *b, size_t n) {
    for (uint32_t r = 0; r < n; r++) {
        if (r % INSERTIONS_A_CALL == 0) BRIO_FORWARD(brio_progress(b->ctx, "hull", (double)r / (double)n));
        BRIO_FORWARD(insert(b, r));
    }
    assert(b->num_unused <= b->p->count);
    close_gaps(b);
    return BRIO_OK;
}

brio_status brio_polytope_build(brio_context *ctx, const brio_hull_records *records, const uint32_t corner[4],
                                uint64_t seed, brio_polytope *out) {
    brio_status status = BRIO_OK;
    size_t n = records->count;
    double *centre = records->record[n];
    builder b = {.ctx = ctx, .p = out, .index = records->index, .centre = centre, .rng = brio_rng_new(seed)};
    b.record = (const double(*)[4])records->record;
    *out = (brio_polytope){0};
    BRIO_TRY(BRIO_RESERVE(ctx, b.stack, b.stack_capacity, 3));
    BRIO_TRY(BRIO_ALLOC(ctx, out->same, n));
    for (uint32_t r = 0; r < n; r++) out->same[r] = r;
    BRIO_TRY(begin(&b, corner));
    if (place_centre(&b, centre, corner)) {
        brio_filter_for(&b.filter, b.record, n + 1, false);
        BRIO_TRY(insert_all(&b, n));
        out->exact_calls = b.filter.unsettled;
    } else {
        out->count = 0;
    }
done:
    if (status != BRIO_OK) brio_polytope_free(ctx, out);
    brio_release(ctx, b.hole);
    brio_release(ctx, b.border);
    brio_release(ctx, b.stack);
    brio_release(ctx, b.unused);
    return status;
}

void brio_polytope_free(brio_context *ctx, brio_polytope *p) {
    brio_release(ctx, p->triangle);
    brio_release(ctx, p->same);
    *p = (brio_polytope){0};
}
