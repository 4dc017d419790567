/* A triangulation in tiles: what all its stages share.
 *
 * A point has two names. Its index is the caller's. Its place is where it lies in the file of points: tile after tile,
 * in a tile along a Hilbert curve, which is cut into blocks. Of points at one position only the one that stands for it
 * has a place. */
#ifndef BRIO_TILES_WORK_H
#define BRIO_TILES_WORK_H

#include "brio/tiles.h"
#include "completion/completion.h"
#include "store/store.h"
#include "tiles/cuts.h"
#include "triangulation/triangulation.h"

enum {
    TILE_BLOCK = 128,    /* points in a block, at most. Chosen: tiles.md */
    TILE_FAN = 8,        /* blocks, or nodes, below a node */
    TILE_DIRECTIONS = 26 /* in which extreme points are found */
};

#define TILE_NONE  UINT32_MAX
#define TILE_FAR   (UINT32_MAX - 1) /* of a node whose points another process has; `first` is its rank */
#define TILE_OTHER (UINT32_MAX - 2) /* a tile of another process: none of the nodes here is of it */

/** A node of the tree of boxes over all blocks. */
typedef struct {
    brio_ball_box box;
    brio_set_point sample;    /* one of its points; the name is its place */
    uint64_t place;           /* of a block: its first point */
    uint32_t first, children; /* 0 children: a block */
    uint32_t points;          /* of a block */
    uint32_t tile;            /* of the root of a tile; else TILE_NONE */
} brio_tile_node;

typedef struct {
    brio_ball_box home; /* sides may be infinite; the weight is the heaviest of all points */
    uint64_t raw;       /* points, those at equal positions included */
    uint64_t place;     /* of its first point */
    uint32_t points;    /* that have a place */
    uint32_t root;      /* node; TILE_NONE if there are no points */
    uint64_t vertices, tetrahedra, hull_facets,
        halo; /* of the finished tile; halo: points of other tiles that it knew */
    uint64_t asked, found, sampled, read, triangulated, most_points, most_tetrahedra;
    uint32_t rounds, finished; /* finished: 1 */
    uint64_t border;           /* tetrahedra of its stars that belong to others, and infinite ones; 0 without stars */
    uint64_t stars;            /* 1: the border is in its file */
} brio_tile;

struct brio_tiles {
    brio_context *ctx;
    brio_store_folder folder;
    brio_tiles_stats stats;
    brio_tiles_cells_stats cells;
    bool weighted, has_points, has_result, has_ranks, has_neighbours, stars;
    bool sorts_cells, sorts_faces; /* cells will be asked for in order, and their faces */
    bool certifies;                /* faces of alpha shapes will be added to a certificate */
    bool torn;                     /* points were on their way to the tiles when a call failed: some are nowhere */
    uint64_t key;
    uint64_t points_hash; /* of the file of points */
    uint32_t num_tiles;
    uint64_t first_place; /* of all: what is added to the row of the file of points */
    /* while points are added */
    brio_store_file raw;
    brio_set_point *some; /* that are not written yet */
    size_t num_some;
    brio_tile_cuts cuts;
    brio_ball_box all; /* of all points, with the heaviest */
    double lightest;
    /* then */
    brio_tile *tile;
    brio_tile_node *node;
    size_t num_nodes, node_capacity;
    brio_set_point extreme[TILE_DIRECTIONS]; /* names are places */
    brio_set_point basis[4];                 /* points that span what all of them span */
    int num_basis;
};

/** --- stages, in their order; each returns BRIO_OK or what its public function promises --- */

/** Appends points to the raw file, and samples them.   first  the index of the first. */
brio_status brio_tiles_take(brio_tiles *t, const double *points, const double *weights, size_t num_points,
                            uint64_t first);
/** Cuts space by the sample, and makes a file of points for each tile. */
brio_status brio_tiles_divide(brio_tiles *t);
/** Brings the points of all tiles to their places, and makes the tree of boxes. */
brio_status brio_tiles_arrange(brio_tiles *t);
/** Triangulates one tile, and writes its file. */
brio_status brio_tiles_complete(brio_tiles *t, uint32_t tile);

