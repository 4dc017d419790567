/* The tiles of all ranks are completed, two of each rank at a time.
 *
 * A round: each rank triangulates the first of its two tiles. Its questions go out while it triangulates the second.
 * Then each rank answers what it was asked, and takes what it gets. A slot whose tile is finished takes the next one.
 * Rounds go on until no rank has a tile left. Every rank takes the same steps, with empty hands if need be.
 *
 * A question goes down the tree of boxes, in which the tiles of other ranks are there down to their upper nodes: where
 * those samples are in conflict in sufficient number, no other rank is asked. An answer has each point once. */
#include "base/memory.h"
#include "base/sort.h"
#include "ranks/work.h"
#include <assert.h>
#include <string.h>

/** Who asks, or is answered: the beginning of a message. */
typedef struct {
    uint32_t slot, tile; /* of the rank that asks */
    uint64_t count;      /* of an answer: questions that are free */
    brio_ball_box seen;  /* of a question: the tile knows all points in it */
} heading;

typedef struct {
    brio_ball ball;
    uint64_t question;
} far_question;

_Static_assert(sizeof(far_question) % 8 == 0 && sizeof(heading) % 8 == 0, "messages are of words");

typedef struct {
    uint32_t tile;
    brio_tile_work *work; /* NULL: the slot is empty */
    uint32_t *pending;    /* of each question: answers that may say that it is free, or BLOCKED */
} slot;

#define BLOCKED UINT32_MAX

typedef struct {
    brio_ranks *r;
    slot slots[RANK_SLOTS];
    uint32_t next_tile;
    brio_ball *balls;
    brio_found found;
    uint64_t bytes_before;
} completing;

/* --- questions --- */

static brio_status put_question(completing *c, uint32_t number, int rank, const brio_ball *ball, uint64_t question) {
    brio_exchange *x = &c->r->x;
    heading h = {number, c->slots[number].tile, 0, c->r->seen[c->slots[number].tile]};
    far_question q;
    memset(&q, 0, sizeof q);
    q.ball = *ball, q.question = question;
    if (!brio_exchange_parcel(x, rank)->size) BRIO_FORWARD(brio_exchange_put(x, rank, &h, sizeof h));
    c->r->far_asked++;
    return brio_exchange_put(x, rank, &q, sizeof q);
}

/* Searches this rank's points for some questions, and lists what others must be asked. */
static brio_status ask_some(completing *c, uint32_t number, size_t first, size_t n) {
    slot *s = &c->slots[number];
    brio_completion *completion = brio_tile_work_completion(s->work);
    brio_tile_source *source = brio_tile_work_source(s->work);
    size_t num_asked;
    BRIO_FORWARD(brio_completion_balls(completion, first, n, c->balls));
    c->found.count = 0;
    BRIO_FORWARD(brio_tile_conflicts(source, c->balls, n, &c->found));
    BRIO_FORWARD(brio_completion_take(completion, c->found.point, c->found.count));
    const brio_tile_asked *asked = brio_tile_source_asked(source, &num_asked);
    for (size_t i = 0; i < n; i++) s->pending[first + i] = c->balls[i].is_free ? 0 : BLOCKED;
    for (size_t i = 0; i < num_asked; i++) {
        uint32_t *pending = &s->pending[first + asked[i].ball];
        if (*pending != BLOCKED) ++*pending;
        BRIO_FORWARD(put_question(c, number, (int)asked[i].rank, &c->balls[asked[i].ball], first + asked[i].ball));
    }
    for (size_t i = 0; i < n; i++)
        if (!s->pending[first + i]) brio_completion_is_free(completion, first + i);
    return BRIO_OK;
}

