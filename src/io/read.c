/* Reads a file, or bytes in memory: finds the format and calls the format's reader. */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/versioned.h"
#include "io/blocks.h"
#include "io/read_job.h"
#include "io/unpack.h"
#include "platform/file.h"
#include <string.h>
#include <strings.h>

/* Bytes of a file in which its content may show the format. */
enum { START = BRIO_IO_BLOCK < 4096 ? BRIO_IO_BLOCK : 4096 };

/* Returns the part of a name behind its last dot, or the whole name if there is none. */
static const char *extension_of(const char *path) {
    const char *name = path + brio_folder_length(path), *dot = strrchr(name, '.');
    return dot ? dot + 1 : name;
}

/* Returns whether the extension of a name, which may have .gz or .zst behind it, is the one wanted. */
static bool has_extension(const char *path, const char *wanted) {
    size_t stem = brio_unpacked_length(path), length = strlen(wanted);
    if (stem == strlen(path)) return !strcasecmp(extension_of(path), wanted);
    size_t name = brio_folder_length(path);
    if (stem < name + length || strncasecmp(path + stem - length, wanted, length) != 0) return false;
    return stem == name + length || path[stem - length - 1] == '.';
}

static bool is_extension(const char *path, const char *extension) {
    return !strcasecmp(extension_of(path), extension);
}

brio_format brio_format_of(const char *path) {
    return brio_format_with(path, is_extension);
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
    size_t stem = length_of_stem(path);
    const char *packed = path[stem] ? path + brio_unpacked_length(path) : "";
    BRIO_FORWARD(BRIO_ALLOC(ctx, *out, stem + strlen(extension) + strlen(packed) + 1));
    memcpy(*out, path, stem);
    strcpy(*out + stem, extension);
    strcat(*out + stem, packed);
    return BRIO_OK;
}

/* Finds the format by the content or, failing that, the extension. What has no name (standard input, "-") and is in no
 * known format is read as rows of numbers; so is a file .xyz whose columns have names from the caller, whatever its
 * first line. */
static brio_status find_format(brio_stream *s, const char *path, brio_read_job *job) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_stream_fill(s, START));
    const char *bytes = s->buffer + s->begin;
    size_t size = brio_stream_left(s);
    job->format = brio_format_that_starts(bytes, size);
    if (job->format == BRIO_FORMAT_AUTO)
        job->format = strcmp(path, "-") ? brio_format_with(path, has_extension) : BRIO_FORMAT_XYZ;
    bool may_be_chemical = job->format == BRIO_FORMAT_XYZ && (!strcmp(path, "-") || has_extension(path, "xyz"));
    if (may_be_chemical && !job->columns && brio_chemical_starts(bytes, size)) job->format = BRIO_FORMAT_CHEMICAL;
    if (job->format == BRIO_FORMAT_AUTO) {
        char known[BRIO_FORMAT_LIST];
        brio_format_list(0, 0, known, sizeof known);
        status = brio_fail(s->ctx, BRIO_BECAUSE(s->ctx, UNKNOWN_FORMAT, BRIO_ERR_FORMAT),
                           "%s: unknown format, expected one of %s", s->name, known);
    }
done:
    return status;
}

static brio_status read_stream(brio_stream *s, brio_builder *b, brio_format format, const char *columns) {
    const brio_format_row *row = brio_format_row_of(format);
    if (!row) return brio_fail(s->ctx, BRIO_ERR_ARGUMENT, "%s: no such format: %d", s->name, (int)format);
    return row->codec->read ? row->codec->read(s, b) : row->codec->read_columns(s, b, columns);
}

