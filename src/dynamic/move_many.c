/* Many points move at once.
 *
 * All new records are written, then the tetrahedra whose time is over are tested side by side (slack.c): most need no
 * more. Where a tetrahedron
 * is not positive any more, or the hull is not convex, one of the points there goes back to where it was. Where a
 * vertex behind a facet is in conflict, the two tetrahedra there are a hole, which is filled with the triangulation
 * of its vertices; while that does not have all facets of the hole's border, the tetrahedra behind those that it
 * lacks join the hole. This does what flips do, and never sticks. Facets of the border are tested again. The points
 * that went back then move one by one.
 *
 * Whatever was done, each repair leaves mates that are mates of each other, and that all tests hold in the end and no
 * vertex was lost proves the triangulation, by the theorem of triangulation/check.c: its tests 1 and 6 are made at
 * every facet, test 5 at every edge of the hull, and test 4 holds for a point o at an inner vertex if o is strictly
 * inside of all hull facets and a ray from o meets exactly one of them: then c(o) = 1. The ray goes to a vertex of the
 * hull, turned infinitesimally into one of its facets.
 * Where signs of 0 leave this open, or a hole grows large, all is built anew.
 *
 * Based on: de Castro, Tournois, Alliez, Devillers. Filtering relocations on a Delaunay triangulation. CGF 2009.
 *           Shewchuk. Star splaying: an algorithm for repairing Delaunay triangulations and convex hulls. SoCG 2005.
 * Differs from the paper: holes are filled, stars are not splayed. */
#include "base/memory.h"
#include "dynamic/live.h"
#include "triangulation/ring.h"
#include <string.h>

/* Bad facets whose repair takes as long as taking a point out and putting it in. Measured. */
static const double BAD_A_MOVE = 8;

/* Building anew is as fast as this share of what it is worth to repair: the test of all has still to come. Measured. */
static const double BEFORE_TESTS = 0.85;

typedef struct {
    brio_dynamic *d;
    const brio_record *before;     /* of each row */
    uint32_t *back;                /* rows that went back; those from `tested` on still have to be tested */
    brio_record *wish;             /* where each of them shall be */
    uint32_t *bad;                 /* facets that may be bad */
    uint32_t *mended;              /* rows that a repair might have lost */
    brio_slot_list open, infinite; /* tetrahedra that are not certainly sound; all that are infinite */
    bool mends, new_hull;          /* new_hull: repairs took infinite ones out */
    size_t num_back, tested, most_back, num_bad, bad_capacity, num_mended, mended_capacity;
} sweep;

static int side(brio_dynamic *d, uint32_t a, uint32_t b, uint32_t c, uint32_t e) {
    const brio_record *r = (const brio_record *)d->record;
    return brio_orient3d_sign(&d->filter, r[a], r[b], r[c], r[e]);
}

/* Puts one of these rows back to where it was, one that moved. */
static void put_back(sweep *s, const uint32_t *row, size_t count) {
    if (s->num_back > s->most_back) return;
    for (size_t i = 0; i < count; i++) {
        double *r = s->d->record[row[i]];
        if (row[i] == 0 || memcmp(r, s->before[row[i]], sizeof(brio_record)) == 0) continue;
        memcpy(s->wish[s->num_back], r, sizeof(brio_record));
        memcpy(r, s->before[row[i]], sizeof(brio_record));
        s->back[s->num_back++] = row[i];
        return;
    }
}

/* Returns whether the vertex behind a facet of a tetrahedron is in conflict with it. */
static bool is_bad(brio_dynamic *d, uint32_t facet) {
    const brio_record *r = (const brio_record *)d->record;
    uint32_t mate = *brio_mate(&d->t, facet);
    const uint32_t *v = d->t.tet[brio_tet_of(facet)].vertex, *w = d->t.tet[brio_tet_of(mate)].vertex;
    uint32_t apex = w[brio_slot_of(mate)];
    if (v[3] == 0 && w[3] == 0) return side(d, v[0], v[1], v[2], apex) > 0;
    if (v[3] == 0 || w[3] == 0) return false;
    return brio_conflict(&d->filter, r[v[0]], r[v[1]], r[v[2]], r[v[3]], r[apex], d->weighted);
}

