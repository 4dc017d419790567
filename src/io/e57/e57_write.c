/* Writes E57 files: the points of each scanner's place as a scan with its pose.
 *
 * All points are seen before the first one is written, for the scans (scans.h). A scan is a section of packets; each
 * packet has as many points as fit. Coordinates are doubles, and every property has its own type, so that no bit is
 * lost; only coordinates of a scanner that stands elsewhere than at 0 are differences, which may round: they are
 * measured. A pose moves and does not turn. The XML section, with the bounds of all scans, and the headers come last.
 *
 * Based on: ASTM E2807-11. Standard specification for 3D imaging data exchange, version 1.0. */
#include "base/memory.h"
#include "base/utf8.h"
#include "io/e57/e57.h"
#include "io/little_endian.h"
#include "io/number.h"
#include "io/output.h"
#include "io/scalar.h"
#include "io/scans.h"
#include <assert.h>
#include <inttypes.h>
#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* --- pages --- */

/* The pages of a file: 1,020 bytes of content and a checksum each. The first page, which has the header, is written
 * last, and so are the headers of sections: each stands at the beginning of a page, which is kept for it.
 *
 * Based on: ASTM E2807-11, 7 (physical and logical offsets, checksums). */

typedef struct brio_e57_pen {
    brio_output *out;       /* set by the caller before every call */
    uint32_t (*table)[256]; /* for the checksum */
    char page[BRIO_E57_PAGE], kept[BRIO_E57_PAGE];
    size_t used;        /* bytes of content in `page` */
    uint64_t pages;     /* that are complete */
    uint64_t kept_page; /* the page that is or will be in `kept` */
    uint64_t sum;       /* of the checksums so far: the same bytes have the same one */
} brio_e57_pen;

static void e57_pen_free(brio_e57_pen *p, brio_context *ctx) {
    brio_release(ctx, p->table);
    p->table = NULL;
}

/* Returns the logical offset of the next byte. */
static uint64_t e57_pen_offset(const brio_e57_pen *p) {
    return p->pages * BRIO_E57_CONTENT + p->used;
}

/* Writes the checksum of a page behind its content. Returns the checksum. */
static uint32_t sign(const brio_e57_pen *p, char page[BRIO_E57_PAGE]) {
    uint32_t sum = brio_e57_checksum(p->table, page);
    for (int i = 0; i < 4; i++) page[BRIO_E57_CONTENT + i] = (char)(sum >> (24 - 8 * i) & 255);
    return sum;
}

static brio_status write_page(brio_e57_pen *p) {
    assert(p->used == BRIO_E57_CONTENT);
    p->sum = (p->sum ^ sign(p, p->page)) * UINT64_C(0x100000001b3);
    if (p->pages == p->kept_page) memcpy(p->kept, p->page, BRIO_E57_PAGE);
    p->pages++;
    p->used = 0;
    return brio_output_bytes(p->out, p->page, BRIO_E57_PAGE);
}

static brio_status e57_put(brio_e57_pen *p, const void *bytes, size_t size) {
    const char *at = bytes;
    while (size) {
        size_t part = size < BRIO_E57_CONTENT - p->used ? size : BRIO_E57_CONTENT - p->used;
        memcpy(p->page + p->used, at, part);
        p->used += part;
        at += part;
        size -= part;
        if (p->used == BRIO_E57_CONTENT) BRIO_FORWARD(write_page(p));
    }
    return BRIO_OK;
}

/* Writes a text as printf does: at most 511 bytes. */
__attribute__((format(printf, 2, 3))) static brio_status e57_put_text(brio_e57_pen *p, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    assert(length >= 0 && (size_t)length < sizeof text);
    return e57_put(p, text, (size_t)length);
}

/* Fills the page with zeros, so that the next byte begins a page, which is kept until the next call. */
static brio_status e57_pen_turn(brio_e57_pen *p) {
    if (p->used) {
        memset(p->page + p->used, 0, BRIO_E57_CONTENT - p->used);
        p->used = BRIO_E57_CONTENT;
        BRIO_FORWARD(write_page(p));
    }
    p->kept_page = p->pages;
    return BRIO_OK;
}

