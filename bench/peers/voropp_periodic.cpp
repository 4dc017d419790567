// Voronoi and power cells in space that repeats by voro++, for comparison: a program of its own, never linked with brio.
//   voropp_periodic POINTS CELL [RADII] [--cells OUT]
// POINTS: raw little-endian doubles, x y z of each point. CELL: bx,bxy,by,bxz,byz,bz: the vectors (bx,0,0), (bxy,by,0),
// (bxz,byz,bz). A box, whose bxy, bxz and byz are 0, goes to voro++'s container for boxes, which is the faster one. RADII: raw
// doubles, one a point; the weight of a point is the square of its radius.
// Prints one line: cells, sum of volumes, faces, seconds of construction, volumes and neighbours, of which processor seconds,
// peak bytes, library. With
// --cells writes a text, a line for each cell: its point, volume, and for each face neighbour:area.
#include "peer.hpp"
#include "voropp.hpp"
#include <cmath>
#include <cstring>
#include <ctime>

namespace {

struct Input {
    std::vector<double> points, radii;
    double cell[6];
    const char *cells = nullptr;
    size_t size() const { return points.size() / 3; }
};

void put(voro::container &c, const Input &in, int i) {
    c.put(i, in.points[3 * i], in.points[3 * i + 1], in.points[3 * i + 2]);
}
void put(voro::container_periodic &c, const Input &in, int i) {
    c.put(i, in.points[3 * i], in.points[3 * i + 1], in.points[3 * i + 2]);
}
void put(voro::container_poly &c, const Input &in, int i) {
    c.put(i, in.points[3 * i], in.points[3 * i + 1], in.points[3 * i + 2], in.radii[i]);
}
void put(voro::container_periodic_poly &c, const Input &in, int i) {
    c.put(i, in.points[3 * i], in.points[3 * i + 1], in.points[3 * i + 2], in.radii[i]);
}

template <class Loop, class Container> int run(const Input &in, Container &container, const peer::Stopwatch &watch) {
    const std::clock_t began = std::clock();
    double sum = 0;
    size_t cells = 0, faces = 0;
    std::vector<int> neighbours;
    for (size_t i = 0; i < in.size(); i++) put(container, in, static_cast<int>(i));
    Loop loop(container);
    voro::voronoicell_neighbor cell;
    if (loop.start()) do
            if (container.compute_cell(cell, loop)) {
                sum += cell.volume(), cells++;
                cell.neighbors(neighbours);
                faces += neighbours.size();
            }
        while (loop.inc());
    const double cpu = static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC;
    std::printf("%zu %.17g %zu %.4f %.4f %llu voro++-0.4.6\n", cells, sum, faces, watch.seconds(), cpu,
                peer::peak_bytes());
    if (!in.cells) return 0;
    std::FILE *out = std::fopen(in.cells, "w");
    if (!out) return 2;
    if (loop.start()) do
            if (container.compute_cell(cell, loop)) voropp::write_cell(out, loop.pid(), cell);
        while (loop.inc());
    return std::fclose(out) ? 2 : 0;
}

// voro++ sorts points into blocks: as many as its manual recommends, 8 points to a block.
template <class Box, class Lattice> int run_in(const Input &in) {
    const double *c = in.cell, side[3] = {c[0], c[2], c[5]};
    const double scale = std::cbrt(static_cast<double>(in.size()) / 8 / (side[0] * side[1] * side[2]));
    int blocks[3];
    for (int k = 0; k < 3; k++) blocks[k] = static_cast<int>(side[k] * scale) + 1;
    const peer::Stopwatch watch;
    if (c[1] == 0 && c[3] == 0 && c[4] == 0) {
        Box container(0, c[0], 0, c[2], 0, c[5], blocks[0], blocks[1], blocks[2], true, true, true, 8);
        return run<voro::c_loop_all>(in, container, watch);
    }
    Lattice container(c[0], c[1], c[2], c[3], c[4], c[5], blocks[0], blocks[1], blocks[2], 8);
    return run<voro::c_loop_all_periodic>(in, container, watch);
}

} // namespace

int main(int argc, char **argv) {
    Input in;
    if (argc < 3) return std::fprintf(stderr, "usage: voropp_periodic POINTS CELL [RADII] [--cells OUT]\n"), 1;
    in.points = peer::read_numbers(argv[1], 1);
    double *c = in.cell;
    if (std::sscanf(argv[2], "%lf,%lf,%lf,%lf,%lf,%lf", c, c + 1, c + 2, c + 3, c + 4, c + 5) != 6)
        return std::fprintf(stderr, "%s is no cell\n", argv[2]), 1;
    for (int i = 3; i < argc; i++)
        if (!std::strcmp(argv[i], "--cells") && i + 1 < argc)
            in.cells = argv[++i];
        else
            in.radii = peer::read_numbers(argv[i], 1);
    if (in.radii.empty()) return run_in<voro::container, voro::container_periodic>(in);
    if (in.radii.size() != in.size()) return std::fprintf(stderr, "radii do not fit the points\n"), 1;
    return run_in<voro::container_poly, voro::container_periodic_poly>(in);
}
