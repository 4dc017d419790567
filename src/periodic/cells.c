/* Cells of a periodic triangulation.
 *
 * The tetrahedra with a vertex in the domain are unfolded (unfold.c), and the cells of the points there are computed
 * from their stars (brio_cells_of_complex). Then neighbours become points and shifts, and each cell is moved to where
 * its point was given: a vertex of cells that move differently becomes several. */
#include "base/float_state.h"
#include "base/kept.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/team.h"
#include "base/versioned.h"
#include "cells/diagram.h"
#include "periodic/periodic.h"
#include <math.h>
#include <string.h>

/* BOX_REACH: how many cells wide a box is along coordinates that repeat; no cell reaches as far. */
enum { BOX_REACH = 8, CELLS_A_THREAD = 1 << 12 };

typedef struct {
    brio_context *ctx;
    const brio_periodic *t;
    brio_images images;
    brio_tetrahedron *unfolded;  /* or NULL */
    uint32_t (*more)[4], *owner; /* for a sweep */
    double box[6];
} periodic_call;

/* --- the call for cells in the domain --- */

/* Appends all translates within the lattice's range: for points of a plane or a line, which are few or thin. */
static brio_status add_all(periodic_call *c) {
    brio_images *m = &c->images;
    const brio_lattice *l = &c->t->lattice;
    for (size_t p = 0; p < m->num_points; p++) {
        int32_t s[3], from[3] = {0, 0, 0}, to[3] = {0, 0, 0};
        for (int i = 0; i < l->rank; i++) {
            double share = brio_lattice_share(l, i, m->x[p]);
            from[i] = (int32_t)ceil(-l->range[i] - share), to[i] = (int32_t)floor(1 + l->range[i] - share);
        }
        for (s[0] = from[0]; s[0] <= to[0]; s[0]++)
            for (s[1] = from[1]; s[1] <= to[1]; s[1]++)
                for (s[2] = from[2]; s[2] <= to[2]; s[2]++)
                    if (s[0] || s[1] || s[2]) BRIO_FORWARD(brio_images_add(m, (uint32_t)p, s));
        BRIO_FORWARD(brio_look(c->ctx, 1));
    }
    return BRIO_OK;
}

/* Takes the caller's box along coordinates in which no vector goes anywhere; along the others it is wide. */
static brio_status take_box(periodic_call *c, brio_cells_options *o) {
    const brio_lattice *l = &c->t->lattice;
    bool clips = false;
    BRIO_EXPECT(c->ctx, !o->planes && !o->num_planes, BRIO_ERR_ARGUMENT,
                "planes do not clip cells of a space that repeats; a box does along coordinates that do not repeat");
    if (!o->box) return BRIO_OK;
    for (int k = 0; k < 3; k++) {
        double low = 0, high = 0;
        c->box[k] = o->box[k], c->box[3 + k] = o->box[3 + k];
        if (l->unit[k] == 0) {
            clips = true;
            continue;
        }
        for (int i = 0; i < 3; i++) low += fabs(l->basis[i][k]) * BOX_REACH;
        for (size_t p = 0; p < c->images.num_points; p++) high = fmax(high, fabs(c->images.x[p][k]));
        c->box[k] = -low - high, c->box[3 + k] = low + high;
    }
    BRIO_EXPECT(c->ctx, clips, BRIO_ERR_ARGUMENT, "a box, but every coordinate repeats");
    o->box = c->box;
    return BRIO_OK;
}

/* --- what the caller sees --- */

/* Returns how far a shift to the domain moves back, along coordinate k. */
static inline double moved_by(const brio_periodic *t, const int32_t shift[3], int k) {
    double sum = 0;
    for (int j = 0; j < t->lattice.rank; j++) sum -= shift[j] * t->lattice.used[j][k];
    return sum;
}

/* Returns how far the cell of a point is moved: from the domain to where the point was given. */
static inline double move_of(const brio_periodic *t, uint32_t point, int k) {
    return t->stays ? 0 : moved_by(t, t->home[point], k);
}

typedef struct {
    const periodic_call *c;
    brio_cells *cells;
    uint8_t *border; /* of each point: whether a neighbour may be a translate */
} showing;

