/* Disks that lose what they were given, and scratch files that somebody cuts: errors, and never another result.
 *
 * sync_file_range stands here in place of the system's. The system tells once only that a disk did not take pages: what that
 * call says must not be lost. */
#define _GNU_SOURCE
#include "base/memory.h"
#include "base/sanitizers.h"
#include "base/scratch_file.h"
#include "harness.h"
#include "io/output.h"
#include "points.h"
#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/statfs.h>
#include <sys/statvfs.h>
#include <sys/syscall.h>
#include <unistd.h>

static int calls, failing_call;

int sync_file_range(int file, off_t offset, off_t size, unsigned flags) {
    (void)file, (void)offset, (void)size, (void)flags;
    if (++calls != failing_call) return 0;
    errno = EIO;
    return -1;
}

/* A static C library has these in one part with statvfs, and would bring its own statvfs along with them. */
int statfs(const char *path, struct statfs *out) {
    return (int)syscall(SYS_statfs, path, out);
}

int fstatfs(int file, struct statfs *out) {
    return (int)syscall(SYS_fstatfs, file, out);
}

/* The system's, except that the disk may have another number of blocks free, or may not count any. */
static uint64_t blocks_free;
static bool says_other, counts_none;

int statvfs(const char *restrict path, struct statvfs *restrict out) {
    struct statfs facts = {0};
    if (statfs(path, &facts) != 0) return -1;
    *out = (struct statvfs){.f_bsize = (unsigned long)facts.f_bsize, .f_frsize = (unsigned long)facts.f_bsize};
    if (!counts_none) out->f_blocks = facts.f_blocks, out->f_bfree = facts.f_bfree, out->f_bavail = facts.f_bavail;
    if (says_other) out->f_bavail = blocks_free, out->f_frsize = 4096;
    return 0;
}

/* --- outputs --- */

enum { PIECE = 1 << 20, PIECES = 70 /* more than two stretches of write_back */ };

static brio_status write_pieces(brio_context *ctx, const char *bytes) {
    brio_status status = BRIO_OK;
    brio_output out;
    BRIO_TRY(brio_output_open(&out, ctx, "lost-pages", BRIO_NO_PROGRESS));
    for (int i = 0; i < PIECES; i++) BRIO_TRY(brio_output_bytes(&out, bytes, PIECE));
    BRIO_TRY(brio_output_finish(&out));
    BRIO_TRY(brio_output_publish(&out));
done:
    brio_output_close(&out);
    return status;
}

static void pages_that_the_disk_loses_before_the_flush_fail_the_output(void) {
    brio_context *ctx = new_context();
    char *bytes = calloc(1, PIECE);
    calls = failing_call = 0;
    EXPECT(write_pieces(ctx, bytes) == BRIO_OK && calls >= 3 && access("lost-pages", F_OK) == 0);
    for (int last = calls, i = 1; i <= last; i++) {
        unlink("lost-pages");
        calls = 0, failing_call = i;
        EXPECT(write_pieces(ctx, bytes) == BRIO_ERR_WRITE, "call %d", i);
        EXPECT(strstr(brio_message(ctx), "lost-pages: "), "%s", brio_message(ctx));
        EXPECT(access("lost-pages", F_OK) != 0, "call %d: a file is left", i);
    }
    failing_call = 0;
    free(bytes);
    brio_context_free(ctx);
}

/* --- scratch files --- */

enum { BLOCK = 20 << 20 }; /* several stretches of write_behind */

static void pages_that_the_disk_loses_fail_the_write_of_a_scratch_file(void) {
    brio_context *ctx = new_context();
    char *block, *memory;
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    EXPECT(BRIO_ALLOC(ctx, block, BLOCK) == BRIO_OK && BRIO_ALLOC_IN_MEMORY(ctx, memory, BLOCK) == BRIO_OK);
    memset(memory, 7, BLOCK);
    calls = failing_call = 0;
    EXPECT(brio_block_write(ctx, block, 0, memory, BLOCK) == BRIO_OK && calls >= 3);
    for (int last = calls, i = 1; i <= last; i++) {
        calls = 0, failing_call = i;
        EXPECT(brio_block_write(ctx, block, 0, memory, BLOCK) == BRIO_ERR_NO_MEMORY, "call %d", i);
        EXPECT(strstr(brio_message(ctx), "cannot write a scratch file"), "%s", brio_message(ctx));
    }
    failing_call = 0;
    brio_release(ctx, block);
    brio_release(ctx, memory);
    brio_context_free(ctx);
}

