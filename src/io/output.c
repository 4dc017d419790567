/* Buffered output to a file that appears only when it is complete.
 *
 * platform/target.h finds the file. A target that is no regular file, or is open already, is written in place. The
 * reader of a pipe may never be ready: such an output waits in wait.h, where the caller can cancel. */
#include "io/output.h"
#include "base/memory.h"
#include "io/blocks.h"
#include "io/number.h"
#include "io/wait.h"
#include "platform/disk.h"
#include <errno.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

enum { BLOCK = BRIO_IO_BLOCK };

static brio_status fail(brio_output *out) {
    return brio_fail(out->ctx, BRIO_ERR_WRITE, "%s: %s", out->name, strerror(errno));
}

/* Takes a descriptor that is open. Its flags and its place stay as they are, because other processes share them. */
static brio_status take_descriptor(brio_output *out, int descriptor) {
    brio_place_facts facts;
    if (!brio_is_writable(descriptor)) return fail(out);
    out->file = descriptor;
    out->waits = brio_find_facts_open(descriptor, &facts) && facts.kind != BRIO_IS_FILE;
    return BRIO_OK;
}

/* Opens a FIFO, and waits here for a reader. The system's own wait could only be ended by a signal. */
static brio_status open_fifo(brio_output *out, const char *path) {
    for (;;) {
        out->file = brio_open_device(path);
        if (out->file >= 0) break;
        if (errno != ENXIO && errno != EINTR) return fail(out);
        BRIO_FORWARD(brio_wait_a_moment(out->ctx, BRIO_WAIT_WRITE, 0));
    }
    out->owned = true;
    return BRIO_OK;
}

/* Opens a pipe, a terminal or a device, which is written in place. */
static brio_status open_special(brio_output *out, const char *path, const brio_place_facts *facts) {
    out->waits = true;
    if (facts->kind == BRIO_IS_PIPE) return open_fifo(out, path);
    out->file = brio_open_device(path);
    out->owned = out->file >= 0;
    return out->owned ? BRIO_OK : fail(out);
}

/* Looks at the file that a path too long for one call leads to: only a file can be replaced. */
static brio_status check_far(brio_output *out) {
    brio_place_facts old;
    if (!brio_target_facts(&out->target, &old)) return errno == ENOENT ? BRIO_OK : fail(out);
    if (old.kind == BRIO_IS_FILE) return brio_target_may_write(&out->target) ? BRIO_OK : fail(out);
    errno = ENAMETOOLONG;
    return fail(out);
}

/* Opens a file. Symbolic links stay; the file that they lead to is replaced. A file that is reached through an open
 * descriptor is not: its name may be another's, and others go on to write into it. What a descriptor of another process
 * has open is written at its end. */
static brio_status open_file(brio_output *out, const char *path) {
    brio_status status = BRIO_OK;
    brio_place_facts old;
    bool exists = brio_find_facts(path, &old), far = !exists && errno == ENAMETOOLONG;
    if (!exists && errno != ENOENT && !far) return fail(out);
    if (!brio_target_find(&out->target, path)) return fail(out);
    int descriptor = brio_target_descriptor(&out->target);
    if (descriptor >= 0) return take_descriptor(out, descriptor);
    if (exists && old.kind != BRIO_IS_FILE) return open_special(out, path, &old);
    /* a rename does not check whether the old file may be written */
    if (exists && !brio_may_write(path)) return fail(out);
    if (far) BRIO_TRY(check_far(out));
    if (brio_target_is_open_file(&out->target)) {
        out->file = brio_open_end(path);
        if (out->file < 0) return fail(out);
    } else if (!brio_target_create(&out->target, &out->file)) {
        status = fail(out);
    }
done:
    out->owned = out->file >= 0;
    return status;
}

