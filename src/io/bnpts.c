/* Reads binary oriented points, as Kazhdan's programs for Poisson reconstruction do: records of six floats in single
 * precision, little endian, for position and normal. There is no header: the size of the file is the number of points.
 *
 * Based on: Kazhdan, Hoppe. Screened Poisson surface reconstruction. ACM Transactions on Graphics 32, 2013 (the
 * accompanying program). */
#include "io/formats.h"
#include "io/scalar.h"
#include <inttypes.h>

enum { RECORD = 24, NORMAL_AT = 12, FLOAT = 4 };

static brio_status read_point(brio_stream *s, brio_builder *b) {
    const char *bytes = NULL;
    double point[3];
    bool swap = !brio_host_is_little();
    BRIO_FORWARD(brio_stream_take(s, RECORD, &bytes));
    brio_scalar_convert_triples(point, bytes, 1, RECORD, BRIO_SCALAR_FLOAT32, swap);
    BRIO_FORWARD(brio_builder_vertex(b, point));
    for (size_t k = 0; k < 3; k++) {
        float *normal = (float *)b->mesh->properties[k].data + (b->mesh->num_vertices - 1);
        brio_scalar_gather(normal, bytes + NORMAL_AT + FLOAT * k, 1, FLOAT, FLOAT, swap);
    }
    return BRIO_OK;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    uint64_t rows = s->size / RECORD;
    bool known = s->size != BRIO_SIZE_UNKNOWN;
    BRIO_EXPECT(s->ctx, !known || s->size % RECORD == 0, BRIO_ERR_FORMAT,
                "%s: %" PRIu64 " bytes, expected a multiple of %d: records of x y z nx ny nz in single precision",
                s->name, s->size, RECORD);
    BRIO_FORWARD(brio_builder_property(b, "nx", BRIO_SCALAR_FLOAT32));
    BRIO_FORWARD(brio_builder_property(b, "ny", BRIO_SCALAR_FLOAT32));
    BRIO_FORWARD(brio_builder_property(b, "nz", BRIO_SCALAR_FLOAT32));
    if (known) BRIO_FORWARD(brio_builder_expect_vertices(b, rows));
    brio_stream_element(s, "point", known ? rows : 0);
    for (;; s->row++) {
        BRIO_FORWARD(brio_stream_fill(s, 1));
        if (!brio_stream_left(s)) break;
        if (!known) s->rows = s->row + 1;
        BRIO_FORWARD(read_point(s, b));
    }
    return BRIO_OK;
}

const brio_codec brio_bnpts_codec = {.read = read_file};
