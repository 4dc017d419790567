/* Cells in ascending order of their sites: divided into files by their sites, each of which is then sorted in memory.
 *
 * Based on: Aggarwal, Vitter. The input/output complexity of sorting and related problems. CACM 1988. */
#include "base/memory.h"
#include "base/sort.h"
#include "tiles/cells.h"
#include <assert.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* AT_ONCE: cells that are handed on together. The others: bytes that wait for a file, and for all of them
 * (brio_waiting_bytes). Chosen. */
enum { AT_ONCE = 1 << 11, BUFFER = 1 << 16, LEAST_BUFFER = 1 << 10, ALL_BUFFERS = 1 << 25 };

typedef struct {
    uint64_t site;
    double volume, area, centroid[3];
    uint32_t bounded, faces;
} cell_row;

typedef struct {
    int64_t neighbour;
    double area, normal[3];
} face_row;

/* A file, and what waits for it. */
typedef struct {
    brio_store_file file;
    char *buffer;
    size_t used, room;
} tray;

struct brio_ordered_cells {
    brio_tiles *t;
    bool areas, centroids, sizes;
    bool counts, faces; /* counts: the number of faces of each cell; faces: the faces themselves */
    size_t num_parts;
    uint64_t *end;             /* of each part except the last */
    tray *cells_of, *faces_of; /* of each part */
    uint8_t *packed;           /* the cell that was packed last */
    size_t packed_capacity;
};

typedef brio_ordered_cells ordering;

/* --- to the files --- */

static brio_status flush(tray *f) {
    brio_status status = f->used ? brio_store_append(&f->file, f->buffer, f->used) : BRIO_OK;
    f->used = 0;
    return status;
}

static brio_status put(tray *f, const void *bytes, size_t size) {
    if (f->used + size > f->room) BRIO_FORWARD(flush(f));
    assert(size <= f->room);
    memcpy(f->buffer + f->used, bytes, size);
    f->used += size;
    return BRIO_OK;
}

brio_status brio_ordered_cells_pack(brio_ordered_cells *o, const brio_cells *cells, size_t c, uint64_t site,
                                    const void **bytes, size_t *size) {
    cell_row row = {.site = site, .volume = cells->volume[c], .bounded = cells->bounded[c]};
    if (o->areas) row.area = cells->area[c];
    if (o->centroids) memcpy(row.centroid, cells->centroid + 3 * c, sizeof row.centroid);
    if (o->counts) row.faces = (uint32_t)(cells->face_offsets[c + 1] - cells->face_offsets[c]);
    *size = sizeof row + (o->faces ? row.faces * sizeof(face_row) : 0);
    BRIO_FORWARD(BRIO_RESERVE(o->t->ctx, o->packed, o->packed_capacity, *size));
    *bytes = o->packed;
    memcpy(o->packed, &row, sizeof row);
    for (uint32_t i = 0; o->faces && i < row.faces; i++) {
        uint64_t f = cells->face_offsets[c] + i;
        face_row face = {.neighbour = cells->face_neighbours[f]};
        if (o->sizes) {
            face.area = cells->face_areas[f];
            memcpy(face.normal, cells->face_normals + 3 * f, sizeof face.normal);
        }
        memcpy(o->packed + sizeof row + i * sizeof face, &face, sizeof face);
    }
    return BRIO_OK;
}

