/* Every reconstruction, with every option: what it promises of its surface is judged by surface_oracle.h. The samples are few,
 * so that labels are often wrong. */
#include "surface_methods.h"
#include "surface_oracle.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    double points[3 * MOST_SAMPLES];
    surface_method method = fuzz_method(&in);
    brio_context_set_threads(ctx, fuzz_byte(&in) < 8 ? 2 : 1);
    size_t n = fuzz_samples(&in, points);
    reconstruction r = method(ctx, &in, points, n, 1);
    if (r.mesh && r.surface) expect_surface(ctx, r.mesh, r.closed, r.method);
    if (r.mesh && !r.surface) fuzz_expect_sound(r.mesh), expect_certificate(ctx, r.mesh);
    brio_mesh_free(r.mesh);
    fuzz_end();
    return 0;
}
