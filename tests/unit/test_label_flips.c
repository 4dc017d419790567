/* Flips of labels against the energy of the whole graph; mending of random labels; handles that are made by hand. */
#include "base/memory.h"
#include "base/rng.h"
#include "base/vector.h"
#include "dual/spacing.h"
#include "failing_allocator.h"
#include "harness.h"
#include "points.h"
#include "reconstruct/labeled_delaunay/hash_order.h"
#include "reconstruct/labeled_delaunay/simple_flips.h"
#include "reconstruct/labeled_delaunay/small_regions.h"
#include "reconstruct/labeled_delaunay/vote_cut.h"
#include "reconstruct/labeled_delaunay/vote_region.h"
#include "reconstruct/labeled_delaunay/weak_handles.h"
#include <math.h>
#include <string.h>

enum { SAMPLES = 800 };

/* A point set with its graph of votes. */
typedef struct {
    brio_context *ctx;
    double points[3 * SAMPLES], spacing[SAMPLES];
    brio_triangulation *delaunay;
    brio_pole_vectors dual;
    brio_vote_graph graph;
    uint8_t *label;
} scene;

/* own  #P, or NULL: as of brio_vote_graph_new. */
static brio_status set_up_with(scene *s, brio_context *ctx, void (*make)(uint64_t, size_t, double *),
                               const float *own) {
    brio_status status = BRIO_OK;
    s->ctx = ctx;
    s->graph.ctx = ctx;
    make(1, SAMPLES, s->points);
    BRIO_TRY(brio_delaunay(ctx, s->points, NULL, SAMPLES, NULL, &s->delaunay));
    BRIO_TRY(brio_sample_spacing(ctx, s->delaunay, s->points, SAMPLES, s->spacing, NULL));
    BRIO_TRY(brio_pole_vectors_find(ctx, s->delaunay, s->points, SAMPLES, 0.39, &s->dual));
    BRIO_TRY(brio_vote_graph_new(ctx, &s->dual, s->spacing, 0, own, &s->graph));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s->label, s->dual.t.count + SAMPLES));
done:
    return status;
}

static brio_status set_up(scene *s, brio_context *ctx, void (*make)(uint64_t, size_t, double *)) {
    return set_up_with(s, ctx, make, NULL);
}

static void tear_down(scene *s) {
    brio_vote_graph_free(&s->graph);
    brio_pole_vectors_free(s->ctx, &s->dual);
    brio_triangulation_free(s->delaunay);
    brio_release(s->ctx, s->label);
}

static scene *scene_of(void (*make)(uint64_t, size_t, double *)) {
    scene *s = calloc(1, sizeof *s);
    EXPECT(set_up(s, new_context(), make) == BRIO_OK);
    return s;
}

static void free_scene(scene *s) {
    brio_context *ctx = s->ctx;
    tear_down(s);
    EXPECT(brio_context_memory(ctx) == 0);
    brio_context_free(ctx);
    free(s);
}

static bool centroid_is(const scene *s, size_t t, bool (*inside)(const double *)) {
    double centroid[3] = {0, 0, 0};
    for (int i = 0; i < 4; i++)
        for (size_t k = 0; k < 3; k++) centroid[k] += s->points[3 * s->dual.t.tet[t].vertex[i] + k] / 4;
    return inside(centroid);
}

/* A tetrahedron is inner if `inside` says so of its centroid; infinite ones are outer. */
static void label_by(scene *s, bool (*inside)(const double *)) {
    for (size_t t = 0; t < s->dual.t.count; t++)
        s->label[t] = t < s->dual.num_finite && centroid_is(s, t, inside) ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
}

static bool in_torus(const double *p) {
    double ring = sqrt(p[0] * p[0] + p[1] * p[1]) - 1;
    return ring * ring + p[2] * p[2] < 0.16;
}

static bool in_ball(const double *p) {
    return p[0] * p[0] + p[1] * p[1] + p[2] * p[2] < 1;
}

