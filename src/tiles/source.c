/* Points of other tiles in conflict with tetrahedra of one tile.
 *
 * A ball goes down the tree of boxes, level by level. At each level the samples of the nodes that it meets are tested:
 * where ENOUGH of them are in conflict the search ends, so that a ball far too large for want of points gets points all
 * over it, and the balls of the next round are smaller by a factor. Else it comes to blocks, and these are read.
 *
 * Where many points lie nearly on spheres, as the points of a rounded sphere do, blocks are met by ball after ball, and
 * their points compared exactly without being in conflict; elsewhere, as on a torus, ball after ball finds some points
 * of them. A block that had PATIENCE such comparisons a point, in vain or not, is added as a whole; then its points are
 * known, and known points are never in conflict. So the number of these comparisons is in proportion to the points.
 * Half-spaces that compare in vain do not count: near the hull they meet whole blocks, of which no point is needed.
 *
 * Most balls are empty, and large: they touch the boxes of many blocks. So a block in memory is divided into groups of
 * points that follow each other along the curve. A ball is compared with the boxes of all groups in vector lanes, and
 * with the points of the groups whose boxes it meets. */
#include "base/memory.h"
#include "base/team.h"
#include "platform/thread.h"
#include "predicates/lanes_plain.h"
#include "tiles/work.h"
#include <assert.h>
#include <string.h>

enum {
    ENOUGH = 12,         /* points in conflict that end a search. Chosen: tiles.md */
    ENOUGH_OF_BLOCK = 4, /* of one block */
    PATIENCE = 2,
    MOST_TIES = 4096, /* of a thread's comparisons with samples */
    MOST_TIES_A_HIT = 16,
    BALLS_A_THREAD = 64
};

static const double NEAR = 0.6; /* a node is as far away as it is large, divided by this: then its sample suffices */

/* Boxes that a ball is compared with at once: those of the nodes below a node, or of the groups of a block. */
#define BOXES TILE_FAN
enum { GROUPS = BOXES, GROUP = TILE_BLOCK / GROUPS /* points in a group */ };

/* The points of a block are tried STEP places apart, so that the first of them are all over the block. STEP is near the
 * golden section of TILE_BLOCK [Weyl 1916], and STEP * STEP_BACK is 1 modulo TILE_BLOCK. */
enum { STEP = 79, STEP_BACK = 47 };
_Static_assert(TILE_BLOCK == 128 && STEP * STEP_BACK % TILE_BLOCK == 1, "each place is tried once");
_Static_assert(BOXES % LANES == 0 && GROUP % LANES == 0, "boxes and points come in whole lanes");

enum { BLOCK_NEW, BLOCK_ADDED, BLOCK_KNOWN }; /* ADDED: in this round; the completion does not know it yet */

typedef struct {
    double low[3][GROUPS], high[3][GROUPS], weight[GROUPS]; /* of the groups; low is INFINITY where there is no point */
    double x[TILE_BLOCK], y[TILE_BLOCK], z[TILE_BLOCK];     /* behind the points: INFINITY, which is near nothing */
    double w[TILE_BLOCK];
    uint64_t place;
    uint32_t points;
    uint32_t tried; /* comparisons that count; atomic */
    int state;      /* atomic */
} block;

/* A ball in lanes: see brio_ball_meets. */
typedef struct {
    lanes from[3], way[3], least;
} ball_lanes;

/* One thread's search. */
typedef struct {
    brio_filter filter;
    ball_lanes ball; /* that is searched for */
    brio_found found;
    uint64_t ties, hits;  /* of samples compared: those that are not in conflict by a hair, those that are */
    uint32_t *now, *next; /* nodes */
    brio_tile_asked *asked;
    size_t num_asked, asked_capacity;
    size_t now_capacity, next_capacity, num_now, num_next;
} search;

