/* How a power crust came to be at its samples: the poles that were labeled, and the faces of their power cells. The
 * crust is the faces between inner and outer balls.
 *
 * The Delaunay triangulation of the samples was freed when the poles were found; it is made once more, with the same
 * bits.
 *
 * Samples may share a pole: a ball has one in its middle. Its cell would be told once for each of them. So of a large
 * cell only the faces are told that touch the cell of the sample's other pole.
 *
 * Based on: Choi. Practical Delaunay triangulation algorithms ... 2003, figures 3.4 and 3.7. */
#include "reconstruct/power_crust/crust_explanation.h"
#include "base/memory.h"
#include "reconstruct/explanation/explanation.h"
#include "reconstruct/power_crust/crust_positions.h"
#include "triangulation/ring.h"
#include <math.h>
#include <string.h>

static const double THETA = 0.39269908169872414; /* pi / 8: of the shapes of cells (dual/poles.c) */

/* A cell of more vertices is large, and a face of more corners is left out. Cells have 27 vertices on average. */
enum { MANY = 128 };

typedef struct {
    const brio_labeled_poles *l;
    brio_incidences stars; /* of the poles */
    uint32_t *tets; /* of the power diagram: those that are vertices of the sample at work, from row `first` on */
    size_t count, capacity, first;
    uint32_t beside[2 * MANY]; /* poles whose faces with a large cell are told */
    size_t besides;
} crust_work;

/* Adds a corner of a face: a vertex of the power diagram, where the crust has it. */
static brio_status add_corner(crust_work *w, brio_explaining *x, uint32_t tet) {
    const brio_power_diagram *d = &w->l->diagram;
    size_t i = 0;
    while (i < w->count && w->tets[i] != tet) i++;
    if (i == w->count) {
        double place[3];
        BRIO_FORWARD(BRIO_RESERVE(x->ctx, w->tets, w->capacity, w->count + 1));
        w->tets[w->count++] = tet;
        brio_crust_positions(d, (const uint32_t(*)[4]) & d->power.tet[tet].vertex, 1, place);
        BRIO_FORWARD(brio_explain_vertex(x, place, UINT32_MAX));
    }
    return brio_explain_corner(x, w->first + i);
}

/* Adds the face between the cells of the poles in slots i and j of a tetrahedron; leaves out faces without end, and of
 * too many corners. */
static brio_status add_face(crust_work *w, brio_explaining *x, uint32_t tet, int i, int j) {
    const brio_power_diagram *d = &w->l->diagram;
    const brio_tetrahedra *t = &d->power;
    const uint32_t p = t->tet[tet].vertex[i], q = t->tet[tet].vertex[j];
    size_t corners = 1;
    brio_ring ring = brio_ring_second(t, tet, i, j);
    for (bool more = true; more; more = brio_ring_next(&ring), corners++)
        if (ring.tet >= d->num_finite || corners == MANY) return BRIO_OK;
    ring = brio_ring_second(t, tet, i, j);
    BRIO_FORWARD(add_corner(w, x, tet));
    do { BRIO_FORWARD(add_corner(w, x, ring.tet)); } while (brio_ring_next(&ring));
    return brio_explain_polygon(x, w->l->label[p] != w->l->label[q] ? BRIO_EXPLAINED_TAKEN : BRIO_EXPLAINED_LEFT);
}

static bool is_large(const crust_work *w, uint32_t pole) {
    return w->stars.offsets[pole + 1] - w->stars.offsets[pole] > MANY;
}

/* Adds the faces of a pole's cell, save for those that it shares with the pole `but`. */
static brio_status add_cell(crust_work *w, brio_explaining *x, uint32_t pole, uint32_t but) {
    const brio_tetrahedra *t = &w->l->diagram.power;
    if (is_large(w, pole)) return BRIO_OK;
    for (uint64_t n = w->stars.offsets[pole]; n < w->stars.offsets[pole + 1]; n++) {
        uint32_t tet = w->stars.items[n];
        int slot = brio_slot_of_vertex(t->tet[tet].vertex, pole);
        for (int j = 0; j < 4; j++)
            if (j != slot && t->tet[tet].vertex[j] != but && brio_ring_size(t, tet, slot, j))
                BRIO_FORWARD(add_face(w, x, tet, slot, j));
    }
    return BRIO_OK;
}