/* Half the tetrahedra, at random. */
static bool is_lucky(const double *p) {
    uint64_t bits;
    memcpy(&bits, p, sizeof bits);
    return brio_hash(bits, 3) & 1;
}

/* --- energy --- */

/* Each sample has the better one of its two labels. */
static double energy_of(scene *s, const brio_label_flips *f) {
    for (size_t p = 0; p < SAMPLES; p++) s->label[s->dual.t.count + p] = BRIO_LABEL_OUTER;
    brio_label_samples(f);
    double energy = NAN;
    EXPECT(brio_vote_energy(&s->graph, s->label, &energy) == BRIO_OK);
    return energy / BRIO_VOTE_UNIT;
}

static size_t count_faces(const scene *s) {
    size_t faces = 0;
    for (size_t t = 0; t < s->dual.t.count; t++)
        for (int i = 0; i < 4; i++) faces += s->label[t] < s->label[s->dual.t.tet[t].mate[i] >> 2];
    return faces;
}

static void flips_know_the_energy(void) {
    scene *s = scene_of(torus_points);
    brio_label_flips f;
    brio_rng rng = brio_rng_new(1);
    label_by(s, in_torus);
    EXPECT(brio_label_flips_new(&s->graph, s->label, &f) == BRIO_OK);
    double before = energy_of(s, &f);
    size_t faces = count_faces(s);
    for (int i = 0; i < 500; i++) {
        uint32_t tet = (uint32_t)brio_rng_below(&rng, s->dual.num_finite);
        int64_t cost = brio_flip_cost(&f, tet), energy = f.energy;
        EXPECT(brio_flip(&f, tet) == BRIO_OK && f.energy == energy + cost);
        if (i % 100 == 0) {
            double found = energy_of(s, &f) - before;
            EXPECT(fabs((double)f.energy / BRIO_FLIP_UNIT - found) < 0.05, "%g, not %g",
                   (double)f.energy / BRIO_FLIP_UNIT, found);
            EXPECT(f.faces == (int64_t)count_faces(s) - (int64_t)faces);
        }
    }
    brio_take_back(&f, 0);
    EXPECT(f.energy == 0 && f.faces == 0 && energy_of(s, &f) == before);
    brio_label_flips_free(&f);
    free_scene(s);
}

/* --- mending --- */

static size_t count_singular(brio_label_flips *f) {
    size_t singular = 0;
    brio_star_parts parts;
    for (uint32_t p = 0; p < SAMPLES; p++) singular += brio_find_parts(f, p, &parts) && brio_surplus(&parts) > 0;
    return singular;
}

static void mending_leaves_hardly_any_singular_sample(void) {
    scene *s = scene_of(uniform_points);
    brio_label_flips f;
    brio_mending m;
    label_by(s, is_lucky);
    EXPECT(brio_label_flips_new(&s->graph, s->label, &f) == BRIO_OK);
    EXPECT(brio_mending_new(&f, &m) == BRIO_OK);
    size_t before = count_singular(&f);
    EXPECT(m.singular == before && before > SAMPLES / 2, "%zu, %zu", m.singular, before);
    EXPECT(brio_mend(&m) == BRIO_OK);
    EXPECT(m.singular == count_singular(&f) && m.singular < before / 50, "%zu of %zu are left", m.singular, before);
    for (size_t t = s->dual.num_finite; t < s->dual.t.count; t++) EXPECT(s->label[t] == BRIO_LABEL_OUTER);
    brio_mending_free(&m);
    brio_label_flips_free(&f);
    free_scene(s);
}

/* Many samples of this chaos sleep, and are woken by others. What is expected is found when all samples have all their
 * turns, which checked builds do. */
