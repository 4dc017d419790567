// Qhull's side of the cross-check: a program of its own, never linked with brio. sets.hpp says what goes in and out.
//   hull       vertices; facts: volume, area, facets after merging
//   delaunay   tetrahedra (triangles in the plane); Qhull computes in doubles: for sets without near ties
#include "sets.hpp"
extern "C" {
#include <libqhull_r/qhull_ra.h>
}

using sets::Result;
using sets::Set;

static void put_hull(qhT *qh, Result &r) {
    vertexT *vertex;
    facetT *facet;
    double facets = 0;
    FORALLvertices r.row({static_cast<uint32_t>(qh_pointid(qh, vertex->point))});
    FORALLfacets facets++;
    qh_getarea(qh, qh->facet_list);
    r.fact[0] = qh->totvol, r.fact[1] = qh->totarea, r.fact[2] = facets;
}

static void put_delaunay(qhT *qh, Result &r) {
    facetT *facet;
    FORALLfacets {
        if (facet->upperdelaunay) continue;
        vertexT *vertex, **vertexp;
        size_t n = 0;
        FOREACHvertex_(facet->vertices) r.index.push_back(static_cast<uint32_t>(qh_pointid(qh, vertex->point))), n++;
        for (; n < r.columns; n++) r.index.push_back(UINT32_MAX);
        r.value.push_back(0);
    }
}

static void solve(const char *mode, const Set &s, Result &r) {
    const bool hull = !std::strcmp(mode, "hull");
    char hull_options[] = "qhull Pp", delaunay_options[] = "qhull d Qbb Qt Q12 Pp";
    std::vector<double> x = s.x;
    qhT state, *qh = &state;
    r.columns = hull ? 1 : 4;
    std::FILE *nowhere = std::fopen("/dev/null", "w");
    qh_zero(qh, nowhere);
    r.status = static_cast<uint64_t>(qh_new_qhull(qh, static_cast<int>(s.dimension), static_cast<int>(s.n), x.data(), False,
                                                  hull ? hull_options : delaunay_options, nullptr, nowhere));
    if (!r.status) hull ? put_hull(qh, r) : put_delaunay(qh, r);
    int left, total;
    qh_freeqhull(qh, !qh_ALL);
    qh_memfreeshort(qh, &left, &total);
    std::fclose(nowhere);
}

int main(int argc, char **argv) { return sets::run(argc, argv, solve); }
