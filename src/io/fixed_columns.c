/* Writes texts of points whose columns have a meaning by their place, and no names: .pts, .xyzrgb, .xyzn.
 *
 *     .pts     Leica's: the number of points, then x y z, the intensity and the colour as bytes, each if there is one
 *     .xyzrgb  Open3D's: x y z and the colour from 0 to 1
 *     .xyzn    x y z and the normal
 *
 * They have neither a comment nor a line of names: readers take every line for a point. brio reads them as it reads
 * all texts of points (text/xyz_read.c), where columns without names have the names that the extension tells. */
#include "io/row_format.h"
#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { DIGITS = 20, AXES = 3, MOST_COLUMNS = 4 };

/* What follows the coordinates of a point. */
typedef struct {
    const brio_property *of[MOST_COLUMNS];
    size_t count;
} fixed_columns;

static void add_channels(fixed_columns *c, brio_channels channels) {
    for (int k = 0; k < channels.count && k < AXES; k++) c->of[c->count++] = channels.of[k];
}

static brio_status write_points(brio_output *out, const fixed_columns *c, const brio_mesh *m) {
    for (size_t v = 0; v < m->num_vertices; v++) {
        BRIO_FORWARD(brio_output_point(out, m->vertices + AXES * v));
        for (size_t i = 0; i < c->count; i++) BRIO_FORWARD(brio_output_scalar(out, ' ', c->of[i], v));
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

static brio_status begin_without_count(brio_output *out, const brio_write_job *job, void *state) {
    (void)out, (void)job, (void)state;
    return BRIO_OK;
}

/* --- .xyzrgb and .xyzn --- */

static brio_status write_colours(brio_output *out, const brio_write_job *job, void *state) {
    fixed_columns c = {.count = 0};
    (void)state;
    add_channels(&c, brio_colour_of(job->mesh));
    return write_points(out, &c, job->mesh);
}

static brio_status write_normals(brio_output *out, const brio_write_job *job, void *state) {
    fixed_columns c = {.count = 0};
    (void)state;
    add_channels(&c, brio_normal_of(job->mesh));
    return write_points(out, &c, job->mesh);
}

/* --- .pts --- */

typedef struct {
    bool open;         /* whether the number of points is written last */
    uint64_t count_at; /* the byte at which it stands */
} pts_state;

/* Writes the number of points, or keeps a place for it. */
static brio_status begin_count(brio_output *out, const brio_write_job *job, void *state) {
    pts_state *s = state;
    s->open = job->points == BRIO_COUNT_UNKNOWN;
    s->count_at = brio_output_offset(out);
    if (!s->open) return brio_output_format(out, "%" PRIu64 "\n", job->points);
    return brio_output_format(out, "%*s\n", DIGITS, "");
}

static brio_status write_intensities_and_colours(brio_output *out, const brio_write_job *job, void *state) {
    fixed_columns c = {.count = 0};
    const brio_property *intensity = brio_mesh_property(job->mesh, "intensity");
    (void)state;
    if (intensity) c.of[c.count++] = intensity;
    add_channels(&c, brio_colour_of(job->mesh));
    return write_points(out, &c, job->mesh);
}

static brio_status end_count(brio_output *out, const brio_write_job *job, void *state) {
    const pts_state *s = state;
    char digits[DIGITS + 1];
    if (!s->open) return BRIO_OK;
    snprintf(digits, sizeof digits, "%-*" PRIu64, DIGITS, job->points);
    return brio_output_patch(out, s->count_at, digits, DIGITS);
}

static const brio_row_format pts_rows = {.state = sizeof(pts_state),
                                         .counts = true,
                                         .begin = begin_count,
                                         .rows = write_intensities_and_colours,
                                         .end = end_count},
                             xyzrgb_rows = {.begin = begin_without_count, .rows = write_colours},
                             xyzn_rows = {.begin = begin_without_count, .rows = write_normals};

const brio_codec brio_pts_codec = {.read_columns = brio_xyz_read, .rows = &pts_rows},
                 brio_xyzrgb_codec = {.read_columns = brio_xyz_read, .rows = &xyzrgb_rows},
                 brio_xyzn_codec = {.read_columns = brio_xyz_read, .rows = &xyzn_rows};
