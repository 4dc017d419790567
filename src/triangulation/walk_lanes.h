/* The walk of locate_walk.c with the four facets of a tetrahedron side by side in the lanes of one AVX2 register;
 * included by the engines that have it. */
#include "triangulation/locate_walk.h"
#include <assert.h>
#include <immintrin.h>

/* Writes x, y, z of the vertices of a tetrahedron relative to p, a vertex a lane. */
static inline void vertices_about(const brio_tetrahedra *t, const uint32_t v[4], const double *p, __m256d xyz[3]) {
    __m256d origin = _mm256_loadu_pd(p), r[4];
    for (int i = 0; i < 4; i++) r[i] = _mm256_loadu_pd(t->record[v[i]]) - origin;
    __m256d ab0 = _mm256_unpacklo_pd(r[0], r[1]), ab1 = _mm256_unpackhi_pd(r[0], r[1]);
    __m256d cd0 = _mm256_unpacklo_pd(r[2], r[3]), cd1 = _mm256_unpackhi_pd(r[2], r[3]);
    xyz[0] = _mm256_permute2f128_pd(ab0, cd0, 0x20);
    xyz[1] = _mm256_permute2f128_pd(ab1, cd1, 0x20);
    xyz[2] = _mm256_permute2f128_pd(ab0, cd0, 0x31);
}

/* Returns in lane i the orientation of the tetrahedron with vertex i replaced by the origin. */
static inline __m256d facet_sides(const __m256d xyz[3]) {
    __m256d a[3], b[3], c[3]; /* the vertices one, two and three after i */
    for (int k = 0; k < 3; k++) {
        a[k] = _mm256_permute4x64_pd(xyz[k], 0x39);
        b[k] = _mm256_permute4x64_pd(xyz[k], 0x4e);
        c[k] = _mm256_permute4x64_pd(xyz[k], 0x93);
    }
    __m256d x = _mm256_fmsub_pd(b[1], c[2], b[2] * c[1]), y = _mm256_fmsub_pd(b[2], c[0], b[0] * c[2]);
    __m256d z = _mm256_fmsub_pd(b[0], c[1], b[1] * c[0]);
    __m256d det = _mm256_fmadd_pd(a[0], x, _mm256_fmadd_pd(a[1], y, a[2] * z));
    return _mm256_xor_pd(det, _mm256_setr_pd(0.0, -0.0, 0.0, -0.0));
}

static inline int sign_of_side(const brio_tetrahedra *t, brio_filter *f, const uint32_t *v, int slot, const double *p) {
    const uint8_t *facet = BRIO_FACET[slot];
    return brio_orient3d_sign(f, t->record[v[facet[0]]], t->record[v[facet[1]]], t->record[v[facet[2]]], p);
}

/* Sets *above to the facets that certainly have p strictly inside. Returns those of the facets `ahead` that have p
 * strictly on their far side. */
static inline unsigned facets_beyond(const brio_tetrahedra *t, brio_filter *f, const uint32_t v[4], const double *p,
                                     unsigned ahead, unsigned *above) {
    __m256d xyz[3], bound = _mm256_set1_pd(f->orient_static);
    vertices_about(t, v, p, xyz);
    __m256d side = facet_sides(xyz);
    *above = (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(side, bound, _CMP_GT_OQ));
    unsigned beyond = ahead & (unsigned)_mm256_movemask_pd(_mm256_cmp_pd(-side, bound, _CMP_GT_OQ));
    unsigned unsure = ahead & ~(*above | beyond);
    for (; __builtin_expect(unsure != 0, 0); unsure &= unsure - 1) {
        int i = __builtin_ctz(unsure);
        beyond |= (unsigned)(sign_of_side(t, f, v, i, p) < 0) << i;
    }
    return beyond;
}

/* Draws one of the facets `beyond`. */
static inline unsigned draw_facet(brio_walk *w, unsigned beyond) {
    w->random = brio_walk_random(w->random);
    assert(beyond != 0 && beyond >> 4 == 0);
    unsigned first = w->random >> 30;
    return (first + (unsigned)__builtin_ctz((beyond | beyond << 4) >> first)) & 3;
}

static uint32_t walk(const brio_tetrahedra *t, brio_zone *zone, brio_filter *f, brio_walk *w, const double *p,
                     uint64_t most_steps) {
    uint32_t tet = brio_walk_begin(t, w);
    unsigned ahead = 15; /* all facets but the one that the walk came through */
    if ((w->blocked = !brio_owns(t, zone, tet))) return BRIO_NO_TET;
    for (uint64_t steps = 0; steps <= most_steps; steps++, w->steps++) {
        assert(brio_has_tet(t, tet) && brio_zone_holds_tet(t, zone, tet)); /* P3 */
        const uint32_t *v = t->tet[tet].vertex;
        if (v[3] == t->infinite) return tet;
        unsigned above, beyond = facets_beyond(t, f, v, p, ahead, &above);
        if (!beyond) {
            w->unsure = 15u & ~above;
            return tet;
        }
        unsigned slot = draw_facet(w, beyond);
        uint32_t mate = t->tet[tet].mate[slot];
        if ((w->blocked = !brio_owns_beyond(t, zone, mate))) return BRIO_NO_TET;
        tet = brio_tet_of(mate);
        ahead = 15u ^ 1u << brio_slot_of(mate);
    }
    return BRIO_NO_TET;
}

/* Takes one step from *tet. Returns whether the walk has ended there. */
static inline bool step(const brio_tetrahedra *t, brio_filter *f, brio_walk *w, const double *p, uint32_t *tet,
                        unsigned *ahead) {
    assert(brio_has_tet(t, *tet));
    const uint32_t *v = t->tet[*tet].vertex;
    if (v[3] == t->infinite) return true;
    unsigned above, beyond = facets_beyond(t, f, v, p, *ahead, &above);
    if (!beyond) {
        w->unsure = 15u & ~above;
        return true;
    }
    uint32_t mate = t->tet[*tet].mate[draw_facet(w, beyond)];
    *tet = brio_tet_of(mate);
    *ahead = 15u ^ 1u << brio_slot_of(mate);
    __builtin_prefetch(&t->tet[*tet]);
    w->steps++;
    return false;
}

static inline void fetch_vertices(const brio_tetrahedra *t, uint32_t tet) {
    for (int i = 0; i < 3; i++) __builtin_prefetch(t->record[t->tet[tet].vertex[i]]);
    if (t->tet[tet].vertex[3] != t->infinite) __builtin_prefetch(t->record[t->tet[tet].vertex[3]]);
}

static void walk_abreast(const brio_tetrahedra *t, brio_filter *f, brio_walk walks[BRIO_ABREAST],
                         const double (*points)[4], unsigned which, uint32_t *found) {
    unsigned ahead[BRIO_ABREAST];
    for (unsigned left = which; left; left &= left - 1) {
        int i = __builtin_ctz(left);
        found[i] = brio_walk_begin(t, &walks[i]);
        ahead[i] = 15;
    }
    while (which) {
        for (unsigned left = which; left; left &= left - 1) fetch_vertices(t, found[__builtin_ctz(left)]);
        for (unsigned left = which; left; left &= left - 1) {
            int i = __builtin_ctz(left);
            which ^= (unsigned)step(t, f, &walks[i], points[i], &found[i], &ahead[i]) << i;
        }
    }
}
