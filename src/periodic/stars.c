/* The stars of the points in the domain.
 *
 * The points and the translates in a margin about the domain are triangulated. All translates in a parallelepiped K are
 * known then. A tetrahedron is right if no translate outside K conflicts with it. Such a translate lies outside the
 * convex hull of the known ones, and the tetrahedra in conflict with it are joined across facets with an infinite one.
 * So a search from the hull, through tetrahedra whose balls leave K, meets all that can be wrong: a layer.
 *
 * Where one of the layer at a point of the domain is in conflict with a translate, its points are redone: completed
 * from their neighbours here, and from translates that are looked for (completion/completion.h). Only translates in the
 * lattice's range about the domain matter, by decision 018.
 *
 * Based on: decision 018; Caroli, Teillaud. Delaunay triangulations of closed Euclidean d-orbifolds. DCG 2016.
 * Differs from the paper: no covering of 27 or more sheets is made; copies are where balls need them. */
#include "periodic/periodic.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/vector.h"
#include "periodic/translates.h"
#include "predicates/circumcentre.h"
#include <assert.h>
#include <math.h>
#include <string.h>

enum { POINTS_A_THREAD = 1 << 14, BALLS_A_THREAD = 1 << 9 };

/* What one thread has of a step of the search for the layer. */
typedef struct {
    brio_filter filter;
    uint32_t *met;
    size_t count, capacity;
    brio_status status;
} searcher;

typedef struct {
    brio_context *ctx;
    const brio_lattice *lattice;
    brio_stars *s;
    size_t num_points;
    double margin[3]; /* K: coordinates in the basis from -margin to 1 + margin */
    double heaviest;
    const brio_tetrahedron *tet;
    size_t num_finite, num_tets;
    uint8_t *seen;  /* #tetrahedra; atomic */
    uint32_t *edge; /* of the layer: what the last step met */
    size_t edge_count, edge_capacity;
    searcher *searcher; /* one a thread */
    brio_translates translates;
    uint8_t *left_out;
} layer;

/* --- what is triangulated first --- */

/* Returns the spacing of points that fill their box, the domain's span and what they reach beyond it. */
static double spacing_of(const brio_lattice *l, const double (*home)[3], size_t num_points) {
    double side[3] = {0, 0, 0}, product = 1, most = 0, n = (double)num_points;
    for (int i = 0; i < 3; i++) {
        double low = INFINITY, high = -INFINITY, unit = 1 / brio_length(l->dual[i]);
        for (size_t p = 0; p < num_points && i >= l->rank; p++) {
            double share = brio_lattice_share(l, i, home[p]);
            low = fmin(low, share), high = fmax(high, share);
        }
        side[i] = i < l->rank ? unit : (high - low) * unit;
    }
    for (int i = 1; i < 3; i++)
        for (int j = i; j > 0 && side[j] > side[j - 1]; j--) {
            double x = side[j];
            side[j] = side[j - 1], side[j - 1] = x;
        }
    for (int d = 1; d <= 3; d++) {
        product *= side[d - 1];
        most = fmax(most, pow(product / n, 1.0 / d));
    }
    return most;
}

void brio_stars_shifts(const brio_lattice *lattice, const double margin[3], const double *x, int32_t from[3],
                       int32_t to[3]) {
    for (int i = 0; i < 3; i++) {
        from[i] = to[i] = 0;
        if (i >= lattice->rank) continue;
        double share = brio_lattice_share(lattice, i, x);
        double low = -margin[i] - share, high = 1 + margin[i] - share;
        if (low <= -1) from[i] = (int32_t)ceil(low);
        if (high >= 1) to[i] = (int32_t)floor(high);
    }
}

void brio_stars_margin(const brio_stars_task *task, double margin[3]) {
    const brio_lattice *l = task->lattice;
    double width = task->halo * spacing_of(l, task->home, task->num_points);
    for (int i = 0; i < l->rank; i++) margin[i] = fmin(width * brio_length(l->dual[i]), l->range[i]);
}

/* Points of which the translates in K are appended. */
typedef struct {
    layer *y;
    size_t *next; /* of each thread: the number of its translates, then where the next one goes */
} translating;

