/* Point location by a visibility walk from the last inserted tetrahedron.
 *
 * The walk steps from a tetrahedron across any facet that has the point strictly on its far side. With exact
 * predicates no tetrahedron of a regular triangulation is visited twice, so the walk ends. A random number chooses the
 * facet to test first, which avoids the long detours of a fixed order.
 *
 * Based on: Devillers, Pion, Teillaud. Walking in a triangulation. IJFCS 2002. */
#include "triangulation/locate_walk.h"
#include <assert.h>

uint32_t brio_locate_walk(const brio_tetrahedra *t, brio_zone *zone, brio_filter *f, brio_walk *walk, const double *p,
                          uint64_t most_steps) {
    uint32_t tet = brio_walk_begin(t, walk);
    int came_through = 4;
    walk->unsure = 15;
    if ((walk->blocked = !brio_owns(t, zone, tet))) return BRIO_NO_TET;
    for (uint64_t steps = 0;; steps++, walk->steps++) {
        if (steps > most_steps) return BRIO_NO_TET;
        assert(brio_has_tet(t, tet) && brio_zone_holds_tet(t, zone, tet)); /* P3 */
        const uint32_t *v = t->tet[tet].vertex;
        if (walk->watch) walk->watch->came_to(walk->watch, t, tet);
        if (v[3] == t->infinite) return tet;
        walk->random = brio_walk_random(walk->random);
        int first = (int)(walk->random >> 30), i = 0;
        for (; i < 4; i++) {
            int slot = (first + i) & 3;
            if (slot == came_through) continue;
            const uint8_t *facet = BRIO_FACET[slot];
            if (brio_orient3d_sign(f, t->record[v[facet[0]]], t->record[v[facet[1]]], t->record[v[facet[2]]], p) < 0) {
                uint32_t mate = t->tet[tet].mate[slot];
                if ((walk->blocked = !brio_owns_beyond(t, zone, mate))) return BRIO_NO_TET;
                tet = brio_tet_of(mate);
                came_through = brio_slot_of(mate);
                break;
            }
        }
        if (i == 4) return tet;
    }
}

void brio_locate_abreast(const brio_tetrahedra *t, brio_filter *f, brio_walk walks[BRIO_ABREAST],
                         const double (*points)[4], unsigned which, uint32_t *found) {
    for (; which; which &= which - 1) {
        int i = __builtin_ctz(which);
        found[i] = brio_locate_walk(t, NULL, f, &walks[i], points[i], UINT64_MAX);
    }
}
