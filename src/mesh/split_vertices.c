/* Splits vertices where several fans of faces meet.
 *
 * A union-find joins the corners at both ends of every edge of two faces; its sets are the fans. The fans, numbered in
 * the order of their first corners, become the vertices.
 *
 * On the boundary of a solid an edge may have more than two faces, with the inside in the wedges between them. Then
 * each face is paired with the face across its inside wedge: the first face met when turning round the edge from the
 * face into the inside. */
#include "mesh/split_vertices.h"
#include "base/memory.h"
#include "predicates/predicates.h"
#include "mesh/edge_rings.h"
#include "base/union_find.h"
#include <string.h>

/* Joins the corners of each fan. The least corner of a fan names the fan. */
static void join_corners(const brio_mesh *m, const uint32_t *ring, const uint32_t *next, uint32_t *fan) {
    const uint32_t *v = m->face_vertices;
    for (uint32_t h = 0; h < m->face_offsets[m->num_faces]; h++) {
        uint32_t g = ring[h];
        if (g <= h || ring[g] != h) continue;
        bool same_way = v[h] == v[g];
        brio_unite(fan, h, same_way ? g : next[g], true);
        brio_unite(fan, next[h], same_way ? next[g] : g, true);
    }
}

/* Replaces *rows by `count` rows of `size` bytes, one for each fan; row i is a copy of old row from[i]. */
static brio_status take_rows(brio_context *ctx, char **rows, size_t size, const uint32_t *from, size_t count) {
    char *taken = NULL;
    brio_status status = BRIO_ALLOC(ctx, taken, count * size);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < count; i++) memcpy(taken + i * size, *rows + from[i] * size, size);
    brio_release(ctx, *rows);
    *rows = taken;
    return BRIO_OK;
}

static brio_status replace_vertices(brio_context *ctx, brio_mesh *m, const uint32_t *from, size_t count) {
    char *rows = (char *)m->vertices;
    BRIO_FORWARD(take_rows(ctx, &rows, 3 * sizeof *m->vertices, from, count));
    m->vertices = (double *)(void *)rows;
    for (size_t i = 0; i < m->num_properties; i++) {
        rows = m->properties[i].data;
        BRIO_FORWARD(take_rows(ctx, &rows, brio_scalar_size(m->properties[i].type), from, count));
        m->properties[i].data = rows;
    }
    m->num_vertices = count;
    return BRIO_OK;
}

/* --- wedges; the faces are triangles --- */

static uint32_t next_corner(uint32_t h) {
    return h % 3 == 2 ? h - 2 : h + 1;
}

/* Returns the side of the triangle of half-edge h on which the apex of the triangle of g lies: negative inside. */
static int side_of_apex(const brio_mesh *m, uint32_t h, uint32_t g) {
    const uint32_t *v = m->face_vertices;
    const uint32_t corners[4] = {v[h], v[next_corner(h)], v[next_corner(next_corner(h))],
                                 v[next_corner(next_corner(g))]};
    const double *p[4];
    for (int i = 0; i < 4; i++) p[i] = m->vertices + 3 * (size_t)corners[i];
    return brio_orient3d(p[0], p[1], p[2], p[3]);
}

/* Returns whether g comes before `other` when turning round their edge from h into the inside. */
static bool is_met_first(const brio_mesh *m, uint32_t h, uint32_t g, uint32_t other) {
    int side = side_of_apex(m, h, g), other_side = side_of_apex(m, h, other);
    if (side != other_side) return side < other_side;
    return side_of_apex(m, g, other) > 0; /* g and h have opposite directions */
}

uint32_t brio_wedge_partner(const brio_mesh *m, const uint32_t *ring, uint32_t h, bool inside) {
    const uint32_t *v = m->face_vertices;
    uint32_t partner = h;
    for (uint32_t g = ring[h]; g != h; g = ring[g])
        if (v[g] != v[h] && (partner == h || is_met_first(m, h, g, partner) == inside)) partner = g;
    return partner;
}

/* Splits rings of more than two half-edges into pairs that share an inside wedge, or with `inside` false an outside
 * one.
 * partner  #corners of work space.   Returns whether such rings exist. */
static bool pair_wedges(const brio_mesh *m, uint32_t *ring, uint32_t *partner, bool inside) {
    size_t corners = 3 * m->num_faces;
    bool any = false;
    for (uint32_t h = 0; h < corners; h++) {
        bool paired = ring[ring[h]] == h;
        partner[h] = paired ? ring[h] : brio_wedge_partner(m, ring, h, inside);
        any |= !paired;
    }
    for (uint32_t h = 0; h < corners; h++) ring[h] = partner[partner[h]] == h ? partner[h] : h;
    return any;
}

/* --- all of it --- */

