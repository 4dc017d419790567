/* The exact check against brute force, on mutated sets: it accepts exactly the right ones, and knows which are canonical.
 * The first byte chooses a scene; then each three bytes are a mutation and what is random in it. */
#include "fuzz.h"
#include "scenes.h"

enum { SCENES = 48, MOST_MUTATIONS = 6 };

static const scene *scene_of(brio_context *ctx, size_t i) {
    static scene *scenes[SCENES];
    if (!scenes[i]) {
        scenes[i] = malloc(sizeof *scenes[i]);
        make_scene(ctx, scenes[i], i + 1, 3);
    }
    return scenes[i];
}

static void judge(brio_context *ctx, const site_set *s, const tet_set *t) {
    double points[3 * BRUTE_POINTS], weights[BRUTE_POINTS];
    int canonical = -1;
    as_doubles(s, 0, points, weights);
    brio_status status =
        brio_tetrahedra_check(ctx, points, s->weighted ? weights : NULL, s->n, *t->v, 4, t->count, &canonical);
    bool right = brute_accepts(s, t);
    FUZZ_EXPECT(status == (right ? BRIO_OK : BRIO_ERR_CHECK), "%s set: %s", right ? "right" : "wrong",
                brio_message(ctx));
    FUZZ_EXPECT(canonical == (right ? brute_canonical(s, t) : -1), "canonical %d", canonical);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size) {
    brio_context *ctx = fuzz_context();
    fuzz_input in = {bytes, size};
    static scene e;
    static tet_set t;
    e = *scene_of(ctx, fuzz_below(&in, SCENES));
    t = e.right[fuzz_below(&in, ALTERNATIVES)];
    for (int i = 0; i < MOST_MUTATIONS && in.left && t.count; i++) {
        mutation change = MUTATIONS[fuzz_below(&in, sizeof MUTATIONS / sizeof *MUTATIONS)];
        e.rng = brio_rng_new(fuzz_below(&in, 65536));
        change(&e, &t);
    }
    judge(ctx, &e.s, &t);
    FUZZ_EXPECT(!harness_failures);
    fuzz_end();
    return 0;
}
