/* The extent of a surface, see extent.h. Only vertices that faces use count: a vertex far away that no face uses must
 * not make the faces vanish. */
#include "mesh/extent.h"
#include "base/scale.h"
#include <math.h>

void brio_box_add_corners(const brio_mesh *mesh, uint64_t begin, uint64_t end, double low[3], double high[3]) {
    for (uint64_t h = begin; h < end; h++)
        for (size_t k = 0; k < 3; k++) {
            double x = mesh->vertices[3 * (size_t)mesh->face_vertices[h] + k];
            if (x < low[k]) low[k] = x;
            if (x > high[k]) high[k] = x;
        }
}

int brio_box_exponent(const double low[3], const double high[3]) {
    enum { MOST = 1000 };
    double half = 0;
    for (int k = 0; k < 3; k++) half = fmax(half, 0.5 * high[k] - 0.5 * low[k]);
    int exponent = brio_exponent(half);
    return exponent > MOST ? MOST : exponent < -MOST ? -MOST : exponent;
}

double brio_surface_scale(const brio_mesh *mesh) {
    double low[3] = {INFINITY, INFINITY, INFINITY}, high[3] = {-INFINITY, -INFINITY, -INFINITY};
    if (mesh->num_faces) brio_box_add_corners(mesh, 0, mesh->face_offsets[mesh->num_faces], low, high);
    return brio_power_of_two(-brio_box_exponent(low, high));
}
