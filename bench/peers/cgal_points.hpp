// What CGAL's drivers share: kernel and points.
#ifndef CGAL_POINTS_HPP
#define CGAL_POINTS_HPP

#include "peer.hpp"
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/version.h>

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

static const char *const LIBRARY = "CGAL-" CGAL_VERSION_STR;

inline std::vector<Kernel::Point_3> read_points(const char *path) {
    const std::vector<double> x = peer::read_points(path);
    std::vector<Kernel::Point_3> points;
    points.reserve(x.size() / 3);
    for (size_t i = 0; i < x.size(); i += 3) points.emplace_back(x[i], x[i + 1], x[i + 2]);
    return points;
}

#endif
