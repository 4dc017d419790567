/* Gives each point that owns no cell the vertex that represents it.
 *
 * Without weights such a point is a duplicate, and insertion has named its vertex. With weights the point that hid it
 * may have been hidden later, and a vertex at its position may have come after it. So each such point is located in
 * the finished triangulation. A point at the position of a vertex is a duplicate. Any other point is hidden, and
 * descent along edges finds its vertex of least power distance: in a regular triangulation a vertex without a nearer
 * neighbour is the nearest of all. Apexes of flat inputs are skipped: the edges of the flat triangulation suffice.
 *
 * Where hidden points are to be left without a representative, nothing is located: a table of positions tells
 * duplicates from hidden points. */
#include "triangulation/represent.h"
#include "base/memory.h"
#include "base/rng.h"
#include "base/sort.h"
#include "base/team.h"
#include "triangulation/nearest_vertex.h"
#include "triangulation/vertex_tets.h"
#include <assert.h>
#include <string.h>

enum { SLOTS_A_THREAD = 1 << 13 };

typedef struct {
    brio_inserter *ins;
    uint32_t *vertex_tet; /* a tetrahedron of each vertex */
    brio_nearest nearest;
    uint32_t *hidden;
    size_t num_hidden;
} workspace;

static brio_status represent_one(workspace *w, uint32_t p) {
    brio_inserter *ins = w->ins;
    const brio_store *s = ins->store;
    const double *x = s->record[p];
    assert(s->state[w->vertex_tet[brio_alive(s, p)]] == TET_PLAIN);
    ins->walk.start = w->vertex_tet[brio_alive(s, p)];
    uint32_t tet = brio_inserter_walk(ins, x, UINT64_MAX);
    assert(tet != BRIO_NO_TET);
    const uint32_t *v = s->t.tet[tet].vertex;
    for (int i = 0; i < 4; i++)
        if (v[i] != s->t.infinite && brio_same_position(s->record[v[i]], x)) {
            s->representative[p] = v[i];
            ins->stats.duplicates++;
            return BRIO_OK;
        }
    assert(s->weighted); /* without weights every point is a vertex or at one */
    w->hidden[w->num_hidden++] = p;
    return brio_nearest_vertex(&w->nearest, tet, x, &s->representative[p]);
}

/* Orders by position, then by descending weight, then by index. */
static int compare_hidden(uint32_t p, uint32_t q, const void *user) {
    const brio_store *s = user;
    int sign = brio_lexicographic(s->record[p], s->record[q]);
    if (sign) return sign;
    if (s->record[p][3] != s->record[q][3]) return s->record[p][3] > s->record[q][3] ? -1 : 1;
    return s->caller[p] < s->caller[q] ? -1 : 1;
}

static brio_status count_hidden(workspace *w) {
    const brio_store *s = w->ins->store;
    brio_delaunay_stats *stats = &w->ins->stats;
    brio_status status =
        brio_sort_rows(s->ctx, &(brio_row_order){*s->record, 4, compare_hidden, s}, w->hidden, w->num_hidden);
    if (status != BRIO_OK) return status;
    for (size_t n = 0; n < w->num_hidden; n++) {
        bool again = n > 0 && brio_same_position(s->record[w->hidden[n - 1]], s->record[w->hidden[n]]);
        if (again)
            stats->duplicates++;
        else
            stats->hidden++;
    }
    return BRIO_OK;
}

static brio_status represent_weighted(brio_inserter *ins) {
    const brio_store *s = ins->store;
    workspace w = {.ins = ins};
    brio_status status = BRIO_OK;
    size_t not_vertices = 0;
    for (uint32_t p = 0; p < s->num_points; p++) not_vertices += s->representative[p] != p;
    if (!not_vertices) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(s->ctx, w.hidden, not_vertices));
    BRIO_TRY(BRIO_ALLOC(s->ctx, w.vertex_tet, s->num_points + 3));
    brio_vertex_tets_fill(s, w.vertex_tet);
    BRIO_TRY(brio_nearest_new(s->ctx, &s->t, s->num_points, w.vertex_tet, &w.nearest));
    for (uint32_t p = 0; p < s->num_points; p++)
        if (s->representative[p] != p) {
            BRIO_TRY(represent_one(&w, p));
            BRIO_TRY(brio_look(s->ctx, 16));
        }
    BRIO_TRY(count_hidden(&w));
done:
    brio_release(s->ctx, w.vertex_tet);
    brio_nearest_free(&w.nearest);
    brio_release(s->ctx, w.hidden);
    return status;
}

/* --- hidden points left without a representative --- */

/* A hash table of records at distinct positions, by linear probing. */
typedef struct {
    const brio_store *store;
    uint32_t *place; /* size of them: a record, or BRIO_INFINITE */
    size_t size;     /* a power of two */
} positions;

static brio_status positions_new(const brio_store *s, positions *out) {
    *out = (positions){.store = s, .size = 64};
    while (out->size < s->num_points + s->num_points / 2) out->size *= 2;
    brio_status status = BRIO_ALLOC(s->ctx, out->place, out->size);
    if (status == BRIO_OK) memset(out->place, 0xff, out->size * sizeof *out->place);
    return status;
}

static size_t first_place(const positions *t, uint32_t p) {
    uint64_t x[3];
    memcpy(x, t->store->record[p], sizeof x);
    assert((t->size & (t->size - 1)) == 0 && t->size > t->store->num_points); /* probing ends */
    return brio_mix(x[0] ^ brio_mix(x[1] ^ brio_mix(x[2]))) & (t->size - 1);
}

