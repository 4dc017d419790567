/* Contested places, mending, weak handles and signs of sheets go in orders that positions give: they know nothing of
 * the numbers of samples and tetrahedra, nor of an object far away. */
#include "base/memory.h"
#include "dual/spacing.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/labeled_delaunay/hash_order.h"
#include "reconstruct/labeled_delaunay/sheet_signs.h"
#include "reconstruct/labeled_delaunay/vote_labels.h"
#include "reconstruct/labeled_delaunay/weak_handles.h"
#include <math.h>

/* SHELLS: spheres of guards round the torus. Contested places reach over one or two of them. */
enum { TORUS = 1200, SHELLS = 3, GUARD = 60 * SHELLS, ALONE = TORUS + GUARD, ALL = ALONE + 600 };

/* Of a torus: the spacing is about a ninth of that, and what is far away is at 2. */
static const double LARGE = 0.01, SMALL = 1e-8;

typedef struct {
    brio_context *ctx;
    double size; /* of the torus */
    double *points, *spacing;
    brio_triangulation *delaunay;
    brio_pole_vectors dual;
    brio_vote_graph graph;
    uint8_t *label;
} scene;

/* Returns which shell a sample is on: 0 of the torus, SHELLS + 1 if it is far away. */
static size_t shell_of(size_t sample) {
    return sample < TORUS ? 0 : sample < ALONE ? 1 + sample % SHELLS : SHELLS + 1;
}

/* A noisy torus at -0.6, with samples on spheres far round it; a noisy ball at 0.6. All coordinates are under 1. */
static void place_points(double size, double *p) {
    brio_rng rng = brio_rng_new(8);
    torus_points(1, TORUS, p);
    sphere_points(2, GUARD, p + 3 * TORUS);
    sphere_points(3, ALL - ALONE, p + 3 * ALONE);
    for (size_t i = 0; i < 3 * ALL; i++) {
        size_t shell = shell_of(i / 3);
        bool far = shell > SHELLS, guard = shell > 0 && !far;
        double x = guard ? pow(3, (double)shell) * p[i] : p[i] + 0.1 * (brio_rng_double(&rng) - 0.5);
        p[i] = (far ? 0.6 : -0.6) + size * x;
    }
}

static scene *scene_with(size_t n, const double *all) {
    brio_status status = BRIO_OK;
    scene *s = calloc(1, sizeof *s);
    s->ctx = new_context();
    s->graph.ctx = s->ctx;
    s->points = malloc(3 * n * sizeof *s->points);
    s->spacing = malloc(n * sizeof *s->spacing);
    memcpy(s->points, all, 3 * n * sizeof *s->points);
    BRIO_TRY(brio_delaunay(s->ctx, s->points, NULL, n, NULL, &s->delaunay));
    BRIO_TRY(brio_sample_spacing(s->ctx, s->delaunay, s->points, n, s->spacing, NULL));
    BRIO_TRY(brio_pole_vectors_find(s->ctx, s->delaunay, s->points, n, 0.39, &s->dual));
done:
    EXPECT(status == BRIO_OK);
    return s;
}

static scene *scene_of(size_t n, double size) {
    double all[3 * ALL];
    place_points(size, all);
    scene *s = scene_with(n, all);
    s->size = size;
    return s;
}

static void weigh(scene *s) {
    EXPECT(brio_vote_graph_new(s->ctx, &s->dual, s->spacing, 0, NULL, &s->graph) == BRIO_OK);
    s->label = calloc(s->dual.t.count + s->dual.num_points, 1);
}

static void free_scene(scene *s) {
    brio_context *ctx = s->ctx;
    brio_vote_graph_free(&s->graph);
    brio_pole_vectors_free(ctx, &s->dual);
    brio_triangulation_free(s->delaunay);
    free(s->points);
    free(s->spacing);
    free(s->label);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    free(s);
}

static bool is_in_torus(const scene *s, size_t tet) {
    for (int i = 0; i < 4; i++)
        if (s->dual.t.tet[tet].vertex[i] >= TORUS) return false;
    return true;
}

/* Returns whether a finite tetrahedron is inner before it is spoiled: what is within every other shell and not in the
 * torus, or in the ball. */
static bool is_inner(const scene *s, size_t tet) {
    const uint32_t *v = s->dual.t.tet[tet].vertex;
    double c[3] = {0, 0, 0}, square = 0;
    size_t shell = 0;
    for (int i = 0; i < 4; i++)
        if (shell_of(v[i]) > shell) shell = shell_of(v[i]);
    for (size_t k = 0; k < 3; k++) {
        for (int i = 0; i < 4; i++) c[k] += (s->points[3 * (size_t)v[i] + k] + (shell > SHELLS ? -0.6 : 0.6)) / 4;
        c[k] /= s->size;
        square += c[k] * c[k];
    }
    double ring = sqrt(c[0] * c[0] + c[1] * c[1]) - 1;
    return shell == 0 ? ring * ring + c[2] * c[2] >= 0.16 : shell > SHELLS ? square < 1 : shell % 2 == 1;
}