/* Begins a file: its first page is empty. Call e57_pen_free even if this fails. */
static brio_status e57_pen_begin(brio_e57_pen *p) {
    const char header[1] = {0};
    BRIO_FORWARD(brio_e57_checksum_table(p->out->ctx, &p->table));
    p->kept_page = UINT64_MAX;
    BRIO_FORWARD(e57_put(p, header, sizeof header));
    return e57_pen_turn(p);
}

/* Replaces the first bytes of the page that is kept. */
static brio_status e57_pen_patch(brio_e57_pen *p, const void *bytes, size_t size) {
    if (p->pages == p->kept_page) { /* the page is not written yet */
        memcpy(p->page, bytes, size);
        return BRIO_OK;
    }
    memcpy(p->kept, bytes, size);
    sign(p, p->kept);
    return brio_output_patch(p->out, p->kept_page * BRIO_E57_PAGE, p->kept, BRIO_E57_PAGE);
}

/* Fills the last page with zeros and gives the first one its bytes. */
static brio_status e57_pen_end(brio_e57_pen *p, const void *header, size_t size) {
    BRIO_FORWARD(e57_pen_turn(p));
    memset(p->kept, 0, BRIO_E57_PAGE);
    p->kept_page = 0;
    return e57_pen_patch(p, header, size);
}

/* --- scans --- */

enum { SECTION_HEADER = 32, DATA_HEADER = 6, PACKET = 65536, FILE_HEADER = 48, AXES = 3 };

#define E57_NAMES    "http://www.astm.org/COMMIT/E57/2010-e57-v1.0"
#define NORMAL_NAMES "http://www.libe57.org/E57_NOR_surface_normals.txt"
#define OWN_NAMES    "urn:brio:e57:properties" /* of all properties that the format has no field for */

/* A field of the prototype: a coordinate, a property, or `valid`: cartesianInvalidState, which is 0 of all points, has
 * no bits, and is there because pye57 reads no scan without it. */
typedef struct {
    char element[BRIO_E57_NAME];
    bool axis, valid, renamed;
    size_t from; /* axis or index of the property */
    brio_scalar type;
} field;

/* What the XML section says of a scan that is written. */
typedef struct {
    uint64_t section;                          /* physical offset */
    uint64_t sum;                              /* of the checksums up to it */
    double low[AXES], high[AXES], least, most; /* of the coordinates in the scan, and of the intensity */
} written;

typedef struct {
    brio_scans scans; /* first: BRIO_SCANS_ROWS */
    brio_e57_pen pen;
    field *fields;
    size_t num_fields, record; /* bytes of a point */
    written *list;             /* of each scan */
    size_t num_written;
    char *packet, *crs;
} e57_writer;

/* --- fields --- */

/* Properties that the format has fields for. `whole`: only of integers. */
static const struct {
    const char *property, *element;
    bool whole;
} known[] = {{"intensity", "intensity", false},
             {"row_index", "rowIndex", true},
             {"column_index", "columnIndex", true},
             {"return_index", "returnIndex", true},
             {"return_count", "returnCount", true},
             {"time_stamp", "timeStamp", false},
             {"red", "colorRed", false},
             {"green", "colorGreen", false},
             {"blue", "colorBlue", false},
             {"nx", "nor:normalX", false},
             {"ny", "nor:normalY", false},
             {"nz", "nor:normalZ", false}};

static bool is_real(brio_scalar type) {
    return type == BRIO_SCALAR_FLOAT32 || type == BRIO_SCALAR_FLOAT64;
}

/* Returns the element of a property, or NULL. */
static const char *known_element(const brio_mesh *m, const brio_property *p) {
    brio_channels colour = brio_colour_of(m), normal = brio_normal_of(m);
    for (size_t i = 0; i < sizeof known / sizeof *known; i++) {
        if (strcmp(known[i].property, p->name) != 0 || (known[i].whole && is_real(p->type))) continue;
        bool is_colour = !strncmp(known[i].element, "color", 5), is_normal = known[i].element[3] == ':';
        bool deep = p->type == BRIO_SCALAR_UINT8 || p->type == BRIO_SCALAR_UINT16;
        if (is_colour && !(deep && brio_channels_have(&colour, p))) return NULL;
        if (is_normal && !brio_channels_have(&normal, p)) return NULL;
        return known[i].element;
    }
    return NULL;
}

