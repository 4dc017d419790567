// GUDHI's side of the cross-check: a program of its own, never linked with brio. sets.hpp says what goes in and out.
//   filtration simplices of every dimension with their alpha values, by exact arithmetic
#include "sets.hpp"
#include <CGAL/Epeck_d.h>
#include <gudhi/Alpha_complex.h>
#include <gudhi/Simplex_tree.h>

using sets::Result;
using sets::Set;
using Kernel = CGAL::Epeck_d<CGAL::Dimension_tag<3>>;
using Point = Kernel::Point_d;
using Weighted_point = Kernel::Weighted_point_d;

template <class Complex> void put(Complex &complex, Result &r) {
    Gudhi::Simplex_tree<> tree;
    r.status = complex.create_complex(tree, std::numeric_limits<double>::infinity(), true) ? 0 : 20;
    for (auto simplex : tree.complex_simplex_range()) {
        uint32_t n = 0;
        for (auto vertex : tree.simplex_vertex_range(simplex)) r.index.push_back(static_cast<uint32_t>(vertex)), n++;
        for (; n < r.columns; n++) r.index.push_back(UINT32_MAX);
        r.value.push_back(tree.filtration(simplex));
    }
}

int main(int argc, char **argv) {
    return sets::run(argc, argv, [](const char *, const Set &s, Result &r) {
        std::vector<Point> points;
        r.columns = 4;
        for (size_t i = 0; i < s.n; i++) points.emplace_back(s.at(i)[0], s.at(i)[1], s.at(i)[2]);
        if (s.weighted) {
            Gudhi::alpha_complex::Alpha_complex<Kernel, true> complex(points, s.w);
            put(complex, r);
        } else {
            Gudhi::alpha_complex::Alpha_complex<Kernel, false> complex(points);
            put(complex, r);
        }
    });
}
