/* Gaps in a surface: some are openings of the surface, others are places where no candidate was found.
 *
 * The candidates among the boundary facets leave gaps. First, a single facet is filled if it is about as small as the
 * candidates around it. Then each remaining gap is measured as a whole. A gap without room for one more sample is a
 * lapse and is filled, because samples could not show an opening of that size. Only the surroundings of gaps are
 * measured.
 *
 * Lengths and areas are rounded to multiples of one power of two before they are added, so that their sums do not
 * depend on the order of the facets. */
#include "reconstruct/cocone/surface_gaps.h"
#include "base/memory.h"
#include "base/vector.h"
#include "reconstruct/cocone/triangle.h"

/* A facet that is no candidate is filled if its circle is at most FILLING times as large as the largest circle of a
 * candidate at its corners. From 1.5 on, the closed models of the tests come out closed. */
static const double FILLING = 1.5;

/* A gap is a lapse under two conditions. No edge is over LONG times the mean edge of the faces at its corners. Its area
 * is at most DISC times the square of that mean: then it has no room for a disc with a radius of one mean edge, where a
 * surface would have a sample. Measured: the remaining opening of the club has an edge of 3.4 times the mean. Of the
 * 258 gaps of ten raw scans of the bunny 241 are lapses, and none of the four with over ten edges is. */
static const double LONG = 2.5, DISC = 3.141592653589793;

/* Among boundary samples, a triangle longer than SUSPECT times the shortest ones around it may span an opening.
 * Connected triangles of this kind are an opening if one of them is longer than OPENING times the shortest ones, and if
 * they have room for MISSING samples. At sharp edges, where samples are too few as well, there is no such room.
 * Measured on the club: 16 samples at the opening, 4 at the largest sharp edge. */
static const double SUSPECT = 1.5, OPENING = 4, MISSING = 8;

/* Adding this to a length of at most 4 and subtracting it rounds the length to a multiple of 2^-40. */
static const double ROUND_LENGTH = 0x1.8p12;

/* What has been measured at a sample of a gap. */
typedef enum { NOT_MEASURED, CANDIDATES_MEASURED, FACES_MEASURED } measured;

typedef struct {
    const brio_face_choice *choice;
    const brio_tet_labels *labels; /* of the choice */
    const double *points;
    uint8_t *measured; /* #P, a `measured` each */
    double *size;      /* #P: squared radius of the largest circle of a candidate at the sample; 0 without candidates */
    double *shortest;  /* #P: least length_square of a candidate at the sample; infinite without candidates */
    double *edges;     /* #P: sum of the lengths of the edges at the sample, counted once for each face */
    uint32_t *degree;  /* #P: number of the lengths in that sum */
    uint32_t *facet;   /* the boundary facets that are no faces, ascending */
    size_t num_facets;
    uint32_t *open; /* facets of the gaps that stay open */
    size_t num_open;
} gaps;

/* --- sizes --- */

static const double *corner_point(const gaps *g, uint32_t facet, int k) {
    return g->points + 3 * (size_t)brio_corner_of(g->choice, facet, k);
}

static double circle_square(const gaps *g, uint32_t facet) {
    return brio_circle_square(corner_point(g, facet, 0), corner_point(g, facet, 1), corner_point(g, facet, 2));
}

/* Returns the squared length of the longest edge. */
static double length_square(const gaps *g, uint32_t facet) {
    double square[3];
    brio_cross_square(corner_point(g, facet, 0), corner_point(g, facet, 1), corner_point(g, facet, 2), square);
    return fmax(fmax(square[0], square[1]), square[2]);
}

static double area(const gaps *g, uint32_t facet) {
    return brio_triangle_area(corner_point(g, facet, 0), corner_point(g, facet, 1), corner_point(g, facet, 2));
}

static bool is_finite(const gaps *g, uint32_t facet) {
    const brio_tetrahedron *tet = g->choice->dual->t.tet;
    return brio_slot_of(facet) == 3 || tet[brio_tet_of(facet)].vertex[3] != BRIO_INFINITE;
}

