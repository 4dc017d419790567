/* What a file loses, said before or beside the loss: what its format has no place for, and what single precision does
 * to coordinates.
 *
 * Coordinates of a country's grid, such as 4100000.456, are half a metre apart in single precision: points of a scan
 * merge, and triangles fold over. Where a format has double precision, too, --float32 then gives way to it. Where it
 * has no other, as STL, points that it would ruin are refused as soon as they are read. A surface that is finished is
 * written in any case. Single pairs of points that are almost coincident are merged, and counted. */
#include "cli/files/cloud.h"
#include "cli/files/lost.h"
#include "cli/run/run.h"
#include "platform/file.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* --- what the format cannot hold --- */

/* Returns whether a format has a place for colours or normals, the property is one of these, and the mesh has all
 * three. Formats that have places for other single properties are written by convert alone, which knows what it loses
 * (io/convert). */
static bool is_held(const brio_mesh *mesh, const char *name, unsigned holds) {
    static const struct {
        unsigned what;
        const char *names[3];
    } groups[] = {{BRIO_HOLDS_COLOURS, {"red", "green", "blue"}}, {BRIO_HOLDS_NORMALS, {"nx", "ny", "nz"}}};
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++) {
        bool all = holds & groups[g].what, one = false;
        for (int k = 0; k < 3; k++) {
            all = all && brio_mesh_property(mesh, groups[g].names[k]);
            one |= !strcmp(name, groups[g].names[k]);
        }
        if (all && one) return true;
    }
    return false;
}

/* Returns whether a format has a place for a property of faces: for all, or for their colours. */
static bool is_held_of_faces(const char *name, unsigned holds) {
    static const char *const colour[] = {"red", "green", "blue", "alpha"};
    bool one = false;
    for (int k = 0; k < 4; k++) one |= !strcmp(name, colour[k]);
    return holds & BRIO_HOLDS_FACE_PROPERTIES || (one && holds & BRIO_HOLDS_FACE_COLOURS);
}

/* Lists the names of the properties that a format does not hold, the first few of them. Returns how many there are. */
static size_t list_names(const brio_mesh *mesh, unsigned holds, char text[1024]) {
    enum { MOST = 12 };
    size_t used = 0, count = 0;
    for (size_t i = 0; i < mesh->num_face_properties && mesh->num_faces && holds & BRIO_HOLDS_FACES; i++) {
        const char *name = mesh->face_properties[i].name;
        if (is_held_of_faces(name, holds)) continue;
        if (count++ < MOST) used += (size_t)snprintf(text + used, 1024 - used, " \"%s of faces\"", name);
    }
    for (size_t i = 0; i < mesh->num_properties && !(holds & BRIO_HOLDS_NAMES); i++) {
        if (is_held(mesh, mesh->properties[i].name, holds)) continue;
        if (count++ < MOST) used += (size_t)snprintf(text + used, 1024 - used, " %s", mesh->properties[i].name);
    }
    if (count > MOST) snprintf(text + used, 1024 - used, " ...");
    return count;
}

void cli_tell_lost(run *r, const char *path, const brio_mesh *mesh, brio_format format) {
    char names[1024];
    const unsigned holds = brio_format_facts(format)->holds;
    if (mesh->num_faces && !(holds & BRIO_HOLDS_FACES)) cli_warn(r, WARNING_FACES, path);
    if (mesh->num_edges && !(holds & BRIO_HOLDS_EDGES)) cli_warn(r, WARNING_EDGES, path);
    if (!r->has_properties || !list_names(mesh, holds, names)) return;
    if (holds & BRIO_HOLDS_PROPERTIES && !(holds & BRIO_HOLDS_NAMES))
        cli_warn(r, WARNING_NAMES, path, names);
    else
        cli_warn(r, WARNING_PROPERTIES, path, names);
}

void cli_tell_idle(run *r, const char *path, bool ascii, bool float32) {
    if (r->common.ascii && !ascii) cli_warn(r, WARNING_IDLE_ASCII, path);
    if (r->common.float32 && !float32) cli_warn(r, WARNING_IDLE_FLOAT32, path);
}

/* --- single precision --- */

/* What single precision would do to points.
 *
 * Points merge, or move over their neighbours. The points of a file that goes by in blocks are never together: points
 * that merge are near each other in space, and in most files near each other in the order, too. Where the order is
 * random, a block of a cloud that singles ruin has pairs that merge, since so few positions are left. */

typedef struct single_loss {
    size_t points, merged; /* points; how many of them fall on others */
    double largest;        /* the coordinate of largest magnitude */
    double moved;          /* the most that a coordinate moves; 0 where single precision cannot hold `largest` */
    double spacing;        /* the typical distance of neighbours; 0: unknown, or nothing moves */
} single_loss;