static void what_changes_wakes_what_sleeps(void) {
    scene *s = scene_of(uniform_points);
    brio_label_flips f;
    brio_mending m;
    uint64_t inner = 0;
    label_by(s, is_lucky);
    EXPECT(brio_label_flips_new(&s->graph, s->label, &f) == BRIO_OK);
    EXPECT(brio_mending_new(&f, &m) == BRIO_OK && brio_mend(&m) == BRIO_OK);
    for (size_t t = 0; t < s->dual.num_finite; t++)
        if (s->label[t] == BRIO_LABEL_INNER) inner += brio_tet_hash(&s->dual, t);
    EXPECT(f.size == 2553 && inner == 0xedfedc0aa8c61a0c, "%zu, %llx", f.size, (unsigned long long)inner);
    brio_mending_free(&m);
    brio_label_flips_free(&f);
    free_scene(s);
}

/* --- small regions --- */

/* Walks over the region of a tetrahedron; flips its tetrahedra in `dropped` if it is small. Returns whether it is. */
static bool drop_region(const scene *s, uint32_t start, size_t least, bool *seen, uint8_t *dropped) {
    uint32_t *front = calloc(s->dual.t.count, sizeof *front);
    size_t size = 0, boundary = 0;
    bool finite = true;
    seen[front[size++] = start] = true;
    for (size_t n = 0; n < size; n++) {
        finite &= front[n] < s->dual.num_finite;
        for (int i = 0; i < 4; i++) {
            uint32_t other = s->dual.t.tet[front[n]].mate[i] >> 2;
            boundary += s->label[other] != s->label[start];
            if (s->label[other] == s->label[start] && !seen[other]) seen[front[size++] = other] = true;
        }
    }
    bool small = finite && boundary < least;
    for (size_t n = 0; n < size && small; n++) dropped[front[n]] = brio_other_label(s->label[start]);
    free(front);
    return small;
}

static void small_regions_are_those_of_a_walk(void) {
    scene *s = scene_of(uniform_points);
    size_t count = s->dual.t.count, total = 0;
    bool *seen = malloc(count);
    uint8_t *dropped = malloc(count);
    for (size_t least = 0; least < 40; least += 3) {
        size_t wanted = 0, changed;
        label_by(s, is_lucky);
        memset(seen, 0, count);
        memcpy(dropped, s->label, count);
        for (uint32_t t = 0; t < count; t++) wanted += !seen[t] && drop_region(s, t, least, seen, dropped);
        EXPECT(brio_drop_small_regions(s->ctx, &s->dual.t, least, s->label, &changed) == BRIO_OK);
        EXPECT(changed == wanted && !memcmp(dropped, s->label, count), "%zu, not %zu", changed, wanted);
        total += changed;
    }
    EXPECT(total > 100, "%zu", total);
    free(seen);
    free(dropped);
    free_scene(s);
}

/* --- flips that deform --- */

/* Samples off by up to 0.08: where they are exact no sample is in doubt, and nothing is looked at. */
static void noisy(uint64_t seed, size_t count, double *points) {
    brio_rng rng = brio_rng_new(seed);
    for (size_t i = 0; i < 3 * count; i++) points[i] += 0.08 * (2 * brio_rng_double(&rng) - 1);
}

static void noisy_sphere_points(uint64_t seed, size_t count, double *points) {
    sphere_points(seed, count, points);
    noisy(seed, count, points);
}

static void noisy_torus_points(uint64_t seed, size_t count, double *points) {
    torus_points(seed, count, points);
    noisy(seed, count, points);
}

/* Grows a patch of one label from a tetrahedron: up to `most` finite ones, each next to the one before. Returns their
 * number. */
static size_t grow_patch(const scene *s, brio_rng *rng, uint32_t tet, size_t most, uint32_t *patch) {
    size_t count = 0;
    for (int trial = 0; count < most && trial < 50; trial++) {
        uint32_t next = s->dual.t.tet[tet].mate[brio_rng_below(rng, 4)] >> 2;
        bool listed = false;
        for (size_t i = 0; i < count; i++) listed |= patch[i] == tet;
        if (!listed) patch[count++] = tet;
        if (next < s->dual.num_finite && s->label[next] == s->label[tet]) tet = next;
    }
    return count;
}

