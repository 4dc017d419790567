/* Triangulations and hulls of up to 12 points of any finite doubles against brute force in exact integers: exact_answer.h.
 *   bruteforce [--inputs N] [--seed S] [--first I]
 * Prints what was compared. An input whose result is wrong is printed; --inputs 1 --first I repeats it. */
#include "brio/laboratory.h"
#include "compare_exact.h"
#include <time.h>

enum { KINDS = 6, PREDICATES_AN_INPUT = 4 };

static const char *const KIND_NAMES[KINDS] = {"Delaunay, space", "regular, space", "Delaunay, plane",
                                              "regular, plane",  "flat in space",  "convex hull"};

typedef struct {
    uint64_t inputs[KINDS], simplices[KINDS], ties[KINDS], hidden[KINDS], wrong[KINDS], predicates;
} tally;

/* --- one input --- */

static void any_options(dice *d, brio_delaunay_options *o, brio_laboratory_options *lab) {
    uint32_t order = below(d, BRIO_ORDER_END + BRIO_BLOCKS_END - 1);
    *o = (brio_delaunay_options){0};
    *lab = (brio_laboratory_options){0};
    if (order < BRIO_ORDER_END)
        o->order = (brio_order)order;
    else
        lab->order = (brio_laboratory_order)(order - BRIO_ORDER_END + 1);
    lab->locate = (brio_location)below(d, BRIO_LOCATION_END);
    o->round_ratio = one_in(d, 2) ? 0 : 0.5;
    lab->block_size = below(d, 4);
    o->seed = below(d, 1000);
    o->leave_hidden = one_in(d, 8);
}

/* Tetrahedra from anywhere: either orientation. */
static const char *check_tetrahedra(brio_context *ctx, dice *d, const point_set *s, const brio_triangulation *t) {
    uint32_t v[4 * MASKS];
    size_t n = brio_triangulation_stats(t)->tetrahedra;
    const brio_tetrahedron *from = brio_triangulation_tetrahedra(t);
    int canonical = -1;
    for (size_t i = 0; i < n; i++) {
        uint32_t turn = below(d, 2);
        for (uint32_t k = 0; k < 4; k++) v[4 * i + k] = from[i].vertex[k < 2 ? k ^ turn : k];
    }
    brio_status status = brio_tetrahedra_check(ctx, s->x, s->weighted ? s->w : NULL, s->n, v, 4, n, &canonical);
    return status ? "brio_tetrahedra_check refuses it" : canonical != 1 ? "it is not canonical" : NULL;
}

static const char *try_solid(brio_context *ctx, dice *d, const point_set *s, const exact_answer *a) {
    brio_delaunay_options o;
    brio_laboratory_options experiment;
    brio_laboratory *lab;
    any_options(d, &o, &experiment);
    const double *w = s->weighted ? s->w : NULL;
    brio_triangulation *t;
    if (brio_laboratory_new(ctx, &experiment, &lab)) return brio_message(ctx);
    brio_status status = brio_delaunay(ctx, s->x, w, s->n, &o, &t);
    brio_laboratory_free(lab);
    if (status) return brio_message(ctx);
    const char *wrong = compare_solid(s, a, t, o.leave_hidden);
    if (!wrong && brio_triangulation_check(ctx, t, s->x, w, s->n)) wrong = "brio_triangulation_check refuses it";
    if (!wrong && a->dimension == 3) wrong = check_tetrahedra(ctx, d, s, t);
    brio_triangulation_free(t);
    return wrong;
}

static const char *try_plane(brio_context *ctx, const point_set *s, const exact_answer *a) {
    const double *w = s->weighted ? s->w : NULL;
    brio_triangulation2 *t;
    brio_status status = s->coordinates == 2 ? brio_delaunay2(ctx, s->x, w, s->n, NULL, &t)
                                             : brio_delaunay2_flat(ctx, s->x, w, s->n, NULL, &t);
    if (a->dimension == 3) return status == BRIO_ERR_NO_ANSWER ? NULL : "points off a plane are not refused";
    if (status) return brio_message(ctx);
    const char *wrong = compare_plane(s, a, t);
    if (!wrong && brio_triangulation2_check(ctx, t, s->x, w, s->n)) wrong = "brio_triangulation2_check refuses it";
    brio_triangulation2_free(t);
    return wrong;
}

