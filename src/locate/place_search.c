/* Exact searches for vertices in the k-d tree of a locator.
 *
 * A search keeps the best vertices found so far in ascending order. Two vertices are compared by their rounded values
 * where the error bounds of these decide, else exactly (brio_power_compare), and by position where they are equal. The
 * far half of a range is left out only if every value there is greater than the last one kept, for all rounding errors.
 * Rounded values are of coordinates times the locator's scale: else all would be infinite or 0 for vertices far from 1,
 * and a search would compare all of them exactly.
 *
 * Based on: Friedman, Bentley, Finkel. An algorithm for finding best matches in logarithmic expected time. ACM TOMS
 * 1977.
 *           Arya, Mount. Algorithms for fast vector quantization. DCC 1993 (distances of ranges).
 * Differs from the papers: a range knows its greatest weight, which bounds its power distances. */
#include "locate/place_search.h"
#include "base/vector.h"
#include "query/nearest_points.h"
#include <string.h>

/* Twice the 5 roundings of a value, as in brio_power_compare; u = 2^-53. SMALL bounds what underflow costs. */
static const double SHARE = 10 * 0x1p-53, SMALL = 0x1p-1000;

typedef struct {
    const brio_locator *l;
    double x[3];
    bool power;
    size_t wanted, size;
    brio_found *found;
} search;

static inline brio_found evaluate(const search *s, size_t place) {
    const double *p = s->l->record[place];
    double scale = s->l->scale, dx = (s->x[0] - p[0]) * scale, dy = (s->x[1] - p[1]) * scale;
    double dz = (s->x[2] - p[2]) * scale, square = dx * dx + dy * dy + dz * dz;
    if (!s->power) return (brio_found){square, square, (uint32_t)place};
    double weight = p[3] * scale * scale;
    return (brio_found){square - weight, square + fabs(weight), (uint32_t)place};
}

static int compare_exactly(const search *s, uint32_t a, uint32_t b) {
    const double *p = s->l->record[a], *q = s->l->record[b];
    double unweighted[2][4] = {{p[0], p[1], p[2], 0}, {q[0], q[1], q[2], 0}};
    int sign = s->power ? brio_power_compare(s->x, p, q) : brio_power_compare(s->x, unweighted[0], unweighted[1]);
    return sign ? sign : brio_lexicographic(p, q);
}

/* Returns whether a comes before b. Infinite and undefined values compare false, and are compared exactly. */
static inline bool comes_before(const search *s, const brio_found *a, const brio_found *b) {
    double bound = SHARE * (a->magnitude + b->magnitude) + SMALL;
    if (b->value - a->value > bound) return true;
    if (a->value - b->value > bound) return false;
    return compare_exactly(s, a->place, b->place) < 0;
}

static inline void offer(search *s, size_t place) {
    brio_found now = evaluate(s, place);
    if (s->size == s->wanted) {
        const brio_found *last = &s->found[s->size - 1];
        if (place == last->place || !comes_before(s, &now, last)) return;
        s->size--;
    }
    size_t i = s->size++;
    for (; i > 0 && comes_before(s, &now, &s->found[i - 1]); i--) s->found[i] = s->found[i - 1];
    s->found[i] = now;
}

/* Returns whether every vertex of a range that is `off` away along the axes comes after the last one kept.
 * off, most  scaled. */
static inline bool is_beyond(const search *s, const double off[3], double most) {
    if (s->size < s->wanted) return false;
    const brio_found *last = &s->found[s->size - 1];
    double square = brio_dot(off, off);
    return square - most - last->value > SHARE * (square + fabs(most) + last->magnitude) + SMALL;
}

/* Looks at a range.   off  along each axis, how far the range is from the position at least; scaled. */
static void look(search *s, size_t begin, size_t end, double off[3]) {
    const brio_locator *l = s->l;
    if (end - begin <= BRIO_TREE_LEAF) {
        for (size_t place = begin; place < end; place++) offer(s, place);
        return;
    }
    size_t middle = begin + (end - begin) / 2;
    int axis = l->axis[middle];
    double across = (s->x[axis] - l->record[middle][axis]) * l->scale, before = off[axis];
    double most = s->power ? l->most[middle] * l->scale * l->scale : 0;
    if (across < 0)
        look(s, begin, middle, off);
    else
        look(s, middle + 1, end, off);
    off[axis] = across;
    if (!is_beyond(s, off, most)) {
        offer(s, middle);
        if (across < 0)
            look(s, middle + 1, end, off);
        else
            look(s, begin, middle, off);
    }
    off[axis] = before;
}

size_t brio_search_places(const brio_locator *l, const double *x, bool power, size_t wanted, uint32_t hint,
                          brio_found *found) {
    search s = {.l = l, .x = {x[0], x[1], x[2]}, .power = power && l->weighted, .wanted = wanted, .found = found};
    if (wanted == 1 && hint != BRIO_INFINITE) s.found[s.size++] = evaluate(&s, hint);
    look(&s, 0, l->num_vertices, (double[3]){0, 0, 0});
    return s.size;
}

uint32_t brio_place_near(const brio_locator *l, const double *x) {
    size_t begin = 0, end = l->num_vertices;
    while (end - begin > BRIO_TREE_LEAF) {
        size_t middle = begin + (end - begin) / 2;
        int axis = l->axis[middle];
        if (x[axis] < l->record[middle][axis])
            end = middle;
        else
            begin = middle + 1;
    }
    size_t place = begin + (end - begin) / 2;
    return (uint32_t)(place < l->num_vertices ? place : l->num_vertices - 1);
}
