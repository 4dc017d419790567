/* Completion: see completion.h; docs/decisions/017-tiles.md proves it.
 *
 * A round triangulates some points. Each tetrahedron at an own point whose star is not final yet is judged: it is
 * final if it was asked for in an earlier round and is still there, or if its ball lies in the home box, where all
 * points are own ones. The source is asked for the others. A star is final when all its tetrahedra are. The next
 * round triangulates the points whose stars are not final, the vertices of these stars, and what the source found.
 * Other known points may be left out: the star of a point in a triangulation is the lower side of the cone from the
 * lifted point over the others, so points that are not in the star stay outside it, whatever is added.
 *
 * Rounds end, for each adds points of a finite set. What a round found is ordered by names, so that the order in which
 * answers came has no trace.
 *
 * Based on: Peterka, Morozov, Phillips. High-performance computation of distributed-memory parallel 3D Voronoi and
 *           Delaunay tessellation. SC 2014 (neighbours are asked until balls are known).
 *           Funke, Sanders. Parallel d-D Delaunay triangulations in shared and distributed memory. ALENEX 2017.
 * Differs from the papers: what is asked for is points in conflict, a bounded number at a time, with exact ties and
 * weights; half-spaces are asked for, too; later rounds triangulate the borders only. */
#include "completion/completion.h"
#include "base/finite.h"
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "completion/known.h"
#include "predicates/circumcentre.h"
#include "triangulation/triangulation.h"
#include <assert.h>
#include <string.h>

enum {
    SLAB = 1 << 17, /* tetrahedra looked at before some are handed on */
    TETS_A_THREAD = 1 << 12,
    POINTS_A_THREAD = 1 << 14,
    BALLS_A_THREAD = 1 << 8
};

enum { STAR_OPEN, STAR_FINAL, NO_VERTEX }; /* of an own point */
enum { OPEN = 1, ENDS = 2 };               /* of a star, in a round: ENDS that is final at its end */

struct brio_completion {
    brio_context *ctx;
    brio_completion_task task;
    brio_completion_stats stats;
    brio_bar bar;
    brio_set_point *known; /* own points first */
    size_t num_known, capacity;
    brio_names_met names;
    bool in_sequence; /* names of own points follow each other, and are not in `names` */
    uint8_t *state;   /* of each own point */
    size_t num_open;  /* own points whose state is STAR_OPEN */
    brio_tet_set asked, next_asked;
    /* of the round */
    uint32_t *local; /* of each point that is triangulated, its index among the known ones */
    size_t num_local, local_capacity;
    double *points, *weights;
    size_t points_capacity, weights_capacity;
    brio_triangulation *t;
    const brio_tetrahedron *tet;
    size_t num_tets;
    uint8_t *open;      /* of each local point: OPEN or ENDS if it is an own point whose star is open, else 0 */
    uint8_t *not_final; /* of each local point: 1 if a tetrahedron at it is not final */
    uint8_t *to_ask;    /* of each tetrahedron: 1 if it is asked for and not known to be free of conflicts */
    uint8_t *stays;     /* of each tetrahedron: 1 if it is at a star that stays open */
    uint32_t *question; /* the tetrahedron of each */
    size_t num_questions, question_capacity, known_before;
};

typedef brio_completion completion;

/* --- a round's triangulation --- */

static void end_round(completion *c) {
    brio_triangulation_free(c->t);
    brio_release(c->ctx, c->open);
    brio_release(c->ctx, c->not_final);
    brio_release(c->ctx, c->to_ask);
    brio_release(c->ctx, c->stays);
    c->t = NULL;
    c->open = c->not_final = c->to_ask = c->stays = NULL;
}

static void gather_some(void *user, size_t begin, size_t end, int thread) {
    completion *c = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        const double *r = c->known[c->local[i]].record;
        memcpy(c->points + 3 * i, r, 3 * sizeof *r);
        if (c->task.weighted) c->weights[i] = r[3];
    }
}

static brio_status gather(completion *c) {
    size_t n = c->num_local;
    BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->points, c->points_capacity, 3 * n + 1));
    if (c->task.weighted) BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->weights, c->weights_capacity, n + 1));
    return brio_for(c->ctx, brio_threads(c->ctx, n, POINTS_A_THREAD), n, gather_some, c);
}

