/* Closed tasks that rank 0 shares with all ranks: bytes go out, and bytes come back.
 *
 * All ranks take the same steps, as everywhere (exchange.h). Exchange k brings each rank some tasks of rank 0, and rank
 * 0 the answers to the tasks of exchange k - 2: so while a rank works on the tasks of one exchange, those of the next
 * are on their way. Answers are matched to tasks by number, so it makes no difference which rank has a task, nor
 * when its answer comes. */
#ifndef BRIO_RANKS_TASKS_H
#define BRIO_RANKS_TASKS_H

#include "ranks/exchange.h"

/** What rank 0 has done. Tasks are numbered from 0. */
typedef struct {
    size_t count;
    /** Returns the bytes of a task, a multiple of 8. */
    size_t (*size)(void *user, size_t task);
    /** Writes a task. */
    brio_status (*write)(void *user, size_t task, void *bytes);
    /** Takes the answer to a task; once for each, in any order. */
    brio_status (*take)(void *user, size_t task, const void *answer, size_t size);
    void *user;
} brio_tasks;

/** How a rank does a task. */
typedef struct {
    /** Returns the bytes of the answer to a task, a multiple of 8. */
    size_t (*answer_size)(const void *task, size_t size);
    /** Does a task. Threads call this together. */
    brio_status (*work)(brio_context *ctx, const void *task, size_t size, void *answer);
} brio_task_kind;

/** Has all ranks do tasks, each with its threads. Collective.
 *  tasks  NULL on other ranks than 0.
 *  Memory: of the tasks of two exchanges, at most 64 MiB or one task each, on rank 0; and of their answers.
 *  Returns BRIO_OK or a failure of this rank or of all, after which the caller calls brio_exchange_agree. */
brio_status brio_tasks_share(brio_exchange *x, const brio_tasks *tasks, const brio_task_kind *kind);

#endif
