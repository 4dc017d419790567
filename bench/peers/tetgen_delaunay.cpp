// Delaunay triangulation by TetGen, for comparison: a program of its own, never linked with brio.
//   tetgen_delaunay POINTS      POINTS: raw little-endian doubles, x y z of each point
// Prints one line: vertices, finite tetrahedra, seconds of the construction call alone, peak bytes, library.
// The call includes copying the tetrahedra out: TetGen has no interface that leaves them where they are.
#include "peer.hpp"
#define TETLIBRARY
#include <algorithm>
#include <tetgen.h>

// TetGen reports coincident points in its list of points alone: vertices are what a tetrahedron has.
static size_t count_vertices(const tetgenio &mesh, size_t points) {
    std::vector<bool> used(points);
    for (long i = 0; i < 4L * mesh.numberoftetrahedra; i++) used[static_cast<size_t>(mesh.tetrahedronlist[i])] = true;
    return static_cast<size_t>(std::count(used.begin(), used.end(), true));
}

int main(int argc, char **argv) {
    if (argc != 2) return std::fprintf(stderr, "usage: tetgen_delaunay POINTS\n"), 1;
    std::vector<double> points = peer::read_points(argv[1]);
    char switches[] = "zQNFJ"; // from zero, quiet, no points and no faces in the output, points keep their numbers
    tetgenio in, out;
    in.pointlist = points.data();
    in.numberofpoints = static_cast<int>(points.size() / 3);
    int status = 0;
    const peer::Stopwatch watch;
    try {
        tetrahedralize(switches, &in, &out);
    } catch (int code) { status = 10 + code; }
    const double seconds = watch.seconds();
    in.pointlist = nullptr; // it is not TetGen's to free
    if (status) return status;
    return peer::report(count_vertices(out, points.size() / 3), static_cast<size_t>(out.numberoftetrahedra), seconds,
                        "TetGen-1.5");
}
