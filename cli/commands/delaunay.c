/* brio delaunay: tetrahedra, or with --plane triangles, of the points of a file, weighted or not. */
#include "cli/files/files.h"
#include "cli/files/read_write.h"
#include "cli/run/commands.h"
#include "cli/run/run.h"
#include "cli/steps/estimate.h"
#include "cli/steps/order.h"
#include "cli/steps/periodic.h"
#include "cli/steps/plane.h"
#include "cli/steps/properties.h"
#include "cli/steps/tiles.h"
#include "cli/steps/weights.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- edges to go along --- */

/* Chooses and makes the subgraph of a mesh's edges that a location goes along. */

/** In place of a brio_subgraph: the one that suits the location. */
enum { SUBGRAPH_FITTING = BRIO_SUBGRAPH_END };

extern const option_choice cli_subgraphs[];

const option_choice cli_subgraphs[] = {{"bounded", BRIO_SUBGRAPH_BOUNDED},
                                       {"mst", BRIO_SUBGRAPH_MINIMUM},
                                       {"tree", BRIO_SUBGRAPH_TREE},
                                       {"all", BRIO_SUBGRAPH_ALL},
                                       {NULL, 0}};

/* Returns whether a location goes along edges. */
static bool needs_edges(brio_location location) {
    return location == BRIO_LOCATION_TRACE || location == BRIO_LOCATION_NEIGHBOUR;
}

static brio_status report_edges(run *r, const brio_mesh *mesh, brio_subgraph kind, const brio_edges *edges) {
    uint32_t *degree = calloc(mesh->num_vertices + 1, sizeof *degree), most = 0;
    if (!degree)
        return cli_fail(r, BRIO_ERR_NO_MEMORY, "no memory for the degrees of %zu vertices", mesh->num_vertices);
    for (size_t i = 0; i < 2 * edges->count; i++) {
        uint32_t d = ++degree[edges->ends[i]];
        if (d > most) most = d;
    }
    free(degree);
    const option_choice *name = cli_subgraphs;
    while (name->value != (int)kind) name++;
    cli_fact_open(&r->facts, "subgraph", FACT_OBJECT);
    cli_fact_text(&r->facts, "kind", name->name);
    cli_fact_count(&r->facts, "edges", edges->count);
    cli_fact_count(&r->facts, "max_degree", most);
    cli_fact_close(&r->facts);
    return BRIO_OK;
}

/* Lists the edges of a subgraph, and reports which. Fitting is for a trace the bounded one or, of a mesh that has none,
 * the
 *  minimum spanning tree; for a neighbour all edges. The time is lapped as `subgraph`. A mesh without faces is a fault
 *  of the file. */
static brio_status cli_mesh_edges(run *r, const brio_mesh *mesh, brio_location location, int subgraph,
                                  brio_edges *out) {
    brio_status status = BRIO_OK;
    bool fitting = subgraph == SUBGRAPH_FITTING;
    brio_subgraph kind = (brio_subgraph)subgraph;
    if (!mesh->num_faces) {
        cli_hint(r, HINT_SURFACE);
        return cli_fail(r, BRIO_ERR_FORMAT, "%s: expected a surface mesh to go along, found no faces", r->operands[0]);
    }
    if (fitting) kind = location == BRIO_LOCATION_TRACE ? BRIO_SUBGRAPH_BOUNDED : BRIO_SUBGRAPH_ALL;
    status = brio_mesh_subgraph(r->ctx, mesh, kind, out);
    if (status == BRIO_ERR_NO_ANSWER && fitting) {
        kind = BRIO_SUBGRAPH_MINIMUM;
        status = brio_mesh_subgraph(r->ctx, mesh, kind, out);
    }
    TRY(status);
    TRY(report_edges(r, mesh, kind, out));
    cli_lap(r, "subgraph");
done:
    return status;
}

/* --- the command --- */

typedef struct arguments {
    weights_options weights;
    periodic_options periodic;
    order_options order;
    int locate, subgraph, plane;
    uint64_t record_every, tiles; /* 0: not given */
    size_t page_size, cache_size; /* 0: not given */
    bool first_conflict, all_conflicts, rounds, verify, neighbours, faces, edges;
} arguments;