/* Returns whether flips leave the Euler characteristic and no singular sample. The flips are taken back. */
static bool changes_nothing(brio_mending *m, const uint32_t *patch, size_t count) {
    brio_label_flips *f = m->flips;
    int64_t before = 2 * m->all_fans - f->faces;
    for (size_t i = 0; i < count; i++) EXPECT(brio_flip(f, patch[i]) == BRIO_OK);
    EXPECT(brio_mending_look(m, 0, count) == BRIO_OK);
    bool same = m->singular == 0 && 2 * m->all_fans - f->faces == before;
    brio_take_back(f, 0);
    f->size = count; /* the list is still there */
    EXPECT(brio_mending_look(m, 0, count) == BRIO_OK && m->singular == 0);
    f->size = 0;
    return same;
}

/* What is said to deform leaves the Euler characteristic; of single tetrahedra, so does nothing else. */
static void deformations_are_known(scene *s, bool (*inside)(const double *), size_t *yes, size_t *no) {
    brio_label_flips f;
    brio_mending m;
    brio_rng rng = brio_rng_new(5);
    static uint8_t fans[SAMPLES], label[SAMPLES * 20];
    label_by(s, inside);
    EXPECT(brio_label_flips_new(&s->graph, s->label, &f) == BRIO_OK && s->dual.t.count <= sizeof label);
    EXPECT(brio_mending_new(&f, &m) == BRIO_OK && brio_mend(&m) == BRIO_OK && m.singular == 0);
    f.size = 0;
    memcpy(fans, m.fans, SAMPLES), memcpy(label, s->label, s->dual.t.count);
    for (int trial = 0; trial < 4000; trial++) {
        uint32_t patch[8], tet = (uint32_t)brio_rng_below(&rng, s->dual.num_finite);
        size_t count = grow_patch(s, &rng, tet, 1 + trial % 8, patch);
        bool found = brio_flips_deform(&m, patch, count);
        EXPECT(!memcmp(fans, m.fans, SAMPLES) && !memcmp(label, s->label, s->dual.t.count), "trial %d", trial);
        bool same = changes_nothing(&m, patch, count);
        EXPECT(found ? same : !same || count > 1, "trial %d, %zu tetrahedra", trial, count);
        *yes += found && count > 1, *no += !found;
    }
    brio_mending_free(&m);
    brio_label_flips_free(&f);
}

static void flips_that_deform_are_known(void) {
    scene *torus = scene_of(noisy_torus_points), *chaos = scene_of(uniform_points);
    size_t yes = 0, no = 0;
    deformations_are_known(torus, in_torus, &yes, &no);
    deformations_are_known(chaos, in_ball, &yes, &no);
    EXPECT(yes > 200 && no > 200, "%zu, %zu", yes, no);
    free_scene(torus);
    free_scene(chaos);
}

/* --- handles --- */

/* Returns twice the Euler characteristic of the boundary, of which every sample is one fan. */
static int64_t twice_euler(scene *s, brio_label_flips *f) {
    int64_t twice = -(int64_t)count_faces(s);
    brio_star_parts parts;
    for (uint32_t p = 0; p < SAMPLES; p++)
        if (brio_find_parts(f, p, &parts) && parts.count > 0) twice += 2 * (parts.count - 1);
    return twice;
}

/* One tetrahedron of eight on the wrong side. */
static bool in_spoiled_torus(const double *p) {
    uint64_t bits;
    memcpy(&bits, p, sizeof bits);
    return in_torus(p) != (brio_hash(bits, 3) % 8 == 0);
}

/* Returns the number of sets of tetrahedra with a label that hang together across facets. */
static size_t count_parts(const scene *s, uint8_t label) {
    size_t parts = 0;
    uint32_t *front = calloc(s->dual.t.count, sizeof *front);
    bool *seen = calloc(s->dual.t.count, sizeof *seen);
    for (uint32_t t = 0; t < s->dual.t.count; t++) {
        if (seen[t] || s->label[t] != label) continue;
        size_t size = 0;
        parts++;
        seen[front[size++] = t] = true;
        while (size > 0) {
            const uint32_t *mate = s->dual.t.tet[front[--size]].mate;
            for (int i = 0; i < 4; i++)
                if (s->label[mate[i] >> 2] == label && !seen[mate[i] >> 2]) seen[front[size++] = mate[i] >> 2] = true;
        }
    }
    free(front);
    free(seen);
    return parts;
}

