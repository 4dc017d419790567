/* Files by system calls: see store.h. A process that is killed leaves the folder, and its lock is gone with it. */
#define _GNU_SOURCE
#include "tiles/store.h"
#include "base/memory.h"
#include "base/quiet_signals.h"
#include <assert.h>
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <string.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

enum { AT_ONCE = 1 << 22, PATH_BYTES = 4096 };

static const char LOCK[] = "lock";

static void path_of(const brio_store_folder *f, const char *name, char path[PATH_BYTES]) {
    snprintf(path, PATH_BYTES, "%s/%s", f->path, name);
}

brio_status brio_store_begin(brio_context *ctx, const char *parent, const char *name, brio_store_folder *out) {
    char path[PATH_BYTES];
    size_t size = strlen(parent) + strlen(name) + 2;
    *out = (brio_store_folder){.ctx = ctx, .lock = -1};
    BRIO_EXPECT(ctx, *parent && size < PATH_BYTES - 64, BRIO_ERR_OPEN, "%s: not a writable folder: %s",
                *parent ? parent : "\"\"", strerror(*parent ? ENAMETOOLONG : ENOENT));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->path, size));
    snprintf(out->path, size, "%s/%s", parent, name);
    bool made = mkdir(out->path, 0700) == 0;
    path_of(out, LOCK, path);
    if (made || errno == EEXIST) out->lock = open(path, O_RDWR | O_CREAT | O_CLOEXEC | O_NOFOLLOW, 0600);
    bool locked = out->lock >= 0 && flock(out->lock, LOCK_EX | LOCK_NB) == 0;
    if (locked) return BRIO_OK;
    bool busy = out->lock >= 0 && errno == EWOULDBLOCK;
    brio_fail(ctx, BRIO_ERR_OPEN, "%s: %s", out->path, busy ? "in use by another process" : strerror(errno));
    if (out->lock >= 0) close(out->lock);
    if (made) rmdir(out->path);
    brio_release(ctx, out->path);
    out->path = NULL;
    return BRIO_ERR_OPEN;
}

/* Removes all files but the lock. */
void brio_store_clear(brio_store_folder *f) {
    DIR *folder = f->path ? opendir(f->path) : NULL;
    if (!folder) return;
    for (struct dirent *e; (e = readdir(folder)) != NULL;)
        if (strcmp(e->d_name, ".") && strcmp(e->d_name, "..") && strcmp(e->d_name, LOCK))
            unlinkat(dirfd(folder), e->d_name, 0);
    closedir(folder);
}

void brio_store_end(brio_store_folder *f) {
    if (!f->path) return;
    brio_store_clear(f);
    brio_store_remove(f, LOCK);
    rmdir(f->path);
    close(f->lock);
    brio_release(f->ctx, f->path);
    f->path = NULL;
}

static brio_status fail_file(const brio_store_file *f, brio_status status, const char *verb, int error) {
    return brio_fail(f->folder->ctx, status, "%s/%s: cannot %s: %s", f->folder->path, f->name, verb,
                     error ? strerror(error) : "the file ends early");
}

static brio_status open_file(brio_store_folder *folder, const char *name, int flags, brio_store_file *out) {
    char path[PATH_BYTES];
    struct stat facts;
    *out = (brio_store_file){.folder = folder, .file = -1};
    snprintf(out->name, sizeof out->name, "%s", name);
    path_of(folder, name, path);
    out->file = open(path, flags | O_CLOEXEC | O_NOFOLLOW, 0600);
    bool writes = flags & O_CREAT;
    if (out->file < 0)
        return fail_file(out, writes ? BRIO_ERR_WRITE : BRIO_ERR_OPEN, writes ? "make it" : "open it", errno);
    if (fstat(out->file, &facts) == 0) out->size = (uint64_t)facts.st_size;
    return BRIO_OK;
}

brio_status brio_store_create(brio_store_folder *folder, const char *name, brio_store_file *out) {
    return open_file(folder, name, O_RDWR | O_CREAT | O_TRUNC, out);
}

brio_status brio_store_open(brio_store_folder *folder, const char *name, brio_store_file *out) {
    return open_file(folder, name, O_RDONLY, out);
}

bool brio_store_has(const brio_store_folder *folder, const char *name) {
    char path[PATH_BYTES];
    path_of(folder, name, path);
    return access(path, R_OK) == 0;
}

brio_status brio_store_publish(brio_store_file *f, const char *name, bool lasts) {
    char from[PATH_BYTES], to[PATH_BYTES];
    path_of(f->folder, f->name, from);
    path_of(f->folder, name, to);
    if (lasts && fdatasync(f->file) != 0) return fail_file(f, BRIO_ERR_WRITE, "write", errno);
    if (rename(from, to) != 0) return fail_file(f, BRIO_ERR_WRITE, "rename it", errno);
    snprintf(f->name, sizeof f->name, "%s", name);
    return BRIO_OK;
}

void brio_store_remove(brio_store_folder *folder, const char *name) {
    char path[PATH_BYTES];
    struct stat facts;
    path_of(folder, name, path);
    if (stat(path, &facts) == 0 && (uint64_t)facts.st_size <= folder->bytes) folder->bytes -= (uint64_t)facts.st_size;
    unlink(path);
}

void brio_store_close(brio_store_file *f) {
    if (f->folder && f->file >= 0) close(f->file);
    *f = (brio_store_file){.file = -1};
}

brio_status brio_store_write(brio_store_file *f, uint64_t offset, const void *bytes, size_t size) {
    brio_store_folder *folder = f->folder;
    const char *from = bytes;
    while (size > 0) {
        brio_quiet_signals quiet;
        brio_signals_block(&quiet);
        ssize_t n = pwrite(f->file, from, size < AT_ONCE ? size : AT_ONCE, (off_t)offset);
        brio_signals_restore(&quiet);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return fail_file(f, BRIO_ERR_WRITE, "write", n < 0 ? errno : ENOSPC);
        from += n, size -= (size_t)n, offset += (uint64_t)n;
        if (offset > f->size) folder->bytes += offset - f->size, f->size = offset;
        if (folder->bytes > folder->most) folder->most = folder->bytes;
        BRIO_FORWARD(brio_look(folder->ctx, (size_t)n / 1024 + 1));
    }
    return BRIO_OK;
}

brio_status brio_store_append(brio_store_file *f, const void *bytes, size_t size) {
    return brio_store_write(f, f->size, bytes, size);
}

brio_status brio_store_read(const brio_store_file *f, uint64_t offset, void *bytes, size_t size) {
    char *to = bytes;
    while (size > 0) {
        ssize_t n = pread(f->file, to, size < AT_ONCE ? size : AT_ONCE, (off_t)offset);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return fail_file(f, BRIO_ERR_OPEN, "read", n < 0 ? errno : 0);
        to += n, size -= (size_t)n, offset += (uint64_t)n;
    }
    return BRIO_OK;
}
