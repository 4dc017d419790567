/* The input of a command, read, and its output, written. */
#ifndef BRIO_CLI_READ_WRITE_H
#define BRIO_CLI_READ_WRITE_H

#include "cli/run/run.h"

/** Refuses options that every command has: values without a meaning, options about files that are not written, files
 *  that are named twice. */
brio_status cli_check_common(run *r);

/** Returns what the options of the command line say about reading. The library stores the counts of points that were
 *  left out, and that miss, and what else a reader found, in the run: cli_tell_input. */
brio_read_options cli_read_options(run *r);
/** Reports, and warns of, the points that reading left out and those that the file lacks. Warns of what else the user
 *  may not expect (brio_read_notes). */
void cli_tell_input(run *r, const char *path);

/** Reads an input with --input-format and --columns. The time is lapped as `read`. */
brio_status cli_read(run *r, const char *path, brio_mesh **out);

/** Refuses --columns and the other options about reading points for a command that reads none. */
brio_status cli_refuse_input_options(run *r);

/** Frees the faces, tetrahedra and edges of a mesh. */
brio_status cli_drop_connectivity(run *r, brio_mesh *mesh);

/** Reads for a command that goes by the points alone: faces and tetrahedra of the file are dropped. */
brio_status cli_read_points(run *r, const char *path, brio_mesh **out);

/** Reads the same for a command that makes a surface of the points: warns where the file has one already. */
brio_status cli_read_samples(run *r, const char *path, brio_mesh **out);

/** Refuses an option, where it was given, about a file that is not written. */
brio_status cli_require_output_for(run *r, const char *option, bool given);

/** Finds everything wrong with -o that can be found before the work: no output, no format, a format that does not hold
 *  what the command writes, a pipe where it needs a file, a folder that cannot be written.
 *  optional  the command has a use without -o also when it does not report as JSON. */
brio_status cli_require_output(run *r, bool optional);
/** Finds the same where an option changes what the command writes. */
brio_status cli_require_output_holding(run *r, cli_holds holds, bool optional);
/** Writes to -o and, where --view and --picture ask for them, a page and a picture; does nothing without them. The
 * time is
 *  lapped as `write`, `view` and `picture`. */
brio_status cli_write(run *r, const brio_mesh *mesh);
/** Writes to another file, by its extension. */
brio_status cli_write_to(run *r, const char *path, const brio_mesh *mesh);

/** Refuses a number of tiles that there cannot be, and tiles without a scratch folder. */
brio_status cli_check_tile_count(run *r, uint64_t tiles);

/* --- points in tiles (point_tiles.c) --- */

/** Returns whether a path is that of an index of files of points: .vpc or .pvtp. */
bool cli_is_point_index(const char *path);
/** Returns the extension of the files that -o, such an index, and --format ask for, without a dot. */
const char *cli_point_tile_format(const run *r);
/** Refuses what points are not written to in tiles, and an output that could not be made. */
brio_status cli_check_point_tiles(run *r, uint64_t tiles);
/** Converts the input to a file for each tile and the index -o.
 *  o  as for brio_convert; receives the tiles.   stats  receives the facts. */
brio_status cli_point_tiles(run *r, uint64_t tiles, brio_convert_options *o, brio_convert_stats *stats);

/* --- pages that show meshes in a browser, and pictures (page.c) --- */

/** Returns what a page calls a file: its name without the folders. */
const char *cli_page_name(const char *path);
/** Finds everything wrong with the name of a page that can be found before the work.   name  the option's; path NULL:
 *  no page. */
brio_status cli_check_page(run *r, const char *name, const char *path);
/** Writes a page, reports its size, and warns of points that are not on it. The time is lapped as `view`. */
brio_status cli_write_page(run *r, const char *path, const brio_page_layer *const *layers, size_t num_layers,
                           const brio_page_options *options);
/** Finds everything wrong with --picture and its options that can be found before the work. */
brio_status cli_check_picture(run *r);
/** Writes the picture of --picture, and reports from where it is seen. The time is lapped as `picture`.
 *  page  the options of a page that a picture has, too: crossings, side by side; NULL for the defaults. */
brio_status cli_write_picture(run *r, const brio_page_layer *const *layers, size_t num_layers,
                              const brio_page_options *page);
/** Writes the page of --view, with the report so far beside the mesh, and the picture of --picture; does nothing
 *  without them. */
brio_status cli_show(run *r, const brio_mesh *mesh);
/** Does the same where a picture shows another mesh than the page.
 *  colour  the property that colours the picture unless --colour-by says otherwise; NULL: as ever. */
brio_status cli_show_both(run *r, const brio_mesh *mesh, const brio_mesh *pictured, const char *colour);

/** Cells that are to be shown, as they come in parts: those that end and, of more than 8,000, an even choice. */
typedef struct shown_cells {
    uint64_t all;   /* set at first: how many cells will come, */
    bool has_sites; /* and whether 32 bits hold the sites, which are shown then */
    bool is_near;   /* they do not reach far beyond this box: */
    double low[3], high[3];
    uint64_t seen;              /* cells so far */
    size_t left_out, count;     /* cells that are not shown; parts that have some */
    brio_mesh **whole, **small; /* of each part: on a page, and in a picture */
} shown_cells;

/** Leaves out the cells that reach beyond the box of points, of all calls, by more than a quarter of its longest side.
 *  Before the cells come. */
void cli_shown_cells_stay_near(shown_cells *s, const double *points, size_t count);
/** Takes a part of the cells, with vertices.   site  in place of cells->site; or NULL. */
brio_status cli_shown_cells_add(run *r, shown_cells *s, const brio_cells *cells, const uint64_t *site);
/** Writes what cli_show_both writes, and warns of cells that are left out. BRIO_ERR_NO_ANSWER: none is shown. */
brio_status cli_shown_cells_show(run *r, const shown_cells *s);
void cli_shown_cells_free(shown_cells *s);

/** Returns how many pieces are shown of those that there are: at most `most`, and those that fit in a part of
 *  --max-memory.   bytes  of a piece. */
uint64_t cli_most_shown(const run *r, uint64_t all, double most, double bytes);
/** Shows the tetrahedra of all tiles, or of over 200,000 an even choice: one tile is in memory at a time. */
brio_status cli_show_tiles(run *r, brio_tiles *t, uint32_t tiles);

#endif
