/* Small regions of labels. A union-find joins the tetrahedra of one label across facets; its sets are the regions. At
 * the least tetrahedron of a region the facets to the other label are counted, up to what makes the region large. The
 * regions are the same for any number of threads.
 *
 * At the hull, patches are found by flooding the infinite tetrahedra across the facets that they share. A closed object
 * whose evidence is wrong at a few samples of the hull would else get a hole there. */
#include "reconstruct/labeled_delaunay/small_regions.h"
#include "base/memory.h"
#include "base/team.h"
#include "base/union_find.h"
#include "base/scale.h"
#include "reconstruct/cocone/triangle.h"
#include "reconstruct/labels/label.h"
#include <assert.h>

/* LARGE: the count of a region with an infinite tetrahedron. TETS_A_THREAD is chosen. */
enum { LARGE = UINT16_MAX, TETS_A_THREAD = 1 << 13 };

typedef struct {
    const brio_tetrahedra *t;
    uint8_t *label;
    uint32_t *parent;   /* #T: union-find; the root of a region is its least tetrahedron */
    uint16_t *boundary; /* #T: of roots: facets to the other label; those past `least` need not be counted */
    size_t least, small;
    bool alone; /* one thread does all */
} sieve;

static void make_regions(void *user, size_t begin, size_t end, int thread) {
    sieve *s = user;
    (void)thread;
    for (size_t tet = begin; tet < end; tet++) s->parent[tet] = (uint32_t)tet;
}

static void join_regions(void *user, size_t begin, size_t end, int thread) {
    sieve *s = user;
    (void)thread;
    for (uint32_t tet = (uint32_t)begin; tet < end; tet++)
        for (int i = 0; i < 4; i++) {
            uint32_t other = brio_tet_of(s->t->tet[tet].mate[i]);
            if (other < tet && s->label[other] == s->label[tet]) brio_unite(s->parent, tet, other, s->alone);
        }
}

/* Counts facets to the other label. Threads that add to one region at once may count a few past `least`. */
static void count_facets(void *user, size_t begin, size_t end, int thread) {
    sieve *s = user;
    (void)thread;
    for (uint32_t tet = (uint32_t)begin; tet < end; tet++) {
        uint16_t count = 0;
        for (int i = 0; i < 4; i++) count += s->label[brio_tet_of(s->t->tet[tet].mate[i])] != s->label[tet];
        if (count == 0) continue;
        uint16_t *all = &s->boundary[brio_find(s->parent, tet)];
        if (__atomic_load_n(all, __ATOMIC_RELAXED) < s->least) __atomic_fetch_add(all, count, __ATOMIC_RELAXED);
    }
}

static void keep_infinite(void *user, size_t begin, size_t end, int thread) {
    sieve *s = user;
    (void)thread;
    for (uint32_t tet = (uint32_t)begin; tet < end; tet++)
        if (brio_is_infinite(s->t, tet))
            __atomic_store_n(&s->boundary[brio_find(s->parent, tet)], LARGE, __ATOMIC_RELAXED);
}

static void drop_regions(void *user, size_t begin, size_t end, int thread) {
    sieve *s = user;
    size_t small = 0;
    (void)thread;
    for (uint32_t tet = (uint32_t)begin; tet < end; tet++) {
        uint32_t root = brio_find(s->parent, tet);
        if (s->boundary[root] >= s->least) continue;
        s->label[tet] = brio_other_label(s->label[tet]);
        small += root == tet;
    }
    __atomic_fetch_add(&s->small, small, __ATOMIC_RELAXED);
}

