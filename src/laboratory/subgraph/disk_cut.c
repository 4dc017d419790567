/* Cuts a triangulated surface into disks.
 *
 * A breadth-first tree of triangles, joined across edges, is a disk. The edges that the tree does not cross are the
 * cut. In each closed component of genus g the cut is a connected graph with 2 g independent cycles. Every vertex has
 * an edge that is not crossed, so the cut reaches all vertices. Then the code removes loose ends of the cut one edge
 * at a time; the disk stays one disk. What remains has no vertex of degree 1. The sum of (degree - 2) over its
 * vertices is 4 g - 2, so no vertex has degree above 4 g. On a sphere no cut remains; there one triangle is cut out.
 *
 * At a pinched vertex each fan of triangles counts as a vertex.
 *
 * Based on: Lazarus, Pocchiola, Vegter, Verroust. Computing a canonical polygonal schema of an orientable triangulated
 * surface. SoCG 2001.
 * Differs from the paper: the cut is the graph of all cycles at once, not a set of curves that may run side by side.
 * So no vertex lies on more cut edges than necessary. */
#include "laboratory/subgraph/spanning_subgraph.h"
#include "base/memory.h"
#include "mesh/twins.h"

/* --- sectors --- */

/* Returns the corner to the right of corner h at its vertex, or BRIO_NO_HALF_EDGE when a cut lies between. */
static uint32_t right_of(const brio_disk_cut *cut, uint32_t h) {
    return cut->flags[h] & BRIO_EDGE_CUT ? BRIO_NO_HALF_EDGE : brio_next_corner(cut->twin[h]);
}

static uint32_t left_of(const brio_disk_cut *cut, uint32_t h) {
    uint32_t in = brio_previous_corner(h);
    return cut->flags[in] & BRIO_EDGE_CUT ? BRIO_NO_HALF_EDGE : cut->twin[in];
}

/* Returns the rightmost corner of the sector of h, or h when no cut ends the sector. */
static uint32_t rightmost(brio_disk_cut *cut, uint32_t h) {
    uint32_t at = h;
    for (;;) {
        uint32_t right = right_of(cut, at);
        cut->steps++;
        if (right == BRIO_NO_HALF_EDGE) return at;
        if (right == h) return h;
        at = right;
    }
}

/* Numbers the sectors. */
static void number_sectors(brio_disk_cut *cut) {
    cut->num_sectors = 0;
    for (size_t h = 0; h < cut->num_corners; h++) cut->sector[h] = BRIO_NO_HALF_EDGE;
    for (size_t h = 0; h < cut->num_corners; h++) {
        if (cut->sector[h] != BRIO_NO_HALF_EDGE) continue;
        uint32_t start = rightmost(cut, (uint32_t)h), at = start;
        do {
            cut->sector[at] = (uint32_t)cut->num_sectors;
            cut->steps++;
            at = left_of(cut, at);
        } while (at != start && at != BRIO_NO_HALF_EDGE);
        cut->num_sectors++;
    }
}

/* --- the cut --- */

static void set_cut(brio_disk_cut *cut, uint32_t h, bool is_cut) {
    uint8_t bits = is_cut ? BRIO_EDGE_CUT : 0;
    cut->flags[h] = bits;
    if (cut->twin[h] != BRIO_NO_HALF_EDGE) cut->flags[cut->twin[h]] = bits;
}

/* Cuts all edges that the breadth-first trees of triangles do not cross.   queue  #F;   seen  #F, zeroed. */
static void cut_round_trees(brio_disk_cut *cut, uint32_t *queue, uint8_t *seen) {
    size_t faces = cut->num_corners / 3;
    for (size_t h = 0; h < cut->num_corners; h++) cut->flags[h] = BRIO_EDGE_CUT;
    for (size_t root = 0; root < faces; root++) {
        if (seen[root]) continue;
        size_t tail = 0;
        queue[tail++] = (uint32_t)root;
        seen[root] = 1;
        for (size_t head = 0; head < tail; head++)
            for (uint32_t h = 3 * queue[head], end = h + 3; h < end; h++) {
                cut->steps++;
                uint32_t twin = cut->twin[h];
                if (twin == BRIO_NO_HALF_EDGE || seen[twin / 3]) continue;
                seen[twin / 3] = 1;
                set_cut(cut, h, false);
                queue[tail++] = twin / 3;
            }
    }
}

/* For each fan: the number of its cut edges, and the exclusive or of the names of these edges (edge_name). At a fan of
 * degree 1 the exclusive or is the name of its one cut edge. */