brio_status brio_output_open(brio_output *out, brio_context *ctx, const char *path, uint64_t expected) {
    bool standard = !strcmp(path, "-");
    *out = (brio_output){
        .ctx = ctx, .name = standard ? "standard output" : path, .target.folder = -1, .file = -1, .expected = expected};
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->buffer, BLOCK));
    return standard ? take_descriptor(out, BRIO_OUTPUT) : open_file(out, path);
}

int brio_open_descriptor(const char *path) {
    return strcmp(path, "-") ? brio_path_descriptor(path) : BRIO_OUTPUT;
}

bool brio_output_is_single(const char *path) {
    brio_place_facts facts;
    if (brio_open_descriptor(path) >= 0) return true;
    return brio_find_facts(path, &facts) && (facts.kind == BRIO_IS_CHARACTERS || facts.kind == BRIO_IS_BLOCKS);
}

static double share_written(const brio_output *out) {
    bool known = out->expected && out->expected != BRIO_NO_PROGRESS;
    double share = known ? (double)out->written / (double)out->expected : 0;
    return share < 1 ? share : 1;
}

/* Makes one system call. A target that may block gets what fits whenever it takes anything. */
static int64_t write_some(const brio_output *out, const char *bytes, size_t size) {
    size_t room = brio_pipe_room();
    return brio_write_bytes(out->file, bytes, out->waits && size > room ? room : size);
}

static brio_status write_all(brio_output *out, const char *bytes, size_t size) {
    while (size) {
        if (out->waits) BRIO_FORWARD(brio_wait_for(out->ctx, out->file, BRIO_WAIT_WRITE, share_written(out)));
        int64_t done = write_some(out, bytes, size);
        if (done < 0 && (errno == EINTR || errno == EAGAIN)) {
            BRIO_FORWARD(brio_wait_a_moment(out->ctx, BRIO_WAIT_WRITE, share_written(out)));
            continue;
        }
        if (done == 0) errno = EIO; /* a device that takes nothing would be asked for ever */
        if (done <= 0) return fail(out);
        bytes += done;
        size -= (size_t)done;
        out->written += (uint64_t)done;
    }
    return BRIO_OK;
}

/* Makes the disk take what was written, STRETCH bytes (chosen) at a time: one flush of a big file at its end could not
 * be cancelled. The system tells of a failure once only, here or at the flush. */
static brio_status write_back(brio_output *out) {
    enum { STRETCH = 1 << 25 };
    uint64_t size = out->written - out->given;
    if (!out->target.is_new || size < STRETCH) return BRIO_OK;
    if (out->given > out->taken && !brio_wait_written(out->file, out->taken, out->given - out->taken)) return fail(out);
    if (!brio_start_writing(out->file, out->given, size)) return fail(out);
    out->taken = out->given;
    out->given = out->written;
    return BRIO_OK;
}

static brio_status report(brio_output *out) {
    brio_status status = write_back(out);
    if (status != BRIO_OK || out->expected == BRIO_NO_PROGRESS) return status;
    return brio_progress(out->ctx, "write", share_written(out));
}

static brio_status flush(brio_output *out) {
    size_t used = out->used;
    out->used = 0;
    BRIO_FORWARD(write_all(out, out->buffer, used));
    return report(out);
}

brio_status brio_output_patch(brio_output *out, uint64_t offset, const void *bytes, size_t size) {
    const char *p = bytes;
    BRIO_FORWARD(flush(out));
    while (size) {
        int64_t done = brio_write_bytes_at(out->file, p, size, offset);
        if (done < 0 && errno == EINTR) continue;
        if (done == 0) errno = EIO;
        if (done <= 0) return fail(out);
        p += done;
        offset += (uint64_t)done;
        size -= (size_t)done;
    }
    return BRIO_OK;
}

brio_status brio_output_finish(brio_output *out) {
    BRIO_FORWARD(flush(out));
    if (!out->owned) return BRIO_OK;
    if (out->target.is_new && !brio_flush_to_disk(out->file)) return fail(out);
    if (brio_target_is_nameless(&out->target)) return BRIO_OK; /* needed open to be named; all of it is on the disk */
    out->owned = false;
    return brio_close(out->file) ? BRIO_OK : fail(out);
}

