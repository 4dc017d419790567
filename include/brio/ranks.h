/* brio/ranks.h: the triangulation of brio/tiles.h by many processes, each with tiles in a scratch folder of its host.
 *
 * The processes are ranks of a transport, which sends bytes among them: libbrio-mpi has one for MPI, and the caller may
 * have another. All ranks call the same collective functions in the same order; a rank alone calls brio_ranks_add, and
 * the functions that say so. A failure of one rank is the failure of all, with one sentence. After it all ranks may
 * call the next function, unless the transport failed.
 * docs/mpi.md says what it costs; docs/decisions/021-ranks.md why it is right.
 *
 *     brio_ranks_options o = {.size = sizeof o, .scratch = "/var/tmp", .tiles = 4};
 *     brio_ranks *r;
 *     brio_ranks_new(ctx, &transport, &o, &r);
 *     status = read my share: brio_ranks_add(ctx, r, points, NULL, count, index of the first);
 *     brio_ranks_agree(ctx, r, status);
 *     brio_ranks_run(ctx, r);
 *     brio_ranks_checksum(ctx, r, &checksum);
 *     brio_ranks_free(r);
 */
#ifndef BRIO_RANKS_H
#define BRIO_RANKS_H

#include "tiles.h"

#ifdef __cplusplus
extern "C" {
#endif

/** What one rank sends to another in an exchange. */
typedef struct brio_letter {
    const void *bytes; /* aligned to 8 bytes */
    uint64_t size;     /* may be 0 */
    uint64_t note;
    int rank; /* to which it goes, or from which it came */
    int reserved_int;
} brio_letter;

/** Bytes of a transport's room for each rank. */
#define BRIO_TRANSPORT_ROOM 128

/** Sends bytes among ranks. In an exchange every rank sends a message to every rank, itself included. Exchanges end in
 *  the order in which they began, and at most two are under way. */
typedef struct brio_transport {
    size_t size;
    int rank, ranks;
    const char *host; /* a name for messages */
    void *user;
    /** Begins an exchange, and does not wait.   messages  one to each rank, in their order; bytes stay until it ends.
     *  Returns 0, or another number if the transport failed: BRIO_ERR_NO_MEMORY says that there was no memory,
     *  BRIO_ERR_CANCELLED that the wait was ended. The transport is not called then any more, and other ranks may wait
     *  for this one: the caller must end them. */
    int (*begin)(void *user, const brio_letter *messages);
    /** Waits until the oldest exchange is complete.   received  one message from each rank, in any order; their bytes
     *  are valid until the next call of `end`. Returns what `begin` returns. */
    int (*end)(void *user, brio_letter *received);
    /** NULL, or BRIO_TRANSPORT_ROOM bytes for each rank, aligned to 8. In it a rank that has no memory to begin a
     *  collective function says so to all others. Without room these are not told, and the caller must end them. It is
     *  used while one of the functions below begins, and not kept: any number of sets of ranks may share it. */
    void *room;
} brio_transport;

typedef struct brio_ranks brio_ranks;

typedef struct brio_ranks_options {
    size_t size;
    const char *scratch; /* a folder of this host with room for about 190 bytes a point of this rank */
    uint32_t tiles;      /* of each rank, at most 4,096; 0 means 4; the same on all ranks. Two are in memory */
    int stars;           /* as in brio_tiles_options, for brio_ranks_cells; the same on all ranks */
    uint64_t key; /* as in brio_tiles_options; the same on all ranks. A run goes on if all ranks have their folders */
} brio_ranks_options;

/** What the ranks sent, all ranks together. */
typedef struct brio_ranks_traffic {
    size_t size;
    uint64_t exchanges;                 /* of each rank */
    uint64_t bytes;                     /* sent to other ranks, all phases */
    uint64_t question_bytes;            /* of these, while tiles were completed */
    uint64_t far_asked;                 /* questions to other ranks */
    uint64_t far_found;                 /* points in their answers */
    uint64_t rounds;                    /* of the ranks together */
    uint64_t least_points, most_points; /* of a rank */
    double waited_seconds;              /* for other ranks, the mean of all */
} brio_ranks_traffic;

/** Collective. Makes an empty set of points, and a folder in the scratch folder.
 *  transport  copied; what it points to must stay.
 *  out  owned by the caller: brio_ranks_free; NULL on error.
 *  Returns BRIO_OK or, on all ranks, what brio_tiles_new returns on one: if the transport has room, or what failed was
 *  not the first 2 kB of this rank's memory. A transport that is none is BRIO_ERR_ARGUMENT, and others are not told. */
BRIO_API brio_status brio_ranks_new(brio_context *ctx, const brio_transport *transport,
                                    const brio_ranks_options *options, brio_ranks **out);

/** Returns 1 if a run before left all points in the folders of all ranks, so that none are to be added; else 0. */
BRIO_API int brio_ranks_has_points(const brio_ranks *r);

/** Appends points of this rank alone; not collective.
 *  first  the index of the first of them among all points of all ranks. Each index is given once.
 *  Returns what brio_tiles_add returns: hand it to brio_ranks_agree. */
BRIO_API brio_status brio_ranks_add(brio_context *ctx, brio_ranks *r, const double *points, const double *weights,
                                    size_t num_points, uint64_t first);

/** Collective. Tells all ranks how this one fares.
 *  status  BRIO_OK, or a failure of this rank, whose sentence is in the context.
 *  sentence  NULL, or the sentence instead.
 *  Returns BRIO_OK on all ranks, or on all the failure of one: the sentence then names the rank and its host. */
BRIO_API brio_status brio_ranks_agree(brio_context *ctx, brio_ranks *r, brio_status status, const char *sentence);

/** Collective. Divides all points into tiles, and triangulates these: brio_tiles_run. After a failure a further call
 *  does what brio_tiles_run does.
 *  Returns BRIO_OK or, on all ranks, what brio_tiles_run returns on one. */
BRIO_API brio_status brio_ranks_run(brio_context *ctx, brio_ranks *r);

/** Returns the facts of all ranks together. The views are valid until brio_ranks_free. */
BRIO_API const brio_tiles_stats *brio_ranks_facts(const brio_ranks *r);
BRIO_API const brio_ranks_traffic *brio_ranks_sent(const brio_ranks *r);

/** Collective. Computes what brio_triangulation_checksum returns for the triangulation of all points.
 *  Memory: about 80 bytes for each point of a rank. Returns what brio_tiles_checksum returns. */
BRIO_API brio_status brio_ranks_checksum(brio_context *ctx, brio_ranks *r, uint64_t *checksum);

/** Collective. Reads the tetrahedra of one tile of each rank.
 *  tile  below the number of tiles of each rank; the same on all.   out  freed with brio_tile_part_free. */
BRIO_API brio_status brio_ranks_part(brio_context *ctx, brio_ranks *r, uint32_t tile, brio_tile_part *out);

/** Collective. Names the neighbours of the tetrahedra of one tile of each rank, as brio_tiles_neighbours does. A tile's
 *  number in these names is that of its rank times the number of tiles of a rank, plus its own.
 *  tile  below the number of tiles of each rank.   part  of that tile, as brio_ranks_part made it.
 *  neighbours  #T by 4, the caller's.
 *  Cost: that of brio_tiles_neighbours. The first call makes all parts once more, and sends the facets between two
 *  tiles: 32 bytes for each side, and 16 back.
 *  Returns BRIO_OK or, on all ranks, what brio_tiles_neighbours returns on one. */
BRIO_API brio_status brio_ranks_neighbours(brio_context *ctx, brio_ranks *r, uint32_t tile, const brio_tile_part *part,
                                           brio_tile_neighbour (*neighbours)[4]);

/** Collective. Computes the cells of all vertices: each rank those of its tiles. Their numbers are those that
 *  brio_tiles_cells computes of all points.
 *  options  as in brio_voronoi_cells; the same on all ranks.
 *  ordered  as in brio_tiles_cells; the same on all ranks. 0: each rank gets the cells of its tiles, as they are
 *           computed. 1 and 2: rank after rank, the cells come in ascending order of their sites. Each rank gets those
 *           of a range of sites, about as many as another rank.
 *  take  NULL, or receives the cells. If it returns another number than 0, the run ends on all ranks.
 *  user  handed to `take`.
 *  Memory: what brio_tiles_cells needs, and 48 bytes for each point of a tile's halo; with `ordered` also 1 kB for each
 *  tile of all ranks. Cost: each point of a halo is asked for, 8 bytes, and sent, 40; with `ordered` each cell and face
 *  is sent with as many bytes as it takes of the disk.
 *  Returns BRIO_OK or, on all ranks, what brio_tiles_cells returns on one.
 *  Based on: [Kulisch Miranker 1986], for the sum of volumes; [Frazer McKellar 1970], for the order. */
BRIO_API brio_status brio_ranks_cells(brio_context *ctx, brio_ranks *r, const brio_cells_options *options, int ordered,
                                      brio_tile_cells_fn take, void *user);

/** Returns the facts of the cells of all ranks, of the last call of brio_ranks_cells that ended well. volume_sum is
 *  the exact sum of the volumes of all bounded cells, rounded once: the same for every number of ranks and tiles. The
 *  view is valid until brio_ranks_free. */
BRIO_API const brio_tiles_cells_stats *brio_ranks_cells_facts(const brio_ranks *r);

/* --- surfaces --- */

/** Ranks that triangulate for rank 0, and decide parts of minimum cuts. */
typedef struct brio_team_of_ranks brio_team_of_ranks;

/** What a team did. */
typedef struct brio_team_facts {
    size_t size;
    uint64_t triangulations;
    uint64_t bytes;                               /* that rank 0 sent to others while they triangulated */
    uint64_t parts;                               /* of minimum cuts, decided by all ranks */
    uint64_t part_bytes;                          /* that rank 0 sent to others for these */
    uint64_t bytes_received, part_bytes_received; /* that came to rank 0 from others meanwhile */
} brio_team_facts;

/** Has the triangulations and the minimum cuts of surfaces made by all ranks: on rank 0 alone, while all others call
 *  brio_ranks_serve. From now on brio_surface with the method BRIO_SURFACE_LABELED, in this context, triangulates and
 *  cuts with the team, until brio_ranks_dismiss. The surface has the same bits, whatever the number of ranks and tiles.
 *  Rank 0 has the points and all other arrays of the surface: in files, if the context has a scratch folder
 *  (brio_context_set_scratch).
 *  options  as in brio_ranks_new, without stars and key.
 *  out  ended by brio_ranks_dismiss, in any case; NULL on error, which ends what other ranks call, if the transport has
 *  room. Without room other ranks do not get to know it, and the caller must end them.
 *  Memory: of each rank as of brio_ranks_run, and 48 bytes a tetrahedron of a tile. Sent to rank 0: 48 bytes a
 *  tetrahedron. For a cut 40 bytes a tetrahedron are sent from rank 0, and 1 comes back, 17 if the context has no
 *  scratch folder. The parts of at most 64 MiB, or one part, are on their way in each of two exchanges. A part in work
 *  takes 62 bytes a tetrahedron.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_ranks_lead(brio_context *ctx, const brio_transport *transport,
                                     const brio_ranks_options *options, brio_team_of_ranks **out);

/** Returns the facts. The view is valid until brio_ranks_dismiss. */
BRIO_API const brio_team_facts *brio_ranks_led(const brio_team_of_ranks *team);

/** Ends the team on rank 0, and what others call.
 *  status    what they return: BRIO_OK, or the failure of rank 0, whose sentence is in the context.
 *  sentence  NULL, or the sentence instead.
 *  Returns the status of all ranks. The sentence names the rank that failed and its host. After a failure of another
 *  rank in a cut it is that failure, whatever `status` is: then other ranks have it already. */
BRIO_API brio_status brio_ranks_dismiss(brio_team_of_ranks *team, brio_status status, const char *sentence);

/** Triangulates and cuts for rank 0 until it dismisses this rank: on all ranks but 0.
 *  options  as those of rank 0; the folder is one of this host.
 *  Returns what rank 0 says, with its sentence; or what made the transport fail; or, before there were exchanges,
 *  BRIO_ERR_ARGUMENT or BRIO_ERR_NO_MEMORY. If the transport has room, rank 0 gets to know that when it first needs
 *  other ranks, at the latest in brio_ranks_dismiss. Without room nobody does, and the caller must end the others. */
BRIO_API brio_status brio_ranks_serve(brio_context *ctx, const brio_transport *transport,
                                      const brio_ranks_options *options);

/** Frees everything, and removes this rank's files, unless the run has a key and the last collective call failed, after
 *  the points were divided: then a run that follows goes on with them. NULL is accepted. Not collective. */
BRIO_API void brio_ranks_free(brio_ranks *r);

#ifdef __cplusplus
}
#endif
#endif
