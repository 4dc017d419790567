/* Writes VTK's XML files: tags, points with their properties, and arrays.
 *
 * Raw arrays are appended: their offsets follow from their sizes, so that nothing need be kept. The size of a
 * compressed array is known when it was compressed: compressed arrays are kept in memory until all tags are written.
 *
 * Based on: Schroeder, Martin, Lorensen. The Visualization Toolkit. 4th edition, Kitware 2006; VTK file formats. */
#include "base/memory.h"
#include "base/team.h"
#include "base/utf8.h"
#include "io/scalar.h"
#include "io/vtk/vtk_writer.h"
#include "io/vtk/vtk.h"
#include "mesh/properties.h"
#include <stdio.h>
#include <string.h>

/* --- compressed arrays --- */

/* Compressed arrays of VTK's XML files: blocks of zlib, and their sizes in front of them.
 *
 * Threads compress a batch of blocks at a time. The blocks do not depend on the number of threads. */

/* BLOCK: bytes of a block; a multiple of every scalar's size, and large enough that beginning anew costs little. BATCH:
 * blocks compressed at a time. Both chosen. */
enum { BLOCK = 1 << 17, BATCH = 32, WORDS = 3 };

typedef struct {
    brio_context *ctx;
    char *plain, *packed; /* BATCH blocks, and room for as many when they are compressed */
    size_t plain_size;    /* of all blocks of the batch */
    size_t sizes[BATCH];
    brio_status status;
} batch;

static void pack_blocks(void *user, size_t begin, size_t end, int thread) {
    batch *b = user;
    size_t bound = brio_vtk_deflate_bound(BLOCK);
    (void)thread;
    for (size_t i = begin; i < end; i++) {
        size_t left = b->plain_size - i * BLOCK;
        b->sizes[i] = bound;
        brio_report(&b->status, brio_vtk_deflate(b->ctx, b->plain + i * BLOCK, left < BLOCK ? left : BLOCK,
                                                 b->packed + i * bound, &b->sizes[i]));
    }
}

/* Appends the blocks of a batch, and stores their sizes in front.   first  the number of the first one. */
static brio_status append(brio_vtk_appended *a, const batch *b, uint64_t first, size_t count) {
    for (size_t i = 0; i < count; i++) {
        uint64_t size = b->sizes[i];
        BRIO_FORWARD(BRIO_RESERVE(b->ctx, a->packed, a->capacity, a->packed_size + size));
        memcpy(a->packed + (WORDS + first + i) * sizeof size, &size, sizeof size);
        memcpy(a->packed + a->packed_size, b->packed + i * brio_vtk_deflate_bound(BLOCK), size);
        a->packed_size += size;
    }
    return BRIO_OK;
}

static brio_status report(brio_vtk_writer *w, size_t size) {
    w->compressed += size;
    double share = w->out->expected ? (double)w->compressed / (double)w->out->expected : 0;
    return brio_progress(w->out->ctx, "write", share < 1 ? share : 1);
}

static brio_status pack_batches(brio_vtk_writer *w, brio_vtk_appended *a, batch *b) {
    brio_status status = BRIO_OK;
    const brio_vtk_source *source = &a->source;
    size_t size = brio_vtk_type_size(source->type);
    uint64_t most = BATCH * (uint64_t)BLOCK / size;
    for (uint64_t first = 0; first < source->count; first += most) {
        size_t numbers = (size_t)(source->count - first < most ? source->count - first : most);
        source->fill(source->user, first, numbers, b->plain);
        b->plain_size = numbers * size;
        size_t blocks = (b->plain_size + BLOCK - 1) / BLOCK;
        BRIO_TRY(brio_for_chunks(b->ctx, brio_threads(b->ctx, blocks, 1), blocks, 1, pack_blocks, b));
        BRIO_TRY(b->status);
        BRIO_TRY(append(a, b, first * size / BLOCK, blocks));
        BRIO_TRY(report(w, b->plain_size));
    }
done:
    return status;
}