static brio_status triangulate(completion *c) {
    brio_completion_stats *s = &c->stats;
    brio_delaunay_options o = {.size = sizeof o, .leave_hidden = 1};
    size_t n = c->num_local;
    double done = 1 - 1.0 / (1 + s->rounds); /* the first round takes most of the time */
    brio_progress_part(c->ctx, c->bar, done, 1 - 1.0 / (2 + s->rounds));
    BRIO_FORWARD(gather(c));
    const double *weights = c->task.weighted ? c->weights : NULL;
    if (c->task.any_order)
        BRIO_FORWARD(brio_delaunay_any_order(c->ctx, c->points, weights, n, &o, &c->t));
    else
        BRIO_FORWARD(brio_delaunay(c->ctx, c->points, weights, n, &o, &c->t));
    const brio_delaunay_stats *facts = brio_triangulation_stats(c->t);
    c->tet = brio_triangulation_tetrahedra(c->t);
    c->num_tets = facts->tetrahedra + facts->hull_facets;
    s->dimension = facts->dimension;
    s->rounds++;
    s->triangulated += n;
    if (n > s->most_points) s->most_points = n;
    if (c->num_tets > s->most_tetrahedra) s->most_tetrahedra = c->num_tets;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(c->ctx, c->open, n + 1));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(c->ctx, c->not_final, n + 1));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(c->ctx, c->to_ask, c->num_tets + 1));
    const uint32_t *representative = brio_triangulation_representatives(c->t);
    for (size_t i = 0; i < n; i++) {
        uint32_t p = c->local[i];
        if (p >= c->task.num_own || c->state[p] != STAR_OPEN) continue;
        if (representative[i] == i)
            c->open[i] = OPEN;
        else /* what hides it stays */
            c->state[p] = NO_VERTEX, c->num_open--;
    }
    return BRIO_OK;
}

/* --- judging --- */

static inline bool is_finite_tet(const brio_tetrahedron *t) {
    return t->vertex[3] != BRIO_INFINITE;
}

static bool at_open_star(const completion *c, const brio_tetrahedron *t) {
    return c->open[t->vertex[0]] | c->open[t->vertex[1]] | c->open[t->vertex[2]] |
           (is_finite_tet(t) && c->open[t->vertex[3]]);
}

static brio_tet_key key_of(const completion *c, const brio_tetrahedron *t) {
    uint32_t v[4];
    for (int i = 0; i < 4; i++) v[i] = t->vertex[i] == BRIO_INFINITE ? BRIO_INFINITE : c->local[t->vertex[i]];
    return brio_tet_key_of(v);
}

/* Sets the balls of some tetrahedra. */
static void set_balls(const completion *c, const uint32_t *tets, size_t n, brio_ball *balls) {
    uint32_t vertex[BRIO_CENTRE_BATCH][4];
    double centre[BRIO_CENTRE_BATCH][3], error[BRIO_CENTRE_BATCH];
    size_t finite = 0;
    assert(n <= BRIO_CENTRE_BATCH);
    for (size_t i = 0; i < n; i++)
        if (is_finite_tet(&c->tet[tets[i]])) memcpy(vertex[finite++], c->tet[tets[i]].vertex, sizeof *vertex);
    brio_centre_batch batch = {c->points, c->task.weighted ? c->weights : NULL, (const uint32_t(*)[4])vertex, finite};
    if (finite) brio_centres(&batch, *centre, error);
    for (size_t i = 0, f = 0; i < n; i++) {
        brio_ball *b = &balls[i];
        const uint32_t *v = c->tet[tets[i]].vertex;
        *b = (brio_ball){.infinite = !is_finite_tet(&c->tet[tets[i]])};
        for (int k = 0; k < (b->infinite ? 3 : 4); k++)
            memcpy(b->vertex[k], c->known[c->local[v[k]]].record, sizeof *b->vertex);
        if (!b->infinite) memcpy(b->centre, centre[f], sizeof b->centre);
        brio_ball_set_region(b, b->infinite ? 0 : error[f], &c->task.all);
        f += !b->infinite;
    }
}