/** Returns the bytes of memory that brio_tiles_run needs for one of equal tiles of points at different positions. Cells
 *  need more. */
double brio_tiles_least_memory(const brio_tiles_options *options, double points);

/** Returns the bytes at most while points are taken and divided. */
double brio_tiles_divide_bytes(const brio_tiles *t);
/** Returns the bytes beside the tiles while runs of vertices are merged.   runs  how many. */
double brio_tiles_merge_bytes(const brio_context *ctx, size_t runs);
/** Returns the bytes of what a source (below) has of all nodes. */
double brio_tile_source_bytes(const brio_tiles *t);

/** Refuses tiles that do not fit in the memory that the context may have.   at_once  tiles in memory together. */
brio_status brio_tiles_require_memory(brio_tiles *t, int at_once);
/** Refuses points for which the disk has no room, beyond what they take as they were added: before the work, not hours
 *  after.   n  points of the tiles here. */
brio_status brio_tiles_require_disk(brio_tiles *t, double n);
/** Makes the facts the sums of the tiles' facts. */
void brio_tiles_add_facts(brio_tiles *t);
/** Empties tiles whose points a run before left. */
void brio_tiles_forget(brio_tiles *t);
/** Leaves the folder for another process that goes on. */
void brio_tiles_leave(brio_tiles *t);

/** --- parts of these stages --- */

/** Writes the points that wait, after the last were taken. */
brio_status brio_tiles_end_taking(brio_tiles *t);
/** Reads up to t->num_some of the raw points into t->some.   from  the first.   *count  receives how many. */
brio_status brio_tiles_read_raw(brio_tiles *t, uint64_t from, size_t *count);
/** Removes the raw points and the sample. */
void brio_tiles_drop_raw(brio_tiles *t);
/** Cuts space into tiles by the sample.   home  receives the box of each. */
brio_status brio_tiles_cut(brio_tiles *t, uint32_t num_tiles, brio_ball_box *home);
/** Takes a point into account for the extreme points and the basis.   f  a filter for all points. */
void brio_tiles_note(brio_tiles *t, brio_filter *f, const brio_set_point *p);

/** Files that points of each tile are appended to. */
typedef struct brio_tile_tray brio_tile_tray;
brio_status brio_tile_trays_new(brio_tiles *t, brio_tile_tray **out);
brio_status brio_tile_trays_put(brio_tiles *t, brio_tile_tray *trays, uint32_t tile, const brio_set_point *p);
brio_status brio_tile_trays_end(brio_tiles *t, brio_tile_tray *trays);
void brio_tile_trays_free(brio_tiles *t, brio_tile_tray *trays);

/** Saves or finds what the stages before brio_tiles_complete made. *found tells whether it was there. */
brio_status brio_tiles_save(brio_tiles *t);
brio_status brio_tiles_restore(brio_tiles *t, bool *found);

/** Returns a hash of bytes in memory, and of a hash before. */
uint64_t brio_tiles_hash(uint64_t hash, const void *bytes, size_t size);

/** --- tree of boxes --- */

/** Appends nodes for a tile's blocks.   points  the tile's, in their places. */
brio_status brio_tile_tree_add(brio_tiles *t, uint32_t tile, const brio_set_point *points);
/** Appends the nodes over the roots of the tiles. The last node is then the root of all. */
brio_status brio_tile_tree_close(brio_tiles *t);

/** Lists the upper nodes of the tiles, for other processes: of each tile its root, with the tile's number, and what is
 *  below it, level by level. `first` is a row of the list.   *out  owned by the caller. */
brio_status brio_tile_tree_upper(brio_tiles *t, brio_tile_node **out, size_t *count);
/** Nodes over which one more is to come, in the order of space. */
typedef struct {
    uint32_t *node;
    size_t count, capacity;
} brio_tile_roots;
brio_status brio_tile_roots_add(brio_tiles *t, brio_tile_roots *roots, uint32_t node);
/** Appends the upper nodes of another process, and their roots to a list. */
brio_status brio_tile_tree_far(brio_tiles *t, const brio_tile_node *nodes, size_t count, int rank,
                               brio_tile_roots *roots);
