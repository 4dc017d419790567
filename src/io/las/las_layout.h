/* What goes where in the records of a LAS file that is written. */
#ifndef BRIO_IO_LAS_LAYOUT_H
#define BRIO_IO_LAS_LAYOUT_H

#include "io/las/las_fields.h"

/** Where a property goes. */
typedef struct brio_las_place {
    size_t at;
    brio_scalar type;
    uint8_t shift, bits;
    bool extra;                   /* behind the fields of the format */
    bool renamed;                 /* whether a reader finds another name */
    unsigned raw;                 /* the type of an extra number that is scaled or has 64 bits, or 0 */
    double scale, offset;         /* raw: of the number */
    char name[BRIO_LAS_NAME + 1]; /* extra: in the file */
} brio_las_place;

/** What the values of a property are. */
typedef struct brio_las_range {
    bool whole;
    double low, high;
    bool described; /* whether all values are such as its description in the file it comes from allows */
} brio_las_range;

typedef struct brio_las_layout {
    unsigned format;
    size_t record, num_extras;
    brio_las_place *places; /* of each property */
    brio_las_range *ranges;
} brio_las_layout;

/** Widens the ranges by the properties of a block. The first block makes them. */
brio_status brio_las_layout_see(brio_context *ctx, brio_las_layout *l, const brio_mesh *block);
/** Chooses a format and gives every property its place.
 *  name  of the file, for messages.   late  whether the format must be one of version 1.4.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (more properties than a file holds), BRIO_ERR_NO_MEMORY. */
brio_status brio_las_layout_make(brio_context *ctx, brio_las_layout *l, const char *name, const brio_mesh *block,
                                 bool late);
void brio_las_layout_free(brio_context *ctx, brio_las_layout *l);

/** Makes the description of the extra number that a property becomes. */
void brio_las_describe(const brio_las_layout *l, const brio_mesh *block, size_t property, char bytes[BRIO_LAS_EXTRA]);

/** Stores value i of a property in a record whose bytes were 0. */
void brio_las_put(const brio_las_place *place, const brio_property *property, size_t i, char *record);

#endif
