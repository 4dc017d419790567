/* Points that own no cell, each with the vertex that represents it.
 *
 * Without weights a point that is no vertex is a duplicate, and insertion has named its vertex. With weights a point
 * may have been hidden by another that was hidden later itself, and may coincide with a vertex that came after it: so
 * each one is located in the finished triangulation. At the position of a vertex it is a duplicate; else it is hidden,
 * and its vertex of least power distance is found by descent along edges: in a regular triangulation a vertex with no
 * nearer neighbour is the nearest of all. Apexes of flat inputs are passed over: the edges of the flat triangulation
 * suffice. */
#include "base/memory.h"
#include "base/sort.h"
#include "base/team.h"
#include "triangulation/kernel.h"
#include "triangulation/nearest_vertex.h"
#include "triangulation/vertex_tets.h"

enum { SLOTS_A_THREAD = 1 << 13 };

typedef struct {
    brio_kernel *k;
    uint32_t *vertex_tet; /* a tetrahedron of each vertex */
    brio_nearest nearest;
    uint32_t *hidden;
    size_t num_hidden;
} workspace;

static brio_status represent_one(workspace *w, uint32_t p) {
    brio_kernel *k = w->k;
    const double *x = k->record[p];
    k->walk.start = w->vertex_tet[brio_alive(k, p)];
    uint32_t tet = k->engine->walk(&k->t, &k->filter, &k->walk, x, UINT64_MAX);
    const uint32_t *v = k->t.tet[tet].vertex;
    for (int i = 0; i < 4; i++)
        if (v[i] != k->t.infinite && brio_same_position(k->record[v[i]], x)) {
            k->representative[p] = v[i];
            k->stats.duplicates++;
            return BRIO_OK;
        }
    w->hidden[w->num_hidden++] = p;
    return brio_nearest_vertex(&w->nearest, tet, x, &k->representative[p]);
}

/* By position; at one position the heaviest first, then the lowest index. */
static int compare_hidden(uint32_t p, uint32_t q, const void *user) {
    const brio_kernel *k = user;
    int sign = brio_lexicographic(k->record[p], k->record[q]);
    if (sign) return sign;
    if (k->record[p][3] != k->record[q][3]) return k->record[p][3] > k->record[q][3] ? -1 : 1;
    return k->caller[p] < k->caller[q] ? -1 : 1;
}

static brio_status count_hidden(workspace *w) {
    brio_kernel *k = w->k;
    brio_status status =
        brio_sort_rows(k->ctx, &(brio_row_order){*k->record, 4, compare_hidden, k}, w->hidden, w->num_hidden);
    if (status != BRIO_OK) return status;
    for (size_t n = 0; n < w->num_hidden; n++) {
        bool again = n > 0 && brio_same_position(k->record[w->hidden[n - 1]], k->record[w->hidden[n]]);
        if (again)
            k->stats.duplicates++;
        else
            k->stats.hidden++;
    }
    return BRIO_OK;
}

static brio_status represent_weighted(brio_kernel *k) {
    workspace w = {.k = k};
    brio_status status = BRIO_OK;
    size_t not_vertices = 0;
    for (uint32_t p = 0; p < k->num_points; p++) not_vertices += k->representative[p] != p;
    if (!not_vertices) return BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(k->ctx, w.hidden, not_vertices));
    BRIO_TRY(BRIO_ALLOC(k->ctx, w.vertex_tet, k->num_points + 3));
    brio_vertex_tets_fill(k, w.vertex_tet);
    BRIO_TRY(brio_nearest_new(k->ctx, &k->t, k->num_points, w.vertex_tet, &w.nearest));
    for (uint32_t p = 0; p < k->num_points; p++)
        if (k->representative[p] != p) BRIO_TRY(represent_one(&w, p));
    BRIO_TRY(count_hidden(&w));
done:
    brio_release(k->ctx, w.vertex_tet);
    brio_nearest_free(&w.nearest);
    brio_release(k->ctx, w.hidden);
    return status;
}

/* All points at one position: the heaviest, then the lowest index, represents the others. */
static void represent_coincident(brio_kernel *k) {
    uint32_t best = 0;
    for (uint32_t p = 1; p < k->num_points; p++) {
        double difference = k->weighted ? k->record[p][3] - k->record[best][3] : 0;
        if (difference > 0 || (difference == 0 && k->caller[p] < k->caller[best])) best = p;
    }
    for (uint32_t p = 0; p < k->num_points; p++) k->representative[p] = best;
    k->stats.duplicates = k->num_points - 1;
}

/* Whether record p stands before the vertex that represents it, at its position and as heavy. */
static bool is_earlier_twin(const brio_kernel *k, uint32_t p) {
    uint32_t v = k->representative[p];
    return p < v && k->representative[v] == v && brio_same_position(k->record[p], k->record[v]) &&
           (!k->weighted || k->record[p][3] == k->record[v][3]);
}

static bool has_earlier_twin(const brio_kernel *k) {
    for (uint32_t p = 0; p < k->num_points; p++)
        if (is_earlier_twin(k, p)) return true;
    return false;
}

typedef struct {
    brio_kernel *k;
    const uint32_t *first; /* of each vertex: the record that takes its place */
} renaming;

static void rename_vertices(void *user, size_t begin, size_t end, int thread) {
    const renaming *r = user;
    (void)thread;
    for (size_t t = begin; t < end; t++) {
        if (r->k->state[t] != TET_PLAIN) continue; /* nobody need have written an unused slot */
        uint32_t *v = r->k->t.tet[t].vertex;
        for (int i = 0; i < 4; i++) v[i] = r->first[v[i]];
    }
}

/* In a parallel pass a later one of coincident points may come first and become the vertex. The first in the order
 * takes its place back, so that the order of the tetrahedra does not tell. */
static brio_status restore_first(brio_kernel *k) {
    uint32_t *first = NULL;
    brio_status status = BRIO_ALLOC(k->ctx, first, k->num_points + 3);
    if (status != BRIO_OK) return status;
    for (uint32_t v = 0; v < k->num_points + 3; v++) first[v] = v;
    for (uint32_t p = (uint32_t)k->num_points; p-- > 0;)
        if (is_earlier_twin(k, p)) first[k->representative[p]] = p;
    renaming r = {k, first};
    brio_for(k->ctx, brio_threads(k->ctx, k->t.count, SLOTS_A_THREAD), k->t.count, rename_vertices, &r);
    for (uint32_t p = 0; p < k->num_points; p++) {
        uint32_t v = k->representative[p];
        k->representative[p] = first[v];
        if (v != p || first[p] == p) continue;
        uint32_t name = k->caller[p];
        k->caller[p] = k->caller[first[p]], k->caller[first[p]] = name;
    }
    brio_release(k->ctx, first);
    return BRIO_OK;
}

static void count_duplicates(brio_kernel *k) {
    brio_expect_sequence(k->representative);
    for (uint32_t p = 0; p < k->num_points; p++) k->stats.duplicates += k->representative[p] != p;
    brio_expect_random(k->representative);
}

brio_status brio_kernel_represent(brio_kernel *k) {
    brio_status status = k->rank && k->dimension == 3 && has_earlier_twin(k) ? restore_first(k) : BRIO_OK;
    if (status != BRIO_OK) return status;
    if (k->dimension == 0)
        represent_coincident(k);
    else if (k->weighted && k->dimension > 0)
        status = represent_weighted(k);
    else
        count_duplicates(k);
    k->stats.vertices = k->num_points - k->stats.duplicates - k->stats.hidden;
    return status;
}