/** Appends nodes over roots. */
brio_status brio_tile_tree_join(brio_tiles *t, const brio_tile_roots *roots);

/** Sets a filter for all points. */
void brio_tiles_filter(const brio_tiles *t, brio_filter *f);

/** Points of other tiles that a tile asks for: reads their blocks, and keeps those that it read. */
typedef struct brio_tile_source brio_tile_source;

/** Makes a source.
 *  root  the node below which it searches.
 *  seen  NULL, or a box all of whose points who asks knows: blocks in it are not searched. */
brio_status brio_tile_source_new(brio_tiles *t, uint32_t tile, uint32_t root, const brio_ball_box *seen,
                                 brio_tile_source **out);
void brio_tile_source_free(brio_tile_source *s);
/** Notes that a round of the completion begins, which knows all that was added before. */
void brio_tile_source_round(brio_tile_source *s);
/** Finds points in conflict, as a brio_conflicts_fn. */
brio_status brio_tile_conflicts(brio_tile_source *s, brio_ball *balls, size_t count, brio_found *found);
/** A question for another process. */
typedef struct {
    uint32_t ball, rank;
} brio_tile_asked;
/** Returns what other processes must be asked for, after brio_tile_conflicts or brio_tile_coarse_sample. */
const brio_tile_asked *brio_tile_source_asked(const brio_tile_source *s, size_t *count);
/** Adds a sample of the other tiles: the denser the nearer they are to a box. */
brio_status brio_tile_coarse_sample(brio_tile_source *s, const brio_ball_box *own, brio_found *found);
/** Returns the number of blocks that were read. */
uint64_t brio_tile_source_read(const brio_tile_source *s);

/** Chooses the box, wider than a tile's home, in which a tile shall know all points when it begins. */
brio_status brio_tile_halo_box(brio_tiles *t, uint32_t tile, brio_ball_box *seen);
/** Adds the points of other tiles in a box, those that this process has.
 *  root  the node below which they are.   tile  of which none is added. */
brio_status brio_tile_halo_add(brio_tiles *t, uint32_t tile, uint32_t root, const brio_ball_box *box,
                               brio_found *found);
/** Lists the ranks that may have points in a box.   *ranks  grows by them, each at least once. */
brio_status brio_tile_halo_ranks(brio_tiles *t, const brio_ball_box *box, brio_tile_roots *ranks);

/** A tile at work. */
typedef struct brio_tile_work brio_tile_work;
/** Begins a tile.
 *  more  NULL if one process has all points; else points of other processes that it begins with: all in `seen`, and a
 *        coarse sample.
 *  *out  NULL if the tile has no points or is finished, also by a run before. */
brio_status brio_tile_begin(brio_tiles *t, uint32_t tile, const brio_found *more, const brio_ball_box *seen,
                            brio_tile_work **out);
brio_completion *brio_tile_work_completion(brio_tile_work *w);
brio_tile_source *brio_tile_work_source(brio_tile_work *w);
/** Writes the file of a completed tile. */
brio_status brio_tile_finish(brio_tile_work *w);
/** Frees the work; a tile that is not finished may be begun again. */
void brio_tile_end(brio_tile_work *w);

/** --- results --- */

/** The file of a finished tile: its tetrahedra, the places of the points of other tiles that it knew, the border, and a
 *  byte for each of its points that says whether it is a vertex. A tetrahedron's vertices are points of the tile, or
 *  with the tile's number of points subtracted, rows of the halo. Infinite tetrahedra, which only the border has, have
 *  BRIO_INFINITE last. */
typedef struct {
    uint32_t (*tetrahedra)[4];
    uint64_t *halo;
    uint8_t *is_vertex;
} brio_tile_result;

