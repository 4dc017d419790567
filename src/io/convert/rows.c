/* Points in a scratch file, see rows.h.
 *
 * They are divided by a k-d tree over a sample, as tiles of a triangulation are. Three passes over the rows find the
 * sample, how many points each tile has, and bring them there: so each tile's rows are one piece of the new file, and
 * a tile needs no more memory than the buffer of rows that wait for their place. */
#include "io/convert/rows.h"
#include "base/memory.h"
#include "base/team.h"
#include "platform/disk.h"
#include "platform/file.h"
#include "platform/folder.h"
#include "tiles/cuts.h"
#include <assert.h>
#include <errno.h>
#include <math.h>
#include <string.h>

/* BUFFERS: bytes of rows that wait for their places, of all tiles together; MOST_WAITING of one (brio_waiting_bytes).
 * All chosen. */
enum { BUFFERS = 1 << 25, MOST_WAITING = 1 << 18, ROWS_A_THREAD = 1 << 13, POSITION = 3 * sizeof(double) };

/* --- the file --- */

static brio_status open_rows(const brio_rows *r, int *file) {
    *file = brio_open_nameless(r->folder);
    if (*file >= 0) return BRIO_OK;
    return brio_fail(r->ctx, BRIO_ERR_OPEN, "%s: not a writable folder: %s", *r->folder ? r->folder : "\"\"",
                     strerror(errno));
}

static brio_status write_rows(const brio_rows *r, int file, uint64_t place, const char *bytes, size_t size) {
    while (size > 0) {
        int64_t n = brio_write_bytes_at(file, bytes, size, place);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
            return brio_fail(r->ctx, BRIO_ERR_WRITE, "%s: cannot write a scratch file: %s", r->folder,
                             strerror(n < 0 ? errno : ENOSPC));
        bytes += n, size -= (size_t)n, place += (uint64_t)n;
    }
    return BRIO_OK;
}

static brio_status read_rows(const brio_rows *r, uint64_t first, size_t count) {
    size_t size = count * r->size;
    uint64_t place = first * r->size;
    for (char *to = r->bytes; size > 0;) {
        int64_t n = brio_read_bytes_at(r->file, to, size, place);
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0)
            return brio_fail(r->ctx, BRIO_ERR_OPEN, "%s: cannot read a scratch file: %s", r->folder,
                             n < 0 ? strerror(errno) : "it ends early");
        to += n, size -= (size_t)n, place += (uint64_t)n;
    }
    return brio_look(r->ctx, count);
}

brio_status brio_rows_require_room(const brio_rows *r, const char *name, uint64_t points) {
    uint64_t room;
    double need = (double)points * (double)r->size;
    if (!brio_free_bytes(r->folder, &room)) return BRIO_OK;
    BRIO_EXPECT(r->ctx, need <= (double)room, BRIO_ERR_WRITE,
                "%s: the points of %s need about %.0f MB more on this disk, which has room for %.0f MB", r->folder,
                name, need / 1e6, (double)room / 1e6);
    return BRIO_OK;
}

/* --- blocks --- */

/* A block, and its rows. */
typedef struct {
    const brio_mesh *block;
    char *bytes;
    size_t size;
} block_rows;

static void pack(void *user, size_t begin, size_t end, int thread) {
    const block_rows *b = user;
    size_t at = POSITION;
    (void)thread;
    for (size_t i = begin; i < end; i++) memcpy(b->bytes + i * b->size, b->block->vertices + 3 * i, POSITION);
    for (size_t k = 0; k < b->block->num_properties; k++) {
        const brio_property *p = &b->block->properties[k];
        size_t size = brio_scalar_size(p->type);
        for (size_t i = begin; i < end; i++)
            memcpy(b->bytes + i * b->size + at, (const char *)p->data + i * size, size);
        at += size;
    }
}

static void unpack(void *user, size_t begin, size_t end, int thread) {
    const block_rows *b = user;
    size_t at = POSITION;
    (void)thread;
    for (size_t i = begin; i < end; i++) memcpy(b->block->vertices + 3 * i, b->bytes + i * b->size, POSITION);
    for (size_t k = 0; k < b->block->num_properties; k++) {
        const brio_property *p = &b->block->properties[k];
        size_t size = brio_scalar_size(p->type);
        for (size_t i = begin; i < end; i++) memcpy((char *)p->data + i * size, b->bytes + i * b->size + at, size);
        at += size;
    }
}