/* Fills an empty slot with the next tile, triangulates, and sends the questions. */
static brio_status ask(completing *c, uint32_t number) {
    brio_ranks *r = c->r;
    slot *s = &c->slots[number];
    size_t questions = 0;
    while (!s->work && c->next_tile < r->t->num_tiles) {
        s->tile = c->next_tile++;
        BRIO_FORWARD(brio_tile_begin(r->t, s->tile, &r->sample[s->tile], &r->seen[s->tile], &s->work));
    }
    if (s->work) {
        BRIO_FORWARD(brio_completion_begin(brio_tile_work_completion(s->work), &questions));
        BRIO_FORWARD(BRIO_ALLOC(r->ctx, s->pending, questions + 1));
        brio_tile_source_round(brio_tile_work_source(s->work));
    }
    for (size_t first = 0; first < questions; first += BRIO_COMPLETION_BALLS) {
        size_t n = questions - first < BRIO_COMPLETION_BALLS ? questions - first : BRIO_COMPLETION_BALLS;
        BRIO_FORWARD(ask_some(c, number, first, n));
    }
    return brio_exchange_begin(&r->x, false);
}

/* --- answers to others --- */

/* Returns the source that searches this rank's points for a tile of another. */
static brio_status source_for(brio_ranks *r, int rank, const heading *h, brio_tile_source **out) {
    brio_rank_served *served = &r->served[rank * RANK_SLOTS + (int)h->slot];
    if (served->source && served->tile != h->tile) {
        brio_tile_source_free(served->source);
        served->source = NULL;
    }
    served->tile = h->tile;
    if (!served->source) BRIO_FORWARD(brio_tile_source_new(r->t, TILE_OTHER, r->own_root, &h->seen, &served->source));
    *out = served->source;
    return BRIO_OK;
}

static int compare_names(uint32_t i, uint32_t j, const void *user) {
    const brio_set_point *p = user;
    return p[i].name < p[j].name ? -1 : p[i].name > p[j].name;
}

/* Sends what was found, each point once. */
static brio_status put_points(completing *c, int rank) {
    brio_ranks *r = c->r;
    uint32_t *row = NULL;
    brio_status status = BRIO_OK;
    const brio_set_point *p = c->found.point;
    BRIO_TRY(BRIO_ALLOC(r->ctx, row, c->found.count + 1));
    for (size_t i = 0; i < c->found.count; i++) row[i] = (uint32_t)i;
    BRIO_TRY(brio_sort_many_indices(r->ctx, row, c->found.count, compare_names, p));
    for (size_t i = 0; i < c->found.count; i++) {
        if (i && p[row[i - 1]].name == p[row[i]].name) continue;
        BRIO_TRY(brio_exchange_put(&r->x, rank, &p[row[i]], sizeof *p));
        r->far_found++;
    }
done:
    brio_release(r->ctx, row);
    return status;
}

static brio_status answer_message(completing *c, const brio_letter *m) {
    brio_ranks *r = c->r;
    const heading *h = m->bytes;
    const far_question *q = (const far_question *)(h + 1);
    size_t n = (m->size - sizeof *h) / sizeof *q;
    heading reply = {.slot = h->slot, .tile = h->tile};
    brio_tile_source *source;
    BRIO_FORWARD(source_for(r, m->rank, h, &source));
    brio_tile_source_round(source);
    c->found.count = 0;
    size_t at = brio_exchange_parcel(&r->x, m->rank)->size;
    BRIO_FORWARD(brio_exchange_put(&r->x, m->rank, &reply, sizeof reply));
    for (size_t first = 0; first < n; first += BRIO_COMPLETION_BALLS) {
        size_t some = n - first < BRIO_COMPLETION_BALLS ? n - first : BRIO_COMPLETION_BALLS;
        for (size_t i = 0; i < some; i++) c->balls[i] = q[first + i].ball;
        BRIO_FORWARD(brio_tile_conflicts(source, c->balls, some, &c->found));
        for (size_t i = 0; i < some; i++) {
            if (!c->balls[i].is_free) continue;
            BRIO_FORWARD(brio_exchange_put(&r->x, m->rank, &q[first + i].question, sizeof q->question));
            reply.count++;
        }
    }
    memcpy(brio_exchange_parcel(&r->x, m->rank)->bytes + at, &reply, sizeof reply);
    return put_points(c, m->rank);
}

