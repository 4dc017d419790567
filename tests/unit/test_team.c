/* The team: loops that do every index once, barriers that order, and a host that refuses threads, forks, or calls from a
 * small stack. */
#define _GNU_SOURCE
#include "base/sanitizers.h"
#include "base/team.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include <pthread.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

static const int THREADS[] = {1, 2, 3, 8, 17, 64};
enum { NUM_THREADS = sizeof THREADS / sizeof *THREADS, MOST_INDICES = 5000 };

static brio_context *context_with(int threads) {
    brio_context *ctx = NULL;
    EXPECT(brio_context_new(NULL, &ctx) == BRIO_OK);
    brio_context_set_threads(ctx, threads);
    return ctx;
}

/* --- loops --- */

static void count_indices(void *user, size_t begin, size_t end, int thread) {
    uint8_t *done = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) done[i]++;
}

static bool all_are(const uint8_t *done, size_t n, int times) {
    for (size_t i = 0; i < n; i++)
        if (done[i] != times) return false;
    return true;
}

static void loops_do_every_index_once(void) {
    static uint8_t done[MOST_INDICES];
    const size_t sizes[] = {0, 1, 2, 16, 17, 63, MOST_INDICES};
    for (int k = 0; k < NUM_THREADS; k++) {
        brio_context *ctx = context_with(THREADS[k]);
        for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++) {
            int threads = brio_threads(ctx, sizes[s], 1);
            EXPECT(threads >= 1 && threads <= THREADS[k]);
            memset(done, 0, sizeof done);
            EXPECT(brio_for(ctx, threads, sizes[s], count_indices, done) == BRIO_OK);
            EXPECT(all_are(done, sizes[s], 1), "%zu indices in %d threads", sizes[s], threads);
            for (size_t chunk = 1; chunk <= 100; chunk *= 10)
                EXPECT(brio_for_chunks(ctx, threads, sizes[s], chunk, count_indices, done) == BRIO_OK);
            EXPECT(all_are(done, sizes[s], 4), "%zu indices in %d threads, in chunks", sizes[s], threads);
        }
        brio_context_free(ctx);
    }
}

static void small_work_starts_no_thread(void) {
    brio_context *ctx = context_with(8);
    EXPECT(brio_threads(ctx, 0, 1) == 1);
    EXPECT(brio_threads(ctx, 1999, 1000) == 1);
    EXPECT(brio_threads(ctx, 2000, 1000) == 2);
    EXPECT(brio_threads(ctx, 1 << 30, 1000) == 8);
    brio_context_free(ctx);
}

static void impossible_numbers_of_threads_are_bounded(void) {
    const int wishes[] = {100000, 60000, INT32_MAX, -5};
    static double points[3 * 3000];
    uniform_points(1, 3000, points);
    for (int i = 0; i < 4; i++) {
        brio_context *ctx = context_with(wishes[i]);
        brio_triangulation *t = NULL;
        EXPECT(brio_context_threads(ctx) >= 1 && brio_context_threads(ctx) <= 4096);
        EXPECT(brio_delaunay(ctx, points, NULL, 3000, NULL, &t) == BRIO_OK);
        brio_triangulation_free(t);
        brio_context_free(ctx);
    }
}

/* --- barriers --- */

enum { STEPS = BRIEF_TESTS ? 80 : 200, MOST_MEMBERS = 64 };

typedef struct {
    int step[MOST_MEMBERS];
    int wrong;
} steps;

/* Each member writes its step, and after the barrier sees the others at the same step or, past the next one, later. */
static void take_steps(void *user, const brio_member *m) {
    steps *s = user;
    for (int step = 1; step <= STEPS; step++) {
        s->step[m->thread] = step;
        brio_barrier(m);
        for (int i = 0; i < m->threads; i++)
            if (s->step[i] != step) __atomic_fetch_add(&s->wrong, 1, __ATOMIC_RELAXED);
        brio_barrier(m);
    }
}

