/* brio alpha: the boundary of an alpha shape of the points of a file, and the alpha filtration. */
#include "cli/steps/certificate.h"
#include "cli/run/commands.h"
#include "cli/steps/estimate.h"
#include "cli/files/files.h"
#include "cli/files/new_file.h"
#include "cli/files/read_write.h"
#include "cli/steps/hints.h"
#include "cli/steps/periodic.h"
#include "cli/run/interrupt.h"
#include "cli/steps/properties.h"
#include "cli/steps/tiles.h"
#include "cli/files/cloud.h"
#include "cli/steps/weights.h"
#include <errno.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

static const double CENTRES_ROUNDING = 8; /* chosen: a centre moves by more than the points of its sphere do */

typedef struct arguments {
    weights_options weights;
    periodic_options periodic;
    const char *alpha, *filtration; /* as given, or NULL */
    uint64_t tiles;                 /* 0: not given */
} arguments;

static const option options[] = {
    {"alpha", 'A', OPTION_TEXT, offsetof(arguments, alpha), "A|auto",
     "squared radius, as in the literature, GUDHI and CGAL; PyVista and Open3D take its root. auto: the least with all "
     "points in one solid",
     0},
    {"filtration", 0, OPTION_OUTPUT, offsetof(arguments, filtration), "FILE",
     "write all simplices with their values, sorted: lines for GUDHI; .sparse: the edges for ripser", 0},
    WEIGHTS_ROWS(arguments, weights),
    TILES_ROWS(arguments, tiles),
    PERIODIC_ROWS(arguments, periodic),
    {0},
};

static const arguments defaults = {.weights.exponent = NO_EXPONENT};

/* Sets *alpha to the number that was given; NaN for auto. */
static brio_status read_alpha(run *r, const arguments *a, double *alpha) {
    char *end = NULL;
    if (!a->alpha) return cli_fail(r, BRIO_ERR_ARGUMENT, "no alpha: --alpha A or --alpha auto is missing");
    *alpha = NAN;
    if (!strcmp(a->alpha, "auto")) return BRIO_OK;
    *alpha = strtod(a->alpha, &end);
    if (end == a->alpha || *end || !isfinite(*alpha))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--alpha: expected a number or auto, got '%s'", a->alpha);
    return BRIO_OK;
}

static brio_filtration_format filtration_format(const char *path) {
    const char *dot = strrchr(path, '.');
    return dot && !strcmp(dot, ".sparse") ? BRIO_FILTRATION_RIPSER : BRIO_FILTRATION_GUDHI;
}

/* Warns of squared radii that became infinite, or too close to 0 for all bits. With weights values of 0 are usual. */
static void warn_beyond_doubles(run *r, const brio_alpha_complex *c, bool weighted) {
    size_t beyond = 0, total = 0;
    for (int k = 1; k < 4; k++)
        for (size_t i = 0; i < c->counts[k]; i++, total++) {
            double value = c->values[k][i];
            beyond += isinf(value) || (fabs(value) < DBL_MIN && !(weighted && value == 0));
        }
    if (beyond) cli_warn(r, WARNING_BEYOND, beyond, total);
}

static brio_status write_filtration(run *r, const char *path, const brio_alpha_complex *complex) {
    brio_status status = BRIO_OK;
    size_t total = complex->counts[0] + complex->counts[1] + complex->counts[2] + complex->counts[3];
    uint32_t *order = malloc(total * sizeof *order);
    if (!order) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory for the order of %zu simplices", total);
    TRY(brio_alpha_order(r->ctx, complex, order));
    cli_interrupt_writing(strcmp(path, "-") != 0);
    status = brio_write_filtration(r->ctx, path, complex, order, filtration_format(path));
    cli_interrupt_writing(false);
    cli_lap(r, "filtration");
done:
    free(order);
    return status;
}

static void report(run *r, const brio_alpha_complex *c, const brio_mesh *surface, const brio_alpha_shape_stats *s) {
    facts *f = &r->facts;
    cli_fact_text(f, "method", "alpha-shape");
    cli_fact_real(f, "alpha", s->alpha);
    cli_fact_real(f, "radius", s->alpha > 0 ? sqrt(s->alpha) : 0);
    cli_fact_count(f, "samples", c->counts[0]);
    cli_fact_count(f, "simplices", c->counts[0] + c->counts[1] + c->counts[2] + c->counts[3]);
    cli_fact_count(f, "tetrahedra", s->tetrahedra);
    cli_fact_count(f, "vertices", surface->num_vertices);
    cli_fact_count(f, "faces", surface->num_faces);
    cli_fact_count(f, "split", s->split);
    cli_fact_count(f, "uncovered", s->uncovered);
    cli_fact_count(f, "singular_vertices", s->singular_vertices);
    cli_fact_count(f, "singular_edges", s->singular_edges);
    cli_fact_count(f, "singular_facets", s->singular_facets);
}

