/* Blocks of nodes for the improvement of labels.
 *
 * Only nodes near violated edges take part, because a set of nodes whose flip lowers the energy has a violated edge on
 * its border. Space is halved at multiples of powers of two, in x, y and z in turn, until a cell has few nodes: a cell
 * is a block. The grid is shifted by a random vector. Nodes that one grid separates, another one keeps together. Two
 * blocks that an edge joins must not change at the same time, so the blocks are coloured, and a block waits for those
 * beside it whose colours are less. The order in which blocks choose colours is that of a hash of their cells.
 *
 * So a block depends on the nodes of its cell and of the cell twice as large, and its colour on blocks beside it that
 * have less hashes, and so on along a chain, which is short. Nodes elsewhere change neither.
 *
 * In memory a colour is a round. Where the graph is in scratch files, each round of all blocks would read all of it: so
 * the rounds of a window of the curve, as large as fits in a part of the memory, come before those of the next one. A
 * window takes in what its blocks wait for, each block after those. Whatever the windows are, each block comes after
 * the blocks beside it of less colours and before the others, so the labels are the same.
 *
 * Based on: Morton. A computer oriented geodetic data base and a new technique in file sequencing. IBM 1966 (the order
 *           in which cells are lists of neighbours).
 *           Jones, Plassmann. A parallel graph coloring heuristic. SIAM J. Sci. Comput. 1993 (hashes as
 *           priorities). */
#include "reconstruct/labels/node_blocks.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/scale.h"
#include "base/sort.h"
#include "base/team.h"
#include "predicates/predicates.h"
#include <assert.h>
#include <math.h>
#include <string.h>

/* HOPS: a node of a block is at most this many edges from a node with a violated edge. Chosen, as the next two.
 * GRID_BITS: of each coordinate on the grid. LEVELS: of halvings in one direction, as many as fit into a key. */
enum { HOPS = 3, OUTSIDE = 255, NODES_A_THREAD = 1024, NODES_A_CHUNK = 1024, GRID_BITS = 60, LEVELS = 21 };

/* What one thread finds: the pairs of blocks that an edge joins, as higher number << 32 | lower number. */
typedef struct {
    uint64_t *pair;
    size_t count, capacity;
    uint32_t *seen; /* #blocks: 1 + the last block that was found to be joined to the block */
} joiner;

typedef struct {
    uint64_t hash; /* of its cell */
    size_t begin, end;
} found_block;

typedef struct {
    const brio_signed_graph *g;
    const uint8_t *label, *fixed;
    size_t together; /* nodes of a window */
    int threads;     /* of all loops here */
    uint8_t hop;     /* the depth of the nodes whose neighbours are reached now */
    joiner *joiners; /* one for each thread */
    brio_status joined;
    uint64_t shift[3]; /* of the grid */
    uint64_t differ;   /* the bits in which places of nodes of the region differ on the grid */
    int top;           /* the highest of these */
    uint64_t *key;     /* of each node of the region: its cells of LEVELS levels, the largest first */
    size_t keyed;      /* the first of the nodes whose keys are made now */
    int level;         /* the first level of these keys */
    uint8_t *depth;    /* #nodes: edges from the nearest node with a violated edge, or OUTSIDE */
    found_block *found;
    size_t num_found, found_room;
    uint8_t *trouble; /* #blocks: 1 if one of the block's nodes has a violated edge */
    uint64_t *pair;   /* the pairs of all threads, sorted */
    size_t num_pairs;
    brio_node_blocks *out;
} finder;

/* --- the region --- */

static bool is_troubled(const finder *f, uint32_t p) {
    const brio_signed_graph *g = f->g;
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++)
        if (g->edge[e].weight != 0 && brio_label_violates(f->label, p, g->edge[e])) return true;
    return false;
}

/* Sets the depth of the neighbours of p that have none. Relaxed order suffices: threads that reach a node in one hop
 * write the same depth. No thread looks for that depth in this hop, and the next hop is another run. */
