/* Colours and normals: their names, their depth, and the change of depth from format to format.
 *
 * From 16 to 8 bits a value loses its lower byte: writers of 16 bits multiply bytes by 256, as the LAS specification
 * says, or by 257, and both come back exactly so. From 8 to 16 bits a value is multiplied by 257, so that white stays
 * white. Floating-point numbers from 0 to 1 are rounded to the nearest of the 256 or 65536 values. */
#include "io/colour.h"
#include "base/memory.h"
#include "io/scalar.h"
#include "mesh/properties.h"
#include <ctype.h>
#include <math.h>
#include <string.h>

/* --- names --- */

enum { COLOUR, NORMAL, INTENSITY, KINDS, MOST = 4 };

static const char *const usual[KINDS][MOST] = {{"red", "green", "blue", "alpha"}, {"nx", "ny", "nz"}, {"intensity"}};
static const int needed[KINDS] = {3, 3, 1}; /* of the names; the others may be missing */

/* Names by which programs know the same, in small letters and without signs. Rf, Gf and Bf go from 0 to 1 in
 * CloudCompare, which also writes scalar_NAME; diffuse_red is what old PLY files have, normal_x and color_r what PCL's
 * users write; names with numbers are the parts of an array. */
static const struct {
    int kind;
    const char *names[MOST];
} families[] = {{COLOUR, {"red", "green", "blue", "alpha"}},
                {COLOUR, {"r", "g", "b", "a"}},
                {COLOUR, {"rf", "gf", "bf", "af"}},
                {COLOUR, {"diffusered", "diffusegreen", "diffuseblue", "diffusealpha"}},
                {COLOUR, {"colorred", "colorgreen", "colorblue", "coloralpha"}},
                {COLOUR, {"colourred", "colourgreen", "colourblue", "colouralpha"}},
                {COLOUR, {"colorr", "colorg", "colorb", "colora"}},
                {COLOUR, {"vertexred", "vertexgreen", "vertexblue", "vertexalpha"}},
                {COLOUR, {"scalarred", "scalargreen", "scalarblue", "scalaralpha"}},
                {COLOUR, {"scalarr", "scalarg", "scalarb", "scalara"}},
                {COLOUR, {"rgb0", "rgb1", "rgb2"}},
                {COLOUR, {"rgba0", "rgba1", "rgba2", "rgba3"}},
                {COLOUR, {"color0", "color1", "color2", "color3"}},
                {COLOUR, {"colors0", "colors1", "colors2", "colors3"}},
                {NORMAL, {"nx", "ny", "nz"}},
                {NORMAL, {"normalx", "normaly", "normalz"}},
                {NORMAL, {"xnormal", "ynormal", "znormal"}},
                {NORMAL, {"normx", "normy", "normz"}},
                {NORMAL, {"scalarnx", "scalarny", "scalarnz"}},
                {NORMAL, {"normal0", "normal1", "normal2"}},
                {NORMAL, {"normals0", "normals1", "normals2"}},
                {INTENSITY, {"intensity"}},
                {INTENSITY, {"scalarintensity"}}};

/* Copies what counts of a name: letters and digits before a unit in brackets, in small letters. */
static void plain_name(const char *name, char plain[64]) {
    size_t n = 0;
    for (; *name && ((*name != '(' && *name != '[') || n == 0); name++)
        if (isalnum((unsigned char)*name) || (unsigned char)*name >= 0x80)
            plain[n++] = (char)((unsigned char)*name < 0x80 ? tolower((unsigned char)*name) : *name);
    plain[n] = 0;
}

/* Finds the properties of a family; of two with one plain name the first counts. */
static void find_family(const brio_mesh *m, const char *const names[MOST], brio_property *found[MOST]) {
    char plain[64];
    for (int k = 0; k < MOST; k++) found[k] = NULL;
    for (size_t i = 0; i < m->num_properties; i++) {
        plain_name(m->properties[i].name, plain);
        for (int k = 0; k < MOST && names[k]; k++)
            if (!found[k] && !strcmp(plain, names[k])) found[k] = &m->properties[i];
    }
}

static bool is_taken(const brio_mesh *m, const char *name, const brio_property *by_other_than) {
    const brio_property *p = brio_mesh_property(m, name);
    return p && p != by_other_than;
}

void brio_colour_name(brio_mesh *m) {
    brio_property *found[MOST];
    for (size_t f = 0; f < sizeof families / sizeof *families; f++) {
        int kind = families[f].kind;
        bool all = true;
        find_family(m, families[f].names, found);
        for (int k = 0; k < needed[kind]; k++) all &= found[k] && !is_taken(m, usual[kind][k], found[k]);
        for (int k = 0; k < MOST && all && usual[kind][k]; k++)
            if (found[k] && !is_taken(m, usual[kind][k], found[k])) strcpy(found[k]->name, usual[kind][k]);
    }
}

/* --- channels --- */

