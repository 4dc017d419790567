// brio's side of the cross-check: sets.hpp says what goes in and out.
//   delaunay   simplices of the affine hull's dimension: of the Delaunay or, with weights, the regular triangulation
//   filtration simplices of every dimension with their alpha values
//   shape      at alpha = the parameter: rows (kind, vertices) of solid tetrahedra (0), regular (1) and singular facets (2)
//   hull       vertices; facts: volume, area, facets
//   cells      in the box [0, 1]^3: rows (site, neighbour) with areas; (site, none) with volumes; walls are -1 to -6
#include "brio/brio.h"
#include "sets.hpp"
#include <algorithm>
#include <array>
#include <map>

using sets::Result;
using sets::Set;

static brio_context *ctx;

static const double *weights_of(const Set &s) { return s.weighted ? s.w.data() : nullptr; }

static void triangles(const Set &s, Result &r) {
    brio_triangulation2 *t = nullptr;
    r.status = s.dimension == 2 ? brio_delaunay2(ctx, s.x.data(), weights_of(s), s.n, nullptr, &t)
                                : brio_delaunay2_flat(ctx, s.x.data(), weights_of(s), s.n, nullptr, &t);
    if (!t) return;
    const brio_delaunay2_stats *f = brio_triangulation2_stats(t);
    size_t count;
    const uint32_t *line = brio_triangulation2_line(t, &count);
    r.fact[0] = f->dimension, r.fact[1] = static_cast<double>(f->vertices);
    for (size_t i = 0; i < f->triangles; i++) {
        const uint32_t *v = brio_triangulation2_triangles(t)[i].vertex;
        r.row({v[0], v[1], v[2]});
    }
    for (size_t i = 0; i + 1 < count; i++) r.row({line[i], line[i + 1]});
    brio_triangulation2_free(t);
}

static void delaunay(const Set &s, Result &r) {
    r.columns = 4;
    if (s.dimension == 2) return triangles(s, r);
    brio_triangulation *t = nullptr;
    r.status = brio_delaunay(ctx, s.x.data(), weights_of(s), s.n, nullptr, &t);
    if (!t) return;
    const brio_delaunay_stats *f = brio_triangulation_stats(t);
    r.fact[0] = f->dimension, r.fact[1] = static_cast<double>(f->vertices);
    for (size_t i = 0; i < f->tetrahedra; i++) {
        const uint32_t *v = brio_triangulation_tetrahedra(t)[i].vertex;
        r.row({v[0], v[1], v[2], v[3]});
    }
    const bool flat = f->dimension < 3;
    brio_triangulation_free(t);
    if (flat) triangles(s, r);
}

static void put_simplices(const brio_alpha_complex &c, Result &r) {
    for (size_t k = 0; k < 4; k++)
        for (size_t i = 0; i < c.counts[k]; i++) {
            for (size_t j = 0; j < 4; j++) r.index.push_back(j <= k ? c.simplices[k][(k + 1) * i + j] : UINT32_MAX);
            r.value.push_back(c.values[k][i]);
        }
}

// A facet of the complex is regular if it has one solid tetrahedron, singular if it has none, else inside.
static void put_shape(const brio_alpha_complex &c, double alpha, Result &r) {
    std::map<std::array<uint32_t, 3>, int> solid;
    for (size_t i = 0; i < c.counts[3]; i++) {
        const uint32_t *v = c.simplices[3] + 4 * i;
        if (c.values[3][i] > alpha) continue;
        r.row({0, v[0], v[1], v[2], v[3]});
        for (int k = 0; k < 4; k++) solid[{v[k > 0 ? 0 : 1], v[k > 1 ? 1 : 2], v[k > 2 ? 2 : 3]}]++;
    }
    for (size_t i = 0; i < c.counts[2]; i++) {
        const uint32_t *v = c.simplices[2] + 3 * i;
        const auto found = solid.find({v[0], v[1], v[2]});
        if (found != solid.end() && found->second == 1) r.row({1, v[0], v[1], v[2]});
        if (found == solid.end() && c.values[2][i] <= alpha) r.row({2, v[0], v[1], v[2]});
    }
}

static void alpha(const Set &s, bool shape, Result &r) {
    brio_triangulation *t = nullptr;
    brio_alpha_complex c = {};
    c.size = sizeof c;
    r.columns = shape ? 5 : 4;
    r.status = brio_delaunay(ctx, s.x.data(), weights_of(s), s.n, nullptr, &t);
    if (t) r.status = brio_alpha_values(ctx, t, s.x.data(), weights_of(s), s.n, &c);
    if (t && r.status == BRIO_OK && shape) put_shape(c, s.parameter, r);
    if (t && r.status == BRIO_OK && !shape) put_simplices(c, r);
    brio_alpha_complex_free(&c);
    brio_triangulation_free(t);
}

static void hull(const Set &s, Result &r) {
    std::vector<uint32_t> samples(s.n);
    brio_convex_hull_options o = {0};
    brio_convex_hull_stats stats = {};
    brio_certificate c = {};
    brio_mesh *m = nullptr;
    stats.size = sizeof stats, c.size = sizeof c, o.samples = samples.data();
    r.status = brio_convex_hull(ctx, s.x.data(), s.n, &o, &m, &stats);
    if (m && stats.dimension < 3) r.status = BRIO_ERR_NO_ANSWER;
    if (r.status == BRIO_OK && brio_mesh_certificate(ctx, m, &c) == BRIO_OK) {
        for (size_t v = 0; v < m->num_vertices; v++) r.row({samples[v]});
        r.fact[0] = c.volume, r.fact[1] = c.area, r.fact[2] = static_cast<double>(stats.facets);
    }
    brio_certificate_free(&c);
    brio_mesh_free(m);
}

static void cells(const Set &s, Result &r) {
    const double box[6] = {0, 0, 0, 1, 1, 1};
    brio_cells_options o = {0};
    brio_cells *c = nullptr;
    o.centroids = 0, o.box = box, r.columns = 2;
    r.status = brio_voronoi_cells(ctx, nullptr, s.x.data(), weights_of(s), s.n, &o, &c);
    for (size_t i = 0; c && i < c->num_cells; i++) {
        if (c->volume[i] == 0) continue; // cells outside the box, which voro++ leaves out
        r.row({c->site[i]}, c->volume[i]);
        for (uint64_t f = c->face_offsets[i]; f < c->face_offsets[i + 1]; f++)
            r.row({c->site[i], static_cast<uint32_t>(c->face_neighbours[f])}, c->face_areas[f]);
    }
    if (c) r.fact[0] = c->volume_sum;
    brio_cells_free(c);
}

int main(int argc, char **argv) {
    if (brio_context_new(nullptr, &ctx) != BRIO_OK) return 2;
    return sets::run(argc, argv, [](const char *mode, const Set &s, Result &r) {
        if (!std::strcmp(mode, "delaunay")) delaunay(s, r);
        if (!std::strcmp(mode, "filtration")) alpha(s, false, r);
        if (!std::strcmp(mode, "shape")) alpha(s, true, r);
        if (!std::strcmp(mode, "hull")) hull(s, r);
        if (!std::strcmp(mode, "cells")) cells(s, r);
    });
}
