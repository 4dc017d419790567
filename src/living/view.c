/* What is asked of a living triangulation in space that repeats: facts, points, neighbours, location, a snapshot, the
 * exact check.
 *
 * A snapshot finds the stars of the points in the triangulation that is there, as a fresh build finds them in the one
 * that it has made (periodic/stars.c). Single questions are answered from the stars themselves where their balls prove
 * them (W3). */
#include "base/float_state.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/versioned.h"
#include "living/living.h"
#include "periodic/translates.h"
#include "predicates/circumcentre.h"
#include <stdlib.h>
#include <string.h>

brio_status brio_dynamic_periodic_facts(const brio_dynamic_periodic *d, brio_dynamic_periodic_stats *stats) {
    BRIO_DOOR;
    BRIO_FORWARD(BRIO_CHECK_RESULT(d->ctx, brio_dynamic_periodic_stats, stats));
    const brio_lattice *l = &d->lattice;
    brio_dynamic_periodic_stats mine = {
        .size = sizeof mine,
        .indices = d->num_points,
        .points = d->alive,
        .translates = d->inner->counts.alive,
        .directions = l->rank,
        .dimension = d->inner->dimension,
        .cell_volume = l->volume,
        .cell_moved = l->moved,
        .moved = d->moved,
        .reach = d->reach,
        .in_place = d->in_place + d->inner->in_place,
        .replaced = d->replaced + d->inner->replaced,
        .anew = d->anew + d->inner->anew,
        .snapshots = d->snapshots,
    };
    for (int j = 0; j < l->rank; j++) memcpy(mine.cell + 3 * l->axis[j], l->used[j], sizeof l->used[j]);
    BRIO_GIVE(brio_dynamic_periodic_stats, stats, &mine);
    return BRIO_OK;
}

int brio_dynamic_periodic_point(const brio_dynamic_periodic *d, uint32_t index, double record[4]) {
    BRIO_DOOR;
    if (index >= d->num_points || d->point[index].first == BRIO_NONE) return 0;
    const brio_wrapped *w = &d->point[index];
    if (record) {
        brio_lattice_given(&d->lattice, w->x, w->shift, record);
        record[3] = w->weight;
    }
    return 1;
}

void brio_dynamic_periodic_points(const brio_dynamic_periodic *d, uint32_t *indices, double *points, double *weights) {
    BRIO_DOOR;
    size_t n = 0;
    for (size_t i = 0; i < d->num_points; i++) {
        const brio_wrapped *w = &d->point[i];
        if (w->first == BRIO_NONE) continue;
        if (indices) indices[n] = (uint32_t)i;
        if (points) brio_lattice_given(&d->lattice, w->x, w->shift, points + 3 * n);
        if (weights) weights[n] = w->weight;
        n++;
    }
}

/* --- snapshot --- */

typedef struct {
    brio_context *ctx;
    const brio_dynamic_periodic *d;
    double (*home)[3], *weight; /* of each place */
    uint32_t *index;
} shot;

static brio_status list_places(shot *s, int32_t (**shift)[3]) {
    const brio_dynamic_periodic *d = s->d;
    size_t n = 0;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->home, d->alive + 1));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->index, d->alive + 1));
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, *shift, d->alive + 1));
    if (d->weighted) BRIO_FORWARD(BRIO_ALLOC(s->ctx, s->weight, d->alive + 1));
    for (size_t i = 0; i < d->num_points; i++) {
        const brio_wrapped *w = &d->point[i];
        if (w->first == BRIO_NONE) continue;
        memcpy(s->home[n], w->x, sizeof *s->home);
        memcpy((*shift)[n], w->shift, sizeof **shift);
        if (s->weight) s->weight[n] = w->weight;
        s->index[n++] = (uint32_t)i;
    }
    return BRIO_OK;
}

/* Returns the inner name of a translate. */
static uint32_t name_of(const brio_dynamic_periodic *d, uint32_t point, const int32_t shift[3]) {
    for (uint32_t name = d->point[point].first; name != BRIO_NONE; name = d->kept[name].next) {
        const int8_t *s = d->kept[name].shift;
        if (s[0] == shift[0] && s[1] == shift[1] && s[2] == shift[2]) return name;
    }
    return BRIO_NONE;
}

