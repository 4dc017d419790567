/* The exact check against brute force: triangulations are mutated in many ways, and the check must accept exactly those
 * that brute force accepts. The number of mutated sets may be given, and a seed: test_check_mutations 1000000 7. */
#include "brute_result.h"
#include "points.h"
#include "scenes.h"

static size_t num_sets = BRIEF_TESTS ? 4000 : 12000;
static uint64_t first_seed = 1;

enum { SETS_A_SCENE = 200, RESULTS_A_SCENE = 200 };

typedef struct {
    size_t made, right, accepted, refused, canonical;
} tally;

/* --- tetrahedra from anywhere --- */

static void judge_set(brio_context *ctx, const scene *e, const tet_set *t, uint64_t seed, tally *sum) {
    double points[3 * BRUTE_POINTS], weights[BRUTE_POINTS];
    int canonical = -1;
    as_doubles(&e->s, 0, points, weights);
    brio_status status =
        brio_tetrahedra_check(ctx, points, e->s.weighted ? weights : NULL, e->s.n, *t->v, 4, t->count, &canonical);
    bool right = brute_accepts(&e->s, t), best = right && brute_canonical(&e->s, t);
    EXPECT(status == (right ? BRIO_OK : BRIO_ERR_CHECK), "seed %llu: %s set: %s", (unsigned long long)seed,
           right ? "right" : "wrong", brio_message(ctx));
    EXPECT(canonical == (right ? best : -1), "seed %llu: canonical %d", (unsigned long long)seed, canonical);
    sum->made++, sum->right += right, sum->canonical += best;
    sum->accepted += status == BRIO_OK, sum->refused += status == BRIO_ERR_CHECK;
}

static void report(const char *what, const tally *sum) {
    fprintf(stderr, "       %zu %s: %zu right (%zu canonical); %zu accepted, %zu refused\n", sum->made, what,
            sum->right, sum->canonical, sum->accepted, sum->refused);
}

static void the_check_accepts_what_brute_force_accepts(void) {
    static scene e;
    static tet_set t;
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    tally sum = {0};
    for (uint64_t seed = first_seed; sum.made < num_sets; seed++) {
        make_scene(ctx, &e, seed, 3);
        for (size_t i = 0; i < SETS_A_SCENE && sum.made < num_sets; i++) {
            t = e.right[draw(&e, ALTERNATIVES)];
            if (draw(&e, 4) == 0) wind(&e, &t);
            for (size_t m = draw(&e, 5); m > 0 && t.count; m--) mutate(&e, &t);
            judge_set(ctx, &e, &t, seed, &sum);
        }
    }
    EXPECT(sum.right > sum.made / 20 && sum.right < sum.made);
    EXPECT(sum.canonical > 0 && sum.canonical < sum.right);
    report("mutated sets", &sum);
    brio_context_free(ctx);
}

/* --- results of brio_delaunay --- */

static uint32_t *any_handle(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    return &t->tet[draw(e, tets)].mate[draw(e, 4)];
}

static void wrong_mate(scene *e, brio_triangulation *t) {
    size_t handles = 4 * (t->stats.tetrahedra + t->stats.hull_facets);
    *any_handle(e, t) = draw(e, 8) ? (uint32_t)draw(e, handles) : draw(e, 2) ? UINT32_MAX : (uint32_t)handles;
}

/* Two pairs of mates change partners; the mates stay mutual. */
static void exchange_mates(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    uint32_t *f = any_handle(e, t), *g = any_handle(e, t), a = *f, b = *g;
    if (a / 4 >= tets || b / 4 >= tets) return;
    uint32_t handle_f = t->tet[a / 4].mate[a % 4], handle_g = t->tet[b / 4].mate[b % 4];
    *f = b, t->tet[b / 4].mate[b % 4] = handle_f;
    *g = a, t->tet[a / 4].mate[a % 4] = handle_g;
}

static void wrong_vertex(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    t->tet[draw(e, tets)].vertex[draw(e, 4)] = draw(e, 8) ? draw_point(e) : UINT32_MAX;
}

/* Slots of one tetrahedron change places, with their mates: right again when it is an even permutation that leaves the
 * infinite vertex where it is. */
