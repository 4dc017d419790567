/* A surface out of the boundary between outer and inner tetrahedra.
 *
 * The boundary is a closed manifold once brio_make_manifold has seen to it, and every part of a closed manifold is a
 * manifold with boundary but for the samples where it has several fans. There all fans but the largest are dropped;
 * dropping can only shorten the fans of other samples or cut them in two, so these are looked at again until nothing
 * changes.
 *
 * Based on: Amenta, Choi, Dey, Leekha. A simple algorithm for homeomorphic surface reconstruction. SoCG 2000, whose
 *           outer boundary this is on a dense sample.
 * Differs from the paper: no walk; the labels of the tetrahedra are where the outside is, so that one hole does not
 * turn the whole surface inside out. */
#include "reconstruct/manifold_extraction.h"
#include "base/memory.h"
#include "base/vector.h"
#include "reconstruct/label_boundary.h"
#include "reconstruct/triangle.h"

/* A facet of the boundary that is no candidate fills a small hole when its circle is at most this many times as large
 * as the largest one of a candidate at its corners. From 1.5 on the closed models of the tests come out closed. */
static const double FILLING = 1.5;

/* A gap of several facets, too, is a lapse rather than an opening where the samples could not show one: when none of its
 * edges is over LONG times as long as the mean edge of the faces at its corners, and its area is under that of a
 * disc of this radius, so that nowhere in it is the next sample farther than a spacing away. (What is left of the club's
 * opening, which other faces span, has an edge of 3.4 times the mean; of the 258 gaps of ten raw scans of the bunny,
 * 232 are lapses, and none of the four with over ten edges.) */
static const double LONG = 2.5, DISC = 3.141592653589793;

/* Among boundary samples, a triangle over SUSPECT times as long as the shortest ones around may span an opening of the
 * surface. Such triangles together are one when one of them is over OPENING times as long and there would be room for
 * MISSING samples; at sharp edges, where samples are too few as well, there is not (club: 16 samples at the opening, 4
 * at the largest sharp edge). */
static const double SUSPECT = 1.5, OPENING = 4, MISSING = 8;

typedef struct {
    brio_context *ctx;
    const brio_tet_labels *labels;
    const brio_tetrahedra *t;
    uint32_t *boundary; /* the facets of the boundary, seen from outside */
    size_t num_boundary;
    uint8_t *face;      /* of each outer tetrahedron: bit i tells whether facet i is a face */
    size_t num_gaps;    /* facets of the boundary that are no candidates */
    uint8_t *at_gap;    /* of each sample: 1 at a gap, and for boundary samples */
    double *size_at;    /* of each sample at a gap: squared radius of the largest circle round a candidate there */
    double *shortest;   /* of each sample at a gap: squared length of the shortest candidate there */
    double *edge_sum;   /* of each sample at a gap: the lengths of the faces' edges there, each once a face */
    uint32_t *edges;    /* of each sample at a gap: how many these are */
    uint32_t *facet_of; /* of each sample in the queue: a boundary facet seen from outside */
    uint32_t *gap;      /* facets of the gaps that stay open */
    size_t gap_size;
    uint32_t *queue; /* samples to look at */
    size_t size, capacity;
} extraction;

/* --- which facets are faces --- */

static bool is_face(const extraction *x, uint32_t facet) {
    return x->face[brio_tet_of(facet)] >> brio_slot_of(facet) & 1;
}

static void set_face(extraction *x, uint32_t facet) {
    x->face[brio_tet_of(facet)] |= (uint8_t)(1 << brio_slot_of(facet));
}

static void clear_face(extraction *x, uint32_t facet) {
    x->face[brio_tet_of(facet)] &= (uint8_t) ~(1 << brio_slot_of(facet));
}

static uint32_t corner_of(const extraction *x, uint32_t facet, int k) {
    return x->t->tet[brio_tet_of(facet)].vertex[BRIO_FACET[brio_slot_of(facet)][k]];
}

