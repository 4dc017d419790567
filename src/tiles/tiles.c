/* Triangulations in tiles: the public functions, and the order of the stages. */
#include "brio/tiles.h"
#include "base/float_state.h"
#include "base/kept.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/versioned.h"
#include "platform/folder.h"
#include "platform/thread.h"
#include "tiles/cells.h"
#include "tiles/work.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { TILES = 8, MOST_TILES = 1 << 16 };

/* Bytes of memory for each point of the largest tile: its triangulation with a halo. For its cells: of each point, and
 * of each site of a slab. All measured: tiles.md. */
static const double BYTES_A_POINT = 520, CELLS_A_POINT = 300, SLAB_A_SITE = 3600;
/* Bytes of a tile's work whatever the number of points, and of each thread of it. Measured on 30,000 points. */
static const double TILE_BYTES = 27e5, THREAD_BYTES = 335e3;
/* Of the block of points that the caller hands over: 65,536 with a property. */
static const double BLOCK_BYTES = 2e6;
/* For a certificate of an alpha shape: faces for each point of the tile, of which uniform points have up to 2.7, at the
 * worst alpha, and surfaces 2; bytes of a face in its part. Both measured: tiles.md. */
static const double FACES_A_POINT = 2.7, CERTIFICATE_A_FACE = 150;
/* Bytes of the disk for each point, when the ranks are made: points, tetrahedra, runs; and when cells are sorted, with
 * faces or without: points, tetrahedra, cells. Measured: tiles.md. */
static const double DISK_A_POINT = 195, DISK_WITH_FACES = 850, DISK_WITH_CELLS = 240;

/* --- life --- */

/* Makes the folder, or takes one that a killed process left: with a key to go on, without one for its room. */
static brio_status begin_folder(brio_tiles *t, const char *scratch) {
    char name[64];
    if (!t->key) return brio_store_begin_free(t->ctx, scratch, "brio-tiles", &t->folder);
    snprintf(name, sizeof name, "brio-tiles-%016" PRIx64, t->key);
    return brio_store_begin(t->ctx, scratch, name, &t->folder);
}

/* Refuses tiles whose files' buffers do not fit. */
static brio_status require_room_to_divide(const brio_tiles *t) {
    double need = brio_tiles_divide_bytes(t) + BLOCK_BYTES, limit = (double)brio_memory_limit(t->ctx);
    BRIO_EXPECT(t->ctx, need <= limit, BRIO_ERR_NO_MEMORY,
                "%u tiles need about %.1f MB, for any number of points, of the %.1f MB that are allowed", t->num_tiles,
                need / 1e6, limit / 1e6);
    return BRIO_OK;
}

brio_status brio_tiles_new(brio_context *ctx, const brio_tiles_options *options, brio_tiles **out) {
    BRIO_DOOR;
    brio_tiles_options o = {0};
    brio_tiles *t = NULL;
    brio_status status = BRIO_OK;
    *out = NULL;
    BRIO_TRY(BRIO_TAKE(ctx, brio_tiles_options, options, &o));
    BRIO_REQUIRE(ctx, o.scratch, BRIO_ERR_ARGUMENT, "tiles need a scratch folder");
    BRIO_REQUIRE(ctx, o.stars >= 0 && o.stars <= 4, BRIO_ERR_ARGUMENT, "brio_tiles_options.stars is %d", o.stars);
    BRIO_REQUIRE(ctx, o.tiles <= MOST_TILES, BRIO_ERR_ARGUMENT, "%u tiles; at most %d", o.tiles, MOST_TILES);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, t, 1));
    t->ctx = ctx;
    t->raw.file = -1;
    t->folder.lock = -1;
    t->num_tiles = o.tiles ? o.tiles : TILES;
    t->stars = o.stars != 0;
    t->sorts_cells = o.stars == 1 || o.stars == 3;
    t->sorts_faces = o.stars == 1;
    t->certifies = o.stars == 4;
    t->key = o.key ? brio_hash(o.key, t->num_tiles) : 0;
    t->stats.size = sizeof t->stats;
    t->cells.size = sizeof t->cells;
    t->stats.dimension = -1;
    BRIO_TRY(begin_folder(t, o.scratch));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, t->tile, t->num_tiles));
    if (t->key) BRIO_TRY(brio_tiles_restore(t, &t->has_points));
    if (!t->has_points) brio_store_clear(&t->folder);
    if (!t->has_points) BRIO_TRY(require_room_to_divide(t));
    *out = t;
    t = NULL;
