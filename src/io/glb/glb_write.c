/* Writes GLB, the container of glTF 2.0: the JSON, then the numbers of the vertices and the indices.
 *
 * Polygons of more than three corners are cut into triangles from their first corner.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "base/memory.h"
#include "io/formats.h"
#include "io/glb/glb.h"
#include "io/little_endian.h"
#include "io/number.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* --- the layout --- */

/* What a GLB file will hold, and where: planned before anything is written, because the JSON stands in front. */

/* Numbers of the vertices: POSITION, or properties. */
typedef struct brio_glb_output {
    char name[BRIO_GLB_NAME];
    int type, components, stride; /* type: BRIO_GLB_INT8 ... ; stride: bytes of a row, a multiple of 4 */
    bool normalized;
    const brio_property *from[4]; /* NULL for POSITION */
    uint64_t offset;              /* in the binary chunk */
} brio_glb_output;

typedef struct brio_glb_layout {
    const brio_mesh *mesh;
    brio_glb_output *outputs;
    size_t num_outputs;
    uint64_t num_triangles, triangles_at, edges_at; /* where their indices begin */
    uint64_t size;                                  /* of the binary chunk */
    double origin[3];                               /* coordinates are stored relative to it */
    float least[3], most[3];                        /* of the stored coordinates */
    double moved;                                   /* the greatest distance between a vertex and its stored place */
    char *json;                                     /* padded to a multiple of 4 */
    size_t json_size;
} brio_glb_layout;

/* --- JSON --- */

/* The JSON of a GLB file that is written: one scene, one node, one mesh. */

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

/* Makes the JSON of a layout. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
static brio_status glb_json(brio_context *ctx, const char *comment, brio_glb_layout *l) {
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

enum { HEADERS = 12 + 8 + 8, STEPS = 4 };

/* --- coordinates --- */

/* Single precision has 24 bits. If these hold every coordinate, the origin is 0. Otherwise coordinates are stored
 * relative to the middle of their box, rounded to a sixteenth of its longest side, if that moves vertices less. The
 * node that holds the mesh is translated by the origin, in double precision. */

/* Returns the greatest distance that a vertex moves if coordinates are stored relative to an origin; infinite if they
 * are too large. */
static double moved_by(const brio_mesh *m, const double *origin) {
    double most = 0;
    for (size_t v = 0; v < m->num_vertices; v++) {
        double square = 0;
        for (size_t k = 0; k < 3; k++) {
            double x = m->vertices[3 * v + k], relative = x - origin[k];
            if (!(fabs(relative) <= 0x1.fffffep127)) return (double)INFINITY;
            double d = (double)(float)relative + origin[k] - x;
            square += d * d;
            most = fmax(most, fabs(d)); /* squares of the smallest numbers are 0 */
        }
        most = fmax(most, sqrt(square));
    }
    return most;
}

/* Finds the middle of the box, rounded so that it has few digits. */
static void find_middle(const brio_mesh *m, double *middle) {
    double least[3], most[3], side = 0;
    for (size_t k = 0; k < 3; k++) least[k] = most[k] = m->vertices[k];
    for (size_t i = 3; i < 3 * m->num_vertices; i++) {
        least[i % 3] = fmin(least[i % 3], m->vertices[i]);
        most[i % 3] = fmax(most[i % 3], m->vertices[i]);
    }
    for (size_t k = 0; k < 3; k++) side = fmax(side, most[k] / 2 - least[k] / 2);
    double step = side > 0 ? ldexp(1, ilogb(side) + 1 - STEPS) : 0;
    for (size_t k = 0; k < 3; k++) {
        double x = least[k] / 2 + most[k] / 2, rounded = step > 0 ? rint(x / step) * step + 0.0 : x; /* no -0 */
        middle[k] = isfinite(rounded) ? rounded : 0;
    }
}

