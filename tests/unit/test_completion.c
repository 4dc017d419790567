/* Completion: the tetrahedra at own points are those of the triangulation of the whole set, whatever points are own and
 * whatever the source adds beyond one point in conflict for each ball. */
#include "base/memory.h"
#include "completion/completion.h"
#include "harness.h"
#include "points.h"
#include "predicates/circumcentre.h"

enum { MOST = 400, MOST_TETS = 8 * MOST * 8 };

typedef enum { ONE_A_BALL, ALL_IN_CONFLICT, ALL_IN_BOXES, SOURCES } way; /* what the source adds */

typedef struct {
    brio_set_point point[MOST];
    size_t count;
    double points[3 * MOST], weights[MOST];
    bool weighted, stands[MOST]; /* stands: for its position */
    brio_ball_box box;
    way way;
    uint64_t balls;
} whole;

typedef struct {
    uint64_t v[4];
} named_tet;

typedef struct {
    named_tet tet[MOST_TETS];
    size_t count;
    const brio_set_point *points; /* of the whole */
    bool wrong;
} collected;

static whole set;
static collected ours, theirs;

static void set_up(brio_rng *rng, size_t n, int kind, bool weighted) {
    set = (whole){.count = n, .weighted = weighted};
    uint64_t seed = brio_rng_next(rng);
    switch (kind) {
    case 0:
        uniform_points(seed, n, set.points);
        break;
    case 1:
        integer_points(seed, n, 5, set.points);
        break;
    case 2:
        clustered_points(seed, n, set.points);
        break;
    case 3:
        sphere_points(seed, n, set.points);
        break;
    case 4: /* most points in a plane, most of these on a line */
        integer_points(seed, n, 40, set.points);
        for (size_t i = 7; i < n; i++) set.points[3 * i] = 3, set.points[3 * i + 1] = i % 3 ? 5 : set.points[3 * i + 1];
        break;
    default:
        integer_points(seed, n, 2, set.points);
        break;
    }
    if (weighted) integer_weights(seed, n, kind == 1 ? 6 : 2, set.weights);
    for (int k = 0; k < 3; k++) set.box.low[k] = INFINITY, set.box.high[k] = -INFINITY;
    for (size_t i = 0; i < n; i++) {
        double *r = set.point[i].record;
        for (int k = 0; k < 3; k++) {
            r[k] = set.points[3 * i + (size_t)k];
            set.box.low[k] = fmin(set.box.low[k], r[k]);
            set.box.high[k] = fmax(set.box.high[k], r[k]);
        }
        r[3] = set.weights[i];
        set.box.weight = fmax(set.box.weight, r[3]);
        set.point[i].name = UINT64_C(1) << 40 | i;
    }
    for (size_t i = 0; i < n; i++) {
        set.stands[i] = true;
        for (size_t j = 0; j < n; j++) {
            const double *p = set.point[i].record, *q = set.point[j].record;
            if (brio_same_position(p, q) && (q[3] > p[3] || (q[3] == p[3] && j < i))) set.stands[i] = false;
        }
    }
}

static brio_filter filter_of_set(void) {
    brio_filter f;
    double extent[3];
    for (int k = 0; k < 3; k++) extent[k] = set.box.high[k] - set.box.low[k];
    brio_filter_set(&f, extent, set.box.weight, set.weighted);
    return f;
}

static brio_status conflicts(void *user, brio_ball *balls, size_t count, brio_found *found) {
    whole *w = user;
    brio_filter f = filter_of_set();
    w->balls += count;
    for (size_t b = 0; b < count; b++) {
        bool any = false;
        for (size_t i = 0; i < w->count; i++) {
            if (!w->stands[i]) continue;
            const double *r = w->point[i].record;
            brio_ball_box about = {{r[0], r[1], r[2]}, {r[0], r[1], r[2]}, r[3]};
            bool takes = brio_ball_takes(&f, &balls[b], r), meets = brio_ball_meets(&f, &balls[b], &about);
            EXPECT(meets || !takes, "a ball takes point %zu, which it does not meet", i);
            EXPECT(!takes || w->way == ALL_IN_BOXES || !brio_ball_inside(&balls[b], &about));
            if (w->way == ALL_IN_BOXES ? meets : takes && !(any && w->way == ONE_A_BALL))
                EXPECT(brio_found_add(found, &w->point[i]) == BRIO_OK);
            any |= takes;
        }
        if (w->way == ALL_IN_CONFLICT) balls[b].is_free = !any;
    }
    return BRIO_OK;
}