static bool is_taken(const e57_writer *w, const char *element) {
    for (size_t i = 0; i < w->num_fields; i++)
        if (!strcmp(w->fields[i].element, element)) return true;
    return false;
}

/* Makes an element's name of a property: letters, digits and _ behind the extension's prefix. */
static void make_element(const e57_writer *w, const char *name, field *f) {
    char plain[BRIO_E57_NAME] = "brio:";
    size_t n = strlen(plain);
    if (!(*name == '_' || (*name >= 'A' && *name <= 'Z') || (*name >= 'a' && *name <= 'z'))) plain[n++] = '_';
    for (const char *c = name; *c && n + 1 < sizeof plain; c++) {
        bool fits = *c == '_' || (*c >= 'A' && *c <= 'Z') || (*c >= 'a' && *c <= 'z') || (*c >= '0' && *c <= '9');
        plain[n++] = fits ? *c : '_';
    }
    plain[n] = 0;
    strcpy(f->element, plain);
    for (size_t k = 2; is_taken(w, f->element); k++) brio_numbered_name(f->element, sizeof f->element, plain, k);
    f->renamed = strcmp(f->element + strlen("brio:"), name) != 0 || (!strcmp(name, "scan") && w->scans.count > 1);
}

/* Returns the bytes of a field's value. */
static size_t size_of(const field *f) {
    return f->valid ? 0 : brio_scalar_size(f->type);
}

static void add_field(e57_writer *w, field f) {
    w->fields[w->num_fields++] = f;
    w->record += size_of(&f);
}

static brio_status plan(brio_output *out, const brio_write_job *job, e57_writer *w) {
    static const char *const axes[AXES] = {"cartesianX", "cartesianY", "cartesianZ"};
    const brio_mesh *m = job->mesh;
    BRIO_FORWARD(BRIO_ALLOC_ZERO(out->ctx, w->fields, AXES + 1 + m->num_properties));
    for (size_t k = 0; k < AXES; k++) {
        field f = {.axis = true, .from = k, .type = job->options->float32 ? BRIO_SCALAR_FLOAT32 : BRIO_SCALAR_FLOAT64};
        strcpy(f.element, axes[k]);
        add_field(w, f);
    }
    add_field(w, (field){.element = "cartesianInvalidState", .valid = true});
    for (size_t i = 0; i < m->num_properties; i++) {
        field f = {.from = i, .type = m->properties[i].type};
        const char *element = known_element(m, &m->properties[i]);
        if (brio_scans_hold(&w->scans, m, i)) continue;
        if (element)
            strcpy(f.element, element);
        else
            make_element(w, m->properties[i].name, &f);
        add_field(w, f);
    }
    return BRIO_OK;
}

static bool renames(const void *state, size_t i) {
    const e57_writer *w = state;
    for (size_t f = 0; f < w->num_fields; f++)
        if (!w->fields[f].axis && !w->fields[f].valid && w->fields[f].from == i) return w->fields[f].renamed;
    return false;
}

/* --- points --- */

static brio_status begin_scan(brio_output *out, e57_writer *w) {
    const char header[SECTION_HEADER] = {0};
    written *s = &w->list[w->num_written++];
    BRIO_FORWARD(e57_pen_turn(&w->pen));
    *s = (written){.section = brio_output_offset(out), .sum = w->pen.sum, .least = INFINITY, .most = -INFINITY};
    for (int k = 0; k < AXES; k++) s->low[k] = INFINITY, s->high[k] = -INFINITY;
    return e57_put(&w->pen, header, sizeof header);
}

static brio_status end_scan(e57_writer *w) {
    const written *s = &w->list[w->num_written - 1];
    uint64_t begin = s->section / BRIO_E57_PAGE * BRIO_E57_CONTENT;
    char header[SECTION_HEADER] = {1}; /* a section of points; without an index */
    brio_put_le64(header + 8, e57_pen_offset(&w->pen) - begin);
    brio_put_le64(header + 16, s->section + SECTION_HEADER);
    return e57_pen_patch(&w->pen, header, sizeof header);
}

