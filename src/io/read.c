/* Reads a file, or bytes in memory: finds the format and calls the format's reader. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "io/blocks.h"
#include "io/read_job.h"
#include "io/unpack.h"
#include <string.h>
#include <strings.h>
#include <unistd.h>

/* Bytes of a file in which its content may show the format. */
enum { START = BRIO_IO_BLOCK < 4096 ? BRIO_IO_BLOCK : 4096 };

static const struct {
    const char *extension;
    brio_format format;
} extensions[] = {{"ply", BRIO_FORMAT_PLY},     {"xyz", BRIO_FORMAT_XYZ},           {"pts", BRIO_FORMAT_XYZ},
                  {"txt", BRIO_FORMAT_XYZ},     {"csv", BRIO_FORMAT_XYZ},           {"obj", BRIO_FORMAT_OBJ},
                  {"off", BRIO_FORMAT_OFF},     {"vtu", BRIO_FORMAT_VTU},           {"node", BRIO_FORMAT_NODE},
                  {"ele", BRIO_FORMAT_NODE},    {"vtp", BRIO_FORMAT_VTP},           {"las", BRIO_FORMAT_LAS},
                  {"laz", BRIO_FORMAT_LAZ},     {"pcd", BRIO_FORMAT_PCD},           {"ptx", BRIO_FORMAT_PTX},
                  {"stl", BRIO_FORMAT_STL},     {"npy", BRIO_FORMAT_NPY},           {"npz", BRIO_FORMAT_NPZ},
                  {"glb", BRIO_FORMAT_GLB},     {"gltf", BRIO_FORMAT_GLB},          {"e57", BRIO_FORMAT_E57},
                  {"bnpts", BRIO_FORMAT_BNPTS}, {"chemical", BRIO_FORMAT_CHEMICAL}, {"extxyz", BRIO_FORMAT_CHEMICAL}};

static const brio_read_options STANDARD = {.size = sizeof STANDARD, .format = BRIO_FORMAT_AUTO};

BRIO_OPTIONS_INIT(brio_read_options)

/* Returns the part of a name behind its last dot, or the whole name if there is none. */
static const char *extension_of(const char *path) {
    const char *slash = strrchr(path, '/'), *name = slash ? slash + 1 : path, *dot = strrchr(name, '.');
    return dot ? dot + 1 : name;
}

/* Whether the extension of a name, which may have .gz or .zst behind it, is the one wanted. */
static bool has_extension(const char *path, const char *wanted) {
    size_t stem = brio_unpacked_length(path), length = strlen(wanted);
    if (stem == strlen(path)) return !strcasecmp(extension_of(path), wanted);
    return stem > length && path[stem - length - 1] == '.' && !strncasecmp(path + stem - length, wanted, length);
}

brio_format brio_format_of(const char *path) {
    const char *extension = extension_of(path);
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (!strcasecmp(extension, extensions[i].extension)) return extensions[i].format;
    return BRIO_FORMAT_AUTO;
}

/* Returns the format by the extension of a file that may be compressed. */
static brio_format format_to_read(const char *path) {
    for (size_t i = 0; i < sizeof extensions / sizeof *extensions; i++)
        if (has_extension(path, extensions[i].extension)) return extensions[i].format;
    return BRIO_FORMAT_AUTO;
}

bool brio_is_ele(const char *path) {
    return has_extension(path, "ele");
}

/* Returns the length of a path of the pair .node and .ele without its extension, or of any other path. */
static size_t length_of_stem(const char *path) {
    size_t length = brio_unpacked_length(path);
    size_t extension = has_extension(path, "node") ? 5 : has_extension(path, "ele") ? 4 : 0;
    return extension && length >= extension && path[length - extension] == '.' ? length - extension : strlen(path);
}

bool brio_is_gltf(const char *path) {
    return has_extension(path, "gltf");
}

brio_status brio_sibling(brio_context *ctx, const char *path, const char *extension, char **out) {
    brio_status status = BRIO_OK;
    size_t stem = length_of_stem(path);
    const char *packed = path[stem] ? path + brio_unpacked_length(path) : "";
    BRIO_TRY(BRIO_ALLOC(ctx, *out, stem + strlen(extension) + strlen(packed) + 1));
    memcpy(*out, path, stem);
    strcpy(stpcpy(*out + stem, extension), packed);
done:
    return status;
}

/* Finds the format by the content or, failing that, the extension. What has no name (standard input, "-") and is in no
 * known format is read as rows of numbers; so is a file .xyz whose columns have names from the caller, whatever its first line. */
