/* Exchanges by MPI: see brio/mpi.h.
 *
 * Notes and sizes go by MPI_Ialltoall; bytes as messages from each rank to each, where there are any, in pieces that
 * MPI's counts can tell. Messages between two ranks stay in order, so that the tags of even and of odd exchanges
 * suffice. What waits looks at the network, then sleeps: twice as long each time, up to a millisecond.
 *
 * A rank that is asked to stop while it waits tells the others, and waits on: they look for that while they work, fail in
 * an exchange, and all end alike. Only where they do not come the transport fails. */
#include "brio/mpi.h"
#include <brio/context.h>
#include <stdbool.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

/* PATIENCE: nanoseconds that a rank which is asked to stop waits for others, all waits together. The library looks at
 * least every 500 ms of processor time, and the mpirun of Open MPI kills a second after it has asked to stop.
 * TAG_STOP: of an empty message that says so; the tags below are of exchanges. */
enum { UNDER_WAY = 2, PIECE = 1 << 28, LONGEST_SLEEP = 1000000 /* nanoseconds */, PATIENCE = 800000000 };
enum { TAG_STOP = UNDER_WAY };

typedef struct {
    uint64_t size, note;
} notice;

typedef struct {
    notice *out, *in;
    MPI_Request noted, *sends;
    int num_sends, most_sends;
    const void *to_self;
} exchange;

struct brio_mpi {
    MPI_Comm comm;
    int rank, ranks;
    char host[MPI_MAX_PROCESSOR_NAME];
    exchange exchange[UNDER_WAY];
    uint64_t begun, ended;
    uint8_t *received; /* what the last end gave */
    uint64_t received_size;
    MPI_Request *receives;
    int num_receives, most_receives;
    int (*stop)(void *user);
    void *stop_user;
    int64_t waited;        /* nanoseconds since it was asked to stop, while it waited */
    MPI_Request listening; /* for a rank that was asked to stop; null after it said so */
    MPI_Request *telling;  /* all others that this rank was; NULL: it has not told them */
    int failed;            /* what the call returned that did */
    void *room;            /* of the transport */
};

/* --- requests --- */

static int reserve(MPI_Request **requests, int *most, int count) {
    if (count < *most) return 0;
    int room = 2 * count + 16;
    MPI_Request *grown = realloc(*requests, (size_t)room * sizeof **requests);
    if (!grown) return BRIO_ERR_NO_MEMORY;
    *requests = grown, *most = room;
    return 0;
}

static int send_bytes(brio_mpi *m, exchange *e, const brio_letter *letter, int tag) {
    for (uint64_t at = 0; at < letter->size; at += PIECE) {
        int size = letter->size - at < PIECE ? (int)(letter->size - at) : PIECE;
        if (reserve(&e->sends, &e->most_sends, e->num_sends)) return BRIO_ERR_NO_MEMORY;
        if (MPI_Isend((const char *)letter->bytes + at, size, MPI_BYTE, letter->rank, tag, m->comm,
                      &e->sends[e->num_sends++]))
            return 1;
    }
    return 0;
}

static int receive_bytes(brio_mpi *m, uint8_t *to, uint64_t bytes, int from, int tag) {
    for (uint64_t at = 0; at < bytes; at += PIECE) {
        int size = bytes - at < PIECE ? (int)(bytes - at) : PIECE;
        if (reserve(&m->receives, &m->most_receives, m->num_receives)) return BRIO_ERR_NO_MEMORY;
        if (MPI_Irecv(to + at, size, MPI_BYTE, from, tag, m->comm, &m->receives[m->num_receives++])) return 1;
    }
    return 0;
}

/* --- stopping --- */

static int listen(brio_mpi *m) {
    return MPI_Irecv(NULL, 0, MPI_BYTE, MPI_ANY_SOURCE, TAG_STOP, m->comm, &m->listening);
}

int brio_mpi_stopped(brio_mpi *m) {
    int told = 0;
    return m->listening == MPI_REQUEST_NULL || (!MPI_Test(&m->listening, &told, MPI_STATUS_IGNORE) && told);
}

/* Tells the others that this rank was asked to stop, if none told it: then they know. */
static void tell(brio_mpi *m) {
    if (m->telling || brio_mpi_stopped(m)) return;
    m->telling = malloc((size_t)m->ranks * sizeof *m->telling);
    for (int i = 0; m->telling && i < m->ranks; i++) {
        m->telling[i] = MPI_REQUEST_NULL;
        if (i != m->rank) MPI_Isend(NULL, 0, MPI_BYTE, i, TAG_STOP, m->comm, &m->telling[i]);
    }
}

/* Receives what others told and this rank did not need, and stops listening. Collective. */
static void settle(brio_mpi *m) {
    int told = m->telling != NULL, all = 0;
    MPI_Allreduce(&told, &all, 1, MPI_INT, MPI_SUM, m->comm);
    for (all -= told + (m->listening == MPI_REQUEST_NULL); all > 0; all--) {
        if (m->listening == MPI_REQUEST_NULL) listen(m);
        MPI_Wait(&m->listening, MPI_STATUS_IGNORE);
    }
    if (told) MPI_Waitall(m->ranks, m->telling, MPI_STATUSES_IGNORE);
}

/* --- waiting --- */

/* Waits for requests without using the processor. Returns 0, 1 or BRIO_ERR_CANCELLED. */
static int wait_for(brio_mpi *m, int count, MPI_Request *requests) {
    struct timespec sleep = {0, 1000};
    for (int looks = 0;; looks++) {
        int done;
        if (MPI_Testall(count, requests, &done, MPI_STATUSES_IGNORE)) return 1;
        if (done) return 0;
        bool stop = m->stop && m->stop(m->stop_user);
        if (stop && m->waited >= PATIENCE) return BRIO_ERR_CANCELLED;
        if (stop) tell(m);
        if (looks < 10) continue;
        nanosleep(&sleep, NULL);
        if (stop) m->waited += sleep.tv_nsec;
        if (sleep.tv_nsec < LONGEST_SLEEP) sleep.tv_nsec *= 2;
    }
}

