/* Tables of numbers as outputs: .csv, a line of names and a line for each row; .npy, an array of numpy. */
#ifndef BRIO_CLI_TABLE_H
#define BRIO_CLI_TABLE_H

#include "cli/run/run.h"

/** Columns of one type: values[row * columns + column], as int64 or float64. */
typedef struct table {
    const char *names; /* of the columns, with commas between */
    size_t rows, columns;
    const int64_t *integers; /* NULL for a table of reals */
    const double *reals;     /* NaN is written as nan */
} table;

/** Returns whether -o and --format ask for a table: .csv or .npy. */
bool cli_is_table(const run *r, const char *extension);

/** Finds everything wrong with the output that can be found before the work. Without -o there must be --json. */
brio_status cli_require_table(run *r);

/** Writes a table to -o, or does nothing without it: a file beside the target, renamed to it when it is complete. The
 *  time is lapped as `write`. */
brio_status cli_write_table(run *r, const table *t);

#endif