typedef struct {
    uint32_t *degree, *sum;
} fan_edges;

static uint32_t edge_name(const brio_disk_cut *cut, uint32_t h) {
    return h < cut->twin[h] ? h : cut->twin[h]; /* a boundary edge has twin UINT32_MAX, so its name is h */
}

static void change_edge(const brio_disk_cut *cut, const fan_edges *fans, uint32_t h, uint32_t by) {
    const uint32_t ends[2] = {cut->sector[h], cut->sector[brio_next_corner(h)]};
    for (int i = 0; i < 2; i++) {
        fans->degree[ends[i]] += by;
        fans->sum[ends[i]] ^= h;
    }
}

/* Removes the loose ends of the cut. During this step the sectors are the fans. */
static void prune(brio_disk_cut *cut, const fan_edges *fans) {
    for (uint32_t h = 0; h < cut->num_corners; h++)
        if ((cut->flags[h] & BRIO_EDGE_CUT) && edge_name(cut, h) == h) change_edge(cut, fans, h, 1);
    for (size_t i = 0; i < cut->num_sectors; i++)
        for (uint32_t fan = (uint32_t)i; fans->degree[fan] == 1;) {
            uint32_t h = fans->sum[fan];
            uint32_t other = cut->sector[h] ^ cut->sector[brio_next_corner(h)] ^ fan;
            change_edge(cut, fans, h, (uint32_t)-1);
            set_cut(cut, h, false);
            cut->steps++;
            fan = other;
        }
}

/* Cuts one triangle out of each component that has no cut.   queue  #F;   seen  #F, zeroed. */
static void cut_spheres(brio_disk_cut *cut, uint32_t *queue, uint8_t *seen) {
    for (size_t root = 0; root < cut->num_corners / 3; root++) {
        if (seen[root]) continue;
        size_t tail = 0;
        bool whole = true;
        queue[tail++] = (uint32_t)root;
        seen[root] = 1;
        for (size_t head = 0; head < tail; head++)
            for (uint32_t h = 3 * queue[head], end = h + 3; h < end; h++) {
                cut->steps++;
                if (cut->flags[h] & BRIO_EDGE_CUT) {
                    whole = false;
                } else if (!seen[cut->twin[h] / 3]) {
                    seen[cut->twin[h] / 3] = 1;
                    queue[tail++] = cut->twin[h] / 3;
                }
            }
        for (uint32_t i = 0; whole && i < 3; i++) set_cut(cut, 3 * (uint32_t)root + i, true);
    }
}

/* --- all of it --- */

static brio_status cut_into_disks(brio_context *ctx, brio_disk_cut *cut) {
    brio_status status = BRIO_OK;
    uint32_t *queue = NULL;
    uint8_t *seen = NULL;
    fan_edges fans = {0};
    size_t faces = cut->num_corners / 3;
    for (size_t h = 0; h < cut->num_corners; h++) cut->flags[h] = cut->twin[h] == BRIO_NO_HALF_EDGE ? BRIO_EDGE_CUT : 0;
    number_sectors(cut); /* without cuts, sectors are fans */
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, fans.degree, cut->num_sectors));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, fans.sum, cut->num_sectors));
    BRIO_TRY(BRIO_ALLOC(ctx, queue, faces));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, seen, faces));
    cut_round_trees(cut, queue, seen);
    prune(cut, &fans);
    for (size_t f = 0; f < faces; f++) seen[f] = 0;
    cut_spheres(cut, queue, seen);
done:
    brio_release(ctx, queue);
    brio_release(ctx, seen);
    brio_release(ctx, fans.degree);
    brio_release(ctx, fans.sum);
    return status;
}

brio_status brio_disk_cut_make(brio_context *ctx, const brio_mesh *mesh, brio_disk_cut *out) {
    *out = (brio_disk_cut){.num_corners = 3 * mesh->num_faces};
    BRIO_FORWARD(brio_mesh_twins(ctx, mesh, &out->twin));
    BRIO_FORWARD(brio_progress(ctx, "subgraph", 0.2));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->flags, out->num_corners));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->sector, out->num_corners));
    BRIO_FORWARD(cut_into_disks(ctx, out));
    BRIO_FORWARD(brio_progress(ctx, "subgraph", 0.5));
    number_sectors(out);
    return BRIO_OK;
}

void brio_disk_cut_free(brio_context *ctx, brio_disk_cut *cut) {
    brio_release(ctx, cut->twin);
    brio_release(ctx, cut->flags);
    brio_release(ctx, cut->sector);
    *cut = (brio_disk_cut){0};
}