static double circle_square(const extraction *x, uint32_t facet) {
    const double *points = x->labels->cocones->dual->points;
    return brio_circle_square(points + 3 * (size_t)corner_of(x, facet, 0), points + 3 * (size_t)corner_of(x, facet, 1),
                              points + 3 * (size_t)corner_of(x, facet, 2));
}

/* Length of the edge from corner k to the next. */
static double edge_length(const extraction *x, uint32_t facet, int k) {
    const double *points = x->labels->cocones->dual->points;
    const double *p = points + 3 * (size_t)corner_of(x, facet, k);
    const double *q = points + 3 * (size_t)corner_of(x, facet, (k + 1) % 3);
    return sqrt(brio_square_distance(p, q));
}

/* Square of the longest edge. */
static double length_square(const extraction *x, uint32_t facet) {
    const double *points = x->labels->cocones->dual->points, *p[3];
    for (int k = 0; k < 3; k++) p[k] = points + 3 * (size_t)corner_of(x, facet, k);
    double ab = brio_square_distance(p[0], p[1]), bc = brio_square_distance(p[1], p[2]);
    return fmax(fmax(ab, bc), brio_square_distance(p[2], p[0]));
}

static bool is_finite(const extraction *x, uint32_t facet) {
    return brio_slot_of(facet) == 3 || x->t->tet[brio_tet_of(facet)].vertex[3] != BRIO_INFINITE;
}

static void choose_candidates(extraction *x) {
    for (size_t n = 0; n < x->num_boundary; n++) {
        if (brio_is_candidate(x->labels->cocones, x->boundary[n]))
            set_face(x, x->boundary[n]);
        else
            x->num_gaps++;
    }
}

static bool is_face_at_gap(const extraction *x, uint32_t facet) {
    return is_face(x, facet) &&
           (x->at_gap[corner_of(x, facet, 0)] | x->at_gap[corner_of(x, facet, 1)] | x->at_gap[corner_of(x, facet, 2)]);
}

static void begin_measuring(extraction *x, uint32_t p) {
    x->at_gap[p] = 1;
    x->size_at[p] = x->edge_sum[p] = 0;
    x->shortest[p] = INFINITY;
    x->edges[p] = 0;
}

/* Lets a candidate count at those of its samples that are at gaps. */
static void measure_candidate(extraction *x, uint32_t facet) {
    double size = circle_square(x, facet), length = length_square(x, facet);
    for (int k = 0; k < 3; k++) {
        uint32_t p = corner_of(x, facet, k);
        if (!x->at_gap[p]) continue;
        x->size_at[p] = fmax(x->size_at[p], size);
        x->shortest[p] = fmin(x->shortest[p], length);
    }
}

/* Finds how large the candidates at each sample of a gap are. Other samples' places in the arrays are never touched. */
static brio_status measure_gaps(extraction *x) {
    brio_status status = BRIO_OK;
    const uint8_t *boundary = x->labels->cocones->boundary;
    size_t num_points = x->labels->cocones->dual->num_points;
    BRIO_TRY(BRIO_ALLOC_ZERO(x->ctx, x->at_gap, num_points));
    BRIO_TRY(BRIO_ALLOC(x->ctx, x->size_at, num_points));
    BRIO_TRY(BRIO_ALLOC(x->ctx, x->shortest, num_points));
    BRIO_TRY(BRIO_ALLOC(x->ctx, x->edge_sum, num_points));
    BRIO_TRY(BRIO_ALLOC(x->ctx, x->edges, num_points));
    BRIO_TRY(BRIO_ALLOC(x->ctx, x->facet_of, num_points));
    for (size_t n = 0; n < x->num_boundary; n++)
        for (int k = 0; k < 3 && !is_face(x, x->boundary[n]); k++) {
            uint32_t p = corner_of(x, x->boundary[n], k);
            if (p != BRIO_INFINITE) begin_measuring(x, p);
        }
    for (size_t p = 0; boundary && p < num_points; p++)
        if (boundary[p]) begin_measuring(x, (uint32_t)p);
    for (size_t n = 0; n < x->num_boundary; n++)
        if (is_face_at_gap(x, x->boundary[n])) measure_candidate(x, x->boundary[n]);
done:
    return status;
}