/* Encodes a coordinate of points: their differences from the scanner's place. */
static void encode_axis(e57_writer *w, const brio_mesh *m, const brio_scan_part *part, const field *f, char *bytes) {
    written *s = &w->list[w->num_written - 1];
    double place = part->scan->place[f->from];
    for (size_t v = part->first; v < part->end; v++, bytes += brio_scalar_size(f->type)) {
        double x = m->vertices[AXES * v + f->from], y = place == 0 ? x : x - place;
        if (f->type == BRIO_SCALAR_FLOAT32) {
            float single = (float)y;
            uint32_t bits;
            memcpy(&bits, &single, sizeof bits);
            brio_put_le32(bytes, bits);
            y = single;
        } else {
            brio_put_le_double(bytes, y);
        }
        s->low[f->from] = fmin(s->low[f->from], y);
        s->high[f->from] = fmax(s->high[f->from], y);
        double found = place == 0 ? y : y + place;
        if (found != x) w->scans.moved = fmax(w->scans.moved, fabs(found - x) * sqrt(3));
    }
}

/* Encodes a property. Integers are differences from the least number of their type. */
static void encode_property(const brio_property *p, const brio_scan_part *part, char *bytes) {
    size_t size = brio_scalar_size(p->type), count = part->end - part->first;
    bool has_sign = p->type == BRIO_SCALAR_INT8 || p->type == BRIO_SCALAR_INT16 || p->type == BRIO_SCALAR_INT32;
    brio_scalar_gather(bytes, (const char *)p->data + part->first * size, count, size, size, !brio_host_is_little());
    for (size_t i = 0; has_sign && i < count; i++) bytes[i * size + size - 1] ^= (char)0x80;
}

static void note_intensity(written *s, const brio_property *p, const brio_scan_part *part) {
    for (size_t v = part->first; v < part->end; v++) {
        double x = brio_property_value(p, v);
        s->least = fmin(s->least, x);
        s->most = fmax(s->most, x);
    }
}

/* Writes a packet of at most 65,536 bytes, which are a multiple of four. */
static brio_status write_packet(e57_writer *w, const brio_mesh *m, const brio_scan_part *part) {
    size_t at = DATA_HEADER + 2 * w->num_fields, count = part->end - part->first;
    memset(w->packet, 0, at);
    w->packet[0] = 1; /* data */
    brio_put_le16(w->packet + 4, (uint16_t)w->num_fields);
    for (size_t i = 0; i < w->num_fields; i++) {
        const field *f = &w->fields[i];
        size_t length = count * size_of(f);
        brio_put_le16(w->packet + DATA_HEADER + 2 * i, (uint16_t)length);
        if (!count) continue;
        if (f->axis)
            encode_axis(w, m, part, f, w->packet + at);
        else if (!f->valid)
            encode_property(&m->properties[f->from], part, w->packet + at);
        if (!strcmp(f->element, "intensity"))
            note_intensity(&w->list[w->num_written - 1], &m->properties[f->from], part);
        at += length;
    }
    for (; at % 4; at++) w->packet[at] = 0;
    brio_put_le16(w->packet + 2, (uint16_t)(at - 1));
    return e57_put(&w->pen, w->packet, at);
}

static brio_status write_part(brio_output *out, const brio_mesh *m, e57_writer *w, const brio_scan_part *part) {
    size_t most = (PACKET - 4 - DATA_HEADER - 2 * w->num_fields) / w->record;
    if (part->begins) BRIO_FORWARD(begin_scan(out, w));
    for (brio_scan_part chunk = *part; chunk.first < part->end; chunk.first = chunk.end) {
        chunk.end = part->end - chunk.first < most ? part->end : chunk.first + most;
        BRIO_FORWARD(write_packet(w, m, &chunk));
    }
    if (part->ends) BRIO_FORWARD(end_scan(w));
    return BRIO_OK;
}

static brio_status write_rows(brio_output *out, const brio_write_job *job, void *state) {
    e57_writer *w = state;
    brio_scan_part part = {.end = 0};
    w->pen.out = out;
    w->scans.moved = 0;
    while (brio_scans_next(&w->scans, job->mesh, &part)) BRIO_FORWARD(write_part(out, job->mesh, w, &part));
    w->scans.rounds |= w->scans.moved > 0;
    return BRIO_OK;
}

/* --- the XML section --- */