static bool is_among_boundary(const gaps *g, uint32_t facet) {
    return brio_is_among_boundary(g->choice->cocones, facet);
}

/* --- the surroundings of gaps --- */

/* Measures the candidates at sample p, a corner of facet `first`. */
static void measure_candidates(gaps *g, uint32_t p, uint32_t first) {
    uint32_t facet = first;
    if (p == BRIO_INFINITE || g->measured[p] != NOT_MEASURED) return;
    g->measured[p] = CANDIDATES_MEASURED;
    g->size[p] = 0, g->shortest[p] = INFINITY;
    do {
        if (brio_is_face(g->choice, facet)) {
            g->size[p] = fmax(g->size[p], circle_square(g, facet));
            g->shortest[p] = fmin(g->shortest[p], length_square(g, facet));
        }
        facet = brio_next_round_vertex(g->labels, facet, p);
    } while (facet != first);
}

/* Measures the edges of the faces at sample p, a corner of facet `first`. */
static void measure_faces(gaps *g, uint32_t p, uint32_t first) {
    uint32_t facet = first;
    if (g->measured[p] == FACES_MEASURED) return;
    g->measured[p] = FACES_MEASURED;
    g->edges[p] = 0, g->degree[p] = 0;
    do {
        for (int k = 0; k < 3 && brio_is_face(g->choice, facet); k++) {
            uint32_t q = brio_corner_of(g->choice, facet, k);
            if (q == p) continue;
            double length = sqrt(brio_square_distance(g->points + 3 * (size_t)p, g->points + 3 * (size_t)q));
            g->edges[p] += (length + ROUND_LENGTH) - ROUND_LENGTH;
            g->degree[p]++;
        }
        facet = brio_next_round_vertex(g->labels, facet, p);
    } while (facet != first);
}

/* Measures the candidates at all samples of gaps and at all boundary samples. Entries of other samples are neither
 * written nor read. */
static brio_status measure_gaps(brio_context *ctx, gaps *g) {
    brio_status status = BRIO_OK;
    const brio_face_choice *c = g->choice;
    const uint8_t *boundary = c->cocones->boundary;
    size_t num_points = c->dual->num_points;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, g->measured, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, g->size, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, g->shortest, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, g->edges, num_points));
    BRIO_TRY(BRIO_ALLOC(ctx, g->degree, num_points));
    for (size_t n = 0; n < g->num_facets; n++)
        for (int k = 0; k < 3; k++) measure_candidates(g, brio_corner_of(c, g->facet[n], k), g->facet[n]);
    for (size_t n = 0; n < c->num_facets && boundary; n++)
        for (int k = 0; k < 3; k++) {
            uint32_t p = brio_corner_of(c, c->facets[n], k);
            if (p != BRIO_INFINITE && boundary[p]) measure_candidates(g, p, c->facets[n]);
        }
done:
    return status;
}

/* --- openings among boundary samples --- */

/* Returns the squared spacing of a facet's samples: the largest of their entries in `shortest`. */
static double spacing_square(const gaps *g, uint32_t facet) {
    double most = 0;
    for (int k = 0; k < 3; k++) {
        uint32_t p = brio_corner_of(g->choice, facet, k);
        if (p != BRIO_INFINITE && g->shortest[p] > most && g->shortest[p] < INFINITY) most = g->shortest[p];
    }
    return most;
}

/* Returns whether the length of a boundary facet exceeds `times` times the spacing of its samples. */
static bool is_longer(const gaps *g, uint32_t facet, double times) {
    return length_square(g, facet) > times * times * spacing_square(g, facet);
}

/* Removes from the faces the candidates among boundary samples that are longer than those around them. They may span an
 * opening; collect_opening decides. */
static void suspect_long_candidates(const gaps *g) {
    const brio_face_choice *c = g->choice;
    for (size_t n = 0; n < c->num_facets; n++) {
        uint32_t facet = c->facets[n];
        if (brio_is_face(c, facet) && is_among_boundary(g, facet) && is_longer(g, facet, SUSPECT))
            brio_clear_face(c, facet);
    }
}

