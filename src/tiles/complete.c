/* One tile: its own points and a coarse sample of the others are completed, and the tetrahedra that belong to the tile
 * go to its file. A tetrahedron belongs to the tile of its lexicographically least vertex, so to exactly one; that tile
 * has the star of that vertex. */
#include "base/memory.h"
#include "tiles/work.h"
#include <assert.h>
#include <stdio.h>
#include <string.h>

enum { BUFFER = 1 << 13 };

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

static const char MAGIC[8] = {'b', 'r', 'i', 'o', 't', 'i', 'l', '2'};

typedef struct {
    brio_tiles *t;
    brio_tile *facts;
    brio_store_file out;
    uint32_t (*buffer)[4];
    size_t num_buffer;
    uint32_t *halo_row; /* of each known point that is not an own one: 1 + its row of the halo, or 0 */
    size_t num_rows, row_capacity;
    uint64_t *halo;
    size_t halo_capacity;
} writing;

/* --- tetrahedra --- */

static bool belongs_here(const writing *w, const brio_set_point *known, const uint32_t *v, int count) {
    int least = 0;
    for (int i = 1; i < count; i++)
        if (brio_lexicographic(known[v[i]].record, known[v[least]].record) < 0) least = i;
    return v[least] < w->facts->points;
}

/* Finds the row of a known point of another tile in the halo. */
static brio_status find_row(writing *w, const brio_set_point *known, uint32_t v, uint32_t *row) {
    brio_context *ctx = w->t->ctx;
    size_t at = v - w->facts->points, before = w->num_rows;
    if (at >= before) {
        BRIO_FORWARD(BRIO_RESERVE(ctx, w->halo_row, w->row_capacity, at + 1));
        memset(w->halo_row + before, 0, (at + 1 - before) * sizeof *w->halo_row);
        w->num_rows = at + 1;
    }
    if (!w->halo_row[at]) {
        BRIO_FORWARD(BRIO_RESERVE(ctx, w->halo, w->halo_capacity, w->facts->halo + 1));
        w->halo[w->facts->halo++] = known[v].name;
        w->halo_row[at] = (uint32_t)w->facts->halo;
    }
    *row = w->facts->points + w->halo_row[at] - 1;
    return BRIO_OK;
}

static brio_status flush(writing *w) {
    brio_status status = brio_store_append(&w->out, w->buffer, w->num_buffer * sizeof *w->buffer);
    w->num_buffer = 0;
    return status;
}

