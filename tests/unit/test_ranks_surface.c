/* Surfaces whose triangulations many ranks make, which are threads here: the bits of one process, whatever the number of
 * ranks and tiles and the order of messages. A failure of one rank is that of all. */
#include "base/memory.h"
#include "post_office.h"
#include "surface_points.h"

/* --- a run --- */

typedef struct {
    size_t n;
    int ranks;
    uint32_t tiles;
    uint64_t seed; /* of the messages' order, and of the surface */
    bool scratch;  /* the arrays of the surface are in files */
    int poor;      /* the rank whose memory ends, or -1 */
    size_t memory; /* that it has; 0: `ration` says what it gets */
    ration ration;
} plan;

typedef struct {
    const plan *plan;
    postman man;
    brio_thread thread;
    brio_status status;
    brio_mesh *mesh; /* of rank 0 */
    brio_context *ctx;
    ration ration;
    brio_team_facts facts;
    char sentence[512];
} member;

/* Reconstructs the surface on rank 0. */
static brio_status lead(member *m, const brio_transport *t, const brio_ranks_options *o) {
    const brio_surface_options options = {.size = sizeof options, .seed = m->plan->seed};
    brio_team_of_ranks *team;
    brio_status status = brio_ranks_lead(m->ctx, t, o, &team);
    if (status != BRIO_OK) return status;
    status = brio_surface(m->ctx, points, m->plan->n, &options, &m->mesh, NULL);
    m->facts = *brio_ranks_led(team);
    return brio_ranks_dismiss(team, status, NULL);
}

static void work(void *argument) {
    member *m = argument;
    const plan *p = m->plan;
    brio_transport t = {.size = sizeof t,
                        .rank = m->man.rank,
                        .ranks = p->ranks,
                        .host = "here",
                        .user = &m->man,
                        .begin = post_begin,
                        .end = post_end,
                        .room = m->man.room};
    brio_ranks_options o = {.size = sizeof o, .scratch = folder, .tiles = p->tiles};
    brio_context_set_threads(m->ctx, 1);
    if (p->scratch && m->man.rank == 0) EXPECT(brio_context_set_scratch(m->ctx, folder) == BRIO_OK);
    if (p->poor == m->man.rank) brio_context_set_memory_limit(m->ctx, p->memory), m->ration = p->ration;
    m->status = m->man.rank ? brio_ranks_serve(m->ctx, &t, &o) : lead(m, &t, &o);
    m->ration.left = 0;
    EXPECT((m->ctx->scratch != NULL) == (p->scratch && m->man.rank == 0)); /* as it was, after a failure too */
    snprintf(m->sentence, sizeof m->sentence, "%s", m->status == BRIO_OK ? "" : brio_message(m->ctx));
    for (int i = 0; i < p->ranks; i++) free(m->man.held[i]);
}

/* Whether the sentence of a failure names a rank once: the one that is poor, or else the leader. */
static bool names_one_rank(const plan *p, const member *m) {
    char name[32];
    snprintf(name, sizeof name, "rank %d on here: ", p->poor < 0 ? 0 : p->poor);
    return m->status == BRIO_OK || (!strncmp(m->sentence, name, strlen(name)) && !strstr(m->sentence + 1, "rank "));
}

/* Runs all ranks. Returns the first, whose mesh and context are the caller's; its ration is that of the poor rank. */
static member run_ranks(const plan *p) {
    static post office;
    static member members[MOST_RANKS];
    office = (post){.ranks = p->ranks, .seed = p->seed};
    brio_mutex_new(&office.lock);
    brio_condition_new(&office.changed);
    for (int i = 0; i < p->ranks; i++) {
        const brio_allocator memory = {ration_alloc, ration_realloc, ration_free, &members[i].ration};
        members[i] =
            (member){.plan = p, .man = {.post = &office, .rank = i, .rng = brio_rng_new(p->seed + (uint64_t)i)}};
        EXPECT(brio_context_new(p->ration.left ? &memory : NULL, &members[i].ctx) == BRIO_OK);
        EXPECT(brio_thread_start(&members[i].thread, work, &members[i], 1 << 21));
    }
    for (int i = 0; i < p->ranks; i++) brio_thread_join(&members[i].thread);
    EXPECT(names_one_rank(p, &members[0]), "rank %d: %s", p->poor, members[0].sentence);
    for (int i = 1; i < p->ranks; i++) {
        EXPECT(members[i].status == members[0].status && !strcmp(members[i].sentence, members[0].sentence),
               "rank 0: %s; rank %d: %s", members[0].sentence, i, members[i].sentence);
        EXPECT(brio_context_memory(members[i].ctx) == 0);
        brio_context_free(members[i].ctx);
    }
    brio_condition_free(&office.changed);
    brio_mutex_free(&office.lock);
    if (p->poor > 0) members[0].ration = members[p->poor].ration;
    return members[0];
}

