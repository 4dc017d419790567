/* Maximum flow by two search trees that are kept between augmentations.
 *
 * One tree grows from the source along arcs with residual capacity, the other grows from the sink against such arcs. An
 * arc between the trees closes an augmenting path. The flow along the path saturates arcs, and the node below a
 * saturated arc of its tree becomes an orphan. An orphan looks for another parent in its tree. If there is none, it
 * leaves the tree and its children become orphans. The flow is maximal when no node of either tree can grow. Each node
 * of a tree keeps its distance from the terminal and the time of its last check. With these an orphan finds out quickly
 * which nodes are still connected to the terminal, and takes the nearest one as its parent.
 *
 * Based on: Boykov, Kolmogorov. An experimental comparison of min-cut/max-flow algorithms for energy minimization in
 *           vision. IEEE PAMI 2004. */
#include "reconstruct/labels/max_flow.h"
#include "base/memory.h"
#include <string.h>

/* Marks in `parent`: no parent, the terminal is the parent, the node is an orphan. NO_NODE is a mark in next_active. */
enum { NO_ARC = UINT32_MAX, AT_TERMINAL = UINT32_MAX - 1, ORPHAN = UINT32_MAX - 2, NO_NODE = UINT32_MAX };
enum { FREE = BRIO_FLOW_FREE, SOURCE = BRIO_FLOW_SOURCE, SINK = BRIO_FLOW_SINK };

/* --- the graph --- */

static brio_status make_arcs(brio_flow *f, const brio_flow_edge *edges, size_t num_edges) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->node, f->node_capacity, f->num_nodes + 1));
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->arc, f->arc_capacity, 2 * num_edges));
    memset(f->node, 0, (f->num_nodes + 1) * sizeof *f->node);
    for (size_t e = 0; e < num_edges; e++) f->node[edges[e].a].first++, f->node[edges[e].b].first++;
    for (size_t v = 0, start = 0; v <= f->num_nodes; v++) {
        start += f->node[v].first;
        f->node[v].first = (uint32_t)start; /* the end of the arcs of v; the next loop fills them backwards */
    }
    for (size_t e = 0; e < num_edges; e++) {
        brio_flow_edge x = edges[e];
        uint32_t there = --f->node[x.a].first, back = --f->node[x.b].first;
        f->arc[there] = (brio_flow_arc){x.b, back, x.capacity};
        f->arc[back] = (brio_flow_arc){x.a, there, x.capacity};
    }
done:
    return status;
}

/* Returns the residual capacity of an arc in the direction away from the terminal of the tree `side`. */
static int32_t capacity_outwards(const brio_flow *f, uint8_t side, uint32_t arc) {
    return f->arc[side == SOURCE ? arc : f->arc[arc].mate].residual;
}

/* Returns the residual capacity of an arc in the direction towards the terminal of the tree `side`. */
static int32_t capacity_inwards(const brio_flow *f, uint8_t side, uint32_t arc) {
    return f->arc[side == SOURCE ? f->arc[arc].mate : arc].residual;
}

/* --- queues --- */

static void activate(brio_flow *f, uint32_t v) {
    if (f->node[v].next_active != NO_NODE) return;
    if (f->active_head == NO_NODE)
        f->active_head = v;
    else
        f->node[f->active_tail].next_active = v;
    f->active_tail = v;
    f->node[v].next_active = v;
}

static void pop_active(brio_flow *f) {
    uint32_t v = f->active_head;
    f->active_head = f->node[v].next_active == v ? NO_NODE : f->node[v].next_active;
    f->node[v].next_active = NO_NODE;
}

static void make_orphan(brio_flow *f, uint32_t v) {
    size_t at = f->orphan_first + f->num_orphans++;
    f->node[v].parent = ORPHAN;
    f->node[at < f->num_nodes ? at : at - f->num_nodes].orphan = v;
}

