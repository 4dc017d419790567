/* Sheets of the boundary of a solid that comes in parts: what brio_mesh_split_sheets makes, by counting alone.
 *
 * Faces are paired across inside wedges, and across outside wedges at edges that a fan passes twice at both ends. The
 * owner of a vertex (parts.c) sees this there. At an edge whose other end has another owner, it leaves a strand open
 * that has a second strand of the same fan beside it. Of such strands both owners write which fan they are of; those
 * that are of one fan at both ends are paired across outside wedges, the others across inside wedges. A fan with open
 * strands is a chain of pieces, which are joined when that is known. */
#include "base/sort.h"
#include "base/team.h"
#include "certificate/parts.h"
#include "mesh/split_vertices.h"
#include <string.h>

enum { CORNERS_A_THREAD = 1 << 13, CORNERS_A_CHUNK = 1 << 10, SETTLED = 2 };

static bool is_complete(const brio_topology *t, uint32_t h) {
    return brio_starts_own(t, h) || brio_starts_own(t, brio_next_corner(t, h));
}

static uint32_t start_of(const brio_topology *t, uint32_t h) {
    return t->mesh->face_vertices[h];
}

static uint32_t apex_of(const brio_topology *t, uint32_t h) {
    return t->mesh->face_vertices[brio_next_corner(t, brio_next_corner(t, h))];
}

/* Returns whether a half-edge runs from the lesser index to the greater one. */
static bool ascends(const brio_topology *t, uint32_t h) {
    return t->index[start_of(t, h)] < t->index[start_of(t, brio_next_corner(t, h))];
}

static brio_status bounds_no_solid(const brio_topology *t) {
    return brio_fail(t->ctx, BRIO_ERR_ARGUMENT,
                     "the faces bound no solid: at an edge inside and outside do not alternate");
}

/* --- pairs across inside wedges --- */

typedef struct {
    const brio_topology *t;
    const uint32_t *whole; /* #corners: rings of all faces of an edge */
    bool sound;
} pairing;

static void pair_inside(void *user, size_t begin, size_t end, int thread) {
    pairing *p = user;
    const brio_topology *t = p->t;
    bool sound = true;
    (void)thread;
    for (uint32_t h = (uint32_t)begin; h < end; h++) {
        t->ring[h] = is_complete(t, h) ? brio_wedge_partner(t->mesh, p->whole, h, true) : h;
        sound = sound && (t->ring[h] != h || !is_complete(t, h));
    }
    if (!sound) __atomic_store_n(&p->sound, false, __ATOMIC_RELAXED); /* read after all threads have ended */
}

static brio_status make_inside_pairs(const brio_topology *t, const uint32_t *whole) {
    pairing p = {t, whole, true};
    int threads = brio_threads(t->ctx, t->corners, CORNERS_A_THREAD);
    BRIO_FORWARD(brio_for_chunks(t->ctx, threads, t->corners, CORNERS_A_CHUNK, pair_inside, &p));
    for (size_t h = 0; h < t->corners && p.sound; h++) p.sound = t->ring[t->ring[h]] == h;
    return p.sound ? BRIO_OK : bounds_no_solid(t);
}

/* Joins the corners at both ends of pairs and, with `faces`, the faces.   left_out  #corners: not 0 at half-edges whose
 * pair is not joined; NULL: none. */
static brio_status join_pairs(const brio_topology *t, const uint8_t *left_out, bool faces) {
    for (uint32_t h = 0; h < t->corners; h++) {
        uint32_t g = t->ring[h];
        BRIO_FORWARD(brio_look(t->ctx, 1));
        if (g <= h || (left_out && left_out[h])) continue;
        brio_unite(t->fan, h, brio_next_corner(t, g), true); /* they run in opposite directions */
        brio_unite(t->fan, brio_next_corner(t, h), g, true);
        if (faces) brio_unite(t->patch, brio_face_at(t, h), brio_face_at(t, g), true);
    }
    return BRIO_OK;
}

/* --- strands of an edge --- */

/* Returns the half-edge of an edge that runs from the lesser index to the greater one and has the least apex. */
static uint32_t first_half_edge(const brio_topology *t, const uint32_t *whole, uint32_t h) {
    uint32_t first = UINT32_MAX, g = h;
    do
        if (ascends(t, g) && (first == UINT32_MAX || t->index[apex_of(t, g)] < t->index[apex_of(t, first)])) first = g;
    while ((g = whole[g]) != h);
    return first;
}

/* Appends the strands of an edge, in their order round it. */
static brio_status list_strands(const brio_topology *t, const uint32_t *whole, uint32_t h, brio_strands *s) {
    uint32_t first = first_half_edge(t, whole, h), g = first, rank = 0, faces = 1;
    for (uint32_t other = whole[h]; other != h; other = whole[other]) faces++;
    if (first == UINT32_MAX) return bounds_no_solid(t);
    do {
        uint32_t inner = t->ring[g];
        if (2 * rank >= faces) return bounds_no_solid(t);
        BRIO_FORWARD(BRIO_RESERVE(t->ctx, s->strand, s->capacity, s->count + 1));
        s->strand[s->count++] =
            (brio_strand){.half = {g, inner},
                          .label = {brio_find(t->fan, g), brio_find(t->fan, brio_next_corner(t, g))},
                          .rank = rank++,
                          .end = SETTLED};
        g = brio_wedge_partner(t->mesh, whole, inner, false);
    } while (g != first);
    return 2 * rank == faces ? BRIO_OK : bounds_no_solid(t);
}