/* Writes <NAME type="TYPE">x</NAME>. */
static brio_status put_number(brio_e57_pen *p, const char *name, bool real, double x) {
    char digits[BRIO_NUMBER_LENGTH + 1];
    digits[real ? brio_print_double(digits, x) : brio_print_integer(digits, (int64_t)x)] = 0;
    return e57_put_text(p, "<%s type=\"%s\">%s</%s>\n", name, real ? "Float" : "Integer", digits, name);
}

/* Writes a character of n bytes, or what stands for it: XML has no control characters but white space, and not the last
 * two of the first plane. */
static brio_status put_character(brio_e57_pen *p, const char *c, size_t n) {
    const char *escaped = *c == '<' ? "&lt;" : *c == '>' ? "&gt;" : *c == '&' ? "&amp;" : NULL;
    bool control = (unsigned char)*c < ' ' && !strchr("\t\n\r", *c),
         last = n == 3 && !memcmp(c, "\xef\xbf", 2) && c[2] >= '\xbe';
    if (control || last) escaped = "?";
    return escaped ? e57_put(p, escaped, strlen(escaped)) : e57_put(p, c, n);
}

/* Writes a text of an element. Bytes that are not UTF-8 are taken for Latin-1. */
static brio_status put_escaped(brio_e57_pen *p, const char *text) {
    for (size_t n; *text; text += n) {
        n = brio_utf8_length(text);
        const char latin[2] = {(char)(0xc0 | (unsigned char)*text >> 6), (char)(0x80 | (*text & 0x3f))};
        BRIO_FORWARD(n ? put_character(p, text, n) : e57_put(p, latin, sizeof latin));
        n += !n;
    }
    return BRIO_OK;
}

/* Writes a name for the content: the same bytes have the same one. */
static brio_status put_guid(brio_e57_pen *p, uint64_t sum, uint64_t number) {
    uint64_t other = (sum ^ (number + 1)) * UINT64_C(0x9e3779b97f4a7c15);
    return e57_put_text(p, "<guid type=\"String\">{%08X-%04X-5%03X-8%03X-%012" PRIX64 "}</guid>\n",
                        (unsigned)(sum >> 32), (unsigned)(sum >> 16 & 0xffff), (unsigned)(sum & 0xfff),
                        (unsigned)(other >> 52), other & UINT64_C(0xffffffffffff));
}

static brio_status put_pose(brio_e57_pen *p, const brio_scan *scan) {
    if (scan->place[0] == 0 && scan->place[1] == 0 && scan->place[2] == 0) return BRIO_OK;
    BRIO_FORWARD(e57_put_text(p, "<pose type=\"Structure\">\n<rotation type=\"Structure\">\n"));
    for (int k = 0; k < 4; k++) BRIO_FORWARD(put_number(p, (const char *[]){"w", "x", "y", "z"}[k], true, k == 0));
    BRIO_FORWARD(e57_put_text(p, "</rotation>\n<translation type=\"Structure\">\n"));
    for (int k = 0; k < AXES; k++)
        BRIO_FORWARD(put_number(p, (const char *[]){"x", "y", "z"}[k], true, scan->place[k]));
    return e57_put_text(p, "</translation>\n</pose>\n");
}

static brio_status put_bounds(brio_e57_pen *p, const written *s) {
    static const char *const names[2][AXES] = {{"xMinimum", "yMinimum", "zMinimum"},
                                               {"xMaximum", "yMaximum", "zMaximum"}};
    if (!(s->low[0] <= s->high[0])) return BRIO_OK;
    BRIO_FORWARD(e57_put_text(p, "<cartesianBounds type=\"Structure\">\n"));
    for (int k = 0; k < AXES; k++) {
        BRIO_FORWARD(put_number(p, names[0][k], true, s->low[k]));
        BRIO_FORWARD(put_number(p, names[1][k], true, s->high[k]));
    }
    return e57_put_text(p, "</cartesianBounds>\n");
}

static const field *field_named(const e57_writer *w, const char *element) {
    for (size_t i = 0; i < w->num_fields; i++)
        if (!strcmp(w->fields[i].element, element)) return &w->fields[i];
    return NULL;
}

