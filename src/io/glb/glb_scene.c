/* What the JSON of a glTF file says about geometry. Every value is looked at once, so that the time is linear in the
 * size of the text whatever it holds. Indices are checked where they are used.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. */
#include "base/memory.h"
#include "io/glb/glb.h"

void brio_glb_scene_free(brio_context *ctx, brio_glb_scene *scene) {
    for (size_t i = 0; i < scene->num_buffers; i++) brio_release(ctx, scene->buffers[i].bytes);
    brio_release(ctx, scene->buffers);
    brio_release(ctx, scene->views);
    brio_release(ctx, scene->accessors);
    brio_release(ctx, scene->attributes);
    brio_release(ctx, scene->primitives);
    brio_release(ctx, scene->meshes);
    brio_release(ctx, scene->nodes);
    brio_release(ctx, scene->children);
    brio_release(ctx, scene->roots);
    *scene = (brio_glb_scene){.num_roots = 0};
}

#ifndef BRIO_HAS_CJSON

brio_status brio_glb_scene_read(brio_builder *b, bool on_disk, const char *text, size_t size, brio_glb_scene *scene) {
    (void)on_disk, (void)text, (void)size, (void)scene;
    return brio_fail(b->ctx, BRIO_ERR_FORMAT, "%s: this brio was built without cJSON, which reads glTF files", b->name);
}

#else
#include "io/base64.h"
#include "io/glb/json.h"
#include "io/limits.h"
#include "io/textrow.h"
#include "platform/file.h"
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <string.h>

/* --- buffers in other files --- */

/* Reads buffers of a glTF file that are in other files.
 *
 * A file that is read must not be able to name any file of the machine, so a URI has no scheme, begins with no slash,
 * and never goes up to the parent folder. What is behind the name must be a regular file.
 *
 * Based on: The Khronos Group. glTF 2.0 specification. ISO/IEC 12113, 2022. Berners-Lee, Fielding, Masinter. Uniform
 * Resource Identifier (URI): generic syntax. RFC 3986, 2005. */

enum { PART = 1 << 20 }; /* bytes read at a time; chosen */

/* --- the name --- */

static int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

/* Decodes %20 and the like in place. A percent sign that begins no such thing stays: exporters forget to write %25. */
static bool decode(char *text) {
    char *to = text;
    for (const char *from = text; *from; from++) {
        int high = *from == '%' ? digit(from[1]) : -1, low = high >= 0 ? digit(from[2]) : -1;
        *to = low >= 0 ? (char)(16 * high + low) : *from;
        if (!*to++) return false;
        if (low >= 0) from += 2;
    }
    *to = 0;
    return true;
}

/* Returns whether a name stays in its folder and those below. */
static bool stays(const char *name) {
    if (!*name || *name == '/' || strchr(name, '\\')) return false;
    for (const char *part = name; part; part = strchr(part, '/')) {
        part += *part == '/';
        size_t length = strcspn(part, "/");
        if (length == 2 && part[0] == '.' && part[1] == '.') return false;
    }
    return true;
}

/* Makes the path of the file.   out  owned by the caller (brio_release), on failure too. */
static brio_status make_path(brio_context *ctx, const char *path, const char *uri, size_t number, char **out) {
    size_t folder = brio_folder_length(path), length = strlen(uri);
    bool scheme = memchr(uri, ':', strcspn(uri, "/%")) != NULL;
    BRIO_FORWARD(BRIO_ALLOC(ctx, *out, folder + length + 1));
    memcpy(*out, path, folder);
    memcpy(*out + folder, uri, length + 1);
    BRIO_EXPECT(ctx, !scheme && decode(*out + folder) && stays(*out + folder), BRIO_ERR_FORMAT,
                "%s: buffers[%zu] is in %s: expected a file in the folder of the glTF file, or below it", path, number,
                brio_excerpt_of(uri).text);
    return BRIO_OK;
}

/* --- the bytes --- */