/* Compresses an array into memory, block by block, in all threads. */
static brio_status vtk_pack(brio_vtk_writer *w, brio_vtk_appended *a) {
    brio_status status = BRIO_OK;
    batch b = {.ctx = w->out->ctx, .status = BRIO_OK};
    uint64_t bytes = a->source.count * brio_vtk_type_size(a->source.type), blocks = (bytes + BLOCK - 1) / BLOCK;
    const uint64_t words[WORDS] = {blocks, BLOCK, bytes % BLOCK};
    size_t most = blocks < BATCH ? (size_t)blocks : BATCH;
    BRIO_TRY(BRIO_ALLOC(b.ctx, b.plain, most * BLOCK));
    BRIO_TRY(BRIO_ALLOC(b.ctx, b.packed, most * brio_vtk_deflate_bound(BLOCK)));
    a->packed_size = (WORDS + (size_t)blocks) * sizeof *words;
    BRIO_TRY(BRIO_RESERVE(b.ctx, a->packed, a->capacity, a->packed_size));
    memcpy(a->packed, words, sizeof words);
    BRIO_TRY(pack_batches(w, a, &b));
    BRIO_TRY(BRIO_RESIZE(b.ctx, a->packed, a->packed_size));
done:
    brio_release(b.ctx, b.plain);
    brio_release(b.ctx, b.packed);
    return status;
}

/* --- the writer --- */

/* PART: bytes of w->part. PER_LINE: numbers of a line of text. SHARE: of the progress while arrays are compressed. All
 * chosen. */
enum { PART = 1 << 16, PER_LINE = 12 };
static const double SHARE = 0.9;

brio_vtk_writer brio_vtk_writer_new(brio_output *out, const brio_write_job *job, const char *kind) {
    return (brio_vtk_writer){.out = out,
                             .job = job,
                             .kind = kind,
                             .wide = job->mesh->num_vertices > INT32_MAX,
                             .bar = brio_progress_bar(out->ctx)};
}

void brio_vtk_writer_free(brio_vtk_writer *w) {
    for (size_t i = 0; i < w->num_appended; i++) brio_release(w->out->ctx, w->appended[i].packed);
    brio_release(w->out->ctx, w->appended);
    brio_release(w->out->ctx, w->part);
    brio_release(w->out->ctx, w->names);
    brio_release(w->out->ctx, w->properties);
    brio_progress_part(w->out->ctx, w->bar, 0, 1);
}

int brio_vtk_index_type(const brio_vtk_writer *w) {
    return w->wide ? BRIO_VTK_INT64 : BRIO_SCALAR_INT32;
}

/* --- tags --- */

static brio_status write_escaped(brio_output *out, const char *text) {
    for (; *text; text++) {
        const char *escape = *text == '&'   ? "&amp;"
                             : *text == '<' ? "&lt;"
                             : *text == '>' ? "&gt;"
                             : *text == '"' ? "&quot;"
                                            : NULL;
        BRIO_FORWARD(escape ? brio_output_string(out, escape) : brio_output_bytes(out, text, 1));
    }
    return BRIO_OK;
}

/* Writes a comment. Two hyphens would end an XML comment too early. */
static brio_status write_comment(brio_output *out, const char *comment) {
    if (!comment || !*comment) return BRIO_OK;
    BRIO_FORWARD(brio_output_string(out, "<!-- "));
    for (char last = 0; *comment; last = *comment++) {
        char plain = *comment == '-' && last == '-' ? ' ' : *comment;
        BRIO_FORWARD(brio_output_bytes(out, &plain, 1));
    }
    return brio_output_string(out, " -->\n");
}

brio_status brio_vtk_begin(brio_vtk_writer *w) {
    BRIO_FORWARD(BRIO_ALLOC(w->out->ctx, w->part, PART));
    if (w->job->options->compress) brio_progress_part(w->out->ctx, w->bar, 0, SHARE);
    BRIO_FORWARD(brio_output_format(
        w->out,
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"%s\" version=\"1.0\" byte_order=\"%s\" header_type=\"UInt64\"%s>\n",
        w->kind, brio_host_is_little() ? "LittleEndian" : "BigEndian",
        w->job->options->compress ? " compressor=\"vtkZLibDataCompressor\"" : ""));
    BRIO_FORWARD(write_comment(w->out, w->job->options->comment));
    return brio_output_format(w->out, "<%s>\n", w->kind);
}

/* Writes a tag up to the format of the array. */
static brio_status write_tag(brio_vtk_writer *w, const brio_vtk_source *a) {
    BRIO_FORWARD(brio_output_format(w->out, "<DataArray type=\"%s\" Name=\"", brio_vtk_type_name(a->type)));
    BRIO_FORWARD(write_escaped(w->out, a->name));
    return brio_output_format(w->out, "\" NumberOfComponents=\"%d\"", a->components);
}

/* --- arrays --- */

