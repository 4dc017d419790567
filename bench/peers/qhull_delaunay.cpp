// Delaunay triangulation by Qhull, for comparison: a program of its own, never linked with brio.
//   qhull_delaunay POINTS      POINTS: raw little-endian doubles, x y z of each point
// Prints one line: vertices, finite tetrahedra, seconds of the construction call alone, peak bytes, library.
// Options: Delaunay, last coordinate scaled, a point at infinity (for cospherical points), facets triangulated. Qhull
// computes in doubles with merged facets: its counts may differ from exact ones.
#include "peer.hpp"
extern "C" {
#include <libqhull_r/qhull_ra.h>
}

static size_t count_tetrahedra(qhT *qh) {
    size_t count = 0;
    facetT *facet;
    FORALLfacets count += !facet->upperdelaunay;
    return count;
}

static size_t count_vertices(qhT *qh) {
    size_t count = 0;
    vertexT *vertex;
    FORALLvertices count++;
    return count - (qh->ATinfinity ? 1 : 0);
}

int main(int argc, char **argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: qhull_delaunay POINTS\n"), 1;
    std::vector<double> points = peer::read_points(argv[1]);
    char options[] = "qhull d Qbb Qz Qt Q12 Pp";
    qhT state, *qh = &state;
    qh_zero(qh, stderr);
    const peer::Stopwatch watch;
    const int status =
        qh_new_qhull(qh, 3, static_cast<int>(points.size() / 3), points.data(), False, options, nullptr, stderr);
    const double seconds = watch.seconds();
    if (status) return 10 + status;
    const std::string version(qh_version); // "2020.2.r 2020/08/31"
    const std::string library = "Qhull-" + version.substr(0, version.find(' '));
    return peer::report(count_vertices(qh), count_tetrahedra(qh), seconds, library.c_str());
}
