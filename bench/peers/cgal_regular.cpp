// Regular triangulation by CGAL, for comparison: a program of its own, never linked with brio.
//   cgal_regular POINTS EXPONENT   POINTS: raw little-endian doubles; weight of point i: ldexp((i*7919) mod 1000, EXPONENT)
// Prints one line: vertices, finite tetrahedra, seconds of the construction call alone.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Regular_triangulation_3.h>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <vector>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Regular_triangulation_3<Kernel>;

int main(int argc, char **argv) {
    if (argc != 3) return std::fprintf(stderr, "usage: cgal_regular POINTS EXPONENT\n"), 1;
    std::ifstream file(argv[1], std::ios::binary);
    std::vector<Kernel::Weighted_point_3> points;
    for (double p[3]; file.read(reinterpret_cast<char *>(p), sizeof p);) {
        const double weight = std::ldexp(static_cast<double>(points.size() * 7919 % 1000), std::atoi(argv[2]));
        points.emplace_back(Kernel::Point_3(p[0], p[1], p[2]), weight);
    }
    const auto start = std::chrono::steady_clock::now();
    Triangulation t(points.begin(), points.end());
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    std::printf("%zu %zu %.3f\n", static_cast<size_t>(t.number_of_vertices()),
                static_cast<size_t>(t.number_of_finite_cells()), seconds.count());
}