static void reach_neighbours(const finder *f, uint32_t p, uint8_t depth) {
    const brio_signed_graph *g = f->g;
    for (size_t e = g->first[p]; e < g->first[p + 1]; e++) {
        uint8_t *there = &f->depth[g->edge[e].node];
        if (__atomic_load_n(there, __ATOMIC_RELAXED) == OUTSIDE && !f->fixed[g->edge[e].node])
            __atomic_store_n(there, depth, __ATOMIC_RELAXED);
    }
}

static void mark_troubled(void *user, size_t begin, size_t end, int thread) {
    const finder *f = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) f->depth[p] = !f->fixed[p] && is_troubled(f, (uint32_t)p) ? 0 : OUTSIDE;
}

static void hop_from(void *user, size_t begin, size_t end, int thread) {
    const finder *f = user;
    (void)thread;
    for (size_t p = begin; p < end; p++)
        if (__atomic_load_n(&f->depth[p], __ATOMIC_RELAXED) == f->hop) reach_neighbours(f, (uint32_t)p, f->hop + 1);
}

static brio_status mark_region(finder *f) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->g->ctx;
    size_t n = f->g->count;
    BRIO_TRY(brio_for_chunks(ctx, f->threads, n, NODES_A_CHUNK, mark_troubled, f));
    for (f->hop = 0; f->hop < HOPS; f->hop++) BRIO_TRY(brio_for_chunks(ctx, f->threads, n, NODES_A_CHUNK, hop_from, f));
done:
    return status;
}

static brio_status list_region(finder *f) {
    brio_status status = BRIO_OK;
    brio_node_blocks *b = f->out;
    size_t n = f->g->count, count = 0;
    BRIO_TRY(BRIO_ALLOC(b->ctx, f->depth, n));
    BRIO_TRY(mark_region(f));
    for (size_t p = 0; p < n; p++) b->count += f->depth[p] != OUTSIDE;
    BRIO_TRY(BRIO_ALLOC(b->ctx, b->node, b->count));
    for (size_t p = 0; p < n; p++)
        if (f->depth[p] != OUTSIDE) b->node[count++] = (uint32_t)p;
done:
    return status;
}

/* --- cells --- */

static uint64_t on_grid(const finder *f, uint32_t node, int k) {
    double x = f->g->position[3 * (size_t)node + (size_t)k] * brio_scale_to_one(f->g->exponent);
    x = fmax(-1, fmin(1, x)) * (double)(INT64_C(1) << GRID_BITS);
    return f->shift[k] + (uint64_t)((INT64_C(1) << GRID_BITS) + (int64_t)x);
}

static void find_differences(void *user, size_t begin, size_t end, int thread) {
    finder *f = user;
    uint64_t differ = 0;
    (void)thread;
    for (int k = 0; k < 3; k++) {
        uint64_t first = on_grid(f, f->out->node[0], k);
        for (size_t i = begin; i < end; i++) differ |= on_grid(f, f->out->node[i], k) ^ first;
    }
    __atomic_fetch_or(&f->differ, differ, __ATOMIC_RELAXED);
}

/* Returns the 3 * LEVELS bits that say in which half a node is, at each level in x, y and z, from f->level down. */
static uint64_t key_of(const finder *f, uint32_t node) {
    uint64_t key = 0, cell[3];
    for (int k = 0; k < 3; k++) cell[k] = on_grid(f, node, k);
    for (int level = f->level; level < f->level + LEVELS; level++)
        for (int k = 0; k < 3; k++) key = key << 1 | (f->top < level ? 0 : cell[k] >> (f->top - level) & 1);
    return key;
}

static void find_keys(void *user, size_t begin, size_t end, int thread) {
    const finder *f = user;
    (void)thread;
    for (size_t i = f->keyed + begin; i < f->keyed + end; i++) f->key[i] = key_of(f, f->out->node[i]);
}

/* Sorts the nodes of a cell by the smaller ones of the next LEVELS levels. */
static brio_status sort_by_cells(finder *f, size_t begin, size_t end, int level) {
    brio_status status = BRIO_OK;
    brio_node_blocks *b = f->out;
    f->keyed = begin, f->level = level;
    BRIO_TRY(brio_for(b->ctx, brio_threads(b->ctx, end - begin, NODES_A_THREAD), end - begin, find_keys, f));
    BRIO_TRY(brio_radix_sort(b->ctx, f->key + begin, b->node + begin, end - begin, 3 * LEVELS));
done:
    return status;
}

