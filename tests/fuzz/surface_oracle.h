/* What the polygons of a small mesh are as a surface, found anew: it shares no code with the library. */
#ifndef BRIO_TESTS_SURFACE_ORACLE_H
#define BRIO_TESTS_SURFACE_ORACLE_H

#include "fuzz.h"

typedef struct {
    bool closed, manifold, oriented;
    size_t components;
    int64_t euler; /* vertices that faces use - edges + faces */
} surface_facts;

typedef struct {
    uint32_t low, high;
    bool forward; /* whether the face runs from low to high */
    size_t face;
} oracle_side;

static inline int compare_sides(const void *a, const void *b) {
    const oracle_side *s = a, *t = b;
    if (s->low != t->low) return s->low < t->low ? -1 : 1;
    return (s->high > t->high) - (s->high < t->high);
}

static inline size_t oracle_root(size_t *parent, size_t i) {
    while (parent[i] != i) i = parent[i] = parent[parent[i]];
    return i;
}

static inline void oracle_join(size_t *parent, size_t i, size_t j) {
    parent[oracle_root(parent, i)] = oracle_root(parent, j);
}

static inline size_t oracle_sets(size_t *parent, size_t n) {
    size_t sets = 0;
    for (size_t i = 0; i < n; i++) sets += oracle_root(parent, i) == i;
    return sets;
}

static inline size_t *oracle_singles(size_t n) {
    size_t *parent = malloc((n + 1) * sizeof *parent);
    for (size_t i = 0; i < n; i++) parent[i] = i;
    return parent;
}

/* The corner of a face at a vertex. */
static inline size_t corner_at(const brio_mesh *m, size_t face, uint32_t vertex) {
    size_t c = m->face_offsets[face];
    while (m->face_vertices[c] != vertex) c++;
    return c;
}

/* Whether the faces at each vertex are one fan: corners at a vertex are joined across the edges there. */
static inline bool has_one_fan_each(const brio_mesh *m, const oracle_side *side, size_t corners, size_t used) {
    size_t *fan = oracle_singles(corners);
    for (size_t i = 0; i + 1 < corners; i++) {
        if (compare_sides(&side[i], &side[i + 1])) continue;
        for (int end = 0; end < 2; end++) {
            uint32_t v = end ? side[i].high : side[i].low;
            oracle_join(fan, corner_at(m, side[i].face, v), corner_at(m, side[i + 1].face, v));
        }
    }
    bool one = oracle_sets(fan, corners) == used;
    free(fan);
    return one;
}

static inline size_t count_used(const brio_mesh *m) {
    size_t used = 0;
    bool *seen = calloc(m->num_vertices + 1, 1);
    for (size_t i = 0; m->num_faces && i < m->face_offsets[m->num_faces]; i++) {
        used += !seen[m->face_vertices[i]];
        seen[m->face_vertices[i]] = true;
    }
    free(seen);
    return used;
}

/** Judges polygons none of which has a vertex twice. */
static inline surface_facts judge_surface(const brio_mesh *m) {
    size_t corners = m->num_faces ? m->face_offsets[m->num_faces] : 0, edges = 0, used = count_used(m);
    oracle_side *side = malloc((corners + 1) * sizeof *side);
    size_t *part = oracle_singles(m->num_faces);
    surface_facts f = {.closed = m->num_faces > 0, .manifold = true, .oriented = true};
    for (size_t t = 0, n = 0; t < m->num_faces; t++)
        for (uint64_t c = m->face_offsets[t]; c < m->face_offsets[t + 1]; c++, n++) {
            uint64_t next = c + 1 < m->face_offsets[t + 1] ? c + 1 : m->face_offsets[t];
            uint32_t a = m->face_vertices[c], b = m->face_vertices[next];
            side[n] = (oracle_side){a < b ? a : b, a < b ? b : a, a < b, t};
        }
    qsort(side, corners, sizeof *side, compare_sides);
    for (size_t i = 0, same; i < corners; i += same, edges++) {
        for (same = 1; i + same < corners && !compare_sides(&side[i], &side[i + same]); same++)
            oracle_join(part, side[i].face, side[i + same].face);
        if (same != 2) f.closed = false;
        if (same > 2) f.manifold = false;
        if (same == 2 && side[i].forward == side[i + 1].forward) f.oriented = false;
    }
    if (f.manifold) f.manifold = has_one_fan_each(m, side, corners, used);
    f.components = oracle_sets(part, m->num_faces);
    f.euler = (int64_t)used - (int64_t)edges + (int64_t)m->num_faces;
    free(part);
    free(side);
    return f;
}

/** Whether the library's certificate says the same, where both say something. */
static inline surface_facts expect_certificate(brio_context *ctx, const brio_mesh *m) {
    surface_facts f = judge_surface(m);
    brio_certificate c = {0};
    FUZZ_EXPECT(brio_mesh_certificate(ctx, m, &c) == BRIO_OK, "%s", brio_message(ctx));
    FUZZ_EXPECT(c.closed == f.closed && c.manifold == f.manifold, "closed %d %d manifold %d %d", c.closed, f.closed,
                c.manifold, f.manifold);
    FUZZ_EXPECT(!f.manifold || c.oriented == f.oriented, "oriented %d %d", c.oriented, f.oriented);
    FUZZ_EXPECT(c.components == f.components, "components %zu %zu", c.components, f.components);
    if (f.closed && f.manifold && f.oriented)
        FUZZ_EXPECT(2 * (int64_t)f.components - f.euler == 2 * c.genus, "euler %lld genus %lld", (long long)f.euler,
                    (long long)c.genus);
    brio_certificate_free(&c);
    return f;
}

/** A surface that is promised to be manifold and oriented, and maybe closed. */
static inline void expect_surface(brio_context *ctx, const brio_mesh *m, bool closed, const char *what) {
    fuzz_expect_sound(m);
    surface_facts f = expect_certificate(ctx, m);
    FUZZ_EXPECT(f.manifold && f.oriented && (f.closed || !closed), "%s: closed %d manifold %d oriented %d", what,
                f.closed, f.manifold, f.oriented);
}

#endif