static brio_status read_all(brio_context *ctx, int file, const char *name, char *bytes, uint64_t size) {
    for (uint64_t at = 0; at < size;) {
        size_t want = size - at < PART ? (size_t)(size - at) : PART;
        BRIO_FORWARD(brio_progress(ctx, "read", 0));
        int64_t got = brio_read_bytes(file, bytes + at, want);
        if (got < 0 && errno == EINTR) continue;
        BRIO_EXPECT(ctx, got > 0, BRIO_ERR_OPEN, "%s: %s", name, got ? strerror(errno) : "ends while it is read");
        at += (uint64_t)got;
    }
    return BRIO_OK;
}

/* Reads the file that a buffer names, whole. The name is a relative URI: it may be in a folder below that of the
 * glTF file, and nowhere else.
 *  path     of the glTF file, for messages, too.   on_disk  whether it is a file with a folder.
 *  number   of the buffer, for messages.
 *  buffer   its size is what the JSON says; receives the bytes.
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
static brio_status glb_load(brio_context *ctx, const char *path, bool on_disk, const char *uri, size_t number,
                            brio_glb_buffer *buffer) {
    brio_status status = BRIO_OK;
    char *name = NULL;
    int file = -1;
    brio_place_facts facts;
    BRIO_REQUIRE(ctx, on_disk, BRIO_ERR_FORMAT,
                 "%s: buffers[%zu] is in another file, %s, which is only found beside a file: expected a .glb, which "
                 "holds its data, or data in the JSON",
                 path, number, brio_excerpt_of(uri).text);
    BRIO_TRY(make_path(ctx, path, uri, number, &name));
    file = brio_open_input(name);
    BRIO_REQUIRE(ctx, file >= 0 && brio_find_facts_open(file, &facts), BRIO_ERR_OPEN, "%s: buffers[%zu] is in %s: %s",
                 path, number, name, strerror(errno));
    BRIO_REQUIRE(ctx, facts.kind == BRIO_IS_FILE, BRIO_ERR_FORMAT,
                 "%s: buffers[%zu] is in %s, which is no regular file", path, number, name);
    BRIO_REQUIRE(ctx, facts.size >= buffer->size, BRIO_ERR_FORMAT,
                 "%s: buffers[%zu] has %" PRIu64 " bytes, the file %s has %" PRIu64, path, number, buffer->size, name,
                 facts.size);
    BRIO_TRY(BRIO_ALLOC(ctx, buffer->bytes, buffer->size));
    BRIO_TRY(read_all(ctx, file, name, buffer->bytes, buffer->size));
done:
    if (file >= 0) brio_close(file);
    brio_release(ctx, name);
    return status;
}

/* --- the JSON of a file --- */

/* Whole numbers up to this are doubles. */
#define MOST_WHOLE 0x1p53

typedef struct {
    brio_context *ctx;
    brio_builder *builder;
    const char *name;
    bool on_disk;
    size_t files; /* buffers in other files */
    const brio_json *root;
    brio_glb_scene *scene;
    size_t attribute_capacity, primitive_capacity, child_capacity;
    const char *list; /* what is being read: list[item] */
    size_t item;
} reader;

static brio_status bad(const reader *r, const char *key, const char *expected) {
    return brio_fail(r->ctx, BRIO_ERR_FORMAT, "%s: %s[%zu].%s: expected %s", r->name, r->list, r->item, key, expected);
}

/* --- values --- */

/* Reads a whole number that may be missing.   otherwise  the value then. */
static brio_status whole(const reader *r, const brio_json *object, const char *key, uint64_t otherwise, uint64_t *out) {
    const brio_json *item = brio_json_get(object, key);
    double value = 0;
    *out = otherwise;
    if (!item) return BRIO_OK;
    if (!brio_json_number(item, &value) || !(value >= 0 && value <= MOST_WHOLE) || value != floor(value))
        return bad(r, key, "a whole number");
    *out = (uint64_t)value;
    return BRIO_OK;
}

/* Reads an index that may be missing. */
static brio_status index_of(const reader *r, const brio_json *object, const char *key, uint32_t *out) {
    uint64_t value = 0;
    brio_status status = whole(r, object, key, BRIO_GLB_NONE, &value);
    *out = value < BRIO_GLB_NONE ? (uint32_t)value : BRIO_GLB_NONE;
    return status;
}