/* Makes a mesh with what another one tells of all points, and room for `count` of them. */
static brio_status make_like(brio_context *ctx, const brio_mesh *like, size_t count, brio_mesh **out) {
    BRIO_FORWARD(brio_mesh_new(ctx, out));
    brio_mesh *m = *out;
    memcpy(m->coordinate_step, like->coordinate_step, sizeof m->coordinate_step);
    memcpy(m->coordinate_origin, like->coordinate_origin, sizeof m->coordinate_origin);
    for (size_t i = 0; i < like->num_metadata; i++) {
        const brio_metadata *d = &like->metadata[i];
        BRIO_FORWARD(brio_mesh_set_metadata(m, d->name, d->bytes, d->size));
    }
    BRIO_FORWARD(BRIO_ALLOC(ctx, m->vertices, 3 * count + 1));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, m->properties, like->num_properties + 1));
    for (; m->num_properties < like->num_properties; m->num_properties++) {
        const brio_property *from = &like->properties[m->num_properties];
        brio_property *p = &m->properties[m->num_properties];
        memcpy(p->name, from->name, sizeof p->name);
        p->type = from->type;
        BRIO_FORWARD(brio_resize_to(ctx, &p->data, count + 1, brio_scalar_size(p->type)));
    }
    return BRIO_OK;
}

brio_status brio_rows_begin(brio_rows *r, const brio_mesh *first) {
    BRIO_FORWARD(open_rows(r, &r->file));
    BRIO_FORWARD(make_like(r->ctx, first, BRIO_BLOCK_ROWS, &r->kind));
    r->size = POSITION;
    for (size_t i = 0; i < first->num_properties; i++) r->size += brio_scalar_size(first->properties[i].type);
    return BRIO_ALLOC(r->ctx, r->bytes, BRIO_BLOCK_ROWS * r->size);
}

/* Returns the first property that another mesh does not have so. */
static const brio_property *find_missing(const brio_mesh *m, const brio_mesh *other) {
    for (size_t i = 0; i < m->num_properties; i++) {
        const brio_property *p = brio_mesh_property(other, m->properties[i].name);
        if (!p || p->type != m->properties[i].type) return &m->properties[i];
    }
    return NULL;
}

const brio_property *brio_rows_differ(const brio_rows *r, const brio_mesh *block) {
    const brio_property *missing = find_missing(r->kind, block);
    return missing ? missing : find_missing(block, r->kind);
}

/* Returns a view of some vertices of a mesh.   order  a mesh with the same properties, in the order of the view's.
 * property  room for these. */
static brio_mesh part_of(const brio_mesh *m, size_t first, size_t count, const brio_mesh *order,
                         brio_property *property) {
    brio_mesh part = *m;
    part.vertices = m->num_vertices ? m->vertices + 3 * first : NULL;
    part.num_vertices = count;
    part.properties = property;
    for (size_t i = 0; i < m->num_properties; i++) {
        property[i] = *brio_mesh_property(m, order->properties[i].name);
        if (m->num_vertices) property[i].data = (char *)property[i].data + first * brio_scalar_size(property[i].type);
    }
    return part;
}

static brio_status append_part(brio_rows *r, const brio_mesh *part) {
    block_rows b = {part, r->bytes, r->size};
    size_t n = part->num_vertices;
    BRIO_FORWARD(brio_for(r->ctx, brio_threads(r->ctx, n, ROWS_A_THREAD), n, pack, &b));
    BRIO_FORWARD(write_rows(r, r->file, r->count * r->size, r->bytes, n * r->size));
    r->count += n;
    return brio_look(r->ctx, n);
}

brio_status brio_rows_append(brio_rows *r, const brio_mesh *block) {
    brio_status status = BRIO_OK;
    brio_property *property = NULL;
    assert(!brio_rows_differ(r, block));
    BRIO_TRY(BRIO_ALLOC(r->ctx, property, block->num_properties + 1));
    for (size_t first = 0, n; first < block->num_vertices; first += n) {
        n = block->num_vertices - first < BRIO_BLOCK_ROWS ? block->num_vertices - first : BRIO_BLOCK_ROWS;
        brio_mesh part = part_of(block, first, n, r->kind, property);
        BRIO_TRY(append_part(r, &part));
    }
    if (r->count * r->size > r->most) r->most = r->count * r->size;
done:
    brio_release(r->ctx, property);
    return status;
}

