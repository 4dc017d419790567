/* Sibson's coordinates of a query: the shares of its Voronoi cell that it would take from the cells of its natural
 * neighbours. */
#ifndef BRIO_LOCATE_NATURAL_H
#define BRIO_LOCATE_NATURAL_H

#include "base/memory.h"
#include "locate/holder.h"

/* --- barycentric coordinates --- */

/* Coordinates of a query in the tetrahedron that holds it. */

/** Sets share[i] to the barycentric coordinate of x at vertex i of the tetrahedron. The shares are at least 0 and sum
 *  to
 *  1. They are exactly 0 for vertices opposite to a facet whose plane holds x.   h  not outside. */
void brio_barycentric(const brio_locator *l, const brio_holder *h, const double *x, double share[4]);

/** Sets row to scale (position of the place - x). */
static inline void brio_offset(const brio_locator *l, uint32_t place, const double *x, double scale, double *row) {
    for (int k = 0; k < 3; k++) row[k] = (l->record[place][k] - x[k]) * scale;
}

/* --- numbers of indices --- */

/* A small map from keys to numbers, for sets that are built and forgotten once a query. Open addressing; a clear is one
 * step, because each entry knows the generation that wrote it. */

typedef struct {
    uint64_t key;
    uint32_t generation, value;
} brio_map_entry;

/** I1  The entries whose generation is the map's are in use; at most half of the entries are. */
typedef struct {
    brio_map_entry *entry;
    size_t capacity, size; /* capacity: 0 or a power of two */
    uint32_t generation;   /* not 0 once there are entries */
} brio_index_map;

/** Grows the map so that one more key fits. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_map_grow(brio_context *ctx, brio_index_map *map);

static inline size_t brio_map_place(const brio_index_map *map, uint64_t key) {
    size_t i = (size_t)((key * UINT64_C(0x9e3779b97f4a7c15)) >> 32) & (map->capacity - 1);
    while (map->entry[i].generation == map->generation && map->entry[i].key != key) i = (i + 1) & (map->capacity - 1);
    return i;
}

/** Sets *value to where the number of a key is kept; a new key has the number `fresh`, and *is_new is set. The pointer
 *  is valid until the next call.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
static inline brio_status brio_map_find(brio_context *ctx, brio_index_map *map, uint64_t key, uint32_t fresh,
                                        uint32_t **value, bool *is_new) {
    if (2 * map->size >= map->capacity) {
        brio_status status = brio_map_grow(ctx, map);
        if (status != BRIO_OK) return status;
    }
    brio_map_entry *e = &map->entry[brio_map_place(map, key)];
    if ((*is_new = e->generation != map->generation)) {
        *e = (brio_map_entry){key, map->generation, fresh};
        map->size++;
    }
    *value = &e->value;
    return BRIO_OK;
}

/** A dual edge: the facet between two tetrahedra of the cavity, or on its border. */
typedef struct {
    uint32_t corner[3]; /* local vertices, such that (corner, apex of tetrahedron `from`) is positive */
    uint32_t from, to;  /* centres: of the tetrahedron that the facet is seen from, and behind it */
} brio_dual_edge;

/** What is known of an edge of the cavity: the facet between the Voronoi cells of its ends. */
typedef struct {
    uint32_t end[2]; /* local vertices, end[0] < end[1] */
    uint32_t origin; /* a centre on the facet */
    double area[3];  /* twice the vector area of the facet's part inside the query's cell */
} brio_dual_facet;

/** The workspace of one thread, and the coordinates that were computed last. Offsets are relative to the query and
 *  scaled. */
typedef struct {
    brio_context *ctx;
    brio_index_map tets, vertices, edges; /* to the arrays below */
    uint32_t *tet;                        /* the cavity: the tetrahedra whose spheres hold the query */
    uint32_t *place;                      /* of each local vertex; local vertex 0 is the query */
    uint32_t (*corner)[4];                /* of each centre: the local vertices of its tetrahedron */
    double (*offset)[3], (*centre)[3];    /* of local vertices; of centres */
    uint32_t *base;                       /* of each local vertex: a centre on its bisector with the query */
    double *share;                        /* of each local vertex: its coordinate; 0 for the query */
    brio_dual_edge *edge;
    brio_dual_facet *facet;
    size_t num_tets, num_vertices, num_centres, num_edges, num_facets;
    size_t tet_room, place_room, corner_room, offset_room, centre_room, base_room, share_room, edge_room, facet_room;
} brio_natural;

void brio_natural_free(brio_natural *n);

/** Computes the coordinates of x: share[1 .. num_vertices) of the vertices place[1 .. num_vertices). They are at least
 *  0 and sum to 1. Sets *found to false where doubles do not suffice, very near the hull.
 *  h  what brio_find_holders found: inside, not on the hull, not at a vertex. The locator has no weights.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_natural_coordinates(brio_natural *n, brio_querent *q, const brio_holder *h, const double *x,
                                     bool *found);

#endif
