/* Closed tasks that rank 0 shares, and minimum cuts whose parts are such tasks. Ranks are threads here. */
#include "post_office.h"
#include "ranks/tasks.h"
#include "ranks/work.h"

enum { MOST_TASKS = 400, FACETS = 4, MOST_NODES = 8000 };

/* What all ranks do: tasks that are squared, or the cut of a graph. */
typedef struct {
    int ranks;
    uint64_t seed;
    size_t tasks;
    int fails;         /* the rank on which a task fails, or -1 */
    bool refuses;      /* rank 0 does not take the answers */
    size_t allocation; /* of the rank `fails` that fails, counted from 1; 0: the task fails */
    const brio_cut_graph *graph;
    size_t size; /* nodes of a part */
} plan;

typedef struct {
    const plan *plan;
    postman man;
    brio_thread thread;
    brio_status status;
    char sentence[512];
    size_t allocations; /* until one fails; 0: none does */
    uint8_t taken[MOST_TASKS];
    uint8_t *label;
    bool goes_on; /* exchanges worked after the tasks */
} member;

/* --- tasks that are squared --- */

typedef struct {
    uint64_t number, rows, fails_on;
    uint64_t row[]; /* `rows` of them */
} square_task;

static size_t rows_of(size_t task) {
    return task % 7 == 3 ? 3000 : task % 5;
}

static size_t task_size(void *user, size_t task) {
    (void)user;
    return sizeof(square_task) + 8 * rows_of(task);
}

static brio_status write_task(void *user, size_t task, void *bytes) {
    const member *m = user;
    square_task *t = bytes;
    t->number = task, t->rows = rows_of(task);
    t->fails_on = m->plan->fails >= 0 && !m->plan->allocation ? task == m->plan->tasks / 2 : 0;
    for (size_t i = 0; i < t->rows; i++) t->row[i] = task + i;
    return BRIO_OK;
}

static size_t square_size(const void *task, size_t size) {
    EXPECT(size == sizeof(square_task) + 8 * ((const square_task *)task)->rows);
    return 8 + 8 * ((const square_task *)task)->rows;
}

static brio_status square(brio_context *ctx, const void *task, size_t size, void *answer) {
    const square_task *t = task;
    uint64_t *a = answer;
    (void)size;
    BRIO_EXPECT(ctx, !t->fails_on, BRIO_ERR_NO_ANSWER, "task %llu has no answer", (unsigned long long)t->number);
    a[0] = t->number;
    for (size_t i = 0; i < t->rows; i++) a[1 + i] = t->row[i] * t->row[i];
    return BRIO_OK;
}

static brio_status take_square(void *user, size_t task, const void *answer, size_t size) {
    member *m = user;
    const uint64_t *a = answer;
    EXPECT(a[0] == task && size == 8 + 8 * rows_of(task), "task %zu", task);
    for (size_t i = 0; i < rows_of(task); i++) EXPECT(a[1 + i] == (task + i) * (task + i));
    m->taken[task]++;
    return m->plan->refuses && task == m->plan->tasks / 2 ? BRIO_ERR_CANCELLED : BRIO_OK;
}

static const brio_task_kind SQUARES = {square_size, square};

/* --- a rank --- */

static bool gives(member *m) {
    return m->allocations == 0 || --m->allocations > 0;
}
static void *give(size_t size, void *user) {
    return gives(user) ? malloc(size) : NULL;
}
static void *give_more(void *block, size_t size, void *user) {
    return gives(user) ? realloc(block, size) : NULL;
}
static void take_back(void *block, void *user) {
    (void)user;
    free(block);
}

/* A cut is that of its parts, then that of what they left, and so on: rank 0 says whether there is another one. */
static brio_status say(brio_exchange *x, uint64_t another) {
    return brio_exchange_all(x, &another, sizeof another);
}

static brio_status lead_cut(void *user, brio_parts *p) {
    brio_exchange *x = user;
    brio_status status = say(x, 1);
    return status == BRIO_OK ? brio_ranks_lead_cut(x, p) : status;
}

static brio_status lead(member *m, brio_exchange *x) {
    const brio_part_decider by_ranks = {.decide = lead_cut, .user = x, .workers = (size_t)m->plan->ranks};
    brio_cut_graph g = *m->plan->graph;
    g.ctx = x->ctx;
    brio_status status = brio_cut_in_parts(&g, m->plan->size, &by_ranks, m->label);
    return status == BRIO_OK ? say(x, 0) : status;
}

static brio_status follow(brio_exchange *x) {
    for (;;) {
        brio_status status = brio_exchange_now(x, false);
        if (status != BRIO_OK || !*(const uint64_t *)x->from[0]->bytes) return status;
        status = brio_ranks_follow_cut(x);
        if (status != BRIO_OK) return status;
    }
}