/** Reads it.   wants_all  false: only which points are vertices. */
brio_status brio_tile_result_read(brio_tiles *t, uint32_t tile, bool wants_all, brio_tile_result *out);
void brio_tile_result_free(brio_tiles *t, brio_tile_result *r);
/** Removes the file. */
void brio_tile_result_remove(brio_tiles *t, uint32_t tile);
/** Reads the places of the halo of a tile, as many as its facts say. */
brio_status brio_tile_halo(brio_tiles *t, uint32_t tile, uint64_t *halo);
/** Reads the border of a tile.   border  as many rows as the tile's facts say. */
brio_status brio_tile_border(brio_tiles *t, uint32_t tile, uint32_t (*border)[4]);
/** A function that reads the points of a halo, in its order. */
typedef brio_status (*brio_halo_fn)(void *user, const uint64_t *halo, size_t n, brio_set_point *points);
/** Such a function, and what it is called with. */
typedef struct {
    brio_halo_fn read;
    void *user;
} brio_halo_reader;
/** Returns the reader of points that are all of this process. */
brio_halo_reader brio_tile_own_halo(brio_tiles *t);
/** Makes the part of a tile, as brio_tiles_part. */
brio_status brio_tile_part_make(brio_tiles *t, uint32_t tile, const brio_halo_reader *halo, brio_tile_part *p);

/** Sums the hashes of all tetrahedra: the checksum. */
brio_status brio_tiles_sum(brio_tiles *t, uint64_t *checksum);

/** Reads points by their places.   points  their names become `count` of their indices. */
brio_status brio_tile_points(brio_tiles *t, uint64_t place, size_t count, brio_set_point *points);
/** Reads rows of `size` bytes of a file that has one for each place.   places  in ascending order. */
brio_status brio_tile_rows(const brio_store_file *f, const uint64_t *places, size_t count, size_t size, void *rows);

/** --- neighbours across tiles: the steps that one process and ranks have in common (neighbours.c) --- */

/** A facet without a neighbour in the part that has it. Tiles are numbered through all processes. */
typedef struct {
    uint64_t index[3]; /* of the vertices, ascending */
    uint32_t tile, facet;
} brio_lone_facet;

/** Says to a facet of a tile which one is on its other side.   other_tile  BRIO_NO_TILE: the facet is of the hull. */
typedef struct {
    uint32_t tile, facet, other_tile, other_facet;
} brio_facet_answer;

#define BRIO_NO_FACET UINT32_MAX

/** Returns a number by which both sides of a facet meet. */
uint64_t brio_lone_facet_hash(const brio_lone_facet *l);

/** Finds the neighbours that are in the same part.
 *  p  as brio_tile_part_make makes it.   mate  4 for each tetrahedron: receives the facet on the other side of each
 *  facet, or BRIO_NO_FACET where the part has none. */
brio_status brio_tile_match_inside(brio_context *ctx, uint32_t tile, const brio_tile_part *p, uint32_t *mate);

/** Hands on the facets of a part that have no neighbour in it. They come into files of rows, as many as tiles: `lone-I`
 *  by their hash. Answers come into `joined-I` by their tile (store/row_files.h). */
typedef brio_status (*brio_lone_facet_fn)(void *user, const brio_lone_facet *l);
brio_status brio_tile_lone_facets(uint32_t tile, const brio_tile_part *p, const uint32_t *mate, brio_lone_facet_fn take,
                                  void *user);

/** Finds the pairs of facets of file `lone-I`, removes it, and hands on an answer to each facet.
 *  *alone  grows by the facets that have no other side. */
typedef brio_status (*brio_facet_answer_fn)(void *user, const brio_facet_answer *a);
brio_status brio_facet_pairs(brio_tiles *t, uint32_t file, brio_facet_answer_fn take, void *user, uint64_t *alone);

/** Reads the answers of file `joined-I`.   *answers  n, the caller's: brio_release, on failure too. */
brio_status brio_facet_answers_read(brio_tiles *t, uint32_t file, brio_facet_answer **answers, size_t *n);
/** Returns BRIO_ERR_OPEN, for answers that cannot be. */
brio_status brio_facet_answers_changed(const brio_tiles *t, uint32_t file);
/** Removes the files of lone facets and of answers that are there, after a failure. */
void brio_facet_files_remove(brio_tiles *t);

