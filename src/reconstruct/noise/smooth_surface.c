/* Smoothing of a surface: every vertex moves along the normal of the surface fitted to its neighbours onto that surface,
 * PASSES times. The neighbours are found along edges, breadth first, whole rings at a time until there are MORE: not in
 * space, where a thin wall has its other side.
 *
 * Based on: Alexa, Behr, Cohen-Or, Fleishman, Levin, Silva. Computing and rendering point set surfaces. TVCG 2003.
 * Differs from the paper: neighbours along the surface. */
#include "reconstruct/noise/smooth_surface.h"
#include "base/memory.h"
#include "base/places.h"
#include "base/team.h"
#include "base/vector.h"
#include "reconstruct/noise/local_surface.h"
#include <math.h>
#include <string.h>

/* As for samples (sample_noise.c). VERTICES_A_THREAD is chosen, too. */
enum { MORE = 36, PASSES = 2, VERTICES_A_THREAD = 256 };

typedef struct {
    size_t *first;  /* #P + 1: the vertices that faces join to p are next[first[p]] to next[first[p + 1] - 1] */
    uint32_t *next; /* 3 #F: the corner after p of each face at p */
    const double *from;
    double *to;
} smoothing;

static brio_status list_neighbours(brio_context *ctx, smoothing *s, size_t num_points, const uint32_t *faces,
                                   size_t num_faces) {
    brio_status status = BRIO_OK;
    size_t *place = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, place, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, s->first, num_points + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, s->next, 3 * num_faces));
    for (size_t c = 0; c < 3 * num_faces; c++) place[faces[c]]++;
    s->first[num_points] = brio_counts_to_places(place, 1, num_points, 0);
    memcpy(s->first, place, num_points * sizeof *place);
    for (size_t f = 0; f < num_faces; f++)
        for (size_t k = 0; k < 3; k++) s->next[place[faces[3 * f + k]]++] = faces[3 * f + (k + 1) % 3];
done:
    brio_release(ctx, place);
    return status;
}

static bool is_listed(const uint32_t *list, size_t count, uint32_t p) {
    for (size_t i = 0; i < count; i++)
        if (list[i] == p) return true;
    return false;
}

/* Lists p and the vertices nearest to it along edges: whole rings, until they are MORE, at most BRIO_MOST_NEAR. */
static size_t list_rings(const smoothing *s, uint32_t p, uint32_t *list) {
    size_t count = 1, ring = 0;
    list[0] = p;
    while (count < MORE && ring < count) {
        size_t end = count;
        for (; ring < end; ring++)
            for (size_t e = s->first[list[ring]]; e < s->first[list[ring] + 1] && count < BRIO_MOST_NEAR; e++)
                if (!is_listed(list, count, s->next[e])) list[count++] = s->next[e];
    }
    return count;
}

static void smooth_vertex(const smoothing *s, uint32_t p) {
    uint32_t list[BRIO_MOST_NEAR];
    brio_neighbourhood n = {.count = list_rings(s, p, list)};
    brio_local_surface surface;
    for (size_t j = 0; j < n.count; j++) {
        for (size_t k = 0; k < 3; k++) n.offset[j][k] = s->from[3 * (size_t)list[j] + k] - s->from[3 * (size_t)p + k];
        n.square[j] = brio_dot(n.offset[j], n.offset[j]);
    }
    if (!brio_fit_local_surface(&n, &surface) || fabs(surface.height) > surface.unit) return;
    for (size_t k = 0; k < 3; k++) s->to[3 * (size_t)p + k] += surface.height * surface.frame[2][k];
}

static void smooth_part(void *user, size_t begin, size_t end, int thread) {
    const smoothing *s = user;
    (void)thread;
    for (size_t p = begin; p < end; p++)
        if (s->first[p + 1] > s->first[p]) smooth_vertex(s, (uint32_t)p);
}

brio_status brio_smooth_surface(brio_context *ctx, double *points, size_t num_points, const uint32_t *faces,
                                size_t num_faces) {
    brio_status status = BRIO_OK;
    smoothing s = {.to = points};
    double *from = NULL;
    BRIO_TRY(list_neighbours(ctx, &s, num_points, faces, num_faces));
    BRIO_TRY(BRIO_ALLOC(ctx, from, 3 * num_points));
    s.from = from;
    for (int pass = 0; pass < PASSES; pass++) {
        BRIO_TRY(brio_progress(ctx, "smooth", (double)pass / PASSES));
        memcpy(from, points, 3 * num_points * sizeof *from);
        brio_for_chunks(ctx, brio_threads(ctx, num_points, VERTICES_A_THREAD), num_points, VERTICES_A_THREAD,
                        smooth_part, &s);
    }
done:
    brio_release(ctx, s.first);
    brio_release(ctx, s.next);
    brio_release(ctx, from);
    return status;
}
