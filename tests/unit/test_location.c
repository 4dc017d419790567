/* Strategies of point location: one answer whichever is used, right searches, few steps, clean ends. */
#include "brio/testdata.h"
#include "base/memory.h"
#include "failing_allocator.h"
#include "harness.h"
#include "insertion.h"
#include "points.h"
#include "laboratory/location/history.h"
#include "laboratory/location/locate_segment.h"

enum { N = 400, EDGES = 2 * N, SETS = 7 };

static double points[3 * N], weights[N];
static uint32_t edges[2 * EDGES];

static const char *const names[] = {"walk", "jump", "hierarchy", "history", "trace", "neighbour"};

/* The strategies, and those of the history DAG once more with each of its other searches. */
enum { STRATEGIES = BRIO_LOCATION_END + 4 };

static trial_options strategy(int s) {
    trial_options o = {0};
    int other = s - BRIO_LOCATION_END;
    o.all_conflicts = other == 0 || other == 1;
    o.first_conflict = other > 1;
    o.locate = other < 0 ? (brio_location)s : other % 2 == 0 ? BRIO_LOCATION_HISTORY : BRIO_LOCATION_TRACE;
    o.edges = edges;
    o.num_edges = EDGES;
    return o;
}

static void scan_points(size_t n, double *to) {
    brio_context *ctx = new_context();
    brio_mesh *mesh;
    EXPECT(brio_generate(ctx, BRIO_KIND_SCAN, n + n / 4, NULL, &mesh) == BRIO_OK && mesh->num_vertices >= n);
    memcpy(to, mesh->vertices, 3 * n * sizeof *to);
    brio_mesh_free(mesh);
    brio_context_free(ctx);
}

/* Edges between points that follow one another, with gaps, and a few at random, loops and repetitions among them. */
static void make_edges(size_t n) {
    brio_rng rng = brio_rng_new(5);
    for (uint32_t i = 0; i < EDGES; i++) {
        bool chain = i % N < n - 1 && i % 10 && i % 200 > 20;
        edges[2 * i] = chain ? i % N : brio_rng_below(&rng, (uint32_t)n);
        edges[2 * i + 1] = chain ? i % N + 1 : i % 3 ? edges[2 * i] : brio_rng_below(&rng, (uint32_t)n);
    }
}

static void make_set(int set) {
    double unit = 1e-3;
    if (set == 0) uniform_points(1, N, points);
    if (set == 1) scan_points(N, points), unit = 0.02;
    if (set == 2) integer_points(2, N, 8, points), unit = 1;
    if (set == 3) scan_points(N, points), unit = 0.02;
    for (size_t i = 0; i < N && set == 3; i++) points[3 * i + 2] = floor(points[3 * i + 2] * 32) / 32;
    if (set == 4) clustered_points(3, N, points);
    if (set == 5) sphere_points(4, N, points), unit = 0.02; /* in convex position: none is ever hidden */
    if (set == 6) integer_points(6, N, 40, points), unit = 4;
    for (size_t i = 0; i < N && set == 6; i++) points[3 * i + 2] = 3;
    integer_weights(7, N, 6, weights);
    for (size_t i = 0; i < N; i++) weights[i] *= unit;
    make_edges(N);
}

typedef struct {
    uint64_t arrays, checksum; /* of all that is returned; of the set of tetrahedra */
    brio_delaunay_stats stats;
    brio_laboratory_stats lab;
} result;

static result run(const double *p, const double *w, size_t n, const trial_options *o) {
    brio_context *ctx = new_context();
    brio_triangulation *t = NULL;
    brio_laboratory *lab;
    result r = {0};
    brio_context_set_threads(ctx, 2);
    EXPECT(trial_delaunay(ctx, p, w, n, o, &t, &lab) == BRIO_OK, "%s", brio_message(ctx));
    if (t) {
        r.lab = *brio_laboratory_results(lab);
        EXPECT(brio_triangulation_check(ctx, t, p, w, n) == BRIO_OK, "%s", brio_message(ctx));
        EXPECT(brio_triangulation_checksum(ctx, t, p, &r.checksum) == BRIO_OK);
        r.stats = *brio_triangulation_stats(t);
        const uint32_t *number = (const uint32_t *)brio_triangulation_tetrahedra(t);
        for (size_t i = 0; i < 8 * (r.stats.tetrahedra + r.stats.hull_facets); i++)
            r.arrays = brio_mix(r.arrays + number[i]);
        for (size_t i = 0; i < n; i++) r.arrays = brio_mix(r.arrays + brio_triangulation_representatives(t)[i]);
    }
    brio_triangulation_free(t);
    brio_laboratory_free(lab);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    return r;
}

