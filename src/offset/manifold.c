/* Labels of tetrahedra whose boundary is a manifold.
 *
 * Round a sample, tetrahedra are triangles on a sphere. The boundary is one fan at the sample exactly if the covered
 * tetrahedra of its star are one part, connected across facets, and the free ones are, too (by Jordan's theorem, see
 * reconstruct/cocone/manifold_stars.c). Where they are more, the surface touches itself: mostly between tetrahedra so
 * flat that rounding labels them, sometimes because the offset does.
 *
 * At such a sample a part takes the other label, or the tetrahedra of a path through the star do, from the part to
 * another one of its label. Of the moves that leave fewer parts too many, at all samples they touch, the one is made
 * that costs least; if none does, the one that costs least. A move costs, for each of its tetrahedra, the distance by
 * which its facets are on the wrong side of the offset then, and one error for each handle or component that it makes
 * or ends. A sample that had its turn PATIENCE times in vain is given up: its star is outside of the solid, for good.
 * So the work ends: the parts too many become fewer except in such turns, and stars are given up once.
 *
 * Samples have their turns in the order of their numbers, then those whose stars changed, and so on: no result depends
 * on threads. */
#include "offset/work.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* MOST: tetrahedra that change together. PATIENCE, MOST: chosen. */
enum { PATIENCE = 4, MOST = 256, NO_TET = UINT32_MAX, OUTSIDE_STAR = 0 };

static const double STEP = 0x1p-10; /* of the error: what a tetrahedron costs besides, so that few change; chosen */

/* The star of a sample, in parts that are connected across facets. */
typedef struct {
    uint32_t *tet;
    size_t size, capacity;
    uint32_t parts; /* numbered from 1 */
    int of[2];      /* free ones, covered ones */
} star;

typedef struct {
    uint32_t *tet;
    size_t size, capacity;
    double cost;
    int fewer; /* parts too many, than before */
} move;

typedef struct {
    brio_context *ctx;
    const brio_offset_labels *l;
    uint8_t outside;         /* BRIO_OFFSET_COVERED, or 0: the label of infinite tetrahedra */
    uint32_t *tet_of_sample; /* #P: NO_TET for points that are no vertices */
    uint32_t *part_of;       /* #T: part of each tetrahedron of the star at hand; OUTSIDE_STAR between collections */
    float (*height)[2];      /* #T: least and greatest of the facets, NAN: not known yet; NULL until one is asked for */
    uint8_t *fixed;          /* #T: the tetrahedron is outside for good */
    uint8_t *visits;         /* #P */
    uint8_t *waiting;        /* #P: 1 in the queue */
    uint32_t *queue;
    size_t size, queue_capacity;
    star at_hand, other; /* the star whose turn it is; a star that a move touches */
    double *path_cost;   /* of the star at hand, by place in it */
    uint32_t *path_from;
    uint8_t *path_done;
    size_t path_capacity[3];
    move trial, best;
    uint32_t *touched;
    size_t num_touched, touched_capacity;
} untier;

static unsigned label_of(const untier *u, size_t tet) {
    return u->l->label[tet] & BRIO_OFFSET_COVERED;
}

/* --- stars --- */

static void leave(untier *u, const star *s) {
    for (size_t i = 0; i < s->size; i++) u->part_of[s->tet[i]] = OUTSIDE_STAR;
}

/* Takes the tetrahedra that are connected with tetrahedron `first` of the star of v, and have its label. They follow
 * each other in the star. */
static brio_status flood(untier *u, uint32_t v, uint32_t first, star *s) {
    unsigned label = label_of(u, first);
    size_t next = s->size;
    s->of[label]++;
    s->parts++;
    BRIO_FORWARD(BRIO_RESERVE(u->ctx, s->tet, s->capacity, s->size + 1));
    s->tet[s->size++] = first;
    u->part_of[first] = s->parts;
    for (; next < s->size; next++) {
        const brio_tetrahedron *t = &u->l->tet[s->tet[next]];
        BRIO_FORWARD(BRIO_RESERVE(u->ctx, s->tet, s->capacity, s->size + 4));
        for (int i = 0; i < 4; i++) {
            uint32_t other = t->mate[i] / 4;
            if (t->vertex[i] == v || u->part_of[other] != OUTSIDE_STAR || label_of(u, other) != label) continue;
            u->part_of[other] = s->parts;
            s->tet[s->size++] = other;
        }
    }
    return BRIO_OK;
}

