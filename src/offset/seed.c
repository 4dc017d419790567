/* The first samples of an offset surface: those over the corners of the faces. They are the corners of the flat parts
 * of the offset, and the ends of its round parts. */
#include "base/team.h"
#include "base/vector.h"
#include "offset/work.h"
#include <math.h>
#include <string.h>

enum { BATCH = 1 << 13, FACES_A_CHUNK = 64, PLACES = 4 /* of a triangle: corners, centroid */ };

static const double MOST_SHIFT = 0.1; /* of a sample from the place over the corner, in distances; chosen */
static const double APART = 0.35;     /* least distance of samples, in sides of a triangle on a ball; chosen */

typedef struct {
    const brio_offset_work *w;
    double side; /* 1 or -1: of the normals, on which the near side is */
    size_t first;
    double (*place)[PLACES][3]; /* of the batch */
    uint8_t (*found)[PLACES];
} seeder;

/* Returns six times the volume that the triangles bound. */
static double volume_of(const brio_triangle_tree *t) {
    double sum = 0, middle[3];
    for (int k = 0; k < 3; k++) middle[k] = 0.5 * (t->boxes[0].low[k] + t->boxes[0].high[k]);
    for (size_t i = 0; i < t->num_triangles; i++) {
        double p[3][3], n[3];
        for (int c = 0; c < 3; c++)
            for (int k = 0; k < 3; k++) p[c][k] = t->vertices[3 * (size_t)t->triangles[i][c] + (size_t)k] - middle[k];
        brio_cross(p[0], p[1], n);
        sum += brio_dot(n, p[2]);
    }
    return sum;
}

/* Writes the unit normal of a triangle, on the near side; returns false if it has none. */
static bool normal_of(const seeder *s, const double *const p[3], double *n) {
    double u[3], v[3];
    for (int k = 0; k < 3; k++) u[k] = p[1][k] - p[0][k], v[k] = p[2][k] - p[0][k];
    brio_cross(u, v, n);
    double length = brio_length(n);
    if (!(length > 0)) return false;
    for (int k = 0; k < 3; k++) n[k] *= s->side / length;
    return true;
}

/* Finds the point of the offset over p; returns false when it is not close to there. */
static bool find_over(const brio_offset_work *w, const double *p, const double *n, double *out) {
    const brio_offset_field *f = &w->field;
    double x[3], nearest[3], normal[3], tolerance = BRIO_OFFSET_TOLERANCE * w->error;
    size_t triangle;
    for (int k = 0; k < 3; k++) x[k] = p[k] + f->distance * n[k];
    double square = brio_closest_point(&f->solid->tree, x, nearest, &triangle);
    if (sqrt(square) < (1 - MOST_SHIFT) * f->distance || brio_offset_is_beyond(f, x)) return false;
    if (sqrt(square) >= f->distance * (1 - 0x1p-40)) {
        memcpy(out, x, sizeof x);
        return true;
    }
    if (!brio_offset_reach(f, x, tolerance, out, normal)) return false;
    return brio_square_distance(x, out) <= MOST_SHIFT * MOST_SHIFT * f->distance * f->distance;
}

static void seed_part(void *user, size_t begin, size_t end, int thread) {
    const seeder *s = user;
    const brio_triangle_tree *t = &s->w->field.solid->tree;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        const double *p[3];
        double n[3], centroid[3];
        memset(s->found[i], 0, PLACES);
        for (int c = 0; c < 3; c++) p[c] = t->vertices + 3 * (size_t)t->triangles[s->first + i][c];
        if (!normal_of(s, p, n)) continue;
        bool any = false;
        for (int c = 0; c < 3; c++) any |= s->found[i][c] = find_over(s->w, p[c], n, s->place[i][c]);
        for (int k = 0; k < 3; k++) centroid[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
        if (!any) s->found[i][3] = find_over(s->w, centroid, n, s->place[i][3]);
    }
}

static brio_status thin_out(brio_offset_work *w) {
    brio_status status = BRIO_OK;
    uint8_t *chosen = NULL;
    size_t n = 0;
    double spacing = APART * sqrt(2 * w->field.distance * w->error);
    BRIO_TRY(BRIO_ALLOC(w->ctx, chosen, w->num_points));
    BRIO_TRY(brio_thin(w->ctx, w->points, w->num_points, spacing, chosen, NULL));
    for (size_t i = 0; i < w->num_points; i++)
        if (chosen[i]) memmove(w->points + 3 * n++, w->points + 3 * i, 3 * sizeof *w->points);
    w->num_points = n;
done:
    brio_release(w->ctx, chosen);
    return status;
}

brio_status brio_offset_seed(brio_offset_work *w) {
    brio_status status = BRIO_OK;
    const brio_triangle_tree *t = &w->field.solid->tree;
    seeder s = {.w = w, .side = (volume_of(t) < 0) == w->field.inwards ? 1 : -1};
    BRIO_TRY(BRIO_ALLOC(w->ctx, s.place, BATCH));
    BRIO_TRY(BRIO_ALLOC(w->ctx, s.found, BATCH));
    for (; s.first < t->num_triangles; s.first += BATCH) {
        size_t count = t->num_triangles - s.first < BATCH ? t->num_triangles - s.first : BATCH;
        BRIO_TRY(brio_offset_progress(w));
        BRIO_TRY(
            brio_for_chunks(w->ctx, brio_threads(w->ctx, count, FACES_A_CHUNK), count, FACES_A_CHUNK, seed_part, &s));
        for (size_t i = 0; i < count; i++)
            for (int c = 0; c < PLACES; c++)
                if (s.found[i][c]) BRIO_TRY(brio_offset_add(w, s.place[i][c]));
    }
    BRIO_TRY(thin_out(w));
done:
    brio_release(w->ctx, s.place);
    brio_release(w->ctx, s.found);
    return status;
}