brio_status brio_output_publish(brio_output *out) {
    return brio_target_publish(&out->target, out->file) ? BRIO_OK : fail(out);
}

brio_status brio_output_publish_all(brio_output *const *outs, int count) {
    brio_status status = BRIO_OK;
    for (int i = 0; i < count && status == BRIO_OK; i++)
        status = brio_target_exchange(&outs[i]->target, outs[i]->file) ? BRIO_OK : fail(outs[i]);
    for (int i = count - 1; i >= 0 && status != BRIO_OK; i--) brio_target_undo(&outs[i]->target);
    return status;
}

void brio_output_close(brio_output *out) {
    if (out->owned) brio_close(out->file);
    brio_target_close(&out->target);
    brio_release(out->ctx, out->buffer);
    *out = (brio_output){.ctx = out->ctx, .target.folder = -1, .file = -1};
}

/* --- what goes into the buffer --- */

brio_status brio_output_bytes(brio_output *out, const void *bytes, size_t size) {
    const char *p = bytes;
    while (size) {
        if (out->used == BLOCK || (out->used && size >= BLOCK)) BRIO_FORWARD(flush(out));
        if (size >= BLOCK) { /* past the buffer */
            BRIO_FORWARD(write_all(out, p, BLOCK));
            BRIO_FORWARD(report(out));
            p += BLOCK;
            size -= BLOCK;
            continue;
        }
        size_t part = size < BLOCK - out->used ? size : BLOCK - out->used;
        memcpy(out->buffer + out->used, p, part);
        out->used += part;
        p += part;
        size -= part;
    }
    return BRIO_OK;
}

brio_status brio_output_string(brio_output *out, const char *text) {
    return brio_output_bytes(out, text, strlen(text));
}

brio_status brio_output_format(brio_output *out, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    return brio_output_string(out, text);
}

/* Makes room in the buffer for one number and the character before it. */
static brio_status room(brio_output *out, char before) {
    if (out->used + BRIO_NUMBER_LENGTH + 1 > BLOCK) {
        brio_status status = flush(out);
        if (status != BRIO_OK) return status;
    }
    if (before) out->buffer[out->used++] = before;
    return BRIO_OK;
}

brio_status brio_output_double(brio_output *out, char before, double x) {
    brio_status status = room(out, before);
    if (status == BRIO_OK) out->used += brio_print_double(out->buffer + out->used, x);
    return status;
}

brio_status brio_output_integer(brio_output *out, char before, int64_t x) {
    brio_status status = room(out, before);
    if (status == BRIO_OK) out->used += brio_print_integer(out->buffer + out->used, x);
    return status;
}

brio_status brio_output_scalar(brio_output *out, char before, const brio_property *property, size_t i) {
    double x = brio_property_value(property, i);
    if (property->type == BRIO_SCALAR_FLOAT64) return brio_output_double(out, before, x);
    if (property->type != BRIO_SCALAR_FLOAT32) return brio_output_integer(out, before, (int64_t)x);
    brio_status status = room(out, before);
    if (status == BRIO_OK) out->used += brio_print_float(out->buffer + out->used, (float)x);
    return status;
}

brio_status brio_output_point(brio_output *out, const double *point) {
    for (int k = 0; k < 3; k++) BRIO_FORWARD(brio_output_double(out, k ? ' ' : 0, point[k]));
    return BRIO_OK;
}

brio_status brio_output_comment(brio_output *out, const char *prefix, const char *comment) {
    while (comment && *comment) {
        size_t length = strcspn(comment, "\r\n");
        BRIO_FORWARD(brio_output_string(out, prefix));
        BRIO_FORWARD(brio_output_bytes(out, comment, length));
        BRIO_FORWARD(brio_output_string(out, "\n"));
        comment += length;
        comment += strspn(comment, "\r\n");
    }
    return BRIO_OK;
}
