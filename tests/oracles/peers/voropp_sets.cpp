// voro++'s side of the cross-check: a program of its own, never linked with brio. sets.hpp says what goes in and out.
//   cells      as brio_sets. Weights are squares of radii. Points on one place are left to the caller to leave out.
#include "sets.hpp"
#include <cmath>
#include <voro++/voro++.hh>

using sets::Result;
using sets::Set;

template <class Container, class Put> void cells(const Set &s, Result &r, Put put) {
    const int blocks = static_cast<int>(std::cbrt(static_cast<double>(s.n) / 8)) + 1;
    Container container(0, 1, 0, 1, 0, 1, blocks, blocks, blocks, false, false, false, 8);
    for (size_t i = 0; i < s.n; i++) put(container, static_cast<int>(i), s.at(i), s.w[i]);
    voro::c_loop_all loop(container);
    voro::voronoicell_neighbor cell;
    if (loop.start()) do {
            if (!container.compute_cell(cell, loop)) continue;
            const auto site = static_cast<uint32_t>(loop.pid());
            std::vector<int> neighbours;
            std::vector<double> areas;
            cell.neighbors(neighbours), cell.face_areas(areas);
            r.row({site}, cell.volume());
            r.fact[0] += cell.volume();
            for (size_t f = 0; f < areas.size(); f++) r.row({site, static_cast<uint32_t>(neighbours[f])}, areas[f]);
        } while (loop.inc());
}

int main(int argc, char **argv) {
    return sets::run(argc, argv, [](const char *, const Set &s, Result &r) {
        r.columns = 2;
        if (s.weighted)
            cells<voro::container_poly>(s, r, [](voro::container_poly &c, int i, const double *x, double w) {
                c.put(i, x[0], x[1], x[2], std::sqrt(w));
            });
        else
            cells<voro::container>(s, r, [](voro::container &c, int i, const double *x, double) { c.put(i, x[0], x[1], x[2]); });
    });
}