static brio_status work_on(member *m, brio_exchange *x) {
    const brio_tasks tasks = {m->plan->tasks, task_size, write_task, take_square, m};
    if (m->plan->graph) return m->man.rank ? follow(x) : lead(m, x);
    return brio_tasks_share(x, m->man.rank ? NULL : &tasks, &SQUARES);
}

static void run_member(void *argument) {
    member *m = argument;
    const brio_allocator memory = {give, give_more, take_back, m};
    brio_exchange x;
    brio_context *ctx;
    const brio_transport t = {.size = sizeof t,
                              .rank = m->man.rank,
                              .ranks = m->plan->ranks,
                              .host = "here",
                              .user = &m->man,
                              .begin = post_begin,
                              .end = post_end};
    EXPECT(brio_context_new(&memory, &ctx) == BRIO_OK);
    brio_context_set_threads(ctx, 1 + m->man.rank % 3);
    EXPECT(brio_exchange_new(ctx, &t, &x) == BRIO_OK);
    m->allocations = m->plan->fails == m->man.rank ? m->plan->allocation : 0;
    m->status = brio_exchange_agree(&x, work_on(m, &x));
    m->allocations = 0;
    snprintf(m->sentence, sizeof m->sentence, "%s", m->status == BRIO_OK ? "" : brio_message(ctx));
    m->goes_on = brio_exchange_agree(&x, BRIO_OK) == BRIO_OK;
    brio_exchange_free(&x);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    for (int i = 0; i < m->plan->ranks; i++) free(m->man.held[i]);
}

/* Runs all ranks, which agree in what they return. Returns rank 0. */
static member run(const plan *p, uint8_t *label) {
    static post office;
    static member members[MOST_RANKS];
    office = (post){.ranks = p->ranks, .seed = p->seed};
    brio_mutex_new(&office.lock);
    brio_condition_new(&office.changed);
    for (int i = 0; i < p->ranks; i++) {
        members[i] = (member){.plan = p, .label = label};
        members[i].man = (postman){.post = &office, .rank = i, .rng = brio_rng_new(p->seed + (uint64_t)i)};
        EXPECT(brio_thread_start(&members[i].thread, run_member, &members[i], 1 << 21));
    }
    for (int i = 0; i < p->ranks; i++) brio_thread_join(&members[i].thread);
    for (int i = 0; i < p->ranks; i++)
        EXPECT(members[i].goes_on && members[i].status == members[0].status &&
                   !strcmp(members[i].sentence, members[0].sentence),
               "rank 0: %s; rank %d: %s", members[0].sentence, i, members[i].sentence);
    brio_condition_free(&office.changed);
    brio_mutex_free(&office.lock);
    return members[0];
}

/* --- tests of tasks --- */

static void each_task_is_answered_once(void) {
    static const size_t TASKS[] = {0, 1, 2, 5, 9, 40, MOST_TASKS};
    for (int i = 0; i < 7 * MOST_RANKS; i++) {
        plan p = {
            .ranks = 1 + i % MOST_RANKS, .seed = (uint64_t)(i % 2 * i), .tasks = TASKS[i / MOST_RANKS], .fails = -1};
        member m = run(&p, NULL);
        EXPECT(m.status == BRIO_OK, "%s", m.sentence);
        for (size_t t = 0; t < MOST_TASKS; t++) EXPECT(m.taken[t] == (t < p.tasks), "task %zu of %zu", t, p.tasks);
    }
}

static void a_task_that_fails_ends_all_and_they_go_on(void) {
    for (int i = 0; i < 16; i++) {
        plan p = {.ranks = 1 + i % MOST_RANKS, .seed = (uint64_t)i, .tasks = 100, .fails = 0};
        member m = run(&p, NULL);
        EXPECT(m.status == BRIO_ERR_NO_ANSWER && strstr(m.sentence, "task 50 has no answer"), "%s", m.sentence);
    }
}

static void rank_0_ends_all(void) {
    for (int i = 0; i < 16; i++) {
        plan p = {.ranks = 1 + i % MOST_RANKS, .seed = (uint64_t)i, .tasks = 100, .fails = -1, .refuses = true};
        member m = run(&p, NULL);
        EXPECT(m.status == BRIO_ERR_CANCELLED, "%s", m.sentence);
    }
}

static void a_rank_without_memory_ends_all(void) {
    for (int rank = 0; rank < 3; rank++) {
        size_t failed = 0;
        plan p = {.ranks = 3, .seed = 5, .tasks = 60, .fails = rank};
        for (p.allocation = 1;; p.allocation++) {
            member m = run(&p, NULL);
            if (m.status == BRIO_OK) break;
            char words[32];
            snprintf(words, sizeof words, "rank %d on here: ", rank);
            EXPECT(m.status == BRIO_ERR_NO_MEMORY && !strncmp(m.sentence, words, strlen(words)), "%s", m.sentence);
            failed++;
        }
        EXPECT(failed > 1, "%zu", failed);
    }
}

