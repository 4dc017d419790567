/* brio/mesh.h: meshes and their properties, and what changes them: components, merging, subdivision, simplification. */
#ifndef BRIO_MESH_H
#define BRIO_MESH_H

#include "context.h"

#ifdef __cplusplus
extern "C" {
#endif

/** Scalar types of properties, as in PLY. */
typedef enum brio_scalar {
    BRIO_SCALAR_INT8 = 0,
    BRIO_SCALAR_UINT8 = 1,
    BRIO_SCALAR_INT16 = 2,
    BRIO_SCALAR_UINT16 = 3,
    BRIO_SCALAR_INT32 = 4,
    BRIO_SCALAR_UINT32 = 5,
    BRIO_SCALAR_FLOAT32 = 6,
    BRIO_SCALAR_FLOAT64 = 7,
    BRIO_SCALAR_END
} brio_scalar;

/** Returns the bytes of a scalar type. */
BRIO_API size_t brio_scalar_size(brio_scalar type);

/** One named number for each vertex, or for each face. */
typedef struct brio_property {
    char name[64];
    brio_scalar type;
    int reserved_int;
    void *data; /* #V or #F scalars of `type` */
    uint64_t reserved[2];
} brio_property;

/** Something that a file says of all its points at once. brio carries it from file to file. */
typedef struct brio_metadata {
    char name[64]; /* what it is, such as "crs.wkt": docs/formats.md lists the names */
    size_t size;   /* of the bytes, which a further byte 0 follows */
    char *bytes;
} brio_metadata;

/** What a file holds: points, polygons, tetrahedra or edges over them, and properties of points and polygons. Polygons
 *  are stored one after the other: face f has the vertices face_vertices[face_offsets[f]] to
 *  face_vertices[face_offsets[f+1] - 1]. Vertices at the same position stay distinct. The mesh owns all arrays; the
 *  array of an absent part is NULL. A program may change the numbers in the arrays, but neither pointers nor counts.
 *  Later versions may append fields. */
typedef struct brio_mesh {
    size_t size; /* of the struct in the library that runs */
    brio_context *context;
    size_t num_vertices;
    double *vertices; /* #V by 3 */
    size_t num_faces;
    uint64_t *face_offsets; /* #F + 1 */
    uint32_t *face_vertices;
    size_t num_tetrahedra;
    uint32_t *tetrahedra; /* #T by 4 */
    size_t num_properties;
    brio_property *properties;
    size_t num_edges; /* edges of their own, such as those of a medial axis; edges of polygons are not listed */
    uint32_t *edges;  /* #E by 2 */
    double coordinate_step[3];   /* of a LAS file: every coordinate is a whole number times the step, */
    double coordinate_origin[3]; /* plus the origin. brio_write keeps both. Steps are 0 if they are not known. */
    size_t num_metadata;
    brio_metadata *metadata; /* what the file says of all its points at once, such as their coordinate system */
    size_t num_face_properties;
    brio_property *face_properties; /* of the faces */
} brio_mesh;

/** Makes an empty mesh. Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_new(brio_context *ctx, brio_mesh **out);
/** Frees a mesh with all its arrays; NULL is accepted. */
BRIO_API void brio_mesh_free(brio_mesh *mesh);

/* The functions that set a part of a mesh return BRIO_OK, BRIO_ERR_ARGUMENT (the mesh has that part already, or as
 * said), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. They leave indices unchecked; the functions that use them check. */

/** Copies vertices into a mesh without vertices and properties; vertices NULL sets them to 0. */
BRIO_API brio_status brio_mesh_set_vertices(brio_mesh *mesh, const double *vertices, size_t num_vertices);
/** Copies polygons into a mesh without faces and properties of faces.   offsets  #F + 1, from 0 on, not decreasing;
 *  NULL without faces.   indices  offsets[#F]. */
BRIO_API brio_status brio_mesh_set_faces(brio_mesh *mesh, const uint64_t *offsets, const uint32_t *indices,
                                         size_t num_faces);
/** Copies tetrahedra into a mesh. Tetrahedron i has four vertices at tetrahedra + stride * i: stride 4 for a packed
 *  array, 8 for the array of a brio_triangulation. */
BRIO_API brio_status brio_mesh_set_tetrahedra(brio_mesh *mesh, const uint32_t *tetrahedra, size_t stride,
                                              size_t num_tetrahedra);
/** Copies edges into a mesh.   edges  #E by 2. */
BRIO_API brio_status brio_mesh_set_edges(brio_mesh *mesh, const uint32_t *edges, size_t num_edges);
/** Adds a property of the vertices, filled with 0.   data  receives the array, #V scalars, owned by the mesh.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the mesh has a property of that name, the name is empty or has over 63 bytes, or
 *  there is no such type), BRIO_ERR_NO_MEMORY. Names are UTF-8: in one that is not, other bytes are taken for
 *  Latin-1. */
BRIO_API brio_status brio_mesh_add_property(brio_mesh *mesh, const char *name, brio_scalar type, void **data);
/** Removes the property of that name, if there is one. */
BRIO_API void brio_mesh_remove_property(brio_mesh *mesh, const char *name);
/** Returns the property of that name, or NULL. Valid until a property is added to the mesh or removed from it; its data
 *  stay where they are until that property is removed, or vertices are. */
BRIO_API const brio_property *brio_mesh_property(const brio_mesh *mesh, const char *name);
/** Adds a property of the faces, as brio_mesh_add_property adds one of the vertices; names of the two do not meet. */
BRIO_API brio_status brio_mesh_add_face_property(brio_mesh *mesh, const char *name, brio_scalar type, void **data);
/** Removes the property of the faces of that name, if there is one. */
BRIO_API void brio_mesh_remove_face_property(brio_mesh *mesh, const char *name);
/** Returns the property of the faces of that name, or NULL; valid as that of brio_mesh_property. */
BRIO_API const brio_property *brio_mesh_face_property(const brio_mesh *mesh, const char *name);
/** Adds metadata, or replaces that of the same name.   bytes  copied.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the name is empty, has over 63 bytes, or is no UTF-8), BRIO_ERR_NO_MEMORY. */
BRIO_API brio_status brio_mesh_set_metadata(brio_mesh *mesh, const char *name, const void *bytes, size_t size);
/** Returns the metadata of that name, or NULL; valid until metadata is set. */
BRIO_API const brio_metadata *brio_mesh_metadata(const brio_mesh *mesh, const char *name);
/** Returns scalar i of a property as a double. */
BRIO_API double brio_property_value(const brio_property *property, size_t i);

/** Adds the properties nx, ny, nz (float32) to the vertices: the unit mean of the normals of the faces at a vertex,
 *  weighted by area. A normal points to the side from which the faces are seen counterclockwise. A vertex whose
 *  faces have no area has the normal of the vertices at its position that edges join to it. A vertex without faces has
 *  the normal 0.
 *  Returns BRIO_OK; BRIO_ERR_ARGUMENT (an index out of range, or the mesh has such properties) and BRIO_ERR_NO_MEMORY,
 *  after which the mesh is as it was. */
BRIO_API brio_status brio_mesh_add_normals(brio_mesh *mesh);

/** Gives the vertices of a mesh the properties of points, such as the colours of the samples of a surface. The values
 *  are copied in their types, not averaged. A property whose name the mesh has becomes input_NAME, or input_NAME_2 and
 *  so on.
 *  points   whose properties are wanted; only its vertices and properties count.
 *  samples  NULL: each vertex takes the properties of the point nearest to it, of the lexicographically first one among
 *           points at equal distances (distances are rounded to doubles), and of the lowest index among coincident
 *           points. Or #V: for each vertex of the mesh the index of its point, such as the data of the property
 *           "sample" that brio_surface adds. It has no such index for methods whose vertices are not points: NULL then.
 *  mesh     receives the properties. After a failure it has those that it had.
 *  Cost: with samples linear; else O(n log n) for the points and expected O(log n) a vertex, with all threads; 57 bytes
 *  a point and 4 a vertex.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range, or vertices and no points), BRIO_ERR_NOT_FINITE,
 *  BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Friedman Bentley Finkel 1977]. */
BRIO_API brio_status brio_mesh_carry_properties(brio_context *ctx, const brio_mesh *points, const uint32_t *samples,
                                                brio_mesh *mesh);

/** Drops components of a mesh: sets of faces joined across edges. Also drops the vertices, with their properties, that
 *  only dropped faces used; the rest keeps its order, and faces that stay keep their properties.
 *  largest      1: keeps one component, that of the largest area (among equal areas, the one of more faces, then the
 *               first one); 0: keeps all.
 *  least_faces  drops the components of fewer faces, before the largest one is looked for.
 *  dropped_components, dropped_faces  NULL, or receive what was dropped.
 *  Cost: near-linear; about 30 bytes a corner.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (an index out of range, or the mesh has edges or tetrahedra), BRIO_ERR_NO_ANSWER
 *  (no component has as many faces; a mesh without any stays as it is), BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. After a
 *  failure the mesh is as it was. */
BRIO_API brio_status brio_mesh_keep_components(brio_mesh *mesh, int largest, size_t least_faces,
                                               size_t *dropped_components, size_t *dropped_faces);

/** What merging vertices changed. */
typedef struct brio_merge_stats {
    size_t size;
    size_t vertices;                 /* that another one stands for */
    size_t faces, tetrahedra, edges; /* dropped, since too few distinct corners were left */
} brio_merge_stats;

/** Merges vertices at equal positions, or near each other, in place: faces that have their vertices to themselves, as
 *  some programs write them, then share them. Vertices at most `distance` apart become one, and so does a chain of
 *  them; -0 equals 0. The vertex of the lexicographically least position stays, of coincident ones the first, with its
 *  position and its properties. Vertices keep their order. The merged positions do not depend on the order of the
 *  vertices, nor on the number of threads.
 *  A face loses corners that equal the next one, and is dropped if fewer than three distinct corners are left.
 *  Tetrahedra and edges with equal corners are dropped, and so are those that were given like that. Faces that become
 *  equal stay, and faces that stay keep their properties.
 *  distance  0: equal positions only; or a normal number, at least 2^-38 times the largest coordinate. Distances that
 *            are this one up to rounding, 2^-50 of the greatest coordinate, count as this one.
 *  stats     NULL, or receives what was changed.
 *  Cost: O(n) where few vertices are in a cube of half the distance; the number of pairs of two such cubes at most, one
 *  beside the other. Memory: 24 bytes a vertex, and up to 64 for each distinct position or cube.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the distance, or an index out of range), BRIO_ERR_NOT_FINITE, BRIO_ERR_TOO_LARGE
 *  (2^32 corners), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. After a failure the mesh is as it was. */
BRIO_API brio_status brio_mesh_merge_vertices(brio_mesh *mesh, double distance, brio_merge_stats *stats);

/** Subdivides a mesh of triangles by the butterfly scheme. Each level adds one vertex on every edge and divides every
 *  triangle into four. Old vertices keep their indices and positions; the limit surface is smooth, also at vertices
 *  without six neighbours. Boundaries are subdivided as curves. A new vertex receives the mean of the properties of its
 *  edge's ends or, for integer properties, those of one end; a triangle has the properties of the one that it was part
 *  of. Of two triangles with the same corners the result has different edges with the same ends, which a second level
 *  refuses.
 *  levels  1 to 15.   out  owned by the caller.
 *  Cost: linear in the result; 64 bytes a vertex of the result and 118 a vertex of the level before.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT, BRIO_ERR_NO_ANSWER (a face is no triangle, an edge has more than two faces or
 *  two faces that run along it in the same direction, doubles cannot hold a new vertex), BRIO_ERR_TOO_LARGE,
 *  BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED.
 *  Based on: [Dyn Levin Gregory 1990], [Zorin Schroeder Sweldens 1996]. */
BRIO_API brio_status brio_mesh_subdivide(brio_context *ctx, const brio_mesh *mesh, int levels, brio_mesh **out);

typedef struct brio_mesh_simplify_options {
    size_t size;
    size_t target_faces; /* stops at this number of faces; 0: as few as the tolerance allows */
    double
        tolerance; /* most distance of a new vertex from the planes of the triangles that it stands for, as the root of
                            the mean of squares, in the unit of the mesh; 0: any distance */
    int any; /* 1: takes any mesh: cuts polygons into triangles, drops faces without three distinct corners, and takes what
                is not manifold and oriented for boundaries, which stay; 0: such meshes are refused */
    int reserved_int;
} brio_mesh_simplify_options;

/** Simplifies a mesh of triangles in place: edges collapse, about in the order of their errors. The mesh stays manifold
 *  and oriented, and keeps its components, genus and boundary; triangles do not turn over. Vertices of the boundary
 *  stay. Triangles do not come to cross others: the pairs that brio_mesh_self_intersections counts do not become more.
 *  Where collapses would make them cross, the work begins anew, with an exact test of each collapse, in one thread.
 *  Boundaries, topology and these tests may leave more faces than asked for. Vertices that no triangle uses are
 *  dropped. A vertex keeps the properties of one of those that it stands for, a triangle those that it had. The result
 *  does not depend on the number of threads, nor on the numbers of the vertices; the order of the faces and of their
 *  corners breaks ties. Cost: O(n log n); 223 bytes a vertex beside the mesh, and 24 more for each vertex that is left
 *  when the last edges collapse; 112 more a vertex, and about ten times the seconds, where each collapse is tested.
 *  Returns BRIO_OK; BRIO_ERR_ARGUMENT (neither target nor tolerance, a negative one, a face is no triangle or has a
 *  vertex twice, the mesh is not manifold and oriented at an edge or a vertex, without options.any; an index is out of
 *  range; the mesh has edges or tetrahedra), BRIO_ERR_TOO_LARGE (2^32 corners) and
 *  BRIO_ERR_NOT_FINITE, after which the mesh is
 *  what it was; BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED, BRIO_ERR_NO_ANSWER (doubles cannot hold a new vertex), after
 *  which it can only be freed.
 *  Based on: [Garland Heckbert 1997], [Dey Edelsbrunner Guha Nekhayev 1999], [Gumhold Borodin Klein 2003]. */
BRIO_API brio_status brio_mesh_simplify(brio_context *ctx, brio_mesh *mesh, const brio_mesh_simplify_options *options);

#ifdef __cplusplus
}
#endif
#endif