static void count_some(void *user, size_t from, size_t to, int thread) {
    const translating *h = user;
    for (size_t p = from; p < to; p++) {
        int32_t low[3], high[3];
        brio_stars_shifts(h->y->lattice, h->y->margin, h->y->s->images.x[p], low, high);
        size_t all = (size_t)(high[0] - low[0] + 1) * (size_t)(high[1] - low[1] + 1) * (size_t)(high[2] - low[2] + 1);
        h->next[thread] += all - 1;
    }
}

static void add_some(void *user, size_t from, size_t to, int thread) {
    const translating *h = user;
    brio_images *m = &h->y->s->images;
    for (size_t p = from; p < to; p++) {
        int32_t low[3], high[3], s[3];
        brio_stars_shifts(h->y->lattice, h->y->margin, m->x[p], low, high);
        for (s[0] = low[0]; s[0] <= high[0]; s[0]++)
            for (s[1] = low[1]; s[1] <= high[1]; s[1]++)
                for (s[2] = low[2]; s[2] <= high[2]; s[2]++)
                    if (s[0] || s[1] || s[2]) brio_images_set(m, h->next[thread]++, (uint32_t)p, s);
    }
}

/* Appends the translates of the points that are in K. */
static brio_status add_margin(layer *y) {
    brio_status status = BRIO_OK;
    translating h = {.y = y};
    int threads = brio_threads(y->ctx, y->num_points, POINTS_A_THREAD);
    size_t next = y->num_points;
    BRIO_TRY(BRIO_ALLOC_ZERO(y->ctx, h.next, (size_t)threads));
    BRIO_TRY(brio_for(y->ctx, threads, y->num_points, count_some, &h));
    for (int i = 0; i < threads; i++) {
        size_t count = h.next[i];
        h.next[i] = next;
        next += count;
    }
    BRIO_TRY(brio_images_extend(&y->s->images, next - y->num_points));
    BRIO_TRY(brio_for(y->ctx, threads, y->num_points, add_some, &h));
done:
    brio_release(y->ctx, h.next);
    return status;
}

double brio_stars_count(const brio_stars_task *task) {
    double count = 0, margin[3];
    brio_stars_margin(task, margin);
    for (size_t p = 0; p < task->num_points; p++) {
        int32_t from[3], to[3];
        brio_stars_shifts(task->lattice, margin, task->home[p], from, to);
        count += (to[0] - from[0] + 1.0) * (to[1] - from[1] + 1.0) * (to[2] - from[2] + 1.0);
    }
    return count;
}

static brio_status triangulate(layer *y, const brio_stars_task *task) {
    brio_stars *s = y->s;
    brio_delaunay_options o = {.size = sizeof o, .seed = task->seed, .max_tetrahedra = task->max_tetrahedra};
    s->num_known = s->images.count;
    if (task->known)
        BRIO_FORWARD(task->known->make(task->known->user, &s->images, &s->t));
    else
        BRIO_FORWARD(brio_delaunay(y->ctx, s->images.x[0], s->images.weight, s->num_known, &o, &s->t));
    s->triangulated += s->num_known;
    s->rounds++;
    const brio_delaunay_stats *facts = brio_triangulation_stats(s->t);
    y->tet = brio_triangulation_tetrahedra(s->t);
    y->num_finite = facts->tetrahedra;
    y->num_tets = facts->tetrahedra + facts->hull_facets;
    const uint32_t *representative = brio_triangulation_representatives(s->t);
    BRIO_FORWARD(BRIO_ALLOC(y->ctx, s->is_vertex, y->num_points + 1));
    for (size_t p = 0; p < y->num_points; p++) s->is_vertex[p] = representative[p] == p;
    return BRIO_OK;
}

bool brio_stars_has_all(const brio_lattice *lattice, const double margin[3]) {
    for (int i = 0; i < lattice->rank; i++)
        if (margin[i] < lattice->range[i]) return false;
    return true;
}

/* --- the layer --- */

static brio_status push(const layer *y, searcher *own, size_t tet) {
    uint8_t *seen = &y->seen[tet];
    if (__atomic_load_n(seen, __ATOMIC_RELAXED) || __atomic_exchange_n(seen, 1, __ATOMIC_RELAXED)) return BRIO_OK;
    BRIO_FORWARD(BRIO_RESERVE(y->ctx, own->met, own->capacity, own->count + 1));
    own->met[own->count++] = (uint32_t)tet;
    return BRIO_OK;
}