static brio_channels channels_of(const brio_mesh *m, int kind) {
    brio_channels c = {.count = 0};
    for (int k = 0; k < MOST && usual[kind][k]; k++) {
        const brio_property *p = brio_mesh_property(m, usual[kind][k]);
        if (!p || (k && p->type != c.of[0]->type)) break;
        c.of[c.count++] = p;
    }
    if (c.count < needed[kind]) c.count = 0;
    return c;
}

static bool is_real(brio_scalar type) {
    return type == BRIO_SCALAR_FLOAT32 || type == BRIO_SCALAR_FLOAT64;
}

brio_channels brio_colour_of(const brio_mesh *m) {
    return channels_of(m, COLOUR);
}

brio_channels brio_normal_of(const brio_mesh *m) {
    brio_channels c = channels_of(m, NORMAL);
    if (c.count && !is_real(c.of[0]->type)) c.count = 0;
    return c;
}

bool brio_channels_have(const brio_channels *c, const brio_property *p) {
    for (int k = 0; k < c->count; k++)
        if (c->of[k] == p) return true;
    return false;
}

/* --- depth --- */

/* White of 1, 255 and 65535, and what is near enough to a step between them to be that step: texts have six digits. */
static const double UNIT = 1, BYTE = 255, WORD = 65535, NEAR = 1e-6;

/* Returns white as type and metadata tell it, or 0. */
static double told_white(const brio_mesh *m, const brio_channels *c) {
    const brio_metadata *depth = brio_mesh_metadata(m, "colour.depth");
    if (c->of[0]->type == BRIO_SCALAR_UINT8) return BYTE;
    if (depth) return !strcmp(depth->bytes, "8") ? BYTE : !strcmp(depth->bytes, "1") ? UNIT : WORD;
    return c->of[0]->type == BRIO_SCALAR_UINT16 ? WORD : 0;
}

static bool is_open(const brio_colour_depth *plan, const brio_mesh *m) {
    brio_channels c = brio_colour_of(m);
    bool known = plan->to == BRIO_COLOURS_AS_THEY_ARE || plan->looked || plan->decided;
    return !known && c.count && told_white(m, &c) == 0;
}

static void look(brio_colour_depth *plan, const brio_mesh *m) {
    brio_channels c = brio_colour_of(m);
    for (int k = 0; k < c.count; k++)
        for (size_t v = 0; v < m->num_vertices; v++) {
            double x = brio_property_value(c.of[k], v);
            if (isnan(x)) continue;
            plan->least = fmin(plan->least, x);
            plan->most = fmax(plan->most, x);
            plan->fraction |= x != floor(x);
        }
}

/* Returns white of values in the range that was seen. Values a little over 1 that are no whole numbers are not
 * bytes. */
static double seen_white(const brio_colour_depth *plan, brio_scalar type) {
    if (plan->least < 0 || plan->most > WORD) return 0;
    if (is_real(type) && (plan->most <= UNIT || (plan->fraction && plan->most < 2))) return UNIT;
    return plan->most <= BYTE ? BYTE : WORD;
}

static void decide(brio_colour_depth *plan, const brio_mesh *m, const brio_channels *c) {
    plan->guessed = is_open(plan, m);
    if (plan->guessed) look(plan, m);
    plan->white = told_white(m, c);
    if (plan->white == 0) plan->white = seen_white(plan, c->of[0]->type);
    plan->decided = true;
}

double brio_colour_white(const brio_mesh *m) {
    brio_colour_depth plan = {.to = BRIO_COLOURS_8};
    brio_channels c = brio_colour_of(m);
    if (c.count) decide(&plan, m, &c);
    return plan.white;
}

uint8_t brio_colour_byte(double x, double white) {
    if (!(x > 0)) return 0;
    if (x >= white) return 255;
    return (uint8_t)(white == WORD && x == floor(x) ? (uint32_t)x >> 8 : rint(x / white * BYTE));
}

/* --- change of depth --- */

/* Returns white of the file that is written, and the type of its numbers; 0: they stay as they are. */
static double target_white(const brio_colour_depth *plan, brio_scalar from, brio_scalar *type) {
    brio_colours to = plan->to;
    if (plan->white == 0) return 0;
    if (to == BRIO_COLOURS_NORMALIZED)
        to = plan->white == BYTE ? BRIO_COLOURS_8 : plan->white == WORD ? BRIO_COLOURS_16 : BRIO_COLOURS_UNIT;
    if (to == BRIO_COLOURS_8_OR_16) to = plan->white == WORD ? BRIO_COLOURS_16 : BRIO_COLOURS_8;
    switch (to) {
    case BRIO_COLOURS_8:
        *type = BRIO_SCALAR_UINT8;
        return from == *type ? 0 : BYTE;
    case BRIO_COLOURS_16:
        *type = BRIO_SCALAR_UINT16;
        return from == *type ? 0 : WORD;
    case BRIO_COLOURS_UNIT:
        *type = from == BRIO_SCALAR_FLOAT64 && plan->white == UNIT && plan->to == BRIO_COLOURS_UNIT
                    ? from
                    : BRIO_SCALAR_FLOAT32;
        return from == *type && plan->white == UNIT ? 0 : UNIT;
    case BRIO_COLOURS_AS_THEY_ARE:
    case BRIO_COLOURS_8_OR_16:
    case BRIO_COLOURS_NORMALIZED:
        break;
    }
    return 0;
}