brio_status brio_rows_pass(const brio_rows *r, uint64_t first, uint64_t count, const brio_sink *sink) {
    block_rows b = {r->kind, r->bytes, r->size};
    uint64_t done = 0;
    do {
        size_t n = count - done < BRIO_BLOCK_ROWS ? (size_t)(count - done) : BRIO_BLOCK_ROWS;
        brio_mesh block = *r->kind;
        block.num_vertices = n;
        BRIO_FORWARD(read_rows(r, first + done, n));
        BRIO_FORWARD(brio_for(r->ctx, brio_threads(r->ctx, n, ROWS_A_THREAD), n, unpack, &b));
        BRIO_FORWARD(sink->take(sink->user, &block));
        done += n;
    } while (done < count);
    return BRIO_OK;
}

brio_status brio_rows_mesh(const brio_rows *r, uint64_t first, uint64_t count, brio_mesh **out) {
    brio_status status = BRIO_OK;
    brio_property *property = NULL;
    brio_mesh *m = NULL;
    *out = NULL;
    BRIO_REQUIRE(r->ctx, count <= BRIO_MAX_VERTICES, BRIO_ERR_TOO_LARGE, "a tile of %llu points: take more tiles",
                 (unsigned long long)count);
    BRIO_TRY(make_like(r->ctx, r->kind, (size_t)count, &m));
    BRIO_TRY(BRIO_ALLOC(r->ctx, property, m->num_properties + 1));
    m->num_vertices = (size_t)count;
    for (size_t done = 0, n; done < count; done += n) {
        n = count - done < BRIO_BLOCK_ROWS ? (size_t)count - done : BRIO_BLOCK_ROWS;
        brio_mesh part = part_of(m, done, n, m, property);
        block_rows b = {&part, r->bytes, r->size};
        BRIO_TRY(read_rows(r, first + done, n));
        BRIO_TRY(brio_for(r->ctx, brio_threads(r->ctx, n, ROWS_A_THREAD), n, unpack, &b));
    }
    *out = m;
    m = NULL;
done:
    brio_mesh_free(m);
    brio_release(r->ctx, property);
    return status;
}

/* --- tiles --- */

/* Rows on their way to their tiles. */
typedef struct {
    brio_rows *r;
    const uint8_t *chosen;
    brio_tile_cuts cuts;
    brio_row_tile *tile;
    int file;         /* with the rows in their new order */
    char *waiting;    /* num_tiles by `room` rows */
    size_t room;      /* rows that wait for the place of a tile, at most */
    uint32_t *number; /* of those that wait, of each tile */
    uint64_t *placed; /* rows of each tile that have their place */
    uint64_t stay;    /* rows that stay, so far in a pass */
} division;

typedef brio_status (*row_fn)(division *d, const char *row, const double position[3]);

/* Calls a function for each row that stays, in their order.   part  of the work, for progress */
static brio_status for_rows(division *d, double part, row_fn call) {
    const brio_rows *r = d->r;
    d->stay = 0;
    for (uint64_t first = 0; first < r->count; first += BRIO_BLOCK_ROWS) {
        size_t n = r->count - first < BRIO_BLOCK_ROWS ? (size_t)(r->count - first) : BRIO_BLOCK_ROWS;
        BRIO_FORWARD(brio_progress(r->ctx, "divide", (part + (double)first / (double)r->count) / 3));
        BRIO_FORWARD(read_rows(r, first, n));
        for (size_t i = 0; i < n; i++) {
            double position[3];
            if (d->chosen && !d->chosen[first + i]) continue;
            memcpy(position, r->bytes + i * r->size, POSITION);
            BRIO_FORWARD(call(d, r->bytes + i * r->size, position));
            d->stay++;
        }
    }
    return BRIO_OK;
}

static brio_status sample_row(division *d, const char *row, const double position[3]) {
    (void)row;
    brio_tile_cuts_sample(&d->cuts, position, d->stay);
    return BRIO_OK;
}

