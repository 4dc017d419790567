/* A team of threads, created when they are first needed, asleep between runs.
 *
 * A thread waits at a gate, a number that another thread changes. Each thread has a gate for the start of a run. The
 * barrier is a gate, too, and ends a run. A waiting thread reads the number for a few microseconds, then sleeps on a
 * condition variable, so that a waiting team costs nothing on a busy machine.
 *
 * I1  Member 0 writes `work`, `user` and the members before it changes the start gates; the other members read them
 *     after. The barrier at the end of a run orders these reads before the writes of the next run.
 * I2  After a fork, the child has a copy of the team without its threads. The child forgets them and creates new
 * ones. */
#include "base/team.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/sanitizers.h"
#include "base/stress.h"
#include "platform/pages.h"
#include <assert.h>
#include <string.h>

/* LOOKS: reads of a gate before sleeping, about 5 us together, which is less than waking a thread takes. LINE: bytes of
 * a cache line. */
enum { LOOKS = 256, LINE = 64 };
/* Bytes of a thread's stack; chosen. Stack frames are several times larger in sanitizer builds and without
 * optimization. */
#if BRIO_ASAN || BRIO_TSAN || BRIO_MSAN || !defined(__OPTIMIZE__)
static const size_t STACK = (size_t)4 << 20;
#else
static const size_t STACK = (size_t)512 << 10;
#endif

typedef struct {
    unsigned value;
    int sleepers;
    brio_mutex lock;
    brio_condition changed;
    char apart[LINE]; /* keeps what other threads write on another cache line */
} gate;

typedef struct {
    brio_team *team;
    brio_thread handle;
    brio_member member;
    gate start;
} thread;

struct brio_team {
    int size;       /* number of threads, the caller's included */
    long process;   /* the process of the threads */
    bool busy;      /* whether a run is going on */
    int processors; /* waiting threads read a gate before they sleep only if a run has at most as many members */
    brio_work_fn work;
    void *user;
    gate barrier;
    int arrived; /* members that have arrived at the barrier */
    thread thread[];
};

/* --- gates --- */

static void gate_new(gate *g) {
    g->value = 0;
    g->sleepers = 0;
    brio_mutex_new(&g->lock);
    brio_condition_new(&g->changed);
}

static void gate_free(gate *g) {
    brio_condition_free(&g->changed);
    brio_mutex_free(&g->lock);
}

/* Changes a gate and wakes who sleeps there. The stores and loads of `value` and `sleepers` here and in gate_sleep are
 * sequentially consistent: either the
 * sleeper sees the new value, or gate_change sees the sleeper. */
static void gate_change(gate *g) {
    brio_stress();
    __atomic_add_fetch(&g->value, 1, __ATOMIC_SEQ_CST);
    if (!__atomic_load_n(&g->sleepers, __ATOMIC_SEQ_CST)) return;
    brio_mutex_lock(&g->lock);
    brio_condition_wake_all(&g->changed);
    brio_mutex_unlock(&g->lock);
}

static void gate_sleep(gate *g, unsigned old) {
    brio_mutex_lock(&g->lock);
    __atomic_add_fetch(&g->sleepers, 1, __ATOMIC_SEQ_CST);
    while (__atomic_load_n(&g->value, __ATOMIC_SEQ_CST) == old) brio_condition_wait(&g->changed, &g->lock);
    __atomic_sub_fetch(&g->sleepers, 1, __ATOMIC_SEQ_CST);
    brio_mutex_unlock(&g->lock);
}

static inline void pause_briefly(void) {
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    __asm__ volatile("yield");
#endif
}

static void gate_wait(gate *g, unsigned old, bool looks) {
    brio_stress();
    for (int i = 0; looks && i < LOOKS; i++) {
        if (__atomic_load_n(&g->value, __ATOMIC_ACQUIRE) != old) return;
        pause_briefly();
    }
    gate_sleep(g, old);
}

/* --- the threads --- */