/* Returns a value at another depth, and takes note of what that loses. */
static double changed(brio_colour_depth *plan, double x, double white) {
    if (isnan(x)) {
        plan->lost = true;
        return 0;
    }
    if (plan->white == WORD && white == BYTE && x == floor(x)) {
        uint32_t word = (uint32_t)x;
        plan->off_steps_257 |= word % 257 != 0;
        plan->off_steps_256 |= word % 256 != 0;
        return word >> 8;
    }
    double exact = x / plan->white * white, step = white == UNIT ? exact : rint(exact);
    plan->lost |= fabs(step / white - x / plan->white) > NEAR || step > white;
    return fmin(step, white);
}

/* Checks a guess of the depth. A guess by the first block holds as long as no value shows that white is more. */
static brio_status check_guess(brio_context *ctx, brio_colour_depth *plan, const brio_mesh *m) {
    brio_channels c = brio_colour_of(m);
    double guess = plan->white;
    if (!plan->guessed || !c.count) return BRIO_OK;
    look(plan, m);
    BRIO_EXPECT(ctx, seen_white(plan, c.of[0]->type) == guess, BRIO_ERR_FORMAT,
                "the colours of the first points seemed to have a white of %g, but one further on is %g: such an input "
                "has to be a file, which can be read twice",
                guess, plan->most > guess ? plan->most : plan->least);
    return BRIO_OK;
}

static brio_status change(brio_context *ctx, brio_colour_depth *plan, brio_property *p, size_t count, brio_scalar type,
                          double white) {
    char *data = NULL;
    size_t size = brio_scalar_size(type);
    BRIO_FORWARD(brio_resize_to(ctx, &data, count + 1, size));
    for (size_t v = 0; v < count; v++)
        brio_scalar_store(data + v * size, type, changed(plan, brio_property_value(p, v), white));
    p->data = data;
    p->type = type;
    return BRIO_OK;
}

/* Shows the colours of points: shown->properties is then a list that free_list frees. */
static brio_status show(brio_context *ctx, brio_colour_depth *plan, const brio_mesh *m, brio_mesh *shown) {
    brio_channels c = brio_colour_of(m);
    brio_scalar type = BRIO_SCALAR_END;
    if (!c.count || plan->to == BRIO_COLOURS_AS_THEY_ARE) return BRIO_OK;
    if (!plan->decided) decide(plan, m, &c);
    BRIO_FORWARD(check_guess(ctx, plan, m));
    double white = target_white(plan, c.of[0]->type, &type);
    if (white == 0) return BRIO_OK;
    shown->properties = NULL;
    BRIO_FORWARD(BRIO_ALLOC(ctx, shown->properties, m->num_properties));
    memcpy(shown->properties, m->properties, m->num_properties * sizeof *m->properties);
    for (int k = 0; k < c.count; k++)
        BRIO_FORWARD(change(ctx, plan, &shown->properties[c.of[k] - m->properties], m->num_vertices, type, white));
    return BRIO_OK;
}

static void free_list(brio_context *ctx, const brio_property *list, size_t count, brio_property *shown) {
    if (!shown || shown == list) return;
    for (size_t i = 0; i < count; i++)
        if (shown[i].data != list[i].data) brio_release(ctx, shown[i].data);
    brio_release(ctx, shown);
}

/* --- the whole --- */

bool brio_colour_is_open(const brio_colour_plan *plan, const brio_mesh *m) {
    return is_open(&plan->points, m);
}

void brio_colour_look(brio_colour_plan *plan, const brio_mesh *m) {
    look(&plan->points, m);
}

brio_status brio_colour_show(brio_context *ctx, brio_colour_plan *plan, const brio_mesh *m, brio_mesh *shown) {
    brio_status status = BRIO_OK;
    const brio_mesh faces = brio_mesh_faces_as_points(m);
    brio_mesh shown_faces = faces;
    *shown = *m;
    BRIO_TRY(show(ctx, &plan->points, m, shown));
    if (m->num_faces) BRIO_TRY(show(ctx, &plan->faces, &faces, &shown_faces));
done:
    shown->face_properties = shown_faces.properties;
    return status;
}

void brio_colour_free(brio_context *ctx, const brio_mesh *m, brio_mesh *shown) {
    free_list(ctx, m->properties, m->num_properties, shown->properties);
    free_list(ctx, m->face_properties, m->num_face_properties, shown->face_properties);
    shown->properties = shown->face_properties = NULL;
}

static bool has_lost(const brio_colour_depth *plan) {
    return plan->lost || (plan->off_steps_257 && plan->off_steps_256);
}

bool brio_colour_lost(const brio_colour_plan *plan) {
    return has_lost(&plan->points) || has_lost(&plan->faces);
}