static brio_status triangulate(run *r, const brio_mesh *input, const double *weights, brio_triangulation **t,
                               brio_alpha_complex *complex) {
    brio_delaunay_options o = {0};
    o.seed = r->common.seed;
    FORWARD(brio_delaunay(r->ctx, input->vertices, weights, input->num_vertices, &o, t));
    cli_lap(r, "delaunay");
    FORWARD(brio_alpha_values(r->ctx, *t, input->vertices, weights, input->num_vertices, complex));
    cli_lap(r, "values");
    return BRIO_OK;
}

/* Returns the greatest squared radius that counts as equal to one that the user gives. */
static double up_to(double alpha, const brio_mesh *points) {
    if (!(alpha > 0)) return alpha;
    double radius = cli_up_to(sqrt(alpha), CENTRES_ROUNDING * cli_rounding(points));
    return radius * radius;
}

/* Makes the layer of a page that shows all alphas, with a slider. With more facets it would be too large a page. */
static brio_status show_filtration(run *r, const brio_mesh *input, const brio_alpha_complex *complex, brio_mesh **out) {
    enum { MOST_FACETS = 800000 }; /* of 60,000 points; chosen: 20 MB, and the slider answers at once */
    if (!r->common.view) return BRIO_OK;
    if (complex->counts[2] > MOST_FACETS) {
        cli_warn(r, WARNING_FILTRATION, r->common.view, complex->counts[2]);
        return BRIO_OK;
    }
    FORWARD(brio_alpha_facets(r->ctx, input->vertices, complex, out));
    r->beside = *out;
    r->beside_name = "all alphas";
    return BRIO_OK;
}

static brio_status make_shape(run *r, const brio_mesh *input, const brio_alpha_complex *complex, double alpha) {
    brio_status status = BRIO_OK;
    brio_mesh *surface = NULL, *facets = NULL;
    brio_alpha_shape_stats s = {0};
    double most = up_to(alpha, input);
    if (isnan(alpha)) TRY(brio_alpha_auto(r->ctx, complex, &most));
    TRY(brio_alpha_shape(r->ctx, input->vertices, complex, most, &surface, &s));
    if (!isnan(alpha)) s.alpha = alpha; /* as it was given */
    cli_lap(r, "shape");
    report(r, complex, surface, &s);
    TRY(cli_carry_properties(r, input, NULL, surface));
    TRY(cli_check_interrupt(r));
    TRY(cli_certify(r, surface, 0));
    TRY(show_filtration(r, input, complex, &facets));
    TRY(cli_write(r, surface));
done:
    r->beside = NULL;
    brio_mesh_free(facets);
    brio_mesh_free(surface);
    return status;
}

/* --- in space that repeats --- */

static void report_periodic(run *r, const brio_alpha_complex *c, const brio_mesh *surface,
                            const brio_periodic_shape_stats *s) {
    const brio_alpha_shape_stats open = {.alpha = s->alpha,
                                         .tetrahedra = s->tetrahedra,
                                         .split = s->split,
                                         .uncovered = s->uncovered,
                                         .singular_vertices = s->singular_vertices,
                                         .singular_edges = s->singular_edges,
                                         .singular_facets = s->singular_facets};
    report(r, c, surface, &open);
    cli_fact_count(&r->facts, "surfaces", s->components);
    cli_fact_integer(&r->facts, "euler", s->euler);
    cli_fact_real(&r->facts, "area", s->area);
    cli_fact_real(&r->facts, "volume", s->volume);
    if (!surface->num_faces) cli_warn(r, WARNING_FULL, c->counts[3]);
}

/* Writes the simplices, named by their points. */
static brio_status write_by_points(run *r, const char *path, const brio_periodic_alpha *complex) {
    brio_status status = BRIO_OK;
    brio_alpha_complex named = {0};
    TRY(brio_periodic_alpha_by_points(r->ctx, complex, &named));
    TRY(write_filtration(r, path, &named));
done:
    brio_alpha_complex_free(&named);
    return status;
}

