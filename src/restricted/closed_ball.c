/* The closed-ball property, by counting.
 *
 * An edge of the Voronoi diagram meets the surface in as many points as there are crossings. A facet meets it in curves
 * made of segments, one for each face; segments are joined where an edge of the surface meets the facet, and end at
 * crossings. The curves are one arc when they hang together and have two ends. A cell meets the surface in a region of
 * polygons, joined across edges of the surface; it is a disk when it hangs together and its Euler characteristic is 1:
 * no closed surface, and none with another boundary than one circle, has that.
 *
 * Based on: Edelsbrunner, Shah. Triangulating topological spaces. IJCGA 1997. */
#include "base/memory.h"
#include "base/sort.h"
#include "base/union_find.h"
#include "restricted/work.h"
#include <string.h>

static int compare_crossings(uint32_t i, uint32_t j, const void *user) {
    const brio_crossing *a = (const brio_crossing *)user + i, *b = (const brio_crossing *)user + j;
    for (int k = 0; k < 3; k++)
        if (a->sample[k] != b->sample[k]) return a->sample[k] < b->sample[k] ? -1 : 1;
    return a->face < b->face ? -1 : a->face > b->face;
}

brio_status brio_restriction_sort(brio_restriction *r) {
    brio_status status = BRIO_OK;
    uint32_t *index = NULL;
    brio_crossing *sorted = NULL;
    BRIO_REQUIRE(r->ctx, r->num_crossings < UINT32_MAX, BRIO_ERR_TOO_LARGE, "%zu crossings; at most 2^32 - 2",
                 r->num_crossings);
    BRIO_TRY(BRIO_ALLOC(r->ctx, index, r->num_crossings));
    BRIO_TRY(BRIO_ALLOC(r->ctx, sorted, r->num_crossings));
    for (size_t i = 0; i < r->num_crossings; i++) index[i] = (uint32_t)i;
    BRIO_TRY(brio_sort_many_indices(r->ctx, index, r->num_crossings, compare_crossings, r->crossing));
    for (size_t i = 0; i < r->num_crossings; i++) sorted[i] = r->crossing[index[i]];
    for (size_t i = 0; i < r->num_crossings; i++) r->crossing[i] = sorted[i];
done:
    brio_release(r->ctx, index);
    brio_release(r->ctx, sorted);
    return status;
}

static void mark(uint8_t *bad, const uint32_t *samples, int count) {
    for (int k = 0; bad && k < count; k++) bad[samples[k]] = 1;
}

/* Crossings are sorted. */
static void count_edges(const brio_restriction *r, brio_ball_counts *n, uint8_t *bad) {
    for (size_t i = 0, end; i < r->num_crossings; i = end) {
        const uint32_t *s = r->crossing[i].sample;
        for (end = i + 1; end < r->num_crossings && !memcmp(r->crossing[end].sample, s, sizeof(uint32_t[3])); end++)
            continue;
        n->edges++;
        n->bad_edges += end > i + 1;
        if (end > i + 1) mark(bad, s, 3);
    }
}

/* --- facets --- */

/* An end of a segment: where the facet of two samples leaves a face. */
typedef struct {
    uint32_t sample[2], face, edge; /* of the surface; BRIO_INFINITE: at a crossing */
} segment_end;

static int compare_ends(uint32_t i, uint32_t j, const void *user) {
    const segment_end *a = (const segment_end *)user + i, *b = (const segment_end *)user + j;
    for (int k = 0; k < 2; k++)
        if (a->sample[k] != b->sample[k]) return a->sample[k] < b->sample[k] ? -1 : 1;
    return a->face < b->face ? -1 : a->face > b->face;
}

static segment_end end_of(uint32_t a, uint32_t b, uint32_t face, uint32_t edge) {
    return (segment_end){{a < b ? a : b, a < b ? b : a}, face, edge};
}

/* Lists the ends of all segments. */
static size_t list_ends(const brio_restriction *r, segment_end *end) {
    size_t count = 0;
    for (size_t i = 0; i < r->num_crossings; i++) {
        const brio_crossing *c = &r->crossing[i];
        for (int k = 0; k < 3; k++) end[count++] = end_of(c->sample[k], c->sample[(k + 1) % 3], c->face, BRIO_INFINITE);
    }
    for (size_t e = 0; e < r->num_edges; e++)
        for (uint64_t i = r->first[e]; i + 1 < r->first[e + 1]; i++)
            for (int k = 0; k < 2; k++) end[count++] = end_of(r->met[i], r->met[i + 1], r->side[e][k], (uint32_t)e);
    return count;
}