/* Labels, mends, removes weak handles, none of which was all that joined two parts, and returns twice the Euler characteristic before and after. */
static void remove_from(scene *s, bool (*inside)(const double *), int64_t *before, int64_t *after) {
    brio_label_flips f;
    brio_mending m;
    size_t removed;
    label_by(s, inside);
    EXPECT(brio_label_flips_new(&s->graph, s->label, &f) == BRIO_OK);
    EXPECT(brio_mending_new(&f, &m) == BRIO_OK && brio_mend(&m) == BRIO_OK && m.singular == 0);
    *before = twice_euler(s, &f);
    size_t inner = count_parts(s, BRIO_LABEL_INNER), outer = count_parts(s, BRIO_LABEL_OUTER);
    EXPECT(brio_remove_weak_handles(&m, &removed) == BRIO_OK && m.singular == 0);
    EXPECT((removed > 0) == (*before != twice_euler(s, &f)), "%zu", removed);
    *after = twice_euler(s, &f);
    EXPECT(count_parts(s, BRIO_LABEL_INNER) <= inner && count_parts(s, BRIO_LABEL_OUTER) <= outer);
    brio_mending_free(&m);
    brio_label_flips_free(&f);
}

static void true_handles_stay_and_none_appears(void) {
    int64_t before, after;
    scene *torus = scene_of(torus_points), *sphere = scene_of(sphere_points);
    remove_from(torus, in_torus, &before, &after);
    EXPECT(before == 0 && after == 0, "torus: %lld, %lld", (long long)before, (long long)after);
    remove_from(sphere, in_ball, &before, &after);
    EXPECT(before == 4 && after == 4, "sphere: %lld, %lld", (long long)before, (long long)after);
    remove_from(torus, in_spoiled_torus, &before, &after);
    EXPECT(after >= before, "spoiled torus: %lld, %lld", (long long)before, (long long)after);
    free_scene(torus);
    free_scene(sphere);
}

static uint64_t spoiling; /* which tetrahedra in_spoiled_ball takes */

static bool in_spoiled_ball(const double *p) {
    uint64_t bits;
    memcpy(&bits, p, sizeof bits);
    return in_ball(p) != (brio_hash(bits, spoiling) % 8 == 0);
}

/* Half of the tetrahedra of a ball and round it, at random. */
static bool in_mixed_ball(const double *p) {
    uint64_t bits;
    memcpy(&bits, p, sizeof bits);
    return in_ball(p) != (brio_hash(bits, 33) % 2 == 0);
}

/* One patch of this chaos is worth its flips only after another one's. What is expected is found when all patches are
 * weighed at their turns, which checked builds do. */
static void what_a_flip_changes_is_weighed_again(void) {
    scene *s = scene_of(noisy_sphere_points);
    brio_label_flips f;
    brio_mending m;
    size_t removed;
    uint64_t inner = 0;
    label_by(s, in_mixed_ball);
    EXPECT(brio_label_flips_new(&s->graph, s->label, &f) == BRIO_OK);
    EXPECT(brio_mending_new(&f, &m) == BRIO_OK && brio_mend(&m) == BRIO_OK);
    EXPECT(brio_remove_weak_handles(&m, &removed) == BRIO_OK);
    for (size_t t = 0; t < s->dual.num_finite; t++)
        if (s->label[t] == BRIO_LABEL_INNER) inner += brio_tet_hash(&s->dual, t);
    EXPECT(removed == 101 && inner == 0x83902a0f4104f9e3, "%zu, %llx", removed, (unsigned long long)inner);
    brio_mending_free(&m);
    brio_label_flips_free(&f);
    free_scene(s);
}

