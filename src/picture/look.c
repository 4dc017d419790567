/* From where a picture is seen: the direction from which most is seen.
 *
 * Samples of the surfaces, or points, fall into the cells of a coarse picture. A sample is seen if nothing in its
 * cell is nearer to the eye by more than the depth of a surface that runs through the cell steeply. The direction
 * with the most seen area wins: area that looks at the eye, since what looks away shows the inside, and hardly any of
 * what is seen along its side.
 *
 * Based on: Polonsky, Patane, Biasotti, Gotsman, Spagnuolo. What's in an image? Towards the computation of the "best"
 * view of an
 *           object. Visual Computer 2005, where the seen area is one of the measures.
 * Differs from it: samples in place of triangles, 49 directions, and the side counts that a face looks to. */
#include "base/memory.h"
#include "base/vector.h"
#include "picture/picture.h"

/* SAMPLES: of all meshes at most. CELLS: of the coarse picture along each axis. TURNS: directions around, of each
 * height. DEPTH: sizes of a cell that a seen sample may be behind the nearest one. All chosen. */
enum { SAMPLES = 20000, CELLS = 40, TURNS = 16 };
static const double DEPTH = 2.5;

/* How far up the eye is, in degrees: a height a ring. Earlier ones win where equal. */
static const double HEIGHT[] = {25, 50, 0};

typedef struct {
    double place[3], normal[3], area; /* normal 0: seen from everywhere alike */
} sample;

void brio_look_from(const double direction[3], brio_look_axes *a) {
    const double up[2][3] = {{0, 0, 1}, {0, 1, 0}};
    double largest = fmax(fabs(direction[0]), fmax(fabs(direction[1]), fabs(direction[2])));
    for (int k = 0; k < 3; k++) a->back[k] = direction[k] / largest; /* squares of these are no 0, and finite */
    double length = brio_length(a->back);
    for (int k = 0; k < 3; k++) a->back[k] /= length;
    bool along = fabs(a->back[0]) + fabs(a->back[1]) < 1e-6;
    brio_cross(up[along], a->back, a->right);
    double size = brio_length(a->right);
    for (int k = 0; k < 3; k++) a->right[k] /= size;
    brio_cross(a->back, a->right, a->up);
}

/* Returns what a mesh is sampled by: its faces, its tetrahedra, or its vertices. */
static size_t items_of(const brio_mesh *m) {
    return m->num_faces ? m->num_faces : m->num_vertices;
}

/* Samples a face at the mean of its corners, with the area of its polygon; others are points. */
static sample sample_of(const brio_mesh *m, const brio_scene_box *box, size_t i) {
    sample s = {.area = 1};
    if (!m->num_faces) {
        brio_scene_place(box, m->vertices + 3 * i, s.place);
        return s;
    }
    const uint32_t *v = m->face_vertices + m->face_offsets[i];
    size_t corners = (size_t)(m->face_offsets[i + 1] - m->face_offsets[i]);
    double first[3] = {0}, before[3] = {0}, here[3], part[3];
    for (size_t k = 0; k < corners; k++) {
        brio_scene_place(box, m->vertices + 3 * (size_t)v[k], here);
        for (int x = 0; x < 3; x++) {
            s.place[x] += here[x] / (double)corners;
            if (k == 0) first[x] = here[x];
            here[x] -= first[x];
        }
        if (k > 1) {
            brio_cross(before, here, part);
            for (int x = 0; x < 3; x++) s.normal[x] += part[x];
        }
        for (int x = 0; x < 3; x++) before[x] = here[x];
    }
    s.area = brio_length(s.normal);
    for (int x = 0; x < 3 && s.area > 0; x++) s.normal[x] /= s.area;
    return s;
}

/* Returns what a seen sample counts for. */
static double worth(const sample *s, const brio_look_axes *axes) {
    double cosine = brio_dot(s->normal, axes->back), plain = s->normal[0] + s->normal[1] + s->normal[2] == 0;
    if (plain && brio_dot(s->normal, s->normal) == 0) return s->area;
    if (cosine < 0) return 0.3 * s->area * fmin(1, -2 * cosine);
    return s->area * fmin(1, 2 * cosine);
}

/* Returns how much is seen along a direction. */
static double seen_from(const double direction[3], const sample *s, size_t n, float *nearest) {
    enum { ALL = CELLS * CELLS };
    const double width = 2 * sqrt(3.0) / CELLS; /* of a cell: the box has a radius of that at most */
    brio_look_axes axes;
    double sum = 0;
    brio_look_from(direction, &axes);
    for (int i = 0; i < ALL; i++) nearest[i] = -INFINITY;
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < n; i++) {
            double x = brio_dot(s[i].place, axes.right) / width, y = brio_dot(s[i].place, axes.up) / width;
            double depth = brio_dot(s[i].place, axes.back);
            int column = (int)floor(x + CELLS / 2.0), row = (int)floor(y + CELLS / 2.0);
            column = column < 0 ? 0 : column < CELLS ? column : CELLS - 1;
            row = row < 0 ? 0 : row < CELLS ? row : CELLS - 1;
            float *cell = nearest + row * CELLS + column;
            if (pass == 0)
                *cell = fmaxf(*cell, (float)depth);
            else if (depth >= (double)*cell - DEPTH * width)
                sum += worth(s + i, &axes);
        }
    return sum;
}

brio_status brio_look_best(brio_context *ctx, const brio_mesh *const *meshes, size_t count, const brio_scene_box *box,
                           double direction[3]) {
    static const double DEGREE = 3.14159265358979323846 / 180;
    brio_status status = BRIO_OK;
    size_t all = 0, n = 0;
    double most = -1;
    sample *samples = NULL;
    float *nearest = NULL;
    for (size_t i = 0; i < count; i++) all += items_of(meshes[i]);
    size_t step = all / SAMPLES + 1;
    BRIO_TRY(BRIO_ALLOC(ctx, samples, all / step + count + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, nearest, (size_t)CELLS * CELLS));
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < items_of(meshes[i]); k += step) samples[n++] = sample_of(meshes[i], box, k);
    for (int h = 0; h < 4; h++)
        for (int turn = 0; turn < (h < 3 ? TURNS : 1); turn++) {
            double height = (h < 3 ? HEIGHT[h] : 89) * DEGREE, around = (-60 + 360.0 / TURNS * turn) * DEGREE;
            double one[3] = {cos(height) * cos(around), cos(height) * sin(around), sin(height)};
            double seen = seen_from(one, samples, n, nearest);
            BRIO_TRY(brio_look(ctx, n + CELLS * CELLS));
            if (seen <= most * (1 + 1e-9)) continue;
            most = seen;
            for (int k = 0; k < 3; k++) direction[k] = one[k];
        }
done:
    brio_release(ctx, samples);
    brio_release(ctx, nearest);
    return status;
}
