/* One tile: its own points, those near its border and a coarse sample of the others are completed, and the tetrahedra
 * that belong to the tile go to its file. A tetrahedron belongs to the tile of its lexicographically least vertex, so
 * to exactly one; that tile has the star of that vertex.
 *
 * The vertices of a tetrahedron in the file are known points, own ones first: those of other tiles are the halo. */
#include "base/memory.h"
#include "tiles/work.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

/* The head of a tile's file; what follows it is in the order of the counts. */
typedef struct {
    char magic[8];
    uint64_t key;
    uint32_t tile, points;
    brio_tile facts;
    uint64_t hash; /* of what follows */
    uint64_t own;  /* of the head itself, with a 0 here */
} tile_head;

_Static_assert(sizeof(tile_head) % 8 == 0, "whole words");

static const char MAGIC[8] = {'b', 'r', 'i', 'o', 't', 'i', 'l', '3'};

enum { BUFFER = 1 << 13 }; /* tetrahedra of the border */

struct brio_tile_work {
    brio_tiles *t;
    uint32_t tile;
    brio_tile *facts, before;
    brio_ball_box seen; /* all points in it are known from the beginning */
    brio_tile_source *source;
    brio_completion *completion;
    size_t num_known;            /* from the beginning */
    brio_store_file out, border; /* the border is copied to the end of `out` */
    uint32_t (*buffer)[4];       /* what the border has not yet */
    size_t num_buffer;
    uint64_t *halo;
};

typedef brio_tile_work writing;

/* --- tetrahedra --- */

/* Takes final tetrahedra that belong to the tile, as a brio_final_fn. */
static brio_status take(void *user, const brio_set_point *known, const uint32_t (*vertex)[4], size_t count) {
    writing *w = user;
    (void)known;
    for (size_t i = 0, end; i < count; i = end + 1) { /* up to an infinite one */
        for (end = i; end < count && vertex[end][3] != BRIO_INFINITE;) end++;
        w->facts->hull_facets += end < count;
        w->facts->tetrahedra += end - i;
        BRIO_FORWARD(brio_store_append(&w->out, vertex + i, (end - i) * sizeof *vertex));
    }
    return BRIO_OK;
}

static bool belongs_here(const writing *w, const brio_set_point *known, const uint32_t *v, int count) {
    int least = 0;
    for (int i = 1; i < count; i++)
        if (brio_lexicographic(known[v[i]].record, known[v[least]].record) < 0) least = i;
    return v[least] < w->facts->points;
}

static void name_border(const writing *w, char name[32]) {
    snprintf(name, 32, "border-%u", w->tile);
}

static brio_status begin_border(writing *w) {
    char name[32];
    name_border(w, name);
    BRIO_FORWARD(brio_store_create(&w->t->folder, name, &w->border));
    return BRIO_ALLOC(w->t->ctx, w->buffer, BUFFER);
}

static void end_border(writing *w) {
    char name[32];
    name_border(w, name);
    brio_store_close(&w->border);
    brio_store_remove(&w->t->folder, name);
}

static brio_status flush_border(writing *w) {
    brio_status status = brio_store_append(&w->border, w->buffer, w->num_buffer * sizeof *w->buffer);
    w->num_buffer = 0;
    return status;
}

/* Takes final tetrahedra of all stars, as a brio_final_fn. */
static brio_status take_stars(void *user, const brio_set_point *known, const uint32_t (*vertex)[4], size_t count) {
    writing *w = user;
    for (size_t i = 0, end; i < count; i = end + 1) { /* up to one of the border */
        bool here = true, finite = true;
        for (end = i; end < count; end++) {
            finite = vertex[end][3] != BRIO_INFINITE;
            here = belongs_here(w, known, vertex[end], finite ? 4 : 3);
            if (!finite || !here) break;
        }
        w->facts->tetrahedra += end - i;
        BRIO_FORWARD(brio_store_append(&w->out, vertex + i, (end - i) * sizeof *vertex));
        if (end == count) break;
        w->facts->hull_facets += here && !finite;
        w->facts->border++;
        memcpy(w->buffer[w->num_buffer++], vertex[end], sizeof *vertex);
        if (w->num_buffer == BUFFER) BRIO_FORWARD(flush_border(w));
    }
    return BRIO_OK;
}

