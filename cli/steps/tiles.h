/* --tiles: a triangulation tile after tile in the scratch folder. */
#ifndef BRIO_CLI_TILES_H
#define BRIO_CLI_TILES_H

#include "cli/steps/weights.h"

/** Rows of a command's option table whose struct has a uint64_t `field`. */
/* clang-format off */
#define TILES_ROWS(type, field)                                                                                        \
    {"tiles", 0, OPTION_NATURAL | OPTION_POSITIVE, offsetof(type, field), "N",                                         \
     "more points than fit in memory: N tiles, one after the other, in the folder of --scratch", 0}
/* clang-format on */

/** Refuses what --tiles does not go with: weights in a file, no scratch folder. */
brio_status cli_check_tiles(run *r, const weights_options *weights, uint64_t tiles);
/** Refuses an output that is not .pvtu. */
brio_status cli_check_tile_files(run *r);

/** Reads the input block by block, and triangulates it in tiles.
 *  stars  whether cells will be computed.   out  freed by the caller, also on an error. */
brio_status cli_triangulate_tiles(run *r, const weights_options *weights, uint64_t tiles, bool stars, brio_tiles **out);

/** Triangulates the input in tiles, and reports as brio delaunay does. Writes -o: x.pvtu, and a file for each tile in
 *  the folder x beside it. */
brio_status cli_tiles(run *r, const weights_options *weights, uint64_t tiles);

#endif