struct brio_tile_source {
    brio_tiles *t;
    uint32_t tile, root;
    brio_store_file points;
    double *low[3], *high[3], *weight; /* boxes of the nodes; those of the tile are met by no ball */
    block **cache;                     /* of each node that is a block; atomic */
    uint64_t num_read;
    uint32_t *read; /* nodes whose blocks are in memory */
    size_t read_capacity;
    uint32_t round;
    uint32_t *parent; /* of each node that a search may reach; TILE_NONE of the root */
    uint32_t *left;   /* of each node: blocks below that are BLOCK_NEW; atomic */
    uint32_t *last;   /* of each node: the last round in which a block below became BLOCK_ADDED; atomic */
    brio_mutex lock;  /* of what is above */
    search *search;
    int threads;
    brio_status status; /* of the threads; atomic */
    brio_ball *balls;
    brio_tile_asked *asked; /* of other processes, in the last call */
    size_t num_asked, asked_capacity;
};

double brio_tile_source_bytes(const brio_tiles *t) {
    enum { BOX = 7 * sizeof(double), OF_TREE = 3 * sizeof(uint32_t) };
    return (double)t->num_nodes * (BOX + OF_TREE + sizeof(block *));
}

void brio_tiles_filter(const brio_tiles *t, brio_filter *f) {
    double extent[3], heaviest = fabs(t->all.weight), lightest = isfinite(t->lightest) ? t->lightest : 0;
    for (int k = 0; k < 3; k++) extent[k] = t->all.high[k] - t->all.low[k];
    brio_filter_set(f, extent, t->weighted ? heaviest + fabs(lightest) : 0, t->weighted);
}

static bool is_inside(const brio_ball_box *box, const brio_ball_box *outer) {
    for (int k = 0; k < 3; k++)
        if (box->low[k] < outer->low[k] || box->high[k] > outer->high[k]) return false;
    return true;
}

/* Sets the parents of a node and of those below, and how many blocks of other tiles each has that are not known yet.
 * Roots of tiles have copies that are in no tree, or in that of another root. A node of another process counts as a
 * block that is never read: what is above it is never gone past. A node in the box that was seen has no block that is
 * not known: no search goes below it, where parents are not set. */
static uint32_t count_below(brio_tile_source *s, uint32_t at, uint32_t parent, const brio_ball_box *seen) {
    const brio_tile_node *node = &s->t->node[at];
    uint32_t left = node->children == 0;
    s->parent[at] = parent;
    if (node->tile == s->tile || (seen && is_inside(&node->box, seen))) return 0;
    for (uint32_t c = node->first; c < node->first + node->children; c++) left += count_below(s, c, at, seen);
    return s->left[at] = left;
}

static brio_status count_blocks(brio_tile_source *s, const brio_ball_box *seen) {
    const brio_tiles *t = s->t;
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, s->parent, t->num_nodes + 1));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(t->ctx, s->left, t->num_nodes + 1));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(t->ctx, s->last, t->num_nodes + 1));
    count_below(s, s->root, TILE_NONE, seen);
    return BRIO_OK;
}

static brio_status set_node_boxes(brio_tile_source *s) {
    const brio_tiles *t = s->t;
    size_t n = t->num_nodes + BOXES; /* as many are read, whatever the first one is */
    for (int k = 0; k < 3; k++) {
        BRIO_FORWARD(BRIO_ALLOC(t->ctx, s->low[k], n));
        BRIO_FORWARD(BRIO_ALLOC(t->ctx, s->high[k], n));
    }
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, s->weight, n));
    for (size_t i = 0; i < n; i++) {
        const brio_tile_node *node = i < t->num_nodes ? &t->node[i] : NULL;
        bool none = !node || node->tile == s->tile;
        for (int k = 0; k < 3; k++) {
            s->low[k][i] = none ? INFINITY : node->box.low[k];
            s->high[k][i] = none ? -INFINITY : node->box.high[k];
        }
        s->weight[i] = none ? -INFINITY : node->box.weight;
    }
    return BRIO_OK;
}

