/* Exchanges among ranks, and how the failure of one becomes that of all.
 *
 * All that ranks say to each other are exchanges of a transport (brio/ranks.h), numbered from 0 on each rank: the same
 * number is the same exchange. So no rank waits for something that another does not come to: no deadlock.
 *
 * A rank that fails puts its sentence into the next exchange that it begins, with the number f. Every rank ends f, for
 * at most two are under way, and none is begun beyond f + 1 before f has ended. On seeing the sentence each rank begins
 * f + 1, if it has not, and ends it: then nothing is under way anywhere, and all return the same status. If several
 * fail, the least number, and of it the least rank, has the sentence.
 *
 * The rank with the failure puts its name before the sentence, once: a sentence that names a rank already, because it
 * came from another one in an earlier exchange, stays as it is.
 *
 * So after brio_exchange_agree all ranks stand at the same number, and exchanges go on. Only a transport that failed
 * ends them for good. What a later call exchanges must then follow from what all ranks have alike: a rank may have
 * finished a step that another one failed in. */
#ifndef BRIO_RANKS_EXCHANGE_H
#define BRIO_RANKS_EXCHANGE_H

#include "base/context.h"
#include "brio/ranks.h"

enum { BRIO_MOST_UNDER_WAY = 2 };

/** Bytes on their way to one rank. */
typedef struct {
    uint8_t *bytes;
    size_t size, capacity;
} brio_parcel;

typedef struct {
    brio_context *ctx;
    brio_transport transport;
    brio_parcel *parcel[BRIO_MOST_UNDER_WAY]; /* to each rank, of the exchanges of even and of odd numbers */
    brio_letter *out, *received;              /* received: in the order in which the transport gave them */
    const brio_letter **from;                 /* the same by rank */
    uint64_t begun, ended;
    bool any;            /* a rank said so in the exchange that ended last */
    brio_status failure; /* of this call of a collective function; after `broken` of all */
    bool broken;         /* the transport failed */
    bool failed;         /* the last collective function did */
    char last_words[640];
    char sentence[600];             /* of `failure` */
    uint64_t bytes, received_bytes; /* sent to other ranks, and from them */
    double waited;
} brio_exchange;

/** Takes the caller's transport, and checks it.   transport  zero, without room, on failure. */
brio_status brio_exchange_take(brio_context *ctx, const brio_transport *given, brio_transport *transport);

/** Prepares exchanges. A rank where that fails calls brio_exchange_refuse. */
brio_status brio_exchange_new(brio_context *ctx, const brio_transport *transport, brio_exchange *x);
void brio_exchange_free(brio_exchange *x);

/** Ends on all ranks what this one cannot begin: the first exchange of all others. Takes no memory but the room of the
 *  transport; without room it does nothing, and others wait.
 *  status  a failure, whose sentence is in the context. Returns that of all ranks. */
brio_status brio_exchange_refuse(brio_context *ctx, const brio_transport *transport, brio_status status);

/** Ends exchanges for good: others over the same transport failed with it.   status  theirs. */
void brio_exchange_break(brio_exchange *x, brio_status status);

/** Appends bytes, a multiple of 8, to what goes to a rank in the next exchange. */
brio_status brio_exchange_put(brio_exchange *x, int rank, const void *bytes, size_t size);
/** Appends room for bytes.   *room  receives where, valid until more is appended. */
brio_status brio_exchange_room(brio_exchange *x, int rank, size_t size, void **room);
/** Returns the parcel to a rank of the next exchange. */
brio_parcel *brio_exchange_parcel(brio_exchange *x, int rank);

/** Begins the next exchange.   any  seen by all ranks as x->any if one says so. */
brio_status brio_exchange_begin(brio_exchange *x, bool any);
/** Ends the oldest exchange: x->received, x->from and x->any are of it. Returns BRIO_OK or, on all ranks, a failure. */
brio_status brio_exchange_end(brio_exchange *x);
/** Does both. */
brio_status brio_exchange_now(brio_exchange *x, bool any);

/** Sends the same bytes to all ranks, and receives theirs. */
brio_status brio_exchange_all(brio_exchange *x, const void *bytes, size_t size);

/** Ends a collective function.   status  of this rank, whose sentence is in the context. Returns that of all ranks.
 *  Exchanges may go on afterwards, unless the transport failed. */
brio_status brio_exchange_agree(brio_exchange *x, brio_status status);

#endif
