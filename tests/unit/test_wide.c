/* Products of 128 bits and their quotients, against the compiler's integers of 128 bits where it has them, and by themselves. */
#include "base/rng.h"
#include "base/wide.h"
#include "harness.h"

/* Numbers with many zeros and many ones, where carries happen. */
static uint64_t draw(brio_rng *rng) {
    uint64_t x = brio_rng_next(rng);
    switch (brio_rng_next(rng) % 6) {
    case 0:
        return UINT64_MAX - x % 3;
    case 1:
        return x % 3;
    case 2:
        return x | UINT64_C(0xffffffff);
    case 3:
        return x << 32;
    case 4:
        return UINT64_C(1) << x % 64;
    default:
        return x;
    }
}

/* (a b + c + d) / a is b and what is left, if c + d is small; with the greatest numbers there is no carry beyond 128 bits. */
static void products_divide_again(void) {
    brio_rng rng = brio_rng_new(1);
    uint64_t high, low, rest;
    low = brio_multiply_add(UINT64_MAX, UINT64_MAX, UINT64_MAX, UINT64_MAX, &high);
    EXPECT(low == UINT64_MAX && high == UINT64_MAX);
    for (int i = 0; i < 100000; i++) {
        uint64_t a = draw(&rng) | UINT64_C(1) << 63, b = draw(&rng), c = draw(&rng) % a;
        low = brio_multiply_add(a, b, c, 0, &high);
        EXPECT(brio_divide_wide(high, low, a, &rest) == b && rest == c, "%llx %llx %llx", (unsigned long long)a,
               (unsigned long long)b, (unsigned long long)c);
    }
}

static void products_are_those_of_the_compiler(void) {
#ifdef __SIZEOF_INT128__
    __extension__ typedef unsigned __int128 wide;
    brio_rng rng = brio_rng_new(2);
    for (int i = 0; i < 100000; i++) {
        uint64_t a = draw(&rng), b = draw(&rng), c = draw(&rng), d = draw(&rng), high;
        uint64_t low = brio_multiply_add(a, b, c, d, &high);
        EXPECT(((wide)high << 64 | low) == (wide)a * b + c + d, "%llx %llx %llx %llx", (unsigned long long)a,
               (unsigned long long)b, (unsigned long long)c, (unsigned long long)d);
    }
#else
    printf("skipped: the compiler has no integers of 128 bits to compare with\n");
#endif
}

SUITE(test_wide) {
    RUN(products_divide_again);
    RUN(products_are_those_of_the_compiler);
    return harness_end();
}
