// What the drivers of voro++ share: a cell as a line of text.
#ifndef VOROPP_HPP
#define VOROPP_HPP

#include <cstdio>
#include <vector>
#include <voro++/voro++.hh>

namespace voropp {

// Writes a cell: its point, volume, and for each face neighbour:area.
inline void write_cell(std::FILE *out, int site, voro::voronoicell_neighbor &cell) {
    std::vector<int> neighbours;
    std::vector<double> areas;
    cell.neighbors(neighbours);
    cell.face_areas(areas);
    std::fprintf(out, "%d %.17g", site, cell.volume());
    for (size_t f = 0; f < neighbours.size(); f++) std::fprintf(out, " %d:%.17g", neighbours[f], areas[f]);
    std::fputc('\n', out);
}

} // namespace voropp

#endif
