/* Signs of sheets by any number of threads, against a matrix of ties that is added up piece by piece. */
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/labeled_delaunay/axis_agreement.h"
#include "reconstruct/labeled_delaunay/hash_order.h"
#include "reconstruct/labeled_delaunay/sheet_signs.h"
#include "base/vector.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = BRIEF_TESTS ? 1800 : 3000, MOST_THREADS = 5 };

static double points[3 * SAMPLES], spacing[SAMPLES];
static float told[SAMPLES];

/* --- the oracle --- */

typedef struct {
    const brio_pole_vectors *v;
    size_t n;
    bool is_told;
    int64_t *weight; /* n by n: between roots */
    uint32_t root[SAMPLES];
    bool opposite[SAMPLES]; /* to its root */
    int64_t told[SAMPLES];
} pieces;

static int64_t *between(const pieces *s, size_t a, size_t b) {
    return &s->weight[a * s->n + b];
}

static void tie_edge(const pieces *s, uint32_t p, uint32_t q) {
    const double *a = s->v->plane + 4 * (size_t)p, *b = s->v->plane + 4 * (size_t)q;
    double u[3], unit = fmin(spacing[p], spacing[q]), along = brio_dot(a, b);
    double distance = sqrt(brio_square_distance(points + 3 * (size_t)p, points + 3 * (size_t)q));
    for (int k = 0; k < 3; k++) u[k] = points[3 * q + (size_t)k] - points[3 * p + (size_t)k];
    double mirrored = along - 2 * brio_dot(a, u) * brio_dot(b, u) / brio_dot(u, u);
    if (!(distance < 2.5 * unit)) return;
    *between(s, p, q) = *between(s, q, p) = lrint(1024 * brio_axis_log_odds(along, mirrored, distance / unit, 0.1));
}

static void tie_all(const pieces *s) {
    for (size_t tet = 0; tet < s->v->num_finite; tet++)
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < i; k++) {
                uint32_t p = s->v->t.tet[tet].vertex[i], q = s->v->t.tet[tet].vertex[k];
                if (*between(s, p, q) == 0) tie_edge(s, p < q ? p : q, p < q ? q : p);
            }
}

static bool is_worth(const pieces *s, size_t a, size_t b, int64_t weight) {
    int64_t x = s->told[a], y = weight < 0 ? -s->told[b] : s->told[b];
    return (double)llabs(weight) > 1024.0 * ((double)(llabs(x) + llabs(y) - llabs(x + y)) / 0x1p24);
}

static bool comes_before(uint32_t p, uint32_t q) {
    return brio_compare_hashes(p, q, points) < 0;
}

/* Returns the piece that one is tied to most, or SAMPLES. */
static uint32_t best_of(const pieces *s, uint32_t a) {
    uint32_t best = SAMPLES;
    for (uint32_t b = 0; b < s->n; b++) {
        int64_t weight = *between(s, a, b);
        if (weight == 0 || !is_worth(s, a, b, weight)) continue;
        int64_t most = best < SAMPLES ? llabs(*between(s, a, best)) : -1;
        if (llabs(weight) > most || (llabs(weight) == most && comes_before(b, best))) best = b;
    }
    return best;
}

typedef struct {
    uint32_t a, b;
    int64_t weight;
} wish;

static int compare_wishes(const void *x, const void *y) {
    const wish *a = x, *b = y;
    if (llabs(a->weight) != llabs(b->weight)) return llabs(a->weight) > llabs(b->weight) ? -1 : 1;
    return a->a == b->a ? 0 : comes_before(a->a, b->a) ? -1 : 1;
}

/* Joins the pieces that samples a and b are in now. */
static bool join(pieces *s, wish w) {
    uint32_t a = s->root[w.a], b = s->root[w.b];
    bool opposite = s->opposite[w.a] ^ s->opposite[w.b] ^ (w.weight < 0);
    if (a == b || !is_worth(s, a, b, opposite ? -llabs(w.weight) : llabs(w.weight))) return false;
    uint32_t up = comes_before(a, b) ? a : b, down = up == a ? b : a;
    s->told[up] += opposite ? -s->told[down] : s->told[down];
    for (size_t p = 0; p < s->n; p++)
        if (s->root[p] == down) s->root[p] = up, s->opposite[p] ^= opposite;
    return true;
}

/* Adds the ties of joined pieces up. */
static void add_up(pieces *s) {
    int64_t *sum = calloc(s->n * s->n, sizeof *sum);
    for (size_t a = 0; a < s->n; a++)
        for (size_t b = 0; b < s->n; b++) {
            int64_t weight = *between(s, a, b);
            if (weight == 0 || s->root[a] == s->root[b]) continue;
            sum[s->root[a] * s->n + s->root[b]] += s->opposite[a] != s->opposite[b] ? -weight : weight;
        }
    free(s->weight);
    s->weight = sum;
}