static brio_status count_row(division *d, const char *row, const double position[3]) {
    brio_row_tile *t = &d->tile[brio_tile_cuts_find(&d->cuts, position)];
    (void)row;
    for (int k = 0; k < 3; k++) {
        t->low[k] = t->count ? fmin(t->low[k], position[k]) : position[k];
        t->high[k] = t->count ? fmax(t->high[k], position[k]) : position[k];
    }
    t->count++;
    return BRIO_OK;
}

/* Writes the rows that wait for the places of a tile. */
static brio_status place_waiting(division *d, uint32_t tile) {
    size_t size = d->r->size;
    uint64_t at = d->tile[tile].first + d->placed[tile];
    BRIO_FORWARD(write_rows(d->r, d->file, at * size, d->waiting + tile * d->room * size, d->number[tile] * size));
    d->placed[tile] += d->number[tile];
    d->number[tile] = 0;
    return BRIO_OK;
}

static brio_status place_row(division *d, const char *row, const double position[3]) {
    uint32_t tile = brio_tile_cuts_find(&d->cuts, position);
    size_t size = d->r->size;
    memcpy(d->waiting + (tile * d->room + d->number[tile]) * size, row, size);
    return ++d->number[tile] == d->room ? place_waiting(d, tile) : BRIO_OK;
}

/* Returns how many rows wait for a tile's place: fewer if there are many tiles. */
static size_t room_of_tile(const brio_rows *r, uint32_t num_tiles) {
    size_t most = r->size > MOST_WAITING ? r->size : MOST_WAITING;
    return brio_waiting_bytes(r->ctx, num_tiles, r->size, most, BUFFERS) / r->size;
}

double brio_rows_divide_bytes(const brio_rows *r, uint32_t num_tiles) {
    size_t waiting = room_of_tile(r, num_tiles) * r->size;
    return brio_tile_cuts_bytes(num_tiles) +
           num_tiles * (double)(waiting + sizeof(uint32_t) + sizeof(uint64_t) + sizeof(brio_row_tile));
}

static brio_status make_room(division *d, uint32_t num_tiles) {
    size_t size = d->r->size;
    d->room = room_of_tile(d->r, num_tiles);
    BRIO_FORWARD(BRIO_ALLOC(d->r->ctx, d->waiting, num_tiles * d->room * size));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(d->r->ctx, d->number, num_tiles));
    return BRIO_ALLOC_ZERO(d->r->ctx, d->placed, num_tiles);
}

brio_status brio_rows_divide(brio_rows *r, const uint8_t *chosen, uint32_t num_tiles, brio_row_tile *tile) {
    division d = {.r = r, .chosen = chosen, .tile = tile, .file = -1};
    brio_status status = BRIO_OK;
    memset(tile, 0, num_tiles * sizeof *tile);
    BRIO_TRY(brio_tile_cuts_begin(r->ctx, &d.cuts));
    BRIO_TRY(for_rows(&d, 0, sample_row));
    BRIO_TRY(brio_tile_cuts_make(r->ctx, &d.cuts, num_tiles, NULL));
    brio_tile_cuts_drop_sample(r->ctx, &d.cuts);
    BRIO_TRY(for_rows(&d, 1, count_row));
    for (uint32_t i = 1; i < num_tiles; i++) tile[i].first = tile[i - 1].first + tile[i - 1].count;
    BRIO_TRY(make_room(&d, num_tiles));
    BRIO_TRY(open_rows(r, &d.file));
    BRIO_TRY(for_rows(&d, 2, place_row));
    for (uint32_t i = 0; i < num_tiles; i++) BRIO_TRY(place_waiting(&d, i));
    r->most = (r->count + d.stay) * r->size;
    r->count = d.stay;
    int file = r->file;
    r->file = d.file;
    d.file = file; /* the rows as they came are not needed any more */
done:
    if (d.file >= 0) brio_close(d.file);
    brio_tile_cuts_free(r->ctx, &d.cuts);
    brio_release(r->ctx, d.waiting);
    brio_release(r->ctx, d.number);
    brio_release(r->ctx, d.placed);
    return status;
}

void brio_rows_free(brio_rows *r) {
    if (r->file >= 0) brio_close(r->file);
    r->file = -1;
    brio_mesh_free(r->kind);
    brio_release(r->ctx, r->bytes);
    r->kind = NULL, r->bytes = NULL;
}
