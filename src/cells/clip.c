/* Cells clipped to the region.
 *
 * A cell whose vertices are all near the region is taken as it is and cut by the walls. A cell with vertices far away
 * or at infinity starts from the region instead, and is cut by the planes of its faces: then nothing far away is
 * computed. Both ways cut by the same planes; faces without area were dropped before, exactly. Which vertices a plane
 * cuts off is exact, too (exact_side.h): of a face whose area is lost in rounding, the polyhedron still knows that it
 * has one. */
#include "cells/star_cell.h"
#include "cells/exact_side.h"
#include "base/vector.h"
#include <assert.h>
#include <string.h>

/* Cuts the region by the planes of all faces of the cell. A cell that has neighbours but no face with an area is an
 * edge or a point, as weights can make it: nothing is left. */
static brio_status cut_from_region(const brio_star_cell *c, const brio_region *region, brio_polyhedron *p) {
    const brio_diagram *d = c->d;
    const double *site = d->at + 3 * (size_t)c->site;
    bool neighbours = false, faces = false;
    BRIO_FORWARD(brio_polyhedron_copy(p, &region->shape, site));
    for (size_t i = 0; i < c->num_sides && p->faces.count; i++) {
        const brio_side *s = &c->side[i];
        double plane[4];
        if (s->site >= d->num_points) continue;
        neighbours = true;
        if (s->vertices < 3) continue;
        faces = true;
        for (size_t k = 0; k < 3; k++) plane[k] = d->at[3 * (size_t)s->site + k] - site[k];
        plane[3] = brio_dot(plane, s->foot);
        BRIO_FORWARD(brio_polyhedron_cut(p, plane, (int64_t)s->site));
    }
    if (neighbours && !faces) brio_polyhedron_clear(p);
    return BRIO_OK;
}

/* Finds the vertex of the polyhedron at the centre of a tetrahedron, or adds it, where the centre of the tetrahedron
 * that is met first is. The hash table of the star cell now holds names: its sides are complete. */
static brio_status vertex_of(brio_star_cell *c, brio_polyhedron *p, uint32_t tet, uint32_t *vertex) {
    uint32_t name = brio_same_centre(c->d, tet);
    size_t mask = c->num_slots - 1, at = (name * UINT32_C(0x9E3779B1) >> 7) & mask;
    while (c->slot[at][1] && c->slot[at][0] != name) at = (at + 1) & mask;
    assert(name < c->d->num_finite); /* a Voronoi vertex */
    if (c->slot[at][1]) return *vertex = c->slot[at][1] - 1, BRIO_OK;
    const double *x = c->d->centre[tet], *site = c->d->at + 3 * (size_t)c->site;
    double from[3] = {x[0] - site[0], x[1] - site[1], x[2] - site[2]};
    *vertex = (uint32_t)p->num_vertices;
    c->slot[at][0] = name;
    c->slot[at][1] = *vertex + 1;
    brio_exact_vertex exact = {.orientation = 1}; /* tetrahedra are positive */
    for (int k = 0; k < 3; k++) exact.plane[k] = brio_plane_of_tetrahedron(name, k);
    return brio_polyhedron_add_vertex(p, from, name, &exact);
}

/* Fills the polyhedron with the bounded cell as it is. */
static brio_status take_cell(brio_star_cell *c, brio_polyhedron *p) {
    brio_polyhedron_clear(p);
    memset(c->slot, 0, c->num_slots * sizeof *c->slot);
    for (size_t i = 0; i < c->num_sides; i++) {
        const brio_side *s = &c->side[i];
        size_t count;
        uint32_t vertex;
        if (s->vertices < 3) continue;
        BRIO_FORWARD(brio_star_cell_polygon(c, s, &count));
        BRIO_FORWARD(brio_polyhedron_add_face(p, (int64_t)s->site));
        for (size_t j = 0; j < count; j++) {
            BRIO_FORWARD(vertex_of(c, p, c->polygon[j], &vertex));
            BRIO_FORWARD(brio_polyhedron_add_corner(p, vertex));
        }
    }
    return BRIO_OK;
}

brio_status brio_clip_cell(brio_star_cell *c, const brio_region *region, brio_polyhedron *p) {
    const double *site = c->d->at + 3 * (size_t)c->site;
    const brio_exact_planes planes = {c->d, region, c->site};
    const brio_judge judge = {brio_exact_orientation, brio_exact_side, &planes};
    brio_status status = BRIO_OK;
    p->judge = &judge;
    if (c->place == BRIO_PLACE_FAR) {
        status = cut_from_region(c, region, p);
        goto done;
    }
    BRIO_TRY(take_cell(c, p));
    for (size_t i = 0; i < region->num_planes && p->faces.count; i++) {
        double plane[4];
        memcpy(plane, region->plane[i], sizeof plane);
        plane[3] -= brio_dot(plane, site);
        BRIO_TRY(brio_polyhedron_cut(p, plane, -1 - (int64_t)i));
    }
done:
    p->judge = NULL;
    return status;
}