static const char *try_hull(brio_context *ctx, const point_set *s, const exact_answer *a) {
    uint32_t sample[MOST_POINTS + 1];
    brio_convex_hull_options o = {0};
    brio_convex_hull_stats stats = {0};
    brio_mesh *m;
    o.polygons = 1, o.samples = sample;
    if (brio_convex_hull(ctx, s->x, s->n, &o, &m, &stats)) return brio_message(ctx);
    const char *wrong = compare_hull(a, m, sample, &stats);
    brio_mesh_free(m);
    return wrong;
}

/* --- predicates --- */

/* What the two predicates of the points' coordinates say of positions p[0] to p[d + 1]. */
typedef struct {
    int orient, sphere, perturbed;
} signs;

static signs signs_of(const point_set *s, const exact_answer *a, const uint32_t *p, bool positive) {
    const double *x[5], *w = NULL;
    double weights[5];
    size_t d = s->coordinates;
    for (size_t i = 0; i < d + 2; i++)
        x[i] = s->x + d * a->heaviest[p[i]], weights[i] = weight_at(s, a->heaviest[p[i]]);
    if (s->weighted) w = weights;
    if (d == 2)
        return (signs){brio_orient2d(x[0], x[1], x[2]), brio_incircle(x[0], x[1], x[2], x[3], w),
                       positive ? brio_incircle_perturbed(x[0], x[1], x[2], x[3], w) : 0};
    return (signs){brio_orient3d(x[0], x[1], x[2], x[3]), brio_insphere(x[0], x[1], x[2], x[3], x[4], w),
                   positive ? brio_insphere_perturbed(x[0], x[1], x[2], x[3], x[4], w) : 0};
}

/* d + 2 different positions in any order: the sign of the order of the first d + 1, and of all. */
static void draw_positions(dice *d, size_t positions, uint32_t count, uint32_t *p, int *parity) {
    mask has = 0;
    parity[0] = parity[1] = 1;
    for (uint32_t i = 0; i < count; i++) {
        do p[i] = below(d, (uint32_t)positions);
        while (has >> p[i] & 1);
        bool odd = __builtin_popcount(has >> p[i]) % 2;
        has |= 1u << p[i];
        if (odd && i + 1 < count) parity[0] = -parity[0];
        if (odd) parity[1] = -parity[1];
    }
}

static const char *try_predicates(dice *d, const point_set *s, const exact_answer *a, tally *sum) {
    uint32_t p[5], count = (uint32_t)s->coordinates + 2;
    int parity[2], dimension = (int)s->coordinates;
    if (a->dimension != dimension || a->positions < count) return NULL;
    for (int i = 0; i < PREDICATES_AN_INPUT; i++) {
        draw_positions(d, a->positions, count, p, parity);
        mask simplex = 0;
        for (uint32_t k = 0; k + 1 < count; k++) simplex |= 1u << p[k];
        mask all = simplex | 1u << p[count - 1];
        int orient = parity[0] * volume_sign[simplex];
        /* the last row's minor is the volume, with its sign by columns: inside where the height is negative */
        int rows = dimension % 2 ? -1 : 1, sphere = -rows * parity[1] * mpz_sgn(det[all]);
        signs found = signs_of(s, a, p, orient > 0);
        if (found.orient != orient) return "another orientation";
        if (orient && found.sphere != sphere) return "another side of a sphere";
        if (orient > 0 && found.perturbed != -rows * parity[1] * perturbed_sign(all, dimension))
            return "another perturbed side of a sphere";
        sum->predicates += 1 + (orient != 0) + (orient > 0);
    }
    return NULL;
}

