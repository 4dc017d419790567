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

/* What brio_in_conflict says of a finite tetrahedron, by the exact stages alone. */
static bool is_in_conflict(const brio_tetrahedra *t, brio_filter *f, uint32_t tet, const double *p, bool weighted) {
    const uint32_t *v = t->tet[tet].vertex;
    const double *a = t->record[v[0]], *b = t->record[v[1]], *c = t->record[v[2]], *d = t->record[v[3]];
    int sign = brio_insphere_exact(a, b, c, d, p, weighted);
    return (sign ? sign : brio_insphere_tie(f, a, b, c, d, p)) > 0;
}

/* Compares lanes with the exact stages on tetrahedra of the points. Returns how many tests reached these stages. */
static uint64_t compare(const brio_engine *engine, brio_record *record, bool weighted) {
    brio_tetrahedron tets[BRIO_BATCH] = {0};
    brio_tetrahedra t = {.tet = tets, .count = BRIO_BATCH, .infinite = POINTS, .record = record};
    brio_filter filter, judge;
    brio_rng rng = brio_rng_new(5);
    uint32_t facets[BRIO_BATCH], p;
    int compared = 0, wrong = 0;
    record[POINTS][3] = INFINITY;
    brio_filter_for(&filter, (const brio_record *)record, POINTS, weighted);
    judge = filter;
    for (uint32_t i = 0; i < BRIO_BATCH; i++) facets[i] = brio_facet_of(i, 0);
    for (int trial = 0; trial < TRIALS; trial++) {
        if (!make_batch(&rng, record, tets, &p)) continue;
        unsigned found = engine->conflicts(&t, &filter, facets, BRIO_BATCH, record[p]);
        for (uint32_t i = 0; i < BRIO_BATCH; i++)
            wrong += (found >> i & 1) != is_in_conflict(&t, &judge, i, record[p], weighted);
        compared++;
    }
    EXPECT(wrong == 0, "%d of %d", wrong, compared * BRIO_BATCH);
    EXPECT(compared > TRIALS / 3, "%d batches", compared);
    return filter.exact;
}

static void exactly_cospherical_points_are_ties_in_lanes_too(void) {
    static brio_record record[POINTS + 1];
    cospherical_points(3, record);
    for (int weighted = 0; weighted < 2; weighted++) {
        for (int i = 0; i < POINTS; i++) record[i][3] = weighted ? 7 : 0;
        for (int set = 0; set < BRIO_INSTRUCTION_SETS; set++)
            if (use_set(set)) compare(brio_engine_choose(weighted), record, weighted);
    }
}

/* Writes points on a sphere, one in 16 of them 2^30 times as far out; all of them times 2^exponent, and weights of no
 * consequence times the square of that. */
static void points_with_far_ones(uint64_t seed, int exponent, brio_record *record) {
    static double p[3 * POINTS];
    sphere_points(seed, POINTS, p);
    for (int i = 0; i < POINTS; i++) {
        for (int k = 0; k < 3; k++) record[i][k] = ldexp(p[3 * i + k], exponent + (i % 16 == 0 ? 30 : 0));
        record[i][3] = ldexp(i % 5, 2 * exponent - 30);
    }
}

/* Vertices far from the others, and units in which products overflow or vanish, once made each test exact. */
static void neither_far_vertices_nor_far_units_make_tests_exact(void) {
    static brio_record record[POINTS + 1];
    static const int EXPONENTS[] = {0, 300, 500, 990, -300, -500, -1000};
    for (size_t e = 0; e < sizeof EXPONENTS / sizeof *EXPONENTS; e++)
        for (int weighted = 0; weighted < 2; weighted++) {
            if (weighted && (EXPONENTS[e] > 500 || EXPONENTS[e] < -500)) continue; /* no doubles hold the weights */
            points_with_far_ones(e, EXPONENTS[e], record);
            for (int set = 0; set < BRIO_INSTRUCTION_SETS; set++) {
                if (!use_set(set)) continue;
                uint64_t exact = compare(brio_engine_choose(weighted), record, weighted);
                EXPECT(exact < BRIO_BATCH * TRIALS / 1000, "2^%d, weighted %d: %llu tests", EXPONENTS[e], weighted,
                       (unsigned long long)exact);
            }
        }
}

