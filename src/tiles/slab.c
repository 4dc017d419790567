/* A slab: some successive points of a tile with the tetrahedra of their stars, as a complex whose cells are computed at
 * once. The memory of cells with faces is many times that of a triangulation, so a tile's cells are computed slab after
 * slab.
 *
 * The tile's file has the tetrahedra that belong to the tile, and its border; a tetrahedron is of each slab that has a
 * vertex of it. Mates are found by a hash table of the facets that have a site. The order of tetrahedra in the file
 * depends on threads. The numbers of cells and faces do not depend on it; the order of the cells' vertices does, so for
 * them tetrahedra are sorted by the places of their vertices. */
#include "tiles/cells.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include <assert.h>
#include <string.h>

enum { SITES = BRIO_SLAB_SITES };

/* --- a tile --- */

void brio_slabs_free(brio_slabs *s) {
    brio_context *ctx = s->t->ctx;
    brio_tile_result_free(s->t, &s->result);
    brio_release(ctx, s->border);
    brio_release(ctx, s->points);
    brio_release(ctx, s->first);
    brio_release(ctx, s->list);
    brio_release(ctx, s->local);
    brio_release(ctx, s->row);
    brio_release(ctx, s->tet);
    brio_release(ctx, s->slot);
    brio_release(ctx, s->at);
    brio_release(ctx, s->weights);
}

/* Returns the vertices of tetrahedron i: of those of the file, then of the border. */
static inline const uint32_t *vertices_of(const brio_slabs *s, size_t i) {
    return i < s->num_tets ? s->result.tetrahedra[i] : s->border[i - s->num_tets];
}

static inline bool is_finite(const uint32_t *v) {
    return v[3] != BRIO_INFINITE;
}

/* Writes the slabs of a tetrahedron, each once. Returns how many there are. */
static int slabs_of(const brio_slabs *s, const uint32_t *v, uint32_t slab[4]) {
    int n = 0;
    for (int k = 0; k < (is_finite(v) ? 4 : 3); k++) {
        if (v[k] >= s->num_own) continue;
        int i = 0;
        while (i < n && slab[i] != v[k] / SITES) i++;
        if (i == n) slab[n++] = v[k] / SITES;
    }
    return n;
}

/* Lists the tetrahedra of each slab. */
static brio_status list_tetrahedra(brio_slabs *s) {
    brio_context *ctx = s->t->ctx;
    size_t all = s->num_tets + s->num_border;
    uint32_t slab[4];
    BRIO_FORWARD(BRIO_ALLOC_ZERO(ctx, s->first, s->count + 2));
    for (size_t i = 0; i < all; i++) {
        const uint32_t *v = vertices_of(s, i);
        for (int k = 0; k < 4; k++)
            BRIO_EXPECT(ctx, v[k] < s->num_rows || (k == 3 && i >= s->num_tets && !is_finite(v)), BRIO_ERR_OPEN,
                        "%s/tile-%u was changed from outside", s->t->folder.path, s->tile);
        for (int n = slabs_of(s, v, slab); n-- > 0;) s->first[slab[n] + 2]++;
        BRIO_FORWARD(brio_look(ctx, 1));
    }
    for (size_t i = 2; i < s->count + 2; i++) s->first[i] += s->first[i - 1];
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->list, s->first[s->count + 1] + 1));
    for (size_t i = 0; i < all; i++) {
        for (int n = slabs_of(s, vertices_of(s, i), slab); n-- > 0;) s->list[s->first[slab[n] + 1]++] = (uint32_t)i;
        BRIO_FORWARD(brio_look(ctx, 1));
    }
    return BRIO_OK;
}