/* Collects the star of v with its parts. The marks of its tetrahedra stay until leave(). */
static brio_status collect(untier *u, uint32_t v, star *s) {
    s->size = s->parts = 0;
    s->of[0] = s->of[1] = 0;
    BRIO_FORWARD(flood(u, v, u->tet_of_sample[v], s));
    for (size_t n = 0; n < s->size; n++)
        for (int i = 0; i < 4; i++) {
            uint32_t other = u->l->tet[s->tet[n]].mate[i] / 4;
            if (u->l->tet[s->tet[n]].vertex[i] != v && u->part_of[other] == OUTSIDE_STAR)
                BRIO_FORWARD(flood(u, v, other, s));
        }
    return BRIO_OK;
}

/* Returns how many parts of a star are too many. */
static int surplus_of(const star *s) {
    return (s->of[0] > 1 ? s->of[0] - 1 : 0) + (s->of[1] > 1 ? s->of[1] - 1 : 0);
}

/* --- moves --- */

static bool is_movable(const untier *u, uint32_t tet) {
    return u->l->tet[tet].vertex[3] != BRIO_INFINITE && !u->fixed[tet];
}

/* Returns what a tetrahedron costs that takes the other label. */
static double cost_of(const untier *u, uint32_t tet) {
    float *h = u->height[tet];
    if (isnan(h[0])) {
        brio_offset_heights heights = brio_offset_heights_of(u->l->w, u->l->tet[tet].vertex);
        h[0] = (float)heights.least;
        h[1] = (float)heights.greatest;
    }
    return STEP * u->l->w->error + (label_of(u, tet) ? -(double)h[0] : (double)h[1]);
}

static brio_status add_to_move(untier *u, move *m, uint32_t tet) {
    BRIO_FORWARD(BRIO_RESERVE(u->ctx, m->tet, m->capacity, m->size + 1));
    m->tet[m->size++] = tet;
    m->cost += cost_of(u, tet);
    return BRIO_OK;
}

/* Fills the trial with the tetrahedra of a part; leaves it empty if they are too many, or one of them cannot change. */
static brio_status take_part(untier *u, uint32_t part) {
    for (size_t i = 0; i < u->at_hand.size; i++) {
        uint32_t tet = u->at_hand.tet[i];
        if (u->part_of[tet] != part) continue;
        if (!is_movable(u, tet) || u->trial.size == MOST) return u->trial.size = 0, BRIO_OK;
        BRIO_FORWARD(add_to_move(u, &u->trial, tet));
    }
    return BRIO_OK;
}

/* Returns the place in the star of what is nearest to the beginning and not done, or the star's size. */
static size_t nearest_open(const untier *u) {
    size_t best = u->at_hand.size;
    for (size_t i = 0; i < u->at_hand.size; i++)
        if (!u->path_done[i] && u->path_cost[i] < (best < u->at_hand.size ? u->path_cost[best] : INFINITY)) best = i;
    return best;
}

static size_t place_in_star(const star *s, uint32_t tet) {
    size_t i = 0;
    while (s->tet[i] != tet) i++;
    return i;
}

/* Fills the trial with the tetrahedra of the path of least cost from a part of the star of v to another part of its
 * label; leaves it empty if there is none [Dijkstra 1959]. */
static brio_status take_path(untier *u, uint32_t v, uint32_t part, unsigned label) {
    const star *s = &u->at_hand;
    size_t end;
    BRIO_FORWARD(BRIO_RESERVE(u->ctx, u->path_cost, u->path_capacity[0], s->size));
    BRIO_FORWARD(BRIO_RESERVE(u->ctx, u->path_from, u->path_capacity[1], s->size));
    BRIO_FORWARD(BRIO_RESERVE(u->ctx, u->path_done, u->path_capacity[2], s->size));
    for (size_t i = 0; i < s->size; i++) {
        u->path_cost[i] = u->part_of[s->tet[i]] == part ? 0 : INFINITY;
        u->path_from[i] = NO_TET;
        u->path_done[i] = false;
    }
    while ((end = nearest_open(u)) < s->size) {
        uint32_t at = s->tet[end];
        if (label_of(u, at) == label && u->part_of[at] != part) break;
        u->path_done[end] = true;
        for (int i = 0; i < 4; i++) {
            uint32_t other = u->l->tet[at].mate[i] / 4;
            bool there = label_of(u, other) == label;
            if (u->l->tet[at].vertex[i] == v || u->part_of[other] == part || (!there && !is_movable(u, other)))
                continue;
            size_t j = place_in_star(s, other);
            double cost = u->path_cost[end] + (there ? 0 : cost_of(u, other));
            if (!u->path_done[j] && cost < u->path_cost[j]) u->path_cost[j] = cost, u->path_from[j] = (uint32_t)end;
        }
    }
    for (uint32_t i = end < s->size ? u->path_from[end] : NO_TET; i != NO_TET; i = u->path_from[i])
        if (label_of(u, s->tet[i]) != label) BRIO_FORWARD(add_to_move(u, &u->trial, s->tet[i]));
    return BRIO_OK;
}

