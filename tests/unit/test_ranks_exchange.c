/* Exchanges of ranks that are threads: how the failure of one becomes that of all, and what its sentence says. */
#include "ranks/exchange.h"
#include "post_office.h"

/* What a rank does. */
typedef brio_status rank_work(brio_context *ctx, const brio_transport *t);

typedef struct {
    postman man;
    brio_thread thread;
    rank_work *work;
    int ranks;
    bool has_room;
    brio_status status;
    char sentence[512];
} member;

static void run_member(void *argument) {
    member *m = argument;
    brio_context *ctx = new_context();
    const brio_transport t = {.size = sizeof t,
                              .rank = m->man.rank,
                              .ranks = m->ranks,
                              .host = "here",
                              .user = &m->man,
                              .begin = post_begin,
                              .end = post_end,
                              .room = m->has_room ? m->man.room : NULL};
    m->status = m->work(ctx, &t);
    snprintf(m->sentence, sizeof m->sentence, "%s", m->status == BRIO_OK ? "" : brio_message(ctx));
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    for (int i = 0; i < m->ranks; i++) free(m->man.held[i]);
}

/* Runs ranks, which end with the same failure. */
static void ends_with(rank_work *work, brio_status status, const char *sentence) {
    static post office;
    static member members[3];
    office = (post){.ranks = 3};
    brio_mutex_new(&office.lock);
    brio_condition_new(&office.changed);
    for (int i = 0; i < 3; i++) {
        members[i] = (member){.man = {.post = &office, .rank = i}, .work = work, .ranks = 3, .has_room = true};
        EXPECT(brio_thread_start(&members[i].thread, run_member, &members[i], 1 << 20));
    }
    for (int i = 0; i < 3; i++) brio_thread_join(&members[i].thread);
    for (int i = 0; i < 3; i++)
        EXPECT(members[i].status == status && !strcmp(members[i].sentence, sentence), "rank %d: %s", i,
               members[i].sentence);
    brio_condition_free(&office.changed);
    brio_mutex_free(&office.lock);
}

static brio_status fails_on(brio_context *ctx, const brio_transport *t, int rank) {
    return t->rank == rank ? brio_fail(ctx, BRIO_ERR_NO_ANSWER, "no answer") : BRIO_OK;
}

/* --- one failure, two exchanges --- */

static brio_status agree_on(brio_context *ctx, const brio_transport *t, brio_status status) {
    brio_exchange x;
    EXPECT(brio_exchange_new(ctx, t, &x) == BRIO_OK);
    status = brio_exchange_agree(&x, status);
    brio_exchange_free(&x);
    return status;
}

static brio_status agree_twice(brio_context *ctx, const brio_transport *t) {
    brio_status status = agree_on(ctx, t, fails_on(ctx, t, 1));
    return agree_on(ctx, t, t->rank == 0 ? status : BRIO_OK); /* rank 0 hands it on */
}

static brio_status agree_on_more(brio_context *ctx, const brio_transport *t) {
    brio_status status = agree_on(ctx, t, fails_on(ctx, t, 1));
    char sentence[512];
    snprintf(sentence, sizeof sentence, "a.ply: %s", brio_message(ctx));
    if (t->rank == 2) brio_fail(ctx, status, "%s", sentence);
    return agree_on(ctx, t, t->rank == 2 ? status : BRIO_OK);
}

/* Of two failures one after the other each has its own rank. */
static brio_status fail_anew(brio_context *ctx, const brio_transport *t) {
    agree_on(ctx, t, fails_on(ctx, t, 1));
    return agree_on(ctx, t, fails_on(ctx, t, 2));
}

/* A sentence that went through two layers named two ranks. */
static void a_sentence_names_one_rank(void) {
    ends_with(agree_twice, BRIO_ERR_NO_ANSWER, "rank 1 on here: no answer");
    ends_with(agree_on_more, BRIO_ERR_NO_ANSWER, "a.ply: rank 1 on here: no answer");
    ends_with(fail_anew, BRIO_ERR_NO_ANSWER, "rank 2 on here: no answer");
}

/* --- what all know already --- */

static brio_status say_something_else(brio_context *ctx, const brio_transport *t) {
    brio_exchange x;
    EXPECT(brio_exchange_new(ctx, t, &x) == BRIO_OK);
    brio_status status = fails_on(ctx, t, 2);
    if (status == BRIO_OK) {
        EXPECT(brio_exchange_now(&x, false) == BRIO_ERR_NO_ANSWER);
        if (t->rank == 0) status = brio_fail(ctx, BRIO_ERR_CANCELLED, "interrupted");
    }
    status = brio_exchange_agree(&x, status);
    brio_exchange_free(&x);
    return status;
}

/* Rank 0 returned the first failure, with a sentence about another one. */
static void a_failure_that_all_know_keeps_its_sentence(void) {
    ends_with(say_something_else, BRIO_ERR_NO_ANSWER, "rank 2 on here: no answer");
}

/* --- ranks that do not begin --- */

static brio_status refuse(brio_context *ctx, const brio_transport *t) {
    brio_status status = fails_on(ctx, t, 1);
    return status == BRIO_OK ? agree_on(ctx, t, BRIO_OK) : brio_exchange_refuse(ctx, t, status);
}

static brio_status refuse_on_two(brio_context *ctx, const brio_transport *t) {
    if (t->rank == 0) return agree_on(ctx, t, BRIO_OK);
    return brio_exchange_refuse(ctx, t, brio_fail(ctx, BRIO_ERR_NO_MEMORY, "out of memory"));
}

