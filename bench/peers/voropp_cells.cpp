// Voronoi and power cells in a box by voro++, for comparison: a program of its own, never linked with brio.
//   voropp_cells POINTS BOX [RADII] [--cells OUT]
// POINTS: raw little-endian doubles, x y z of each point. BOX: x0,y0,z0,x1,y1,z1. RADII: raw doubles, one a point; the
// weight of a point is the square of its radius.
// Prints one line: cells, sum of volumes, seconds of construction and volumes alone, peak bytes, library. With --cells
// writes a text, a line for each cell: its point, volume, and for each face neighbour:area. Walls are -1 to -6.
#include "peer.hpp"
#include "voropp.hpp"
#include <cmath>
#include <cstring>

namespace {

struct Input {
    std::vector<double> points, radii;
    double box[6];
    const char *cells = nullptr;
    size_t size() const { return points.size() / 3; }
};

// voro++ sorts points into blocks: as many as its manual recommends, 8 points to a block.
template <class Container, class Put> int run(const Input &in, Put put) {
    const double *b = in.box, side[3] = {b[3] - b[0], b[4] - b[1], b[5] - b[2]};
    const double scale = std::cbrt(static_cast<double>(in.size()) / 8 / (side[0] * side[1] * side[2]));
    int blocks[3];
    for (int k = 0; k < 3; k++) blocks[k] = static_cast<int>(side[k] * scale) + 1;
    const peer::Stopwatch watch;
    Container container(b[0], b[3], b[1], b[4], b[2], b[5], blocks[0], blocks[1], blocks[2], false, false, false, 8);
    for (size_t i = 0; i < in.size(); i++) put(container, i);
    double sum = 0;
    size_t cells = 0;
    voro::c_loop_all loop(container);
    voro::voronoicell cell;
    if (loop.start()) do
            if (container.compute_cell(cell, loop)) sum += cell.volume(), cells++;
        while (loop.inc());
    const double seconds = watch.seconds();
    std::printf("%zu %.17g %.4f %llu voro++-0.4.6\n", cells, sum, seconds, peer::peak_bytes());
    if (!in.cells) return 0;
    std::FILE *out = std::fopen(in.cells, "w");
    if (!out) return 2;
    voro::voronoicell_neighbor full;
    if (loop.start()) do
            if (container.compute_cell(full, loop)) voropp::write_cell(out, loop.pid(), full);
        while (loop.inc());
    return std::fclose(out) ? 2 : 0;
}

} // namespace

int main(int argc, char **argv) {
    Input in;
    if (argc < 3) return std::fprintf(stderr, "usage: voropp_cells POINTS BOX [RADII] [--cells OUT]\n"), 1;
    in.points = peer::read_points(argv[1]);
    if (std::sscanf(argv[2], "%lf,%lf,%lf,%lf,%lf,%lf", &in.box[0], &in.box[1], &in.box[2], &in.box[3], &in.box[4],
                    &in.box[5]) != 6)
        return std::fprintf(stderr, "%s is no box\n", argv[2]), 1;
    for (int i = 3; i < argc; i++)
        if (!std::strcmp(argv[i], "--cells") && i + 1 < argc)
            in.cells = argv[++i];
        else
            in.radii = peer::read_numbers(argv[i], 1);
    if (in.radii.empty())
        return run<voro::container>(in, [&](voro::container &c, size_t i) {
            c.put(static_cast<int>(i), in.points[3 * i], in.points[3 * i + 1], in.points[3 * i + 2]);
        });
    if (in.radii.size() != in.size()) return std::fprintf(stderr, "radii do not fit the points\n"), 1;
    return run<voro::container_poly>(in, [&](voro::container_poly &c, size_t i) {
        c.put(static_cast<int>(i), in.points[3 * i], in.points[3 * i + 1], in.points[3 * i + 2], in.radii[i]);
    });
}