/* Makes the triangulation of the images, which are all that are kept. */
static brio_status make_known(void *user, const brio_images *m, brio_triangulation **out) {
    const shot *s = user;
    const brio_dynamic *inner = s->d->inner;
    brio_live_points list = {m->x ? m->x[0] : NULL, m->weight, NULL, m->count};
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(s->ctx, list.name, m->count + 1));
    for (size_t i = 0; i < m->count; i++) {
        list.name[i] = name_of(s->d, s->index[m->list[i].point], m->list[i].shift);
        BRIO_REQUIRE(s->ctx, list.name[i] != BRIO_NONE, BRIO_ERR_INTERNAL, "a translate in the margin is missing");
    }
    BRIO_REQUIRE(s->ctx, m->count == inner->counts.alive, BRIO_ERR_INTERNAL, "%zu translates, of which %zu are kept",
                 m->count, inner->counts.alive);
    status = brio_live_snapshot(s->ctx, inner, &list, out);
done:
    brio_release(s->ctx, list.name);
    return status;
}

/* Takes a snapshot.   index  NULL, or receives the index of each place; the caller frees it. */
static brio_status take_snapshot(brio_context *ctx, const brio_dynamic_periodic *d, brio_periodic **out,
                                 uint32_t **index) {
    brio_periodic *t = NULL;
    brio_status status = BRIO_OK;
    shot s = {.ctx = ctx, .d = d};
    double start = brio_seconds();
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, t, 1));
    t->ctx = ctx;
    t->lattice = d->lattice;
    t->stats.moved = d->moved;
    BRIO_TRY(list_places(&s, &t->home));
    t->stays = true;
    for (size_t p = 0; p < d->alive; p++) t->stays &= !t->home[p][0] && !t->home[p][1] && !t->home[p][2];
    brio_stars_known known = {.make = make_known, .user = &s};
    memcpy(known.margin, d->margin, sizeof known.margin);
    brio_stars_task task = {.lattice = &t->lattice,
                            .home = (const double(*)[3])s.home,
                            .weights = s.weight,
                            .num_points = d->alive,
                            .halo = d->halo,
                            .seed = BRIO_SEED,
                            .known = d->alive ? &known : NULL};
    BRIO_TRY(brio_periodic_make(t, &task));
    t->images.lattice = &t->lattice;
    t->stats.seconds = brio_seconds() - start;
    *out = t;
    t = NULL;
    if (index) *index = s.index, s.index = NULL;
done:
    brio_periodic_free(t);
    brio_release(ctx, s.home);
    brio_release(ctx, s.weight);
    brio_release(ctx, s.index);
    return status;
}

brio_status brio_dynamic_periodic_snapshot(brio_context *ctx, const brio_dynamic_periodic *d, brio_periodic **out) {
    BRIO_DOOR;
    *out = NULL;
    return take_snapshot(ctx, d, out, NULL);
}

brio_status brio_dynamic_periodic_checksum(brio_context *ctx, const brio_dynamic_periodic *d, uint64_t *checksum) {
    BRIO_DOOR;
    brio_periodic *t = NULL;
    BRIO_FORWARD(take_snapshot(ctx, d, &t, NULL));
    brio_status status = brio_periodic_checksum(ctx, t, checksum);
    brio_periodic_free(t);
    return status;
}

