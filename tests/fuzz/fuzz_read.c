/* Every reader, from memory: a file is read, or it is refused with a reason. With `salvage` a file that is read has the same
 * points, or fewer and says so. */
#include "read_input.h"

static void expect_salvage(brio_context *ctx, const read_input *r, brio_read_options o, const brio_mesh *whole) {
    brio_mesh *m = NULL;
    uint64_t missing = 0;
    o.salvage = 1;
    o.missing = &missing;
    brio_status status = brio_read_memory(ctx, r->bytes, r->size, r->name, &o, &m);
    fuzz_expect_failure(status);
    FUZZ_EXPECT((status == BRIO_OK) == (m != NULL), "status %d", (int)status);
    FUZZ_EXPECT(!whole || m, "refused with salvage: %s", brio_message(ctx));
    if (m) fuzz_expect_sound(m);
    FUZZ_EXPECT(!whole || m->num_vertices + missing >= whole->num_vertices, "points are lost");
    brio_mesh_free(m);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    brio_read_options o = {0};
    brio_mesh *m = NULL;
    read_input r = fuzz_read_input(&in);
    o.columns = r.columns;
    brio_status status = brio_read_memory(ctx, r.bytes, r.size, r.name, &o, &m);
    fuzz_expect_failure(status);
    FUZZ_EXPECT((status == BRIO_OK) == (m != NULL), "status %d", (int)status);
    FUZZ_EXPECT(status != BRIO_ERR_OPEN && status != BRIO_ERR_CANCELLED && status != BRIO_ERR_WRITE, "status %d: %s",
                (int)status, brio_message(ctx));
    if (m) fuzz_expect_sound(m);
    expect_salvage(ctx, &r, o, m);
    brio_mesh_free(m);
    fuzz_end();
    return 0;
}
