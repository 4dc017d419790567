/* The mesh handle: points, polygons or tetrahedra over them, properties of the points. */
#include "mesh/properties.h"
#include "base/float_state.h"
#include "base/memory.h"
#include "base/utf8.h"
#include <string.h>

/* Larger counts are refused, so that sizes in bytes cannot overflow. */
static const uint64_t MOST = SIZE_MAX / 64 < UINT64_C(1) << 48 ? SIZE_MAX / 64 : UINT64_C(1) << 48;

brio_status brio_mesh_new(brio_context *ctx, brio_mesh **out) {
    brio_status status = BRIO_ALLOC_ZERO(ctx, *out, 1);
    if (status == BRIO_OK) **out = (brio_mesh){.size = sizeof **out, .context = ctx};
    return status;
}

static void free_properties(brio_context *ctx, brio_property *properties, size_t count) {
    for (size_t i = 0; i < count; i++) brio_release(ctx, properties[i].data);
    brio_release(ctx, properties);
}

void brio_mesh_free(brio_mesh *mesh) {
    if (!mesh) return;
    brio_context *ctx = mesh->context;
    free_properties(ctx, mesh->properties, mesh->num_properties);
    free_properties(ctx, mesh->face_properties, mesh->num_face_properties);
    for (size_t i = 0; i < mesh->num_metadata; i++) brio_release(ctx, mesh->metadata[i].bytes);
    brio_release(ctx, mesh->metadata);
    brio_release(ctx, mesh->vertices);
    brio_release(ctx, mesh->face_offsets);
    brio_release(ctx, mesh->face_vertices);
    brio_release(ctx, mesh->tetrahedra);
    brio_release(ctx, mesh->edges);
    brio_release(ctx, mesh);
}

brio_status brio_mesh_set_vertices(brio_mesh *mesh, const double *vertices, size_t num_vertices) {
    brio_context *ctx = mesh->context;
    double *copy = NULL;
    BRIO_EXPECT(ctx, !mesh->vertices, BRIO_ERR_ARGUMENT, "the mesh has vertices already");
    BRIO_EXPECT(ctx, !mesh->num_properties, BRIO_ERR_ARGUMENT, "the mesh has properties already: set vertices first");
    BRIO_EXPECT(ctx, num_vertices <= UINT32_MAX && num_vertices < MOST, BRIO_ERR_TOO_LARGE,
                "%zu vertices; indices have 32 bits", num_vertices);
    BRIO_FORWARD(vertices ? BRIO_ALLOC(ctx, copy, 3 * num_vertices) : BRIO_ALLOC_ZERO(ctx, copy, 3 * num_vertices));
    if (vertices && num_vertices) memcpy(copy, vertices, 3 * num_vertices * sizeof *copy);
    mesh->vertices = copy;
    mesh->num_vertices = num_vertices;
    return BRIO_OK;
}

static brio_status check_offsets(brio_context *ctx, const uint64_t *offsets, size_t num_faces) {
    BRIO_EXPECT(ctx, num_faces < MOST, BRIO_ERR_TOO_LARGE, "%zu faces", num_faces);
    if (!num_faces && !offsets) return BRIO_OK;
    BRIO_EXPECT(ctx, offsets[0] == 0, BRIO_ERR_ARGUMENT, "the first offset of faces is not 0");
    for (size_t f = 0; f < num_faces; f++)
        BRIO_EXPECT(ctx, offsets[f] <= offsets[f + 1] && offsets[f + 1] < MOST, BRIO_ERR_ARGUMENT,
                    "face %zu: its offsets decrease or are too large", f);
    return BRIO_OK;
}

brio_status brio_mesh_set_faces(brio_mesh *mesh, const uint64_t *offsets, const uint32_t *indices, size_t num_faces) {
    brio_context *ctx = mesh->context;
    uint64_t *o = NULL;
    uint32_t *v = NULL;
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, !mesh->face_offsets, BRIO_ERR_ARGUMENT, "the mesh has faces already");
    BRIO_REQUIRE(ctx, !mesh->num_face_properties, BRIO_ERR_ARGUMENT,
                 "the mesh has properties of faces already: set faces first");
    BRIO_TRY(check_offsets(ctx, offsets, num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, o, num_faces + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, v, num_faces ? offsets[num_faces] : 0));
    o[0] = 0;
    if (num_faces) memcpy(o, offsets, (num_faces + 1) * sizeof *o);
    if (o[num_faces]) memcpy(v, indices, o[num_faces] * sizeof *v);
    mesh->face_offsets = o;
    mesh->face_vertices = v;
    mesh->num_faces = num_faces;
    o = NULL;
    v = NULL;
done:
    brio_release(ctx, o);
    brio_release(ctx, v);
    return status;
}