/* The share of the points that may merge. Chosen: above the pairs of almost coincident points that scans have and that
 * the power crust makes (86 of 600,000 vertices on a torus), below what a country's grid does. */
static const double MOST_MERGED = 1e-3;
/* The share of the spacing of the points by which coordinates may move. Chosen. */
static const double MOST_MOVED = 0.1;
static const double LARGEST_SINGLE = 0x1.fffffep127;

typedef struct {
    run *r;
    const double *box; /* of the points that count; NULL: all do */
    single_loss *loss;
    size_t blocks; /* with points that move */
    brio_status status;
} survey;

/* --- blocks --- */

static bool fits(const single_loss *l) {
    return fabs(l->largest) <= LARGEST_SINGLE;
}

/* Finds the most that one of some coordinates moves. Raises `largest`. */
static double move_of(single_loss *l, const double *x, size_t count) {
    double moved = 0;
    for (size_t i = 0; i < count; i++)
        if (fabs(x[i]) > fabs(l->largest)) l->largest = x[i];
    if (!fits(l)) return 0;
    for (size_t i = 0; i < count; i++) {
        double d = fabs(x[i] - (double)(float)x[i]);
        if (d > moved) moved = d; /* with fmax, gcc 12 for aarch64 ends with an internal error */
    }
    return moved;
}

/* Adds the points of a block. The spacing is searched in the blocks 1, 2, 4, 8 and so on, since that costs more than
 * all else. */
static brio_status add_points(survey *s, const double *points, size_t count) {
    single_loss *l = s->loss;
    size_t merged;
    double spacing, moved = move_of(l, points, 3 * count);
    l->points += count;
    l->moved = fits(l) ? fmax(l->moved, moved) : 0;
    if (!(moved > 0) || !fits(l)) return BRIO_OK;
    FORWARD(cli_cloud_merged(s->r, points, count, &merged));
    l->merged += merged;
    s->blocks++;
    if (s->blocks & (s->blocks - 1)) return BRIO_OK;
    FORWARD(cli_cloud_spacing(s->r, points, count, &spacing));
    if (spacing > 0 && (l->spacing == 0 || spacing < l->spacing)) l->spacing = spacing;
    return BRIO_OK;
}

/* Copies the points in a box. */
static size_t crop(const brio_mesh *block, const double *box, double *kept) {
    size_t count = 0;
    for (size_t v = 0; v < block->num_vertices; v++) {
        const double *p = block->vertices + 3 * v;
        bool inside = true;
        for (int k = 0; k < 3; k++) inside &= p[k] >= box[k] && p[k] <= box[k + 3];
        if (inside) memcpy(kept + 3 * count++, p, 3 * sizeof *p);
    }
    return count;
}

/* Takes a block. A coordinate that singles cannot hold ends the search. */
static int take_block(const brio_mesh *block, void *user) {
    survey *s = user;
    size_t n = block->num_vertices;
    double *kept = s->box ? malloc((3 * n + 1) * sizeof *kept) : NULL;
    if (s->box && !kept)
        s->status = cli_fail(s->r, BRIO_ERR_NO_MEMORY, "out of memory: a block of %zu points", n);
    else if (s->box)
        s->status = add_points(s, kept, crop(block, s->box, kept));
    else
        s->status = add_points(s, block->vertices, n);
    free(kept);
    return s->status != BRIO_OK || !fits(s->loss);
}

/* --- the whole --- */

/* Finds the loss of the points of a mesh. */
static brio_status cli_single_loss(run *r, const brio_mesh *mesh, single_loss *loss) {
    survey s = {.r = r, .loss = loss};
    *loss = (single_loss){.points = 0};
    return add_points(&s, mesh->vertices, mesh->num_vertices);
}

static bool can_be_read_twice(const char *path) {
    brio_place_facts found;
    return strcmp(path, "-") != 0 && brio_find_facts(path, &found) && found.kind == BRIO_IS_FILE;
}

/* Finds the loss of the points that a conversion of a file takes. Reads the file once, in blocks: points that merge are
 *  counted in each block, and the spacing is the least of some blocks. Says nothing of what cannot be read twice.
 *  o  its box and `thin` choose among the points.
 *  Returns BRIO_OK also for files with errors, which the conversion will find. */
static brio_status single_loss_of_file(run *r, const char *path, const brio_convert_options *o, single_loss *loss) {
    survey s = {.r = r, .loss = loss, .box = o->crop ? o->box : NULL};
    *loss = (single_loss){.points = 0};
    if (!can_be_read_twice(path)) return BRIO_OK;
    brio_status status = brio_read_blocks(r->ctx, path, o->from, take_block, &s, NULL);
    if (s.status != BRIO_OK) return s.status;
    if (status == BRIO_ERR_CANCELLED && fits(loss)) return status;
    if (loss->moved <= MOST_MOVED * o->thin) loss->merged = 0; /* no thinned points are as near as that */
    loss->spacing = fmax(loss->spacing, o->thin);
    return BRIO_OK;
}

