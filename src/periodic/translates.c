/* Translates in conflict with a tetrahedron, by a tree of boxes about the points in the domain.
 *
 * The points are sorted along the Morton curve of their coordinates in the basis. Boxes hold runs of them, and runs of
 * boxes. A search tries the shifts that bring the domain to the ball, and enters boxes that may hold a point that is in
 * conflict, and deeper in it than the best so far. Depths are rounded; conflicts are exact. */
#include "periodic/translates.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/vector.h"
#include <assert.h>
#include <math.h>
#include <string.h>

/* RUN: sites of a box; FAN: boxes of a box; both chosen. BITS: of a coordinate of the curve. */
enum { RUN = 8, FAN = 8, BITS = 10, SHIFT_BITS = 8, HALF = 1 << (SHIFT_BITS - 1) };

/* --- names --- */

uint64_t brio_translate_name(uint32_t point, const int32_t shift[3]) {
    uint64_t name = point;
    for (int k = 0; k < 3; k++) {
        assert(-HALF <= shift[k] && shift[k] < HALF);
        name = name << SHIFT_BITS | (uint64_t)(shift[k] + HALF);
    }
    return name;
}

brio_image brio_translate_of(uint64_t name) {
    brio_image image = {.point = (uint32_t)(name >> 3 * SHIFT_BITS)};
    for (int k = 2; k >= 0; k--, name >>= SHIFT_BITS) image.shift[k] = (int32_t)(name & (2 * HALF - 1)) - HALF;
    return image;
}

/* --- the tree --- */

/* Moves bit i of BITS bits to bit 3 i. */
static uint64_t spread(uint64_t x) {
    x = (x | x << 16) & 0x030000ff;
    x = (x | x << 8) & 0x0300f00f;
    x = (x | x << 4) & 0x030c30c3;
    return (x | x << 2) & 0x09249249;
}

/* Returns the place of a position on the curve. Coordinates that do not repeat are taken as shares of the box. */
static uint64_t curve_key(const brio_translates *t, const double *x) {
    uint64_t key = 0;
    for (int k = 0; k < 3; k++) {
        double width = t->all.high[k] - t->all.low[k], share = width > 0 ? (x[k] - t->all.low[k]) / width : 0;
        double cell = share * (1 << BITS); /* not below 0 */
        key |= spread(cell < (1 << BITS) - 1 ? (uint64_t)cell : (1 << BITS) - 1) << k;
    }
    return key;
}

static inline void widen(brio_ball_box *b, const double *low, const double *high, double weight) {
    for (int k = 0; k < 3; k++) {
        b->low[k] = low[k] < b->low[k] ? low[k] : b->low[k];
        b->high[k] = high[k] > b->high[k] ? high[k] : b->high[k];
    }
    b->weight = weight > b->weight ? weight : b->weight;
}

brio_ball_box brio_translates_box(const brio_lattice *l, const double low[3], const double high[3], double heaviest) {
    brio_ball_box box = {.weight = heaviest};
    for (int k = 0; k < 3; k++) {
        box.low[k] = low[k], box.high[k] = high[k];
        for (int i = 0; i < l->rank; i++) {
            double way = (ceil(l->range[i]) + 1) * fabs(l->basis[i][k]);
            box.low[k] -= way, box.high[k] += way;
        }
    }
    return box;
}

static const brio_ball_box NOTHING = {{INFINITY, INFINITY, INFINITY}, {-INFINITY, -INFINITY, -INFINITY}, -INFINITY};

static brio_status make_boxes(brio_translates *t) {
    size_t size = (t->count + RUN - 1) / RUN, total = 0;
    for (; size > 0 && t->levels<15; size = size> 1 ? (size + FAN - 1) / FAN : 0) {
        t->first[t->levels++] = total;
        total += size;
    }
    t->first[t->levels] = total;
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->box, total + 1));
    for (size_t i = 0; i < total; i++) t->box[i] = NOTHING;
    for (size_t i = 0; i < t->count; i++) widen(&t->box[i / RUN], t->site[i], t->site[i], t->site[i][3]);
    for (int level = 1; level < t->levels; level++)
        for (size_t i = t->first[level - 1]; i < t->first[level]; i++) {
            const brio_ball_box *b = &t->box[i];
            widen(&t->box[t->first[level] + (i - t->first[level - 1]) / FAN], b->low, b->high, b->weight);
        }
    return BRIO_OK;
}

static brio_status sort_sites(const brio_images *m, const uint8_t *left_out, brio_translates *t) {
    brio_status status = BRIO_OK;
    uint64_t *key = NULL;
    BRIO_TRY(BRIO_ALLOC(t->ctx, key, m->num_points + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, t->point, m->num_points + 1));
    for (size_t p = 0; p < m->num_points; p++) {
        if (left_out[p]) continue;
        key[t->count] = curve_key(t, m->x[p]);
        t->point[t->count++] = (uint32_t)p;
    }
    BRIO_TRY(brio_radix_sort(t->ctx, key, t->point, t->count, 3 * BITS));
    BRIO_TRY(BRIO_ALLOC(t->ctx, t->site, t->count + 1));
    for (size_t i = 0; i < t->count; i++) {
        memcpy(t->site[i], m->x[t->point[i]], 3 * sizeof(double));
        t->site[i][3] = m->weight ? m->weight[t->point[i]] : 0;
    }
done:
    brio_release(t->ctx, key);
    return status;
}

