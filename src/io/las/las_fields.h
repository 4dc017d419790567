/* The fields of LAS records, and how they become properties of a mesh. */
#ifndef BRIO_IO_LAS_FIELDS_H
#define BRIO_IO_LAS_FIELDS_H

#include "io/builder.h"
#include "io/las/las_header.h"
#include <stdatomic.h>

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
    brio_context *ctx;
    size_t record;
    double scale[3], offset[3];
    brio_las_column *columns;
    size_t num_columns;
    atomic_bool *rounded; /* becomes true where an integer of 64 bits is no double */
} brio_las_plan;

/** Entries of the metadata "las.extras": the name of a property, and the description that its extra bytes had. */
enum { BRIO_LAS_EXTRA_ENTRY = 64 + BRIO_LAS_EXTRA };

/** Adds the properties of a file to the mesh under construction, and the metadata "las.extras" if descriptions say more than
 *  name and type. Call brio_las_plan_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY. */
brio_status brio_las_plan_make(brio_las_plan *plan, brio_builder *b, const brio_las_header *h);
/** Adds red, green and blue alone, of a format that has them. */
brio_status brio_las_plan_colours(brio_las_plan *plan, brio_builder *b, const brio_las_header *h);
void brio_las_plan_free(brio_las_plan *plan);

/** Returns whether a format has colours. */
bool brio_las_has_colours(unsigned format);

/** Stores the coordinates and properties of `count` records as those of the mesh's vertices from `first` on. Threads
 *  may call this together for different vertices. */
void brio_las_store(const brio_las_plan *plan, const brio_mesh *mesh, const char *records, size_t first, size_t count);

#endif