/* Whether a facet of the boundary that is no candidate is as small as the candidates around it. */
static bool is_small(const extraction *x, uint32_t facet) {
    double size = 0;
    for (int k = 0; k < 3; k++) size = fmax(size, x->size_at[corner_of(x, facet, k)]);
    return circle_square(x, facet) <= FILLING * FILLING * size;
}

/* Squared length of the longest of the shortest candidates of a facet's samples: how far they are from each other. */
static double spacing_square(const extraction *x, uint32_t facet) {
    double most = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t p = corner_of(x, facet, k);
        if (p != BRIO_INFINITE && x->shortest[p] > most && x->shortest[p] < INFINITY) most = x->shortest[p];
    }
    return most;
}

/* Whether a facet of the boundary is over so many times as long as the spacing of its samples. */
static bool is_longer(const extraction *x, uint32_t facet, double times) {
    return length_square(x, facet) > times * times * spacing_square(x, facet);
}

static double area(const extraction *x, uint32_t facet) {
    const double *points = x->labels->cocones->dual->points;
    return brio_triangle_area(points + 3 * (size_t)corner_of(x, facet, 0), points + 3 * (size_t)corner_of(x, facet, 1),
                              points + 3 * (size_t)corner_of(x, facet, 2));
}

/* Takes the candidates among boundary samples that are longer than those around them, and may span an opening, for gaps
 * until it is known how long the longest of them is. */
static void suspect_long_candidates(extraction *x) {
    for (size_t n = 0; n < x->num_boundary; n++) {
        uint32_t facet = x->boundary[n];
        if (is_face(x, facet) && brio_is_among_boundary(x->labels->cocones, facet) && is_longer(x, facet, SUSPECT)) {
            clear_face(x, facet);
            x->num_gaps++;
        }
    }
}

/* The samples of a facet of the boundary are to be looked at. */
static brio_status push_corners(extraction *x, uint32_t facet) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(x->ctx, x->queue, x->capacity, x->size + 3));
    for (int k = 0; k < 3; k++) {
        uint32_t p = corner_of(x, facet, k);
        if (p == BRIO_INFINITE) continue;
        x->facet_of[p] = facet;
        x->queue[x->size++] = p;
    }
done:
    return status;
}

/* Adds to x->gap all facets of the gap among boundary samples that a facet belongs to, across the edges of the boundary,
 * as faces for now. Whether it is too large for a place where samples are merely too few. */
static bool collect_gap(extraction *x, uint32_t first) {
    bool is_long = false;
    double missing = 0; /* samples of this spacing that the gap has room for */
    size_t next = x->gap_size;
    x->gap[x->gap_size++] = first;
    set_face(x, first);
    for (; next < x->gap_size; next++) {
        uint32_t facet = x->gap[next];
        bool finite = is_finite(x, facet);
        missing += finite ? area(x, facet) / spacing_square(x, facet) : INFINITY;
        is_long = is_long || !finite || is_longer(x, facet, OPENING);
        for (int k = 0; k < 3; k++) {
            uint32_t a = corner_of(x, facet, k), b = corner_of(x, facet, (k + 1) % 3);
            uint32_t other = brio_next_round_edge(x->labels, facet, a, b);
            if (is_face(x, other) || !brio_is_among_boundary(x->labels->cocones, other)) continue;
            set_face(x, other);
            x->gap[x->gap_size++] = other;
        }
    }
    return is_long && missing > MISSING;
}

/* Fills the facets that are no larger than the candidates around them, or all that are finite; x->gap receives the
 * facets of openings among boundary samples. */
static void fill_small_facets(extraction *x, bool all) {
    for (size_t n = 0; n < x->num_boundary; n++) {
        uint32_t facet = x->boundary[n];
        size_t begin = x->gap_size;
        if (is_face(x, facet)) continue;
        if (brio_is_among_boundary(x->labels->cocones, facet)) {
            if (all && is_finite(x, facet))
                set_face(x, facet);
            else if (!collect_gap(x, facet))
                x->gap_size = begin;
        } else if (is_finite(x, facet) && (all || is_small(x, facet))) {
            set_face(x, facet);
        }
    }
    for (size_t n = 0; n < x->gap_size; n++) clear_face(x, x->gap[n]);
}

