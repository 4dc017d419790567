// Regular triangulation by CGAL, for comparison: a program of its own, never linked with brio.
//   cgal_regular POINTS EXPONENT   POINTS: raw little-endian doubles; weight of point i: ldexp((i*7919) mod 1000, EXPONENT)
// Prints one line: vertices, finite tetrahedra, seconds of the construction call alone, peak bytes, library.
#include "cgal_points.hpp"
#include <CGAL/Regular_triangulation_3.h>
#include <cmath>

using Triangulation = CGAL::Regular_triangulation_3<Kernel>;

static std::vector<Kernel::Weighted_point_3> read_weighted_points(const char *path, int exponent) {
    std::vector<Kernel::Weighted_point_3> points;
    for (const Kernel::Point_3 &p : read_points(path))
        points.emplace_back(p, std::ldexp(static_cast<double>(points.size() * 7919 % 1000), exponent));
    return points;
}

int main(int argc, char **argv) {
    if (argc != 3) return std::fprintf(stderr, "usage: cgal_regular POINTS EXPONENT\n"), 1;
    const std::vector<Kernel::Weighted_point_3> points = read_weighted_points(argv[1], std::atoi(argv[2]));
    const peer::Stopwatch watch;
    const Triangulation t(points.begin(), points.end());
    const double seconds = watch.seconds();
    return peer::report(t.number_of_vertices(), t.number_of_finite_cells(), seconds, LIBRARY);
}
