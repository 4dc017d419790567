/* The certificate of faces that come in parts: what its files share.
 *
 * Each vertex has an owner, which sees all its faces: the part it is in, if no other part has faces there, or the
 * bucket of its index. What is counted at a vertex or an edge is counted by owners, as topology.h tells. A part's
 * patches, and patches alone, are in memory for good: a union-find joins those that are one component, whoever finds
 * that out. */
#ifndef BRIO_CERTIFICATE_PARTS_H
#define BRIO_CERTIFICATE_PARTS_H

#include "base/memory.h"
#include "certificate/exact_sum.h"
#include "certificate/topology.h"
#include "store/row_files.h"

/** Sets that a union-find joins, and the patch that each is of. The sets are counted when all is joined. */
typedef struct {
    uint32_t *parent, *patch;
    size_t count, parents, patches; /* the last two: capacities */
} brio_open_sets;

struct brio_parts_certificate {
    brio_context *ctx;
    brio_store_folder folder;
    uint32_t buckets;
    bool sheets, ended;
    double centre[3], scale; /* the centre is scaled, too */
    int exponent;
    brio_row_files faces;   /* that have a vertex of a bucket: brio_face_row */
    brio_row_files pinched; /* brio_pinched_row: fans of vertices that have fans in several patches */
    brio_row_files ends;    /* brio_end_row: boundary edges from one owner's vertex to another's */
    brio_row_files knots;   /* with sheets: brio_knot_row */
    brio_component *component;
    uint32_t *parent;                  /* of patches */
    size_t count, components, parents; /* patches; capacities */
    brio_open_sets loops;              /* parts of boundary loops */
    brio_open_sets fans;               /* with sheets: fans, or pieces of them, that other owners may join or cut */
    brio_edge_faults edges;
    uint64_t bad_vertices, degenerate, num_faces, points; /* points: indices that faces use */
    brio_exact_sum area, volume;
};

/** A part of the surface with the faces at its own vertices: a part without what is shared, or a bucket. */
typedef struct {
    brio_mesh mesh; /* of triangles; not owned */
    const uint64_t *index;
    uint8_t *own;
    uint32_t *patch; /* #F: of each face, among those of all parts */
} brio_owned_faces;

typedef struct {
    uint64_t index[3];
    uint32_t patch;
    uint32_t shared;    /* bit k: vertex k is of a bucket */
    double point[3][3]; /* written with sheets */
} brio_face_row;

typedef struct {
    uint64_t index;
    uint64_t patch;
} brio_pinched_row;

/** The start or the end of a boundary edge; both owners write one. */
typedef struct {
    uint64_t edge[2]; /* indices, ascending */
    uint64_t set;     /* of loops */
} brio_end_row;

/** A strand: two faces of an edge with the inside between them, as one end of the edge sees it. Strands of an edge are
 *  numbered in their order round it. */
typedef struct {
    uint64_t edge[2];     /* indices, ascending */
    uint32_t rank, label; /* label: of the fan that it is of if all pairs are across inside wedges */
    uint32_t end;         /* 0 or 1: which vertex of the edge is the owner's */
    uint32_t fan[2];      /* sets of fans that the two faces' corners at this end are of, the face that runs along the
                             edge first */
    uint32_t patch[2];    /* of these faces */
} brio_knot_row;

/** Adds a set.   *set  receives its number. Returns BRIO_OK, BRIO_ERR_TOO_LARGE, BRIO_ERR_NO_MEMORY. */
brio_status brio_open_sets_add(brio_context *ctx, brio_open_sets *s, uint32_t patch, uint32_t *set);

/** Two faces of an edge of more than two, with the inside between them. */
typedef struct {
    uint32_t half[2];  /* half-edges: the first runs from the lesser index to the greater one */
    uint32_t label[2]; /* of the fans at the two ends, if all pairs are across inside wedges */
    uint32_t rank;     /* place among the strands of the edge, in their order round it */
    uint32_t end;      /* 0 or 1: the only own end, whose owner leaves this strand open; 2: it is settled */
} brio_strand;

typedef struct {
    brio_strand *strand;
    size_t count, capacity;
} brio_strands;

/** Pairs the half-edges of each edge with an own end as brio_mesh_split_sheets does, where that is known here, and
 *  joins faces and corners across these pairs. t->ring then has pairs, and itself at edges without an own end.
 *  strands  receives those that are left open; freed by the caller, also on an error.
 *  Returns BRIO_OK, BRIO_ERR_ARGUMENT (the faces bound no solid), BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_sheets_pair(const brio_topology *t, brio_strands *strands);
/** Counts edges and vertices, and writes the strands that are left open. */
brio_status brio_sheets_count(brio_parts_certificate *c, const brio_owned_faces *o, const brio_topology *t,
                              const brio_strands *strands);
/** Joins what the two ends of edges have told. */
brio_status brio_sheets_join(brio_parts_certificate *c);

/** Returns the bucket of an edge. */
uint32_t brio_bucket_of_edge(const brio_parts_certificate *c, const uint64_t edge[2]);

#endif