static size_t length_of(const brio_json *array) {
    size_t n = 0;
    for (const brio_json *item = brio_json_first(array); item; item = brio_json_next(item)) n++;
    return n;
}

/* Reads `count` numbers that may be missing. */
static brio_status numbers(const reader *r, const brio_json *object, const char *key, size_t count, double *out) {
    const brio_json *array = brio_json_get(object, key), *item = brio_json_first(array);
    if (!array) return BRIO_OK;
    for (size_t i = 0; i < count; i++, item = brio_json_next(item))
        if (!item || !brio_json_number(item, &out[i]) || !isfinite(out[i])) return bad(r, key, "finite numbers");
    return item ? bad(r, key, "fewer numbers") : BRIO_OK;
}

/* --- buffers, views, accessors --- */

static brio_status read_uri(reader *r, const char *uri, brio_glb_buffer *buffer) {
    static const char mark[] = ";base64,";
    const char *data = !strncmp(uri, "data:", 5) ? strstr(uri, mark) : NULL;
    size_t size = 0;
    if (!data) {
        BRIO_FORWARD(brio_limit_elements(r->ctx, r->name, 0, ++r->files));
        return glb_load(r->ctx, r->name, r->on_disk, uri, r->item, buffer);
    }
    data += strlen(mark);
    BRIO_FORWARD(BRIO_ALLOC(r->ctx, buffer->bytes, strlen(data) / 4 * 3));
    if (!brio_base64_decode(data, strlen(data), (uint8_t *)buffer->bytes, &size)) return bad(r, "uri", "base64");
    if (size < buffer->size) return bad(r, "uri", "byteLength bytes");
    return BRIO_OK;
}

static brio_status read_buffer(reader *r, const brio_json *item) {
    brio_glb_buffer *buffer = &r->scene->buffers[r->item];
    const char *uri = brio_json_string(brio_json_get(item, "uri"));
    BRIO_FORWARD(whole(r, item, "byteLength", 0, &buffer->size));
    if (uri) BRIO_FORWARD(read_uri(r, uri, buffer));
    return BRIO_OK;
}

static brio_status read_view(reader *r, const brio_json *item) {
    brio_glb_view *view = &r->scene->views[r->item];
    const brio_json *extensions = brio_json_get(item, "extensions");
    BRIO_EXPECT(r->ctx,
                !brio_json_get(extensions, "EXT_meshopt_compression") &&
                    !brio_json_get(extensions, "KHR_meshopt_compression"),
                BRIO_ERR_FORMAT, "%s: bufferViews[%zu] is compressed by meshopt, which is not read: export it without",
                r->name, r->item);
    BRIO_FORWARD(index_of(r, item, "buffer", &view->buffer));
    BRIO_FORWARD(whole(r, item, "byteOffset", 0, &view->offset));
    BRIO_FORWARD(whole(r, item, "byteLength", 0, &view->size));
    return whole(r, item, "byteStride", 0, &view->stride);
}

static brio_status read_accessor(reader *r, const brio_json *item) {
    static const struct {
        const char *name;
        int components;
    } types[] = {{"SCALAR", 1}, {"VEC2", 2}, {"VEC3", 3}, {"VEC4", 4}};
    brio_glb_accessor *a = &r->scene->accessors[r->item];
    const char *type = brio_json_string(brio_json_get(item, "type"));
    uint64_t component = 0;
    for (size_t i = 0; type && i < sizeof types / sizeof *types; i++)
        if (!strcmp(type, types[i].name)) a->components = types[i].components;
    BRIO_FORWARD(index_of(r, item, "bufferView", &a->view));
    BRIO_FORWARD(whole(r, item, "byteOffset", 0, &a->offset));
    BRIO_FORWARD(whole(r, item, "count", 0, &a->count));
    BRIO_FORWARD(whole(r, item, "componentType", 0, &component));
    a->type = component <= BRIO_GLB_FLOAT ? (int)component : 0;
    a->normalized = brio_json_is_true(brio_json_get(item, "normalized"));
    a->sparse = brio_json_get(item, "sparse") != NULL;
    return BRIO_OK;
}