brio_status brio_mesh_set_tetrahedra(brio_mesh *mesh, const uint32_t *tetrahedra, size_t stride,
                                     size_t num_tetrahedra) {
    brio_context *ctx = mesh->context;
    uint32_t *copy = NULL;
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(ctx, !mesh->tetrahedra, BRIO_ERR_ARGUMENT, "the mesh has tetrahedra already");
    BRIO_REQUIRE(ctx, stride >= 4, BRIO_ERR_ARGUMENT, "a stride of %zu numbers for four vertices", stride);
    BRIO_REQUIRE(ctx, num_tetrahedra < MOST, BRIO_ERR_TOO_LARGE, "%zu tetrahedra", num_tetrahedra);
    BRIO_TRY(BRIO_ALLOC(ctx, copy, 4 * num_tetrahedra));
    for (size_t t = 0; t < num_tetrahedra; t++) {
        memcpy(copy + 4 * t, tetrahedra + stride * t, 4 * sizeof *copy);
        BRIO_TRY(brio_look(ctx, 1));
    }
    mesh->tetrahedra = copy;
    mesh->num_tetrahedra = num_tetrahedra;
    copy = NULL;
done:
    brio_release(ctx, copy);
    return status;
}

brio_status brio_mesh_set_edges(brio_mesh *mesh, const uint32_t *edges, size_t num_edges) {
    brio_context *ctx = mesh->context;
    uint32_t *copy = NULL;
    BRIO_EXPECT(ctx, !mesh->edges, BRIO_ERR_ARGUMENT, "the mesh has edges already");
    BRIO_EXPECT(ctx, num_edges < MOST, BRIO_ERR_TOO_LARGE, "%zu edges", num_edges);
    BRIO_FORWARD(BRIO_ALLOC(ctx, copy, 2 * num_edges));
    if (num_edges) memcpy(copy, edges, 2 * num_edges * sizeof *copy);
    mesh->edges = copy;
    mesh->num_edges = num_edges;
    return BRIO_OK;
}

size_t brio_scalar_size(brio_scalar type) {
    static const size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
    return (unsigned)type < BRIO_SCALAR_END ? sizes[type] : 0;
}

/* --- properties --- */

/* Appends a property of `rows` numbers to a list. */
static brio_status append(brio_context *ctx, brio_property **list, size_t *count, size_t rows, const char *name,
                          brio_scalar type) {
    brio_property p = {.type = type};
    brio_status status = BRIO_OK;
    char *bytes = NULL;
    BRIO_REQUIRE(ctx, brio_scalar_size(type), BRIO_ERR_ARGUMENT, "property %s: no such scalar type", name);
    BRIO_REQUIRE(ctx, brio_utf8_copy(p.name, sizeof p.name, name) && name[0], BRIO_ERR_ARGUMENT,
                 "a property name of %zu bytes, expected 1 to 63 bytes of UTF-8", strlen(name));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, bytes, rows * brio_scalar_size(type)));
    p.data = bytes;
    BRIO_TRY(BRIO_RESIZE(ctx, *list, *count + 1));
    (*list)[(*count)++] = p;
    bytes = NULL;
done:
    brio_release(ctx, bytes);
    return status;
}

static const brio_property *find(const brio_property *list, size_t count, const char *name) {
    char clean[64];
    bool fits = brio_utf8_copy(clean, sizeof clean, name);
    for (size_t i = 0; fits && i < count; i++)
        if (!strcmp(list[i].name, clean)) return &list[i];
    return NULL;
}

/* Removes what has the name. Returns how many are left. */
static size_t remove_named(brio_context *ctx, brio_property *list, size_t count, const char *name) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++) {
        if (strcmp(list[i].name, name) != 0)
            list[kept++] = list[i];
        else
            brio_release(ctx, list[i].data);
    }
    return kept;
}

void brio_properties_move(const brio_property *list, size_t count, size_t from, size_t to) {
    for (size_t i = 0; i < count; i++) {
        size_t size = brio_scalar_size(list[i].type);
        char *rows = list[i].data;
        memmove(rows + to * size, rows + from * size, size);
    }
}

brio_mesh brio_mesh_faces_as_points(const brio_mesh *mesh) {
    return (brio_mesh){.size = sizeof(brio_mesh),
                       .context = mesh->context,
                       .num_vertices = mesh->num_faces,
                       .num_properties = mesh->num_face_properties,
                       .properties = mesh->face_properties};
}

brio_status brio_mesh_append_property(brio_mesh *mesh, const char *name, brio_scalar type) {
    return append(mesh->context, &mesh->properties, &mesh->num_properties, mesh->num_vertices, name, type);
}

brio_status brio_mesh_append_face_property(brio_mesh *mesh, const char *name, brio_scalar type) {
    return append(mesh->context, &mesh->face_properties, &mesh->num_face_properties, mesh->num_faces, name, type);
}