static void nothing_falls_apart_in_a_chaos(void) {
    int64_t before, after;
    scene *s = scene_of(uniform_points);
    remove_from(s, is_lucky, &before, &after);
    EXPECT(after != before, "%lld, %lld", (long long)before, (long long)after);
    free_scene(s);
}

/* Of some twelve crumbs in each of four chaoses, one may be left: of 200 chaoses, none is in 125. */
static void crumbs_and_bubbles_are_removed(void) {
    int64_t before, after, all = 0, left = 0;
    scene *s = scene_of(noisy_sphere_points);
    for (spoiling = 0; spoiling < 4; spoiling++) {
        remove_from(s, in_spoiled_ball, &before, &after);
        EXPECT(before > 4 && after >= 4, "%lld, %lld", (long long)before, (long long)after);
        all += before - 4, left += after - 4;
    }
    EXPECT(all > 100 && 10 * left < all, "%lld of %lld", (long long)left, (long long)all);
    free_scene(s);
}

/* Returns an outer finite neighbour of a tetrahedron, or the tetrahedron itself if it has none. */
static uint32_t outer_neighbour(const scene *s, uint32_t tet) {
    for (int i = 0; i < 4; i++) {
        uint32_t other = s->dual.t.tet[tet].mate[i] >> 2;
        if (other < s->dual.num_finite && s->label[other] == BRIO_LABEL_OUTER) return other;
    }
    return tet;
}

/* Flips an outer tetrahedron and neighbours, until they are a handle: at most 12. Returns whether they are. */
static bool add_handle(scene *s, brio_label_flips *f, brio_mending *m, uint32_t tet) {
    int64_t before = 2 * m->all_fans - f->faces;
    while (f->size < 12 && s->label[tet] == BRIO_LABEL_OUTER) {
        EXPECT(brio_flip(f, tet) == BRIO_OK && brio_mending_look(m, f->size - 1, f->size) == BRIO_OK);
        if (m->singular == 0 && 2 * m->all_fans - f->faces == before - 4) return true;
        tet = outer_neighbour(s, tet);
    }
    size_t size = f->size;
    brio_take_back(f, 0);
    EXPECT(brio_mending_look(m, 0, size) == BRIO_OK);
    return false;
}

static void a_false_handle_is_removed(void) {
    scene *s = scene_of(noisy_torus_points);
    brio_label_flips f;
    brio_mending m;
    size_t removed = 0;
    bool added = false;
    label_by(s, in_torus);
    EXPECT(brio_label_flips_new(&s->graph, s->label, &f) == BRIO_OK);
    EXPECT(brio_mending_new(&f, &m) == BRIO_OK && brio_mend(&m) == BRIO_OK && m.singular == 0);
    EXPECT(twice_euler(s, &f) == 0);
    brio_mending_forget(&m);
    f.size = 0;
    for (uint32_t t = 0; t < s->dual.num_finite && !added; t++)
        if (s->label[t] == BRIO_LABEL_OUTER) added = add_handle(s, &f, &m, t);
    EXPECT(added && twice_euler(s, &f) == -4);
    EXPECT(brio_remove_weak_handles(&m, &removed) == BRIO_OK);
    EXPECT(removed > 0 && m.singular == 0 && twice_euler(s, &f) == 0, "%zu, %lld", removed,
           (long long)twice_euler(s, &f));
    brio_mending_free(&m);
    brio_label_flips_free(&f);
    free_scene(s);
}

static brio_status flip_and_mend(brio_context *ctx) {
    brio_status status = BRIO_OK;
    scene *s = calloc(1, sizeof *s);
    brio_label_flips f = {.ctx = ctx};
    brio_mending m = {.flips = &f};
    size_t removed;
    BRIO_TRY(set_up(s, ctx, torus_points));
    label_by(s, in_spoiled_torus);
    BRIO_TRY(brio_label_flips_new(&s->graph, s->label, &f));
    BRIO_TRY(brio_mending_new(&f, &m));
    BRIO_TRY(brio_mend(&m));
    BRIO_TRY(brio_remove_weak_handles(&m, &removed));
done:
    brio_mending_free(&m);
    brio_label_flips_free(&f);
    tear_down(s);
    free(s);
    return status;
}

