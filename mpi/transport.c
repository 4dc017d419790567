/* Exchanges by MPI: see brio/mpi.h.
 *
 * Notes and sizes go by MPI_Ialltoall; bytes as messages from each rank to each, where there are any, in pieces that
 * MPI's counts can tell. Messages between two ranks stay in order, so that the tags of even and of odd exchanges
 * suffice. What waits looks at the network, then sleeps: twice as long each time, up to a millisecond. */
#include "brio/mpi.h"
#include <brio/context.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { UNDER_WAY = 2, PIECE = 1 << 28, LONGEST_SLEEP = 1000000 /* nanoseconds */ };

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
    uint8_t *room; /* what the last end gave */
    uint64_t room_size;
    MPI_Request *receives;
    int num_receives, most_receives;
    int (*stop)(void *user);
    void *stop_user;
    int failed; /* what the call returned that did */
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

/* Waits for requests without using the processor. */
static int wait_for(brio_mpi *m, int count, MPI_Request *requests) {
    struct timespec sleep = {0, 1000};
    for (int looks = 0;; looks++) {
        int done;
        if (MPI_Testall(count, requests, &done, MPI_STATUSES_IGNORE)) return 1;
        if (done) return 0;
        if (m->stop && m->stop(m->stop_user)) return 1;
        if (looks < 10) continue;
        nanosleep(&sleep, NULL);
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
    if (size <= m->room_size && size >= m->room_size / 4) return 0;
    free(m->room);
    m->room = malloc(size ? size : 1);
    m->room_size = m->room ? size : 0;
    return !m->room;
}

static int end(brio_mpi *m, brio_letter *received) {
    int tag = (int)(m->ended % UNDER_WAY);
    exchange *e = &m->exchange[tag];
    uint64_t all = 0;
    if (wait_for(m, 1, &e->noted)) return 1;
    for (int i = 0; i < m->ranks; i++) all += rounded(e->in[i].size);
    if (make_room(m, all)) return BRIO_ERR_NO_MEMORY;
    m->num_receives = 0;
    uint8_t *at = m->room;
    for (int i = 0; i < m->ranks; at += rounded(e->in[i++].size)) {
        received[i] = (brio_letter){.bytes = at, .size = e->in[i].size, .note = e->in[i].note, .rank = i};
        int failed = i != m->rank ? receive_bytes(m, at, e->in[i].size, i, tag) : 0;
        if (failed) return failed;
    }
    if (e->in[m->rank].size) memcpy((void *)received[m->rank].bytes, e->to_self, e->in[m->rank].size);
    if (wait_for(m, m->num_receives, m->receives) || wait_for(m, e->num_sends, e->sends)) return 1;
    m->ended++;
    return 0;
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
    if (MPI_Comm_dup(comm, &m->comm)) return 1;
    if (MPI_Comm_set_errhandler(m->comm, MPI_ERRORS_RETURN)) return 1;
    if (MPI_Comm_rank(m->comm, &m->rank) || MPI_Comm_size(m->comm, &m->ranks)) return 1;
    if (MPI_Get_processor_name(m->host, &length)) return 1;
    for (int k = 0; k < UNDER_WAY; k++) {
        m->exchange[k].out = calloc((size_t)m->ranks, sizeof(notice));
        m->exchange[k].in = calloc((size_t)m->ranks, sizeof(notice));
        if (!m->exchange[k].out || !m->exchange[k].in) return 1;
    }
    return 0;
}

brio_mpi *brio_mpi_new(MPI_Comm comm) {
    brio_mpi *m = calloc(1, sizeof *m);
    if (m && prepare(m, comm)) {
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
                            .end = end_or_fail};
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
    for (int k = 0; k < UNDER_WAY; k++) {
        free(m->exchange[k].out);
        free(m->exchange[k].in);
        free(m->exchange[k].sends);
    }
    free(m->receives);
    free(m->room);
    if (m->comm != MPI_COMM_NULL && !m->failed) MPI_Comm_free(&m->comm);
    free(m);
}