/* Places the grid, and finds the smallest cell of it that holds the region. */
static brio_status find_top(finder *f, uint64_t draw) {
    brio_status status = BRIO_OK;
    brio_node_blocks *b = f->out;
    brio_rng rng = brio_rng_new(draw);
    for (int k = 0; k < 3; k++) f->shift[k] = brio_rng_next(&rng) >> (64 - GRID_BITS);
    if (b->count > 0) BRIO_TRY(brio_for(b->ctx, f->threads, b->count, find_differences, f));
    while (f->differ >> f->top > 1) f->top++;
done:
    return status;
}

/* Appends a block.   levels  how often its cell was halved. */
static brio_status add_block(finder *f, size_t begin, size_t end, int levels) {
    brio_status status = BRIO_OK;
    brio_node_blocks *b = f->out;
    uint64_t hash = 0;
    BRIO_TRY(BRIO_RESERVE(b->ctx, f->found, f->found_room, f->num_found + 1));
    for (int k = 0; k < 3; k++) {
        int low = f->top + 1 - (levels + 2 - k) / 3;
        hash = brio_hash(hash, on_grid(f, b->node[begin], k) >> low);
        hash = brio_hash(hash, (uint64_t)low);
    }
    f->found[f->num_found++] = (found_block){hash, begin, end};
done:
    return status;
}

static int compare_positions(uint32_t a, uint32_t b, const void *user) {
    const double *position = user;
    return brio_lexicographic(position + 3 * (size_t)a, position + 3 * (size_t)b);
}

/* Halves a cell until no part has over 2^bits nodes. However many levels that takes, the keys are those of the cell: so
 * nodes far away change nothing. Where more nodes are at one place of the grid, their positions in ascending order are
 * cut into runs.   levels  how often it was halved. */
static brio_status halve(finder *f, size_t begin, size_t end, int levels) {
    brio_status status = BRIO_OK;
    size_t most = (size_t)1 << f->out->bits;
    while (end - begin > most && levels < 3 * (f->top + 1)) {
        if (levels % (3 * LEVELS) == 0) BRIO_TRY(sort_by_cells(f, begin, end, levels / 3));
        uint64_t bit = UINT64_C(1) << (3 * LEVELS - 1 - levels++ % (3 * LEVELS));
        size_t low = begin, high = end;
        while (low < high) {
            size_t middle = low + (high - low) / 2;
            if (f->key[middle] & bit)
                high = middle;
            else
                low = middle + 1;
        }
        if (low == begin || low == end) continue;
        BRIO_TRY(halve(f, begin, low, levels));
        begin = low;
    }
    if (end - begin > most)
        BRIO_TRY(
            brio_sort_many_indices(f->out->ctx, f->out->node + begin, end - begin, compare_positions, f->g->position));
    for (size_t next; begin < end; begin = next) {
        next = end - begin > most ? begin + most : end;
        BRIO_TRY(add_block(f, begin, next, levels));
    }
done:
    return status;
}

static int compare_blocks(uint32_t a, uint32_t b, const void *user) {
    const found_block *x = (const found_block *)user + a, *y = (const found_block *)user + b;
    if (x->hash != y->hash) return x->hash < y->hash ? -1 : 1;
    return (x->begin > y->begin) - (x->begin < y->begin);
}