void brio_barrier(const brio_member *member) {
    brio_team *team = member->team;
    if (!team) return;
    int threads = member->threads; /* read before arriving: after the last arrival the next run may write it */
    bool looks = threads <= team->processors;
    assert(0 <= member->thread && member->thread < threads && threads <= team->size);
    unsigned old = __atomic_load_n(&team->barrier.value, __ATOMIC_ACQUIRE);
    assert(__atomic_load_n(&team->arrived, __ATOMIC_RELAXED) < threads); /* this member has not arrived yet */
    if (__atomic_add_fetch(&team->arrived, 1, __ATOMIC_ACQ_REL) == threads) {
        __atomic_store_n(&team->arrived, 0, __ATOMIC_RELAXED);
        gate_change(&team->barrier);
    } else {
        gate_wait(&team->barrier, old, looks);
    }
}

/* Does the work of each run until a run has none: the function of a thread. */
static void live(void *argument) {
    thread *self = argument;
    brio_team *team = self->team;
    brio_float_state state = brio_float_enter();
    bool looks = false;
    for (unsigned seen = 0;; seen++) {
        gate_wait(&self->start, seen, looks);
        if (!team->work) break;
        assert(self->member.team == team && team->thread + self->member.thread == self); /* I1 */
        looks = self->member.threads <= team->processors;
        assert(brio_float_is_standard());
        team->work(team->user, &self->member);
        brio_barrier(&self->member);
    }
    brio_float_leave(&state);
}

/* Creates one more thread. Returns whether the system created it. */
static bool grow(brio_team *team) {
    thread *t = &team->thread[team->size];
    assert(team->process == brio_process_number()); /* I2 */
    t->team = team;
    gate_new(&t->start);
    bool created = brio_thread_start(&t->handle, live, t, STACK);
    if (created)
        team->size++;
    else
        gate_free(&t->start);
    return created;
}

/* Resets the team in a child process, which has none of its parent's threads. */
static void forget_other_process(brio_team *team) {
    long process = brio_process_number();
    if (process == team->process) return;
    team->process = process;
    team->size = 1;
    team->arrived = 0;
    team->busy = false;
    gate_new(&team->barrier);
}

size_t brio_team_bytes(int most) {
    return sizeof(brio_team) + (size_t)most * sizeof(thread);
}

brio_team *brio_team_begin(void *memory, int most, int processors) {
    assert(most >= 1 && processors >= 1);
    brio_team *team = memory;
    memset(team, 0, brio_team_bytes(most));
    team->size = 1;
    team->process = brio_process_number();
    team->processors = processors;
    gate_new(&team->barrier);
    return team;
}

void brio_team_end(brio_team *team) {
    forget_other_process(team);
    assert(!team->busy);
    team->work = NULL;
    for (int i = 1; i < team->size; i++) gate_change(&team->thread[i].start);
    for (int i = 1; i < team->size; i++) {
        brio_thread_join(&team->thread[i].handle);
        gate_free(&team->thread[i].start);
    }
    gate_free(&team->barrier);
}

/* --- runs --- */

int brio_threads(brio_context *ctx, size_t n, size_t least) {
    brio_team *team = ctx->team;
    int most = brio_context_threads(ctx);
    if (brio_is_stressed()) least = 1;
    size_t useful = least ? n / least : n;
    int wanted = useful < (size_t)most ? (int)useful : most;
    if (wanted < 2 || team->busy) return 1;
    forget_other_process(team);
    while (team->size < wanted && grow(team)) {}
    assert(team->size >= 1);
    return wanted < team->size ? wanted : team->size;
}