static const option_choice locations[] = {{"walk", BRIO_LOCATION_WALK},
                                          {"jump", BRIO_LOCATION_JUMP},
                                          {"hierarchy", BRIO_LOCATION_HIERARCHY},
                                          {"history", BRIO_LOCATION_HISTORY},
                                          {"trace", BRIO_LOCATION_TRACE},
                                          {"neighbour", BRIO_LOCATION_NEIGHBOUR},
                                          {NULL, 0}};

#define FIELD(name) offsetof(arguments, name)
static const option options[] = {
    WEIGHTS_ROWS(arguments, weights),
    {"plane", 0, OPTION_CHOICE, FIELD(plane), "NAME", "triangles of two coordinates instead of tetrahedra", cli_planes},
    TILES_ROWS(arguments, tiles),
    {"verify", 0, OPTION_FLAG, FIELD(verify), NULL, "check the result exactly and completely", 0},
    PERIODIC_ROWS(arguments, periodic),
    {"", 0, OPTION_TITLE, 0, NULL, "how points are inserted (the result is the same)", 0},
    ORDER_ROWS(arguments, order, "; for trace random"),
    {"locate", 0, OPTION_CHOICE, FIELD(locate), "NAME", "how a point finds its tetrahedron (default walk)", locations},
    {"first-conflict", 0, OPTION_FLAG, FIELD(first_conflict), NULL,
     "history, trace: search depth first for a conflict, as the program hull, not along one path", 0},
    {"all-conflicts", 0, OPTION_FLAG, FIELD(all_conflicts), NULL, "history, trace: follow all conflicts, not one path",
     0},
    {"subgraph", 0, OPTION_CHOICE, FIELD(subgraph), "NAME",
     "trace, neighbour: edges of IN, a surface mesh, to go along (default bounded for trace, all for neighbour)",
     cli_subgraphs},
    {"rounds", 0, OPTION_FLAG, FIELD(rounds), NULL, "report the counters at the end of each round", 0},
    {"neighbors", 0, OPTION_FLAG, FIELD(neighbours), NULL, "-o x.node: also x.neigh, the neighbours of tetrahedra", 0},
    {"faces", 0, OPTION_FLAG, FIELD(faces), NULL, "-o x.node: also x.face, their facets, with those of the hull marked",
     0},
    {"edges", 0, OPTION_FLAG, FIELD(edges), NULL, "-o x.node: also x.edge, their edges, with those of the hull marked",
     0},
    {"record-every", 0, OPTION_NATURAL | OPTION_POSITIVE, FIELD(record_every), "N",
     "report the counters after every N insertions", 0},
    {"page-size", 0, OPTION_SIZE | OPTION_POSITIVE, FIELD(page_size), "SIZE",
     "count touches of pages of that size, a power of two, with one thread", 0},
    {"cache-size", 0, OPTION_SIZE | OPTION_POSITIVE, FIELD(cache_size), "SIZE",
     "of the cache in which --page-size counts faults (default one page)", 0},
    {0},
};
#undef FIELD

static const arguments defaults = {
    .weights.exponent = NO_EXPONENT, .order = NO_ORDER_OPTIONS, .subgraph = SUBGRAPH_FITTING, .plane = NO_PLANE};

static int insertion_order(const arguments *a) {
    bool random = a->order.order == FITTING_ORDER && a->locate == (int)BRIO_LOCATION_TRACE;
    return random ? BRIO_ORDER_RANDOM : cli_order_of(&a->order);
}

/* Refuses options of tetrahedra. */
static brio_status check_plane(run *r, const arguments *a) {
    bool three = a->locate != (int)BRIO_LOCATION_WALK || a->all_conflicts || a->rounds || a->first_conflict ||
                 a->record_every || a->page_size || a->cache_size || a->subgraph != SUBGRAPH_FITTING;
    if (three)
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "--plane goes with orders, --verify and weights, not with locations or records");
    return cli_require_output_holding(r, CLI_SURFACES, true);
}

/* Refuses options that say how all points are inserted at once. */
static brio_status check_tiles(run *r, const arguments *a) {
    bool once = a->locate != (int)BRIO_LOCATION_WALK || a->all_conflicts || a->rounds || a->first_conflict ||
                a->record_every || a->page_size || a->cache_size || a->subgraph != SUBGRAPH_FITTING || a->verify ||
                a->plane != NO_PLANE || a->order.order != FITTING_ORDER || a->order.block_size ||
                !isnan(a->order.round_ratio);
    if (once)
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "--tiles goes with weights, -o, --view and --picture, not with --plane, --verify, orders, "
                        "locations or records");
    FORWARD(cli_check_tiles(r, &a->weights, a->tiles));
    return cli_check_tile_output(r, ".pvtu");
}