/* Writes what white is, and the range of the intensities. */
static brio_status put_limits(e57_writer *w, const written *s) {
    static const char *const colours[] = {"colorRed", "colorGreen", "colorBlue"};
    brio_e57_pen *p = &w->pen;
    const field *intensity = field_named(w, "intensity"), *red = field_named(w, "colorRed");
    char name[BRIO_E57_NAME];
    if (intensity && s->least <= s->most && isfinite(s->least) && isfinite(s->most)) {
        BRIO_FORWARD(e57_put_text(p, "<intensityLimits type=\"Structure\">\n"));
        BRIO_FORWARD(put_number(p, "intensityMinimum", is_real(intensity->type), s->least));
        BRIO_FORWARD(put_number(p, "intensityMaximum", is_real(intensity->type), s->most));
        BRIO_FORWARD(e57_put_text(p, "</intensityLimits>\n"));
    }
    if (!red) return BRIO_OK;
    BRIO_FORWARD(e57_put_text(p, "<colorLimits type=\"Structure\">\n"));
    for (int k = 0; k < 3; k++) {
        snprintf(name, sizeof name, "%sMinimum", colours[k]);
        BRIO_FORWARD(put_number(p, name, false, 0));
        snprintf(name, sizeof name, "%sMaximum", colours[k]);
        BRIO_FORWARD(put_number(p, name, false, red->type == BRIO_SCALAR_UINT8 ? UINT8_MAX : UINT16_MAX));
    }
    return e57_put_text(p, "</colorLimits>\n");
}

static brio_status put_field(brio_e57_pen *p, const field *f) {
    static const struct {
        double least, most;
    } ranges[BRIO_SCALAR_END] = {[BRIO_SCALAR_INT8] = {INT8_MIN, INT8_MAX},    [BRIO_SCALAR_UINT8] = {0, UINT8_MAX},
                                 [BRIO_SCALAR_INT16] = {INT16_MIN, INT16_MAX}, [BRIO_SCALAR_UINT16] = {0, UINT16_MAX},
                                 [BRIO_SCALAR_INT32] = {INT32_MIN, INT32_MAX}, [BRIO_SCALAR_UINT32] = {0, UINT32_MAX}};
    if (f->valid) return e57_put_text(p, "<%s type=\"Integer\" minimum=\"0\" maximum=\"0\"/>\n", f->element);
    if (is_real(f->type))
        return e57_put_text(p, "<%s type=\"Float\" precision=\"%s\"/>\n", f->element,
                            f->type == BRIO_SCALAR_FLOAT32 ? "single" : "double");
    return e57_put_text(p, "<%s type=\"Integer\" minimum=\"%" PRId64 "\" maximum=\"%" PRId64 "\"/>\n", f->element,
                        (int64_t)ranges[f->type].least, (int64_t)ranges[f->type].most);
}

static brio_status put_scan(e57_writer *w, size_t i) {
    brio_e57_pen *p = &w->pen;
    BRIO_FORWARD(e57_put_text(p, "<vectorChild type=\"Structure\">\n"));
    BRIO_FORWARD(put_guid(p, w->list[i].sum, i + 1));
    BRIO_FORWARD(put_pose(p, &w->scans.list[i]));
    BRIO_FORWARD(put_bounds(p, &w->list[i]));
    BRIO_FORWARD(put_limits(w, &w->list[i]));
    BRIO_FORWARD(e57_put_text(p,
                              "<points type=\"CompressedVector\" fileOffset=\"%" PRIu64 "\" recordCount=\"%" PRIu64
                              "\">\n<prototype type=\"Structure\">\n",
                              w->list[i].section, w->scans.list[i].points));
    for (size_t f = 0; f < w->num_fields; f++) BRIO_FORWARD(put_field(p, &w->fields[f]));
    return e57_put_text(p, "</prototype>\n<codecs type=\"Vector\" allowHeterogeneousChildren=\"1\"/>\n"
                           "</points>\n</vectorChild>\n");
}

