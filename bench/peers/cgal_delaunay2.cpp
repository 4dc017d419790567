// Delaunay triangulation of the plane by CGAL, for comparison: a program of its own, never linked with brio.
//   cgal_delaunay2 POINTS      POINTS: raw little-endian doubles, x y of each point
// Prints one line: vertices, triangles, processor seconds of the construction call alone, peak bytes, library.
#include "peer.hpp"
#include <CGAL/Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangulation = CGAL::Delaunay_triangulation_2<Kernel>;

int main(int argc, char **argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: cgal_delaunay2 POINTS\n"), 1;
    const std::vector<double> x = peer::read_numbers(argv[1], 2);
    std::vector<Kernel::Point_2> points;
    points.reserve(x.size() / 2);
    for (size_t i = 0; i < x.size(); i += 2) points.emplace_back(x[i], x[i + 1]);
    const peer::Processor_clock watch;
    const Triangulation t(points.begin(), points.end());
    const double seconds = watch.seconds();
    return peer::report(t.number_of_vertices(), t.number_of_faces(), seconds, "CGAL-" CGAL_VERSION_STR);
}