/* --- the transport --- */

static int begin(brio_mpi *m, const brio_letter *letters) {
    int tag = (int)(m->begun % UNDER_WAY);
    exchange *e = &m->exchange[tag];
    e->num_sends = 0;
    for (int i = 0; i < m->ranks; i++) e->out[i] = (notice){letters[i].size, letters[i].note};
    e->to_self = letters[m->rank].bytes;
    if (MPI_Ialltoall(e->out, 2, MPI_UINT64_T, e->in, 2, MPI_UINT64_T, m->comm, &e->noted)) return 1;
    for (int i = 0; i < m->ranks; i++) { /* each rank begins with another, so that none gets all at once */
        int to = (m->rank + i) % m->ranks;
        int failed = to != m->rank ? send_bytes(m, e, &letters[to], tag) : 0;
        if (failed) return failed;
    }
    m->begun++;
    return 0;
}

static uint64_t rounded(uint64_t size) {
    return (size + 15) / 16 * 16;
}

static int make_room(brio_mpi *m, uint64_t size) {
    if (size <= m->received_size && size >= m->received_size / 4) return 0;
    free(m->received);
    m->received = malloc(size ? size : 1);
    m->received_size = m->received ? size : 0;
    return !m->received;
}

static int end(brio_mpi *m, brio_letter *received) {
    int tag = (int)(m->ended % UNDER_WAY);
    exchange *e = &m->exchange[tag];
    uint64_t all = 0;
    int failed = wait_for(m, 1, &e->noted);
    if (failed) return failed;
    for (int i = 0; i < m->ranks; i++) all += rounded(e->in[i].size);
    if (make_room(m, all)) return BRIO_ERR_NO_MEMORY;
    m->num_receives = 0;
    uint8_t *at = m->received;
    for (int i = 0; i < m->ranks; at += rounded(e->in[i++].size)) {
        received[i] = (brio_letter){.bytes = at, .size = e->in[i].size, .note = e->in[i].note, .rank = i};
        failed = i != m->rank ? receive_bytes(m, at, e->in[i].size, i, tag) : 0;
        if (failed) return failed;
    }
    if (e->in[m->rank].size) memcpy((void *)received[m->rank].bytes, e->to_self, e->in[m->rank].size);
    failed = wait_for(m, m->num_receives, m->receives);
    if (!failed) failed = wait_for(m, e->num_sends, e->sends);
    if (!failed) m->ended++;
    return failed;
}

static int begin_or_fail(void *user, const brio_letter *letters) {
    brio_mpi *m = user;
    if (!m->failed) m->failed = begin(m, letters);
    return m->failed;
}

static int end_or_fail(void *user, brio_letter *received) {
    brio_mpi *m = user;
    if (!m->failed) m->failed = end(m, received);
    return m->failed;
}

/* --- life --- */

static int prepare(brio_mpi *m, MPI_Comm comm) {
    int length = 0;
    m->comm = MPI_COMM_NULL;
    m->listening = MPI_REQUEST_NULL;
    if (MPI_Comm_dup(comm, &m->comm)) return 1;
    if (MPI_Comm_set_errhandler(m->comm, MPI_ERRORS_RETURN)) return 1;
    if (MPI_Comm_rank(m->comm, &m->rank) || MPI_Comm_size(m->comm, &m->ranks)) return 1;
    if (MPI_Get_processor_name(m->host, &length)) return 1;
    for (int k = 0; k < UNDER_WAY; k++) {
        m->exchange[k].out = calloc((size_t)m->ranks, sizeof(notice));
        m->exchange[k].in = calloc((size_t)m->ranks, sizeof(notice));
        if (!m->exchange[k].out || !m->exchange[k].in) return 1;
    }
    m->room = calloc((size_t)m->ranks, BRIO_TRANSPORT_ROOM);
    return !m->room || listen(m);
}

brio_mpi *brio_mpi_new(MPI_Comm comm) {
    brio_mpi *m = calloc(1, sizeof *m);
    if (m && prepare(m, comm)) {
        m->failed = 1; /* others may have come farther */
        brio_mpi_free(m);
        return NULL;
    }
    return m;
}

brio_transport brio_mpi_transport(brio_mpi *m) {
    return (brio_transport){.size = sizeof(brio_transport),
                            .rank = m->rank,
                            .ranks = m->ranks,
                            .host = m->host,
                            .user = m,
                            .begin = begin_or_fail,
                            .end = end_or_fail,
                            .room = m->room};
}

void brio_mpi_set_stop(brio_mpi *m, int (*stop)(void *user), void *user) {
    m->stop = stop;
    m->stop_user = user;
}

int brio_mpi_has_failed(const brio_mpi *m) {
    return m->failed != 0;
}

void brio_mpi_free(brio_mpi *m) {
    if (!m) return;
    if (m->ended && !m->failed) settle(m);
    if (m->listening != MPI_REQUEST_NULL) {
        MPI_Cancel(&m->listening);
        MPI_Wait(&m->listening, MPI_STATUS_IGNORE);
    }
    for (int k = 0; k < UNDER_WAY; k++) {
        free(m->exchange[k].out);
        free(m->exchange[k].in);
        free(m->exchange[k].sends);
    }
    free(m->receives);
    free(m->received);
    free(m->telling);
    free(m->room);
    if (m->comm != MPI_COMM_NULL && !m->failed) MPI_Comm_free(&m->comm);
    free(m);
}