/* --- meshes --- */

static brio_status read_attributes(reader *r, const brio_json *attributes, brio_glb_primitive *p) {
    brio_glb_scene *scene = r->scene;
    p->attribute = scene->num_attributes;
    for (const brio_json *item = brio_json_first(attributes); item; item = brio_json_next(item)) {
        brio_glb_attribute a = {.name = ""};
        double value = 0;
        strncat(a.name, brio_json_key(item), sizeof a.name - 1);
        if (!brio_json_number(item, &value) || !(value >= 0 && value < BRIO_GLB_NONE) || value != floor(value))
            return bad(r, "primitives.attributes", "accessors");
        a.accessor = (uint32_t)value;
        BRIO_FORWARD(BRIO_RESERVE(r->ctx, scene->attributes, r->attribute_capacity, scene->num_attributes + 1));
        scene->attributes[scene->num_attributes++] = a;
    }
    p->attributes = scene->num_attributes - p->attribute;
    return BRIO_OK;
}

static brio_status read_primitive(reader *r, const brio_json *item) {
    brio_glb_primitive p = {.mode = BRIO_GLB_TRIANGLES};
    uint64_t mode = 0;
    BRIO_FORWARD(whole(r, item, "mode", BRIO_GLB_TRIANGLES, &mode));
    if (mode >= BRIO_GLB_MODE_END) return bad(r, "primitives.mode", "a number from 0 to 6");
    p.mode = (brio_glb_mode)mode;
    BRIO_FORWARD(index_of(r, item, "indices", &p.indices));
    p.draco = brio_json_get(brio_json_get(item, "extensions"), "KHR_draco_mesh_compression") != NULL;
    p.targets = brio_json_first(brio_json_get(item, "targets")) != NULL;
    BRIO_FORWARD(read_attributes(r, brio_json_get(item, "attributes"), &p));
    BRIO_FORWARD(BRIO_RESERVE(r->ctx, r->scene->primitives, r->primitive_capacity, r->scene->num_primitives + 1));
    r->scene->primitives[r->scene->num_primitives++] = p;
    return BRIO_OK;
}

static brio_status read_mesh(reader *r, const brio_json *item) {
    brio_glb_mesh *mesh = &r->scene->meshes[r->item];
    mesh->primitive = r->scene->num_primitives;
    const brio_json *p = brio_json_first(brio_json_get(item, "primitives"));
    for (; p; p = brio_json_next(p)) BRIO_FORWARD(read_primitive(r, p));
    mesh->primitives = r->scene->num_primitives - mesh->primitive;
    return BRIO_OK;
}

/* --- nodes --- */

/* Makes the matrix of a translation, a rotation and a scale. A quaternion need not be of length 1. */
static void compose(const double *t, const double *q, const double *s, double *m) {
    double x = q[0], y = q[1], z = q[2], w = q[3], square = x * x + y * y + z * z + w * w;
    double f = square > 0 ? 2 / square : 0;
    const double rotation[9] = {1 - f * (y * y + z * z), f * (x * y + z * w),     f * (x * z - y * w),
                                f * (x * y - z * w),     1 - f * (x * x + z * z), f * (y * z + x * w),
                                f * (x * z + y * w),     f * (y * z - x * w),     1 - f * (x * x + y * y)};
    for (int column = 0; column < 3; column++) {
        for (int row = 0; row < 3; row++) m[4 * column + row] = rotation[3 * column + row] * s[column];
        m[4 * column + 3] = 0;
        m[12 + column] = t[column];
    }
    m[15] = 1;
}

static brio_status read_children(reader *r, const brio_json *item, brio_glb_node *node) {
    brio_glb_scene *scene = r->scene;
    const brio_json *child = brio_json_first(brio_json_get(item, "children"));
    node->child = scene->num_children;
    for (; child; child = brio_json_next(child)) {
        double value = 0;
        if (!brio_json_number(child, &value) || !(value >= 0 && value < (double)scene->num_nodes) ||
            value != floor(value))
            return bad(r, "children", "nodes of the file");
        BRIO_FORWARD(BRIO_RESERVE(r->ctx, scene->children, r->child_capacity, scene->num_children + 1));
        scene->children[scene->num_children++] = (uint32_t)value;
    }
    node->children = scene->num_children - node->child;
    return BRIO_OK;
}