/* One in eight of the tetrahedra of torus samples has the other label. */
static void label_spoiled(const scene *s) {
    for (size_t t = 0; t < s->dual.t.count; t++) {
        s->label[t] = BRIO_LABEL_OUTER;
        if (t >= s->dual.num_finite) continue;
        bool spoiled = is_in_torus(s, t) && brio_tet_hash(&s->dual, t) % 8 == 0;
        if (is_inner(s, t) != spoiled) s->label[t] = BRIO_LABEL_INNER;
    }
    for (size_t p = 0; p < s->dual.num_points; p++) s->label[s->dual.t.count + p] = BRIO_LABEL_OUTER;
}

/* Returns how many tetrahedra changed. */
static size_t settle(scene *s) {
    size_t undecided, changed = 0;
    uint8_t *before = malloc(s->dual.t.count);
    memcpy(before, s->label, s->dual.t.count);
    EXPECT(brio_settle_labels(&s->graph, s->label, &undecided) == BRIO_OK);
    for (size_t t = 0; t < s->dual.t.count; t++) changed += before[t] != s->label[t];
    free(before);
    return changed;
}

static size_t mend(scene *s) {
    brio_label_flips flips;
    brio_mending mending;
    size_t removed;
    EXPECT(brio_label_flips_new(&s->graph, s->label, &flips) == BRIO_OK);
    EXPECT(brio_mending_new(&flips, &mending) == BRIO_OK && mending.singular > 100);
    EXPECT(brio_mend(&mending) == BRIO_OK);
    EXPECT(brio_remove_weak_handles(&mending, &removed) == BRIO_OK);
    brio_label_samples(&flips);
    size_t size = flips.size;
    brio_mending_free(&mending);
    brio_label_flips_free(&flips);
    return size + removed;
}

/* --- numbers --- */

static void shuffle(brio_rng *rng, uint32_t *number, size_t from, size_t to) {
    for (size_t i = from; i < to; i++) number[i] = (uint32_t)i;
    for (size_t i = to; i > from + 1; i--) {
        size_t k = from + brio_rng_below(rng, (uint32_t)(i - from));
        uint32_t swap = number[i - 1];
        number[i - 1] = number[k], number[k] = swap;
    }
}

typedef struct {
    uint32_t *sample, *tet; /* the new number of each */
    uint32_t (*slot)[4];    /* of each tetrahedron, the new slot of what is in a slot */
} numbers;

/* Infinite tetrahedra stay behind the finite ones, and keep the infinite vertex in slot 3. */
static numbers new_numbers(const scene *s, uint64_t seed) {
    size_t n = s->dual.num_points, tets = s->dual.t.count;
    brio_rng rng = brio_rng_new(seed);
    numbers to = {malloc(4 * n), malloc(4 * tets), malloc(16 * tets)};
    shuffle(&rng, to.sample, 0, n);
    shuffle(&rng, to.tet, 0, s->dual.num_finite);
    shuffle(&rng, to.tet, s->dual.num_finite, tets);
    for (size_t t = 0; t < tets; t++) {
        to.slot[t][3] = 3;
        shuffle(&rng, to.slot[t], 0, t < s->dual.num_finite ? 4 : 3);
    }
    return to;
}

static void free_numbers(numbers *to) {
    free(to->sample);
    free(to->tet);
    free(to->slot);
}