void brio_run(brio_context *ctx, int threads, brio_work_fn work, void *user) {
    brio_team *team = ctx->team;
    assert(threads == 1 || (threads <= team->size && !team->busy)); /* threads is what brio_threads returned */
    if (threads > team->size) threads = team->size;
    if (threads < 2 || team->busy) {
        work(user, &(brio_member){NULL, 0, 1});
        return;
    }
    assert(__atomic_load_n(&team->arrived, __ATOMIC_RELAXED) == 0);
    team->busy = true;
    team->work = work;
    team->user = user;
    for (int i = 1; i < threads; i++) {
        team->thread[i].member = (brio_member){team, i, threads};
        gate_change(&team->thread[i].start);
    }
    brio_member caller = {team, 0, threads};
    work(user, &caller);
    brio_barrier(&caller);
    team->busy = false;
}

bool brio_may_look(const brio_context *ctx) {
    return !ctx->team->busy;
}

/* --- loops --- */

/* PIECE: most items of a part that are worked on between two looks: an item may take 50 us. Chosen. */
enum { PIECE = 1 << 11 };

typedef struct {
    brio_context *ctx;
    brio_part_fn body;
    void *user;
    size_t n, chunk, next;
    bool looks;         /* not within another run, whose member may be any thread */
    brio_status status; /* the first failure; atomic */
} loop;

/* Works on [begin, end), which counts as `work` items. Returns whether the loop goes on: not where the body itself
 * asked the callback, and was told to stop. */
static bool do_some(loop *l, size_t begin, size_t end, size_t work, const brio_member *m) {
    l->body(l->user, begin, end, m->thread);
    if (l->looks && m->thread == 0)
        brio_report(&l->status, l->ctx->stopped ? BRIO_ERR_CANCELLED : brio_look(l->ctx, work));
    return __atomic_load_n(&l->status, __ATOMIC_RELAXED) == BRIO_OK;
}

static void do_part(void *user, const brio_member *m) {
    loop *l = user;
    size_t begin = brio_part(l->n, m->thread, m->threads), end = brio_part(l->n, m->thread + 1, m->threads);
    assert(begin <= end && end <= l->n);
    for (size_t next; begin < end; begin = next) {
        next = end - begin > PIECE ? begin + PIECE : end;
        if (!do_some(l, begin, next, (next - begin) * (BRIO_LOOK_EVERY / PIECE), m)) return;
    }
}

static void do_whole_part(void *user, const brio_member *m) {
    loop *l = user;
    size_t begin = brio_part(l->n, m->thread, m->threads), end = brio_part(l->n, m->thread + 1, m->threads);
    if (begin < end) do_some(l, begin, end, BRIO_LOOK_EVERY, m);
}

/* Works on chunks until none is left. A chunk is as much work as is worth a look. */
static void do_chunks(void *user, const brio_member *m) {
    loop *l = user;
    bool more = true;
    while (more) {
        brio_stress();
        size_t begin = __atomic_fetch_add(&l->next, l->chunk, __ATOMIC_RELAXED);
        size_t end = begin < l->n && l->n - begin > l->chunk ? begin + l->chunk : l->n;
        more = begin < l->n && do_some(l, begin, end, BRIO_LOOK_EVERY, m);
    }
}

static brio_status run_loop(brio_context *ctx, int threads, brio_work_fn work, loop *l) {
    l->ctx = ctx;
    l->looks = brio_may_look(ctx);
    if (l->looks) ctx->stopped = false;
    brio_run(ctx, threads, work, l);
    return l->status;
}

brio_status brio_for(brio_context *ctx, int threads, size_t n, brio_part_fn body, void *user) {
    return run_loop(ctx, threads, do_part, &(loop){.body = body, .user = user, .n = n});
}

brio_status brio_for_parts(brio_context *ctx, int threads, size_t n, brio_part_fn body, void *user) {
    return run_loop(ctx, threads, do_whole_part, &(loop){.body = body, .user = user, .n = n});
}

brio_status brio_for_chunks(brio_context *ctx, int threads, size_t n, size_t chunk, brio_part_fn body, void *user) {
    assert(chunk > 0 || n == 0);
    return run_loop(ctx, threads, do_chunks, &(loop){.body = body, .user = user, .n = n, .chunk = chunk});
}

