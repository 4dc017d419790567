/* Point location by the Delaunay hierarchy.
 *
 * Above the triangulation of the points stands one of a random sample of them, above that one of a sample of the sample,
 * and so on; each has a kernel of its own. A point is located in the smallest triangulation by a walk; from the nearest
 * vertex of the tetrahedron found there the next walk starts in the triangulation below. A point that became a vertex is
 * then inserted into the triangulations above that drew it, where its tetrahedra are known by now. With weights a vertex
 * above may have been hidden below: then the vertex that took its place is where the walk starts.
 *
 * Based on: Devillers. The Delaunay hierarchy. IJFCS 2002.
 * Differs from the paper: the nearest vertex of the tetrahedron, not of the sample, leads downwards; the sample is
 * drawn beforehand, so that the records of a triangulation lie side by side. */
#include "base/memory.h"
#include "base/rng.h"
#include "triangulation/kernel.h"
#include "triangulation/vertex_tets.h"
#include <string.h>

enum { RATIO = 30, MOST_LEVELS = 7 };

typedef struct {
    brio_kernel *kernel;
    uint32_t *vertex_tet;
    uint32_t *below;  /* each record's number in the triangulation below */
    uint32_t next;    /* no record before this one is waiting to be inserted */
    uint32_t located; /* tetrahedron of the point that is being inserted */
} level;

typedef struct {
    level level[MOST_LEVELS]; /* the first is that of all points */
    int num_levels;
    uint64_t seed;
} hierarchy;

/* The highest level that a record is drawn for. The first ones make the first tetrahedron in each level. */
static int height_of(const brio_kernel *k, const hierarchy *own, uint32_t p) {
    brio_rng rng = brio_rng_new(own->seed ^ brio_mix(p));
    int height = 0, first = k->dimension + 1;
    if ((int64_t)p < first) return MOST_LEVELS - 1;
    while (height < MOST_LEVELS - 1 && brio_rng_below(&rng, RATIO) == 0) height++;
    return height;
}

static brio_status filled_level(brio_kernel *k, uint32_t p) {
    const level *own = k->location;
    (void)p;
    brio_vertex_tets_filled(k, own->vertex_tet);
    return BRIO_OK;
}

/* In a triangulation above, the point has been located before it is inserted. */
static brio_status locate_level(brio_kernel *k, uint32_t p, uint32_t *tet) {
    const level *own = k->location;
    (void)p;
    *tet = own->located;
    return BRIO_OK;
}

static const brio_locator locator_level = {.locate = locate_level, .filled = filled_level};

/* A kernel for n of the records of another. */
static brio_status level_new(const brio_kernel *main, level *own, size_t n) {
    brio_status status = BRIO_OK;
    brio_context *ctx = main->ctx;
    brio_kernel *k = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, k, 1));
    own->kernel = k;
    k->ctx = ctx;
    k->num_points = n;
    k->weighted = main->weighted;
    k->engine = main->engine;
    k->locator = &locator_level;
    k->location = own;
    k->max_tetrahedra = main->max_tetrahedra;
    k->t.infinite = (uint32_t)n + 2;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, k->record, n + 3));
    k->record[n + 2][3] = INFINITY;
    k->t.record = k->record;
    BRIO_TRY(BRIO_ALLOC(ctx, k->caller, n + 3));
    BRIO_TRY(BRIO_ALLOC(ctx, own->below, n + 3));
    BRIO_TRY(BRIO_ALLOC(ctx, own->vertex_tet, n + 3));
    status = brio_kernel_workspace(k);
done:
    return status;
}

/* Divides the records among the levels, those of each in the order of insertion. */
static void deal_records(const brio_kernel *k, hierarchy *own) {
    uint32_t count[MOST_LEVELS] = {0};
    for (uint32_t p = 0; p < k->num_points; p++) {
        int height = height_of(k, own, p);
        uint32_t below = p;
        for (int l = 1; l <= height && l < own->num_levels; l++) {
            uint32_t at = count[l]++;
            brio_kernel *kernel = own->level[l].kernel;
            memcpy(kernel->record[at], k->record[p], sizeof(brio_record));
            kernel->caller[at] = at;
            own->level[l].below[at] = below;
            below = at;
        }
    }
}