/* --- tests of cuts --- */

typedef struct {
    size_t num_nodes;
    brio_triangulation *t;
    int32_t capacity[4 * MOST_NODES], terminal[MOST_NODES];
} tetrahedra;

static void read_nodes(const void *user, size_t begin, size_t end, uint32_t *mate, int32_t *capacity,
                       int32_t *terminal) {
    const tetrahedra *g = user;
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(g->t);
    for (size_t v = begin; v < end; v++) {
        for (int k = 0; k < FACETS; k++) {
            bool none = tet[v].mate[k] >= 4 * g->num_nodes;
            *mate++ = none ? BRIO_NO_MATE : tet[v].mate[k];
            *capacity++ = none ? 0 : g->capacity[4 * v + (size_t)k];
        }
        *terminal++ = g->terminal[v];
    }
}

static void make_graph(brio_context *ctx, uint64_t seed, tetrahedra *g) {
    enum { POINTS = 1000 };
    static double p[3 * POINTS];
    brio_rng rng = brio_rng_new(seed);
    uniform_points(seed, POINTS, p);
    EXPECT(brio_delaunay(ctx, p, NULL, POINTS, NULL, &g->t) == BRIO_OK);
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(g->t);
    g->num_nodes = brio_triangulation_stats(g->t)->tetrahedra;
    EXPECT(g->num_nodes <= MOST_NODES);
    for (uint32_t arc = 0; arc < 4 * g->num_nodes; arc++) {
        uint32_t mate = tet[arc / 4].mate[arc % 4];
        if (mate < 4 * g->num_nodes && mate >= arc)
            g->capacity[arc] = g->capacity[mate] = (int32_t)brio_rng_below(&rng, 1000);
    }
    for (size_t v = 0; v < g->num_nodes; v++) g->terminal[v] = (int32_t)brio_rng_below(&rng, 3000) - 1500;
}

static void cuts_by_ranks_are_those_of_one_process(void) {
    brio_context *ctx = new_context();
    tetrahedra *g = malloc(sizeof *g);
    uint8_t *one = malloc(MOST_NODES), *many = malloc(MOST_NODES);
    int32_t *residual = malloc(4 * MOST_NODES * sizeof *residual), *after = malloc(4 * MOST_NODES * sizeof *after);
    for (int i = 0; i < (SHORT_TESTS ? 16 : 80); i++) {
        make_graph(ctx, (uint64_t)i, g);
        brio_cut_graph graph = {.ctx = ctx, .num_nodes = g->num_nodes, .read = read_nodes, .user = g};
        plan p = {.ranks = 1 + i % MOST_RANKS, .seed = (uint64_t)(i % 3 * i), .fails = -1, .graph = &graph};
        p.size = 50 + 70 * (size_t)(i % 5);
        graph.residual = i % 2 ? residual : NULL;
        EXPECT(brio_cut_in_parts(&graph, p.size, NULL, one) == BRIO_OK);
        graph.residual = i % 2 ? after : NULL;
        member m = run(&p, many);
        EXPECT(m.status == BRIO_OK && !memcmp(one, many, g->num_nodes), "graph %d: %s", i, m.sentence);
        if (i % 2) EXPECT(!memcmp(residual, after, 4 * g->num_nodes * sizeof *after), "the flow of graph %d", i);
        brio_triangulation_free(g->t);
    }
    free(g), free(one), free(many), free(residual), free(after);
    brio_context_free(ctx);
}

static void a_rank_without_memory_ends_a_cut(void) {
    brio_context *ctx = new_context();
    tetrahedra *g = malloc(sizeof *g);
    uint8_t *label = malloc(MOST_NODES);
    make_graph(ctx, 1, g);
    brio_cut_graph graph = {.ctx = ctx, .num_nodes = g->num_nodes, .read = read_nodes, .user = g};
    for (int rank = 0; rank < 2; rank++) {
        size_t failed = 0;
        plan p = {.ranks = 2, .fails = rank, .graph = &graph, .size = 700};
        for (p.allocation = 1;; p.allocation += 1 + p.allocation / 8, failed++) {
            member m = run(&p, label);
            if (m.status == BRIO_OK) break;
            EXPECT(m.status == BRIO_ERR_NO_MEMORY, "%s", m.sentence);
        }
        EXPECT(failed > 5, "%zu", failed);
    }
    brio_triangulation_free(g->t);
    free(g), free(label);
    brio_context_free(ctx);
}

SUITE(test_ranks_cuts) {
    RUN(each_task_is_answered_once);
    RUN(a_task_that_fails_ends_all_and_they_go_on);
    RUN(rank_0_ends_all);
    RUN(a_rank_without_memory_ends_all);
    RUN(cuts_by_ranks_are_those_of_one_process);
    RUN(a_rank_without_memory_ends_a_cut);
    return harness_end();
}
