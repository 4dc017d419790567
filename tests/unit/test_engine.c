/* The conflict tests in vector lanes against the exact stage, where only that can tell. */
#include "harness.h"
#include "instruction_sets.h"
#include "points.h"
#include "triangulation/engine.h"

enum { POINTS = 1152, TRIALS = 20000 };

/* Points exactly on one sphere about the origin, of 50 bits a coordinate: an integer quaternion turns the x axis into an
 * integer vector as long as its squared norm, and all its permutations have one norm. */
static void cospherical_points(uint64_t seed, brio_record *record) {
    brio_rng rng = brio_rng_new(seed);
    double q[4];
    for (int i = 0; i < 4; i++) q[i] = (double)(brio_rng_next(&rng) >> 40);
    for (int i = 0; i < POINTS; i++) {
        double s[4];
        uint32_t shuffle = (uint32_t)(brio_rng_next(&rng) >> 32);
        for (int k = 3; k > 0; k--) {
            int j = (int)brio_rng_below(&rng, (uint32_t)k + 1);
            double keep = q[k];
            q[k] = q[j], q[j] = keep;
        }
        for (int k = 0; k < 4; k++) s[k] = shuffle >> k & 1 ? -q[k] : q[k];
        record[i][0] = s[0] * s[0] + s[1] * s[1] - s[2] * s[2] - s[3] * s[3];
        record[i][1] = 2 * (s[1] * s[2] + s[0] * s[3]);
        record[i][2] = 2 * (s[1] * s[3] - s[0] * s[2]);
        record[i][3] = 0;
    }
}

/* A batch of positive tetrahedra of distinct points, and a point that is none of their vertices. */
static bool make_batch(brio_rng *rng, const brio_record *record, brio_tetrahedron *tets, uint32_t *p) {
    *p = brio_rng_below(rng, POINTS);
    for (int t = 0; t < BRIO_BATCH; t++) {
        uint32_t *v = tets[t].vertex;
        for (int i = 0; i < 4; i++) v[i] = brio_rng_below(rng, POINTS);
        int sign = brio_orient3d(record[v[0]], record[v[1]], record[v[2]], record[v[3]]);
        for (int i = 0; i < 4; i++) sign = brio_same_position(record[v[i]], record[*p]) ? 0 : sign;
        if (sign == 0) return false;
        uint32_t first = v[0];
        if (sign < 0) v[0] = v[1], v[1] = first;
    }
    return true;
}

static void compare(const brio_engine *engine, bool weighted) {
    static brio_record record[POINTS + 1];
    brio_tetrahedron tets[BRIO_BATCH] = {0};
    brio_tetrahedra t = {.tet = tets, .count = BRIO_BATCH, .infinite = POINTS, .record = record};
    brio_filter filter;
    brio_rng rng = brio_rng_new(5);
    uint32_t facets[BRIO_BATCH], p;
    int compared = 0, wrong = 0;
    cospherical_points(3, record);
    for (int i = 0; i < POINTS; i++) record[i][3] = weighted ? 7 : 0;
    record[POINTS][3] = INFINITY;
    brio_filter_for(&filter, (const brio_record *)record, POINTS, weighted);
    for (uint32_t i = 0; i < BRIO_BATCH; i++) facets[i] = brio_facet_of(i, 0);
    for (int trial = 0; trial < TRIALS; trial++) {
        if (!make_batch(&rng, record, tets, &p)) continue;
        unsigned found = engine->conflicts(&t, &filter, facets, BRIO_BATCH, record[p]);
        for (uint32_t i = 0; i < BRIO_BATCH; i++)
            wrong += (found >> i & 1) != brio_in_conflict_exact(&t, &filter, i, record[p], weighted);
        compared++;
    }
    EXPECT(wrong == 0, "%d of %d", wrong, compared * BRIO_BATCH);
    EXPECT(compared > TRIALS / 3, "%d batches", compared);
}

static void exactly_cospherical_points_are_ties_in_lanes_too(void) {
    for (int weighted = 0; weighted < 2; weighted++) {
        for (int set = 0; set < BRIO_INSTRUCTION_SETS; set++)
            if (use_set(set)) compare(brio_engine_choose(weighted), weighted);
    }
}

SUITE(test_engine) {
    RUN(exactly_cospherical_points_are_ties_in_lanes_too);
    return harness_end();
}