/* Enters a record at a position that the table does not have. */
static void enter(positions *t, uint32_t p) {
    size_t at = first_place(t, p);
    while (t->place[at] != BRIO_INFINITE) at = (at + 1) & (t->size - 1);
    t->place[at] = p;
}

/* Returns the record of the table at the position of p, after entering p if there was none. */
static uint32_t find_or_enter(positions *t, uint32_t p) {
    const brio_record *r = t->store->record;
    size_t at = first_place(t, p);
    while (t->place[at] != BRIO_INFINITE && !brio_same_position(r[t->place[at]], r[p])) at = (at + 1) & (t->size - 1);
    if (t->place[at] == BRIO_INFINITE) t->place[at] = p;
    return t->place[at];
}

/* Names the vertices of duplicates, and counts the hidden points. */
static brio_status leave_hidden(brio_inserter *ins) {
    const brio_store *s = ins->store;
    positions t;
    brio_status status = positions_new(s, &t);
    if (status != BRIO_OK) return status;
    for (uint32_t p = 0; p < s->num_points; p++)
        if (s->representative[p] == p) enter(&t, p);
    for (uint32_t p = 0; p < s->num_points; p++) {
        if (s->representative[p] == p) continue;
        uint32_t same = find_or_enter(&t, p);
        bool is_vertex = s->representative[same] == same;
        s->representative[p] = is_vertex ? same : BRIO_INFINITE;
        ins->stats.duplicates += same != p;
        ins->stats.hidden += same == p;
    }
    brio_release(s->ctx, t.place);
    return BRIO_OK;
}

/* --- all points --- */

/* Represents points that are all at one position. The heaviest represents the others; among equal weights, the one
 * with the lowest index. */
static void represent_coincident(brio_inserter *ins) {
    const brio_store *s = ins->store;
    uint32_t best = 0;
    for (uint32_t p = 1; p < s->num_points; p++) {
        double difference = s->weighted ? s->record[p][3] - s->record[best][3] : 0;
        if (difference > 0 || (difference == 0 && s->caller[p] < s->caller[best])) best = p;
    }
    for (uint32_t p = 0; p < s->num_points; p++) s->representative[p] = best;
    ins->stats.duplicates = s->num_points - 1;
}

/* Returns whether record p precedes the vertex that represents it, at the vertex's position and with its weight. */
static bool is_earlier_twin(const brio_store *s, uint32_t p) {
    uint32_t v = s->representative[p];
    return p < v && s->representative[v] == v && brio_same_position(s->record[p], s->record[v]) &&
           (!s->weighted || s->record[p][3] == s->record[v][3]);
}

static bool has_earlier_twin(const brio_store *s) {
    for (uint32_t p = 0; p < s->num_points; p++)
        if (is_earlier_twin(s, p)) return true;
    return false;
}

typedef struct {
    const brio_store *store;
    const uint32_t *first; /* of each vertex, the record that replaces it */
} renaming;

static void rename_vertices(void *user, size_t begin, size_t end, int thread) {
    const renaming *r = user;
    (void)thread;
    for (size_t t = begin; t < end; t++) {
        if (r->store->state[t] != TET_PLAIN) continue; /* an unused slot may never have been written */
        uint32_t *v = r->store->t.tet[t].vertex;
        assert(v[0] < r->store->t.infinite && v[3] <= r->store->t.infinite); /* I2 */
        for (int i = 0; i < 4; i++) v[i] = r->first[v[i]];
    }
}

/* Makes the first of coincident points of equal weight their vertex again. A parallel pass, or a sequence by weights,
 * may have inserted a later one first; without this step the order of the tetrahedra would depend on that. */
static brio_status restore_first(brio_store *s) {
    uint32_t *first = NULL;
    brio_status status = BRIO_ALLOC(s->ctx, first, s->num_points + 3);
    if (status != BRIO_OK) return status;
    for (uint32_t v = 0; v < s->num_points + 3; v++) first[v] = v;
    for (uint32_t p = (uint32_t)s->num_points; p-- > 0;)
        if (is_earlier_twin(s, p)) first[s->representative[p]] = p;
    renaming r = {s, first};
    status = brio_for(s->ctx, brio_threads(s->ctx, s->t.count, SLOTS_A_THREAD), s->t.count, rename_vertices, &r);
    for (uint32_t p = 0; p < s->num_points; p++) {
        uint32_t v = s->representative[p];
        s->representative[p] = first[v];
        if (v != p || first[p] == p) continue;
        uint32_t name = s->caller[p];
        s->caller[p] = s->caller[first[p]], s->caller[first[p]] = name;
    }
    brio_release(s->ctx, first);
    return status;
}

static void count_duplicates(brio_inserter *ins) {
    const brio_store *s = ins->store;
    brio_expect_sequence(s->representative);
    for (uint32_t p = 0; p < s->num_points; p++) ins->stats.duplicates += s->representative[p] != p;
    brio_expect_random(s->representative);
}

brio_status brio_represent(brio_inserter *ins, bool leaves_hidden) {
    brio_store *s = ins->store;
    bool in_order = !s->rank && !s->sequence && !s->adopted;
    brio_status status = !in_order && s->dimension == 3 && has_earlier_twin(s) ? restore_first(s) : BRIO_OK;
    if (status != BRIO_OK) return status;
    if (s->dimension == 0)
        represent_coincident(ins);
    else if (s->weighted && s->dimension > 0)
        status = leaves_hidden ? leave_hidden(ins) : represent_weighted(ins);
    else
        count_duplicates(ins);
    assert(ins->stats.duplicates + ins->stats.hidden <= s->num_points);
    ins->stats.vertices = s->num_points - ins->stats.duplicates - ins->stats.hidden;
    return status;
}