/* Checks W1 and W2. */
static brio_status check_kept(brio_context *ctx, const brio_dynamic_periodic *d) {
    size_t count = 0, alive = 0;
    for (uint32_t i = 0; i < d->num_points; i++) {
        const brio_wrapped *w = &d->point[i];
        int32_t from[3], to[3], t[3];
        size_t own = 1;
        if (w->first == BRIO_NONE) continue;
        alive++;
        brio_stars_shifts(&d->lattice, d->margin, w->x, from, to);
        for (int k = 0; k < 3; k++) own *= (size_t)(to[k] - from[k] + 1);
        for (uint32_t name = w->first; name != BRIO_NONE; name = d->kept[name].next, own--, count++) {
            double record[4], x[3];
            bool inside = d->kept[name].point == i;
            for (int k = 0; k < 3; k++) {
                t[k] = d->kept[name].shift[k];
                inside &= from[k] <= t[k] && t[k] <= to[k];
            }
            brio_lattice_move(&d->lattice, w->x, t, x);
            BRIO_EXPECT(ctx, inside && name_of(d, i, t) == name, BRIO_ERR_CHECK,
                        "a translate of point %u should not be there", i);
            BRIO_EXPECT(ctx, brio_dynamic_point(d->inner, name, record) != BRIO_DYNAMIC_NONE, BRIO_ERR_CHECK,
                        "a translate of point %u is not there", i);
            BRIO_EXPECT(ctx, memcmp(record, x, sizeof x) == 0 && record[3] == w->weight, BRIO_ERR_CHECK,
                        "a translate of point %u is at another place", i);
        }
        BRIO_EXPECT(ctx, own == 0, BRIO_ERR_CHECK, "point %u lacks translates", i);
    }
    BRIO_EXPECT(ctx, alive == d->alive && count == d->inner->counts.alive, BRIO_ERR_CHECK,
                "%zu points and %zu translates are counted as %zu and %zu", alive, count, d->alive,
                d->inner->counts.alive);
    return BRIO_OK;
}

brio_status brio_dynamic_periodic_check(brio_context *ctx, const brio_dynamic_periodic *d) {
    BRIO_DOOR;
    brio_periodic *t = NULL;
    BRIO_FORWARD(check_kept(ctx, d));
    BRIO_FORWARD(brio_dynamic_check(ctx, d->inner));
    BRIO_FORWARD(take_snapshot(ctx, d, &t, NULL));
    brio_status status = brio_periodic_check(ctx, t);
    brio_periodic_free(t);
    return status;
}

/* --- what balls prove --- */

/* Returns whether the balls of these tetrahedra do not leave the margin (W3). */
static bool are_proven(const brio_dynamic_periodic *d, const uint32_t *tets, size_t count) {
    static const uint32_t OWN[1][4] = {{0, 1, 2, 3}};
    const brio_dynamic *inner = d->inner;
    if (brio_stars_has_all(&d->lattice, d->margin)) return true;
    brio_ball_box all = brio_translates_box(&d->lattice, inner->low, inner->high, inner->high[3]);
    for (size_t i = 0; i < count; i++) {
        brio_ball b = {.infinite = brio_is_infinite(&inner->t, tets[i])};
        double x[4][3], weight[4], error;
        if (b.infinite) return false;
        for (int k = 0; k < 4; k++) {
            memcpy(b.vertex[k], inner->record[inner->t.tet[tets[i]].vertex[k]], sizeof b.vertex[k]);
            memcpy(x[k], b.vertex[k], sizeof x[k]);
            weight[k] = b.vertex[k][3];
        }
        brio_centres(&(brio_centre_batch){x[0], d->weighted ? weight : NULL, OWN, 1}, b.centre, &error);
        brio_ball_set_square(&b, error, &all);
        if (brio_stars_leaves(&d->lattice, d->margin, inner->high[3], &b)) return false;
    }
    return true;
}

/* Lists the corners of tetrahedra of the snapshot by the places of their points. */
static brio_status list_stars(brio_dynamic_periodic *d) {
    const brio_periodic *t = d->snapshot;
    size_t corners = 4 * t->stats.tetrahedra;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(d->ctx, d->star_begin, d->alive + 2));
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, d->star, corners + 1));
    for (size_t i = 0; i < corners; i++) d->star_begin[t->shown[t->tet[i / 4].vertex[i % 4]].point + 2]++;
    for (size_t p = 0; p < d->alive; p++) d->star_begin[p + 2] += d->star_begin[p + 1];
    for (size_t i = 0; i < corners; i++)
        d->star[d->star_begin[t->shown[t->tet[i / 4].vertex[i % 4]].point + 1]++] = (uint32_t)i;
    return BRIO_OK;
}