static uint32_t pop_orphan(brio_flow *f) {
    uint32_t v = f->node[f->orphan_first].orphan;
    f->orphan_first = f->orphan_first + 1 < f->num_nodes ? f->orphan_first + 1 : 0;
    f->num_orphans--;
    return v;
}

/* --- growing --- */

static void plant(brio_flow *f) {
    for (uint32_t v = 0; v < f->num_nodes; v++) {
        f->node[v].next_active = NO_NODE;
        f->node[v].parent = NO_ARC;
        f->node[v].checked = 0;
        f->side[v] = f->terminal[v] > 0 ? SOURCE : f->terminal[v] < 0 ? SINK : FREE;
    }
    f->active_head = NO_NODE;
    for (uint32_t v = 0; v < f->num_nodes; v++)
        if (f->side[v] != FREE) {
            f->node[v].parent = AT_TERMINAL;
            f->node[v].distance = 1;
            activate(f, v);
        }
}

static void hang(brio_flow *f, uint32_t v, uint32_t arc_to_parent, uint32_t parent) {
    f->node[v].parent = arc_to_parent;
    f->node[v].distance = f->node[parent].distance + 1;
    f->node[v].checked = f->node[parent].checked;
}

/* Returns whether w, a node of the tree of v, is known to come nearer to the terminal with v as its parent. */
static bool is_nearer_by(const brio_flow *f, uint32_t v, uint32_t w) {
    const brio_flow_node *here = &f->node[v], *there = &f->node[w];
    return there->checked <= here->checked && there->distance > here->distance + 1 && there->parent < ORPHAN;
}

/* Grows the tree from an active node. Returns an arc that leads from the source's tree to the sink's tree, or NO_ARC if
 * the node cannot grow any more. */
static uint32_t grow(brio_flow *f, uint32_t v) {
    uint8_t side = f->side[v];
    for (uint32_t arc = f->node[v].first; arc < f->node[v + 1].first; arc++) {
        uint32_t w = f->arc[arc].head;
        if (f->side[w] == side) {
            if (is_nearer_by(f, v, w) && capacity_outwards(f, side, arc)) hang(f, w, f->arc[arc].mate, v);
        } else if (capacity_outwards(f, side, arc)) {
            if (f->side[w] != FREE) return side == SOURCE ? arc : f->arc[arc].mate;
            f->side[w] = side;
            hang(f, w, f->arc[arc].mate, v);
            activate(f, w);
        }
    }
    return NO_ARC;
}

/* --- augmenting --- */

/* Returns the arc between v and its parent in the direction of the flow. */
static uint32_t flow_arc(const brio_flow *f, uint32_t v) {
    return f->side[v] == SOURCE ? f->arc[f->node[v].parent].mate : f->node[v].parent;
}

/* Returns the least residual capacity on the path between v and its terminal. */
static int64_t least_along(const brio_flow *f, uint32_t v) {
    int64_t least = INT64_MAX;
    for (; f->node[v].parent != AT_TERMINAL; v = f->arc[f->node[v].parent].head) {
        int32_t residual = f->arc[flow_arc(f, v)].residual;
        if (residual < least) least = residual;
    }
    int64_t terminal = f->side[v] == SOURCE ? f->terminal[v] : -f->terminal[v];
    return terminal < least ? terminal : least;
}

static void send_along(brio_flow *f, uint32_t v, int64_t amount) {
    while (f->node[v].parent != AT_TERMINAL) {
        uint32_t arc = flow_arc(f, v), up = f->arc[f->node[v].parent].head;
        f->arc[arc].residual -= (int32_t)amount;
        f->arc[f->arc[arc].mate].residual += (int32_t)amount;
        if (!f->arc[arc].residual) make_orphan(f, v);
        v = up;
    }
    f->terminal[v] -= f->side[v] == SOURCE ? amount : -amount;
    if (!f->terminal[v]) make_orphan(f, v);
}