static brio_status refuse_and_fail(brio_context *ctx, const brio_transport *t) {
    if (t->rank == 2) return brio_exchange_refuse(ctx, t, brio_fail(ctx, BRIO_ERR_NO_MEMORY, "out of memory"));
    return agree_on(ctx, t, fails_on(ctx, t, 1));
}

static void a_rank_that_cannot_begin_ends_all(void) {
    ends_with(refuse, BRIO_ERR_NO_ANSWER, "rank 1 on here: no answer");
    ends_with(refuse_on_two, BRIO_ERR_NO_MEMORY, "rank 1 on here: out of memory");
    ends_with(refuse_and_fail, BRIO_ERR_NO_ANSWER, "rank 1 on here: no answer");
}

static int post_nothing(void *user, const brio_letter *letters) {
    (void)user, (void)letters;
    EXPECT(false, "an exchange without room");
    return 1;
}

static void without_room_nothing_is_said(void) {
    brio_context *ctx = new_context();
    const brio_transport t = {.size = sizeof t, .ranks = 2, .host = "here", .begin = post_nothing};
    EXPECT(brio_exchange_refuse(ctx, &t, brio_fail(ctx, BRIO_ERR_NO_MEMORY, "none")) == BRIO_ERR_NO_MEMORY);
    EXPECT(!strcmp(brio_message(ctx), "none"));
    brio_context_free(ctx);
}

static void transports_are_checked(void) {
    brio_context *ctx = new_context();
    brio_transport taken,
        t = {.size = sizeof t, .ranks = 2, .rank = 2, .host = "here", .begin = post_begin, .end = post_end};
    EXPECT(brio_exchange_take(ctx, &t, &taken) == BRIO_ERR_ARGUMENT);
    t.rank = 1, t.end = NULL;
    EXPECT(brio_exchange_take(ctx, &t, &taken) == BRIO_ERR_ARGUMENT);
    t.end = post_end, t.room = &t;
    t.size = offsetof(brio_transport, room); /* of a program that does not know it */
    EXPECT(brio_exchange_take(ctx, &t, &taken) == BRIO_OK && !taken.room && taken.rank == 1);
    brio_context_free(ctx);
}

/* --- transports that fail --- */

static int fail_at(void *user, brio_letter *received) {
    (void)received;
    return *(int *)user;
}

static int begin_well(void *user, const brio_letter *letters) {
    (void)user, (void)letters;
    return 0;
}

static void a_transport_says_why_it_failed(void) {
    static const struct {
        int code;
        brio_status status;
        const char *sentence;
    } WHY[] = {{BRIO_ERR_CANCELLED, BRIO_ERR_CANCELLED, "rank 0 on here: cancelled while it waited for other ranks"},
               {BRIO_ERR_NO_MEMORY, BRIO_ERR_NO_MEMORY, "rank 0 on here: no memory for what other ranks send"},
               {1, BRIO_ERR_OPEN, "rank 0 on here: the exchange with other ranks failed"}};
    for (int i = 0; i < 3; i++) {
        brio_context *ctx = new_context();
        brio_exchange x, other;
        int code = WHY[i].code;
        const brio_transport t = {
            .size = sizeof t, .ranks = 1, .host = "here", .user = &code, .begin = begin_well, .end = fail_at};
        EXPECT(brio_exchange_new(ctx, &t, &x) == BRIO_OK && brio_exchange_new(ctx, &t, &other) == BRIO_OK);
        EXPECT(brio_exchange_now(&x, false) == WHY[i].status && !strcmp(brio_message(ctx), WHY[i].sentence));
        brio_exchange_break(&other, WHY[i].status);
        code = 0; /* too late */
        for (int again = 0; again < 2; again++) {
            brio_fail(ctx, BRIO_ERR_NO_ANSWER, "something else");
            EXPECT(brio_exchange_agree(again ? &other : &x, BRIO_ERR_NO_ANSWER) == WHY[i].status);
            EXPECT(!strcmp(brio_message(ctx), WHY[i].sentence), "%s", brio_message(ctx));
            EXPECT(brio_exchange_agree(again ? &other : &x, BRIO_OK) == WHY[i].status, "it is broken for good");
        }
        brio_exchange_free(&x), brio_exchange_free(&other);
        brio_context_free(ctx);
    }
}

/* --- bytes --- */

static brio_status count_bytes(brio_context *ctx, const brio_transport *t) {
    static const uint64_t words[4] = {1, 2, 3, 4};
    brio_exchange x;
    EXPECT(brio_exchange_new(ctx, t, &x) == BRIO_OK);
    for (int i = 0; i < 3; i++) EXPECT(brio_exchange_put(&x, i, words, 8 * (size_t)(1 + t->rank)) == BRIO_OK);
    EXPECT(brio_exchange_now(&x, false) == BRIO_OK);
    EXPECT(x.bytes == 16 * (uint64_t)(1 + t->rank) && x.received_bytes == 48 - 8 * (uint64_t)(1 + t->rank));
    brio_exchange_free(&x);
    return BRIO_OK;
}

static void bytes_of_other_ranks_are_counted(void) {
    ends_with(count_bytes, BRIO_OK, "");
}

SUITE(test_ranks_exchange) {
    RUN(a_sentence_names_one_rank);
    RUN(a_failure_that_all_know_keeps_its_sentence);
    RUN(a_rank_that_cannot_begin_ends_all);
    RUN(without_room_nothing_is_said);
    RUN(transports_are_checked);
    RUN(a_transport_says_why_it_failed);
    RUN(bytes_of_other_ranks_are_counted);
    return harness_end();
}