static void choose_origin(brio_glb_layout *l) {
    const brio_mesh *m = l->mesh;
    double middle[3] = {0, 0, 0}, moved = moved_by(m, l->origin);
    if (moved > 0) find_middle(m, middle);
    double less = moved > 0 ? moved_by(m, middle) : moved;
    l->moved = less < moved ? less : moved;
    for (int k = 0; k < 3; k++) l->origin[k] = less < moved ? middle[k] : 0;
    if (!isfinite(l->moved)) return;
    for (size_t i = 0; i < 3 * m->num_vertices; i++) {
        float x = (float)(m->vertices[i] - l->origin[i % 3]);
        l->least[i % 3] = i < 3 || x < l->least[i % 3] ? x : l->least[i % 3];
        l->most[i % 3] = i < 3 || x > l->most[i % 3] ? x : l->most[i % 3];
    }
}

/* --- attributes --- */

static int type_of(const brio_property *p) {
    switch (p->type) {
    case BRIO_SCALAR_INT8:
        return BRIO_GLB_INT8;
    case BRIO_SCALAR_UINT8:
        return BRIO_GLB_UINT8;
    case BRIO_SCALAR_INT16:
        return BRIO_GLB_INT16;
    case BRIO_SCALAR_UINT16:
        return BRIO_GLB_UINT16;
    default: /* attributes have no integers of 32 bits and no doubles */
        return BRIO_GLB_FLOAT;
    }
}

static void add_output(brio_glb_layout *l, const brio_glb_output *output) {
    brio_glb_output *o = &l->outputs[l->num_outputs++];
    int size = output->type == BRIO_GLB_FLOAT ? 4 : output->type >= BRIO_GLB_INT16 ? 2 : 1;
    *o = *output;
    o->stride = (size * o->components + 3) / 4 * 4;
    o->offset = l->size;
    l->size += (uint64_t)o->stride * l->mesh->num_vertices;
}

/* Adds properties that are one attribute, if the mesh has them all in one type. Returns how many were taken.
 *  names  the first three are needed, the fourth may be NULL or missing. */
static int add_group(brio_glb_layout *l, const char *name, const char *const names[4], bool floats) {
    brio_glb_output o = {.components = 0};
    strcpy(o.name, name);
    for (int k = 0; k < 4 && names[k]; k++) {
        const brio_property *p = brio_mesh_property(l->mesh, names[k]);
        bool same = p && (k == 0 || type_of(p) == o.type);
        if (!same ||
            (type_of(p) != BRIO_GLB_FLOAT && (floats || p->type == BRIO_SCALAR_INT8 || p->type == BRIO_SCALAR_INT16)))
            break;
        o.type = type_of(p);
        o.from[o.components++] = p;
    }
    if (o.components < 3) return 0;
    o.normalized = o.type != BRIO_GLB_FLOAT;
    add_output(l, &o);
    return o.components;
}

static bool is_taken(const brio_glb_layout *l, const brio_property *p) {
    for (size_t i = 0; i < l->num_outputs; i++)
        for (int k = 0; k < 4; k++)
            if (l->outputs[i].from[k] == p) return true;
    return false;
}

static brio_status plan_attributes(brio_context *ctx, brio_glb_layout *l) {
    static const char *const normal[4] = {"nx", "ny", "nz", NULL}, *const colour[4] = {"red", "green", "blue", "alpha"};
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, l->outputs, l->mesh->num_properties + 1));
    add_output(l, &(brio_glb_output){.name = "POSITION", .type = BRIO_GLB_FLOAT, .components = 3});
    add_group(l, "NORMAL", normal, true);
    add_group(l, "COLOR_0", colour, false);
    for (size_t i = 0; i < l->mesh->num_properties; i++) {
        const brio_property *p = &l->mesh->properties[i];
        brio_glb_output o = {.name = "_", .type = type_of(p), .components = 1, .from = {p}};
        if (is_taken(l, p)) continue;
        strncat(o.name, p->name, sizeof o.name - 2);
        add_output(l, &o);
    }
    return BRIO_OK;
}

/* --- indices --- */

static void plan_indices(brio_glb_layout *l) {
    const brio_mesh *m = l->mesh;
    for (size_t f = 0; f < m->num_faces; f++) {
        uint64_t corners = m->face_offsets[f + 1] - m->face_offsets[f];
        l->num_triangles += corners > 2 ? corners - 2 : 0;
    }
    l->triangles_at = l->size;
    l->edges_at = l->triangles_at + 3 * sizeof(uint32_t) * l->num_triangles;
    l->size = l->edges_at + 2 * sizeof(uint32_t) * m->num_edges;
}

