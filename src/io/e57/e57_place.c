/* Places the points of a scan, and their normals.
 *
 * A pose turns by a unit quaternion, then moves. The quaternion is scaled to length 1 first, because its numbers are
 * rounded. A pose that does nothing leaves every bit as it was.
 *
 * Based on: ASTM E2807-11, 8.4.3 (pose) and 8.4.4.2 (spherical coordinates). */
#include "io/e57/e57_place.h"
#include "io/scalar.h"
#include <math.h>
#include <string.h>

void brio_e57_pose_make(brio_e57_pose *pose, const brio_e57_scan *scan) {
    const double *t = scan->translation;
    double q[4] = {1, 0, 0, 0}, largest = 0;
    for (int k = 0; k < 4; k++) largest = fmax(largest, fabs(scan->rotation[k]));
    for (int k = 0; k < 4 && largest > 0; k++) q[k] = scan->rotation[k] / largest; /* no square is too large then */
    double length = sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    double w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
    *pose = (brio_e57_pose){.matrix = {1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y),
                                       2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x),
                                       2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)},
                            .turns = x != 0 || y != 0 || z != 0,
                            .moves = t[0] != 0 || t[1] != 0 || t[2] != 0};
    memcpy(pose->translation, t, sizeof pose->translation);
}

void brio_e57_from_spherical(double *points, size_t num_points) {
    for (size_t i = 0; i < num_points; i++) {
        double *p = points + 3 * i;
        double range = p[0], azimuth = p[1], elevation = p[2], flat = range * cos(elevation);
        p[0] = flat * cos(azimuth);
        p[1] = flat * sin(azimuth);
        p[2] = range * sin(elevation);
    }
}

static void turn(const double *m, double *p) {
    double x = p[0], y = p[1], z = p[2];
    for (int k = 0; k < 3; k++) p[k] = m[3 * k] * x + m[3 * k + 1] * y + m[3 * k + 2] * z;
}

void brio_e57_turn_normals(const brio_e57_pose *pose, brio_mesh *mesh, size_t first) {
    static const char *const names[] = {"nx", "ny", "nz"};
    const brio_property *p[3];
    for (int k = 0; k < 3; k++) {
        p[k] = brio_mesh_property(mesh, names[k]);
        if (!p[k] || (p[k]->type != BRIO_SCALAR_FLOAT32 && p[k]->type != BRIO_SCALAR_FLOAT64)) return;
    }
    for (size_t v = first; v < mesh->num_vertices && pose->turns; v++) {
        double normal[3];
        for (int k = 0; k < 3; k++) normal[k] = brio_property_value(p[k], v);
        turn(pose->matrix, normal);
        for (int k = 0; k < 3; k++)
            brio_scalar_store((char *)p[k]->data + v * brio_scalar_size(p[k]->type), p[k]->type, normal[k]);
    }
}

void brio_e57_move(const brio_e57_pose *pose, double *points, size_t num_points) {
    const double *t = pose->translation;
    for (size_t i = 0; i < num_points && pose->turns; i++) turn(pose->matrix, points + 3 * i);
    for (size_t i = 0; i < 3 * num_points && pose->moves; i++) points[i] += t[i % 3];
}

static size_t keep(char *values, size_t size, const uint8_t *invalid, size_t count) {
    size_t kept = 0;
    for (size_t i = 0; i < count; i++)
        if (!invalid[i]) memmove(values + kept++ * size, values + i * size, size);
    return kept;
}

void brio_e57_drop(brio_mesh *mesh, size_t first, const uint8_t *invalid) {
    size_t count = mesh->num_vertices - first, kept = 0;
    while (kept < count && !invalid[kept]) kept++;
    if (kept == count) return;
    for (size_t i = 0; i < mesh->num_properties; i++) {
        size_t size = brio_scalar_size(mesh->properties[i].type);
        keep((char *)mesh->properties[i].data + first * size, size, invalid, count);
    }
    kept = keep((char *)(mesh->vertices + 3 * first), 3 * sizeof *mesh->vertices, invalid, count);
    mesh->num_vertices = first + kept;
}
