/* Rounds of a biased randomized insertion order (BRIO).
 *
 * Each point draws the round of its insertion: the last round with probability 1 - ratio, the round before the last
 * with probability (1 - ratio) ratio, and so on. The early rounds are a random sample of all points. So the bounds of
 * randomized analysis for the expected work hold for every order inside the rounds.
 *
 * With weights a light point may be inserted and then hidden by a heavier one, for nothing. So a second sequence is
 * made, in which the points of a block, BLOCK neighbours along the order of the indices, exchange the rounds that they
 * drew: the heavier one takes the earlier round. A round keeps its number of points in each block, so it still is
 * spread over space as the points are; but it is no random sample any more, and the bounds of the analysis do not hold
 * for it. With equal weights the sequence is the order.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 5.3.
 * Differs from the paper: the sequence by weights. */
#include "order/rounds.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/rng.h"
#include "base/team.h"
#include <assert.h>
#include <string.h>

/* BLOCK: of a scan with 60 % hidden points, blocks of 8 points create 12.4 million tetrahedra, of 64 points 11.3, of
 * 256 points 11.2, and the rounds that were drawn 15.9. */
enum { BLOCK = 64, INDICES_A_THREAD = 1 << 13 };

/* Sets least[r]: a point whose hash is less than least[r] is at least r rounds before the last round. Returns the
 * number of rounds: adds rounds until the first round is expected to hold about one point. */
static int set_rounds(size_t n, double ratio, uint64_t least[BRIO_MOST_ROUNDS + 1]) {
    double share = ratio;
    assert(0 <= ratio && ratio < 1);
    int rounds = 1;
    for (; rounds < BRIO_MOST_ROUNDS && share * (double)n >= 1; rounds++, share *= ratio)
        least[rounds] = (uint64_t)(share * 0x1p63) << 1;
    least[rounds] = 0;
    return rounds;
}

static inline int rounds_before_last(uint64_t hash, const uint64_t least[BRIO_MOST_ROUNDS + 1]) {
    int back = 0;
    while (hash < least[back + 1]) back++;
    assert(back < BRIO_MOST_ROUNDS);
    return back;
}

/* Replaces each thread's counts by the positions where the thread writes, with the first round in front. Sets the
 * ends. */
static void first_places(size_t (*place)[BRIO_MOST_ROUNDS], int threads, brio_round_ends *rounds) {
    for (int r = 0; r < rounds->count; r++)
        rounds->end[r] = brio_counts_to_places(&place[0][rounds->count - 1 - r], BRIO_MOST_ROUNDS, (size_t)threads,
                                               r > 0 ? rounds->end[r - 1] : 0);
}

/* The data of one call that divides indices into rounds. */
typedef struct {
    const brio_division *of;
    uint64_t least[BRIO_MOST_ROUNDS + 1];
    uint8_t *back;                     /* n: the number of rounds between the index's round and the last round */
    size_t (*place)[BRIO_MOST_ROUNDS]; /* [thread][rounds before the last]: a count, then a position in `order` */
} division;

static uint64_t draw_of(const brio_division *of, size_t i) {
    return brio_hash(of->seed, of->index[i]);
}

/* Returns whether index i takes an earlier round than index j: the heavier one; of equal weights, the one that drew the
 * earlier round. */
static bool precedes(const brio_division *of, size_t i, size_t j) {
    double a = of->weights[of->index[i]], b = of->weights[of->index[j]];
    return a != b ? a > b : draw_of(of, i) < draw_of(of, j);
}

/* Writes the rounds of the indices of a block after the exchange: the heaviest take the rounds before the last. */
static void exchange_rounds(const division *d, size_t begin, size_t end, uint8_t back[BLOCK]) {
    uint8_t drawn[BLOCK];
    size_t heavy[BLOCK], places = 0, count = 0;
    for (size_t i = begin; i < end; i++) { /* sorted: the earliest round first */
        size_t k = places;
        back[i - begin] = 0;
        if (d->back[i] == 0) continue;
        for (places++; k > 0 && drawn[k - 1] < d->back[i]; k--) drawn[k] = drawn[k - 1];
        drawn[k] = d->back[i];
    }
    for (size_t i = begin; i < end && places > 0; i++) { /* sorted: the heaviest first */
        if (count == places && !precedes(d->of, i, heavy[count - 1])) continue;
        size_t k = count < places ? count++ : count - 1;
        for (; k > 0 && precedes(d->of, i, heavy[k - 1]); k--) heavy[k] = heavy[k - 1];
        heavy[k] = i;
    }
    assert(count == places && end - begin <= BLOCK);
    for (size_t k = 0; k < count; k++) back[heavy[k] - begin] = drawn[k];
}

static size_t begin_of_block(const division *d, size_t block) {
    return block < d->of->n / BLOCK + 1 ? block * BLOCK : d->of->n;
}

static void count_blocks(void *user, size_t first, size_t last, int thread) {
    const division *d = user;
    for (size_t i = begin_of_block(d, first), end = begin_of_block(d, last); i < end; i++) {
        d->back[i] = (uint8_t)rounds_before_last(draw_of(d->of, i), d->least);
        d->place[thread][d->back[i]]++;
    }
}

/* Writes order and sequence. A block has as many points in a round before the exchange as after it, so order and
 * sequence have the same places. */
static void place_blocks(void *user, size_t first, size_t last, int thread) {
    const division *d = user;
    const brio_division *of = d->of;
    size_t *place = d->place[thread], turn[BRIO_MOST_ROUNDS];
    uint8_t back[BLOCK];
    memcpy(turn, place, sizeof turn);
    for (size_t block = first; block < last; block++) {
        size_t begin = begin_of_block(d, block), end = begin_of_block(d, block + 1);
        if (of->sequence) exchange_rounds(d, begin, end, back);
        for (size_t i = begin; i < end; i++) {
            size_t to = place[d->back[i]]++;
            assert(to < of->n);
            of->order[to] = of->index[i];
            if (of->rank) of->rank[to] = (uint32_t)i;
            if (of->sequence) of->sequence[turn[back[i - begin]]++] = (uint32_t)to;
        }
    }
}

brio_status brio_divide_into_rounds(brio_context *ctx, const brio_division *of, brio_round_ends *ends) {
    brio_status status = BRIO_OK;
    division d = {.of = of};
    size_t n = of->n, blocks = n / BLOCK + 1;
    int threads = brio_threads(ctx, n, INDICES_A_THREAD);
    ends->count = set_rounds(n, of->ratio, d.least);
    BRIO_TRY(BRIO_ALLOC(ctx, d.back, n));
    brio_expect_sequence(d.back);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, d.place, (size_t)threads));
    BRIO_TRY(brio_for(ctx, threads, blocks, count_blocks, &d));
    first_places(d.place, threads, ends);
    assert(ends->count <= BRIO_MOST_ROUNDS && ends->end[ends->count - 1] == n);
    BRIO_TRY(brio_for(ctx, threads, blocks, place_blocks, &d));
done:
    brio_release(ctx, d.back);
    brio_release(ctx, d.place);
    return status;
}
