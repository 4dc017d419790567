/* Every reader, from memory. The first byte chooses a format by its extension, the rest is the file; or it chooses a wrapping
 * with right checksums (pages of E57, an archive of one array, gzip, zstd) for the rest, since a fuzzer guesses no checksums.
 * A file is read, or it is refused with a reason. */
#include "fuzz.h"
#include "wrapped_input.h"

static const char *const names[] = {"a.ply", "a.xyz",  "a.csv", "a.obj", "a.off", "a.vtu",   "a.vtp",   "a.node",
                                    "a.las", "a.laz",  "a.pcd", "a.ptx", "a.stl", "a.npy",   "a.npz",   "a.glb",
                                    "a.txt", "a.gltf", "a.e57", "a.pts", NULL,    "a.bnpts", "a.extxyz"};
static const char *const columns[] = {"x,y,z", "-,x,y,z,nx", "z y x", "x,y,z,x", "x"};

enum { NAMES = sizeof names / sizeof *names, COLUMNS = sizeof columns / sizeof *columns };

static void read_bytes(brio_context *ctx, const void *bytes, size_t size, const char *name, const char *named) {
    brio_read_options o = brio_read_options_default();
    brio_mesh *m = NULL;
    o.columns = named;
    brio_status status = brio_read_memory(ctx, bytes, size, name, &o, &m);
    fuzz_expect_failure(status);
    FUZZ_EXPECT((status == BRIO_OK) == (m != NULL), "status %d", (int)status);
    FUZZ_EXPECT(status != BRIO_ERR_OPEN && status != BRIO_ERR_CANCELLED && status != BRIO_ERR_WRITE, "status %d: %s",
                (int)status, brio_message(ctx));
    if (m) fuzz_expect_sound(m);
    brio_mesh_free(m);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    size_t choice = fuzz_below(&in, 32);
    static wrapped w;
    if (choice < NAMES) {
        read_bytes(ctx, in.at, in.left, names[choice], NULL);
    } else if (choice < NAMES + WRAPPINGS) {
        wrap(&w, (wrapping)(choice - NAMES), in.at, in.left);
        read_bytes(ctx, w.bytes, w.size, w.name, NULL);
    } else {
        read_bytes(ctx, in.at, in.left, "a.csv", columns[choice % COLUMNS]);
    }
    fuzz_end();
    return 0;
}