/* Adds the faces of a large cell that touch that of the pole `other`, which is not large and has been told. */
static brio_status add_large_cell(crust_work *w, brio_explaining *x, uint32_t pole, uint32_t other) {
    const brio_tetrahedra *t = &w->l->diagram.power;
    w->besides = 0;
    for (uint64_t n = w->stars.offsets[other]; n < w->stars.offsets[other + 1]; n++) {
        uint32_t tet = w->stars.items[n];
        const uint32_t *v = t->tet[tet].vertex;
        int slot = brio_slot_of_vertex(v, pole);
        for (int j = 0; j < 4 && slot < 4; j++) {
            size_t i = 0;
            if (j == slot || v[j] == other) continue;
            while (i < w->besides && w->beside[i] != v[j]) i++;
            if (i < w->besides) continue;
            w->beside[w->besides++] = v[j];
            BRIO_FORWARD(add_face(w, x, tet, slot, j));
        }
    }
    return BRIO_OK;
}

static brio_status add_poles(void *user, brio_explaining *x, uint32_t s, double pole[8], int8_t side[2]) {
    crust_work *w = user;
    const brio_poles *poles = &w->l->poles;
    uint32_t cell[2] = {BRIO_NO_POLE, BRIO_NO_POLE};
    w->count = 0;
    w->first = x->vertices;
    for (size_t i = 0; i < 2; i++) {
        uint32_t p = poles->of_sample[2 * (size_t)s + i];
        double *row = pole + 4 * i;
        for (int k = 0; k < 4; k++) row[k] = NAN;
        side[i] = 0;
        if (p == BRIO_NO_POLE) continue;
        memcpy(row, poles->centre + 3 * (size_t)p, 3 * sizeof *row);
        row[3] = sqrt(poles->square[p]);
        side[i] = w->l->label[p] == BRIO_LABEL_OUTER ? 1 : -1;
        const uint32_t told = cell[0] == BRIO_NO_POLE || is_large(w, cell[0]) ? BRIO_NO_POLE : cell[0];
        cell[i] = w->l->diagram.representative[p];
        if (!i || cell[0] != cell[1]) BRIO_FORWARD(add_cell(w, x, cell[i], told));
    }
    for (int i = 0; i < 2; i++)
        if (cell[0] != BRIO_NO_POLE && cell[1] != BRIO_NO_POLE && is_large(w, cell[i]) && !is_large(w, cell[1 - i]))
            BRIO_FORWARD(add_large_cell(w, x, cell[i], cell[1 - i]));
    return BRIO_OK;
}

brio_status brio_explain_crust(brio_labeled_poles *l, const brio_surface_options *options) {
    brio_status status = BRIO_OK;
    brio_triangulation *delaunay = NULL;
    crust_work w = {.l = l};
    brio_explained s = {.options = options,
                        .points = l->points,
                        .num_points = l->num_samples + BRIO_BOUNDING_POINTS,
                        .num_samples = l->num_samples,
                        .order = l->order,
                        .exponent = l->exponent,
                        .theta = THETA,
                        .more = add_poles,
                        .user = &w};
    if (!options->explanation) return BRIO_OK;
    BRIO_TRY(brio_triangulation_incident_tetrahedra(l->ctx, l->power, &w.stars));
    BRIO_TRY(brio_delaunay(l->ctx, l->points, NULL, s.num_points, &l->triangulation, &delaunay));
    s.delaunay = delaunay;
    BRIO_TRY(brio_explain(l->ctx, &s));
done:
    brio_incidences_free(&w.stars);
    brio_release(l->ctx, w.tets);
    brio_triangulation_free(delaunay);
    return status;
}
