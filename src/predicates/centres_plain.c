/* Computes centres with the instructions that every processor has. */
#include "predicates/lanes_plain.h"

#define CENTRES brio_centres_plain
#include "predicates/centre_lanes.h"
