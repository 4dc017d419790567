/* brio info: what is in a file, and how much memory each command would take for it. */
#include "cloud.h"
#include "commands.h"
#include "estimate.h"
#include "weights.h"
#include <stdlib.h>

static const option options[] = {{0}};
static const char defaults = 0; /* info has no options of its own */

static void report_vector(facts *f, const char *name, const double v[3]) {
    cli_fact_open(f, name, FACT_LIST);
    for (int k = 0; k < 3; k++) cli_fact_real(f, NULL, v[k]);
    cli_fact_close(f);
}

static void report_box(facts *f, const brio_mesh *mesh) {
    double low[3], high[3];
    if (!mesh->num_vertices) {
        cli_fact_null(f, "box");
        return;
    }
    cli_cloud_box(mesh->vertices, mesh->num_vertices, low, high);
    cli_fact_open(f, "box", FACT_OBJECT);
    report_vector(f, "min", low);
    report_vector(f, "max", high);
    cli_fact_close(f);
}

static void report_properties(facts *f, const brio_mesh *mesh) {
    static const char *const types[] = {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};
    cli_fact_open(f, "properties", FACT_OBJECT);
    for (size_t i = 0; i < mesh->num_properties; i++)
        cli_fact_text(f, mesh->properties[i].name, types[mesh->properties[i].type]);
    cli_fact_close(f);
}

/* Estimates of the commands that go by the triangulation. */
static brio_status report_triangulations(run *r, const brio_mesh *mesh) {
    static const weights_options standard = {.exponent = NO_EXPONENT, .estimate = true};
    facts *f = &r->facts;
    double *weights = NULL, beside = CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh), delaunay, cells, places;
    size_t n = mesh->num_vertices;
    brio_status status = BRIO_OK;
    TRY(cli_weights(r, &standard, mesh, &weights));
    TRY(cli_delaunay_bytes(r, mesh, weights, NULL, &delaunay));
    TRY(cli_voronoi_bytes(r, mesh, weights, true, &cells));
    TRY(cli_locate_bytes(r, mesh, weights, NULL, &places));
    cli_fact_bytes(f, "delaunay", (uint64_t)delaunay);
    cli_fact_bytes(f, "plane", (uint64_t)(beside + (double)brio_estimate_delaunay2(n, weights != NULL)));
    cli_fact_bytes(f, "voronoi", (uint64_t)cells);
    cli_fact_bytes(f, "hull", (uint64_t)cli_hull_bytes(mesh));
    cli_fact_bytes(f, "alpha", (uint64_t)cli_alpha_bytes(mesh));
    cli_fact_bytes(f, "locate", (uint64_t)places);
    cli_fact_bytes(f, "interpolate", (uint64_t)places);
done:
    free(weights);
    return status;
}

/* Estimates of surfaces and axes. */
static brio_status report_surfaces(run *r, const brio_mesh *mesh) {
    facts *f = &r->facts;
    double beside = CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh);
    uint64_t surface, crust, cocone;
    brio_status status = BRIO_OK;
    TRY(brio_estimate_labeled_delaunay(r->ctx, mesh->num_vertices, NULL, &surface));
    TRY(brio_estimate_power_crust(r->ctx, mesh->num_vertices, NULL, &crust));
    TRY(brio_estimate_cocone(r->ctx, mesh->num_vertices, NULL, &cocone));
    static const char *const of_poles[] = {"medial", "offset"};
    cli_fact_bytes(f, "surface", (uint64_t)(beside + (double)surface));
    for (int i = 0; i < 2; i++) cli_fact_bytes(f, of_poles[i], (uint64_t)(beside + (double)crust));
    cli_fact_bytes(f, "cocone", (uint64_t)(beside + (double)cocone));
    if (mesh->num_faces) {
        double subdivide = (double)brio_estimate_mesh_subdivide(mesh->num_faces, 1);
        cli_fact_bytes(f, "subdivide", (uint64_t)(CLI_PROGRAM_BYTES + subdivide));
    }
done:
    return status;
}

static brio_status report_estimates(run *r, const brio_mesh *mesh) {
    cli_fact_open(&r->facts, "estimate_bytes", FACT_OBJECT);
    brio_status status = report_triangulations(r, mesh);
    if (status == BRIO_OK) status = report_surfaces(r, mesh);
    cli_fact_close(&r->facts);
    return status;
}

static brio_status info(run *r) {
    brio_mesh *mesh = NULL;
    size_t duplicates;
    double spacing;
    facts *f = &r->facts;
    brio_status status = BRIO_OK;
    if (r->common.output) TRY(cli_fail(r, BRIO_ERR_ARGUMENT, "info writes no file; -o has no meaning here"));
    TRY(cli_read(r, r->operands[0], &mesh));
    TRY(cli_require_memory(r, cli_info_bytes(mesh)));
    TRY(cli_cloud_duplicates(r, mesh->vertices, mesh->num_vertices, &duplicates));
    TRY(cli_cloud_spacing(r, mesh->vertices, mesh->num_vertices, &spacing));
    cli_lap(r, "measure");
    cli_fact_count(f, "points", mesh->num_vertices);
    cli_fact_count(f, "faces", mesh->num_faces);
    cli_fact_count(f, "tetrahedra", mesh->num_tetrahedra);
    report_box(f, mesh);
    cli_fact_count(f, "duplicates", duplicates);
    if (spacing > 0)
        cli_fact_real(f, "spacing", spacing);
    else
        cli_fact_null(f, "spacing");
    report_properties(f, mesh);
    TRY(report_estimates(r, mesh));
done:
    brio_mesh_free(mesh);
    return status;
}

const command cli_info = {
    .name = "info",
    .operands = "FILE",
    .summary = "what is in a file: counts, box, spacing, memory for each command",
    .examples = "brio info scan.ply\nbefore anything else\n",
    .group = GROUP_FILES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = info,
};
