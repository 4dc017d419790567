/* The convex hull of points of dimension 2 or less, exactly.
 *
 * The projection along one axis maps a plane that is not parallel to that axis one to one, and the hull to the hull.
 * The projected points are sorted; the lower and the upper half of the hull are found from the sorted points.
 *
 * Based on: Andrew. Another efficient algorithm for convex hulls in two dimensions. IPL 1979. */
#include "base/memory.h"
#include "base/sort.h"
#include "hull/hull_faces.h"
#include <assert.h>

/* The axes that a projection keeps: along z, x and y. */
static const int KEPT[3][2] = {{0, 1}, {1, 2}, {2, 0}};

typedef struct {
    const double (*record)[4];
    const uint32_t *index;
    const int *axis; /* the two axes that are kept */
} projection;

/* Returns the sign of the area of the projected triangle: det [b-a, c-a] is the determinant of orient3d for the points
 * (a, 0), (b, 0), (c, 0) and (a, 1). */
static int orient2d(const projection *on, uint32_t a, uint32_t b, uint32_t c) {
    const uint32_t index[4] = {a, b, c, a};
    double p[4][4];
    for (int i = 0; i < 4; i++) {
        p[i][0] = on->record[index[i]][on->axis[0]];
        p[i][1] = on->record[index[i]][on->axis[1]];
        p[i][2] = i == 3;
        p[i][3] = 0;
    }
    return brio_orient3d_exact(p[0], p[1], p[2], p[3]);
}

static int compare_projected(uint32_t a, uint32_t b, const void *user) {
    const projection *on = user;
    for (int k = 0; k < 2; k++) {
        double p = on->record[a][on->axis[k]], q = on->record[b][on->axis[k]];
        if (p != q) return p < q ? -1 : 1;
    }
    return (on->index[a] > on->index[b]) - (on->index[a] < on->index[b]);
}

static bool same_projected(const projection *on, uint32_t a, uint32_t b) {
    return on->record[a][on->axis[0]] == on->record[b][on->axis[0]] &&
           on->record[a][on->axis[1]] == on->record[b][on->axis[1]];
}

/* Extends a half of the hull, which begins at hull[first], by a point. Returns the new size of the hull. */
static size_t extend(const projection *on, uint32_t *hull, size_t first, size_t size, uint32_t point) {
    while (size >= first + 2 && orient2d(on, hull[size - 2], hull[size - 1], point) <= 0) size--;
    assert(first <= size);
    hull[size] = point;
    return size + 1;
}

/* Writes the hull of sorted points, all of different positions. Returns its size. */
static size_t wrap(const projection *on, const uint32_t *sorted, size_t n, uint32_t *hull) {
    size_t size = 0;
    for (size_t i = 0; i < n; i++) size = extend(on, hull, 0, size, sorted[i]);
    size_t upper = size - 1;
    for (size_t i = n - 1; i-- > 0;) size = extend(on, hull, upper, size, sorted[i]);
    assert(size >= 4 && hull[size - 1] == hull[0]);
    return size - 1; /* the last point is the first one */
}

static brio_status wrap_plane(brio_context *ctx, const projection *on, size_t n, brio_hull_polygons *out) {
    brio_status status = BRIO_OK;
    uint32_t *sorted = NULL;
    size_t positions = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, sorted, n));
    BRIO_TRY(BRIO_ALLOC(ctx, out->corner, n + 1));
    for (uint32_t i = 0; i < n; i++) sorted[i] = i;
    BRIO_TRY(brio_sort_rows(ctx, &(brio_row_order){on->record[0] + on->axis[0], 4, compare_projected, on}, sorted, n));
    for (size_t i = 0; i < n; i++)
        if (i == 0 || !same_projected(on, sorted[i], sorted[positions - 1])) sorted[positions++] = sorted[i];
    out->first[1] = wrap(on, sorted, positions, out->corner);
    brio_rotate_polygon(on->record, out->corner, out->first[1]);
done:
    brio_release(ctx, sorted);
    return status;
}

/* Finds the lexicographically least and greatest record; of equal ones that of the lowest index. */
static brio_status find_ends(brio_context *ctx, const projection *on, size_t n, brio_hull_polygons *out) {
    brio_status status = BRIO_ALLOC(ctx, out->corner, 2);
    if (status != BRIO_OK) return status;
    uint32_t *end = out->corner;
    end[0] = end[1] = 0;
    for (uint32_t i = 1; i < n; i++)
        for (int side = 0; side < 2; side++) {
            int sign = brio_lexicographic(on->record[i], on->record[end[side]]);
            if (sign == (side ? 1 : -1) || (sign == 0 && on->index[i] < on->index[end[side]])) end[side] = i;
        }
    return BRIO_OK;
}

brio_status brio_flat_hull(brio_context *ctx, const brio_hull_records *records, int dimension, const uint32_t *corner,
                           brio_hull_polygons *out) {
    brio_status status = BRIO_OK;
    size_t n = records->count;
    projection on = {(const double(*)[4])records->record, records->index, KEPT[0]};
    *out = (brio_hull_polygons){0};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, out->first, 2));
    if (dimension < 0) return BRIO_OK;
    out->count = 1;
    if (dimension == 2) {
        for (int i = 0; i < 3 && orient2d(&on, corner[0], corner[1], corner[2]) == 0; i++) on.axis = KEPT[i];
        BRIO_TRY(wrap_plane(ctx, &on, n, out));
    } else {
        BRIO_TRY(find_ends(ctx, &on, n, out));
        out->first[1] = (uint64_t)dimension + 1;
    }
done:
    if (status != BRIO_OK) brio_hull_polygons_free(ctx, out);
    return status;
}