/* Makes the snapshot for questions, where there is none. */
static brio_status need_snapshot(brio_dynamic_periodic *d) {
    brio_status status = BRIO_OK;
    if (d->snapshot) return BRIO_OK;
    BRIO_TRY(take_snapshot(d->ctx, d, &d->snapshot, &d->index));
    BRIO_TRY(brio_periodic_locator_new(d->ctx, d->snapshot, &d->locator));
    BRIO_TRY(BRIO_ALLOC(d->ctx, d->place, d->num_points + 1));
    for (uint32_t p = 0; p < d->alive; p++) d->place[d->index[p]] = p;
    BRIO_TRY(list_stars(d));
    d->snapshots++;
done:
    if (status != BRIO_OK) brio_wrapped_forget(d);
    return status;
}

/* --- questions --- */

/* Returns the translate that stands for the position of an inner vertex: that of least index of the heaviest there. */
static const brio_kept *standing_for(const brio_dynamic_periodic *d, uint32_t row) {
    const brio_dynamic *inner = d->inner;
    const brio_kept *best = &d->kept[inner->row[row].name];
    for (uint32_t r = inner->row[row].twins; r != BRIO_NONE; r = inner->row[r].next) {
        const brio_kept *k = &d->kept[inner->row[r].name];
        if (inner->record[r][3] == inner->record[row][3] && k->point < best->point) best = k;
    }
    return best;
}

/* Returns a translate as the caller sees it, where the caller's shift `from` counts as 0. */
static brio_image shown(const brio_dynamic_periodic *d, const brio_kept *k, const int64_t from[3]) {
    const brio_lattice *l = &d->lattice;
    brio_image out = {.point = k->point};
    for (int j = 0; j < l->rank; j++) {
        int64_t shift = d->point[k->point].shift[j] - from[j];
        for (int i = 0; i < l->rank; i++) shift += k->shift[i] * l->change[i][j];
        out.shift[l->axis[j]] = (int32_t)shift;
    }
    return out;
}

static brio_status list_one(brio_dynamic_periodic *d, size_t *count, const brio_image *image) {
    BRIO_FORWARD(BRIO_RESERVE(d->ctx, d->list, d->list_capacity, *count + 1));
    d->list[(*count)++] = *image;
    return BRIO_OK;
}

/* Lists the neighbours that the star shows, where it is proven. */
static brio_status list_from_star(brio_dynamic_periodic *d, uint32_t index, uint32_t row, bool *proven, size_t *count) {
    brio_dynamic *inner = d->inner;
    const brio_hole *h = &inner->hole;
    const int32_t *s = d->point[index].shift;
    const int64_t from[3] = {s[0], s[1], s[2]};
    brio_status status = brio_live_star(inner, row);
    if (status == BRIO_OK) {
        *proven = are_proven(d, h->tet, h->num_tets);
        if (*proven) brio_hole_number(inner);
        for (size_t i = 1; *proven && i < h->num_vertices && status == BRIO_OK; i++) {
            brio_image image = shown(d, standing_for(d, h->vertex[i]), from);
            status = list_one(d, count, &image);
        }
    }
    brio_hole_forget(inner);
    return status;
}

static int compare_images(const void *p, const void *q) {
    const brio_image *a = p, *b = q;
    if (a->point != b->point) return a->point < b->point ? -1 : 1;
    for (int k = 0; k < 3; k++)
        if (a->shift[k] != b->shift[k]) return a->shift[k] < b->shift[k] ? -1 : 1;
    return 0;
}