brio_status brio_translates_new(brio_context *ctx, const brio_images *m, const uint8_t *left_out, brio_translates *t) {
    const brio_lattice *l = m->lattice;
    *t = (brio_translates){.ctx = ctx, .lattice = l, .all = NOTHING};
    double extent[3], least = INFINITY;
    for (size_t p = 0; p < m->num_points; p++) {
        double w = m->weight ? m->weight[p] : 0;
        widen(&t->all, m->x[p], m->x[p], w);
        least = fmin(least, w);
    }
    BRIO_FORWARD(sort_sites(m, left_out, t));
    BRIO_FORWARD(make_boxes(t));
    for (int i = 0; i < l->rank; i++) {
        t->most[i] = (int32_t)ceil(l->range[i]);
        assert(t->most[i] <= BRIO_LATTICE_MOST_SHIFT);
    }
    t->all = brio_translates_box(l, t->all.low, t->all.high, t->all.weight);
    for (int k = 0; k < 3; k++) extent[k] = fmax(t->all.high[k] - t->all.low[k], 0);
    brio_filter_set(&t->filter, extent, t->count ? t->all.weight - least : 0, m->weight != NULL);
    return BRIO_OK;
}

void brio_translates_free(brio_translates *t) {
    if (!t->ctx) return;
    brio_release(t->ctx, t->site);
    brio_release(t->ctx, t->point);
    brio_release(t->ctx, t->box);
    *t = (brio_translates){0};
}

/* --- a search --- */

typedef struct {
    const brio_translates *t;
    brio_filter *filter;
    const brio_ball *ball;
    double normal[3]; /* of a half-space */
    double offset[3]; /* of the shift that is tried */
    int32_t shift[3];
    double best; /* the depth of what was found; -INFINITY for nothing */
    size_t site;
    int32_t found[3];
} search;

/* Returns how deep a position is in the ball or half-space, about. */
static double depth_of(const search *s, const double *x, double weight) {
    const brio_ball *b = s->ball;
    double way[3];
    if (b->infinite) {
        for (int k = 0; k < 3; k++) way[k] = x[k] - b->vertex[0][k];
        return brio_dot(way, s->normal);
    }
    for (int k = 0; k < 3; k++) way[k] = x[k] - b->centre[k];
    return weight - brio_dot(way, way);
}

/* Returns a bound of the depths in a box, moved to the shift. */
static double most_depth(const search *s, const brio_ball_box *box) {
    double x[3];
    for (int k = 0; k < 3; k++) {
        if (s->ball->infinite)
            x[k] = s->normal[k] > 0 ? box->high[k] : box->low[k];
        else
            x[k] = fmin(fmax(s->ball->centre[k], box->low[k]), box->high[k]);
    }
    return depth_of(s, x, box->weight);
}

static void try_site(search *s, size_t i) {
    double record[4];
    for (int k = 0; k < 3; k++) record[k] = s->t->site[i][k] + s->offset[k];
    record[3] = s->t->site[i][3];
    double depth = depth_of(s, record, record[3]);
    if (s->best > -INFINITY && !(depth > s->best)) return;
    if (!brio_ball_takes(s->filter, s->ball, record)) return;
    s->best = isnan(depth) ? -0x1p1000 : depth;
    s->site = i;
    memcpy(s->found, s->shift, sizeof s->found);
}

static void enter(search *s, int level, size_t i) {
    const brio_translates *t = s->t;
    brio_ball_box box = t->box[t->first[level] + i];
    for (int k = 0; k < 3; k++) box.low[k] += s->offset[k], box.high[k] += s->offset[k];
    if (!brio_ball_meets(s->filter, s->ball, &box)) return;
    if (s->best > -INFINITY && most_depth(s, &box) < s->best) return;
    if (level == 0) {
        for (size_t j = i * RUN; j < (i + 1) * RUN && j < t->count; j++) try_site(s, j);
        return;
    }
    size_t below = t->first[level] - t->first[level - 1];
    for (size_t j = i * FAN; j < (i + 1) * FAN && j < below; j++) enter(s, level - 1, j);
}

/* Finds the shifts that bring the domain to the ball. */
static void shifts_to(const brio_translates *t, const brio_ball *ball, int32_t *from, int32_t *to) {
    double most = ball->square + t->all.weight, radius = sqrt(fmax(most, 0)) * (1 + 0x1p-30);
    for (int i = 0; i < 3; i++) {
        from[i] = -t->most[i], to[i] = t->most[i];
        if (i >= t->lattice->rank || ball->infinite || !(radius < INFINITY)) continue;
        double share = brio_lattice_share(t->lattice, i, ball->centre), way = radius * brio_length(t->lattice->dual[i]);
        way += 0x1p-30 * (1 + fabs(share));
        if (floor(share - way) > from[i]) from[i] = (int32_t)fmin(floor(share - way), to[i] + 1);
        if (floor(share + way) < to[i]) to[i] = (int32_t)fmax(floor(share + way), from[i] - 1);
    }
}