typedef struct {
    segment_end *end;
    uint32_t *order;   /* of the ends: those of a facet, and of a face, are next to each other */
    uint64_t *joint;   /* edge << 32 | segment, of the segments of one facet */
    uint32_t *segment; /* union-find of these */
    size_t count, joint_capacity, segment_capacity;
} facet_work;

/* Returns whether the segments whose ends are [begin, end) of the order make one arc. */
static brio_status is_arc(brio_context *ctx, facet_work *w, size_t begin, size_t end, bool *arc) {
    size_t segments = (end - begin) / 2, joints = 0, ends = 0, sets = 0;
    BRIO_FORWARD(BRIO_RESERVE(ctx, w->joint, w->joint_capacity, end - begin));
    BRIO_FORWARD(BRIO_RESERVE(ctx, w->segment, w->segment_capacity, segments));
    for (size_t i = 0; i < segments; i++) w->segment[i] = (uint32_t)i;
    for (size_t i = begin; i < end; i++) {
        const segment_end *e = &w->end[w->order[i]];
        if (e->edge == BRIO_INFINITE)
            ends++;
        else
            w->joint[joints++] = (uint64_t)e->edge << 32 | (i - begin) / 2;
    }
    brio_sort_keys(w->joint, joints);
    for (size_t i = 0; i + 1 < joints; i += 2)
        brio_unite(w->segment, (uint32_t)w->joint[i], (uint32_t)w->joint[i + 1], true);
    for (size_t i = 0; i < segments; i++) sets += w->segment[i] == i;
    *arc = sets == 1 && ends == 2;
    return BRIO_OK;
}

/* Checks the segments. Every segment has two ends: the lists are of one complex. */
static brio_status check_segments(const brio_restriction *r, const facet_work *w) {
    bool paired = w->count % 2 == 0;
    for (size_t i = 0; i + 1 < w->count && paired; i += 2)
        paired = compare_ends(w->order[i], w->order[i + 1], w->end) == 0;
    BRIO_EXPECT(r->ctx, paired, BRIO_ERR_INTERNAL, "a face and a facet of the Voronoi diagram have no common segment");
    return BRIO_OK;
}

static brio_status count_facets(const brio_restriction *r, facet_work *w, brio_ball_counts *n, uint8_t *bad) {
    size_t most = 3 * r->num_crossings + 2 * (size_t)r->first[r->num_edges];
    BRIO_EXPECT(r->ctx, most < UINT32_MAX, BRIO_ERR_TOO_LARGE,
                "the surface and the cells have more than 2^32 segments");
    BRIO_FORWARD(BRIO_ALLOC(r->ctx, w->end, most));
    w->count = list_ends(r, w->end);
    BRIO_FORWARD(BRIO_ALLOC(r->ctx, w->order, w->count));
    for (size_t i = 0; i < w->count; i++) w->order[i] = (uint32_t)i;
    BRIO_FORWARD(brio_sort_many_indices(r->ctx, w->order, w->count, compare_ends, w->end));
    BRIO_FORWARD(check_segments(r, w));
    for (size_t i = 0, end; i < w->count; i = end) {
        const uint32_t *s = w->end[w->order[i]].sample;
        bool arc = false;
        for (end = i; end < w->count && !memcmp(w->end[w->order[end]].sample, s, sizeof(uint32_t[2]));) end += 2;
        BRIO_FORWARD(brio_look(r->ctx, end - i));
        BRIO_FORWARD(is_arc(r->ctx, w, i, end, &arc));
        n->facets++;
        n->bad_facets += !arc;
        if (!arc) mark(bad, s, 2);
    }
    return BRIO_OK;
}

/* --- cells --- */

