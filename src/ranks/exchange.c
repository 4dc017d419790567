/* Exchanges: see exchange.h.
 *
 * Based on: Hoefler, Siebert, Lumsdaine. Scalable communication protocols for dynamic sparse data exchange. PPoPP 2010.
 * Differs from the paper: every rank sends every rank a note, whose size is known; so the end needs no consensus. */
#include "ranks/exchange.h"
#include "base/memory.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { NOTE_ANY = 1, NOTE_FAILED = 2 };

/* The sentence of a failure, as it is sent. */
typedef struct {
    int64_t status;
    char sentence[600];
} last_words;

_Static_assert(sizeof(last_words) <= sizeof(((brio_exchange *)0)->last_words), "room for them");

brio_status brio_exchange_new(brio_context *ctx, const brio_transport *transport, brio_exchange *x) {
    size_t n = (size_t)transport->ranks;
    *x = (brio_exchange){.ctx = ctx, .transport = *transport};
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, x->parcel[0], n));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, x->parcel[1], n));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, x->out, n));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, x->received, n));
    return BRIO_ALLOC_ZERO(ctx, x->from, n);
}

void brio_exchange_free(brio_exchange *x) {
    if (!x->ctx) return;
    for (int k = 0; k < BRIO_MOST_UNDER_WAY; k++) {
        for (int i = 0; x->parcel[k] && i < x->transport.ranks; i++) brio_release(x->ctx, x->parcel[k][i].bytes);
        brio_release(x->ctx, x->parcel[k]);
    }
    brio_release(x->ctx, x->out);
    brio_release(x->ctx, x->received);
    brio_release(x->ctx, x->from);
}

brio_parcel *brio_exchange_parcel(brio_exchange *x, int rank) {
    return &x->parcel[x->begun % BRIO_MOST_UNDER_WAY][rank];
}

brio_status brio_exchange_room(brio_exchange *x, int rank, size_t size, void **room) {
    brio_parcel *p = brio_exchange_parcel(x, rank);
    assert(size % 8 == 0 && x->begun - x->ended < BRIO_MOST_UNDER_WAY);
    BRIO_FORWARD(BRIO_RESERVE(x->ctx, p->bytes, p->capacity, p->size + size));
    *room = p->bytes + p->size;
    p->size += size;
    return BRIO_OK;
}

brio_status brio_exchange_put(brio_exchange *x, int rank, const void *bytes, size_t size) {
    void *room;
    if (!size) return BRIO_OK;
    BRIO_FORWARD(brio_exchange_room(x, rank, size, &room));
    memcpy(room, bytes, size);
    return BRIO_OK;
}

/* --- one exchange --- */

static brio_status fail_transport(brio_exchange *x, int code) {
    x->failure = code == BRIO_ERR_NO_MEMORY ? BRIO_ERR_NO_MEMORY : BRIO_ERR_OPEN;
    x->broken = true;
    return brio_fail(x->ctx, x->failure, "rank %d on %s: %s", x->transport.rank, x->transport.host,
                     code == BRIO_ERR_NO_MEMORY ? "no memory for what other ranks send"
                                                : "the exchange with other ranks failed");
}

static brio_status begin(brio_exchange *x, uint64_t note) {
    for (int i = 0; i < x->transport.ranks; i++) {
        const brio_parcel *p = brio_exchange_parcel(x, i);
        x->out[i] = (brio_letter){.bytes = p->bytes, .size = p->size, .note = note, .rank = i};
        if (note & NOTE_FAILED) x->out[i].bytes = x->last_words, x->out[i].size = sizeof(last_words);
        if (i != x->transport.rank) x->bytes += x->out[i].size;
    }
    int failed = x->transport.begin(x->transport.user, x->out);
    if (failed) return fail_transport(x, failed);
    x->begun++;
    return BRIO_OK;
}