/* Ends the exchange of questions, answers them, and begins that of answers. */
static brio_status serve(completing *c) {
    brio_exchange *x = &c->r->x;
    BRIO_FORWARD(brio_exchange_end(x));
    for (int i = 0; i < c->r->ranks; i++)
        if (x->received[i].size) BRIO_FORWARD(answer_message(c, &x->received[i]));
    return brio_exchange_begin(x, false);
}

/* --- answers of others --- */

static brio_status take(completing *c, uint32_t number, bool *any) {
    brio_exchange *x = &c->r->x;
    slot *s = &c->slots[number];
    bool goes_on = false;
    BRIO_FORWARD(brio_exchange_end(x));
    if (!s->work) return BRIO_OK;
    brio_completion *completion = brio_tile_work_completion(s->work);
    for (int i = 0; i < c->r->ranks; i++) {
        const brio_letter *m = &x->received[i];
        const heading *h = m->bytes;
        if (!m->size) continue;
        assert(h->slot == number && h->tile == s->tile);
        const uint64_t *question = (const uint64_t *)(h + 1);
        for (uint64_t k = 0; k < h->count; k++)
            if (s->pending[question[k]] != BLOCKED && --s->pending[question[k]] == 0)
                brio_completion_is_free(completion, question[k]);
        const brio_set_point *p = (const brio_set_point *)(question + h->count);
        size_t n = (m->size - sizeof *h - h->count * sizeof *question) / sizeof *p;
        BRIO_FORWARD(brio_completion_take(completion, p, n));
    }
    brio_release(c->r->ctx, s->pending);
    s->pending = NULL;
    c->r->rounds++;
    BRIO_FORWARD(brio_completion_end(completion, &goes_on));
    *any |= goes_on;
    if (goes_on) return BRIO_OK;
    BRIO_FORWARD(brio_tile_finish(s->work));
    brio_tile_end(s->work);
    s->work = NULL;
    return BRIO_OK;
}

/* --- what a tile begins with --- */

/* Asks for all points in a box, and for a coarse sample about another. */
typedef struct {
    uint64_t tile;
    brio_ball_box seen, box;
} sample_question;

static brio_status put_once(brio_ranks *r, int rank, const sample_question *q) {
    const brio_parcel *p = brio_exchange_parcel(&r->x, rank);
    const uint8_t *last = p->size ? p->bytes + p->size - sizeof *q : NULL;
    if (last && !memcmp(last, &q->tile, sizeof q->tile)) return BRIO_OK;
    return brio_exchange_put(&r->x, rank, q, sizeof *q);
}

static brio_status ask_for_tile(brio_ranks *r, uint32_t tile, brio_found *unused) {
    brio_tiles *t = r->t;
    brio_tile_source *source = NULL;
    brio_tile_roots near = {.count = 0};
    brio_status status = BRIO_OK;
    sample_question q;
    size_t n;
    memset(&q, 0, sizeof q);
    q.tile = tile;
    q.box = t->node[t->tile[tile].root].box;
    BRIO_TRY(brio_tile_halo_box(t, tile, &q.seen));
    r->seen[tile] = q.seen;
    BRIO_TRY(brio_tile_halo_ranks(t, &q.seen, &near));
    BRIO_TRY(brio_tile_source_new(t, tile, (uint32_t)t->num_nodes - 1, NULL, &source));
    BRIO_TRY(brio_tile_coarse_sample(source, &q.box, unused));
    unused->count = 0;
    const brio_tile_asked *asked = brio_tile_source_asked(source, &n);
    for (size_t k = 0; k < n; k++) BRIO_TRY(put_once(r, (int)asked[k].rank, &q));
    for (size_t k = 0; k < near.count; k++) BRIO_TRY(put_once(r, (int)near.node[k], &q));
done:
    brio_tile_source_free(source);
    brio_release(r->ctx, near.node);
    return status;
}

static brio_status ask_samples(brio_ranks *r, brio_found *unused) {
    for (uint32_t i = 0; i < r->t->num_tiles; i++)
        if (r->t->tile[i].points) BRIO_FORWARD(ask_for_tile(r, i, unused));
    return brio_exchange_now(&r->x, false);
}

