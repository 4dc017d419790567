/* --tiles: a triangulation tile after tile in the scratch folder. */
#ifndef BRIO_CLI_TILES_H
#define BRIO_CLI_TILES_H

#include "cli/files/new_file.h"
#include "cli/steps/weights.h"

/** Rows of a command's option table whose struct has a uint64_t `field`. */
/* clang-format off */
#define TILES_ROWS(type, field)                                                                                        \
    {"tiles", 0, OPTION_NATURAL | OPTION_POSITIVE, offsetof(type, field), "N",                                         \
     "more points than fit in memory: N tiles, one after the other, in the folder of --scratch", 0}
/* clang-format on */

/** Refuses what --tiles does not go with: weights in a file, no scratch folder. */
brio_status cli_check_tiles(run *r, const weights_options *weights, uint64_t tiles);
/** Refuses an output that is not .pvtu.   formats  what the sentence says is written. */
brio_status cli_check_tile_files(run *r, const char *formats);

/** Refuses an output that is neither an index of files for tiles nor .ply, and for .ply an input that cannot be read
 *  twice.   index  ".pvtu" or ".pvtp". */
brio_status cli_check_tile_output(run *r, const char *index);
/** Returns whether the output is one file for all tiles. */
bool cli_merges_tiles(const run *r);

/** The output of all tiles in one file: all points as they are read again, in their order and with their properties,
 *  then tetrahedra or faces. Each vertex is the row of its point. */
typedef struct {
    run *r;
    weights_options options;
    uint64_t key; /* of the input before it was read */
    brio_write_options how;
    double moved;
    int rounded;   /* whether colours lose steps */
    size_t merged; /* points that single precision merges */
    brio_mesh_parts *parts;
    brio_property *property; /* of a block as it is written */
    size_t num_properties;   /* of the input */
    bool adds_weight;
    uint64_t count, all; /* points */
    bool looks; /* the depth of colours shows in all blocks only, which are looked at before they are written */
    brio_status status;
} tile_merging;

/** What comes behind the points. */
typedef struct {
    bool of_faces; /* else of tetrahedra */
    uint64_t count;
    brio_status (*write)(run *r, brio_mesh_parts *parts, void *user); /* appends them */
    void *user;
} tile_cells;

/** Begins, before the input is read. */
void cli_merging_begin(tile_merging *m, run *r, const weights_options *weights);
brio_status cli_merging_write(tile_merging *m, const tile_cells *cells);

/** Reads the input block by block, and triangulates it in tiles.
 *  stars  as in brio_tiles_options.   out  freed by the caller, also on an error. */
brio_status cli_triangulate_tiles(run *r, const weights_options *weights, uint64_t tiles, int stars, brio_tiles **out);

/** Does the same for an output that is one file, which it refuses before the long work where its points cannot be
 *  written.   merging  NULL: no such output. */
brio_status cli_triangulate_merging(run *r, tile_merging *merging, const weights_options *weights, uint64_t tiles,
                                    int stars, brio_tiles **out);

/** Triangulates the input in tiles, and reports as brio delaunay does. Writes -o: x.pvtu, and a file for each tile in
 *  the folder x beside it; or x.ply, all in one file. */
brio_status cli_tiles(run *r, const weights_options *weights, uint64_t tiles);

/* --- what brio-mpi has the same of --- */

/** Returns a number for a file as it is now and the way in which it is read, or 0 if it cannot be read again, or if
 *  the file does not tell whether the points are the same. */
uint64_t cli_tiles_key(const run *r, const weights_options *w, const char *path);
/** Finds the weights of a block, or NULL.   first  the index of its first point.   *weights  the caller frees it. */
brio_status cli_block_weights(run *r, const weights_options *options, const brio_mesh *block, uint64_t first,
                              double **weights);
void cli_report_tiles(run *r, const brio_tiles_stats *s, uint64_t checksum);
/** Reads --box: six numbers with commas between them. */
brio_status cli_read_box(run *r, const char *text, double box[6]);
/** Returns whether a region is neither so small nor so large that its share of rounding errors says nothing. */
bool cli_volume_is_held(double volume);
/** Reports cells as brio voronoi does. */
void cli_report_tile_cells(run *r, const brio_tiles_stats *s, const brio_tiles_cells_stats *cells);
/** Writes the tetrahedra of a tile. Its vertices have the property `point`, the index in the input, and `weight` if
 *  points have weights: all files have the same properties, which the index names. */
brio_status cli_write_part(run *r, const brio_tile_part *part, bool weighted, const char *path);
/** Writes the index of a folder of files 0.vtu and so on. */
brio_status cli_write_tiles_index(run *r, const new_folder *folder, uint32_t tiles, bool weighted);
/** Writes the index of a folder of files 0.vtp and so on, which have the property `point`. */
brio_status cli_write_faces_index(run *r, const new_folder *folder, uint32_t files);

#endif
