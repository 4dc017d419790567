/* Buffered output to a file that appears only when it is complete. */
#define _GNU_SOURCE
#include "io/output.h"
#include "base/memory.h"
#include "base/rng.h"
#include "io/number.h"
#include <errno.h>
#include <fcntl.h>
#include <limits.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

enum { BLOCK = 1 << 20, NAME_TRIES = 100 };

static brio_status fail(brio_output *out) {
    return brio_fail(out->ctx, BRIO_ERR_WRITE, "%s: %s", out->name, strerror(errno));
}

/* Makes the temporary file. It has the permissions of the file that it replaces. */
static brio_status open_temporary(brio_output *out, const struct stat *old) {
    brio_status status = BRIO_OK;
    size_t size = strlen(out->target) + 32;
    BRIO_TRY(BRIO_ALLOC(out->ctx, out->temporary, size));
    uint64_t seed = (uint64_t)getpid() << 32 ^ (uint64_t)(brio_seconds() * 1e9);
    for (int i = 0; i < NAME_TRIES && out->file < 0; i++) {
        snprintf(out->temporary, size, "%s.part-%08x", out->target, (unsigned)brio_mix(seed + (unsigned)i));
        out->file = open(out->temporary, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (out->file < 0 && errno != EEXIST) break;
    }
    out->owned = out->file >= 0;
    if (out->file < 0) {
        status = fail(out);
        brio_release(out->ctx, out->temporary);
        out->temporary = NULL;
    } else if (old && fchmod(out->file, old->st_mode & 07777) != 0) {
        status = fail(out);
    }
done:
    return status;
}

/* The target is what a symbolic link leads to, so that the link stays one. */
static brio_status open_file(brio_output *out, const char *path) {
    brio_status status = BRIO_OK;
    struct stat old;
    char real[PATH_MAX];
    bool exists = stat(path, &old) == 0;
    if (exists && !S_ISREG(old.st_mode)) {
        out->file = open(path, O_WRONLY | O_CLOEXEC);
        out->owned = out->file >= 0;
        return out->owned ? BRIO_OK : fail(out);
    }
    /* a rename does not ask whether the old file may be written */
    if (exists && access(path, W_OK) != 0) return fail(out);
    const char *target = exists && realpath(path, real) ? real : path;
    BRIO_TRY(BRIO_ALLOC(out->ctx, out->target, strlen(target) + 1));
    strcpy(out->target, target);
    BRIO_TRY(open_temporary(out, exists ? &old : NULL));
done:
    return status;
}

brio_status brio_output_open(brio_output *out, brio_context *ctx, const char *path, uint64_t expected) {
    brio_status status = BRIO_OK;
    bool standard = !strcmp(path, "-");
    *out = (brio_output){.ctx = ctx, .name = standard ? "standard output" : path, .file = -1, .expected = expected};
    BRIO_TRY(BRIO_ALLOC(ctx, out->buffer, BLOCK));
    if (standard)
        out->file = STDOUT_FILENO;
    else
        BRIO_TRY(open_file(out, path));
done:
    return status;
}

static brio_status write_all(brio_output *out, const char *bytes, size_t size) {
    while (size) {
        ssize_t done = write(out->file, bytes, size);
        if (done < 0 && errno == EINTR) continue;
        if (done < 0) return fail(out);
        bytes += done;
        size -= (size_t)done;
        out->written += (uint64_t)done;
    }
    return BRIO_OK;
}

static brio_status report(brio_output *out) {
    double share = out->expected ? (double)out->written / (double)out->expected : 0;
    return brio_progress(out->ctx, "write", share < 1 ? share : 1);
}

static brio_status flush(brio_output *out) {
    brio_status status = BRIO_OK;
    size_t used = out->used;
    out->used = 0;
    BRIO_TRY(write_all(out, out->buffer, used));
    BRIO_TRY(report(out));
done:
    return status;
}

brio_status brio_output_finish(brio_output *out) {
    brio_status status = BRIO_OK;
    BRIO_TRY(flush(out));
    if (out->temporary && fsync(out->file) != 0) return fail(out);
    if (out->owned) {
        int closed = close(out->file);
        out->owned = false;
        if (closed != 0) return fail(out);
    }
done:
    return status;
}

brio_status brio_output_publish(brio_output *out) {
    if (!out->temporary) return BRIO_OK;
    if (rename(out->temporary, out->target) != 0) return fail(out);
    brio_release(out->ctx, out->temporary);
    out->temporary = NULL;
    return BRIO_OK;
}

void brio_output_close(brio_output *out) {
    if (out->owned) close(out->file);
    if (out->temporary) unlink(out->temporary);
    brio_release(out->ctx, out->temporary);
    brio_release(out->ctx, out->target);
    brio_release(out->ctx, out->buffer);
    *out = (brio_output){.ctx = out->ctx, .file = -1};
}

/* --- what goes into the buffer --- */

brio_status brio_output_bytes(brio_output *out, const void *bytes, size_t size) {
    brio_status status = BRIO_OK;
    const char *p = bytes;
    while (size) {
        if (out->used == BLOCK || (out->used && size >= BLOCK)) BRIO_TRY(flush(out));
        if (size >= BLOCK) { /* by way of no buffer */
            BRIO_TRY(write_all(out, p, BLOCK));
            BRIO_TRY(report(out));
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
done:
    return status;
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

/* Room for one number with what is before it. */
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
    if (property->type == BRIO_FLOAT64) return brio_output_double(out, before, x);
    if (property->type != BRIO_FLOAT32) return brio_output_integer(out, before, (int64_t)x);
    brio_status status = room(out, before);
    if (status == BRIO_OK) out->used += brio_print_float(out->buffer + out->used, (float)x);
    return status;
}

brio_status brio_output_point(brio_output *out, const double *point) {
    brio_status status = BRIO_OK;
    for (int k = 0; k < 3; k++) BRIO_TRY(brio_output_double(out, k ? ' ' : 0, point[k]));
done:
    return status;
}

brio_status brio_output_comment(brio_output *out, const char *prefix, const char *comment) {
    brio_status status = BRIO_OK;
    while (comment && *comment) {
        size_t length = strcspn(comment, "\r\n");
        BRIO_TRY(brio_output_string(out, prefix));
        BRIO_TRY(brio_output_bytes(out, comment, length));
        BRIO_TRY(brio_output_string(out, "\n"));
        comment += length;
        comment += strspn(comment, "\r\n");
    }
done:
    return status;
}