/* Changes the labels of a move, and returns by how much the facets of the boundary become more. */
static int make(const untier *u, const move *m) {
    int more = 0;
    for (size_t i = 0; i < m->size; i++) {
        for (int f = 0; f < 4; f++)
            more += label_of(u, u->l->tet[m->tet[i]].mate[f] / 4) == label_of(u, m->tet[i]) ? 1 : -1;
        u->l->label[m->tet[i]] ^= BRIO_OFFSET_COVERED;
    }
    return more;
}

static brio_status list_touched(untier *u, const move *m) {
    u->num_touched = 0;
    for (size_t i = 0; i < m->size; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t v = u->l->tet[m->tet[i]].vertex[k];
            size_t n = 0;
            while (n < u->num_touched && u->touched[n] != v) n++;
            if (n < u->num_touched) continue;
            BRIO_FORWARD(BRIO_RESERVE(u->ctx, u->touched, u->touched_capacity, n + 1));
            u->touched[u->num_touched++] = v;
        }
    return BRIO_OK;
}

/* Adds up, over the touched samples, the parts too many and the fans of the boundary. */
static brio_status count(untier *u, int *surplus, int *fans) {
    *surplus = *fans = 0;
    for (size_t i = 0; i < u->num_touched; i++) {
        BRIO_FORWARD(collect(u, u->touched[i], &u->other));
        leave(u, &u->other);
        *surplus += surplus_of(&u->other);
        *fans += (int)u->other.parts - 1;
    }
    return BRIO_OK;
}

/* Weighs the trial, and keeps it if it is better than the best so far. */
static brio_status weigh(untier *u) {
    int before, after, fans_before, fans_after;
    if (!u->trial.size) return BRIO_OK;
    BRIO_FORWARD(list_touched(u, &u->trial));
    BRIO_FORWARD(count(u, &before, &fans_before));
    int faces = make(u, &u->trial);
    brio_status status = count(u, &after, &fans_after);
    make(u, &u->trial);
    BRIO_FORWARD(status);
    u->trial.fewer = before - after;
    /* Euler's characteristic is the number of fans less half the number of facets. */
    u->trial.cost += u->l->w->error * abs(2 * (fans_after - fans_before) - faces) / 4;
    bool helps = u->trial.fewer > 0, helped = u->best.fewer > 0;
    if (!u->best.size || (helps == helped ? u->trial.cost < u->best.cost : helps)) {
        move swap = u->best;
        u->best = u->trial;
        u->trial = swap;
    }
    return BRIO_OK;
}

/* --- one sample --- */

static brio_status enqueue(untier *u, uint32_t v) {
    if (u->waiting[v]) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(u->ctx, u->queue, u->queue_capacity, u->size + 1));
    u->queue[u->size++] = v;
    u->waiting[v] = 1;
    return BRIO_OK;
}

static brio_status relabel(untier *u, uint32_t tet) {
    u->l->label[tet] ^= BRIO_OFFSET_COVERED;
    for (int k = 0; k < 4; k++) BRIO_FORWARD(enqueue(u, u->l->tet[tet].vertex[k]));
    return BRIO_OK;
}