/* Reads the tetrahedra in the .ele file beside a .node file. The file may be missing unless `asked_for` is set. */
static brio_status read_tetrahedra(brio_builder *b, const char *path, bool asked_for) {
    brio_status status = BRIO_OK;
    brio_stream s = {.ctx = b->ctx, .file = -1};
    char *ele = NULL;
    BRIO_TRY(brio_sibling(b->ctx, path, ".ele", &ele));
    if (asked_for || brio_is_there(ele)) {
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
    const brio_format_row *row = brio_format_row_of(format);
    char texts[BRIO_FORMAT_LIST];
    if (!columns || !row || row->codec->read_columns) return BRIO_OK;
    brio_format_list_columns(texts, sizeof texts);
    return brio_fail(s->ctx, BRIO_ERR_ARGUMENT,
                     "%s: columns are named (--columns), but only texts of points (%s) have columns", s->name, texts);
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
    b.flat = job->flat;
    b.drop_invalid = job->drop_invalid;
    b.salvage = job->salvage;
    b.origins = job->origins || job->scans;
    b.scans = job->scans;
    BRIO_TRY(read_stream(&s, &b, job->format, job->columns));
    if (job->format == BRIO_FORMAT_NODE && !job->memory && strcmp(job->path, "-") != 0)
        BRIO_TRY(read_tetrahedra(&b, job->path, tetrahedra));
    BRIO_TRY(brio_builder_finish(&b));
    BRIO_TRY(brio_progress(ctx, "read", 1));
    memcpy(job->version, b.version, sizeof job->version);
    job->dropped = b.refused.count;
    job->missing = b.missing;
    job->origins = b.has_origins;
    brio_release(ctx, job->left_out);
    job->left_out = b.left_out, job->num_left_out = b.num_left_out;
    b.left_out = NULL;
    job->notes = b.notes;
    job->streamed = b.streams;
    if (b.streams) goto done;
    job->mesh = b.mesh;
    b.mesh = NULL;
done:
    brio_mesh_free(b.mesh);
    brio_release(ctx, b.left_out);
    brio_stream_close(&s);
    brio_release(ctx, node);
    return status;
}

void brio_read_job_free(brio_context *ctx, brio_read_job *job) {
    brio_release(ctx, job->left_out);
    job->left_out = NULL;
    job->num_left_out = 0;
}

/* Makes a job of the caller's options. */
static brio_read_job job_of(const char *path, const brio_read_options *o) {
    return (brio_read_job){.path = path,
                           .format = o->format,
                           .columns = o->columns,
                           .flat = o->flat,
                           .drop_invalid = o->drop_invalid,
                           .salvage = o->salvage,
                           .origins = o->origins != NULL};
}

/* Tells the caller what a job found beside the mesh, and frees what the job owns. */
static void give_findings(brio_context *ctx, const brio_read_options *o, brio_read_job *job) {
    if (o->dropped) *o->dropped = job->dropped;
    if (o->missing) *o->missing = job->missing;
    BRIO_GIVE(brio_read_notes, o->notes, &job->notes);
    if (o->origins) *o->origins = job->origins;
    for (size_t i = 0; i < job->num_left_out && o->left_out; i++) o->left_out(job->left_out[i], o->left_out_user);
    brio_read_job_free(ctx, job);
}

brio_status brio_read(brio_context *ctx, const char *path, const brio_read_options *options, brio_mesh **out) {
    BRIO_DOOR;
    brio_read_options o = {0};
    *out = NULL;
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_read_options, options, &o));
    BRIO_FORWARD(BRIO_CHECK_RESULT(ctx, brio_read_notes, o.notes));
    brio_read_job job = job_of(path, &o);
    BRIO_FORWARD(brio_read_file(ctx, &job));
    give_findings(ctx, &o, &job);
    *out = job.mesh;
    return BRIO_OK;
}

brio_status brio_read_memory(brio_context *ctx, const void *bytes, size_t size, const char *name,
                             const brio_read_options *options, brio_mesh **out) {
    BRIO_DOOR;
    brio_read_options o = {0};
    const brio_bytes memory = {bytes, size};
    *out = NULL;
    BRIO_FORWARD(BRIO_TAKE(ctx, brio_read_options, options, &o));
    BRIO_FORWARD(BRIO_CHECK_RESULT(ctx, brio_read_notes, o.notes));
    brio_read_job job = job_of(name ? name : "-", &o);
    job.memory = &memory;
    BRIO_FORWARD(brio_read_file(ctx, &job));
    give_findings(ctx, &o, &job);
    *out = job.mesh;
    return BRIO_OK;
}

/* --- blocks --- */

typedef struct {
    brio_context *ctx;
    brio_rows_fn take;
    void *user;
} block_call;

/* Hands a block over. A callback that cancels because one of its calls failed leaves that call's sentence. */
static brio_status call(void *user, const brio_mesh *block) {
    const block_call *c = user;
    uint64_t failures = c->ctx->failures;
    if (!c->take(block, c->user)) return BRIO_OK;
    return c->ctx->failures == failures ? brio_fail(c->ctx, BRIO_ERR_CANCELLED, "cancelled") : BRIO_ERR_CANCELLED;
}

brio_status brio_read_blocks(brio_context *ctx, const char *path, const brio_read_options *options, brio_rows_fn take,
                             void *user, brio_file_facts *facts) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    block_call c = {ctx, take, user};
    const brio_sink sink = {call, &c};
    brio_read_options o = {0};
    brio_read_job job = {.path = path};
    brio_file_facts found = {.size = sizeof found};
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_file_facts, facts));
    BRIO_TRY(BRIO_TAKE(ctx, brio_read_options, options, &o));
    BRIO_TRY(BRIO_CHECK_RESULT(ctx, brio_read_notes, o.notes));
    job = job_of(path, &o);
    job.sink = &sink;
    BRIO_TRY(brio_read_file(ctx, &job));
    give_findings(ctx, &o, &job);
    if (job.mesh) BRIO_TRY(call(&c, job.mesh));
    found.format = job.format;
    found.streamed = job.streamed;
    memcpy(found.version, job.version, sizeof found.version);
done:
    BRIO_GIVE(brio_file_facts, facts, &found);
    brio_mesh_free(job.mesh);
    return status;
}