static brio_status put_xml(e57_writer *w, const brio_write_job *job) {
    brio_e57_pen *p = &w->pen;
    BRIO_FORWARD(e57_put_text(p, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<e57Root type=\"Structure\" xmlns=\"%s\"",
                              E57_NAMES));
    BRIO_FORWARD(e57_put_text(p, " xmlns:nor=\"%s\" xmlns:brio=\"%s\">\n", NORMAL_NAMES, OWN_NAMES));
    BRIO_FORWARD(e57_put_text(p, "<formatName type=\"String\">ASTM E57 3D Imaging Data File</formatName>\n"));
    BRIO_FORWARD(put_guid(p, p->sum, 0));
    BRIO_FORWARD(e57_put_text(p, "<versionMajor type=\"Integer\">1</versionMajor>\n"
                                 "<versionMinor type=\"Integer\">0</versionMinor>\n"
                                 "<e57LibraryVersion type=\"String\">"));
    BRIO_FORWARD(put_escaped(p, job->options->comment ? job->options->comment : "brio"));
    BRIO_FORWARD(e57_put_text(p, "</e57LibraryVersion>\n"));
    if (w->crs) {
        BRIO_FORWARD(e57_put_text(p, "<coordinateMetadata type=\"String\">"));
        BRIO_FORWARD(put_escaped(p, w->crs));
        BRIO_FORWARD(e57_put_text(p, "</coordinateMetadata>\n"));
    }
    BRIO_FORWARD(e57_put_text(p, "<data3D type=\"Vector\" allowHeterogeneousChildren=\"1\">\n"));
    for (size_t i = 0; i < w->scans.count; i++) BRIO_FORWARD(put_scan(w, i));
    return e57_put_text(p, "</data3D>\n<images2D type=\"Vector\" allowHeterogeneousChildren=\"1\"/>\n</e57Root>\n");
}

/* --- the file --- */

static brio_status begin(brio_output *out, const brio_write_job *job, void *state) {
    e57_writer *w = state;
    const brio_metadata *crs = brio_mesh_metadata(job->mesh, "crs.wkt");
    BRIO_EXPECT(out->ctx, brio_output_can_patch(out), BRIO_ERR_ARGUMENT,
                "%s: the beginning of an E57 file is written last: that needs a file, no pipe", out->name);
    BRIO_FORWARD(brio_scans_settle(out->ctx, &w->scans));
    BRIO_FORWARD(BRIO_ALLOC_ZERO(out->ctx, w->list, w->scans.count));
    BRIO_FORWARD(BRIO_ALLOC(out->ctx, w->packet, PACKET));
    if (crs) {
        BRIO_FORWARD(BRIO_ALLOC(out->ctx, w->crs, crs->size + 1));
        memcpy(w->crs, crs->bytes, crs->size);
        w->crs[crs->size] = 0;
    }
    BRIO_FORWARD(plan(out, job, w));
    w->pen.out = out;
    return e57_pen_begin(&w->pen);
}

static brio_status end(brio_output *out, const brio_write_job *job, void *state) {
    e57_writer *w = state;
    char header[FILE_HEADER] = "ASTM-E57\1";
    w->pen.out = out;
    if (!w->scans.points) {
        BRIO_FORWARD(begin_scan(out, w));
        BRIO_FORWARD(write_packet(w, job->mesh, &(brio_scan_part){.scan = w->scans.list})); /* readers expect one */
        BRIO_FORWARD(end_scan(w));
    }
    assert(w->num_written == w->scans.count);
    uint64_t xml = e57_pen_offset(&w->pen);
    BRIO_FORWARD(put_xml(w, job));
    uint64_t length = e57_pen_offset(&w->pen) - xml, pages = (xml + length + BRIO_E57_CONTENT - 1) / BRIO_E57_CONTENT;
    brio_put_le64(header + 16, pages * BRIO_E57_PAGE);
    brio_put_le64(header + 24, brio_e57_physical(xml));
    brio_put_le64(header + 32, length);
    brio_put_le64(header + 40, BRIO_E57_PAGE);
    return e57_pen_end(&w->pen, header, sizeof header);
}

static void free_state(brio_context *ctx, void *state) {
    e57_writer *w = state;
    brio_scans_free(ctx, &w->scans);
    e57_pen_free(&w->pen, ctx);
    brio_release(ctx, w->fields);
    brio_release(ctx, w->list);
    brio_release(ctx, w->packet);
    brio_release(ctx, w->crs);
}

const brio_row_format brio_e57_rows = {.state = sizeof(e57_writer),
                                       BRIO_SCANS_ROWS,
                                       .begin = begin,
                                       .rows = write_rows,
                                       .end = end,
                                       .free = free_state,
                                       .renames = renames};