/* Returns the part of a site: the number of ends that are not above it. */
static size_t part_of(const ordering *o, uint64_t site) {
    size_t low = 0, high = o->num_parts - 1;
    while (low < high) {
        size_t middle = (low + high) / 2;
        if (o->end[middle] <= site)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

brio_status brio_ordered_cells_put(brio_ordered_cells *o, const void *bytes, size_t *size) {
    cell_row row;
    memcpy(&row, bytes, sizeof row);
    const uint8_t *face = (const uint8_t *)bytes + sizeof row;
    size_t part = part_of(o, row.site), num_faces = o->faces ? row.faces : 0;
    *size = sizeof row + num_faces * sizeof(face_row);
    for (size_t f = 0; f < num_faces; f++)
        BRIO_FORWARD(put(&o->faces_of[part], face + f * sizeof(face_row), sizeof(face_row)));
    BRIO_FORWARD(put(&o->cells_of[part], &row, sizeof row));
    return brio_look(o->t->ctx, 1);
}

static void name_of(const char *kind, size_t part, char name[32]) {
    snprintf(name, 32, "%s-%zu", kind, part);
}

/* Returns the bytes that wait for each of the files. */
static size_t room_of_tray(const brio_context *ctx, size_t num_parts) {
    return brio_waiting_bytes(ctx, 2 * num_parts, LEAST_BUFFER, BUFFER, ALL_BUFFERS);
}

double brio_ordered_cells_buffers(const brio_context *ctx, size_t tiles, bool with_faces) {
    size_t num_parts = BRIO_ORDERED_PARTS * tiles, waiting = room_of_tray(ctx, num_parts) + BRIO_BLOCK_HEADER;
    return (double)num_parts * (double)(2 * sizeof(tray) + (with_faces ? 2 : 1) * waiting);
}

static brio_status open_tray(ordering *o, const char *kind, size_t part, tray *f) {
    char name[32];
    f->room = room_of_tray(o->t->ctx, o->num_parts);
    name_of(kind, part, name);
    BRIO_FORWARD(brio_store_create(&o->t->folder, name, &f->file));
    brio_store_shut(&f->file);
    return BRIO_ALLOC(o->t->ctx, f->buffer, f->room);
}

/* Closes the files. They stay in the folder. */
static void close_trays(ordering *o, tray *list) {
    for (size_t i = 0; list && i < o->num_parts; i++) {
        brio_store_close(&list[i].file);
        brio_release(o->t->ctx, list[i].buffer);
        list[i].buffer = NULL;
    }
}

static brio_status open_trays(ordering *o) {
    BRIO_FORWARD(BRIO_ALLOC_ZERO(o->t->ctx, o->cells_of, o->num_parts));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(o->t->ctx, o->faces_of, o->num_parts));
    for (size_t i = 0; i < o->num_parts; i++) o->cells_of[i].file.file = o->faces_of[i].file.file = -1;
    for (size_t i = 0; i < o->num_parts; i++) {
        BRIO_FORWARD(open_tray(o, "cells", i, &o->cells_of[i]));
        if (o->faces) BRIO_FORWARD(open_tray(o, "faces", i, &o->faces_of[i]));
    }
    return BRIO_OK;
}

static brio_status flush_trays(ordering *o) {
    for (size_t i = 0; i < o->num_parts; i++) {
        BRIO_FORWARD(flush(&o->cells_of[i]));
        if (o->faces) BRIO_FORWARD(flush(&o->faces_of[i]));
    }
    return BRIO_OK;
}

/* --- from the files --- */

/* The cells of a part. */
typedef struct {
    cell_row *cell;
    face_row *face;
    uint64_t *begin; /* of each cell, its first face */
    uint32_t *order;
    size_t count;
} rows;

static int compare_sites(uint32_t i, uint32_t j, const void *user) {
    const cell_row *cell = user;
    return cell[i].site < cell[j].site ? -1 : cell[i].site > cell[j].site;
}

/* Reads a whole file, and removes it. */
static brio_status read_all(ordering *o, const char *kind, size_t part, size_t size, void **out, size_t *count) {
    brio_store_file f = {.file = -1};
    brio_status status = BRIO_OK;
    char name[32], *bytes = NULL;
    name_of(kind, part, name);
    BRIO_TRY(brio_store_open(&o->t->folder, name, &f));
    *count = (size_t)f.size / size;
    BRIO_TRY(BRIO_ALLOC(o->t->ctx, bytes, *count * size + 1));
    *out = bytes;
    BRIO_TRY(brio_store_read(&f, 0, bytes, *count * size));
done:
    brio_store_close(&f);
    brio_store_remove(&o->t->folder, name);
    return status;
}

static brio_status read_rows(ordering *o, size_t part, rows *r) {
    brio_context *ctx = o->t->ctx;
    size_t num_faces = 0;
    uint64_t next = 0;
    void *cells = NULL, *faces = NULL;
    brio_status status = read_all(o, "cells", part, sizeof *r->cell, &cells, &r->count);
    r->cell = cells;
    BRIO_FORWARD(status);
    if (o->faces) status = read_all(o, "faces", part, sizeof *r->face, &faces, &num_faces);
    r->face = faces;
    BRIO_FORWARD(status);
    BRIO_FORWARD(BRIO_ALLOC(ctx, r->begin, r->count + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, r->order, r->count + 1));
    for (size_t c = 0; c < r->count; c++) {
        r->order[c] = (uint32_t)c;
        r->begin[c] = next;
        next += r->cell[c].faces;
    }
    BRIO_EXPECT(ctx, !o->faces || next == num_faces, BRIO_ERR_OPEN, "%s/faces-%zu was changed from outside",
                o->t->folder.path, part);
    return brio_sort_many_indices(ctx, r->order, r->count, compare_sites, r->cell);
}

static brio_status make_cells(ordering *o, size_t n, size_t faces, brio_cells **out) {
    brio_context *ctx = o->t->ctx;
    brio_cells *cells = NULL;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, cells, 1));
    *out = cells;
    cells->size = sizeof *cells;
    cells->context = ctx;
    cells->num_cells = n;
    BRIO_FORWARD(BRIO_ALLOC(ctx, cells->site, n + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, cells->volume, n + 1));
    BRIO_FORWARD(BRIO_ALLOC(ctx, cells->bounded, n + 1));
    if (o->areas) BRIO_FORWARD(BRIO_ALLOC(ctx, cells->area, n + 1));
    if (o->centroids) BRIO_FORWARD(BRIO_ALLOC(ctx, cells->centroid, 3 * n + 1));
    if (o->counts) BRIO_FORWARD(BRIO_ALLOC(ctx, cells->face_offsets, n + 1));
    if (!o->faces) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(ctx, cells->face_neighbours, faces + 1));
    if (!o->sizes) return BRIO_OK;
    BRIO_FORWARD(BRIO_ALLOC(ctx, cells->face_areas, faces + 1));
    return BRIO_ALLOC(ctx, cells->face_normals, 3 * faces + 1);
}

