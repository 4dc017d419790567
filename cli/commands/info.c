/* brio info: what is in a file, and how much memory each command would take for it.
 *
 * The file is read in blocks first, for its counts, its box and the ranges of its properties. Duplicates, the spacing
 * and the estimates need the points in memory; a file of more than MOST_IN_MEMORY points is not read a second time, and
 * the report has null for duplicates and spacing. */
#include "cli/files/cloud.h"
#include "cli/files/read_write.h"
#include "cli/run/commands.h"
#include "cli/steps/estimate.h"
#include "cli/steps/weights.h"
#include "platform/file.h"
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_IN_MEMORY UINT64_C(100000000) /* chosen: 2.4 GB of coordinates */

typedef struct property_range {
    char name[64];
    brio_scalar type;
    double low, high; /* of the values that are numbers; low > high if there are none */
} property_range;

/* What a pass over the file found. */
typedef struct survey {
    uint64_t points, faces, tetrahedra;
    double low[3], high[3], step[3], origin[3];
    property_range *ranges;
    size_t num_ranges;
    bool failed; /* out of memory */
    brio_file_facts file;
    facts left_out;      /* the names of what is not read of the file */
    facts of_faces;      /* the names and types of the properties of its faces */
    facts crs, metadata; /* what the file says of all its points: of their coordinate system; everything else */
} survey;

static const char *const type_names[] = {"int8", "uint8", "int16", "uint16", "int32", "uint32", "float32", "float64"};

static const option options[] = {{0}};
static const char defaults = 0; /* info has no options but those of all commands */

static void report_vector(facts *f, const char *name, const double v[3]) {
    cli_fact_open(f, name, FACT_LIST);
    for (int k = 0; k < 3; k++) cli_fact_real(f, NULL, v[k]);
    cli_fact_close(f);
}

static int take_properties(survey *v, const brio_mesh *block) {
    v->ranges = calloc(block->num_properties + 1, sizeof *v->ranges);
    if (!v->ranges) return 1;
    v->num_ranges = block->num_properties;
    for (size_t i = 0; i < v->num_ranges; i++) {
        memcpy(v->ranges[i].name, block->properties[i].name, sizeof v->ranges[i].name);
        v->ranges[i].type = block->properties[i].type;
        v->ranges[i].low = 1;
    }
    return 0;
}

/* Takes note of the properties of faces. Files with faces are one block. */
static void take_face_properties(survey *v, const brio_mesh *block) {
    for (size_t i = 0; i < block->num_face_properties && block->num_faces; i++)
        cli_fact_text(&v->of_faces, block->face_properties[i].name, type_names[block->face_properties[i].type]);
}

/* Takes note of metadata: a text that people can read, or else how many bytes there are. */
static void take_metadata(survey *v, const brio_mesh *block) {
    for (size_t i = 0; i < block->num_metadata; i++) {
        const brio_metadata *m = &block->metadata[i];
        bool system = !strncmp(m->name, "crs.", 4), text = strlen(m->bytes) == m->size;
        facts *to = system ? &v->crs : &v->metadata;
        for (size_t k = 0; k < m->size; k++) text &= (unsigned char)m->bytes[k] >= ' ' || strchr("\t\r\n", m->bytes[k]);
        if (text)
            cli_fact_text(to, m->name + (system ? 4 : 0), m->bytes);
        else
            cli_fact_bytes(to, m->name + (system ? 4 : 0), m->size);
    }
}

static void widen(property_range *range, double x) {
    bool none = range->low > range->high;
    if (x != x) return;
    if (none || x < range->low) range->low = x;
    if (none || x > range->high) range->high = x;
}