static void turn_tet(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets, at = draw(e, tets);
    for (size_t n = 1 + draw(e, 2); n > 0; n--) {
        brio_tetrahedron *a = &t->tet[at];
        size_t i = draw(e, 4), j = (i + 1 + draw(e, 3)) % 4;
        uint32_t vertex = a->vertex[i], mate = a->mate[i];
        if (mate / 4 >= tets || a->mate[j] / 4 >= tets) return;
        a->vertex[i] = a->vertex[j], a->vertex[j] = vertex;
        a->mate[i] = a->mate[j], a->mate[j] = mate;
        t->tet[a->mate[i] / 4].mate[a->mate[i] % 4] = (uint32_t)(4 * at + i);
        t->tet[a->mate[j] / 4].mate[a->mate[j] % 4] = (uint32_t)(4 * at + j);
    }
}

/* Tetrahedra a and b change places, and their neighbours know it. */
static void swap_tets(brio_triangulation *t, size_t a, size_t b) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    brio_tetrahedron swap = t->tet[a];
    t->tet[a] = t->tet[b], t->tet[b] = swap;
    for (size_t i = 0; i < 4 * tets; i++) {
        uint32_t *mate = &t->tet[i / 4].mate[i % 4], tet = *mate / 4;
        if (tet == a || tet == b) *mate = (uint32_t)(4 * (tet == a ? b : a) + *mate % 4);
    }
}

/* Right again when both are finite or both infinite. */
static void exchange_tets(scene *e, brio_triangulation *t) {
    size_t tets = t->stats.tetrahedra + t->stats.hull_facets;
    swap_tets(t, draw(e, tets), draw(e, tets));
}

/* The ties broken in another way, or other tetrahedra, with everything else as it should be. */
static void other_tets(scene *e, brio_triangulation *t) {
    tet_set other = e->right[draw(e, ALTERNATIVES)];
    for (size_t m = draw(e, 3); m > 0 && other.count; m--) mutate(e, &other);
    brute_result(&e->s, &other, t);
}

/* A flat tetrahedron on the hull, with everything else as it should be. */
static void flat_tet(scene *e, brio_triangulation *t) {
    tet_set other = e->right[0];
    add_flat_on_hull(e, &other);
    brute_result(&e->s, &other, t);
}

/* One tetrahedron more, a copy whose mates do not know it: the first infinite one goes to the end for a finite one. */
static void unknown_copy(scene *e, brio_triangulation *t) {
    size_t first = t->stats.tetrahedra, tets = first + t->stats.hull_facets, from = draw(e, tets);
    if (tets == 0 || tets == 2 * BRUTE_TETS) return;
    t->tet[tets] = t->tet[from];
    t->stats.hull_facets++;
    if (from >= first) return;
    t->stats.hull_facets--, t->stats.tetrahedra++;
    swap_tets(t, tets, first);
}

static void wrong_representative(scene *e, brio_triangulation *t) {
    t->representative[draw_point(e)] = draw(e, 8) ? draw_point(e) : UINT32_MAX;
}

/* A vertex and its twin change roles everywhere. */
static void other_twin(scene *e, brio_triangulation *t) {
    uint32_t p = draw_point(e), q = twin_of(e, p);
    for (size_t i = 0; i < 4 * (t->stats.tetrahedra + t->stats.hull_facets); i++) {
        uint32_t *v = &t->tet[i / 4].vertex[i % 4];
        *v = *v == p ? q : *v == q ? p : *v;
    }
    for (size_t i = 0; i < e->s.n; i++) {
        uint32_t *r = &t->representative[i];
        *r = *r == p ? q : *r == q ? p : *r;
    }
}

static void wrong_count(scene *e, brio_triangulation *t) {
    size_t *count[] = {&t->stats.vertices, &t->stats.duplicates, &t->stats.hidden};
    *count[draw(e, 3)] += draw(e, 2) ? 1 : SIZE_MAX;
    if (draw(e, 2)) *count[draw(e, 3)] += draw(e, 2) ? 1 : SIZE_MAX;
}

static void wrong_dimension(scene *e, brio_triangulation *t) {
    t->stats.dimension = (int)draw(e, 5) - 1;
}