/* Cuts all open files that have no name, and makes them as long as `then`. */
static int cut_nameless_files(off_t size, off_t then) {
    int cut = 0;
    DIR *dir = opendir("/proc/self/fd");
    for (struct dirent *e = dir ? readdir(dir) : NULL; e; e = readdir(dir)) {
        char path[300], target[300] = "";
        snprintf(path, sizeof path, "/proc/self/fd/%s", e->d_name);
        if (readlink(path, target, sizeof target - 1) > 0 && strstr(target, "(deleted)"))
            cut += truncate(path, size) == 0 && truncate(path, then) == 0;
    }
    if (dir) closedir(dir);
    return cut;
}

/* Writing and growing a file that was cut filled what was lost with zeros. */
static void a_scratch_file_that_was_cut_is_an_error_and_no_zeros(void) {
    brio_context *ctx = new_context();
    char *block, bytes[64] = {1};
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    EXPECT(BRIO_ALLOC(ctx, block, 3 << 20) == BRIO_OK);
    EXPECT(brio_block_write(ctx, block, 100, bytes, sizeof bytes) == BRIO_OK);
    brio_context_set_scratch(ctx, NULL); /* closes nothing: the block keeps its file */
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    EXPECT(BRIO_RESIZE(ctx, block, 4 << 20) == BRIO_OK && BRIO_RESIZE(ctx, block, 2 << 20) == BRIO_OK);
    EXPECT(brio_block_read(ctx, block, 100, bytes, sizeof bytes) == BRIO_OK && bytes[0] == 1);
    EXPECT(cut_nameless_files(BRIO_SCRATCH_PAGE, BRIO_SCRATCH_PAGE) == 1); /* the page of the block's header stays */
    EXPECT(brio_block_write(ctx, block, 1 << 20, bytes, sizeof bytes) == BRIO_ERR_NO_MEMORY);
    EXPECT(strstr(brio_message(ctx), "was cut from outside"), "%s", brio_message(ctx));
    EXPECT(brio_block_read(ctx, block, 100, bytes, sizeof bytes) == BRIO_ERR_NO_MEMORY);
    EXPECT(BRIO_RESIZE(ctx, block, 4 << 20) == BRIO_ERR_NO_MEMORY);
    brio_release(ctx, block);
    brio_context_free(ctx);
}

/* A call that was about to grow or shrink the file makes it as long as it was. The header of the block was zeros then, and
 * the allocator was to free it. */
static void a_scratch_file_of_zeros_is_lost(void) {
    enum { SIZE = 3 << 20 };
    brio_context *ctx = new_context();
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    size_t before = brio_context_memory(ctx);
    for (off_t left = 0; left <= SIZE; left += SIZE / 2) {
        char *block, bytes[64] = {1};
        EXPECT(BRIO_ALLOC(ctx, block, SIZE) == BRIO_OK);
        EXPECT(cut_nameless_files(left, 2 * SIZE) > 0);
        EXPECT(BRIO_RESIZE(ctx, block, SIZE / 2) == BRIO_ERR_NO_MEMORY);
        EXPECT(strstr(brio_message(ctx), "was cut from outside"), "%s", brio_message(ctx));
        EXPECT(BRIO_RESIZE(ctx, block, 2 * SIZE) == BRIO_ERR_NO_MEMORY);
        EXPECT(brio_block_read(ctx, block, 100, bytes, sizeof bytes) == BRIO_ERR_NO_MEMORY);
        EXPECT(brio_block_write(ctx, block, 100, bytes, sizeof bytes) == BRIO_ERR_NO_MEMORY);
        brio_release(ctx, block);
    }
    EXPECT(brio_context_memory(ctx) == before);
    brio_context_free(ctx);
}