static int compare_names(const void *a, const void *b) {
    uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return x < y ? -1 : x > y;
}

static int compare_tets(const void *a, const void *b) {
    const named_tet *t = a, *u = b;
    for (int k = 0; k < 4; k++)
        if (t->v[k] != u->v[k]) return t->v[k] < u->v[k] ? -1 : 1;
    return 0;
}

static void add(collected *c, const named_tet *t) {
    if (c->count == MOST_TETS) {
        c->wrong = true;
        return;
    }
    c->tet[c->count] = *t;
    qsort(c->tet[c->count++].v, 4, sizeof *t->v, compare_names);
}

static brio_status collect(void *user, const brio_set_point *known, const uint32_t (*vertex)[4], size_t count) {
    for (size_t i = 0; i < count; i++) {
        named_tet t;
        for (int k = 0; k < 4; k++) t.v[k] = vertex[i][k] == BRIO_INFINITE ? UINT64_MAX : known[vertex[i][k]].name;
        if (vertex[i][3] != BRIO_INFINITE)
            EXPECT(brio_orient3d_exact(known[vertex[i][0]].record, known[vertex[i][1]].record,
                                       known[vertex[i][2]].record, known[vertex[i][3]].record) > 0);
        add(user, &t);
    }
    return BRIO_OK;
}

/* Collects the tetrahedra of the whole at own points. */
static void collect_whole(const brio_triangulation *t, const bool *own) {
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    theirs.count = 0;
    for (size_t i = 0; i < s->tetrahedra + s->hull_facets; i++) {
        const uint32_t *v = brio_triangulation_tetrahedra(t)[i].vertex;
        named_tet n;
        bool at_own = false;
        for (int k = 0; k < 4; k++) {
            n.v[k] = v[k] == BRIO_INFINITE ? UINT64_MAX : set.point[v[k]].name;
            at_own |= v[k] != BRIO_INFINITE && own[v[k]];
        }
        if (at_own) add(&theirs, &n);
    }
}

/* Chooses own points: each with some chance, or those in a box, whose interior is then the home. */
static void choose_own(brio_rng *rng, bool in_box, bool *own, brio_ball_box *home) {
    uint32_t share = 1 + brio_rng_below(rng, 9);
    *home = set.box;
    int k = (int)brio_rng_below(rng, 3);
    double cut = set.box.low[k] + brio_rng_double(rng) * (set.box.high[k] - set.box.low[k]);
    home->high[k] = cut;
    for (int i = 0; i < 3; i++) {
        home->low[i] = -INFINITY;
        if (i != k) home->high[i] = INFINITY;
    }
    for (size_t i = 0; i < set.count; i++)
        own[i] = in_box ? set.point[i].record[k] < cut : brio_rng_below(rng, 10) < share;
}

static bool spans_space(const brio_set_point *p) {
    return brio_orient3d_exact(p[0].record, p[1].record, p[2].record, p[3].record) != 0;
}

/* Puts own points first, then four that span space, and some others. */
static size_t list_points(brio_rng *rng, const bool *own, brio_set_point *list, size_t *num_own) {
    size_t n = 0;
    for (size_t i = 0; i < set.count; i++)
        if (own[i] && set.stands[i]) list[n++] = set.point[i];
    *num_own = n;
    for (size_t i = 0; i < set.count; i++)
        if (!own[i] && set.stands[i] && brio_rng_below(rng, 10) == 0) list[n++] = set.point[i];
    for (int attempt = 0; attempt < 10000; attempt++) {
        brio_set_point four[4];
        for (int i = 0; i < 4; i++) {
            uint32_t p;
            do p = brio_rng_below(rng, (uint32_t)set.count);
            while (!set.stands[p]);
            four[i] = set.point[p];
        }
        if (!spans_space(four)) continue;
        for (int i = 0; i < 4; i++) {
            bool there = false;
            for (size_t j = 0; j < n; j++) there |= list[j].name == four[i].name;
            if (!there) list[n++] = four[i];
        }
        break;
    }
    return n;
}

static void check_vertices(const brio_triangulation *t, const brio_set_point *list, size_t num_own,
                           const uint8_t *is_vertex, const brio_completion_stats *s) {
    const uint32_t *r = brio_triangulation_representatives(t);
    size_t vertices = 0;
    for (size_t i = 0; i < num_own; i++) {
        size_t p = list[i].name & UINT32_MAX;
        EXPECT(is_vertex[i] == (r[p] == p), "point %zu", p);
        vertices += is_vertex[i];
    }
    EXPECT(s->vertices == vertices && s->not_vertices == num_own - vertices);
}

