/* The instruction set in use. The environment is read when the library is loaded, before a program has threads that
 * could change it. */
#include "base/instruction_set.h"
#include <assert.h>
#include <stdlib.h>
#include <string.h>
#if defined(__x86_64__)
#include <cpuid.h>
#endif

static const char *const NAME[BRIO_INSTRUCTION_SETS] = {"plain", "avx2", "avx512"};

brio_instruction_set brio_instructions_in_use = BRIO_PLAIN;

const char *brio_instruction_set_name(brio_instruction_set set) {
    assert((unsigned)set < BRIO_INSTRUCTION_SETS);
    return NAME[set];
}

#if defined(__x86_64__)

/* Registers that the system keeps for each thread, by bits of XCR0: those of AVX, and besides those of AVX-512. */
enum { KEPT_FOR_AVX = 0x06, KEPT_FOR_AVX512 = 0xe6 };

static bool has_all(unsigned int bits, unsigned int wanted) {
    return (bits & wanted) == wanted;
}

/* Asks the processor itself: __builtin_cpu_supports says no to everything where the compiler's library does not fill
 * what it reads, as in the cross compiler of the packages.
 * Based on: Intel 64 and IA-32 Architectures Software Developer's Manual, volume 1, 14.3, 14.7 and 15.2. */
brio_instruction_set brio_most_instructions(void) {
    unsigned int a, basic, more, c, d, kept;
    if (!__get_cpuid(1, &a, &more, &basic, &d) || !has_all(basic, bit_OSXSAVE | bit_AVX | bit_FMA)) return BRIO_PLAIN;
    /* volatile: a processor without it must not come here before the test above */
    __asm__ volatile("xgetbv" : "=a"(kept), "=d"(d) : "c"(0));
    if (!has_all(kept, KEPT_FOR_AVX) || !__get_cpuid_count(7, 0, &a, &more, &c, &d) || !has_all(more, bit_AVX2))
        return BRIO_PLAIN;
    bool wide = has_all(kept, KEPT_FOR_AVX512) && has_all(more, bit_AVX512F | bit_AVX512DQ | bit_AVX512VL);
    return wide ? BRIO_AVX512 : BRIO_AVX2;
}

#else

brio_instruction_set brio_most_instructions(void) {
    return BRIO_PLAIN;
}

#endif

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