static void fill_cells(const ordering *o, const rows *r, size_t first, brio_cells *cells, uint64_t *site) {
    uint64_t next = 0;
    for (size_t c = 0; c < cells->num_cells; c++) {
        const cell_row *row = &r->cell[r->order[first + c]];
        site[c] = row->site;
        cells->site[c] = (uint32_t)c;
        cells->volume[c] = row->volume;
        cells->bounded[c] = (uint8_t)row->bounded;
        if (o->areas) cells->area[c] = row->area;
        if (o->centroids) memcpy(cells->centroid + 3 * c, row->centroid, sizeof row->centroid);
        if (o->counts) cells->face_offsets[c] = next;
        if (!o->faces) {
            next += row->faces;
            continue;
        }
        const face_row *face = r->face + r->begin[r->order[first + c]];
        for (uint32_t f = 0; f < row->faces; f++, next++) {
            cells->face_neighbours[next] = face[f].neighbour;
            if (!o->sizes) continue;
            cells->face_areas[next] = face[f].area;
            memcpy(cells->face_normals + 3 * next, face[f].normal, sizeof face->normal);
        }
    }
    if (o->counts) cells->face_offsets[cells->num_cells] = next;
}

static brio_status hand_on(ordering *o, const rows *r, const brio_tile_cells_sink *sink) {
    uint64_t site[AT_ONCE];
    brio_status status = BRIO_OK;
    for (size_t first = 0; first < r->count && status == BRIO_OK; first += AT_ONCE) {
        size_t n = r->count - first < AT_ONCE ? r->count - first : AT_ONCE, faces = 0;
        brio_cells *cells = NULL;
        for (size_t c = 0; c < n; c++) faces += r->cell[r->order[first + c]].faces;
        status = make_cells(o, n, faces, &cells);
        if (status == BRIO_OK) {
            fill_cells(o, r, first, cells, site);
            status = sink->take(sink->user, cells, site);
        }
        brio_cells_free(cells);
        if (status == BRIO_OK) status = brio_look(o->t->ctx, n);
    }
    return status;
}

