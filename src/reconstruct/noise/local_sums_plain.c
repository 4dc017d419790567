/* Sums over a neighbourhood with the instructions that every processor has. */
#define LOCAL_SUMS brio_local_sums_plain
#include "reconstruct/noise/local_sums_lanes.h"