static void expect_same(const result *found, const result *expected, int set, int s, int order) {
    const char *name = names[s < BRIO_LOCATION_END ? s : (s - BRIO_LOCATION_END) % 2 + BRIO_LOCATION_HISTORY];
    EXPECT(found->checksum == expected->checksum, "set %d, %s, order %d", set, name, order);
    EXPECT(found->stats.vertices == expected->stats.vertices && found->stats.hidden == expected->stats.hidden &&
               found->stats.duplicates == expected->stats.duplicates,
           "set %d, %s, order %d", set, name, order);
}

static void every_strategy_in_every_order_gives_one_triangulation(void) {
    for (int set = 0; set < SETS; set++) {
        make_set(set);
        for (int weighted = BRIEF_TESTS ? set % 2 : 0; weighted < 2; weighted += BRIEF_TESTS ? 2 : 1) {
            const double *w = weighted ? weights : NULL;
            result first = {0};
            for (int order = 0; order < TRIAL_ORDERS; order += BRIEF_TESTS ? 1 + set % 2 : 1) {
                result walk = {0};
                for (int s = 0; s < STRATEGIES; s++) {
                    trial_options o = strategy(s);
                    o.order = order;
                    result r = run(points, w, N, &o);
                    if (s == 0) walk = r;
                    if (s == 0 && order == 0) first = r;
                    EXPECT(r.arrays == walk.arrays, "set %d, strategy %d, order %d", set, s, order);
                    expect_same(&r, &first, set, s, order);
                }
            }
            EXPECT((first.stats.hidden > 0) == (weighted && set != 5), "set %d hides nothing", set);
        }
    }
}

static void strategies_count_what_they_do(void) {
    make_set(1);
    for (int s = 0; s < STRATEGIES; s++) {
        trial_options o = strategy(s);
        result r = run(points, NULL, N, &o);
        brio_laboratory_stats stats = r.lab;
        bool history = o.locate == BRIO_LOCATION_HISTORY || o.locate == BRIO_LOCATION_TRACE;
        EXPECT(stats.history == (history ? r.stats.created : 0), "strategy %d", s);
        EXPECT((stats.history_tests > 0) == history, "strategy %d", s);
        EXPECT((stats.history_conflicts > 0) == (o.all_conflicts || o.first_conflict), "strategy %d", s);
        EXPECT(stats.history_conflicts <= stats.history_tests, "strategy %d", s);
        EXPECT((stats.trace_intersections > 0) == (o.locate == BRIO_LOCATION_TRACE), "strategy %d", s);
        EXPECT((r.stats.walk_steps > 0) == !history, "strategy %d", s);
    }
}

/* Pairs of points close together, and the edges of these pairs; to be freed. */
static double *paired_points(size_t n, uint32_t **pairs) {
    double *p = malloc(3 * n * sizeof *p);
    *pairs = malloc(n * sizeof **pairs);
    uniform_points(1, n, p);
    for (size_t i = 1; i < n; i += 2)
        for (size_t c = 0; c < 3; c++) p[3 * i + c] = p[3 * i - 3 + c] + 1e-5 * p[3 * i + c];
    for (uint32_t i = 0; i < n; i++) (*pairs)[i] = i;
    return p;
}

/* In random order the point inserted last is anywhere: what a strategy starts from decides. */
static void walks_are_short(void) {
    static const brio_location walks[] = {BRIO_LOCATION_JUMP, BRIO_LOCATION_HIERARCHY, BRIO_LOCATION_NEIGHBOUR};
    enum { MANY = 8000 };
    uint32_t *pairs;
    double *many = paired_points(MANY, &pairs);
    for (int i = 0; i < 3; i++) {
        trial_options o = {0};
        o.order = BRIO_ORDER_RANDOM, o.locate = walks[i], o.edges = pairs, o.num_edges = MANY / 2;
        result r = run(many, NULL, MANY, &o);
        double steps = (double)r.stats.walk_steps / MANY;
        EXPECT(steps > 0 && steps < 30, "%s: %g steps a point", names[walks[i]], steps);
        o.num_edges = 0;
        r = run(many, NULL, MANY, &o);
        EXPECT(walks[i] != BRIO_LOCATION_NEIGHBOUR || (double)r.stats.walk_steps / MANY > 35, "without edges");
    }
    free(many);
    free(pairs);
}

