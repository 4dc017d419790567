/* Coordinate systems of files, as metadata of a mesh:
 *   crs.wkt      the system as well-known text of OGC, in UTF-8
 *   crs.geokeys  the system as keys of GeoTIFF: the records 34735 to 34737 of LAS, one after the other, each behind its
 *                header of 60 bytes (the form that LAS has for records behind the points)
 *   crs.code     its code, such as "EPSG:32633", or "EPSG:32633+5773" with that of the heights
 *   crs.name     its name, such as "WGS 84 / UTM zone 33N" */
#ifndef BRIO_IO_CRS_H
#define BRIO_IO_CRS_H

#include "base/context.h"

/** Bytes of the header of a record in "crs.geokeys" and in "las.records", and where its parts are. */
enum {
    BRIO_RECORD_HEADER = 60,
    BRIO_RECORD_USER = 2,
    BRIO_RECORD_ID = 18,
    BRIO_RECORD_SIZE = 20,
    BRIO_RECORD_TEXT = 28
};

/** Goes to the next record of "crs.geokeys" or "las.records".
 *  at      0 before the first record; then behind the record that was found.
 *  header  receives the record's header, which the `size` bytes of the record follow.   Returns whether there is
 *          one. */
bool brio_record_next(const brio_metadata *records, size_t *at, const char **header, size_t *size);

/** Adds crs.code and crs.name to a mesh whose crs.wkt or crs.geokeys tell them; the text counts first.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_crs_describe(brio_mesh *mesh);

#endif
