/* The greedy labels against the pseudo-code of figure 3.8 [Choi 2003], written out with a search through all poles in
 * place of the priority queue.
 *
 * What the house adds to the figure, and so does the test:
 *   certain    poles of bounding points and poles on the hull of the regular triangulation are outer before all others,
 *              and no evidence reaches them
 *   hidden     a pole without a cell has one neighbour, its representative
 *   ties       equal priorities go by the numbers of the poles, lowest first
 *   rounding   weights are in single precision, beliefs and |in - out| keep the upper half of a double */
#include "base/memory.h"
#include "harness.h"
#include "points.h"
#include "surface_calls.h"
#include "reconstruct/power_crust/labeled_poles.h"

enum { OUT = 0, IN = 1 };

/* Classes of priorities, lowest first. The figure's |in - out| - 1 < 0 is CONFUSED, 0 is NOTHING. */
typedef enum { CONFUSED, NOTHING, EVIDENCE, CERTAIN } priority_class;

typedef struct {
    const brio_labeled_poles *l;
    uint8_t *neighbours; /* #poles by #poles */
    uint8_t *certain, *label;
    double (*belief)[2]; /* out and in of each pole */
    size_t confused;
} figure;

static double upper_half(double x) {
    uint64_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits &= UINT64_C(0xffffffff00000000);
    memcpy(&x, &bits, sizeof bits);
    return x;
}

static double dot_from(const double *o, const double *a, const double *b) {
    return (a[0] - o[0]) * (b[0] - o[0]) + (a[1] - o[1]) * (b[1] - o[1]) + (a[2] - o[2]) * (b[2] - o[2]);
}

/* -cos of the angle at which two polar balls intersect, by the law of cosines; 1 for a ball inside the other. */
static double weight_of_balls(const figure *f, size_t p, size_t q) {
    const brio_poles *poles = &f->l->poles;
    const double *a = poles->centre + 3 * p, *b = poles->centre + 3 * q;
    double r = poles->square[p], s = poles->square[q], weight = (r + s - dot_from(a, b, b)) / (2 * sqrt(r * s));
    return (double)(float)fmin(weight, 1);
}

/* -cos of the angle between the poles of a sample. */
static double weight_of_poles(const figure *f, size_t sample, size_t p, size_t q) {
    const double *s = f->l->points + 3 * sample, *a = f->l->poles.centre + 3 * p, *b = f->l->poles.centre + 3 * q;
    return (double)(float)fmin(-dot_from(s, a, b) / sqrt(dot_from(s, a, a) * dot_from(s, b, b)), 1);
}

static void find_neighbours(figure *f) {
    const brio_labeled_poles *l = f->l;
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(l->power);
    const brio_delaunay_stats *s = brio_triangulation_stats(l->power);
    size_t n = l->poles.count;
    for (size_t t = 0; t < s->tetrahedra; t++)
        for (int i = 0; i < 16; i++)
            if (i / 4 != i % 4) f->neighbours[n * tet[t].vertex[i / 4] + tet[t].vertex[i % 4]] = 1;
    for (size_t t = s->tetrahedra; t < s->tetrahedra + s->hull_facets; t++)
        for (int i = 0; i < 3; i++) f->certain[tet[t].vertex[i]] = 1;
    for (size_t p = 0; p < n; p++) {
        size_t shown = brio_triangulation_representatives(l->power)[p];
        f->certain[p] |= l->poles.bounding[p];
        if (shown != p) f->neighbours[n * p + shown] = f->neighbours[n * shown + p] = 1;
    }
}

/* Update_Priority. */
static priority_class priority_of(const figure *f, size_t p, double *value) {
    double in = f->belief[p][IN], out = f->belief[p][OUT];
    bool confused = in > 0 && out > 0;
    *value = confused ? upper_half(fabs(in - out)) : fmax(in, out);
    if (f->certain[p]) return CERTAIN;
    return confused ? CONFUSED : *value > 0 ? EVIDENCE : NOTHING;
}

/* Remove the top element. */
static size_t take_top(const figure *f, priority_class *class) {
    size_t top = SIZE_MAX;
    double most = -1;
    *class = CONFUSED;
    for (size_t p = 0; p < f->l->poles.count; p++) {
        double value;
        if (f->label[p] != BRIO_LABEL_NONE) continue;
        priority_class c = priority_of(f, p, &value);
        if (top < SIZE_MAX && (c < *class || (c == *class && value <= most))) continue;
        top = p, most = value, *class = c;
    }
    return top;
}