static brio_status find_format(brio_stream *s, const char *path, brio_read_job *job) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_stream_fill(s, START));
    const char *bytes = s->buffer + s->begin;
    size_t size = brio_stream_left(s);
    if (brio_ply_starts(bytes, size))
        job->format = BRIO_FORMAT_PLY;
    else if (brio_off_starts(bytes, size))
        job->format = BRIO_FORMAT_OFF;
    else if (brio_vtk_starts(bytes, size))
        job->format = BRIO_FORMAT_VTU;
    else if (brio_las_starts(bytes, size))
        job->format = BRIO_FORMAT_LAS;
    else if (brio_pcd_starts(bytes, size))
        job->format = BRIO_FORMAT_PCD;
    else if (brio_npy_starts(bytes, size))
        job->format = BRIO_FORMAT_NPY;
    else if (brio_glb_starts(bytes, size))
        job->format = BRIO_FORMAT_GLB;
    else if (brio_e57_starts(bytes, size))
        job->format = BRIO_FORMAT_E57;
    else if (brio_npz_starts(bytes, size))
        job->format = BRIO_FORMAT_NPZ;
    else
        job->format = strcmp(path, "-") ? format_to_read(path) : BRIO_FORMAT_XYZ;
    bool may_be_chemical = job->format == BRIO_FORMAT_XYZ && (!strcmp(path, "-") || has_extension(path, "xyz"));
    if (may_be_chemical && !job->columns && brio_chemical_starts(bytes, size)) job->format = BRIO_FORMAT_CHEMICAL;
    BRIO_REQUIRE(s->ctx, job->format != BRIO_FORMAT_AUTO, BRIO_ERR_FORMAT,
                 "%s: unknown format, expected .ply .xyz .pts .txt .csv .obj .off .vtu .vtp .node .ele .las .laz .pcd "
                 ".ptx .stl .npy .npz .glb .gltf .e57 or .bnpts",
                 s->name);
done:
    return status;
}

static brio_status read_stream(brio_stream *s, brio_builder *b, brio_format format, const char *columns) {
    switch (format) {
    case BRIO_FORMAT_PLY:
        return brio_ply_read(s, b);
    case BRIO_FORMAT_XYZ:
        return brio_xyz_read(s, b, columns);
    case BRIO_FORMAT_OBJ:
        return brio_obj_read(s, b);
    case BRIO_FORMAT_OFF:
        return brio_off_read(s, b);
    case BRIO_FORMAT_VTU:
    case BRIO_FORMAT_VTP:
        return brio_vtk_read(s, b);
    case BRIO_FORMAT_NODE:
        return brio_node_read(s, b);
    case BRIO_FORMAT_LAS:
    case BRIO_FORMAT_LAZ:
        return brio_las_read(s, b);
    case BRIO_FORMAT_PCD:
        return brio_pcd_read(s, b);
    case BRIO_FORMAT_PTX:
        return brio_ptx_read(s, b);
    case BRIO_FORMAT_STL:
        return brio_stl_read(s, b);
    case BRIO_FORMAT_NPY:
        return brio_npy_read(s, b);
    case BRIO_FORMAT_GLB:
        return brio_glb_read(s, b);
    case BRIO_FORMAT_E57:
        return brio_e57_read(s, b);
    case BRIO_FORMAT_CHEMICAL:
        return brio_chemical_read(s, b);
    case BRIO_FORMAT_BNPTS:
        return brio_bnpts_read(s, b);
    case BRIO_FORMAT_NPZ:
        return brio_npz_read(s, b);
    case BRIO_FORMAT_AUTO:
    case BRIO_FORMAT_END:
        break;
    }
    return brio_fail(s->ctx, BRIO_ERR_ARGUMENT, "%s: no such format: %d", s->name, (int)format);
}

/* Reads the tetrahedra in the .ele file beside a .node file. The file may be missing unless `asked_for` is set. */
static brio_status read_tetrahedra(brio_builder *b, const char *path, bool asked_for) {
    brio_status status = BRIO_OK;
    brio_stream s = {.ctx = b->ctx, .file = -1};
    char *ele = NULL;
    BRIO_TRY(brio_sibling(b->ctx, path, ".ele", &ele));
    if (asked_for || access(ele, F_OK) == 0) {
        BRIO_TRY(brio_stream_open(&s, b->ctx, ele));
        BRIO_TRY(brio_ele_read(&s, b));
    }
done:
    brio_stream_close(&s);
    brio_release(b->ctx, ele);
    return status;
}

/* Refuses names of columns for a format that has none. */
static brio_status check_columns(const brio_stream *s, brio_format format, const char *columns) {
    if (!columns || format == BRIO_FORMAT_XYZ) return BRIO_OK;
    return brio_fail(s->ctx, BRIO_ERR_ARGUMENT,
                     "%s: columns are named (--columns), but only texts of points (.xyz .pts .txt .csv) have columns",
                     s->name);
}

