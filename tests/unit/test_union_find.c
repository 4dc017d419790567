/* Union-find against labels that are renamed one by one: the same sets and roots by one thread or many, in any order. */
#include "base/union_find.h"
#include "base/team.h"
#include "harness.h"
#include "points.h"

enum { MOST = 600, TRIALS = 60, MANY = 40000, THREADS = 8 };

typedef struct {
    uint32_t a, b;
} edge;

static edge edges[2 * MANY];
static uint32_t parent[MANY], other[MANY], label[MANY];

/* Random pairs; every fourth set is one long path, from its high end or from its low one; every fourth other set is a
 * star, whose highest element meets lower and lower ones, so that many unions are of the same root. */
static void fill_edges(uint64_t seed, uint32_t n, size_t count) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < count; i++) {
        uint32_t step = (uint32_t)(i % (n - 1)), down = n - 2 - step, from_end = seed % 8 == 0 ? down : step;
        if (seed % 4 == 0)
            edges[i] = (edge){from_end, from_end + 1};
        else if (seed % 4 == 2)
            edges[i] = (edge){n - 1, down};
        else
            edges[i] = (edge){brio_rng_below(&rng, n), brio_rng_below(&rng, n)};
    }
}

static void alone_each(uint32_t *link, uint32_t n) {
    for (uint32_t i = 0; i < n; i++) link[i] = i;
}

/* The least element of each element's set, by renaming. */
static void unite_labels(uint32_t n, uint32_t a, uint32_t b) {
    uint32_t low = label[a] < label[b] ? label[a] : label[b], high = label[a] < label[b] ? label[b] : label[a];
    for (uint32_t i = 0; low != high && i < n; i++)
        if (label[i] == high) label[i] = low;
}

/* Links never go up; the root of each set is its least element. */
static void expect_labels(uint32_t *link, const uint32_t *least, uint32_t n, const char *what) {
    for (uint32_t i = 0; i < n; i++) EXPECT(link[i] <= i, "%s: link of %u", what, i);
    for (uint32_t i = 0; i < n; i++) EXPECT(brio_find(link, i) == least[i], "%s: root of %u", what, i);
    for (uint32_t i = 0; i < n; i++) EXPECT(least[link[i]] == least[i], "%s: path of %u", what, i);
}

static void sets_are_those_of_renamed_labels(void) {
    for (uint64_t seed = 0; seed < TRIALS; seed++) {
        uint32_t n = 2 + (uint32_t)(seed * 37 % (MOST - 1));
        size_t count = n * (seed % 5) / 4;
        fill_edges(seed, n, count);
        alone_each(parent, n);
        alone_each(other, n);
        alone_each(label, n);
        for (size_t i = 0; i < count; i++) {
            brio_unite(parent, edges[i].a, edges[i].b, seed % 2);
            brio_unite(other, edges[count - 1 - i].b, edges[count - 1 - i].a, !(seed % 2));
            unite_labels(n, edges[i].a, edges[i].b);
            EXPECT(brio_find(parent, edges[i].a) == label[edges[i].a], "after union %zu", i);
        }
        expect_labels(parent, label, n, "in order");
        expect_labels(other, label, n, "in reverse");
    }
}

/* --- threads --- */

/* MANY elements as forests of `size` elements, which threads grow together, all of them one forest at a time. */
typedef struct {
    size_t size, edges; /* of each forest */
} job;

/* Thread t of n unites the ends of edges t, t + n, t + 2 n, ... of each forest and finds roots of others between. */
static void unite_some(void *user, const brio_member *m) {
    const job *j = user;
    for (size_t f = 0; f < MANY / j->size; f++) {
        uint32_t *link = parent + f * j->size;
        const edge *own = edges + f * j->edges;
        brio_barrier(m); /* all at once */
        for (size_t i = (size_t)m->thread; i < j->edges; i += (size_t)m->threads) {
            brio_unite(link, own[i].a, own[i].b, m->threads == 1);
            brio_find(link, own[j->edges - 1 - i].a);
        }
    }
}

/* Grows the forests by one thread; `label` has the roots. */
static void unite_alone(const job *j) {
    for (size_t f = 0; f < MANY / j->size; f++) {
        uint32_t *link = other + f * j->size, n = (uint32_t)j->size;
        const edge *own = edges + f * j->edges;
        alone_each(link, n);
        for (size_t i = 0; i < j->edges; i++) brio_unite(link, own[i].a, own[i].b, true);
        for (uint32_t i = 0; i < n; i++) label[f * n + i] = brio_find(link, i);
    }
}

static void expect_the_same_by_threads(brio_context *ctx, uint64_t seed, size_t size) {
    job j = {size, size * (1 + seed % 3) / 2 - 1};
    uint32_t n = (uint32_t)size;
    fill_edges(seed, n, MANY / size * j.edges);
    unite_alone(&j);
    for (size_t f = 0; f < MANY / size; f++) alone_each(parent + f * size, n);
    brio_run(ctx, brio_threads(ctx, MANY, 1), unite_some, &j);
    for (size_t f = 0; f < MANY / size; f++) expect_labels(parent + f * size, label + f * size, n, "by threads");
}

static void any_number_of_threads_gives_the_same_sets(void) {
    for (int t = 2; t <= THREADS; t *= 2) {
        brio_context *ctx = new_context();
        brio_context_set_threads(ctx, t);
        for (uint64_t seed = 0; seed < 12; seed++) {
            expect_the_same_by_threads(ctx, seed, 100);
            expect_the_same_by_threads(ctx, seed, MANY);
        }
        brio_context_free(ctx);
    }
}

SUITE(test_union_find) {
    RUN(sets_are_those_of_renamed_labels);
    RUN(any_number_of_threads_gives_the_same_sets);
    return harness_end();
}
