/* The geometry of a glTF file as a mesh: the vertices of all primitives at their places, and properties from their
 * attributes.
 *
 * NORMAL becomes nx, ny, nz; COLOR_0 red, green, blue, alpha; _NAME becomes NAME. First all primitives are looked at,
 * to know the properties and their types: a property that has different types in two primitives is a float if it is a
 * colour, and a double otherwise; a primitive that lacks it has 0, or white. Then the vertices are added. A primitive
 * whose attributes are those of the one before it has that one's vertices.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "io/glb/glb.h"
#include "base/memory.h"
#include "io/little_endian.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- the numbers of an accessor --- */

/* The numbers of an accessor of a glTF file. */

/* Rows of numbers, all of which lie in a buffer. */
typedef struct brio_glb_column {
    const char *first;
    uint64_t stride, count;
    int type, components;
    bool normalized;
} brio_glb_column;

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
    const brio_glb_scene *s = &file->scene;
    BRIO_EXPECT(file->ctx, view < s->num_views && s->views[view].buffer < s->num_buffers, BRIO_ERR_FORMAT,
                "%s: bufferViews[%u]: expected a view of a buffer of the file", file->name, view);
    const brio_glb_view *v = &s->views[view];
    const brio_glb_buffer *buffer = &s->buffers[v->buffer];
    bool outside = !buffer->bytes && (v->buffer || !file->binary);
    BRIO_EXPECT(file->ctx, !outside, BRIO_ERR_FORMAT, "%s: buffers[%u] has no data in the file", file->name, v->buffer);
    uint64_t size = buffer->bytes || buffer->size < file->binary_size ? buffer->size : file->binary_size;
    BRIO_EXPECT(file->ctx, v->offset <= size && v->size <= size - v->offset, BRIO_ERR_FORMAT,
                "%s: bufferViews[%u] has bytes %" PRIu64 " to %" PRIu64 " of buffers[%u], which has %" PRIu64,
                file->name, view, v->offset, v->offset + v->size, v->buffer, size);
    *bytes = (buffer->bytes ? buffer->bytes : file->binary) + v->offset;
    return BRIO_OK;
}

/* Returns whether all rows lie in the view. */
static bool fits(const brio_glb_accessor *a, const brio_glb_view *v, uint64_t stride, uint64_t row) {
    uint64_t end;
    if (!a->count || stride < row) return false;
    if (__builtin_mul_overflow(a->count - 1, stride, &end) || __builtin_add_overflow(end, row, &end)) return false;
    return !__builtin_add_overflow(end, a->offset, &end) && end <= v->size;
}

/* Finds the numbers of an accessor, and checks that all of them lie in their buffer.
 *  what  what the accessor is for, for the message.
 *  Returns BRIO_OK or BRIO_ERR_FORMAT. */
static brio_status glb_column_of(const brio_glb_file *file, uint32_t accessor, const char *what, brio_glb_column *out) {
    const brio_glb_scene *s = &file->scene;
    const char *bytes = NULL;
    BRIO_EXPECT(file->ctx, accessor < s->num_accessors, BRIO_ERR_FORMAT, "%s: %s: accessor %u, the file has %zu",
                file->name, what, accessor, s->num_accessors);
    const brio_glb_accessor *a = &s->accessors[accessor];
    uint64_t row = (uint64_t)a->components * size_of(a->type);
    BRIO_EXPECT(file->ctx, row, BRIO_ERR_FORMAT, "%s: accessors[%u]: expected SCALAR to VEC4 of a componentType",
                file->name, accessor);
    BRIO_EXPECT(file->ctx, !a->sparse, BRIO_ERR_FORMAT,
                "%s: accessors[%u] is sparse, which is not read: export it without", file->name, accessor);
    BRIO_EXPECT(file->ctx, a->view != BRIO_GLB_NONE, BRIO_ERR_FORMAT, "%s: accessors[%u] has no bufferView", file->name,
                accessor);
    BRIO_FORWARD(view_bytes(file, a->view, &bytes));
    const brio_glb_view *v = &s->views[a->view];
    uint64_t stride = v->stride ? v->stride : row;
    BRIO_EXPECT(file->ctx, fits(a, v, stride, row), BRIO_ERR_FORMAT,
                "%s: accessors[%u] has %" PRIu64 " rows of %" PRIu64 " bytes, which are not in its view of %" PRIu64
                " bytes",
                file->name, accessor, a->count, row, v->size);
    *out = (brio_glb_column){bytes + a->offset, stride, a->count, a->type, a->components, a->normalized};
    return BRIO_OK;
}