/* Divides the region into blocks, and numbers them in the order of their hashes. */
static brio_status list_blocks(finder *f) {
    brio_status status = BRIO_OK;
    brio_node_blocks *b = f->out;
    uint32_t *order = NULL;
    BRIO_TRY(BRIO_ALLOC(b->ctx, f->key, b->count));
    BRIO_TRY(b->count > 0 ? halve(f, 0, b->count, 0) : BRIO_OK);
    b->num_blocks = f->num_found;
    BRIO_TRY(BRIO_ALLOC(b->ctx, order, b->num_blocks));
    BRIO_TRY(BRIO_ALLOC(b->ctx, b->begin, b->num_blocks));
    BRIO_TRY(BRIO_ALLOC(b->ctx, b->end, b->num_blocks));
    BRIO_TRY(BRIO_ALLOC(b->ctx, b->of, b->count));
    for (size_t i = 0; i < b->num_blocks; i++) order[i] = (uint32_t)i;
    BRIO_TRY(brio_sort_many_indices(b->ctx, order, b->num_blocks, compare_blocks, f->found));
    for (uint32_t i = 0; i < b->num_blocks; i++) {
        b->begin[i] = f->found[order[i]].begin, b->end[i] = f->found[order[i]].end;
        for (size_t n = b->begin[i]; n < b->end[i]; n++) b->of[n] = i;
    }
done:
    brio_release(b->ctx, order);
    return status;
}

static brio_status set_places(const finder *f) {
    brio_node_blocks *b = f->out;
    brio_status status = BRIO_ALLOC(b->ctx, b->place, f->g->count);
    if (status != BRIO_OK) return status;
    memset(b->place, 255, f->g->count * sizeof *b->place);
    for (size_t i = 0; i < b->count; i++) b->place[b->node[i]] = (uint32_t)i;
    return BRIO_OK;
}

/* --- rounds --- */

static brio_status find_trouble(finder *f) {
    brio_node_blocks *b = f->out;
    brio_status status = BRIO_ALLOC_ZERO(b->ctx, f->trouble, b->num_blocks);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < b->count; i++) f->trouble[b->of[i]] |= f->depth[b->node[i]] == 0;
    return BRIO_OK;
}

/* Lists the pairs of a block and the blocks of lower number, with violated edges, that an edge joins to it. */
static brio_status join(const finder *f, joiner *j, uint32_t block) {
    const brio_signed_graph *g = f->g;
    const brio_node_blocks *b = f->out;
    brio_status status = BRIO_OK;
    for (size_t i = b->begin[block]; i < b->end[block]; i++)
        for (size_t e = g->first[b->node[i]]; e < g->first[b->node[i] + 1]; e++) {
            uint32_t place = b->place[g->edge[e].node], other = place == BRIO_NO_PLACE ? block : b->of[place];
            if (other >= block || j->seen[other] == block + 1 || !f->trouble[other]) continue;
            j->seen[other] = block + 1;
            BRIO_TRY(BRIO_RESERVE(b->ctx, j->pair, j->capacity, j->count + 1));
            j->pair[j->count++] = (uint64_t)block << 32 | other;
        }
done:
    return status;
}

/* Joins the blocks that begin at some of the places: along the curve, since what is near is read together. */
static void join_part(void *user, size_t begin, size_t end, int thread) {
    finder *f = user;
    for (size_t i = begin; i < end; i++) {
        uint32_t block = f->out->of[i];
        if (f->out->begin[block] == i && f->trouble[block])
            brio_report(&f->joined, join(f, &f->joiners[thread], block));
    }
}

static brio_status join_all(finder *f) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->out->ctx;
    size_t n = f->out->num_blocks;
    for (int t = 0; t < f->threads; t++) BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f->joiners[t].seen, n));
    BRIO_TRY(brio_for_chunks(ctx, f->threads, f->out->count, NODES_A_CHUNK, join_part, f));
    status = f->joined;
done:
    return status;
}

static brio_status list_pairs(finder *f) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->out->ctx;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f->joiners, (size_t)f->threads));
    BRIO_TRY(join_all(f));
    for (int t = 0; t < f->threads; t++) f->num_pairs += f->joiners[t].count;
    BRIO_TRY(BRIO_ALLOC(ctx, f->pair, f->num_pairs));
    for (size_t t = 0, count = 0; t < (size_t)f->threads; count += f->joiners[t++].count)
        if (f->joiners[t].count) memcpy(f->pair + count, f->joiners[t].pair, f->joiners[t].count * sizeof *f->pair);
    BRIO_TRY(brio_sort_many_keys(ctx, f->pair, f->num_pairs));
done:
    for (int t = 0; f->joiners && t < f->threads; t++) {
        brio_release(ctx, f->joiners[t].pair);
        brio_release(ctx, f->joiners[t].seen);
    }
    brio_release(ctx, f->joiners);
    return status;
}