static brio_status answer_sample(brio_ranks *r, int rank, const sample_question *q, brio_found *found) {
    brio_tile_source *source;
    BRIO_FORWARD(brio_tile_source_new(r->t, TILE_OTHER, r->own_root, NULL, &source));
    found->count = 0;
    brio_status status = brio_tile_coarse_sample(source, &q->box, found);
    brio_tile_source_free(source);
    BRIO_FORWARD(status);
    BRIO_FORWARD(brio_tile_halo_add(r->t, TILE_OTHER, r->own_root, &q->seen, found));
    uint64_t head[2] = {q->tile, found->count};
    r->far_found += found->count;
    BRIO_FORWARD(brio_exchange_put(&r->x, rank, head, sizeof head));
    return brio_exchange_put(&r->x, rank, found->point, found->count * sizeof *found->point);
}

static brio_status answer_samples(brio_ranks *r, brio_found *found) {
    for (int i = 0; i < r->ranks; i++) {
        const brio_letter *m = &r->x.received[i];
        const sample_question *q = m->bytes;
        for (size_t k = 0; k < m->size / sizeof *q; k++) BRIO_FORWARD(answer_sample(r, m->rank, &q[k], found));
    }
    return brio_exchange_now(&r->x, false);
}

static brio_status take_samples(brio_ranks *r) {
    for (int i = 0; i < r->ranks; i++) {
        const uint8_t *at = r->x.received[i].bytes, *end = at + r->x.received[i].size;
        while (at < end) {
            uint64_t head[2];
            memcpy(head, at, sizeof head);
            at += sizeof head;
            for (uint64_t k = 0; k < head[1]; k++, at += sizeof(brio_set_point))
                BRIO_FORWARD(brio_found_add(&r->sample[head[0]], (const brio_set_point *)at));
        }
    }
    return BRIO_OK;
}

static brio_status exchange_samples(brio_ranks *r) {
    brio_found found = {.ctx = r->ctx};
    brio_status status = BRIO_OK;
    for (uint32_t i = 0; i < r->t->num_tiles; i++) r->sample[i].count = 0;
    BRIO_TRY(ask_samples(r, &found));
    BRIO_TRY(answer_samples(r, &found));
    status = take_samples(r);
done:
    brio_release(r->ctx, found.point);
    return status;
}

/* --- all rounds --- */

static brio_status run_round(completing *c, bool *any) {
    *any = false;
    for (uint32_t i = 0; i < RANK_SLOTS; i++) BRIO_FORWARD(ask(c, i));
    for (uint32_t i = 0; i < RANK_SLOTS; i++) BRIO_FORWARD(serve(c));
    for (uint32_t i = 0; i < RANK_SLOTS; i++) BRIO_FORWARD(take(c, i, any));
    *any |= c->next_tile < c->r->t->num_tiles;
    BRIO_FORWARD(brio_progress(c->r->ctx, "insert", (double)c->next_tile / (c->r->t->num_tiles + 1.0)));
    BRIO_FORWARD(brio_exchange_now(&c->r->x, *any));
    *any = c->r->x.any;
    return BRIO_OK;
}

brio_status brio_ranks_complete(brio_ranks *r) {
    brio_status status = BRIO_OK;
    completing c = {.r = r, .found = {.ctx = r->ctx}, .bytes_before = r->x.bytes};
    BRIO_TRY(BRIO_ALLOC(r->ctx, c.balls, BRIO_COMPLETION_BALLS));
    BRIO_TRY(exchange_samples(r));
    for (bool any = true; any;) BRIO_TRY(run_round(&c, &any));
    r->question_bytes = r->x.bytes - c.bytes_before;
done:
    for (int i = 0; i < RANK_SLOTS; i++) {
        brio_tile_end(c.slots[i].work);
        brio_release(r->ctx, c.slots[i].pending);
    }
    for (int i = 0; i < r->ranks * RANK_SLOTS; i++) {
        brio_tile_source_free(r->served[i].source);
        r->served[i].source = NULL;
    }
    brio_release(r->ctx, c.balls);
    brio_release(r->ctx, c.found.point);
    return status;
}
