/* Reads the caller's points: refuses numbers that are not finite, and finds the plane of points in space.
 *
 * Each number is read once, into a record, and it is the record that must be finite: another thread of the caller may
 * write to the caller's arrays meanwhile.
 *
 * The plane is projected along the coordinate axis closest to its normal. The projection keeps which triples of points
 * are collinear and, up to one sign for all, which are counterclockwise. The order of the two axes sets that sign. */
#include "plane/plane_input.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/points_hash.h"
#include "predicates/predicates.h"
#include <math.h>
#include <string.h>

/* --- records --- */

/* Copies the coordinates of a point, in the caller's order of the coordinates, and its weight. */
static inline void copy_point(const brio_plane_input *in, size_t i, double *record) {
    const double *p = in->points + (size_t)in->coordinates * i;
    record[0] = p[0] + 0.0;
    record[1] = p[1] + 0.0;
    record[2] = in->coordinates == 3 ? p[2] + 0.0 : 0;
    record[3] = in->weights ? in->weights[i] + 0.0 : 0;
}

static inline void turn_point(const brio_plane_input *in, size_t i, double *record) {
    for (int k = 0; k < 3; k++) record[k] = in->own[i][in->axis[k]];
    record[3] = in->own[i][3];
}

brio_status brio_plane_records_new(brio_context *ctx, brio_plane_input *input, const uint32_t *order, size_t room,
                                   brio_plane_record **out) {
    size_t n = input->count;
    brio_plane_record *record = NULL;
    uint64_t hash = 0;
    bool finite = true;
    brio_status status = BRIO_ALLOC(ctx, record, n + room);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < n; i++) {
        size_t from = order ? order[i] : i;
        if (input->own)
            turn_point(input, from, record[i]);
        else
            copy_point(input, from, record[i]);
        finite &= brio_all_finite(record[i], 4);
        hash += brio_point_hash(from, record[i]);
    }
    if (!input->own) input->hash = hash;
    if (!finite) {
        status = brio_refuse_records(ctx, (const double(*)[4])record, order, n);
        brio_release(ctx, record);
        return status;
    }
    memset(record + n, 0, room * sizeof *record);
    *out = record;
    return BRIO_OK;
}

/* --- points of a plane in space --- */

/* A search for points that are not in one plane. */
typedef struct {
    const brio_plane_input *in;
    size_t corner[3]; /* points in general position */
    int count;
    brio_filter filter;
} search;

static void load(const brio_plane_input *in, size_t i, double *record) {
    memcpy(record, in->own[i], sizeof *in->own);
    record[3] = 0;
}

static void find_filter(search *s) {
    double low[3] = {0}, high[3] = {0}, extent[3];
    for (size_t i = 0; i < s->in->count; i++)
        for (int k = 0; k < 3; k++) {
            double x = s->in->own[i][k];
            low[k] = i && low[k] < x ? low[k] : x;
            high[k] = i && high[k] > x ? high[k] : x;
        }
    for (int k = 0; k < 3; k++) extent[k] = high[k] - low[k];
    brio_filter_set(&s->filter, extent, 0, false);
}

/* Returns whether point i is off the affine hull of the corners. */
static bool off_hull(search *s, const double (*corner)[4], size_t i) {
    double p[4];
    load(s->in, i, p);
    switch (s->count) {
    case 1:
        return !brio_same_position(corner[0], p);
    case 2:
        return !brio_collinear(corner[0], corner[1], p);
    default:
        return brio_orient3d_sign(&s->filter, corner[0], corner[1], corner[2], p) != 0;
    }
}

