/* Structs of the public interface that can grow.
 *
 * Each struct begins with `size_t size`, the bytes of the struct that the caller was compiled with. New fields are
 * appended. The library reads and writes no byte of the caller beyond `size`, so a program built for an older header
 * works with a newer library. A program built for a newer header works with an older library if the fields unknown to
 * that library are zero. A size of 0 stands for the fields that the struct had at first (BRIO_FIRST_NAME), so that a
 * struct of zeros works, too: a program that sets a later field sets the size. A field of 0 is the default. */
#ifndef BRIO_BASE_VERSIONED_H
#define BRIO_BASE_VERSIONED_H

#include "base/context.h"
#include <stddef.h>

/* The last field that each struct of the public interface had at first, in version 0.3: a `size` of 0 stands for the
 * struct up to there. The list is of that version for ever; a new struct gets a row with the last field that it begins
 * with. */
#define BRIO_FIRST_brio_alpha_complex          triangulation2
#define BRIO_FIRST_brio_alpha_shape_stats      singular_facets
#define BRIO_FIRST_brio_ball_union_options     seed
#define BRIO_FIRST_brio_ball_union_stats       mesh_seconds
#define BRIO_FIRST_brio_cells_options          num_planes
#define BRIO_FIRST_brio_certificate            volume
#define BRIO_FIRST_brio_convert_options        crs
#define BRIO_FIRST_brio_convert_stats          degenerate
#define BRIO_FIRST_brio_convex_hull_options    samples
#define BRIO_FIRST_brio_convex_hull_stats      mesh_seconds
#define BRIO_FIRST_brio_coverage               left_out
#define BRIO_FIRST_brio_curve_certificate      length
#define BRIO_FIRST_brio_curve_options          reserved_int
#define BRIO_FIRST_brio_curve_stats            curve_seconds
#define BRIO_FIRST_brio_delaunay2_options      seed
#define BRIO_FIRST_brio_delaunay_options       reserved_int
#define BRIO_FIRST_brio_distance               diagonal
#define BRIO_FIRST_brio_dynamic_periodic_stats snapshots
#define BRIO_FIRST_brio_dynamic_stats          exact_calls
#define BRIO_FIRST_brio_evidence               origin_of
#define BRIO_FIRST_brio_failure                bytes
#define BRIO_FIRST_brio_faces_part             faces
#define BRIO_FIRST_brio_file_facts             version
#define BRIO_FIRST_brio_generate_options       reserved_int
#define BRIO_FIRST_brio_interpolation          components
#define BRIO_FIRST_brio_iso_surface_options    vertices
#define BRIO_FIRST_brio_merge_stats            edges
#define BRIO_FIRST_brio_mesh_offset_options    error
#define BRIO_FIRST_brio_mesh_offset_stats      error
#define BRIO_FIRST_brio_mesh_simplify_options  reserved_int
#define BRIO_FIRST_brio_outliers_options       factor
#define BRIO_FIRST_brio_parts_options          high
#define BRIO_FIRST_brio_parts_stats            scratch_bytes
#define BRIO_FIRST_brio_periodic_options       reserved_int
#define BRIO_FIRST_brio_page_layer             report
#define BRIO_FIRST_brio_page_options           reserved_int
#define BRIO_FIRST_brio_page_stats             reserved_int
#define BRIO_FIRST_brio_picture_options        reserved_int
#define BRIO_FIRST_brio_picture_stats          high
#define BRIO_FIRST_brio_planar_crust_stats     crust_seconds
#define BRIO_FIRST_brio_plane_frame            thickness
#define BRIO_FIRST_brio_power_shape_options    redundancy
#define BRIO_FIRST_brio_power_shape_stats      shape_seconds
#define BRIO_FIRST_brio_read_notes             rounded_column
#define BRIO_FIRST_brio_read_options           origins
#define BRIO_FIRST_brio_restricted_stats       cut_seconds
#define BRIO_FIRST_brio_spanning_tree_stats    tree_seconds
#define BRIO_FIRST_brio_surface_options        pieces
#define BRIO_FIRST_brio_surface_stats          rounding
#define BRIO_FIRST_brio_periodic_shape_stats   volume
#define BRIO_FIRST_brio_tile_part              num_tetrahedra
#define BRIO_FIRST_brio_tiles_alpha_stats      singular_facets
#define BRIO_FIRST_brio_tiles_options          key
#define BRIO_FIRST_brio_ranks_options          key
#define BRIO_FIRST_brio_transport              end
#define BRIO_FIRST_brio_voronoi_axis_options   seed
#define BRIO_FIRST_brio_voronoi_axis_stats     label_seconds
#define BRIO_FIRST_brio_write_options          reserved_int

/** What is known of a struct: its name, the bytes that it has in this version, and those that it had at first. */
typedef struct {
    const char *name;
    size_t size, first;
} brio_layout;

#define BRIO_END_OF(type, field) (offsetof(type, field) + sizeof(((type *)0)->field))
#define BRIO_FIRST_SIZE(type)    BRIO_END_OF(type, BRIO_FIRST_##type)
#define BRIO_LAYOUT(type)        (&(const brio_layout){#type, sizeof(type), BRIO_FIRST_SIZE(type)})

/** Copies the caller's options over the library's struct `mine`, which holds zeros. given NULL leaves it.
 *  Returns BRIO_OK, or BRIO_ERR_ARGUMENT if the size is impossible or an unknown field is not 0. */
brio_status brio_versioned_take(brio_context *ctx, const void *given, void *mine, const brio_layout *layout);

/** Checks the size of the struct that the caller passed for a result; NULL is accepted.
 *  Returns BRIO_OK, or BRIO_ERR_ARGUMENT if the size is impossible. */
brio_status brio_versioned_check(brio_context *ctx, const void *given, const brio_layout *layout);

/** Does what brio_versioned_check does for a result that owns memory and is never NULL. The size must be at least
 *  `least`: then the struct has all fields by which the result is freed. */
brio_status brio_versioned_check_owner(brio_context *ctx, const void *given, size_t least, const brio_layout *layout);

/** Returns whether the caller's struct has `least` bytes, and a size that brio_versioned_check accepts. */
bool brio_versioned_reaches(const void *given, size_t least, const brio_layout *layout);

/** Copies a result into the caller's struct, up to the caller's size, which stays. Bytes beyond the library's struct
 *  become 0. Does nothing for NULL or a size that brio_versioned_check refuses. */
void brio_versioned_give(void *given, const void *mine, const brio_layout *layout);

/** brio_versioned_take, _check and _give for a variable `mine` of type `type`. */
#define BRIO_TAKE(ctx, type, given, mine)   brio_versioned_take(ctx, given, mine, BRIO_LAYOUT(type))
#define BRIO_CHECK_RESULT(ctx, type, given) brio_versioned_check(ctx, given, BRIO_LAYOUT(type))
#define BRIO_GIVE(type, given, mine)        brio_versioned_give(given, mine, BRIO_LAYOUT(type))

/** For a result that owns memory: `last` is the last of its fields by which it is freed. */
#define BRIO_CHECK_OWNER(ctx, type, given, last)                                                                       \
    brio_versioned_check_owner(ctx, given, BRIO_END_OF(type, last), BRIO_LAYOUT(type))
#define BRIO_OWNS(type, given, last) brio_versioned_reaches(given, BRIO_END_OF(type, last), BRIO_LAYOUT(type))

#endif