static void every_failed_allocation_is_a_status(void) {
    expect_clean_failures(flip_and_mend);
}

/* --- beyond the hull --- */

static double whole_energy(const scene *s) {
    double energy = NAN;
    EXPECT(brio_vote_energy(&s->graph, s->label, &energy) == BRIO_OK);
    return energy;
}

static void turn_over(scene *s) {
    for (size_t i = 0; i < s->dual.t.count + SAMPLES; i++) s->label[i] = (uint8_t)brio_other_label(s->label[i]);
}

/* Samples without evidence cannot tell labels from the opposite ones. What decides is the hull. */
static void the_hull_is_outside_where_no_sample_tells(void) {
    static const float own[SAMPLES] = {0};
    scene *s = calloc(1, sizeof *s);
    brio_vote_cut cut;
    size_t hull, inner = 0;
    double energy;
    EXPECT(set_up_with(s, new_context(), sphere_points, own) == BRIO_OK);
    hull = s->dual.t.count - s->dual.num_finite;
    for (size_t i = 0; i < s->dual.t.count + SAMPLES; i++)
        s->label[i] = i < s->dual.num_finite ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
    energy = whole_energy(s);
    turn_over(s);
    EXPECT(fabs(whole_energy(s) - energy - (double)hull * BRIO_HULL_VOTE * BRIO_VOTE_UNIT) < 1e-6 * energy);
    for (size_t t = 0; t < s->dual.t.count; t++)
        for (int k = 0; k < 4; k++) s->graph.vote[t][k] = s->graph.facet[t][k] = 0;
    EXPECT(brio_vote_cut_new(&s->graph, NULL, &cut) == BRIO_OK);
    EXPECT(brio_vote_cut_find(&cut, -BRIO_HULL_VOTE / 2, s->label, s->label) == BRIO_OK);
    for (size_t t = s->dual.num_finite; t < s->dual.t.count; t++) inner += s->label[t] == BRIO_LABEL_INNER;
    EXPECT(hull > 100 && inner == 0, "%zu of %zu", inner, hull);
    brio_vote_cut_free(&cut);
    free_scene(s);
}

/* With all others as in the cut of all, some tetrahedra have the labels that they have there. */
static void a_cut_of_some_tetrahedra_is_that_of_all(void) {
    static const double BIAS[] = {0, 4, -2};
    scene *s = scene_of(torus_points);
    size_t tets = s->dual.t.count;
    uint8_t *open = calloc(tets, 1), *all = malloc(tets + SAMPLES);
    for (int trial = 0; trial < 9; trial++) {
        brio_rng rng = brio_rng_new((uint64_t)trial);
        brio_vote_cut whole, some;
        for (size_t p = 0; p < SAMPLES; p++)
            s->label[tets + p] = brio_rng_below(&rng, 8) ? BRIO_LABEL_OUTER : BRIO_LABEL_INNER;
        for (size_t t = 0; t < tets; t++) s->label[t] = BRIO_LABEL_OUTER;
        EXPECT(brio_vote_cut_new(&s->graph, NULL, &whole) == BRIO_OK);
        EXPECT(brio_vote_cut_find(&whole, BIAS[trial % 3], s->label, s->label) == BRIO_OK);
        memcpy(all, s->label, tets + SAMPLES);
        for (size_t t = 0; t < tets; t++) {
            open[t] = brio_rng_below(&rng, 6) < 1 + (uint32_t)trial / 2;
            if (open[t] && t < s->graph.num_free) s->label[t] = brio_other_label(s->label[t]);
        }
        EXPECT(brio_vote_cut_new(&s->graph, open, &some) == BRIO_OK);
        EXPECT(brio_vote_cut_find(&some, BIAS[trial % 3], s->label, s->label) == BRIO_OK);
        EXPECT(!memcmp(all, s->label, tets + SAMPLES), "trial %d", trial);
        brio_vote_cut_free(&whole);
        brio_vote_cut_free(&some);
    }
    free(open);
    free(all);
    free_scene(s);
}

