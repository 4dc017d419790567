/* The binary section with the points of a scan: packets, each with a part of every field's byte stream. */
#ifndef BRIO_IO_E57_SECTION_H
#define BRIO_IO_E57_SECTION_H

#include "io/e57/e57_xml.h"

/** Where the packets of a scan are: logical offsets. */
typedef struct brio_e57_section {
    size_t scan; /* its number, for messages */
    uint64_t data, begin, end;
    bool endless; /* whether its header has no length: then the caller finds the end */
} brio_e57_section;

/** Reads the header of a scan's section. Some programs write a length of 0, or that of the header. */
brio_status brio_e57_section_open(brio_e57_pages *p, const brio_e57_scans *scans, size_t scan, brio_e57_section *out);

/** Fails if a section is too short for the records that the XML announces. */
brio_status brio_e57_section_check(const brio_e57_pages *p, const brio_e57_scans *scans,
                                   const brio_e57_section *section);

/** Decodes the packets of a section.
 *  fields    the scan's, for messages.
 *  decoders  one for each of `count` fields. */
brio_status brio_e57_section_read(brio_e57_pages *p, const brio_e57_section *section, const brio_e57_field *fields,
                                  brio_e57_decoder *decoders, size_t count);

#endif
