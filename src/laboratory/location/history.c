/* The history DAG and its two searches.
 *
 * One path: an insertion creates the union of what it destroys. So a point in the closure of a destroyed tetrahedron
 * is in the closure of a tetrahedron created by the same insertion. A point strictly outside the facet of a destroyed
 * infinite tetrahedron is in the closure of a finite tetrahedron created then, or strictly outside the facet of a
 * created infinite one. For along a ray from the new vertex through the old hull, the height over the plane of a facet
 * that the new vertex sees only falls.
 * Conflicts: the search goes depth first from a tetrahedron in conflict with the point to those that took its place,
 * which it tests one after the other. It ends at the first one in conflict that is live, as the program hull does, or
 * goes on until it has all of them. It comes to the tetrahedra that held the point, unless the point is hidden; so it
 * ends. A hull facet in whose plane the point lies does not count as in conflict. A tetrahedron with a vertex at the
 * point's position does, so that duplicates are found.
 *
 * Based on: Guibas, Knuth, Sharir. Randomized incremental construction of Delaunay and Voronoi diagrams. Algorithmica
 * 1992, for the path. Clarkson, Mehlhorn, Seidel. Four results on randomized incremental constructions. CGTA 1993.
 * Differs from the paper: a created tetrahedron is linked to all tetrahedra destroyed with it, as in Choi 2003, not to
 * the two at its facet. So a conflict that descends only from the tetrahedron outside the cavity is not met. */
#include "laboratory/location/history.h"
#include "base/memory.h"
#include <assert.h>

void brio_history_free(brio_context *ctx, brio_history *h) {
    brio_release(ctx, h->node);
    brio_release(ctx, h->first);
    brio_release(ctx, h->node_of);
    brio_release(ctx, h->seen);
    brio_release(ctx, h->open);
    brio_release(ctx, h->conflict);
}

static inline bool is_live(const brio_history_node *node) {
    return node->next & BRIO_HISTORY_LIVE;
}
static inline uint32_t live_slot(const brio_history_node *node) {
    assert(node->next & BRIO_HISTORY_LIVE);
    return node->next & ~BRIO_HISTORY_LIVE;
}

/* Reserves room for `count` more nodes. Grows by an eighth, because doubling the largest array would waste too much
 * memory. */
static brio_status reserve_nodes(brio_inserter *ins, brio_history *h, size_t count) {
    const brio_store *s = ins->store;
    brio_status status = BRIO_OK;
    size_t need = h->num_nodes + count, capacity = need + need / 8 + 1024;
    BRIO_REQUIRE(s->ctx, need < UINT32_MAX, BRIO_ERR_TOO_LARGE, "more than 2^32 - 2 nodes of the history DAG");
    if (need > h->node_capacity) {
        BRIO_TRY(BRIO_RESIZE(s->ctx, h->node, capacity));
        h->node_capacity = capacity;
    }
    if (s->capacity > h->slot_capacity) {
        BRIO_TRY(BRIO_RESIZE(s->ctx, h->node_of, s->capacity));
        h->slot_capacity = s->capacity;
    }
    status = BRIO_RESERVE(s->ctx, h->first, h->first_capacity, h->num_insertions + 2);
done:
    return status;
}

static void touch_node(const brio_inserter *ins, size_t node) {
    const brio_touch_view *view = brio_touches_of(ins);
    if (view) brio_touch(view->counts, BRIO_TOUCH_HISTORY, node * sizeof(brio_history_node));
}

/* Counts a node and the records of its vertices. */
static void touch_search(const brio_inserter *ins, const brio_history *h, size_t node) {
    const brio_touch_view *view = brio_touches_of(ins);
    if (!view) return;
    touch_node(ins, node);
    for (int i = 0; i < 4; i++)
        if (h->node[node].vertex[i] != ins->store->t.infinite) brio_touch_record(view, h->node[node].vertex[i]);
}

