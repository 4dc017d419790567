/* What the makers of machined solids share: parts with treated edges, holes and their patterns. */
#ifndef BRIO_TESTDATA_SOLID_EDGES_H
#define BRIO_TESTDATA_SOLID_EDGES_H

#include "testdata/solid_maker.h"

/** A part: bodies joined, then tools cut away. */
typedef struct {
    uint32_t root; /* the difference: tools are joined to it */
    uint32_t body; /* the union: bodies are joined to it */
} brio_solid_part;

/** Makes an empty part. The edges where bodies meet, and those that tools leave, are sharp, chamfered or round by
 *  chance. */
brio_solid_part brio_solid_part_new(brio_solid_maker *m);

/** Makes a union or a difference whose edges are sharp (two of three), chamfered or round by chance. */
uint32_t brio_solid_edged(brio_solid_maker *m, brio_csg_kind kind);

/** Makes a box whose edges are sharp, or by chance round all over or round along z. */
uint32_t brio_solid_rough_box(brio_solid_maker *m, double x, double y, double z);

/** Draws a radius of a hole that is at most `most`; at least a spacing, if that is no more. */
double brio_solid_hole(brio_solid_maker *m, double most);

/** Makes a hole along z through everything, by chance with a wide or a conical mouth at z = face. */
uint32_t brio_solid_bolt(brio_solid_maker *m, double radius, double face);

/** Makes holes along z in a grid that fits the rectangle |x| <= half[0], |y| <= half[1]. */
uint32_t brio_solid_bolt_grid(brio_solid_maker *m, double x, double y, double face);

/** Makes a ring of holes along z at the given distance from the axis. */
uint32_t brio_solid_bolt_ring(brio_solid_maker *m, double distance, double room, double face);

#endif
