/* Weights of points: from a file, from the properties `weight` or `radius` of the input, or by the rule of
 * --weights-mod. A radius stands for its square. */
#ifndef BRIO_CLI_WEIGHTS_H
#define BRIO_CLI_WEIGHTS_H

#include "cli/run/run.h"
#include <limits.h>

typedef struct weights_options {
    const char *file;
    int exponent; /* of --weights-mod; NO_EXPONENT without */
    bool unweighted;
    bool balls;     /* points are balls: that a radius counts is no news */
    bool estimate;  /* no words, and properties that are no weights count as none */
    bool quiet;     /* no words: they were said */
    uint64_t first; /* the mesh is a block: the index of its first point */
} weights_options;

enum { NO_EXPONENT = INT_MIN };

/** Rows of a command's option table whose struct has weights_options as its member `field`. */
/* clang-format off */
#define WEIGHTS_ROWS(type, field)                                                                                      \
    {"weights", 0, OPTION_INPUT, offsetof(type, field.file), "FILE",                                                   \
     "weights of the points, one number a line; overrules the properties weight and radius "                           \
     "(weight = radius squared)", 0},                                                                                  \
    {"weights-mod", 0, OPTION_INT, offsetof(type, field.exponent), "E", "weight i is ((i*7919) mod 1000) * 2^E", 0},   \
    {"unweighted", 0, OPTION_FLAG, offsetof(type, field.unweighted), NULL,                                             \
     "ignore properties named weight and radius", 0}
/* clang-format on */

/** Fails with wrong usage when more than one source is named. */
brio_status cli_check_weights_options(run *r, const weights_options *options);

/** Returns whether the points of this mesh are weighted. */
bool cli_is_weighted(const weights_options *options, const brio_mesh *mesh);

/** Returns the weights in *weights, to be freed with free(); NULL for none. */
brio_status cli_weights(run *r, const weights_options *options, const brio_mesh *mesh, double **weights);

/** Makes the property `weight` of the mesh the weights that hold, so that its file can be checked by itself. Properties
 *  that they overrule become input_weight and input_radius. */
brio_status cli_keep_weights(run *r, const weights_options *options, brio_mesh *mesh, const double *weights);

#endif
