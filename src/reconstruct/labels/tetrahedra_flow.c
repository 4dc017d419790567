/* Maximum flow of tetrahedra: see flow_body.h. An arc is a facet handle: 4 t + i leads from tetrahedron t across its
 * facet i. So the triangulation has heads and mates, and a tetrahedron costs 41 bytes, a third of what lists of edges
 * take.
 *
 * The open tetrahedra are cut into parts of consecutive ones, which are near each other in space. At first the arcs
 * between parts are closed, and any thread finds the maximum flow of each part. Then MERGED parts that follow each
 * other become one: the arcs between them open, and the flow goes on from there. Most flow is short, and only nodes at
 * the borders are active. In the end one thread merges what is left. A closed arc holds the complement of its residual
 * capacity, a negative number. So a part reads nothing that another part writes.
 *
 * Where the arrays are in scratch files, parts merge block by block, each as large as fits in a part of the memory. So
 * what is merged was read a moment ago, and all is read once for all levels within the blocks, not once a level.
 *
 * Based on: Liu, Sun. Parallel graph-cuts by adaptive bottom-up merging. CVPR 2010.
 * Differs from the paper: which parts merge does not depend on their sizes or borders. */
#include "reconstruct/labels/tetrahedra_flow.h"
#include "base/memory.h"
#include "base/team.h"
#include <string.h>

/* PART_SIZE: chosen, the arrays of a part fit into a cache of 2 MB. MERGED: parts that become one; chosen. */
enum { PART_SIZE = 1 << 15, MERGED = 4, AHEAD = 1 << 13 };

/* A block of the nodes takes at most one in SHARE bytes of the memory. NODE_BYTES: of a node in all arrays. SHARE is
 * chosen. */
enum { SHARE = 3, NODE_BYTES = 73 };

static uint32_t tet_at(const brio_tet_flow *f, size_t i) {
    return f->open ? f->open[i] : (uint32_t)i;
}

#define FLOW                 brio_tet_flow
#define FLOW_TERMINAL        int32_t
#define FLOW_NODES(f)        ((f)->to - (f)->from)
#define FLOW_NODE(f, i)      tet_at(f, (f)->from + (i))
#define FLOW_FIRST(f, v)     brio_facet_of(v, 0)
#define FLOW_END(f, v)       (brio_facet_of(v, 3) + 1)
#define FLOW_HEAD(f, a)      brio_tet_of(*brio_mate((f)->t, a))
#define FLOW_MATE(f, a)      (*brio_mate((f)->t, a))
#define FLOW_RESIDUAL(f, a)  ((f)->residual[brio_tet_of(a)][brio_slot_of(a)])
#define FLOW_IS_CLOSED(f, a) (FLOW_RESIDUAL(f, a) < 0)
#include "reconstruct/labels/flow_body.h"

brio_status brio_tet_flow_new(brio_context *ctx, const brio_tetrahedra *t, const uint32_t *open, size_t num_open,
                              brio_tet_flow *out) {
    brio_status status = BRIO_OK;
    *out = (brio_tet_flow){.ctx = ctx,
                           .t = t,
                           .open = open,
                           .num_open = num_open,
                           .part_size = PART_SIZE,
                           .most_together = ctx->scratch ? brio_memory_limit(ctx) / SHARE / NODE_BYTES : num_open};
    BRIO_TRY(BRIO_ALLOC(ctx, out->node, t->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->residual, t->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->terminal, t->count));
    BRIO_TRY(BRIO_ALLOC(ctx, out->side, t->count));
    memset(out->side, BRIO_FLOW_FREE, t->count);
done:
    return status;
}

void brio_tet_flow_free(brio_tet_flow *f) {
    brio_release(f->ctx, f->node);
    brio_release(f->ctx, f->residual);
    brio_release(f->ctx, f->terminal);
    brio_release(f->ctx, f->side);
    *f = (brio_tet_flow){.ctx = f->ctx};
}

/* --- parts --- */

/* Closes or opens an arc. */
static void toggle(int32_t *residual) {
    *residual = ~*residual;
}

/* Announces what the nodes from `from` to `to` - 1 are known by. */
static void expect_nodes(const brio_tet_flow *f, size_t from, size_t to, bool all) {
    if (from >= to) return;
    if (all)
        brio_expect_rows(f->ctx, BRIO_ARRAYS(BRIO_READS(f->t->tet), BRIO_READS(f->node), BRIO_READS(f->terminal)),
                         tet_at(f, from), (size_t)tet_at(f, to - 1) + 1);
    brio_expect_rows(f->ctx, BRIO_ARRAYS(BRIO_READS(f->residual), BRIO_READS(f->side)), tet_at(f, from),
                     (size_t)tet_at(f, to - 1) + 1);
}

/* Closes the arcs that leave the part. */
static void close_border(brio_tet_flow *f) {
    uint32_t first = tet_at(f, f->from), last = tet_at(f, f->to - 1);
    for (size_t i = f->from; i < f->to; i++) {
        uint32_t tet = tet_at(f, i);
        for (int k = 0; k < 4; k++) {
            uint32_t other = brio_tet_of(f->t->tet[tet].mate[k]);
            if (other < first || other > last) toggle(&f->residual[tet][k]);
        }
    }
}

