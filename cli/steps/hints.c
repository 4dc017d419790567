/* What to try after a failure, by the command, the status and its reason. What the program finds wrong by itself has
 * its hint where it is found. */
#include "cli/steps/hints.h"
#include "cli/files/cloud.h"
#include <math.h>
#include <string.h>

static bool is(const run *r, const char *name) {
    return !strcmp(r->command->name, name);
}

/* Returns whether the failure has a status and a reason. */
static bool fails(const run *r, brio_status status, brio_reason reason) {
    const brio_failure f = cli_failure(r);
    return f.status == status && f.reason == reason;
}

static void suggest_for_poles(run *r) {
    if (fails(r, BRIO_ERR_NO_ANSWER, BRIO_REASON_SWALLOWED))
        cli_hint(r, HINT_DISTANCE);
    else if (fails(r, BRIO_ERR_NO_ANSWER, BRIO_REASON_OPEN_MESH))
        cli_hint(r, HINT_CHECK);
    else
        cli_hint(r, HINT_SOLID);
}

static void suggest_for_subdivision(run *r) {
    if (fails(r, BRIO_ERR_NO_ANSWER, BRIO_REASON_NOT_TRIANGLES))
        cli_hint(r, HINT_TRIANGLES);
    else
        cli_hint(r, HINT_CHECK);
}

/* Suggests what to try. What is said of flat points by cli_examine, and by a sentence that says how to scale, is all
 * there is to say. */
static void suggest_for_no_answer(run *r) {
    if (r->flat || fails(r, BRIO_ERR_NO_ANSWER, BRIO_REASON_SCALE)) return;
    if (is(r, "alpha") && fails(r, BRIO_ERR_NO_ANSWER, BRIO_REASON_NO_VALUE)) cli_hint(r, HINT_ALPHA);
    if (is(r, "iso")) cli_hint(r, HINT_LEVEL);
    if (is(r, "subdivide") && !r->hints.used) suggest_for_subdivision(r);
    if (is(r, "medial") || is(r, "offset")) suggest_for_poles(r);
    if (is(r, "surface") || is(r, "medial") || is(r, "offset") || is(r, "alpha")) cli_hint(r, HINT_METHODS);
}

/* Returns whether the big arrays alone are too big: the estimate is, which counts them, or a block that would be in a
 * file. */
static bool helps_scratch(const run *r) {
    enum { LEAST_MAPPED = 1 << 20 }; /* bytes of a block of the library that can be in a file */
    if (r->common.scratch) return false;
    if (r->over_limit) return true;
    return cli_failure(r).bytes >= LEAST_MAPPED;
}

static void suggest_for_no_memory(run *r) {
    static const char *const estimated[] = {"delaunay",    "voronoi", "hull",   "alpha",  "locate",
                                            "interpolate", "surface", "medial", "offset", "subdivide"};
    if (helps_scratch(r))
        cli_hint(r, HINT_SCRATCH);
    else if (r->common.max_memory)
        cli_hint(r, HINT_LIMIT);
    for (size_t i = 0; r->num_operands > 0 && i < sizeof estimated / sizeof *estimated; i++)
        if (is(r, estimated[i])) cli_hint(r, HINT_ESTIMATE);
}

static void suggest_for_check(run *r) {
    if (!is(r, "check")) return;
    if (fails(r, BRIO_ERR_CHECK, BRIO_REASON_NOT_CLOSED)) cli_hint(r, HINT_OPEN);
    cli_hint(r, HINT_REPORT);
}

static void suggest_for_format(run *r) {
    bool unknown = fails(r, BRIO_ERR_FORMAT, BRIO_REASON_UNKNOWN_FORMAT);
    if (unknown && is(r, "iso"))
        cli_hint(r, HINT_ISO);
    else if (unknown && !r->common.input_format)
        cli_hint(r, HINT_INPUT_FORMAT);
}

void cli_suggest(run *r, brio_status status) {
    if (!r->command) return;
    switch (status) {
    case BRIO_ERR_NO_ANSWER:
        suggest_for_no_answer(r);
        break;
    case BRIO_ERR_NO_MEMORY:
        suggest_for_no_memory(r);
        break;
    case BRIO_ERR_CHECK:
        suggest_for_check(r);
        break;
    case BRIO_ERR_FORMAT:
        suggest_for_format(r);
        break;
    default:
        break;
    }
}

/* --- what of the input explains a failure --- */

/* Points as near to a plane or a line as this share of their extent lie on it: those of a slanting one are rounded.
 * Chosen. */
static const double FLAT = 1e-9;

static void subtract(const double *p, const double *q, double scale, double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = (p[k] - q[k]) * scale;
}