brio_status brio_tile_source_new(brio_tiles *t, uint32_t tile, uint32_t root, const brio_ball_box *seen,
                                 brio_tile_source **out) {
    brio_tile_source *s = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, s, 1));
    s->t = t;
    s->tile = tile;
    s->root = root;
    s->points.file = -1;
    brio_mutex_new(&s->lock);
    s->threads = brio_threads(t->ctx, 1 << 20, BALLS_A_THREAD);
    BRIO_TRY(brio_store_open(&t->folder, "points", &s->points));
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, s->cache, t->num_nodes + 1));
    BRIO_TRY(count_blocks(s, seen));
    BRIO_TRY(set_node_boxes(s));
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, s->search, s->threads));
    for (int i = 0; i < s->threads; i++) {
        brio_tiles_filter(t, &s->search[i].filter);
        s->search[i].found.ctx = t->ctx;
    }
    *out = s;
    s = NULL;
done:
    brio_tile_source_free(s);
    return status;
}

void brio_tile_source_free(brio_tile_source *s) {
    if (!s) return;
    brio_context *ctx = s->t->ctx;
    for (uint64_t i = 0; i < s->num_read; i++) brio_release(ctx, s->cache[s->read[i]]);
    for (int i = 0; s->search && i < s->threads; i++) {
        brio_release(ctx, s->search[i].found.point);
        brio_release(ctx, s->search[i].now);
        brio_release(ctx, s->search[i].next);
        brio_release(ctx, s->search[i].asked);
    }
    brio_store_close(&s->points);
    brio_mutex_free(&s->lock);
    brio_release(ctx, s->search);
    brio_release(ctx, s->read);
    brio_release(ctx, s->asked);
    for (int k = 0; k < 3; k++) brio_release(ctx, s->low[k]), brio_release(ctx, s->high[k]);
    brio_release(ctx, s->weight);
    brio_release(ctx, s->cache);
    brio_release(ctx, s->parent);
    brio_release(ctx, s->left);
    brio_release(ctx, s->last);
    brio_release(ctx, s);
}

uint64_t brio_tile_source_read(const brio_tile_source *s) {
    return s->num_read;
}

/* --- balls against boxes --- */

/* Returns whether no comparison in floating point says more than that the ball may take a point. */
static bool is_unsettled(const brio_ball *ball) {
    return ball->infinite || !(ball->least > -INFINITY);
}

static ball_lanes lanes_of(const brio_ball *ball) {
    ball_lanes wide = {.least = all(ball->least)};
    for (int k = 0; k < 3; k++) wide.from[k] = all(ball->vertex[0][k]), wide.way[k] = all(ball->way[k]);
    return wide;
}

/* Returns the lanes whose points may be in the ball.   d  from the ball's first vertex to them. */
static inline lane_mask may_take(const ball_lanes *ball, const lanes d[3], lanes weight) {
    for (int k = 0; k < 3; k++) weight += d[k] * (2 * ball->way[k] - d[k]);
    return ~(weight < ball->least); /* also for NaN */
}

/* Boxes, an array for each coordinate. */
typedef struct {
    const double *low[3], *high[3], *weight;
} boxes;

/* Returns the bits of those of BOXES boxes that a ball meets. */
static unsigned boxes_met(const ball_lanes *ball, const boxes *b) {
    unsigned met = 0;
    for (int i = 0; i < BOXES; i += LANES) {
        lanes d[3];
        for (int k = 0; k < 3; k++) {
            lanes low = load_lanes(b->low[k] + i) - ball->from[k], high = load_lanes(b->high[k] + i) - ball->from[k];
            d[k] = maximum(low, -maximum(-high, -ball->way[k])); /* nearest to the centre */
        }
        met |= bits_of(may_take(ball, d, load_lanes(b->weight + i))) << i;
    }
    return met;
}

/* --- blocks --- */

static double most_of(const double *x, uint32_t count, double most) {
    for (uint32_t i = 0; i < count; i++) most = x[i] > most ? x[i] : most;
    return most;
}

static double least_of(const double *x, uint32_t count) {
    double least = INFINITY;
    for (uint32_t i = 0; i < count; i++) least = x[i] < least ? x[i] : least;
    return least;
}

