/* Writes points as rows of numbers: .xyz .pts .txt .csv. A line of names comes first. */
#include "io/row_format.h"
#include <string.h>
#include <strings.h>

static bool wants_commas(const char *path) {
    size_t length = strlen(path);
    return length >= 4 && !strcasecmp(path + length - 4, ".csv");
}

static brio_status write_names(brio_output *out, const brio_write_job *job, char separator) {
    brio_status status = BRIO_OK;
    /* spreadsheets read a line that begins with # as data */
    BRIO_TRY(brio_output_format(out, "%sx%cy%cz", separator == ',' ? "" : "# ", separator, separator));
    for (size_t i = 0; i < job->mesh->num_properties; i++)
        BRIO_TRY(brio_output_format(out, "%c%s", separator, job->names[i]));
    BRIO_TRY(brio_output_string(out, "\n"));
done:
    return status;
}

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    (void)state;
    BRIO_TRY(brio_output_comment(out, "# ", job->options->comment));
    BRIO_TRY(write_names(out, job, wants_commas(out->name) ? ',' : ' '));
done:
    return status;
}

static brio_status write_rows(brio_output *out, const brio_write_job *job, void *state) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    char separator = wants_commas(out->name) ? ',' : ' ';
    (void)state;
    for (size_t v = 0; v < m->num_vertices; v++) {
        for (int k = 0; k < 3; k++)
            BRIO_TRY(brio_output_double(out, k ? separator : 0, m->vertices[3 * v + (size_t)k]));
        for (size_t i = 0; i < m->num_properties; i++)
            BRIO_TRY(brio_output_scalar(out, separator, &m->properties[i], v));
        BRIO_TRY(brio_output_string(out, "\n"));
    }
done:
    return status;
}

const brio_row_format brio_xyz_rows = {.comments = true, .begin = begin, .rows = write_rows};