/* Finds the gap among boundary samples that contains facet `first`, across edges of the boundary. Appends its facets to
 * g->open and marks them as faces for now. Returns whether the gap is an opening. */
static bool collect_opening(gaps *g, uint32_t first) {
    bool is_long = false;
    double missing = 0; /* samples of the local spacing that the gap has room for */
    size_t next = g->num_open;
    g->open[g->num_open++] = first;
    brio_set_face(g->choice, first);
    for (; next < g->num_open; next++) {
        uint32_t facet = g->open[next];
        bool finite = is_finite(g, facet);
        missing += finite ? area(g, facet) / spacing_square(g, facet) : INFINITY;
        is_long = is_long || !finite || is_longer(g, facet, OPENING);
        for (int k = 0; k < 3; k++) {
            uint32_t a = brio_corner_of(g->choice, facet, k), b = brio_corner_of(g->choice, facet, (k + 1) % 3);
            uint32_t other = brio_next_round_edge(g->labels, facet, a, b);
            if (brio_is_face(g->choice, other) || !is_among_boundary(g, other)) continue;
            brio_set_face(g->choice, other);
            g->open[g->num_open++] = other;
        }
    }
    return is_long && missing > MISSING;
}

/* --- single facets --- */

/* Returns whether a boundary facet that is no candidate is as small as the candidates around it. */
static bool is_small(const gaps *g, uint32_t facet) {
    double size = 0;
    for (int k = 0; k < 3; k++) size = fmax(size, g->size[brio_corner_of(g->choice, facet, k)]);
    return circle_square(g, facet) <= FILLING * FILLING * size;
}

/* Fills the facets that are as small as the candidates around them or, with `all`, all finite facets. Fills the gaps
 * among boundary samples that are no openings. */
static void fill_facets(gaps *g, bool all) {
    const brio_face_choice *c = g->choice;
    for (size_t n = 0; n < g->num_facets; n++) {
        uint32_t facet = g->facet[n];
        size_t begin = g->num_open;
        if (brio_is_face(c, facet)) continue;
        if (is_finite(g, facet) && (all || (!is_among_boundary(g, facet) && is_small(g, facet))))
            brio_set_face(c, facet);
        else if (is_among_boundary(g, facet) && !collect_opening(g, facet))
            g->num_open = begin;
    }
    for (size_t n = 0; n < g->num_open; n++) brio_clear_face(c, g->open[n]);
    g->num_open = 0;
}

/* --- whole gaps --- */

/* Returns whether all facets of a gap are finite and have a sample that is no boundary sample.   longest  receives the
 * longest edge. */
static bool is_between_samples(const gaps *g, const uint32_t *facets, size_t count, double *longest) {
    double most = 0;
    for (size_t n = 0; n < count; n++) {
        if (!is_finite(g, facets[n]) || is_among_boundary(g, facets[n])) return false;
        most = fmax(most, length_square(g, facets[n]));
    }
    *longest = sqrt(most);
    return true;
}

/* Returns whether a gap, whose facets are no faces, is a lapse. */
static bool is_lapse(gaps *g, const uint32_t *facets, size_t count) {
    double longest, edges = 0, room = 0;
    uint64_t degree = 0;
    int exponent;
    if (!is_between_samples(g, facets, count, &longest)) return false;
    frexp(longest, &exponent);
    double round = ldexp(0x1.8p16, 2 * exponent); /* rounds to multiples of 2^-36 of the square of the longest edge */
    for (size_t n = 0; n < count; n++) {
        room += (area(g, facets[n]) + round) - round;
        for (int k = 0; k < 3; k++) {
            uint32_t p = brio_corner_of(g->choice, facets[n], k);
            measure_faces(g, p, facets[n]);
            edges += g->edges[p], degree += g->degree[p];
        }
    }
    double spacing = degree > 0 ? edges / (double)degree : 0;
    return longest <= LONG * spacing && room <= DISC * spacing * spacing;
}

