/* The inner loops in AVX2: four doubles a register. */
#if defined(__x86_64__)
#include "predicates/lanes_avx2.h"

#include "triangulation/conflict_lanes.h"
#include "triangulation/sound_lanes.h"
#include "triangulation/walk_lanes.h"

#define WALK      walk
#define ABREAST   walk_abreast
#define ENGINE    brio_engine_avx2
#define FIND_ROWS find_rows
#include "triangulation/engine_body.h"
#else
typedef int brio_no_avx2;
#endif
