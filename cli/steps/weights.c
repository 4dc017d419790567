/* Weights of points. A file of weights has one number a line; blank lines and what follows a # are comments.
 *
 * A point of weight w is the ball of squared radius w. So the property `radius`, which `brio medial` writes, stands for
 * weights, too: its squares. */
#include "cli/steps/weights.h"
#include "cli/steps/properties.h"
#include "platform/file.h"
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Weights and squares of radii that differ by this share are equal: singles that were rounded, and squared, differ by
 * 2^-23. */
static const double ROUNDING = 1e-6;

brio_status cli_check_weights_options(run *r, const weights_options *options) {
    int sources = (options->file != NULL) + (options->exponent != NO_EXPONENT) + options->unweighted;
    if (sources > 1)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "only one of --weights, --weights-mod and --unweighted can hold");
    if (options->exponent != NO_EXPONENT && !isfinite(ldexp(999, options->exponent)))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--weights-mod: 999 * 2^%d is not a finite double", options->exponent);
    if (options->file && !strcmp(options->file, "-") && !strcmp(r->operands[0], "-"))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "points and weights both want standard input");
    return BRIO_OK;
}

bool cli_is_weighted(const weights_options *options, const brio_mesh *mesh) {
    if (options->unweighted) return false;
    return options->file || options->exponent != NO_EXPONENT || brio_mesh_property(mesh, "weight") ||
           brio_mesh_property(mesh, "radius");
}

/* --- a file of weights --- */

/* Returns what a line holds: 1 a number, 0 nothing, -1 something else. */
static int line_number(char *line, double *value) {
    char *end;
    line[strcspn(line, "#\r\n")] = 0;
    line += strspn(line, " \t");
    if (!*line) return 0;
    *value = strtod(line, &end);
    end += strspn(end, " \t");
    return end == line || *end || !isfinite(*value) ? -1 : 1;
}

/* Returns what it means that the system does not give a file or its bytes. */
static brio_status unread(void) {
    return errno == ENOMEM ? BRIO_ERR_NO_MEMORY : BRIO_ERR_OPEN;
}

/* Lines longer than the buffer are refused: a number is short, and a file of one endless line is no file of weights. */
static brio_status read_lines(run *r, const char *name, FILE *file, double *weights, size_t count) {
    char line[1024];
    size_t found = 0, number = 0, last = 0, surplus = 0;
    while (fgets(line, sizeof line, file)) {
        double value;
        number++;
        if (!strchr(line, '\n') && !feof(file))
            return cli_fail(r, BRIO_ERR_FORMAT, "%s:%zu: expected a number, found a very long line", name, number);
        int kind = line_number(line, &value);
        if (kind < 0) return cli_fail(r, BRIO_ERR_FORMAT, "%s:%zu: expected one finite number", name, number);
        if (kind == 0) continue;
        if (found < count) weights[found] = value;
        if (found++ == count) surplus = number;
        last = number;
        if (found % 65536 == 0 && cli_check_interrupt(r) != BRIO_OK) return BRIO_ERR_CANCELLED;
    }
    if (ferror(file)) return cli_fail(r, unread(), "%s: %s", name, strerror(errno));
    if (found > count)
        return cli_fail(r, BRIO_ERR_FORMAT, "%s:%zu: the first weight too many: %zu weights for %zu points", name,
                        surplus, found, count);
    if (found < count)
        return cli_fail(r, BRIO_ERR_FORMAT, "%s:%zu: the last weight of too few: %zu weights for %zu points", name,
                        last, found, count);
    return BRIO_OK;
}

static brio_status read_weights(run *r, const char *name, double *weights, size_t count) {
    bool standard_input = !strcmp(name, "-");
    FILE *file = standard_input ? stdin : brio_open_stream(name, "r");
    if (!file) return cli_fail(r, unread(), "%s: %s", name, strerror(errno));
    brio_status status = read_lines(r, name, file, weights, count);
    if (!standard_input) fclose(file);
    return status;
}

/* --- any source --- */

static void copy_property(const brio_property *property, double *weights, size_t count) {
    for (size_t i = 0; i < count; i++) weights[i] = brio_property_value(property, i);
}

