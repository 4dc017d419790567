/* Closed tasks that rank 0 shares with all ranks: tasks.h. */
#include "ranks/tasks.h"
#include "base/memory.h"
#include "base/team.h"
#include <assert.h>
#include <string.h>

/* Bytes of the tasks of one exchange. Chosen. */
enum { MOST_BYTES = 1 << 26 };

/* What stands before the bytes of a task, and before those of an answer. */
typedef struct {
    uint64_t task, size, is_answer;
} head;

/* A task that came, and where its answer goes. */
typedef struct {
    const void *task;
    size_t size;
    void *answer;
} order;

typedef struct {
    brio_exchange *x;
    const brio_tasks *tasks; /* NULL on other ranks than 0 */
    const brio_task_kind *kind;
    size_t handed_out, answered;
    order *order; /* of the exchange that ended last */
    size_t num_orders, most_orders;
    brio_status settled;
} sharing;

/* --- out and back --- */

static brio_status put_task(sharing *s, int rank) {
    const brio_tasks *t = s->tasks;
    void *room;
    head h = {s->handed_out, t->size(t->user, s->handed_out), false};
    BRIO_FORWARD(brio_exchange_put(s->x, rank, &h, sizeof h));
    BRIO_FORWARD(brio_exchange_room(s->x, rank, h.size, &room));
    return t->write(t->user, s->handed_out++, room);
}

/* Deals tasks to the ranks in turn, and begins the exchange. */
static brio_status begin(sharing *s) {
    const brio_tasks *t = s->tasks;
    uint64_t bytes = 0;
    bool any = t && s->handed_out < t->count;
    int rank = 0; /* others first: they wait */
    while (t && s->handed_out < t->count && bytes < MOST_BYTES) {
        rank = (rank + 1) % s->x->transport.ranks;
        bytes += t->size(t->user, s->handed_out);
        BRIO_FORWARD(put_task(s, rank));
    }
    return brio_exchange_begin(s->x, any);
}

/* Takes what a rank sent: answers, and tasks, of which it makes a list. */
static brio_status read_letter(sharing *s, const brio_letter *m) {
    const uint8_t *at = m->bytes, *end = at + m->size;
    while (at < end) {
        head h;
        memcpy(&h, at, sizeof h);
        at += sizeof h;
        if (h.is_answer) {
            assert(s->tasks && s->answered < s->handed_out);
            s->answered++;
            BRIO_FORWARD(s->tasks->take(s->tasks->user, h.task, at, h.size));
        } else {
            BRIO_FORWARD(BRIO_RESERVE(s->x->ctx, s->order, s->most_orders, s->num_orders + 1));
            s->order[s->num_orders++] = (order){.task = at, .size = h.size};
        }
        at += h.size;
    }
    return BRIO_OK;
}

/* Ends the oldest exchange.   *any  receives whether it had tasks. */
static brio_status end(sharing *s, bool *any) {
    BRIO_FORWARD(brio_exchange_end(s->x));
    *any = s->x->any;
    s->num_orders = 0;
    for (int i = 0; i < s->x->transport.ranks; i++) BRIO_FORWARD(read_letter(s, &s->x->received[i]));
    return BRIO_OK;
}

/* --- work --- */

/* Makes room for all answers in what goes to rank 0 next. */
static brio_status make_room(sharing *s) {
    size_t all = 0;
    void *room;
    for (size_t i = 0; i < s->num_orders; i++)
        all += sizeof(head) + s->kind->answer_size(s->order[i].task, s->order[i].size);
    BRIO_FORWARD(brio_exchange_room(s->x, 0, all, &room));
    uint8_t *at = room;
    for (size_t i = 0; i < s->num_orders; i++) {
        order *o = &s->order[i];
        head h = *(const head *)((const uint8_t *)o->task - sizeof h);
        h.size = s->kind->answer_size(o->task, o->size);
        h.is_answer = true;
        memcpy(at, &h, sizeof h);
        o->answer = at + sizeof h;
        at += sizeof h + h.size;
    }
    return BRIO_OK;
}

static void work_some(void *user, size_t begin, size_t end, int thread) {
    sharing *s = user;
    (void)thread;
    for (size_t i = begin; i < end; i++)
        brio_report(&s->settled, s->kind->work(s->x->ctx, s->order[i].task, s->order[i].size, s->order[i].answer));
}

static brio_status work(sharing *s) {
    brio_context *ctx = s->x->ctx;
    if (!s->num_orders) return BRIO_OK;
    BRIO_FORWARD(make_room(s));
    BRIO_FORWARD(brio_for_chunks(ctx, brio_threads(ctx, s->num_orders, 1), s->num_orders, 1, work_some, s));
    return s->settled;
}

brio_status brio_tasks_share(brio_exchange *x, const brio_tasks *tasks, const brio_task_kind *kind) {
    sharing s = {.x = x, .tasks = tasks, .kind = kind};
    brio_status status = BRIO_OK;
    bool any = true;
    BRIO_TRY(begin(&s));
    while (any) {
        BRIO_TRY(begin(&s));
        BRIO_TRY(end(&s, &any));
        BRIO_TRY(work(&s));
    }
    BRIO_TRY(end(&s, &any)); /* the answers to the last tasks */
    assert(!tasks || s.answered == tasks->count);
done:
    brio_release(x->ctx, s.order);
    return status;
}