static void show_some(void *user, size_t from, size_t to, int thread) {
    const showing *h = user;
    const brio_periodic *t = h->c->t;
    const brio_lattice *l = &t->lattice;
    brio_cells *cells = h->cells;
    (void)thread;
    for (size_t n = from; n < to; n++)
        for (uint64_t f = cells->face_offsets[n]; f < cells->face_offsets[n + 1]; f++) {
            if (t->stays && h->border && !h->border[cells->site[n]]) break; /* nearly all */
            if (cells->face_neighbours[f] < 0) continue;
            if (t->stays && (size_t)cells->face_neighbours[f] < h->c->images.num_points) continue;
            const brio_image *image = &h->c->images.list[cells->face_neighbours[f]];
            cells->face_neighbours[f] = image->point;
            for (int j = 0; j < l->rank; j++) {
                int64_t shift = (int64_t)t->home[image->point][j] - t->home[cells->site[n]][j];
                for (int i = 0; i < l->rank; i++) shift += image->shift[i] * l->change[i][j];
                cells->face_shifts[3 * f + (size_t)l->axis[j]] = (int32_t)shift;
            }
        }
}

/* Makes points and shifts of the images that are neighbours. Points of dimension 2 or less have no tetrahedra that say
 * where the border is. */
static brio_status show_neighbours(const periodic_call *c, brio_cells *cells) {
    const brio_periodic *t = c->t;
    brio_status status = BRIO_OK;
    showing h = {.c = c, .cells = cells};
    size_t faces = cells->face_offsets ? (size_t)cells->face_offsets[cells->num_cells] : 0;
    if (!cells->face_offsets) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, cells->face_shifts, 3 * faces + 1));
    if (t->stats.dimension == 3) BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, h.border, c->images.num_points + 1));
    for (size_t i = 0; i < t->num_border && h.border; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t v = t->tet[t->border[i]].vertex[k];
            if (v != BRIO_INFINITE) h.border[brio_images_point(&c->images, v)] = 1;
        }
    BRIO_TRY(brio_for(c->ctx, brio_threads(c->ctx, cells->num_cells, CELLS_A_THREAD), cells->num_cells, show_some, &h));
done:
    brio_release(c->ctx, h.border);
    return status;
}

static void move_centroids(const periodic_call *c, brio_cells *cells) {
    for (size_t n = 0; n < cells->num_cells && cells->centroid; n++)
        for (int k = 0; k < 3; k++)
            cells->centroid[3 * n + (size_t)k] =
                brio_lattice_shown(&c->t->lattice, cells->centroid[3 * n + (size_t)k], k) +
                move_of(c->t, cells->site[n], k);
}

/* A vertex of cells that move by one shift. */
typedef struct {
    uint32_t vertex;
    int32_t move[3];
} moved_vertex;

/* Vertices of moved cells, in the order in which they were met, and a table that finds them. */
typedef struct {
    brio_context *ctx;
    moved_vertex *list;
    size_t count, capacity;
    uint32_t *slot; /* one more than the number in the list, or 0; at most half of them are in use */
    size_t size;
} moved_vertices;

static size_t place_of(const moved_vertices *m, const moved_vertex *v) {
    uint64_t moves = (uint64_t)(uint32_t)v->move[0] << 32 | (uint32_t)v->move[1];
    uint64_t hash = brio_mix(v->vertex + brio_mix(moves) + (uint32_t)v->move[2] * UINT64_C(0x9e3779b97f4a7c15));
    size_t place = hash & (m->size - 1);
    while (m->slot[place] && memcmp(&m->list[m->slot[place] - 1], v, sizeof *v)) place = (place + 1) & (m->size - 1);
    return place;
}

/* Doubles the table. Cells at one vertex may all have other moves, so nobody knows how large it gets. */
static brio_status grow(moved_vertices *m) {
    brio_release(m->ctx, m->slot);
    m->size = m->size ? 2 * m->size : 64;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(m->ctx, m->slot, m->size));
    for (size_t i = 0; i < m->count; i++) m->slot[place_of(m, &m->list[i])] = (uint32_t)i + 1;
    return BRIO_OK;
}

/* Sets *number to that of a vertex, which is added if it is not known. */
static brio_status find_moved(moved_vertices *m, const moved_vertex *v, uint32_t *number) {
    if (2 * (m->count + 1) > m->size) BRIO_FORWARD(grow(m));
    uint32_t *slot = &m->slot[place_of(m, v)];
    if (!*slot) {
        BRIO_EXPECT(m->ctx, m->count < UINT32_MAX - 1, BRIO_ERR_TOO_LARGE, "2^32 - 2 vertices of cells or more");
        BRIO_FORWARD(BRIO_RESERVE(m->ctx, m->list, m->capacity, m->count + 1));
        m->list[m->count++] = *v;
        *slot = (uint32_t)m->count;
    }
    *number = *slot - 1;
    return BRIO_OK;
}

