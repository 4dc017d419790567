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
#include "reconstruct/label_boundary.h"
#include "reconstruct/triangle.h"

/* A facet of the boundary that is no candidate fills a small hole when its circle is at most this many times as large
 * as the largest one of a candidate at its corners. From 1.5 on the closed models of the tests come out closed. */
static const double FILLING = 1.5;

typedef struct {
    brio_context *ctx;
    const brio_tet_labels *labels;
    const brio_tetrahedra *t;
    uint8_t *face;      /* of each outer tetrahedron: bit i tells whether facet i is a face */
    uint32_t *facet_of; /* of each sample: a boundary facet seen from outside; BRIO_INFINITE for none */
    uint32_t *queue;    /* samples to look at */
    size_t size, capacity;
    double *size_at; /* of each sample: squared radius of the largest circle round a candidate there */
} extraction;

static bool is_face(const extraction *x, uint32_t facet) {
    return x->face[brio_tet_of(facet)] >> brio_slot_of(facet) & 1;
}

static double circle_square(const extraction *x, uint32_t facet) {
    const uint32_t *v = x->t->tet[brio_tet_of(facet)].vertex;
    const double *corner[3];
    for (int k = 0; k < 3; k++)
        corner[k] = x->labels->cocones->dual->points + 3 * (size_t)v[BRIO_FACET[brio_slot_of(facet)][k]];
    return brio_circle_square(corner[0], corner[1], corner[2]);
}

static bool is_finite(const extraction *x, uint32_t facet) {
    return brio_slot_of(facet) == 3 || x->t->tet[brio_tet_of(facet)].vertex[3] != BRIO_INFINITE;
}

/* Finds the boundary: a facet of each sample, the candidates as faces, and how large these are. */
static void choose_candidates(extraction *x) {
    for (size_t tet = 0; tet < x->t->count; tet++)
        for (int i = 0; i < 4 && x->labels->label[tet] == BRIO_LABEL_OUTER; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i);
            const uint32_t *v = x->t->tet[tet].vertex;
            if (!brio_is_boundary(x->labels, facet)) continue;
            bool candidate = brio_is_candidate(x->labels->cocones, facet);
            double size = candidate ? circle_square(x, facet) : 0;
            if (candidate) x->face[tet] |= (uint8_t)(1 << i);
            for (int k = 0; k < 3; k++) {
                uint32_t p = v[BRIO_FACET[i][k]];
                if (p == BRIO_INFINITE) continue;
                x->facet_of[p] = facet;
                x->size_at[p] = fmax(x->size_at[p], size);
            }
        }
}

/* Whether a facet of the boundary that is no candidate is as small as the candidates around it. */
static bool fills_small_hole(const extraction *x, uint32_t facet) {
    const uint32_t *v = x->t->tet[brio_tet_of(facet)].vertex;
    double size = 0;
    for (int k = 0; k < 3; k++) size = fmax(size, x->size_at[v[BRIO_FACET[brio_slot_of(facet)][k]]]);
    return circle_square(x, facet) <= FILLING * FILLING * size;
}

static brio_status push(extraction *x, uint32_t v) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(x->ctx, x->queue, x->capacity, x->size + 1));
    x->queue[x->size++] = v;
done:
    return status;
}

/* Adds the facets of the boundary that fill holes; the samples of the others are to be looked at. */
static brio_status choose_fillings(extraction *x, bool all) {
    brio_status status = BRIO_OK;
    for (size_t tet = 0; tet < x->t->count; tet++)
        for (int i = 0; i < 4 && x->labels->label[tet] == BRIO_LABEL_OUTER; i++) {
            uint32_t facet = brio_facet_of((uint32_t)tet, i);
            const uint32_t *v = x->t->tet[tet].vertex;
            if (is_face(x, facet) || !brio_is_boundary(x->labels, facet)) continue;
            if (is_finite(x, facet) && (all || fills_small_hole(x, facet))) {
                x->face[tet] |= (uint8_t)(1 << i);
                continue;
            }
            for (int k = 0; k < 3; k++)
                if (v[BRIO_FACET[i][k]] != BRIO_INFINITE) BRIO_TRY(push(x, v[BRIO_FACET[i][k]]));
        }
done:
    return status;
}

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
            const uint32_t *corner = x->t->tet[brio_tet_of(facet)].vertex;
            x->face[brio_tet_of(facet)] &= (uint8_t) ~(1 << brio_slot_of(facet));
            for (int k = 0; k < 3; k++) BRIO_TRY(push(x, corner[BRIO_FACET[brio_slot_of(facet)][k]]));
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

static brio_status write_faces(extraction *x, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    size_t count = 0;
    for (size_t tet = 0; tet < x->t->count; tet++) count += (size_t)__builtin_popcount(x->face[tet]);
    BRIO_TRY(BRIO_ALLOC(x->ctx, mesh->face_offsets, count + 1));
    BRIO_TRY(BRIO_ALLOC(x->ctx, mesh->face_vertices, 3 * count));
    uint32_t *corner = mesh->face_vertices;
    for (size_t tet = 0; tet < x->t->count; tet++)
        for (int i = 0; i < 4; i++)
            for (int k = 0; k < 3 && x->face[tet] >> i & 1; k++) *corner++ = x->t->tet[tet].vertex[BRIO_FACET[i][k]];
    for (size_t f = 0; f <= count; f++) mesh->face_offsets[f] = 3 * f;
    mesh->num_faces = count;
done:
    return status;
}

brio_status brio_extract_faces(brio_context *ctx, const brio_tet_labels *l, bool candidates_only, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    size_t n = l->cocones->dual->num_points;
    extraction x = {.ctx = ctx, .labels = l, .t = &l->cocones->dual->t};
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, x.face, x.t->count));
    BRIO_TRY(BRIO_ALLOC(ctx, x.facet_of, n));
    for (size_t v = 0; v < n; v++) x.facet_of[v] = BRIO_INFINITE;
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, x.size_at, n));
    choose_candidates(&x);
    BRIO_TRY(choose_fillings(&x, !candidates_only));
    BRIO_TRY(drop_small_fans(&x));
    BRIO_TRY(write_faces(&x, mesh));
done:
    brio_release(ctx, x.face);
    brio_release(ctx, x.facet_of);
    brio_release(ctx, x.size_at);
    brio_release(ctx, x.queue);
    return status;
}