/* Ends the oldest exchange, and empties what was sent in it.   *failed  receives the message of a rank that failed. */
static brio_status end(brio_exchange *x, const brio_letter **failed) {
    double start = brio_seconds();
    int broken = x->transport.end(x->transport.user, x->received);
    if (broken) return fail_transport(x, broken);
    x->waited += brio_seconds() - start;
    for (int i = 0; i < x->transport.ranks; i++) x->parcel[x->ended % BRIO_MOST_UNDER_WAY][i].size = 0;
    x->ended++;
    x->any = false;
    *failed = NULL;
    for (int i = 0; i < x->transport.ranks; i++) x->from[x->received[i].rank] = &x->received[i];
    for (int i = x->transport.ranks; i-- > 0;) {
        x->any |= (x->from[i]->note & NOTE_ANY) != 0;
        if (x->from[i]->note & NOTE_FAILED) *failed = x->from[i];
    }
    return BRIO_OK;
}

/* --- failures --- */

static void adopt(brio_exchange *x, const brio_letter *failed) {
    last_words words;
    memcpy(&words, failed->bytes, sizeof words);
    x->failure = (brio_status)words.status;
    brio_fail(x->ctx, x->failure, "%s", words.sentence);
}

/* Begins and ends what other ranks wait for.   first  the exchange that has the sentence of a failure: the least number
 * that is known. */
static brio_status drain(brio_exchange *x, uint64_t first, bool mine) {
    const brio_letter *failed;
    while (x->ended < first + BRIO_MOST_UNDER_WAY) {
        for (int i = 0; i < x->transport.ranks && x->begun - x->ended < BRIO_MOST_UNDER_WAY; i++)
            brio_exchange_parcel(x, i)->size = 0;
        while (x->begun < first + BRIO_MOST_UNDER_WAY && x->begun - x->ended < BRIO_MOST_UNDER_WAY)
            BRIO_FORWARD(begin(x, mine && x->begun == first ? NOTE_FAILED : 0));
        uint64_t number = x->ended;
        BRIO_FORWARD(end(x, &failed));
        if (!failed || number > first || (x->failure != BRIO_OK && number == first)) continue;
        first = number;
        adopt(x, failed);
    }
    return x->failure;
}

/* Ends the run on all ranks because of a failure of this one. */
static brio_status fail(brio_exchange *x, brio_status status) {
    last_words words = {.status = status};
    snprintf(words.sentence, sizeof words.sentence, "rank %d on %s: %s", x->transport.rank, x->transport.host,
             brio_message(x->ctx));
    memcpy(x->last_words, &words, sizeof words);
    return drain(x, x->begun, true);
}

brio_status brio_exchange_agree(brio_exchange *x, brio_status status) {
    if (x->failure != BRIO_OK)
        status = x->failure; /* all know of it */
    else
        status = status == BRIO_OK ? brio_exchange_now(x, false) : fail(x, status);
    x->failed = status != BRIO_OK;
    if (!x->broken) x->failure = BRIO_OK;
    return status;
}

/* --- what callers see --- */

brio_status brio_exchange_begin(brio_exchange *x, bool any) {
    if (x->failure != BRIO_OK) return x->failure;
    return begin(x, any ? NOTE_ANY : 0);
}

brio_status brio_exchange_end(brio_exchange *x) {
    const brio_letter *failed;
    if (x->failure != BRIO_OK) return x->failure;
    BRIO_FORWARD(end(x, &failed));
    if (!failed) return BRIO_OK;
    adopt(x, failed);
    return drain(x, x->ended - 1, false);
}

brio_status brio_exchange_now(brio_exchange *x, bool any) {
    BRIO_FORWARD(brio_exchange_begin(x, any));
    return brio_exchange_end(x);
}

brio_status brio_exchange_all(brio_exchange *x, const void *bytes, size_t size) {
    for (int i = 0; i < x->transport.ranks; i++) BRIO_FORWARD(brio_exchange_put(x, i, bytes, size));
    return brio_exchange_now(x, false);
}