/* Takes K a bit smaller: the coordinates of the known translates in the basis were rounded. */
bool brio_stars_leaves(const brio_lattice *lattice, const double margin[3], double heaviest, const brio_ball *b) {
    static const double SLACK = 0x1p-30;
    if (b->infinite || !(b->square < INFINITY)) return true;
    double most = b->square + heaviest, radius;
    if (most < 0) return false;
    radius = sqrt(most) * (1 + SLACK);
    for (int i = 0; i < lattice->rank; i++) {
        double share = brio_lattice_share(lattice, i, b->centre), slack = SLACK * (1 + fabs(share));
        double way = radius * brio_length(lattice->dual[i]) + slack;
        if (!(share - way > -margin[i] && share + way < 1 + margin[i])) return true;
    }
    return false;
}

/* Sets the balls of some tetrahedra. */
static void set_balls(const layer *y, const uint32_t *tets, size_t n, brio_ball *balls) {
    const brio_images *m = &y->s->images;
    uint32_t vertex[BRIO_CENTRE_BATCH][4];
    double centre[BRIO_CENTRE_BATCH][3], error[BRIO_CENTRE_BATCH];
    size_t finite = 0, f = 0;
    for (size_t i = 0; i < n; i++)
        if (tets[i] < y->num_finite) memcpy(vertex[finite++], y->tet[tets[i]].vertex, sizeof *vertex);
    brio_centre_batch batch = {m->x[0], m->weight, (const uint32_t(*)[4])vertex, finite};
    if (finite) brio_centres(&batch, *centre, error);
    for (size_t i = 0; i < n; i++) {
        brio_ball *b = &balls[i];
        const uint32_t *v = y->tet[tets[i]].vertex;
        *b = (brio_ball){.infinite = tets[i] >= y->num_finite};
        for (int k = 0; k < (b->infinite ? 3 : 4); k++) {
            memcpy(b->vertex[k], m->x[v[k]], 3 * sizeof(double));
            b->vertex[k][3] = m->weight ? m->weight[v[k]] : 0;
        }
        if (!b->infinite) memcpy(b->centre, centre[f], sizeof b->centre);
        brio_ball_set_region(b, b->infinite ? 0 : error[f], &y->translates.all);
        f += !b->infinite;
    }
}

/* Returns whether a tetrahedron has points in the domain of which it is not known yet that they are redone. */
static bool asks(const layer *y, const uint32_t *v) {
    for (int k = 0; k < 4; k++)
        if (v[k] < y->num_points && !__atomic_load_n(&y->s->redone[v[k]], __ATOMIC_RELAXED)) return true;
    return false;
}

/* Looks at one of the layer: goes on to its mates, and marks its points for redoing where a translate conflicts. */
static brio_status look_at(const layer *y, searcher *own, uint32_t tet, const brio_ball *ball) {
    const brio_tetrahedron *t = &y->tet[tet];
    brio_set_point found;
    if (!brio_stars_leaves(y->lattice, y->margin, y->heaviest, ball)) return BRIO_OK;
    for (int i = 0; i < 4; i++) BRIO_FORWARD(push(y, own, t->mate[i] >> 2));
    if (!asks(y, t->vertex) || !brio_translates_deepest(&y->translates, &own->filter, ball, &found)) return BRIO_OK;
    for (int k = 0; k < 4; k++)
        if (t->vertex[k] < y->num_points) __atomic_store_n(&y->s->redone[t->vertex[k]], 1, __ATOMIC_RELAXED);
    return BRIO_OK;
}

static void look_at_some(void *user, size_t from, size_t to, int thread) {
    const layer *y = user;
    searcher *own = &y->searcher[thread];
    brio_ball balls[BRIO_CENTRE_BATCH];
    for (size_t at = from, n; at < to && own->status == BRIO_OK; at += n) {
        n = to - at < BRIO_CENTRE_BATCH ? to - at : BRIO_CENTRE_BATCH;
        set_balls(y, y->edge + at, n, balls);
        for (size_t i = 0; i < n; i++) brio_report(&own->status, look_at(y, own, y->edge[at + i], &balls[i]));
    }
}

/* Makes what the threads met the edge of the layer. */
static brio_status take_step(layer *y, int threads) {
    y->edge_count = 0;
    for (int i = 0; i < threads; i++) {
        searcher *own = &y->searcher[i];
        BRIO_FORWARD(own->status);
        BRIO_FORWARD(BRIO_RESERVE(y->ctx, y->edge, y->edge_capacity, y->edge_count + own->count));
        if (own->count) memcpy(y->edge + y->edge_count, own->met, own->count * sizeof *own->met);
        y->edge_count += own->count;
        own->count = 0;
    }
    return BRIO_OK;
}