static int take_block(const brio_mesh *block, void *user) {
    survey *v = user;
    double low[3], high[3];
    if (!v->ranges) take_metadata(v, block);
    if (!v->ranges) take_face_properties(v, block);
    if (!v->ranges && take_properties(v, block)) return v->failed = true;
    if (block->num_vertices) cli_cloud_box(block->vertices, block->num_vertices, low, high);
    for (int k = 0; k < 3 && block->num_vertices; k++) {
        if (!v->points || low[k] < v->low[k]) v->low[k] = low[k];
        if (!v->points || high[k] > v->high[k]) v->high[k] = high[k];
        v->step[k] = block->coordinate_step[k];
        v->origin[k] = block->coordinate_origin[k];
    }
    for (size_t i = 0; i < v->num_ranges; i++)
        for (size_t j = 0; j < block->num_vertices; j++)
            widen(&v->ranges[i], brio_property_value(&block->properties[i], j));
    v->points += block->num_vertices;
    v->faces += block->num_faces;
    v->tetrahedra += block->num_tetrahedra;
    return 0;
}

static void on_left_out(const char *name, void *user) {
    survey *v = user;
    cli_fact_text(&v->left_out, NULL, name);
}

static void report_left_out(run *r, const survey *v) {
    r->facts.failed |= v->left_out.failed;
    if (!v->left_out.count) return;
    cli_fact_open(&r->facts, "left_out", FACT_LIST);
    for (size_t i = 0; i < v->left_out.count; i++) cli_fact_text(&r->facts, NULL, v->left_out.list[i].text);
    cli_fact_close(&r->facts);
}

static void report_metadata(run *r, const char *name, const facts *metadata) {
    r->facts.failed |= metadata->failed;
    if (!metadata->count) return;
    cli_fact_open(&r->facts, name, FACT_OBJECT);
    for (size_t i = 0; i < metadata->count; i++) {
        const fact *f = &metadata->list[i];
        if (f->kind == FACT_TEXT)
            cli_fact_text(&r->facts, f->name, f->text);
        else
            cli_fact_bytes(&r->facts, f->name, f->count);
    }
    cli_fact_close(&r->facts);
}

static void free_survey(survey *v) {
    cli_facts_free(&v->left_out);
    cli_facts_free(&v->of_faces);
    cli_facts_free(&v->crs);
    cli_facts_free(&v->metadata);
    free(v->ranges);
}

/* Reads the file in blocks, if it can be read again, or into memory. A text whose later rows lack a column goes into
 * memory, too. */
static brio_status survey_file(run *r, survey *v, brio_mesh **mesh) {
    const char *path = r->operands[0];
    brio_read_options how = cli_read_options(r);
    brio_place_facts there;
    brio_status status = BRIO_ERR_FORMAT;
    how.left_out = on_left_out;
    how.left_out_user = v;
    bool named = strcmp(path, "-") != 0;
    if (named && !brio_find_facts(path, &there)) return cli_fail(r, BRIO_ERR_OPEN, "%s: %s", path, strerror(errno));
    if (named && there.kind == BRIO_IS_FILE) status = brio_read_blocks(r->ctx, path, &how, take_block, v, &v->file);
    if (v->failed) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory");
    bool known = status == BRIO_OK;
    if (known && v->points > MOST_IN_MEMORY) {
        cli_tell_input(r, path);
        return BRIO_OK;
    }
    if (!known && status != BRIO_ERR_FORMAT) return status;
    TRY(cli_read(r, path, mesh));
    if (known) return BRIO_OK;
    free_survey(v);
    *v = (survey){.file.size = sizeof v->file};
    if (take_block(*mesh, v)) return cli_fail(r, BRIO_ERR_NO_MEMORY, "out of memory");
done:
    return status;
}

static void report_file(facts *f, const survey *v) {
    const brio_format_info *info = brio_format_facts(v->file.format);
    char name[16] = "";
    if (info) snprintf(name, sizeof name, "%.*s", (int)strcspn(info->extensions, " "), info->extensions);
    if (info) cli_fact_text(f, "format", name);
    if (v->file.version[0]) cli_fact_text(f, "version", v->file.version);
}