done:
    brio_tiles_free(t);
    return status;
}

void brio_tiles_free(brio_tiles *t) {
    if (!t) return;
    brio_store_close(&t->raw);
    brio_store_end(&t->folder);
    brio_release(t->ctx, t->some);
    brio_tile_cuts_free(t->ctx, &t->cuts);
    brio_release(t->ctx, t->tile);
    brio_release(t->ctx, t->node);
    brio_release(t->ctx, t);
}

int brio_tiles_has_points(const brio_tiles *t) {
    return t->has_points;
}

const brio_tiles_stats *brio_tiles_facts(const brio_tiles *t) {
    return &t->stats;
}

brio_status brio_tiles_add(brio_context *ctx, brio_tiles *t, const double *points, const double *weights,
                           size_t num_points) {
    BRIO_DOOR;
    BRIO_EXPECT(ctx, ctx == t->ctx, BRIO_ERR_ARGUMENT, "the tiles are of another context");
    BRIO_EXPECT(ctx, !t->has_points && !t->torn, BRIO_ERR_ARGUMENT, "the tiles have all their points already");
    if (!num_points) return BRIO_OK;
    if (!t->stats.points) t->weighted = weights != NULL;
    BRIO_EXPECT(ctx, !weights == !t->weighted, BRIO_ERR_ARGUMENT, "earlier points have %s, and these have %s",
                t->weighted ? "weights" : "no weights", weights ? "some" : "none");
    return brio_tiles_take(t, points, weights, num_points, t->stats.points);
}

/* --- points by place --- */

brio_status brio_tile_points(brio_tiles *t, uint64_t place, size_t count, brio_set_point *points) {
    brio_store_file f = {.file = -1};
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_store_open(&t->folder, "points", &f));
    BRIO_TRY(brio_store_read(&f, (place - t->first_place) * sizeof *points, points, count * sizeof *points));
done:
    brio_store_close(&f);
    return status;
}

brio_status brio_tile_rows(const brio_store_file *f, const uint64_t *places, size_t count, size_t size, void *rows) {
    enum { WINDOW = 1 << 14 };
    char window[WINDOW];
    size_t in_window = WINDOW / size;
    for (size_t i = 0, end; i < count; i = end) {
        uint64_t first = places[i];
        for (end = i; end < count && places[end] - first < in_window; end++) {}
        BRIO_FORWARD(brio_store_read(f, first * size, window, (places[end - 1] - first + 1) * size));
        for (size_t k = i; k < end; k++) memcpy((char *)rows + k * size, window + (places[k] - first) * size, size);
    }
    return BRIO_OK;
}

/* --- saved state --- */

typedef struct {
    char magic[8];
    uint64_t key, num_nodes;
    size_t sizes[3];
    brio_tiles_stats stats;
    brio_ball_box all;
    double lightest;
    uint64_t weighted;
    brio_set_point extreme[TILE_DIRECTIONS], basis[4];
    int num_basis;
    uint64_t points_hash;
    uint64_t hash; /* of the head, with a 0 here, of tiles and nodes */
} saved_head;

static const char MAGIC[8] = {'b', 'r', 'i', 'o', 't', 'l', 's', '2'};

uint64_t brio_tiles_hash(uint64_t hash, const void *bytes, size_t size) {
    for (size_t i = 0; i < size; i += 8) {
        uint64_t word = 0;
        memcpy(&word, (const char *)bytes + i, size - i < 8 ? size - i : 8);
        hash = brio_mix(hash ^ word);
    }
    return hash;
}

static saved_head head_of(const brio_tiles *t) {
    saved_head h;
    memset(&h, 0, sizeof h);
    memcpy(h.magic, MAGIC, sizeof MAGIC);
    h.key = t->key;
    h.num_nodes = t->num_nodes;
    h.sizes[0] = sizeof h, h.sizes[1] = sizeof *t->tile, h.sizes[2] = sizeof *t->node;
    h.stats = t->stats;
    h.all = t->all;
    h.lightest = t->lightest;
    h.weighted = t->weighted;
    memcpy(h.extreme, t->extreme, sizeof h.extreme);
    memcpy(h.basis, t->basis, sizeof h.basis);
    h.num_basis = t->num_basis;
    h.points_hash = t->points_hash;
    return h;
}

