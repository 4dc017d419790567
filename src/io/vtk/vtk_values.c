/* Arrays that are kept as the file has them. */
#include "io/vtk/vtk_values.h"
#include "base/memory.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <string.h>

enum { PART = 1 << 16 }; /* bytes decoded at a time; chosen */

double brio_vtk_number(const brio_vtk_values *values, uint64_t i) {
    const char *p = values->bytes + i * brio_vtk_type_size(values->type);
    uint64_t raw;
    if (values->type < BRIO_SCALAR_END) return brio_scalar_load(p, (brio_scalar)values->type, false);
    memcpy(&raw, p, sizeof raw);
    return values->type == BRIO_VTK_INT64 ? (double)(int64_t)raw : (double)raw;
}

brio_status brio_vtk_bad_rows(const brio_vtk_decoder *d, uint64_t found, uint64_t rows) {
    return brio_fail(d->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: byte %" PRIu64 ": array %s has %" PRIu64 "%s rows, not %" PRIu64, d->stream->name,
                     brio_stream_offset(d->stream), d->array->name, found,
                     found > rows && d->encoding == BRIO_VTK_TEXT ? " or more" : "", rows);
}

brio_status brio_vtk_expect_rows(const brio_vtk_decoder *d, uint64_t bytes, uint64_t rows, size_t row) {
    if (bytes == UINT64_MAX) return BRIO_OK;
    if (bytes % row == 0 && (rows == UINT64_MAX || bytes / row == rows)) return BRIO_OK;
    return brio_fail(d->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: byte %" PRIu64 ": array %s has %" PRIu64 " bytes, which is not %s rows of %zu bytes",
                     d->stream->name, brio_stream_offset(d->stream), d->array->name, bytes,
                     rows == UINT64_MAX ? "a number of" : "the number of", row);
}

brio_status brio_vtk_read_values(brio_vtk_decoder *d, uint64_t bytes, uint64_t count, brio_vtk_values *out) {
    brio_status status = BRIO_OK;
    brio_stream *s = d->stream;
    size_t size = brio_vtk_type_size(d->array->type), capacity = 0, used = 0, got = 0;
    *out = (brio_vtk_values){.type = d->array->type};
    BRIO_TRY(brio_vtk_expect_rows(d, bytes, count, size));
    if (s->size != BRIO_SIZE_UNKNOWN && bytes != UINT64_MAX) capacity = (size_t)bytes;
    if (!capacity) capacity = 1; /* a place for no values, too */
    BRIO_TRY(BRIO_ALLOC(s->ctx, out->bytes, capacity));
    do {
        BRIO_TRY(BRIO_RESERVE(s->ctx, out->bytes, capacity, bytes == used ? used : used + PART));
        BRIO_TRY(brio_vtk_decoder_take(d, out->bytes + used, capacity - used < PART ? capacity - used : PART, &got));
        if (d->swap) brio_scalar_gather(out->bytes + used, out->bytes + used, got / size, size, size, true);
        used += got;
        s->row = used / size;
        if (count != UINT64_MAX && used / size > count) break;
    } while (got);
    out->count = used / size;
    if (count != UINT64_MAX && out->count != count) return brio_vtk_bad_rows(d, out->count, count);
done:
    return status;
}