/* --- slacks of tetrahedra --- */

enum { SOUND_ROWS = 8 * BRIO_BATCH + 1, INFINITE_ROW = SOUND_ROWS - 1 };

static double square_distance(const double *p, const double *q) {
    double x = p[0] - q[0], y = p[1] - q[1], z = p[2] - q[2];
    return x * x + y * y + z * z;
}

/* Tetrahedra with a vertex behind each facet, all of their own points: rows 8 i to 8 i + 7 are those of number i. Many
 * are thin, and many of the vertices behind facets are near the sphere. */
static void draw_stars(brio_rng *rng, bool weighted, brio_record *record, brio_tetrahedron *tets) {
    for (uint32_t i = 0; i < BRIO_BATCH; i++) {
        brio_record *r = record + 8 * i;
        static const double NEAR[] = {0.02, 0.02, 0.5, 0.5, 1e-14}; /* the last: on both sides of the sphere */
        double thin = brio_rng_below(rng, 3) ? 1 : 0.02, near = NEAR[brio_rng_below(rng, 5)], centre[3];
        for (int k = 0; k < 8; k++)
            for (int c = 0; c < 4; c++)
                r[k][c] =
                    c == 3 ? (weighted ? 0.002 * brio_rng_double(rng) : 0) : brio_rng_double(rng) * (c == 2 ? thin : 1);
        for (uint32_t k = 0; k < 4; k++) tets[i].vertex[k] = 8 * i + k;
        if (brio_orient3d(r[0], r[1], r[2], r[3]) < 0) tets[i].vertex[0] = 8 * i + 1, tets[i].vertex[1] = 8 * i;
        EXPECT(brio_circumcentre(r[0], r[1], r[2], r[3], NULL, centre, NULL) == BRIO_OK);
        double radius = sqrt(square_distance(centre, r[0]));
        for (uint32_t k = 0; k < 4; k++) {
            double length = 0, *e = r[4 + k];
            uint32_t behind = BRIO_BATCH + 4 * i + k;
            for (int c = 0; c < 3; c++) e[c] = 2 * brio_rng_double(rng) - 1, length += e[c] * e[c];
            for (int c = 0; c < 3; c++)
                e[c] = centre[c] +
                       radius * (1 + near * (brio_rng_double(rng) - (near < 1e-9 ? 0.5 : 0))) * e[c] / sqrt(length);
            tets[i].mate[k] = brio_facet_of(behind, 0);
            tets[behind] = (brio_tetrahedron){{8 * i + 4 + k, 0, 0, 0}, {0, 0, 0, 0}};
        }
    }
    record[INFINITE_ROW][3] = INFINITY;
}

/* What a move may change the sign of: the volume, or the in-sphere determinant of a vertex behind a facet. */
static double measure(double p[5][4], bool of_volume, bool weighted) {
    if (!of_volume) return -brio_insphere_estimate(p[0], p[1], p[2], p[3], p[4], weighted);
    double row[3][3];
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++) row[i][c] = p[i + 1][c] - p[0][c];
    return row[0][0] * (row[1][1] * row[2][2] - row[1][2] * row[2][1]) -
           row[0][1] * (row[1][0] * row[2][2] - row[1][2] * row[2][0]) +
           row[0][2] * (row[1][0] * row[2][1] - row[1][1] * row[2][0]);
}

/* Moves each point by a distance against the gradient. */
static void move_against(double p[5][4], double distance, bool of_volume, bool weighted) {
    static const double STEP = 1e-5;
    double to[5][3];
    for (int i = 0; i < 5; i++) {
        double length = 0;
        for (int c = 0; c < 3; c++) {
            double keep = p[i][c], above;
            p[i][c] = keep + STEP, above = measure(p, of_volume, weighted);
            p[i][c] = keep - STEP, to[i][c] = measure(p, of_volume, weighted) - above;
            p[i][c] = keep;
            length += to[i][c] * to[i][c];
        }
        for (int c = 0; c < 3 && length > 0; c++) to[i][c] *= 0.9999 * distance / sqrt(length);
    }
    for (int i = 0; i < 5; i++)
        for (int c = 0; c < 3; c++) p[i][c] += to[i][c];
}

