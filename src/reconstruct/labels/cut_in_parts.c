/* A part is a run of consecutive nodes. It is cut without knowing the rest (part_cut.c), which leaves some of its nodes
 * near the border undecided. The nodes that all parts left undecided make a smaller graph, with what is decided as
 * terminals. It is cut in the same way, until it is one part, or until parts decide less than half of it: then it is
 * cut as a whole. docs/decisions/042-cuts-in-closed-parts.md has the proof that this is the cut of the whole. */
#include "reconstruct/labels/cut_in_parts.h"
#include "base/memory.h"
#include <string.h>

/* MOST_SIZE, LEAST_SIZE: nodes of a part. A thread has PARTS parts, so that none waits long for another. The parts in
 * work take at most one in SHARE bytes of the memory, with NODE_BYTES a node. All chosen. */
enum { MOST_SIZE = 1 << 18, LEAST_SIZE = 1 << 12, PARTS = 4, SHARE = 4, NODE_BYTES = 62 };

/* Returns how many nodes may be in memory at once. */
static size_t most_held(const brio_context *ctx) {
    return brio_memory_limit(ctx) / SHARE / NODE_BYTES;
}

/* --- one part --- */

/* Makes a node of the graph one of a part: arcs that lead out of it go to `outside`. Subtracts what the last flow sends
 * along the others.
 *   residual  of the node after the last flow; its capacities if there was none. */
static void enclose(brio_part_cut *cut, uint32_t first, size_t v, const int32_t residual[4]) {
    uint32_t *mate = cut->mate + 4 * v, num_arcs = 4 * (uint32_t)cut->num_nodes;
    int32_t *capacity = cut->capacity + 4 * v, outside = 0, sent = 0;
    for (int k = 0; k < 4; k++) {
        bool in = mate[k] - 4 * first < num_arcs;
        int32_t all = capacity[k], left = in ? residual[k] : all;
        mate[k] = in ? mate[k] - 4 * first : BRIO_NO_MATE;
        outside += in ? 0 : all;
        sent += all - left;
        capacity[k] = left;
    }
    cut->terminal[v] -= sent;
    cut->outside[v] = outside;
}

/* Announces the stretch after that which begins at `from`. */
static void expect_stretch_after(const brio_cut_graph *g, size_t from, size_t end) {
    size_t next = from + BRIO_SWEEP_STRETCH, to = next + BRIO_SWEEP_STRETCH;
    brio_expect_rows(g->ctx, g->along, next, to < end ? to : end);
}

brio_status brio_parts_collect(const brio_parts *p, size_t i, brio_part_cut *out) {
    brio_status status = BRIO_OK;
    const brio_cut_graph *g = p->g;
    size_t first = brio_part_first(p, i), end = first + brio_part_nodes(p, i);
    BRIO_TRY(brio_part_cut_new(g->ctx, end - first, end - first <= most_held(g->ctx), out));
    brio_expect_rows(g->ctx, g->along, first, first + BRIO_SWEEP_STRETCH < end ? first + BRIO_SWEEP_STRETCH : end);
    for (size_t from = first, to; from < end; from = to) {
        to = end - from < BRIO_SWEEP_STRETCH ? end : from + BRIO_SWEEP_STRETCH;
        expect_stretch_after(g, from, end);
        g->read(g->user, from, to, out->mate + 4 * (from - first), out->capacity + 4 * (from - first),
                out->terminal + (from - first));
    }
    for (size_t v = 0; v < out->num_nodes; v++)
        enclose(out, (uint32_t)first, v, g->has_flow ? g->residual + 4 * (first + v) : out->capacity + 4 * v);
done:
    return status;
}

brio_status brio_parts_keep(brio_parts *p, size_t i, const brio_part_cut *cut, const uint8_t *label) {
    brio_status status = BRIO_OK;
    const brio_cut_graph *g = p->g;
    size_t first = brio_part_first(p, i), count = brio_part_nodes(p, i), num_left = 0;
    memcpy(p->label + first, label, count);
    if (g->residual) memcpy(g->residual + 4 * first, cut->capacity, 4 * count * sizeof *cut->capacity);
    for (size_t v = 0; v < count; v++) num_left += label[v] == BRIO_LABEL_NONE;
    BRIO_TRY(BRIO_ALLOC(g->ctx, p->left[i], num_left));
    for (size_t v = 0; v < count; v++) {
        if (label[v] != BRIO_LABEL_NONE) continue;
        brio_undecided *u = &p->left[i][p->num_left[i]++];
        u->node = (uint32_t)(first + v);
        g->read(g->user, u->node, (size_t)u->node + 1, u->mate, u->capacity, &u->terminal);
    }
done:
    return status;
}

typedef struct {
    brio_parts *parts;
    brio_status settled;
} deciding;

/* Collects, decides and keeps a part. */
static void decide_part(void *user, size_t begin, size_t end, int thread) {
    deciding *d = user;
    brio_parts *p = d->parts;
    brio_context *ctx = p->g->ctx;
    brio_status status = BRIO_OK;
    brio_part_cut cut = {0};
    uint8_t *label = NULL;
    size_t i = begin / p->size;
    (void)end, (void)thread;
    BRIO_TRY(brio_parts_collect(p, i, &cut));
    BRIO_TRY(BRIO_ALLOC(ctx, label, cut.num_nodes));
    BRIO_TRY(brio_part_cut_decide(ctx, &cut, cut.num_nodes <= most_held(ctx), label));
    BRIO_TRY(brio_parts_keep(p, i, &cut, label));
done:
    brio_part_cut_free(ctx, &cut);
    brio_release(ctx, label);
    brio_report(&d->settled, status);
}

