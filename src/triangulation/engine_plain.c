/* The inner loops with the instructions that every processor of the target has: two doubles a register. */
#include "predicates/lanes_plain.h"

#include "triangulation/conflict_lanes.h"
#include "triangulation/sound_lanes.h"

#define WALK      brio_locate_walk
#define ABREAST   brio_locate_abreast
#define ENGINE    brio_engine_plain
#define FIND_ROWS find_rows
#include "triangulation/engine_body.h"