/* Makes a scene with other numbers and the same tetrahedra, and the same centres and axes as far as they are there. */
static scene *renumber_tetrahedra(const scene *s, const numbers *to) {
    size_t n = s->dual.num_points, tets = s->dual.t.count;
    brio_status status = BRIO_OK;
    scene *o = calloc(1, sizeof *o);
    brio_pole_vectors *v = &o->dual;
    o->ctx = o->graph.ctx = new_context();
    *v = (brio_pole_vectors){.t = {.count = tets, .infinite = s->dual.t.infinite},
                             .num_finite = s->dual.num_finite,
                             .num_points = n,
                             .num_vertices = n};
    v->points = o->points = malloc(3 * n * sizeof *o->points);
    o->spacing = malloc(n * sizeof *o->spacing);
    BRIO_TRY(BRIO_ALLOC(o->ctx, v->t.tet, tets));
    if (s->dual.centre) BRIO_TRY(BRIO_ALLOC(o->ctx, v->centre, 4 * tets));
    if (s->dual.plane) BRIO_TRY(BRIO_ALLOC(o->ctx, v->plane, 4 * n));
    for (size_t p = 0; p < n; p++) {
        memcpy(o->points + 3 * (size_t)to->sample[p], s->points + 3 * p, 24);
        o->spacing[to->sample[p]] = s->spacing[p];
        if (v->plane) memcpy(v->plane + 4 * (size_t)to->sample[p], s->dual.plane + 4 * p, 32);
    }
    for (size_t t = 0; t < tets; t++) {
        uint32_t at = to->tet[t];
        if (v->centre) memcpy(v->centre + 4 * (size_t)at, s->dual.centre + 4 * t, 32);
        for (int i = 0; i < 4; i++) {
            uint32_t slot = to->slot[t][i], mate = s->dual.t.tet[t].mate[i], vertex = s->dual.t.tet[t].vertex[i];
            v->t.tet[at].vertex[slot] = vertex == v->t.infinite ? vertex : to->sample[vertex];
            v->t.tet[at].mate[slot] = 4 * to->tet[mate >> 2] + to->slot[mate >> 2][mate & 3];
        }
    }
done:
    EXPECT(status == BRIO_OK);
    return o;
}

static void list_stars(const brio_tetrahedra *t, size_t n, brio_vote_graph *g) {
    for (size_t t4 = 0; t4 < 4 * t->count; t4++) {
        uint32_t vertex = t->tet[t4 / 4].vertex[t4 % 4];
        if (vertex != t->infinite) g->first[vertex + 1]++;
    }
    for (size_t p = 0; p < n; p++) g->first[p + 1] += g->first[p];
    for (uint32_t t4 = 0; t4 < 4 * t->count; t4++) {
        uint32_t vertex = t->tet[t4 / 4].vertex[t4 % 4];
        if (vertex != t->infinite) g->star[g->first[vertex]++] = t4;
    }
    for (size_t p = n; p > 0; p--) g->first[p] = g->first[p - 1];
    g->first[0] = 0;
}

/* Makes a scene with other numbers, and the same weights and labels. */
static scene *renumber(const scene *s, const numbers *to) {
    size_t n = s->dual.num_points, tets = s->dual.t.count;
    brio_status status = BRIO_OK;
    scene *o = renumber_tetrahedra(s, to);
    brio_vote_graph *g = &o->graph;
    *g = (brio_vote_graph){.ctx = o->ctx, .dual = &o->dual, .num_free = s->graph.num_free};
    o->label = calloc(tets + n, 1);
    BRIO_TRY(BRIO_ALLOC(o->ctx, g->vote, tets));
    BRIO_TRY(BRIO_ALLOC(o->ctx, g->facet, tets));
    BRIO_TRY(BRIO_ALLOC(o->ctx, g->star, s->graph.first[n]));
    BRIO_TRY(BRIO_ALLOC_ZERO(o->ctx, g->first, n + 1));
    for (size_t t = 0; t < tets; t++) {
        uint32_t at = to->tet[t];
        o->label[at] = s->label[t];
        for (int i = 0; i < 4; i++) {
            g->vote[at][to->slot[t][i]] = s->graph.vote[t][i];
            g->facet[at][to->slot[t][i]] = s->graph.facet[t][i];
        }
    }
    for (size_t p = 0; p < n; p++) o->label[tets + to->sample[p]] = s->label[tets + p];
    list_stars(&o->dual.t, n, g);
done:
    EXPECT(status == BRIO_OK);
    return o;
}

static void free_renumbered(scene *o) {
    brio_release(o->ctx, o->dual.t.tet);
    brio_release(o->ctx, o->dual.centre);
    brio_release(o->ctx, o->dual.plane);
    o->dual = (brio_pole_vectors){0};
    free_scene(o);
}

static void expect_same_labels(const scene *s, const scene *o, const numbers *to, const char *step) {
    size_t tets = s->dual.t.count, different = 0;
    for (size_t t = 0; t < tets; t++) different += s->label[t] != o->label[to->tet[t]];
    for (size_t p = 0; p < s->dual.num_points; p++) different += s->label[tets + p] != o->label[tets + to->sample[p]];
    EXPECT(different == 0, "%s: %zu labels", step, different);
}

static void numbers_do_not_matter(void) {
    scene *s = scene_of(ALONE, LARGE);
    weigh(s);
    for (uint64_t seed = 1; seed <= 3; seed++) {
        label_spoiled(s);
        numbers to = new_numbers(s, seed);
        scene *o = renumber(s, &to);
        size_t changed = settle(s);
        EXPECT(changed > 100 && settle(o) == changed, "%zu", changed);
        expect_same_labels(s, o, &to, "contested places");
        label_spoiled(s);
        free_renumbered(o);
        o = renumber(s, &to);
        changed = mend(s);
        EXPECT(changed > 100 && mend(o) == changed, "%zu", changed);
        expect_same_labels(s, o, &to, "mending");
        free_renumbered(o);
        free_numbers(&to);
    }
    free_scene(s);
}