/* Searches the layer step by step, from the hull on. Which points are redone does not depend on the order. */
static brio_status search_layer(layer *y) {
    brio_status status = BRIO_OK;
    int most = brio_threads(y->ctx, y->num_tets, BALLS_A_THREAD);
    BRIO_TRY(BRIO_ALLOC_ZERO(y->ctx, y->seen, y->num_tets + 1));
    BRIO_TRY(BRIO_ALLOC_ZERO(y->ctx, y->searcher, (size_t)most));
    for (int i = 0; i < most; i++) y->searcher[i].filter = y->translates.filter;
    for (size_t t = y->num_finite; t < y->num_tets; t++) BRIO_TRY(push(y, &y->searcher[0], t));
    BRIO_TRY(take_step(y, 1));
    while (y->edge_count) {
        int threads = brio_threads(y->ctx, y->edge_count, BALLS_A_THREAD);
        BRIO_TRY(brio_for(y->ctx, threads < most ? threads : most, y->edge_count, look_at_some, y));
        BRIO_TRY(brio_look(y->ctx, 16 * y->edge_count));
        BRIO_TRY(take_step(y, most));
    }
    for (size_t p = 0; p < y->num_points; p++) y->s->num_redone += y->s->redone[p];
done:
    for (int i = 0; y->searcher && i < most; i++) brio_release(y->ctx, y->searcher[i].met);
    return status;
}

/* --- points that are redone --- */

typedef struct {
    const layer *y;
    uint8_t *needed; /* #images; atomic */
} needing;

/* Marks the vertices of tetrahedra with redone points. */
static void need_some(void *user, size_t from, size_t to, int thread) {
    const needing *h = user;
    const uint8_t *is_redone = h->y->s->redone;
    size_t points = h->y->num_points;
    (void)thread;
    for (size_t t = from; t < to; t++) {
        const uint32_t *v = h->y->tet[t].vertex;
        bool redone = false;
        for (int k = 0; k < 4; k++) redone |= v[k] < points && is_redone[v[k]];
        for (int k = 0; k < 4 && redone; k++)
            if (v[k] != BRIO_INFINITE) __atomic_store_n(&h->needed[v[k]], 1, __ATOMIC_RELAXED);
    }
}

/* Lists the redone points, and the vertices of their tetrahedra. */
static brio_status list_points(const layer *y, brio_set_point **out, size_t *num_own, size_t *num_all) {
    const brio_images *m = &y->s->images;
    brio_status status = BRIO_OK;
    needing h = {.y = y};
    brio_set_point *list = NULL;
    size_t n = 0, count = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(y->ctx, h.needed, m->count + 1));
    BRIO_TRY(brio_for(y->ctx, brio_threads(y->ctx, y->num_tets, POINTS_A_THREAD), y->num_tets, need_some, &h));
    for (size_t i = 0; i < m->count; i++) count += h.needed[i] != 0;
    BRIO_TRY(BRIO_ALLOC(y->ctx, list, count + 1));
    for (int own = 1; own >= 0; own--)
        for (size_t i = 0; i < m->count; i++) {
            bool is_redone = i < y->num_points && y->s->redone[i];
            if (!h.needed[i] || is_redone != (own == 1)) continue;
            brio_set_point *p = &list[n++];
            memcpy(p->record, m->x[i], 3 * sizeof(double));
            p->record[3] = m->weight ? m->weight[i] : 0;
            p->name = brio_translate_name(m->list[i].point, m->list[i].shift);
            *num_own += own == 1;
        }
    *num_all = n;
    *out = list;
    list = NULL;
done:
    brio_release(y->ctx, h.needed);
    brio_release(y->ctx, list);
    return status;
}

