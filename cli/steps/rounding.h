/* Thresholds that a user gives, and distances that equal them up to rounding. */
#ifndef BRIO_CLI_ROUNDING_H
#define BRIO_CLI_ROUNDING_H

#include <brio/brio.h>

/** Returns by how much the rounding of coordinates may change distances between points of a mesh. */
double cli_rounding(const brio_mesh *mesh);

/** Returns the greatest distance that counts as equal to a threshold, by a rounding that is at most 2^-14 of it. So a
 *  grid whose spacing no double holds is treated alike all over. */
double cli_up_to(double threshold, double rounding);

#endif