static brio_status decide_by_threads(void *user, brio_parts *p) {
    deciding d = {p, BRIO_OK};
    const brio_cut_graph *g = p->g;
    (void)user;
    BRIO_FORWARD(
        brio_for_chunks(g->ctx, brio_threads(g->ctx, g->num_nodes, p->size), g->num_nodes, p->size, decide_part, &d));
    return d.settled;
}

/* --- what is left --- */

/* Returns the place of an undecided node among those of all parts.   first  #parts: the place of each part's first. */
static uint32_t place_of(const brio_parts *p, const size_t *first, uint32_t node) {
    size_t i = node / p->size, low = 0, high = p->num_left[i];
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (p->left[i][middle].node <= node)
            low = middle;
        else
            high = middle;
    }
    return (uint32_t)(first[i] + low);
}

/* Makes an undecided node one of the graph of what is left: mates that are decided become terminals. */
static void join_decided(const brio_parts *p, const size_t *first, brio_undecided *u) {
    for (int k = 0; k < 4; k++) {
        uint32_t mate = u->mate[k];
        uint8_t label = mate == BRIO_NO_MATE ? BRIO_LABEL_OUTER : p->label[mate / 4];
        if (label == BRIO_LABEL_NONE) {
            u->mate[k] = 4 * place_of(p, first, mate / 4) + mate % 4;
            continue;
        }
        u->terminal += label == BRIO_LABEL_OUTER ? u->capacity[k] : -u->capacity[k];
        u->mate[k] = BRIO_NO_MATE;
        u->capacity[k] = 0;
    }
}

static void read_left(const void *user, size_t begin, size_t end, uint32_t *mate, int32_t *capacity,
                      int32_t *terminal) {
    const brio_undecided *left = (const brio_undecided *)user + begin;
    for (size_t i = 0; i < end - begin; i++) {
        memcpy(mate + 4 * i, left[i].mate, sizeof left[i].mate);
        memcpy(capacity + 4 * i, left[i].capacity, sizeof left[i].capacity);
        terminal[i] = left[i].terminal;
    }
}

/* Lists the undecided nodes of all parts, in their order, as a graph.   count  of them. */
static brio_status list_left(const brio_parts *p, brio_undecided **left, size_t *count) {
    brio_status status = BRIO_OK;
    size_t *first = NULL;
    *count = 0;
    BRIO_TRY(BRIO_ALLOC(p->g->ctx, first, p->num_parts));
    for (size_t i = 0; i < p->num_parts; i++) first[i] = *count, *count += p->num_left[i];
    BRIO_TRY(BRIO_ALLOC(p->g->ctx, *left, *count));
    for (size_t i = 0; i < p->num_parts; i++)
        for (size_t k = 0; k < p->num_left[i]; k++) {
            brio_undecided *u = *left + first[i] + k;
            *u = p->left[i][k];
            join_decided(p, first, u);
        }
done:
    brio_release(p->g->ctx, first);
    return status;
}

/* Cuts the graph of what is left. */
static brio_status cut_left(const brio_parts *p, const brio_part_decider *decider) {
    brio_status status = BRIO_OK;
    brio_context *ctx = p->g->ctx;
    brio_undecided *left = NULL;
    uint8_t *label = NULL;
    size_t count;
    BRIO_TRY(list_left(p, &left, &count));
    if (count == 0) goto done;
    BRIO_TRY(BRIO_ALLOC(ctx, label, count));
    brio_cut_graph rest = {
        .ctx = ctx, .num_nodes = count, .read = read_left, .user = left, .along = {BRIO_READS(left)}};
    BRIO_TRY(brio_cut_in_parts(&rest, count <= p->g->num_nodes / 2 ? p->size : count, decider, label));
    for (size_t i = 0; i < count; i++) p->label[left[i].node] = label[i];
done:
    brio_release(ctx, left);
    brio_release(ctx, label);
    return status;
}

/* --- the whole --- */

/* Returns how many nodes of a part suit the memory and those who decide. */
static size_t suitable_size(const brio_cut_graph *g, const brio_part_decider *decider) {
    size_t size = MOST_SIZE, workers = decider ? decider->workers : 0;
    if (!workers) workers = (size_t)brio_threads(g->ctx, g->num_nodes, LEAST_SIZE);
    size_t held = most_held(g->ctx) / workers;
    if (workers > 1 && g->num_nodes / PARTS / workers < size) size = g->num_nodes / PARTS / workers;
    if (g->ctx->scratch && held < size) size = held;
    return size > LEAST_SIZE ? size : LEAST_SIZE;
}

brio_status brio_cut_in_parts(const brio_cut_graph *g, size_t size, const brio_part_decider *decider, uint8_t *label) {
    brio_status status = BRIO_OK;
    static const brio_part_decider THREADS = {decide_by_threads, NULL, 0};
    const brio_part_decider *others = g->ctx->decider;
    brio_parts p = {.g = g, .size = size ? size : suitable_size(g, decider ? decider : others), .label = label};
    p.num_parts = (g->num_nodes + p.size - 1) / p.size;
    const brio_part_decider *by = decider ? decider : others && p.num_parts > 1 ? others : &THREADS;
    BRIO_TRY(BRIO_ALLOC_ZERO(g->ctx, p.left, p.num_parts));
    BRIO_TRY(BRIO_ALLOC_ZERO(g->ctx, p.num_left, p.num_parts));
    BRIO_TRY(by->decide(by->user, &p));
    BRIO_TRY(cut_left(&p, decider));
done:
    for (size_t i = 0; p.left && i < p.num_parts; i++) brio_release(g->ctx, p.left[i]);
    brio_release(g->ctx, p.left);
    brio_release(g->ctx, p.num_left);
    return status;
}
