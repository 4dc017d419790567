/* Cells by ranks: each rank computes those of its tiles, whose stars are final. Of other ranks it needs the points of
 * its halos, and the sums.
 *
 * The volume of all cells is summed exactly, as a whole number of 2^-1074, and rounded once. So it is the same for
 * every number of ranks and tiles.
 *
 * Based on: Kulisch, Miranker. The arithmetic of the digital computer: a new approach. SIAM Review 1986 (one long
 *           accumulator). */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "ranks/work.h"
#include "tiles/cells.h"
#include <math.h>
#include <string.h>

/* --- exact sums --- */

enum { DIGITS = 68, CARRY_AFTER = 1 << 30, LEAST_EXPONENT = -1074 };

/* A sum of doubles that are not negative: the digits of a whole number to the base 2^32, the least one first. Between
 * carries a digit has up to 2^62. */
typedef struct {
    uint64_t digit[DIGITS];
    uint64_t terms;    /* since the last carry */
    uint64_t infinite; /* terms that are no finite numbers */
} exact_sum;

static void carry(exact_sum *s) {
    uint64_t rest = 0;
    for (int i = 0; i < DIGITS; i++) {
        rest += s->digit[i];
        s->digit[i] = rest & UINT32_MAX;
        rest >>= 32;
    }
    s->terms = 0;
}

static void add_term(exact_sum *s, double x) {
    int exponent;
    if (!isfinite(x)) s->infinite++;
    if (!isfinite(x) || !(x > 0)) return;
    uint64_t mantissa = (uint64_t)ldexp(frexp(x, &exponent), 53);
    int at = exponent - 53 - LEAST_EXPONENT;
    if (at < 0) mantissa >>= -at, at = 0; /* of a subnormal number: these bits are 0 */
    uint64_t low = (mantissa & UINT32_MAX) << at % 32, high = (mantissa >> 32) << at % 32;
    uint64_t *digit = s->digit + at / 32;
    digit[0] += low & UINT32_MAX;
    digit[1] += (low >> 32) + (high & UINT32_MAX);
    digit[2] += high >> 32;
    if (++s->terms == CARRY_AFTER) carry(s);
}

static void add_sum(exact_sum *to, const exact_sum *from) {
    for (int i = 0; i < DIGITS; i++) to->digit[i] += from->digit[i];
    to->infinite += from->infinite;
    carry(to);
}

/* Returns the sum, rounded to the nearest double. The last carry was made. */
static double rounded(const exact_sum *s) {
    int top = DIGITS - 1, bits = 0;
    while (top > 1 && !s->digit[top]) top--;
    while (bits < 32 && s->digit[top] >> bits) bits++;
    uint64_t third = top > 1 ? s->digit[top - 2] : 0, rest = bits ? third << (64 - bits) : 0;
    uint64_t high = (s->digit[top] << 32 | s->digit[top - 1]) << (32 - bits) | third >> bits;
    for (int i = 0; i < top - 2; i++) rest |= s->digit[i];
    double sum = ldexp((double)(high | (rest != 0)), 32 * (top - 1) - (32 - bits) + LEAST_EXPONENT);
    return s->infinite ? INFINITY : sum;
}

/* --- the cells of a rank --- */

typedef struct {
    brio_ranks *r;
    brio_tile_cells_fn take; /* NULL: nobody */
    void *user;
    brio_tiles_cells_stats stats;
    exact_sum volume;
    double lost; /* not used */
    const brio_set_point *halo;
} cell_run;

static brio_status take_cells(void *user, brio_cells *cells, const uint64_t *site) {
    cell_run *c = user;
    brio_tile_cells_count(cells, &c->stats, &c->lost);
    for (size_t i = 0; i < cells->num_cells; i++)
        if (cells->bounded[i]) add_term(&c->volume, cells->volume[i]);
    if (!c->take) return BRIO_OK;
    BRIO_EXPECT(c->r->ctx, !c->take(cells, site, c->user), BRIO_ERR_CANCELLED,
                "cells: the caller's function ended the run");
    return BRIO_OK;
}

static brio_status answer_point(brio_ranks *r, uint64_t place, void *row) {
    return brio_tile_points(r->t, place, 1, row);
}

