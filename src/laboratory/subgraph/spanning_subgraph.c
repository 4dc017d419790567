/* Spanning subgraph of bounded degree of a triangulated surface.
 *
 * The surface is cut into disks. The code removes vertices from the boundary cycle of each disk, one at a time. A
 * vertex may go when it has no chord; a chord is an edge inside the disk to another vertex of the cycle. What remains
 * is a disk again, and at the end one triangle, whose edges start the subgraph. Then the vertices come back in reverse
 * order. Let z1 ... zm be the neighbours of z when z went. The edges z z1, z z2 and z zm replace the cycle edges z1 z2
 * and zm-1 zm. So only the degree of z grows, to three. The copies of a vertex that the cut passed through
 * become one vertex in the result. The degree of that vertex is the sum of the degrees of its copies.
 *
 * Vertices of disks are the sectors of disk_cut.c. A half-edge bounds the disk in work when its flag LIVE_END is set;
 * removed triangles have no mark.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms for surface reconstruction and related problems. PhD
 * thesis, The University of Texas at Austin 2003, section 4.3.2.
 * Differs from the paper: chords are counted, where lemma 14 marks the vertices that have a chord. When a vertex of
 * degree two goes, the chord between its neighbours becomes a cycle edge; a count can be reduced, a mark cannot. The
 * loop replaces recursion. */
#include "laboratory/subgraph/spanning_subgraph.h"
#include "base/float_state.h"
#include "base/memory.h"

enum { LIVE_END = 2, CHOSEN = 4 }; /* bits 1 and 2 of the flags of half-edges; bit 0 is BRIO_EDGE_CUT */

enum { ON_CYCLE = 1, LISTED = 2 }; /* bits of the state of a sector */

enum { ROUNDS_A_REPORT = 1 << 20 };

/* The first and the last corner of a vertex when the vertex was removed. */
typedef struct {
    uint32_t first, last;
} removal;

typedef struct {
    brio_disk_cut cut;
    uint32_t *out;    /* of each sector on a cycle, its outgoing half-edge of the cycle; the disk is on the left */
    uint32_t *chords; /* number of chords of each sector on a cycle */
    uint8_t *state;   /* of each sector */
    uint32_t
        *free; /* stack of sectors that had no chord when they were listed; a sector is on the stack at most once */
    removal *removals; /* in the order of removal */
    size_t num_free, num_removals;
    size_t num_disks; /* disks of which one triangle is left */
} peeler;

/* --- the disk in work --- */

static uint32_t end_sector(const peeler *p, uint32_t h) {
    return p->cut.sector[brio_next_corner(h)];
}

/* Returns the corner to the left of h at its vertex, or BRIO_NO_HALF_EDGE at the end of the disk. */
static uint32_t live_left(peeler *p, uint32_t h) {
    uint32_t in = brio_previous_corner(h);
    p->cut.steps++;
    return p->cut.flags[in] & LIVE_END ? BRIO_NO_HALF_EDGE : p->cut.twin[in];
}

static void list_if_free(peeler *p, uint32_t sector) {
    if (p->chords[sector] || (p->state[sector] & LISTED)) return;
    p->state[sector] |= LISTED;
    p->free[p->num_free++] = sector;
}

/* Puts an inner sector on the cycle and counts the chords that this makes. */
static void enter_cycle(peeler *p, uint32_t sector) {
    p->state[sector] |= ON_CYCLE;
    uint32_t corner = p->out[sector];
    for (uint32_t left; (left = live_left(p, corner)) != BRIO_NO_HALF_EDGE; corner = left) {
        uint32_t other = end_sector(p, left);
        if (!(p->state[other] & ON_CYCLE)) continue;
        p->chords[sector]++;
        p->chords[other]++;
    }
    list_if_free(p, sector);
}

/* --- removing vertices --- */

static void start_cycles(peeler *p) {
    brio_disk_cut *cut = &p->cut;
    for (uint32_t h = 0; h < cut->num_corners; h++) {
        cut->steps++;
        if (!(cut->flags[h] & BRIO_EDGE_CUT)) continue;
        cut->flags[h] |= LIVE_END;
        p->out[cut->sector[h]] = h;
        p->state[cut->sector[h]] |= ON_CYCLE;
    }
    for (uint32_t h = 0; h < cut->num_corners; h++) {
        uint32_t a = cut->sector[h], b = end_sector(p, h);
        bool inside = !(cut->flags[h] & BRIO_EDGE_CUT) && h < cut->twin[h];
        if (!inside || !(p->state[a] & ON_CYCLE) || !(p->state[b] & ON_CYCLE)) continue;
        p->chords[a]++;
        p->chords[b]++;
    }
    for (uint32_t s = 0; s < cut->num_sectors; s++)
        if (p->state[s] & ON_CYCLE) list_if_free(p, s);
}