/* Appends the border to the tile's file. */
static brio_status copy_border(writing *w) {
    BRIO_FORWARD(flush_border(w));
    for (uint64_t done = 0; done < w->facts->border; done += BUFFER) {
        size_t some = w->facts->border - done < BUFFER ? (size_t)(w->facts->border - done) : BUFFER;
        size_t size = some * sizeof *w->buffer;
        BRIO_FORWARD(brio_store_read(&w->border, done * sizeof *w->buffer, w->buffer, size));
        BRIO_FORWARD(brio_store_append(&w->out, w->buffer, size));
    }
    return BRIO_OK;
}

/* --- a tile --- */

static bool is_known(const brio_set_point *points, size_t begin, size_t end, uint64_t name) {
    for (size_t i = begin; i < end; i++)
        if (points[i].name == name) return true;
    return false;
}

/* Lists the points that are known from the beginning: own ones, extreme ones, a basis, those near the border, a coarse
 * sample; and those of other processes. */
static brio_status list_known(const writing *w, const brio_found *more, brio_found *list) {
    brio_tiles *t = w->t;
    const brio_tile *facts = w->facts;
    size_t n = facts->points;
    BRIO_FORWARD(BRIO_RESERVE(t->ctx, list->point, list->capacity, n + TILE_DIRECTIONS + 4));
    BRIO_FORWARD(brio_tile_points(t, facts->place, n, list->point));
    for (size_t i = 0; i < n; i++) list->point[i].name = facts->place + i;
    list->count = n;
    for (int i = 0; i < TILE_DIRECTIONS + t->num_basis; i++) {
        const brio_set_point *p = i < t->num_basis ? &t->basis[i] : &t->extreme[i - t->num_basis];
        bool own = p->name >= facts->place && p->name - facts->place < n;
        if (!own && !is_known(list->point, n, list->count, p->name)) list->point[list->count++] = *p;
    }
    BRIO_FORWARD(brio_tile_halo_add(t, w->tile, (uint32_t)t->num_nodes - 1, &w->seen, list));
    for (size_t i = 0; more && i < more->count; i++) BRIO_FORWARD(brio_found_add(list, &more->point[i]));
    return brio_tile_coarse_sample(w->source, &t->node[facts->root].box, list);
}

static void note_facts(brio_tile *facts, const brio_completion_stats *s, const brio_tile_source *source,
                       size_t num_known, bool stars) {
    facts->vertices = s->vertices;
    facts->asked = s->asked;
    facts->found = s->found;
    facts->sampled = num_known - facts->points;
    facts->read = brio_tile_source_read(source);
    facts->triangulated = s->triangulated;
    facts->most_points = s->most_points;
    facts->most_tetrahedra = s->most_tetrahedra;
    facts->rounds = (uint32_t)s->rounds;
    facts->finished = 1;
    facts->stars = stars;
}

static brio_status write_rest(writing *w, const uint8_t *is_vertex) {
    brio_store_file *f = &w->out;
    char name[32];
    tile_head head;
    memset(&head, 0, sizeof head);
    head.key = w->t->key, head.tile = w->tile, head.points = w->facts->points, head.facts = *w->facts;
    memcpy(head.magic, MAGIC, sizeof head.magic);
    snprintf(name, sizeof name, "tile-%u", w->tile);
    BRIO_FORWARD(brio_store_append(f, w->halo, w->facts->halo * sizeof *w->halo));
    if (w->t->stars) BRIO_FORWARD(copy_border(w));
    BRIO_FORWARD(brio_store_append(f, is_vertex, w->facts->points)); /* last: all else is whole words */
    head.hash = f->hash;
    head.own = brio_tiles_hash(head.key, &head, sizeof head);
    BRIO_FORWARD(brio_store_write(f, 0, &head, sizeof head));
    return brio_store_publish(f, name);
}

