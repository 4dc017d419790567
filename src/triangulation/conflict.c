/* Conflict tests one by one, and the choice of the instruction set at run time. */
#include "triangulation/conflict.h"

bool brio_in_conflict_exact(const brio_tetrahedra *t, brio_filter *f, uint32_t tet, const double *p, bool weighted) {
    const uint32_t *v = t->tet[tet].vertex;
    if (v[3] == t->infinite) {
        int side = brio_orient3d_exact(t->record[v[0]], t->record[v[1]], t->record[v[2]], p);
        if (side) return side > 0;
        return brio_in_conflict(t, f, brio_tet_of(t->tet[tet].mate[3]), p, weighted);
    }
    const double *a = t->record[v[0]], *b = t->record[v[1]], *c = t->record[v[2]], *d = t->record[v[3]];
    int sign = brio_insphere_exact(a, b, c, d, p, weighted);
    return (sign ? sign : brio_insphere_tie(f, a, b, c, d, p)) > 0;
}

static unsigned conflicts(const brio_tetrahedra *t, brio_filter *f, const uint32_t facets[BRIO_BATCH], size_t count,
                          const double *p) {
    unsigned mask = 0;
    for (size_t i = 0; i < count; i++)
        mask |= (unsigned)brio_in_conflict(t, f, brio_tet_of(facets[i]), p, false) << i;
    return mask;
}

static unsigned conflicts_weighted(const brio_tetrahedra *t, brio_filter *f, const uint32_t facets[BRIO_BATCH],
                                   size_t count, const double *p) {
    unsigned mask = 0;
    for (size_t i = 0; i < count; i++)
        mask |= (unsigned)brio_in_conflict(t, f, brio_tet_of(facets[i]), p, true) << i;
    return mask;
}

brio_conflicts_fn brio_conflicts_choose(bool weighted) {
    brio_conflicts_fn chosen = NULL;
#if defined(__x86_64__)
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq"))
        chosen = brio_conflicts_avx512(weighted);
    if (!chosen && __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma"))
        chosen = brio_conflicts_avx2(weighted);
#endif
    if (chosen) return chosen;
    return weighted ? conflicts_weighted : conflicts;
}