brio_status brio_slabs_open(brio_tiles *t, uint32_t tile, const brio_halo_reader *halo, brio_slabs *s) {
    const brio_tile *facts = &t->tile[tile];
    brio_context *ctx = t->ctx;
    *s = (brio_slabs){.t = t,
                      .tile = tile,
                      .num_own = facts->points,
                      .num_rows = facts->points + facts->halo,
                      .num_tets = facts->tetrahedra,
                      .num_border = facts->border,
                      .count = ((size_t)facts->points + SITES - 1) / SITES};
    BRIO_EXPECT(ctx, s->num_tets + s->num_border < UINT32_MAX, BRIO_ERR_TOO_LARGE,
                "tile %u has 2^32 tetrahedra or more: take more tiles", tile);
    BRIO_FORWARD(brio_tile_result_read(t, tile, true, &s->result));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->border, s->num_border + 1));
    BRIO_FORWARD(brio_tile_border(t, tile, s->border));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->points, s->num_rows + 1));
    BRIO_FORWARD(brio_tile_points(t, facts->place, facts->points, s->points));
    BRIO_FORWARD(halo->read(halo->user, s->result.halo, facts->halo, s->points + facts->points));
    BRIO_FORWARD(BRIO_ALLOC(ctx, s->local, s->num_rows + 1));
    memset(s->local, 0xff, s->num_rows * sizeof *s->local);
    return list_tetrahedra(s);
}

/* --- a slab --- */

/* Writes the places of a tetrahedron's vertices, in ascending order; the infinite vertex is behind all. */
static void places_of(const brio_slabs *s, const uint32_t *v, uint64_t place[4]) {
    uint64_t first = s->t->tile[s->tile].place;
    for (int n = 0; n < 4; n++) {
        uint64_t at = v[n] < s->num_own    ? first + v[n]
                      : v[n] < s->num_rows ? s->result.halo[v[n] - s->num_own]
                                           : UINT64_MAX;
        int i = n;
        for (; i > 0 && place[i - 1] > at; i--) place[i] = place[i - 1];
        place[i] = at;
    }
}

static int compare_tetrahedra(uint32_t i, uint32_t j, const void *user) {
    const brio_slabs *s = user;
    uint64_t a[4], b[4];
    int k = 0;
    places_of(s, vertices_of(s, i), a);
    places_of(s, vertices_of(s, j), b);
    while (k < 3 && a[k] == b[k]) k++;
    return a[k] < b[k] ? -1 : a[k] > b[k];
}

/* Returns the number of a row of the tile in the slab, a new one where it has none. */
static brio_status number(brio_slabs *s, uint32_t row, uint32_t *local) {
    if (s->local[row] == UINT32_MAX) {
        BRIO_FORWARD(BRIO_RESERVE(s->t->ctx, s->row, s->row_capacity, s->complex.num_points + 1));
        s->row[s->complex.num_points] = row;
        s->local[row] = (uint32_t)s->complex.num_points++;
    }
    *local = s->local[row];
    return BRIO_OK;
}

/* Copies the tetrahedra of a slab, the finite ones or the others, with the numbers of their vertices. */
static brio_status copy_tetrahedra(brio_slabs *s, size_t slab, bool finite) {
    brio_cell_complex *c = &s->complex;
    for (uint64_t i = s->first[slab]; i < s->first[slab + 1]; i++) {
        const uint32_t *v = vertices_of(s, s->list[i]);
        if (is_finite(v) != finite) continue;
        brio_tetrahedron *to = &s->tet[c->count];
        to->vertex[3] = BRIO_INFINITE;
        for (int k = 0; k < (finite ? 4 : 3); k++) BRIO_FORWARD(number(s, v[k], &to->vertex[k]));
        for (uint32_t k = 0; k < 4; k++) to->mate[k] = 4 * (uint32_t)c->count + k;
        c->count++;
    }
    return BRIO_OK;
}

/* --- mates --- */

static inline void sort_three(uint32_t v[3]) {
    for (int i = 0; i < 2; i++)
        for (int k = 0; k < 2 - i; k++)
            if (v[k] > v[k + 1]) {
                uint32_t swap = v[k];
                v[k] = v[k + 1], v[k + 1] = swap;
            }
}

