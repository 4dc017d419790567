// Delaunay triangulation by CGAL, for comparison: a program of its own, never linked with brio.
//   cgal_delaunay POINTS      POINTS: raw little-endian doubles, x y z of each point
// Prints one line: vertices, finite tetrahedra, seconds of the construction call alone.
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel>;

int main(int argc, char **argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: cgal_delaunay POINTS\n"), 1;
    std::ifstream file(argv[1], std::ios::binary);
    std::vector<Kernel::Point_3> points;
    for (double p[3]; file.read(reinterpret_cast<char *>(p), sizeof p);) points.emplace_back(p[0], p[1], p[2]);
    const auto start = std::chrono::steady_clock::now();
    Triangulation t(points.begin(), points.end());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%zu %zu %.3f\n", static_cast<size_t>(t.number_of_vertices()),
                static_cast<size_t>(t.number_of_finite_cells()), seconds.count());
}
