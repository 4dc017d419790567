/* Centres without the vector instructions of newer processors. */
#include "predicates/lanes_plain.h"

#define CENTRES brio_centres_plain
#include "predicates/centre_lanes.h"
