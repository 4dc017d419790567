/* Exact dyadic arithmetic against 128-bit integers, against the laws of a ring where those are too small, and at the
 * limits of doubles. */
#include "predicates/dyadic.h"
#include "points.h"
#include "harness.h"

__extension__ typedef __int128 wide;

enum { TRIALS = 20000 };

/* --- oracles --- */

/* r = n 2^e, by bits: an implementation of its own. */
static void set_integer(brio_dyadic *r, wide n, int e) {
    unsigned __int128 m = n < 0 ? -(unsigned __int128)n : (unsigned __int128)n;
    uint64_t limb[4] = {0, 0, 0, 0};
    int low = e >= 0 ? e / 64 : -((63 - e) / 64), shift = e - 64 * low, first = 0, last = 4;
    for (int bit = 0; bit < 128; bit++)
        if (m >> bit & 1) limb[(bit + shift) / 64] |= UINT64_C(1) << (bit + shift) % 64;
    while (last > 0 && limb[last - 1] == 0) last--;
    while (first < last && limb[first] == 0) first++;
    *r = (brio_dyadic){.sign = n > 0 ? 1 : n < 0 ? -1 : 0, .low = n ? low + first : 0, .size = last - first};
    memcpy(r->limb, limb + first, (size_t)(last - first) * sizeof *limb);
}

/* Whether two numbers are the same, limb by limb: numbers that keep the invariants have one form. */
static bool same(const brio_dyadic *x, const brio_dyadic *y) {
    return x->sign == y->sign && x->low == y->low && x->size == y->size &&
           !memcmp(x->limb, y->limb, (size_t)x->size * sizeof *x->limb);
}

static bool keeps_invariants(const brio_dyadic *x) {
    if (x->size < 0 || x->size > BRIO_DYADIC_CAPACITY || x->sign < -1 || x->sign > 1) return false;
    if ((x->sign == 0) != (x->size == 0)) return false;
    return !x->size || (x->limb[0] != 0 && x->limb[x->size - 1] != 0);
}

#define EXPECT_SAME(x, y, ...) EXPECT(keeps_invariants(x) && same(x, y), __VA_ARGS__)

static wide random_integer(brio_rng *rng, int bits) {
    uint64_t high = (uint64_t)brio_rng_below(rng, UINT32_MAX) << 32 | brio_rng_below(rng, UINT32_MAX);
    wide n = (wide)(high >> (64 - bits));
    return brio_rng_below(rng, 2) ? n : -n;
}

/* A double of any exponent; every eighth one is 0, denormal, a power of two or at the limit. */
static double random_double(brio_rng *rng) {
    const double special[] = {
        0, -0.0, 0x1p-1074, -0x1p-1074, 0x1.fffffffffffffp1023, -0x1.fffffffffffffp1023, 0x1p-1022,
        1, -1,   0x1p64,    0x1p-64,    0x1.fffffffffffffp-1023};
    if (brio_rng_below(rng, 8) == 0) return special[brio_rng_below(rng, sizeof special / sizeof *special)];
    double m = 1 + brio_rng_double(rng);
    return ldexp(brio_rng_below(rng, 2) ? m : -m, (int)brio_rng_below(rng, 2098) - 1074);
}

/* --- setting --- */

static void every_double_is_set_exactly(void) {
    brio_rng rng = brio_rng_new(1);
    for (int e = -1200; e <= 1023; e++) /* powers of two; 0 below the denormals */
        for (int s = -1; s <= 1; s += 2) {
            brio_dyadic x, wanted;
            double power = ldexp(s, e);
            brio_dyadic_set(&x, power);
            set_integer(&wanted, power == 0 ? 0 : s, e);
            EXPECT_SAME(&x, &wanted, "%a", power);
        }
    for (int i = 0; i < TRIALS; i++) {
        wide n = random_integer(&rng, 53);
        int e = (int)brio_rng_below(&rng, 1074 + 971) - 1074;
        brio_dyadic x, wanted;
        brio_dyadic_set(&x, ldexp((double)n, e));
        set_integer(&wanted, n, e);
        EXPECT_SAME(&x, &wanted, "%a", ldexp((double)n, e));
    }
}

/* --- integers times powers of two --- */

/* Sums, differences and products of n 2^e and m 2^f whose exact results fit into 128 bits. */
static void small_results_are_those_of_integers(void) {
    brio_rng rng = brio_rng_new(2);
    for (int i = 0; i < TRIALS; i++) {
        int bits = 1 + (int)brio_rng_below(&rng, 62), apart = (int)brio_rng_below(&rng, 60);
        int e = (int)brio_rng_below(&rng, 4000) - 2000;
        wide n = random_integer(&rng, bits), m = random_integer(&rng, bits);
        if (brio_rng_below(&rng, 8) == 0) m = n, apart = 0;
        brio_dyadic x, y, r, wanted;
        set_integer(&x, n, e + apart);
        set_integer(&y, m, e);
        for (int s = -1; s <= 1; s += 2) {
            brio_dyadic_add(&r, &x, &y, s);
            set_integer(&wanted, n * ((wide)1 << apart) + s * m, e);
            EXPECT_SAME(&r, &wanted, "sum, trial %d", i);
            brio_dyadic_add(&r, &y, &x, s);
            set_integer(&wanted, m + s * n * ((wide)1 << apart), e);
            EXPECT_SAME(&r, &wanted, "sum turned round, trial %d", i);
        }
        brio_dyadic_multiply(&r, &x, &y);
        set_integer(&wanted, n * m, 2 * e + apart);
        EXPECT_SAME(&r, &wanted, "product, trial %d", i);
    }
}

