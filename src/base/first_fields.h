/* The last field that each struct of the public interface had at first, in version 0.3: a `size` of 0 stands for the
 * struct up to there. The list is of that version for ever; a new struct gets a row with the last field that it begins
 * with. */
#ifndef BRIO_BASE_FIRST_FIELDS_H
#define BRIO_BASE_FIRST_FIELDS_H

#define BRIO_FIRST_brio_alpha_complex         triangulation2
#define BRIO_FIRST_brio_alpha_shape_stats     singular_facets
#define BRIO_FIRST_brio_ball_union_options    seed
#define BRIO_FIRST_brio_ball_union_stats      mesh_seconds
#define BRIO_FIRST_brio_cells_options         num_planes
#define BRIO_FIRST_brio_certificate           volume
#define BRIO_FIRST_brio_convert_options       crs
#define BRIO_FIRST_brio_convert_stats         degenerate
#define BRIO_FIRST_brio_convex_hull_options   samples
#define BRIO_FIRST_brio_convex_hull_stats     mesh_seconds
#define BRIO_FIRST_brio_coverage              left_out
#define BRIO_FIRST_brio_curve_certificate     length
#define BRIO_FIRST_brio_curve_options         reserved_int
#define BRIO_FIRST_brio_curve_stats           curve_seconds
#define BRIO_FIRST_brio_delaunay2_options     seed
#define BRIO_FIRST_brio_delaunay_options      cache_bytes
#define BRIO_FIRST_brio_distance              diagonal
#define BRIO_FIRST_brio_evidence              origin_of
#define BRIO_FIRST_brio_file_facts            version
#define BRIO_FIRST_brio_generate_options      reserved_int
#define BRIO_FIRST_brio_interpolation         components
#define BRIO_FIRST_brio_iso_surface_options   vertices
#define BRIO_FIRST_brio_merge_stats           edges
#define BRIO_FIRST_brio_mesh_offset_options   error
#define BRIO_FIRST_brio_mesh_offset_stats     error
#define BRIO_FIRST_brio_mesh_simplify_options reserved_int
#define BRIO_FIRST_brio_outliers_options      factor
#define BRIO_FIRST_brio_plane_frame           thickness
#define BRIO_FIRST_brio_power_shape_options   redundancy
#define BRIO_FIRST_brio_power_shape_stats     shape_seconds
#define BRIO_FIRST_brio_read_notes            rounded_column
#define BRIO_FIRST_brio_read_options          origins
#define BRIO_FIRST_brio_restricted_stats      cut_seconds
#define BRIO_FIRST_brio_spanning_tree_stats   tree_seconds
#define BRIO_FIRST_brio_surface_options       reserved_int
#define BRIO_FIRST_brio_surface_stats         rounding
#define BRIO_FIRST_brio_voronoi_axis_options  seed
#define BRIO_FIRST_brio_voronoi_axis_stats    label_seconds
#define BRIO_FIRST_brio_write_options         reserved_int

#endif