/* Lets the edges of a face count at those of its samples that are at gaps. */
static void measure_edges(extraction *x, uint32_t facet) {
    double length[3];
    for (int k = 0; k < 3; k++) length[k] = edge_length(x, facet, k);
    for (int k = 0; k < 3; k++) {
        uint32_t p = corner_of(x, facet, k);
        if (!x->at_gap[p]) continue;
        x->edge_sum[p] += length[k] + length[(k + 2) % 3];
        x->edges[p] += 2;
    }
}

/* What is known of a gap: over all corners of its facets the mean of the faces' mean edges there; its area; its longest
 * edge. */
typedef struct {
    double spacing_sum, area, longest;
    size_t corners;
    bool may_close; /* no facet is infinite, or of an opening among boundary samples */
} gap_shape;

static void add_to_shape(const extraction *x, uint32_t facet, gap_shape *s) {
    if (!is_finite(x, facet) || brio_is_among_boundary(x->labels->cocones, facet)) {
        s->may_close = false;
        return;
    }
    s->area += area(x, facet);
    s->longest = fmax(s->longest, sqrt(length_square(x, facet)));
    for (int k = 0; k < 3; k++) {
        uint32_t p = corner_of(x, facet, k);
        if (x->edges[p] == 0) continue;
        s->spacing_sum += x->edge_sum[p] / x->edges[p];
        s->corners++;
    }
}

static bool is_lapse(const gap_shape *s) {
    double spacing = s->corners > 0 ? s->spacing_sum / (double)s->corners : 0;
    return s->may_close && s->longest <= LONG * spacing && s->area <= DISC * spacing * spacing;
}

/* Adds to x->gap all facets of the gap that a facet belongs to, across the edges of the boundary, as faces for now.
 * Whether it is a lapse. */
static bool collect_lapse(extraction *x, uint32_t first) {
    gap_shape shape = {.may_close = true};
    size_t next = x->gap_size;
    x->gap[x->gap_size++] = first;
    set_face(x, first);
    for (; next < x->gap_size; next++) {
        uint32_t facet = x->gap[next];
        add_to_shape(x, facet, &shape);
        for (int k = 0; k < 3; k++) {
            uint32_t other =
                brio_next_round_edge(x->labels, facet, corner_of(x, facet, k), corner_of(x, facet, (k + 1) % 3));
            if (is_face(x, other)) continue;
            set_face(x, other);
            x->gap[x->gap_size++] = other;
        }
    }
    return is_lapse(&shape);
}

/* Fills the gaps that are no openings, or all that are finite; the samples of the others are to be looked at. */
static brio_status choose_fillings(extraction *x, bool all) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_ALLOC(x->ctx, x->gap, x->num_gaps));
    fill_small_facets(x, all);
    x->gap_size = 0;
    for (size_t n = 0; n < x->num_boundary; n++)
        if (is_face_at_gap(x, x->boundary[n])) measure_edges(x, x->boundary[n]);
    for (size_t n = 0; n < x->num_boundary; n++) {
        size_t begin = x->gap_size;
        if (!is_face(x, x->boundary[n]) && collect_lapse(x, x->boundary[n])) x->gap_size = begin;
    }
    for (size_t n = 0; n < x->gap_size; n++) clear_face(x, x->gap[n]);
    for (size_t n = 0; n < x->gap_size; n++) BRIO_TRY(push_corners(x, x->gap[n]));
done:
    return status;
}

/* --- one fan a sample --- */

/* A fan of faces: its first face, counterclockwise, and the number of faces. */
typedef struct {
    uint32_t first;
    size_t length;
} fan;

/* Whether a fan is to be kept rather than another: the longer one, ties by the position where it begins. */
static bool is_better(const extraction *x, uint32_t v, fan a, fan b) {
    const double *points = x->labels->cocones->dual->points;
    if (a.length != b.length) return a.length > b.length;
    return brio_lexicographic(points + 3 * (size_t)brio_corner_after(x->t, a.first, v),
                              points + 3 * (size_t)brio_corner_after(x->t, b.first, v)) > 0;
}