/* Finds up to three points in general position. */
static brio_status find_corners(brio_context *ctx, search *s, double (*corner)[4]) {
    const size_t *c = s->corner;
    find_filter(s);
    for (size_t i = 0; i < s->in->count; i++) {
        if (i > 0 && !off_hull(s, (const double(*)[4])corner, i)) continue;
        BRIO_EXPECT(ctx, s->count < 3, BRIO_ERR_NO_ANSWER, "point %zu is off the plane of points %zu, %zu and %zu",
                    BRIO_POINT(ctx, i), BRIO_POINT(ctx, c[0]), c[1], c[2]);
        load(s->in, i, corner[s->count]);
        s->corner[s->count++] = i;
    }
    return BRIO_OK;
}

/* Returns the sign of component k of the normal of three points. */
static int normal_sign(const double (*corner)[4], int k) {
    double p[3][4] = {{0}};
    for (int i = 0; i < 3; i++) p[i][0] = corner[i][(k + 1) % 3], p[i][1] = corner[i][(k + 2) % 3];
    return brio_orient2d_exact(p[0], p[1], p[2]);
}

/* Returns the magnitude of component k of the normal, roughly. */
static double normal_size(const double (*corner)[4], int k) {
    const double *a = corner[0], *b = corner[1], *c = corner[2];
    int x = (k + 1) % 3, y = (k + 2) % 3;
    double size = fabs((b[x] - a[x]) * (c[y] - a[y]) - (b[y] - a[y]) * (c[x] - a[x]));
    return size < INFINITY ? size : 0;
}

static void set_axes(brio_plane_input *in, int u, int v) {
    in->axis[0] = u, in->axis[1] = v, in->axis[2] = 3 - u - v;
}

/* Sets the axes for three points in general position. */
static void choose_axes(brio_plane_input *in, const double (*corner)[4]) {
    int sign[3], along = 0, facing = 0;
    double most = -1;
    for (int k = 0; k < 3; k++) {
        sign[k] = normal_sign(corner, k);
        if (sign[k]) facing = sign[k];
        if (sign[k] && normal_size(corner, k) > most) most = normal_size(corner, k), along = k;
    }
    if (sign[along] == facing)
        set_axes(in, (along + 1) % 3, (along + 2) % 3);
    else
        set_axes(in, (along + 2) % 3, (along + 1) % 3);
}

/* Sets the axes for points on a line: u is the axis along which the line is longest. Different numbers have a
 * difference that is not 0, though half of it may be; of lengths that overflow the first one is taken. */
static void choose_line_axes(brio_plane_input *in, const double (*corner)[4]) {
    int u = 0;
    for (int k = 1; k < 3; k++)
        if (fabs(corner[1][k] - corner[0][k]) > fabs(corner[1][u] - corner[0][u])) u = k;
    set_axes(in, u, (u + 1) % 3);
}

static brio_status find_plane(brio_context *ctx, brio_plane_input *in) {
    search s = {.in = in};
    double corner[3][4] = {{0}};
    brio_status status = find_corners(ctx, &s, corner);
    if (status != BRIO_OK) return status;
    if (s.count == 3)
        choose_axes(in, (const double(*)[4])corner);
    else if (s.count == 2)
        choose_line_axes(in, (const double(*)[4])corner);
    return BRIO_OK;
}

brio_status brio_plane_input_set(brio_context *ctx, const double *points, const double *weights, size_t num_points,
                                 int coordinates, brio_plane_input *input) {
    brio_plane_record *own = NULL;
    *input = (brio_plane_input){points, weights, num_points, coordinates, {0, 1, 2}, 0, NULL};
    if (coordinates == 2) return BRIO_OK;
    brio_status status = brio_plane_records_new(ctx, input, NULL, 1, &own);
    if (status != BRIO_OK) return status;
    input->own = own;
    return find_plane(ctx, input);
}

void brio_plane_input_free(brio_context *ctx, brio_plane_input *input) {
    brio_release(ctx, input->own);
    input->own = NULL;
}

void brio_plane_input_key(const brio_plane_input *input, brio_plane_filter *filter) {
    for (int i = 0; i < 3; i++) filter->key[input->axis[i]] = (uint8_t)i;
}
