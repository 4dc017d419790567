/* Rounds of a biased randomized insertion order (BRIO).
 *
 * Each point draws the round it is inserted in: the last with probability 1 - ratio, the one before with probability
 * (1 - ratio) ratio, and so on. The early rounds are a random sample of everything, which keeps the expected work of the
 * randomized analysis, whatever the order inside a round.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 5.3. */
#include "order/rounds.h"
#include "base/memory.h"
#include "base/parallel.h"
#include "base/rng.h"

/* least[r]: a point whose hash is below least[r] is at least r rounds before the last. The number of rounds: until one
 * point is left. */
static int set_rounds(size_t n, double ratio, uint64_t least[BRIO_MOST_ROUNDS + 1]) {
    double share = ratio;
    int rounds = 1;
    for (; rounds < BRIO_MOST_ROUNDS && share * (double)n >= 1; rounds++, share *= ratio)
        least[rounds] = (uint64_t)(share * 0x1p63) << 1;
    least[rounds] = 0;
    return rounds;
}

static inline int rounds_before_last(uint64_t hash, const uint64_t least[BRIO_MOST_ROUNDS + 1]) {
    int back = 0;
    while (hash < least[back + 1]) back++;
    return back;
}

/* Turns each thread's counts into where it writes, the first round first. */
static void first_places(size_t (*place)[BRIO_MOST_ROUNDS], int threads, brio_round_ends *rounds) {
    size_t sum = 0;
    for (int r = 0; r < rounds->count; r++) {
        int back = rounds->count - 1 - r;
        for (int t = 0; t < threads; t++) {
            size_t count = place[t][back];
            place[t][back] = sum;
            sum += count;
        }
        rounds->end[r] = sum;
    }
}

brio_status brio_divide_into_rounds(brio_context *ctx, const uint32_t *index, size_t n, double ratio, uint64_t seed,
                                    int threads, uint32_t *order, uint32_t *rank, brio_round_ends *rounds) {
    uint64_t least[BRIO_MOST_ROUNDS + 1];
    size_t(*place)[BRIO_MOST_ROUNDS] = NULL;
    uint8_t *back = NULL;
    brio_status status = BRIO_OK;
    rounds->count = set_rounds(n, ratio, least);
    BRIO_TRY(BRIO_ALLOC(ctx, back, n));
    brio_expect_sequence(back);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, place, (size_t)threads));
    BRIO_OMP(parallel for schedule(static, 1) num_threads(threads))
    for (int t = 0; t < threads; t++)
        for (size_t i = brio_part(n, t, threads); i < brio_part(n, t + 1, threads); i++) {
            back[i] = (uint8_t)rounds_before_last(brio_hash(seed, index[i]), least);
            place[t][back[i]]++;
        }
    first_places(place, threads, rounds);
    BRIO_OMP(parallel for schedule(static, 1) num_threads(threads))
    for (int t = 0; t < threads; t++)
        for (size_t i = brio_part(n, t, threads); i < brio_part(n, t + 1, threads); i++) {
            size_t to = place[t][back[i]]++;
            order[to] = index[i];
            if (rank) rank[to] = (uint32_t)i;
        }
done:
    brio_release(ctx, back);
    brio_release(ctx, place);
    return status;
}