/* --- loops along arrays --- */

/* Rows that are asked for at once, a stretch: STRETCH_BYTES of the widest array, as far as the bounds allow. AHEAD: so
 * many stretches before they are reached. LEAST: bytes of less, and more than one in SHARE bytes of the memory, are
 * left to page faults: pages that are being read cannot be given to others. Chosen, but LEAST_STRETCH is that of a
 * piece of brio_for. */
enum { STRETCH_BYTES = 1 << 18, LEAST_STRETCH = 1 << 11, MOST_STRETCH = BRIO_SWEEP_STRETCH };
enum { AHEAD = 2, LEAST = 1 << 14, SHARE = 64 };

void brio_expect_rows(const brio_context *ctx, const brio_swept *swept, size_t begin, size_t end) {
    size_t most = brio_memory_limit(ctx) / SHARE;
    if (!ctx->scratch || begin >= end) return;
    for (size_t i = 0; swept[i].size > 0; i++) {
        if (!swept[i].rows) continue;
        uintptr_t from = (uintptr_t)swept[i].rows + begin * swept[i].size;
        size_t bytes = (end - begin) * swept[i].size, before = from % 4096;
        if (bytes >= LEAST && bytes <= most)
            brio_pages_advise((void *)(from - before), bytes + before, BRIO_PAGES_SOON);
    }
}

void brio_expect_next(const brio_context *ctx, size_t row, size_t n, const brio_swept *swept) {
    size_t from = row + AHEAD * BRIO_SWEEP_STRETCH, to = from + BRIO_SWEEP_STRETCH;
    brio_expect_rows(ctx, swept, from, to < n ? to : n);
}

brio_status brio_settle_rows(brio_context *ctx, const brio_swept *swept, size_t begin, size_t end) {
    size_t most = brio_memory_limit(ctx) / SHARE;
    if (!ctx->scratch || begin >= end) return BRIO_OK;
    for (size_t i = 0; swept[i].size > 0; i++) {
        size_t bytes = (end - begin) * swept[i].size;
        if (swept[i].rows && swept[i].written && bytes >= LEAST && bytes <= most)
            BRIO_FORWARD(brio_block_settle(ctx, swept[i].rows, begin * swept[i].size, bytes));
    }
    return BRIO_OK;
}

typedef struct {
    brio_context *ctx;
    brio_part_fn body;
    void *user;
    const brio_swept *swept;
    size_t n, stretch;
    brio_status status;
} sweep;

/* Works on a piece. Pieces ascend, and are shorter than a stretch. */
static void sweep_piece(void *user, size_t begin, size_t end, int member) {
    sweep *s = user;
    size_t next = (begin + s->stretch - 1) / s->stretch * s->stretch; /* the stretch that begins here, if any does */
    if (next < end) {
        size_t from = next + AHEAD * s->stretch, to = from + s->stretch;
        brio_expect_rows(s->ctx, s->swept, from, to < s->n ? to : s->n);
        if (next >= s->stretch) brio_report(&s->status, brio_settle_rows(s->ctx, s->swept, next - s->stretch, next));
    }
    s->body(s->user, begin, end, member);
}

brio_status brio_sweep_arrays(brio_context *ctx, int threads, size_t n, brio_part_fn body, void *user,
                              const brio_swept *swept) {
    sweep s = {ctx, body, user, swept, n, MOST_STRETCH, BRIO_OK};
    if (!ctx->scratch) return brio_for(ctx, threads, n, body, user);
    for (size_t i = 0; swept[i].size > 0; i++)
        while (s.stretch > LEAST_STRETCH && s.stretch * swept[i].size > STRETCH_BYTES) s.stretch /= 2;
    brio_expect_rows(ctx, swept, 0, n < AHEAD * s.stretch ? n : AHEAD * s.stretch);
    BRIO_FORWARD(brio_for(ctx, threads, n, sweep_piece, &s));
    return s.status;
}
