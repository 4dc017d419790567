// The advancing front surface of CGAL, for comparison: a separate program, never linked with brio.
//   cgal_advancing_front IN OUT      PLY files: points, and the surface with all of them as vertices
//   cgal_advancing_front --version
#include <CGAL/Advancing_front_surface_reconstruction.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/IO/read_ply_points.h>
#include <CGAL/version.h>
#include <array>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <iterator>
#include <vector>

using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Face = std::array<std::size_t, 3>;

static bool read_points(const char *path, std::vector<Point> &points) {
    std::ifstream file(path, std::ios::binary);
    return file && CGAL::IO::read_PLY(file, std::back_inserter(points));
}

// A little-endian machine is taken for granted, as by the judge.
static bool write_mesh(const char *path, const std::vector<Point> &points, const std::vector<Face> &faces) {
    std::ofstream file(path, std::ios::binary);
    file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
         << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << faces.size()
         << "\nproperty list uchar uint vertex_indices\nend_header\n";
    for (const Point &p : points) {
        const double xyz[3] = {p.x(), p.y(), p.z()};
        file.write(reinterpret_cast<const char *>(xyz), sizeof xyz);
    }
    for (const Face &f : faces) {
        file.put(3);
        for (const std::size_t v : f) {
            const std::uint32_t corner = static_cast<std::uint32_t>(v);
            file.write(reinterpret_cast<const char *>(&corner), sizeof corner);
        }
    }
    return file.good();
}

int main(int argc, char **argv) {
    if (argc == 2 && !std::strcmp(argv[1], "--version")) return std::printf("CGAL %s\n", CGAL_VERSION_STR), 0;
    if (argc != 3) return std::fprintf(stderr, "usage: cgal_advancing_front IN OUT\n"), 1;
    std::vector<Point> points;
    std::vector<Face> faces;
    if (!read_points(argv[1], points)) return std::fprintf(stderr, "%s cannot be read\n", argv[1]), 2;
    CGAL::advancing_front_surface_reconstruction(points.begin(), points.end(), std::back_inserter(faces));
    return write_mesh(argv[2], points, faces) ? 0 : 2;
}
