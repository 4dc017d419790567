/* Writes points as rows of numbers: .xyz .txt .csv .asc .tsv. A line of names comes first. */
#include "io/row_format.h"
#include <string.h>
#include <strings.h>

static char separator_of(const brio_output *out, const brio_write_job *job) {
    size_t length = strlen(out->name);
    if (job->options->separator) return job->options->separator[0];
    const char *extension = length >= 4 ? out->name + length - 4 : "";
    return !strcasecmp(extension, ".csv") ? ',' : !strcasecmp(extension, ".tsv") ? '\t' : ' ';
}

static brio_status write_names(brio_output *out, const brio_write_job *job, char separator) {
    /* spreadsheets read a line that begins with # as data, so that CSV has no comment */
    BRIO_FORWARD(brio_output_format(out, "%sx%cy%cz", separator == ' ' ? "# " : "", separator, separator));
    for (size_t i = 0; i < job->mesh->num_properties; i++)
        BRIO_FORWARD(brio_output_format(out, "%c%s", separator, job->names[i]));
    return brio_output_string(out, "\n");
}

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    (void)state;
    const char *given = job->options->separator;
    BRIO_EXPECT(out->ctx, !given || !strcmp(given, ",") || !strcmp(given, " "), BRIO_ERR_ARGUMENT,
                "%s: the separator \"%s\", expected a comma or a blank", out->name, given);
    char separator = separator_of(out, job);
    if (separator == ' ') BRIO_FORWARD(brio_output_comment(out, "# ", job->options->comment));
    return write_names(out, job, separator);
}

static brio_status write_rows(brio_output *out, const brio_write_job *job, void *state) {
    const brio_mesh *m = job->mesh;
    char separator = separator_of(out, job);
    (void)state;
    for (size_t v = 0; v < m->num_vertices; v++) {
        for (int k = 0; k < 3; k++)
            BRIO_FORWARD(brio_output_double(out, k ? separator : 0, m->vertices[3 * v + (size_t)k]));
        for (size_t i = 0; i < m->num_properties; i++)
            BRIO_FORWARD(brio_output_scalar(out, separator, &m->properties[i], v));
        BRIO_FORWARD(brio_output_string(out, "\n"));
    }
    return BRIO_OK;
}

static const brio_row_format rows = {.comments = true, .begin = begin, .rows = write_rows};

const brio_codec brio_xyz_codec = {.read_columns = brio_xyz_read, .rows = &rows};