/* History tests a point that a random order comes to at most. By backwards analysis insertion j made the tetrahedron that
 * holds a point with probability 4 / j, and a neighbour of the point among those inserted so far with probability
 * degree / j. A search comes to the insertions of the first kind, or of the second when it follows all conflicts, and
 * tests at most what each created. */
static double most_history_tests(const brio_delaunay_stats *s, bool all_conflicts) {
    double n = (double)s->vertices, joined = n + (double)s->tetrahedra + 0.5 * (double)s->hull_facets - 1;
    return (all_conflicts ? 2 * joined / n : 4) * log(n) * (double)s->created / n;
}

static void history_tests_grow_as_the_logarithm(void) {
    for (size_t n = 1000; n <= (BRIEF_TESTS ? 4000 : 16000); n *= 4) {
        double *p = malloc(3 * n * sizeof *p);
        uniform_points(1, n, p);
        for (int all = 0; all < 2; all++) {
            trial_options o = {0};
            o.order = BRIO_ORDER_RANDOM, o.locate = BRIO_LOCATION_HISTORY, o.all_conflicts = all;
            result r = run(p, NULL, n, &o);
            double tests = (double)r.lab.history_tests / (double)n, most = most_history_tests(&r.stats, all);
            EXPECT(tests < most, "%zu points, all conflicts %d: %g tests a point, at most %g", n, all, tests, most);
        }
        free(p);
    }
}

/* The bound can be broken, without the random order: each point is beyond all those before it, and the searches for it come
 * to an insertion for most of these. */
static void history_tests_of_sorted_points_are_many(void) {
    enum { MANY = 4000 };
    double *p = malloc(3 * MANY * sizeof *p);
    uniform_points(1, MANY, p);
    for (size_t i = 0; i < MANY; i++) p[3 * i] = (double)i;
    trial_options o = {0};
    o.order = BRIO_ORDER_INPUT, o.locate = BRIO_LOCATION_HISTORY;
    result r = run(p, NULL, MANY, &o);
    double tests = (double)r.lab.history_tests / MANY, most = most_history_tests(&r.stats, false);
    EXPECT(tests > most, "%g tests a point, at most %g", tests, most);
    free(p);
}

/* The second point of a pair is found from the first by tracing, through one tetrahedron or two, in each of the two
 * tracings; the first is found from the root. So half of the tests are left. Without edges nothing is traced. */
static void traced_pairs_save_their_history_tests(void) {
    enum { MANY = BRIEF_TESTS ? 3000 : 8000, TRACINGS = 2 };
    uint32_t *pairs;
    double *many = paired_points(MANY, &pairs);
    for (int all = 0; all < 2; all++) {
        trial_options o = {0};
        o.order = BRIO_ORDER_RANDOM, o.locate = BRIO_LOCATION_HISTORY, o.all_conflicts = all;
        brio_laboratory_stats plain = run(many, NULL, MANY, &o).lab;
        o.locate = BRIO_LOCATION_TRACE;
        brio_laboratory_stats without = run(many, NULL, MANY, &o).lab;
        EXPECT(without.history_tests == plain.history_tests && without.trace_intersections == 0);
        o.edges = pairs, o.num_edges = MANY / 2;
        brio_laboratory_stats traced = run(many, NULL, MANY, &o).lab;
        EXPECT((double)traced.history_tests < 0.6 * (double)plain.history_tests, "%g of %g tests a point",
               (double)traced.history_tests / MANY, (double)plain.history_tests / MANY);
        EXPECT(traced.trace_intersections > 0 && traced.trace_intersections < TRACINGS * MANY, "%g entered a point",
               (double)traced.trace_intersections / MANY);
    }
    free(many);
    free(pairs);
}

/* --- searches --- */

