/* The first tetrahedron, and inputs of fewer than three dimensions.
 *
 * Four points come first in the insertion order: the first point, the first point at another position, the first point
 * off their line and the first point off their plane. If there are fewer, an apex off the plane (two off the line) is
 * added. Then every tetrahedron has all apexes, and its orthosphere meets the points' plane (line) in the orthocircle
 * of its other vertices. The symbolic perturbation skips the apexes. So the link of the apexes is the perturbed
 * regular triangulation of the points in their own dimension, with the same hidden points. */
#include "triangulation/start.h"
#include "base/memory.h"
#include <assert.h>
#include <string.h>

enum { FIRST = 5 }; /* tetrahedra that a triangulation begins with */

static void swap_records(brio_store *s, size_t i, size_t j) {
    if (i == j) return;
    brio_record r;
    memcpy(r, s->record[i], sizeof r);
    memcpy(s->record[i], s->record[j], sizeof r);
    memcpy(s->record[j], r, sizeof r);
    assert(i < s->num_points && j < s->num_points);
    uint32_t c = s->caller[i];
    s->caller[i] = s->caller[j], s->caller[j] = c;
    if (!s->rank) return;
    c = s->rank[i];
    s->rank[i] = s->rank[j], s->rank[j] = c;
}

/* Returns whether record i is off the affine hull of the first `count` records, which are in general position. */
static bool off_hull(brio_store *s, size_t i, int count) {
    const brio_record *r = s->record;
    switch (count) {
    case 1:
        return !brio_same_position(r[0], r[i]);
    case 2:
        return !brio_collinear(r[0], r[1], r[i]);
    default:
        return brio_orient3d_sign(&s->filter, r[0], r[1], r[2], r[i]) != 0;
    }
}

/* Moves records in general position to the front. Returns their number. */
static int general_position(brio_store *s) {
    int count = s->num_points > 0;
    for (size_t i = 1; i < s->num_points && count < 4; i++) {
        if (count == 0 || !off_hull(s, i, count)) continue;
        swap_records(s, i, (size_t)count);
        count++;
    }
    return count;
}

/* Gives the first four records, those of the first tetrahedron, the first turns. Flat inputs need no sequence. */
static void choose_turns(brio_store *s) {
    size_t to = s->num_points;
    if (s->dimension < 3) {
        brio_release(s->ctx, s->sequence);
        s->sequence = NULL;
        return;
    }
    for (size_t i = s->num_points; i-- > 0;)
        if (s->sequence[i] > 3) s->sequence[--to] = s->sequence[i];
    assert(to == 4); /* the first four records were in the sequence */
    for (uint32_t i = 0; i < 4; i++) s->sequence[i] = i;
}

/* Returns a finite number different from x, about `step` away. */
static double moved(double x, double step) {
    double y = x > 0 ? x - step : x + step;
    if (y != x) return y;
    return x != 0 ? x * 0.5 : 1;
}

/* Writes record `apex` off the affine hull of corner[0 .. count), which are records in general position. */
static void place_apex(brio_store *s, uint32_t corner[4], int count, uint32_t apex, double step) {
    const brio_record *r = s->record;
    for (int axis = 0; axis < 3; axis++) {
        double *p = s->record[apex];
        memcpy(p, r[corner[0]], sizeof(brio_record));
        p[3] = 0;
        p[axis] = moved(p[axis], step);
        bool off = count == 2 ? !brio_collinear(r[corner[0]], r[corner[1]], p)
                              : brio_orient3d_exact(r[corner[0]], r[corner[1]], r[corner[2]], p) != 0;
        if (off) break;
    }
    assert(apex < s->t.infinite);
    corner[count] = apex;
}

static double largest_difference(const brio_store *s) {
    double most = 0;
    for (int c = 0; c < 3; c++) most = fmax(most, fabs(s->record[1][c] - s->record[0][c]));
    return fmin(most, 1e300);
}

/* Rotates the latest of the first three vertices to the front; the orientation stays. */
static void latest_first(uint32_t *v) {
    assert(v[0] != v[1] && v[1] != v[2] && v[2] != v[0]);
    while (v[0] < v[1] || v[0] < v[2]) {
        uint32_t first = v[0];
        v[0] = v[1], v[1] = v[2], v[2] = first;
    }
}

/* Makes the tetrahedron of four records and the four infinite tetrahedra around it. The latest vertex is in slot 0, as
 * after any insertion. */
static void first_tetrahedron(brio_store *s, uint32_t corner[4]) {
    const brio_record *r = s->record;
    brio_tetrahedra *t = &s->t;
    uint32_t *own = t->tet[0].vertex;
    own[0] = corner[3], own[1] = corner[0], own[2] = corner[1], own[3] = corner[2];
    if (brio_orient3d_exact(r[own[0]], r[own[1]], r[own[2]], r[own[3]]) < 0) own[2] = corner[2], own[3] = corner[1];
    assert(brio_orient3d_exact(r[own[0]], r[own[1]], r[own[2]], r[own[3]]) > 0); /* I1 */
    assert(s->capacity >= FIRST && s->t.count == 0);
    t->count = FIRST;
    for (uint32_t i = 0; i < 4; i++) { /* facet i seen from outside: its order reversed */
        uint32_t *v = t->tet[i + 1].vertex;
        v[0] = own[BRIO_FACET[i][0]], v[1] = own[BRIO_FACET[i][2]], v[2] = own[BRIO_FACET[i][1]];
        v[3] = t->infinite;
        latest_first(v);
        t->tet[0].mate[i] = brio_facet_of(i + 1, 3);
        t->tet[i + 1].mate[3] = i;
    }
    for (uint32_t i = 0; i < 4; i++)
        for (uint32_t e = 0; e < 3;
             e++) { /* across the edge opposite to vertex e lies the facet opposite to that vertex */
            uint32_t j = (uint32_t)brio_slot_of_vertex(own, t->tet[i + 1].vertex[e]);
            int other = brio_slot_of_vertex(t->tet[j + 1].vertex, own[i]);
            assert(j < 4 && other < 3 && j != i);
            t->tet[i + 1].mate[e] = brio_facet_of(j + 1, other);
        }
    memset(s->state, TET_PLAIN, t->count);
}

/* Chooses the filter. Reads all records once, in order. */
static void choose_filter(brio_store *s, size_t records) {
    brio_expect_sequence(s->record);
    brio_filter_for(&s->filter, (const brio_record *)s->record, records, s->weighted);
    brio_expect_random(s->record);
}

brio_status brio_start(brio_store *s) {
    if (s->num_points == 0) {
        s->dimension = -1;
        return BRIO_OK;
    }
    choose_filter(s, s->num_points);
    int count = general_position(s);
    s->dimension = count - 1;
    if (s->sequence) choose_turns(s);
    if (s->dimension == 0) return BRIO_OK;
    uint32_t corner[4] = {0, 1, 2, 3};
    double step = largest_difference(s);
    for (int apex = 0; count < 4; apex++, count++)
        place_apex(s, corner, count, (uint32_t)s->num_points + (uint32_t)apex, step);
    if (s->dimension < 3) {
        size_t records = s->num_points + (size_t)(3 - s->dimension);
        choose_filter(s, records);
    }
    brio_status status = brio_store_reserve(s, FIRST);
    if (status == BRIO_OK) first_tetrahedron(s, corner);
    return status;
}