/* Counts the fans of faces at v that end somewhere and finds the best of them. */
static size_t count_fans(const extraction *x, uint32_t v, fan *best) {
    uint32_t start = x->facet_of[v];
    size_t fans = 0;
    while (is_face(x, start)) { /* to a gap, so that no fan is met in two parts */
        start = brio_next_round_vertex(x->labels, start, v);
        if (start == x->facet_of[v]) return 0;
    }
    fan now = {0};
    uint32_t facet = start;
    do {
        facet = brio_next_round_vertex(x->labels, facet, v);
        if (is_face(x, facet)) {
            if (now.length++ == 0) now.first = facet;
        } else if (now.length > 0) {
            if (fans++ == 0 || is_better(x, v, now, *best)) *best = now;
            now.length = 0;
        }
    } while (facet != start);
    return fans;
}

/* Drops the faces at v but for one fan. */
static brio_status keep_fan(extraction *x, uint32_t v, fan kept) {
    brio_status status = BRIO_OK;
    uint32_t facet = kept.first;
    for (size_t n = 0; n == 0 || facet != kept.first; n++) {
        if (n >= kept.length && is_face(x, facet)) {
            clear_face(x, facet);
            BRIO_TRY(push_corners(x, facet));
        }
        facet = brio_next_round_vertex(x->labels, facet, v);
    }
done:
    return status;
}

/* Works in rounds, each in the order of positions, so that the order of the samples is of no importance. */
static brio_status drop_small_fans(extraction *x) {
    brio_status status = BRIO_OK;
    fan best = {0};
    for (size_t begin = 0, end; begin < x->size; begin = end) {
        end = x->size;
        brio_sort_by_position(x->labels->cocones->dual->points, x->queue + begin, end - begin);
        for (size_t n = begin; n < end; n++) {
            uint32_t v = x->queue[n];
            if (count_fans(x, v, &best) > 1) BRIO_TRY(keep_fan(x, v, best));
        }
    }
done:
    return status;
}

static brio_status write_faces(extraction *x, uint32_t **faces, size_t *num_faces) {
    brio_status status = BRIO_OK;
    size_t count = 0;
    for (size_t n = 0; n < x->num_boundary; n++)
        if (is_face(x, x->boundary[n])) x->boundary[count++] = x->boundary[n];
    BRIO_TRY(BRIO_ALLOC(x->ctx, *faces, 3 * count));
    *num_faces = count;
    for (size_t n = 0; n < count; n++)
        for (int k = 0; k < 3; k++) (*faces)[3 * n + (size_t)k] = corner_of(x, x->boundary[n], k);
done:
    return status;
}

brio_status brio_extract_faces(brio_context *ctx, const brio_tet_labels *l, bool candidates_only, uint32_t *facets,
                               size_t num_facets, uint32_t **faces, size_t *num_faces) {
    brio_status status = BRIO_OK;
    extraction x = {.ctx = ctx, .labels = l, .t = &l->cocones->dual->t, .boundary = facets, .num_boundary = num_facets};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, x.face, x.t->count));
    choose_candidates(&x);
    if (x.num_gaps > 0 || l->cocones->boundary) {
        BRIO_TRY(measure_gaps(&x));
        suspect_long_candidates(&x);
        BRIO_TRY(choose_fillings(&x, !candidates_only));
        BRIO_TRY(drop_small_fans(&x));
    }
    BRIO_TRY(write_faces(&x, faces, num_faces));
done:
    brio_release(ctx, x.face);
    brio_release(ctx, x.at_gap);
    brio_release(ctx, x.facet_of);
    brio_release(ctx, x.size_at);
    brio_release(ctx, x.shortest);
    brio_release(ctx, x.edge_sum);
    brio_release(ctx, x.edges);
    brio_release(ctx, x.gap);
    brio_release(ctx, x.queue);
    return status;
}