static void drop(member *m) {
    brio_mesh_free(m->mesh);
    brio_context_free(m->ctx);
    EXPECT(files_left() == 0);
}

/* --- tests --- */

static brio_team_facts compare(const plan *p, int kind) {
    brio_context *ctx = new_context();
    brio_mesh *whole = NULL;
    const brio_surface_options options = {.size = sizeof options, .seed = p->seed};
    brio_status expected = brio_surface(ctx, points, p->n, &options, &whole, NULL);
    member m = run_ranks(p);
    EXPECT(m.status == expected, "kind %d, %d ranks, %zu points: %s", kind, p->ranks, p->n, m.sentence);
    if (expected != BRIO_OK) EXPECT(strstr(m.sentence, brio_message(ctx)), "%s / %s", m.sentence, brio_message(ctx));
    if (expected == BRIO_OK && m.status == BRIO_OK) {
        EXPECT(m.facts.triangulations > 0);
        EXPECT(whole->num_vertices == m.mesh->num_vertices && whole->num_faces == m.mesh->num_faces,
               "kind %d, %d ranks, %zu points", kind, p->ranks, p->n);
        if (whole->num_vertices == m.mesh->num_vertices && whole->num_faces == m.mesh->num_faces) {
            EXPECT(!memcmp(whole->vertices, m.mesh->vertices, 24 * whole->num_vertices));
            EXPECT(!memcmp(whole->face_vertices, m.mesh->face_vertices, 12 * whole->num_faces));
        }
    }
    drop(&m);
    brio_mesh_free(whole);
    brio_context_free(ctx);
    return m.facts;
}

static void surfaces_are_those_of_one_process(void) {
    static const int ranks[] = {1, 2, 3, 5, 8}, kinds[] = {2, 5, 6, 3, 4, 8};
    for (uint64_t trial = 0; trial < (uint64_t)(BRIEF_TESTS ? 12 : SHORT_TESTS ? 30 : 500); trial++) {
        brio_rng rng = brio_rng_new(trial);
        int kind = kinds[trial % 6];
        plan p = {.n = make_points(trial, 4 + brio_rng_below(&rng, trial % 4 ? 500 : 2500), kind),
                  .ranks = ranks[trial % 5],
                  .tiles = 1 + brio_rng_below(&rng, 3),
                  .seed = trial % 3 ? trial : 0,
                  .scratch = trial % 2,
                  .poor = -1};
        compare(&p, kind);
    }
}

/* A tile of 26,000 tetrahedra goes to rank 0 in two messages. */
static void large_tiles_come_in_pieces(void) {
    plan p = {.n = 4000, .ranks = 1, .tiles = 1, .poor = -1};
    uniform_points(8, 4000, points);
    compare(&p, -1);
}

/* Cuts of 27,000 tetrahedra are divided into parts for ranks: each of at least 4,096, so smaller sets have none. */
static void cuts_are_divided_among_ranks(void) {
    for (int trial = 0; trial < (SHORT_TESTS ? 2 : 6); trial++) {
        plan p = {.n = make_points(8, MOST, trial % 3), .ranks = 3 - trial % 2, .tiles = 1, .poor = -1};
        p.seed = (uint64_t)trial, p.scratch = trial % 2;
        uint64_t parts = compare(&p, trial % 3).parts;
        EXPECT(parts > 2, "trial %d: %llu parts", trial, (unsigned long long)parts);
    }
}