static void augment(brio_flow *f, uint32_t arc) {
    uint32_t from = f->arc[f->arc[arc].mate].head, to = f->arc[arc].head;
    int64_t amount = f->arc[arc].residual, before = least_along(f, from), after = least_along(f, to);
    if (before < amount) amount = before;
    if (after < amount) amount = after;
    f->arc[arc].residual -= (int32_t)amount;
    f->arc[f->arc[arc].mate].residual += (int32_t)amount;
    send_along(f, from, amount);
    send_along(f, to, amount);
}

/* --- adopting --- */

/* Returns the distance of v from its terminal along parents, or UINT32_MAX if the path ends at an orphan. Marks the
 * nodes of a path that reaches the terminal as checked. */
static uint32_t distance_to_terminal(brio_flow *f, uint32_t v) {
    uint32_t distance = 0, top = v;
    for (;; top = f->arc[f->node[top].parent].head) {
        if (f->node[top].checked == f->time) {
            distance += f->node[top].distance;
            break;
        }
        if (f->node[top].parent == ORPHAN) return UINT32_MAX;
        distance++;
        if (f->node[top].parent == AT_TERMINAL) {
            f->node[top].checked = f->time;
            f->node[top].distance = 1;
            break;
        }
    }
    for (uint32_t d = distance; f->node[v].checked != f->time; v = f->arc[f->node[v].parent].head) {
        f->node[v].checked = f->time;
        f->node[v].distance = d--;
    }
    return distance;
}

/* Frees v from its tree and makes the children of v orphans. */
static void abandon(brio_flow *f, uint32_t v) {
    uint8_t side = f->side[v];
    for (uint32_t arc = f->node[v].first; arc < f->node[v + 1].first; arc++) {
        uint32_t w = f->arc[arc].head;
        if (f->side[w] != side) continue;
        if (capacity_inwards(f, side, arc)) activate(f, w);
        if (f->node[w].parent == f->arc[arc].mate) make_orphan(f, w);
    }
    f->side[v] = FREE;
    f->node[v].parent = NO_ARC;
}

static void adopt(brio_flow *f, uint32_t v) {
    uint8_t side = f->side[v];
    uint32_t best = NO_ARC, least = UINT32_MAX;
    for (uint32_t arc = f->node[v].first; arc < f->node[v + 1].first; arc++) {
        if (f->side[f->arc[arc].head] != side || !capacity_inwards(f, side, arc)) continue;
        uint32_t distance = distance_to_terminal(f, f->arc[arc].head);
        if (distance < least) least = distance, best = arc;
    }
    if (best == NO_ARC) {
        abandon(f, v);
        return;
    }
    f->node[v].parent = best;
    f->node[v].distance = least + 1;
    f->node[v].checked = f->time;
}

/* --- the whole --- */

brio_flow brio_flow_new(brio_context *ctx) {
    return (brio_flow){.ctx = ctx};
}

void brio_flow_free(brio_flow *f) {
    brio_release(f->ctx, f->node);
    brio_release(f->ctx, f->arc);
}

void brio_flow_again(brio_flow *f, int64_t *terminal, uint8_t *side) {
    f->terminal = terminal, f->side = side;
    f->time = 0, f->orphan_first = f->num_orphans = 0;
    plant(f);
    while (f->active_head != NO_NODE) {
        uint32_t v = f->active_head, arc = f->side[v] == FREE ? NO_ARC : grow(f, v);
        if (arc == NO_ARC) {
            pop_active(f);
            continue;
        }
        f->time++;
        augment(f, arc);
        while (f->num_orphans) adopt(f, pop_orphan(f));
    }
}

brio_status brio_flow_maximum(brio_flow *f, size_t num_nodes, const brio_flow_edge *edges, size_t num_edges,
                              int64_t *terminal, uint8_t *side) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(f->ctx, num_nodes < ORPHAN && num_edges < ORPHAN / 2, BRIO_ERR_TOO_LARGE,
                 "%zu edges of a flow are more than 32-bit indices can name", num_edges);
    f->num_nodes = num_nodes;
    BRIO_TRY(make_arcs(f, edges, num_edges));
    brio_flow_again(f, terminal, side);
done:
    return status;
}