static brio_status read_node(reader *r, const brio_json *item) {
    brio_glb_node *node = &r->scene->nodes[r->item];
    double t[3] = {0, 0, 0}, q[4] = {0, 0, 0, 1}, s[3] = {1, 1, 1};
    BRIO_EXPECT(r->ctx, !brio_json_get(brio_json_get(item, "extensions"), "EXT_mesh_gpu_instancing"), BRIO_ERR_FORMAT,
                "%s: nodes[%zu] has instances of EXT_mesh_gpu_instancing, which are not read: export it without",
                r->name, r->item);
    BRIO_FORWARD(numbers(r, item, "translation", 3, t));
    BRIO_FORWARD(numbers(r, item, "rotation", 4, q));
    BRIO_FORWARD(numbers(r, item, "scale", 3, s));
    compose(t, q, s, node->matrix);
    BRIO_FORWARD(numbers(r, item, "matrix", 16, node->matrix));
    BRIO_FORWARD(index_of(r, item, "mesh", &node->mesh));
    return read_children(r, item, node);
}

/* Finds the nodes of the default scene or, without scenes, the nodes that are nobody's children. */
static brio_status read_roots(reader *r) {
    brio_status status = BRIO_OK;
    brio_glb_scene *s = r->scene;
    const brio_json *scene = brio_json_first(brio_json_get(r->root, "scenes"));
    bool *is_child = NULL;
    uint64_t number = 0;
    r->list = "scenes";
    r->item = 0;
    BRIO_TRY(whole(r, r->root, "scene", 0, &number));
    if (scene && brio_json_next(scene)) BRIO_TRY(brio_builder_leave_out(r->builder, "other scenes"));
    for (; scene && number; number--) scene = brio_json_next(scene);
    const brio_json *nodes = brio_json_get(scene, "nodes"), *item = brio_json_first(nodes);
    BRIO_TRY(BRIO_ALLOC(r->ctx, s->roots, scene ? length_of(nodes) : s->num_nodes));
    for (; item; item = brio_json_next(item)) {
        double value = 0;
        if (!brio_json_number(item, &value) || !(value >= 0 && value < (double)s->num_nodes) || value != floor(value)) {
            status = bad(r, "nodes", "nodes of the file");
            goto done;
        }
        s->roots[s->num_roots++] = (uint32_t)value;
    }
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, is_child, s->num_nodes));
    for (size_t i = 0; i < s->num_children; i++) is_child[s->children[i]] = true;
    for (size_t i = 0; !scene && i < s->num_nodes; i++)
        if (!is_child[i]) s->roots[s->num_roots++] = (uint32_t)i;
done:
    brio_release(r->ctx, is_child);
    return status;
}

/* --- the file --- */

static brio_status check_extensions(const reader *r) {
    /* they change looks only, or are read */
    static const char *const harmless[] = {"KHR_mesh_quantization", "KHR_materials_", "KHR_texture_",  "KHR_lights_",
                                           "KHR_animation_",        "EXT_texture_",   "MSFT_texture_", "EXT_lights_",
                                           "KHR_node_visibility",   "KHR_xmp"};
    const brio_json *item = brio_json_first(brio_json_get(r->root, "extensionsRequired"));
    for (; item; item = brio_json_next(item)) {
        const char *name = brio_json_string(item);
        size_t i = 0, count = sizeof harmless / sizeof *harmless;
        if (!name) continue;
        while (i < count && strncmp(name, harmless[i], strlen(harmless[i])) != 0) i++;
        if (i == count)
            return brio_fail(r->ctx, BRIO_ERR_FORMAT,
                             "%s: needs the extension %.60s, which is not read: export it without", r->name, name);
    }
    return BRIO_OK;
}

/* Reads a list of the root.   items, count, size  the array that receives them, the number and the size of its
 * items. */
