/* The instruction set that the library uses: found once, when the library is loaded, for all code that comes in
 * versions for several sets. */
#ifndef BRIO_BASE_INSTRUCTION_SET_H
#define BRIO_BASE_INSTRUCTION_SET_H

#include <stdbool.h>

/** Each set contains the sets before it.
 *  plain   what the compiler was told that every processor has
 *  avx2    AVX2 and fused multiply-add: four doubles a register
 *  avx512  AVX-512 F, DQ and VL: eight doubles a register */
typedef enum { BRIO_PLAIN, BRIO_AVX2, BRIO_AVX512, BRIO_INSTRUCTION_SETS } brio_instruction_set;

/** The set in use. Written when the library is loaded, and by brio_use_instructions. */
extern brio_instruction_set brio_instructions_in_use;

static inline brio_instruction_set brio_instructions(void) {
    return brio_instructions_in_use;
}

/** Returns whether the processor multiplies and adds in one rounding; a constant where the target always or never
 *  does. */
static inline bool brio_have_fma(void) {
#if defined(__FMA__) || defined(__aarch64__)
    return true;
#elif defined(__x86_64__)
    return brio_instructions() >= BRIO_AVX2;
#else
    return false;
#endif
}

/** Returns the name of a set: plain, avx2 or avx512. */
const char *brio_instruction_set_name(brio_instruction_set set);

/** Returns the largest set that this processor has. */
brio_instruction_set brio_most_instructions(void);

/** Returns the set for a value of the environment variable BRIO_INSTRUCTIONS: the set that the value names. A value
 *  that is NULL, that names no set, or a set that the processor does not have, gives the largest set. */
brio_instruction_set brio_instructions_for(const char *name);

/** Uses a set from now on, for tests. No other thread may be in the library. Returns false, and changes nothing, where
 *  the processor does not have the set. */
bool brio_use_instructions(brio_instruction_set set);

#endif
