/* The insertion order: options that commands of triangulations and hulls share. */
#include "cli/steps/order.h"
#include <math.h>

const option_choice cli_orders[] = {{"brio", BRIO_ORDER_BRIO},
                                    {"brio-octree", BRIO_ORDER_BRIO_OCTREE},
                                    {"brio-kdtree", BRIO_ORDER_BRIO_KDTREE},
                                    {"octree", BRIO_ORDER_OCTREE},
                                    {"hilbert", BRIO_ORDER_HILBERT},
                                    {"random", BRIO_ORDER_RANDOM},
                                    {"input", BRIO_ORDER_INPUT},
                                    {NULL, 0}};

brio_order cli_order_of(const order_options *o) {
    return o->order == FITTING_ORDER ? BRIO_ORDER_BRIO : (brio_order)o->order;
}

brio_status cli_check_order(run *r, const order_options *o, brio_order order) {
    bool in_blocks = order == BRIO_ORDER_BRIO_OCTREE || order == BRIO_ORDER_BRIO_KDTREE;
    bool in_rounds = order == BRIO_ORDER_BRIO || in_blocks;
    if (o->block_size && !in_blocks && order != BRIO_ORDER_OCTREE)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--block-size: only with --order brio-octree, brio-kdtree or octree");
    if (!isnan(o->round_ratio) && !in_rounds)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--round-ratio: the insertion order has no rounds");
    if (o->round_ratio <= 0 || o->round_ratio >= 1)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--round-ratio: %g is not between 0 and 1", o->round_ratio);
    return BRIO_OK;
}
