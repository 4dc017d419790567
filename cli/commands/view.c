/* brio view: a page that shows files in a browser. */
#include "cli/files/files.h"
#include "cli/files/read_write.h"
#include "cli/run/commands.h"
#include <string.h>

/* Layers of a page: its program has as many colours that are told apart. */
enum { MOST_FILES = 12 };

typedef struct arguments {
    bool self_intersections, side_by_side, exact;
    const char *title;
    uint64_t points;
} arguments;

static const option options[] = {
    {"self-intersections", 0, OPTION_FLAG, offsetof(arguments, self_intersections), NULL,
     "find the faces that run through each other, and show them", 0},
    {"side-by-side", 0, OPTION_FLAG, offsetof(arguments, side_by_side), NULL,
     "open with the files side by side, instead of over each other", 0},
    {"points", 0, OPTION_NATURAL | OPTION_POSITIVE, offsetof(arguments, points), "N",
     "thin clouds of more points evenly to N (default 5e6)", 0},
    {"exact", 0, OPTION_FLAG, offsetof(arguments, exact), NULL,
     "every number to the last bit, also of more than 250,000 vertices", 0},
    {"title", 0, OPTION_TEXT, offsetof(arguments, title), "TEXT", "title of the page (default: the files' names)", 0},
    {0},
};

static const arguments defaults = {0};

static void report(run *r, brio_mesh *const *meshes, int count) {
    uint64_t vertices = 0, faces = 0, tetrahedra = 0, edges = 0;
    for (int i = 0; i < count; i++) {
        vertices += meshes[i]->num_vertices;
        faces += meshes[i]->num_faces;
        tetrahedra += meshes[i]->num_tetrahedra;
        edges += meshes[i]->num_edges;
    }
    cli_fact_count(&r->facts, "layers", (uint64_t)count);
    cli_fact_count(&r->facts, "vertices", vertices);
    cli_fact_count(&r->facts, "faces", faces);
    cli_fact_count(&r->facts, "tetrahedra", tetrahedra);
    cli_fact_count(&r->facts, "edges", edges);
}

/* Refuses outputs that are no page, options about the form of other files, and those of a page where there is none. */
static brio_status check_output(run *r) {
    const common_options *c = &r->common;
    const arguments *a = r->arguments;
    const char *idle = a->points ? "points" : a->exact ? "exact" : a->title ? "title" : NULL;
    const char *given = c->format ? "format" : c->ascii ? "ascii" : c->float32 ? "float32" : NULL;
    if (!c->output && !c->picture) return cli_fail_output(r, "no output: -o FILE is missing");
    if (given) return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s has no meaning here: a page has one form", given);
    if (idle && !c->output) return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s has no meaning without a page: -o FILE", idle);
    return c->output && strcmp(c->output, "-") ? cli_check_page(r, "output", c->output) : BRIO_OK;
}

static brio_status view(run *r) {
    const arguments *a = r->arguments;
    brio_mesh *meshes[MOST_FILES] = {NULL};
    brio_page_layer layers[MOST_FILES] = {{0}};
    const brio_page_layer *list[MOST_FILES];
    brio_page_options o = {.size = sizeof o,
                           .title = a->title,
                           .most_points = (size_t)a->points,
                           .exact = a->exact,
                           .self_intersections = a->self_intersections,
                           .side_by_side = a->side_by_side};
    brio_status status = BRIO_OK;
    TRY(check_output(r));
    for (int i = 0; i < r->num_operands; i++) {
        TRY(cli_read(r, r->operands[i], &meshes[i]));
        layers[i].mesh = meshes[i];
        layers[i].name = cli_page_name(r->operands[i]);
        list[i] = &layers[i];
    }
    report(r, meshes, r->num_operands);
    if (r->common.output) TRY(cli_write_page(r, r->common.output, list, (size_t)r->num_operands, &o));
    if (r->common.picture) TRY(cli_write_picture(r, list, (size_t)r->num_operands, &o));
    r->shown = true;
done:
    for (int i = 0; i < MOST_FILES; i++) brio_mesh_free(meshes[i]);
    return status;
}

const command cli_view = {
    .name = "view",
    .operands = "FILE ...",
    .summary = "one page that shows files in a browser, or a picture: points, surfaces, tetrahedra",
    .description =
        "The page is one HTML file that needs no network and no installation. It shows colours and properties, the "
        "certificate of faces, boundaries and edges of more than two faces, and tetrahedra with a cutting plane. "
        "Several files are layers of one scene, or stand side by side.",
    .examples = "brio view surface.ply -o page.html\nopen page.html in a browser\n"
                "brio view scan.ply surface.ply -o both.html\nthe points over their surface\n"
                "brio view before.ply after.ply --side-by-side -o compare.html\nturned together\n"
                "brio view surface.ply --picture surface.png\na picture, without a browser\n",
    .has_output = true,
    .shows = true,
    .outputs = ".html .htm",
    .group = GROUP_FILES,
    .min_operands = 1,
    .max_operands = MOST_FILES,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = view,
};
