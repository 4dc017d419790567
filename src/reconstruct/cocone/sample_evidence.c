/* What files know of the side from which samples were seen, as log-odds that the axis of a sample points outwards.
 *
 * A sample knows the axis of its surface up to sign, better than a normal that was estimated. A normal, or the
 * direction from the sample to its scanner, tells the sign. How often it is right is not known, but can be measured:
 * two samples at an edge of a candidate have axes whose signs are known relative to each other. If each tells its sign
 * rightly with probability r, the two agree with probability A = r^2 + (1 - r)^2, so r = (1 + sqrt(2 A - 1)) / 2. Flat
 * views tell less than steep ones, above all in noise, so r is measured for each class of the cosine between direction
 * and axis. Signs that are drawn by lot have A = 1/2 and weigh nothing.
 *
 * What A does not see are signs that are wrong together: of normals that all point inwards, or of a part of them that
 * was turned as a whole. Alone they turn the surface over: it is what they say. Beside places of scanners they lose:
 * these were measured, normals are computed. How often normals are right is told then by how often they agree with the
 * places.
 *
 * Based on: Labatut, Pons, Keriven. Robust and efficient surface reconstruction from range data. CGF 2009.
 * Differs from the paper: scanners vote on the sides of samples, and these on tetrahedra. Lines of sight through
 *                         tetrahedra gain nothing beside that. */
#include "reconstruct/cocone/sample_evidence.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include "base/versioned.h"
#include <math.h>

/* CLASSES: of |cosine|. FEW: pairs of a class that tell its rate. All chosen. */
enum { CLASSES = 8, FEW = 64, SAMPLES_A_THREAD = 1 << 12, TETS_A_THREAD = 1 << 12 };

/* Axes within 60 degrees of each other, up to sign, have signs relative to each other. Chosen. */
static const double PARALLEL = 0.5;

/* In log-odds: evidence under LEAST in the mean is drawn by lot; MOST is the largest weight of a sample. Chosen. */
static const double LEAST = 0.3, MOST = 6;

brio_status brio_take_evidence(brio_context *ctx, const brio_evidence *given, size_t num_points,
                               brio_sample_evidence *out) {
    brio_status status = BRIO_OK;
    out->given = (brio_evidence){0};
    if (given) BRIO_TRY(BRIO_TAKE(ctx, brio_evidence, given, &out->given));
    const brio_evidence *e = &out->given;
    BRIO_REQUIRE(ctx, !e->origins || e->origin_of || e->num_origins == 1 || e->num_origins == num_points,
                 BRIO_ERR_ARGUMENT, "%zu places of scanners for %zu points: which saw which?", e->num_origins,
                 num_points);
done:
    return status;
}

typedef struct {
    const brio_sample_evidence *e;
    const brio_cocones *c;
    unsigned kind;
    double most;   /* the largest weight of a sample */
    float *cosine; /* #P: between the direction of the evidence and the axis; 0 where nothing is known */
    uint64_t agree[CLASSES], pairs[CLASSES];
    double weight[CLASSES], total; /* of each class, and of all together, before `most` */
    float *own;
} weighing;

static int class_of(float cosine) {
    int class = (int)(fabsf(cosine) * CLASSES);
    return class < CLASSES ? class : CLASSES - 1;
}

bool brio_scanner_place(const brio_sample_evidence *e, size_t p, double place[3]) {
    const brio_evidence *given = &e->given;
    if (!given->origins) return false;
    size_t point = e->order[p];
    size_t at = given->origin_of ? given->origin_of[point] : given->num_origins == 1 ? 0 : point;
    if (at >= given->num_origins) return false;
    for (size_t k = 0; k < 3; k++) place[k] = ldexp(given->origins[3 * at + k], -e->exponent);
    return true;
}

/* Writes the direction from a sample at x to its scanner; zero where its place is not known. */
static void towards_scanner(const brio_sample_evidence *e, size_t p, const double x[3], double to[3]) {
    bool is_known = brio_scanner_place(e, p, to);
    for (size_t k = 0; k < 3; k++) to[k] = is_known ? to[k] - x[k] : 0;
}

/* Returns the cosine between an axis and the direction that the evidence of a sample at x gives; 0 where there is
 * none. */
static double cosine_to(const brio_sample_evidence *e, unsigned kind, size_t p, const double x[3],
                        const double axis[3]) {
    double to[3];
    if (kind == BRIO_EVIDENCE_NORMALS)
        for (size_t k = 0; k < 3; k++) to[k] = e->given.normals[3 * (size_t)e->order[p] + k];
    else
        towards_scanner(e, p, x, to);
    double length = hypot(hypot(to[0], to[1]), to[2]), cosine = brio_dot(to, axis) / length;
    return length > 0 && fabs(cosine) <= 2 ? cosine : 0;
}

