/* The instruction set in use. The environment is read when the library is loaded, before a program has threads that
 * could change it. */
#include "base/instruction_set.h"
#include <assert.h>
#include <stdlib.h>
#include <string.h>

static const char *const NAME[BRIO_INSTRUCTION_SETS] = {"plain", "avx2", "avx512"};

brio_instruction_set brio_instructions_in_use = BRIO_PLAIN;

const char *brio_instruction_set_name(brio_instruction_set set) {
    assert((unsigned)set < BRIO_INSTRUCTION_SETS);
    return NAME[set];
}

brio_instruction_set brio_most_instructions(void) {
#if defined(__x86_64__)
    __builtin_cpu_init();
    if (!__builtin_cpu_supports("avx2") || !__builtin_cpu_supports("fma")) return BRIO_PLAIN;
    bool wide =
        __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512vl");
    return wide ? BRIO_AVX512 : BRIO_AVX2;
#else
    return BRIO_PLAIN;
#endif
}

brio_instruction_set brio_instructions_for(const char *name) {
    brio_instruction_set most = brio_most_instructions();
    for (int set = 0; name && set < (int)most; set++)
        if (!strcmp(name, NAME[set])) return (brio_instruction_set)set;
    return most;
}

bool brio_use_instructions(brio_instruction_set set) {
    if (set > brio_most_instructions()) return false;
    assert((unsigned)set < BRIO_INSTRUCTION_SETS);
    brio_instructions_in_use = set;
    return true;
}

static __attribute__((constructor)) void choose_instructions(void) {
    brio_instructions_in_use = brio_instructions_for(getenv("BRIO_INSTRUCTIONS"));
}
