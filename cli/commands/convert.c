/* brio convert: any format to any other, and a choice among the points. */
#include "cli/run/commands.h"
#include "cli/files/files.h"
#include "cli/run/interrupt.h"
#include "cli/files/lost.h"
#include "cli/files/read_write.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

typedef struct arguments {
    const char *crop, *crs;
    double thin, merge; /* merge: NaN where it is not given */
    uint64_t tiles;     /* 0: not given */
    int outliers;
    bool crs_comment;
} arguments;

#define FIELD(name) offsetof(arguments, name)
static const option options[] = {
    {"crop", 0, OPTION_TEXT, FIELD(crop), "x0,y0,z0,x1,y1,z1", "keep the points in this box, its border included", 0},
    {"crs", 0, OPTION_OUTPUT, FIELD(crs), "FILE", "also write the coordinate system to a file .prj, as well-known text",
     0},
    {"crs-comment", 0, OPTION_FLAG, FIELD(crs_comment), NULL,
     "write the coordinate system into the comments of a PLY file, as text or as its code", 0},
    {"drop-outliers", 0, OPTION_INT | OPTION_POSITIVE, FIELD(outliers), "K",
     "drop points that are far from their K nearest points (8 to 16)", 0},
    {"thin", 0, OPTION_NUMBER, FIELD(thin), "S", "keep points at least S apart, all others being nearer than S to one",
     0},
    {"merge", 0, OPTION_NUMBER | OPTION_OPTIONAL, FIELD(merge), "[DISTANCE]",
     "merge vertices at equal positions, or at most DISTANCE apart; drops triangles that lose a corner", 0},
    {"tiles", 0, OPTION_NATURAL | OPTION_POSITIVE, FIELD(tiles), "N",
     "divide the points, more than fit in memory, among N tiles, by way of the folder of --scratch: -o x.vpc or "
     "x.pvtp, "
     "an index of files in a folder x",
     0},
    {0},
};
#undef FIELD

static const arguments defaults = {.merge = NAN};

static brio_status take_crop(run *r, const char *text, double box[6]) {
    const char *at = text;
    for (int i = 0; i < 6; i++) {
        char *end;
        box[i] = strtod(at, &end);
        if (end == at || !isfinite(box[i]) || *end != (i < 5 ? ',' : 0))
            return cli_fail(r, BRIO_ERR_ARGUMENT, "--crop: expected x0,y0,z0,x1,y1,z1, got '%s'", text);
        at = end + 1;
    }
    for (int k = 0; k < 3; k++)
        if (box[k] > box[k + 3])
            return cli_fail(r, BRIO_ERR_ARGUMENT, "--crop: %c from %g to %g is empty", "xyz"[k], box[k], box[k + 3]);
    return BRIO_OK;
}

static void on_name(const char *name, void *user) {
    cli_fact_text(user, NULL, name); /* a list until the report */
}

/* Reports names as a list.   text  receives them for a warning. */
static void report_names(run *r, const char *name, const facts *names, char text[1024]) {
    size_t used = 0;
    text[0] = 0;
    r->facts.failed |= names->failed;
    cli_fact_open(&r->facts, name, FACT_LIST);
    for (size_t i = 0; i < names->count; i++) cli_fact_text(&r->facts, NULL, names->list[i].text);
    cli_fact_close(&r->facts);
    for (size_t i = 0; i < names->count && used < 1024; i++)
        used += (size_t)snprintf(text + used, 1024 - used, "%s %s", i ? "," : "", names->list[i].text);
}

static void report_lost(run *r, const facts *lost, const facts *renamed) {
    char text[1024];
    report_names(r, "lost", lost, text);
    if (lost->count) cli_warn(r, WARNING_LOST, r->common.output, text);
    if (!renamed->count) return;
    report_names(r, "renamed", renamed, text);
    cli_warn(r, WARNING_RENAMED, r->common.output, text);
}

static brio_status take_files(run *r, brio_read_options *from, brio_write_options *to) {
    const common_options *c = &r->common;
    const arguments *chosen = r->arguments;
    const char *format = chosen->tiles ? cli_point_tile_format(r) : c->format;
    FORWARD(cli_output_format(r, c->output, format, &to->format));
    *from = cli_read_options(r);
    to->size = sizeof *to;
    if (format && !strcasecmp(format, "csv")) to->separator = ",";
    to->ascii = c->ascii;
    to->float32 = c->float32;
    to->compress = c->compress;
    to->comment = "brio " BRIO_VERSION;
    to->crs_comment = chosen->crs_comment;
    if (to->crs_comment && to->format != BRIO_FORMAT_PLY)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: --crs-comment writes comments of PLY files only", c->output);
    return BRIO_OK;
}

static brio_status take_options(run *r, brio_convert_options *o) {
    const arguments *chosen = r->arguments;
    o->crop = chosen->crop != NULL;
    if (chosen->crop) FORWARD(take_crop(r, chosen->crop, o->box));
    if (chosen->thin < 0) return cli_fail(r, BRIO_ERR_ARGUMENT, "--thin: %g is below 0", chosen->thin);
    if (chosen->outliers > 63)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "--drop-outliers: %d is not between 1 and 63", chosen->outliers);
    if (chosen->tiles && !isnan(chosen->merge))
        return cli_fail(r, BRIO_ERR_ARGUMENT,
                        "--merge: not with --tiles, since all vertices are in memory for it; merge before, by another "
                        "conversion");
    if (chosen->merge < 0) return cli_fail(r, BRIO_ERR_ARGUMENT, "--merge: %g is below 0", chosen->merge);
    o->merge = !isnan(chosen->merge);
    if (o->merge) o->merge_distance = chosen->merge;
    o->thin = chosen->thin;
    o->crs = chosen->crs;
    if (o->crs) FORWARD(cli_check_target(r, o->crs));
    o->drop_outliers = chosen->outliers;
    return BRIO_OK;
}

