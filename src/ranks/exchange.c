/* Exchanges: see exchange.h.
 *
 * Based on: Hoefler, Siebert, Lumsdaine. Scalable communication protocols for dynamic sparse data exchange. PPoPP 2010.
 * Differs from the paper: every rank sends every rank a note, whose size is known; so the end needs no consensus. */
#include "ranks/exchange.h"
#include "base/memory.h"
#include "base/versioned.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { NOTE_ANY = 1, NOTE_FAILED = 2, MOST_RANKS = 1 << 20 };

/* The sentence of a failure, as it is sent. */
typedef struct {
    int64_t status;
    char sentence[600];
} last_words;

_Static_assert(sizeof(last_words) <= sizeof(((brio_exchange *)0)->last_words), "room for them");

/* --- life --- */

brio_status brio_exchange_take(brio_context *ctx, const brio_transport *given, brio_transport *transport) {
    brio_transport t = {0};
    *transport = t;
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_transport, given, &t));
    BRIO_EXPECT(ctx,
                t.begin && t.end && t.host && t.ranks > 0 && t.ranks <= MOST_RANKS && t.rank >= 0 && t.rank < t.ranks,
                BRIO_ERR_ARGUMENT, "a transport of rank %d of %d", t.rank, t.ranks);
    *transport = t;
    return BRIO_OK;
}

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

/* What a rank needs of the transport's room to take part in an exchange, for each rank. */
typedef struct {
    brio_letter out, received;
    const brio_letter *from;
    brio_parcel parcel[BRIO_MOST_UNDER_WAY];
} little;

_Static_assert(sizeof(little) <= BRIO_TRANSPORT_ROOM, "room for it");

brio_status brio_exchange_refuse(brio_context *ctx, const brio_transport *transport, brio_status status) {
    size_t n = (size_t)transport->ranks;
    brio_exchange x = {.ctx = ctx, .transport = *transport};
    if (!transport->room) return status;
    memset(transport->room, 0, n * BRIO_TRANSPORT_ROOM);
    x.out = transport->room;
    x.received = x.out + n;
    x.parcel[0] = (brio_parcel *)(x.received + n);
    x.parcel[1] = x.parcel[0] + n;
    x.from = (const brio_letter **)(x.parcel[1] + n);
    return brio_exchange_agree(&x, status);
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

/* Notes the failure of a rank, and the sentence that names it. */
static brio_status note_failure(brio_exchange *x, brio_status status, const char *sentence) {
    x->failure = status;
    if (sentence != x->sentence) snprintf(x->sentence, sizeof x->sentence, "%s", sentence);
    brio_fail(x->ctx, status, "%s", x->sentence);
    snprintf(x->ctx->named, sizeof x->ctx->named, "%s", brio_message(x->ctx));
    return status;
}

/* Puts the name of this rank before a sentence. */
static void name_rank(const brio_exchange *x, const char *sentence, char named[600]) {
    snprintf(named, 600, "rank %d on %s: %s", x->transport.rank, x->transport.host, sentence);
}

static brio_status fail_transport(brio_exchange *x, int code) {
    char sentence[600];
    brio_status status = BRIO_ERR_OPEN;
    const char *what = "the exchange with other ranks failed";
    if (code == BRIO_ERR_NO_MEMORY) status = BRIO_ERR_NO_MEMORY, what = "no memory for what other ranks send";
    if (code == BRIO_ERR_CANCELLED) status = BRIO_ERR_CANCELLED, what = "cancelled while it waited for other ranks";
    x->broken = true;
    name_rank(x, what, sentence);
    return note_failure(x, status, sentence);
}

void brio_exchange_break(brio_exchange *x, brio_status status) {
    char sentence[600];
    x->broken = true;
    snprintf(sentence, sizeof sentence, "%s", brio_message(x->ctx));
    note_failure(x, status, sentence);
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
        if (i != x->transport.rank) x->received_bytes += x->from[i]->size;
        x->any |= (x->from[i]->note & NOTE_ANY) != 0;
        if (x->from[i]->note & NOTE_FAILED) *failed = x->from[i];
    }
    return BRIO_OK;
}

/* --- failures --- */

static void adopt(brio_exchange *x, const brio_letter *failed) {
    last_words words;
    memcpy(&words, failed->bytes, sizeof words);
    note_failure(x, (brio_status)words.status, words.sentence);
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
    const char *sentence = brio_message(x->ctx), *named = x->ctx->named;
    if (*named && strstr(sentence, named))
        snprintf(words.sentence, sizeof words.sentence, "%s", sentence);
    else
        name_rank(x, sentence, words.sentence);
    memcpy(x->last_words, &words, sizeof words);
    return drain(x, x->begun, true);
}

brio_status brio_exchange_agree(brio_exchange *x, brio_status status) {
    if (x->failure != BRIO_OK)
        status = note_failure(x, x->failure, x->sentence); /* all know of it; the context may say something else */
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
