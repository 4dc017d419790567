/* The power crust on the command line: its options, the call, what it counts. */
#ifndef BRIO_CLI_POWER_CRUST_H
#define BRIO_CLI_POWER_CRUST_H

#include "cli/run/run.h"

typedef struct power_crust_options {
    int labeling, noise;
    double sampling_density;
    bool sharp, triangulate, simplify, closed;
    const char *open;    /* auto, or a number, or NULL: as given */
    const char *normals; /* file, or NULL */
} power_crust_options;

extern const option_choice cli_labelings[], cli_noise[];

/** Labelings beside those of brio_labeling: of experiments; of the faces of a closed mesh, for commands that take them
 *  where there are any; and the default of these commands. */
enum { LABELS_OF_INPUT = -2, LABELS_NAIVE = BRIO_LABELING_END, LABELS_THEORETICAL, LABELS_OF_MESH };
extern const option_choice cli_labelings_or_mesh[];

/** Replaces LABELS_OF_INPUT by what it comes to, and tells whether that is the mesh; BRIO_ERR_ARGUMENT when faces are
 *  asked for that are not there. */
brio_status cli_settle_labeling(run *r, const brio_mesh *input, int *labeling, bool *by_mesh);

/** Hints what can be done where a mesh has no inside, or points no surface.   by_mesh  whether the mesh was gone by. */
void cli_suggest_labeling(run *r, brio_status status, const brio_mesh *input, bool by_mesh);

/** Rows of a command's option table whose struct has power_crust_options as its member `field`: those that the labeled
 *  Delaunay triangulation has, too, and those of the power crust alone. */
/* clang-format off */
#define SOLID_ROWS(type, field)                                                                                        \
    {"noise", 0, OPTION_CHOICE, offsetof(type, field.noise), "NAME",                                                   \
     "what to do about noisy points (default auto)", cli_noise},                                                       \
    {"auto", 0, OPTION_NOTE, 0, NULL, "smooth if noise is found", 0},                                                  \
    {"keep", 0, OPTION_NOTE, 0, NULL, "leave the vertices on the points", 0},                                          \
    {"smooth", 0, OPTION_NOTE, 0, NULL, "smooth whatever is found", 0},                                                \
    {"open", 0, OPTION_TEXT, offsetof(type, field.open), "K|auto",                                                     \
     "leave holes open whose radii are over K point spacings; auto, the default of labeled-delaunay: where the points "\
     "end", 0},                                                                                                        \
    {"closed", 0, OPTION_FLAG, offsetof(type, field.closed), NULL,                                                     \
     "close all holes, also where the points end; the default of power-crust", 0},                                     \
    {"simplify", 0, OPTION_FLAG, offsetof(type, field.simplify), NULL,                                                 \
     "a quarter as many faces, as far as the shape allows; triangles", 0},                                             \
    {"triangulate", 0, OPTION_FLAG, offsetof(type, field.triangulate), NULL,                                           \
     "plain triangles: faces without properties, for readers that expect none", 0}

#define POWER_CRUST_ROWS(type, field)                                                                                  \
    {"labeling", 0, OPTION_CHOICE, offsetof(type, field.labeling), "NAME",                                             \
     "what tells inside from outside (default global); the others are those of the papers", cli_labelings},            \
    {"sampling-density", 'R', OPTION_NUMBER | OPTION_POSITIVE, offsetof(type, field.sampling_density), "R",            \
     "discard the nearer pole of cells too wide for an R-sample, 0 < R < 1", 0},                                       \
    {"sharp", 'B', OPTION_FLAG, offsetof(type, field.sharp), NULL,                                                     \
     "discard both poles there, for sharp edges without points (R defaults to 0.5)", 0}
/* clang-format on */

/** Sets *spacings to the number of --open: NaN for auto, or where nothing was given; 0 for --closed.
 *  Returns BRIO_OK, or BRIO_ERR_ARGUMENT. */
brio_status cli_read_open(run *r, const power_crust_options *options, double *spacings);

/** Returns what the library's options have for a labeling: the default for one that an experiment makes. */
brio_labeling cli_library_labeling(int labeling);

/** Returns what the options of an experiment have for a labeling. */
brio_laboratory_labeling cli_label_experiment(int labeling);

/** Returns the options of the poles as the library has them, without a solid. */
brio_pole_options cli_pole_options(const power_crust_options *options);

/** Writes the points with their normals, #P by 3. */
brio_status cli_write_normals(run *r, const char *path, const brio_mesh *points, const double *normals);

/** Adds the stages of a power crust to the clock. */
void cli_report_power_crust_stages(run *r, const power_crust_options *options, const brio_surface_stats *stats);

/** Reports the noise that was found, and whether the samples were smoothed. */
void cli_report_noise(run *r, double noise, bool smoothed);

/** Reports the counts of a power crust. */
void cli_report_power_crust(run *r, const power_crust_options *options, const brio_surface_stats *stats);

#endif