/** Names the neighbours of a part, as brio_tiles_neighbours.
 *  file  of its answers.   tile, all_tiles  of all processes. */
brio_status brio_tile_name_neighbours(brio_tiles *t, uint32_t file, uint32_t tile, uint64_t all_tiles,
                                      const brio_tile_part *part, brio_tile_neighbour (*neighbours)[4]);

/** Takes the part of a tile with its mates inside. */
typedef brio_status (*brio_tile_part_fn)(void *user, uint32_t tile, const brio_tile_part *part, const uint32_t *mate);
/** Makes the parts of all tiles of one process, one after the other, hands on each, and writes the answers to all that
 *  have facets without a neighbour. After a failure the files of these give their room back.
 *  with  NULL, or a function that takes the parts. */
brio_status brio_tiles_join(brio_tiles *t, brio_tile_part_fn with, void *user);

/* --- a triangulation put together from the parts of its tiles --- */

/** Tetrahedra that come part after part. Facets of the hull have infinite ones, which follow. */
typedef struct {
    brio_context *ctx;
    brio_input input;      /* of brio_delaunay, without weights */
    uint64_t seed;         /* likewise */
    const uint64_t *first; /* #tiles + 1: of each tile, its first tetrahedron among all */
    uint32_t num_tiles;
    size_t num_finite, count; /* count: the infinite ones, too */
    size_t num_infinite;      /* that are here */
    size_t num_lone;          /* facets that are here and have no mate yet */
    brio_adoption *adoption;
    brio_tetrahedron *tet;  /* count */
    brio_tetrahedron *some; /* on their way there */
} brio_gather;

/** Makes room.
 *  g  with ctx, input and seed; freed with brio_gather_free, on failure too. Points stay where they are, as `first`.
 *  hull_facets  of all.   Returns BRIO_OK, BRIO_ERR_TOO_LARGE (over 2^30 tetrahedra), BRIO_ERR_NO_MEMORY. */
brio_status brio_gather_begin(brio_gather *g, const uint64_t *first, uint32_t num_tiles, uint64_t hull_facets);
void brio_gather_free(brio_gather *g);

/** A tetrahedron of a tile: its vertices by the indices of points, and its mates in the same tile, or BRIO_NO_FACET. */
typedef struct {
    uint32_t vertex[4], mate[4];
} brio_gather_row;

/** Writes `count` rows of a part from `begin` on. */
void brio_gather_rows(const brio_tile_part *part, const uint32_t *mate, size_t begin, size_t count,
                      brio_gather_row *rows);

/** Takes rows of a tile's part. They may come in any order. */
brio_status brio_gather_take(brio_gather *g, uint32_t tile, uint64_t begin, const brio_gather_row *rows, size_t count);

/** Takes the answers to all tiles from the files `joined-I`, which are removed, once all rows are here.
 *  t  in whose folder they are.   Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_gather_join(brio_gather *g, brio_tiles *t);

/** Makes what brio_delaunay makes of the points, once all parts are joined.
 *  duplicates  points at the position of another one.
 *  Cost: sorts the tetrahedra, in files where the context has a scratch folder.
 *  Returns what brio_delaunay returns. */
brio_status brio_gather_end(brio_gather *g, uint64_t duplicates, brio_triangulation **out);

/** Makes what brio_delaunay makes with this seed of the points of all tiles of one process, whose dimension is 3. The
 *  tiles have neither parts nor points afterwards: their files are removed as they are read.
 *  points  num_points by 3: those that were added.   Returns what brio_delaunay returns. */
brio_status brio_tiles_gather(brio_tiles *t, const double *points, size_t num_points, uint64_t seed,
                              brio_triangulation **out);

/** Lets a context's triangulations be made in tiles.
 *  options  kept: neither stars nor a key.   Returns BRIO_OK, BRIO_ERR_ARGUMENT. */
brio_status brio_triangulate_in_tiles(brio_context *ctx, const brio_tiles_options *options, brio_triangulator *out);

#endif
