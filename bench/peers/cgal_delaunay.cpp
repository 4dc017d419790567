// Delaunay triangulation by CGAL, for comparison: a program of its own, never linked with brio.
//   cgal_delaunay POINTS      POINTS: raw little-endian doubles, x y z of each point
// Prints one line: vertices, finite tetrahedra, seconds of the construction call alone, peak bytes, library.
#include "cgal_points.hpp"
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>

using Triangulation = CGAL::Delaunay_triangulation_3<Kernel>;

int main(int argc, char **argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: cgal_delaunay POINTS\n"), 1;
    const std::vector<Kernel::Point_3> points = read_points(argv[1]);
    const peer::Stopwatch watch;
    const Triangulation t(points.begin(), points.end());
    const double seconds = watch.seconds();
    return peer::report(t.number_of_vertices(), t.number_of_finite_cells(), seconds, LIBRARY);
}
