/* Points in space that repeats: see periodic.h. */
#include "cli/steps/periodic.h"
#include "cli/run/sentences.h"
#include "cli/steps/estimate.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* Reads 9 numbers with commas between them, or 3, which are the diagonal. */
static bool read_cell(const char *text, double cell[9]) {
    double numbers[9];
    int count = 0;
    for (const char *rest = text; count < 9;) {
        char *end;
        numbers[count] = strtod(rest, &end);
        if (end == rest || !isfinite(numbers[count]) || (*end != ',' && *end != 0)) return false;
        count++;
        if (*end == 0) break;
        rest = end + 1;
        if (count == 9) return false;
    }
    if (count != 3 && count != 9) return false;
    for (int i = 0; i < 9; i++) cell[i] = count == 9 ? numbers[i] : i % 4 == 0 ? numbers[i / 4] : 0;
    return true;
}

static bool read_directions(const char *text, int open[3]) {
    for (int k = 0; k < 3; k++) open[k] = text && !strchr(text, "xyz"[k]);
    return !text || (*text && strspn(text, "xyz") == strlen(text));
}

/* Takes what the options say of cell and directions. Without --cell the cell is that of the file, which the mesh has.
 * points  NULL: the file was not read yet. */
static brio_status take(run *r, const periodic_options *p, const brio_mesh *points, double cell[9],
                        brio_periodic_options *o) {
    int open[3];
    if (p->cell && !read_cell(p->cell, cell))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--cell: '%s' is neither ax,ay,az,bx,by,bz,cx,cy,cz nor lx,ly,lz",
                        p->cell);
    if (!read_directions(p->directions, o->open))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--periodic: '%s' is not made of the letters x, y and z", p->directions);
    if (!p->cell && points && !brio_mesh_cell(points, cell, open))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--periodic without --cell, but %s has no cell", r->operands[0]);
    o->size = sizeof *o;
    o->cell = cell;
    o->seed = r->common.seed;
    return BRIO_OK;
}

brio_status cli_check_periodic(run *r, const periodic_options *p) {
    brio_periodic_options o = {0};
    double cell[9];
    return take(r, p, NULL, cell, &o);
}

void cli_tell_cell(run *r, const periodic_options *p, const brio_mesh *points) {
    char letters[4] = "";
    double cell[9];
    int open[3];
    size_t count = 0;
    if (cli_is_periodic(p) || !brio_mesh_cell(points, cell, open)) return;
    for (int k = 0; k < 3; k++)
        if (!open[k]) letters[count++] = "xyz"[k];
    if (count) cli_warn(r, WARNING_CELL, r->operands[0], letters);
}

/* --- memory --- */

brio_status cli_periodic_delaunay_bytes(run *r, const periodic_options *p, const brio_mesh *mesh, const double *weights,
                                        double *bytes) {
    brio_periodic_options o = {0};
    double cell[9];
    uint64_t work = 0;
    FORWARD(take(r, p, mesh, cell, &o));
    FORWARD(brio_estimate_periodic(r->ctx, mesh->vertices, weights, mesh->num_vertices, &o, &work));
    *bytes = CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh) + (weights ? sizeof(double) * (double)mesh->num_vertices : 0) +
             (double)work;
    return BRIO_OK;
}

/* Estimates what goes by the tetrahedra, of which a point has the usual number. */
static brio_status add_bytes(run *r, const periodic_options *p, const brio_mesh *mesh, const double *weights,
                             double a_point, double *bytes) {
    size_t usual;
    FORWARD(cli_periodic_delaunay_bytes(r, p, mesh, weights, bytes));
    FORWARD(cli_usual_points(r, mesh, weights, false, &usual));
    *bytes += a_point * (double)usual;
    return BRIO_OK;
}

/* Bytes a point beyond those of the triangulation were measured on 20,000 and 100,000 uniform points. */

brio_status cli_periodic_cells_bytes(run *r, const periodic_options *p, const brio_mesh *mesh, const double *weights,
                                     bool vertices, double *bytes) {
    static const double CELL = 1850, VERTICES = 1000;
    return add_bytes(r, p, mesh, weights, CELL + (vertices ? VERTICES : 0), bytes);
}

brio_status cli_periodic_alpha_bytes(run *r, const periodic_options *p, const brio_mesh *mesh, const double *weights,
                                     bool filtration, double *bytes) {
    static const double COMPLEX = 1300, BY_POINTS = 840;
    return add_bytes(r, p, mesh, weights, COMPLEX + (filtration ? BY_POINTS : 0), bytes);
}

brio_status cli_periodic_locate_bytes(run *r, const periodic_options *p, const brio_mesh *mesh, const double *weights,
                                      const brio_mesh *places, double *bytes) {
    static const double LOCATOR = 50, PLACE = 40;
    FORWARD(add_bytes(r, p, mesh, weights, LOCATOR, bytes));
    *bytes += cli_mesh_bytes(places) + PLACE * (double)places->num_vertices;
    return BRIO_OK;
}

/* --- the triangulation --- */

brio_status cli_periodic(run *r, const periodic_options *p, const brio_mesh *mesh, const double *weights,
                         brio_periodic **out) {
    brio_periodic_options o = {0};
    double cell[9];
    facts *f = &r->facts;
    *out = NULL;
    FORWARD(take(r, p, mesh, cell, &o));
    FORWARD(brio_delaunay_periodic(r->ctx, mesh->vertices, weights, mesh->num_vertices, &o, out));
    const brio_periodic_stats *s = brio_periodic_facts(*out);
    cli_lap(r, "insert");
    cli_fact_bool(f, "weighted", weights != NULL);
    cli_fact_text(f, "periodic", p->directions ? p->directions : "xyz");
    cli_fact_count(f, "points", s->points);
    cli_fact_count(f, "duplicates", s->duplicates);
    cli_fact_count(f, "hidden", s->hidden);
    cli_fact_integer(f, "dimension", s->dimension);
    cli_fact_open(f, "cell", FACT_LIST);
    for (int i = 0; i < 9; i++) cli_fact_real(f, NULL, s->cell[i]);
    cli_fact_close(f);
    cli_fact_real(f, "cell_volume", s->cell_volume);
    cli_fact_real(f, "moved", fmax(s->moved, s->cell_moved));
    cli_fact_count(f, "triangulated", s->triangulated);
    cli_fact_count(f, "completed", s->completed);
    return BRIO_OK;
}
