/* The spacing of samples, from the shortest Delaunay edges. The Delaunay triangulation holds the edge from each sample
 * to its nearest sample, and edges that leave a smooth surface are longer than edges along it.
 *
 * Every thread reads all tetrahedra, and has its own samples: most of the work is done at the samples. */
#include "dual/spacing.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include <assert.h>
#include <math.h>

/* NEAREST: derived, the mean degree of a triangulated surface. SAMPLES_A_THREAD, SLICE: chosen. */
enum { NEAREST = 6, SAMPLES_A_THREAD = 1 << 12, SLICE = 1 << 17 };

typedef struct {
    float square[NEAREST]; /* ascending */
    uint32_t sample[NEAREST];
    uint32_t count;
} neighbours;

static void offer(neighbours *n, uint32_t sample, float square) {
    assert(n->count <= NEAREST);
    if (n->count == NEAREST && !(square < n->square[NEAREST - 1])) return;
    for (uint32_t i = 0; i < n->count; i++)
        if (n->sample[i] == sample) return;
    uint32_t i = n->count < NEAREST ? n->count++ : NEAREST - 1;
    for (; i > 0 && n->square[i - 1] > square; i--) n->square[i] = n->square[i - 1], n->sample[i] = n->sample[i - 1];
    n->square[i] = square;
    n->sample[i] = sample;
}

typedef struct {
    const brio_tetrahedron *tet; /* the slice that all threads read */
    size_t num_tets, num_samples;
    const double *points;
    neighbours *list; /* #samples */
    double *spacing;
    float *second; /* or NULL */
} measuring;

/* Offers each end of an edge to the other end, if that is one of the samples begin to end - 1. */
static void offer_edge(const measuring *m, uint32_t a, uint32_t b, size_t begin, size_t end) {
    bool to_a = a - begin < end - begin && b < m->num_samples, to_b = b - begin < end - begin && a < m->num_samples;
    if (!to_a && !to_b) return;
    double square = brio_square_distance(m->points + 3 * (size_t)a, m->points + 3 * (size_t)b);
    if (to_a) offer(&m->list[a], b, (float)square);
    if (to_b) offer(&m->list[b], a, (float)square);
}

static void offer_slice(void *user, size_t begin, size_t end, int thread) {
    const measuring *m = user;
    (void)thread;
    for (size_t i = 0; i < m->num_tets; i++)
        for (int j = 1; j < 4; j++)
            for (int k = 0; k < j; k++) offer_edge(m, m->tet[i].vertex[j], m->tet[i].vertex[k], begin, end);
}

static void measure_part(void *user, size_t begin, size_t end, int thread) {
    const measuring *m = user;
    (void)thread;
    for (size_t s = begin; s < end; s++) {
        double sum = 0;
        for (uint32_t i = 0; i < m->list[s].count; i++) sum += sqrt((double)m->list[s].square[i]);
        m->spacing[s] = m->list[s].count ? sum / m->list[s].count : 0;
        if (m->second) m->second[s] = m->list[s].count > 1 ? sqrtf(m->list[s].square[1]) : INFINITY;
    }
}

brio_status brio_sample_spacing(brio_context *ctx, const brio_triangulation *t, const double *points,
                                size_t num_samples, double *spacing, float *second) {
    brio_status status = BRIO_OK;
    const brio_tetrahedron *tet = brio_triangulation_tetrahedra(t);
    size_t count = brio_triangulation_stats(t)->tetrahedra;
    int threads = brio_threads(ctx, num_samples, SAMPLES_A_THREAD);
    measuring m = {.num_samples = num_samples, .points = points, .spacing = spacing, .second = second};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, m.list, num_samples));
    for (size_t first = 0; first < count; first += SLICE) {
        m.tet = tet + first;
        m.num_tets = count - first < SLICE ? count - first : SLICE;
        brio_expect_rows(ctx, BRIO_ARRAYS(BRIO_READS(tet)), first + m.num_tets,
                         count - first < 2 * SLICE ? count : first + 2 * SLICE);
        BRIO_TRY(brio_for_parts(ctx, threads, num_samples, offer_slice, &m));
    }
    BRIO_TRY(brio_sweep(ctx, threads, num_samples, measure_part, &m, BRIO_READS(m.list), BRIO_WRITES(m.spacing),
                        BRIO_WRITES(m.second)));
done:
    brio_release(ctx, m.list);
    return status;
}

void brio_pole_spacing(const brio_poles *poles, size_t num_samples, const double *of_sample, double *spacing) {
    for (size_t p = 0; p < poles->count; p++) spacing[p] = 0;
    for (size_t i = 0; i < 2 * num_samples; i++) {
        uint32_t p = poles->of_sample[i];
        assert(p == BRIO_NO_POLE || p < poles->count);
        if (p != BRIO_NO_POLE) spacing[p] = fmax(spacing[p], of_sample[i / 2]);
    }
}