/* Whatever memory a rank has, all end alike, with its sentence or with the surface. */
static void a_rank_without_memory_ends_all(void) {
    size_t failed = 0, ended = 0;
    for (uint64_t trial = 0; trial < (uint64_t)(SHORT_TESTS ? 16 : 200); trial++) {
        plan p = {.n = make_points(3, 900, 2), .ranks = 3, .tiles = 2, .seed = trial, .poor = (int)(trial % 3)};
        p.memory = (size_t)20000 << trial % 13, p.scratch = trial % 2;
        member m = run_ranks(&p);
        EXPECT(m.status == BRIO_OK || m.status == BRIO_ERR_NO_MEMORY, "%s", m.sentence);
        EXPECT((m.status == BRIO_OK) == (m.mesh != NULL));
        failed += m.status != BRIO_OK, ended += m.status == BRIO_OK;
        drop(&m);
    }
    EXPECT(failed > 0 && ended > 0, "%zu failed, %zu did not", failed, ended);
}

/* A rank whose memory ended before it could say so let the others wait for ever. */
static void a_rank_without_any_memory_let_others_wait(void) {
    for (size_t memory = 50; memory < 7000; memory += SHORT_TESTS ? 300 : 50)
        for (int poor = 0; poor < 3; poor++) {
            plan p = {.n = make_points(3, 200, 2), .ranks = 3, .tiles = 2, .poor = poor, .memory = memory};
            member m = run_ranks(&p);
            EXPECT(m.status == BRIO_ERR_NO_MEMORY || m.status == BRIO_OK, "%zu bytes of rank %d: %s", memory, poor,
                   m.sentence);
            drop(&m);
        }
}

/* Every allocation of a rank fails, once or with all that come after it: counted, and then sampled. */
static void starve(plan *p) {
    for (p->poor = 0; p->poor < p->ranks; p->poor++) {
        bool refused = true;
        size_t n;
        for (n = 1; refused; n += 1 + n / (BRIEF_TESTS ? 4 : SHORT_TESTS ? 8 : 64)) {
            p->ration.left = n;
            member m = run_ranks(p);
            refused = m.ration.refused;
            EXPECT(m.status == (refused ? BRIO_ERR_NO_MEMORY : BRIO_OK), "allocation %zu of rank %d: %s", n, p->poor,
                   m.sentence);
            EXPECT((m.status == BRIO_OK) == (m.mesh != NULL));
            drop(&m);
        }
        EXPECT(n > 200, "%zu allocations of rank %d", n, p->poor);
    }
}

static void any_allocation_of_any_rank_ends_all(void) {
    for (int i = 0; i < 4; i += BRIEF_TESTS ? 3 : 1) {
        plan p = {.n = make_points(3, 150, 2), .ranks = 2 + i % 2, .tiles = 2, .seed = (uint64_t)i};
        p.ration.for_good = i / 2;
        starve(&p);
    }
}

/* Tiles of one process would take the place of the ranks. */
static void ranks_have_their_own_tiles(void) {
    brio_context *ctx = new_context();
    postman man = {0};
    post office = {.ranks = 1};
    brio_transport t = {
        .size = sizeof t, .ranks = 1, .host = "here", .user = &man, .begin = post_begin, .end = post_end};
    brio_ranks_options o = {.size = sizeof o, .scratch = folder};
    const brio_tiles_options tiles = {.size = sizeof tiles, .scratch = folder, .tiles = 2};
    const brio_surface_options options = {.size = sizeof options, .tiles = &tiles};
    brio_team_of_ranks *team;
    brio_mesh *mesh;
    man.post = &office;
    brio_mutex_new(&office.lock);
    brio_condition_new(&office.changed);
    EXPECT(brio_ranks_lead(ctx, &t, &o, &team) == BRIO_OK);
    EXPECT(brio_surface(ctx, points, make_points(3, 500, 2), &options, &mesh, NULL) == BRIO_ERR_ARGUMENT && !mesh);
    EXPECT(strstr(brio_message(ctx), "ranks triangulate for this surface"), "%s", brio_message(ctx));
    EXPECT(brio_ranks_dismiss(team, BRIO_OK, NULL) == BRIO_OK);
    /* there are no ranks any more */
    EXPECT(brio_surface(ctx, points, make_points(8, MOST, 0), &options, &mesh, NULL) == BRIO_OK);
    brio_mesh_free(mesh);
    free(man.held[0]);
    brio_condition_free(&office.changed);
    brio_mutex_free(&office.lock);
    brio_context_free(ctx);
}

