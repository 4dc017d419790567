/* Maximum flow by two search trees that are kept between augmentations, for graphs whose arcs are kept in different
 * ways.
 *
 * One tree grows from the source along arcs with residual capacity, the other grows from the sink against such arcs. An
 * arc between the trees closes an augmenting path. The flow along the path saturates arcs, and the node below a
 * saturated arc of its tree becomes an orphan. An orphan looks for another parent in its tree. If there is none, it
 * leaves the tree and its children become orphans. The flow is maximal when no node of either tree can grow. Each node
 * of a tree keeps its distance from the terminal and the time of its last check. With these an orphan finds out quickly
 * which nodes are still connected to the terminal, and takes the nearest one as its parent.
 *
 * After a flow the terminals may change. The trees stay, except for nodes whose terminal is now another one or
 * saturated, so little is to be done if few terminals change. An arc can be closed: no tree and no flow uses it.
 *
 * Includers define first
 *   FLOW, FLOW_TERMINAL      the type of the workspace, with a member `trees` and the arrays node, terminal and side;
 *                            the type of the entries of `terminal`,
 *   FLOW_NODES(f)            the number of nodes, and
 *   FLOW_FIRST(f, v), FLOW_END(f, v), FLOW_HEAD(f, arc), FLOW_MATE(f, arc), FLOW_RESIDUAL(f, arc)
 *                            the arcs that leave a node, the end of an arc, the same edge in the other direction, and
 *                            its residual capacity, which can be assigned, and
 *   FLOW_IS_CLOSED(f, arc)   whether an arc is closed.
 * They get clear(f), which empties the trees of all nodes, plant(f), which makes the trees fit the terminals, and
 * push(f), which makes the flow maximal. Where few terminals change, fit_terminal(f, v) for these and then adopt_all(f)
 * do what plant(f) does. The ring of orphans is in the entries 0 to room - 1 of `node`.
 *
 * Based on: Boykov, Kolmogorov. An experimental comparison of min-cut/max-flow algorithms for energy minimization in
 *           vision. IEEE PAMI 2004.
 *           Kohli, Torr. Dynamic graph cuts for efficient inference in Markov random fields. IEEE PAMI 2007 (terminals
 *           that change). */
#include "reconstruct/labels/max_flow.h"

/* Marks in `parent`: no parent, the terminal is the parent, the node is an orphan. NO_NODE is a mark in next_active. */
enum { NO_ARC = UINT32_MAX, AT_TERMINAL = UINT32_MAX - 1, ORPHAN = UINT32_MAX - 2, NO_NODE = UINT32_MAX };
enum { FREE = BRIO_FLOW_FREE, SOURCE = BRIO_FLOW_SOURCE, SINK = BRIO_FLOW_SINK };

/* Returns the residual capacity of an arc in the direction away from the terminal of the tree `side`. */
static int32_t capacity_outwards(const FLOW *f, uint8_t side, uint32_t arc) {
    return FLOW_RESIDUAL(f, side == SOURCE ? arc : FLOW_MATE(f, arc));
}

/* Returns the residual capacity of an arc in the direction towards the terminal of the tree `side`. */
static int32_t capacity_inwards(const FLOW *f, uint8_t side, uint32_t arc) {
    return FLOW_RESIDUAL(f, side == SOURCE ? FLOW_MATE(f, arc) : arc);
}

/* --- queues --- */

static void activate(FLOW *f, uint32_t v) {
    if (f->node[v].next_active != NO_NODE) return;
    if (f->trees.active_head == NO_NODE)
        f->trees.active_head = v;
    else
        f->node[f->trees.active_tail].next_active = v;
    f->trees.active_tail = v;
    f->node[v].next_active = v;
}

static void pop_active(FLOW *f) {
    uint32_t v = f->trees.active_head;
    f->trees.active_head = f->node[v].next_active == v ? NO_NODE : f->node[v].next_active;
    f->node[v].next_active = NO_NODE;
}

static void make_orphan(FLOW *f, uint32_t v) {
    size_t at = f->trees.orphan_first + f->trees.num_orphans++;
    f->node[v].parent = ORPHAN;
    f->node[at < f->trees.room ? at : at - f->trees.room].orphan = v;
}

