/* The numbers of an accessor of a glTF file.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "io/glb/glb_column.h"
#include "io/little_endian.h"
#include <inttypes.h>

static size_t size_of(int type) {
    switch (type) {
    case BRIO_GLB_INT8:
    case BRIO_GLB_UINT8:
        return 1;
    case BRIO_GLB_INT16:
    case BRIO_GLB_UINT16:
        return 2;
    case BRIO_GLB_UINT32:
    case BRIO_GLB_FLOAT:
        return 4;
    default:
        return 0;
    }
}

/* Finds the bytes of a view. */
static brio_status view_bytes(const brio_glb_file *file, uint32_t view, const char **bytes) {
    brio_status status = BRIO_OK;
    const brio_glb_scene *s = &file->scene;
    BRIO_REQUIRE(file->ctx, view < s->num_views && s->views[view].buffer < s->num_buffers, BRIO_ERR_FORMAT,
                 "%s: bufferViews[%u]: expected a view of a buffer of the file", file->name, view);
    const brio_glb_view *v = &s->views[view];
    const brio_glb_buffer *buffer = &s->buffers[v->buffer];
    bool outside = !buffer->bytes && (v->buffer || !file->binary);
    BRIO_REQUIRE(file->ctx, !outside, BRIO_ERR_FORMAT, "%s: buffers[%u] has no data in the file", file->name,
                 v->buffer);
    uint64_t size = buffer->bytes || buffer->size < file->binary_size ? buffer->size : file->binary_size;
    BRIO_REQUIRE(file->ctx, v->offset <= size && v->size <= size - v->offset, BRIO_ERR_FORMAT,
                 "%s: bufferViews[%u] has bytes %" PRIu64 " to %" PRIu64 " of buffers[%u], which has %" PRIu64,
                 file->name, view, v->offset, v->offset + v->size, v->buffer, size);
    *bytes = (buffer->bytes ? buffer->bytes : file->binary) + v->offset;
done:
    return status;
}

/* Returns whether all rows lie in the view. */
static bool fits(const brio_glb_accessor *a, const brio_glb_view *v, uint64_t stride, uint64_t row) {
    uint64_t end;
    if (!a->count || stride < row) return false;
    if (__builtin_mul_overflow(a->count - 1, stride, &end) || __builtin_add_overflow(end, row, &end)) return false;
    return !__builtin_add_overflow(end, a->offset, &end) && end <= v->size;
}

brio_status brio_glb_column_of(const brio_glb_file *file, uint32_t accessor, const char *what, brio_glb_column *out) {
    brio_status status = BRIO_OK;
    const brio_glb_scene *s = &file->scene;
    const char *bytes = NULL;
    BRIO_REQUIRE(file->ctx, accessor < s->num_accessors, BRIO_ERR_FORMAT, "%s: %s: accessor %u, the file has %zu",
                 file->name, what, accessor, s->num_accessors);
    const brio_glb_accessor *a = &s->accessors[accessor];
    uint64_t row = (uint64_t)a->components * size_of(a->type);
    BRIO_REQUIRE(file->ctx, row, BRIO_ERR_FORMAT, "%s: accessors[%u]: expected SCALAR to VEC4 of a componentType",
                 file->name, accessor);
    BRIO_REQUIRE(file->ctx, !a->sparse, BRIO_ERR_FORMAT,
                 "%s: accessors[%u] is sparse, which is not read: export it without", file->name, accessor);
    BRIO_REQUIRE(file->ctx, a->view != BRIO_GLB_NONE, BRIO_ERR_FORMAT, "%s: accessors[%u] has no bufferView",
                 file->name, accessor);
    BRIO_TRY(view_bytes(file, a->view, &bytes));
    const brio_glb_view *v = &s->views[a->view];
    uint64_t stride = v->stride ? v->stride : row;
    BRIO_REQUIRE(file->ctx, fits(a, v, stride, row), BRIO_ERR_FORMAT,
                 "%s: accessors[%u] has %" PRIu64 " rows of %" PRIu64 " bytes, which are not in its view of %" PRIu64
                 " bytes",
                 file->name, accessor, a->count, row, v->size);
    *out = (brio_glb_column){bytes + a->offset, stride, a->count, a->type, a->components, a->normalized};
done:
    return status;
}

double brio_glb_raw(const brio_glb_column *c, uint64_t row, int component) {
    const char *p = c->first + row * c->stride + (size_t)component * size_of(c->type);
    float value;
    uint32_t bits;
    switch (c->type) {
    case BRIO_GLB_INT8:
        return *(const int8_t *)p;
    case BRIO_GLB_UINT8:
        return *(const uint8_t *)p;
    case BRIO_GLB_INT16:
        return (int16_t)brio_le16(p);
    case BRIO_GLB_UINT16:
        return brio_le16(p);
    case BRIO_GLB_UINT32:
        return brio_le32(p);
    default:
        bits = brio_le32(p);
        memcpy(&value, &bits, sizeof value);
        return (double)value;
    }
}

double brio_glb_scaled(const brio_glb_column *c, uint64_t row, int component) {
    double raw = brio_glb_raw(c, row, component);
    if (!c->normalized) return raw;
    switch (c->type) {
    case BRIO_GLB_INT8:
        return raw < -127 ? -1 : raw / 127;
    case BRIO_GLB_UINT8:
        return raw / 255;
    case BRIO_GLB_INT16:
        return raw < -32767 ? -1 : raw / 32767;
    case BRIO_GLB_UINT16:
        return raw / 65535;
    default:
        return raw;
    }
}