/* Plans the file.   layout  call glb_layout_free, on failure too.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (coordinates beyond single precision, or a file of over 4 GiB),
 *  BRIO_ERR_NO_MEMORY. */
static brio_status glb_layout_make(brio_context *ctx, const char *name, const brio_write_job *job, brio_glb_layout *l) {
    *l = (brio_glb_layout){.mesh = job->mesh};
    if (l->mesh->num_vertices) {
        choose_origin(l);
        BRIO_EXPECT(ctx, isfinite(l->moved), BRIO_ERR_ARGUMENT, "%s: coordinates do not fit single precision", name);
        BRIO_FORWARD(plan_attributes(ctx, l));
        plan_indices(l);
    }
    BRIO_FORWARD(glb_json(ctx, job->options->comment, l));
    uint64_t size = HEADERS + l->json_size + l->size;
    BRIO_EXPECT(ctx, size <= UINT32_MAX, BRIO_ERR_ARGUMENT, "%s: %" PRIu64 " bytes, a GLB file has at most %" PRIu32,
                name, size, UINT32_MAX);
    return BRIO_OK;
}

static void glb_layout_free(brio_context *ctx, brio_glb_layout *l) {
    brio_release(ctx, l->outputs);
    brio_release(ctx, l->json);
}

/* --- the file --- */

static brio_status write_words(brio_output *out, const uint32_t *words, size_t count) {
    for (size_t i = 0; i < count; i++) {
        char bytes[4];
        brio_put_le32(bytes, words[i]);
        BRIO_FORWARD(brio_output_bytes(out, bytes, sizeof bytes));
    }
    return BRIO_OK;
}

static brio_status write_headers(brio_output *out, const brio_glb_layout *l) {
    enum { GLTF = 0x46546c67, JSON = 0x4e4f534a, BINARY = 0x004e4942 };
    uint32_t binary = l->size ? 8 + (uint32_t)l->size : 0, json = (uint32_t)l->json_size;
    BRIO_FORWARD(write_words(out, (const uint32_t[]){GLTF, 2, 12 + 8 + json + binary, json, JSON}, 5));
    BRIO_FORWARD(brio_output_bytes(out, l->json, l->json_size));
    if (binary) BRIO_FORWARD(write_words(out, (const uint32_t[]){(uint32_t)l->size, BINARY}, 2));
    return BRIO_OK;
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
    for (size_t v = 0; v < l->mesh->num_vertices; v++) {
        char row[16] = {0}, *at = row;
        for (int k = 0; k < o->components; k++)
            at += put_number(at, o->type,
                             o->from[0] ? brio_property_value(o->from[k], v)
                                        : l->mesh->vertices[3 * v + (size_t)k] - l->origin[k]);
        BRIO_FORWARD(brio_output_bytes(out, row, (size_t)o->stride));
    }
    return BRIO_OK;
}

static brio_status write_triangles(brio_output *out, const brio_mesh *m) {
    for (size_t f = 0; f < m->num_faces; f++) {
        const uint32_t *corners = m->face_vertices + m->face_offsets[f];
        uint64_t count = m->face_offsets[f + 1] - m->face_offsets[f];
        for (uint64_t i = 2; i < count; i++)
            BRIO_FORWARD(write_words(out, (const uint32_t[]){corners[0], corners[i - 1], corners[i]}, 3));
    }
    return BRIO_OK;
}

brio_status brio_glb_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    brio_glb_layout l;
    BRIO_TRY(glb_layout_make(out->ctx, out->name, job, &l));
    BRIO_TRY(write_headers(out, &l));
    for (size_t i = 0; i < l.num_outputs; i++) BRIO_TRY(write_output(out, &l, &l.outputs[i]));
    if (l.size) {
        BRIO_TRY(write_triangles(out, l.mesh));
        BRIO_TRY(write_words(out, l.mesh->edges, 2 * l.mesh->num_edges));
    }
    if (job->options->moved) *job->options->moved = l.moved;
done:
    glb_layout_free(out->ctx, &l);
    return status;
}