/* A search for p against all live tetrahedra. */
static void expect_searches_right(brio_inserter *ins, brio_history *h, const double *p) {
    const brio_store *s = ins->store;
    uint32_t tet = brio_history_path(ins, h, BRIO_HISTORY_ROOT, p);
    EXPECT(s->state[tet] == TET_PLAIN && tetrahedron_holds(s, tet, p));
    EXPECT(brio_history_path(ins, h, h->node_of[tet], p) == tet);
    EXPECT(brio_history_conflicts(ins, h, BRIO_HISTORY_ROOT, p, 1) == BRIO_OK && h->num_conflicts <= 1);
    uint32_t first = h->num_conflicts ? h->conflict[0] : BRIO_NO_TET;
    EXPECT(brio_history_conflicts(ins, h, BRIO_HISTORY_ROOT, p, SIZE_MAX) == BRIO_OK);
    EXPECT(first == (h->num_conflicts ? h->conflict[0] : BRIO_NO_TET)); /* the first one of all */
    bool any = false, listed = false;
    for (uint32_t t = 0; t < s->t.count; t++)
        any |= s->state[t] == TET_PLAIN && brio_in_conflict(&s->t, &ins->filter, t, p, s->weighted);
    for (size_t i = 0; i < h->num_conflicts; i++) {
        uint32_t found = h->conflict[i];
        EXPECT(s->state[found] == TET_PLAIN && brio_in_conflict(&s->t, &ins->filter, found, p, s->weighted));
        for (size_t j = 0; j < i; j++) EXPECT(h->conflict[j] != found);
        listed |= found == tet;
    }
    EXPECT(any == (h->num_conflicts > 0));
    if (brio_in_conflict(&s->t, &ins->filter, tet, p, s->weighted) && !brio_is_infinite(&s->t, tet)) EXPECT(listed);
}

/* A history made by hand: insertion 0 has nodes 0 and 1, insertion 1, which destroyed node 0, has 2 to 4, insertion 2, which
 * destroyed node 3, has 5 to 7, and insertion 3, which destroyed 6, has 8. Nodes whose turn it is are tetrahedra about the
 * origin, the place that is searched for; the others are far away. */
typedef struct {
    brio_inserter *ins;
    brio_history h;
    brio_laboratory_stats stats;
    brio_history_node node[9];
    uint32_t first[5], node_of[9];
} made_history;

/* Nodes of `conflicts`, a bit each, are in conflict with the origin. */
static void make_history(made_history *m, brio_inserter *ins, unsigned conflicts) {
    static const uint32_t first[5] = {0, 2, 5, 8, 9}, next[9] = {1, BRIO_HISTORY_LIVE + 1, BRIO_HISTORY_LIVE + 2,
                                                                 2, BRIO_HISTORY_LIVE + 4, BRIO_HISTORY_LIVE + 5,
                                                                 3, BRIO_HISTORY_LIVE + 7, BRIO_HISTORY_LIVE + 8};
    *m = (made_history){.ins = ins};
    memcpy(m->first, first, sizeof first);
    for (uint32_t i = 0; i < 9; i++) {
        uint32_t v = conflicts >> i & 1 ? 0 : 4;
        m->node[i] = (brio_history_node){{v, v + 1, v + 2, v + 3}, next[i]};
        m->node_of[i] = i;
    }
    m->h = (brio_history){.stats = &m->stats,
                          .node = m->node,
                          .num_nodes = 9,
                          .first = m->first,
                          .num_insertions = 4,
                          .node_of = m->node_of};
}

/* The nodes that a search for the origin tests, until it has `most` conflicts; *found is the first of these. */
static uint64_t tests_of_search(brio_inserter *ins, unsigned conflicts, size_t most, uint32_t *found) {
    static const double origin[4] = {0};
    made_history m;
    make_history(&m, ins, conflicts);
    EXPECT(brio_history_conflicts(ins, &m.h, BRIO_HISTORY_ROOT, origin, most) == BRIO_OK);
    *found = m.h.num_conflicts ? m.h.conflict[0] : BRIO_NO_TET;
    brio_context *ctx = ins->store->ctx;
    brio_release(ctx, m.h.seen);
    brio_release(ctx, m.h.open);
    brio_release(ctx, m.h.conflict);
    return m.stats.history_tests;
}