/* What is told of a sample: next to nothing of most, much that is right or wrong of one in eight. */
static float told_of(const scene *s, size_t p) {
    uint64_t hash = brio_position_hash(s->points + 3 * p);
    return (float)(hash >> 8 & 255) / 255 * (hash & 7 ? 0.01f : 6) * (hash & 64 ? 1 : -1);
}

static void sign(const scene *s, bool told, uint8_t *turned, uint8_t *alone) {
    float *tells = malloc(ALL * sizeof *tells);
    brio_sheet_samples samples = {s->spacing, 0, told ? tells : NULL};
    for (size_t p = 0; p < s->dual.num_points; p++) tells[p] = told_of(s, p);
    EXPECT(brio_sign_sheets(s->ctx, &s->dual, &samples, turned, alone) == BRIO_OK);
    free(tells);
}

/* Samples anywhere in a cube: most pieces are not on the hull, and have the signs of their roots. */
static void signs_do_not_depend_on_numbers(void) {
    double all[3 * ALL];
    uniform_points(3, ALL, all);
    scene *s = scene_with(ALL, all);
    uint8_t turned[ALL], alone[ALL], again[ALL], again_alone[ALL];
    for (uint64_t seed = 1; seed <= 6; seed++) {
        size_t different = 0, inwards = 0;
        numbers to = new_numbers(s, seed);
        scene *o = renumber_tetrahedra(s, &to);
        sign(s, seed % 2, turned, alone);
        sign(o, seed % 2, again, again_alone);
        for (size_t p = 0; p < ALL; p++) {
            different += turned[p] != again[to.sample[p]] || alone[p] != again_alone[to.sample[p]];
            inwards += turned[p];
        }
        EXPECT(different == 0 && inwards > 100 && inwards < ALL - 100, "%zu, %zu", different, inwards);
        free_renumbered(o);
        free_numbers(&to);
    }
    free_scene(s);
}

/* --- what is far away --- */

typedef struct {
    uint64_t hash;
    size_t tet;
} named;

static int compare_named(const void *a, const void *b) {
    const named *x = a, *y = b;
    return (x->hash > y->hash) - (x->hash < y->hash);
}

/* Returns the labels of the tetrahedra of torus samples in both scenes that differ.   common  receives the number of
 * these tetrahedra. */
static size_t count_different(const scene *alone, const scene *beside, size_t *common) {
    size_t count = 0, different = 0;
    named *list = malloc(alone->dual.num_finite * sizeof *list);
    for (size_t t = 0; t < alone->dual.num_finite; t++)
        if (is_in_torus(alone, t)) list[count++] = (named){brio_tet_hash(&alone->dual, t), t};
    qsort(list, count, sizeof *list, compare_named);
    *common = 0;
    for (size_t t = 0; t < beside->dual.num_finite; t++) {
        named key = {brio_tet_hash(&beside->dual, t), t}, *at = bsearch(&key, list, count, sizeof *list, compare_named);
        if (!at) continue;
        ++*common;
        different += alone->label[at->tet] != beside->label[t];
    }
    free(list);
    return different;
}

static void expect_same_beside(double size) {
    scene *alone = scene_of(ALONE, size), *beside = scene_of(ALL, size);
    size_t common;
    weigh(alone);
    weigh(beside);
    label_spoiled(alone);
    label_spoiled(beside);
    settle(alone);
    settle(beside);
    size_t different = count_different(alone, beside, &common);
    EXPECT(common > 5000 && different == 0, "contested places: %zu of %zu labels", different, common);
    label_spoiled(alone);
    label_spoiled(beside);
    mend(alone);
    mend(beside);
    different = count_different(alone, beside, &common);
    EXPECT(common > 5000 && different == 0, "mending: %zu of %zu labels", different, common);
    free_scene(alone);
    free_scene(beside);
}

static void an_object_far_away_does_not_matter(void) {
    expect_same_beside(LARGE);
}

/* Once cells were halved no more than 21 times: all nodes of the torus were in one. */
static void an_object_a_billion_spacings_away_does_not_matter(void) {
    expect_same_beside(SMALL);
}

SUITE(test_position_rounds) {
    RUN(numbers_do_not_matter);
    RUN(signs_do_not_depend_on_numbers);
    RUN(an_object_far_away_does_not_matter);
    RUN(an_object_a_billion_spacings_away_does_not_matter);
    return harness_end();
}
