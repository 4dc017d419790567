/* The fields of LAS records, and how they become properties of a mesh. */
#ifndef BRIO_IO_LAS_FIELDS_H
#define BRIO_IO_LAS_FIELDS_H

#include "io/builder.h"
#include "io/las/las_header.h"

/** A field of a format. */
typedef struct brio_las_field {
    const char *name;
    brio_scalar type;    /* of its property */
    uint8_t at;          /* its first byte in a record */
    uint8_t shift, bits; /* bits > 0: these bits of one byte */
} brio_las_field;

enum { BRIO_LAS_FIELDS = 20 };

/** Lists the fields of a format besides the coordinates, and returns their number.
 *  fields  room for BRIO_LAS_FIELDS. */
size_t brio_las_fields_of(unsigned format, brio_las_field *fields);

/** What becomes of the bytes of a record. */
typedef struct brio_las_column {
    size_t property;
    size_t at;
    unsigned extra; /* an extra byte's type whose values become doubles, or 0 */
    brio_scalar type;
    uint8_t shift, bits;
    double scale, offset;
} brio_las_column;

typedef struct brio_las_plan {
    size_t record;
    double scale[3], offset[3];
    brio_las_column *columns;
    size_t num_columns;
} brio_las_plan;

/** Adds the properties of a file to the mesh under construction. Call brio_las_plan_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY. */
brio_status brio_las_plan_make(brio_las_plan *plan, brio_builder *b, const brio_las_header *h);
void brio_las_plan_free(brio_context *ctx, brio_las_plan *plan);

/** Stores the coordinates and properties of `count` records as those of the mesh's vertices from `first` on. Threads
 *  may call this together for different vertices. */
void brio_las_store(const brio_las_plan *plan, const brio_mesh *mesh, const char *records, size_t first, size_t count);

#endif