/* Returns whether the loss ruins the points.   reason  receives why. */
static bool single_is_harmful(const single_loss *l, char reason[200]) {
    if (!fits(l)) {
        snprintf(reason, 200, "single precision cannot hold %g", l->largest);
        return true;
    }
    if ((double)l->merged > MOST_MERGED * (double)l->points) {
        snprintf(reason, 200, "single precision would merge %zu of %zu points with others", l->merged, l->points);
        return true;
    }
    if (l->spacing > 0 && l->moved > MOST_MOVED * l->spacing) {
        snprintf(reason, 200, "single precision would move points by up to %.3g, and most are %.3g from the next",
                 l->moved, l->spacing);
        return true;
    }
    return false;
}

/* --- what is said of it --- */

static bool has(brio_format format, unsigned what) {
    return (brio_format_facts(format)->holds & what) == what;
}

/* Returns whether a format has coordinates in single precision and no other ones. */
static bool has_singles_alone(brio_format format) {
    const brio_format_info *info = brio_format_facts(format);
    const unsigned others = BRIO_HOLDS_DOUBLES | BRIO_HOLDS_ORIGIN;
    return info && info->holds & BRIO_HOLDS_SINGLES && !(info->holds & others);
}

brio_status cli_check_precision(run *r, const char *path, const brio_mesh *mesh) {
    const common_options *c = &r->common;
    single_loss l;
    char reason[200];
    if (!c->output || !has_singles_alone(brio_format_of(c->format ? c->format : c->output))) return BRIO_OK;
    brio_status status = cli_single_loss(r, mesh, &l);
    if (status != BRIO_OK || !single_is_harmful(&l, reason)) return status;
    return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: %s: %s has no other; .ply has double precision", path, reason,
                    brio_format_facts(brio_format_of(c->format ? c->format : c->output))->name);
}

/* Returns whether points are rounded to singles: where there is nothing else, or by choice. */
static bool rounds(const brio_write_options *o) {
    return has_singles_alone(o->format) || (o->float32 && has(o->format, BRIO_HOLDS_SINGLES | BRIO_HOLDS_DOUBLES));
}

static void tell_idle(run *r, const char *path, const brio_write_options *o) {
    cli_tell_idle(r, path, has(o->format, BRIO_HOLDS_TEXT), has(o->format, BRIO_HOLDS_SINGLES));
    if (has(o->format, BRIO_HOLDS_RARE_DOUBLES) && !o->float32) cli_warn(r, WARNING_RARE_DOUBLES, path);
}

/* Takes back --float32 if the loss is harmful. Returns the number of points that merge. */
static size_t settle(run *r, const char *path, const single_loss *l, brio_write_options *o) {
    char reason[200];
    bool harmful = single_is_harmful(l, reason);
    if (!harmful) return l->merged;
    if (has_singles_alone(o->format)) {
        cli_warn(r, WARNING_SINGLE, path, reason);
        return l->merged;
    }
    cli_warn(r, WARNING_DOUBLE, path, reason);
    cli_fact_bool(&r->facts, "float32", false);
    o->float32 = 0;
    return 0;
}

brio_status cli_settle_precision(run *r, const char *path, const brio_mesh *mesh, brio_write_options *o,
                                 size_t *merged) {
    single_loss l = {.points = 0};
    tell_idle(r, path, o);
    if (rounds(o)) FORWARD(cli_single_loss(r, mesh, &l));
    *merged = settle(r, path, &l, o);
    return BRIO_OK;
}

brio_status cli_settle_conversion(run *r, int inputs, const brio_convert_options *o, brio_write_options *written,
                                  size_t *merged) {
    const char *to = r->common.output;
    single_loss all = {.points = 0};
    tell_idle(r, to, written);
    for (int i = 0; i < inputs && rounds(written) && fits(&all); i++) {
        single_loss l;
        FORWARD(single_loss_of_file(r, r->operands[i], o, &l));
        all.points += l.points;
        all.merged += l.merged;
        all.moved = fmax(all.moved, l.moved);
        if (fabs(l.largest) > fabs(all.largest)) all.largest = l.largest;
        if (l.spacing > 0 && !(all.spacing > 0 && all.spacing <= l.spacing)) all.spacing = l.spacing;
    }
    *merged = settle(r, to, &all, written);
    return BRIO_OK;
}

void cli_tell_moved(run *r, const char *path, double moved, size_t merged) {
    if (moved > 0) cli_fact_real(&r->facts, "moved", moved);
    if (merged) cli_fact_count(&r->facts, "merged", merged);
    if (merged) cli_warn(r, WARNING_MERGED, path, merged);
    if (moved > 0) cli_warn(r, WARNING_MOVED, path, moved);
}
