/* brio iso: the iso-surface of a map, or of the atoms in a PDB file, with its certificate. */
#include "cli/files/read_write.h"
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/estimate.h"
#include <math.h>

typedef struct arguments {
    double level, blobbiness; /* NaN: not given */
    uint64_t resolution, vertices;
    bool sigma, conforming, vertex_normals, self_intersections;
} arguments;

#define FIELD(name) offsetof(arguments, name)
static const option options[] = {
    {"level", 0, OPTION_NUMBER, FIELD(level), "L", "the value on the surface; for atoms 1 is their own radius", 0},
    {"sigma", 0, OPTION_FLAG, FIELD(sigma), NULL, "the level is in standard deviations above the map's mean", 0},
    {"resolution", 0, OPTION_NATURAL | OPTION_POSITIVE, FIELD(resolution), "R",
     "cells along the longest side (default the map's own, or 0.5 A for atoms)", 0},
    {"points", 'n', OPTION_NATURAL | OPTION_POSITIVE, FIELD(vertices), "N",
     "choose the resolution for about N vertices", 0},
    {"blobbiness", 0, OPTION_NUMBER | OPTION_POSITIVE, FIELD(blobbiness), "B",
     "atoms: the larger, the closer to spheres (default 2)", 0},
    {"delaunay-conforming", 0, OPTION_FLAG, FIELD(conforming), NULL, "all triangles are Delaunay", 0},
    {"vertex-normals", 0, OPTION_FLAG, FIELD(vertex_normals), NULL, "give the vertices normals, as properties nx ny nz",
     0},
    {"self-intersections", 0, OPTION_FLAG, FIELD(self_intersections), NULL,
     "count the pairs of faces that run through each other", 0},
    {0},
};
#undef FIELD

static const arguments defaults = {.level = NAN, .blobbiness = NAN};

static brio_status check_arguments(run *r, const arguments *a) {
    if (isnan(a->level)) return cli_fail(r, BRIO_ERR_ARGUMENT, "the level of the surface is missing: --level L");
    if (a->vertices && a->resolution)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "-n chooses the resolution: give one of -n and --resolution");
    brio_status status = cli_require_output_for(r, "vertex-normals", a->vertex_normals);
    return status == BRIO_OK ? cli_require_output(r, false) : status;
}

static brio_status iso(run *r) {
    const arguments *a = r->arguments;
    brio_iso_surface_options o = {0};
    brio_mesh *mesh = NULL;
    brio_status status = BRIO_OK;
    TRY(cli_refuse_input_options(r));
    TRY(check_arguments(r, a));
    o.deviations = a->sigma;
    o.conforming = a->conforming;
    o.resolution = (size_t)a->resolution;
    if (!isnan(a->blobbiness)) o.blobbiness = a->blobbiness;
    o.vertices = (size_t)a->vertices;
    if (o.vertices) TRY(cli_require_work(r, BRIO_OK, NULL, brio_estimate_iso_surface(o.vertices)));
    TRY(brio_iso_surface(r->ctx, r->operands[0], a->level, &o, &mesh));
    cli_lap(r, "iso");
    cli_fact_count(&r->facts, "points", mesh->num_vertices);
    cli_fact_count(&r->facts, "vertices", mesh->num_vertices);
    cli_fact_count(&r->facts, "faces", mesh->num_faces);
    if (a->vertex_normals) TRY(brio_mesh_add_normals(mesh));
    TRY(cli_certify(r, mesh, a->self_intersections ? CERTIFY_COUNTED : 0u));
    TRY(cli_write(r, mesh));
done:
    brio_mesh_free(mesh);
    return status;
}

const command cli_iso = {
    .name = "iso",
    .operands = "IN",
    .summary = "iso-surface of a map, or of atoms",
    .description =
        "The surface on which the values of a map, or the density of atoms, have a given level. In version 0.1 it "
        "was called brio generate iso, which still works.",
    .examples =
        "brio iso emd_1234.map --level 2 --sigma -o surface.ply\ntwo standard deviations above the mean of the map\n"
        "brio iso 1abc.pdb --level 1 -n 50000 -o molecule.ply\natoms at their own radii, about 50000 vertices\n",
    .inputs = ".map .mrc .ccp4 .pdb .ent",
    .has_output = true,
    .holds = CLI_SURFACES,
    .group = GROUP_SURFACES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = iso,
};