static brio_status read_list(reader *r, const char *key, void *items, size_t *count,
                             brio_status (*read)(reader *r, const brio_json *item), size_t size) {
    const brio_json *list = brio_json_get(r->root, key), *item = brio_json_first(list);
    size_t n = brio_json_is_array(list) ? length_of(list) : 0;
    if (!n) return BRIO_OK;
    BRIO_FORWARD(brio_zeroed(r->ctx, items, n, size));
    *count = n;
    r->list = key;
    for (r->item = 0; item; item = brio_json_next(item), r->item++) {
        if (!brio_json_is_object(item)) return bad(r, "", "an object");
        BRIO_FORWARD(read(r, item));
    }
    return BRIO_OK;
}

/* Notes the lists of the root that become nothing. */
static brio_status note_left_out(const reader *r) {
    static const char *const lists[][2] = {{"materials", "materials"}, {"textures", "textures"},
                                           {"images", "textures"},     {"animations", "animations"},
                                           {"skins", "skins"},         {"cameras", "cameras"}};
    static const char *const named[] = {"nodes", "meshes"};
    for (size_t i = 0; i < sizeof lists / sizeof *lists; i++)
        if (brio_json_first(brio_json_get(r->root, lists[i][0])))
            BRIO_FORWARD(brio_builder_leave_out(r->builder, lists[i][1]));
    if (brio_json_get(brio_json_get(r->root, "extensions"), "KHR_lights_punctual"))
        BRIO_FORWARD(brio_builder_leave_out(r->builder, "lights"));
    for (size_t i = 0; i < sizeof named / sizeof *named; i++) {
        const brio_json *item = brio_json_first(brio_json_get(r->root, named[i]));
        while (item && !brio_json_get(item, "name")) item = brio_json_next(item);
        if (item) BRIO_FORWARD(brio_builder_leave_out(r->builder, "names of nodes and meshes"));
    }
    return BRIO_OK;
}

/* Makes room in the lists that others point into by a first item and a count, so that none of them is NULL. */
static brio_status begin_lists(reader *r) {
    BRIO_FORWARD(BRIO_RESERVE(r->ctx, r->scene->attributes, r->attribute_capacity, 1));
    BRIO_FORWARD(BRIO_RESERVE(r->ctx, r->scene->primitives, r->primitive_capacity, 1));
    return BRIO_RESERVE(r->ctx, r->scene->children, r->child_capacity, 1);
}

brio_status brio_glb_scene_read(brio_builder *b, bool on_disk, const char *text, size_t size, brio_glb_scene *s) {
    brio_status status = BRIO_OK;
    brio_context *ctx = b->ctx;
    const char *name = b->name;
    brio_json_document document = {.ctx = ctx, .name = name};
    reader r = {.ctx = ctx, .builder = b, .name = name, .on_disk = on_disk, .scene = s};
    BRIO_TRY(brio_json_parse(&document, text, size));
    r.root = document.root;
    const char *version = brio_json_string(brio_json_get(brio_json_get(r.root, "asset"), "version"));
    BRIO_REQUIRE(ctx, version && version[0] == '2', BRIO_ERR_FORMAT, "%s: asset.version: expected glTF 2.0", name);
    BRIO_TRY(check_extensions(&r));
    BRIO_TRY(begin_lists(&r));
    BRIO_TRY(read_list(&r, "buffers", &s->buffers, &s->num_buffers, read_buffer, sizeof *s->buffers));
    BRIO_TRY(read_list(&r, "bufferViews", &s->views, &s->num_views, read_view, sizeof *s->views));
    BRIO_TRY(read_list(&r, "accessors", &s->accessors, &s->num_accessors, read_accessor, sizeof *s->accessors));
    BRIO_TRY(read_list(&r, "meshes", &s->meshes, &s->num_meshes, read_mesh, sizeof *s->meshes));
    BRIO_TRY(read_list(&r, "nodes", &s->nodes, &s->num_nodes, read_node, sizeof *s->nodes));
    BRIO_TRY(read_roots(&r));
    BRIO_TRY(note_left_out(&r));
done:
    brio_json_free(&document);
    return status;
}

#endif
