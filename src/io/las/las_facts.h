/* What a LAS file that is written says beside its points: header and records of variable length. */
#ifndef BRIO_IO_LAS_FACTS_H
#define BRIO_IO_LAS_FACTS_H

#include "io/formats.h"
#include "io/las/las_grid.h"
#include "io/las/las_layout.h"

enum { BRIO_LAS_RETURNS = 15 };

typedef struct brio_las_facts {
    const brio_mesh *mesh; /* whose metadata are written */
    const brio_las_layout *layout;
    const brio_las_grid *grid;
    const char *comment; /* NULL, or in place of the program's name */
    uint64_t points;
    uint64_t returns[BRIO_LAS_RETURNS + 1]; /* points by the number of their return */
    bool compressed;
    uint32_t chunk; /* compressed: points of a chunk */
    uint64_t late;  /* the first byte behind the points, if it is known */
} brio_las_facts;

/** The place in the header of the first byte of the records behind the points. */
enum { BRIO_LAS_LATE_PLACE = 235 };

/** Returns how many records stand behind the points: those that are too long to stand before them. */
uint32_t brio_las_late_records(const brio_mesh *mesh);

/** Writes the header and the records before the points.   Returns BRIO_OK, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY. */
brio_status brio_las_facts_write(brio_output *out, brio_las_facts *f);
/** Writes the records behind the points. */
brio_status brio_las_late_write(brio_output *out, const brio_mesh *mesh);

#endif