/* Marks those of a batch of finite tetrahedra whose balls leave the home box. */
static void judge_batch(completion *c, const uint32_t *tets, size_t n) {
    uint32_t vertex[BRIO_CENTRE_BATCH][4];
    double centre[BRIO_CENTRE_BATCH][3], error[BRIO_CENTRE_BATCH];
    brio_ball ball;
    for (size_t i = 0; i < n; i++) memcpy(vertex[i], c->tet[tets[i]].vertex, sizeof *vertex);
    brio_centre_batch batch = {c->points, c->task.weighted ? c->weights : NULL, (const uint32_t(*)[4])vertex, n};
    brio_near_centres(&batch, *centre, error);
    ball.infinite = false;
    for (size_t i = 0; i < n; i++) {
        memcpy(ball.vertex[0], c->points + 3 * (size_t)vertex[i][0], 3 * sizeof **ball.vertex);
        ball.vertex[0][3] = c->task.weighted ? c->weights[vertex[i][0]] : 0;
        memcpy(ball.centre, centre[i], sizeof ball.centre);
        brio_ball_set_square(&ball, error[i], &c->task.all);
        c->to_ask[tets[i]] = !brio_ball_inside(&ball, c->task.home);
    }
}

static void judge_some(void *user, size_t begin, size_t end, int thread) {
    completion *c = user;
    uint32_t some[BRIO_CENTRE_BATCH];
    size_t n = 0;
    (void)thread;
    for (size_t t = begin; t < end; t++) {
        if (!at_open_star(c, &c->tet[t])) continue;
        if (c->asked.count > 0) {
            brio_tet_key key = key_of(c, &c->tet[t]);
            if (brio_tet_set_has(&c->asked, &key)) continue;
        }
        if (!is_finite_tet(&c->tet[t]) || !c->task.home)
            c->to_ask[t] = 1;
        else
            some[n++] = (uint32_t)t;
        if (n == BRIO_CENTRE_BATCH) judge_batch(c, some, n), n = 0;
    }
    if (n) judge_batch(c, some, n);
}

/* --- asking --- */

/* Orders the questions by their vertices: in which order the tetrahedra came is forgotten. The sort is stable, so it
 * takes the last two vertices first. */
static brio_status order_questions(completion *c) {
    uint64_t *key = NULL;
    brio_status status = BRIO_OK;
    size_t n = c->num_questions;
    BRIO_TRY(BRIO_ALLOC(c->ctx, key, n + 1));
    for (int first = 2; first >= 0; first -= 2) {
        for (size_t i = 0; i < n; i++) {
            brio_tet_key k = key_of(c, &c->tet[c->question[i]]);
            key[i] = (uint64_t)k.v[first] << 32 | k.v[first + 1];
        }
        BRIO_TRY(brio_radix_sort(c->ctx, key, c->question, n, 64));
    }
done:
    brio_release(c->ctx, key);
    return status;
}

/* Returns the first index from `from` on that is marked; n if there is none. Few are. */
static size_t next_marked(const uint8_t *mark, size_t from, size_t n) {
    for (uint64_t eight = 0; from + sizeof eight <= n; from += sizeof eight) {
        memcpy(&eight, mark + from, sizeof eight);
        if (eight) break;
    }
    while (from < n && !mark[from]) from++;
    return from;
}

static brio_status list_questions(completion *c) {
    size_t n = 0;
    for (size_t t = 0; t < c->num_tets; t++) n += c->to_ask[t];
    c->num_questions = 0;
    BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->question, c->question_capacity, n));
    for (size_t t = 0; (t = next_marked(c->to_ask, t, c->num_tets)) < c->num_tets; t++)
        c->question[c->num_questions++] = (uint32_t)t;
    c->stats.asked += n;
    return order_questions(c);
}

brio_status brio_completion_begin(brio_completion *c, size_t *questions) {
    *questions = 0;
    c->known_before = c->num_known;
    c->num_questions = 0;
    if (!c->task.num_own) return BRIO_OK;
    BRIO_FORWARD(triangulate(c));
    if (c->stats.dimension < 3) return BRIO_OK;
    int threads = brio_threads(c->ctx, c->num_tets, TETS_A_THREAD);
    BRIO_FORWARD(brio_for(c->ctx, threads, c->num_tets, judge_some, c));
    c->next_asked.count = 0;
    BRIO_FORWARD(list_questions(c));
    *questions = c->num_questions;
    return BRIO_OK;
}

typedef struct {
    const completion *c;
    const uint32_t *question;
    brio_ball *balls;
} wanted;

static void set_some_balls(void *user, size_t begin, size_t end, int thread) {
    const wanted *w = user;
    (void)thread;
    for (size_t i = begin; i < end; i += BRIO_CENTRE_BATCH) {
        size_t n = end - i < BRIO_CENTRE_BATCH ? end - i : BRIO_CENTRE_BATCH;
        set_balls(w->c, w->question + i, n, w->balls + i);
    }
}

