/* A simulated laser scanner. */
#ifndef BRIO_TESTDATA_SCAN_H
#define BRIO_TESTDATA_SCAN_H

#include "brio/testdata.h"
#include "base/memory.h"

/** Scans the sculpture with about n rays that hit. The options are valid. The vertices are listed view by view and row
 *  by row. The property "view" (uint16) is the index of the sensor position. */
brio_status brio_scan(brio_context *ctx, size_t n, const brio_generate_options *options, brio_mesh **out);

#endif