/* Adds nodes for `count` new tetrahedra in the given slots (NULL: slots 0, 1, ...). */
static brio_status add_nodes(brio_inserter *ins, brio_history *h, const uint32_t *slots, size_t count) {
    brio_status status = reserve_nodes(ins, h, count);
    if (status != BRIO_OK) return status;
    for (size_t i = 0; i < count; i++) {
        uint32_t slot = slots ? slots[i] : (uint32_t)i;
        const uint32_t *v = ins->store->t.tet[slot].vertex;
        assert(slot < h->slot_capacity && h->num_nodes < h->node_capacity);
        assert(!(slot & BRIO_HISTORY_LIVE)); /* bit 31 says that the node is live; bits 0 to 30 are its slot */
        touch_node(ins, h->num_nodes);
        h->node_of[slot] = (uint32_t)h->num_nodes;
        h->node[h->num_nodes++] = (brio_history_node){{v[0], v[1], v[2], v[3]}, BRIO_HISTORY_LIVE | slot};
    }
    assert(h->num_insertions + 1 < h->first_capacity);
    h->first[++h->num_insertions] = (uint32_t)h->num_nodes;
    h->stats->history = h->num_nodes;
    return BRIO_OK;
}

/* Counts nodes that a search compared with a point. */
static void count_tests(brio_inserter *ins, const brio_history *h, uint64_t nodes) {
    h->stats->history_tests += nodes;
    ins->searched += nodes;
}

brio_status brio_history_new(brio_inserter *ins, brio_history *out) {
    brio_trial *trial = brio_trial_of(ins);
    *out = (brio_history){.stats = &trial->stats,
                          .search = trial->options->all_conflicts    ? BRIO_SEARCH_ALL_CONFLICTS
                                    : trial->options->first_conflict ? BRIO_SEARCH_FIRST_CONFLICT
                                                                     : BRIO_SEARCH_PATH};
    brio_status status = add_nodes(ins, out, NULL, ins->store->t.count);
    if (status == BRIO_OK) out->first[0] = 0;
    return status;
}

brio_status brio_history_add(brio_inserter *ins, brio_history *h) {
    const brio_cavity *c = &ins->cavity;
    assert(h->num_insertions < BRIO_HISTORY_LIVE);
    for (size_t i = 0; i < c->num_tets; i++) {
        uint32_t node = h->node_of[brio_tet_of(c->entry[i])];
        assert(h->node[node].next == (BRIO_HISTORY_LIVE | brio_tet_of(c->entry[i])));
        touch_node(ins, node);
        h->node[node].next = (uint32_t)h->num_insertions;
    }
    return add_nodes(ins, h, c->created, c->num_created);
}

/* --- one path --- */

/* Returns whether p is in the closure of a finite tetrahedron, or strictly outside the facet of an infinite one. Tests
 * the facet opposite to the latest vertex last, because it seldom decides. */
static bool holds(brio_inserter *ins, const uint32_t v[4], const double *p) {
    const brio_store *s = ins->store;
    const brio_record *r = s->t.record;
    if (v[3] == s->t.infinite) return brio_orient3d_sign(&ins->filter, r[v[0]], r[v[1]], r[v[2]], p) > 0;
    for (int i = 3; i >= 0; i--) {
        const uint8_t *facet = BRIO_FACET[i];
        if (brio_orient3d_sign(&ins->filter, r[v[facet[0]]], r[v[facet[1]]], r[v[facet[2]]], p) < 0) return false;
    }
    return true;
}

static inline uint32_t next_of(const brio_history *h, uint32_t from) {
    assert(from == BRIO_HISTORY_ROOT || from < h->num_nodes);
    return from == BRIO_HISTORY_ROOT ? 0 : h->node[from].next;
}

uint32_t brio_history_path(brio_inserter *ins, brio_history *h, uint32_t from, const double *p) {
    uint32_t next = next_of(h, from);
    while (!(next & BRIO_HISTORY_LIVE)) {
        assert(next < h->num_insertions);
        uint32_t node = h->first[next];
        touch_search(ins, h, node);
        while (!holds(ins, h->node[node].vertex, p)) touch_search(ins, h, ++node);
        assert(node < h->first[next + 1]); /* one tetrahedron of the insertion holds p */
        count_tests(ins, h, node - h->first[next] + 1);
        next = h->node[node].next;
    }
    return next & ~BRIO_HISTORY_LIVE;
}

/* --- conflicts --- */

static bool conflicts(brio_inserter *ins, const brio_history_node *node, const double *p) {
    const brio_store *s = ins->store;
    const brio_record *r = s->t.record;
    const uint32_t *v = node->vertex;
    if (v[3] == s->t.infinite) return brio_orient3d_sign(&ins->filter, r[v[0]], r[v[1]], r[v[2]], p) > 0;
    for (int i = 0; i < 4; i++)
        if (brio_same_position(r[v[i]], p)) return true;
    return brio_conflict(&ins->filter, r[v[0]], r[v[1]], r[v[2]], r[v[3]], p, s->weighted);
}

