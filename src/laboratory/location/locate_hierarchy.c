/* Point location by the Delaunay hierarchy.
 *
 * Level 0 is the triangulation of all points. Level l + 1 is the triangulation of a random sample of the points of
 * level l. Each level has a store and an inserter. A walk locates the point in the highest level. The next walk, one
 * level below, starts from the nearest vertex of the tetrahedron found, and so on down to level 0. A point that became
 * a vertex is then inserted into the higher levels that drew it, where its tetrahedra are already known. With weights
 * a vertex of a level may have been hidden in the level below; then the walk starts from the vertex that replaced it.
 *
 * Based on: Devillers. The Delaunay hierarchy. IJFCS 2002.
 * Differs from the paper: the nearest vertex of the tetrahedron, not of the sample, leads downwards. The sample is
 * drawn beforehand, so that the records of a level are contiguous. */
#include "laboratory/location/trial.h"
#include "base/memory.h"
#include "base/rng.h"
#include "triangulation/insert.h"
#include "triangulation/start.h"
#include "triangulation/vertex_tets.h"
#include <assert.h>
#include <string.h>

enum { RATIO = 30, MOST_LEVELS = 7 };

typedef struct {
    brio_store *store;
    brio_inserter *inserter;
    uint32_t *vertex_tet;
    uint32_t *below;  /* number of each record in the level below */
    uint32_t next;    /* no record before this one still waits for insertion */
    uint32_t located; /* tetrahedron that locates the point being inserted */
    brio_touch_view view;
} level;

typedef struct {
    level level[MOST_LEVELS]; /* level 0 has all points */
    int num_levels;
    uint64_t seed;
} hierarchy;

/* Returns the highest level for which a record is drawn. The first dimension + 1 records are in every level, because
 * they make its first tetrahedron. */
static int height_of(const brio_store *s, const hierarchy *own, uint32_t p) {
    brio_rng rng = brio_rng_new(own->seed ^ brio_mix(p));
    int height = 0, first = s->dimension + 1;
    if ((int64_t)p < first) return MOST_LEVELS - 1;
    while (height < MOST_LEVELS - 1 && brio_rng_below(&rng, RATIO) == 0) height++;
    return height;
}

static brio_status filled_level(brio_inserter *ins, uint32_t p) {
    const level *own = ins->location;
    BRIO_FORWARD(brio_count_insertion(ins, p));
    brio_vertex_tets_filled(ins, own->vertex_tet);
    return BRIO_OK;
}

/* Returns the tetrahedron found earlier: above level 0 a point is located before its insertion. */
static brio_status locate_level(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    const level *own = ins->location;
    (void)p;
    *tet = own->located;
    return BRIO_OK;
}

static const brio_strategy locator_level = {.locate = locate_level, .filled = filled_level};

/* Allocates a level for n of all records. */
static brio_status level_new(const brio_store *all, level *own, size_t n) {
    BRIO_FORWARD(brio_store_sample(all, n, &own->store));
    BRIO_FORWARD(BRIO_ALLOC(all->ctx, own->below, n + 3));
    return BRIO_ALLOC(all->ctx, own->vertex_tet, n + 3);
}

/* Distributes the records among the levels; each level keeps the order of insertion. */
static void deal_records(const brio_store *all, hierarchy *own) {
    uint32_t count[MOST_LEVELS] = {0};
    for (uint32_t p = 0; p < all->num_points; p++) {
        int height = height_of(all, own, p);
        uint32_t below = p;
        for (int l = 1; l <= height && l < own->num_levels; l++) {
            uint32_t at = count[l]++;
            brio_store *s = own->level[l].store;
            memcpy(s->record[at], all->record[p], sizeof(brio_record));
            s->caller[at] = at;
            assert(at < s->num_points && (at == 0 || own->level[l].below[at - 1] < below));
            own->level[l].below[at] = below;
            below = at;
        }
    }
}

/* Starts a level. Its first tetrahedron has the vertices of the first tetrahedron of the level below, apexes
 * included. */
static brio_status start_level(const brio_store *all, level *own, const brio_store *below) {
    brio_store *s = own->store;
    BRIO_FORWARD(brio_start(s));
    s->filter = all->filter; /* its bounds hold for all points that will be located */
    BRIO_FORWARD(brio_inserter_new(s, &own->inserter));
    own->inserter->locator = &locator_level;
    own->inserter->location = own;
    for (uint32_t i = 0; i < 3; i++) own->below[s->num_points + i] = (uint32_t)below->num_points + i;
    own->next = (uint32_t)s->dimension + 1;
    brio_vertex_tets_fill(s, own->vertex_tet);
    return BRIO_OK;
}