/* Gives each block, in order, the first colour that no earlier block joined to it has.
 *  taken  #blocks + 1, all 0: for each colour, 1 + the last block that cannot have it. */
static void colour_blocks(const finder *f, uint32_t *colour, uint32_t *taken) {
    const brio_node_blocks *b = f->out;
    for (size_t block = 0, i = 0; block < b->num_blocks; block++) {
        if (!f->trouble[block]) continue;
        for (; i < f->num_pairs && f->pair[i] >> 32 == block; i++)
            taken[colour[(uint32_t)f->pair[i]]] = (uint32_t)block + 1;
        uint32_t c = 0;
        while (taken[c] == block + 1) c++;
        colour[block] = c;
    }
}

/* A block that waits, and where the next one that it waits for stands in `earlier`. */
typedef struct {
    uint32_t block;
    size_t next;
} waiting_block;

/* What is known when blocks are put into rounds. Block b waits for the blocks earlier[first[b]] to earlier[first[b + 1]
 * - 1]: those joined to it whose colours are less. */
typedef struct {
    uint32_t *colour; /* #blocks */
    size_t *first;    /* #blocks + 1 */
    uint32_t *earlier;
    uint8_t *listed;     /* #blocks */
    waiting_block *path; /* #colours: a block, one that it waits for, and so on */
    const size_t *begin;
    size_t num_listed, num_listed_nodes, room; /* blocks that have a round, and their nodes; room for rounds */
} schedule;

/* Returns the block of a pair that waits for the other one. */
static uint32_t waiting(const schedule *s, uint64_t pair, uint32_t *other) {
    uint32_t a = (uint32_t)(pair >> 32), b = (uint32_t)pair;
    bool a_waits = s->colour[a] > s->colour[b];
    *other = a_waits ? b : a;
    return a_waits ? a : b;
}

static brio_status list_earlier(const finder *f, schedule *s) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->out->ctx;
    size_t n = f->out->num_blocks;
    uint32_t other;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->first, n + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, s->earlier, f->num_pairs));
    for (size_t i = 0; i < f->num_pairs; i++) s->first[waiting(s, f->pair[i], &other)]++;
    for (size_t b = 0, end = 0; b <= n; b++) end += s->first[b], s->first[b] = end;
    for (size_t i = 0; i < f->num_pairs; i++) {
        uint32_t b = waiting(s, f->pair[i], &other);
        s->earlier[--s->first[b]] = other;
    }
done:
    return status;
}

/* Lists a block after those that it waits for, each of these after those that it waits for, and so on, as far as they
 * are not listed. Colours fall along a path, so a path is not longer than there are colours. */
static void list_block(schedule *s, brio_node_blocks *b, uint32_t block) {
    size_t depth = 0;
    if (s->listed[block]) return;
    s->listed[block] = 1;
    s->path[depth++] = (waiting_block){block, s->first[block]};
    while (depth > 0) {
        waiting_block *top = &s->path[depth - 1];
        if (top->next < s->first[top->block + 1]) {
            uint32_t other = s->earlier[top->next++];
            assert(s->colour[other] < s->colour[top->block]);
            if (!s->listed[other]) s->path[depth++] = (waiting_block){other, s->first[other]};
            s->listed[other] = 1;
        } else {
            s->num_listed_nodes += b->end[top->block] - b->begin[top->block];
            b->block[s->num_listed++] = top->block;
            depth--;
        }
    }
}

/* Compares colours, then places along the curve of the cells: blocks of a colour do not touch, so their order does not
 * matter, and what is near is worked on together. */
static int compare_turns(uint32_t a, uint32_t b, const void *user) {
    const schedule *s = user;
    if (s->colour[a] != s->colour[b]) return s->colour[a] < s->colour[b] ? -1 : 1;
    return (s->begin[a] > s->begin[b]) - (s->begin[a] < s->begin[b]);
}

