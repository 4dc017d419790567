/* The journal of a transaction: what slots and rows were before it, to be written back when it fails.
 *
 * Homes of vertices change with every tetrahedron and are not noted. When slots are written back, each of their
 * vertices gets one of them as its home: a vertex whose home has changed lost a tetrahedron that it had before. The
 * lists of free slots and rows are made again from what slots and rows are. */
#include "base/memory.h"
#include "dynamic/live.h"

brio_status brio_journal_reserve(brio_dynamic *d, size_t slots, size_t rows) {
    brio_journal *j = &d->journal;
    BRIO_FORWARD(BRIO_RESERVE(d->ctx, j->slot, j->slot_capacity, j->num_slots + slots));
    return BRIO_RESERVE(d->ctx, j->row, j->row_capacity, j->num_rows + rows);
}

void brio_live_begin(brio_dynamic *d) {
    brio_journal *j = &d->journal;
    assert(!d->in_transaction && d->num_loose == 0 && d->hole.num_tets == 0);
    d->in_transaction = true;
    d->needs_anew = false;
    j->num_slots = j->num_rows = 0;
    j->slots_before = d->t.count;
    j->rows_before = d->num_rows;
    j->names_before = d->num_names;
    j->counts = d->counts;
}

static void restore_rows(brio_dynamic *d) {
    const brio_journal *j = &d->journal;
    for (size_t i = 0; i < j->num_rows; i++) {
        const brio_old_row *old = &j->row[i];
        for (int c = 0; c < 4; c++) d->record[old->at][c] = old->record[c];
        d->row[old->at] = old->row;
        d->home[old->at] = old->home;
        d->kind[old->at] = old->kind;
        if (old->kind != ROW_FREE) d->row_of[old->row.name] = old->at;
    }
    d->num_rows = j->rows_before;
    d->num_names = j->names_before;
    d->num_free_rows = 0;
    for (size_t r = 1; r < d->num_rows; r++)
        if (d->kind[r] == ROW_FREE) d->free_row[d->num_free_rows++] = (uint32_t)r;
}

static void restore_slots(brio_dynamic *d) {
    const brio_journal *j = &d->journal;
    d->t.count = j->slots_before;
    for (size_t i = 0; i < j->num_slots; i++) {
        const brio_old_slot *old = &j->slot[i];
        d->t.tet[old->slot] = old->tet;
        d->hidden[old->slot] = old->hidden;
        d->state[old->slot] = old->state;
        if (old->state != SLOT_PLAIN) continue;
        for (int v = 0; v < 4; v++) d->home[old->tet.vertex[v]] = old->slot;
    }
    d->num_unused = 0;
    for (size_t s = 0; s < d->t.count; s++) {
        if (d->state[s] == SLOT_UNUSED)
            d->unused[d->num_unused++] = (uint32_t)s;
        else
            d->walk.start = (uint32_t)s;
    }
}

brio_status brio_live_end(brio_dynamic *d, brio_status status) {
    const brio_journal *j = &d->journal;
    assert(d->in_transaction);
    d->in_transaction = false;
    if (status == BRIO_OK) {
        assert(d->num_loose == 0 && d->hole.num_tets == 0);
        for (size_t i = 0; i < j->num_slots; i++) d->state[j->slot[i].slot] &= (uint8_t)~SLOT_NOTED;
        for (size_t i = 0; i < j->num_rows; i++) d->kind[j->row[i].at] &= (uint8_t)~ROW_NOTED;
        return BRIO_OK;
    }
    brio_hole_forget(d);
    d->num_loose = 0;
    d->counts = j->counts;
    restore_rows(d);
    restore_slots(d);
    return status;
}