/* Notes a facet that is bad. Where the hull is not convex, a row goes back instead; once repairs have begun no row
 * can, and all is built anew. */
static brio_status note_bad(sweep *s, uint32_t facet) {
    if (!is_bad(s->d, facet)) return BRIO_OK;
    uint32_t mate = *brio_mate(&s->d->t, facet);
    if (brio_is_infinite(&s->d->t, brio_tet_of(facet)) && brio_is_infinite(&s->d->t, brio_tet_of(mate))) {
        const uint32_t *v = s->d->t.tet[brio_tet_of(facet)].vertex;
        s->d->needs_anew |= s->mends;
        put_back(s, (uint32_t[4]){brio_apex(&s->d->t, mate), v[0], v[1], v[2]}, 4);
        return BRIO_OK;
    }
    BRIO_FORWARD(BRIO_RESERVE(s->d->ctx, s->bad, s->bad_capacity, s->num_bad + 1));
    s->bad[s->num_bad++] = facet;
    return BRIO_OK;
}

/* Returns whether a tetrahedron is infinite or positive; else a row goes back. */
static bool has_volume(sweep *s, uint32_t tet) {
    const uint32_t *v = s->d->t.tet[tet].vertex;
    if (v[3] == 0 || side(s->d, v[0], v[1], v[2], v[3]) > 0) return true;
    put_back(s, v, 4);
    return false;
}

static brio_status test_tetrahedron(sweep *s, uint32_t tet) {
    if (!has_volume(s, tet)) return BRIO_OK; /* its facets are tested when a row has gone back */
    for (int k = 0; k < 4; k++)
        if (brio_tet_of(s->d->t.tet[tet].mate[k]) > tet) BRIO_FORWARD(note_bad(s, brio_facet_of(tet, k)));
    return BRIO_OK;
}

/* Tests the star of a row that went back. */
static brio_status test_star(sweep *s, uint32_t row) {
    brio_dynamic *d = s->d;
    const brio_hole *h = &d->hole;
    brio_status status = brio_live_star(d, row);
    if (status == BRIO_OK) brio_slack_end(d);
    for (size_t i = 0; i < h->num_tets && status == BRIO_OK; i++) {
        if (!has_volume(s, h->tet[i])) continue;
        for (int k = 0; k < 4 && status == BRIO_OK; k++) status = note_bad(s, brio_facet_of(h->tet[i], k));
    }
    brio_hole_forget(d);
    return status;
}

/* Returns whether more is to be done than building anew takes. */
static bool is_hopeless(const sweep *s) {
    return (double)s->num_back + (double)s->num_bad / BAD_A_MOVE > (double)s->most_back;
}

/* Returns whether a sample of the tetrahedra says so. */
static bool looks_hopeless(sweep *s) {
    enum { SAMPLE = 1024 };
    brio_dynamic *d = s->d;
    size_t step = d->t.count / SAMPLE + 1, seen = 0, bad = 0;
    for (size_t slot = 0; slot < d->t.count; slot += step, seen++) {
        if ((double)d->until[slot] >= d->travelled || d->state[slot] & SLOT_UNUSED) continue;
        for (int k = 0; k < 4; k++) bad += is_bad(d, brio_facet_of((uint32_t)slot, k));
    }
    double all = (double)bad / 2 * (double)d->t.count / (double)(seen + 1); /* a facet is seen from two sides */
    return all / BAD_A_MOVE > BEFORE_TESTS * (double)s->most_back;
}