static void barriers_order_what_members_write(void) {
    for (int k = 0; k < NUM_THREADS; k++) {
        brio_context *ctx = context_with(THREADS[k]);
        steps s = {.wrong = 0};
        for (int again = 0; again < 3; again++) brio_run(ctx, brio_threads(ctx, MOST_MEMBERS, 1), take_steps, &s);
        EXPECT(s.wrong == 0, "%d threads", THREADS[k]);
        brio_context_free(ctx);
    }
}

typedef struct {
    brio_context *ctx;
    size_t threads, calls;
} nested;

static void run_inside(void *user, const brio_member *m) {
    nested *n = user;
    static uint8_t done[MOST_MEMBERS][100];
    int threads = brio_threads(n->ctx, 100, 1);
    memset(done[m->thread], 0, 100);
    brio_status status = brio_for(n->ctx, threads, 100, count_indices, done[m->thread]);
    __atomic_fetch_add(&n->threads, (size_t)threads, __ATOMIC_RELAXED);
    __atomic_fetch_add(&n->calls, status == BRIO_OK && all_are(done[m->thread], 100, 1), __ATOMIC_RELAXED);
}

static void work_within_work_runs_alone(void) {
    nested n = {context_with(8), 0, 0};
    brio_run(n.ctx, brio_threads(n.ctx, 8, 1), run_inside, &n);
    EXPECT(n.threads == 8 && n.calls == 8);
    brio_context_free(n.ctx);
}

/* --- looks --- */

typedef struct {
    size_t looks, allowed;
    pthread_t caller;
    bool elsewhere; /* asked in another thread than the caller's */
} wish;

static int ask(const char *stage, double fraction, void *user) {
    wish *a = user;
    (void)stage, (void)fraction;
    a->elsewhere |= !pthread_equal(pthread_self(), a->caller);
    return a->looks++ >= a->allowed;
}

static void count_some(void *user, size_t begin, size_t end, int thread) {
    (void)thread;
    __atomic_fetch_add((size_t *)user, end - begin, __ATOMIC_RELAXED);
}

/* A loop of any length asks once for so much work, and ends where it is asked to. */
static void loops_look_and_stop(void) {
    enum { MANY = 100 * BRIO_LOOK_EVERY };
    for (int k = 0; k < NUM_THREADS; k++) {
        brio_context *ctx = context_with(THREADS[k]);
        int threads = brio_threads(ctx, MANY, 1);
        wish a = {0, SIZE_MAX, pthread_self(), false};
        size_t count = 0;
        brio_context_set_progress(ctx, ask, &a);
        EXPECT(brio_for(ctx, threads, MANY, count_some, &count) == BRIO_OK && count == MANY);
        EXPECT(a.looks + 1 >= 100u / (size_t)threads && !a.elsewhere, "%zu looks, %d threads", a.looks, threads);
        count = a.looks = a.allowed = 0;
        EXPECT(brio_for(ctx, threads, MANY, count_some, &count) == BRIO_ERR_CANCELLED);
        EXPECT(threads > 1 || count <= BRIO_LOOK_EVERY, "%zu", count);
        count = a.looks = a.allowed = 0;
        EXPECT(brio_for_chunks(ctx, threads, MANY, 64, count_some, &count) == (a.looks ? BRIO_ERR_CANCELLED : BRIO_OK));
        EXPECT(threads > 1 || count == 64, "%zu", count);
        brio_context_free(ctx);
    }
}

static void count_calls(void *user, size_t begin, size_t end, int thread) {
    (void)begin, (void)end, (void)thread;
    __atomic_fetch_add((size_t *)user, 1, __ATOMIC_RELAXED);
}

/* Bodies that read all data were called for each piece of their part: spacings and stars of a million samples took minutes. */
static void whole_parts_are_one_call_each(void) {
    for (int k = 0; k < NUM_THREADS; k++) {
        brio_context *ctx = context_with(THREADS[k]);
        int threads = brio_threads(ctx, 1 << 20, 1);
        wish a = {0, 0, pthread_self(), false};
        size_t calls = 0;
        EXPECT(brio_for_parts(ctx, threads, 1 << 20, count_calls, &calls) == BRIO_OK && calls == (size_t)threads, "%zu",
               calls);
        brio_context_set_progress(ctx, ask, &a);
        EXPECT(brio_for_parts(ctx, threads, 1 << 20, count_calls, &calls) == BRIO_ERR_CANCELLED && !a.elsewhere);
        brio_context_free(ctx);
    }
}

