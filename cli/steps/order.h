/* The insertion order: options that commands of triangulations and hulls share. */
#ifndef BRIO_CLI_ORDER_H
#define BRIO_CLI_ORDER_H

#include "cli/run/run.h"

typedef struct order_options {
    int order;           /* a brio_order, ORDER_IN_BLOCKS + a brio_laboratory_order, or FITTING_ORDER */
    double round_ratio;  /* NaN: not given */
    uint64_t block_size; /* 0: not given */
} order_options;

/* FITTING_ORDER stands for the command's own choice. */
enum { ORDER_IN_BLOCKS = BRIO_ORDER_END, FITTING_ORDER = ORDER_IN_BLOCKS + BRIO_BLOCKS_END };

extern const option_choice cli_orders[];

/** Rows of a command's option table whose struct has order_options as its member `field`; `usual` ends the help of
 *  --order. */
#define ORDER_ROWS(type, field, usual)                                                                                 \
    {"order",   0, OPTION_CHOICE, offsetof(type, field.order), "NAME", "insertion order (default brio" usual ")",      \
     cli_orders},                                                                                                      \
        {"block-size",                                                                                                 \
         0,                                                                                                            \
         OPTION_NATURAL | OPTION_POSITIVE,                                                                             \
         offsetof(type, field.block_size),                                                                             \
         "N",                                                                                                          \
         "most points of an octree or k-d tree block (default 2000)",                                                  \
         0},                                                                                                           \
    {                                                                                                                  \
        "round-ratio", 0, OPTION_NUMBER, offsetof(type, field.round_ratio), "R",                                       \
            "share of the points before the last round (default 1/8 for brio, else 1/2)", 0                            \
    }

/** Values of the options when none is given. */
#define NO_ORDER_OPTIONS                                                                                               \
    { .order = FITTING_ORDER, .round_ratio = NAN }

/** Refuses options that the order does not have.   order  what FITTING_ORDER stands for is known. */
brio_status cli_check_order(run *r, const order_options *o, int order);

/** Returns the order; BRIO where none was given. */
int cli_order_of(const order_options *o);

/** Returns what the library's options have for an order: BRIO for an order by blocks, which an experiment makes. */
brio_order cli_library_order(int order);

/** Writes the order by blocks, where one was given, into the options of an experiment. */
void cli_order_experiment(const order_options *o, brio_laboratory_options *lab);

#endif