/* Refuses the files beside .node and .ele where these are not written. */
static brio_status check_beside_node(run *r, const arguments *a) {
    const char *name = a->neighbours ? "neighbors" : a->faces ? "faces" : "edges", *output = r->common.output;
    bool node = output && brio_format_of(r->common.format ? r->common.format : output) == BRIO_FORMAT_NODE;
    r->neighbours = a->neighbours;
    r->faces = a->faces;
    r->edges = a->edges;
    if (!a->neighbours && !a->faces && !a->edges) return BRIO_OK;
    if (a->plane != NO_PLANE) return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s: not with --plane", name);
    if (!node)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s: only with -o x.node, beside which the file is written", name);
    return BRIO_OK;
}

/* Refuses options that space that repeats has not. */
static brio_status check_periodic(run *r, const arguments *a) {
    FORWARD(cli_check_periodic(r, &a->periodic));
    bool open = a->locate != (int)BRIO_LOCATION_WALK || a->all_conflicts || a->rounds || a->first_conflict ||
                a->record_every || a->page_size || a->cache_size || a->subgraph != SUBGRAPH_FITTING ||
                a->plane != NO_PLANE || a->order.order != FITTING_ORDER || a->tiles;
    if (cli_is_periodic(&a->periodic) && open)
        return cli_fail(
            r, BRIO_ERR_ARGUMENT,
            "--cell goes with --verify and weights, not with --plane, --tiles, orders, locations or records");
    return BRIO_OK;
}

static brio_status check_arguments(run *r, const arguments *a) {
    brio_status status = BRIO_OK;
    TRY(cli_check_order(r, &a->order, insertion_order(a)));
    TRY(cli_check_weights_options(r, &a->weights));
    TRY(check_beside_node(r, a));
    TRY(check_periodic(r, a));
    if (a->tiles) return check_tiles(r, a);
    if (a->plane != NO_PLANE) return check_plane(r, a);
    TRY(cli_require_output(r, true));
    const char *output = r->common.output;
    if (output && cli_is_single(output) && r->common.format && brio_format_of(r->common.format) == BRIO_FORMAT_NODE)
        return cli_fail_output(r, "%s cannot hold the two files .node and .ele",
                               strcmp(output, "-") ? output : "standard output");
    if (a->rounds && a->record_every) return cli_fail(r, BRIO_ERR_ARGUMENT, "only one of --rounds and --record-every");
    if (a->all_conflicts && a->first_conflict)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "only one of --first-conflict and --all-conflicts");
    if ((a->all_conflicts || a->first_conflict) && a->locate != BRIO_LOCATION_HISTORY &&
        a->locate != BRIO_LOCATION_TRACE)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--%s goes with --locate history and trace only",
                        a->all_conflicts ? "all-conflicts" : "first-conflict");
    if (a->page_size & (a->page_size - 1) || (a->page_size && a->page_size < 64))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--page-size: %zu bytes are no power of two from 64 on", a->page_size);
    if (a->cache_size && !a->page_size)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--cache-size goes with --page-size only");
    if (a->subgraph != SUBGRAPH_FITTING && !needs_edges((brio_location)a->locate))
        status = cli_fail(r, BRIO_ERR_ARGUMENT, "--subgraph goes with --locate trace and neighbour only");
done:
    return status;
}

/* Begins the experiment that the options ask for, along edges where the location wants them. */
static brio_status begin_experiment(run *r, const arguments *a, const brio_edges *edges) {
    brio_laboratory_options lab = {.locate = (brio_location)a->locate,
                                   .first_conflict = a->first_conflict,
                                   .all_conflicts = a->all_conflicts,
                                   .page_bytes = a->page_size,
                                   .cache_bytes = a->cache_size,
                                   .edges = edges->ends,
                                   .num_edges = edges->count,
                                   .record_every = a->rounds ? BRIO_RECORD_ROUNDS : a->record_every};
    cli_order_experiment(&a->order, &lab);
    return cli_experiment(r, &lab);
}

