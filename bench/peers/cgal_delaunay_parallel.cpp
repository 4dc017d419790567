// Delaunay triangulation by CGAL in several threads (a grid of locks), for comparison: never linked with brio.
//   cgal_delaunay_parallel POINTS THREADS      POINTS: raw little-endian doubles, x y z of each point
// Prints one line: vertices, finite tetrahedra, seconds of the construction call alone, peak bytes, library.
#include "cgal_points.hpp"
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Delaunay_triangulation_cell_base_3.h>
#include <CGAL/bounding_box.h>
#include <tbb/global_control.h>

using Structure =
    CGAL::Triangulation_data_structure_3<CGAL::Triangulation_vertex_base_3<Kernel>,
                                         CGAL::Delaunay_triangulation_cell_base_3<Kernel>, CGAL::Parallel_tag>;
using Triangulation = CGAL::Delaunay_triangulation_3<Kernel, Structure>;

static const int LOCKS_ALONG_A_SIDE = 50; // as in CGAL's manual

int main(int argc, char **argv) {
    if (argc != 3 || std::atoi(argv[2]) < 1)
        return std::fprintf(stderr, "usage: cgal_delaunay_parallel POINTS THREADS\n"), 1;
    const std::vector<Kernel::Point_3> points = read_points(argv[1]);
    const tbb::global_control threads(tbb::global_control::max_allowed_parallelism,
                                      static_cast<size_t>(std::atoi(argv[2])));
    const CGAL::Bbox_3 box = CGAL::bounding_box(points.begin(), points.end()).bbox();
    const peer::Stopwatch watch;
    Triangulation::Lock_data_structure locks(box, LOCKS_ALONG_A_SIDE);
    const Triangulation t(points.begin(), points.end(), &locks);
    const double seconds = watch.seconds();
    return peer::report(t.number_of_vertices(), t.number_of_finite_cells(), seconds, LIBRARY);
}