static brio_status make_periodic_shape(run *r, const brio_periodic_alpha *complex, double alpha, double most) {
    brio_status status = BRIO_OK;
    brio_mesh *surface = NULL;
    brio_periodic_shape_stats s = {0};
    if (isnan(alpha)) TRY(brio_periodic_alpha_auto(r->ctx, complex, &most));
    TRY(brio_periodic_alpha_shape(r->ctx, complex, most, &surface, &s));
    if (!isnan(alpha)) s.alpha = alpha; /* as it was given */
    cli_lap(r, "shape");
    report_periodic(r, complex->complex, surface, &s);
    TRY(cli_check_interrupt(r));
    TRY(cli_certify(r, surface, CERTIFY_OPEN));
    TRY(cli_write(r, surface));
done:
    brio_mesh_free(surface);
    return status;
}

static brio_status alpha_periodic(run *r, const brio_mesh *input, const double *weights, double alpha) {
    const arguments *a = r->arguments;
    brio_status status = BRIO_OK;
    brio_periodic *t = NULL;
    brio_periodic_alpha *complex = NULL;
    TRY(cli_periodic(r, &a->periodic, input, weights, &t));
    TRY(brio_periodic_alpha_values(r->ctx, t, &complex));
    cli_lap(r, "values");
    if (a->filtration) warn_beyond_doubles(r, complex->complex, weights != NULL);
    if (a->filtration) TRY(write_by_points(r, a->filtration, complex));
    TRY(make_periodic_shape(r, complex, alpha, up_to(alpha, input)));
done:
    brio_periodic_alpha_free(complex);
    brio_periodic_free(t);
    return status;
}

/* --- in tiles --- */

static brio_status check_tiles(run *r, double alpha) {
    const arguments *a = r->arguments;
    const char *shown = cli_showing(r);
    if (cli_is_periodic(&a->periodic)) return cli_fail(r, BRIO_ERR_ARGUMENT, "--cell, --periodic: not with --tiles");
    if (isnan(alpha))
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "--alpha auto: not with --tiles; it takes all tetrahedra in the order of their values");
    if (a->filtration) return cli_fail(r, BRIO_ERR_ARGUMENT, "--filtration: not with --tiles; it sorts all simplices");
    if (shown) return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: not with --tiles; brio view shows the file", shown);
    if (!r->common.output && !r->common.json) return cli_fail_output(r, "no output: -o FILE is missing");
    FORWARD(cli_check_tiles(r, &a->weights, a->tiles));
    return cli_check_tile_output(r, ".pvtp");
}

/* What is done with the faces of tiles. */
typedef struct {
    run *r;
    brio_tiles *tiles;
    double alpha;
    brio_parts_certificate *certificate;
    new_folder folder; /* of files for tiles; without a path there are none */
    uint32_t files;
    brio_mesh_parts *parts; /* of one file */
    brio_status status;
} shape_in_tiles;

/* Writes the faces of a tile. Its vertices have the property `point`, the index in the input. */
static brio_status write_piece(shape_in_tiles *s, const brio_faces_part *part) {
    run *r = s->r;
    char path[BRIO_PATH_MOST + 32];
    brio_mesh *mesh = NULL;
    brio_write_options how = {.size = sizeof how, .ascii = r->common.ascii, .compress = r->common.compress};
    uint64_t *offsets = malloc((part->num_faces + 1) * sizeof *offsets);
    void *data;
    brio_status status = BRIO_OK;
    if (!offsets) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for %zu faces", part->num_faces);
    for (size_t f = 0; f <= part->num_faces; f++) offsets[f] = 3 * f;
    TRY(brio_mesh_new(r->ctx, &mesh));
    TRY(brio_mesh_set_vertices(mesh, part->points, part->num_vertices));
    TRY(brio_mesh_set_faces(mesh, offsets, *part->faces, part->num_faces));
    TRY(brio_mesh_add_property(mesh, "point", BRIO_SCALAR_FLOAT64, &data));
    for (size_t v = 0; v < part->num_vertices; v++) ((double *)data)[v] = (double)part->index[v];
    snprintf(path, sizeof path, "%s/%u.vtp", s->folder.path, s->files++);
    status = brio_write(r->ctx, path, mesh, &how);
done:
    brio_mesh_free(mesh);
    free(offsets);
    return status;
}

static int take_faces(const brio_faces_part *part, uint32_t tile, void *user) {
    shape_in_tiles *s = user;
    (void)tile;
    s->status = brio_parts_certificate_add(s->r->ctx, s->certificate, part);
    if (s->status == BRIO_OK && s->folder.lock >= 0) s->status = write_piece(s, part);
    if (s->status != BRIO_OK) cli_keep_failure(s->r, s->status);
    return s->status != BRIO_OK;
}