/* Returns whether the worst moves by a distance leave a star of number i as it is. */
static bool stays(const brio_record *record, const brio_tetrahedron *tet, uint32_t i, double distance, bool weighted) {
    for (uint32_t k = 0; k < 5; k++) {
        double p[5][4];
        for (uint32_t v = 0; v < 5; v++) {
            uint32_t row = v < 4 ? tet->vertex[v] : 8 * i + 4 + k % 4;
            for (int c = 0; c < 4; c++) p[v][c] = record[row][c];
        }
        for (int steps = 0; steps < 4; steps++) move_against(p, distance / 4, k == 4, weighted); /* it bends */
        if (brio_orient3d(p[0], p[1], p[2], p[3]) <= 0) return false;
        double weights[5] = {p[0][3], p[1][3], p[2][3], p[3][3], p[4][3]};
        if (k < 4 && brio_insphere(p[0], p[1], p[2], p[3], p[4], weighted ? weights : NULL) >= 0) return false;
    }
    return true;
}

/*  wide  other points are so far away that the filter's static bounds settle nothing. */
static void hold_slacks(const brio_engine *engine, bool weighted, bool wide) {
    static brio_record record[SOUND_ROWS];
    static brio_tetrahedron tets[5 * BRIO_BATCH];
    brio_tetrahedra t = {.tet = tets, .count = 5 * BRIO_BATCH, .infinite = INFINITE_ROW, .record = record};
    brio_filter filter;
    brio_rng rng = brio_rng_new(11);
    size_t sound = 0, broken = 0, loose = 0;
    for (int trial = 0; trial < (BRIEF_TESTS ? 40 : 150); trial++) {
        uint32_t which[BRIO_BATCH];
        double slack[BRIO_BATCH];
        draw_stars(&rng, weighted, record, tets);
        brio_filter_for(&filter, (const brio_record *)record, INFINITE_ROW, weighted);
        if (wide) brio_filter_set(&filter, (double[3]){1e6, 1e6, 1e6}, 1, weighted);
        for (uint32_t i = 0; i < BRIO_BATCH; i++) which[i] = i;
        uint64_t bits = engine->sound(&t, &filter, which, BRIO_BATCH, slack);
        for (uint32_t i = 0; i < BRIO_BATCH; i++) {
            if (!(bits >> i & 1) || !(slack[i] > 0)) continue;
            sound++;
            broken += !stays((const brio_record *)record, &tets[i], i, slack[i], weighted);
            loose += stays((const brio_record *)record, &tets[i], i, 4 * slack[i], weighted);
        }
    }
    EXPECT(sound > (BRIEF_TESTS ? 30 : 150) && broken == 0, "%zu of %zu, weighted %d, wide %d", broken, sound, weighted,
           wide);
    EXPECT(loose < sound - sound / 4, "%zu of %zu could have four times the slack, weighted %d", loose, sound,
           weighted);
}

static void no_move_within_the_slack_breaks_a_star(void) {
    for (int weighted = 0; weighted < 2; weighted++)
        for (int set = 0; set < BRIO_INSTRUCTION_SETS; set++)
            for (int wide = 0; wide < 2 && use_set(set); wide++)
                hold_slacks(brio_engine_choose(weighted), weighted, wide);
}

/* A vertex behind the first facet whose lift is no number: infinity less infinity. It left no trace in what was found
 * of the other facets, and a tetrahedron in conflict was told to be sound. */
static void a_lift_that_is_no_number_is_not_sound(void) {
    static brio_record record[SOUND_ROWS];
    static brio_tetrahedron tets[5 * BRIO_BATCH];
    brio_tetrahedra t = {.tet = tets, .count = 5 * BRIO_BATCH, .infinite = INFINITE_ROW, .record = record};
    brio_rng rng = brio_rng_new(5);
    for (int set = 0; set < BRIO_INSTRUCTION_SETS; set++)
        for (uint32_t facet = 0; facet < 4 && use_set(set); facet++) {
            uint32_t which[BRIO_BATCH];
            double slack[BRIO_BATCH];
            brio_filter filter;
            draw_stars(&rng, true, record, tets);
            for (uint32_t i = 0; i < BRIO_BATCH; i++) {
                double *far = record[8 * i + 4 + facet];
                which[i] = i;
                for (int v = 0; v < 8; v++) record[8 * i + (uint32_t)v][3] = -1.7e308;
                far[0] = 1.4e154, far[1] = far[2] = 0, far[3] = 1.7e308;
            }
            brio_filter_for(&filter, (const brio_record *)record, INFINITE_ROW, true);
            EXPECT(brio_engine_choose(true)->sound(&t, &filter, which, BRIO_BATCH, slack) == 0, "facet %u", facet);
        }
}

