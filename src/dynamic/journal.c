/* The journal of a transaction: what slots and rows were before it, to be written back when it fails.
 *
 * The tetrahedra behind the border of a hole get other mates, and are not copied. Let T and W share a facet before the
 * transaction, and let T be copied while it still has W as its mate there: that holds for the one of them that is
 * copied first, since only the change of one gives the other another mate. So copies are written back from the last
 * to the first, and each makes itself the mate of its mates. What W's copy, a later one, says of the facet is
 * overwritten then. Slots that were reused meanwhile were copied before that, and are written after it. Stamps tell
 * what is later where several threads copy: each hole has a later one than the holes that it meets, and what one thread
 * copies after a pass, in a hole or not, has a later one than all that the pass copied.
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
    j->stamp = *j->time = 0;
}

void brio_journal_stamp(brio_dynamic *d) {
    d->journal.stamp = __atomic_add_fetch(d->journal.time, 1, __ATOMIC_RELAXED);
}

void brio_journal_give(brio_dynamic *d, brio_journal *hand, brio_journal *node) {
    *node = *hand;
    node->more = d->journal.more;
    d->journal.more = node;
    hand->slot = NULL, hand->row = NULL;
    hand->num_slots = hand->num_rows = hand->slot_capacity = hand->row_capacity = 0;
    brio_journal_stamp(d);
}

static void restore_rows(brio_dynamic *d) {
    for (const brio_journal *j = &d->journal; j; j = j->more)
        for (size_t i = 0; i < j->num_rows; i++) {
            const brio_old_row *old = &j->row[i];
            for (int c = 0; c < 4; c++) d->record[old->at][c] = old->record[c];
            d->row[old->at] = old->row;
            d->home[old->at] = old->home;
            d->kind[old->at] = old->kind;
            if (old->kind != ROW_FREE) d->row_of[old->row.name] = old->at;
        }
    d->num_rows = d->journal.rows_before;
    d->num_names = d->journal.names_before;
    d->num_free_rows = 0;
    for (size_t r = 1; r < d->num_rows; r++)
        if (d->kind[r] == ROW_FREE) d->free_row[d->num_free_rows++] = (uint32_t)r;
}

/* Writes a copy of a slot back. */
static void restore_slot(brio_dynamic *d, const brio_old_slot *old) {
    brio_set_first_hidden(d, old->slot, old->hidden);
    d->state[old->slot] = old->state;
    if (old->state != SLOT_PLAIN) return;
    d->t.tet[old->slot] = old->tet;
    for (int k = 0; k < 4; k++) {
        d->home[old->tet.vertex[k]] = old->slot;
        *brio_mate(&d->t, old->tet.mate[k]) = brio_facet_of(old->slot, k);
    }
}

/* Returns the journal whose last copy that is not written back yet has the latest stamp; NULL where none is left. */
static brio_journal *latest(brio_dynamic *d) {
    brio_journal *last = NULL;
    for (brio_journal *j = &d->journal; j; j = j->more)
        if (j->num_slots && (!last || j->slot[j->num_slots - 1].stamp > last->slot[last->num_slots - 1].stamp))
            last = j;
    return last;
}

static void restore_slots(brio_dynamic *d) {
    for (brio_journal *j; (j = latest(d)) != NULL;) {
        uint32_t stamp = j->slot[j->num_slots - 1].stamp;
        while (j->num_slots && j->slot[j->num_slots - 1].stamp == stamp) restore_slot(d, &j->slot[--j->num_slots]);
    }
    d->t.count = d->journal.slots_before;
    d->num_unused = 0;
    for (size_t s = 0; s < d->t.count; s++) {
        if (d->state[s] == SLOT_UNUSED)
            d->unused[d->num_unused++] = (uint32_t)s;
        else
            d->walk.start = (uint32_t)s;
    }
}

/* Frees the journals of hands. */
static void forget_more(brio_dynamic *d) {
    for (brio_journal *j = d->journal.more, *more; j; j = more) {
        more = j->more;
        brio_release(d->ctx, j->slot);
        brio_release(d->ctx, j->row);
        brio_release(d->ctx, j);
    }
    d->journal.more = NULL;
}

brio_status brio_live_end(brio_dynamic *d, brio_status status) {
    assert(d->in_transaction);
    d->in_transaction = false;
    if (status != BRIO_ERR_INTERNAL) d->needs_anew = false;
    if (status == BRIO_OK) {
        assert(d->num_loose == 0 && d->hole.num_tets == 0);
        for (const brio_journal *j = &d->journal; j; j = j->more) {
            for (size_t i = 0; i < j->num_slots; i++) d->state[j->slot[i].slot] &= (uint8_t)~SLOT_NOTED;
            for (size_t i = 0; i < j->num_rows; i++) d->kind[j->row[i].at] &= (uint8_t)~ROW_NOTED;
        }
    } else {
        brio_hole_forget(d);
        d->num_loose = 0;
        d->counts = d->journal.counts;
        restore_rows(d);
        restore_slots(d);
    }
    forget_more(d);
    return status;
}
