/* brio interpolate: values of a property of the points of a file, at the points of another file. */
#include "cli/files/read_write.h"
#include "cli/run/commands.h"
#include "cli/steps/located.h"
#include "cli/steps/properties.h"
#include "cli/files/table.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct arguments {
    const char *at, *property;
    int method, plane;
} arguments;

static const option_choice methods[] = {
    {"natural", BRIO_INTERPOLATION_NATURAL}, {"linear", BRIO_INTERPOLATION_LINEAR}, {NULL, 0}};

static const option options[] = {
    AT_ROW(arguments, at),
    {"property", 0, OPTION_TEXT, offsetof(arguments, property), "NAME", "the property of IN whose values are wanted",
     0},
    {"method", 0, OPTION_CHOICE, offsetof(arguments, method), "NAME",
     "by natural neighbours (default natural), or linear in each tetrahedron", methods},
    LOCATED_PLANE_ROW(arguments, plane),
    {0},
};

static const arguments defaults = {.plane = LOCATED_SPACE};

static bool wants_table(const run *r) {
    return cli_is_table(r, "csv") || cli_is_table(r, "npy");
}

static brio_status check_arguments(run *r, const arguments *a) {
    if (!a->property) return cli_fail(r, BRIO_ERR_ARGUMENT, "no property: --property NAME is missing");
    return wants_table(r) ? cli_require_table(r) : cli_require_output(r, false);
}

static brio_status values_of(run *r, const brio_mesh *points, const char *name, double **values) {
    const brio_property *property = brio_mesh_property(points, name);
    if (!property) {
        cli_hint(r, HINT_PROPERTIES);
        return cli_fail(r, BRIO_ERR_FORMAT, "%s: its points have no property '%s'", r->operands[0], name);
    }
    *values = malloc((2 * points->num_vertices + 1) * sizeof **values);
    if (!*values) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory: %zu values", points->num_vertices);
    size_t none = 0;
    for (size_t i = 0; i < points->num_vertices; i++) {
        (*values)[2 * i] = brio_property_value(property, i);
        (*values)[2 * i + 1] = 1; /* NaN in the results outside of the hull alone */
        none += !isfinite((*values)[2 * i]);
    }
    if (none) cli_warn(r, WARNING_NOT_FINITE, none, name);
    return BRIO_OK;
}

/* Adds the property to the places, which a table leaves out. */
static brio_status add_results(run *r, brio_mesh *at, const arguments *a, double **results) {
    void *data;
    cli_set_aside(r, at, a->property);
    brio_status status = brio_mesh_add_property(at, a->property, BRIO_SCALAR_FLOAT64, &data);
    if (status == BRIO_OK) *results = data;
    return status;
}

static brio_status write_results(run *r, const located *l, const arguments *a, const double *results) {
    size_t count = l->at->num_vertices;
    if (!wants_table(r)) return cli_write(r, l->at);
    return cli_write_table(r, &(table){a->property, count, 1, NULL, results});
}

static brio_status answer(run *r, const located *l, const arguments *a, const double *values) {
    brio_status status = BRIO_OK;
    brio_interpolation o = {0};
    double *results = NULL;
    size_t inside = 0, count = l->at->num_vertices;
    double *found = malloc((2 * count + 1) * sizeof *found);
    if (!found) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory: %zu places", count);
    o.method = (brio_interpolation_method)a->method;
    o.values = values;
    o.components = 2;
    TRY(add_results(r, l->at, a, &results));
    if (l->plane)
        TRY(brio_locator2_interpolate(r->ctx, l->plane, l->places, count, &o, found));
    else
        TRY(brio_locator_interpolate(r->ctx, l->locator, l->at->vertices, count, &o, found));
    cli_lap(r, "interpolate");
    for (size_t i = 0; i < count; i++) {
        results[i] = found[2 * i];
        inside += !isnan(found[2 * i + 1]);
    }
    cli_report_inside(r, inside, count);
    TRY(write_results(r, l, a, results));
done:
    free(found);
    return status;
}

static brio_status interpolate(run *r) {
    const arguments *a = r->arguments;
    located l = {0};
    double *values = NULL;
    brio_status status = BRIO_OK;
    TRY(check_arguments(r, a));
    TRY(cli_read_located(r, a->at, NULL, NULL, a->plane, &l));
    if (!l.points->num_vertices)
        FAIL(r, BRIO_ERR_NO_ANSWER, "%s: no points, so no values to interpolate between", r->operands[0]);
    TRY(values_of(r, l.points, a->property, &values));
    TRY(cli_make_locator(r, a->plane, false, &l));
    if (l.duplicates) cli_warn(r, WARNING_COINCIDENT, l.duplicates);
    TRY(answer(r, &l, a, values));
done:
    free(values);
    cli_located_free(&l);
    return status;
}

const command cli_interpolate = {
    .name = "interpolate",
    .operands = "IN",
    .summary = "values of a property of points, at other places",
    .examples =
        "brio interpolate stations.csv --at places.xyz --property temperature -o values.csv\nby natural neighbours\n"
        "brio interpolate stations.csv --at places.csv --plane xy --property depth -o values.csv\nover a map: columns "
        "x, y, depth\n",
    .has_output = true,
    .holds = CLI_POINTS,
    .group = GROUP_TRIANGULATIONS,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = interpolate,
};