/* Calls fill for the whole array, a part at a time.   take  receives each part. */
static brio_status for_parts(brio_vtk_writer *w, const brio_vtk_source *a,
                             brio_status (*take)(brio_vtk_writer *w, const brio_vtk_source *a, size_t count)) {
    size_t most = PART / brio_vtk_type_size(a->type) / (size_t)a->components * (size_t)a->components;
    for (uint64_t first = 0; first < a->count; first += most) {
        size_t count = (size_t)(a->count - first < most ? a->count - first : most);
        a->fill(a->user, first, count, w->part);
        BRIO_FORWARD(take(w, a, count));
    }
    return BRIO_OK;
}

static brio_status write_raw_part(brio_vtk_writer *w, const brio_vtk_source *a, size_t count) {
    return brio_output_bytes(w->out, w->part, count * brio_vtk_type_size(a->type));
}

static brio_status write_text_part(brio_vtk_writer *w, const brio_vtk_source *a, size_t count) {
    const brio_property numbers = {.type = (brio_scalar)a->type, .data = w->part};
    size_t line = a->components > 1 ? (size_t)a->components : PER_LINE;
    for (size_t i = 0; i < count; i++) {
        char before = i % line ? ' ' : '\n';
        BRIO_FORWARD(a->type == BRIO_VTK_INT64 ? brio_output_integer(w->out, before, ((const int64_t *)w->part)[i])
                                               : brio_output_scalar(w->out, before, &numbers, i));
    }
    return BRIO_OK;
}

static brio_status write_text(brio_vtk_writer *w, const brio_vtk_source *a) {
    BRIO_FORWARD(write_tag(w, a));
    BRIO_FORWARD(brio_output_string(w->out, " format=\"ascii\">"));
    BRIO_FORWARD(for_parts(w, a, write_text_part));
    return brio_output_string(w->out, "\n</DataArray>\n");
}

brio_status brio_vtk_write_array(brio_vtk_writer *w, const brio_vtk_source *source) {
    if (w->job->options->ascii) return write_text(w, source);
    BRIO_FORWARD(BRIO_RESERVE(w->out->ctx, w->appended, w->appended_capacity, w->num_appended + 1));
    brio_vtk_appended *a = &w->appended[w->num_appended++];
    *a = (brio_vtk_appended){.source = *source};
    if (w->job->options->compress) BRIO_FORWARD(vtk_pack(w, a));
    BRIO_FORWARD(write_tag(w, source));
    BRIO_FORWARD(brio_output_format(w->out, " format=\"appended\" offset=\"%llu\"/>\n", (unsigned long long)w->offset));
    w->offset += a->packed ? a->packed_size : sizeof(uint64_t) + source->count * brio_vtk_type_size(source->type);
    return BRIO_OK;
}

static brio_status write_appended(brio_vtk_writer *w) {
    BRIO_FORWARD(brio_output_string(w->out, "<AppendedData encoding=\"raw\">\n_"));
    for (size_t i = 0; i < w->num_appended; i++) {
        brio_vtk_appended *a = &w->appended[i];
        uint64_t bytes = a->source.count * brio_vtk_type_size(a->source.type);
        if (a->packed) {
            BRIO_FORWARD(brio_output_bytes(w->out, a->packed, a->packed_size));
            brio_release(w->out->ctx, a->packed);
            a->packed = NULL;
            continue;
        }
        BRIO_FORWARD(brio_output_bytes(w->out, &bytes, sizeof bytes));
        BRIO_FORWARD(for_parts(w, &a->source, write_raw_part));
    }
    return brio_output_string(w->out, "\n</AppendedData>\n");
}

brio_status brio_vtk_end(brio_vtk_writer *w) {
    BRIO_FORWARD(brio_output_format(w->out, "</Piece>\n</%s>\n", w->kind));
    if (w->job->options->compress) {
        brio_progress_part(w->out->ctx, w->bar, SHARE, 1);
        w->out->expected = w->offset;
    }
    if (!w->job->options->ascii) BRIO_FORWARD(write_appended(w));
    return brio_output_string(w->out, "</VTKFile>\n");
}

/* --- points --- */

static void fill_coordinates(void *user, uint64_t first, size_t count, void *to) {
    const brio_vtk_writer *w = user;
    const double *from = w->job->mesh->vertices + first;
    if (!w->job->options->float32) {
        memcpy(to, from, count * sizeof *from);
        return;
    }
    for (size_t i = 0; i < count; i++) ((float *)to)[i] = (float)from[i];
}