static brio_delaunay_options library_options(const run *r, const arguments *a) {
    brio_delaunay_options o = {0};
    o.order = cli_library_order(insertion_order(a));
    o.seed = r->common.seed;
    o.leave_hidden = !cli_wants_mesh(r) && !a->verify; /* a report counts them, but names none */
    if (!isnan(a->order.round_ratio)) o.round_ratio = a->order.round_ratio;
    return o;
}

static brio_status require_memory(run *r, const arguments *a, const brio_mesh *mesh, const double *weights) {
    brio_edges expected = {.count = mesh->num_faces ? (size_t)mesh->face_offsets[mesh->num_faces] / 2 : 0};
    brio_delaunay_options o = library_options(r, a);
    double bytes;
    if (cli_is_periodic(&a->periodic)) {
        FORWARD(cli_periodic_delaunay_bytes(r, &a->periodic, mesh, weights, &bytes));
        return cli_require_memory(r, bytes);
    }
    FORWARD(begin_experiment(r, a, &expected));
    brio_status status = cli_delaunay_bytes(r, mesh, weights, &o, &bytes);
    brio_laboratory_end(r->lab);
    return status == BRIO_OK ? cli_require_memory(r, bytes) : status;
}

/* Goes along the edges of the mesh where the location wants them; its faces are dropped before the triangulation. */
static brio_status triangulate(run *r, const arguments *a, brio_mesh *mesh, const double *weights,
                               brio_triangulation **out) {
    brio_status status = BRIO_OK;
    brio_edges edges = {0};
    if (needs_edges((brio_location)a->locate))
        TRY(cli_mesh_edges(r, mesh, (brio_location)a->locate, a->subgraph, &edges));
    TRY(cli_drop_connectivity(r, mesh));
    brio_delaunay_options o = library_options(r, a);
    TRY(begin_experiment(r, a, &edges));
    TRY(brio_delaunay(r->ctx, mesh->vertices, weights, mesh->num_vertices, &o, out));
    const brio_delaunay_stats *s = brio_triangulation_stats(*out);
    cli_stage(r, "order", s->order_seconds);
    cli_stage(r, "insert", s->insert_seconds);
    r->lap = cli_clock();
    TRY(cli_check_interrupt(r));
done:
    brio_laboratory_end(r->lab);
    brio_edges_free(&edges);
    return status;
}

static brio_status report_stats(run *r, const brio_mesh *mesh, const brio_triangulation *t, bool weighted) {
    const brio_delaunay_stats *s = brio_triangulation_stats(t);
    const brio_laboratory_stats *lab = brio_laboratory_results(r->lab);
    facts *f = &r->facts;
    uint64_t checksum;
    brio_status status = brio_triangulation_checksum(r->ctx, t, mesh->vertices, &checksum);
    if (status != BRIO_OK) return status;
    cli_lap(r, "checksum");
    cli_fact_bool(f, "weighted", weighted);
    cli_fact_count(f, "points", s->points);
    cli_fact_count(f, "vertices", s->vertices);
    cli_fact_count(f, "duplicates", s->duplicates);
    cli_fact_count(f, "hidden", s->hidden);
    cli_fact_integer(f, "dimension", s->dimension);
    cli_fact_count(f, "tetrahedra", s->tetrahedra);
    cli_fact_count(f, "hull_facets", s->hull_facets);
    cli_fact_checksum(f, "checksum", checksum);
    cli_fact_count(f, "created", s->created);
    cli_fact_count(f, "destroyed", s->destroyed);
    cli_fact_count(f, "walk_steps", s->walk_steps);
    cli_fact_count(f, "insphere_calls", s->insphere_calls);
    cli_fact_count(f, "exact_calls", s->exact_calls);
    cli_fact_count(f, "deferred", s->deferred);
    cli_fact_count(f, "serial", s->serial);
    cli_fact_count(f, "history", lab->history);
    cli_fact_count(f, "history_tests", lab->history_tests);
    cli_fact_count(f, "history_conflicts", lab->history_conflicts);
    cli_fact_count(f, "trace_intersections", lab->trace_intersections);
    return BRIO_OK;
}