static uint32_t pop_orphan(FLOW *f) {
    uint32_t v = f->node[f->trees.orphan_first].orphan;
    f->trees.orphan_first = f->trees.orphan_first + 1 < f->trees.room ? f->trees.orphan_first + 1 : 0;
    f->trees.num_orphans--;
    return v;
}

/* --- growing --- */

static void hang(FLOW *f, uint32_t v, uint32_t arc_to_parent, uint32_t parent) {
    f->node[v].parent = arc_to_parent;
    f->node[v].distance = f->node[parent].distance + 1;
    f->node[v].checked = f->node[parent].checked;
}

/* Returns whether w, a node of the tree of v, is known to come nearer to the terminal with v as its parent. */
static bool is_nearer_by(const FLOW *f, uint32_t v, uint32_t w) {
    const brio_flow_node *here = &f->node[v], *there = &f->node[w];
    return there->checked <= here->checked && there->distance > here->distance + 1 && there->parent < ORPHAN;
}

/* Grows the tree from an active node. Returns an arc that leads from the source's tree to the sink's tree, or NO_ARC if
 * the node cannot grow any more. */
static uint32_t grow(FLOW *f, uint32_t v) {
    uint8_t side = f->side[v];
    for (uint32_t arc = FLOW_FIRST(f, v); arc < FLOW_END(f, v); arc++) {
        uint32_t w = FLOW_HEAD(f, arc);
        if (FLOW_IS_CLOSED(f, arc)) continue;
        if (f->side[w] == side) {
            if (is_nearer_by(f, v, w) && capacity_outwards(f, side, arc)) hang(f, w, FLOW_MATE(f, arc), v);
        } else if (capacity_outwards(f, side, arc)) {
            if (f->side[w] != FREE) return side == SOURCE ? arc : FLOW_MATE(f, arc);
            f->side[w] = side;
            hang(f, w, FLOW_MATE(f, arc), v);
            activate(f, w);
        }
    }
    return NO_ARC;
}

/* --- augmenting --- */

/* Returns the arc between v and its parent in the direction of the flow. */
static uint32_t flow_arc(const FLOW *f, uint32_t v) {
    return f->side[v] == SOURCE ? FLOW_MATE(f, f->node[v].parent) : f->node[v].parent;
}

/* Returns the least residual capacity on the path between v and its terminal. */
static int64_t least_along(const FLOW *f, uint32_t v) {
    int64_t least = INT64_MAX;
    for (; f->node[v].parent != AT_TERMINAL; v = FLOW_HEAD(f, f->node[v].parent)) {
        int32_t residual = FLOW_RESIDUAL(f, flow_arc(f, v));
        if (residual < least) least = residual;
    }
    int64_t terminal = f->side[v] == SOURCE ? f->terminal[v] : -f->terminal[v];
    return terminal < least ? terminal : least;
}

static void send_along(FLOW *f, uint32_t v, int64_t amount) {
    while (f->node[v].parent != AT_TERMINAL) {
        uint32_t arc = flow_arc(f, v), up = FLOW_HEAD(f, f->node[v].parent);
        FLOW_RESIDUAL(f, arc) -= (int32_t)amount;
        FLOW_RESIDUAL(f, FLOW_MATE(f, arc)) += (int32_t)amount;
        if (!FLOW_RESIDUAL(f, arc)) make_orphan(f, v);
        v = up;
    }
    f->terminal[v] -= (FLOW_TERMINAL)(f->side[v] == SOURCE ? amount : -amount);
    if (!f->terminal[v]) make_orphan(f, v);
}

static void augment(FLOW *f, uint32_t arc) {
    uint32_t from = FLOW_HEAD(f, FLOW_MATE(f, arc)), to = FLOW_HEAD(f, arc);
    int64_t amount = FLOW_RESIDUAL(f, arc), before = least_along(f, from), after = least_along(f, to);
    if (before < amount) amount = before;
    if (after < amount) amount = after;
    FLOW_RESIDUAL(f, arc) -= (int32_t)amount;
    FLOW_RESIDUAL(f, FLOW_MATE(f, arc)) += (int32_t)amount;
    send_along(f, from, amount);
    send_along(f, to, amount);
}

/* --- adopting --- */

/* Returns the distance of v from its terminal along parents, or UINT32_MAX if the path ends at an orphan. Marks the
 * nodes of a path that reaches the terminal as checked. */