/* Numbers of a property, or of a colour: those of a point come one after the other. */
static void fill_property(void *user, uint64_t first, size_t count, void *to) {
    const brio_vtk_property *p = user;
    size_t size = brio_scalar_size(p->of.of[0]->type), channels = (size_t)p->of.count;
    for (size_t i = 0; i < count; i++) {
        uint64_t row = (first + i) / channels - p->first;
        const brio_property *channel = p->of.of[(first + i) % channels];
        if (row < p->rows) /* of rows before the first one, the difference has wrapped round */
            memcpy((char *)to + i * size, (const char *)channel->data + row * size, size);
        else
            memset((char *)to + i * size, 0, size);
    }
}

/* Returns the colour of bytes that becomes one array, unless its name is taken. */
static brio_channels colour_of(const brio_mesh *m) {
    brio_channels colour = brio_colour_of(m);
    bool taken = brio_mesh_property(m, "RGB") || brio_mesh_property(m, "RGBA");
    if (colour.count && (taken || colour.of[0]->type != BRIO_SCALAR_UINT8)) colour.count = 0;
    return colour;
}

static bool is_taken(char (*names)[64], size_t count, const char *name) {
    for (size_t i = 0; i < count; i++)
        if (!strcmp(names[i], name)) return true;
    return false;
}

/* Makes names. XML cannot represent control characters, which become blanks; a name that is taken then gets _2, _3 and
 * so on. */
static void make_names(const brio_mesh *m, char (*names)[64]) {
    for (size_t i = 0; i < m->num_properties; i++) {
        char plain[64];
        snprintf(plain, sizeof plain, "%s", m->properties[i].name);
        for (char *c = plain; *c; c++)
            if ((unsigned char)*c < ' ') *c = ' ';
        strcpy(names[i], plain);
        for (size_t n = 2; is_taken(names, i, names[i]); n++) brio_numbered_name(names[i], 64, plain, n);
    }
}

/* Writes the properties of points or of faces, which are given as points.   before, behind  rows that are 0.
 * names, properties  room for them, which stays until the end of the file. */
static brio_status write_properties(brio_vtk_writer *w, const brio_mesh *m, uint64_t before, uint64_t behind,
                                    char (*names)[64], brio_vtk_property *properties) {
    const brio_channels colour = colour_of(m);
    make_names(m, names);
    for (size_t i = 0; i < m->num_properties; i++) {
        const brio_property *p = &m->properties[i];
        bool joins = brio_channels_have(&colour, p);
        brio_vtk_source source = {names[i],      p->type,       1, before + m->num_vertices + behind,
                                  fill_property, properties + i};
        properties[i] = (brio_vtk_property){{.of = {p}, .count = 1}, before, m->num_vertices};
        if (joins && p != colour.of[0]) continue;
        if (joins) {
            properties[i].of = colour;
            source.name = colour.count == 4 ? "RGBA" : "RGB";
            source.components = colour.count;
            source.count *= (uint64_t)colour.count;
        }
        BRIO_FORWARD(brio_vtk_write_array(w, &source));
    }
    return BRIO_OK;
}

brio_status brio_vtk_write_points(brio_vtk_writer *w) {
    const brio_mesh *m = w->job->mesh;
    const brio_scalar type = w->job->options->float32 ? BRIO_SCALAR_FLOAT32 : BRIO_SCALAR_FLOAT64;
    BRIO_FORWARD(BRIO_ALLOC(w->out->ctx, w->names, m->num_properties + m->num_face_properties));
    BRIO_FORWARD(BRIO_ALLOC(w->out->ctx, w->properties, m->num_properties + m->num_face_properties));
    BRIO_FORWARD(brio_output_string(w->out, "<Points>\n"));
    BRIO_FORWARD(brio_vtk_write_array(
        w, &(brio_vtk_source){"Points", type, 3, 3 * (uint64_t)m->num_vertices, fill_coordinates, w}));
    BRIO_FORWARD(brio_output_string(w->out, "</Points>\n<PointData>\n"));
    BRIO_FORWARD(write_properties(w, m, 0, 0, w->names, w->properties));
    return brio_output_string(w->out, "</PointData>\n");
}

brio_status brio_vtk_write_cell_data(brio_vtk_writer *w, uint64_t before, uint64_t behind) {
    const brio_mesh *m = w->job->mesh, faces = brio_mesh_faces_as_points(m);
    if (!m->num_faces || !m->num_face_properties) return BRIO_OK;
    BRIO_FORWARD(brio_output_string(w->out, "<CellData>\n"));
    BRIO_FORWARD(
        write_properties(w, &faces, before, behind, w->names + m->num_properties, w->properties + m->num_properties));
    return brio_output_string(w->out, "</CellData>\n");
}