brio_status brio_completion_balls(const brio_completion *c, size_t first, size_t count, brio_ball *balls) {
    wanted w = {c, c->question + first, balls};
    return brio_for(c->ctx, brio_threads(c->ctx, count, BALLS_A_THREAD), count, set_some_balls, &w);
}

void brio_completion_is_free(brio_completion *c, size_t question) {
    c->to_ask[c->question[question]] = 0;
}

/* Notes the name of a point that is not an own one by its place.   *is_new  receives whether it was not known. */
static brio_status meet(completion *c, uint64_t name, bool *is_new) {
    *is_new = false;
    if (c->in_sequence && name - c->known[0].name < c->task.num_own) return BRIO_OK;
    return brio_names_enter(c->ctx, &c->names, name, is_new);
}

brio_status brio_completion_take(brio_completion *c, const brio_set_point *points, size_t count) {
    for (size_t i = 0; i < count; i++) {
        bool is_new;
        BRIO_FORWARD(meet(c, points[i].name, &is_new));
        if (!is_new) continue;
        BRIO_EXPECT(c->ctx, c->num_known < UINT32_MAX - 16, BRIO_ERR_TOO_LARGE,
                    "more than 2^32 - 17 points are needed to complete %zu", c->task.num_own);
        BRIO_FORWARD(BRIO_RESERVE(c->ctx, c->known, c->capacity, c->num_known + 1));
        c->known[c->num_known++] = points[i];
        c->stats.found++;
        BRIO_FORWARD(brio_look(c->ctx, 1));
    }
    return BRIO_OK;
}

/* --- answers --- */

static int compare_names(uint32_t i, uint32_t j, const void *user) {
    const brio_set_point *p = user;
    return p[i].name < p[j].name ? -1 : p[i].name > p[j].name;
}

/* Orders the points that this round found by their names: in which order they came is forgotten. */
static brio_status order_found(completion *c) {
    brio_set_point *found = c->known + c->known_before, *sorted = NULL;
    size_t n = c->num_known - c->known_before;
    uint32_t *row = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(c->ctx, row, n + 1));
    BRIO_TRY(BRIO_ALLOC(c->ctx, sorted, n + 1));
    for (size_t i = 0; i < n; i++) row[i] = (uint32_t)i;
    BRIO_TRY(brio_sort_many_indices(c->ctx, row, n, compare_names, found));
    for (size_t i = 0; i < n; i++) sorted[i] = found[row[i]];
    memcpy(found, sorted, n * sizeof *found);
done:
    brio_release(c->ctx, row);
    brio_release(c->ctx, sorted);
    return status;
}

/* Marks the vertices of the tetrahedra that may have a conflict. If nothing was found, none has. */
static void mark_not_final(completion *c) {
    for (size_t i = 0; i < c->num_questions && c->num_known > c->known_before; i++) {
        const brio_tetrahedron *t = &c->tet[c->question[i]];
        if (!c->to_ask[c->question[i]]) continue;
        for (int k = 0; k < (is_finite_tet(t) ? 4 : 3); k++) c->not_final[t->vertex[k]] = 1;
    }
}

/* --- final stars --- */

/* What one thread found in a slab. */
typedef struct {
    size_t begin, count, finite; /* rows */
} share;

typedef struct {
    completion *c;
    size_t first, size; /* tetrahedra of the slab */
    int threads;
    uint32_t (*row)[4];
    share *share;
} slab;

/* Returns a tetrahedron's leader, as a local point: its own vertex that is known first. BRIO_INFINITE if it has no own
 * vertex, or is not wanted. */
static uint32_t leader_of(const completion *c, const brio_tetrahedron *t) {
    uint32_t leader = BRIO_INFINITE, least = t->vertex[0];
    int count = is_finite_tet(t) ? 4 : 3, own = 0;
    for (int k = 0; k < count; k++) {
        uint32_t v = t->vertex[k];
        if (c->local[v] >= c->task.num_own) continue;
        own++;
        if (leader == BRIO_INFINITE || c->local[v] < c->local[leader]) leader = v;
    }
    if (own == count || own == 0 || !c->task.least_only) return leader;
    for (int k = 1; k < count; k++)
        if (brio_lexicographic(c->points + 3 * (size_t)t->vertex[k], c->points + 3 * (size_t)least) < 0)
            least = t->vertex[k];
    return c->local[least] < c->task.num_own ? leader : BRIO_INFINITE;
}

