/* One point moves, or gets another weight.
 *
 * If its star stays valid with the new record, only the record changes. Valid means: all finite tetrahedra of the
 * star are positive; across each facet of the star, inner and outer ones, the vertex on the other side is not in
 * conflict; and the hull stays strictly convex at each edge of the star's infinite tetrahedra. Then the tetrahedra
 * still cover the hull once, and are locally regular everywhere: they are the triangulation. A tie on the hull goes
 * the long way, so that this needs no argument about folded facets. Else the point is taken out and put in again.
 *
 * Based on: de Castro, Tournois, Alliez, Devillers. Filtering relocations on a Delaunay triangulation. CGF 2009. */
#include "dynamic/live.h"
#include <string.h>

/* Returns whether all finite tetrahedra of the hole are positive. */
static bool all_positive(brio_dynamic *d) {
    const brio_hole *h = &d->hole;
    for (size_t i = 0; i < h->num_tets; i++) {
        const uint32_t *v = d->t.tet[h->tet[i]].vertex;
        const brio_record *r = (const brio_record *)d->record;
        if (v[3] == 0) continue;
        if (brio_orient3d_sign(&d->filter, r[v[0]], r[v[1]], r[v[2]], r[v[3]]) <= 0) return false;
    }
    return true;
}

/* Returns whether the tetrahedron `tet` stands the vertex on the other side of a facet of it, `mate` being that
 * facet's handle on the other side. */
static bool stands(brio_dynamic *d, uint32_t tet, uint32_t mate) {
    const uint32_t *v = d->t.tet[tet].vertex;
    uint32_t other = brio_tet_of(mate), apex = brio_apex(&d->t, mate);
    const brio_record *r = (const brio_record *)d->record;
    if (v[3] == 0) {
        if (!brio_is_infinite(&d->t, other)) return true; /* the hull facet between them is that of a positive one */
        return brio_orient3d_sign(&d->filter, r[v[0]], r[v[1]], r[v[2]], r[apex]) < 0;
    }
    if (apex == 0) return true;
    return !brio_conflict(&d->filter, r[v[0]], r[v[1]], r[v[2]], r[v[3]], r[apex], d->weighted);
}

/* Returns whether the star of a vertex, which is the hole, is valid with the record that the vertex has. */
static bool is_valid(brio_dynamic *d) {
    const brio_hole *h = &d->hole;
    if (!all_positive(d)) return false;
    for (size_t i = 0; i < h->num_tets; i++) {
        uint32_t tet = h->tet[i];
        for (int k = 0; k < 4; k++) {
            uint32_t mate = d->t.tet[tet].mate[k], other = brio_tet_of(mate);
            if (brio_in_hole(d, other) && other < tet) continue; /* the facet was seen from there */
            if (!stands(d, tet, mate)) return false;
        }
    }
    return true;
}

/* Writes the record of a vertex in place; false, and nothing is changed, where its star would not be valid. */
static brio_status in_place(brio_dynamic *d, uint32_t row, const double *record, bool *done) {
    double before[4];
    *done = false;
    if (brio_row_kind(d, row) != ROW_VERTEX || d->row[row].twins != BRIO_NONE) return BRIO_OK;
    BRIO_FORWARD(brio_live_star(d, row));
    if (!d->attempt && !brio_hole_has_hidden(d)) {
        memcpy(before, d->record[row], sizeof before);
        memcpy(d->record[row], record, sizeof before);
        *done = is_valid(d);
        if (*done)
            brio_slack_end(d);
        else
            memcpy(d->record[row], before, sizeof before);
    }
    brio_hole_forget(d);
    return BRIO_OK;
}

brio_status brio_live_move(brio_dynamic *d, uint32_t name, const double *record) {
    uint32_t row = d->row_of[name];
    bool done;
    if (brio_row_kind(d, row) == ROW_LOOSE) return brio_live_place(d, row); /* a hand has taken it out */
    if (memcmp(d->record[row], record, sizeof(brio_record)) == 0) {
        d->in_place++;
        return BRIO_OK;
    }
    BRIO_FORWARD(brio_journal_reserve(d, 0, 1));
    brio_live_admit(d, record);
    brio_note_row(d, row);
    BRIO_FORWARD(in_place(d, row, record, &done));
    d->in_place += done;
    if (done || d->attempt) return BRIO_OK;
    BRIO_FORWARD(brio_live_take(d, &row));
    if (d->attempt) return BRIO_OK;
    BRIO_FORWARD(brio_journal_reserve(d, 0, 1));
    brio_note_row(d, row);
    memcpy(d->record[row], record, sizeof(brio_record));
    d->replaced++;
    return brio_live_place(d, row);
}