/* Sets the boxes of the groups. */
static void set_boxes(block *b) {
    const double *const x[3] = {b->x, b->y, b->z};
    for (uint32_t g = 0; g < GROUPS; g++) {
        uint32_t first = g * GROUP, left = b->points > first ? b->points - first : 0, n = left < GROUP ? left : GROUP;
        for (int k = 0; k < 3; k++)
            b->low[k][g] = least_of(x[k] + first, n), b->high[k][g] = most_of(x[k] + first, n, -INFINITY);
        b->weight[g] = most_of(b->w + first, n, -INFINITY);
    }
}

static brio_status read_block(brio_tile_source *s, const brio_tile_node *node, block **out) {
    brio_set_point some[TILE_BLOCK];
    BRIO_FORWARD(BRIO_ALLOC(s->t->ctx, *out, 1));
    block *b = *out;
    b->place = node->place;
    b->points = node->points;
    b->tried = 0;
    b->state = BLOCK_NEW;
    brio_status status = brio_store_read(&s->points, (node->place - s->t->first_place) * sizeof *some, some,
                                         node->points * sizeof *some);
    for (uint32_t i = 0; status == BRIO_OK && i < node->points; i++) {
        b->x[i] = some[i].record[0], b->y[i] = some[i].record[1];
        b->z[i] = some[i].record[2], b->w[i] = some[i].record[3];
    }
    for (uint32_t i = node->points; i < TILE_BLOCK; i++) b->x[i] = b->y[i] = b->z[i] = INFINITY, b->w[i] = 0;
    set_boxes(b);
    if (status != BRIO_OK) brio_release(s->t->ctx, b);
    return status;
}

/* Finds the block of a node; reads it if no thread has. */
static brio_status find_block(brio_tile_source *s, uint32_t node, block **out) {
    *out = __atomic_load_n(&s->cache[node], __ATOMIC_ACQUIRE);
    if (*out) return BRIO_OK;
    brio_mutex_lock(&s->lock);
    brio_status status = BRIO_OK;
    *out = s->cache[node];
    if (!*out) status = BRIO_RESERVE(s->t->ctx, s->read, s->read_capacity, s->num_read + 1);
    if (!*out && status == BRIO_OK) status = read_block(s, &s->t->node[node], out);
    if (status == BRIO_OK && !s->cache[node]) {
        s->read[s->num_read++] = node;
        __atomic_store_n(&s->cache[node], *out, __ATOMIC_RELEASE);
    }
    brio_mutex_unlock(&s->lock);
    return status;
}

static brio_set_point point_of(const block *b, uint32_t i) {
    return (brio_set_point){{b->x[i], b->y[i], b->z[i], b->w[i]}, b->place + i};
}

/* Returns whether a ball may take a point. */
static inline bool is_near(const brio_ball *ball, const double *record) {
    double sum = record[3];
    for (int k = 0; k < 3; k++) {
        double d = record[k] - ball->vertex[0][k];
        sum += d * (2 * ball->way[k] - d);
    }
    return !(sum < ball->least);
}

/* Returns the bits of the points of a group that a ball may take. */
static unsigned points_met(const ball_lanes *ball, const block *b, int group) {
    const double *x = b->x + group * GROUP, *y = b->y + group * GROUP, *z = b->z + group * GROUP;
    const double *w = b->w + group * GROUP;
    unsigned met = 0;
    for (int i = 0; i < GROUP; i += LANES) {
        lanes d[3] = {load_lanes(x + i) - ball->from[0], load_lanes(y + i) - ball->from[1],
                      load_lanes(z + i) - ball->from[2]};
        met |= bits_of(may_take(ball, d, load_lanes(w + i))) << i;
    }
    return met;
}

/* A set of points of a block: bit i % 64 of word i / 64 is that of the point that is tried as number i. */
typedef struct {
    uint64_t word[TILE_BLOCK / 64];
} tries;