/* Opens the nodes of an insertion to the search, at most once. */
static brio_status come_to(brio_context *ctx, brio_history *h, uint32_t insertion, size_t *depth) {
    assert(insertion < h->num_insertions);
    if (h->seen[insertion] == h->searches) return BRIO_OK;
    brio_status status = BRIO_RESERVE(ctx, h->open, h->open_capacity, *depth + 1);
    if (status != BRIO_OK) return status;
    h->seen[insertion] = h->searches;
    h->open[(*depth)++] = (brio_history_span){h->first[insertion], h->first[insertion + 1]};
    return BRIO_OK;
}

static brio_status list_conflict(brio_context *ctx, brio_history *h, uint32_t tet) {
    brio_status status = BRIO_RESERVE(ctx, h->conflict, h->conflict_capacity, h->num_conflicts + 1);
    if (status == BRIO_OK) h->conflict[h->num_conflicts++] = tet;
    return status;
}

/* Begins a search: it has seen no insertion yet. */
static brio_status begin_search(brio_context *ctx, brio_history *h) {
    size_t old = h->seen_capacity;
    brio_status status = BRIO_RESERVE(ctx, h->seen, h->seen_capacity, h->num_insertions);
    if (status != BRIO_OK) return status;
    for (size_t i = old; i < h->seen_capacity; i++) h->seen[i] = 0;
    h->searches++;
    h->num_conflicts = 0;
    return BRIO_OK;
}

brio_status brio_history_conflicts(brio_inserter *ins, brio_history *h, uint32_t from, const double *p, size_t most) {
    const brio_store *s = ins->store;
    size_t depth = 0;
    uint32_t next = next_of(h, from);
    BRIO_FORWARD(begin_search(s->ctx, h));
    if (next & BRIO_HISTORY_LIVE) return list_conflict(s->ctx, h, next & ~BRIO_HISTORY_LIVE);
    BRIO_FORWARD(come_to(s->ctx, h, next, &depth));
    while (depth > 0 && h->num_conflicts < most) {
        brio_history_span *here = &h->open[depth - 1];
        if (here->node == here->end) {
            depth--;
            continue;
        }
        touch_search(ins, h, here->node);
        const brio_history_node *node = &h->node[here->node++];
        count_tests(ins, h, 1);
        if (!conflicts(ins, node, p)) continue;
        h->stats->history_conflicts++;
        if (is_live(node))
            BRIO_FORWARD(list_conflict(s->ctx, h, live_slot(node)));
        else
            BRIO_FORWARD(come_to(s->ctx, h, node->next, &depth));
    }
    return BRIO_OK;
}

brio_status brio_history_locate(brio_inserter *ins, brio_history *h, uint32_t from, const double *p, uint32_t *tet) {
    if (h->search != BRIO_SEARCH_PATH) {
        size_t most = h->search == BRIO_SEARCH_FIRST_CONFLICT ? 1 : SIZE_MAX;
        brio_status status = brio_history_conflicts(ins, h, from, p, most);
        if (status != BRIO_OK) return status;
        if (h->num_conflicts > 0) {
            *tet = h->conflict[0];
            return BRIO_OK;
        }
    }
    *tet = brio_history_path(ins, h, from, p);
    return BRIO_OK;
}

/* --- the strategy: point location in the history alone, as in the program hull --- */

static brio_status start_history(brio_inserter *ins) {
    brio_history *h = NULL;
    brio_status status = BRIO_ALLOC_ZERO(ins->store->ctx, h, 1);
    if (status != BRIO_OK) return status;
    ins->location = h;
    return brio_history_new(ins, h);
}

static brio_status locate(brio_inserter *ins, uint32_t p, uint32_t *tet) {
    return brio_history_locate(ins, ins->location, BRIO_HISTORY_ROOT, ins->store->record[p], tet);
}

static brio_status filled(brio_inserter *ins, uint32_t p) {
    BRIO_FORWARD(brio_count_insertion(ins, p));
    return brio_history_add(ins, ins->location);
}

static void free_history(brio_inserter *ins) {
    const brio_store *s = ins->store;
    if (ins->location) brio_history_free(s->ctx, ins->location);
    brio_release(s->ctx, ins->location);
    ins->location = NULL;
}

const brio_strategy brio_strategy_history = {start_history, locate, filled, free_history};