/* Finds the gap that contains facet `first`, across edges of the boundary. Appends its facets to g->open and marks them
 * as faces for now. */
static void collect_gap(gaps *g, uint32_t first) {
    size_t next = g->num_open;
    g->open[g->num_open++] = first;
    brio_set_face(g->choice, first);
    for (; next < g->num_open; next++)
        for (int k = 0; k < 3; k++) {
            uint32_t facet = g->open[next], a = brio_corner_of(g->choice, facet, k);
            uint32_t b = brio_corner_of(g->choice, facet, (k + 1) % 3);
            uint32_t other = brio_next_round_edge(g->labels, facet, a, b);
            if (brio_is_face(g->choice, other)) continue;
            brio_set_face(g->choice, other);
            g->open[g->num_open++] = other;
        }
}

/* A gap: the index in g->open where its facets end. */
typedef struct {
    size_t end;
    bool lapse;
} gap;

/* Fills the gaps that are lapses, and leaves the others in g->open. Measures all gaps before it fills any, so that no
 * gap counts as faces beside another. */
static brio_status fill_lapses(brio_context *ctx, gaps *g) {
    brio_status status = BRIO_OK;
    const brio_face_choice *c = g->choice;
    gap *list = NULL;
    size_t count = 0, capacity = 0, left = 0;
    for (size_t n = 0; n < g->num_facets; n++) {
        if (brio_is_face(c, g->facet[n])) continue;
        collect_gap(g, g->facet[n]);
        BRIO_TRY(BRIO_RESERVE(ctx, list, capacity, count + 1));
        list[count++] = (gap){.end = g->num_open};
    }
    for (size_t n = 0; n < g->num_open; n++) brio_clear_face(c, g->open[n]);
    for (size_t i = 0, begin = 0; i < count; begin = list[i++].end)
        list[i].lapse = is_lapse(g, g->open + begin, list[i].end - begin);
    for (size_t i = 0, n = 0; i < count; i++)
        for (; n < list[i].end; n++) {
            if (list[i].lapse)
                brio_set_face(c, g->open[n]);
            else
                g->open[left++] = g->open[n];
        }
    g->num_open = left;
done:
    brio_release(ctx, list);
    return status;
}

/* Lists the boundary facets that are no faces. */
static brio_status list_facets(brio_context *ctx, gaps *g) {
    brio_status status = BRIO_OK;
    const brio_face_choice *c = g->choice;
    size_t count = 0;
    for (size_t n = 0; n < c->num_facets; n++) count += !brio_is_face(c, c->facets[n]);
    brio_release(ctx, g->facet);
    g->num_facets = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, g->facet, count));
    for (size_t n = 0; g->num_facets < count; n++)
        if (!brio_is_face(c, c->facets[n])) g->facet[g->num_facets++] = c->facets[n];
done:
    return status;
}

brio_status brio_fill_gaps(brio_context *ctx, const brio_face_choice *c, bool all, uint32_t **open, size_t *num_open) {
    brio_status status = BRIO_OK;
    gaps g = {.choice = c, .labels = c->labels, .points = c->dual->points};
    *open = NULL;
    *num_open = 0;
    BRIO_TRY(list_facets(ctx, &g));
    if (g.num_facets == 0 && !c->cocones->boundary) goto done;
    BRIO_TRY(measure_gaps(ctx, &g));
    if (c->cocones->boundary) {
        suspect_long_candidates(&g);
        BRIO_TRY(list_facets(ctx, &g));
    }
    BRIO_TRY(BRIO_ALLOC(ctx, g.open, g.num_facets));
    fill_facets(&g, all);
    BRIO_TRY(fill_lapses(ctx, &g));
done:
    brio_release(ctx, g.facet);
    brio_release(ctx, g.measured);
    brio_release(ctx, g.size);
    brio_release(ctx, g.shortest);
    brio_release(ctx, g.edges);
    brio_release(ctx, g.degree);
    *open = g.open;
    *num_open = g.num_open;
    return status;
}