static void report_pages(facts *f, brio_laboratory *lab) {
    size_t count;
    const brio_laboratory_stats *s = brio_laboratory_results(lab);
    const uint64_t *faults = brio_laboratory_cache_faults(lab, &count);
    if (!faults) return;
    cli_fact_count(f, "pages", s->pages);
    cli_fact_count(f, "page_touches", s->page_touches);
    cli_fact_count(f, "page_faults", s->page_faults);
    cli_fact_open(f, "caches", FACT_LIST);
    for (size_t i = 0; i < count; i++) {
        cli_fact_open(f, NULL, FACT_OBJECT);
        cli_fact_count(f, "cache_pages", (uint64_t)1 << i);
        cli_fact_count(f, "page_faults", faults[i]);
        cli_fact_close(f);
    }
    cli_fact_close(f);
}

static void report_rounds(facts *f, const brio_laboratory *lab, bool pages) {
    size_t count;
    const brio_round *round = brio_laboratory_rounds(lab, &count);
    if (!round) return;
    cli_fact_open(f, "rounds", FACT_LIST);
    for (size_t i = 0; i < count; i++) {
        cli_fact_open(f, NULL, FACT_OBJECT);
        cli_fact_count(f, "points", round[i].points);
        cli_fact_count(f, "tetrahedra", round[i].tetrahedra);
        cli_fact_count(f, "created", round[i].created);
        cli_fact_count(f, "destroyed", round[i].destroyed);
        cli_fact_count(f, "walk_steps", round[i].walk_steps);
        cli_fact_count(f, "insphere_calls", round[i].insphere_calls);
        cli_fact_count(f, "history", round[i].history);
        if (pages) cli_fact_count(f, "pages", round[i].pages);
        if (pages) cli_fact_count(f, "page_touches", round[i].page_touches);
        if (pages) cli_fact_count(f, "page_faults", round[i].page_faults);
        cli_fact_seconds(f, "locate_seconds", round[i].locate_seconds);
        cli_fact_seconds(f, "seconds", round[i].seconds);
        cli_fact_close(f);
    }
    cli_fact_close(f);
}

static brio_status verify(run *r, const brio_mesh *mesh, const double *weights, const brio_triangulation *t) {
    brio_status status = brio_triangulation_check(r->ctx, t, mesh->vertices, weights, mesh->num_vertices);
    cli_lap(r, "verify");
    if (status == BRIO_OK || status == BRIO_ERR_CHECK) cli_fact_bool(&r->facts, "verified", status == BRIO_OK);
    return status;
}

/* Fills the mesh with the result and frees the triangulation before the file is written. */
static brio_status write_output(run *r, brio_mesh *mesh, const double *weights, brio_triangulation **t) {
    const arguments *a = r->arguments;
    FORWARD(cli_keep_weights(r, &a->weights, mesh, weights));
    FORWARD(cli_add_representatives(r, mesh, brio_triangulation_representatives(*t)));
    const brio_tetrahedron *tets = brio_triangulation_tetrahedra(*t);
    FORWARD(brio_mesh_set_tetrahedra(mesh, (const uint32_t *)tets, 8, brio_triangulation_stats(*t)->tetrahedra));
    brio_triangulation_free(*t);
    *t = NULL;
    return cli_write(r, mesh);
}

/* --- in space that repeats --- */

/* Makes the mesh of the translates that tetrahedra name: properties say of which point, and which translate. */
static brio_status fill_images(run *r, const brio_periodic *t, brio_mesh *mesh) {
    static const char *const names[] = {"point", "shift_a", "shift_b", "shift_c"};
    const brio_periodic_stats *s = brio_periodic_facts(t);
    const brio_image *image = brio_periodic_images(t);
    void *data;
    FORWARD(brio_mesh_set_vertices(mesh, brio_periodic_positions(t), s->images));
    FORWARD(brio_mesh_set_tetrahedra(mesh, (const uint32_t *)brio_periodic_tetrahedra(t), 8, s->tetrahedra));
    for (int k = 0; k < 4; k++) {
        FORWARD(brio_mesh_add_property(mesh, names[k], k ? BRIO_SCALAR_INT32 : BRIO_SCALAR_UINT32, &data));
        for (size_t i = 0; i < s->images; i++) {
            if (k)
                ((int32_t *)data)[i] = image[i].shift[k - 1];
            else
                ((uint32_t *)data)[i] = image[i].point;
        }
    }
    return cli_check_interrupt(r);
}