brio_status brio_mesh_add_property(brio_mesh *mesh, const char *name, brio_scalar type, void **data) {
    BRIO_EXPECT(mesh->context, !brio_mesh_property(mesh, name), BRIO_ERR_ARGUMENT, "two properties named %s", name);
    BRIO_FORWARD(brio_mesh_append_property(mesh, name, type));
    if (data) *data = mesh->properties[mesh->num_properties - 1].data;
    return BRIO_OK;
}

brio_status brio_mesh_add_face_property(brio_mesh *mesh, const char *name, brio_scalar type, void **data) {
    BRIO_EXPECT(mesh->context, !brio_mesh_face_property(mesh, name), BRIO_ERR_ARGUMENT,
                "two properties of faces named %s", name);
    BRIO_FORWARD(brio_mesh_append_face_property(mesh, name, type));
    if (data) *data = mesh->face_properties[mesh->num_face_properties - 1].data;
    return BRIO_OK;
}

brio_status brio_mesh_add_samples(brio_mesh *mesh, size_t num_points, const uint32_t *samples) {
    const brio_scalar type = num_points > INT32_MAX ? BRIO_SCALAR_FLOAT64 : BRIO_SCALAR_INT32;
    void *data = NULL;
    brio_status status = brio_mesh_add_property(mesh, "sample", type, &data);
    for (size_t v = 0; status == BRIO_OK && v < mesh->num_vertices; v++) {
        if (type == BRIO_SCALAR_INT32)
            ((int32_t *)data)[v] = samples ? (int32_t)samples[v] : -1;
        else
            ((double *)data)[v] = samples ? (double)samples[v] : -1;
    }
    return status;
}

void brio_mesh_drop_properties(brio_mesh *mesh, size_t left) {
    while (mesh->num_properties > left) brio_release(mesh->context, mesh->properties[--mesh->num_properties].data);
}

void brio_mesh_remove_property(brio_mesh *mesh, const char *name) {
    BRIO_DOOR;
    mesh->num_properties = remove_named(mesh->context, mesh->properties, mesh->num_properties, name);
}

void brio_mesh_remove_face_property(brio_mesh *mesh, const char *name) {
    BRIO_DOOR;
    mesh->num_face_properties = remove_named(mesh->context, mesh->face_properties, mesh->num_face_properties, name);
}

const brio_property *brio_mesh_property(const brio_mesh *mesh, const char *name) {
    return find(mesh->properties, mesh->num_properties, name);
}

const brio_property *brio_mesh_face_property(const brio_mesh *mesh, const char *name) {
    return find(mesh->face_properties, mesh->num_face_properties, name);
}

/* --- metadata --- */

const brio_metadata *brio_mesh_metadata(const brio_mesh *mesh, const char *name) {
    for (size_t i = 0; i < mesh->num_metadata; i++)
        if (!strcmp(mesh->metadata[i].name, name)) return &mesh->metadata[i];
    return NULL;
}

brio_status brio_mesh_set_metadata(brio_mesh *mesh, const char *name, const void *bytes, size_t size) {
    brio_context *ctx = mesh->context;
    brio_metadata r = {.size = size};
    brio_status status = BRIO_OK;
    size_t i = 0;
    BRIO_REQUIRE(ctx, brio_utf8_copy(r.name, sizeof r.name, name) && name[0], BRIO_ERR_ARGUMENT,
                 "a name of metadata of %zu bytes, expected 1 to 63 bytes of UTF-8", strlen(name));
    BRIO_TRY(BRIO_ALLOC(ctx, r.bytes, size + 1));
    if (size) memcpy(r.bytes, bytes, size);
    r.bytes[size] = 0;
    while (i < mesh->num_metadata && strcmp(mesh->metadata[i].name, r.name) != 0) i++;
    if (i == mesh->num_metadata) {
        BRIO_TRY(BRIO_RESIZE(ctx, mesh->metadata, mesh->num_metadata + 1));
        mesh->num_metadata++;
    } else {
        brio_release(ctx, mesh->metadata[i].bytes);
    }
    mesh->metadata[i] = r;
    r.bytes = NULL;
done:
    brio_release(ctx, r.bytes);
    return status;
}

double brio_property_value(const brio_property *property, size_t i) {
    BRIO_DOOR;
    switch (property->type) {
    case BRIO_SCALAR_INT8:
        return ((const int8_t *)property->data)[i];
    case BRIO_SCALAR_UINT8:
        return ((const uint8_t *)property->data)[i];
    case BRIO_SCALAR_INT16:
        return ((const int16_t *)property->data)[i];
    case BRIO_SCALAR_UINT16:
        return ((const uint16_t *)property->data)[i];
    case BRIO_SCALAR_INT32:
        return ((const int32_t *)property->data)[i];
    case BRIO_SCALAR_UINT32:
        return ((const uint32_t *)property->data)[i];
    case BRIO_SCALAR_FLOAT32:
        return (double)((const float *)property->data)[i];
    case BRIO_SCALAR_FLOAT64:
        return ((const double *)property->data)[i];
    case BRIO_SCALAR_END:
        break;
    }
    return 0;
}