/* Opens the arcs that do not leave the part. The nodes at their ends are active. */
static void open_within(brio_tet_flow *f) {
    uint32_t first = tet_at(f, f->from), last = tet_at(f, f->to - 1);
    for (size_t i = f->from; i < f->to; i++) {
        uint32_t tet = tet_at(f, i);
        bool border = false;
        if ((i - f->from) % AHEAD == 0 && f->to - i > AHEAD)
            expect_nodes(f, i + AHEAD, f->to - i > 2 * AHEAD ? i + 2 * AHEAD : f->to, false);
        for (int k = 0; k < 4; k++) {
            if (f->residual[tet][k] >= 0) continue;
            uint32_t other = brio_tet_of(f->t->tet[tet].mate[k]);
            if (other < first || other > last) continue;
            toggle(&f->residual[tet][k]);
            border = true;
        }
        if (border && f->side[tet] != FREE) activate(f, tet);
    }
}

typedef struct {
    const brio_tet_flow *flow;
    size_t first, end, size; /* the parts of this size between two places are pushed */
    bool merges;             /* whether the parts are made of smaller ones */
    uint32_t time;           /* the latest of a part */
    brio_status settled;
} pushing;

static void keep_later(uint32_t *latest, uint32_t time) {
    uint32_t old = __atomic_load_n(latest, __ATOMIC_RELAXED);
    while (old < time && !__atomic_compare_exchange_n(latest, &old, time, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) {}
}

/* Has the disk begin to write what a part has changed. */
static brio_status settle_nodes(const brio_tet_flow *f) {
    return brio_settle_rows(f->ctx,
                            BRIO_ARRAYS(BRIO_WRITES(f->residual), BRIO_WRITES(f->node), BRIO_WRITES(f->terminal)),
                            tet_at(f, f->from), (size_t)tet_at(f, f->to - 1) + 1);
}

/* Pushes the nodes of a part as far as that goes within. */
static void push_part(void *user, size_t from, size_t to, int thread) {
    pushing *p = user;
    brio_tet_flow f = *p->flow;
    (void)thread;
    f.from = p->first + from, f.to = p->first + to;
    f.trees = (brio_flow_trees){
        .room = to - from, .orphan_base = tet_at(&f, f.from), .time = p->flow->trees.time, .active_head = NO_NODE};
    if (p->merges) {
        open_within(&f);
    } else {
        expect_nodes(&f, f.to, f.to + p->size < p->end ? f.to + p->size : p->end, true);
        close_border(&f);
        if (!f.started) clear(&f);
        plant(&f);
    }
    push(&f);
    keep_later(&p->time, f.trees.time);
    if (!p->merges) brio_report(&p->settled, settle_nodes(&f));
}

/* Pushes parts of a size side by side, between two places. */
static brio_status push_parts(brio_tet_flow *f, size_t first, size_t end, size_t size, bool merges) {
    pushing p = {.flow = f, .first = first, .end = end, .size = size, .merges = merges, .time = f->trees.time};
    int threads = brio_threads(f->ctx, end - first, size);
    brio_status status = brio_for_chunks(f->ctx, threads, end - first, size, push_part, &p);
    f->trees.time = p.time;
    return status == BRIO_OK ? p.settled : status;
}

/* Returns how many nodes are merged before others are begun: a multiple of a part, or all. */
static size_t block_size(const brio_tet_flow *f) {
    size_t size = f->part_size;
    if (f->most_together >= f->num_open) return f->num_open;
    while (size < f->num_open && size <= f->most_together / MERGED) size *= MERGED;
    return size < f->num_open ? size : f->num_open;
}

/* Pushes the nodes of a block, in parts that merge. */
static brio_status push_block(brio_tet_flow *f, size_t first, size_t end, size_t *size) {
    brio_status status = BRIO_OK;
    *size = f->part_size;
    BRIO_TRY(push_parts(f, first, end, *size, false));
    while (*size <= (end - first) / 2 &&
           (f->most_together < f->num_open || brio_threads(f->ctx, end - first, *size) > 1))
        BRIO_TRY(push_parts(f, first, end, *size *= MERGED, true));
done:
    return status;
}

brio_status brio_tet_flow_run(brio_tet_flow *f) {
    brio_status status = BRIO_OK;
    size_t block = block_size(f), size = 0;
    for (size_t first = 0, end; first < f->num_open; first = end) {
        end = f->num_open - first < block ? f->num_open : first + block;
        BRIO_TRY(push_block(f, first, end, &size));
        if (size < block && end - first == block) BRIO_TRY(push_parts(f, first, end, block, true));
        size = block;
    }
    f->started = f->num_open > 0;
    if (block < f->num_open) BRIO_TRY(push_parts(f, 0, f->num_open, f->num_open, true));
done:
    return status;
}
