/* Pictures of meshes: what the files of this folder share.
 *
 * A mesh becomes shapes: triangles, lines and discs over its vertices (shapes.c), which have colours (paint.c). The
 * eye looks along a direction, without perspective (look.c): a place is x to the right and y downwards in samples of
 * the picture, and z towards the eye in the same unit. Samples are drawn band by band (raster.c), SAMPLES by SAMPLES
 * a pixel, and their means are written as a PNG file (png.c). */
#ifndef BRIO_PICTURE_PICTURE_H
#define BRIO_PICTURE_PICTURE_H

#include "base/context.h"

/** Samples of a pixel along each axis. Chosen: with 2 steps are seen at steep edges. */
enum { BRIO_SAMPLES = 3 };

/** A colour: red, green, blue, from 0 to 255. */
typedef struct {
    uint8_t c[3];
} brio_rgb;

/** Where an eye is: unit vectors that are perpendicular to each other, `back` towards the eye. */
typedef struct {
    double right[3], up[3], back[3];
} brio_look_axes;

/** A box of all meshes, in halves, so that boxes wider than the largest double have a size. */
typedef struct {
    double centre[3], half; /* half of the longest side; 1 for a single position */
} brio_scene_box;

/** Writes a position in the unit of the box: from -1 to 1 along its longest side. */
static inline void brio_scene_place(const brio_scene_box *b, const double *p, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = 2 * ((p[k] / 2 - b->centre[k] / 2) / b->half);
}

/* --- shapes --- */

typedef enum { BRIO_LINE_EDGE, BRIO_LINE_BOUNDARY, BRIO_LINE_NONMANIFOLD, BRIO_LINE_FLIPPED } brio_line_kind;

/** I1  corner[], end[]: vertices of the mesh.
 *  I2  of[t] is the face that triangle t is part of; the number of a tetrahedron where there are tetrahedra and no
 *  faces.
 *  I3  bit k of drawn[t] says that the edge from corner k of triangle t to the next one is drawn. */
typedef struct {
    uint32_t (*corner)[3], *of;
    uint8_t *drawn;
    size_t num_triangles;
    uint32_t (*end)[2];
    uint8_t *kind; /* brio_line_kind, of each line */
    size_t num_lines, capacity, kind_capacity;
    uint8_t *crossing;       /* #F: 1 for faces that cross others; NULL where they were not looked for */
    bool discs, flat, lined; /* the vertices are drawn as discs; faces have no common normals; drawn[] counts */
} brio_shapes;

/** Finds the shapes of a mesh, checked.
 *  axes  of the tetrahedra, the half that is nearer to the eye along one coordinate is left out, so that the inside is
 *        seen.   crossings  finds the faces that cross others.
 *  out   freed with brio_shapes_free, on failure too. */
brio_status brio_shapes_find(brio_context *ctx, const brio_mesh *m, const brio_scene_box *box,
                             const brio_look_axes *axes, bool crossings, brio_shapes *out);
void brio_shapes_free(brio_context *ctx, brio_shapes *s);

/* --- colours --- */

/** The colours of a mesh: of its vertices or its faces, or one. */
typedef struct {
    brio_rgb plain;
    brio_rgb *rgb;    /* NULL, or a colour of each vertex or face */
    float *value;     /* NULL, or from 0 to 1, by which the colour map is read; NaN: grey */
    bool of_faces;    /* rgb or value have a row for each face */
    double low, high; /* of the values that the map shows; low > high: there is none */
    const char *name; /* of the property that is shown; NULL: none */
} brio_paint;

/** Finds the colours.   layer  the number of the mesh, which has a colour by it.   wanted  a property of the vertices
 * or the
 *  faces, x, y, z or "none"; NULL: colours of the mesh; of clouds without colours confidence, distance and the like,
 *  else z. found  receives whether the mesh has what is wanted.   out  freed with brio_paint_free, on failure too. */
brio_status brio_paint_find(brio_context *ctx, const brio_mesh *m, size_t layer, const char *wanted, bool *found,
                            brio_paint *out);
/** Makes p->value of what is to be shown, if there is such, in the range of p, which others may have widened. */
brio_status brio_paint_values(brio_context *ctx, const brio_mesh *m, brio_paint *p);
void brio_paint_free(brio_context *ctx, brio_paint *p);
/** Returns the colour of the map at t. */
brio_rgb brio_map_colour(float t);

/* --- where the eye is --- */

/** Finds the axes for an eye that is far away in a direction, not 0: z is up, or y for a direction along z. */
void brio_look_from(const double direction[3], brio_look_axes *axes);

/** Finds of 49 directions the one from which most of the surfaces, or most points, are seen; the first of equals. */
brio_status brio_look_best(brio_context *ctx, const brio_mesh *const *meshes, size_t count, const brio_scene_box *box,
                           double direction[3]);

/* --- the picture --- */

/** A mesh, ready to be drawn. */
typedef struct {
    const brio_mesh *mesh;
    brio_shapes shapes;
    brio_paint paint;
    double (*place)[3]; /* of the vertices, in samples */
    float (*normal)[3]; /* of the vertices, to the right, downwards and towards the eye; NULL: none */
    double radius;      /* of the discs, in samples */
} brio_drawn_mesh;

typedef struct {
    int width, height; /* in pixels */
    brio_rgb background;
    uint8_t *pixels; /* width * height * 3, row by row from above */
} brio_raster;

/** Draws meshes. Every pixel is the same, whatever the number of threads. */
brio_status brio_raster_draw(brio_context *ctx, const brio_drawn_mesh *drawn, size_t count, brio_raster *out);

/** Writes a PNG file of 8 bits a colour.   bytes  receives its size. */
brio_status brio_png_write(brio_context *ctx, const char *path, const brio_raster *raster, uint64_t *bytes);

#endif
