/* One rule for colours and normals: by which names they are known, how deep colours are, and what a format holds of
 * them.
 *
 * A colour is the properties red, green, blue, and alpha if its type is theirs. Its depth is what white is in them: 1,
 * 255 or 65535. Bytes have 8 bits, uint16 has 16 unless the metadata colour.depth says "8". In all other types the
 * greatest value of the whole file decides. */
#ifndef BRIO_IO_COLOUR_H
#define BRIO_IO_COLOUR_H

#include "base/context.h"

/** Properties that belong together, in their order. */
typedef struct brio_channels {
    const brio_property *of[4];
    int count; /* 0: the mesh has them not, or not in one type */
} brio_channels;

/** Returns the channels of the colour of a mesh, 3 or 4. */
brio_channels brio_colour_of(const brio_mesh *m);
/** Returns the 3 channels of the normals of a mesh: nx, ny, nz in floating-point numbers of one type. */
brio_channels brio_normal_of(const brio_mesh *m);
/** Returns whether a property is one of the channels. */
bool brio_channels_have(const brio_channels *c, const brio_property *p);

/** Returns what white is in the colours of the points of a mesh: 1, 255 or 65535. Returns 0 if the mesh has no colours,
 *  or if their numbers are none. For colours of faces give brio_mesh_faces_as_points. */
double brio_colour_white(const brio_mesh *m);
/** Returns a number of a colour as a byte. */
uint8_t brio_colour_byte(double x, double white);

/** Gives colours, normals and intensities their usual names, red green blue alpha, nx ny nz, intensity, where all of
 *  them are there under other names that are known, such as R G B or normal_x normal_y normal_z. */
void brio_colour_name(brio_mesh *m);

typedef enum {
    BRIO_COLOURS_AS_THEY_ARE, /* numbers of any type */
    BRIO_COLOURS_8,           /* bytes */
    BRIO_COLOURS_16,          /* uint16 */
    BRIO_COLOURS_8_OR_16,     /* bytes, or uint16 where the file that is read has 16 bits */
    BRIO_COLOURS_UNIT,        /* floating-point numbers from 0 to 1 */
    BRIO_COLOURS_NORMALIZED   /* bytes, uint16, or float32 from 0 to 1 */
} brio_colours;

/** How the colours of points, or of faces, become those of another file. */
typedef struct brio_colour_depth {
    brio_colours to;
    bool looked;  /* whether all blocks were seen */
    bool decided; /* whether `white` is known */
    bool guessed; /* whether it was found in the first of several blocks */
    double white; /* of the file that is read; 0: its numbers are no colours */
    double least, most;
    bool fraction; /* least, most, fraction: of the values seen */
    bool off_steps_257, off_steps_256,
        lost; /* values of 16 bits that are no bytes times 257, 256; other values rounded */
} brio_colour_depth;

/** How the colours of a file become those of another one. Faces are all in one block. */
typedef struct brio_colour_plan {
    brio_colour_depth points, faces;
} brio_colour_plan;

/** Returns whether the depth of the colours of a mesh's points shows only in all values of the file, and is not known
 *  yet. */
bool brio_colour_is_open(const brio_colour_plan *plan, const brio_mesh *m);
/** Takes note of the values of a block. */
void brio_colour_look(brio_colour_plan *plan, const brio_mesh *m);
/** Makes a view of a mesh whose colours are those of the format; everything else is the mesh's own. Without `looked`
 *  the depth is the one that the first mesh shows.
 *  shown  valid as long as the mesh; call brio_colour_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (the depth was guessed, and this block has deeper colours), BRIO_ERR_NO_MEMORY. */
brio_status brio_colour_show(brio_context *ctx, brio_colour_plan *plan, const brio_mesh *m, brio_mesh *shown);
void brio_colour_free(brio_context *ctx, const brio_mesh *m, brio_mesh *shown);

/** Returns whether the colours that were shown have lost something. */
bool brio_colour_lost(const brio_colour_plan *plan);

#endif
