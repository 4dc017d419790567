/* A trial: the part that an experiment has in a triangulation. It chooses the strategy of location, counts page
 * touches, and records the counters at the end of each round, at each doubling, or after every N points. Insertion
 * itself does no recording: runs of insertions end where an entry is due. */
#include "laboratory/location/trial.h"
#include "base/memory.h"
#include <assert.h>
#include <string.h>

enum { FIRST_DOUBLING = 4096 };

/* Other locations than the walk. HISTORY and TRACE: 300,000 points of a scan peak at 892 bytes a point resident, 322 by
 * the walk. An edge takes 8 bytes as a pair and 8 in the graph. */
static const double HISTORY_BYTES_A_POINT = 570, LOCATION_BYTES_A_POINT = 8, BYTES_AN_EDGE = 16;

void brio_trial_clear(brio_trial *trial) {
    brio_page_touches_free(trial->touches);
    brio_release(trial->ctx, trial->list);
    trial->touches = NULL;
    trial->list = NULL;
    trial->count = trial->capacity = 0;
    trial->stats = (brio_laboratory_stats){.unreached = trial->stats.unreached};
}

static brio_status begin(void *user, brio_context *ctx, size_t num_points) {
    brio_trial *trial = user;
    const brio_laboratory_options *o = trial->options;
    brio_trial_clear(trial);
    for (size_t i = 0; o->edges && i < 2 * o->num_edges; i++)
        BRIO_EXPECT(ctx, o->edges[i] < num_points, BRIO_ERR_ARGUMENT, "edge %zu ends at point %u of %zu", i / 2,
                    BRIO_POINT(ctx, o->edges[i]), num_points);
    return o->page_bytes ? brio_page_touches_new(ctx, o->page_bytes, o->cache_bytes, &trial->touches) : BRIO_OK;
}

static void start(void *user, brio_inserter *ins, const brio_delaunay_options *options, const brio_round_ends *rounds,
                  double since) {
    brio_trial *trial = user;
    trial->seed = options->seed;
    trial->rounds = *rounds;
    trial->start = since;
    brio_count_touches(ins, &trial->view, trial->touches, 0);
}

static double bytes(const void *user, double points) {
    const brio_trial *trial = user;
    double edges = (double)trial->options->num_edges;
    switch (trial->options->locate) {
    case BRIO_LOCATION_WALK:
        return 0;
    case BRIO_LOCATION_HISTORY:
        return HISTORY_BYTES_A_POINT * points;
    case BRIO_LOCATION_TRACE:
        return HISTORY_BYTES_A_POINT * points + BYTES_AN_EDGE * edges;
    case BRIO_LOCATION_NEIGHBOUR:
        return LOCATION_BYTES_A_POINT * points + BYTES_AN_EDGE * edges;
    default:
        return LOCATION_BYTES_A_POINT * points;
    }
}

/* --- records --- */

size_t brio_trial_next(const void *user, size_t inserted) {
    const brio_trial *trial = user;
    uint64_t every = trial->options->record_every;
    assert(trial->rounds.count <= BRIO_MOST_ROUNDS);
    size_t next = FIRST_DOUBLING;
    if (every == 0) return SIZE_MAX;
    if (every != BRIO_RECORD_ROUNDS) {
        uint64_t left = every - inserted % every;
        return left < SIZE_MAX - inserted ? inserted + (size_t)left : SIZE_MAX;
    }
    if (trial->rounds.count > 1) {
        int i = 0;
        while (i < trial->rounds.count && trial->rounds.end[i] <= inserted) i++;
        return i < trial->rounds.count ? trial->rounds.end[i] : SIZE_MAX;
    }
    while (next <= inserted) next *= 2;
    return next;
}

/* Adds an entry when one is due, or when all points are in. */
static brio_status note(void *user, const brio_inserter *ins, size_t inserted) {
    brio_trial *trial = user;
    const brio_store *s = ins->store;
    brio_laboratory_stats so_far = trial->stats;
    bool due = inserted > 0 && brio_trial_next(trial, inserted - 1) == inserted;
    if (trial->options->record_every == 0 || !(due || inserted == s->num_points)) return BRIO_OK;
    if (trial->touches) brio_page_touches_total(trial->touches, &so_far);
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, trial->list, trial->capacity, trial->count + 1));
    trial->list[trial->count++] = (brio_round){
        .points = inserted,
        .tetrahedra = (size_t)(ins->stats.created - ins->stats.destroyed),
        .created = ins->stats.created,
        .destroyed = ins->stats.destroyed,
        .walk_steps = ins->walk.steps,
        .insphere_calls = ins->stats.insphere_calls,
        .history = so_far.history,
        .pages = so_far.pages,
        .page_touches = so_far.page_touches,
        .page_faults = so_far.page_faults,
        .locate_seconds = ins->stats.locate_seconds,
        .seconds = brio_seconds() - trial->start,
    };
    return BRIO_OK;
}

/* --- the walk, counted --- */

static brio_status locate_counted(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    return brio_strategy_walk.locate(ins, p, tet);
}

const brio_strategy brio_strategy_counted_walk = {.locate = locate_counted, .filled = brio_count_insertion};

void brio_trial_part(brio_trial *trial, struct brio_insertion_part *part) {
    static const brio_strategy *const strategies[BRIO_LOCATION_END] = {
        [BRIO_LOCATION_WALK] = &brio_strategy_walk,           [BRIO_LOCATION_JUMP] = &brio_strategy_jump,
        [BRIO_LOCATION_HIERARCHY] = &brio_strategy_hierarchy, [BRIO_LOCATION_HISTORY] = &brio_strategy_history,
        [BRIO_LOCATION_TRACE] = &brio_strategy_trace,         [BRIO_LOCATION_NEIGHBOUR] = &brio_strategy_neighbour,
    };
    bool walks = trial->options->locate == BRIO_LOCATION_WALK, counts = trial->options->page_bytes != 0;
    assert((unsigned)trial->options->locate < BRIO_LOCATION_END);
    *part = (struct brio_insertion_part){
        .user = trial,
        .strategy = walks && counts ? &brio_strategy_counted_walk : strategies[trial->options->locate],
        .walks = walks,
        .alone = !walks || counts,
        .begin = begin,
        .start = start,
        .next = brio_trial_next,
        .note = note,
        .bytes = bytes,
    };
}