/* Splits vertices into the fans that `ring` makes: corners are joined across its pairs. */
static brio_status split_fans(brio_context *ctx, brio_mesh *m, uint32_t *ring) {
    brio_status status = BRIO_OK;
    uint32_t *next = NULL, *fan = NULL, *from = NULL;
    size_t corners = m->num_faces ? m->face_offsets[m->num_faces] : 0, count = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, next, corners));
    BRIO_TRY(BRIO_ALLOC(ctx, fan, corners));
    BRIO_TRY(BRIO_ALLOC(ctx, from, corners));
    for (size_t f = 0; f < m->num_faces; f++)
        for (uint64_t h = m->face_offsets[f]; h < m->face_offsets[f + 1]; h++) {
            fan[h] = (uint32_t)h;
            next[h] = (uint32_t)(h + 1 < m->face_offsets[f + 1] ? h + 1 : m->face_offsets[f]);
        }
    if (corners) join_corners(m, ring, next, fan);
    for (uint32_t h = 0; h < corners; h++) {
        uint32_t first = brio_find(fan, h);
        if (first == h)
            from[count] = m->face_vertices[h],
            next[h] = (uint32_t)count++; /* from now on next[first corner] is the number of the fan */
        ring[h] = next[first];           /* from now on ring[h] is the new vertex of corner h */
    }
    BRIO_TRY(replace_vertices(ctx, m, from, count));
    if (corners) memcpy(m->face_vertices, ring, corners * sizeof *ring);
done:
    brio_release(ctx, next);
    brio_release(ctx, fan);
    brio_release(ctx, from);
    return status;
}

brio_status brio_mesh_split_vertices(brio_context *ctx, brio_mesh *m) {
    brio_status status = BRIO_OK;
    uint32_t *ring = NULL;
    BRIO_TRY(brio_mesh_check_faces(ctx, m));
    BRIO_TRY(brio_edge_rings(ctx, m, &ring));
    BRIO_TRY(split_fans(ctx, m, ring));
done:
    brio_release(ctx, ring);
    return status;
}

/* Makes half-edges of edges that are no pair, or run in one direction, half-edges of boundaries. Members of a ring
 * follow each other in ascending order, so that a pair is seen at its first one. */
static brio_status leave_pairs(brio_context *ctx, const brio_mesh *m, uint32_t *ring) {
    brio_status status = BRIO_OK;
    size_t corners = m->num_faces ? (size_t)m->face_offsets[m->num_faces] : 0;
    uint32_t *pair = NULL;
    BRIO_TRY(BRIO_ALLOC(ctx, pair, corners));
    for (uint32_t h = 0; h < corners; h++) {
        uint32_t g = ring[h];
        pair[h] = ring[g] == h && m->face_vertices[g] != m->face_vertices[h] ? g : h;
    }
    if (corners) memcpy(ring, pair, corners * sizeof *ring);
done:
    brio_release(ctx, pair);
    return status;
}

brio_status brio_mesh_cut_apart(brio_context *ctx, brio_mesh *m) {
    brio_status status = BRIO_OK;
    uint32_t *ring = NULL;
    BRIO_TRY(brio_mesh_check_faces(ctx, m));
    BRIO_TRY(brio_edge_rings(ctx, m, &ring));
    BRIO_TRY(leave_pairs(ctx, m, ring));
    BRIO_TRY(split_fans(ctx, m, ring));
done:
    brio_release(ctx, ring);
    return status;
}

/* Splits vertices where sheets touch. After pairing across inside wedges, two sheets may still be connected round both
 * ends of an edge, which then stays one edge of four faces. There the fan of each end passes the edge twice. Pairing
 * across the outside wedges of all such edges instead splits these fans.
 *
 * Once is enough. On a small sphere round a vertex a fan is a closed curve without crossings, and the inside that it
 * bounds lies at one side of it. Where it passes an edge twice, it comes near itself from its other side. There these
 * places are chords of a disk, which do not cross. A cut at a chord makes two curves of one, and the chord lies
 * between them, whatever other chords are cut. So no fan passes one of these edges twice any more, at either end; and
 * a fan that passed an edge once at one end goes on to do so. Which edges they are depends on the faces alone, so the
 * result does not depend on their order. */
brio_status brio_mesh_split_sheets(brio_context *ctx, brio_mesh *m) {
    brio_status status = BRIO_OK;
    uint32_t *ring = NULL, *partner = NULL;
    bool touch = true;
    BRIO_TRY(BRIO_ALLOC(ctx, partner, 3 * m->num_faces));
    for (int pass = 0; touch && pass < 2; pass++) {
        BRIO_TRY(brio_edge_rings(ctx, m, &ring));
        touch = pair_wedges(m, ring, partner, pass == 0);
        BRIO_TRY(split_fans(ctx, m, ring));
        brio_release(ctx, ring);
        ring = NULL;
    }
done:
    brio_release(ctx, ring);
    brio_release(ctx, partner);
    return status;
}