/* Lists the tetrahedra of a part of a slab whose leader's star ends. */
static void list_finals(void *user, size_t begin, size_t end, int thread) {
    slab *s = user;
    completion *c = s->c;
    share *mine = &s->share[thread];
    *mine = (share){.begin = begin};
    for (size_t i = s->first + begin; i < s->first + end; i++) {
        const brio_tetrahedron *t = &c->tet[i];
        bool finite = is_finite_tet(t);
        unsigned any = c->open[t->vertex[0]] | c->open[t->vertex[1]] | c->open[t->vertex[2]];
        if (finite) any |= c->open[t->vertex[3]];
        c->stays[i] = any & OPEN;
        if (!(any & ENDS)) continue;
        unsigned all = c->open[t->vertex[0]] & c->open[t->vertex[1]] & c->open[t->vertex[2]];
        if (!finite || !(all & c->open[t->vertex[3]] & ENDS)) { /* else it has own vertices alone, which all end */
            uint32_t leader = leader_of(c, t);
            if (leader == BRIO_INFINITE || c->open[leader] != ENDS) continue;
        }
        uint32_t *row = s->row[begin + mine->count++];
        for (int k = 0; k < 4; k++) row[k] = t->vertex[k] == BRIO_INFINITE ? BRIO_INFINITE : c->local[t->vertex[k]];
        mine->finite += finite;
    }
}

static brio_status hand_on_slab(slab *s) {
    completion *c = s->c;
    memset(s->share, 0, (size_t)s->threads * sizeof *s->share);
    BRIO_FORWARD(brio_for_parts(c->ctx, s->threads, s->size, list_finals, s));
    for (int i = 0; i < s->threads; i++) {
        const share *f = &s->share[i];
        c->stats.tetrahedra += f->finite;
        c->stats.infinite += f->count - f->finite;
        if (f->count)
            BRIO_FORWARD(
                c->task.final(c->task.final_user, c->known, (const uint32_t(*)[4])(s->row + f->begin), f->count));
    }
    return BRIO_OK;
}

/* Hands on the tetrahedra whose leader's star ends: each tetrahedron once, in an order that does not depend on the
 * threads. Marks those that are at stars that stay open. */
static brio_status hand_on(completion *c) {
    slab s = {.c = c, .threads = brio_threads(c->ctx, SLAB, TETS_A_THREAD)};
    brio_status status = BRIO_OK;
    size_t most = c->num_tets < SLAB ? c->num_tets : SLAB;
    BRIO_TRY(BRIO_ALLOC(c->ctx, c->stays, c->num_tets + 1));
    BRIO_TRY(BRIO_ALLOC(c->ctx, s.row, most + 1));
    BRIO_TRY(BRIO_ALLOC(c->ctx, s.share, s.threads));
    for (; s.first < c->num_tets; s.first += SLAB) {
        s.size = c->num_tets - s.first < SLAB ? c->num_tets - s.first : SLAB;
        BRIO_TRY(hand_on_slab(&s));
    }
done:
    brio_release(c->ctx, s.row);
    brio_release(c->ctx, s.share);
    return status;
}

static brio_status finish_stars(completion *c) {
    for (size_t i = 0; i < c->num_local; i++)
        if (c->open[i] && !c->not_final[i]) c->open[i] = ENDS;
    BRIO_FORWARD(hand_on(c));
    for (size_t i = 0; i < c->num_local; i++) {
        if (c->open[i] != ENDS) continue;
        c->state[c->local[i]] = STAR_FINAL;
        c->open[i] = 0;
        c->num_open--;
        c->stats.vertices++;
    }
    return BRIO_OK;
}

/* --- the next round --- */

/* Chooses the points of the next round: the vertices of open stars, and the known points from `before` on. Lists what
 * was asked for at these stars: what of it is still there in the next round is final. */