/* Lists the names of the known points of other tiles. */
static brio_status list_halo(writing *w) {
    size_t own = w->facts->points, count;
    const brio_set_point *known = brio_completion_known(w->completion, &count);
    w->facts->halo = count - own;
    BRIO_FORWARD(BRIO_ALLOC(w->t->ctx, w->halo, count - own + 1));
    for (size_t i = own; i < count; i++) w->halo[i - own] = known[i].name;
    return BRIO_OK;
}

/* Returns whether a file is that of the tile as a run before wrote it, every byte of it.   head  receives its head. */
static brio_status check_finished(brio_tiles *t, uint32_t tile, const brio_store_file *f, tile_head *head,
                                  bool *is_good) {
    *is_good = false;
    if (f->size < sizeof *head) return BRIO_OK;
    BRIO_FORWARD(brio_store_read(f, 0, head, sizeof *head));
    uint64_t own = head->own;
    head->own = 0;
    if (memcmp(head->magic, MAGIC, sizeof MAGIC) || brio_tiles_hash(t->key, head, sizeof *head) != own ||
        head->key != t->key || head->tile != tile || head->points != t->tile[tile].points)
        return BRIO_OK;
    const brio_tile *facts = &head->facts;
    uint64_t size =
        (facts->tetrahedra + facts->border) * 4 * sizeof(uint32_t) + facts->halo * sizeof(uint64_t) + head->points;
    if (facts->stars < t->stars) return BRIO_OK;
    return f->size == sizeof *head + size ? brio_store_check(f, sizeof *head, head->hash, is_good) : BRIO_OK;
}

/* Takes the facts of a tile that a run before finished.   *found  receives whether there is one. */
static brio_status take_finished(brio_tiles *t, uint32_t tile, bool *found) {
    brio_store_file f = {.file = -1};
    char name[32];
    tile_head head;
    *found = false;
    snprintf(name, sizeof name, "tile-%u", tile);
    if (!brio_store_has(&t->folder, name)) return BRIO_OK;
    brio_status status = brio_store_open(&t->folder, name, &f);
    if (status == BRIO_OK) status = check_finished(t, tile, &f, &head, found);
    brio_store_close(&f);
    if (*found) t->tile[tile] = head.facts;
    return status == BRIO_ERR_OPEN ? BRIO_OK : status; /* what cannot be read is made anew */
}

static brio_status begin(brio_tile_work *w, const brio_found *more) {
    brio_status status = BRIO_OK;
    brio_tiles *t = w->t;
    brio_found list = {.ctx = t->ctx};
    tile_head none = {.points = 0};
    char name[32];
    snprintf(name, sizeof name, "new-%u", w->tile);
    BRIO_TRY(brio_store_create(&t->folder, name, &w->out));
    BRIO_TRY(brio_store_append(&w->out, &none, sizeof none));
    w->out.hashes = t->key != 0;
    if (t->stars) BRIO_TRY(begin_border(w));
    BRIO_TRY(brio_tile_source_new(t, w->tile, (uint32_t)t->num_nodes - 1, &w->seen, &w->source));
    BRIO_TRY(list_known(w, more, &list));
    w->num_known = list.count;
    brio_completion_task task = {.points = list.point,
                                 .num_own = w->facts->points,
                                 .num_points = list.count,
                                 .weighted = t->weighted,
                                 .all = t->all,
                                 .home = &w->seen,
                                 .final = t->stars ? take_stars : take,
                                 .final_user = w,
                                 .least_only = !t->stars,
                                 .any_order = true};
    status = brio_completion_new(t->ctx, &task, &w->completion);
done:
    brio_release(t->ctx, list.point);
    return status;
}