/* Writes the vertices of a facet in ascending order. Returns whether one of them is a site. */
static inline bool facet_of(const brio_slabs *s, uint32_t handle, uint32_t v[3]) {
    const uint32_t *vertex = s->tet[handle / 4].vertex;
    for (uint32_t i = 0, n = 0; i < 4; i++)
        if (i != handle % 4) v[n++] = vertex[i];
    sort_three(v);
    return v[0] < s->complex.num_sites;
}

static brio_status find_mates(brio_slabs *s) {
    brio_context *ctx = s->t->ctx;
    size_t slots = 64, unpaired = 0;
    uint32_t v[3], w[3];
    while (slots < 6 * s->complex.count) slots *= 2;
    BRIO_FORWARD(BRIO_RESERVE(ctx, s->slot, s->slot_capacity, slots));
    memset(s->slot, 0xff, slots * sizeof *s->slot);
    for (uint32_t h = 0; h < 4 * s->complex.count; h++) {
        if (!facet_of(s, h, v)) continue;
        size_t at = brio_mix((uint64_t)v[0] << 40 ^ (uint64_t)v[1] << 20 ^ v[2]) & (slots - 1);
        for (; s->slot[at] != UINT32_MAX; at = (at + 1) & (slots - 1)) {
            facet_of(s, s->slot[at], w);
            if (!memcmp(v, w, sizeof v)) break;
        }
        if (s->slot[at] == UINT32_MAX) {
            s->slot[at] = h;
            unpaired++;
            continue;
        }
        s->tet[h / 4].mate[h % 4] = s->slot[at];
        s->tet[s->slot[at] / 4].mate[s->slot[at] % 4] = h;
        unpaired--;
        BRIO_FORWARD(brio_look(ctx, 1));
    }
    BRIO_EXPECT(ctx, unpaired == 0, BRIO_ERR_OPEN, "%s/tile-%u was changed from outside", s->t->folder.path, s->tile);
    return BRIO_OK;
}

/* Writes the positions and weights of the slab's points, and forgets their numbers. */
static brio_status take_points(brio_slabs *s) {
    brio_context *ctx = s->t->ctx;
    size_t n = s->complex.num_points;
    BRIO_FORWARD(BRIO_RESERVE(ctx, s->at, s->at_capacity, 3 * n + 1));
    if (s->t->weighted) BRIO_FORWARD(BRIO_RESERVE(ctx, s->weights, s->weights_capacity, n + 1));
    for (size_t i = 0; i < n; i++) {
        const double *r = s->points[s->row[i]].record;
        memcpy(s->at + 3 * i, r, 3 * sizeof *r);
        if (s->t->weighted) s->weights[i] = r[3];
        s->local[s->row[i]] = UINT32_MAX;
    }
    s->complex.points = s->at;
    s->complex.weights = s->t->weighted ? s->weights : NULL;
    return BRIO_OK;
}

brio_status brio_slabs_take(brio_slabs *s, size_t slab, bool sorted) {
    brio_cell_complex *c = &s->complex;
    size_t begin = slab * SITES, end = begin + SITES < s->num_own ? begin + SITES : s->num_own;
    size_t most = (size_t)(s->first[slab + 1] - s->first[slab]);
    uint32_t local;
    if (sorted) BRIO_FORWARD(brio_sort_many_indices(s->t->ctx, s->list + s->first[slab], most, compare_tetrahedra, s));
    *c = (brio_cell_complex){.num_points = 0};
    for (size_t row = begin; row < end; row++)
        if (s->result.is_vertex[row]) BRIO_FORWARD(number(s, (uint32_t)row, &local));
    c->num_sites = c->num_points;
    BRIO_FORWARD(BRIO_RESERVE(s->t->ctx, s->tet, s->tet_capacity, most + 1));
    c->tet = s->tet;
    BRIO_FORWARD(copy_tetrahedra(s, slab, true));
    c->num_finite = c->count;
    BRIO_FORWARD(copy_tetrahedra(s, slab, false));
    BRIO_FORWARD(find_mates(s));
    return take_points(s);
}
