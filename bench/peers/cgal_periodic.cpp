// Counts of CGAL's periodic triangulations of points in a cube: cgal_periodic POINTS SIZE [WEIGHTS]. POINTS is a text of
// three numbers a line, in [0, SIZE); WEIGHTS one number a line, at least 0 and below SIZE^2 / 64, as CGAL asks for. Prints
// vertices and cells.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Periodic_3_Delaunay_triangulation_3.h>
#include <CGAL/Periodic_3_Delaunay_triangulation_traits_3.h>
#include <CGAL/Periodic_3_regular_triangulation_3.h>
#include <CGAL/Periodic_3_regular_triangulation_traits_3.h>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <vector>

typedef CGAL::Exact_predicates_inexact_constructions_kernel Kernel;
typedef CGAL::Periodic_3_Delaunay_triangulation_traits_3<Kernel> DelaunayTraits;
typedef CGAL::Periodic_3_Delaunay_triangulation_3<DelaunayTraits> Delaunay;
typedef CGAL::Periodic_3_regular_triangulation_traits_3<Kernel> RegularTraits;
typedef CGAL::Periodic_3_regular_triangulation_3<RegularTraits> Regular;

int main(int argc, char **argv) {
    if (argc < 3) return 1;
    std::ifstream in(argv[1]);
    const double size = std::atof(argv[2]);
    const Delaunay::Iso_cuboid box(0, 0, 0, size, size, size);
    std::vector<Kernel::Point_3> points;
    for (double x, y, z; in >> x >> y >> z;) points.push_back(Kernel::Point_3(x, y, z));
    if (argc == 3) {
        const Delaunay t(points.begin(), points.end(), box);
        std::cout << t.number_of_vertices() << " " << t.number_of_cells() << "\n";
        return 0;
    }
    std::ifstream heavy(argv[3]);
    std::vector<Regular::Weighted_point> weighted;
    for (const Kernel::Point_3 &p : points) {
        double w = 0;
        heavy >> w;
        weighted.push_back(Regular::Weighted_point(p, w));
    }
    const Regular t(weighted.begin(), weighted.end(), box);
    std::cout << t.number_of_vertices() << " " << t.number_of_cells() << "\n";
    return 0;
}
