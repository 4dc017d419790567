/* A test under every instruction set that the processor has. */
#ifndef BRIO_TESTS_INSTRUCTION_SETS_H
#define BRIO_TESTS_INSTRUCTION_SETS_H

#include "base/instruction_set.h"
#include <stdio.h>

/** Uses a set; false, and a line that says so, where the processor does not have it. */
static inline bool use_set(int set) {
    if (brio_use_instructions((brio_instruction_set)set)) return true;
    printf("skipped: %s, which this processor does not have\n", brio_instruction_set_name((brio_instruction_set)set));
    return false;
}

/** Back to the largest set. */
static inline void use_largest_set(void) {
    brio_use_instructions(brio_most_instructions());
}

#endif
