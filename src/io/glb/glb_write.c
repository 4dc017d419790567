/* Writes GLB, the container of glTF 2.0: the JSON, then the numbers of the vertices and the indices.
 *
 * Polygons of more than three corners are cut into triangles from their first corner.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "io/glb/glb_layout.h"
#include "io/little_endian.h"
#include "io/scalar.h"

static brio_status write_words(brio_output *out, const uint32_t *words, size_t count) {
    brio_status status = BRIO_OK;
    for (size_t i = 0; i < count; i++) {
        char bytes[4];
        brio_put_le32(bytes, words[i]);
        BRIO_TRY(brio_output_bytes(out, bytes, sizeof bytes));
    }
done:
    return status;
}

static brio_status write_headers(brio_output *out, const brio_glb_layout *l) {
    enum { GLTF = 0x46546c67, JSON = 0x4e4f534a, BINARY = 0x004e4942 };
    brio_status status = BRIO_OK;
    uint32_t binary = l->size ? 8 + (uint32_t)l->size : 0, json = (uint32_t)l->json_size;
    BRIO_TRY(write_words(out, (const uint32_t[]){GLTF, 2, 12 + 8 + json + binary, json, JSON}, 5));
    BRIO_TRY(brio_output_bytes(out, l->json, l->json_size));
    if (binary) BRIO_TRY(write_words(out, (const uint32_t[]){(uint32_t)l->size, BINARY}, 2));
done:
    return status;
}

/* Puts a number of an attribute into a row and returns its size. */
static size_t put_number(char *row, int type, double value) {
    float single;
    uint32_t bits;
    switch (type) {
    case BRIO_GLB_INT8:
    case BRIO_GLB_UINT8:
        *row = (char)(int)value;
        return 1;
    case BRIO_GLB_INT16:
    case BRIO_GLB_UINT16:
        brio_put_le16(row, (uint16_t)(int)value);
        return 2;
    default:
        brio_scalar_store(&single, BRIO_SCALAR_FLOAT32, value);
        memcpy(&bits, &single, sizeof bits);
        brio_put_le32(row, bits);
        return 4;
    }
}

static brio_status write_output(brio_output *out, const brio_glb_layout *l, const brio_glb_output *o) {
    brio_status status = BRIO_OK;
    for (size_t v = 0; v < l->mesh->num_vertices; v++) {
        char row[16] = {0}, *at = row;
        for (int k = 0; k < o->components; k++)
            at += put_number(at, o->type,
                             o->from[0] ? brio_property_value(o->from[k], v)
                                        : l->mesh->vertices[3 * v + (size_t)k] - l->origin[k]);
        BRIO_TRY(brio_output_bytes(out, row, (size_t)o->stride));
    }
done:
    return status;
}

static brio_status write_triangles(brio_output *out, const brio_mesh *m) {
    brio_status status = BRIO_OK;
    for (size_t f = 0; f < m->num_faces; f++) {
        const uint32_t *corners = m->face_vertices + m->face_offsets[f];
        uint64_t count = m->face_offsets[f + 1] - m->face_offsets[f];
        for (uint64_t i = 2; i < count; i++)
            BRIO_TRY(write_words(out, (const uint32_t[]){corners[0], corners[i - 1], corners[i]}, 3));
    }
done:
    return status;
}

brio_status brio_glb_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    brio_glb_layout l;
    BRIO_TRY(brio_glb_layout_make(out->ctx, out->name, job, &l));
    BRIO_TRY(write_headers(out, &l));
    for (size_t i = 0; i < l.num_outputs; i++) BRIO_TRY(write_output(out, &l, &l.outputs[i]));
    if (l.size) {
        BRIO_TRY(write_triangles(out, l.mesh));
        BRIO_TRY(write_words(out, l.mesh->edges, 2 * l.mesh->num_edges));
    }
    if (job->options->moved) *job->options->moved = l.moved;
done:
    brio_glb_layout_free(out->ctx, &l);
    return status;
}