/* Returns the hash of a head whose own hash is 0, and of what follows it. */
static uint64_t hash_state(const brio_tiles *t, const saved_head *h) {
    uint64_t hash = brio_tiles_hash(brio_tiles_hash(h->key, h, sizeof *h), t->tile, t->num_tiles * sizeof *t->tile);
    return brio_tiles_hash(hash, t->node, h->num_nodes * sizeof *t->node);
}

/* Tells whether the file of points is whole. */
static brio_status check_points(brio_tiles *t, uint64_t hash, bool *is_good) {
    brio_store_file f = {.file = -1};
    uint64_t places = 0;
    *is_good = false;
    for (uint32_t i = 0; i < t->num_tiles; i++) places += t->tile[i].points;
    if (!brio_store_has(&t->folder, "points")) return BRIO_OK;
    brio_status status = brio_store_open(&t->folder, "points", &f);
    if (status == BRIO_OK && f.size == places * sizeof(brio_set_point)) status = brio_store_check(&f, 0, hash, is_good);
    brio_store_close(&f);
    return status;
}

brio_status brio_tiles_save(brio_tiles *t) {
    brio_store_file f = {.file = -1};
    brio_status status = BRIO_OK;
    saved_head h = head_of(t);
    h.hash = hash_state(t, &h);
    BRIO_TRY(brio_store_create(&t->folder, "state.new", &f));
    BRIO_TRY(brio_store_append(&f, &h, sizeof h));
    BRIO_TRY(brio_store_append(&f, t->tile, t->num_tiles * sizeof *t->tile));
    BRIO_TRY(brio_store_append(&f, t->node, t->num_nodes * sizeof *t->node));
    status = brio_store_publish(&f, "state");
done:
    brio_store_close(&f);
    return status;
}

/* Reads what brio_tiles_save wrote. A file that is not whole, or of another version, is as none. */
static brio_status restore(brio_tiles *t, brio_store_file *f, bool *found) {
    saved_head h, expected = head_of(t);
    BRIO_FORWARD(brio_store_open(&t->folder, "state", f));
    if (f->size < sizeof h) return BRIO_OK;
    BRIO_FORWARD(brio_store_read(f, 0, &h, sizeof h));
    size_t tiles = t->num_tiles * sizeof *t->tile, nodes = h.num_nodes * sizeof *t->node;
    if (memcmp(h.magic, MAGIC, sizeof MAGIC) || h.key != t->key || memcmp(h.sizes, expected.sizes, sizeof h.sizes) ||
        f->size != sizeof h + tiles + nodes)
        return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, t->node, h.num_nodes + 1));
    BRIO_FORWARD(brio_store_read(f, sizeof h, t->tile, tiles));
    BRIO_FORWARD(brio_store_read(f, sizeof h + tiles, t->node, nodes));
    uint64_t hash = h.hash;
    h.hash = 0;
    if (hash_state(t, &h) != hash) return BRIO_OK;
    BRIO_FORWARD(check_points(t, h.points_hash, found));
    if (!*found) return BRIO_OK;
    t->points_hash = h.points_hash;
    t->num_nodes = t->node_capacity = h.num_nodes;
    t->stats = h.stats;
    t->all = h.all;
    t->lightest = h.lightest;
    t->weighted = h.weighted != 0;
    memcpy(t->extreme, h.extreme, sizeof h.extreme);
    memcpy(t->basis, h.basis, sizeof h.basis);
    t->num_basis = h.num_basis;
    return BRIO_OK;
}

brio_status brio_tiles_restore(brio_tiles *t, bool *found) {
    brio_store_file f = {.file = -1};
    *found = false;
    if (!brio_store_has(&t->folder, "state")) return BRIO_OK;
    brio_status status = restore(t, &f, found);
    brio_store_close(&f);
    if (*found || status != BRIO_OK) return status;
    memset(t->tile, 0, t->num_tiles * sizeof *t->tile);
    brio_release(t->ctx, t->node);
    t->node = NULL;
    return BRIO_OK;
}