/* Adds up the Euler characteristic of each region: polygons, less their sides, plus their corners. */
static void add_up_cells(const brio_restriction *r, const facet_work *w, int64_t *chi) {
    for (size_t i = 0; i < r->num_pieces; i++) chi[r->piece[i] >> 32]++;
    for (size_t v = 0; v < r->surface->num_vertices; v++)
        if (r->cell[v] != BRIO_INFINITE) chi[r->cell[v]]++;
    for (size_t e = 0; e < r->num_edges; e++)
        for (uint64_t i = r->first[e]; i < r->first[e + 1]; i++) {
            chi[r->met[i]]--;
            if (i + 1 < r->first[e + 1]) chi[r->met[i]]++, chi[r->met[i + 1]]++;
        }
    for (size_t i = 0; i < r->num_crossings; i++)
        for (int k = 0; k < 3; k++) chi[r->crossing[i].sample[k]]++;
    for (size_t i = 0; i < w->count; i += 2) /* segments */
        for (int k = 0; k < 2; k++) chi[w->end[w->order[i]].sample[k]]--;
}

/* Returns the place of a piece in the list. */
static uint32_t place_of(const brio_restriction *r, const uint64_t *first, uint32_t face, uint32_t sample) {
    uint64_t low = first[face], high = first[face + 1];
    while (low + 1 < high) {
        uint64_t middle = low + (high - low) / 2;
        if (r->piece[middle] >> 32 <= sample)
            low = middle;
        else
            high = middle;
    }
    return (uint32_t)low;
}

/* Joins pieces of one cell across the edges of the surface, and counts the parts of each cell. */
static brio_status count_parts(const brio_restriction *r, uint32_t *parts) {
    brio_context *ctx = r->ctx;
    brio_status status = BRIO_OK;
    uint64_t *first = NULL;
    uint32_t *set = NULL;
    size_t n = r->surface->num_faces;
    BRIO_REQUIRE(ctx, r->num_pieces < UINT32_MAX, BRIO_ERR_TOO_LARGE,
                 "the cells cut the surface into more than 2^32 pieces");
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, first, n + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, set, r->num_pieces));
    for (size_t i = 0; i < r->num_pieces; i++) set[i] = (uint32_t)i, first[(uint32_t)r->piece[i] + 1]++;
    for (size_t f = 0; f < n; f++) first[f + 1] += first[f];
    for (size_t e = 0; e < r->num_edges; e++) {
        BRIO_TRY(brio_look(ctx, r->first[e + 1] - r->first[e]));
        for (uint64_t i = r->first[e]; i < r->first[e + 1]; i++)
            brio_unite(set, place_of(r, first, r->side[e][0], r->met[i]), place_of(r, first, r->side[e][1], r->met[i]),
                       true);
    }
    for (size_t i = 0; i < r->num_pieces; i++) parts[r->piece[i] >> 32] += set[i] == i;
done:
    brio_release(ctx, first);
    brio_release(ctx, set);
    return status;
}

static brio_status count_cells(const brio_restriction *r, const facet_work *w, brio_ball_counts *n, uint8_t *bad) {
    brio_status status = BRIO_OK;
    int64_t *chi = NULL;
    uint32_t *parts = NULL;
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, chi, r->tets.count));
    BRIO_TRY(BRIO_ALLOC_ZERO(r->ctx, parts, r->tets.count));
    add_up_cells(r, w, chi);
    BRIO_TRY(count_parts(r, parts));
    for (uint32_t s = 0; s < r->tets.count; s++) {
        if (parts[s] == 0) continue;
        bool disk = parts[s] == 1 && chi[s] == 1;
        n->cells++;
        n->bad_cells += !disk;
        if (!disk) mark(bad, &s, 1);
    }
done:
    brio_release(r->ctx, chi);
    brio_release(r->ctx, parts);
    return status;
}

brio_status brio_restriction_balls(brio_restriction *r, brio_ball_counts *counts, uint8_t *bad) {
    brio_status status = BRIO_OK;
    facet_work w = {0};
    *counts = (brio_ball_counts){0};
    count_edges(r, counts, bad);
    BRIO_TRY(count_facets(r, &w, counts, bad));
    BRIO_TRY(count_cells(r, &w, counts, bad));
done:
    brio_release(r->ctx, w.end);
    brio_release(r->ctx, w.order);
    brio_release(r->ctx, w.joint);
    brio_release(r->ctx, w.segment);
    return status;
}
