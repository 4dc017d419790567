/* brio/mpi.h: a transport of brio/ranks.h by MPI. Installed with libbrio-mpi.
 *
 *     MPI_Init(&argc, &argv);
 *     brio_mpi *m = brio_mpi_new(MPI_COMM_WORLD);
 *     brio_transport t = brio_mpi_transport(m);
 *     brio_ranks_new(ctx, &t, &options, &ranks);
 */
#ifndef BRIO_MPI_H
#define BRIO_MPI_H

#include <brio/ranks.h>
#include <mpi.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct brio_mpi brio_mpi;

/** Makes a transport among the ranks of a communicator, of which it has a copy. Collective.
 *  Returns NULL if there is no memory, or MPI fails. */
brio_mpi *brio_mpi_new(MPI_Comm comm);

/** Returns the transport; valid until brio_mpi_free. Its calls are made by the thread that calls brio. While it waits
 *  the thread sleeps between its looks at the network, so that ranks may be more than processors. */
brio_transport brio_mpi_transport(brio_mpi *m);

/** While the transport waits, stop(user) is asked now and then. After another result than 0 it tells all other ranks,
 *  and waits for them for at most 0.8 s more, all exchanges together: if they fail meanwhile, all ranks end alike. Then
 *  the exchange fails with BRIO_ERR_CANCELLED. */
void brio_mpi_set_stop(brio_mpi *m, int (*stop)(void *user), void *user);

/** Returns 1 if another rank told this one that it was asked to stop, else 0: for the callback of
 *  brio_context_set_progress, so that this rank ends, too. */
int brio_mpi_stopped(brio_mpi *m);

/** Returns 1 if an exchange failed on this rank, or 0. Other ranks may wait for it then: MPI_Abort ends them. */
int brio_mpi_has_failed(const brio_mpi *m);

/** Frees everything; NULL is accepted. Collective, unless an exchange failed. */
void brio_mpi_free(brio_mpi *m);

#ifdef __cplusplus
}
#endif
#endif