static void report_box(facts *f, const survey *v) {
    if (!v->points) {
        cli_fact_null(f, "box");
        return;
    }
    cli_fact_open(f, "box", FACT_OBJECT);
    report_vector(f, "min", v->low);
    report_vector(f, "max", v->high);
    cli_fact_close(f);
    if (v->step[0] == 0) return;
    report_vector(f, "coordinate_step", v->step);
    report_vector(f, "coordinate_origin", v->origin);
}

static void report_properties(facts *f, const survey *v) {
    cli_fact_open(f, "properties", FACT_OBJECT);
    for (size_t i = 0; i < v->num_ranges; i++) cli_fact_text(f, v->ranges[i].name, type_names[v->ranges[i].type]);
    cli_fact_close(f);
    cli_fact_open(f, "ranges", FACT_OBJECT);
    for (size_t i = 0; i < v->num_ranges; i++) {
        const property_range *range = &v->ranges[i];
        if (range->low > range->high) continue;
        cli_fact_open(f, range->name, FACT_LIST);
        cli_fact_real(f, NULL, range->low);
        cli_fact_real(f, NULL, range->high);
        cli_fact_close(f);
    }
    cli_fact_close(f);
}

/* Estimates of the commands that go by the triangulation.   usual  of the mesh without weights. */
static brio_status report_triangulations(run *r, const brio_mesh *mesh, size_t usual) {
    static const weights_options standard = {.exponent = NO_EXPONENT, .estimate = true};
    facts *f = &r->facts;
    double *weights = NULL, beside = CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh), delaunay, places;
    size_t n = mesh->num_vertices;
    brio_status status = BRIO_OK;
    TRY(cli_weights(r, &standard, mesh, &weights));
    TRY(cli_delaunay_bytes(r, mesh, weights, NULL, &delaunay));
    if (weights) TRY(cli_usual_points(r, mesh, weights, true, &usual));
    places = cli_locate_bytes(mesh, delaunay, NULL);
    cli_fact_bytes(f, "delaunay", (uint64_t)delaunay);
    cli_fact_bytes(f, "plane", (uint64_t)(beside + (double)brio_estimate_delaunay2(n, weights != NULL)));
    cli_fact_bytes(f, "voronoi", (uint64_t)cli_voronoi_bytes(delaunay, usual, true));
    cli_fact_bytes(f, "hull", (uint64_t)cli_hull_bytes(mesh));
    cli_fact_bytes(f, "alpha", (uint64_t)cli_alpha_bytes(mesh, usual));
    cli_fact_bytes(f, "locate", (uint64_t)places);
    cli_fact_bytes(f, "interpolate", (uint64_t)places);
done:
    free(weights);
    return status;
}

/* Reports the estimate of an offset. Of a mesh its faces count, and the distance: a hundredth of the diagonal of its
 * box is taken. A mesh that cannot be offset has none. */
static brio_status report_offset(run *r, const brio_mesh *mesh, double beside, uint64_t of_points) {
    double low[3], high[3], square = 0;
    uint64_t work = 0;
    if (!mesh->num_faces) {
        cli_fact_bytes(&r->facts, "offset", (uint64_t)(beside + (double)of_points));
        return BRIO_OK;
    }
    cli_cloud_box(mesh->vertices, mesh->num_vertices, low, high);
    for (int k = 0; k < 3; k++) square += (high[k] - low[k]) * (high[k] - low[k]);
    brio_status status = brio_estimate_mesh_offset(r->ctx, mesh, sqrt(square) / 100, NULL, &work);
    if (status == BRIO_ERR_CANCELLED || status == BRIO_ERR_NO_MEMORY) return status;
    if (status == BRIO_OK)
        cli_fact_bytes(&r->facts, "offset", (uint64_t)(beside + (double)work));
    else
        cli_fact_null(&r->facts, "offset");
    return BRIO_OK;
}