void brio_tiles_forget(brio_tiles *t) {
    brio_store_clear(&t->folder);
    memset(t->tile, 0, t->num_tiles * sizeof *t->tile);
    brio_release(t->ctx, t->node);
    t->node = NULL;
    t->num_nodes = t->node_capacity = 0;
    t->stats = (brio_tiles_stats){.size = sizeof t->stats, .dimension = -1};
    t->num_basis = 0;
    t->has_points = false;
}

void brio_tiles_leave(brio_tiles *t) {
    brio_store_leave(&t->folder);
}

/* --- all stages --- */

double brio_tiles_least_memory(const brio_tiles_options *o, double points) {
    return BYTES_A_POINT * points / (o->tiles ? o->tiles : TILES);
}

/* Returns the bytes for tiles of at most `points`, of which there are about `tiles`. */
static double bytes_of_tiles(const brio_tiles *t, double points, double tiles, int at_once) {
    double index = (double)t->num_nodes * sizeof *t->node + tiles * (sizeof *t->tile + sizeof *t->cuts.cut);
    double triangulating = at_once * points * BYTES_A_POINT + brio_tile_source_bytes(t);
    double needed = fmax(triangulating, brio_tiles_merge_bytes(t->ctx, (size_t)tiles));
    if (t->stars) {
        double cells = points * CELLS_A_POINT + fmin(points, BRIO_SLAB_SITES) * SLAB_A_SITE;
        if (t->sorts_cells) cells += brio_ordered_cells_buffers(t->ctx, (size_t)tiles, t->sorts_faces);
        if (t->certifies) cells += points * FACES_A_POINT * CERTIFICATE_A_FACE;
        needed = fmax(needed, cells);
    }
    return index + TILE_BYTES + brio_context_threads(t->ctx) * THREAD_BYTES + needed;
}

brio_status brio_tiles_require_memory(brio_tiles *t, int at_once) {
    double most = 0, limit = (double)brio_memory_limit(t->ctx), tiles = t->num_tiles;
    for (uint32_t i = 0; i < t->num_tiles; i++) most = fmax(most, t->tile[i].points);
    double need = bytes_of_tiles(t, most, tiles, at_once);
    if (need <= limit) return BRIO_OK;
    for (double all = 1.2 * most * tiles; tiles < MOST_TILES; tiles = ceil(tiles * 1.02))
        if (bytes_of_tiles(t, all / tiles, tiles, at_once) <= limit) break;
    BRIO_EXPECT(t->ctx, tiles < MOST_TILES, BRIO_ERR_NO_MEMORY,
                "the largest of %u tiles has %.0f points, and needs about %.0f MB, but %.1f MB are allowed, in which "
                "no number of tiles fits",
                t->num_tiles, most, need / 1e6, limit / 1e6);
    return brio_fail(
        t->ctx, BRIO_ERR_NO_MEMORY,
        "the largest of %u tiles has %.0f points, and needs about %.0f MB of the %.0f MB that are allowed: take "
        "about %.0f tiles",
        t->num_tiles, most, need / 1e6, limit / 1e6, tiles);
}

brio_status brio_tiles_require_disk(brio_tiles *t, double n) {
    uint64_t room;
    double each = t->sorts_faces ? DISK_WITH_FACES : t->sorts_cells ? DISK_WITH_CELLS : DISK_A_POINT;
    double need = n * (each - sizeof(brio_set_point));
    if (!brio_free_bytes(t->folder.path, &room)) return BRIO_OK;
    BRIO_EXPECT(t->ctx, need <= (double)room, BRIO_ERR_WRITE,
                "%s: %.0f points need about %.0f MB more on this disk, which has room for %.0f MB", t->folder.path, n,
                need / 1e6, (double)room / 1e6);
    return BRIO_OK;
}