/* Tests these tetrahedra one by one. */
static brio_status test_listed(sweep *s, const brio_slot_list *list) {
    for (size_t i = 0; i < list->count && !is_hopeless(s); i++) {
        BRIO_FORWARD(test_tetrahedron(s, list->slot[i]));
        BRIO_FORWARD(brio_look(s->d->ctx, 1));
    }
    return BRIO_OK;
}

/* Tests all tetrahedra whose time is over. */
static brio_status test_all(sweep *s) {
    brio_dynamic *d = s->d;
    BRIO_FORWARD(brio_slack_test(d, &s->open, &s->infinite));
    BRIO_FORWARD(test_listed(s, &s->infinite));
    BRIO_FORWARD(test_listed(s, &s->open));
    while (s->tested < s->num_back && s->num_back <= s->most_back) {
        BRIO_FORWARD(test_star(s, s->back[s->tested++]));
        BRIO_FORWARD(brio_look(d->ctx, 16));
    }
    d->needs_anew = is_hopeless(s);
    return BRIO_OK;
}

/* --- repairs --- */

/* Adds a tetrahedron to the hole. */
static void join_hole(brio_dynamic *d, uint32_t tet) {
    if (brio_in_hole(d, tet)) return;
    d->state[tet] |= SLOT_HOLE;
    d->hole.tet[d->hole.num_tets++] = tet;
}

/* Lists the border of the hole. */
static void list_border(brio_dynamic *d) {
    brio_hole *h = &d->hole;
    h->num_border = 0;
    for (size_t i = 0; i < h->num_tets; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t mate = d->t.tet[h->tet[i]].mate[k];
            if (!brio_in_hole(d, brio_tet_of(mate))) h->border[h->num_border++] = mate;
        }
}

/* Lets the tetrahedra behind the facets of the border that the filling lacks join the hole; behind all, if it lacks
 * none. */
static brio_status grow(brio_dynamic *d) {
    brio_hole *h = &d->hole;
    size_t before = h->num_tets;
    BRIO_FORWARD(brio_hole_reserve(d, h->num_tets + h->num_border));
    for (size_t b = 0; b < h->num_border; b++)
        if (h->fresh[b] == 0) join_hole(d, brio_tet_of(h->border[b]));
    for (size_t b = 0; b < h->num_border && h->num_tets == before; b++) join_hole(d, brio_tet_of(h->border[b]));
    return BRIO_OK;
}

/* Repairs what is round a bad facet. */
static brio_status mend(sweep *s, uint32_t facet) {
    enum { MOST_TETS = 160 };
    brio_dynamic *d = s->d;
    brio_hole *h = &d->hole;
    bool mended = false;
    size_t infinite = 0;
    join_hole(d, brio_tet_of(facet));
    join_hole(d, brio_tet_of(*brio_mate(&d->t, facet)));
    for (;;) {
        list_border(d);
        BRIO_FORWARD(brio_hole_reserve_fresh(d, h->num_border));
        for (size_t b = 0; b < h->num_border; b++) h->fresh[b] = 1;
        infinite = 0;
        for (size_t i = 0; i < h->num_tets; i++) infinite += brio_is_infinite(&d->t, h->tet[i]);
        BRIO_FORWARD(brio_hole_mend(d, &mended));
        if (mended) break;
        BRIO_FORWARD(grow(d));
        d->needs_anew = h->num_tets > MOST_TETS;
        if (d->needs_anew) return BRIO_OK;
    }
    h->num_tets = 0;
    s->new_hull |= infinite > 0;
    BRIO_FORWARD(BRIO_RESERVE(d->ctx, s->mended, s->mended_capacity, s->num_mended + h->num_vertices));
    for (size_t i = 1; i < h->num_vertices; i++) s->mended[s->num_mended++] = h->vertex[i];
    for (size_t b = 0; b < h->num_border; b++) BRIO_FORWARD(note_bad(s, h->border[b]));
    return BRIO_OK;
}

