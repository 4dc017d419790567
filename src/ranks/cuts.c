/* Minimum cuts whose parts are decided by all ranks: each part is a closed task (tasks.h) of rank 0. */
#include "base/memory.h"
#include "ranks/tasks.h"
#include "ranks/work.h"
#include "reconstruct/labels/cut_in_parts.h"
#include <string.h>

/* --- a part as bytes ---
 *
 * A task is this head, then mates, capacities, terminals and sums outside of brio_part_cut, of four bytes each. An
 * answer is the labels, filled up to a multiple of 8 bytes, then, if the graph keeps its flow, the capacities that it
 * has left. */
typedef struct {
    uint64_t num_nodes, keeps_flow;
} part_head;

static size_t labels_size(size_t num_nodes) {
    return (num_nodes + 7) / 8 * 8;
}

static size_t part_size(size_t num_nodes) {
    return sizeof(part_head) + num_nodes * 4 * (4 + 4 + 1 + 1);
}

static size_t answer_size(const void *task, size_t size) {
    part_head h;
    (void)size;
    memcpy(&h, task, sizeof h);
    return labels_size(h.num_nodes) + (h.keeps_flow ? 4 * sizeof(int32_t) * h.num_nodes : 0);
}

typedef struct {
    void *rows;
    size_t size;
} block;

/* Lists the arrays of a part in the order in which they are sent. */
static void list_blocks(const brio_part_cut *c, block blocks[4]) {
    size_t n = c->num_nodes;
    blocks[0] = (block){c->mate, 4 * n * sizeof *c->mate};
    blocks[1] = (block){c->capacity, 4 * n * sizeof *c->capacity};
    blocks[2] = (block){c->terminal, n * sizeof *c->terminal};
    blocks[3] = (block){c->outside, n * sizeof *c->outside};
}

/* Decides a part, on any rank. */
static brio_status decide_part(brio_context *ctx, const void *task, size_t size, void *answer) {
    brio_status status = BRIO_OK;
    part_head h;
    brio_part_cut cut = {0};
    block blocks[4];
    const uint8_t *at = (const uint8_t *)task + sizeof h;
    memcpy(&h, task, sizeof h);
    BRIO_REQUIRE(ctx, size == part_size(h.num_nodes), BRIO_ERR_OPEN, "a part of %llu nodes has %zu bytes",
                 (unsigned long long)h.num_nodes, size);
    BRIO_TRY(brio_part_cut_new(ctx, h.num_nodes, true, &cut));
    list_blocks(&cut, blocks);
    for (int k = 0; k < 4; at += blocks[k++].size) memcpy(blocks[k].rows, at, blocks[k].size);
    memset((uint8_t *)answer + labels_size(h.num_nodes) - 8, 0, 8); /* what fills the labels up */
    BRIO_TRY(brio_part_cut_decide(ctx, &cut, true, answer));
    if (h.keeps_flow) memcpy((uint8_t *)answer + labels_size(h.num_nodes), blocks[1].rows, blocks[1].size);
done:
    brio_part_cut_free(ctx, &cut);
    return status;
}

static const brio_task_kind PARTS = {answer_size, decide_part};

/* --- rank 0 --- */

static size_t size_of_part(void *user, size_t i) {
    return part_size(brio_part_nodes(user, i));
}

static brio_status write_part(void *user, size_t i, void *bytes) {
    const brio_parts *p = user;
    brio_status status = BRIO_OK;
    brio_part_cut cut = {0};
    block blocks[4];
    part_head h = {brio_part_nodes(p, i), p->g->residual != NULL};
    uint8_t *at = (uint8_t *)bytes + sizeof h;
    memcpy(bytes, &h, sizeof h);
    BRIO_TRY(brio_parts_collect(p, i, &cut));
    list_blocks(&cut, blocks);
    for (int k = 0; k < 4; at += blocks[k++].size) memcpy(at, blocks[k].rows, blocks[k].size);
done:
    brio_part_cut_free(p->g->ctx, &cut);
    return status;
}

static brio_status take_labels(void *user, size_t i, const void *answer, size_t size) {
    brio_parts *p = user;
    size_t labels = labels_size(brio_part_nodes(p, i));
    /* only read */
    const brio_part_cut left = {.capacity = size > labels ? (int32_t *)((uintptr_t)answer + labels) : NULL};
    return brio_parts_keep(p, i, &left, answer);
}

brio_status brio_ranks_lead_cut(brio_exchange *x, brio_parts *p) {
    const brio_tasks tasks = {p->num_parts, size_of_part, write_part, take_labels, p};
    return brio_tasks_share(x, &tasks, &PARTS);
}

brio_status brio_ranks_follow_cut(brio_exchange *x) {
    return brio_tasks_share(x, NULL, &PARTS);
}