/* Copies the halo that was fetched, as a brio_halo_fn. */
static brio_status copy_halo(void *user, const uint64_t *halo, size_t n, brio_set_point *points) {
    const cell_run *c = user;
    (void)halo;
    if (n) memcpy(points, c->halo, n * sizeof *points);
    return BRIO_OK;
}

/* Fetches the halo of a tile, which all ranks do at once, and computes its cells. */
static brio_status run_tile(cell_run *c, const brio_cells_options *o, uint32_t tile) {
    brio_ranks *r = c->r;
    const brio_tile *facts = &r->t->tile[tile];
    const brio_tile_cells_sink sink = {take_cells, c};
    const brio_halo_reader reader = {copy_halo, c};
    uint64_t *place = NULL;
    brio_set_point *halo = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(r->ctx, place, facts->halo + 1));
    BRIO_TRY(BRIO_ALLOC(r->ctx, halo, facts->halo + 1));
    BRIO_TRY(brio_tile_halo(r->t, tile, place));
    BRIO_TRY(brio_ranks_rows(r, place, facts->halo, answer_point, sizeof *halo, halo));
    c->halo = halo;
    if (facts->points) status = brio_tile_run_cells(r->t, tile, o, &reader, &sink, &c->stats);
done:
    brio_release(r->ctx, place);
    brio_release(r->ctx, halo);
    return status;
}

/* --- the sums of all ranks --- */

typedef struct {
    brio_tiles_cells_stats stats;
    exact_sum volume;
} share;

static brio_status add_shares(cell_run *c) {
    brio_ranks *r = c->r;
    share s = {c->stats, c->volume};
    brio_tiles_cells_stats *all = &r->cells;
    exact_sum volume = {.terms = 0};
    carry(&s.volume);
    BRIO_FORWARD(brio_exchange_all(&r->x, &s, sizeof s));
    *all = (brio_tiles_cells_stats){.size = sizeof *all, .region_volume = INFINITY};
    for (int i = 0; i < r->ranks; i++) {
        memcpy(&s, r->x.from[i]->bytes, sizeof s);
        all->cells += s.stats.cells;
        all->bounded += s.stats.bounded;
        all->faces += s.stats.faces;
        all->outside += s.stats.outside;
        all->region_volume = fmin(all->region_volume, s.stats.region_volume);
        add_sum(&volume, &s.volume);
    }
    all->volume_sum = rounded(&volume);
    return brio_tile_cells_check(r->ctx, all);
}

static brio_status run(brio_ranks *r, const brio_cells_options *options, brio_tile_cells_fn take, void *user) {
    cell_run c = {.r = r, .take = take, .user = user, .stats = {.size = sizeof c.stats, .region_volume = INFINITY}};
    brio_cells_options o = {0};
    BRIO_FORWARD(BRIO_TAKE(r->ctx, brio_cells_options, options, &o));
    BRIO_EXPECT(r->ctx, r->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    BRIO_EXPECT(r->ctx, r->t->stars, BRIO_ERR_ARGUMENT, "the tiles have no stars: brio_ranks_options asks for them");
    BRIO_EXPECT(r->ctx, r->facts.dimension == 3 || !r->facts.points, BRIO_ERR_NO_ANSWER,
                "all points are in a plane: their cells are computed by one process only");
    for (uint32_t i = 0; i < r->t->num_tiles; i++) {
        BRIO_FORWARD(brio_progress(r->ctx, "cells", (double)i / r->t->num_tiles));
        BRIO_FORWARD(run_tile(&c, &o, i));
    }
    return add_shares(&c);
}

brio_status brio_ranks_cells(brio_context *ctx, brio_ranks *r, const brio_cells_options *options,
                             brio_tile_cells_fn take, void *user) {
    BRIO_DOOR;
    BRIO_EXPECT(ctx, ctx == r->ctx, BRIO_ERR_ARGUMENT, "the ranks are of another context");
    return brio_exchange_agree(&r->x, run(r, options, take, user));
}

const brio_tiles_cells_stats *brio_ranks_cells_facts(const brio_ranks *r) {
    return &r->cells;
}