static brio_status hand_on_part(ordering *o, size_t part, const brio_tile_cells_sink *sink) {
    rows r = {0};
    brio_status status = read_rows(o, part, &r);
    if (status == BRIO_OK) status = hand_on(o, &r, sink);
    brio_release(o->t->ctx, r.cell);
    brio_release(o->t->ctx, r.face);
    brio_release(o->t->ctx, r.begin);
    brio_release(o->t->ctx, r.order);
    return status;
}

brio_status brio_ordered_cells_hand_on(brio_ordered_cells *o, const brio_tile_cells_sink *sink) {
    BRIO_FORWARD(flush_trays(o));
    close_trays(o, o->cells_of);
    close_trays(o, o->faces_of);
    for (size_t i = 0; i < o->num_parts; i++) BRIO_FORWARD(hand_on_part(o, i, sink));
    return BRIO_OK;
}

/* --- life --- */

static void remove_files(ordering *o) {
    char name[32];
    for (size_t i = 0; i < o->num_parts; i++) {
        name_of("cells", i, name);
        if (brio_store_has(&o->t->folder, name)) brio_store_remove(&o->t->folder, name);
        name_of("faces", i, name);
        if (brio_store_has(&o->t->folder, name)) brio_store_remove(&o->t->folder, name);
    }
}

brio_status brio_ordered_cells_new(brio_tiles *t, const brio_cells_options *options, bool with_faces,
                                   const uint64_t *end, brio_ordered_cells **out) {
    ordering *o = NULL;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(t->ctx, o, 1));
    *out = o;
    *o = (ordering){.t = t,
                    .areas = !options->no_areas,
                    .centroids = !options->no_centroids,
                    .counts = !options->no_faces,
                    .faces = with_faces && !options->no_faces,
                    .sizes = !options->no_face_sizes,
                    .num_parts = (size_t)BRIO_ORDERED_PARTS * t->num_tiles};
    BRIO_FORWARD(BRIO_ALLOC(t->ctx, o->end, o->num_parts));
    memcpy(o->end, end, (o->num_parts - 1) * sizeof *o->end);
    return open_trays(o);
}

void brio_ordered_cells_free(brio_ordered_cells *o) {
    if (!o) return;
    brio_context *ctx = o->t->ctx;
    close_trays(o, o->cells_of);
    close_trays(o, o->faces_of);
    remove_files(o);
    brio_release(ctx, o->cells_of);
    brio_release(ctx, o->faces_of);
    brio_release(ctx, o->end);
    brio_release(ctx, o->packed);
    brio_release(ctx, o);
}

/* --- one process --- */

static brio_status put_cells(void *user, brio_cells *cells, const uint64_t *site) {
    brio_ordered_cells *o = user;
    const void *bytes;
    size_t size;
    for (size_t c = 0; c < cells->num_cells; c++) {
        BRIO_FORWARD(brio_ordered_cells_pack(o, cells, c, site[c], &bytes, &size));
        BRIO_FORWARD(brio_ordered_cells_put(o, bytes, &size));
    }
    return BRIO_OK;
}

brio_status brio_tiles_run_ordered_cells(brio_tiles *t, const brio_cells_options *options, bool with_faces,
                                         const brio_tile_cells_sink *sink, brio_tiles_cells_stats *stats) {
    brio_ordered_cells *o = NULL;
    brio_status status = BRIO_OK;
    size_t num_parts = (size_t)BRIO_ORDERED_PARTS * t->num_tiles;
    uint64_t *end = NULL, share = t->stats.points / num_parts + 1;
    BRIO_TRY(BRIO_ALLOC(t->ctx, end, num_parts));
    for (size_t i = 0; i < num_parts; i++) end[i] = (i + 1) * share;
    BRIO_TRY(brio_ordered_cells_new(t, options, with_faces, end, &o));
    BRIO_TRY(brio_tiles_run_cells(t, options, &(brio_tile_cells_sink){put_cells, o}, stats));
    status = brio_ordered_cells_hand_on(o, sink);
done:
    brio_ordered_cells_free(o);
    brio_release(t->ctx, end);
    return status;
}
