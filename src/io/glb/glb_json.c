/* The JSON of a GLB file that is written: one scene, one node, one mesh.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "base/memory.h"
#include "io/glb/glb_layout.h"
#include "io/number.h"
#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Targets of buffer views. */
enum { VERTICES = 34962, INDICES = 34963 };

/* A text that grows. After a failure nothing is added. */
typedef struct {
    brio_context *ctx;
    char *bytes;
    size_t size, capacity;
    brio_status status;
} text;

static void put_bytes(text *t, const char *bytes, size_t size) {
    if (t->status != BRIO_OK) return;
    t->status = BRIO_RESERVE(t->ctx, t->bytes, t->capacity, t->size + size);
    if (t->status != BRIO_OK) return;
    memcpy(t->bytes + t->size, bytes, size);
    t->size += size;
}

/* Adds text as printf does: at most 255 bytes, no floating-point numbers. */
static void put(text *t, const char *format, ...) __attribute__((format(printf, 2, 3)));
static void put(text *t, const char *format, ...) {
    char bytes[256];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(bytes, sizeof bytes, format, arguments);
    va_end(arguments);
    put_bytes(t, bytes, strlen(bytes));
}

static void put_string(text *t, const char *string) {
    put(t, "\"");
    for (; *string; string++) {
        unsigned char c = (unsigned char)*string;
        if (c < ' ')
            put(t, "\\u%04x", c);
        else
            put(t, c == '"' || c == '\\' ? "\\%c" : "%c", c);
    }
    put(t, "\"");
}

static void put_floats(text *t, const char *key, const float *x) {
    char number[BRIO_NUMBER_LENGTH];
    put(t, ",\"%s\":[", key);
    for (int k = 0; k < 3; k++) {
        if (k) put(t, ",");
        put_bytes(t, number, brio_print_float(number, x[k]));
    }
    put(t, "]");
}

static void put_doubles(text *t, const char *key, const double *x) {
    char number[BRIO_NUMBER_LENGTH];
    put(t, ",\"%s\":[", key);
    for (int k = 0; k < 3; k++) {
        if (k) put(t, ",");
        put_bytes(t, number, brio_print_double(number, x[k]));
    }
    put(t, "]");
}

/* --- the parts --- */

static void put_node(text *t, const brio_glb_layout *l) {
    put(t, ",\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0");
    if (l->origin[0] != 0 || l->origin[1] != 0 || l->origin[2] != 0) put_doubles(t, "translation", l->origin);
    put(t, "}]");
}

/* Adds a primitive.   mode  of glTF.   indices  its accessor, or a negative number. */
static void put_primitive(text *t, const brio_glb_layout *l, int mode, int indices) {
    put(t, "%s{\"attributes\":{", t->bytes && t->bytes[t->size - 1] == '}' ? "," : "");
    for (size_t i = 0; i < l->num_outputs; i++) {
        if (i) put(t, ",");
        put_string(t, l->outputs[i].name);
        put(t, ":%zu", i);
    }
    put(t, "},\"mode\":%d", mode);
    if (indices >= 0) put(t, ",\"indices\":%d", indices);
    put(t, "}");
}

static void put_mesh(text *t, const brio_glb_layout *l) {
    int accessor = (int)l->num_outputs;
    put(t, ",\"meshes\":[{\"primitives\":[");
    if (l->num_triangles) put_primitive(t, l, BRIO_GLB_TRIANGLES, accessor++);
    if (l->mesh->num_edges) put_primitive(t, l, BRIO_GLB_LINES, accessor);
    if (!l->num_triangles && !l->mesh->num_edges) put_primitive(t, l, BRIO_GLB_POINTS, -1);
    put(t, "]}]");
}

static void put_accessors(text *t, const brio_glb_layout *l) {
    static const char *const types[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    uint64_t indices[2] = {3 * l->num_triangles, 2 * (uint64_t)l->mesh->num_edges};
    size_t view = 0;
    put(t, ",\"accessors\":[");
    for (; view < l->num_outputs; view++) {
        const brio_glb_output *o = &l->outputs[view];
        put(t, "%s{\"bufferView\":%zu,\"componentType\":%d,\"count\":%zu,\"type\":\"%s\"%s", view ? "," : "", view,
            o->type, l->mesh->num_vertices, types[o->components], o->normalized ? ",\"normalized\":true" : "");
        if (view == 0) {
            put_floats(t, "min", l->least);
            put_floats(t, "max", l->most);
        }
        put(t, "}");
    }
    for (int i = 0; i < 2; i++)
        if (indices[i])
            put(t, ",{\"bufferView\":%zu,\"componentType\":%d,\"count\":%" PRIu64 ",\"type\":\"SCALAR\"}", view++,
                BRIO_GLB_UINT32, indices[i]);
    put(t, "]");
}

static void put_views(text *t, const brio_glb_layout *l) {
    put(t, ",\"bufferViews\":[");
    for (size_t i = 0; i < l->num_outputs; i++) {
        const brio_glb_output *o = &l->outputs[i];
        put(t, "%s{\"buffer\":0,\"byteOffset\":%" PRIu64 ",\"byteLength\":%" PRIu64 ",\"byteStride\":%d,\"target\":%d}",
            i ? "," : "", o->offset, (uint64_t)o->stride * l->mesh->num_vertices, o->stride, VERTICES);
    }
    const uint64_t ends[3] = {l->triangles_at, l->edges_at, l->size};
    for (int i = 0; i < 2; i++)
        if (ends[i + 1] > ends[i])
            put(t, ",{\"buffer\":0,\"byteOffset\":%" PRIu64 ",\"byteLength\":%" PRIu64 ",\"target\":%d}", ends[i],
                ends[i + 1] - ends[i], INDICES);
    put(t, "],\"buffers\":[{\"byteLength\":%" PRIu64 "}]", l->size);
}

brio_status brio_glb_json(brio_context *ctx, const char *comment, brio_glb_layout *l) {
    text t = {.ctx = ctx, .status = BRIO_OK};
    put(&t, "{\"asset\":{\"version\":\"2.0\",\"generator\":");
    put_string(&t, comment ? comment : "brio");
    put(&t, "},\"scene\":0");
    if (l->size) {
        put_node(&t, l);
        put_mesh(&t, l);
        put_accessors(&t, l);
        put_views(&t, l);
    } else {
        put(&t, ",\"scenes\":[{}]");
    }
    put(&t, "}");
    while (t.size % 4 && t.status == BRIO_OK) put(&t, " ");
    l->json = t.bytes;
    l->json_size = t.size;
    return t.status;
}
