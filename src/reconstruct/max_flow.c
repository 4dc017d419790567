/* Maximum flow by two search trees that are kept between augmentations.
 *
 * A tree grows from the source along arcs with residual capacity, another one from the sink against them. Where they
 * meet there is an augmenting path; the flow along it saturates arcs, and the nodes below a saturated arc of their tree
 * become orphans: each looks for another parent in its tree, or leaves the tree and makes its children orphans. The
 * flow is maximal when no node of either tree can grow. Nodes of the trees keep the time of their last check and their
 * distance from the terminal, so that an orphan sees quickly whether a parent still hangs on the tree, and takes the
 * nearest one.
 *
 * Based on: Boykov, Kolmogorov. An experimental comparison of min-cut/max-flow algorithms for energy minimization in
 * vision. IEEE PAMI 2004. */
#include "reconstruct/max_flow.h"
#include "base/memory.h"

enum { NO_ARC = UINT32_MAX, AT_TERMINAL = UINT32_MAX - 1, ORPHAN = UINT32_MAX - 2, NO_NODE = UINT32_MAX };
enum { FREE = BRIO_FLOW_FREE, SOURCE = BRIO_FLOW_SOURCE, SINK = BRIO_FLOW_SINK };

/* Arcs leave a node in the run first[node] .. first[node + 1); the mate of an arc runs the other way. */
typedef struct {
    brio_context *ctx;
    size_t num_nodes;
    uint32_t *first, *head, *mate;
    int32_t *residual;
    int64_t *terminal;
    uint8_t *side;
    uint32_t *parent;   /* the arc from the node to its parent, or one of the marks above */
    uint32_t *distance; /* to the terminal, right at the time of `checked` */
    uint32_t *checked;
    uint32_t time;
    uint32_t *next_active; /* queue of active nodes, linked; a node in it points to itself at the end */
    uint32_t active_head, active_tail;
    uint32_t *orphans; /* ring of nodes, each in it at most once */
    size_t orphan_first, num_orphans;
} flow;

/* --- the graph --- */

static brio_status make_arcs(flow *f, const brio_flow_edge *edges, size_t num_edges) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->ctx;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f->first, f->num_nodes + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, f->head, 2 * num_edges));
    BRIO_TRY(BRIO_ALLOC(ctx, f->mate, 2 * num_edges));
    BRIO_TRY(BRIO_ALLOC(ctx, f->residual, 2 * num_edges));
    for (size_t e = 0; e < num_edges; e++) f->first[edges[e].a]++, f->first[edges[e].b]++;
    for (size_t v = 0, start = 0; v <= f->num_nodes; v++) {
        start += f->first[v];
        f->first[v] = (uint32_t)start; /* the end of its run; filling goes down to the beginning */
    }
    for (size_t e = 0; e < num_edges; e++) {
        uint32_t there = --f->first[edges[e].a], back = --f->first[edges[e].b];
        f->head[there] = edges[e].b, f->mate[there] = back;
        f->head[back] = edges[e].a, f->mate[back] = there;
        f->residual[there] = f->residual[back] = edges[e].capacity;
    }
done:
    return status;
}

/* What an arc of a node's run still carries away from the terminal of the node's tree. */
static int32_t capacity_outwards(const flow *f, uint8_t side, uint32_t arc) {
    return f->residual[side == SOURCE ? arc : f->mate[arc]];
}

static int32_t capacity_inwards(const flow *f, uint8_t side, uint32_t arc) {
    return f->residual[side == SOURCE ? f->mate[arc] : arc];
}

/* --- queues --- */

static void activate(flow *f, uint32_t v) {
    if (f->next_active[v] != NO_NODE) return;
    if (f->active_head == NO_NODE)
        f->active_head = v;
    else
        f->next_active[f->active_tail] = v;
    f->active_tail = v;
    f->next_active[v] = v;
}

static void pop_active(flow *f) {
    uint32_t v = f->active_head;
    f->active_head = f->next_active[v] == v ? NO_NODE : f->next_active[v];
    f->next_active[v] = NO_NODE;
}

static void make_orphan(flow *f, uint32_t v) {
    size_t at = f->orphan_first + f->num_orphans++;
    f->parent[v] = ORPHAN;
    f->orphans[at < f->num_nodes ? at : at - f->num_nodes] = v;
}

