/* Changes of points as changes of their translates.
 *
 * Where a point moves, its new translates are those of its new position. Each old one goes to the nearest new one,
 * which it reaches by the same short way as the point, also where the point itself comes to the domain's other side.
 * Those that enter or leave the margin are inserted or removed. All is one change of the inner triangulation, so it
 * happens as a whole or not at all. What says which point is which is written after it, and cannot fail.
 *
 * Where the number of points has doubled or halved, margin and inner triangulation are made anew. */
#include "base/memory.h"
#include "living/living.h"
#include <string.h>

/* What a change of the inner triangulation will be. */
typedef struct {
    brio_dynamic_periodic *d;
    uint32_t *removed;
    size_t num_removed, removed_capacity;
    uint32_t *moved; /* inner names; where they go, with which weight, and what they are then */
    double (*to)[3], *weight;
    brio_kept *as;
    size_t num_moved, moved_capacity, to_capacity, weight_capacity, as_capacity;
    double (*in)[3], *in_weight; /* those that come */
    brio_kept *in_as;
    size_t num_in, in_capacity, in_weight_capacity, in_as_capacity;
} plan;

static void plan_free(plan *p) {
    void *blocks[] = {p->removed, p->moved, p->to, p->weight, p->as, p->in, p->in_weight, p->in_as};
    for (size_t i = 0; i < sizeof blocks / sizeof *blocks; i++) brio_release(p->d->ctx, blocks[i]);
}

static brio_kept kept_as(uint32_t point, const int32_t shift[3]) {
    return (brio_kept){point, BRIO_NONE, {(int8_t)shift[0], (int8_t)shift[1], (int8_t)shift[2]}};
}

static brio_status remove_one(plan *p, uint32_t name) {
    BRIO_FORWARD(BRIO_RESERVE(p->d->ctx, p->removed, p->removed_capacity, p->num_removed + 1));
    p->removed[p->num_removed++] = name;
    return BRIO_OK;
}

static brio_status move_one(plan *p, uint32_t name, const brio_wrapped *to, uint32_t point, const int32_t shift[3]) {
    brio_context *ctx = p->d->ctx;
    size_t n = p->num_moved;
    BRIO_FORWARD(BRIO_RESERVE(ctx, p->moved, p->moved_capacity, n + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, p->to, p->to_capacity, n + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, p->weight, p->weight_capacity, n + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, p->as, p->as_capacity, n + 1));
    p->moved[n] = name;
    brio_lattice_move(&p->d->lattice, to->x, shift, p->to[n]);
    p->weight[n] = to->weight;
    p->as[n] = kept_as(point, shift);
    p->num_moved++;
    return BRIO_OK;
}

static brio_status insert_one(plan *p, const brio_wrapped *at, uint32_t point, const int32_t shift[3]) {
    brio_context *ctx = p->d->ctx;
    size_t n = p->num_in;
    BRIO_FORWARD(BRIO_RESERVE(ctx, p->in, p->in_capacity, n + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, p->in_weight, p->in_weight_capacity, n + 1));
    BRIO_FORWARD(BRIO_RESERVE(ctx, p->in_as, p->in_as_capacity, n + 1));
    brio_lattice_move(&p->d->lattice, at->x, shift, p->in[n]);
    p->in_weight[n] = at->weight;
    p->in_as[n] = kept_as(point, shift);
    p->num_in++;
    return BRIO_OK;
}

/* A box of shifts. */
typedef struct {
    int32_t from[3], to[3];
} shifts;

static shifts shifts_of(const brio_dynamic_periodic *d, const double *x) {
    shifts s;
    brio_stars_shifts(&d->lattice, d->margin, x, s.from, s.to);
    return s;
}

static bool has(const shifts *s, const int32_t t[3]) {
    for (int i = 0; i < 3; i++)
        if (t[i] < s->from[i] || t[i] > s->to[i]) return false;
    return true;
}

/* Goes to the next shift of a box; false after the last one. */
static bool next(const shifts *s, int32_t t[3]) {
    for (int i = 2; i >= 0; i--) {
        if (++t[i] <= s->to[i]) return true;
        t[i] = s->from[i];
    }
    return false;
}

static brio_status plan_insertion(plan *p, uint32_t index, const brio_wrapped *to) {
    shifts all = shifts_of(p->d, to->x);
    int32_t t[3];
    memcpy(t, all.from, sizeof t);
    do BRIO_FORWARD(insert_one(p, to, index, t));
    while (next(&all, t));
    return BRIO_OK;
}

static brio_status plan_removal(plan *p, uint32_t index) {
    const brio_dynamic_periodic *d = p->d;
    for (uint32_t name = d->point[index].first; name != BRIO_NONE; name = d->kept[name].next)
        BRIO_FORWARD(remove_one(p, name));
    return BRIO_OK;
}