static void the_failure_of_the_leader_ends_all(void) {
    plan p = {.n = make_points(3, 500, 2), .ranks = 4, .tiles = 1, .poor = -1};
    points[77] = NAN;
    member m = run_ranks(&p);
    EXPECT(m.status == BRIO_ERR_NOT_FINITE, "%s", m.sentence);
    drop(&m);
}

/* A transport of one rank, which fails after some calls, and is not called again. */
typedef struct {
    postman man;
    size_t calls; /* until it fails */
    bool failed;
} brittle;

static bool breaks(brittle *b) {
    EXPECT(!b->failed, "a transport that failed is called");
    b->failed = b->calls-- == 0;
    return b->failed;
}

static int begin_or_break(void *user, const brio_letter *letters) {
    brittle *b = user;
    return breaks(b) ? BRIO_ERR_CANCELLED : post_begin(&b->man, letters);
}

static int end_or_break(void *user, brio_letter *received) {
    brittle *b = user;
    return breaks(b) ? BRIO_ERR_CANCELLED : post_end(&b->man, received);
}

static void a_transport_that_breaks_anywhere_ends_the_leader(void) {
    size_t n = make_points(3, 150, 2), calls = 0;
    bool broken = true;
    for (; broken; calls += 1 + calls / 16) {
        static post office;
        office = (post){.ranks = 1};
        brittle b = {.man.post = &office, .calls = calls};
        plan p = {.n = n, .ranks = 1};
        member m = {.plan = &p, .ctx = new_context()};
        const brio_transport t = {
            .size = sizeof t, .ranks = 1, .host = "here", .user = &b, .begin = begin_or_break, .end = end_or_break};
        const brio_ranks_options o = {.size = sizeof o, .scratch = folder, .tiles = 2};
        brio_mutex_new(&office.lock);
        brio_condition_new(&office.changed);
        brio_status status = lead(&m, &t, &o);
        broken = b.failed;
        EXPECT(status == (broken ? BRIO_ERR_CANCELLED : BRIO_OK), "call %zu: %s", calls, brio_message(m.ctx));
        EXPECT(!broken || !strcmp(brio_message(m.ctx), "rank 0 on here: cancelled while it waited for other ranks"),
               "call %zu: %s", calls, brio_message(m.ctx));
        free(b.man.held[0]);
        for (int i = 0; i < BOXES; i++)
            if (office.box[i][0][0].full) free(office.box[i][0][0].bytes);
        brio_condition_free(&office.changed);
        brio_mutex_free(&office.lock);
        drop(&m);
    }
    EXPECT(calls > 40, "%zu", calls);
}

static void teams_have_neither_stars_nor_a_key(void) {
    brio_context *ctx = new_context();
    postman man = {0};
    brio_transport t = {
        .size = sizeof t, .ranks = 1, .host = "here", .user = &man, .begin = post_begin, .end = post_end};
    brio_ranks_options o = {.size = sizeof o, .scratch = folder, .key = 5};
    brio_team_of_ranks *team;
    EXPECT(brio_ranks_lead(ctx, &t, &o, &team) == BRIO_ERR_ARGUMENT && !team);
    EXPECT(brio_ranks_dismiss(NULL, BRIO_ERR_ARGUMENT, NULL) == BRIO_ERR_ARGUMENT);
    o.key = 0, o.stars = 1;
    EXPECT(brio_ranks_serve(ctx, &t, &o) == BRIO_ERR_ARGUMENT);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
}

SUITE(test_ranks_surface) {
    snprintf(folder, sizeof folder, "/tmp/brio-test-ranks-surface-%ld", (long)getpid());
    EXPECT(mkdir(folder, 0700) == 0);
    RUN(surfaces_are_those_of_one_process);
    RUN(large_tiles_come_in_pieces);
    RUN(cuts_are_divided_among_ranks);
    RUN(a_rank_without_memory_ends_all);
    RUN(a_rank_without_any_memory_let_others_wait);
    RUN(any_allocation_of_any_rank_ends_all);
    RUN(ranks_have_their_own_tiles);
    RUN(the_failure_of_the_leader_ends_all);
    RUN(a_transport_that_breaks_anywhere_ends_the_leader);
    RUN(teams_have_neither_stars_nor_a_key);
    rmdir(folder);
    return harness_end();
}