static void find_cosines(void *user, size_t begin, size_t end, int thread) {
    const weighing *w = user;
    const brio_pole_vectors *v = w->c->dual;
    (void)thread;
    for (size_t p = begin; p < end; p++)
        w->cosine[p] = (float)cosine_to(w->e, w->kind, p, v->points + 3 * p, v->plane + 4 * p);
}

/* Counts a pair of samples, if both see the surface about as steeply. */
static void count_pair(const weighing *w, uint32_t p, uint32_t q, uint64_t *agree, uint64_t *pairs) {
    const double *plane = w->c->dual->plane;
    double parallel = brio_dot(plane + 4 * (size_t)p, plane + 4 * (size_t)q);
    int class = class_of(w->cosine[p]);
    if (w->cosine[p] == 0 || w->cosine[q] == 0 || class != class_of(w->cosine[q]) || fabs(parallel) < PARALLEL) return;
    pairs[class]++;
    agree[class] += ((w->cosine[p] < 0) == (w->cosine[q] < 0)) == (parallel > 0);
}

static void count_pairs(void *user, size_t begin, size_t end, int thread) {
    weighing *w = user;
    const brio_tetrahedra *t = &w->c->dual->t;
    uint64_t agree[CLASSES] = {0}, pairs[CLASSES] = {0};
    (void)thread;
    for (size_t tet = begin; tet < end; tet++)
        for (int i = 0; w->c->candidates[tet] && i < 4; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i);
            const uint32_t *v = t->tet[tet].vertex;
            if (!brio_is_candidate(w->c, facet) || *brio_mate(t, facet) < facet) continue;
            for (int k = 0; k < 3; k++) count_pair(w, v[BRIO_FACET[i][k]], v[BRIO_FACET[i][(k + 1) % 3]], agree, pairs);
        }
    for (int i = 0; i < CLASSES; i++) {
        __atomic_fetch_add(&w->agree[i], agree[i], __ATOMIC_RELAXED);
        __atomic_fetch_add(&w->pairs[i], pairs[i], __ATOMIC_RELAXED);
    }
}

/* Returns the log-odds that a sign is right, if `agree` of `pairs` pairs agree. */
static double log_odds(uint64_t agree, uint64_t pairs) {
    double excess = 2 * (double)(agree + 1) / (double)(pairs + 2) - 1, rate = (1 + sqrt(excess > 0 ? excess : 0)) / 2;
    return fmin(log(rate / (1 - rate)), MOST);
}

/* Returns the log-odds that a normal is right, from how often it agrees with the places that w->own tells of. If these
 * are right with probability o and normals with n, they agree with probability n o + (1 - n)(1 - o).   places  log-odds
 * of o. */
static double log_odds_beside(const weighing *w, double places) {
    size_t both = 0, same = 0;
    for (size_t p = 0; p < w->c->dual->num_points; p++) {
        if (w->own[p] == 0 || w->cosine[p] == 0) continue;
        both++;
        same += (w->own[p] < 0) == (w->cosine[p] < 0);
    }
    if (both < FEW) return MOST;
    double o = 1 / (1 + exp(-places)), n = ((double)(same + 1) / (double)(both + 2) + o - 1) / (2 * o - 1);
    return n <= 0.5 ? 0 : n >= 1 ? MOST : fmin(log(n / (1 - n)), MOST);
}

/* Returns whether most directions are steep: normals that do not go with the shape, such as one normal for all points,
 * are not. Half of the directions drawn by lot are. */
static bool is_steep(const weighing *w) {
    size_t told = 0, steep = 0;
    for (size_t p = 0; p < w->c->dual->num_points; p++) {
        told += w->cosine[p] != 0;
        steep += fabsf(w->cosine[p]) >= 0.5f;
    }
    return 3 * steep >= 2 * told;
}

/* Weighs the classes. Returns whether the evidence tells anything. */
static bool weigh_classes(weighing *w) {
    uint64_t agree = 0, pairs = 0;
    for (int i = 0; i < CLASSES; i++) agree += w->agree[i], pairs += w->pairs[i];
    w->total = log_odds(agree, pairs);
    for (int i = 0; i < CLASSES; i++)
        w->weight[i] = fmin(w->pairs[i] < FEW ? w->total : log_odds(w->agree[i], w->pairs[i]), w->most);
    if (w->kind == BRIO_EVIDENCE_NORMALS && !is_steep(w)) return false;
    return fmin(w->total, w->most) >= LEAST;
}