/* Weighs what can be done about each part of the star at hand whose label has several. */
static brio_status weigh_all(untier *u, uint32_t v) {
    star *s = &u->at_hand;
    u->best.size = 0;
    for (uint32_t part = 1; part <= s->parts; part++)
        for (int by_path = 0; by_path < 2; by_path++) {
            size_t first = 0;
            BRIO_FORWARD(collect(u, v, s));
            while (u->part_of[s->tet[first]] != part) first++;
            unsigned label = label_of(u, s->tet[first]);
            u->trial.size = 0;
            u->trial.cost = 0;
            if (s->of[label] > 1) BRIO_FORWARD(by_path ? take_path(u, v, part, label) : take_part(u, part));
            leave(u, s);
            BRIO_FORWARD(weigh(u));
        }
    return BRIO_OK;
}

/* Lets the star of a sample be outside, for good. */
static brio_status give_up(untier *u) {
    for (size_t i = 0; i < u->at_hand.size; i++) {
        uint32_t tet = u->at_hand.tet[i];
        u->fixed[tet] = 1;
        if (label_of(u, tet) != u->outside) BRIO_FORWARD(relabel(u, tet));
    }
    return BRIO_OK;
}

/* Makes the best move at a sample, again and again, until the star has a part of each label at most. */
static brio_status untie_star(untier *u, uint32_t v) {
    for (;;) {
        BRIO_FORWARD(collect(u, v, &u->at_hand));
        leave(u, &u->at_hand);
        if (!surplus_of(&u->at_hand)) return BRIO_OK;
        BRIO_FORWARD(weigh_all(u, v));
        if (!u->best.size || (u->best.fewer <= 0 && ++u->visits[v] > PATIENCE)) return give_up(u);
        for (size_t i = 0; i < u->best.size; i++) BRIO_FORWARD(relabel(u, u->best.tet[i]));
    }
}

/* --- all --- */

/* Queues the samples whose stars have parts too many. */
static brio_status enqueue_all(untier *u) {
    for (size_t i = 0; i < u->l->count; i++)
        for (int k = 0; k < 4; k++)
            if (u->l->tet[i].vertex[k] != BRIO_INFINITE) u->tet_of_sample[u->l->tet[i].vertex[k]] = (uint32_t)i;
    for (uint32_t v = 0; v < u->l->w->num_points; v++) {
        if (u->tet_of_sample[v] == NO_TET) continue;
        BRIO_FORWARD(collect(u, v, &u->at_hand));
        leave(u, &u->at_hand);
        if (surplus_of(&u->at_hand)) BRIO_FORWARD(enqueue(u, v));
    }
    return BRIO_OK;
}

static brio_status untie_all(untier *u) {
    BRIO_FORWARD(BRIO_ALLOC(u->ctx, u->height, u->l->count));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(u->ctx, u->fixed, u->l->count));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(u->ctx, u->visits, u->l->w->num_points));
    for (size_t i = 0; i < u->l->count; i++) u->height[i][0] = NAN;
    for (size_t n = 0; n < u->size; n++) {
        uint32_t v = u->queue[n];
        u->waiting[v] = 0;
        BRIO_FORWARD(untie_star(u, v));
    }
    return BRIO_OK;
}

brio_status brio_offset_untie(const brio_offset_labels *l) {
    brio_status status = BRIO_OK;
    brio_context *ctx = l->w->ctx;
    untier u = {.ctx = ctx, .l = l, .outside = l->w->field.inwards ? BRIO_OFFSET_COVERED : 0};
    BRIO_TRY(BRIO_ALLOC(ctx, u.tet_of_sample, l->w->num_points));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, u.part_of, l->count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, u.waiting, l->w->num_points));
    memset(u.tet_of_sample, 0xff, l->w->num_points * sizeof *u.tet_of_sample);
    BRIO_TRY(enqueue_all(&u));
    if (u.size) BRIO_TRY(untie_all(&u));
done:
    brio_release(ctx, u.tet_of_sample);
    brio_release(ctx, u.part_of);
    brio_release(ctx, u.height);
    brio_release(ctx, u.fixed);
    brio_release(ctx, u.visits);
    brio_release(ctx, u.waiting);
    brio_release(ctx, u.queue);
    brio_release(ctx, u.at_hand.tet);
    brio_release(ctx, u.other.tet);
    brio_release(ctx, u.path_cost);
    brio_release(ctx, u.path_from);
    brio_release(ctx, u.path_done);
    brio_release(ctx, u.trial.tet);
    brio_release(ctx, u.best.tet);
    brio_release(ctx, u.touched);
    return status;
}