/* Appends the faces of a tile to the one file, by the rows of their points. */
static int append_faces(const brio_faces_part *part, uint32_t tile, void *user) {
    shape_in_tiles *s = user;
    uint32_t(*rows)[3] = malloc((part->num_faces + 1) * sizeof *rows);
    (void)tile;
    s->status = rows ? BRIO_OK : cli_fail(s->r, BRIO_ERR_NO_MEMORY, "out of memory for %zu faces", part->num_faces);
    for (size_t f = 0; rows && f < part->num_faces; f++)
        for (int k = 0; k < 3; k++) rows[f][k] = (uint32_t)part->index[part->faces[f][k]];
    if (rows) s->status = brio_mesh_parts_faces(s->r->ctx, s->parts, (const uint32_t(*)[3])rows, part->num_faces);
    free(rows);
    if (s->status != BRIO_OK) cli_keep_failure(s->r, s->status);
    return s->status != BRIO_OK;
}

/* Finds the faces once more, and writes them: the head of the file says how many there are. */
static brio_status write_faces(run *r, brio_mesh_parts *parts, void *user) {
    shape_in_tiles *s = user;
    s->parts = parts;
    brio_status status = brio_tiles_alpha(r->ctx, s->tiles, s->alpha, append_faces, s, NULL);
    FORWARD(s->status);
    return status;
}

/* Files of the certificate: a bucket takes about as much memory as a tile, and each of its files some on its own. */
enum { MOST_BUCKETS = 1024 };

static brio_status begin_certificate(shape_in_tiles *s, uint32_t tiles) {
    const brio_tiles_stats *of = brio_tiles_facts(s->tiles);
    brio_parts_options o = {.size = sizeof o,
                            .scratch = s->r->common.scratch,
                            .buckets = tiles < MOST_BUCKETS ? tiles : MOST_BUCKETS,
                            .sheets = 1};
    memcpy(o.low, of->low, sizeof o.low);
    memcpy(o.high, of->high, sizeof o.high);
    return brio_parts_certificate_new(s->r->ctx, &o, &s->certificate);
}

static void report_tiles(run *r, const brio_tiles *t, double alpha, const brio_tiles_alpha_stats *s,
                         const brio_parts_stats *p) {
    const brio_tiles_stats *of = brio_tiles_facts(t);
    const brio_alpha_complex complex = {
        .counts = {(size_t)s->counts[0], (size_t)s->counts[1], (size_t)s->counts[2], (size_t)s->counts[3]}};
    const brio_mesh surface = {.num_vertices = (size_t)p->vertices, .num_faces = (size_t)p->faces};
    const brio_alpha_shape_stats open = {.alpha = alpha,
                                         .tetrahedra = (size_t)s->tetrahedra,
                                         .split = (size_t)p->split,
                                         .uncovered = (size_t)s->uncovered,
                                         .singular_vertices = (size_t)s->singular_vertices,
                                         .singular_edges = (size_t)s->singular_edges,
                                         .singular_facets = (size_t)s->singular_facets};
    report(r, &complex, &surface, &open);
    cli_fact_count(&r->facts, "tiles", of->tiles);
    cli_fact_count(&r->facts, "resumed", of->resumed);
    cli_fact_count(&r->facts, "largest_tile", of->most_points);
    cli_fact_count(&r->facts, "scratch_bytes", of->scratch_bytes + p->scratch_bytes);
}

/* Finds the shape, and writes the files of tiles where the output is their index. */
static brio_status shape_tiles(shape_in_tiles *s, double given, uint32_t tiles, brio_tiles_alpha_stats *stats) {
    run *r = s->r;
    brio_certificate certificate = {0};
    brio_parts_stats counted = {.size = sizeof counted};
    bool has_index = r->common.output && !cli_merges_tiles(r), published = false;
    brio_status status = BRIO_OK;
    TRY(begin_certificate(s, tiles));
    if (has_index) TRY(cli_new_folder_open(r, r->common.output, ".vtp", &s->folder));
    brio_status ended = brio_tiles_alpha(r->ctx, s->tiles, s->alpha, take_faces, s, stats);
    TRY(s->status);
    TRY(ended);
    cli_lap(r, "shape");
    TRY(brio_parts_certificate_end(r->ctx, s->certificate, &certificate, &counted));
    cli_lap(r, "certify");
    report_tiles(r, s->tiles, given, stats, &counted);
    TRY(cli_report_certificate(r, &certificate, 0));
    if (has_index) TRY(cli_new_folder_name(r, &s->folder));
    if (has_index) status = cli_write_faces_index(r, &s->folder, s->files);
    published = status == BRIO_OK;
done:
    if (has_index) cli_new_folder_close(&s->folder, published);
    brio_certificate_free(&certificate);
    return status;
}

