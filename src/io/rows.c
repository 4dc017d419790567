/* Points as rows of binary numbers, see rows.h. */
#include "io/rows.h"
#include "base/memory.h"
#include "base/team.h"
#include <string.h>

/* CHUNK: rows encoded at a time. Both chosen. */
enum { CHUNK = 1 << 16, ROWS_A_THREAD = 1 << 12 };

static size_t row_size(const brio_write_job *job) {
    size_t size = 3 * (job->options->float32 ? sizeof(float) : sizeof(double));
    for (size_t i = 0; i < job->mesh->num_properties; i++) size += brio_scalar_size(job->mesh->properties[i].type);
    return size;
}

static void encode_row(const brio_write_job *job, size_t v, char *bytes) {
    const double *p = job->mesh->vertices + 3 * v;
    float rounded[3] = {(float)p[0], (float)p[1], (float)p[2]};
    size_t size = job->options->float32 ? sizeof rounded : 3 * sizeof *p;
    memcpy(bytes, job->options->float32 ? (const void *)rounded : p, size);
    for (size_t i = 0; i < job->mesh->num_properties; i++) {
        const brio_property *property = &job->mesh->properties[i];
        bytes += size;
        size = brio_scalar_size(property->type);
        memcpy(bytes, (const char *)property->data + v * size, size);
    }
}

/* Rows of the vertices from `first` on. */
typedef struct {
    const brio_write_job *job;
    size_t first;
    char *bytes;
    size_t size; /* bytes of a row */
} chunk;

static void encode(void *user, size_t begin, size_t end, int thread) {
    const chunk *c = user;
    (void)thread;
    for (size_t i = begin; i < end; i++) encode_row(c->job, c->first + i, c->bytes + i * c->size);
}

brio_status brio_rows_write(brio_output *out, const brio_write_job *job) {
    brio_status status = BRIO_OK;
    const brio_mesh *m = job->mesh;
    size_t size = row_size(job), most = m->num_vertices < CHUNK ? m->num_vertices : CHUNK;
    char *bytes = NULL;
    if (!m->num_properties && !job->options->float32)
        return brio_output_bytes(out, m->vertices, 3 * m->num_vertices * sizeof *m->vertices);
    BRIO_TRY(BRIO_ALLOC(out->ctx, bytes, most * size));
    for (size_t begin = 0; begin < m->num_vertices; begin += CHUNK) {
        size_t count = m->num_vertices - begin < CHUNK ? m->num_vertices - begin : CHUNK;
        BRIO_TRY(brio_for(out->ctx, brio_threads(out->ctx, count, ROWS_A_THREAD), count, encode,
                          &(chunk){job, begin, bytes, size}));
        BRIO_TRY(brio_output_bytes(out, bytes, count * size));
    }
done:
    brio_release(out->ctx, bytes);
    return status;
}
