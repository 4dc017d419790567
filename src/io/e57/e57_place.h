/* From the coordinates of a scan to points: spherical ones, the scan's pose, and points that are none. */
#ifndef BRIO_IO_E57_PLACE_H
#define BRIO_IO_E57_PLACE_H

#include "io/e57/e57_xml.h"

typedef struct brio_e57_pose {
    double matrix[9], translation[3];
    bool turns, moves; /* whether it does anything */
} brio_e57_pose;

/** Makes the pose of a scan, whose numbers are finite. A quaternion of 0, which some programs write, is no turn. */
void brio_e57_pose_make(brio_e57_pose *pose, const brio_e57_scan *scan);

/** Turns range, azimuth and elevation into x, y, z.   points  #P by 3, changed in place. */
void brio_e57_from_spherical(double *points, size_t num_points);

/** Applies a pose.   points  #P by 3, changed in place. */
void brio_e57_move(const brio_e57_pose *pose, double *points, size_t num_points);

/** Turns the normals of the mesh's points from `first` on: the properties nx, ny, nz, if they are there and can hold
 *  fractions. */
void brio_e57_turn_normals(const brio_e57_pose *pose, brio_mesh *mesh, size_t first);

/** Drops from the mesh the points from `first` on whose `invalid` is not 0.   invalid  of the points from `first` on. */
void brio_e57_drop(brio_mesh *mesh, size_t first, const uint8_t *invalid);

#endif
