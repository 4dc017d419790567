/* Tables of numbers as outputs: see table.h. A .npy file has a header that numpy's format 1.0 describes, then the
 * numbers as they lie in memory.
 *
 * Based on: the NEP 1 of numpy, a simple file format for arrays. */
#include "cli/files/table.h"
#include "cli/files/files.h"
#include "cli/files/lost.h"
#include "cli/files/new_file.h"
#include "platform/target.h"
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <strings.h>

enum { ALIGNMENT = 64, PREAMBLE = 10, ROWS_A_CHECK = 1 << 14 };

static const char *extension_of(const run *r) {
    const char *path = r->common.output;
    if (r->common.format) return r->common.format + (r->common.format[0] == '.');
    if (!path) return "";
    const char *dot = strrchr(path + brio_folder_length(path), '.');
    return dot ? dot + 1 : "";
}

bool cli_is_table(const run *r, const char *extension) {
    return !strcasecmp(extension_of(r), extension);
}

brio_status cli_require_table(run *r) {
    const char *path = r->common.output;
    if (!path && r->common.json) return BRIO_OK;
    if (!path) return cli_fail_output(r, "no output: -o FILE is missing");
    if (!strcmp(path, "-") && !r->common.format) return cli_fail(r, BRIO_ERR_ARGUMENT, "-o - needs --format");
    if (!cli_is_table(r, "csv") && !cli_is_table(r, "npy"))
        return cli_fail(r, BRIO_ERR_ARGUMENT, "%s: '%s' writes .csv and .npy", path, r->command->name);
    return strcmp(path, "-") ? cli_check_target(r, path) : BRIO_OK;
}

/* --- formats --- */

static void write_csv_row(FILE *file, const table *t, size_t row) {
    for (size_t c = 0; c < t->columns; c++) {
        size_t i = row * t->columns + c;
        char text[32] = "nan";
        if (t->integers)
            snprintf(text, sizeof text, "%" PRId64, t->integers[i]);
        else if (t->reals[i] == t->reals[i])
            cli_format_real(t->reals[i], text);
        fprintf(file, c ? ",%s" : "%s", text);
    }
    putc('\n', file);
}

static brio_status write_csv(run *r, FILE *file, const table *t) {
    fprintf(file, "%s\n", t->names);
    for (size_t row = 0; row < t->rows; row++) {
        if (row % ROWS_A_CHECK == 0 && cli_check_interrupt(r) != BRIO_OK) return BRIO_ERR_CANCELLED;
        write_csv_row(file, t, row);
    }
    return BRIO_OK;
}

static void write_npy(FILE *file, const table *t) {
    const union {
        uint16_t number;
        uint8_t first;
    } order = {1};
    char text[160], shape[64];
    snprintf(shape, sizeof shape, t->columns > 1 ? "(%zu, %zu)" : "(%zu,)", t->rows, t->columns);
    int length = snprintf(text, sizeof text, "{'descr': '%c%c8', 'fortran_order': False, 'shape': %s, }",
                          order.first ? '<' : '>', t->integers ? 'i' : 'f', shape);
    int padded = (PREAMBLE + length + 1 + ALIGNMENT - 1) / ALIGNMENT * ALIGNMENT - PREAMBLE;
    const unsigned char begin[PREAMBLE] = {0x93, 'N', 'U', 'M', 'P', 'Y', 1, 0, (unsigned char)padded, 0};
    fwrite(begin, 1, PREAMBLE, file);
    fprintf(file, "%s%*s\n", text, padded - length - 1, "");
    fwrite(t->integers ? (const void *)t->integers : (const void *)t->reals, 8, t->rows * t->columns, file);
}

static brio_status write_rows(run *r, FILE *file, const table *t) {
    brio_status status = BRIO_OK;
    if (cli_is_table(r, "csv"))
        status = write_csv(r, file, t);
    else
        write_npy(file, t);
    if (status == BRIO_OK && (fflush(file) != 0 || ferror(file)))
        status = cli_fail(r, BRIO_ERR_WRITE, "%s: %s", r->common.output, strerror(errno));
    return status;
}

/* --- files --- */

static brio_status write_file(run *r, const char *path, const table *t) {
    brio_status status = BRIO_OK;
    new_file f;
    TRY(cli_new_file_open(r, path, &f));
    TRY(write_rows(r, f.file, t));
    TRY(cli_new_file_publish(r, path, &f));
done:
    cli_new_file_close(&f);
    return status;
}

/* Pipes, devices and open descriptors are written in place. A descriptor that is open keeps its place. */
static brio_status write_in_place(run *r, const char *path, int descriptor, const table *t) {
    int own = descriptor >= 0 ? brio_copy_descriptor(descriptor) : -1;
    FILE *file = own >= 0 ? brio_stream_of(own) : descriptor < 0 ? brio_open_stream(path, "w") : NULL;
    if (!file && own >= 0) brio_close(own);
    if (!file) return cli_fail(r, BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
    brio_status status = write_rows(r, file, t);
    if (fclose(file) != 0 && status == BRIO_OK) status = cli_fail(r, BRIO_ERR_WRITE, "%s: %s", path, strerror(errno));
    return status;
}

brio_status cli_write_table(run *r, const table *t) {
    const char *path = r->common.output;
    brio_place_facts found;
    brio_status status = BRIO_OK;
    if (!path) return BRIO_OK;
    cli_tell_idle(r, path, cli_is_table(r, "csv"), false);
    TRY(cli_check_interrupt(r));
    int descriptor = brio_path_descriptor(path);
    if (!strcmp(path, "-"))
        status = write_rows(r, stdout, t);
    else if (descriptor >= 0 || (brio_find_facts(path, &found) && found.kind != BRIO_IS_FILE))
        status = write_in_place(r, path, descriptor, t);
    else
        status = write_file(r, path, t);
    cli_lap(r, "write");
done:
    return status;
}
