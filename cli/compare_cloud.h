/* Points compared with a surface. */
#ifndef BRIO_CLI_COMPARE_CLOUD_H
#define BRIO_CLI_COMPARE_CLOUD_H

#include "run.h"

/** Reports how far points are from a surface, with the side; writes them with the property `distance` to -o.
 *  within  > 0: fails with BRIO_ERR_CHECK if a point is farther. */
brio_status cli_compare_cloud(run *r, brio_mesh *points, const brio_mesh *surface, double within);

/** Reports whether `worst` is within a limit, and fails with BRIO_ERR_CHECK if not.   outside  of `all` points. */
brio_status cli_judge_within(run *r, double worst, double within, size_t outside, size_t all);

#endif