/* Lists those that the snapshot shows: other vertices of tetrahedra that have a translate of the point. */
static brio_status list_from_snapshot(brio_dynamic_periodic *d, uint32_t index, size_t *count) {
    const brio_periodic *t = d->snapshot;
    uint32_t place = d->place[index];
    size_t kept = 0;
    for (size_t i = 4 * d->star_begin[place]; i < 4 * d->star_begin[place + 1]; i++) {
        uint32_t corner = d->star[i / 4];
        const uint32_t *v = t->tet[corner / 4].vertex;
        const brio_image *own = &t->shown[v[corner % 4]], *other = &t->shown[v[i % 4]];
        if (corner % 4 == i % 4) continue;
        brio_image image = {.point = d->index[other->point]};
        for (int k = 0; k < 3; k++) image.shift[k] = other->shift[k] - own->shift[k];
        BRIO_FORWARD(list_one(d, count, &image));
    }
    if (*count) qsort(d->list, *count, sizeof *d->list, compare_images);
    for (size_t i = 0; i < *count; i++)
        if (i == 0 || compare_images(&d->list[i - 1], &d->list[i]) != 0) d->list[kept++] = d->list[i];
    *count = kept;
    return BRIO_OK;
}

brio_status brio_dynamic_periodic_neighbours(brio_dynamic_periodic *d, uint32_t index, const brio_image **neighbours,
                                             size_t *count) {
    BRIO_DOOR;
    brio_dynamic *inner = d->inner;
    bool proven = true;
    *neighbours = d->list;
    *count = 0;
    BRIO_EXPECT(d->ctx, brio_dynamic_periodic_point(d, index, NULL), BRIO_ERR_ARGUMENT, "there is no point %u", index);
    uint32_t row = inner->row_of[d->point[index].first];
    int kind = brio_row_kind(inner, row);
    if (inner->dimension == 3) {
        if (kind == ROW_HIDDEN) return BRIO_OK; /* what hides it is there in all of space */
        if (kind == ROW_TWIN) row = inner->home[row];
        if (standing_for(d, row)->point != index) return BRIO_OK;
        BRIO_FORWARD(list_from_star(d, index, row, &proven, count));
    }
    if (!proven || inner->dimension < 3) {
        BRIO_FORWARD(need_snapshot(d));
        BRIO_FORWARD(list_from_snapshot(d, index, count));
    }
    *neighbours = d->list;
    return BRIO_OK;
}

/* Locates a position by the snapshot. */
static brio_status locate_in_snapshot(brio_dynamic_periodic *d, const double *position, brio_image vertices[4]) {
    const brio_periodic *t = d->snapshot;
    brio_image found;
    BRIO_FORWARD(brio_periodic_locator_tetrahedra(d->ctx, d->locator, position, 1, &found));
    if (found.point == BRIO_INFINITE) return BRIO_OK;
    for (int k = 0; k < 4; k++) {
        vertices[k] = t->shown[t->tet[found.point].vertex[k]];
        vertices[k].point = d->index[vertices[k].point];
        for (int j = 0; j < 3; j++) vertices[k].shift[j] += found.shift[j];
    }
    return BRIO_OK;
}

brio_status brio_dynamic_periodic_locate(brio_dynamic_periodic *d, const double position[3], brio_image vertices[4]) {
    BRIO_DOOR;
    brio_dynamic *inner = d->inner;
    uint32_t name[4];
    brio_home h;
    for (int k = 0; k < 4; k++) vertices[k] = (brio_image){.point = BRIO_INFINITE};
    for (int k = 0; k < 3; k++)
        BRIO_EXPECT(d->ctx, isfinite(position[k]), BRIO_ERR_NOT_FINITE, "the position is not finite");
    BRIO_EXPECT(d->ctx, brio_lattice_home(&d->lattice, position, &h), BRIO_ERR_ARGUMENT,
                "the position is more than 2^26 cells away");
    if (d->alive == 0) return BRIO_OK;
    if (inner->dimension == 3) {
        BRIO_FORWARD(brio_dynamic_locate(inner, h.x, name));
        uint32_t tet = inner->walk.start; /* that it found */
        if (are_proven(d, &tet, 1)) {
            const int64_t from[3] = {h.shift[0], h.shift[1], h.shift[2]};
            for (int k = 0; k < 4 && name[0] != BRIO_INFINITE; k++)
                vertices[k] = shown(d, standing_for(d, inner->row_of[name[k]]), from);
            return BRIO_OK;
        }
    }
    BRIO_FORWARD(need_snapshot(d));
    return locate_in_snapshot(d, position, vertices);
}