/* Makes rounds of the blocks that were listed since block[from] was. */
static brio_status add_rounds(schedule *s, brio_node_blocks *b, size_t from) {
    brio_status status = brio_sort_many_indices(b->ctx, b->block + from, s->num_listed - from, compare_turns, s);
    for (size_t i = from; i < s->num_listed && status == BRIO_OK; i++) {
        if (i > from && s->colour[b->block[i]] == s->colour[b->block[i - 1]]) continue;
        status = BRIO_RESERVE(b->ctx, b->first_round, s->room, b->num_rounds + 2);
        if (status == BRIO_OK) b->first_round[b->num_rounds++] = i;
    }
    return status;
}

/* Lists the blocks of each round, window after window of the curve, each with what its blocks wait for. */
static brio_status list_rounds(const finder *f, schedule *s) {
    brio_status status = BRIO_OK;
    brio_node_blocks *b = f->out;
    size_t from = 0, nodes = 0, colours = 0;
    s->begin = b->begin;
    for (size_t i = 0; i < b->num_blocks; i++)
        if (f->trouble[i] && s->colour[i] >= colours) colours = s->colour[i] + (size_t)1;
    BRIO_TRY(BRIO_ALLOC(b->ctx, s->path, colours));
    BRIO_TRY(BRIO_ALLOC_ZERO(b->ctx, s->listed, b->num_blocks));
    BRIO_TRY(BRIO_ALLOC(b->ctx, b->block, b->num_blocks));
    BRIO_TRY(BRIO_RESERVE(b->ctx, b->first_round, s->room, 1));
    for (size_t i = 0; i < b->count; i = b->end[b->of[i]]) {
        if (f->trouble[b->of[i]]) list_block(s, b, b->of[i]);
        if (s->num_listed_nodes - nodes < f->together && b->end[b->of[i]] < b->count) continue;
        BRIO_TRY(add_rounds(s, b, from));
        from = s->num_listed, nodes = s->num_listed_nodes;
    }
    b->first_round[b->num_rounds] = s->num_listed;
done:
    return status;
}

static brio_status divide_into_rounds(finder *f) {
    brio_status status = BRIO_OK;
    brio_context *ctx = f->out->ctx;
    schedule s = {0};
    uint32_t *taken = NULL;
    BRIO_TRY(find_trouble(f));
    BRIO_TRY(list_pairs(f));
    BRIO_TRY(BRIO_ALLOC(ctx, s.colour, f->out->num_blocks));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, taken, f->out->num_blocks + 1));
    colour_blocks(f, s.colour, taken);
    BRIO_TRY(list_earlier(f, &s));
    BRIO_TRY(list_rounds(f, &s));
done:
    brio_release(ctx, s.colour);
    brio_release(ctx, s.first);
    brio_release(ctx, s.earlier);
    brio_release(ctx, s.listed);
    brio_release(ctx, s.path);
    brio_release(ctx, taken);
    return status;
}

/* --- the blocks --- */

brio_status brio_node_blocks_find(const brio_signed_graph *g, const uint8_t *label, const uint8_t *fixed,
                                  brio_block_rule rule, brio_node_blocks *out) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(g->ctx, g->count, NODES_A_THREAD);
    finder f = {.g = g, .label = label, .fixed = fixed, .together = rule.together, .threads = threads, .out = out};
    *out = (brio_node_blocks){.ctx = g->ctx, .bits = rule.bits};
    BRIO_TRY(list_region(&f));
    BRIO_TRY(find_top(&f, rule.draw));
    BRIO_TRY(list_blocks(&f));
    BRIO_TRY(set_places(&f));
    BRIO_TRY(divide_into_rounds(&f));
done:
    brio_release(g->ctx, f.depth);
    brio_release(g->ctx, f.key);
    brio_release(g->ctx, f.found);
    brio_release(g->ctx, f.trouble);
    brio_release(g->ctx, f.pair);
    return status;
}

void brio_node_blocks_free(brio_node_blocks *b) {
    brio_release(b->ctx, b->node);
    brio_release(b->ctx, b->place);
    brio_release(b->ctx, b->of);
    brio_release(b->ctx, b->begin);
    brio_release(b->ctx, b->end);
    brio_release(b->ctx, b->first_round);
    brio_release(b->ctx, b->block);
}