static bool same_labels(const brio_strand *a, const brio_strand *b, const bool by[2]) {
    return (!by[0] || a->label[0] == b->label[0]) && (!by[1] || a->label[1] == b->label[1]);
}

/* Returns the next strand, in their order, that is of the same fans at the ends that count: i itself if there is none.
 * */
static size_t next_alike(const brio_strand *strand, size_t n, size_t i, const bool by[2]) {
    size_t j = i;
    do j = (j + 1) % n;
    while (j != i && !same_labels(&strand[i], &strand[j], by));
    return j;
}

/* Pairs the strands of an edge across outside wedges where both its ends show that, and leaves those open of which one
 * end alone shows it. */
static void settle_strands(const brio_topology *t, brio_strand *strand, size_t n) {
    uint32_t low = strand->half[0], high = brio_next_corner(t, low);
    const bool by[2] = {brio_starts_own(t, low), brio_starts_own(t, high)};
    for (size_t i = 0; i < n; i++) {
        size_t j = next_alike(strand, n, i, by);
        if (j == i) continue;
        if (by[0] && by[1])
            t->ring[strand[i].half[1]] = strand[j].half[0], t->ring[strand[j].half[0]] = strand[i].half[1];
        else
            strand[i].end = by[0] ? 0 : 1;
    }
}

/* Settles the edges of more than two faces. Keeps the strands that are open. */
static brio_status settle_edges(const brio_topology *t, const uint32_t *whole, brio_strands *s) {
    for (uint32_t h = 0; h < t->corners; h++) {
        size_t before = s->count, kept = before;
        BRIO_FORWARD(brio_look(t->ctx, 1));
        if (whole[h] > h || whole[whole[h]] == h || !is_complete(t, h)) continue; /* once, at the last half-edge */
        BRIO_FORWARD(list_strands(t, whole, h, s));
        settle_strands(t, s->strand + before, s->count - before);
        for (size_t i = before; i < s->count; i++)
            if (s->strand[i].end != SETTLED) s->strand[kept++] = s->strand[i];
        s->count = kept;
    }
    return BRIO_OK;
}

brio_status brio_sheets_pair(const brio_topology *t, brio_strands *strands) {
    brio_status status = BRIO_OK;
    uint32_t *whole = NULL;
    uint8_t *open = NULL;
    BRIO_TRY(BRIO_ALLOC(t->ctx, whole, t->corners));
    memcpy(whole, t->ring, t->corners * sizeof *whole);
    BRIO_TRY(make_inside_pairs(t, whole));
    BRIO_TRY(join_pairs(t, NULL, false));
    BRIO_TRY(settle_edges(t, whole, strands));
    BRIO_TRY(BRIO_ALLOC_ZERO(t->ctx, open, t->corners));
    for (size_t i = 0; i < strands->count; i++) open[strands->strand[i].half[0]] = open[strands->strand[i].half[1]] = 1;
    for (size_t h = 0; h < t->corners; h++) t->fan[h] = (uint32_t)h;
    status = join_pairs(t, open, true);
done:
    brio_release(t->ctx, whole);
    brio_release(t->ctx, open);
    return status;
}

/* --- counts --- */

/* The sets of fans that are open: at the roots of these fans, `open` is 1. */
typedef struct {
    uint32_t *set;
    uint8_t *open;
} open_fans;

/* Returns the set of the fan of a corner, a new one where it has none. */
static brio_status set_of(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t, uint32_t corner,
                          const open_fans *fans, uint32_t *set) {
    uint32_t root = brio_find(t->fan, corner), patch = o->patch[brio_face_at(t, corner)];
    if (!fans->open[root]) BRIO_FORWARD(brio_open_sets_add(c->ctx, &c->fans, patch, &fans->set[root]));
    fans->open[root] = 1;
    *set = fans->set[root];
    return BRIO_OK;
}

/* Counts the edges of open strands in the patches of their first faces: each pair has one, across whatever wedge. They
 * were counted in those of the greater half-edges. */
static void count_open_edges(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t,
                             const brio_strands *strands) {
    for (size_t i = 0; i < strands->count; i++) {
        const uint32_t *h = strands->strand[i].half;
        if (!brio_counts_edge(t, h[0])) continue;
        c->component[o->patch[brio_face_at(t, h[0] > h[1] ? h[0] : h[1])]].edges--;
        c->component[o->patch[brio_face_at(t, h[0])]].edges++;
    }
}