/* The program hull's search goes depth first, and returns at the first live tetrahedron in conflict. */
static void a_search_ends_at_the_first_live_conflict(void) {
    static const double corner[3 * 8] = {-1, -1, -1, 3,  0,  0,  0,  3,  0,  0,  0,  3,
                                         49, 49, 49, 53, 50, 50, 50, 53, 50, 50, 50, 53};
    static const struct {
        unsigned conflicts;  /* in conflict with the origin, of the nodes 0 to 8 */
        uint64_t first, all; /* tests until the first live conflict, and until all */
        uint32_t found;
    } cases[] = {
        {0x05b, 8, 9, 4}, /* nodes 0, 1, 3, 4 and 6: 0, 2, 3, and below 3: 5, 6, below 6: 8, back to 7, and to 4 */
        {0x002, 2, 2, 1}, /* node 1: after node 0, which is not in conflict */
        {0x1cb, 6, 9, 8}, /* nodes 0, 1, 3, 6, 7 and 8: the way down to 8, whatever lives beside it */
        {0x007, 2, 5, 2}, /* nodes 0, 1 and 2: 0 leads to 2, the first of its insertion */
        {0x049, 9, 9, BRIO_NO_TET},
    };
    brio_context *ctx = new_context();
    trial_options o = strategy(BRIO_LOCATION_WALK);
    brio_inserter *ins = insertion_begin(ctx, corner, NULL, 8, &o);
    for (size_t i = 0; i < sizeof cases / sizeof *cases; i++) {
        uint32_t found;
        uint64_t first = tests_of_search(ins, cases[i].conflicts, 1, &found);
        EXPECT(first == cases[i].first && found == cases[i].found, "case %zu: %d tests, node %u", i, (int)first, found);
        uint64_t all = tests_of_search(ins, cases[i].conflicts, SIZE_MAX, &found);
        EXPECT(all == cases[i].all && found == cases[i].found, "case %zu: %d tests of all, node %u", i, (int)all,
               found);
    }
    insertion_end(ins);
    brio_context_free(ctx);
}

static void history_searches_find_what_brute_force_finds(void) {
    for (int set = 0; set < SETS; set++) {
        for (int weighted = 0; weighted < 2; weighted++) {
            make_set(set);
            brio_context *ctx = new_context();
            trial_options o = strategy(BRIO_LOCATION_HISTORY);
            brio_inserter *ins = insertion_begin(ctx, points, weighted ? weights : NULL, N, &o);
            const brio_store *s = ins->store;
            for (uint32_t end = 4, begin = 0; end < N; begin = end, end += 120) {
                insert_records(ins, begin, end);
                for (uint32_t p = end; p < N; p += 23) {
                    bool vertex = false;
                    for (uint32_t v = 0; v < end; v++) vertex |= brio_same_position(s->record[v], s->record[p]);
                    if (!vertex) expect_searches_right(ins, ins->location, s->record[p]);
                }
            }
            insertion_end(ins);
            EXPECT(brio_context_memory(ctx) == 0);
            brio_context_free(ctx);
        }
    }
}

/* Whether the open segment v w crosses the open triangle. */
static bool crosses(const double *v, const double *w, const double *const *triangle) {
    const double *a = triangle[0], *b = triangle[1], *c = triangle[2];
    if (brio_orient3d(a, b, c, v) * brio_orient3d(a, b, c, w) >= 0) return false;
    int x = brio_orient3d(v, w, a, b), y = brio_orient3d(v, w, b, c), z = brio_orient3d(v, w, c, a);
    return x != 0 && x == y && y == z;
}

/* Among lattice points segments run through vertices, along edges and in facets; some start or end outside. */
static void segments_lead_to_their_ends(void) {
    for (int set = 0; set < SETS; set++) {
        make_set(set);
        brio_context *ctx = new_context();
        trial_options o = strategy(BRIO_LOCATION_HISTORY);
        uint64_t entered = 0;
        brio_inserter *ins = insertion_begin(ctx, points, NULL, N, &o);
        const brio_store *s = ins->store;
        insert_records(ins, 0, 80);
        brio_rng rng = brio_rng_new((uint64_t)set);
        for (int i = 0; i < 1500; i++) {
            const double *u = s->record[brio_rng_below(&rng, N)], *w = s->record[brio_rng_below(&rng, N)];
            uint32_t from = brio_history_path(ins, ins->location, BRIO_HISTORY_ROOT, u);
            EXPECT(tetrahedron_holds(s, brio_locate_segment(ins, from, u, w, &entered), w), "set %d, segment %d", set,
                   i);
        }
        EXPECT(entered > 1500);
        insertion_end(ins);
        brio_context_free(ctx);
    }
}