/* Adds weights to those of the other kind. Where both tell the same the larger one counts: normals mostly have their
 * signs from the scanner, and are wrong where its place is. */
static void add_weights(void *user, size_t begin, size_t end, int thread) {
    const weighing *w = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        double weight = w->weight[class_of(w->cosine[p])];
        double more = w->cosine[p] == 0 ? 0 : w->cosine[p] > 0 ? weight : -weight, own = (double)w->own[p];
        w->own[p] = (float)(own * more <= 0 ? own + more : fabs(more) > fabs(own) ? more : own);
    }
}

static bool is_given(const brio_evidence *e, unsigned kind) {
    return kind == BRIO_EVIDENCE_NORMALS ? e->normals : e->origins;
}

brio_status brio_weigh_evidence(brio_context *ctx, const brio_sample_evidence *e, const brio_cocones *c, float **own,
                                unsigned *used) {
    static const unsigned KINDS[] = {BRIO_EVIDENCE_ORIGINS, BRIO_EVIDENCE_NORMALS};
    brio_status status = BRIO_OK;
    size_t n = c->dual->num_points, tets = c->dual->t.count;
    int threads = brio_threads(ctx, n, SAMPLES_A_THREAD);
    weighing w = {.e = e, .c = c};
    *own = NULL;
    *used = 0;
    if (!e->given.normals && !e->given.origins) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(ctx, w.cosine, n));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, w.own, n));
    for (int k = 0; k < 2; k++) {
        w.kind = KINDS[k];
        if (!is_given(&e->given, w.kind)) continue;
        for (int i = 0; i < CLASSES; i++) w.agree[i] = w.pairs[i] = 0;
        BRIO_TRY(brio_for(ctx, threads, n, find_cosines, &w));
        BRIO_TRY(brio_for(ctx, brio_threads(ctx, tets, TETS_A_THREAD), tets, count_pairs, &w));
        w.most = *used ? log_odds_beside(&w, w.total) : MOST;
        if (!weigh_classes(&w)) continue;
        BRIO_TRY(brio_for(ctx, threads, n, add_weights, &w));
        *used |= w.kind;
    }
done:
    brio_release(ctx, w.cosine);
    if (status == BRIO_OK && *used)
        *own = w.own;
    else
        brio_release(ctx, w.own);
    return status;
}

brio_status brio_orient_by_evidence(brio_context *ctx, const brio_sample_evidence *e, const brio_cocones *c,
                                    uint8_t *turned, float **own, unsigned *used) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_weigh_evidence(ctx, e, c, own, used));
    for (size_t p = 0; p < c->dual->num_points && *own; p++)
        if ((*own)[p] != 0) turned[p] = (*own)[p] < 0;
done:
    return status;
}

typedef struct {
    const brio_sample_evidence *e;
    const double *points;
    float (*out)[3];
} looking;

static void find_directions(void *user, size_t begin, size_t end, int thread) {
    const looking *l = user;
    (void)thread;
    for (size_t p = begin; p < end; p++) {
        double to[3], length;
        towards_scanner(l->e, p, l->points + 3 * p, to);
        length = hypot(hypot(to[0], to[1]), to[2]);
        for (int k = 0; k < 3; k++) l->out[p][k] = length > 0 && length < INFINITY ? (float)(to[k] / length) : 0;
    }
}

brio_status brio_scanner_directions(brio_context *ctx, const brio_sample_evidence *e, const double *points,
                                    size_t num_points, float (**out)[3]) {
    looking l = {e, points, NULL};
    brio_status status = BRIO_ALLOC(ctx, *out, num_points);
    l.out = *out;
    if (status != BRIO_OK) return status;
    return brio_for(ctx, brio_threads(ctx, num_points, SAMPLES_A_THREAD), num_points, find_directions, &l);
}

double brio_evidence_agreement(const brio_sample_evidence *e, unsigned kinds, const double *points,
                               const float (*outside)[3], size_t num_points, size_t *told) {
    size_t agree = 0, all = 0;
    *told = 0;
    for (size_t p = 0; p < num_points; p++) {
        const double axis[3] = {(double)outside[p][0], (double)outside[p][1], (double)outside[p][2]};
        size_t before = all;
        for (unsigned kind = BRIO_EVIDENCE_NORMALS; kind <= BRIO_EVIDENCE_ORIGINS; kind <<= 1) {
            double cosine = kinds & kind && is_given(&e->given, kind) ? cosine_to(e, kind, p, points + 3 * p, axis) : 0;
            agree += cosine > 0;
            all += cosine != 0;
        }
        *told += all > before;
    }
    return all ? (double)agree / (double)all : 0;
}