static brio_status take_final(void *user, const brio_set_point *known, const uint32_t (*vertex)[4], size_t count) {
    const layer *y = user;
    brio_stars *s = y->s;
    BRIO_FORWARD(BRIO_RESERVE(y->ctx, s->extra, s->extra_capacity, s->num_extra + count));
    for (size_t n = 0; n < count; n++) {
        for (int k = 0; k < 4; k++) {
            uint32_t *v = &s->extra[s->num_extra][k];
            *v = BRIO_INFINITE;
            if (vertex[n][k] == BRIO_INFINITE) continue;
            brio_image i = brio_translate_of(known[vertex[n][k]].name);
            BRIO_FORWARD(brio_images_find(&s->images, i.point, i.shift, v));
        }
        s->num_extra++;
    }
    return BRIO_OK;
}

static brio_status redo(layer *y) {
    brio_status status = BRIO_OK;
    brio_set_point *list = NULL;
    uint8_t *is_vertex = NULL;
    brio_completion_stats facts;
    brio_completion_task task = {.weighted = y->s->images.weight != NULL,
                                 .all = y->translates.all,
                                 .source = brio_translates_find,
                                 .source_user = &y->translates,
                                 .final = take_final,
                                 .final_user = y};
    BRIO_TRY(list_points(y, &list, &task.num_own, &task.num_points));
    task.points = list;
    BRIO_TRY(BRIO_ALLOC(y->ctx, is_vertex, task.num_own + 1));
    BRIO_TRY(brio_complete(y->ctx, &task, is_vertex, &facts));
    for (size_t i = 0; i < task.num_own; i++) y->s->is_vertex[brio_translate_of(list[i].name).point] = is_vertex[i];
    y->s->rounds += facts.rounds;
    y->s->triangulated += facts.triangulated;
    y->s->most_completed = facts.most_points;
done:
    brio_release(y->ctx, list);
    brio_release(y->ctx, is_vertex);
    return status;
}

static brio_status complete(layer *y) {
    const brio_images *m = &y->s->images;
    y->heaviest = m->weight ? -INFINITY : 0;
    for (size_t p = 0; p < y->num_points && m->weight; p++) y->heaviest = fmax(y->heaviest, m->weight[p]);
    BRIO_FORWARD(BRIO_ALLOC(y->ctx, y->left_out, y->num_points + 1));
    for (size_t p = 0; p < y->num_points; p++) y->left_out[p] = !y->s->is_vertex[p];
    BRIO_FORWARD(brio_translates_new(y->ctx, m, y->left_out, &y->translates));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(y->ctx, y->s->redone, y->num_points + 1));
    BRIO_FORWARD(search_layer(y));
    return y->s->num_redone ? redo(y) : BRIO_OK;
}

/* --- all --- */

/* Triangulates the points and the translates in a margin about them. */
static brio_status begin(layer *y, const brio_stars_task *task) {
    *y = (layer){.ctx = y->ctx, .lattice = task->lattice, .s = y->s, .num_points = task->num_points};
    BRIO_FORWARD(brio_images_new(y->ctx, task->lattice, task->home, task->weights, task->num_points, &y->s->images));
    if (task->known)
        memcpy(y->margin, task->known->margin, sizeof y->margin);
    else
        brio_stars_margin(task, y->margin);
    BRIO_FORWARD(add_margin(y));
    return triangulate(y, task);
}

brio_status brio_stars_new(brio_context *ctx, const brio_stars_task *task, brio_stars *s) {
    brio_status status = BRIO_OK;
    layer y = {.ctx = ctx, .s = s};
    *s = (brio_stars){.images = {.ctx = ctx}};
    BRIO_TRY(begin(&y, task));
    if (brio_triangulation_stats(s->t)->dimension < 3 && !brio_stars_has_all(y.lattice, y.margin)) {
        brio_stars_task all = *task; /* of a plane or a line: all at once */
        all.halo = INFINITY;
        all.known = NULL;
        brio_stars_free(s);
        BRIO_TRY(begin(&y, &all));
    }
    if (task->num_points && !brio_stars_has_all(y.lattice, y.margin)) BRIO_TRY(complete(&y));
done:
    brio_translates_free(&y.translates);
    brio_release(ctx, y.left_out);
    brio_release(ctx, y.seen);
    brio_release(ctx, y.edge);
    brio_release(ctx, y.searcher);
    return status;
}

void brio_stars_free(brio_stars *s) {
    brio_context *ctx = s->images.ctx;
    brio_triangulation_free(s->t);
    if (ctx) {
        brio_release(ctx, s->redone);
        brio_release(ctx, s->is_vertex);
        brio_release(ctx, s->extra);
    }
    brio_images_free(&s->images);
    *s = (brio_stars){0};
}