/* --- hosts --- */

enum { N = SHORT_TESTS ? 25000 : 60000 };
static double set[3 * N];

static brio_status checksum_of(brio_context *ctx, size_t n, uint64_t *sum) {
    brio_triangulation *t = NULL;
    brio_status status = brio_delaunay(ctx, set, NULL, n, NULL, &t);
    if (status == BRIO_OK) status = brio_triangulation_checksum(ctx, t, set, sum);
    brio_triangulation_free(t);
    return status;
}

/* Runs a host in a process of its own; its exit status, or -1 when a signal ended it. */
static int in_child(int (*host)(void *), void *user) {
    fflush(NULL);
    pid_t child = fork();
    if (child == 0) {
        alarm(120);
        _exit(host(user));
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

typedef struct {
    brio_context *ctx; /* that the parent has used, or NULL */
    uint64_t sum;
} child_job;

static int triangulate(void *user) {
    const child_job *job = user;
    brio_context *ctx = job->ctx ? job->ctx : context_with(2);
    uint64_t sum = 0;
    if (checksum_of(ctx, N, &sum) != BRIO_OK || sum != job->sum) return 1;
    brio_context_free(ctx);
    return 0;
}

/* A child has none of its parent's threads: waiting for them, it hung. */
static void child_after_fork_works(void) {
    if (BRIO_TSAN) {
        printf("skipped: threads of a child after fork, which the thread sanitizer does not allow\n");
        return;
    }
    child_job job = {context_with(2), 0};
    EXPECT(checksum_of(job.ctx, N, &job.sum) == BRIO_OK);
    EXPECT(in_child(triangulate, &job) == 0, "with the context of the parent");
    child_job other = {NULL, job.sum};
    EXPECT(in_child(triangulate, &other) == 0, "with a context of its own");
    uint64_t again = 0;
    EXPECT(checksum_of(job.ctx, N, &again) == BRIO_OK && again == job.sum, "the parent goes on");
    brio_context_free(job.ctx);
}

static size_t address_space(void) {
    unsigned long pages = 0;
    FILE *f = fopen("/proc/self/statm", "r");
    if (f) {
        if (fscanf(f, "%lu", &pages) != 1) pages = 0;
        fclose(f);
    }
    return pages * (size_t)sysconf(_SC_PAGESIZE);
}

/* No room for a single stack more, but for the work: the team is smaller. */
static int without_room_for_stacks(void *user) {
    brio_context *ctx = context_with(17);
    struct rlimit tight = {address_space() + (400 << 10), RLIM_INFINITY};
    if (setrlimit(RLIMIT_AS, &tight)) return 2;
    int threads = brio_threads(ctx, 100, 1);
    (void)user;
    return threads == 1 ? 0 : 1;
}

/* The whole work at many limits: done, or out of memory, and never the end of the process. */
static int with_little_address_space(void *user) {
    const size_t *room = user;
    struct rlimit tight = {address_space() + *room, RLIM_INFINITY};
    uint64_t sum;
    if (setrlimit(RLIMIT_AS, &tight)) return 2;
    brio_context *ctx = NULL;
    if (brio_context_new(NULL, &ctx) == BRIO_ERR_NO_MEMORY) return 0;
    brio_context_set_threads(ctx, 8);
    brio_status status = checksum_of(ctx, N, &sum);
    brio_context_free(ctx);
    return status == BRIO_OK || status == BRIO_ERR_NO_MEMORY ? 0 : 1;
}

static void refused_address_space_is_fewer_threads_or_a_status(void) {
    if (BRIO_ASAN || BRIO_TSAN || BRIO_MSAN) {
        printf("skipped: limits of the address space, which a sanitizer needs for itself\n");
        return;
    }
    EXPECT(in_child(without_room_for_stacks, NULL) == 0);
    for (size_t room = 0; room <= (size_t)48 << 20; room += (size_t)1 << (SHORT_TESTS ? 20 : 19))
        EXPECT(in_child(with_little_address_space, &room) == 0, "%zu bytes", room);
}

static int as_another_user(void *user) {
    struct rlimit alone = {1, 1};
    if (setrlimit(RLIMIT_NPROC, &alone) || setgid(54321) || setuid(54321)) return 2;
    return triangulate(user);
}

static void refused_threads_are_fewer_threads(void) {
    brio_context *ctx = context_with(1);
    child_job job = {NULL, 0};
    EXPECT(checksum_of(ctx, N, &job.sum) == BRIO_OK);
    brio_context_free(ctx);
    int status = in_child(as_another_user, &job);
    if (status == 2)
        printf("skipped: a limit of threads, which does not bind root, who alone may become another user\n");
    else
        EXPECT(status == 0);
}

static void *call_from_small_stack(void *user) {
    brio_context *ctx = context_with(2);
    brio_mesh *crust = NULL;
    uint64_t sum;
    (void)user;
    EXPECT(checksum_of(ctx, 5000, &sum) == BRIO_OK);
    EXPECT(make_crust(ctx, set, 5000, NULL, &crust, NULL, NULL) == BRIO_OK);
    brio_mesh_free(crust);
    brio_context_free(ctx);
    return NULL;
}

static void stack_of_64_kibibytes_is_enough(void) {
    pthread_attr_t attributes;
    pthread_t caller;
    if (BRIO_ASAN || BRIO_TSAN || BRIO_MSAN) {
        printf("skipped: small stacks, since frames are larger under a sanitizer\n");
        return;
    }
    sphere_points(3, 5000, set);
    pthread_attr_init(&attributes);
    EXPECT(pthread_attr_setstacksize(&attributes, 64 << 10) == 0);
    EXPECT(pthread_create(&caller, &attributes, call_from_small_stack, NULL) == 0);
    pthread_join(caller, NULL);
    pthread_attr_destroy(&attributes);
}

/* --- signals --- */

static void ask_mask(void *user, const brio_member *m) {
    int *wrong = user;
    sigset_t mask;
    if (m->thread == 0) return;
    bool asked = pthread_sigmask(SIG_SETMASK, NULL, &mask) == 0;
    if (!asked || sigismember(&mask, SIGBUS) || sigismember(&mask, SIGSEGV) || sigismember(&mask, SIGFPE))
        __atomic_fetch_add(&wrong[0], 1, __ATOMIC_RELAXED);
    if (!asked || !sigismember(&mask, SIGINT) || !sigismember(&mask, SIGTERM))
        __atomic_fetch_add(&wrong[1], 1, __ATOMIC_RELAXED);
}

/* A thread that blocks a signal of its own work ends the process where the host has a handler: a cut scratch file did. */
static void threads_block_signals_except_those_of_their_own_work(void) {
    brio_context *ctx = context_with(3);
    int wrong[2] = {0, 0}, threads = brio_threads(ctx, 100, 1);
    brio_run(ctx, threads, ask_mask, wrong);
    EXPECT(wrong[0] == 0 && wrong[1] == 0, "%d threads, %d and %d", threads, wrong[0], wrong[1]);
    brio_context_free(ctx);
}

SUITE(test_team) {
    uniform_points(1, N, set);
    RUN(refused_address_space_is_fewer_threads_or_a_status); /* first: stacks of threads that ended are kept */
    RUN(loops_do_every_index_once);
    RUN(threads_block_signals_except_those_of_their_own_work);
    RUN(small_work_starts_no_thread);
    RUN(impossible_numbers_of_threads_are_bounded);
    RUN(barriers_order_what_members_write);
    RUN(work_within_work_runs_alone);
    RUN(loops_look_and_stop);
    RUN(whole_parts_are_one_call_each);
    RUN(child_after_fork_works);
    RUN(refused_threads_are_fewer_threads);
    RUN(stack_of_64_kibibytes_is_enough);
    return harness_end();
}
