/* Writes that fail must not end the process that uses the library: no signal of a pipe without a reader or of a limit
 * on the size of files reaches it. The dispositions of the signals are the system's, so that one would end this test. */
#include "points.h"
#include "io_files.h"
#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>

static struct rlimit unlimited;

static void limit_files(rlim_t bytes) {
    struct rlimit limit = {bytes, unlimited.rlim_max};
    EXPECT(setrlimit(RLIMIT_FSIZE, &limit) == 0);
}

static bool is_pending(int signal) {
    sigset_t pending;
    return sigpending(&pending) == 0 && sigismember(&pending, signal) == 1;
}

static bool is_blocked(int signal) {
    sigset_t mask;
    return pthread_sigmask(SIG_BLOCK, NULL, &mask) == 0 && sigismember(&mask, signal) == 1;
}

static void limit_on_the_file_size_does_not_end_the_process(void) {
    static const char *const names[] = {"f.ply", "f.xyz", "f.vtu", "f.node"};
    brio_mesh *mesh = io_make(20000, 0);
    limit_files(65536);
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        EXPECT(brio_write(io_ctx, io_path(names[i]), mesh, NULL) == BRIO_ERR_WRITE, "%s", names[i]);
        EXPECT(io_count_files("") == 0, "%s", names[i]);
    }
    limit_files(unlimited.rlim_cur);
    EXPECT(!is_pending(SIGXFSZ) && !is_blocked(SIGXFSZ));
    brio_mesh_free(mesh);
}

static void scratch_file_over_the_limit_does_not_end_the_process(void) {
    enum { N = 60000 };
    double *p = malloc(3 * N * sizeof *p);
    uniform_points(3, N, p);
    const rlim_t limits[] = {65536, 3 << 20, 8 << 20}; /* the first allocation fails; growth of an array fails */
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++) {
        brio_context *ctx;
        brio_triangulation *t = NULL;
        EXPECT(brio_context_new(NULL, &ctx) == BRIO_OK && brio_context_set_scratch(ctx, io_folder) == BRIO_OK);
        limit_files(limits[i]);
        brio_status status = brio_delaunay(ctx, p, NULL, N, NULL, &t);
        limit_files(unlimited.rlim_cur);
        EXPECT(status == BRIO_ERR_NO_MEMORY && !t, "%zu: %d: %s", i, (int)status, brio_message(ctx));
        EXPECT(brio_context_memory(ctx) < 4096, "%zu bytes", brio_context_memory(ctx));
        brio_context_free(ctx);
        EXPECT(io_count_files("") == 0);
    }
    free(p);
}

/* Writes to standard output, whose reader is gone. */
static brio_status write_to_nobody(const brio_mesh *mesh) {
    brio_write_options options = {0};
    options.format = BRIO_FORMAT_PLY;
    int ends[2], out = dup(1);
    EXPECT(pipe(ends) == 0);
    close(ends[0]);
    dup2(ends[1], 1);
    close(ends[1]);
    brio_status status = brio_write(io_ctx, "-", mesh, &options);
    dup2(out, 1);
    close(out);
    return status;
}

static void pipe_without_a_reader_does_not_end_the_process(void) {
    brio_mesh *mesh = io_make(20000, 0);
    EXPECT(write_to_nobody(mesh) == BRIO_ERR_WRITE);
    EXPECT(strstr(brio_message(io_ctx), "Broken pipe"), "%s", brio_message(io_ctx));
    EXPECT(!is_pending(SIGPIPE) && !is_blocked(SIGPIPE));
    brio_mesh_free(mesh);
}

/* A signal that was pending is the caller's, and so is a mask that blocks it. */
static void signals_of_the_caller_stay_pending(void) {
    brio_mesh *mesh = io_make(20000, 0);
    sigset_t both, before;
    sigemptyset(&both);
    sigaddset(&both, SIGPIPE);
    EXPECT(pthread_sigmask(SIG_BLOCK, &both, &before) == 0);
    EXPECT(write_to_nobody(mesh) == BRIO_ERR_WRITE && !is_pending(SIGPIPE), "a signal of the library is left");
    raise(SIGPIPE);
    EXPECT(write_to_nobody(mesh) == BRIO_ERR_WRITE && is_pending(SIGPIPE), "the caller's signal is taken");
    EXPECT(is_blocked(SIGPIPE) && !is_blocked(SIGXFSZ));
    int taken;
    EXPECT(!is_pending(SIGPIPE) || (sigwait(&both, &taken) == 0 && taken == SIGPIPE));
    pthread_sigmask(SIG_SETMASK, &before, NULL);
    brio_mesh_free(mesh);
}

SUITE(test_quiet_signals) {
    io_begin();
    signal(SIGPIPE, SIG_DFL);
    signal(SIGXFSZ, SIG_DFL);
    if (getrlimit(RLIMIT_FSIZE, &unlimited) != 0) return HARNESS_SKIP;
    RUN(limit_on_the_file_size_does_not_end_the_process);
    RUN(scratch_file_over_the_limit_does_not_end_the_process);
    RUN(pipe_without_a_reader_does_not_end_the_process);
    RUN(signals_of_the_caller_stay_pending);
    return io_end();
}