/* Returns a number as it is in the file. */
static double glb_raw(const brio_glb_column *c, uint64_t row, int component) {
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

/* Returns a number with its scale: of normalized integers a number from 0 or -1 to 1. */
static double glb_scaled(const brio_glb_column *c, uint64_t row, int component) {
    double raw = glb_raw(c, row, component);
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

/* --- faces and edges --- */

/* The primitives of a glTF file as triangles and edges. */

typedef struct {
    const brio_glb_file *file;
    brio_builder *builder;
    brio_glb_column indices;
    bool indexed, flip;
    uint64_t first, count; /* vertices */
} primitive;

/* Returns corner i as a vertex of the mesh. */
static brio_status corner(const primitive *p, uint64_t i, double *vertex) {
    double index = p->indexed ? glb_raw(&p->indices, i, 0) : (double)i;
    BRIO_EXPECT(p->file->ctx, index < (double)p->count, BRIO_ERR_FORMAT,
                "%s: index %" PRIu64 " (counted from 0) of a primitive: vertex %.17g, it has %" PRIu64, p->file->name,
                i, index, p->count);
    *vertex = (double)p->first + index;
    return BRIO_OK;
}

static brio_status add_triangle(const primitive *p, uint64_t a, uint64_t b, uint64_t c) {
    const uint64_t order[3] = {a, p->flip ? c : b, p->flip ? b : c};
    double vertex = 0;
    for (int i = 0; i < 3; i++) {
        BRIO_FORWARD(corner(p, order[i], &vertex));
        BRIO_FORWARD(brio_builder_corner(p->builder, vertex));
    }
    return brio_builder_face(p->builder);
}

static brio_status add_edge(const primitive *p, uint64_t a, uint64_t b) {
    double ends[2];
    BRIO_FORWARD(corner(p, a, &ends[0]));
    BRIO_FORWARD(corner(p, b, &ends[1]));
    return brio_builder_edge(p->builder, ends);
}

static brio_status add_lines(const primitive *p, brio_glb_mode mode, uint64_t n) {
    uint64_t step = mode == BRIO_GLB_LINES ? 2 : 1;
    for (uint64_t i = 0; i + 1 < n; i += step) BRIO_FORWARD(add_edge(p, i, i + 1));
    if (mode == BRIO_GLB_LINE_LOOP && n > 1) BRIO_FORWARD(add_edge(p, n - 1, 0));
    return BRIO_OK;
}

static brio_status add_triangles(const primitive *p, brio_glb_mode mode, uint64_t n) {
    uint64_t step = mode == BRIO_GLB_TRIANGLES ? 3 : 1;
    for (uint64_t i = 0; i + 2 < n; i += step) {
        uint64_t odd = mode == BRIO_GLB_TRIANGLE_STRIP ? i % 2 : 0;
        if (mode == BRIO_GLB_TRIANGLE_FAN)
            BRIO_FORWARD(add_triangle(p, 0, i + 1, i + 2));
        else
            BRIO_FORWARD(add_triangle(p, i, i + 1 + odd, i + 2 - odd));
    }
    return BRIO_OK;
}

/* Adds the faces and edges of a primitive.
 *  first, count  its vertices.   flip  whether faces are turned round, because the place is a mirror image.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
static brio_status glb_add_cells(const brio_glb_file *file, brio_builder *b, const brio_glb_primitive *given,
                                 const uint64_t vertices[2], bool flip) {
    primitive p = {.file = file, .builder = b, .flip = flip, .first = vertices[0], .count = vertices[1]};
    p.indexed = given->indices != BRIO_GLB_NONE;
    if (p.indexed) BRIO_FORWARD(glb_column_of(file, given->indices, "indices", &p.indices));
    bool whole = !p.indexed || (p.indices.components == 1 && p.indices.type != BRIO_GLB_FLOAT);
    BRIO_EXPECT(file->ctx, whole, BRIO_ERR_FORMAT, "%s: accessors[%u]: indices are no whole numbers", file->name,
                given->indices);
    uint64_t n = p.indexed ? p.indices.count : p.count;
    BRIO_EXPECT(file->ctx,
                (given->mode != BRIO_GLB_TRIANGLES || n % 3 == 0) && (given->mode != BRIO_GLB_LINES || n % 2 == 0),
                BRIO_ERR_FORMAT, "%s: a primitive of mode %d has %" PRIu64 " corners", file->name, (int)given->mode, n);
    if (given->mode == BRIO_GLB_POINTS) return BRIO_OK;
    return given->mode < BRIO_GLB_TRIANGLES ? add_lines(&p, given->mode, n) : add_triangles(&p, given->mode, n);
}

/* --- places of meshes --- */

/* The meshes of a glTF file at their places: the matrices of the nodes multiplied from the roots down. */

/* A mesh of the file at its place. */
typedef struct brio_glb_instance {
    double matrix[16]; /* column by column, from the mesh to the scene */
    uint32_t mesh;
} brio_glb_instance;

typedef struct {
    double matrix[16]; /* of the parent */
    uint32_t node;
} task;

typedef struct {
    const brio_glb_file *file;
    task *stack;
    size_t size, capacity;
    bool *visited;
} walk;

/* Computes c = a b, of matrices whose last row is 0 0 0 1. Products with 0 and 1 leave numbers as they are. */
static void multiply(const double *a, const double *b, double *c) {
    for (int j = 0; j < 4; j++) {
        for (int i = 0; i < 3; i++) {
            double sum = a[i] * b[4 * j] + a[4 + i] * b[4 * j + 1] + a[8 + i] * b[4 * j + 2];
            c[4 * j + i] = j == 3 ? sum + a[12 + i] : sum;
        }
        c[4 * j + 3] = j == 3;
    }
}

/* Puts nodes on the stack so that the first one comes first. */
static brio_status push(walk *w, const double *matrix, const uint32_t *nodes, size_t count) {
    BRIO_FORWARD(BRIO_RESERVE(w->file->ctx, w->stack, w->capacity, w->size + count));
    for (size_t i = count; i > 0; i--) {
        task *t = &w->stack[w->size++];
        memcpy(t->matrix, matrix, sizeof t->matrix);
        t->node = nodes[i - 1];
    }
    return BRIO_OK;
}

/* Takes a node from the stack, and puts its children there.   out  its mesh and its place. */
static brio_status visit(walk *w, brio_glb_instance *out) {
    const brio_glb_scene *s = &w->file->scene;
    const task t = w->stack[--w->size];
    const brio_glb_node *node = &s->nodes[t.node];
    BRIO_EXPECT(w->file->ctx, !w->visited[t.node], BRIO_ERR_FORMAT,
                "%s: nodes[%u] is there twice: expected nodes that are a tree", w->file->name, t.node);
    w->visited[t.node] = true;
    BRIO_EXPECT(w->file->ctx, node->mesh == BRIO_GLB_NONE || node->mesh < s->num_meshes, BRIO_ERR_FORMAT,
                "%s: nodes[%u].mesh: the file has %zu meshes", w->file->name, t.node, s->num_meshes);
    multiply(t.matrix, node->matrix, out->matrix);
    out->mesh = node->mesh;
    return push(w, out->matrix, s->children + node->child, node->children);
}

/* Finds the meshes of the scene, in the order of its tree.   out  owned by the caller (brio_release), also on failure.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (no tree), BRIO_ERR_NO_MEMORY. */
static brio_status glb_instances(const brio_glb_file *file, brio_glb_instance **out, size_t *count) {
    static const double identity[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    brio_status status = BRIO_OK;
    const brio_glb_scene *s = &file->scene;
    walk w = {.file = file};
    size_t capacity = 0;
    *out = NULL;
    *count = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(file->ctx, w.visited, s->num_nodes));
    BRIO_TRY(push(&w, identity, s->roots, s->num_roots));
    while (w.size) {
        brio_glb_instance instance;
        BRIO_TRY(visit(&w, &instance));
        if (instance.mesh == BRIO_GLB_NONE) continue;
        BRIO_TRY(BRIO_RESERVE(file->ctx, *out, capacity, *count + 1));
        (*out)[(*count)++] = instance;
    }
done:
    brio_release(file->ctx, w.stack);
    brio_release(file->ctx, w.visited);
    return status;
}

/* --- the scene --- */

/* Chosen. */
enum { MOST_PROPERTIES = 256 };

/* A component of an attribute that becomes a property. */
typedef struct {
    char attribute[BRIO_GLB_NAME];
    int component, components;
    brio_scalar type;
    bool colour, normal;
} property;

typedef struct {
    const brio_glb_file *file;
    brio_builder *builder;
    const brio_glb_instance *instance;
    const brio_glb_primitive *primitive;
    property properties[MOST_PROPERTIES];
    size_t num_properties;
    bool plain, flip; /* the place leaves directions as they are; it is a mirror image */
    double normal_matrix[9];
} builder;

/* --- attributes --- */

static const brio_glb_attribute *attribute_of(const brio_glb_file *file, const brio_glb_primitive *p,
                                              const char *name) {
    const brio_glb_attribute *a = file->scene.attributes + p->attribute;
    for (size_t i = 0; i < p->attributes; i++)
        if (!strcmp(a[i].name, name)) return &a[i];
    return NULL;
}

static bool same_attributes(const brio_glb_file *file, const brio_glb_primitive *p, const brio_glb_primitive *q) {
    const brio_glb_attribute *a = file->scene.attributes + p->attribute, *b = file->scene.attributes + q->attribute;
    if (p->attributes != q->attributes) return false;
    for (size_t i = 0; i < p->attributes; i++)
        if (a[i].accessor != b[i].accessor || strcmp(a[i].name, b[i].name) != 0) return false;
    return true;
}

static brio_status positions_of(const builder *b, brio_glb_column *out) {
    const brio_glb_file *file = b->file;
    BRIO_EXPECT(file->ctx, !b->primitive->draco, BRIO_ERR_FORMAT,
                "%s: a primitive is compressed by Draco, which is not read: export it without", file->name);
    const brio_glb_attribute *a = attribute_of(file, b->primitive, "POSITION");
    BRIO_EXPECT(file->ctx, a, BRIO_ERR_FORMAT, "%s: a primitive without POSITION", file->name);
    BRIO_FORWARD(glb_column_of(file, a->accessor, a->name, out));
    BRIO_EXPECT(file->ctx, out->components == 3, BRIO_ERR_FORMAT, "%s: accessors[%u]: POSITION is no VEC3", file->name,
                a->accessor);
    return BRIO_OK;
}

/* --- properties --- */

/* Returns the type of the property that a column becomes. */
static brio_scalar type_of(const brio_glb_column *c, bool colour, bool normal) {
    static const brio_scalar types[] = {BRIO_SCALAR_INT8,  BRIO_SCALAR_UINT8,  BRIO_SCALAR_INT16,  BRIO_SCALAR_UINT16,
                                        BRIO_SCALAR_INT32, BRIO_SCALAR_UINT32, BRIO_SCALAR_FLOAT32};
    bool bytes = c->type == BRIO_GLB_UINT8 || c->type == BRIO_GLB_UINT16;
    if (normal || (colour && !bytes) || (c->normalized && !colour)) return BRIO_SCALAR_FLOAT32;
    return types[c->type - BRIO_GLB_INT8];
}

static brio_status note_column(builder *b, const char *name, const brio_glb_column *c) {
    bool colour = !strcmp(name, "COLOR_0"), normal = !strcmp(name, "NORMAL");
    brio_scalar type = type_of(c, colour, normal);
    for (int k = 0; k < c->components; k++) {
        property *p = b->properties, *end = p + b->num_properties;
        while (p < end && (p->component != k || strcmp(p->attribute, name) != 0)) p++;
        if (p < end) {
            if (p->type != type) p->type = colour ? BRIO_SCALAR_FLOAT32 : BRIO_SCALAR_FLOAT64;
            if (p->components < c->components) p->components = c->components;
            continue;
        }
        BRIO_EXPECT(b->file->ctx, b->num_properties < MOST_PROPERTIES, BRIO_ERR_FORMAT,
                    "%s: more than %d numbers a vertex", b->file->name, MOST_PROPERTIES);
        *p = (property){.component = k, .components = c->components, .type = type, .colour = colour, .normal = normal};
        memcpy(p->attribute, name, strlen(name) + 1);
        b->num_properties++;
    }
    return BRIO_OK;
}

/* Returns what an attribute that becomes no property is called. */
static const char *name_of_other(const char *attribute) {
    static const char *const names[][2] = {{"TEXCOORD_", "texture coordinates"},
                                           {"COLOR_", "further colours"},
                                           {"TANGENT", "tangents"},
                                           {"JOINTS_", "skins"},
                                           {"WEIGHTS_", "skins"}};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++)
        if (!strncmp(attribute, names[i][0], strlen(names[i][0]))) return names[i][1];
    return attribute[0] ? attribute : "attribute without a name";
}

/* Notes the attributes of a primitive that become properties. */
static brio_status note_primitive(builder *b) {
    brio_glb_column positions, c;
    const brio_glb_attribute *a = b->file->scene.attributes + b->primitive->attribute;
    BRIO_FORWARD(positions_of(b, &positions));
    if (b->primitive->targets) BRIO_FORWARD(brio_builder_leave_out(b->builder, "morph targets"));
    for (size_t i = 0; i < b->primitive->attributes; i++) {
        bool normal = !strcmp(a[i].name, "NORMAL"), colour = !strcmp(a[i].name, "COLOR_0");
        bool own = a[i].name[0] == '_' && a[i].name[1];
        if (!normal && !colour && !own) {
            if (strcmp(a[i].name, "POSITION") != 0)
                BRIO_FORWARD(brio_builder_leave_out(b->builder, name_of_other(a[i].name)));
            continue;
        }
        BRIO_FORWARD(glb_column_of(b->file, a[i].accessor, a[i].name, &c));
        BRIO_EXPECT(b->file->ctx,
                    c.count >= positions.count && (!normal || c.components == 3) && (!colour || c.components >= 3),
                    BRIO_ERR_FORMAT,
                    "%s: accessors[%u]: %s has %" PRIu64 " rows of %d numbers, the positions have %" PRIu64 " rows",
                    b->file->name, a[i].accessor, a[i].name, c.count, c.components, positions.count);
        BRIO_FORWARD(note_column(b, a[i].name, &c));
    }
    return BRIO_OK;
}

/* Makes the properties of the mesh. A name that is taken gets _2 behind it. */
static brio_status make_properties(builder *b) {
    static const char *const normal[] = {"nx", "ny", "nz"}, *const colour[] = {"red", "green", "blue", "alpha"};
    for (size_t i = 0; i < b->num_properties; i++) {
        const property *p = &b->properties[i];
        char name[64];
        if (p->normal || p->colour)
            brio_builder_new_name(b->builder, p->normal ? normal[p->component] : colour[p->component], name);
        else
            brio_builder_component_name(b->builder, p->attribute + 1, (uint64_t)p->component, (uint64_t)p->components,
                                        name);
        BRIO_FORWARD(brio_builder_property(b->builder, name, p->type));
    }
    return BRIO_OK;
}

/* --- vertices --- */

/* Finds what the place does to normals: they go by the cofactors of its matrix. */
static void set_place(builder *b, const brio_glb_instance *instance) {
    const double *m = instance->matrix;
    double determinant = 0;
    b->instance = instance;
    b->plain = true;
    for (int j = 0; j < 3; j++)
        for (int i = 0; i < 3; i++) {
            int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            b->normal_matrix[3 * j + i] = m[4 * j1 + i1] * m[4 * j2 + i2] - m[4 * j2 + i1] * m[4 * j1 + i2];
            determinant += j == 0 ? m[i] * b->normal_matrix[i] : 0;
            if (m[4 * j + i] != (i == j)) b->plain = false;
        }
    b->flip = determinant < 0;
    for (int i = 0; i < 9 && b->flip; i++) b->normal_matrix[i] = -b->normal_matrix[i];
}

/* Moves positions to their places. A coordinate that is not moved keeps its bits: -0 + 0 would be 0. */
static void place_positions(const builder *b, const brio_glb_column *c, uint64_t first) {
    const double *m = b->instance->matrix;
    for (uint64_t v = 0; v < c->count; v++) {
        double *to = b->builder->mesh->vertices + 3 * (first + v), p[3];
        for (int k = 0; k < 3; k++) p[k] = glb_scaled(c, v, k);
        for (int k = 0; k < 3; k++) {
            double turned = b->plain ? p[k] : m[k] * p[0] + m[4 + k] * p[1] + m[8 + k] * p[2];
            to[k] = m[12 + k] != 0 ? turned + m[12 + k] : turned;
        }
    }
}

static double normal_component(const builder *b, const brio_glb_column *c, uint64_t v, int component) {
    double n[3], turned[3], length = 0;
    if (b->plain) return glb_scaled(c, v, component);
    for (int k = 0; k < 3; k++) n[k] = glb_scaled(c, v, k);
    for (int k = 0; k < 3; k++) {
        const double *m = b->normal_matrix;
        turned[k] = m[k] * n[0] + m[3 + k] * n[1] + m[6 + k] * n[2];
        length += turned[k] * turned[k];
    }
    return length > 0 ? turned[component] / sqrt(length) : 0;
}

/* Returns the value of a colour where a primitive has none. */
static double white(brio_scalar type) {
    return type == BRIO_SCALAR_UINT8 ? UINT8_MAX : type == BRIO_SCALAR_UINT16 ? UINT16_MAX : 1;
}

/* Stores a property of the vertices of a primitive.   c  NULL where the primitive has no such attribute. */
static void store(const builder *b, const property *p, const brio_glb_column *c, uint64_t first, uint64_t count) {
    const brio_property *to = &b->builder->mesh->properties[p - b->properties];
    size_t size = brio_scalar_size(p->type);
    bool raw = p->type != BRIO_SCALAR_FLOAT32 && p->type != BRIO_SCALAR_FLOAT64;
    for (uint64_t v = 0; v < count; v++) {
        double value = p->colour ? white(p->type) : 0;
        if (c && p->component < c->components) {
            if (p->normal)
                value = normal_component(b, c, v, p->component);
            else
                value = raw ? glb_raw(c, v, p->component) : glb_scaled(c, v, p->component);
        }
        brio_scalar_store((char *)to->data + (first + v) * size, p->type, value);
    }
}

static brio_status add_vertices(builder *b, uint64_t vertices[2]) {
    brio_glb_column positions, c;
    BRIO_FORWARD(positions_of(b, &positions));
    vertices[0] = b->builder->mesh->num_vertices;
    vertices[1] = positions.count;
    BRIO_FORWARD(brio_builder_add_vertices(b->builder, (size_t)positions.count));
    place_positions(b, &positions, vertices[0]);
    for (size_t i = 0; i < b->num_properties; i++) {
        const brio_glb_attribute *a = attribute_of(b->file, b->primitive, b->properties[i].attribute);
        if (a) BRIO_FORWARD(glb_column_of(b->file, a->accessor, a->name, &c));
        store(b, &b->properties[i], a ? &c : NULL, vertices[0], positions.count);
    }
    return BRIO_OK;
}

/* --- the scene --- */

static brio_status add_instance(builder *b, const brio_glb_instance *instance) {
    const brio_glb_mesh *mesh = &b->file->scene.meshes[instance->mesh];
    const brio_glb_primitive *p = b->file->scene.primitives + mesh->primitive;
    uint64_t vertices[2] = {0, 0};
    set_place(b, instance);
    BRIO_FORWARD(brio_progress(b->file->ctx, "read", 1));
    for (size_t i = 0; i < mesh->primitives; i++) {
        b->primitive = &p[i];
        if (i == 0 || !same_attributes(b->file, &p[i - 1], &p[i])) BRIO_FORWARD(add_vertices(b, vertices));
        BRIO_FORWARD(glb_add_cells(b->file, b->builder, &p[i], vertices, b->flip));
    }
    return BRIO_OK;
}

/* What a mesh is made into at each of its places. */
typedef struct {
    bool noted;
    uint64_t vertices, corners;
} made;

/* Notes the primitives of a mesh, once. */
static brio_status note_mesh(builder *b, uint32_t number, made *m) {
    const brio_glb_scene *s = &b->file->scene;
    const brio_glb_mesh *mesh = &s->meshes[number];
    const brio_glb_primitive *p = s->primitives + mesh->primitive;
    brio_glb_column positions;
    if (m->noted) return BRIO_OK;
    m->noted = true;
    for (size_t i = 0; i < mesh->primitives; i++) {
        b->primitive = &p[i];
        BRIO_FORWARD(note_primitive(b));
        BRIO_FORWARD(positions_of(b, &positions));
        if (i == 0 || !same_attributes(b->file, &p[i - 1], &p[i])) m->vertices += positions.count;
        m->corners += p[i].indices < s->num_accessors ? s->accessors[p[i].indices].count : positions.count;
    }
    return BRIO_OK;
}

/* Refuses a scene that shows meshes, or accessors, so often that a small file becomes a huge mesh. Counts of accessors
 * are at most the bytes of the file, so that the sums are far from an overflow until the limit ends them. */
static brio_status check_expansion(const builder *b, const brio_glb_instance *instances, size_t count,
                                   const made *meshes) {
    const brio_glb_file *file = b->file;
    uint64_t numbers = 0;
    for (size_t i = 0; i < count; i++) {
        const made *m = &meshes[instances[i].mesh];
        uint64_t more = 0;
        if (__builtin_mul_overflow(m->vertices, 3 + b->num_properties, &more) ||
            __builtin_add_overflow(more, m->corners, &more) || __builtin_add_overflow(numbers, more, &numbers))
            numbers = UINT64_MAX;
    }
    return brio_limit_expansion(file->ctx, file->name, "the meshes at all their places", numbers, file->bytes);
}

brio_status brio_glb_add_scene(const brio_glb_file *file, brio_builder *out) {
    brio_status status = BRIO_OK;
    brio_glb_instance *instances = NULL;
    builder *b = NULL;
    made *meshes = NULL;
    size_t count = 0;
    BRIO_TRY(glb_instances(file, &instances, &count));
    BRIO_TRY(BRIO_ALLOC_ZERO(file->ctx, b, 1));
    b->file = file;
    b->builder = out;
    BRIO_TRY(BRIO_ALLOC_ZERO(file->ctx, meshes, file->scene.num_meshes));
    for (size_t i = 0; i < count; i++) BRIO_TRY(note_mesh(b, instances[i].mesh, &meshes[instances[i].mesh]));
    BRIO_TRY(check_expansion(b, instances, count, meshes));
    BRIO_TRY(make_properties(b));
    for (size_t i = 0; i < count; i++) BRIO_TRY(add_instance(b, &instances[i]));
done:
    brio_release(file->ctx, instances);
    brio_release(file->ctx, meshes);
    brio_release(file->ctx, b);
    return status;
}