static uint32_t pop_orphan(flow *f) {
    uint32_t v = f->orphans[f->orphan_first];
    f->orphan_first = f->orphan_first + 1 < f->num_nodes ? f->orphan_first + 1 : 0;
    f->num_orphans--;
    return v;
}

/* --- growing --- */

static void plant(flow *f) {
    for (uint32_t v = 0; v < f->num_nodes; v++) {
        f->next_active[v] = NO_NODE;
        f->parent[v] = NO_ARC;
        f->side[v] = f->terminal[v] > 0 ? SOURCE : f->terminal[v] < 0 ? SINK : FREE;
    }
    f->active_head = NO_NODE;
    for (uint32_t v = 0; v < f->num_nodes; v++)
        if (f->side[v] != FREE) {
            f->parent[v] = AT_TERMINAL;
            f->distance[v] = 1;
            activate(f, v);
        }
}

static void hang(flow *f, uint32_t v, uint32_t arc_to_parent, uint32_t parent) {
    f->parent[v] = arc_to_parent;
    f->distance[v] = f->distance[parent] + 1;
    f->checked[v] = f->checked[parent];
}

/* Grows the tree from an active node. Returns an arc from the tree of the source to that of the sink, or NO_ARC when
 * the node cannot grow any more. */
static uint32_t grow(flow *f, uint32_t v) {
    uint8_t side = f->side[v];
    for (uint32_t arc = f->first[v]; arc < f->first[v + 1]; arc++) {
        if (!capacity_outwards(f, side, arc)) continue;
        uint32_t w = f->head[arc];
        if (f->side[w] == FREE) {
            f->side[w] = side;
            hang(f, w, f->mate[arc], v);
            activate(f, w);
        } else if (f->side[w] != side) {
            return side == SOURCE ? arc : f->mate[arc];
        } else if (f->checked[w] <= f->checked[v] && f->distance[w] > f->distance[v] + 1 && f->parent[w] < ORPHAN) {
            hang(f, w, f->mate[arc], v);
        }
    }
    return NO_ARC;
}

/* --- augmenting --- */

/* The arc between v and its parent that flow takes. */
static uint32_t flow_arc(const flow *f, uint32_t v) {
    return f->side[v] == SOURCE ? f->mate[f->parent[v]] : f->parent[v];
}

/* The least that the path between v and its terminal still carries. */
static int64_t least_along(const flow *f, uint32_t v) {
    int64_t least = INT64_MAX;
    for (; f->parent[v] != AT_TERMINAL; v = f->head[f->parent[v]]) {
        int32_t residual = f->residual[flow_arc(f, v)];
        if (residual < least) least = residual;
    }
    int64_t terminal = f->side[v] == SOURCE ? f->terminal[v] : -f->terminal[v];
    return terminal < least ? terminal : least;
}

static void send_along(flow *f, uint32_t v, int64_t amount) {
    while (f->parent[v] != AT_TERMINAL) {
        uint32_t arc = flow_arc(f, v), up = f->head[f->parent[v]];
        f->residual[arc] -= (int32_t)amount;
        f->residual[f->mate[arc]] += (int32_t)amount;
        if (!f->residual[arc]) make_orphan(f, v);
        v = up;
    }
    f->terminal[v] -= f->side[v] == SOURCE ? amount : -amount;
    if (!f->terminal[v]) make_orphan(f, v);
}

static void augment(flow *f, uint32_t arc) {
    uint32_t from = f->head[f->mate[arc]], to = f->head[arc];
    int64_t amount = f->residual[arc], before = least_along(f, from), after = least_along(f, to);
    if (before < amount) amount = before;
    if (after < amount) amount = after;
    f->residual[arc] -= (int32_t)amount;
    f->residual[f->mate[arc]] += (int32_t)amount;
    send_along(f, from, amount);
    send_along(f, to, amount);
}

/* --- adopting --- */

/* Distance of v from its terminal along parents, or UINT32_MAX when the way up ends at an orphan; nodes on a good way
 * are marked as checked. */
