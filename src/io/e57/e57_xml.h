/* The XML section of an E57 file: where the points of each scan are, what they are made of, and the scans' poses. */
#ifndef BRIO_IO_E57_XML_H
#define BRIO_IO_E57_XML_H

#include "io/builder.h"
#include "io/e57/e57_bits.h"
#include "io/e57/e57_pages.h"

/* Chosen: what a false file can request. MOST_FIELDS is of a scan. */
enum { BRIO_E57_MOST_FIELDS = 256, BRIO_E57_NAME = 64, BRIO_E57_MOST_SCANS = 1 << 20 };

/** A number of each point. Its byte stream is the one of its place in the prototype. */
typedef struct brio_e57_field {
    char name[BRIO_E57_NAME]; /* as in the file; of an extension "prefix:name" */
    brio_e57_code code;
    bool text; /* strings, which are passed over */
} brio_e57_field;

typedef struct brio_e57_scan {
    uint64_t section; /* physical offset of its points */
    uint64_t records;
    size_t first_field, num_fields;
    double rotation[4], translation[3]; /* a quaternion w, x, y, z */
} brio_e57_scan;

typedef struct brio_e57_scans {
    brio_e57_scan *scans;
    brio_e57_field *fields; /* of all scans */
    size_t num_scans, scan_capacity, num_fields, field_capacity;
} brio_e57_scans;

/** Reads the XML section. What it has besides points is noted in the builder; a coordinate system becomes the metadata
 *  crs.wkt of its mesh. Call brio_e57_scans_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_e57_xml_read(brio_e57_pages *p, brio_builder *b, brio_e57_scans *out);
void brio_e57_scans_free(brio_context *ctx, brio_e57_scans *scans);

#endif