static brio_status mend_all(sweep *s) {
    brio_dynamic *d = s->d;
    s->mends = true;
    while (s->num_bad > 0 && !d->needs_anew) {
        uint32_t facet = s->bad[--s->num_bad];
        if (d->state[brio_tet_of(facet)] & SLOT_UNUSED || !is_bad(d, facet)) continue;
        BRIO_FORWARD(mend(s, facet));
        BRIO_FORWARD(brio_look(d->ctx, 8));
    }
    return BRIO_OK;
}

/* --- the hull --- */

/* Returns whether the home of a vertex is infinite: then it is a vertex of the hull. */
static bool on_hull(const brio_dynamic *d, uint32_t row) {
    return brio_is_infinite(&d->t, d->home[row]);
}

/* Returns whether the ray from o to vertex v, turned into the hull facet (v, x, y), is outside of the cone of o and
 * the hull facet (a, b, c), which does not have v. */
static bool misses(brio_dynamic *d, uint32_t o, uint32_t v, const uint32_t *f) {
    for (int k = 0; k < 3; k++)
        if (side(d, o, f[k], f[(k + 1) % 3], v) < 0) return true;
    return false;
}

/* Returns whether that ray is outside of the cone of a hull facet (v, p, q). The facet (v, p, q) with p = x is the
 * one that it goes into. */
static bool misses_fan(brio_dynamic *d, uint32_t o, uint32_t v, const uint32_t *f, uint32_t x) {
    int k = f[0] == v ? 0 : f[1] == v ? 1 : 2;
    uint32_t p = f[(k + 1) % 3], q = f[(k + 2) % 3];
    if (q == x) return true;
    return side(d, o, v, p, x) < 0 || side(d, o, q, v, x) < 0;
}

/* Returns whether a ray from o, an inner vertex that is strictly inside of all hull facets, certainly meets just one
 * of them. A facet (a, b, c) of an infinite tetrahedron has o on its negative side, so (o, a, b, c) is positive: a
 * direction leaves the cone where an orientation (o, a, b, direction) is negative. */
static bool hull_is_sound(brio_dynamic *d, const brio_slot_list *infinite, uint32_t o) {
    uint32_t v = 0, x = 0;
    for (size_t i = 0; i < infinite->count; i++) {
        const uint32_t *f = d->t.tet[infinite->slot[i]].vertex;
        if (i == 0) v = f[0], x = f[1];
        if (side(d, f[0], f[1], f[2], o) >= 0) return false;
        if (i == 0) continue;
        bool fan = f[0] == v || f[1] == v || f[2] == v;
        if (!(fan ? misses_fan(d, o, v, f, x) : misses(d, o, v, f))) return false;
    }
    return infinite->count > 0;
}

/* Returns whether no repair has left out a vertex. */
static bool has_all_vertices(const sweep *s) {
    const brio_dynamic *d = s->d;
    for (size_t i = 0; i < s->num_mended; i++) {
        uint32_t r = s->mended[i], home = d->home[r];
        if (d->state[home] & SLOT_UNUSED || brio_slot_of_vertex(d->t.tet[home].vertex, r) > 3) return false;
    }
    return true;
}

/* Lists the infinite tetrahedra anew where repairs have changed them. */
static brio_status list_infinite(sweep *s) {
    brio_dynamic *d = s->d;
    brio_slot_list *l = &s->infinite;
    if (!s->new_hull) return BRIO_OK;
    l->count = 0;
    BRIO_FORWARD(BRIO_RESERVE(d->ctx, l->slot, l->capacity, d->counts.infinite));
    for (uint32_t slot = 0; slot < d->t.count; slot++)
        if (!(d->state[slot] & SLOT_UNUSED) && brio_is_infinite(&d->t, slot)) l->slot[l->count++] = slot;
    return BRIO_OK;
}