static void complete_once(brio_rng *rng, int kind, bool weighted, way how) {
    static brio_set_point list[2 * MOST];
    static uint8_t is_vertex[MOST];
    static bool own[MOST];
    brio_context *ctx = new_context();
    brio_triangulation *t;
    brio_completion_stats s;
    brio_ball_box home;
    size_t num_own, n = 4 + brio_rng_below(rng, kind == 1 ? 120 : 60);
    bool in_box = brio_rng_below(rng, 2);
    brio_context_set_threads(ctx, 1);
    set_up(rng, n, kind, weighted);
    set.way = how;
    choose_own(rng, in_box, own, &home);
    home.weight = set.box.weight;
    EXPECT(brio_delaunay(ctx, set.points, weighted ? set.weights : NULL, n, NULL, &t) == BRIO_OK);
    collect_whole(t, own);
    size_t count = list_points(rng, own, list, &num_own);
    brio_completion_task task = {list,      num_own, count,   weighted, set.box, in_box ? &home : NULL,
                                 conflicts, &set,    collect, &ours,    false,   brio_rng_below(rng, 2)};
    ours.count = 0;
    EXPECT(brio_complete(ctx, &task, is_vertex, &s) == BRIO_OK, "%s", brio_message(ctx));
    qsort(ours.tet, ours.count, sizeof *ours.tet, compare_tets);
    qsort(theirs.tet, theirs.count, sizeof *theirs.tet, compare_tets);
    EXPECT(!ours.wrong && !theirs.wrong);
    if (brio_triangulation_stats(t)->dimension == 3 && num_own > 0) {
        EXPECT(ours.count == theirs.count && !memcmp(ours.tet, theirs.tet, ours.count * sizeof *ours.tet),
               "kind %d, weights %d, way %d: %zu tetrahedra at %zu own points of %zu, not %zu", kind, weighted,
               (int)how, ours.count, num_own, n, theirs.count);
        EXPECT(s.tetrahedra + s.infinite == ours.count && s.asked == set.balls && s.known == count + s.found);
        check_vertices(t, list, num_own, is_vertex, &s);
    } else {
        EXPECT(ours.count == 0);
    }
    brio_triangulation_free(t);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

static void stars_are_those_of_the_whole(void) {
    brio_rng rng = brio_rng_new(5);
    for (int i = 0; i < (BRIEF_TESTS ? 144 : SHORT_TESTS ? 480 : 6000); i++)
        complete_once(&rng, i % 6, i / 6 % 2, (way)(i / 12 % SOURCES));
}

/* --- many at once, whose answers come in any order --- */

enum { MANY = 4, PIECE = 3 };

typedef struct {
    brio_completion *c;
    brio_ball_box home;
    size_t first[MOST_TETS / PIECE], questions, num_pieces; /* of the round: where the pieces of questions begin */
    uint64_t trace;                                         /* of everything that was handed on, in its order */
    bool goes_on;
} member;

static uint64_t hash_of_tet(const brio_set_point *known, const uint32_t v[4]) {
    uint64_t hash = 0;
    for (int k = 0; k < 4; k++) hash = brio_mix(hash ^ (v[k] == BRIO_INFINITE ? 1 : known[v[k]].name));
    return hash;
}

static brio_status trace(void *user, const brio_set_point *known, const uint32_t (*vertex)[4], size_t count) {
    member *m = user;
    for (size_t i = 0; i < count; i++) m->trace = brio_mix(m->trace ^ hash_of_tet(known, vertex[i]));
    return collect(&ours, known, vertex, count);
}

static void begin_members(brio_context *ctx, brio_rng *rng, member *m) {
    static brio_set_point list[2 * MOST];
    for (int i = 0; i < MANY; i++) {
        bool own[MOST];
        size_t num_own, n;
        for (size_t p = 0; p < set.count; p++) own[p] = brio_mix(p) % MANY == (uint64_t)i;
        n = list_points(rng, own, list, &num_own);
        brio_completion_task task = {list, num_own, n,     set.weighted, set.box, NULL,
                                     NULL, NULL,    trace, &m[i],        false,   false};
        m[i] = (member){.goes_on = true};
        EXPECT(brio_completion_new(ctx, &task, &m[i].c) == BRIO_OK);
    }
}

/* Answers one piece of a member's questions. Now and then a point comes twice. */
static void answer(brio_context *ctx, member *m, brio_rng *rng, bool shuffled) {
    brio_ball ball[PIECE];
    brio_found found = {.ctx = ctx};
    size_t at = shuffled ? brio_rng_below(rng, (uint32_t)m->num_pieces) : 0, first = m->first[at];
    size_t n = m->questions - first < PIECE ? m->questions - first : PIECE;
    memmove(m->first + at, m->first + at + 1, (--m->num_pieces - at) * sizeof *m->first);
    EXPECT(brio_completion_balls(m->c, first, n, ball) == BRIO_OK);
    EXPECT(conflicts(&set, ball, n, &found) == BRIO_OK);
    for (size_t i = found.count; shuffled && i-- > 0;)
        EXPECT(brio_completion_take(m->c, found.point + i, found.count - i > 2 ? 2 : 1) == BRIO_OK);
    if (!shuffled) EXPECT(brio_completion_take(m->c, found.point, found.count) == BRIO_OK);
    for (size_t i = 0; i < n; i++)
        if (ball[i].is_free) brio_completion_is_free(m->c, first + i);
    brio_release(ctx, found.point);
}

static bool run_round(brio_context *ctx, member *m, brio_rng *rng, bool shuffled) {
    size_t left = 0, open = 0;
    for (int i = 0; i < MANY; i++) {
        m[i].num_pieces = m[i].questions = 0;
        if (m[i].goes_on) EXPECT(brio_completion_begin(m[i].c, &m[i].questions) == BRIO_OK);
        for (size_t q = 0; q < m[i].questions; q += PIECE) m[i].first[m[i].num_pieces++] = q;
        left += m[i].num_pieces;
    }
    for (uint32_t i = 0; left > 0; left--) {
        if (shuffled) i = brio_rng_below(rng, MANY);
        while (!m[i].num_pieces) i = (i + 1) % MANY;
        answer(ctx, &m[i], rng, shuffled);
    }
    for (int i = 0; i < MANY; i++) {
        if (m[i].goes_on) EXPECT(brio_completion_end(m[i].c, &m[i].goes_on) == BRIO_OK);
        open += m[i].goes_on;
    }
    return open > 0;
}

/* Completes all points in parts at once. Returns a hash of what was handed on. */
static uint64_t complete_many(brio_context *ctx, uint64_t seed, bool shuffled) {
    static member m[MANY];
    brio_rng lists = brio_rng_new(seed), order = brio_rng_new(seed + 1);
    uint64_t hash = 0;
    ours.count = 0;
    begin_members(ctx, &lists, m);
    while (run_round(ctx, m, &order, shuffled)) {}
    for (int i = 0; i < MANY; i++) {
        hash = brio_mix(hash ^ m[i].trace);
        brio_completion_delete(m[i].c);
    }
    return hash;
}

static void drop_equal(collected *c) {
    size_t n = 0;
    qsort(c->tet, c->count, sizeof *c->tet, compare_tets);
    for (size_t i = 0; i < c->count; i++)
        if (!n || compare_tets(&c->tet[n - 1], &c->tet[i])) c->tet[n++] = c->tet[i];
    c->count = n;
}

static void the_order_of_answers_has_no_trace(void) {
    brio_rng rng = brio_rng_new(9);
    bool own[MOST];
    memset(own, true, sizeof own);
    for (int i = 0; i < (BRIEF_TESTS ? 36 : SHORT_TESTS ? 120 : 2000); i++) {
        brio_context *ctx = new_context();
        brio_triangulation *t;
        brio_context_set_threads(ctx, 1);
        set_up(&rng, 20 + brio_rng_below(&rng, 40), i % 4, i / 4 % 2);
        set.way = (way)(i / 8 % SOURCES);
        uint64_t seed = brio_rng_next(&rng), expected = complete_many(ctx, seed, false);
        EXPECT(complete_many(ctx, seed, true) == expected, "set %d", i);
        EXPECT(brio_delaunay(ctx, set.points, set.weighted ? set.weights : NULL, set.count, NULL, &t) == BRIO_OK);
        collect_whole(t, own);
        drop_equal(&ours), drop_equal(&theirs);
        EXPECT(ours.count == theirs.count && !memcmp(ours.tet, theirs.tet, ours.count * sizeof *ours.tet), "set %d", i);
        brio_triangulation_free(t);
        EXPECT(brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
}

/* Writes which points of the set are the vertices of a ball, in ascending order. */
static void name_vertices(const brio_ball *b, uint32_t name[4]) {
    for (uint32_t k = 0; k < 4; k++) {
        uint32_t v = b->infinite && k == 3 ? BRIO_INFINITE : 0, at = k;
        while (v < set.count && memcmp(b->vertex[k], set.point[v].record, sizeof b->vertex[k]) != 0) v++;
        for (; at > 0 && name[at - 1] > v; at--) name[at] = name[at - 1];
        name[at] = v;
    }
}

/* What is asked of other machines, and in which order, must not depend on the threads that made the tetrahedra. Results do not:
 * without the order of questions all other tests pass. */
static void questions_come_in_the_order_of_their_vertices(void) {
    enum { COUNT = 200 };
    brio_rng rng = brio_rng_new(21);
    for (int weighted = 0; weighted < 2; weighted++) {
        brio_context *ctx = new_context();
        brio_completion *c = NULL;
        brio_ball ball;
        size_t questions = 0, wrong = 0;
        uint32_t before[4] = {0}, name[4] = {0};
        set_up(&rng, COUNT, 0, weighted != 0);
        brio_completion_task task = {set.point, COUNT, COUNT,   weighted != 0, set.box, NULL,
                                     NULL,      NULL,  collect, &ours,         false,   false};
        EXPECT(brio_completion_new(ctx, &task, &c) == BRIO_OK);
        EXPECT(brio_completion_begin(c, &questions) == BRIO_OK && questions > COUNT);
        for (size_t q = 0; q < questions; q++) {
            EXPECT(brio_completion_balls(c, q, 1, &ball) == BRIO_OK);
            name_vertices(&ball, name);
            int k = 0;
            while (k < 3 && name[k] == before[k]) k++;
            wrong += q > 0 && name[k] <= before[k];
            memcpy(before, name, sizeof before);
        }
        EXPECT(wrong == 0, "%zu of %zu questions, weighted %d", wrong, questions, weighted);
        brio_completion_delete(c);
        EXPECT(brio_context_memory(ctx) == 0);
        brio_context_free(ctx);
    }
}

/* Copies of a scan side by side have vertices that are in one plane up to rounding, and balls 10^15 times as large as all of them. A
 * comparison of squares said of no point that it was outside: each such ball compared every point exactly, and tiles took all points. */
static void huge_balls_meet_no_boxes_outside(void) {
    static const double POINTS[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 2, 0x1p-52}};
    static const uint32_t VERTEX[1][4] = {{0, 1, 2, 3}};
    brio_ball_box all = {{-1, -1, -1}, {2, 2, 2}, 0};
    brio_ball ball = {.infinite = false};
    brio_filter f;
    double error, extent[3] = {3, 3, 3};
    brio_filter_set(&f, extent, 0, false);
    for (int i = 0; i < 4; i++) memcpy(ball.vertex[i], POINTS[i], sizeof *POINTS);
    brio_centres(&(brio_centre_batch){*POINTS, NULL, VERTEX, 1}, ball.centre, &error);
    brio_ball_set_region(&ball, error, &all);
    EXPECT(ball.square > 0x1p100 && ball.centre[2] > 0);
    for (int i = 0; i < 30; i++) {
        double apart = ldexp(1, -i);
        brio_ball_box below = {{0, 0, -1}, {1, 1, -apart}, 0}, above = {{0, 0, apart}, {1, 1, 1}, 0};
        EXPECT(!brio_ball_meets(&f, &ball, &below) && brio_ball_meets(&f, &ball, &above), "2^-%d", i);
    }
}

static brio_status failing(void *user, brio_ball *balls, size_t count, brio_found *found) {
    (void)balls, (void)count;
    return brio_fail(found->ctx, BRIO_ERR_OPEN, "%s", (const char *)user);
}

static void an_error_of_the_source_ends_it(void) {
    brio_context *ctx = new_context();
    brio_completion_stats s;
    char text[] = "the source is gone";
    brio_rng rng = brio_rng_new(1);
    set_up(&rng, 50, 0, false);
    brio_completion_task task = {set.point, 20, 50, false, set.box, NULL, failing, text, collect, &ours, false, false};
    EXPECT(brio_complete(ctx, &task, NULL, &s) == BRIO_ERR_OPEN && !strcmp(brio_message(ctx), text));
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_completion) {
    RUN(stars_are_those_of_the_whole);
    RUN(the_order_of_answers_has_no_trace);
    RUN(questions_come_in_the_order_of_their_vertices);
    RUN(huge_balls_meet_no_boxes_outside);
    RUN(an_error_of_the_source_ends_it);
    return harness_end();
}