static brio_status square_radii(run *r, const brio_property *radius, uint64_t first, double *weights, size_t count) {
    for (size_t i = 0; i < count; i++) {
        double value = brio_property_value(radius, i);
        weights[i] = value * value;
        if (!(value >= 0) || !isfinite(weights[i]))
            return cli_fail(r, BRIO_ERR_FORMAT,
                            "point %" PRIu64
                            " (counted from 0) has the radius %g, expected 0 or more, whose square is the weight; "
                            "--unweighted ignores the property",
                            first + i, value);
    }
    return BRIO_OK;
}

/* Refuses weights that are not the squares of the radii. */
static brio_status compare_weights(run *r, const brio_property *weight, uint64_t first, const double *squares,
                                   size_t count) {
    for (size_t i = 0; i < count; i++) {
        double value = brio_property_value(weight, i);
        if (!(fabs(value - squares[i]) <= ROUNDING * squares[i]))
            return cli_fail(r, BRIO_ERR_FORMAT,
                            "point %" PRIu64
                            " (counted from 0) has the weight %g and the radius %g, whose square is another "
                            "number; --unweighted ignores both, --weights FILE overrules them",
                            first + i, value, sqrt(squares[i]));
    }
    return BRIO_OK;
}

static brio_status weights_of_properties(run *r, const brio_mesh *mesh, uint64_t first, double *weights) {
    const brio_property *weight = brio_mesh_property(mesh, "weight"), *radius = brio_mesh_property(mesh, "radius");
    if (radius) FORWARD(square_radii(r, radius, first, weights, mesh->num_vertices));
    if (weight && radius) FORWARD(compare_weights(r, weight, first, weights, mesh->num_vertices));
    if (weight) copy_property(weight, weights, mesh->num_vertices);
    return BRIO_OK;
}

static void modular_weights(int exponent, uint64_t first, double *weights, size_t count) {
    for (size_t i = 0; i < count; i++) weights[i] = ldexp((double)((first + i) * 7919 % 1000), exponent);
}

/* Says which weights hold where that is not plain. */
static void tell_weights(run *r, const weights_options *options, const brio_mesh *mesh) {
    bool weight = brio_mesh_property(mesh, "weight"), radius = brio_mesh_property(mesh, "radius");
    if ((!weight && !radius) || options->unweighted || options->estimate || options->quiet) return;
    if (options->file || options->exponent != NO_EXPONENT)
        cli_warn(r, WARNING_OVERRULED, options->file ? "" : "-mod", weight ? "weight" : "radius");
    else if (!weight && !options->balls)
        cli_warn(r, WARNING_RADII);
}

brio_status cli_weights(run *r, const weights_options *options, const brio_mesh *mesh, double **weights) {
    size_t count = mesh->num_vertices;
    brio_status status = BRIO_OK;
    *weights = NULL;
    if (!cli_is_weighted(options, mesh)) return BRIO_OK;
    double *w = malloc((count + 1) * sizeof *w);
    if (!w) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory: %zu weights", count);
    if (options->file)
        TRY(read_weights(r, options->file, w, count));
    else if (options->exponent != NO_EXPONENT)
        modular_weights(options->exponent, options->first, w, count);
    else
        status = weights_of_properties(r, mesh, options->first, w);
    if (status == BRIO_ERR_FORMAT && options->estimate) {
        r->message[0] = 0;
        status = BRIO_OK;
        goto done;
    }
    if (status != BRIO_OK) goto done;
    tell_weights(r, options, mesh);
    *weights = w;
    w = NULL;
done:
    free(w);
    return status;
}

brio_status cli_keep_weights(run *r, const weights_options *options, brio_mesh *mesh, const double *weights) {
    void *data;
    bool overruled = options->file || options->exponent != NO_EXPONENT || options->unweighted;
    if (overruled) cli_set_aside(r, mesh, "weight");
    if (overruled) cli_set_aside(r, mesh, "radius");
    if (!weights || brio_mesh_property(mesh, "weight")) return BRIO_OK;
    FORWARD(brio_mesh_add_property(mesh, "weight", BRIO_SCALAR_FLOAT64, &data));
    memcpy(data, weights, mesh->num_vertices * sizeof *weights);
    return BRIO_OK;
}
