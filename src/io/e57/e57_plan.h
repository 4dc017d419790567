/* What becomes of the fields of all scans: coordinates and properties. */
#ifndef BRIO_IO_E57_PLAN_H
#define BRIO_IO_E57_PLAN_H

#include "io/builder.h"
#include "io/e57/e57_xml.h"

/** What a field is. PROPERTY + i is property i of the mesh. */
enum { BRIO_E57_UNUSED, BRIO_E57_AXIS, BRIO_E57_INVALID = BRIO_E57_AXIS + 3, BRIO_E57_PROPERTY };

typedef struct brio_e57_plan {
    uint32_t *roles;    /* of each field of all scans; AXIS + k is coordinate k */
    bool *spherical;    /* of each scan: the coordinates are range, azimuth, elevation */
    size_t num_columns; /* properties that are fields */
    bool has_scan;      /* the property behind them is the number of the scan */
} brio_e57_plan;

/** Finds the roles and adds the properties to the mesh. Call brio_e57_plan_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY. */
brio_status brio_e57_plan_make(brio_e57_plan *plan, brio_builder *b, const brio_e57_scans *scans);
void brio_e57_plan_free(brio_context *ctx, brio_e57_plan *plan);

#endif
