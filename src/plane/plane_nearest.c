/* The vertex of least power distance, by descent along edges: in a regular triangulation a vertex without a nearer
 * neighbour is the nearest of all. The descent goes to the first nearer neighbour that it meets around a vertex. */
#include "plane/plane_nearest.h"
#include <assert.h>

static bool is_nearer(const brio_plane_nearest *n, const double *x, uint32_t u, uint32_t v) {
    const brio_plane_record *r = n->view->record;
    if (u >= n->num_points) return false;
    if (v >= n->num_points) return true;
    return brio_plane_is_nearer(n->filter, x, r[u], r[v]);
}

/* Returns a neighbour of v that is nearer to x, or v. */
static uint32_t nearer_neighbour(const brio_plane_nearest *n, uint32_t v, const double *x) {
    assert(v < n->num_points);
    uint32_t first = n->corner[v], t = first;
    do {
        const brio_triangle *own = &n->view->triangle[t];
        assert(own->vertex[0] == v || own->vertex[1] == v || own->vertex[2] == v);
        uint32_t i = own->vertex[0] == v ? 0 : own->vertex[1] == v ? 1 : 2;
        uint32_t u = own->vertex[brio_slot_after(i)];
        if (is_nearer(n, x, u, v)) return u;
        t = brio_triangle_of(own->mate[brio_slot_after(i)]);
    } while (t != first);
    return v;
}

uint32_t brio_plane_nearest_vertex(const brio_plane_nearest *n, uint32_t t, const double *x) {
    const uint32_t *v = n->view->triangle[t].vertex;
    uint32_t best = v[0];
    for (int i = 1; i < 3; i++)
        if (is_nearer(n, x, v[i], best)) best = v[i];
    for (uint32_t next; (next = nearer_neighbour(n, best, x)) != best;) best = next;
    return best;
}