/* Gives the corner of a cell its vertex, a new one where no cell with that move had it. */
static brio_status move_vertices(const periodic_call *c, brio_cells *cells) {
    brio_context *ctx = c->ctx;
    const brio_periodic *t = c->t;
    brio_status status = BRIO_OK;
    moved_vertices m = {.ctx = ctx};
    double *x = NULL;
    for (size_t n = 0; n < cells->num_cells; n++) {
        moved_vertex v;
        memcpy(v.move, t->home[cells->site[n]], sizeof v.move);
        for (uint64_t f = cells->face_offsets[n]; f < cells->face_offsets[n + 1]; f++)
            for (uint64_t at = cells->corner_offsets[f]; at < cells->corner_offsets[f + 1]; at++) {
                v.vertex = cells->face_vertices[at];
                BRIO_TRY(find_moved(&m, &v, &cells->face_vertices[at]));
            }
    }
    BRIO_TRY(BRIO_ALLOC(ctx, x, 3 * m.count + 1));
    for (size_t i = 0; i < m.count; i++)
        for (int k = 0; k < 3; k++)
            x[3 * i + (size_t)k] =
                brio_lattice_shown(&t->lattice, cells->vertices[3 * (size_t)m.list[i].vertex + (size_t)k], k) +
                moved_by(t, m.list[i].move, k);
    brio_release(ctx, cells->vertices);
    cells->vertices = x;
    cells->num_vertices = m.count;
done:
    brio_release(ctx, m.slot);
    brio_release(ctx, m.list);
    return status;
}

/* Unfolds the tetrahedra. Finds no images that are not known where a sweep was prepared. */
static brio_status unfold(void *user, const uint8_t *wanted, brio_cell_complex *complex) {
    periodic_call *c = user;
    brio_unfolded made = {0};
    BRIO_FORWARD(brio_periodic_unfold(c->ctx, c->t, wanted, &c->images, &made));
    complex->tet = made.tet;
    complex->num_finite = made.num_finite;
    complex->count = made.count;
    return BRIO_OK;
}

/* Makes what a sweep takes: the further tetrahedra, and whose translates the images are. */
static brio_status prepare_sweep(periodic_call *c, brio_cell_complex *complex) {
    brio_images *m = &c->images;
    BRIO_FORWARD(brio_periodic_further(c->ctx, c->t, m, &c->more, &complex->num_more));
    BRIO_FORWARD(BRIO_ALLOC(c->ctx, c->owner, m->count - m->num_points));
    for (size_t i = m->num_points; i < m->count; i++) c->owner[i - m->num_points] = m->list[i].point;
    complex->tet = c->t->tet;
    complex->num_finite = c->t->stats.tetrahedra;
    complex->count = c->t->stats.tetrahedra + c->t->stats.hull_facets;
    complex->more = (const uint32_t(*)[4])c->more;
    complex->owner = c->owner;
    complex->whole = unfold;
    complex->user = c;
    return BRIO_OK;
}

static brio_status compute(periodic_call *c, const brio_cells_options *options, brio_cells **out) {
    brio_cells_options o = *options;
    bool flat = c->t->stats.dimension < 3;
    BRIO_FORWARD(brio_images_copy(c->ctx, &c->t->images, &c->t->lattice, &c->images));
    brio_cell_complex complex = {.num_sites = c->images.num_points};
    if (flat) {
        BRIO_FORWARD(add_all(c));
    } else if (brio_cells_are_swept(&o)) {
        BRIO_FORWARD(prepare_sweep(c, &complex));
    } else {
        BRIO_FORWARD(unfold(c, NULL, &complex));
        c->unfolded = complex.tet;
    }
    BRIO_FORWARD(take_box(c, &o));
    complex.points = c->images.x[0];
    complex.weights = c->images.weight;
    complex.num_points = c->images.count;
    BRIO_FORWARD(brio_cells_of_complex(c->ctx, &complex, &o, out));
    if (c->t->lattice.rank == 3) (*out)->region_volume = c->t->lattice.volume;
    BRIO_FORWARD(show_neighbours(c, *out));
    move_centroids(c, *out);
    return (*out)->vertices ? move_vertices(c, *out) : BRIO_OK;
}

brio_status brio_periodic_cells(brio_context *ctx, const brio_periodic *t, const brio_cells_options *options,
                                brio_cells **out) {
    BRIO_DOOR;
    periodic_call c = {.ctx = ctx, .t = t};
    brio_cells_options o = {0};
    brio_status status = BRIO_OK;
    *out = NULL;
    brio_keep_begin(ctx);
    BRIO_TRY(BRIO_TAKE(ctx, brio_cells_options, options, &o));
    BRIO_TRY(compute(&c, &o, out));
done:
    brio_keep_end(ctx);
    brio_images_free(&c.images);
    brio_release(ctx, c.unfolded);
    brio_release(ctx, c.more);
    brio_release(ctx, c.owner);
    if (status != BRIO_OK) {
        brio_cells_free(*out);
        *out = NULL;
    }
    return status;
}