/* Between points in general position inside of the hull. */
static void segments_enter_what_they_cross(void) {
    static double ends[6 * 100];
    brio_context *ctx = new_context();
    trial_options o = strategy(BRIO_LOCATION_HISTORY);
    uniform_points(1, N, points);
    uniform_points(2, 200, ends);
    brio_inserter *ins = insertion_begin(ctx, points, NULL, N, &o);
    const brio_store *s = ins->store;
    insert_records(ins, 0, N);
    for (int i = 0; i < 100; i++) {
        double u[4] = {0}, w[4] = {0};
        for (int c = 0; c < 3; c++) u[c] = 0.3 + 0.4 * ends[6 * i + c], w[c] = 0.3 + 0.4 * ends[6 * i + 3 + c];
        uint64_t entered = 0, crossed = 0;
        uint32_t from = brio_history_path(ins, ins->location, BRIO_HISTORY_ROOT, u);
        brio_locate_segment(ins, from, u, w, &entered);
        for (size_t f = 0; f < 4 * s->t.count; f++) {
            const uint32_t *v = s->t.tet[f / 4].vertex;
            if (s->state[f / 4] != TET_PLAIN || v[3] == s->t.infinite || *brio_mate(&s->t, (uint32_t)f) < f) continue;
            const double *triangle[3];
            for (size_t c = 0; c < 3; c++) triangle[c] = s->record[v[(f + 1 + c) % 4]];
            crossed += crosses(u, w, triangle);
        }
        EXPECT(entered == crossed, "segment %d enters %d, crosses %d", i, (int)entered, (int)crossed);
    }
    insertion_end(ins);
    brio_context_free(ctx);
}

/* --- tracing --- */

/* Inserts all points in their order, tracing the chain of points from `first` on; lists how many were in when something
 * was traced. */
static size_t list_tracings(uint32_t first, uint32_t tracings[8]) {
    brio_context *ctx = new_context();
    trial_options o = strategy(BRIO_LOCATION_TRACE);
    size_t count = 0;
    for (uint32_t i = first; i + 1 < N; i++) edges[2 * (i - first)] = i, edges[2 * (i - first) + 1] = i + 1;
    o.num_edges = N - 1 - first;
    uniform_points(1, N, points);
    brio_inserter *ins = insertion_begin(ctx, points, NULL, N, &o);
    const brio_store *s = ins->store;
    for (uint32_t p = (uint32_t)s->dimension + 1; p < N; p++) {
        uint64_t before = brio_trial_of(ins)->stats.trace_intersections;
        insert_records(ins, p, p + 1);
        if (brio_trial_of(ins)->stats.trace_intersections > before && count < 8) tracings[count++] = p;
    }
    insertion_end(ins);
    brio_context_free(ctx);
    return count;
}

static void edges_are_traced_when_so_many_points_are_in(void) {
    uint32_t tracings[8], expected[2] = {(uint32_t)ceil(N / log(N)), (uint32_t)ceil(N / log(log(N)))};
    EXPECT(list_tracings(0, tracings) == 2 && !memcmp(tracings, expected, sizeof expected));
    EXPECT(list_tracings(N - 50, tracings) == 2 && !memcmp(tracings, expected, sizeof expected), "none was a vertex");
}

/* The edges of the convex hull of points on a sphere: a surface of Delaunay triangles. */
static uint32_t *hull_edges(const double *p, size_t n, size_t *num_edges) {
    brio_context *ctx = new_context();
    brio_triangulation *t = NULL;
    EXPECT(brio_delaunay(ctx, p, NULL, n, NULL, &t) == BRIO_OK);
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t) + s->tetrahedra;
    uint32_t *edge = malloc(6 * s->hull_facets * sizeof *edge);
    *num_edges = 0;
    for (size_t i = 0; i < s->hull_facets; i++)
        for (int a = 0; a < 3; a++) {
            uint32_t u = tet[i].vertex[a], v = tet[i].vertex[(a + 1) % 3];
            if (u > v) continue; /* the facet beside it has it the other way round */
            edge[2 * *num_edges] = u, edge[2 * *num_edges + 1] = v;
            ++*num_edges;
        }
    brio_triangulation_free(t);
    brio_context_free(ctx);
    return edge;
}