/* Returns whether the triangulation is that of its points, all facets having been tested. */
static bool is_sound(const sweep *s) {
    enum { TRIES = 8 };
    brio_dynamic *d = s->d;
    int tries = 0;
    if (!has_all_vertices(s)) return false;
    for (uint32_t r = (uint32_t)d->num_rows / 2; r < d->num_rows && tries < TRIES; r++) {
        if (brio_row_kind(d, r) != ROW_VERTEX || on_hull(d, r)) continue;
        if (hull_is_sound(d, &s->infinite, r)) return true;
        tries++;
    }
    return false;
}

/* --- all --- */

/* Moves one by one what went back: by the names that the rows have before, since points that meet exchange theirs
 * (place.c). */
static brio_status move_back_again(sweep *s) {
    brio_dynamic *d = s->d;
    for (size_t i = 0; i < s->num_back; i++) s->back[i] = d->row[s->back[i]].name;
    for (size_t i = 0; i < s->num_back; i++) {
        BRIO_FORWARD(brio_live_move(d, s->back[i], s->wish[i]));
        BRIO_FORWARD(brio_look(d->ctx, 4));
    }
    return BRIO_OK;
}

/* Exchanges the records of all rows and another array of them, which has room for no more. */
static void exchange(brio_dynamic *d, brio_record **record) {
    brio_record *other = *record;
    *record = d->record;
    d->record = other;
    d->t.record = other;
    d->row_capacity = d->num_rows;
}

/* Ends the time of the stars of rows that go further than the step, and lets time go on by that. */
static brio_status go_on(brio_dynamic *d, const brio_paths *paths) {
    if (!(paths->step < INFINITY)) brio_slack_end_all(d);
    if (!(paths->step < INFINITY)) return BRIO_OK;
    for (size_t i = 0; i < paths->num_fast; i++) {
        brio_status status = brio_live_star(d, paths->fast[i]);
        if (status == BRIO_OK) brio_slack_end(d);
        brio_hole_forget(d);
        BRIO_FORWARD(status);
        BRIO_FORWARD(brio_look(d->ctx, 8));
    }
    brio_slack_advance(d, paths->step);
    return BRIO_OK;
}

/* Tests and repairs; what is not proved then, or takes too long, needs all to be built anew. */
static brio_status repair(sweep *s, const brio_paths *paths) {
    brio_dynamic *d = s->d;
    BRIO_FORWARD(go_on(d, paths));
    d->needs_anew = looks_hopeless(s);
    if (!d->needs_anew) BRIO_FORWARD(test_all(s));
    if (!d->needs_anew) BRIO_FORWARD(mend_all(s));
    if (!d->needs_anew) BRIO_FORWARD(list_infinite(s));
    if (!d->needs_anew) d->needs_anew = !is_sound(s);
    return d->needs_anew ? BRIO_ERR_INTERNAL : BRIO_OK; /* the caller takes the change back and builds anew */
}

brio_status brio_live_move_many(brio_dynamic *d, brio_paths *paths, size_t most) {
    sweep s = {.d = d, .most_back = most};
    brio_status status = BRIO_OK;
    assert(d->counts.vertices == d->counts.alive);
    BRIO_TRY(BRIO_ALLOC(d->ctx, s.back, most + 1));
    BRIO_TRY(BRIO_ALLOC(d->ctx, s.wish, most + 1));
    exchange(d, &paths->record);
    s.before = (const brio_record *)paths->record;
    status = repair(&s, paths);
    if (status == BRIO_OK) status = move_back_again(&s);
    if (status == BRIO_OK) d->in_place += paths->moved - s.num_back;
    if (status != BRIO_OK) {
        status = brio_live_end(d, status); /* what moved one by one goes back first, then what moved together */
        bool anew = d->needs_anew;
        exchange(d, &paths->record);
        brio_slack_end_all(d);
        brio_live_begin(d);
        d->needs_anew = anew;
    }
done:
    brio_release(d->ctx, s.back);
    brio_release(d->ctx, s.wish);
    brio_release(d->ctx, s.bad);
    brio_release(d->ctx, s.mended);
    brio_release(d->ctx, s.open.slot);
    brio_release(d->ctx, s.infinite.slot);
    return status;
}