static void differences_of_doubles_are_exact(void) {
    brio_rng rng = brio_rng_new(3);
    for (int i = 0; i < TRIALS; i++) {
        wide n = random_integer(&rng, 53), m = random_integer(&rng, 53);
        int apart = (int)brio_rng_below(&rng, 70), e = (int)brio_rng_below(&rng, 1900) - 1074;
        double x = ldexp((double)n, e + apart), y = ldexp((double)m, e);
        brio_dyadic r, wanted;
        brio_dyadic_difference(&r, x, y);
        set_integer(&wanted, n * ((wide)1 << apart) - m, e);
        EXPECT_SAME(&r, &wanted, "%a - %a", x, y);
    }
}

/* Carries and borrows over as many limbs as there are: 2^k - 1, then + 1, then - 1, then less itself. */
static void carries_run_through_all_limbs(void) {
    for (int k = 1; k <= 64 * (BRIO_DYADIC_CAPACITY - 2); k += 61) {
        brio_dyadic one, power, less, r;
        set_integer(&one, 1, 0);
        set_integer(&power, 1, k);
        brio_dyadic_add(&less, &power, &one, -1);
        EXPECT(keeps_invariants(&less) && less.sign == 1 && less.low == 0 && less.size == (k + 63) / 64, "2^%d - 1", k);
        for (int i = 0; i < less.size; i++)
            EXPECT(less.limb[i] == (i + 1 < less.size || k % 64 == 0 ? UINT64_MAX : (UINT64_C(1) << k % 64) - 1));
        brio_dyadic_add(&r, &less, &one, 1);
        EXPECT_SAME(&r, &power, "2^%d", k);
        brio_dyadic_add(&r, &r, &less, -1);
        EXPECT_SAME(&r, &one, "2^%d - (2^%d - 1)", k, k);
        brio_dyadic_add(&r, &one, &power, -1);
        less.sign = -1;
        EXPECT_SAME(&r, &less, "1 - 2^%d", k);
    }
}

/* --- laws --- */

static void minus(brio_dyadic *x) {
    x->sign = -x->sign;
}

/* Numbers as the predicates make them: differences of doubles of all exponents. */
static void random_difference(brio_dyadic *x, brio_rng *rng) {
    double a = random_double(rng), b = random_double(rng);
    brio_dyadic_difference(x, a, b);
}

static void laws_of_a_ring_hold_for_any_doubles(void) {
    brio_rng rng = brio_rng_new(4);
    for (int i = 0; i < TRIALS / 4; i++) {
        brio_dyadic x, y, z, a, b, c, d, zero = {0};
        random_difference(&x, &rng);
        random_difference(&y, &rng);
        random_difference(&z, &rng);
        brio_dyadic_add(&a, &x, &y, 1);
        brio_dyadic_add(&b, &y, &x, 1);
        EXPECT_SAME(&a, &b, "x + y = y + x, trial %d", i);
        brio_dyadic_add(&a, &a, &z, 1);
        brio_dyadic_add(&b, &y, &z, 1);
        brio_dyadic_add(&c, &x, &b, 1);
        EXPECT_SAME(&a, &c, "(x + y) + z = x + (y + z), trial %d", i);
        brio_dyadic_add(&a, &x, &y, -1);
        brio_dyadic_add(&b, &y, &x, -1);
        minus(&b);
        EXPECT_SAME(&a, &b, "x - y = -(y - x), trial %d", i);
        brio_dyadic_add(&a, &x, &x, -1);
        EXPECT_SAME(&a, &zero, "x - x = 0, trial %d", i);
        brio_dyadic_multiply(&a, &x, &y);
        brio_dyadic_multiply(&b, &y, &x);
        EXPECT_SAME(&a, &b, "x y = y x, trial %d", i);
        brio_dyadic_multiply(&c, &a, &z);
        brio_dyadic_multiply(&b, &y, &z);
        brio_dyadic_multiply(&d, &x, &b);
        EXPECT_SAME(&c, &d, "(x y) z = x (y z), trial %d", i);
        brio_dyadic_add(&c, &x, &y, 1);
        brio_dyadic_multiply(&d, &c, &z);
        brio_dyadic_multiply(&a, &x, &z);
        brio_dyadic_add(&c, &a, &b, 1);
        EXPECT_SAME(&c, &d, "x z + y z = (x + y) z, trial %d", i);
    }
}

