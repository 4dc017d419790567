/* The versions of the inner loops by instruction set, and the last stages of a test, which they share. */
#include "triangulation/engine.h"
#include "base/instruction_set.h"
#include <assert.h>

bool brio_in_conflict_late(const brio_tetrahedra *t, brio_filter *f, uint32_t tet, const double *p, bool weighted) {
    const uint32_t *v = t->tet[tet].vertex;
    if (v[3] == t->infinite) {
        int side = brio_orient3d_late(f, t->record[v[0]], t->record[v[1]], t->record[v[2]], p);
        if (side) return side > 0;
        return brio_in_conflict(t, f, brio_tet_of(t->tet[tet].mate[3]), p, weighted);
    }
    assert(v[0] != t->infinite && v[1] != t->infinite && v[2] != t->infinite); /* I2 */
    const double *const row[5] = {t->record[v[0]], t->record[v[1]], t->record[v[2]], t->record[v[3]], p};
    int sign = brio_insphere_late(f, row);
    return (sign ? sign : brio_insphere_tie(f, row[0], row[1], row[2], row[3], p)) > 0;
}

const brio_engine *brio_engine_choose(bool weighted) {
    static const brio_engine *const OF_SET[] = {
        brio_engine_plain,
#if defined(__x86_64__)
        brio_engine_avx2,
        brio_engine_avx512,
#endif
    };
    assert((size_t)brio_instructions() < sizeof OF_SET / sizeof *OF_SET);
    return &OF_SET[brio_instructions()][weighted];
}