void brio_tiles_add_facts(brio_tiles *t) {
    brio_tiles_stats *s = &t->stats;
    uint64_t positions = 0;
    s->vertices = s->tetrahedra = s->hull_facets = s->asked = s->found = s->sampled = s->read = s->triangulated = 0;
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        const brio_tile *f = &t->tile[i];
        positions += f->points;
        s->vertices += f->vertices;
        s->tetrahedra += f->tetrahedra;
        s->hull_facets += f->hull_facets;
        s->asked += f->asked;
        s->found += f->found;
        s->sampled += f->sampled;
        s->read += f->read;
        s->triangulated += f->triangulated;
        if (f->rounds > s->most_rounds) s->most_rounds = f->rounds;
        if (f->most_points > s->most_points) s->most_points = f->most_points;
        if (f->most_tetrahedra > s->most_tetrahedra) s->most_tetrahedra = f->most_tetrahedra;
    }
    if (s->dimension < 3) s->vertices = positions;
    s->hidden = positions - s->vertices;
    s->weighted = t->weighted;
    s->scratch_bytes = t->folder.most;
}

static brio_status triangulate(brio_tiles *t, brio_bar bar) {
    double done = 0, all = 0;
    for (uint32_t i = 0; i < t->num_tiles; i++) all += t->tile[i].points;
    for (uint32_t i = 0; i < t->num_tiles; i++) {
        double next = done + t->tile[i].points;
        brio_progress_part(t->ctx, bar, 0.15 + 0.85 * done / all, 0.15 + 0.85 * next / all);
        BRIO_FORWARD(brio_tiles_complete(t, i));
        done = next;
    }
    return BRIO_OK;
}

brio_status brio_tiles_run(brio_context *ctx, brio_tiles *t) {
    BRIO_DOOR;
    brio_status status = BRIO_OK;
    brio_bar bar = brio_progress_bar(ctx);
    double start = brio_seconds();
    brio_keep_begin(ctx); /* a tile takes the memory of the tile before it */
    BRIO_REQUIRE(ctx, ctx == t->ctx, BRIO_ERR_ARGUMENT, "the tiles are of another context");
    BRIO_REQUIRE(ctx, !t->has_result, BRIO_ERR_ARGUMENT, "the tiles are triangulated already");
    BRIO_REQUIRE(ctx, !t->torn, BRIO_ERR_ARGUMENT, "an earlier run ended while it divided the points: add them anew");
    if (!t->has_points) {
        BRIO_TRY(brio_tiles_require_disk(t, (double)t->stats.points));
        t->torn = true;
        brio_progress_part(ctx, bar, 0, 0.05);
        BRIO_TRY(brio_tiles_divide(t));
        brio_progress_part(ctx, bar, 0.05, 0.15);
        BRIO_TRY(brio_tiles_arrange(t));
        t->has_points = true;
        t->torn = false;
        if (t->key) BRIO_TRY(brio_tiles_save(t));
    }
    t->stats.divide_seconds = brio_seconds() - start;
    start = brio_seconds();
    BRIO_REQUIRE(
        ctx, !t->weighted || t->stats.dimension == 3 || t->stats.points < 2, BRIO_ERR_NO_ANSWER,
        "all points are in a plane, and have weights: there are no tetrahedra, and which points are hidden is found "
        "without tiles only");
    if (t->stats.dimension == 3) {
        BRIO_TRY(brio_tiles_require_memory(t, 1));
        BRIO_TRY(triangulate(t, bar));
    }
    brio_tiles_add_facts(t);
    if (t->stats.points) memcpy(t->stats.low, t->all.low, sizeof t->stats.low);
    if (t->stats.points) memcpy(t->stats.high, t->all.high, sizeof t->stats.high);
    t->has_result = true;
    t->stats.triangulate_seconds = brio_seconds() - start;
done:
    brio_keep_end(ctx);
    brio_progress_part(ctx, bar, 0, 1);
    return status;
}

brio_status brio_tiles_checksum(brio_context *ctx, brio_tiles *t, uint64_t *checksum) {
    BRIO_DOOR;
    double start = brio_seconds();
    BRIO_EXPECT(ctx, ctx == t->ctx, BRIO_ERR_ARGUMENT, "the tiles are of another context");
    BRIO_EXPECT(ctx, t->has_result, BRIO_ERR_ARGUMENT, "the tiles are not triangulated yet");
    brio_keep_begin(ctx);
    brio_status status = brio_tiles_sum(t, checksum);
    brio_keep_end(ctx);
    t->stats.scratch_bytes = t->folder.most;
    t->stats.rank_seconds = brio_seconds() - start;
    return status;
}