static uint32_t distance_to_terminal(FLOW *f, uint32_t v) {
    uint32_t distance = 0, top = v;
    for (;; top = FLOW_HEAD(f, f->node[top].parent)) {
        if (f->node[top].checked == f->trees.time) {
            distance += f->node[top].distance;
            break;
        }
        if (f->node[top].parent == ORPHAN) return UINT32_MAX;
        distance++;
        if (f->node[top].parent == AT_TERMINAL) {
            f->node[top].checked = f->trees.time;
            f->node[top].distance = 1;
            break;
        }
    }
    for (uint32_t d = distance; f->node[v].checked != f->trees.time; v = FLOW_HEAD(f, f->node[v].parent)) {
        f->node[v].checked = f->trees.time;
        f->node[v].distance = d--;
    }
    return distance;
}

/* Frees v from its tree and makes the children of v orphans. */
static void abandon(FLOW *f, uint32_t v) {
    uint8_t side = f->side[v];
    for (uint32_t arc = FLOW_FIRST(f, v); arc < FLOW_END(f, v); arc++) {
        uint32_t w = FLOW_HEAD(f, arc);
        if (FLOW_IS_CLOSED(f, arc) || f->side[w] != side) continue;
        if (capacity_inwards(f, side, arc)) activate(f, w);
        if (f->node[w].parent == FLOW_MATE(f, arc)) make_orphan(f, w);
    }
    f->side[v] = FREE;
    f->node[v].parent = NO_ARC;
}

static void adopt(FLOW *f, uint32_t v) {
    uint8_t side = f->side[v];
    uint32_t best = NO_ARC, least = UINT32_MAX;
    for (uint32_t arc = FLOW_FIRST(f, v); arc < FLOW_END(f, v); arc++) {
        if (FLOW_IS_CLOSED(f, arc) || f->side[FLOW_HEAD(f, arc)] != side || !capacity_inwards(f, side, arc)) continue;
        uint32_t distance = distance_to_terminal(f, FLOW_HEAD(f, arc));
        if (distance < least) least = distance, best = arc;
    }
    if (best == NO_ARC) {
        abandon(f, v);
        return;
    }
    f->node[v].parent = best;
    f->node[v].distance = least + 1;
    f->node[v].checked = f->trees.time;
}

/* Adopts the orphans. A node that is no orphan any more, because it was planted since, is left alone. */
static void adopt_all(FLOW *f) {
    while (f->trees.num_orphans) {
        uint32_t v = pop_orphan(f);
        if (f->node[v].parent == ORPHAN) adopt(f, v);
    }
}

/* --- planting --- */

static void clear(FLOW *f) {
    for (size_t i = 0; i < FLOW_NODES(f); i++) {
        f->node[i].next_active = NO_NODE;
        f->node[i].parent = NO_ARC;
        f->node[i].checked = 0;
        f->side[i] = FREE;
    }
}

/* Makes a node of either tree or of none a child of the terminal of a tree. */
static void plant_node(FLOW *f, uint32_t v, uint8_t side) {
    if (f->side[v] != FREE && f->side[v] != side) abandon(f, v);
    if (f->side[v] == FREE) activate(f, v);
    f->side[v] = side;
    f->node[v].parent = AT_TERMINAL;
    f->node[v].distance = 1;
}

/* Makes the trees fit the terminal of a node. A terminal that is saturated may have been the node's parent. */
static inline void fit_terminal(FLOW *f, uint32_t v) {
    uint8_t side = f->terminal[v] > 0 ? SOURCE : SINK;
    if (f->terminal[v] == 0) {
        if (f->node[v].parent == AT_TERMINAL) make_orphan(f, v);
    } else if (side != f->side[v] || f->node[v].parent != AT_TERMINAL) {
        plant_node(f, v, side);
    }
}

/* Makes the trees fit all terminals. */
static void plant(FLOW *f) {
    f->trees.time++;
    for (size_t i = 0; i < FLOW_NODES(f); i++) fit_terminal(f, (uint32_t)i);
    adopt_all(f);
}

/* --- the whole --- */

static void push(FLOW *f) {
    while (f->trees.active_head != NO_NODE) {
        uint32_t v = f->trees.active_head, arc = f->side[v] == FREE ? NO_ARC : grow(f, v);
        if (arc == NO_ARC) {
            pop_active(f);
            continue;
        }
        f->trees.time++;
        augment(f, arc);
        adopt_all(f);
    }
}
