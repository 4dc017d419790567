/* Samples where a surface through samples of an offset is wrong: on creases first, then elsewhere. Samples of one round
 * keep away from each other, as far as from the corners of their triangles. */
#include "base/team.h"
#include "base/vector.h"
#include "offset/work.h"
#include <math.h>
#include <string.h>

enum { BATCH = 1 << 12, FAULTS_A_CHUNK = 16, OTHERS = 5 /* places of a triangle */ };
enum { NOTHING, SMOOTH, CREASE }; /* kinds of samples */

static const double APART = 0.7; /* of a sample's distance from the earlier ones: from those of its round; chosen */
static const double NEAR =
    0.5; /* of the distance from a fault to a crease: from the crease's sample to the earlier ones;
                                    chosen: where they are nearer, the crease is not what is missing */

typedef struct {
    brio_offset_work *w;
    size_t first;
    brio_point_tree tree; /* of the samples that there were */
    double (*sample)[3];  /* for each fault */
    double *room;         /* distance of each from the samples that there were */
    uint8_t *kind;
    uint32_t *head, *next; /* of each point, the last new sample at its triangles; of entries (sample and point) the one
                              before */
    uint32_t *entry_sample;
    size_t entries;
    double (*taken)[3]; /* the samples that are chosen */
    size_t num_taken;
} mender;

static void corners_of(const brio_offset_work *w, size_t triangle, const double *corner[3]) {
    for (int c = 0; c < 3; c++) corner[c] = w->points + 3 * (size_t)w->triangles[triangle][c];
}

/* Returns the distance to the nearest sample there was. */
static double room_at(const mender *m, const double *p) {
    return sqrt(brio_nearest_square(&m->tree, p, INFINITY));
}

static uint8_t find_sample(const mender *m, const brio_offset_fault *fault, double *sample, double *room) {
    const brio_offset_work *w = m->w;
    const brio_offset_field *f = &w->field;
    static const double other[OTHERS][3] = {{0}, {1. / 3, 1. / 3, 1. / 3}, {0.5, 0.5, 0}, {0, 0.5, 0.5}, {0.5, 0, 0.5}};
    double nearest[3], normal[3], tolerance = BRIO_OFFSET_TOLERANCE * w->error, least = BRIO_OFFSET_APART * w->error;
    size_t triangle;
    const double *corner[3];
    corners_of(w, fault->triangle, corner);
    double d = sqrt(brio_closest_point(&f->solid->tree, fault->place, nearest, &triangle));
    double size = fmax(brio_square_distance(corner[0], corner[1]),
                       fmax(brio_square_distance(corner[1], corner[2]), brio_square_distance(corner[2], corner[0])));
    if (d > f->distance && !brio_offset_is_beyond(f, fault->place) &&
        brio_offset_crease(f, fault->place, corner, tolerance, sample) &&
        brio_square_distance(sample, fault->place) < size && (*room = room_at(m, sample)) > least &&
        *room > NEAR * sqrt(brio_square_distance(sample, fault->place)))
        return CREASE;
    for (int i = 0; i < OTHERS; i++) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = i ? other[i][0] * corner[0][k] + other[i][1] * corner[1][k] + other[i][2] * corner[2][k]
                     : fault->place[k];
        if (brio_offset_reach(f, p, tolerance, sample, normal) && (*room = room_at(m, sample)) > least) return SMOOTH;
    }
    return NOTHING;
}

static void find_part(void *user, size_t begin, size_t end, int thread) {
    const mender *m = user;
    (void)thread;
    for (size_t i = m->first + begin; i < m->first + end; i++)
        m->kind[i] = find_sample(m, &m->w->faults[i], m->sample[i], &m->room[i]);
}

static bool is_free(const mender *m, const uint32_t *corner, const double *p, double room) {
    for (int c = 0; c < 3; c++)
        for (uint32_t e = m->head[corner[c]]; e != UINT32_MAX; e = m->next[e])
            if (brio_square_distance(m->sample[m->entry_sample[e]], p) < room * room) return false;
    return true;
}

static void take_kind(mender *m, uint8_t kind) {
    const brio_offset_work *w = m->w;
    for (size_t i = 0; i < w->num_faults; i++) {
        const uint32_t *v = w->triangles[w->faults[i].triangle];
        if (m->kind[i] != kind || !is_free(m, v, m->sample[i], APART * m->room[i])) continue;
        for (int c = 0; c < 3; c++) {
            m->entry_sample[m->entries] = (uint32_t)i;
            m->next[m->entries] = m->head[v[c]];
            m->head[v[c]] = (uint32_t)m->entries++;
        }
        memcpy(m->taken[m->num_taken++], m->sample[i], sizeof *m->taken);
    }
}

brio_status brio_offset_mend(brio_offset_work *w, size_t *added) {
    brio_status status = BRIO_OK;
    mender m = {.w = w};
    size_t n = w->num_faults;
    *added = 0;
    BRIO_REQUIRE(w->ctx, n < UINT32_MAX / 3, BRIO_ERR_TOO_LARGE, "an offset of more than 2^32 triangles");
    BRIO_TRY(BRIO_ALLOC(w->ctx, m.sample, n));
    BRIO_TRY(BRIO_ALLOC(w->ctx, m.room, n));
    BRIO_TRY(BRIO_ALLOC(w->ctx, m.kind, n));
    BRIO_TRY(brio_point_tree_new(w->ctx, w->points, w->num_points, &m.tree));
    BRIO_TRY(BRIO_ALLOC(w->ctx, m.head, w->num_points));
    BRIO_TRY(BRIO_ALLOC(w->ctx, m.next, 3 * n));
    BRIO_TRY(BRIO_ALLOC(w->ctx, m.entry_sample, 3 * n));
    memset(m.head, 0xff, w->num_points * sizeof *m.head);
    for (; m.first < n; m.first += BATCH) {
        size_t count = n - m.first < BATCH ? n - m.first : BATCH;
        BRIO_TRY(brio_offset_progress(w));
        BRIO_TRY(
            brio_for_chunks(w->ctx, brio_threads(w->ctx, count, FAULTS_A_CHUNK), count, FAULTS_A_CHUNK, find_part, &m));
    }
    BRIO_TRY(BRIO_ALLOC(w->ctx, m.taken, n));
    take_kind(&m, CREASE);
    take_kind(&m, SMOOTH);
    BRIO_TRY(brio_offset_add_apart(w, &m.tree, (const double(*)[3])m.taken, m.num_taken, added));
done:
    brio_release(w->ctx, m.sample);
    brio_release(w->ctx, m.room);
    brio_release(w->ctx, m.kind);
    brio_point_tree_free(w->ctx, &m.tree);
    brio_release(w->ctx, m.head);
    brio_release(w->ctx, m.next);
    brio_release(w->ctx, m.entry_sample);
    brio_release(w->ctx, m.taken);
    return status;
}