brio_status brio_tile_begin(brio_tiles *t, uint32_t tile, const brio_found *more, const brio_ball_box *seen,
                            brio_tile_work **out) {
    brio_tile_work *w = NULL;
    brio_status status = BRIO_OK;
    brio_tile *facts = &t->tile[tile];
    bool found = false;
    *out = NULL;
    if (!facts->points || facts->finished) return BRIO_OK;
    if (t->key) BRIO_TRY(take_finished(t, tile, &found));
    t->stats.resumed += found;
    if (found) goto done;
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, w, 1));
    w->t = t, w->tile = tile, w->facts = facts, w->before = *facts, w->out.file = w->border.file = -1;
    if (seen)
        w->seen = *seen;
    else
        BRIO_TRY(brio_tile_halo_box(t, tile, &w->seen));
    BRIO_TRY(begin(w, more));
    *out = w;
    w = NULL;
done:
    brio_tile_end(w);
    return status;
}

void brio_tile_end(brio_tile_work *w) {
    if (!w) return;
    brio_context *ctx = w->t->ctx;
    if (!w->facts->finished) *w->facts = w->before; /* the tile may be tried again */
    brio_completion_delete(w->completion);
    brio_tile_source_free(w->source);
    brio_store_close(&w->out);
    if (w->border.file >= 0) end_border(w);
    brio_release(ctx, w->buffer);
    brio_release(ctx, w->halo);
    brio_release(ctx, w);
}

brio_completion *brio_tile_work_completion(brio_tile_work *w) {
    return w->completion;
}

brio_tile_source *brio_tile_work_source(brio_tile_work *w) {
    return w->source;
}

brio_status brio_tile_finish(brio_tile_work *w) {
    uint8_t *is_vertex = NULL;
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(w->t->ctx, is_vertex, w->facts->points + 1));
    brio_completion_vertices(w->completion, is_vertex);
    BRIO_TRY(list_halo(w));
    note_facts(w->facts, brio_completion_facts(w->completion), w->source, w->num_known, w->t->stars);
    status = write_rest(w, is_vertex);
done:
    if (status != BRIO_OK) w->facts->finished = 0;
    brio_release(w->t->ctx, is_vertex);
    return status;
}

/* --- with one process --- */

/* Asks the questions of a round. */
static brio_status ask(brio_tile_work *w, size_t questions, brio_ball *balls, brio_found *found) {
    brio_completion *c = w->completion;
    brio_tile_source_round(w->source);
    for (size_t first = 0; first < questions; first += BRIO_COMPLETION_BALLS) {
        size_t n = questions - first < BRIO_COMPLETION_BALLS ? questions - first : BRIO_COMPLETION_BALLS;
        BRIO_FORWARD(brio_completion_balls(c, first, n, balls));
        found->count = 0;
        BRIO_FORWARD(brio_tile_conflicts(w->source, balls, n, found));
        BRIO_FORWARD(brio_completion_take(c, found->point, found->count));
        for (size_t i = 0; i < n; i++)
            if (balls[i].is_free) brio_completion_is_free(c, first + i);
    }
    return BRIO_OK;
}

static brio_status run_rounds(brio_tile_work *w) {
    brio_status status = BRIO_OK;
    brio_context *ctx = w->t->ctx;
    brio_ball *balls = NULL;
    brio_found found = {.ctx = ctx};
    BRIO_TRY(BRIO_ALLOC(ctx, balls, BRIO_COMPLETION_BALLS));
    for (bool goes_on = true; goes_on;) {
        size_t questions;
        BRIO_TRY(brio_completion_begin(w->completion, &questions));
        BRIO_TRY(ask(w, questions, balls, &found));
        BRIO_TRY(brio_completion_end(w->completion, &goes_on));
    }
done:
    brio_release(ctx, balls);
    brio_release(ctx, found.point);
    return status;
}

