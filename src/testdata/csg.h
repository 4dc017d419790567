/* Solids as trees of shapes, combined by union, intersection and difference (constructive solid geometry).
 *
 * The value of a node is a signed distance, or close to it near the surface: negative inside, of slope about 1. Node 0
 * stands for no node. Builders return the new node; when a table is full they set `full` and return node 0. */
#ifndef BRIO_TESTDATA_CSG_H
#define BRIO_TESTDATA_CSG_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

enum { BRIO_CSG_NODES = 1024, BRIO_CSG_POINTS = 4096, BRIO_CSG_WORDS = BRIO_CSG_NODES / 64 };

typedef enum {
    BRIO_CSG_BALL,      /* radius v[0] */
    BRIO_CSG_ELLIPSOID, /* half axes v[0] to v[2] */
    BRIO_CSG_CAPSULE,   /* height v[0], radii v[1] below and v[2] above */
    BRIO_CSG_TORUS,     /* radii v[0], v[1] */
    BRIO_CSG_BOX,       /* half sides v[0] to v[2] */
    BRIO_CSG_CYLINDER,  /* radius v[0], half height v[1] */
    BRIO_CSG_PRISM,     /* polygon extruded to |z| <= v[0] */
    BRIO_CSG_LATHE,     /* polygon of (radius, z) turned round the z axis */
    BRIO_CSG_STRAND,    /* polyline of balls, in the ball round v[0] to v[2] with radius v[3] */
    BRIO_CSG_VESSEL,    /* see brio_vessel_distance */
    BRIO_CSG_THREAD,    /* radius v[0], depth v[1], pitch v[2], half height v[3] */
    BRIO_CSG_GYROID,    /* frequency v[0] */
    BRIO_CSG_HALF,      /* z <= 0 */
    BRIO_CSG_UNION,     /* of all children; reach of the blend v[0] */
    BRIO_CSG_COMMON,    /* what all children share */
    BRIO_CSG_CUT,       /* the first child without the others */
    BRIO_CSG_SHELL,     /* points inside the child up to depth v[0] */
    BRIO_CSG_SHEET,     /* points up to v[0] from the child's surface */
    BRIO_CSG_GROW,      /* the child, v[0] thicker */
    BRIO_CSG_FLAT,      /* the child's section z = 0, extruded to |z| <= v[0] */
    BRIO_CSG_WAVES,     /* the child with waves of amplitude v[0], frequency v[1] and phases v[2] to v[4] */
    BRIO_CSG_MOVE,      /* the child moved by v[0] to v[2] */
    BRIO_CSG_PLACE,     /* the child turned by the matrix v[0] to v[8] (its columns are the child's axes), then moved */
    BRIO_CSG_MIRROR,    /* the child's half x >= 0, and its mirror image */
    BRIO_CSG_RING,      /* v[0] copies of the child, turned round the z axis */
    BRIO_CSG_GRID,      /* 2 v[0] + 1 copies along x by v[1] apart, 2 v[2] + 1 copies along y by v[3] apart */
    BRIO_CSG_TWIST      /* the child turned round z by v[0] for each unit of z; its slope is divided by v[1] */
} brio_csg_kind;

/** What takes the place of a sharp edge where two children meet. */
typedef enum {
    BRIO_BLEND_SHARP,
    BRIO_BLEND_SMOOTH, /* a C2 smooth minimum */
    BRIO_BLEND_ROUND,  /* an arc whose radius is the reach */
    BRIO_BLEND_CHAMFER /* a plane that cuts the reach off each side */
} brio_csg_blend;

typedef struct {
    brio_csg_kind kind;
    brio_csg_blend blend;
    uint32_t first, last, next; /* child nodes in a list: 0 ends it */
    uint32_t point, points;     /* of polygons and strands */
    double v[12];
} brio_csg_node;

typedef struct {
    uint32_t num_nodes, num_points, root;
    bool full; /* a table was too small: the tree is not what was asked for */
    brio_csg_node nodes[BRIO_CSG_NODES];
    double points[BRIO_CSG_POINTS][4];
} brio_csg;

/** Empties a tree. */
void brio_csg_clear(brio_csg *tree);

/** Adds a node without children; `v` has `count` numbers. */
uint32_t brio_csg_add(brio_csg *tree, brio_csg_kind kind, const double *v, int count);

/** Makes `child` the last child of `parent`. */
void brio_csg_join(brio_csg *tree, uint32_t parent, uint32_t child);

/** Adds a node with one child. */
uint32_t brio_csg_over(brio_csg *tree, brio_csg_kind kind, uint32_t child, const double *v, int count);

/** Appends a point to the polygon or strand that was added last. */
void brio_csg_point(brio_csg *tree, uint32_t node, double x, double y, double z, double radius);

/** Returns the value of the tree's root. `need` NULL, or one bit a node: a child whose bit is 0 is left out. */
double brio_csg_value(const brio_csg *tree, const double *p, const uint64_t *need);

/** Returns the value at the centre of a ball of the given radius, and sets the bits of all nodes that some point of the
 *  ball needs. The caller clears the bits first. */
double brio_csg_mark(const brio_csg *tree, const double *centre, double radius, uint64_t *need);

#endif