/* Estimates of surfaces and axes. */
static brio_status report_surfaces(run *r, const brio_mesh *mesh, size_t usual) {
    facts *f = &r->facts;
    double beside = CLI_PROGRAM_BYTES + cli_mesh_bytes(mesh);
    uint64_t surface, explained, crust, cocone;
    brio_explanation *wanted = NULL;
    FORWARD(brio_estimate_surface(r->ctx, usual, NULL, &surface));
    const brio_surface_options explaining = {.size = sizeof explaining, .explanation = &wanted};
    FORWARD(brio_estimate_surface(r->ctx, usual, &explaining, &explained));
    FORWARD(brio_estimate_power_shape(r->ctx, usual, NULL, &crust));
    FORWARD(brio_estimate_surface(r->ctx, usual, &(brio_surface_options){.method = BRIO_SURFACE_COCONE}, &cocone));
    cli_fact_bytes(f, "surface", (uint64_t)(beside + (double)surface));
    cli_fact_bytes(f, "explained", (uint64_t)(beside + (double)explained));
    cli_fact_bytes(f, "medial", (uint64_t)(beside + (double)crust));
    FORWARD(report_offset(r, mesh, beside, crust));
    cli_fact_bytes(f, "cocone", (uint64_t)(beside + (double)cocone));
    if (mesh->num_faces) {
        double subdivide = (double)brio_estimate_mesh_subdivide(mesh->num_faces, 1);
        cli_fact_bytes(f, "subdivide", (uint64_t)(CLI_PROGRAM_BYTES + subdivide));
    }
    return BRIO_OK;
}

static brio_status report_estimates(run *r, const brio_mesh *mesh) {
    size_t usual;
    cli_fact_open(&r->facts, "estimate_bytes", FACT_OBJECT);
    brio_status status = cli_usual_points(r, mesh, NULL, true, &usual);
    if (status == BRIO_OK) status = report_triangulations(r, mesh, usual);
    if (status == BRIO_OK) status = report_surfaces(r, mesh, usual);
    cli_fact_close(&r->facts);
    return status;
}

/* Duplicates and spacing, which need the points in memory. */
static brio_status measure(run *r, const brio_mesh *mesh) {
    facts *f = &r->facts;
    size_t duplicates;
    double spacing;
    if (!mesh) {
        cli_fact_null(f, "duplicates");
        cli_fact_null(f, "spacing");
        return BRIO_OK;
    }
    FORWARD(cli_require_memory(r, cli_info_bytes(mesh)));
    FORWARD(cli_cloud_duplicates(r, mesh->vertices, mesh->num_vertices, &duplicates));
    FORWARD(cli_cloud_spacing(r, mesh->vertices, mesh->num_vertices, &spacing));
    cli_lap(r, "measure");
    cli_fact_count(f, "duplicates", duplicates);
    if (spacing > 0)
        cli_fact_real(f, "spacing", spacing);
    else
        cli_fact_null(f, "spacing");
    return BRIO_OK;
}

static brio_status info(run *r) {
    brio_mesh *mesh = NULL;
    survey v = {.file.size = sizeof v.file};
    facts *f = &r->facts;
    brio_status status = BRIO_OK;
    if (r->common.output) FAIL(r, BRIO_ERR_ARGUMENT, "info writes no file; -o has no meaning here");
    TRY(survey_file(r, &v, &mesh));
    report_file(f, &v);
    cli_fact_count(f, "points", v.points);
    cli_fact_count(f, "faces", v.faces);
    cli_fact_count(f, "tetrahedra", v.tetrahedra);
    report_box(f, &v);
    TRY(measure(r, mesh));
    report_properties(f, &v);
    report_metadata(r, "face_properties", &v.of_faces);
    report_metadata(r, "crs", &v.crs);
    report_metadata(r, "metadata", &v.metadata);
    report_left_out(r, &v);
    if (mesh) TRY(report_estimates(r, mesh));
done:
    brio_mesh_free(mesh);
    free_survey(&v);
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