/* --- runs --- */

static void count_one(tally *sum, int kind, const exact_answer *a, const char *wrong) {
    sum->inputs[kind]++;
    sum->simplices[kind] += kind == 5 ? a->planes : a->count;
    sum->ties[kind] += a->ties > 0;
    sum->hidden[kind] += a->positions > (size_t)__builtin_popcount(a->vertices);
    sum->wrong[kind] += wrong != NULL;
}

static void judge(tally *sum, int kind, const point_set *s, const exact_answer *a, const char *wrong) {
    count_one(sum, kind, a, wrong);
    if (!wrong) return;
    printf("WRONG %s: %s; %zu points:\n", KIND_NAMES[kind], wrong, s->n);
    print_points(s->x, s->weighted ? s->w : NULL, s->n, s->coordinates);
}

static bool try_input(brio_context *ctx, const oracle_run *run, uint64_t index, tally *sum) {
    static point_set s;
    static exact_answer a;
    dice d = dice_of(run->seed, index);
    uint64_t before = 0, after = 0;
    for (int k = 0; k < KINDS; k++) before += sum->wrong[k];
    s.coordinates = below(&d, 3) ? 3 : 2, s.weighted = one_in(&d, 2);
    hostile_points(&d, &s);
    exact_solve(&s, &a);
    if (s.coordinates == 3) {
        judge(sum, s.weighted, &s, &a, try_solid(ctx, &d, &s, &a));
        if (a.dimension < 3 || one_in(&d, 16)) judge(sum, 4, &s, &a, try_plane(ctx, &s, &a));
        judge(sum, 5, &s, &a, try_hull(ctx, &s, &a));
    } else {
        judge(sum, 2 + s.weighted, &s, &a, try_plane(ctx, &s, &a));
    }
    const char *wrong = try_predicates(&d, &s, &a, sum);
    if (wrong) judge(sum, s.coordinates == 3 ? s.weighted : 2 + s.weighted, &s, &a, wrong);
    for (int k = 0; k < KINDS; k++) after += sum->wrong[k];
    if (after > before)
        printf("again: bruteforce --inputs 1 --seed %llu --first %llu\n", (unsigned long long)run->seed,
               (unsigned long long)index);
    return after == before;
}

static void report(const oracle_run *run, const tally *sum, uint64_t wrong) {
    printf("%-18s %10s %12s %11s %12s %6s\n", "", "inputs", "simplices", "with ties", "with hidden", "wrong");
    for (int k = 0; k < KINDS; k++)
        printf("%-18s %10llu %12llu %11llu %12llu %6llu\n", KIND_NAMES[k], (unsigned long long)sum->inputs[k],
               (unsigned long long)sum->simplices[k], (unsigned long long)sum->ties[k],
               (unsigned long long)sum->hidden[k], (unsigned long long)sum->wrong[k]);
    printf("signs of predicates compared: %llu\n", (unsigned long long)sum->predicates);
    printf("%llu inputs, seed %llu, first %llu, %.0f s of processor time: %llu wrong\n",
           (unsigned long long)run->inputs, (unsigned long long)run->seed, (unsigned long long)run->first,
           (double)clock() / CLOCKS_PER_SEC, (unsigned long long)wrong);
}

int main(int argc, char **argv) {
    oracle_run run = oracle_arguments(argc, argv, 3000);
    tally sum = {{0}, {0}, {0}, {0}, {0}, 0};
    uint64_t wrong = 0;
    brio_context *ctx = oracle_context();
    exact_begin();
    for (uint64_t i = 0; i < run.inputs && wrong < 20; i++) wrong += !try_input(ctx, &run, run.first + i, &sum);
    if (brio_context_memory(ctx)) wrong++, printf("WRONG: %zu bytes left\n", brio_context_memory(ctx));
    report(&run, &sum, wrong);
    brio_context_free(ctx);
    return wrong ? 1 : 0;
}