/* The first tetrahedron of a level has the same vertices as that of the level below, apexes included. */
static brio_status start_level(const brio_kernel *main, level *own, const brio_kernel *below) {
    brio_kernel *k = own->kernel;
    brio_status status = brio_kernel_start(k);
    if (status != BRIO_OK) return status;
    for (uint32_t i = 0; i < 3; i++) own->below[k->num_points + i] = (uint32_t)below->num_points + i;
    k->filter = main->filter; /* whose bounds hold for all points that will be located */
    own->next = (uint32_t)k->dimension + 1;
    brio_vertex_tets_fill(k, own->vertex_tet);
    return BRIO_OK;
}

static brio_status start_hierarchy(brio_kernel *k, const brio_delaunay_options *options) {
    hierarchy *own = NULL;
    size_t size[MOST_LEVELS] = {0};
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC_ZERO(k->ctx, own, 1));
    k->location = own;
    own->seed = options->seed;
    own->level[0].kernel = k;
    own->num_levels = 1;
    BRIO_TRY(BRIO_ALLOC(k->ctx, own->level[0].vertex_tet, k->num_points + 3));
    brio_vertex_tets_fill(k, own->level[0].vertex_tet);
    for (uint32_t p = 0; p < k->num_points; p++)
        for (int l = height_of(k, own, p); l >= 0; l--) size[l]++;
    for (int l = 1; l < MOST_LEVELS && size[l] > (size_t)k->dimension + 1; l++, own->num_levels++)
        BRIO_TRY(level_new(k, &own->level[l], size[l]));
    deal_records(k, own);
    for (int l = 1; l < own->num_levels; l++) BRIO_TRY(start_level(k, &own->level[l], own->level[l - 1].kernel));
done:
    return status;
}

static uint32_t nearest_of(const brio_kernel *k, uint32_t tet, const double *p) {
    const uint32_t *v = k->t.tet[tet].vertex;
    uint32_t best = v[0];
    double least = brio_square_distance(p, k->record[best]);
    for (int i = 1; i < 4 && v[i] != k->t.infinite; i++) {
        double square = brio_square_distance(p, k->record[v[i]]);
        if (square < least) best = v[i], least = square;
    }
    return best;
}

static brio_status locate(brio_kernel *k, uint32_t p, uint32_t *tet) {
    hierarchy *own = k->location;
    const double *point = k->record[p];
    for (int l = own->num_levels - 1; l >= 0; l--) {
        brio_kernel *here = own->level[l].kernel;
        uint64_t before = here->walk.steps;
        uint32_t at = here->engine->walk(&here->t, &here->filter, &here->walk, point, UINT64_MAX);
        own->level[l].located = at;
        if (l == 0) break;
        k->walk.steps += here->walk.steps - before;
        const level *below = &own->level[l - 1];
        uint32_t v = brio_alive(below->kernel, own->level[l].below[nearest_of(here, at, point)]);
        below->kernel->walk.start = below->vertex_tet[v];
    }
    *tet = own->level[0].located;
    return BRIO_OK;
}

static brio_status filled(brio_kernel *k, uint32_t p) {
    hierarchy *own = k->location;
    brio_vertex_tets_filled(k, own->level[0].vertex_tet);
    int height = height_of(k, own, p);
    uint32_t below = p;
    for (int l = 1; l <= height && l < own->num_levels; l++) {
        level *here = &own->level[l];
        while (here->below[here->next] < below) here->next++;
        brio_status status = brio_kernel_insert(here->kernel, here->next);
        if (status != BRIO_OK) return status;
        below = here->next;
    }
    return BRIO_OK;
}

static void free_hierarchy(brio_kernel *k) {
    hierarchy *own = k->location;
    for (int l = 0; own && l < MOST_LEVELS; l++) {
        level *here = &own->level[l];
        brio_release(k->ctx, here->vertex_tet);
        brio_release(k->ctx, here->below);
        if (l == 0 || !here->kernel) continue;
        brio_kernel_free(here->kernel);
        brio_release(k->ctx, here->kernel);
    }
    brio_release(k->ctx, own);
    k->location = NULL;
}

const brio_locator brio_locator_hierarchy = {start_hierarchy, locate, filled, free_hierarchy};
