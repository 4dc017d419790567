/* The insertion order: options that commands of triangulations and hulls share. */
#include "cli/steps/order.h"
#include <math.h>

const option_choice cli_orders[] = {{"brio", BRIO_ORDER_BRIO},
                                    {"brio-octree", ORDER_IN_BLOCKS + BRIO_BLOCKS_BRIO_OCTREE},
                                    {"brio-kdtree", ORDER_IN_BLOCKS + BRIO_BLOCKS_BRIO_KDTREE},
                                    {"octree", ORDER_IN_BLOCKS + BRIO_BLOCKS_OCTREE},
                                    {"hilbert", BRIO_ORDER_HILBERT},
                                    {"random", BRIO_ORDER_RANDOM},
                                    {"input", BRIO_ORDER_INPUT},
                                    {NULL, 0}};

int cli_order_of(const order_options *o) {
    return o->order == FITTING_ORDER ? BRIO_ORDER_BRIO : o->order;
}

brio_order cli_library_order(int order) {
    return order < ORDER_IN_BLOCKS ? (brio_order)order : BRIO_ORDER_BRIO;
}

void cli_order_experiment(const order_options *o, brio_laboratory_options *lab) {
    int order = cli_order_of(o);
    if (order > ORDER_IN_BLOCKS) lab->order = (brio_laboratory_order)(order - ORDER_IN_BLOCKS);
    lab->block_size = (size_t)o->block_size;
}

brio_status cli_check_order(run *r, const order_options *o, int order) {
    bool in_blocks = order > ORDER_IN_BLOCKS, one_round = order == ORDER_IN_BLOCKS + BRIO_BLOCKS_OCTREE;
    bool in_rounds = order == BRIO_ORDER_BRIO || (in_blocks && !one_round);
    if (o->block_size && !in_blocks)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--block-size: only with --order brio-octree, brio-kdtree or octree");
    if (!isnan(o->round_ratio) && !in_rounds)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--round-ratio: the insertion order has no rounds");
    if (o->round_ratio <= 0 || o->round_ratio >= 1)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--round-ratio: %g is not between 0 and 1", o->round_ratio);
    return BRIO_OK;
}