brio_status brio_sheets_count(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t,
                              const brio_strands *strands) {
    brio_status status = BRIO_OK;
    open_fans fans = {NULL, NULL};
    bool pinched;
    BRIO_TRY(BRIO_ALLOC(c->ctx, fans.set, t->corners));
    BRIO_TRY(BRIO_ALLOC_ZERO(c->ctx, fans.open, t->corners));
    for (size_t i = 0; i < strands->count; i++) {
        const brio_strand *s = &strands->strand[i];
        brio_knot_row row;
        memset(&row, 0, sizeof row);
        row.edge[0] = o->index[start_of(t, s->half[0])];
        row.edge[1] = o->index[start_of(t, s->half[1])];
        row.rank = s->rank, row.end = s->end, row.label = s->label[s->end];
        for (uint32_t k = 0; k < 2; k++) { /* the first half-edge starts at end 0, the second at end 1 */
            uint32_t h = s->half[k], corner = k == s->end ? h : brio_next_corner(t, h);
            BRIO_TRY(set_of(c, o, t, corner, &fans, &row.fan[k]));
            row.patch[k] = o->patch[brio_face_at(t, h)];
        }
        BRIO_TRY(brio_row_files_put(&c->knots, brio_bucket_of_edge(c, row.edge), &row, sizeof row));
    }
    count_open_edges(c, o, t, strands);
    status = brio_topology_count(t, o->patch, c->component, fans.open, &pinched);
done:
    brio_release(c->ctx, fans.set);
    brio_release(c->ctx, fans.open);
    return status;
}

/* --- knots --- */

static int compare_knots(uint32_t i, uint32_t j, const void *user) {
    const brio_knot_row *a = (const brio_knot_row *)user + i, *b = (const brio_knot_row *)user + j;
    for (int k = 0; k < 2; k++)
        if (a->edge[k] != b->edge[k]) return a->edge[k] < b->edge[k] ? -1 : 1;
    if (a->rank != b->rank) return a->rank < b->rank ? -1 : 1;
    return (a->end > b->end) - (a->end < b->end);
}

/* What is written of a strand by each end; NULL: it was settled there. */
typedef struct {
    const brio_knot_row *at[2];
} seen_strand;

static bool are_alike(const seen_strand *a, const seen_strand *b) {
    for (int k = 0; k < 2; k++)
        if (!a->at[k] || !b->at[k] || a->at[k]->label != b->at[k]->label) return false;
    return true;
}

/* Joins the pairs of the strands of one edge. */
static void join_strands(brio_parts_certificate *c, const seen_strand *strand, size_t n) {
    for (size_t i = 0; i < n; i++) {
        size_t j = i;
        do j = (j + 1) % n;
        while (j != i && !are_alike(&strand[i], &strand[j]));
        for (int k = 0; k < 2; k++) {
            const brio_knot_row *from = strand[i].at[k], *to = strand[j].at[k];
            if (!from) continue;
            brio_unite(c->fans.parent, from->fan[1], to->fan[0], true);
            brio_unite(c->parent, from->patch[1], to->patch[0], true);
        }
    }
}

static brio_status join_bucket(brio_parts_certificate *c, uint32_t bucket) {
    brio_context *ctx = c->ctx;
    brio_knot_row *row = NULL;
    seen_strand *strand = NULL;
    uint32_t *order = NULL;
    size_t n = 0, strands = 0;
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_row_files_read(&c->folder, "knots", bucket, sizeof *row, (void **)&row, &n));
    BRIO_TRY(BRIO_ALLOC(ctx, order, n + 1));
    BRIO_TRY(BRIO_ALLOC(ctx, strand, n + 1));
    for (size_t i = 0; i < n; i++) {
        const brio_knot_row *r = &row[order[i] = (uint32_t)i];
        bool sound = r->end < 2;
        for (int k = 0; k < 2; k++) sound = sound && r->fan[k] < c->fans.count && r->patch[k] < c->count;
        BRIO_REQUIRE(ctx, sound, BRIO_ERR_OPEN, "%s/knots-%u was changed from outside", c->folder.path, bucket);
    }
    BRIO_TRY(brio_sort_many_indices(ctx, order, n, compare_knots, row));
    for (size_t i = 0; i < n; i++) {
        const brio_knot_row *r = &row[order[i]], *last = i ? &row[order[i - 1]] : NULL;
        bool same_edge = last && !memcmp(r->edge, last->edge, sizeof r->edge);
        BRIO_TRY(brio_look(ctx, 1));
        if (last && !same_edge) {
            join_strands(c, strand, strands);
            strands = 0;
        }
        if (!same_edge || r->rank != last->rank) strand[strands++] = (seen_strand){{NULL, NULL}};
        strand[strands - 1].at[r->end] = r;
    }
    if (strands) join_strands(c, strand, strands);
done:
    brio_release(ctx, row);
    brio_release(ctx, order);
    brio_release(ctx, strand);
    return status;
}

brio_status brio_sheets_join(brio_parts_certificate *c) {
    for (uint32_t i = 0; i < c->buckets; i++) BRIO_FORWARD(join_bucket(c, i));
    return BRIO_OK;
}