static brio_status start_hierarchy(brio_inserter *ins) {
    brio_store *s = ins->store;
    hierarchy *own = NULL;
    size_t size[MOST_LEVELS] = {0};
    BRIO_FORWARD(BRIO_ALLOC_ZERO(s->ctx, own, 1));
    ins->location = own;
    own->seed = brio_trial_of(ins)->seed;
    own->level[0].store = s;
    own->level[0].inserter = ins;
    own->num_levels = 1;
    BRIO_FORWARD(BRIO_ALLOC(s->ctx, own->level[0].vertex_tet, s->num_points + 3));
    brio_vertex_tets_fill(s, own->level[0].vertex_tet);
    for (uint32_t p = 0; p < s->num_points; p++)
        for (int l = height_of(s, own, p); l >= 0; l--) size[l]++;
    for (int l = 1; l < MOST_LEVELS && size[l] > (size_t)s->dimension + 1; l++, own->num_levels++)
        BRIO_FORWARD(level_new(s, &own->level[l], size[l]));
    deal_records(s, own);
    for (int l = 1; l < own->num_levels; l++) {
        BRIO_FORWARD(start_level(s, &own->level[l], own->level[l - 1].store));
        brio_count_touches(own->level[l].inserter, &own->level[l].view, brio_trial_of(ins)->touches, 2 * l);
    }
    return BRIO_OK;
}

static uint32_t nearest_of(const brio_store *s, uint32_t tet, const double *p) {
    const uint32_t *v = s->t.tet[tet].vertex;
    uint32_t best = v[0];
    assert(best < s->t.infinite); /* I2 */
    double least = brio_square_distance(p, s->record[best]);
    for (int i = 1; i < 4 && v[i] != s->t.infinite; i++) {
        double square = brio_square_distance(p, s->record[v[i]]);
        if (square < least) best = v[i], least = square;
    }
    return best;
}

static brio_status locate(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    hierarchy *own = ins->location;
    const double *point = ins->store->record[p];
    for (int l = own->num_levels - 1; l >= 0; l--) {
        level *here = &own->level[l];
        uint64_t before = here->inserter->walk.steps;
        here->located = brio_inserter_walk(here->inserter, point, UINT64_MAX);
        if (l == 0) break;
        ins->walk.steps += here->inserter->walk.steps - before;
        const level *below = &own->level[l - 1];
        uint32_t v = brio_alive(below->store, here->below[nearest_of(here->store, here->located, point)]);
        assert(below->store->representative[v] == v);
        below->inserter->walk.start = below->vertex_tet[v];
    }
    *tet = own->level[0].located;
    return BRIO_OK;
}

static brio_status filled(brio_inserter *ins, uint32_t p) {
    hierarchy *own = ins->location;
    BRIO_FORWARD(brio_count_insertion(ins, p));
    brio_vertex_tets_filled(ins, own->level[0].vertex_tet);
    int height = height_of(ins->store, own, p);
    uint32_t below = p;
    for (int l = 1; l <= height && l < own->num_levels; l++) {
        level *here = &own->level[l];
        brio_insertion outcome;
        while (here->below[here->next] < below) here->next++;
        assert(here->next < here->store->num_points &&
               here->below[here->next] == below); /* the level drew this record */
        brio_status status = brio_insert(here->inserter, here->next, &outcome);
        if (status != BRIO_OK) return status;
        below = here->next;
    }
    return BRIO_OK;
}

static void free_hierarchy(brio_inserter *ins) {
    brio_context *ctx = ins->store->ctx;
    hierarchy *own = ins->location;
    for (int l = 0; own && l < MOST_LEVELS; l++) {
        level *here = &own->level[l];
        brio_release(ctx, here->vertex_tet);
        brio_release(ctx, here->below);
        if (l == 0) continue;
        brio_inserter_free(here->inserter);
        brio_store_free(here->store);
    }
    brio_release(ctx, own);
    ins->location = NULL;
}

const brio_strategy brio_strategy_hierarchy = {start_hierarchy, locate, filled, free_hierarchy};