/* Lists the points of a block that a ball may take. */
static tries list_near(const search *se, const brio_ball *ball, const block *b) {
    const boxes groups = {{b->low[0], b->low[1], b->low[2]}, {b->high[0], b->high[1], b->high[2]}, b->weight};
    bool whole = is_unsettled(ball);
    tries list = {{0}};
    for (unsigned met = whole ? (1U << GROUPS) - 1 : boxes_met(&se->ball, &groups); met; met &= met - 1) {
        int group = __builtin_ctz(met);
        unsigned near = whole ? (1U << GROUP) - 1 : points_met(&se->ball, b, group);
        for (; near; near &= near - 1) {
            uint32_t i = (uint32_t)(group * GROUP + __builtin_ctz(near)), number = i * STEP_BACK % TILE_BLOCK;
            if (i < b->points) list.word[number / 64] |= UINT64_C(1) << number % 64;
        }
    }
    return list;
}

/* Takes the first point off a list.   *i  receives it. Returns false if the list is empty. */
static bool next_try(tries *list, uint32_t *i) {
    for (uint32_t w = 0; w < TILE_BLOCK / 64; w++) {
        if (!list->word[w]) continue;
        *i = (64 * w + (uint32_t)__builtin_ctzll(list->word[w])) * STEP % TILE_BLOCK;
        list->word[w] &= list->word[w] - 1;
        return true;
    }
    return false;
}

/* Adds all points of a block. Nodes all of whose blocks were added are not gone down to any more. */
static brio_status add_whole(brio_tile_source *s, search *se, block *b, uint32_t node) {
    int expected = BLOCK_NEW;
    if (!__atomic_compare_exchange_n(&b->state, &expected, BLOCK_ADDED, false, __ATOMIC_RELAXED, __ATOMIC_RELAXED))
        return BRIO_OK;
    for (uint32_t n = node; n != TILE_NONE; n = s->parent[n]) {
        __atomic_store_n(&s->last[n], s->round, __ATOMIC_RELAXED);
        __atomic_sub_fetch(&s->left[n], 1, __ATOMIC_RELEASE);
    }
    for (uint32_t i = 0; i < b->points; i++) {
        brio_set_point p = point_of(b, i);
        BRIO_FORWARD(brio_found_add(&se->found, &p));
    }
    return BRIO_OK;
}

static bool is_vertex(const brio_ball *ball, const double *record) {
    for (int i = 0; i < (ball->infinite ? 3 : 4); i++)
        if (brio_same_position(ball->vertex[i], record)) return true;
    return false;
}

/* Adds points of a block.   *hits  grows by those in conflict.   *unsure  becomes true if the block has points that
 * were added in this round and not compared: they end no search, for none need be in conflict. */
static brio_status search_block(brio_tile_source *s, search *se, const brio_ball *ball, uint32_t node, int *hits,
                                bool *unsure) {
    block *b;
    BRIO_FORWARD(find_block(s, node, &b));
    uint32_t tried = 0, i;
    int state = __atomic_load_n(&b->state, __ATOMIC_RELAXED), before = *hits;
    *unsure |= state == BLOCK_ADDED;
    if (state != BLOCK_NEW) return BRIO_OK;
    tries list = list_near(se, ball, b);
    while (*hits < before + ENOUGH_OF_BLOCK && next_try(&list, &i)) {
        brio_set_point p = point_of(b, i);
        if (!brio_ball_takes(&se->filter, ball, p.record)) {
            tried += !ball->infinite && !is_vertex(ball, p.record);
            continue;
        }
        ++*hits;
        tried++;
        BRIO_FORWARD(brio_found_add(&se->found, &p));
    }
    if (!tried || __atomic_add_fetch(&b->tried, tried, __ATOMIC_RELAXED) <= PATIENCE * b->points) return BRIO_OK;
    *unsure = true;
    return add_whole(s, se, b, node);
}

/* --- one ball --- */

/* Tests a node's sample. Where points lie nearly on the balls, all comparisons are exact and in vain: after many of
 * them, samples are not tested any more. */