static brio_status alpha_in_tiles(run *r, double alpha) {
    const arguments *a = r->arguments;
    shape_in_tiles s = {.r = r, .folder = {.lock = -1}};
    brio_tiles_alpha_stats stats = {.size = sizeof stats};
    bool merges = cli_merges_tiles(r);
    double box[6];
    tile_merging m;
    brio_status status = BRIO_OK;
    cli_merging_begin(&m, r, &a->weights);
    TRY(cli_triangulate_merging(r, merges ? &m : NULL, &a->weights, a->tiles, 4, &s.tiles));
    memcpy(box, brio_tiles_facts(s.tiles)->low, 3 * sizeof *box);
    memcpy(box + 3, brio_tiles_facts(s.tiles)->high, 3 * sizeof *box);
    s.alpha = up_to(alpha, &(brio_mesh){.num_vertices = 2, .vertices = box});
    TRY(shape_tiles(&s, alpha, (uint32_t)a->tiles, &stats));
    const tile_cells cells = {true, stats.faces, write_faces, &s};
    if (merges) status = cli_merging_write(&m, &cells);
done:
    brio_parts_certificate_free(s.certificate);
    brio_tiles_free(s.tiles);
    return status;
}

/* --- the command --- */

static brio_status alpha_open(run *r, const brio_mesh *input, const double *weights, double value) {
    const arguments *a = r->arguments;
    brio_status status = BRIO_OK;
    brio_triangulation *t = NULL;
    brio_alpha_complex complex = {0};
    TRY(triangulate(r, input, weights, &t, &complex));
    if (a->filtration) warn_beyond_doubles(r, &complex, weights != NULL);
    if (a->filtration) TRY(write_filtration(r, a->filtration, &complex));
    TRY(make_shape(r, input, &complex, value));
done:
    brio_alpha_complex_free(&complex);
    brio_triangulation_free(t);
    return status;
}

static brio_status alpha(run *r) {
    const arguments *a = r->arguments;
    brio_mesh *input = NULL;
    double *weights = NULL, value = NAN, bytes;
    size_t usual;
    brio_status status = BRIO_OK;
    bool periodic = cli_is_periodic(&a->periodic);
    TRY(read_alpha(r, a, &value));
    TRY(cli_check_weights_options(r, &a->weights));
    TRY(cli_check_periodic(r, &a->periodic));
    if (a->tiles) {
        TRY(check_tiles(r, value));
        return alpha_in_tiles(r, value);
    }
    TRY(cli_require_output(r, a->filtration != NULL));
    if (a->filtration) TRY(cli_check_beside(r, "filtration", a->filtration));
    TRY(cli_read_samples(r, r->operands[0], &input));
    TRY(cli_weights(r, &a->weights, input, &weights));
    TRY(cli_usual_points(r, input, weights, false, &usual));
    bytes = cli_alpha_bytes(input, usual);
    if (periodic && cli_limits_memory(r))
        TRY(cli_periodic_alpha_bytes(r, &a->periodic, input, weights, a->filtration != NULL, &bytes));
    TRY(cli_require_memory(r, bytes));
    cli_tell_cell(r, &a->periodic, input);
    cli_lap(r, "read");
    status = periodic ? alpha_periodic(r, input, weights, value) : alpha_open(r, input, weights, value);
    if (!periodic) cli_examine(r, status, input);
done:
    free(weights);
    brio_mesh_free(input);
    return status;
}

const command cli_alpha = {
    .name = "alpha",
    .operands = "IN",
    .summary = "boundary of an alpha shape of points, and the alpha filtration",
    .description =
        "For points throughout a volume rather than on a surface. Alpha is a squared radius, as in the literature.",
    .examples = "brio alpha points.ply --alpha auto -o shape.ply\nthe least alpha with all points in one solid\n"
                "brio alpha points.ply --alpha 0.01 --filtration values.txt -o shape.ply\nall simplices and their "
                "values as well\n"
                "brio alpha scan.laz --tiles 16 --scratch /var/tmp --alpha 0.01 -o shape.ply\nmore points than fit in "
                "memory\n"
                "brio alpha atoms.extxyz --periodic xyz --alpha 4 -o pores.ply\natoms in a cell that repeats\n",
    .has_output = true,
    .holds = CLI_SURFACES,
    .group = GROUP_SURFACES,
    .min_operands = 1,
    .max_operands = 1,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = alpha,
};