brio_status brio_tiles_complete(brio_tiles *t, uint32_t tile) {
    brio_status status = BRIO_OK;
    brio_bar bar = brio_progress_bar(t->ctx);
    brio_tile_work *w = NULL;
    BRIO_TRY(brio_tile_begin(t, tile, NULL, NULL, &w));
    if (!w) goto done;
    BRIO_TRY(run_rounds(w));
    status = brio_tile_finish(w);
done:
    brio_tile_end(w);
    brio_progress_part(t->ctx, bar, 0, 1);
    return status;
}

/* --- results --- */

void brio_tile_result_free(brio_tiles *t, brio_tile_result *r) {
    brio_release(t->ctx, r->tetrahedra);
    brio_release(t->ctx, r->halo);
    brio_release(t->ctx, r->is_vertex);
    *r = (brio_tile_result){0};
}

brio_status brio_tile_result_read(brio_tiles *t, uint32_t tile, bool wants_all, brio_tile_result *out) {
    const brio_tile *facts = &t->tile[tile];
    brio_store_file f = {.file = -1};
    brio_status status = BRIO_OK;
    char name[32];
    uint64_t tetrahedra = facts->tetrahedra * sizeof *out->tetrahedra, halo = facts->halo * sizeof *out->halo;
    uint64_t border = facts->border * 4 * sizeof(uint32_t);
    *out = (brio_tile_result){0};
    snprintf(name, sizeof name, "tile-%u", tile);
    BRIO_TRY(BRIO_ALLOC(t->ctx, out->is_vertex, facts->points + 1));
    if (wants_all) BRIO_TRY(BRIO_ALLOC(t->ctx, out->tetrahedra, facts->tetrahedra + 1));
    if (wants_all) BRIO_TRY(BRIO_ALLOC(t->ctx, out->halo, facts->halo + 1));
    if (!facts->points) goto done;
    BRIO_TRY(brio_store_open(&t->folder, name, &f));
    BRIO_TRY(brio_store_read(&f, sizeof(tile_head) + tetrahedra + halo + border, out->is_vertex, facts->points));
    if (!wants_all) goto done;
    BRIO_TRY(brio_store_read(&f, sizeof(tile_head), out->tetrahedra, tetrahedra));
    BRIO_TRY(brio_store_read(&f, sizeof(tile_head) + tetrahedra, out->halo, halo));
done:
    brio_store_close(&f);
    if (status != BRIO_OK) brio_tile_result_free(t, out);
    return status;
}

void brio_tile_result_remove(brio_tiles *t, uint32_t tile) {
    char name[32];
    snprintf(name, sizeof name, "tile-%u", tile);
    brio_store_remove(&t->folder, name);
}

brio_status brio_tile_halo(brio_tiles *t, uint32_t tile, uint64_t *halo) {
    const brio_tile *facts = &t->tile[tile];
    brio_store_file f = {.file = -1};
    brio_status status = BRIO_OK;
    char name[32];
    if (!facts->halo) return BRIO_OK;
    snprintf(name, sizeof name, "tile-%u", tile);
    BRIO_TRY(brio_store_open(&t->folder, name, &f));
    status = brio_store_read(&f, sizeof(tile_head) + facts->tetrahedra * 4 * sizeof(uint32_t), halo,
                             facts->halo * sizeof *halo);
done:
    brio_store_close(&f);
    return status;
}

brio_status brio_tile_border(brio_tiles *t, uint32_t tile, uint32_t (*border)[4]) {
    const brio_tile *facts = &t->tile[tile];
    brio_store_file f = {.file = -1};
    brio_status status = BRIO_OK;
    char name[32];
    uint64_t at = sizeof(tile_head) + facts->tetrahedra * 4 * sizeof(uint32_t) + facts->halo * sizeof(uint64_t);
    if (!facts->border) return BRIO_OK;
    snprintf(name, sizeof name, "tile-%u", tile);
    BRIO_TRY(brio_store_open(&t->folder, name, &f));
    BRIO_TRY(brio_store_read(&f, at, border, facts->border * sizeof *border));
done:
    brio_store_close(&f);
    return status;
}
