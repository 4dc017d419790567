/* Normals of samples from their poles: the direction from the inner pole to the outer pole. The farther a pole, the
 * more accurate its direction, so the vectors to the poles are added without normalisation. If both poles have one
 * label, the direction of the farther pole alone counts.
 *
 * Based on: Amenta, Bern. Surface reconstruction by Voronoi filtering. DCG 1999 (poles as normals). */
#include "reconstruct/power_crust/sample_normals.h"
#include "base/memory.h"
#include "mesh/closest_point.h"
#include <math.h>
#include <string.h>

static bool normalise(double *n) {
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (!(length > 0) || isinf(length)) return false;
    for (int k = 0; k < 3; k++) n[k] /= length;
    return true;
}

/* Adds the vector between the sample and a pole, pointing outwards. */
static void add_pole(const brio_power_diagram *d, const uint8_t *label, size_t s, uint32_t pole, double *n) {
    double sign = label[pole] == BRIO_LABEL_INNER ? -1 : 1;
    for (size_t k = 0; k < 3; k++) n[k] += sign * (d->poles->centre[3 * (size_t)pole + k] - d->samples[3 * s + k]);
}

static bool normal_from_poles(const brio_power_diagram *d, const uint8_t *label, size_t s, double *n) {
    uint32_t far = d->poles->of_sample[2 * s], near = d->poles->of_sample[2 * s + 1];
    n[0] = n[1] = n[2] = 0;
    if (far == BRIO_NO_POLE) return false;
    add_pole(d, label, s, far, n);
    if (near != BRIO_NO_POLE && label[near] != label[far]) add_pole(d, label, s, near, n);
    return normalise(n);
}

static void normal_from_crust(const brio_triangle_tree *tree, const double *p, double *n) {
    double closest[3], u[3], v[3];
    size_t triangle;
    brio_closest_point(tree, p, closest, &triangle);
    const double *corner[3];
    for (int i = 0; i < 3; i++) corner[i] = tree->vertices + 3 * (size_t)tree->triangles[triangle][i];
    for (int k = 0; k < 3; k++) u[k] = corner[1][k] - corner[0][k], v[k] = corner[2][k] - corner[0][k];
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    if (!normalise(n)) n[0] = n[1] = n[2] = 0;
}

brio_status brio_sample_normals(const brio_power_diagram *d, const uint8_t *label, const uint32_t *representative,
                                const uint32_t *order, const brio_mesh *crust, double *normals) {
    brio_status status = BRIO_OK;
    brio_triangle_tree tree = {0};
    for (size_t s = 0; s < d->num_samples; s++) {
        double *n = normals + 3 * (size_t)order[s];
        size_t r = representative[s];
        if (r < s) {
            memcpy(n, normals + 3 * (size_t)order[r], 3 * sizeof *n);
        } else if (!normal_from_poles(d, label, r, n)) {
            if (!tree.boxes) BRIO_TRY(brio_triangle_tree_new(crust->context, crust, &tree));
            normal_from_crust(&tree, d->samples + 3 * r, n);
        }
    }
done:
    brio_triangle_tree_free(crust->context, &tree);
    return status;
}
