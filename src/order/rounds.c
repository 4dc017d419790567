/* Rounds of a biased randomized insertion order (BRIO).
 *
 * Each point draws the round of its insertion: the last round with probability 1 - ratio, the round before the last
 * with probability (1 - ratio) ratio, and so on. The early rounds are a random sample of all points. So the bounds of
 * randomized analysis for the expected work hold for every order inside the rounds.
 *
 * Based on: Amenta, Choi, Rote. Incremental constructions con BRIO. SoCG 2003.
 *           Choi. Practical Delaunay triangulation algorithms ... 2003, section 5.3. */
#include "order/rounds.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/rng.h"
#include "base/team.h"

enum { INDICES_A_THREAD = 1 << 13 };

/* Sets least[r]: a point whose hash is less than least[r] is at least r rounds before the last round. Returns the
 * number of rounds: adds rounds until the first round is expected to hold about one point. */
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

static void count_part(void *user, size_t begin, size_t end, int thread) {
    const division *d = user;
    for (size_t i = begin; i < end; i++) {
        d->back[i] = (uint8_t)rounds_before_last(brio_hash(d->of->seed, d->of->index[i]), d->least);
        d->place[thread][d->back[i]]++;
    }
}

static void place_part(void *user, size_t begin, size_t end, int thread) {
    const division *d = user;
    for (size_t i = begin; i < end; i++) {
        size_t to = d->place[thread][d->back[i]]++;
        d->of->order[to] = d->of->index[i];
        if (d->of->rank) d->of->rank[to] = (uint32_t)i;
    }
}

brio_status brio_divide_into_rounds(brio_context *ctx, const brio_division *of, brio_round_ends *ends) {
    brio_status status = BRIO_OK;
    division d = {.of = of};
    size_t n = of->n;
    int threads = brio_threads(ctx, n, INDICES_A_THREAD);
    ends->count = set_rounds(n, of->ratio, d.least);
    BRIO_TRY(BRIO_ALLOC(ctx, d.back, n));
    brio_expect_sequence(d.back);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, d.place, (size_t)threads));
    brio_for(ctx, threads, n, count_part, &d);
    first_places(d.place, threads, ends);
    brio_for(ctx, threads, n, place_part, &d);
done:
    brio_release(ctx, d.back);
    brio_release(ctx, d.place);
    return status;
}
