/* brio simplify: fewer triangles for the same surface. */
#include "cli/files/read_write.h"
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/hints.h"

typedef struct arguments {
    uint64_t faces;
    double error;
} arguments;

static const option options[] = {
    {"faces", 0, OPTION_NATURAL | OPTION_POSITIVE, offsetof(arguments, faces), "N",
     "stop at N triangles, as far as borders, topology and crossings allow", 0},
    {"error", 0, OPTION_NUMBER | OPTION_POSITIVE, offsetof(arguments, error), "D",
     "keep new vertices within D of the planes of the triangles that they stand for (root of the mean of squares)", 0},
    {0},
};

static const arguments defaults = {0};

/* Beyond this share more than N faces the user is told. */
static const double NEAR = 0.01;

static brio_status simplify(run *r) {
    const arguments *a = r->arguments;
    brio_mesh_simplify_options o = {0};
    brio_mesh *mesh = NULL;
    brio_status status = BRIO_OK;
    if (!a->faces && !(a->error > 0)) FAIL(r, BRIO_ERR_ARGUMENT, "simplify: --faces N or --error D is missing");
    TRY(cli_require_output(r, false));
    TRY(cli_read(r, r->operands[0], &mesh));
    if (!mesh->num_faces) FAIL(r, BRIO_ERR_NO_ANSWER, "%s: has no faces", r->operands[0]);
    if (mesh->num_edges || mesh->num_tetrahedra)
        FAIL(r, BRIO_ERR_NO_ANSWER, "%s: has %s: only faces are simplified", r->operands[0],
             mesh->num_edges ? "edges that no face has" : "tetrahedra");
    size_t before = mesh->num_faces;
    o.target_faces = (size_t)a->faces;
    o.tolerance = a->error;
    o.any = 1;
    TRY(brio_mesh_simplify(r->ctx, mesh, &o));
    cli_lap(r, "simplify");
    cli_fact_count(&r->facts, "faces_before", before);
    cli_fact_count(&r->facts, "vertices", mesh->num_vertices);
    cli_fact_count(&r->facts, "faces", mesh->num_faces);
    if (a->faces && !(a->error > 0) && (double)mesh->num_faces > (1 + NEAR) * (double)a->faces && before > a->faces)
        cli_warn(r, WARNING_MORE_FACES, mesh->num_faces, (size_t)a->faces);
    TRY(cli_certify(r, mesh, CERTIFY_OPEN | CERTIFY_INPUT | CERTIFY_ANYTHING));
    TRY(cli_write(r, mesh));
done:
    brio_mesh_free(mesh);
    return status;
}

const command cli_simplify = {
    .name = "simplify",
    .operands = "IN",
    .summary = "fewer triangles for the same surface, of any mesh",
    .description =
        "Edges collapse, those that change the surface least first. Components, handles and borders stay, and no faces "
        "come to cross each other. Vertices and faces that stay keep their properties.",
    .examples = "brio simplify mesh.ply --faces 10000 -o small.ply\nat most 10,000 triangles\n"
                "brio simplify mesh.stl --error 0.01 -o small.stl\nas few as stay within a hundredth\n",
    .has_output = true,
    .holds = CLI_SURFACES,
    .group = GROUP_FILES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = simplify,
};