static void report(run *r, const brio_convert_stats *stats, const brio_convert_options *o) {
    facts *f = &r->facts;
    cli_fact_count(f, "points", stats->points);
    cli_fact_count(f, "faces", stats->faces);
    if (stats->tetrahedra) cli_fact_count(f, "tetrahedra", stats->tetrahedra);
    if (stats->points_read != stats->points || o->crop) cli_fact_count(f, "points_read", stats->points_read);
    if (o->drop_outliers) cli_fact_count(f, "outliers", stats->outliers);
    if (o->thin > 0) cli_fact_count(f, "thinned", stats->thinned);
    if (o->merge) cli_fact_count(f, "merged_vertices", stats->merged);
    if (o->merge) cli_fact_count(f, "degenerate", stats->degenerate);
    if (o->tiles) cli_fact_count(f, "tiles", stats->tiles);
    if (o->tiles) cli_fact_count(f, "largest_tile", stats->largest_tile);
    if (o->tiles) cli_fact_count(f, "scratch_bytes", stats->scratch_bytes);
    cli_fact_bool(f, "streamed", stats->streamed);
}

/* Refuses outputs that cannot be written. */
static brio_status check_output(run *r, uint64_t tiles) {
    const char *output = r->common.output;
    if (tiles) return cli_check_point_tiles(r, tiles);
    if (r->num_operands == 2)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "two outputs: %s and -o %s; several inputs go with --tiles",
                        r->operands[1], output);
    if (r->num_operands > 2)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "convert: %d inputs; several go with --tiles", r->num_operands);
    if (output && cli_is_point_index(output) && !r->common.format)
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: an index of tiles, which --tiles N --scratch DIR writes", output);
    return cli_require_output(r, false);
}

static brio_status convert_file(run *r, const brio_convert_options *o, brio_convert_stats *stats) {
    FORWARD(cli_check_interrupt(r));
    cli_interrupt_writing(strcmp(r->common.output, "-") != 0);
    brio_status status = brio_convert(r->ctx, r->operands[0], r->common.output, o, stats);
    cli_interrupt_writing(false);
    return status;
}

static void report_stages(run *r, const brio_convert_stats *s) {
    double known = s->read_seconds + s->select_seconds + s->divide_seconds;
    if (s->read_seconds > 0) cli_stage(r, "read", s->read_seconds);
    cli_stage(r, "select", s->select_seconds);
    if (s->read_seconds > 0) cli_stage(r, "divide", s->divide_seconds);
    cli_stage(r, "convert", s->seconds - known);
}

static brio_status convert(run *r) {
    const arguments *chosen = r->arguments;
    brio_convert_options o = {.size = sizeof o};
    brio_read_options from = {0};
    brio_write_options to = {0};
    double moved = 0;
    size_t merged = 0;
    brio_convert_stats stats = {.size = sizeof stats};
    facts lost = {0}, renamed = {0};
    brio_status status = BRIO_OK;
    if (!r->common.output) return cli_fail(r, BRIO_ERR_ARGUMENT, "convert: expected A B, got one file");
    TRY(check_output(r, chosen->tiles));
    TRY(take_files(r, &from, &to));
    TRY(take_options(r, &o));
    to.moved = &moved;
    o.from = &from, o.to = &to;
    o.lost = on_name;
    o.lost_user = &lost;
    o.renamed = on_name;
    o.renamed_user = &renamed;
    TRY(cli_settle_conversion(r, r->num_operands, &o, &to, &merged));
    TRY(chosen->tiles ? cli_point_tiles(r, chosen->tiles, &o, &stats) : convert_file(r, &o, &stats));
    report_stages(r, &stats);
    report(r, &stats, &o);
    cli_tell_input(r, r->num_operands > 1 ? "the inputs" : r->operands[0]);
    report_lost(r, &lost, &renamed);
    cli_tell_moved(r, r->common.output, moved, merged);
done:
    cli_facts_free(&lost);
    cli_facts_free(&renamed);
    return status;
}

const command cli_convert = {
    .name = "convert",
    .operands = "A... B",
    .summary = "any format to any other; crops, thins, drops outliers, merges vertices",
    .description =
        "Points go by in blocks, so that a file of any size needs some MiB; files with faces are read as a whole. "
        "First come the points in the box, of these those that are no outliers, of these a thinned set; merging comes "
        "last. With --tiles, points of any number of inputs, which have the same properties, go to a file for each "
        "tile.",
    .examples =
        "brio convert scan.laz scan.ply\nevery property is kept\n"
        "brio convert scan.las small.las --thin 0.05 --drop-outliers 12\npoints 5 cm apart, without stray ones\n"
        "brio convert parts.obj whole.ply --merge\nfaces share the vertices at one place\n"
        "brio convert a.laz b.laz all.vpc --tiles 16 --scratch /var/tmp\nmore points than fit in memory, in 16 files\n",
    .has_output = true,
    .output_optional = true,
    .group = GROUP_FILES,
    .min_operands = 1,
    .max_operands = 1 << 20,
    .writes_last = true,
    .options = options,
    .defaults = &defaults,
    .size = sizeof defaults,
    .run = convert,
};
