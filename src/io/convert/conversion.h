/* A conversion at work: what convert.c, which writes one file, and tiles.c, which writes one for each tile, share.
 *
 * Of a conversion to tiles `to` is the pattern of their names, and while a file is written, its name. */
#ifndef BRIO_IO_CONVERT_CONVERSION_H
#define BRIO_IO_CONVERT_CONVERSION_H

#include "io/convert/rows.h"
#include "io/convert/source.h"
#include "io/row_format.h"

enum { BRIO_MOST_TILES = 1 << 16 };

typedef struct brio_conversion {
    brio_context *ctx;
    const char *to;
    const brio_convert_options *options;
    brio_write_options write;
    brio_format format;
    brio_source source;
    brio_row_writer writer;
    brio_row_writer
        all; /* tiles: was shown the points of all of them; `format` NULL: the files have nothing in common */
    brio_colour_plan colours; /* of all files */
    brio_rows rows;           /* tiles: their points */
    brio_output crs;          /* the coordinate system, if it is asked for; crs.name is NULL until it is written */
    bool told;                /* whether the losses of the parts were named */
    uint8_t *named;           /* of each property: bits of what was named of it */
    bool more;                /* whether files of other tiles follow, after which precision is named */
    bool open;                /* whether a pass ended because the depth of colours was not known */
    int dulled;               /* whether colours lost steps */
    bool rounded;             /* whether a number was rounded */
    double moved;             /* how far a coordinate was */
    uint64_t counted;
    brio_convert_stats stats;
} brio_conversion;

/** Names something that is lost. */
void brio_conversion_lose(const brio_conversion *c, const char *name);

/** Shows a block to c->writer before the writing begins, as a brio_sink. */
brio_status brio_conversion_survey(void *user, const brio_mesh *block);

/** Write the file c->to: the points of c->source row by row, with the passes that the format needs; a mesh as a whole,
 *  as a brio_sink. */
brio_status brio_conversion_stream(brio_conversion *c);
brio_status brio_conversion_write(void *user, const brio_mesh *mesh);

/** Writes a file for each tile.
 *  Returns what brio_convert returns. */
brio_status brio_conversion_tiles(brio_conversion *c);

#endif
