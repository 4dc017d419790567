/* Files by system calls: see store.h. A process that is killed leaves the folder, and its lock is gone with it. */
#include "store/store.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/team.h"
#include "platform/disk.h"
#include "platform/file.h"
#include "platform/folder.h"
#include <assert.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>

/* Bytes: in one call of the system, that are worth a thread to read, and to hash. Chosen. */
enum { AT_ONCE = 1 << 22, READ_A_THREAD = 1 << 22, HASHED_A_THREAD = 1 << 18, FOLDER_TRIES = 100, MOST_AT_ONCE = 4096 };

static const char LOCK[] = "lock";

static void path_of(const brio_store_folder *f, const char *name, char path[BRIO_PATH_MOST]) {
    snprintf(path, BRIO_PATH_MOST, "%s/%s", f->path, name);
}

/* Does what brio_store_begin does.   *in_use  receives whether it failed because another process, or another user, has
 * the folder. */
static brio_status begin(brio_context *ctx, const char *parent, const char *name, brio_store_folder *out,
                         bool *in_use) {
    char path[BRIO_PATH_MOST];
    size_t size = strlen(parent) + strlen(name) + 2;
    *out = (brio_store_folder){.ctx = ctx, .lock = -1};
    *in_use = false;
    BRIO_EXPECT(ctx, *parent && size < BRIO_PATH_MOST - 64, BRIO_ERR_OPEN, "%s: not a writable folder: %s",
                *parent ? parent : "\"\"", strerror(*parent ? ENAMETOOLONG : ENOENT));
    BRIO_FORWARD(BRIO_ALLOC(ctx, out->path, size));
    snprintf(out->path, size, "%s/%s", parent, name);
    bool made = false, there = true;
    path_of(out, LOCK, path);
    /* another process that ends may remove the folder before the lock is made */
    for (int i = 0; i < FOLDER_TRIES && there && out->lock < 0 && (i == 0 || errno == ENOENT); i++) {
        there = brio_make_folder(out->path, true, &made);
        if (there) out->lock = brio_lock_file(path);
    }
    if (out->lock >= 0) return BRIO_OK;
    bool locked = errno == EWOULDBLOCK;
    *in_use = locked || (errno == EACCES && brio_is_there(out->path));
    brio_fail(ctx, BRIO_ERR_OPEN, "%s: %s", out->path, locked ? "in use by another process" : strerror(errno));
    if (made) brio_remove_folder(out->path);
    brio_release(ctx, out->path);
    out->path = NULL;
    return BRIO_ERR_OPEN;
}

brio_status brio_store_begin(brio_context *ctx, const char *parent, const char *name, brio_store_folder *out) {
    bool in_use;
    return begin(ctx, parent, name, out, &in_use);
}

/* Removes all files but the lock. */
void brio_store_clear(brio_store_folder *f) {
    if (f->path) brio_empty_folder(f->path, LOCK);
}

/* Returns whether something with the name of a folder is not of a store: there is no lock, and it is no empty folder,
 * which a process leaves that is killed before it locks it. */
static bool is_in_the_way(const char *parent, const char *name) {
    char path[BRIO_PATH_MOST], lock[BRIO_PATH_MOST];
    if (snprintf(path, sizeof path, "%s/%s", parent, name) >= BRIO_PATH_MOST) return false;
    if (snprintf(lock, sizeof lock, "%s/%s", path, LOCK) >= BRIO_PATH_MOST) return false;
    return brio_is_there(path) && !brio_is_there(lock) && !brio_remove_folder(path);
}

brio_status brio_store_begin_free(brio_context *ctx, const char *parent, const char *name, brio_store_folder *out) {
    char numbered[64];
    bool in_use = true; /* by a process that may be gone by now */
    for (unsigned number = 1; number <= MOST_AT_ONCE && in_use; number++) {
        snprintf(numbered, sizeof numbered, "%s-%u", name, number);
        if (number < MOST_AT_ONCE && is_in_the_way(parent, numbered)) continue;
        brio_status status = begin(ctx, parent, numbered, out, &in_use);
        if (status != BRIO_OK && (status != BRIO_ERR_OPEN || !in_use || number == MOST_AT_ONCE)) return status;
    }
    brio_store_clear(out);
    return BRIO_OK;
}

