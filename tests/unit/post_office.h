/* A transport for ranks that are threads of a test, whose letters may come in any order; and memory of such a rank. */
#ifndef BRIO_TESTS_POST_OFFICE_H
#define BRIO_TESTS_POST_OFFICE_H

#include "brio/ranks.h"
#include "harness.h"
#include "platform/thread.h"
#include "points.h"

enum { MOST_RANKS = 8, BOXES = 4 };

typedef struct {
    uint8_t *bytes;
    uint64_t size, note;
    bool full;
} letter_box;

typedef struct {
    brio_mutex lock;
    brio_condition changed;
    int ranks;
    uint64_t seed;                                 /* of the order of letters; 0: that of ranks */
    letter_box box[BOXES][MOST_RANKS][MOST_RANKS]; /* by exchange, from, to */
} post;

typedef struct {
    post *post;
    int rank;
    uint64_t begun, ended;
    uint8_t *held[MOST_RANKS]; /* what the last end gave */
    brio_rng rng;
    uint64_t room[MOST_RANKS * BRIO_TRANSPORT_ROOM / 8]; /* of the transport */
} postman;

static inline int post_begin(void *user, const brio_letter *letters) {
    postman *m = user;
    post *p = m->post;
    brio_mutex_lock(&p->lock);
    for (int i = 0; i < p->ranks; i++) {
        letter_box *b = &p->box[m->begun % BOXES][m->rank][i];
        EXPECT(!b->full && letters[i].rank == i, "an exchange began too early");
        b->bytes = malloc(letters[i].size + 1);
        if (letters[i].size) memcpy(b->bytes, letters[i].bytes, letters[i].size);
        b->size = letters[i].size, b->note = letters[i].note, b->full = true;
    }
    m->begun++;
    EXPECT(m->begun - m->ended <= 2);
    brio_condition_wake_all(&p->changed);
    brio_mutex_unlock(&p->lock);
    return 0;
}

static inline int post_end(void *user, brio_letter *received) {
    postman *m = user;
    post *p = m->post;
    for (int i = 0; i < p->ranks; i++) {
        free(m->held[i]);
        m->held[i] = NULL;
    }
    brio_mutex_lock(&p->lock);
    for (int i = 0; i < p->ranks; i++) {
        letter_box *b = &p->box[m->ended % BOXES][i][m->rank];
        while (!b->full) brio_condition_wait(&p->changed, &p->lock);
        m->held[i] = b->bytes;
        received[i] = (brio_letter){.bytes = b->bytes, .size = b->size, .note = b->note, .rank = i};
        b->full = false;
    }
    m->ended++;
    brio_mutex_unlock(&p->lock);
    for (int i = p->ranks; p->seed && i > 1; i--) {
        uint32_t j = brio_rng_below(&m->rng, (uint32_t)i);
        brio_letter swap = received[i - 1];
        received[i - 1] = received[j], received[j] = swap;
    }
    return 0;
}

/* --- a rank's memory --- */

/* Allocations until one fails, that one included; 0: none does. Of one thread. */
typedef struct {
    size_t left;
    bool for_good; /* those after it fail, too */
    bool refused;  /* one has failed */
} ration;

static inline bool ration_gives(ration *r) {
    if (!r->left || --r->left) return true;
    r->left = r->for_good;
    r->refused = true;
    return false;
}

static inline void *ration_alloc(size_t size, void *user) {
    return ration_gives(user) ? malloc(size) : NULL;
}

static inline void *ration_realloc(void *block, size_t size, void *user) {
    return ration_gives(user) ? realloc(block, size) : NULL;
}

static inline void ration_free(void *block, void *user) {
    (void)user;
    free(block);
}

#endif