static brio_status choose_points(completion *c, size_t before) {
    brio_status status = BRIO_OK;
    uint8_t *needed = NULL;
    size_t n = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, needed, c->num_local + 1));
    for (size_t i = 0; (i = next_marked(c->stays, i, c->num_tets)) < c->num_tets; i++) {
        const brio_tetrahedron *t = &c->tet[i];
        BRIO_TRY(brio_look(c->ctx, 1));
        for (int k = 0; k < (is_finite_tet(t) ? 4 : 3); k++) needed[t->vertex[k]] = 1;
        brio_tet_key key = key_of(c, t);
        if (c->to_ask[i] || brio_tet_set_has(&c->asked, &key))
            BRIO_TRY(brio_tet_list_add(c->ctx, &c->next_asked, &key));
    }
    for (size_t i = 0; i < c->num_local; i++)
        if (needed[i]) c->local[n++] = c->local[i];
    BRIO_TRY(BRIO_RESERVE(c->ctx, c->local, c->local_capacity, n + c->num_known - before));
    for (size_t p = before; p < c->num_known; p++) c->local[n++] = (uint32_t)p;
    c->num_local = n;
    brio_tet_set old = c->asked;
    c->asked = c->next_asked;
    c->next_asked = old;
    status = brio_tet_set_index(c->ctx, &c->asked);
done:
    brio_release(c->ctx, needed);
    return status;
}

brio_status brio_completion_end(brio_completion *c, bool *goes_on) {
    brio_status status = BRIO_OK;
    bool any = c->num_known > c->known_before;
    *goes_on = false;
    if (c->stats.dimension < 3) goto done;
    BRIO_TRY(order_found(c));
    mark_not_final(c);
    BRIO_TRY(finish_stars(c));
    assert(any || c->num_open == 0);
    if (any && c->num_open > 0) {
        BRIO_TRY(choose_points(c, c->known_before));
        *goes_on = true;
    }
done:
    c->stats.known = c->num_known;
    c->stats.not_vertices = c->stats.dimension < 3 ? 0 : c->task.num_own - c->stats.vertices;
    end_round(c);
    return status;
}

/* --- life --- */

static brio_status set_up(completion *c) {
    const brio_completion_task *task = &c->task;
    size_t n = task->num_points;
    BRIO_FORWARD(brio_refuse_many(c->ctx, n));
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->known, n + 1));
    c->capacity = n + 1;
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->local, n + 1));
    c->local_capacity = n + 1;
    c->in_sequence = task->num_own > 0;
    for (size_t i = 1; i < task->num_own && c->in_sequence; i++)
        c->in_sequence = task->points[i].name == task->points[0].name + i;
    for (size_t i = 0; i < n; i++) {
        bool is_new = true;
        if (i >= task->num_own || !c->in_sequence) BRIO_FORWARD(meet(c, task->points[i].name, &is_new));
        BRIO_FORWARD(brio_look(c->ctx, 1));
        if (!is_new && i >= task->num_own) continue;
        c->local[c->num_known] = (uint32_t)c->num_known;
        c->known[c->num_known++] = task->points[i];
    }
    c->num_local = c->num_known;
    c->num_open = task->num_own;
    return BRIO_ALLOC_ZERO(c->ctx, c->state, task->num_own + 1);
}

brio_status brio_completion_new(brio_context *ctx, const brio_completion_task *task, brio_completion **out) {
    completion *c = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, c, 1));
    *c = (completion){.ctx = ctx, .task = *task, .bar = brio_progress_bar(ctx), .stats.dimension = -1};
    BRIO_TRY(set_up(c));
    *out = c;
    c = NULL;
done:
    brio_completion_delete(c);
    return status;
}

void brio_completion_delete(brio_completion *c) {
    if (!c) return;
    end_round(c);
    brio_names_met_free(c->ctx, &c->names);
    brio_tet_set_free(c->ctx, &c->asked);
    brio_tet_set_free(c->ctx, &c->next_asked);
    brio_release(c->ctx, c->known);
    brio_release(c->ctx, c->state);
    brio_release(c->ctx, c->local);
    brio_release(c->ctx, c->points);
    brio_release(c->ctx, c->weights);
    brio_release(c->ctx, c->question);
    brio_release(c->ctx, c);
}

const brio_completion_stats *brio_completion_facts(const brio_completion *c) {
    return &c->stats;
}

void brio_completion_vertices(const brio_completion *c, uint8_t *is_vertex) {
    for (size_t p = 0; p < c->task.num_own; p++) is_vertex[p] = c->state[p] == STAR_FINAL;
}

const brio_set_point *brio_completion_known(const brio_completion *c, size_t *count) {
    *count = c->num_known;
    return c->known;
}