static uint32_t distance_to_terminal(flow *f, uint32_t v) {
    uint32_t distance = 0, top = v;
    for (;; top = f->head[f->parent[top]]) {
        if (f->checked[top] == f->time) {
            distance += f->distance[top];
            break;
        }
        if (f->parent[top] == ORPHAN) return UINT32_MAX;
        distance++;
        if (f->parent[top] == AT_TERMINAL) {
            f->checked[top] = f->time;
            f->distance[top] = 1;
            break;
        }
    }
    for (uint32_t d = distance; f->checked[v] != f->time; v = f->head[f->parent[v]]) {
        f->checked[v] = f->time;
        f->distance[v] = d--;
    }
    return distance;
}

/* Makes the children of v orphans and v free. */
static void abandon(flow *f, uint32_t v) {
    uint8_t side = f->side[v];
    for (uint32_t arc = f->first[v]; arc < f->first[v + 1]; arc++) {
        uint32_t w = f->head[arc];
        if (f->side[w] != side) continue;
        if (capacity_inwards(f, side, arc)) activate(f, w);
        if (f->parent[w] == f->mate[arc]) make_orphan(f, w);
    }
    f->side[v] = FREE;
    f->parent[v] = NO_ARC;
}

static void adopt(flow *f, uint32_t v) {
    uint8_t side = f->side[v];
    uint32_t best = NO_ARC, least = UINT32_MAX;
    for (uint32_t arc = f->first[v]; arc < f->first[v + 1]; arc++) {
        if (!capacity_inwards(f, side, arc) || f->side[f->head[arc]] != side) continue;
        uint32_t distance = distance_to_terminal(f, f->head[arc]);
        if (distance < least) least = distance, best = arc;
    }
    if (best == NO_ARC) {
        abandon(f, v);
        return;
    }
    f->parent[v] = best;
    f->distance[v] = least + 1;
    f->checked[v] = f->time;
}

/* --- the whole --- */

/* Whether it ended within `work` looks at the arcs of orphans. */
static brio_status run(flow *f, uint64_t work, bool *ended) {
    brio_status status = BRIO_OK;
    uint64_t done_work = 0;
    *ended = false;
    while (f->active_head != NO_NODE) {
        uint32_t v = f->active_head, arc = f->side[v] == FREE ? NO_ARC : grow(f, v);
        if (arc == NO_ARC) {
            pop_active(f);
            continue;
        }
        if (f->time++ % 4096 == 0) BRIO_TRY(brio_progress(f->ctx, "label", 0.75));
        augment(f, arc);
        while (f->num_orphans) {
            uint32_t orphan = pop_orphan(f);
            done_work += f->first[orphan + 1] - f->first[orphan];
            adopt(f, orphan);
        }
        if (done_work > work) return BRIO_OK;
    }
    *ended = true;
done:
    return status;
}

brio_status brio_max_flow(brio_context *ctx, size_t num_nodes, const brio_flow_edge *edges, size_t num_edges,
                          int64_t *terminal, uint8_t *side, uint64_t work, bool *ended) {
    brio_status status = BRIO_OK;
    flow f = {.ctx = ctx, .num_nodes = num_nodes, .terminal = terminal, .side = side};
    BRIO_REQUIRE(ctx, num_nodes < ORPHAN && num_edges < ORPHAN / 2, BRIO_ERR_TOO_LARGE,
                 "%zu edges of a flow are more than 32-bit indices can name", num_edges);
    BRIO_TRY(make_arcs(&f, edges, num_edges));
    BRIO_TRY(BRIO_ALLOC(ctx, f.parent, num_nodes));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f.distance, num_nodes));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f.checked, num_nodes));
    BRIO_TRY(BRIO_ALLOC(ctx, f.next_active, num_nodes));
    BRIO_TRY(BRIO_ALLOC(ctx, f.orphans, num_nodes));
    plant(&f);
    BRIO_TRY(run(&f, work, ended));
done:
    brio_release(ctx, f.first);
    brio_release(ctx, f.head);
    brio_release(ctx, f.mate);
    brio_release(ctx, f.residual);
    brio_release(ctx, f.parent);
    brio_release(ctx, f.distance);
    brio_release(ctx, f.checked);
    brio_release(ctx, f.next_active);
    brio_release(ctx, f.orphans);
    return status;
}
