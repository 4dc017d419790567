// CGAL's side of the cross-check: a program of its own, never linked with brio. sets.hpp says what goes in and out.
//   delaunay   as brio_sets, by exact predicates, in the plane and in space, with and without weights
//   shape      as brio_sets, by exact comparisons of alpha
#include "sets.hpp"
#include <CGAL/Alpha_shape_3.h>
#include <CGAL/Alpha_shape_cell_base_3.h>
#include <CGAL/Alpha_shape_vertex_base_3.h>
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_2.h>
#include <CGAL/Regular_triangulation_3.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_3.h>

using sets::Result;
using sets::Set;
using K = CGAL::Exact_predicates_inexact_constructions_kernel;

template <class Base> using Info3 = CGAL::Triangulation_vertex_base_with_info_3<uint32_t, K, Base>;
template <class Base> using Info2 = CGAL::Triangulation_vertex_base_with_info_2<uint32_t, K, Base>;

using Delaunay3 = CGAL::Delaunay_triangulation_3<
    K, CGAL::Triangulation_data_structure_3<Info3<CGAL::Triangulation_vertex_base_3<K>>,
                                            CGAL::Delaunay_triangulation_cell_base_3<K>>>;
using Regular3 = CGAL::Regular_triangulation_3<
    K, CGAL::Triangulation_data_structure_3<Info3<CGAL::Regular_triangulation_vertex_base_3<K>>,
                                            CGAL::Regular_triangulation_cell_base_3<K>>>;
using Delaunay2 = CGAL::Delaunay_triangulation_2<
    K, CGAL::Triangulation_data_structure_2<Info2<CGAL::Triangulation_vertex_base_2<K>>>>;
using Regular2 = CGAL::Regular_triangulation_2<
    K, CGAL::Triangulation_data_structure_2<Info2<CGAL::Regular_triangulation_vertex_base_2<K>>,
                                            CGAL::Regular_triangulation_face_base_2<K>>>;

template <class Tag> using AlphaVertex = CGAL::Alpha_shape_vertex_base_3<K, Info3<CGAL::Triangulation_vertex_base_3<K>>, Tag>;
using AlphaCell = CGAL::Alpha_shape_cell_base_3<K, CGAL::Delaunay_triangulation_cell_base_3<K>, CGAL::Tag_true>;
using AlphaDelaunay =
    CGAL::Delaunay_triangulation_3<K, CGAL::Triangulation_data_structure_3<AlphaVertex<CGAL::Tag_true>, AlphaCell>>;
using AlphaShape = CGAL::Alpha_shape_3<AlphaDelaunay, CGAL::Tag_true>;

// Points with their indices, as the triangulations take them.
template <class Point, class Make> std::vector<std::pair<Point, uint32_t>> indexed(const Set &s, Make make) {
    std::vector<std::pair<Point, uint32_t>> out;
    for (uint32_t i = 0; i < s.n; i++) out.emplace_back(make(s.at(i), s.w[i]), i);
    return out;
}

template <class T> void put_space(const T &t, Result &r) {
    r.fact[0] = t.dimension(), r.fact[1] = static_cast<double>(t.number_of_vertices());
    if (t.dimension() == 3)
        for (auto c = t.finite_cells_begin(); c != t.finite_cells_end(); ++c)
            r.row({c->vertex(0)->info(), c->vertex(1)->info(), c->vertex(2)->info(), c->vertex(3)->info()});
    if (t.dimension() == 2)
        for (auto f = t.finite_facets_begin(); f != t.finite_facets_end(); ++f)
            r.row({f->first->vertex(0)->info(), f->first->vertex(1)->info(), f->first->vertex(2)->info()});
    if (t.dimension() == 1)
        for (auto e = t.finite_edges_begin(); e != t.finite_edges_end(); ++e)
            r.row({e->first->vertex(e->second)->info(), e->first->vertex(e->third)->info()});
}

template <class T> void put_plane(const T &t, Result &r) {
    r.fact[0] = t.dimension(), r.fact[1] = static_cast<double>(t.number_of_vertices());
    if (t.dimension() == 2)
        for (auto f = t.finite_faces_begin(); f != t.finite_faces_end(); ++f)
            r.row({f->vertex(0)->info(), f->vertex(1)->info(), f->vertex(2)->info()});
    if (t.dimension() == 1)
        for (auto e = t.finite_edges_begin(); e != t.finite_edges_end(); ++e)
            r.row({e->first->vertex(t.cw(e->second))->info(), e->first->vertex(t.ccw(e->second))->info()});
}

template <class T, class Point, class Make> T built(const Set &s, Make make) {
    const auto points = indexed<Point>(s, make);
    T t;
    t.insert(points.begin(), points.end());
    return t;
}

static K::Point_3 space_point(const double *x, double) { return {x[0], x[1], x[2]}; }
static K::Weighted_point_3 heavy_space_point(const double *x, double w) { return {K::Point_3(x[0], x[1], x[2]), w}; }
static K::Point_2 plane_point(const double *x, double) { return {x[0], x[1]}; }
static K::Weighted_point_2 heavy_plane_point(const double *x, double w) { return {K::Point_2(x[0], x[1]), w}; }

static void delaunay(const Set &s, Result &r) {
    r.columns = 4;
    if (s.dimension == 3 && !s.weighted) put_space(built<Delaunay3, K::Point_3>(s, space_point), r);
    if (s.dimension == 3 && s.weighted) put_space(built<Regular3, K::Weighted_point_3>(s, heavy_space_point), r);
    if (s.dimension == 2 && !s.weighted) put_plane(built<Delaunay2, K::Point_2>(s, plane_point), r);
    if (s.dimension == 2 && s.weighted) put_plane(built<Regular2, K::Weighted_point_2>(s, heavy_plane_point), r);
}

static void shape(const Set &s, Result &r) {
    AlphaDelaunay t = built<AlphaDelaunay, K::Point_3>(s, space_point);
    r.columns = 5;
    if (t.dimension() < 3) {
        r.status = 20;
        return;
    }
    AlphaShape a(t, s.parameter, AlphaShape::GENERAL);
    for (auto c = a.finite_cells_begin(); c != a.finite_cells_end(); ++c)
        if (a.classify(c) == AlphaShape::INTERIOR)
            r.row({0, c->vertex(0)->info(), c->vertex(1)->info(), c->vertex(2)->info(), c->vertex(3)->info()});
    for (auto f = a.finite_facets_begin(); f != a.finite_facets_end(); ++f) {
        const auto kind = a.classify(*f);
        if (kind != AlphaShape::REGULAR && kind != AlphaShape::SINGULAR) continue;
        uint32_t v[3], n = 0;
        for (int i = 0; i < 4; i++)
            if (i != f->second) v[n++] = f->first->vertex(i)->info();
        r.row({kind == AlphaShape::REGULAR ? 1u : 2u, v[0], v[1], v[2]});
    }
}

int main(int argc, char **argv) {
    return sets::run(argc, argv, [](const char *mode, const Set &s, Result &r) {
        if (!std::strcmp(mode, "delaunay")) delaunay(s, r);
        if (!std::strcmp(mode, "shape")) shape(s, r);
    });
}