static brio_status plan_move(plan *p, uint32_t index, const brio_wrapped *to) {
    const brio_dynamic_periodic *d = p->d;
    const brio_wrapped *old = &d->point[index];
    shifts before = shifts_of(d, old->x), after = shifts_of(d, to->x);
    int32_t off[3] = {0, 0, 0}, t[3]; /* off: the new place in the domain, moved by this, is near the old one */
    double way[3];
    for (int k = 0; k < 3; k++) way[k] = old->x[k] - to->x[k];
    for (int i = 0; i < d->lattice.rank; i++) off[i] = (int32_t)rint(brio_lattice_share(&d->lattice, i, way));
    for (uint32_t name = old->first; name != BRIO_NONE; name = d->kept[name].next) {
        for (int i = 0; i < 3; i++) t[i] = d->kept[name].shift[i] + off[i];
        BRIO_FORWARD(has(&after, t) ? move_one(p, name, to, index, t) : remove_one(p, name));
    }
    memcpy(t, after.from, sizeof t);
    do {
        int32_t from[3] = {t[0] - off[0], t[1] - off[1], t[2] - off[2]};
        if (!has(&before, from)) BRIO_FORWARD(insert_one(p, to, index, t));
    } while (next(&after, t));
    return BRIO_OK;
}

/* Returns whether nothing changes for the translates of a point. */
static bool stays(const brio_dynamic_periodic *d, const brio_edit *e) {
    if (e->gone || e->index >= d->num_points) return false;
    const brio_wrapped *old = &d->point[e->index];
    return memcmp(old->x, e->to.x, sizeof old->x) == 0 && old->weight == e->to.weight;
}

static brio_status plan_all(plan *p, const brio_edit *edit, size_t count) {
    for (size_t i = 0; i < count; i++) {
        const brio_edit *e = &edit[i];
        if (e->gone)
            BRIO_FORWARD(plan_removal(p, e->index));
        else if (e->index >= p->d->num_points)
            BRIO_FORWARD(plan_insertion(p, e->index, &e->to));
        else if (!stays(p->d, e))
            BRIO_FORWARD(plan_move(p, e->index, &e->to));
        BRIO_FORWARD(brio_look(p->d->ctx, 1));
    }
    return BRIO_OK;
}

/* Puts a translate into the list of its point. Those with shift 0 come last, so that they are first in the end. */
static void link_kept(brio_dynamic_periodic *d, uint32_t name, const brio_kept *as, bool home) {
    if (home != (as->shift[0] == 0 && as->shift[1] == 0 && as->shift[2] == 0)) return;
    d->kept[name] = *as;
    d->kept[name].next = d->point[as->point].first;
    d->point[as->point].first = name;
}

/* Writes what the points are after a change. Room was reserved. */
static void commit(plan *p, const brio_edit *edit, size_t count, uint32_t first_name) {
    brio_dynamic_periodic *d = p->d;
    for (size_t i = 0; i < count; i++) {
        brio_wrapped *w = &d->point[edit[i].index];
        uint32_t first = stays(d, &edit[i]) ? w->first : BRIO_NONE;
        if (!edit[i].gone) *w = edit[i].to;
        w->first = first;
    }
    for (int home = 0; home < 2; home++) {
        for (size_t i = 0; i < p->num_moved; i++) link_kept(d, p->moved[i], &p->as[i], home);
        for (size_t i = 0; i < p->num_in; i++) link_kept(d, first_name + (uint32_t)i, &p->in_as[i], home);
    }
}

/* Gives inner points new names, where many names are those of points that went. A failure is none: they stay. */
static void renumber(brio_dynamic_periodic *d) {
    enum { WASTE = 4096 };
    uint32_t *now = NULL;
    size_t names = d->inner->num_names;
    if (names < 2 * d->inner->counts.alive + WASTE) return;
    if (BRIO_ALLOC(d->ctx, now, names) != BRIO_OK) return;
    brio_live_renumber(d->inner, now);
    for (size_t i = 0; i < names; i++) { /* new names are not greater */
        if (now[i] == BRIO_NONE) continue;
        brio_kept k = d->kept[i];
        if (k.next != BRIO_NONE) k.next = now[k.next];
        d->kept[now[i]] = k;
    }
    for (size_t i = 0; i < d->num_points; i++)
        if (d->point[i].first != BRIO_NONE) d->point[i].first = now[d->point[i].first];
    brio_release(d->ctx, now);
}