/* Ends work on a disk of which one triangle is left: chooses its three edges. */
static void choose_last_triangle(peeler *p, uint32_t corner) {
    for (uint32_t h = corner, i = 0; i < 3; i++, h = brio_next_corner(h)) {
        p->cut.flags[h] |= CHOSEN;
        p->state[p->cut.sector[h]] &= (uint8_t)~ON_CYCLE;
    }
    p->num_disks++;
}

/* Removes the triangles of sector z: the half-edges opposite to z join the cycle. Returns the last corner of z. */
static uint32_t open_fan(peeler *p, uint32_t z) {
    uint32_t corner = p->out[z], last;
    do {
        last = corner;
        uint32_t twin = p->cut.twin[brio_next_corner(corner)];
        corner = live_left(p, corner);
        p->cut.flags[twin] |= LIVE_END;
        p->out[p->cut.sector[twin]] = twin;
    } while (corner != BRIO_NO_HALF_EDGE);
    return last;
}

static void remove_vertex(peeler *p, uint32_t z) {
    uint32_t first = p->out[z];
    if (p->cut.flags[brio_next_corner(first)] & LIVE_END) {
        choose_last_triangle(p, first);
        return;
    }
    uint32_t last = open_fan(p, z);
    p->state[z] &= (uint8_t)~ON_CYCLE;
    p->removals[p->num_removals++] = (removal){first, last};
    if (first == last) {
        const uint32_t ends[2] = {end_sector(p, first), p->cut.sector[brio_previous_corner(first)]};
        for (int i = 0; i < 2; i++) {
            p->chords[ends[i]]--;
            list_if_free(p, ends[i]);
        }
        return;
    }
    for (uint32_t corner = first; corner != last;) {
        uint32_t left = p->cut.twin[brio_previous_corner(corner)];
        enter_cycle(p, end_sector(p, left));
        corner = left;
    }
}

static brio_status peel(brio_context *ctx, peeler *p) {
    start_cycles(p);
    for (size_t round = 1; p->num_free; round++) {
        uint32_t z = p->free[--p->num_free];
        p->state[z] &= (uint8_t)~LISTED;
        p->cut.steps++;
        if ((p->state[z] & ON_CYCLE) && !p->chords[z]) remove_vertex(p, z);
        if (round % ROUNDS_A_REPORT == 0) BRIO_FORWARD(brio_progress(ctx, "subgraph", 0.7));
    }
    BRIO_EXPECT(ctx, p->num_removals + 3 * p->num_disks == p->cut.num_sectors, BRIO_ERR_INTERNAL,
                "a disk is left without a vertex free of chords");
    return BRIO_OK;
}

/* --- restoring vertices --- */

/* Returns the flags that represent the edge of h: those of the lower half-edge when the edge is not cut. The two sides
 * of a cut edge count as two edges. */
static uint8_t *flags_of_edge(const peeler *p, uint32_t h) {
    uint32_t twin = p->cut.twin[h];
    return &p->cut.flags[(p->cut.flags[h] & BRIO_EDGE_CUT) || h < twin ? h : twin];
}

static void restore_vertices(peeler *p) {
    for (size_t i = 0; i < p->cut.num_corners; i++)
        if (p->cut.flags[i] & CHOSEN) {
            p->cut.flags[i] &= (uint8_t)~CHOSEN;
            *flags_of_edge(p, (uint32_t)i) |= CHOSEN;
        }
    for (size_t i = p->num_removals; i-- > 0;) {
        const removal *z = &p->removals[i];
        *flags_of_edge(p, brio_next_corner(z->first)) &= (uint8_t)~CHOSEN;
        *flags_of_edge(p, brio_next_corner(z->last)) &= (uint8_t)~CHOSEN;
        *flags_of_edge(p, z->first) |= CHOSEN;
        *flags_of_edge(p, brio_previous_corner(z->first)) |= CHOSEN;
        *flags_of_edge(p, brio_previous_corner(z->last)) |= CHOSEN;
        p->cut.steps += 5;
    }
}

/* Returns whether half-edge h represents its edge in the result. For a cut edge one side suffices: both sides are in
 * the subgraphs of their disks, because each contains its disk's boundary cycle. */
static bool is_result(const peeler *p, uint32_t h) {
    return h < p->cut.twin[h] && (p->cut.flags[h] & CHOSEN);
}