/* Lemma 8 and theorem 11: what tracing crosses, and the history tests that are left, are O(1) a point, while those
 * from the root grow. */
static void tracing_is_linear_on_a_sphere(void) {
    enum { SIZES = 4, LEAST = 400 };
    double crossed[SIZES], tests[SIZES], from_root[SIZES];
    size_t n = LEAST, num_edges;
    for (int i = 0; i < SIZES; i++, n *= 3) {
        double *p = malloc(3 * n * sizeof *p);
        sphere_points(9, n, p);
        uint32_t *edge = hull_edges(p, n, &num_edges);
        trial_options o = {0};
        o.order = BRIO_ORDER_RANDOM, o.locate = BRIO_LOCATION_TRACE, o.edges = edge, o.num_edges = num_edges;
        result traced = run(p, NULL, n, &o);
        o.locate = BRIO_LOCATION_HISTORY;
        result plain = run(p, NULL, n, &o);
        EXPECT(traced.arrays == plain.arrays);
        crossed[i] = (double)traced.lab.trace_intersections / (double)n;
        tests[i] = (double)traced.lab.history_tests / (double)n;
        from_root[i] = (double)plain.lab.history_tests / (double)n;
        free(edge);
        free(p);
        EXPECT(crossed[i] < 1.2 * crossed[0] && crossed[i] > 1, "%zu points: %g crossed a point", n, crossed[i]);
    }
    EXPECT(tests[3] - tests[1] < 0.2 * (from_root[3] - from_root[1]), "%g tests, %g from the root", tests[3],
           from_root[3]);
}

/* --- hostile --- */

static void few_points_are_answered(void) {
    static const double shape[3][12] = {
        {0}, {0, 0, 0, 1, 0, 0, 2, 0, 0, 3, 0, 0}, {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}};
    for (size_t n = 0; n <= 12; n++)
        for (int kind = 0; kind < 4; kind++) {
            uniform_points(n, n, points);
            for (size_t i = 0; i < 3 * n && kind < 3; i++) points[i] = shape[kind][i % 12];
            uint32_t edge[4] = {0, (uint32_t)n / 2, 0, (uint32_t)n / 3};
            result expected = run(points, NULL, n, NULL);
            for (int s = 0; s < STRATEGIES; s++) {
                trial_options o = strategy(s);
                o.edges = edge, o.num_edges = n ? 2 : 0;
                EXPECT(run(points, NULL, n, &o).arrays == expected.arrays, "%zu points, strategy %d", n, s);
            }
        }
}

static void coincident_points_are_answered(void) {
    for (int weighted = 0; weighted < 2; weighted++) {
        make_set(0);
        for (size_t i = 8; i < N; i++) memcpy(points + 3 * i, points + 3 * (i % 8), 3 * sizeof *points);
        for (size_t i = 0; i < N; i++) weights[i] = (double)(i % 50 / 2) * 0.01;
        result expected = run(points, weighted ? weights : NULL, N, NULL);
        EXPECT(expected.stats.duplicates >= N - 8);
        for (int s = 0; s < STRATEGIES; s++) {
            trial_options o = strategy(s);
            o.order = BRIO_ORDER_INPUT;
            result r = run(points, weighted ? weights : NULL, N, &o);
            expect_same(&r, &expected, 0, s, BRIO_ORDER_INPUT);
        }
    }
}

/* Each point hides the ones before it, so that what stands for a hidden point is many steps away. */
static void chains_of_hidden_points_are_answered(void) {
    make_set(0);
    for (size_t i = 8; i < N; i++)
        for (size_t c = 0; c < 3; c++) points[3 * i + c] = 0.4 + 0.2 * points[3 * i + c];
    for (size_t i = 0; i < N; i++) weights[i] = i < 8 ? 0 : 1e-3 * (double)i;
    result expected = run(points, weights, N, NULL);
    EXPECT(expected.stats.hidden > N / 2, "%zu hidden", expected.stats.hidden);
    for (int s = 0; s < STRATEGIES; s++) {
        trial_options o = strategy(s);
        o.order = BRIO_ORDER_INPUT;
        result r = run(points, weights, N, &o);
        expect_same(&r, &expected, 0, s, BRIO_ORDER_INPUT);
    }
}