void brio_store_end(brio_store_folder *f) {
    char path[BRIO_PATH_MOST];
    if (!f->path) return;
    brio_store_clear(f);
    path_of(f, LOCK, path);
    brio_unlock_file(f->lock, path);
    brio_remove_folder(f->path);
    brio_release(f->ctx, f->path);
    f->path = NULL;
}

void brio_store_leave(brio_store_folder *f) {
    if (!f->path) return;
    brio_close(f->lock);
    brio_release(f->ctx, f->path);
    f->path = NULL;
}

static brio_status fail_file(const brio_store_file *f, brio_status status, const char *verb, int error) {
    return brio_fail(f->folder->ctx, status, "%s/%s: cannot %s: %s", f->folder->path, f->name, verb,
                     error ? strerror(error) : "the file ends early");
}

static brio_status open_file(brio_store_folder *folder, const char *name, bool makes, brio_store_file *out) {
    char path[BRIO_PATH_MOST];
    brio_place_facts facts;
    *out = (brio_store_file){.folder = folder, .file = -1};
    snprintf(out->name, sizeof out->name, "%s", name);
    path_of(folder, name, path);
    out->file = makes ? brio_make_file(path) : brio_open_input(path);
    if (out->file < 0)
        return fail_file(out, makes ? BRIO_ERR_WRITE : BRIO_ERR_OPEN, makes ? "make it" : "open it", errno);
    if (brio_find_facts_open(out->file, &facts)) out->size = facts.size;
    return BRIO_OK;
}

brio_status brio_store_create(brio_store_folder *folder, const char *name, brio_store_file *out) {
    return open_file(folder, name, true, out);
}

brio_status brio_store_open(brio_store_folder *folder, const char *name, brio_store_file *out) {
    return open_file(folder, name, false, out);
}

bool brio_store_has(const brio_store_folder *folder, const char *name) {
    char path[BRIO_PATH_MOST];
    path_of(folder, name, path);
    return brio_is_there(path);
}

brio_status brio_store_publish(brio_store_file *f, const char *name) {
    char from[BRIO_PATH_MOST], to[BRIO_PATH_MOST];
    path_of(f->folder, f->name, from);
    path_of(f->folder, name, to);
    if (!brio_rename_file(from, to)) return fail_file(f, BRIO_ERR_WRITE, "rename it", errno);
    snprintf(f->name, sizeof f->name, "%s", name);
    return BRIO_OK;
}

void brio_store_remove(brio_store_folder *folder, const char *name) {
    char path[BRIO_PATH_MOST];
    brio_place_facts facts;
    path_of(folder, name, path);
    if (brio_find_facts(path, &facts) && facts.size <= folder->bytes) folder->bytes -= facts.size;
    brio_remove_file(path);
}

void brio_store_close(brio_store_file *f) {
    if (f->folder && f->file >= 0) brio_close(f->file);
    *f = (brio_store_file){.file = -1};
}

void brio_store_shut(brio_store_file *f) {
    if (f->file >= 0) brio_close(f->file);
    f->file = -1;
    f->shut = true;
}

static brio_status write_bytes(brio_store_file *f, uint64_t offset, const void *bytes, size_t size) {
    brio_store_folder *folder = f->folder;
    const char *from = bytes;
    while (size > 0) {
        int64_t n = brio_write_bytes_at(f->file, from, size < AT_ONCE ? size : AT_ONCE, offset);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) return fail_file(f, BRIO_ERR_WRITE, "write", n < 0 ? errno : ENOSPC);
        from += n, size -= (size_t)n, offset += (uint64_t)n;
        if (offset > f->size) folder->bytes += offset - f->size, f->size = offset;
        if (folder->bytes > folder->most) folder->most = folder->bytes;
        BRIO_FORWARD(brio_look(folder->ctx, (size_t)n / 1024 + 1));
    }
    return BRIO_OK;
}

brio_status brio_store_write(brio_store_file *f, uint64_t offset, const void *bytes, size_t size) {
    char path[BRIO_PATH_MOST];
    if (!f->shut) return write_bytes(f, offset, bytes, size);
    assert(offset == f->size); /* the descriptor appends */
    path_of(f->folder, f->name, path);
    f->file = brio_open_end(path);
    if (f->file < 0) return fail_file(f, BRIO_ERR_WRITE, "open it", errno);
    brio_status status = write_bytes(f, offset, bytes, size);
    brio_store_shut(f);
    return status;
}

