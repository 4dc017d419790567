/* Small patches of the hull, found by flooding the infinite tetrahedra across the facets that they share. A closed object
 * whose evidence is wrong at a few samples of the hull would else get a hole there. */
#include "reconstruct/labeled_delaunay/hull_patches.h"
#include "base/memory.h"
#include "reconstruct/cocone/triangle.h"

/* Chosen. */
static const double SMALL = 0.01;

typedef struct {
    const brio_pole_vectors *v;
    uint8_t *label, *seen; /* seen: of infinite tetrahedra, from the first one on */
    uint32_t *patch;       /* the infinite tetrahedra, patch after patch */
    size_t size;
} flood;

static double facet_area(const brio_pole_vectors *v, size_t tet) {
    const uint32_t *p = v->t.tet[tet].vertex;
    return brio_triangle_area(v->points + 3 * (size_t)p[0], v->points + 3 * (size_t)p[1], v->points + 3 * (size_t)p[2]);
}

/* Lists the patch of an infinite tetrahedron, and returns the area of its hull facets. */
static double list_patch(flood *f, uint32_t first) {
    const brio_pole_vectors *v = f->v;
    double area = 0;
    size_t begin = f->size;
    f->patch[f->size++] = first;
    f->seen[first - v->num_finite] = 1;
    for (size_t i = begin; i < f->size; i++) {
        uint32_t tet = f->patch[i];
        area += facet_area(v, tet);
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
    double all = 0;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, f.seen, hull));
    BRIO_TRY(BRIO_ALLOC(ctx, f.patch, hull));
    for (size_t tet = v->num_finite; tet < v->t.count; tet++) all += facet_area(v, tet);
    for (size_t tet = v->num_finite; tet < v->t.count; tet++) {
        size_t begin = f.size;
        if (f.seen[tet - v->num_finite] || list_patch(&f, (uint32_t)tet) >= SMALL * all) continue;
        for (size_t i = begin; i < f.size; i++) label[f.patch[i]] = brio_other_label(label[f.patch[i]]);
    }
done:
    brio_release(ctx, f.seen);
    brio_release(ctx, f.patch);
    return status;
}
