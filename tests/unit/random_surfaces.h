/* Random closed surfaces of known genus, of every kind that connectivity allows: bent chains of tori and spheres with
 * handles glued on anywhere, their edges flipped and their vertices shaken, so that degrees are of every size,
 * triangles are long and run through each other, and few of them are Delaunay. */
#ifndef BRIO_TESTS_RANDOM_SURFACES_H
#define BRIO_TESTS_RANDOM_SURFACES_H

#include "mesh/twins.h"
#include "surfaces.h"
#include <string.h>

enum { RANDOM_SURFACES = 200, MOST_GENUS = 6 };

/* A closed surface in work. */
typedef struct {
    uint32_t *v, *twin;
    size_t num_faces;
} closed_surface;

/* Whether vertices c and d have an edge; c is the vertex of corner h. */
static inline bool has_edge(const closed_surface *s, uint32_t h, uint32_t d) {
    uint32_t at = h;
    do {
        if (s->v[brio_next_corner(at)] == d) return true;
        at = s->twin[brio_previous_corner(at)];
    } while (at != h);
    return false;
}

/* Turns the edge of half-edge h in the quadrilateral of its two triangles, unless the other diagonal is an edge. */
static inline void flip_edge(closed_surface *s, uint32_t h) {
    uint32_t t = s->twin[h], h_next = brio_next_corner(h), t_next = brio_next_corner(t);
    uint32_t c = s->v[brio_previous_corner(h)], d = s->v[brio_previous_corner(t)];
    if (c == d || has_edge(s, brio_previous_corner(h), d)) return;
    uint32_t beside_h = s->twin[t_next], beside_t = s->twin[h_next];
    s->v[h_next] = d;
    s->v[t_next] = c;
    s->twin[h] = beside_h, s->twin[beside_h] = h;
    s->twin[t] = beside_t, s->twin[beside_t] = t;
    s->twin[h_next] = t_next, s->twin[t_next] = h_next;
}

/* Whether two triangles share no vertex and no edge runs between them. */
static inline bool far_apart(const closed_surface *s, uint32_t f, uint32_t g) {
    for (uint32_t i = 0; i < 9; i++) {
        uint32_t h = 3 * f + i / 3, d = s->v[3 * g + i % 3];
        if (s->v[h] == d || has_edge(s, h, d)) return false;
    }
    return true;
}

static inline void link_twins(brio_context *ctx, const brio_mesh *mesh, closed_surface *s) {
    brio_release(ctx, s->twin);
    EXPECT(brio_mesh_twins(ctx, mesh, &s->twin) == BRIO_OK, "%s", brio_message(ctx));
}

/* Joins two triangles far apart by a tube of six: the genus grows by one. */
static inline brio_mesh *with_handle(brio_context *ctx, brio_mesh *mesh, brio_rng *rng) {
    closed_surface s = {.v = mesh->face_vertices, .num_faces = mesh->num_faces};
    uint32_t f, g, faces = (uint32_t)mesh->num_faces;
    link_twins(ctx, mesh, &s);
    do {
        f = brio_rng_below(rng, faces);
        g = brio_rng_below(rng, faces);
    } while (!far_apart(&s, f, g));
    uint32_t *v = malloc(3 * (mesh->num_faces + 4) * sizeof *v), tube[6][3];
    memcpy(v, s.v, 3 * mesh->num_faces * sizeof *v);
    for (uint32_t i = 0; i < 3; i++) {
        uint32_t a = v[3 * f + i], b = v[3 * f + (i + 1) % 3];
        uint32_t c = v[3 * g + (5 - i) % 3], d = v[3 * g + (3 - i) % 3];
        tube[2 * i][0] = a, tube[2 * i][1] = b, tube[2 * i][2] = c;
        tube[2 * i + 1][0] = a, tube[2 * i + 1][1] = c, tube[2 * i + 1][2] = d;
    }
    memcpy(v + 3 * (size_t)f, tube[0], sizeof tube[0]);
    memcpy(v + 3 * (size_t)g, tube[1], sizeof tube[1]);
    memcpy(v + 3 * (size_t)faces, tube[2], 4 * sizeof tube[2]);
    brio_mesh *joined = triangle_mesh(ctx, mesh->vertices, mesh->num_vertices, v, mesh->num_faces + 4);
    free(v);
    brio_release(ctx, s.twin);
    brio_mesh_free(mesh);
    return joined;
}

static inline void flip_edges(brio_context *ctx, brio_mesh *mesh, uint32_t flips, brio_rng *rng) {
    closed_surface s = {.v = mesh->face_vertices, .num_faces = mesh->num_faces};
    link_twins(ctx, mesh, &s);
    while (flips-- > 0) flip_edge(&s, brio_rng_below(rng, (uint32_t)(3 * mesh->num_faces)));
    brio_release(ctx, s.twin);
}

static inline int genus_of_random_mesh(uint64_t seed) {
    return (int)(seed % (MOST_GENUS + 1));
}

/* Surface `seed` of RANDOM_SURFACES and more: every other one is a sphere with handles, else a chain of one or two tori
 * with what handles the genus wants; of each kind every other one has flips, of these every other one is shaken. */
static inline brio_mesh *random_mesh(brio_context *ctx, uint64_t seed) {
    brio_rng rng = brio_rng_new(seed);
    int genus = genus_of_random_mesh(seed), most = genus < 2 ? genus : 1 + (int)brio_rng_below(&rng, 2);
    uint64_t kind = seed / (MOST_GENUS + 1);
    bool flips = kind & 2, shaken = kind & 4;
    int tori = kind & 1 ? 0 : most;
    brio_mesh *mesh = random_surface(ctx, tori, tori ? 0.25 : 0.5, seed);
    for (int i = tori; i < genus; i++) mesh = with_handle(ctx, mesh, &rng);
    if (flips) flip_edges(ctx, mesh, 1 + brio_rng_below(&rng, (uint32_t)(4 * mesh->num_faces)), &rng);
    for (size_t i = 0; shaken && i < 3 * mesh->num_vertices; i++) mesh->vertices[i] += 0.1 * brio_rng_double(&rng);
    return mesh;
}

#endif
