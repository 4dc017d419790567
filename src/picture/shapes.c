/* What is drawn of a mesh: the fans of its faces, its edges, the marks of the certificate, tetrahedra cut in half,
 * and points as discs where there is nothing else.
 *
 * A fan begins at a polygon's first corner: a polygon that is not convex can look wrong, as on pages. */
#include "base/memory.h"
#include "mesh/crossing_faces.h"
#include "mesh/edge_rings.h"
#include "mesh/tetrahedra_adjacency.h"
#include "picture/picture.h"

/* MOST_LINED: polygons, or tetrahedra, up to which their edges are drawn: with more, lines would hide them.
 * FEW_CROWDED: edges of more than two faces up to which they are marked in any case; with more, if they are under a
 * tenth of the faces. Cells have many by their nature. Both chosen; pages have the same rule (web/src/layer.js). */
enum { MOST_LINED = 50000, FEW_CROWDED = 50 };

static brio_status put_line(brio_context *ctx, brio_shapes *s, uint32_t a, uint32_t b, brio_line_kind kind) {
    BRIO_FORWARD(BRIO_RESERVE(ctx, s->end, s->capacity, s->num_lines + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, s->kind, s->kind_capacity, s->num_lines + 1));
    s->end[s->num_lines][0] = a;
    s->end[s->num_lines][1] = b;
    s->kind[s->num_lines++] = (uint8_t)kind;
    return BRIO_OK;
}

/* --- faces --- */

static brio_status take_faces(brio_context *ctx, const brio_mesh *m, brio_shapes *s) {
    size_t count = 0;
    for (size_t f = 0; f < m->num_faces; f++) {
        uint64_t corners = m->face_offsets[f + 1] - m->face_offsets[f];
        count += corners < 3 ? 0 : (size_t)corners - 2;
        s->lined |= corners > 3;
    }
    s->lined &= m->num_faces <= MOST_LINED;
    s->flat = s->lined;
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->corner, count + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->of, count + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->drawn, count + 1));
    for (size_t f = 0; f < m->num_faces; f++) {
        const uint32_t *v = m->face_vertices + m->face_offsets[f];
        uint64_t corners = m->face_offsets[f + 1] - m->face_offsets[f];
        for (uint64_t k = 2; k < corners; k++) {
            size_t t = s->num_triangles++;
            s->corner[t][0] = v[0], s->corner[t][1] = v[k - 1], s->corner[t][2] = v[k];
            s->of[t] = (uint32_t)f;
            s->drawn[t] = (uint8_t)(2 | (k == 2 ? 1 : 0) | (k + 1 == corners ? 4 : 0)); /* no diagonals of the fan */
        }
    }
    return BRIO_OK;
}

/* Drops the marks of a complex, where edges of more than two faces are no faults, and faces have no sides. */
static void drop_crowded(brio_shapes *s, size_t faces) {
    size_t crowded = 0;
    for (size_t l = 0; l < s->num_lines; l++) crowded += s->kind[l] == BRIO_LINE_NONMANIFOLD;
    if (crowded <= FEW_CROWDED || crowded < faces / 10) return;
    s->num_lines = 0;
    s->flat = true;
}

/* Finds the edges of one face, of more than two, and of two faces that run along it in the same direction. */
static brio_status take_marks(brio_context *ctx, const brio_mesh *m, brio_shapes *s) {
    brio_status status = BRIO_OK;
    uint32_t *ring = NULL;
    const uint32_t *v = m->face_vertices;
    BRIO_TRY(brio_edge_rings(ctx, m, &ring));
    for (size_t f = 0; f < m->num_faces; f++) {
        uint64_t from = m->face_offsets[f], to = m->face_offsets[f + 1];
        for (uint64_t h = from; h < to; h++) {
            uint32_t g = ring[h], next = v[h + 1 < to ? h + 1 : from];
            BRIO_TRY(brio_look(ctx, 1));
            if (g > h) continue; /* the last half-edge stands for the edge */
            if (g == h)
                BRIO_TRY(put_line(ctx, s, v[h], next, BRIO_LINE_BOUNDARY));
            else if (ring[g] != h)
                BRIO_TRY(put_line(ctx, s, v[h], next, BRIO_LINE_NONMANIFOLD));
            else if (v[g] == v[h])
                BRIO_TRY(put_line(ctx, s, v[h], next, BRIO_LINE_FLIPPED));
        }
    }
    drop_crowded(s, m->num_faces);
done:
    brio_release(ctx, ring);
    return status;
}

