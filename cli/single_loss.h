/* What single precision would do to points. */
#ifndef BRIO_CLI_SINGLE_LOSS_H
#define BRIO_CLI_SINGLE_LOSS_H

#include "run.h"

typedef struct single_loss {
    size_t points, merged; /* points; how many of them fall on others */
    double largest;        /* the coordinate of largest magnitude */
    double moved;          /* the most that a coordinate moves; 0 where single precision cannot hold `largest` */
    double spacing;        /* the typical distance of neighbours; 0: unknown, or nothing moves */
} single_loss;

/** Finds the loss of the points of a mesh. */
brio_status cli_single_loss(run *r, const brio_mesh *mesh, single_loss *loss);

/** Finds the loss of the points that a conversion of a file takes. Reads the file once, in blocks: points that merge are
 *  counted in each block, and the spacing is the least of some blocks. Says nothing of what cannot be read twice.
 *  o  its box and `thin` choose among the points.
 *  Returns BRIO_OK also for files with errors, which the conversion will find. */
brio_status cli_single_loss_of_file(run *r, const char *path, const brio_convert_options *o, single_loss *loss);

/** Returns whether the loss ruins the points.   reason  receives why. */
bool cli_single_is_harmful(const single_loss *loss, char reason[200]);

#endif