brio_status brio_drop_small_regions(brio_context *ctx, const brio_tetrahedra *t, size_t least, uint8_t *label,
                                    size_t *changed) {
    brio_status status = BRIO_OK;
    int threads = brio_threads(ctx, t->count, TETS_A_THREAD);
    assert(least <= LARGE / 2); /* counts stay below LARGE, with what threads add past `least` */
    sieve s = {.t = t, .label = label, .least = least, .alone = threads == 1};
    *changed = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, s.parent, t->count));
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, s.boundary, t->count));
    BRIO_TRY(brio_sweep(ctx, threads, t->count, make_regions, &s, BRIO_WRITES(s.parent)));
    BRIO_TRY(brio_sweep(ctx, threads, t->count, join_regions, &s, BRIO_READS(t->tet), BRIO_WRITES(s.parent)));
    BRIO_TRY(brio_sweep(ctx, threads, t->count, count_facets, &s, BRIO_READS(t->tet), BRIO_READS(s.parent)));
    BRIO_TRY(brio_sweep(ctx, threads, t->count, keep_infinite, &s, BRIO_READS(t->tet)));
    BRIO_TRY(brio_sweep(ctx, threads, t->count, drop_regions, &s, BRIO_READS(s.parent)));
    *changed = s.small;
done:
    brio_release(ctx, s.parent);
    brio_release(ctx, s.boundary);
    return status;
}

size_t brio_count_boundary(const brio_context *ctx, const brio_tetrahedra *t, const uint8_t *label) {
    size_t count = 0;
    for (size_t tet = 0; tet < t->count; tet++) {
        brio_along(ctx, tet, t->count, BRIO_READS(t->tet));
        for (int i = 0; i < 4; i++) count += label[tet] < label[brio_tet_of(t->tet[tet].mate[i])];
    }
    return count;
}

/* --- patches of the hull --- */

/* A patch of the hull under this share of its area is small. Chosen. */
static const double SMALL = 0.01;

typedef struct {
    const brio_pole_vectors *v;
    uint8_t *label, *seen; /* seen: of infinite tetrahedra, from the first one on */
    uint32_t *patch;       /* the infinite tetrahedra, patch after patch */
    size_t size;
    brio_sum_unit unit; /* of areas */
} flood;

static double facet_area(const brio_pole_vectors *v, size_t tet) {
    const uint32_t *p = v->t.tet[tet].vertex;
    return brio_triangle_area(v->points + 3 * (size_t)p[0], v->points + 3 * (size_t)p[1], v->points + 3 * (size_t)p[2]);
}

/* Lists the patch of an infinite tetrahedron, and returns the area of its hull facets, in units. */
static int64_t list_patch(flood *f, uint32_t first) {
    const brio_pole_vectors *v = f->v;
    int64_t area = 0;
    size_t begin = f->size;
    f->patch[f->size++] = first;
    f->seen[first - v->num_finite] = 1;
    for (size_t i = begin; i < f->size; i++) {
        uint32_t tet = f->patch[i];
        area += brio_in_units(f->unit, facet_area(v, tet));
        for (int k = 0; k < 3; k++) {
            uint32_t other = brio_tet_of(v->t.tet[tet].mate[k]);
            if (f->seen[other - v->num_finite] || f->label[other] != f->label[first]) continue;
            f->seen[other - v->num_finite] = 1;
            f->patch[f->size++] = other;
        }
    }
    return area;
}

brio_status brio_drop_hull_patches(brio_context *ctx, const brio_pole_vectors *v, uint8_t *label) {
    brio_status status = BRIO_OK;
    size_t hull = v->t.count - v->num_finite;
    flood f = {.v = v, .label = label};
    double greatest = 0;
    int64_t all = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f.seen, hull));
    BRIO_TRY(BRIO_ALLOC(ctx, f.patch, hull));
    for (size_t tet = v->num_finite; tet < v->t.count; tet++) greatest = fmax(greatest, facet_area(v, tet));
    f.unit = brio_sum_unit_for(greatest, hull);
    for (size_t tet = v->num_finite; tet < v->t.count; tet++) all += brio_in_units(f.unit, facet_area(v, tet));
    for (size_t tet = v->num_finite; tet < v->t.count; tet++) {
        size_t begin = f.size;
        if (f.seen[tet - v->num_finite] || (double)list_patch(&f, (uint32_t)tet) >= SMALL * (double)all) continue;
        for (size_t i = begin; i < f.size; i++) label[f.patch[i]] = brio_other_label(label[f.patch[i]]);
    }
done:
    brio_release(ctx, f.seen);
    brio_release(ctx, f.patch);
    return status;
}