static brio_status change(brio_dynamic_periodic *d, const brio_edit *edit, size_t count, size_t num_points) {
    plan p = {.d = d};
    brio_status status = BRIO_OK;
    renumber(d);
    uint32_t first_name = (uint32_t)d->inner->num_names;
    BRIO_TRY(plan_all(&p, edit, count));
    BRIO_TRY(BRIO_RESERVE(d->ctx, d->kept, d->kept_capacity, d->inner->num_names + p.num_in));
    BRIO_TRY(BRIO_RESERVE(d->ctx, d->point, d->point_capacity, num_points));
    if (p.num_removed + p.num_moved + p.num_in > 0) {
        brio_live_changes c = {.moved = {p.moved, p.to ? p.to[0] : NULL, d->weighted ? p.weight : NULL, p.num_moved},
                               .removed = p.removed,
                               .num_removed = p.num_removed,
                               .points = p.in ? p.in[0] : NULL,
                               .weights = d->weighted ? p.in_weight : NULL,
                               .num_inserted = p.num_in};
        BRIO_TRY(brio_live_change(d->inner, &c));
    }
    for (size_t i = d->num_points; i < num_points; i++) d->point[i].first = BRIO_NONE;
    commit(&p, edit, count, first_name);
done:
    plan_free(&p);
    return status;
}

/* --- margin and inner triangulation, anew --- */

/* Chooses the margin for the points of d, which is new. */
static brio_status choose_margin(brio_dynamic_periodic *d) {
    double(*home)[3] = NULL;
    size_t n = 0;
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, home, d->alive + 1));
    for (size_t i = 0; i < d->num_points; i++)
        if (d->point[i].first != BRIO_NONE) memcpy(home[n++], d->point[i].x, sizeof *home);
    brio_stars_margin(
        &(brio_stars_task){.lattice = &d->lattice, .home = (const double(*)[3])home, .num_points = n, .halo = d->halo},
        d->margin);
    d->margin_for = n;
    brio_release(d->ctx, home);
    return BRIO_OK;
}

/* Makes the inner triangulation of the points of d, whose `first` is other than BRIO_NONE where there is one. */
static brio_status build(brio_dynamic_periodic *d) {
    plan p = {.d = d};
    brio_status status = BRIO_OK;
    BRIO_TRY(choose_margin(d));
    for (uint32_t i = 0; i < d->num_points; i++) {
        if (d->point[i].first == BRIO_NONE) continue;
        BRIO_TRY(plan_insertion(&p, i, &d->point[i]));
        d->point[i].first = BRIO_NONE;
        BRIO_TRY(brio_look(d->ctx, 1));
    }
    BRIO_TRY(BRIO_RESERVE(d->ctx, d->kept, d->kept_capacity, p.num_in));
    BRIO_TRY(brio_dynamic_new(d->ctx, p.in ? p.in[0] : NULL, d->weighted ? p.in_weight : NULL, p.num_in, d->weighted,
                              &d->inner));
    commit(&p, NULL, 0, 0);
done:
    plan_free(&p);
    return status;
}

static brio_status change_anew(brio_dynamic_periodic *d, const brio_edit *edit, size_t count, size_t num_points,
                               size_t alive) {
    brio_dynamic_periodic made = *d, old;
    brio_status status = BRIO_OK;
    made.point = NULL, made.kept = NULL, made.inner = NULL;
    made.point_capacity = made.kept_capacity = 0;
    made.num_points = num_points, made.alive = alive;
    BRIO_TRY(BRIO_RESERVE(d->ctx, made.point, made.point_capacity, num_points + 1));
    if (d->num_points) memcpy(made.point, d->point, d->num_points * sizeof *made.point);
    for (size_t i = 0; i < count; i++) {
        brio_wrapped *w = &made.point[edit[i].index];
        if (!edit[i].gone) *w = edit[i].to;
        w->first = edit[i].gone ? BRIO_NONE : 0;
    }
    BRIO_TRY(build(&made));
    if (d->inner) {
        made.in_place += d->inner->in_place;
        made.replaced += d->inner->replaced;
        made.anew += d->inner->anew + 1;
    }
    old = *d, *d = made, made = old;
done:
    brio_wrapped_clear(&made);
    return status;
}

brio_status brio_wrapped_apply(brio_dynamic_periodic *d, const brio_edit *edit, size_t count, size_t num_points,
                               size_t alive) {
    bool outdated = !d->inner || alive > 2 * d->margin_for || 2 * alive < d->margin_for;
    BRIO_EXPECT(d->ctx, num_points < UINT32_MAX / 2, BRIO_ERR_TOO_LARGE, "more than 2^31 - 1 points");
    BRIO_FORWARD(outdated ? change_anew(d, edit, count, num_points, alive) : change(d, edit, count, num_points));
    brio_wrapped_forget(d);
    d->num_points = num_points;
    d->alive = alive;
    return BRIO_OK;
}