static brio_status take_crossings(brio_context *ctx, const brio_mesh *m, brio_shapes *s) {
    int64_t pairs;
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->crossing, m->num_faces + 1));
    return brio_crossing_faces(ctx, m, NULL, s->crossing, &pairs);
}

/* --- tetrahedra --- */

/* The half of the tetrahedra that is drawn: behind a plane through the middle, across the horizontal axis along which
 * the eye looks most. */
typedef struct {
    const brio_mesh *m;
    const brio_scene_box *box;
    int axis;
    double sign;
} half;

static bool is_behind(const half *h, size_t t) {
    double sum = 0, place[3];
    for (int k = 0; k < 4; k++) {
        brio_scene_place(h->box, h->m->vertices + 3 * (size_t)h->m->tetrahedra[4 * t + (size_t)k], place);
        sum += place[h->axis];
    }
    return h->sign * sum <= 0;
}

static brio_status take_tetrahedra(brio_context *ctx, const brio_mesh *m, const brio_scene_box *box,
                                   const brio_look_axes *axes, brio_shapes *s) {
    brio_status status = BRIO_OK;
    uint32_t *neighbours = NULL;
    const double *back = axes->back;
    const int axis = back[0] * back[0] > back[1] * back[1] ? 0 : 1;
    const half h = {m, box, axis, back[axis] < 0 ? -1 : 1};
    size_t capacity[3] = {0};
    BRIO_TRY(brio_tetrahedra_neighbours(ctx, m, &neighbours));
    for (size_t f = 0; f < 4 * m->num_tetrahedra; f++) {
        size_t t = f / 4, n = s->num_triangles;
        BRIO_TRY(brio_look(ctx, 1));
        if (!is_behind(&h, t) || (neighbours[f] != BRIO_INFINITE && is_behind(&h, neighbours[f]))) continue;
        BRIO_TRY(BRIO_RESERVE(ctx, s->corner, capacity[0], n + 1));
        BRIO_TRY(BRIO_RESERVE(ctx, s->of, capacity[1], n + 1));
        BRIO_TRY(BRIO_RESERVE(ctx, s->drawn, capacity[2], n + 1));
        for (int k = 0; k < 3; k++) s->corner[n][k] = m->tetrahedra[4 * t + brio_facet_corners[f & 3][k]];
        s->of[n] = (uint32_t)t;
        s->drawn[n] = 7;
        s->num_triangles++;
    }
    s->flat = true;
    s->lined = s->num_triangles <= MOST_LINED;
done:
    brio_release(ctx, neighbours);
    return status;
}

brio_status brio_shapes_find(brio_context *ctx, const brio_mesh *m, const brio_scene_box *box,
                             const brio_look_axes *axes, bool crossings, brio_shapes *out) {
    *out = (brio_shapes){0};
    if (m->num_faces) {
        BRIO_FORWARD(take_faces(ctx, m, out));
        BRIO_FORWARD(take_marks(ctx, m, out));
        if (crossings) BRIO_FORWARD(take_crossings(ctx, m, out));
    } else if (m->num_tetrahedra) {
        BRIO_FORWARD(take_tetrahedra(ctx, m, box, axes, out));
    }
    for (size_t e = 0; e < m->num_edges; e++)
        BRIO_FORWARD(put_line(ctx, out, m->edges[2 * e], m->edges[2 * e + 1], BRIO_LINE_EDGE));
    out->discs = !out->num_triangles && !out->num_lines;
    return BRIO_OK;
}

void brio_shapes_free(brio_context *ctx, brio_shapes *s) {
    brio_release(ctx, s->corner);
    brio_release(ctx, s->of);
    brio_release(ctx, s->drawn);
    brio_release(ctx, s->end);
    brio_release(ctx, s->kind);
    brio_release(ctx, s->crossing);
}