/* Tests a full batch of the stars from number `first` on. Returns the bits of the first BRIO_BATCH of them; all others are the same
 * again. */
static uint64_t test_full_batch(const brio_engine *engine, const brio_tetrahedra *t, uint32_t first) {
    uint32_t which[BRIO_SOUND_BATCH];
    double slack[BRIO_SOUND_BATCH];
    brio_filter filter;
    brio_filter_for(&filter, t->record, INFINITE_ROW, false);
    for (uint32_t i = 0; i < BRIO_SOUND_BATCH; i++) which[i] = first + i % BRIO_BATCH;
    uint64_t bits = engine->sound(t, &filter, which, BRIO_SOUND_BATCH, slack), some = bits & ((1u << BRIO_BATCH) - 1);
    for (int i = 0; i < BRIO_SOUND_BATCH; i += BRIO_BATCH)
        EXPECT((bits >> i & ((1u << BRIO_BATCH) - 1)) == some, "batch at %d", i);
    return some;
}

/* Every vertex behind a facet is in conflict: that counts where the tetrahedron behind is finite and has a higher number. */
static void neighbours_of_higher_number_are_asked(void) {
    enum { ALL = (1 << BRIO_BATCH) - 1, BEHIND = 4 * BRIO_BATCH };
    static brio_record record[SOUND_ROWS];
    static brio_tetrahedron tets[5 * BRIO_BATCH], lower[5 * BRIO_BATCH];
    brio_tetrahedra t = {.tet = tets, .count = 5 * BRIO_BATCH, .infinite = INFINITE_ROW, .record = record}, u = t;
    brio_rng rng = brio_rng_new(3);
    draw_stars(&rng, false, record, tets);
    for (uint32_t i = 0; i < BRIO_BATCH; i++)
        for (uint32_t k = 0; k < 4; k++)
            for (int c = 0; c < 3; c++) {
                const brio_record *r = (const brio_record *)record + 8 * i;
                record[8 * i + 4 + k][c] = r[0][c] / 4 + r[1][c] / 4 + r[2][c] / 4 + r[3][c] / 4;
            }
    u.tet = lower;
    memcpy(lower, tets + BRIO_BATCH, BEHIND * sizeof *lower);
    memcpy(lower + BEHIND, tets, BRIO_BATCH * sizeof *lower);
    for (uint32_t i = 0; i < BRIO_BATCH; i++)
        for (uint32_t k = 0; k < 4; k++) lower[BEHIND + i].mate[k] = brio_facet_of(4 * i + k, 0);
    for (int set = 0; set < BRIO_INSTRUCTION_SETS; set++) {
        if (!use_set(set)) continue;
        const brio_engine *engine = brio_engine_choose(false);
        EXPECT(test_full_batch(engine, &t, 0) == 0);
        EXPECT(test_full_batch(engine, &u, BEHIND) == ALL);
    }
    for (uint32_t i = 0; i < BEHIND; i++) tets[BRIO_BATCH + i].vertex[3] = INFINITE_ROW;
    for (uint32_t i = 0; i < BRIO_BATCH; i++)
        for (int k = 0; k < 4; k++) tets[i].mate[k] |= 3;
    for (int set = 0; set < BRIO_INSTRUCTION_SETS; set++)
        if (use_set(set)) EXPECT(test_full_batch(brio_engine_choose(false), &t, 0) == ALL);
}

SUITE(test_engine) {
    RUN(exactly_cospherical_points_are_ties_in_lanes_too);
    RUN(neither_far_vertices_nor_far_units_make_tests_exact);
    RUN(no_move_within_the_slack_breaks_a_star);
    RUN(neighbours_of_higher_number_are_asked);
    RUN(a_lift_that_is_no_number_is_not_sound);
    return harness_end();
}