bool brio_translates_deepest(const brio_translates *t, brio_filter *filter, const brio_ball *ball,
                             brio_set_point *out) {
    search s = {.t = t, .filter = filter, .ball = ball, .best = -INFINITY};
    int32_t from[3], to[3];
    if (!t->count) return false;
    if (ball->infinite) {
        double u[3], v[3];
        for (int k = 0; k < 3; k++)
            u[k] = ball->vertex[1][k] - ball->vertex[0][k], v[k] = ball->vertex[2][k] - ball->vertex[0][k];
        brio_cross(u, v, s.normal);
    }
    shifts_to(t, ball, from, to);
    for (s.shift[0] = from[0]; s.shift[0] <= to[0]; s.shift[0]++)
        for (s.shift[1] = from[1]; s.shift[1] <= to[1]; s.shift[1]++)
            for (s.shift[2] = from[2]; s.shift[2] <= to[2]; s.shift[2]++) {
                static const double zero[3] = {0, 0, 0};
                brio_lattice_move(t->lattice, zero, s.shift, s.offset);
                enter(&s, t->levels - 1, 0);
            }
    if (!(s.best > -INFINITY)) return false;
    brio_lattice_move(t->lattice, t->site[s.site], s.found, out->record);
    out->record[3] = t->site[s.site][3];
    out->name = brio_translate_name(t->point[s.site], s.found);
    return true;
}

brio_status brio_translates_find(void *user, brio_ball *balls, size_t count, brio_found *found) {
    const brio_translates *t = user;
    brio_filter filter = t->filter;
    for (size_t i = 0; i < count; i++) {
        brio_set_point p;
        balls[i].is_free = !brio_translates_deepest(t, &filter, &balls[i], &p);
        if (!balls[i].is_free) BRIO_FORWARD(brio_found_add(found, &p));
        BRIO_FORWARD(brio_look(t->ctx, 16));
    }
    return BRIO_OK;
}

/* --- the nearest --- */

typedef struct {
    const brio_translates *t;
    double x[4], offset[3], bound; /* no farther than `bound`, which is rounded up */
    int32_t shift[3];
    bool any;
    double best[4];
    brio_image image;
} nearest_search;

static double square_to_box(const double *x, const brio_ball_box *box, const double *offset) {
    double square = 0;
    for (int k = 0; k < 3; k++) {
        double low = box->low[k] + offset[k], high = box->high[k] + offset[k];
        double d = x[k] < low ? low - x[k] : x[k] > high ? x[k] - high : 0;
        square += d * d;
    }
    return square - box->weight;
}

static void try_nearest(nearest_search *s, size_t i) {
    double record[4];
    for (int k = 0; k < 3; k++) record[k] = s->t->site[i][k] + s->offset[k];
    record[3] = s->t->site[i][3];
    if (s->any) {
        int sign = brio_power_compare(s->x, record, s->best);
        if (sign > 0 || (sign == 0 && brio_lexicographic(record, s->best) >= 0)) return;
    }
    double square = brio_square_distance(s->x, record);
    s->any = true;
    s->bound = square - record[3] + (square + fabs(record[3])) * 0x1p-40;
    memcpy(s->best, record, sizeof record);
    s->image.point = s->t->point[i];
    memcpy(s->image.shift, s->shift, sizeof s->shift);
}

static void enter_nearest(nearest_search *s, int level, size_t i) {
    const brio_translates *t = s->t;
    double least = square_to_box(s->x, &t->box[t->first[level] + i], s->offset);
    if (s->any && least - fabs(least) * 0x1p-40 > s->bound) return;
    if (level == 0) {
        for (size_t j = i * RUN; j < (i + 1) * RUN && j < t->count; j++) try_nearest(s, j);
        return;
    }
    size_t below = t->first[level] - t->first[level - 1];
    for (size_t j = i * FAN; j < (i + 1) * FAN && j < below; j++) enter_nearest(s, level - 1, j);
}

void brio_translates_nearest(const brio_translates *t, const double *x, brio_image *nearest) {
    static const double zero[3] = {0, 0, 0};
    nearest_search s = {.t = t, .x = {x[0], x[1], x[2], 0}};
    assert(t->count > 0);
    for (s.shift[0] = -t->most[0]; s.shift[0] <= t->most[0]; s.shift[0]++)
        for (s.shift[1] = -t->most[1]; s.shift[1] <= t->most[1]; s.shift[1]++)
            for (s.shift[2] = -t->most[2]; s.shift[2] <= t->most[2]; s.shift[2]++) {
                brio_lattice_move(t->lattice, zero, s.shift, s.offset);
                enter_nearest(&s, t->levels - 1, 0);
            }
    *nearest = s.image;
}