static brio_status status_of(brio_context *ctx, const trial_options *o) {
    brio_triangulation *t = NULL;
    brio_status status = trial_delaunay(ctx, points, NULL, N, o, &t, NULL);
    EXPECT((status == BRIO_OK) == (t != NULL));
    brio_triangulation_free(t);
    EXPECT(brio_context_memory(ctx) == 0);
    return status;
}

static void wrong_options_are_refused(void) {
    brio_context *ctx = new_context();
    make_set(0);
    trial_options o = strategy(BRIO_LOCATION_TRACE);
    edges[2 * EDGES - 1] = N;
    EXPECT(status_of(ctx, &o) == BRIO_ERR_ARGUMENT && strstr(brio_message(ctx), "edge 799 ends at point 400 of 400"),
           "%s", brio_message(ctx));
    o.num_edges--;
    EXPECT(status_of(ctx, &o) == BRIO_OK);
    o.edges = NULL;
    EXPECT(status_of(ctx, &o) == BRIO_ERR_ARGUMENT);
    o.num_edges = 0;
    EXPECT(status_of(ctx, &o) == BRIO_OK);
    o.locate = BRIO_LOCATION_END;
    EXPECT(status_of(ctx, &o) == BRIO_ERR_ARGUMENT && strstr(brio_message(ctx), "location strategy 6"), "%s",
           brio_message(ctx));
    brio_context_free(ctx);
}

static int cancel_at(const char *stage, double fraction, void *user) {
    return !strcmp(stage, "insert") && fraction >= *(double *)user;
}

static void cancelled_strategies_free_everything(void) {
    enum { MANY = BRIEF_TESTS ? 8000 : 20000 };
    double *many = malloc(3 * MANY * sizeof *many);
    uniform_points(3, MANY, many);
    make_edges(N);
    for (int s = 1; s < STRATEGIES; s++)
        for (double fraction = 0; fraction < 0.5; fraction += 0.4) {
            brio_context *ctx = new_context();
            brio_triangulation *t;
            trial_options o = strategy(s);
            brio_context_set_progress(ctx, cancel_at, &fraction);
            EXPECT(trial_delaunay(ctx, many, NULL, MANY, &o, &t, NULL) == BRIO_ERR_CANCELLED && !t, "strategy %d", s);
            EXPECT(brio_context_memory(ctx) == 0);
            brio_context_free(ctx);
        }
    free(many);
}

static void few_tetrahedra_allowed_is_a_status(void) {
    make_set(0);
    for (int s = 0; s < STRATEGIES; s++) {
        brio_context *ctx = new_context();
        trial_options o = strategy(s);
        o.max_tetrahedra = 1000;
        EXPECT(status_of(ctx, &o) == BRIO_ERR_TOO_LARGE);
        brio_context_free(ctx);
    }
}

static int failing_strategy;

static brio_status triangulate(brio_context *ctx) {
    trial_options o = strategy(failing_strategy);
    brio_triangulation *t;
    brio_status status = trial_delaunay(ctx, points, weights, N, &o, &t, NULL);
    brio_triangulation_free(t);
    return status;
}

static void failed_allocations_free_everything(void) {
    make_set(6);
    for (failing_strategy = 1; failing_strategy < STRATEGIES; failing_strategy++) expect_clean_failures(triangulate);
}

SUITE(test_location) {
    RUN(every_strategy_in_every_order_gives_one_triangulation);
    RUN(strategies_count_what_they_do);
    RUN(walks_are_short);
    RUN(history_tests_grow_as_the_logarithm);
    RUN(history_tests_of_sorted_points_are_many);
    RUN(traced_pairs_save_their_history_tests);
    RUN(a_search_ends_at_the_first_live_conflict);
    RUN(history_searches_find_what_brute_force_finds);
    RUN(segments_lead_to_their_ends);
    RUN(segments_enter_what_they_cross);
    RUN(edges_are_traced_when_so_many_points_are_in);
    RUN(tracing_is_linear_on_a_sphere);
    RUN(few_points_are_answered);
    RUN(coincident_points_are_answered);
    RUN(chains_of_hidden_points_are_answered);
    RUN(wrong_options_are_refused);
    RUN(cancelled_strategies_free_everything);
    RUN(few_tetrahedra_allowed_is_a_status);
    RUN(failed_allocations_free_everything);
    return harness_end();
}