/* The last tetrahedron goes to the other kind, or is not counted. */
static void wrong_kinds(scene *e, brio_triangulation *t) {
    if (t->stats.tetrahedra == 0) return;
    t->stats.tetrahedra--;
    t->stats.hull_facets += draw(e, 2);
}

/* Tetrahedra are counted that a flat input does not have. */
static void solid_counts(scene *e, brio_triangulation *t) {
    if (draw(e, 2)) t->stats.tetrahedra++;
    if (draw(e, 2)) t->stats.hull_facets++;
}

typedef void (*spoiling)(scene *, brio_triangulation *);

static const spoiling SPOILINGS[] = {
    wrong_mate,   exchange_mates,       wrong_vertex, turn_tet,    exchange_tets,   other_tets, flat_tet,
    unknown_copy, wrong_representative, other_twin,   wrong_count, wrong_dimension, wrong_kinds};
/* Those that need no tetrahedra. */
static const spoiling FLAT_SPOILINGS[] = {wrong_representative, other_twin, wrong_count, wrong_dimension, solid_counts};

static void judge_result(brio_context *ctx, scene *e, const brio_triangulation *t, uint64_t seed, tally *sum) {
    double points[3 * BRUTE_POINTS], weights[BRUTE_POINTS];
    as_doubles(&e->s, 0, points, weights);
    brio_status status = brio_triangulation_check(ctx, t, points, e->s.weighted ? weights : NULL, e->s.n);
    bool right = brute_accepts_result(&e->s, t);
    EXPECT(status == (right ? BRIO_OK : BRIO_ERR_CHECK), "seed %llu: %s result: %s", (unsigned long long)seed,
           right ? "right" : "wrong", brio_message(ctx));
    sum->made++, sum->right += right, sum->canonical += right;
    sum->accepted += status == BRIO_OK, sum->refused += status == BRIO_ERR_CHECK;
}

static void spoil_results(brio_context *ctx, scene *e, uint64_t seed, int dimension, tally *sum) {
    static brute_storage copy;
    double points[3 * BRUTE_POINTS], weights[BRUTE_POINTS];
    brio_triangulation *right = NULL, t;
    make_scene(ctx, e, seed, dimension);
    as_doubles(&e->s, 0, points, weights);
    EXPECT(brio_delaunay(ctx, points, e->s.weighted ? weights : NULL, e->s.n, NULL, &right) == BRIO_OK);
    for (size_t i = 0; i < RESULTS_A_SCENE; i++) {
        brute_copy(right, &copy, &t);
        for (size_t m = i ? 1 + draw(e, 2) : 0; m > 0; m--) {
            if (dimension == 3)
                SPOILINGS[draw(e, sizeof SPOILINGS / sizeof *SPOILINGS)](e, &t);
            else
                FLAT_SPOILINGS[draw(e, sizeof FLAT_SPOILINGS / sizeof *FLAT_SPOILINGS)](e, &t);
        }
        judge_result(ctx, e, &t, seed, sum);
    }
    brio_triangulation_free(right);
}

static void spoil_dimensions(int low, int high, size_t wanted, const char *what) {
    static scene e;
    brio_context *ctx = new_context();
    brio_context_set_threads(ctx, 1);
    tally sum = {0};
    for (uint64_t seed = first_seed; sum.made < wanted; seed++)
        spoil_results(ctx, &e, seed, low + (int)(seed % (uint64_t)(high - low + 1)), &sum);
    EXPECT(sum.right > 0 && sum.right < sum.made);
    report(what, &sum);
    brio_context_free(ctx);
}

static void results_pass_exactly_when_all_of_them_is_right(void) {
    spoil_dimensions(3, 3, num_sets, "results");
}

static void flat_results_pass_exactly_when_all_of_them_is_right(void) {
    spoil_dimensions(0, 2, num_sets / 4, "flat results");
}

SUITE(test_check_mutations) {
    if (argc > 1) num_sets = strtoull(argv[1], NULL, 10);
    if (argc > 2) first_seed = strtoull(argv[2], NULL, 10);
    RUN(the_check_accepts_what_brute_force_accepts);
    RUN(results_pass_exactly_when_all_of_them_is_right);
    RUN(flat_results_pass_exactly_when_all_of_them_is_right);
    return harness_end();
}