/* Bytes of a file in memory. */
typedef struct {
    const brio_store_file *f;
    char *bytes;
    uint64_t offset;    /* of the first */
    int file;           /* descriptor */
    uint64_t hash;      /* atomic */
    brio_status status; /* atomic */
} piece;

static inline uint64_t hash_word(uint64_t word, uint64_t offset) {
    return brio_mix(word ^ offset * UINT64_C(0x9e3779b97f4a7c15));
}

/* Adds the hash of some words: a sum, so that it does not matter where pieces end. */
static void hash_words(void *user, size_t begin, size_t end, int thread) {
    piece *p = user;
    uint64_t hash = 0, word;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        memcpy(&word, p->bytes + i * sizeof word, sizeof word);
        hash += hash_word(word, p->offset + i * sizeof word);
    }
    __atomic_add_fetch(&p->hash, hash, __ATOMIC_RELAXED);
}

/* Adds the hash of bytes from an offset on. */
static brio_status add_hash(brio_context *ctx, uint64_t offset, const void *bytes, size_t size, uint64_t *hash) {
    piece p = {.bytes = (char *)bytes, .offset = offset};
    uint64_t word = 0;
    size_t words = size / sizeof word, rest = size % sizeof word;
    assert(offset % sizeof word == 0);
    BRIO_FORWARD(brio_for(ctx, brio_threads(ctx, size, HASHED_A_THREAD), words, hash_words, &p));
    if (rest) {
        memcpy(&word, p.bytes + size - rest, rest);
        p.hash += hash_word(word, offset + size - rest);
    }
    *hash += p.hash;
    return BRIO_OK;
}

brio_status brio_store_append(brio_store_file *f, const void *bytes, size_t size) {
    if (f->hashes) BRIO_FORWARD(add_hash(f->folder->ctx, f->size, bytes, size, &f->hash));
    return brio_store_write(f, f->size, bytes, size);
}

/* Reads the bytes [begin, end) of a piece. */
static void read_part(void *user, size_t begin, size_t end, int thread) {
    piece *p = user;
    (void)thread;
    while (begin < end) {
        size_t some = end - begin < AT_ONCE ? end - begin : AT_ONCE;
        int64_t n = brio_read_bytes_at(p->file, p->bytes + begin, some, p->offset + begin);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) {
            brio_report(&p->status, fail_file(p->f, BRIO_ERR_OPEN, "read", n < 0 ? errno : 0));
            return;
        }
        begin += (size_t)n;
    }
}

/* Reads bytes: large pieces by all threads, for the copy out of the system's memory takes as long as a sort. */
static brio_status read_bytes(const brio_store_file *f, int file, uint64_t offset, void *bytes, size_t size) {
    piece p = {.f = f, .bytes = bytes, .offset = offset, .file = file, .status = BRIO_OK};
    int threads = size < 2 * READ_A_THREAD ? 1 : brio_threads(f->folder->ctx, size, READ_A_THREAD);
    if (threads > 1)
        BRIO_FORWARD(brio_for_parts(f->folder->ctx, threads, size, read_part, &p));
    else
        read_part(&p, 0, size, 0);
    return p.status;
}

brio_status brio_store_read(const brio_store_file *f, uint64_t offset, void *bytes, size_t size) {
    char path[BRIO_PATH_MOST];
    if (!f->shut) return read_bytes(f, f->file, offset, bytes, size);
    path_of(f->folder, f->name, path);
    int file = brio_open_input(path);
    if (file < 0) return fail_file(f, BRIO_ERR_OPEN, "open it", errno);
    brio_status status = read_bytes(f, file, offset, bytes, size);
    brio_close(file);
    return status;
}

brio_status brio_store_check(const brio_store_file *f, uint64_t offset, uint64_t hash, bool *same) {
    enum { PIECE = 1 << 20 };
    brio_context *ctx = f->folder->ctx;
    brio_status status = BRIO_OK;
    char *some = NULL;
    uint64_t sum = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, some, PIECE));
    for (size_t n; offset < f->size; offset += n) {
        n = f->size - offset < PIECE ? (size_t)(f->size - offset) : PIECE;
        BRIO_TRY(brio_store_read(f, offset, some, n));
        BRIO_TRY(add_hash(ctx, offset, some, n, &sum));
        BRIO_TRY(brio_look(ctx, n / 1024 + 1));
    }
    *same = sum == hash;
done:
    brio_release(ctx, some);
    return status;
}