/* The file had grown, and the end that tells that it is whole had moved, when there was no room for its mapping. */
static void a_scratch_file_without_room_for_its_mapping_stays_whole(void) {
    brio_context *ctx = new_context();
    char *block, byte = 7;
    struct rlimit old, little;
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    EXPECT(BRIO_ALLOC(ctx, block, 3 << 20) == BRIO_OK && brio_block_write(ctx, block, 100, &byte, 1) == BRIO_OK);
    getrlimit(RLIMIT_AS, &old);
    little = old, little.rlim_cur = 1 << 20;
    bool limited = setrlimit(RLIMIT_AS, &little) == 0;
    brio_status status = BRIO_RESIZE(ctx, block, 64 << 20);
    setrlimit(RLIMIT_AS, &old);
    EXPECT(!limited || BRIO_ASAN || BRIO_TSAN || status == BRIO_ERR_NO_MEMORY, "status %d", (int)status);
    byte = 0;
    EXPECT(brio_block_read(ctx, block, 100, &byte, 1) == BRIO_OK && byte == 7, "%s", brio_message(ctx));
    brio_release(ctx, block);
    brio_context_free(ctx);
}

enum { SAMPLES = 500, TIMES = 20 };

/* Finds the surface of some points, with scratch files. */
static brio_status find_surface(brio_context *ctx, const double *points, size_t num_points) {
    brio_surface_options o = {.size = sizeof o};
    brio_mesh *mesh = NULL;
    EXPECT(brio_context_set_scratch(ctx, ".") == BRIO_OK);
    brio_status status = brio_surface(ctx, points, num_points, &o, &mesh, NULL);
    brio_mesh_free(mesh);
    return status;
}

static void a_surface_for_which_the_disk_has_no_room_is_refused(void) {
    double p[3 * SAMPLES];
    brio_context *ctx = new_context();
    sphere_points(1, SAMPLES, p);
    says_other = true, blocks_free = 1;
    EXPECT(find_surface(ctx, p, SAMPLES) == BRIO_ERR_NO_MEMORY);
    EXPECT(strstr(brio_message(ctx), ".: 500 points need about "), "%s", brio_message(ctx));
    says_other = false;
    EXPECT(find_surface(ctx, p, SAMPLES) == BRIO_OK);
    brio_context_free(ctx);
}

/* Such as memory without a limit: it has 0 blocks, and 0 are free. */
static void a_disk_that_counts_no_blocks_was_full(void) {
    double p[3 * SAMPLES];
    brio_context *ctx = new_context();
    sphere_points(1, SAMPLES, p);
    counts_none = true;
    EXPECT(find_surface(ctx, p, SAMPLES) == BRIO_OK, "%s", brio_message(ctx));
    counts_none = false;
    brio_context_free(ctx);
}

/* 2^52 + 1 blocks have 4096 bytes more than 2^64. */
static void a_disk_of_more_bytes_than_can_be_counted_was_full(void) {
    double p[3 * SAMPLES];
    brio_context *ctx = new_context();
    sphere_points(1, SAMPLES, p);
    says_other = true, blocks_free = (UINT64_C(1) << 52) + 1;
    EXPECT(find_surface(ctx, p, SAMPLES) == BRIO_OK, "%s", brio_message(ctx));
    says_other = false;
    brio_context_free(ctx);
}

/* The disk has room for the positions, and not for as many points: twice as many as points that are given once. */
static void points_that_are_given_many_times_needed_disk_each_time(void) {
    static double p[3 * SAMPLES * TIMES];
    brio_context *ctx = new_context();
    sphere_points(1, SAMPLES * TIMES, p);
    says_other = true, blocks_free = 2 * SAMPLES * 1110 / 4096;
    EXPECT(find_surface(ctx, p, SAMPLES * TIMES) == BRIO_ERR_NO_MEMORY);
    for (size_t i = 3 * SAMPLES; i < 3 * SAMPLES * TIMES; i++) p[i] = p[i - 3 * SAMPLES];
    EXPECT(find_surface(ctx, p, SAMPLES * TIMES) == BRIO_OK, "%s", brio_message(ctx));
    says_other = false;
    brio_context_free(ctx);
}

SUITE(test_lost_pages) {
    RUN(a_surface_for_which_the_disk_has_no_room_is_refused);
    RUN(a_disk_that_counts_no_blocks_was_full);
    RUN(a_disk_of_more_bytes_than_can_be_counted_was_full);
    RUN(points_that_are_given_many_times_needed_disk_each_time);
    RUN(pages_that_the_disk_loses_before_the_flush_fail_the_output);
    RUN(pages_that_the_disk_loses_fail_the_write_of_a_scratch_file);
    RUN(a_scratch_file_that_was_cut_is_an_error_and_no_zeros);
    RUN(a_scratch_file_of_zeros_is_lost);
    RUN(a_scratch_file_without_room_for_its_mapping_stays_whole);
    return harness_end();
}
