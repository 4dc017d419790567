// Insertions and removals one by one in CGAL's Delaunay triangulation, for comparison with bench/dynamic.c: a program of
// its own, never linked with brio.
//   cgal_dynamic POINTS CHANGES      uniform random points
// Prints medians and means of microseconds, for the default triangulation and for the one with fast location.
#include "peer.hpp"
#include <CGAL/Delaunay_triangulation_3.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <algorithm>
#include <random>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

template <class Triangulation> void measure(const char *name, size_t n, size_t changes) {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<double> draw(0, 1);
    std::vector<Kernel::Point_3> points;
    for (size_t i = 0; i < n; i++) points.emplace_back(draw(random), draw(random), draw(random));
    Triangulation t(points.begin(), points.end());
    std::vector<typename Triangulation::Vertex_handle> vertices;
    for (auto v = t.finite_vertices_begin(); v != t.finite_vertices_end(); ++v) vertices.push_back(v);
    std::shuffle(vertices.begin(), vertices.end(), random);
    std::vector<double> took;
    auto report = [&](const char *what) {
        double sum = 0;
        for (double x : took) sum += x;
        std::sort(took.begin(), took.end());
        std::printf("%s %s one: median %.2f us, mean %.2f us\n", name, what, 1e6 * took[took.size() / 2],
                    1e6 * sum / static_cast<double>(took.size()));
        took.clear();
    };
    for (size_t i = 0; i < changes; i++) {
        const Kernel::Point_3 p(draw(random), draw(random), draw(random));
        const peer::Stopwatch watch;
        t.insert(p);
        took.push_back(watch.seconds());
    }
    report("insert");
    for (size_t i = 0; i < changes; i++) {
        const peer::Stopwatch watch;
        t.remove(vertices[i]);
        took.push_back(watch.seconds());
    }
    report("remove");
}

int main(int argc, char **argv) {
    if (argc != 3) return std::fprintf(stderr, "usage: cgal_dynamic POINTS CHANGES\n"), 1;
    const size_t n = std::strtoull(argv[1], nullptr, 10), changes = std::strtoull(argv[2], nullptr, 10);
    measure<CGAL::Delaunay_triangulation_3<Kernel>>("compact", n, changes);
    measure<CGAL::Delaunay_triangulation_3<Kernel, CGAL::Fast_location>>("fast location", n, changes);
    return 0;
}