/* Takes final tetrahedra, as a brio_final_fn. */
static brio_status take(void *user, const brio_set_point *known, const uint32_t (*vertex)[4], size_t count) {
    writing *w = user;
    for (size_t i = 0; i < count; i++) {
        const uint32_t *v = vertex[i];
        bool finite = v[3] != BRIO_INFINITE;
        if (!belongs_here(w, known, v, finite ? 4 : 3)) continue;
        w->facts->hull_facets += !finite;
        if (!finite) continue;
        w->facts->tetrahedra++;
        uint32_t *to = w->buffer[w->num_buffer++];
        for (int k = 0; k < 4; k++) {
            to[k] = v[k];
            if (v[k] >= w->facts->points) BRIO_FORWARD(find_row(w, known, v[k], &to[k]));
        }
        if (w->num_buffer == BUFFER) BRIO_FORWARD(flush(w));
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
 * sample. */
static brio_status list_known(brio_tiles *t, uint32_t tile, brio_tile_source *source, brio_found *list,
                              brio_ball_box *seen) {
    const brio_tile *facts = &t->tile[tile];
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
    BRIO_FORWARD(brio_tile_halo(t, tile, list, seen));
    return brio_tile_coarse_sample(source, list);
}

static void note_facts(brio_tile *facts, const brio_completion_stats *s, const brio_tile_source *source,
                       size_t num_known) {
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
}

static brio_status write_rest(writing *w, uint32_t tile, const uint8_t *is_vertex) {
    brio_store_file *f = &w->out;
    char name[32];
    tile_head head;
    memset(&head, 0, sizeof head);
    head.key = w->t->key, head.tile = tile, head.points = w->facts->points, head.facts = *w->facts;
    memcpy(head.magic, MAGIC, sizeof head.magic);
    snprintf(name, sizeof name, "tile-%u", tile);
    BRIO_FORWARD(flush(w));
    BRIO_FORWARD(brio_store_append(f, w->halo, w->facts->halo * sizeof *w->halo));
    BRIO_FORWARD(brio_store_append(f, is_vertex, w->facts->points));
    head.hash = f->hash;
    head.own = brio_tiles_hash(head.key, &head, sizeof head);
    BRIO_FORWARD(brio_store_write(f, 0, &head, sizeof head));
    return brio_store_publish(f, name);
}

/* Asks the questions of a round. */
static brio_status ask(brio_completion *c, size_t questions, brio_tile_source *source, brio_ball *balls,
                       brio_found *found) {
    brio_tile_source_round(source);
    for (size_t first = 0; first < questions; first += BRIO_COMPLETION_BALLS) {
        size_t n = questions - first < BRIO_COMPLETION_BALLS ? questions - first : BRIO_COMPLETION_BALLS;
        brio_completion_balls(c, first, n, balls);
        found->count = 0;
        BRIO_FORWARD(brio_tile_conflicts(source, balls, n, found));
        BRIO_FORWARD(brio_completion_take(c, found->point, found->count));
        for (size_t i = 0; i < n; i++)
            if (balls[i].is_free) brio_completion_is_free(c, first + i);
    }
    return BRIO_OK;
}

static brio_status run_rounds(brio_tiles *t, brio_completion *c, brio_tile_source *source) {
    brio_status status = BRIO_OK;
    brio_ball *balls = NULL;
    brio_found found = {.ctx = t->ctx};
    BRIO_TRY(BRIO_ALLOC(t->ctx, balls, BRIO_COMPLETION_BALLS));
    for (bool goes_on = true; goes_on;) {
        size_t questions;
        BRIO_TRY(brio_completion_begin(c, &questions));
        BRIO_TRY(ask(c, questions, source, balls, &found));
        BRIO_TRY(brio_completion_end(c, &goes_on));
    }
done:
    brio_release(t->ctx, balls);
    brio_release(t->ctx, found.point);
    return status;
}

static brio_status complete(brio_tiles *t, uint32_t tile, writing *w) {
    brio_status status = BRIO_OK;
    brio_bar bar = brio_progress_bar(t->ctx);
    brio_tile_source *source = NULL;
    brio_completion *c = NULL;
    brio_found list = {.ctx = t->ctx};
    uint8_t *is_vertex = NULL;
    brio_ball_box seen;
    BRIO_TRY(brio_tile_source_new(t, tile, &source));
    BRIO_TRY(list_known(t, tile, source, &list, &seen));
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, is_vertex, w->facts->points + 1));
    brio_completion_task task = {.points = list.point,
                                 .num_own = w->facts->points,
                                 .num_points = list.count,
                                 .weighted = t->weighted,
                                 .all = t->all,
                                 .home = &seen,
                                 .final = take,
                                 .final_user = w};
    BRIO_TRY(brio_completion_new(t->ctx, &task, &c));
    brio_release(t->ctx, list.point);
    list.point = NULL;
    BRIO_TRY(run_rounds(t, c, source));
    brio_completion_vertices(c, is_vertex);
    note_facts(w->facts, brio_completion_facts(c), source, list.count);
    status = write_rest(w, tile, is_vertex);
done:
    brio_completion_delete(c);
    brio_tile_source_free(source);
    brio_release(t->ctx, list.point);
    brio_release(t->ctx, is_vertex);
    brio_progress_part(t->ctx, bar, 0, 1);
    return status;
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
    uint64_t size = facts->tetrahedra * 4 * sizeof(uint32_t) + facts->halo * sizeof(uint64_t) + head->points;
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

brio_status brio_tiles_complete(brio_tiles *t, uint32_t tile) {
    writing w = {.t = t, .facts = &t->tile[tile], .out.file = -1};
    const brio_tile before = *w.facts;
    brio_status status = BRIO_OK;
    tile_head none = {.points = 0};
    bool found = false;
    if (!before.points || before.finished) return BRIO_OK;
    if (t->key) BRIO_TRY(take_finished(t, tile, &found));
    t->stats.resumed += found;
    if (found) goto done;
    BRIO_TRY(brio_store_create(&t->folder, "tile.new", &w.out));
    BRIO_TRY(brio_store_append(&w.out, &none, sizeof none));
    w.out.hashes = t->key != 0;
    BRIO_TRY(BRIO_ALLOC(t->ctx, w.buffer, BUFFER));
    status = complete(t, tile, &w);
done:
    if (status != BRIO_OK) *w.facts = before; /* the tile may be tried again */
    brio_store_close(&w.out);
    brio_release(t->ctx, w.buffer);
    brio_release(t->ctx, w.halo_row);
    brio_release(t->ctx, w.halo);
    return status;
}

/* --- results --- */

void brio_tile_result_free(brio_tiles *t, brio_tile_result *r) {
    brio_release(t->ctx, r->tetrahedra);
    brio_release(t->ctx, r->halo);
    brio_release(t->ctx, r->is_vertex);
    *r = (brio_tile_result){0};
}

brio_status brio_tile_result_read(brio_tiles *t, uint32_t tile, brio_tile_result *out) {
    const brio_tile *facts = &t->tile[tile];
    brio_store_file f = {.file = -1};
    brio_status status = BRIO_OK;
    char name[32];
    uint64_t at = sizeof(tile_head);
    *out = (brio_tile_result){0};
    snprintf(name, sizeof name, "tile-%u", tile);
    BRIO_TRY(BRIO_ALLOC(t->ctx, out->tetrahedra, facts->tetrahedra + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, out->halo, facts->halo + 1));
    BRIO_TRY(BRIO_ALLOC(t->ctx, out->is_vertex, facts->points + 1));
    if (!facts->points) goto done;
    BRIO_TRY(brio_store_open(&t->folder, name, &f));
    BRIO_TRY(brio_store_read(&f, at, out->tetrahedra, facts->tetrahedra * sizeof *out->tetrahedra));
    at += facts->tetrahedra * sizeof *out->tetrahedra;
    BRIO_TRY(brio_store_read(&f, at, out->halo, facts->halo * sizeof *out->halo));
    at += facts->halo * sizeof *out->halo;
    BRIO_TRY(brio_store_read(&f, at, out->is_vertex, facts->points));
done:
    brio_store_close(&f);
    if (status != BRIO_OK) brio_tile_result_free(t, out);
    return status;
}