/* r = x + y where r is x, y, or both. */
static void sums_may_replace_their_terms(void) {
    brio_rng rng = brio_rng_new(5);
    for (int i = 0; i < TRIALS / 4; i++) {
        brio_dyadic x, y, r, a;
        random_difference(&x, &rng);
        random_difference(&y, &rng);
        for (int s = -1; s <= 1; s += 2) {
            brio_dyadic_add(&r, &x, &y, s);
            a = x;
            brio_dyadic_add(&a, &a, &y, s);
            EXPECT_SAME(&a, &r, "in place of the first, trial %d", i);
            a = y;
            brio_dyadic_add(&a, &x, &a, s);
            EXPECT_SAME(&a, &r, "in place of the second, trial %d", i);
            brio_dyadic_add(&r, &x, &x, s);
            a = x;
            brio_dyadic_add(&a, &a, &a, s);
            EXPECT_SAME(&a, &r, "in place of both, trial %d", i);
        }
    }
}

/* The largest determinant that the header speaks of: four products of a sum of three squares less a weight and a minor
 * of three differences, all spanning from the greatest double to the least. */
static void largest_determinant_fits(void) {
    brio_dyadic d, square, lift, weight, minor, term, sum = {0}, other = {0}, half;
    brio_dyadic_difference(&d, 0x1.fffffffffffffp1023, -0x1.fffffffffffffp1023);
    brio_dyadic_set(&weight, 0x1p-1074);
    brio_dyadic_add(&d, &d, &weight, -1); /* 2098 bits and more */
    EXPECT(d.size == 34, "%d", d.size);
    brio_dyadic_multiply(&square, &d, &d);
    brio_dyadic_add(&lift, &square, &square, 1);
    brio_dyadic_add(&lift, &lift, &square, 1);
    brio_dyadic_add(&lift, &lift, &weight, -1);
    brio_dyadic_multiply(&minor, &square, &d);
    for (int i = 0; i < 5; i++) { /* six products in a minor */
        brio_dyadic_multiply(&half, &square, &d);
        brio_dyadic_add(&minor, &minor, &half, 1);
    }
    brio_dyadic_multiply(&term, &lift, &minor);
    for (int i = 0; i < 4; i++) brio_dyadic_add(&sum, &sum, &term, 1);
    EXPECT(keeps_invariants(&sum) && sum.size <= 175, "%d limbs", sum.size);
    /* the same number, multiplied out in another order */
    brio_dyadic_set(&half, 24);
    brio_dyadic_multiply(&other, &lift, &half);
    brio_dyadic_multiply(&term, &other, &d);
    brio_dyadic_multiply(&other, &term, &d);
    brio_dyadic_multiply(&term, &other, &d);
    EXPECT_SAME(&term, &sum, "%d and %d limbs", term.size, sum.size);
}

/* --- rounding --- */

static void doubles_come_back(void) {
    brio_rng rng = brio_rng_new(6);
    for (int i = 0; i < TRIALS; i++) {
        double x = random_double(&rng);
        int e, wanted_e;
        brio_dyadic d;
        brio_dyadic_set(&d, x);
        double m = brio_dyadic_to_double(&d, &e), wanted = frexp(x, &wanted_e);
        EXPECT(m == wanted && e == wanted_e, "%a: %a 2^%d", x, m, e);
    }
}

/* |x - m 2^e| <= 2^-52 |x|, in exact arithmetic, and 0.5 <= |m| < 1. */
static void rounding_errs_by_no_more_than_promised(void) {
    brio_rng rng = brio_rng_new(7);
    for (int i = 0; i < TRIALS; i++) {
        brio_dyadic x, y, product, m, power, error, bound;
        int e;
        random_difference(&x, &rng);
        random_difference(&y, &rng);
        if (i % 3 == 0) brio_dyadic_set(&y, 1);
        if (i % 3 == 1) /* a top limb of one bit */
            brio_dyadic_difference(&x, ldexp(1, 64 * (int)brio_rng_below(&rng, 15)), random_double(&rng));
        brio_dyadic_multiply(&product, &x, &y);
        double head = brio_dyadic_to_double(&product, &e);
        if (!product.sign) {
            EXPECT(head == 0 && e == 0);
            continue;
        }
        EXPECT(fabs(head) >= 0.5 && fabs(head) < 1 && (head > 0) == (product.sign > 0), "%a", head);
        set_integer(&power, 1, e);
        brio_dyadic_set(&m, head);
        brio_dyadic_multiply(&error, &m, &power);
        brio_dyadic_add(&error, &product, &error, -1);
        set_integer(&power, 1, -52);
        brio_dyadic_multiply(&bound, &product, &power);
        error.sign *= error.sign;
        bound.sign *= bound.sign;
        brio_dyadic_add(&error, &bound, &error, -1);
        EXPECT(error.sign >= 0, "trial %d: %a 2^%d", i, head, e);
    }
}

SUITE(test_dyadic) {
    RUN(every_double_is_set_exactly);
    RUN(small_results_are_those_of_integers);
    RUN(differences_of_doubles_are_exact);
    RUN(carries_run_through_all_limbs);
    RUN(laws_of_a_ring_hold_for_any_doubles);
    RUN(sums_may_replace_their_terms);
    RUN(largest_determinant_fits);
    RUN(doubles_come_back);
    RUN(rounding_errs_by_no_more_than_promised);
    return harness_end();
}