static void offer(figure *f, size_t q, int side, double strength) {
    if (!f->certain[q]) f->belief[q][side] = fmax(f->belief[q][side], upper_half(strength));
}

static void pass_on(figure *f, size_t p, int side, double tmp) {
    const brio_labeled_poles *l = f->l;
    size_t n = l->poles.count;
    for (size_t s = 0; s < l->num_samples; s++) {
        const uint32_t *of = l->poles.of_sample + 2 * s;
        if ((of[0] != p && of[1] != p) || of[0] == BRIO_NO_POLE || of[1] == BRIO_NO_POLE) continue;
        size_t q = of[0] == p ? of[1] : of[0];
        double weight = weight_of_poles(f, s, of[0], of[1]);
        if (weight > 0) offer(f, q, !side, tmp * weight);
    }
    for (size_t q = 0; q < n; q++)
        if (f->neighbours[n * p + q] && weight_of_balls(f, p, q) > 0) offer(f, q, side, tmp * weight_of_balls(f, p, q));
}

/* Label_Poles. */
static void label_by_figure(figure *f) {
    priority_class class;
    find_neighbours(f);
    for (size_t p = 0; p < f->l->poles.count; p++)
        if (f->certain[p]) f->belief[p][OUT] = 1;
    for (size_t p; (p = take_top(f, &class)) != SIZE_MAX;) {
        int side = f->belief[p][IN] > f->belief[p][OUT] ? IN : OUT;
        f->label[p] = side == IN ? BRIO_LABEL_INNER : BRIO_LABEL_OUTER;
        f->confused += class == CONFUSED;
        pass_on(f, p, side, f->belief[p][side]);
    }
}

typedef struct {
    size_t sets, inner, confused, hidden;
} totals;

static void compare_labels(const double *points, size_t n, const char *name, totals *sum) {
    brio_context *ctx = new_context();
    brio_surface_options o = CRUST_OPTIONS;
    brio_pole_request request;
    brio_labeled_poles l;
    o.poles.labeling = BRIO_LABELING_GREEDY;
    o.noise = BRIO_NOISE_KEEP;
    brio_context_set_threads(ctx, 1);
    EXPECT(brio_pole_request_of(ctx, &o.poles, o.noise, o.seed, &request) == BRIO_OK);
    brio_status status = brio_labeled_poles_find(ctx, points, n, &request, &l);
    EXPECT(status == BRIO_OK || status == BRIO_ERR_NO_ANSWER, "%s", brio_message(ctx));
    if (status == BRIO_OK) {
        size_t count = l.poles.count, wrong = 0;
        figure f = {.l = &l, .neighbours = calloc(count * count, 1), .certain = calloc(count, 1)};
        f.label = calloc(count, 1);
        f.belief = calloc(count, sizeof *f.belief);
        label_by_figure(&f);
        for (size_t p = 0; p < count; p++) wrong += f.label[p] != l.label[p];
        EXPECT(wrong == 0, "%s, %zu points: %zu of %zu labels differ", name, n, wrong, count);
        EXPECT(f.confused == l.stats.confused, "%s: %zu confused, not %zu", name, l.stats.confused, f.confused);
        sum->sets++, sum->inner += l.stats.inner, sum->confused += f.confused, sum->hidden += l.stats.hidden_poles;
        free(f.neighbours);
        free(f.certain);
        free(f.label);
        free(f.belief);
    }
    brio_labeled_poles_free(&l);
    brio_context_free(ctx);
}

static void greedy_labels_are_those_of_figure_3_8(void) {
    static double p[3 * 200];
    totals sum = {0};
    for (uint64_t trial = 0; trial < 250; trial += BRIEF_TESTS ? 3 : 1) {
        size_t n = 10 + trial % 191;
        uniform_points(trial, n, p);
        compare_labels(p, n, "uniform", &sum);
        clustered_points(trial, n, p);
        compare_labels(p, n, "clustered", &sum);
        integer_points(trial, n, 3 + (uint32_t)trial % 5, p);
        compare_labels(p, n, "lattice", &sum);
        torus_points(trial, n, p);
        compare_labels(p, n, "torus", &sum);
        sphere_points(trial, n, p);
        compare_labels(p, n, "sphere", &sum);
    }
    EXPECT(sum.sets > (BRIEF_TESTS ? 300 : 1000) && sum.inner > 3000 && sum.confused > 3000 && sum.hidden > 100,
           "%zu %zu %zu %zu", sum.sets, sum.inner, sum.confused, sum.hidden);
}

SUITE(test_greedy_labels) {
    RUN(greedy_labels_are_those_of_figure_3_8);
    return harness_end();
}