static brio_status try_sample(search *se, const brio_ball *ball, const brio_set_point *sample, int *hits) {
    bool unsettled = is_unsettled(ball);
    if (se->ties > MOST_TIES && se->ties > MOST_TIES_A_HIT * se->hits) return BRIO_OK;
    if (!unsettled && !is_near(ball, sample->record)) return BRIO_OK;
    if (!brio_ball_takes(&se->filter, ball, sample->record)) {
        se->ties += !unsettled;
        return BRIO_OK;
    }
    ++*hits;
    se->hits++;
    return brio_found_add(&se->found, sample);
}

/* Returns the bits of the nodes below a node that the ball meets. */
static unsigned children_met(brio_tile_source *s, search *se, const brio_ball *ball, const brio_tile_node *node) {
    uint32_t c = node->first;
    unsigned met = 0;
    if (!is_unsettled(ball)) {
        const boxes below = {{s->low[0] + c, s->low[1] + c, s->low[2] + c},
                             {s->high[0] + c, s->high[1] + c, s->high[2] + c},
                             s->weight + c};
        return boxes_met(&se->ball, &below) & ((1U << node->children) - 1);
    }
    for (uint32_t i = 0; i < node->children; i++)
        if (s->t->node[c + i].tile != s->tile && brio_ball_meets(&se->filter, ball, &s->t->node[c + i].box))
            met |= 1U << i;
    return met;
}

/* Goes from a node that the ball meets to its children. */
static brio_status descend(brio_tile_source *s, search *se, const brio_ball *ball, const brio_tile_node *node,
                           int *hits, bool *unsure) {
    for (unsigned met = children_met(s, se, ball, node); met; met &= met - 1) {
        uint32_t c = node->first + (uint32_t)__builtin_ctz(met);
        bool is_whole = !__atomic_load_n(&s->left[c], __ATOMIC_ACQUIRE);
        if (is_whole && __atomic_load_n(&s->last[c], __ATOMIC_RELAXED) < s->round) continue;
        *unsure |= is_whole;
        if (is_whole) continue;
        BRIO_FORWARD(BRIO_RESERVE(s->t->ctx, se->next, se->next_capacity, se->num_next + 1));
        se->next[se->num_next++] = c;
        if (*hits < ENOUGH) BRIO_FORWARD(try_sample(se, ball, &s->t->node[c].sample, hits));
    }
    return BRIO_OK;
}

/* Notes that another process must be asked about a ball. */
static brio_status note_far(brio_tile_source *s, search *se, uint32_t ball, uint32_t rank, size_t begin) {
    for (size_t i = begin; i < se->num_asked; i++)
        if (se->asked[i].rank == rank) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(s->t->ctx, se->asked, se->asked_capacity, se->num_asked + 1));
    se->asked[se->num_asked++] = (brio_tile_asked){ball, rank};
    return BRIO_OK;
}

static brio_status search_ball(brio_tile_source *s, search *se, uint32_t number) {
    brio_ball *ball = &s->balls[number];
    size_t num_asked = se->num_asked;
    int hits = 0;
    bool unsure = false;
    se->num_next = 0;
    se->ball = lanes_of(ball);
    const brio_tile_node above = {.first = s->root, .children = 1};
    BRIO_FORWARD(descend(s, se, ball, &above, &hits, &unsure));
    while (se->num_next > 0 && hits < ENOUGH) {
        uint32_t *swap = se->now;
        size_t capacity = se->now_capacity;
        se->now = se->next, se->now_capacity = se->next_capacity, se->num_now = se->num_next;
        se->next = swap, se->next_capacity = capacity, se->num_next = 0;
        for (size_t i = 0; i < se->num_now && hits < ENOUGH; i++) {
            const brio_tile_node *node = &s->t->node[se->now[i]];
            if (node->children)
                BRIO_FORWARD(descend(s, se, ball, node, &hits, &unsure));
            else if (node->tile == TILE_FAR)
                BRIO_FORWARD(note_far(s, se, number, node->first, num_asked));
            else
                BRIO_FORWARD(search_block(s, se, ball, se->now[i], &hits, &unsure));
        }
    }
    if (hits >= ENOUGH) se->num_asked = num_asked;
    ball->is_free = hits == 0 && !unsure;
    return BRIO_OK;
}