/* Returns the mean distance in space from a node of a region to the next one. */
static double mean_step(const brio_vote_region *r, const uint8_t *fixed) {
    double sum = 0;
    size_t count = 0;
    for (size_t i = 0, before = SIZE_MAX; i < r->num_nodes; i++) {
        if (fixed[r->node[i]]) continue;
        if (before != SIZE_MAX)
            sum += sqrt(brio_square_distance(r->position + 3 * before, r->position + 3 * i)), count++;
        before = i;
    }
    return sum / (double)count;
}

/* A region in scratch files goes along a curve, and has the nodes and edges of the region in memory. */
static void regions_in_scratch_files_go_along_a_curve(void) {
    scene *s = scene_of(uniform_points);
    size_t num_tets = s->dual.t.count, nodes = num_tets + SAMPLES, wrong = 0;
    uint8_t *fixed = calloc(nodes, 1);
    size_t *place = calloc(nodes, sizeof *place);
    brio_vote_region r, along;
    for (size_t t = 0; t < num_tets; t++) fixed[t] = t >= s->dual.num_finite || t % 5 == 0;
    EXPECT(brio_vote_region_new(&s->graph, fixed, s->label, &r) == BRIO_OK);
    EXPECT(brio_context_set_scratch(s->ctx, ".") == BRIO_OK);
    EXPECT(brio_vote_region_new(&s->graph, fixed, s->label, &along) == BRIO_OK);
    EXPECT(r.count == along.count && r.num_nodes == along.num_nodes);
    for (size_t i = 0; i < along.num_nodes; i++) place[along.node[i]] = i;
    for (size_t i = 0; i < r.num_nodes; i++) {
        size_t k = place[r.node[i]], count = r.first[i + 1] - r.first[i];
        wrong += along.node[k] != r.node[i] || along.fixed[k] != r.fixed[i] || along.label[k] != r.label[i];
        wrong += along.first[k + 1] - along.first[k] != count;
        for (size_t e = 0; e < count && !wrong; e++) {
            const brio_signed_edge *a = &r.edge[r.first[i] + e], *b = &along.edge[along.first[k] + e];
            wrong += r.node[a->node] != along.node[b->node] || a->weight != b->weight;
        }
    }
    EXPECT(wrong == 0, "%zu nodes", wrong);
    EXPECT(mean_step(&along, fixed) < 0.5 * mean_step(&r, fixed), "%g and %g", mean_step(&along, fixed),
           mean_step(&r, fixed));
    brio_vote_region_free(&r);
    brio_vote_region_free(&along);
    EXPECT(brio_context_set_scratch(s->ctx, NULL) == BRIO_OK);
    free_scene(s);
    free(fixed);
    free(place);
}

SUITE(test_label_flips) {
    RUN(a_cut_of_some_tetrahedra_is_that_of_all);
    RUN(the_hull_is_outside_where_no_sample_tells);
    RUN(regions_in_scratch_files_go_along_a_curve);
    RUN(flips_know_the_energy);
    RUN(mending_leaves_hardly_any_singular_sample);
    RUN(what_changes_wakes_what_sleeps);
    RUN(small_regions_are_those_of_a_walk);
    RUN(flips_that_deform_are_known);
    RUN(true_handles_stay_and_none_appears);
    RUN(what_a_flip_changes_is_weighed_again);
    RUN(nothing_falls_apart_in_a_chaos);
    RUN(crumbs_and_bubbles_are_removed);
    RUN(a_false_handle_is_removed);
    RUN(every_failed_allocation_is_a_status);
    return harness_end();
}
