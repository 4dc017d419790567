/* Surfaces of the same samples otherwise: in another order, scaled by a power of two, in threads. The faces are the same, by
 * the positions of their corners, to the last bit. */
#include "base/rng.h"
#include "surface_methods.h"

/* A number for the faces of a mesh that depends neither on their order nor on that of the vertices, nor on the corner that
 * comes first.   scale  of the positions, a power of two. */
static uint64_t mix(uint64_t x) {
    x = (x ^ x >> 31) * UINT64_C(0x9e3779b97f4a7c15);
    return x ^ x >> 29;
}

static uint64_t number_of(const double *position, double scale) {
    uint64_t number = 0;
    for (int k = 0; k < 3; k++) {
        double x = position[k] / scale + 0.0; /* no -0 */
        uint64_t bits;
        memcpy(&bits, &x, sizeof bits);
        number = mix(number + bits + 1);
    }
    return number;
}

static uint64_t faces_number(const brio_mesh *m, double scale) {
    uint64_t sum = m ? m->num_faces : UINT64_MAX;
    for (size_t f = 0; m && f < m->num_faces; f++)
        for (uint64_t c = m->face_offsets[f]; c < m->face_offsets[f + 1]; c++) {
            uint64_t next = c + 1 < m->face_offsets[f + 1] ? c + 1 : m->face_offsets[f];
            uint64_t from = number_of(m->vertices + 3 * (size_t)m->face_vertices[c], scale);
            sum += mix(from + mix(number_of(m->vertices + 3 * (size_t)m->face_vertices[next], scale)));
        }
    return sum;
}

static void shuffle_and_scale(double *points, size_t n, uint64_t seed, double scale) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = n; i > 1; i--) {
        size_t j = brio_rng_below(&rng, (uint32_t)i);
        for (size_t k = 0; k < 3; k++) {
            double x = points[3 * (i - 1) + k];
            points[3 * (i - 1) + k] = points[3 * j + k], points[3 * j + k] = x;
        }
    }
    for (size_t i = 0; i < 3 * n; i++) points[i] *= scale;
}

static bool may_round(const double *points, size_t n) {
    for (size_t i = 0; i < 3 * n; i++)
        if (points[i] != 0 && (fabs(points[i]) < 1e-60 || fabs(points[i]) > 1e60)) return true;
    return false;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    double points[3 * MOST_SAMPLES];
    surface_method method = fuzz_method(&in);
    uint8_t change = fuzz_byte(&in);
    size_t n = fuzz_samples(&in, points);
    fuzz_input options = in; /* for both */
    double scale = may_round(points, n) ? 1 : ldexp(1, change % 32 - 16);
    reconstruction first = method(ctx, &in, points, n, 1);
    shuffle_and_scale(points, n, change, scale);
    brio_context_set_threads(ctx, change < 32 ? 3 : 1);
    reconstruction second = method(ctx, &options, points, n, scale);
    FUZZ_EXPECT(faces_number(first.mesh, 1) == faces_number(second.mesh, scale), "%s: %zu and %zu faces", first.method,
                first.mesh ? first.mesh->num_faces : 0, second.mesh ? second.mesh->num_faces : 0);
    brio_mesh_free(first.mesh);
    brio_mesh_free(second.mesh);
    fuzz_end();
    return 0;
}