static brio_status report_periodic(run *r, const brio_periodic *t) {
    const brio_periodic_stats *s = brio_periodic_facts(t);
    uint64_t checksum;
    FORWARD(brio_periodic_checksum(r->ctx, t, &checksum));
    cli_lap(r, "checksum");
    cli_fact_count(&r->facts, "vertices", s->vertices);
    cli_fact_count(&r->facts, "tetrahedra", s->tetrahedra);
    cli_fact_count(&r->facts, "hull_facets", s->hull_facets);
    cli_fact_checksum(&r->facts, "checksum", checksum);
    return BRIO_OK;
}

static brio_status triangulate_periodic(run *r, const brio_mesh *points, const double *weights) {
    const arguments *a = r->arguments;
    brio_status status = BRIO_OK;
    brio_periodic *t = NULL;
    brio_mesh *mesh = NULL;
    TRY(cli_periodic(r, &a->periodic, points, weights, &t));
    TRY(report_periodic(r, t));
    if (a->verify) {
        status = brio_periodic_check(r->ctx, t);
        cli_lap(r, "verify");
        if (status == BRIO_OK || status == BRIO_ERR_CHECK) cli_fact_bool(&r->facts, "verified", status == BRIO_OK);
        TRY(status);
    }
    if (!cli_wants_mesh(r)) goto done;
    TRY(brio_mesh_new(r->ctx, &mesh));
    TRY(fill_images(r, t, mesh));
    TRY(cli_write(r, mesh));
done:
    brio_mesh_free(mesh);
    brio_periodic_free(t);
    return status;
}

static brio_status delaunay(run *r) {
    const arguments *a = r->arguments;
    brio_mesh *mesh = NULL;
    double *weights = NULL;
    brio_triangulation *t = NULL;
    brio_status status = BRIO_OK;
    TRY(check_arguments(r, a));
    if (a->tiles) return cli_tiles(r, &a->weights, a->tiles);
    TRY(needs_edges((brio_location)a->locate) ? cli_read(r, r->operands[0], &mesh)
                                              : cli_read_points(r, r->operands[0], &mesh));
    bool weighted = cli_is_weighted(&a->weights, mesh);
    TRY(cli_weights(r, &a->weights, mesh, &weights));
    if (a->plane != NO_PLANE) {
        cli_lap(r, "read");
        TRY(cli_keep_weights(r, &a->weights, mesh, weights));
        status = cli_plane(r, a->plane, mesh, weights, &a->order, a->verify);
        goto done;
    }
    if (cli_limits_memory(r)) TRY(require_memory(r, a, mesh, weights));
    cli_lap(r, "read");
    cli_tell_cell(r, &a->periodic, mesh);
    if (cli_is_periodic(&a->periodic)) {
        status = triangulate_periodic(r, mesh, weights);
        goto done;
    }
    TRY(triangulate(r, a, mesh, weights, &t));
    TRY(report_stats(r, mesh, t, weighted));
    report_pages(&r->facts, r->lab);
    report_rounds(&r->facts, r->lab, a->page_size > 0);
    if (a->verify) TRY(verify(r, mesh, weights, t));
    if (cli_wants_mesh(r)) TRY(write_output(r, mesh, weights, &t));
done:
    brio_triangulation_free(t);
    free(weights);
    brio_mesh_free(mesh);
    return status;
}

const command cli_delaunay = {
    .name = "delaunay",
    .operands = "IN",
    .summary = "Delaunay triangulation of points, in space or in a plane; regular with weights",
    .description =
        "Exact for every input: duplicates, grids, points in a plane. The result is the same for every order of the "
        "points and every number of threads. Without -o the result is reported and not written. "
        "With --plane the output is one that 'brio hull' writes, too.",
    .examples =
        "brio delaunay points.ply -o tetrahedra.vtu\ntetrahedra for ParaView\n"
        "brio delaunay points.xyz --verify\nchecks the result exactly; writes nothing\n"
        "brio delaunay lidar.las --plane xy -o terrain.ply\ntriangles over the ground: terrain\n"
        "brio delaunay scan.laz --tiles 16 --scratch /var/tmp -o all.ply\nmore points than fit in memory\n"
        "brio delaunay atoms.xyz --cell 20,20,20 -o periodic.vtu\natoms in a box that repeats\n"
        "brio delaunay atoms.xyz --weights radii2.txt -o regular.vtu\nregular triangulation, one weight a line\n",
    .has_output = true,
    .holds = CLI_TETRAHEDRA,
    .output_optional = true,
    .group = GROUP_TRIANGULATIONS,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = delaunay,
};