static brio_status collect(brio_context *ctx, const brio_mesh *mesh, const peeler *p, brio_edges *out) {
    size_t count = 0;
    for (uint32_t h = 0; h < p->cut.num_corners; h++) count += is_result(p, h);
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->ends, 2 * count));
    for (uint32_t h = 0; h < p->cut.num_corners; h++) {
        if (!is_result(p, h)) continue;
        out->ends[2 * out->count] = mesh->face_vertices[h];
        out->ends[2 * out->count++ + 1] = mesh->face_vertices[brio_next_corner(h)];
    }
    return BRIO_OK;
}

/* --- all of it --- */

static brio_status start_peeler(brio_context *ctx, const brio_mesh *mesh, peeler *p) {
    BRIO_FORWARD(brio_disk_cut_make(ctx, mesh, &p->cut));
    size_t n = p->cut.num_sectors;
    BRIO_FORWARD(BRIO_ALLOC(ctx, p->out, n));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, p->chords, n));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, p->state, n));
    BRIO_FORWARD(BRIO_ALLOC(ctx, p->free, n));
    return BRIO_ALLOC(ctx, p->removals, n);
}

static brio_status fill_stats(brio_context *ctx, const brio_mesh *mesh, const peeler *p, const brio_edges *edges,
                              brio_subgraph_stats *stats) {
    brio_status status = BRIO_OK;
    uint32_t *degree = NULL;
    *stats = (brio_subgraph_stats){.copies = p->cut.num_sectors, .steps = p->cut.steps};
    for (uint32_t h = 0; h < p->cut.num_corners; h++)
        stats->cut_edges += h < p->cut.twin[h] && (p->cut.flags[h] & BRIO_EDGE_CUT);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, degree, mesh->num_vertices));
    for (size_t i = 0; i < 2 * edges->count; i++) {
        uint32_t d = ++degree[edges->ends[i]];
        stats->vertices += d == 1;
        if (d > stats->max_degree) stats->max_degree = d;
    }
done:
    brio_release(ctx, degree);
    return status;
}

brio_status brio_spanning_subgraph(brio_context *ctx, const brio_mesh *mesh, brio_edges *out,
                                   brio_subgraph_stats *stats) {
    brio_status status = BRIO_OK;
    peeler p = {0};
    *out = (brio_edges){.context = ctx};
    BRIO_TRY(start_peeler(ctx, mesh, &p));
    BRIO_TRY(peel(ctx, &p));
    restore_vertices(&p);
    BRIO_TRY(collect(ctx, mesh, &p, out));
    if (stats) BRIO_TRY(fill_stats(ctx, mesh, &p, out, stats));
    BRIO_TRY(brio_progress(ctx, "subgraph", 1));
done:
    brio_disk_cut_free(ctx, &p.cut);
    brio_release(ctx, p.out);
    brio_release(ctx, p.chords);
    brio_release(ctx, p.state);
    brio_release(ctx, p.free);
    brio_release(ctx, p.removals);
    if (status != BRIO_OK) brio_edges_free(out);
    return status;
}

/* --- all kinds --- */

/* Makes a tree out of the list of all edges. */
static brio_status spanning_tree(brio_context *ctx, const brio_mesh *mesh, brio_subgraph kind, brio_edges *out) {
    brio_status status = BRIO_OK;
    brio_edges all = {0};
    BRIO_TRY(brio_mesh_edges(ctx, mesh, &all));
    BRIO_TRY(brio_progress(ctx, "subgraph", 0.5));
    if (kind == BRIO_SUBGRAPH_MINIMUM)
        BRIO_TRY(brio_minimum_spanning_tree(ctx, &all, mesh->vertices, mesh->num_vertices, out));
    else
        BRIO_TRY(brio_breadth_first_tree(ctx, &all, mesh->num_vertices, out));
done:
    brio_edges_free(&all);
    return status;
}

brio_status brio_mesh_subgraph(brio_context *ctx, const brio_mesh *mesh, brio_subgraph kind, brio_edges *out) {
    BRIO_DOOR;
    *out = (brio_edges){.context = ctx};
    switch (kind) {
    case BRIO_SUBGRAPH_BOUNDED:
        return brio_spanning_subgraph(ctx, mesh, out, NULL);
    case BRIO_SUBGRAPH_MINIMUM:
    case BRIO_SUBGRAPH_TREE:
        return spanning_tree(ctx, mesh, kind, out);
    case BRIO_SUBGRAPH_ALL:
        return brio_mesh_edges(ctx, mesh, out);
    case BRIO_SUBGRAPH_END:
        break;
    }
    return brio_fail(ctx, BRIO_ERR_ARGUMENT, "no kind of subgraph %d", (int)kind);
}