static size_t join_round(pieces *s, double limit) {
    static wish wishes[SAMPLES];
    size_t count = 0, joined = 0;
    for (uint32_t a = 0; a < s->n; a++) {
        uint32_t b = s->root[a] == a ? best_of(s, a) : SAMPLES;
        if (b < SAMPLES && (double)llabs(*between(s, a, b)) >= 1024 * limit)
            wishes[count++] = (wish){a, b, *between(s, a, b)};
    }
    if (s->is_told) qsort(wishes, count, sizeof *wishes, compare_wishes);
    for (size_t i = 0; i < count; i++) joined += join(s, wishes[i]);
    add_up(s);
    return joined;
}

static void sign_by_matrix(const brio_pole_vectors *v, size_t n, bool is_told, pieces *s) {
    *s = (pieces){.v = v, .n = n, .is_told = is_told, .weight = calloc(n * n, sizeof(int64_t))};
    for (uint32_t p = 0; p < n; p++) s->root[p] = p, s->told[p] = is_told ? (int64_t)(0x1p24 * (double)told[p]) : 0;
    tie_all(s);
    for (double limit = 6; limit >= 1.5; limit /= 2)
        while (join_round(s, limit) > 0) {}
    free(s->weight);
}

/* --- against it --- */

static void expect_signs(brio_context *ctx, const brio_pole_vectors *v, size_t n, bool is_told, const pieces *s) {
    static uint8_t turned[SAMPLES], alone[SAMPLES];
    brio_sheet_samples samples = {spacing, 0.1, is_told ? told : NULL};
    size_t size[SAMPLES] = {0}, wrong = 0;
    for (size_t p = 0; p < n; p++) size[s->root[p]]++;
    EXPECT(brio_sign_sheets(ctx, v, &samples, turned, alone) == BRIO_OK, "%s", brio_message(ctx));
    for (size_t p = 0; p < n; p++) {
        uint32_t root = s->root[p];
        wrong += (turned[p] != turned[root]) != s->opposite[p];
        wrong += alone[p] != (size[root] == 1);
        if (s->told[root] != 0) wrong += turned[p] != ((s->told[root] < 0) != s->opposite[p]);
    }
    EXPECT(wrong == 0, "%zu of %zu samples, %s", wrong, n, is_told ? "told" : "not told");
}

static void compare(void (*make)(uint64_t, size_t, double *), uint64_t seed, size_t n) {
    static pieces s;
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_pole_vectors v;
    brio_rng rng = brio_rng_new(seed);
    make(seed, n, points);
    for (size_t p = 0; p < n; p++) {
        spacing[p] = 0.2 + 0.2 * brio_rng_double(&rng);
        told[p] = (float)(brio_rng_below(&rng, 3) ? 0 : 4 * brio_rng_double(&rng) - 2);
    }
    EXPECT(brio_delaunay(ctx, points, NULL, n, NULL, &t) == BRIO_OK, "%s", brio_message(ctx));
    EXPECT(brio_pole_vectors_find(ctx, t, points, n, 0.39, &v) == BRIO_OK);
    for (int is_told = 0; is_told < 2; is_told++) {
        sign_by_matrix(&v, n, is_told, &s);
        for (int threads = 1; threads <= MOST_THREADS; threads++) {
            brio_context_set_threads(ctx, threads);
            expect_signs(ctx, &v, n, is_told, &s);
        }
    }
    brio_pole_vectors_free(ctx, &v);
    brio_triangulation_free(t);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void lattice_points(uint64_t seed, size_t n, double *p) {
    integer_points(seed, n, 40, p);
    for (size_t i = 0; i < 3 * n; i++) p[i] /= 64;
}

static void signs_are_those_of_a_matrix_of_ties(void) {
    compare(uniform_points, 1, SAMPLES);
    compare(sphere_points, 2, SAMPLES);
    compare(clustered_points, 3, SAMPLES / 2);
    compare(lattice_points, 4, SAMPLES / 3);
    for (uint64_t seed = 5; seed < 8; seed++) compare(uniform_points, seed, SAMPLES);
}

static brio_status sign_a_few(brio_context *ctx) {
    static uint8_t turned[100], alone[100];
    brio_status status = BRIO_ERR_NO_MEMORY;
    brio_triangulation *t = NULL;
    brio_pole_vectors v = {0};
    brio_sheet_samples samples = {spacing, 0.1, told};
    for (size_t p = 0; p < 100; p++) spacing[p] = 0.3, told[p] = (float)(p % 3) - 1;
    sphere_points(5, 100, points);
    status = brio_delaunay(ctx, points, NULL, 100, NULL, &t);
    if (status == BRIO_OK) status = brio_pole_vectors_find(ctx, t, points, 100, 0.39, &v);
    if (status == BRIO_OK) status = brio_sign_sheets(ctx, &v, &samples, turned, alone);
    brio_pole_vectors_free(ctx, &v);
    brio_triangulation_free(t);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(sign_a_few);
}

SUITE(test_sheet_signs) {
    RUN(signs_are_those_of_a_matrix_of_ties);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