static void search_some(void *user, size_t begin, size_t end, int thread) {
    brio_tile_source *s = user;
    for (size_t i = begin; i < end; i++)
        if (__atomic_load_n(&s->status, __ATOMIC_RELAXED) == BRIO_OK)
            brio_report(&s->status, search_ball(s, &s->search[thread], (uint32_t)i));
}

static brio_status collect_asked(brio_tile_source *s, search *se) {
    BRIO_FORWARD(BRIO_RESERVE(s->t->ctx, s->asked, s->asked_capacity, s->num_asked + se->num_asked));
    if (se->num_asked) memcpy(s->asked + s->num_asked, se->asked, se->num_asked * sizeof *se->asked);
    s->num_asked += se->num_asked;
    se->num_asked = 0;
    return BRIO_OK;
}

void brio_tile_source_round(brio_tile_source *s) {
    s->round++;
    for (uint64_t i = 0; i < s->num_read; i++) {
        block *b = s->cache[s->read[i]];
        if (b->state == BLOCK_ADDED) b->state = BLOCK_KNOWN;
    }
}

brio_status brio_tile_conflicts(brio_tile_source *s, brio_ball *balls, size_t count, brio_found *found) {
    int threads = brio_threads(s->t->ctx, count, BALLS_A_THREAD);
    s->balls = balls;
    s->status = BRIO_OK;
    s->num_asked = 0;
    BRIO_FORWARD(brio_for_chunks(s->t->ctx, threads < s->threads ? threads : s->threads, count, 32, search_some, s));
    BRIO_FORWARD(s->status);
    for (int i = 0; i < s->threads; i++) {
        brio_found *f = &s->search[i].found;
        for (size_t k = 0; k < f->count; k++) BRIO_FORWARD(brio_found_add(found, &f->point[k]));
        f->count = 0;
        BRIO_FORWARD(collect_asked(s, &s->search[i]));
    }
    return BRIO_OK;
}

const brio_tile_asked *brio_tile_source_asked(const brio_tile_source *s, size_t *count) {
    *count = s->num_asked;
    return s->asked;
}

/* --- coarse sample --- */

/* Returns the square of a box's diagonal, and sets *apart to the square of its distance to another. */
static double size_and_distance(const brio_ball_box *box, const brio_ball_box *other, double *apart) {
    double size = 0;
    *apart = 0;
    for (int k = 0; k < 3; k++) {
        double side = box->high[k] - box->low[k];
        double gap = fmax(0, fmax(box->low[k] - other->high[k], other->low[k] - box->high[k]));
        size += side * side;
        *apart += gap * gap;
    }
    return size;
}

brio_status brio_tile_coarse_sample(brio_tile_source *s, const brio_ball_box *own, brio_found *found) {
    search *se = &s->search[0];
    s->num_asked = 0;
    BRIO_FORWARD(BRIO_RESERVE(s->t->ctx, se->next, se->next_capacity, 1));
    se->next[0] = s->root;
    for (se->num_next = 1; se->num_next > 0;) {
        const brio_tile_node *node = &s->t->node[se->next[--se->num_next]];
        double apart, size = size_and_distance(&node->box, own, &apart);
        if (node->tile == s->tile) continue;
        bool near = !(size < NEAR * NEAR * apart);
        if (near && node->tile == TILE_FAR) BRIO_FORWARD(note_far(s, se, 0, node->first, 0));
        if (!node->children || !near) {
            BRIO_FORWARD(brio_found_add(found, &node->sample));
            continue;
        }
        BRIO_FORWARD(BRIO_RESERVE(s->t->ctx, se->next, se->next_capacity, se->num_next + node->children));
        for (uint32_t c = 0; c < node->children; c++) se->next[se->num_next++] = node->first + c;
    }
    return collect_asked(s, se);
}
