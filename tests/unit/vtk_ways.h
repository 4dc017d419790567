/* What the tests of VTU and VTP files share: the ways of writing, and whether this build can compress. */
#ifndef BRIO_TESTS_VTK_WAYS_H
#define BRIO_TESTS_VTK_WAYS_H

#include "io_files.h"

#define VTU_TAG "<VTKFile type=\"UnstructuredGrid\" byte_order=\"LittleEndian\""
#define VTP_TAG "<VTKFile type=\"PolyData\" byte_order=\"LittleEndian\" header_type=\"UInt64\""

typedef enum { RAW, TEXT, PACKED, NUM_WAYS } way;

static inline brio_write_options options_of(way w) {
    brio_write_options options = {0};
    options.ascii = w == TEXT;
    options.compress = w == PACKED;
    options.comment = "-- > <";
    return options;
}

/* Without compression where the library was built without zlib. */
static inline int num_ways(void) {
    static int found;
    if (found) return found;
    brio_write_options options = options_of(PACKED);
    brio_mesh *mesh = io_make(3, 0);
    found = brio_write(io_ctx, io_path("z.vtu"), mesh, &options) == BRIO_OK ? NUM_WAYS : PACKED;
    brio_mesh_free(mesh);
    if (found == PACKED) printf("skipped: compressed files: %s\n", brio_message(io_ctx));
    EXPECT(found == NUM_WAYS || strstr(brio_message(io_ctx), "zlib"), "%s", brio_message(io_ctx));
    return found;
}

#endif