/* Opens a file, or memory under its name.   path  of the file to open, which is not always the job's own. */
static brio_status open_job(brio_stream *s, brio_context *ctx, const brio_read_job *job, const char *path) {
    if (!job->memory) return brio_stream_open(s, ctx, path);
    const char *name = strcmp(path, "-") ? path : "memory";
    return brio_stream_open_memory(s, ctx, name, job->memory->bytes, job->memory->size);
}

brio_status brio_read_file(brio_context *ctx, brio_read_job *job) {
    brio_status status = BRIO_OK;
    brio_stream s = {.ctx = ctx, .file = -1};
    brio_builder b = {.ctx = ctx};
    char *node = NULL;
    job->mesh = NULL;
    bool tetrahedra = (job->format == BRIO_FORMAT_AUTO || job->format == BRIO_FORMAT_NODE) && brio_is_ele(job->path);
    BRIO_REQUIRE(ctx, !tetrahedra || !job->memory, BRIO_ERR_ARGUMENT,
                 "%s: the .ele file of a .node file is read beside it, not from memory", job->path);
    if (tetrahedra) BRIO_TRY(brio_sibling(ctx, job->path, ".node", &node));
    BRIO_TRY(open_job(&s, ctx, job, node ? node : job->path));
    if (job->format == BRIO_FORMAT_AUTO) BRIO_TRY(find_format(&s, node ? node : job->path, job));
    BRIO_TRY(check_columns(&s, job->format, job->columns));
    BRIO_TRY(brio_builder_start(&b, ctx, s.name));
    b.sink = job->sink;
    b.announced = &job->announced;
    BRIO_TRY(read_stream(&s, &b, job->format, job->columns));
    if (job->format == BRIO_FORMAT_NODE && !job->memory && strcmp(job->path, "-") != 0)
        BRIO_TRY(read_tetrahedra(&b, job->path, tetrahedra));
    BRIO_TRY(brio_builder_finish(&b));
    BRIO_TRY(brio_progress(ctx, "read", 1));
    memcpy(job->version, b.version, sizeof job->version);
    job->streamed = b.streams;
    if (b.streams) goto done;
    job->mesh = b.mesh;
    b.mesh = NULL;
done:
    brio_mesh_free(b.mesh);
    brio_stream_close(&s);
    brio_release(ctx, node);
    return status;
}

brio_status brio_read_as(brio_context *ctx, const char *path, const brio_read_options *options, brio_mesh **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_read_options o = STANDARD;
    *out = NULL;
    BRIO_TRY(BRIO_TAKE(ctx, brio_read_options, options, &o));
    brio_read_job job = {.path = path, .format = o.format, .columns = o.columns};
    BRIO_TRY(brio_read_file(ctx, &job));
    *out = job.mesh;
done:
    return status;
}

brio_status brio_read(brio_context *ctx, const char *path, brio_format format, brio_mesh **out) {
    BRIO_DOOR;
    brio_read_options o = STANDARD;
    o.format = format;
    return brio_read_as(ctx, path, &o, out);
}

brio_status brio_read_memory(brio_context *ctx, const void *bytes, size_t size, const char *name,
                             const brio_read_options *options, brio_mesh **out) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_read_options o = STANDARD;
    const brio_bytes memory = {bytes, size};
    *out = NULL;
    BRIO_TRY(BRIO_TAKE(ctx, brio_read_options, options, &o));
    brio_read_job job = {.path = name ? name : "-", .memory = &memory, .format = o.format, .columns = o.columns};
    BRIO_TRY(brio_read_file(ctx, &job));
    *out = job.mesh;
done:
    return status;
}

/* --- blocks --- */

typedef struct {
    brio_context *ctx;
    brio_rows_fn take;
    void *user;
} block_call;

static brio_status call(void *user, const brio_mesh *block) {
    const block_call *c = user;
    if (c->take(block, c->user)) return brio_fail(c->ctx, BRIO_ERR_CANCELLED, "cancelled");
    return BRIO_OK;
}

brio_status brio_read_blocks(brio_context *ctx, const char *path, const brio_read_options *options, brio_rows_fn take,
                             void *user, brio_file_facts *facts) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    block_call c = {ctx, take, user};
    const brio_sink sink = {call, &c};
    brio_read_options o = STANDARD;
    brio_read_job job = {.path = path, .sink = &sink};
    brio_file_facts found = {.size = sizeof found};
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_file_facts, facts));
    BRIO_TRY(BRIO_TAKE(ctx, brio_read_options, options, &o));
    job.format = o.format, job.columns = o.columns;
    BRIO_TRY(brio_read_file(ctx, &job));
    if (job.mesh) BRIO_TRY(call(&c, job.mesh));
    found.format = job.format;
    found.streamed = job.streamed;
    memcpy(found.version, job.version, sizeof found.version);
done:
    BRIO_GIVE(brio_file_facts, facts, &found);
    brio_mesh_free(job.mesh);
    return status;
}
