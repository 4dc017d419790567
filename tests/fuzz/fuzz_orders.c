/* Triangulations of any finite doubles: the exact check passes, and the checksum is the same for every order, location and
 * number of threads, for points in another order, with duplicates, and scaled by a power of two; also with a scratch folder,
 * and with hidden points left. */
#include "points_input.h"

enum { MOST = 40, ROOM = MOST + 8 };

typedef struct {
    size_t n;
    bool weighted;
    double points[3 * ROOM], weights[ROOM];
} cloud;

static void make_cloud(fuzz_input *in, cloud *c) {
    c->weighted = fuzz_byte(in) % 4 == 0;
    c->n = fuzz_below(in, MOST + 1);
    for (size_t i = 0; i < 3 * c->n; i++) c->points[i] = fuzz_double(in);
    for (size_t i = 0; i < c->n; i++) c->weights[i] = c->weighted ? fuzz_double(in) : 0;
}

static void swap_rows(cloud *c, size_t i, size_t j) {
    double weight = c->weights[i];
    c->weights[i] = c->weights[j], c->weights[j] = weight;
    for (size_t k = 0; k < 3; k++) {
        double x = c->points[3 * i + k];
        c->points[3 * i + k] = c->points[3 * j + k], c->points[3 * j + k] = x;
    }
}

/* The same points otherwise: some twice, rows exchanged, and twice as large where that does not round. */
static void change_cloud(fuzz_input *in, cloud *c) {
    for (size_t more = c->n ? fuzz_below(in, 8) : 0; more; more--) {
        size_t from = fuzz_below(in, c->n);
        for (size_t k = 0; k < 3; k++) c->points[3 * c->n + k] = c->points[3 * from + k];
        c->weights[c->n++] = c->weights[from];
    }
    for (size_t i = c->n; i > 1; i--) swap_rows(c, i - 1, fuzz_below(in, i));
    double most = 0;
    for (size_t i = 0; i < c->n; i++) most = fmax(most, fabs(c->weights[i]) / 4);
    for (size_t i = 0; i < 3 * c->n; i++) most = fmax(most, fabs(c->points[i]));
    if (most > 1e300 || (c->weighted && most > 1e70)) return;
    for (size_t i = 0; i < 3 * c->n; i++) c->points[i] *= 2;
    for (size_t i = 0; i < c->n; i++) c->weights[i] *= 4;
}

static uint64_t checksum_of(brio_context *ctx, const cloud *c, const trial_options *o) {
    brio_triangulation *t;
    uint64_t sum = 0;
    const double *w = c->weighted ? c->weights : NULL;
    FUZZ_EXPECT(trial_delaunay(ctx, c->points, w, c->n, o, &t, NULL) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(brio_triangulation_check(ctx, t, c->points, w, c->n) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(brio_triangulation_checksum(ctx, t, c->points, &sum) == BRIO_OK);
    brio_triangulation_free(t);
    return sum;
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    static cloud c;
    uint32_t edges[32];
    make_cloud(&in, &c);
    uint64_t first = checksum_of(ctx, &c, NULL);
    brio_context_set_threads(ctx, fuzz_byte(&in) < 16 ? 3 : 1);
    change_cloud(&in, &c);
    trial_options o = fuzz_options(&in, c.n, edges);
    uint8_t bits = fuzz_byte(&in);
    o.leave_hidden = bits & 1;
    if (bits & 2) FUZZ_EXPECT(brio_context_set_scratch(ctx, "/tmp") == BRIO_OK, "%s", brio_message(ctx));
    uint64_t second = checksum_of(ctx, &c, &o);
    FUZZ_EXPECT(brio_context_set_scratch(ctx, NULL) == BRIO_OK);
    FUZZ_EXPECT(first == second, "order %d, location %d: %llx, %llx", (int)o.order, (int)o.locate,
                (unsigned long long)first, (unsigned long long)second);
    fuzz_end();
    return 0;
}