static void cross(const double a[3], const double b[3], double out[3]) {
    for (int k = 0; k < 3; k++) out[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static double largest_of(const double v[3]) {
    return fmax(fabs(v[0]), fmax(fabs(v[1]), fabs(v[2])));
}

/* Returns the dimension of points, up to rounding.   normal  receives that of the plane where the dimension is 2. */
static int dimension_of(const double *points, size_t count, double normal[3]) {
    double along[3] = {0}, far = 0, size = 0, most = 0, beyond = 0;
    for (size_t i = 0; i < 3 * count; i++) {
        size = fmax(size, fabs(points[i]));
        far = fmax(far, fabs(points[i] - points[i % 3]));
    }
    if (!(far > 0) || !isfinite(far)) return far > 0 ? 3 : 0;
    double scale = 1 / far, rounding = FLAT + size * scale * 0x1p-50;
    for (size_t i = 0; i < count; i++) { /* the direction to one of the farthest points */
        double d[3];
        subtract(points + 3 * i, points, scale, d);
        if (largest_of(d) == 1 || largest_of(d) > largest_of(along)) memcpy(along, d, sizeof along);
    }
    for (size_t i = 0; i < count; i++) {
        double d[3], n[3];
        subtract(points + 3 * i, points, scale, d);
        cross(along, d, n);
        if (largest_of(n) > most) most = largest_of(n), memcpy(normal, n, sizeof n);
    }
    if (most <= rounding) return 1;
    for (size_t i = 0; i < count; i++) {
        double d[3];
        subtract(points + 3 * i, points, scale, d);
        beyond = fmax(beyond, fabs(d[0] * normal[0] + d[1] * normal[1] + d[2] * normal[2]) / most);
    }
    return beyond <= rounding ? 2 : 3;
}

static void examine_points(run *r, const brio_mesh *input) {
    static const char *const planes[3] = {"yz", "zx", "xy"}; /* by the axis that is left out */
    double normal[3] = {0};
    int dimension = input->num_vertices ? dimension_of(input->vertices, input->num_vertices, normal) : 3;
    int axis = fabs(normal[2]) >= fmax(fabs(normal[0]), fabs(normal[1])) ? 2 : fabs(normal[1]) >= fabs(normal[0]);
    r->flat = dimension < 3;
    if (dimension == 2)
        cli_hint(r, HINT_PLANE, r->operands[0], planes[axis]);
    else if (r->flat)
        cli_hint(r, HINT_LINE);
}

static size_t coincident(run *r, const brio_mesh *mesh) {
    size_t count = 0;
    char message[sizeof r->message];
    const brio_failure failure = r->failure;
    memcpy(message, r->message, sizeof message);
    if (cli_cloud_duplicates(r, mesh->vertices, mesh->num_vertices, &count) != BRIO_OK) count = 0;
    memcpy(r->message, message, sizeof message);
    r->failure = failure;
    return count;
}

void cli_examine(run *r, brio_status status, const brio_mesh *input) {
    if (status != BRIO_ERR_CHECK && status != BRIO_ERR_NO_ANSWER) return;
    bool open = fails(r, BRIO_ERR_CHECK, BRIO_REASON_NOT_CLOSED);
    bool hollow = fails(r, BRIO_ERR_NO_ANSWER, BRIO_REASON_OPEN_MESH);
    cli_keep_failure(r, status);
    if (status == BRIO_ERR_NO_ANSWER && !input->num_faces) examine_points(r, input);
    size_t count = open || hollow ? coincident(r, input) : 0;
    if (count) cli_hint(r, HINT_MERGE, count, r->operands[0]);
}

void cli_tell_apart(run *r, const brio_mesh *mesh, bool closed) {
    size_t count = closed ? 0 : coincident(r, mesh);
    if (count) cli_warn(r, WARNING_APART, r->operands[0]);
}

/* Returns whether a sentence begins with a name, as all sentences do that are about one file. */
static bool names(const char *sentence, const char *name) {
    size_t length = strlen(name);
    return !strncmp(sentence, name, length) && (sentence[length] == ':' || sentence[length] == ',');
}

void cli_name_input(run *r, brio_status status) {
    char message[sizeof r->message];
    const brio_failure failure = cli_failure(r);
    bool about_input = status == BRIO_ERR_NO_ANSWER || status == BRIO_ERR_CHECK;
    if (!about_input || !r->command || r->command->first_input >= r->num_operands) return;
    const char *input = r->operands[r->command->first_input];
    snprintf(message, sizeof message, "%s", cli_message(r, status));
    if (names(message, input)) return;
    if (!strcmp(input, "-")) input = "standard input";
    if (names(message, input)) return;
    snprintf(r->message, sizeof r->message, "%.300s: %.700s", input, message);
    r->failure = failure;
}
