/* Reads glTF 2.0: GLB, a container of JSON and binary data, and .gltf, whose data are in the JSON or in files beside
 * it.
 *
 * The chunks are read into memory; what they hold is looked at afterwards.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/glb/glb.h"
#include "io/little_endian.h"
#include "io/textrow.h"
#include <inttypes.h>

/* Of the container. PART: bytes read at a time, chosen. */
enum { MAGIC = 0x46546c67, VERSION = 2, HEADER = 12, CHUNK_HEADER = 8, PART = 1 << 20 };
static const uint32_t JSON = 0x4e4f534a, BINARY = 0x004e4942;

static bool starts(const char *bytes, size_t size) {
    return size >= 4 && brio_le32(bytes) == MAGIC;
}

/* Reads bytes into a new block, with a 0 behind them; it grows as they are read.   most  UINT64_MAX: up to the end. */
static brio_status read_block(brio_stream *s, uint64_t most, char **out, uint64_t *size) {
    size_t capacity = 0;
    *size = 0;
    if (s->size != BRIO_SIZE_UNKNOWN && most != UINT64_MAX) capacity = (size_t)most + 1;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, *out, capacity));
    while (*size < most) {
        BRIO_FORWARD(brio_stream_fill(s, 1));
        size_t left = brio_stream_left(s);
        if (left > most - *size) left = (size_t)(most - *size);
        if (!left && most != UINT64_MAX) return brio_stream_truncated(s);
        if (!left) break;
        BRIO_FORWARD(BRIO_RESERVE(s->ctx, *out, capacity, *size + left + 1));
        memcpy(*out + *size, s->buffer + s->begin, left);
        s->begin += left;
        *size += left;
    }
    BRIO_FORWARD(BRIO_RESERVE(s->ctx, *out, capacity, *size + 1));
    (*out)[*size] = 0;
    return BRIO_OK;
}

static brio_status read_chunk(brio_stream *s, uint32_t type, const char *what, char **out, uint64_t *size) {
    const char *bytes = NULL;
    brio_stream_element(s, what, 1);
    BRIO_FORWARD(brio_stream_take(s, CHUNK_HEADER, &bytes));
    uint32_t length = brio_le32(bytes);
    BRIO_EXPECT(s->ctx, brio_le32(bytes + 4) == type, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected the %s", s->name,
                brio_stream_offset(s) - CHUNK_HEADER, what);
    BRIO_FORWARD(brio_stream_expect(s, length, 1, what));
    return read_block(s, length, out, size);
}

static brio_status read_container(brio_stream *s, brio_glb_file *file, char **json, uint64_t *json_size) {
    const char *bytes = NULL;
    brio_stream_element(s, "header", 1);
    BRIO_FORWARD(brio_stream_take(s, HEADER, &bytes));
    uint32_t version = brio_le32(bytes + 4), length = brio_le32(bytes + 8);
    BRIO_EXPECT(s->ctx, version == VERSION, BRIO_ERR_FORMAT, "%s: byte 4: version %u of glTF, expected 2", s->name,
                version);
    BRIO_FORWARD(read_chunk(s, JSON, "JSON chunk", json, json_size));
    if (length >= brio_stream_offset(s) + CHUNK_HEADER)
        BRIO_FORWARD(read_chunk(s, BINARY, "binary chunk", &file->binary, &file->binary_size));
    return BRIO_OK;
}

static brio_status read_file(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    brio_glb_file file = {.ctx = s->ctx, .name = s->name};
    char *json = NULL;
    uint64_t size = 0;
    BRIO_TRY(brio_stream_fill(s, 4));
    if (starts(s->buffer + s->begin, brio_stream_left(s)))
        BRIO_TRY(read_container(s, &file, &json, &size));
    else
        BRIO_TRY(read_block(s, UINT64_MAX, &json, &size));
    BRIO_TRY(brio_glb_scene_read(b, s->owned, json, (size_t)size, &file.scene));
    file.bytes = size + file.binary_size;
    for (size_t i = 0; i < file.scene.num_buffers; i++)
        if (file.scene.buffers[i].bytes) file.bytes += file.scene.buffers[i].size;
    BRIO_TRY(brio_glb_add_scene(&file, b));
done:
    brio_glb_scene_free(s->ctx, &file.scene);
    brio_release(s->ctx, file.binary);
    brio_release(s->ctx, json);
    return status;
}

const brio_codec brio_glb_codec = {.starts = starts, .read = read_file, .write = brio_glb_write};
