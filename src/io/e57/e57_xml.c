/* Reads the XML section of an E57 file with expat, part by part.
 *
 * The parser's events move a place in the tree of the elements that matter; below any other element everything is
 * passed over. A document type is refused, and with it all entities, which could grow without bound.
 *
 * The memory that expat asks for is the context's. Expat's requests do not say whose they are, so the running thread
 * notes the context while expat runs.
 *
 * Based on: ASTM E2807-11, 8 (XML section). */
#include "base/memory.h"
#include "io/e57/e57.h"

#ifdef BRIO_HAS_EXPAT
#include "io/number.h"
#include <expat.h>
#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

/* --- the prototype: how numbers are stored --- */

/* Reads how the numbers of a field are stored: integers with the least bits that their bounds allow, scaled or not, and
 * floating-point numbers as they are.
 *
 * Based on: ASTM E2807-11, 8.3 (data types). */

enum { BRIO_E57_REASON = 160 };

static const char *find(const char *const *attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (!strcmp(attributes[0], name)) return attributes[1];
    return NULL;
}

/* Takes an attribute that is an integer. Some programs write 0.0 for 0. */
static bool take_integer(const char *const *attributes, const char *name, int64_t *value, char *reason) {
    const char *text = find(attributes, name), *at = text;
    uint64_t size;
    if (!text) return true;
    bool negative = *at == '-';
    at += *at == '-' || *at == '+';
    if (brio_parse_count(&at, &size) && !*at && size <= (uint64_t)INT64_MAX + negative) {
        *value = (int64_t)(negative ? 0 - size : size);
        return true;
    }
    double real;
    at = text;
    if (brio_parse_number(&at, &real) && !*at && real == floor(real) && real >= -0x1p63 && real < 0x1p63) {
        *value = (int64_t)real;
        return true;
    }
    snprintf(reason, BRIO_E57_REASON, "%s \"%.64s\", expected a whole number of 64 bits", name, text);
    return false;
}

static bool take_number(const char *const *attributes, const char *name, double *value, char *reason) {
    const char *text = find(attributes, name), *at = text;
    if (!text || (brio_parse_number(&at, value) && !*at && isfinite(*value))) return true;
    snprintf(reason, BRIO_E57_REASON, "%s \"%.64s\", expected a finite number", name, text);
    return false;
}

static bool read_integer(brio_e57_code *code, const char *const *attributes, char *reason) {
    int64_t most = INT64_MAX;
    code->kind = BRIO_E57_INTEGER;
    code->least = INT64_MIN;
    if (!take_integer(attributes, "minimum", &code->least, reason)) return false;
    if (!take_integer(attributes, "maximum", &most, reason)) return false;
    if (code->least > most) {
        snprintf(reason, BRIO_E57_REASON, "its minimum is above its maximum");
        return false;
    }
    uint64_t range = (uint64_t)most - (uint64_t)code->least;
    while (code->bits < 64 && range >> code->bits) code->bits++;
    return true;
}

static bool read_scaled(brio_e57_code *code, const char *const *attributes, char *reason) {
    if (!read_integer(code, attributes, reason)) return false;
    code->kind = BRIO_E57_SCALED;
    code->scale = 1;
    return take_number(attributes, "scale", &code->scale, reason) &&
           take_number(attributes, "offset", &code->offset, reason);
}

static bool read_float(brio_e57_code *code, const char *const *attributes, char *reason) {
    const char *precision = find(attributes, "precision");
    bool single = precision && !strcmp(precision, "single");
    if (precision && !single && strcmp(precision, "double") != 0) {
        snprintf(reason, BRIO_E57_REASON, "precision \"%.64s\", expected single or double", precision);
        return false;
    }
    code->kind = single ? BRIO_E57_SINGLE : BRIO_E57_DOUBLE;
    code->bits = single ? 32 : 64;
    return true;
}

/* Reads what the attributes of a field say. Returns false, with the reason, if they are wrong.
 *  attributes  names and values by turns, ended by NULL. */
static bool e57_field_read(brio_e57_field *field, const char *const *attributes, char reason[BRIO_E57_REASON]) {
    const char *type = find(attributes, "type");
    if (!type) type = "(none)";
    if (!strcmp(type, "Integer")) return read_integer(&field->code, attributes, reason);
    if (!strcmp(type, "ScaledInteger")) return read_scaled(&field->code, attributes, reason);
    if (!strcmp(type, "Float")) return read_float(&field->code, attributes, reason);
    field->text = !strcmp(type, "String");
    if (field->text) return true;
    snprintf(reason, BRIO_E57_REASON, "the type %.64s, expected Integer, ScaledInteger, Float or String", type);
    return false;
}

/* --- the parser --- */

/* PART: bytes given to expat at a time. LONGEST: bytes of a section. TAG: bytes of a tag or a comment, which expat goes
 * through again with each part. NESTED: elements that are open below those that matter; expat keeps all. TEXT: bytes of
 * a number. All chosen. */
enum { PART = 1 << 15, LONGEST = 1 << 26, TAG = 1 << 20, NESTED = 1000, TEXT = 128 };

#define E57_NAMES "http://www.astm.org/COMMIT/E57/2010-e57-v1.0"

/* Where the parser is. Place i is an element, and `inside` the place that it stands in. */
typedef enum {
    OUTSIDE,
    ROOT,
    DATA3D,
    SCAN,
    POSE,
    ROTATION,
    TRANSLATION,
    NUMBER, /* an element whose text is a number of the pose */
    SYSTEM, /* the text of the coordinate system */
    POINTS,
    PROTOTYPE,
    FIELD,
    CODECS,
    CODEC,
    CODEC_PART
} place;

static const struct {
    place inside;
    const char *name; /* NULL: any */
    place is;
} tree[] = {{OUTSIDE, "e57Root", ROOT},
            {ROOT, "data3D", DATA3D},
            {DATA3D, NULL, SCAN},
            {SCAN, "pose", POSE},
            {POSE, "rotation", ROTATION},
            {POSE, "translation", TRANSLATION},
            {ROTATION, "w", NUMBER},
            {ROTATION, "x", NUMBER},
            {ROTATION, "y", NUMBER},
            {ROTATION, "z", NUMBER},
            {TRANSLATION, "x", NUMBER},
            {TRANSLATION, "y", NUMBER},
            {TRANSLATION, "z", NUMBER},
            {SCAN, "points", POINTS},
            {POINTS, "prototype", PROTOTYPE},
            {PROTOTYPE, NULL, FIELD},
            {POINTS, "codecs", CODECS},
            {CODECS, NULL, CODEC},
            {CODEC, NULL, CODEC_PART},
            {ROOT, "coordinateMetadata", SYSTEM}};
enum { DEEPEST = 8 };

/* Elements that the mesh has no place for, and what they are called. Those that follow from the points are not among
 * them, nor are marks such as guid. */
static const struct {
    place inside;
    const char *name, *what;
} passed_over[] = {{ROOT, "images2D", "images"},
                   {ROOT, "creationDateTime", "date of the file"},
                   {SCAN, "name", "names of scans"},
                   {SCAN, "description", "descriptions of scans"},
                   {SCAN, "sensorVendor", "sensors"},
                   {SCAN, "sensorModel", "sensors"},
                   {SCAN, "sensorSerialNumber", "sensors"},
                   {SCAN, "sensorHardwareVersion", "sensors"},
                   {SCAN, "sensorSoftwareVersion", "sensors"},
                   {SCAN, "sensorFirmwareVersion", "sensors"},
                   {SCAN, "temperature", "weather"},
                   {SCAN, "relativeHumidity", "weather"},
                   {SCAN, "atmosphericPressure", "weather"},
                   {SCAN, "acquisitionStart", "times"},
                   {SCAN, "acquisitionEnd", "times"},
                   {SCAN, "pointGroupingSchemes", "groups of points"}};

typedef struct {
    brio_context *ctx;
    brio_builder *builder;
    const char *name; /* of the file */
    XML_Parser parser;
    brio_e57_scans *scans;
    brio_status status;
    place path[DEEPEST];
    int depth;      /* of the place; path[depth] is the place */
    size_t skipped; /* elements that are open below the place */
    double *number; /* receives the text of NUMBER */
    char text[TEXT];
    size_t length;
    const char *pending; /* what the element that is passed over is called, once it has any content */
    char *system;
    size_t system_length, system_capacity;
} xml_reader;

/* --- failures --- */

static void fail(xml_reader *r, brio_status status) {
    if (r->status == BRIO_OK) r->status = status;
    XML_StopParser(r->parser, XML_FALSE);
}

/* Adds file and line to a sentence. */
#define REFUSE(r, format, ...)                                                                                         \
    fail(r, brio_fail((r)->ctx, BRIO_ERR_FORMAT, "%s: XML section, line %lu: " format, (r)->name,                      \
                      (unsigned long)XML_GetCurrentLineNumber((r)->parser), __VA_ARGS__))

/* --- the tree --- */

static place find_place(place inside, const char *name) {
    for (size_t i = 0; i < sizeof tree / sizeof *tree; i++)
        if (tree[i].inside == inside && (!tree[i].name || !strcmp(tree[i].name, name))) return tree[i].is;
    return OUTSIDE;
}

static const char *attribute(const XML_Char **attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (!strcmp(attributes[0], name)) return attributes[1];
    return NULL;
}

/* Turns expat's "namespace|name|prefix" into the name, with its prefix if it is of an extension. */
static void take_name(const XML_Char *full, char name[BRIO_E57_NAME]) {
    const char *bar = strchr(full, '|'), *local = bar ? bar + 1 : full, *second = strchr(local, '|');
    bool own = !bar || ((size_t)(bar - full) == strlen(E57_NAMES) && !strncmp(full, E57_NAMES, (size_t)(bar - full)));
    size_t length = second ? (size_t)(second - local) : strlen(local), at = 0;
    if (!own && second)
        for (const char *c = second + 1; *c && at < 16; c++) name[at++] = *c;
    if (!own && second) name[at++] = ':';
    if (length > BRIO_E57_NAME - 1 - at) length = BRIO_E57_NAME - 1 - at;
    memcpy(name + at, local, length);
    name[at + length] = 0;
}

static void begin_scan(xml_reader *r) {
    brio_e57_scans *s = r->scans;
    if (s->num_scans == BRIO_E57_MOST_SCANS) {
        REFUSE(r, "more than %d scans", BRIO_E57_MOST_SCANS);
        return;
    }
    brio_status status = BRIO_RESERVE(r->ctx, s->scans, s->scan_capacity, s->num_scans + 1);
    if (status != BRIO_OK) {
        fail(r, status);
        return;
    }
    s->scans[s->num_scans++] = (brio_e57_scan){.first_field = s->num_fields, .rotation = {1, 0, 0, 0}};
}

/* Reads a whole number; a number that is missing is wrong, too. */
static bool take_count(xml_reader *r, const XML_Char **attributes, const char *name, uint64_t *value) {
    const char *text = attribute(attributes, name), *at = text;
    if (text && brio_parse_count(&at, value) && !*at) return true;
    REFUSE(r, "points with the %s \"%.64s\", expected a whole number", name, text ? text : "");
    return false;
}

static void begin_points(xml_reader *r, const XML_Char **attributes) {
    brio_e57_scan *scan = &r->scans->scans[r->scans->num_scans - 1];
    const char *type = attribute(attributes, "type");
    if (!type || strcmp(type, "CompressedVector") != 0)
        REFUSE(r, "points of the type %.64s, expected CompressedVector", type ? type : "(none)");
    else if (take_count(r, attributes, "fileOffset", &scan->section))
        take_count(r, attributes, "recordCount", &scan->records);
}

static void begin_field(xml_reader *r, const char *name, const XML_Char **attributes) {
    brio_e57_scans *s = r->scans;
    brio_e57_scan *scan = &s->scans[s->num_scans - 1];
    brio_e57_field field = {.text = false};
    char reason[BRIO_E57_REASON];
    memcpy(field.name, name, BRIO_E57_NAME);
    if (scan->num_fields == BRIO_E57_MOST_FIELDS) {
        REFUSE(r, "more than %d fields", BRIO_E57_MOST_FIELDS);
    } else if (!e57_field_read(&field, (const char *const *)attributes, reason)) {
        REFUSE(r, "field %s: %s", name, reason);
    } else {
        brio_status status = BRIO_RESERVE(r->ctx, s->fields, s->field_capacity, s->num_fields + 1);
        if (status != BRIO_OK) {
            fail(r, status);
            return;
        }
        s->fields[s->num_fields++] = field;
        scan->num_fields++;
    }
}

static void begin_number(xml_reader *r, place inside, char axis) {
    brio_e57_scan *scan = &r->scans->scans[r->scans->num_scans - 1];
    r->length = 0;
    if (inside == ROTATION)
        r->number = &scan->rotation[axis == 'w' ? 0 : axis - 'x' + 1];
    else
        r->number = &scan->translation[axis - 'x'];
}

static void begin_codec_part(xml_reader *r, const char *name) {
    if (strcmp(name, "inputs") != 0 && strcmp(name, "bitPackCodec") != 0)
        REFUSE(r, "the codec %s is not known, expected bitPackCodec", name);
}

/* --- what is passed over --- */

static const char *name_of_passed(place inside, const char *name) {
    for (size_t i = 0; i < sizeof passed_over / sizeof *passed_over; i++)
        if (passed_over[i].inside == inside && !strcmp(passed_over[i].name, name)) return passed_over[i].what;
    return inside == ROOT || inside == SCAN ? strchr(name, ':') ? "elements of extensions" : NULL : NULL;
}

/* Notes the element that is passed over: it has an element or a text. */
static void note_content(xml_reader *r) {
    brio_status status = r->pending ? brio_builder_leave_out(r->builder, r->pending) : BRIO_OK;
    r->pending = NULL;
    if (status != BRIO_OK) fail(r, status);
}

static void take_system(xml_reader *r, const XML_Char *text, size_t length) {
    brio_status status = BRIO_RESERVE(r->ctx, r->system, r->system_capacity, r->system_length + length);
    if (status != BRIO_OK) {
        fail(r, status);
        return;
    }
    memcpy(r->system + r->system_length, text, length);
    r->system_length += length;
}

static void end_system(xml_reader *r) {
    brio_status status = BRIO_OK;
    while (r->system_length && strchr(" \t\r\n", r->system[r->system_length - 1])) r->system_length--;
    if (r->system_length) status = brio_mesh_set_metadata(r->builder->mesh, "crs.wkt", r->system, r->system_length);
    if (status != BRIO_OK) fail(r, status);
}

/* --- expat's events --- */

static void XMLCALL on_start(void *user, const XML_Char *full, const XML_Char **attributes) {
    xml_reader *r = user;
    char name[BRIO_E57_NAME];
    if (r->status != BRIO_OK) return;
    take_name(full, name);
    place inside = r->path[r->depth], is = r->skipped ? OUTSIDE : find_place(inside, name);
    if (inside == OUTSIDE && is != ROOT) {
        REFUSE(r, "the element %s, expected e57Root", name);
        return;
    }
    note_content(r);
    if (is == OUTSIDE) {
        if (!r->skipped) r->pending = name_of_passed(inside, name);
        if (++r->skipped > NESTED) REFUSE(r, "elements nested more than %d deep", NESTED);
        return;
    }
    r->path[++r->depth] = is;
    if (is == SCAN) begin_scan(r);
    if (is == POINTS) begin_points(r, attributes);
    if (is == FIELD) begin_field(r, name, attributes);
    if (is == CODEC_PART) begin_codec_part(r, name);
    if (is == NUMBER) begin_number(r, inside, name[0]);
}

/* Ends a number. An empty element is the number 0. */
static void end_number(xml_reader *r) {
    const char *text = r->text;
    r->text[r->length] = 0;
    while (*text == ' ' || *text == '\t' || *text == '\r' || *text == '\n') text++;
    *r->number = 0;
    if (!*text) return;
    bool read = r->length < TEXT - 1 && brio_parse_number(&text, r->number) && isfinite(*r->number);
    while (read && (*text == ' ' || *text == '\t' || *text == '\r' || *text == '\n')) text++;
    if (!read || *text) REFUSE(r, "the pose has \"%.64s\", expected a finite number", r->text);
}

static void XMLCALL on_end(void *user, const XML_Char *name) {
    xml_reader *r = user;
    (void)name;
    if (r->status != BRIO_OK) return;
    if (r->skipped) {
        r->skipped--;
        r->pending = NULL;
        return;
    }
    if (r->path[r->depth] == NUMBER) end_number(r);
    if (r->path[r->depth] == SYSTEM) end_system(r);
    r->depth--;
}

static void XMLCALL on_text(void *user, const XML_Char *text, int length) {
    xml_reader *r = user;
    for (int i = 0; i < length && r->pending && r->status == BRIO_OK; i++)
        if (!strchr(" \t\r\n", text[i])) note_content(r);
    if (!r->skipped && r->path[r->depth] == SYSTEM && r->status == BRIO_OK) take_system(r, text, (size_t)length);
    if (r->skipped || r->path[r->depth] != NUMBER) return;
    for (int i = 0; i < length && r->length < TEXT - 1; i++) r->text[r->length++] = text[i];
}

static void XMLCALL on_doctype(void *user, const XML_Char *name, const XML_Char *system, const XML_Char *public,
                               int own) {
    xml_reader *r = user;
    (void)system, (void)public, (void)own;
    REFUSE(r, "a document type (%.64s), which E57 files do not have: entities are not read", name);
}

/* --- memory --- */

static _Thread_local brio_context *running; /* the context of the section that this thread reads */

static void *take_memory(size_t size) {
    brio_status status = BRIO_OK;
    return brio_resize(running, NULL, size, 1, &status);
}

static void *resize_memory(void *block, size_t size) {
    brio_status status = BRIO_OK;
    return brio_resize(running, block, size, 1, &status);
}

static void release_memory(void *block) {
    brio_release(running, block);
}

/* --- the section --- */

static brio_status start(xml_reader *r) {
    static const XML_Memory_Handling_Suite memory = {take_memory, resize_memory, release_memory};
    r->parser = XML_ParserCreate_MM(NULL, &memory, "|");
    if (!r->parser) return brio_fail(r->ctx, BRIO_ERR_NO_MEMORY, "%s: out of memory for the XML section", r->name);
    XML_SetReturnNSTriplet(r->parser, 1);
    XML_SetUserData(r->parser, r);
    XML_SetElementHandler(r->parser, on_start, on_end);
    XML_SetCharacterDataHandler(r->parser, on_text);
    XML_SetStartDoctypeDeclHandler(r->parser, on_doctype);
    return BRIO_OK;
}

/* Returns the status of a parse that stopped. */
static brio_status stopped(const xml_reader *r) {
    enum XML_Error error = XML_GetErrorCode(r->parser);
    if (r->status != BRIO_OK) return r->status;
    if (error == XML_ERROR_NO_MEMORY)
        return brio_fail(r->ctx, BRIO_ERR_NO_MEMORY, "%s: out of memory for the XML section", r->name);
    return brio_fail(r->ctx, BRIO_ERR_FORMAT, "%s: XML section, line %lu, column %lu: %s", r->name,
                     (unsigned long)XML_GetCurrentLineNumber(r->parser),
                     (unsigned long)XML_GetCurrentColumnNumber(r->parser), XML_ErrorString(error));
}

/* Measures the section without zero bytes at its end, which are no XML, and which some programs write. */
static brio_status measure(brio_e57_pages *p, uint64_t *length) {
    *length = p->xml_length;
    while (*length) {
        const char *bytes = NULL;
        size_t size = *length < PART ? (size_t)*length : PART;
        BRIO_FORWARD(brio_e57_take(p, p->xml + *length - size, size, &bytes));
        size_t used = size;
        while (used && !bytes[used - 1]) used--;
        *length -= size - used;
        if (used) break;
    }
    BRIO_EXPECT(p->stream->ctx, *length, BRIO_ERR_FORMAT, "%s: the XML section is empty", p->stream->name);
    return BRIO_OK;
}

static brio_status parse(xml_reader *r, brio_e57_pages *p) {
    uint64_t length = 0;
    BRIO_FORWARD(measure(p, &length));
    for (uint64_t at = 0; at < length;) {
        const char *bytes = NULL;
        size_t size = length - at < PART ? (size_t)(length - at) : PART;
        BRIO_FORWARD(brio_e57_take(p, p->xml + at, size, &bytes));
        at += size;
        if (XML_Parse(r->parser, bytes, (int)size, at == length) != XML_STATUS_OK) return stopped(r);
        XML_Index done = XML_GetCurrentByteIndex(r->parser);
        BRIO_EXPECT(r->ctx, done < 0 || at - (uint64_t)done <= TAG, BRIO_ERR_FORMAT,
                    "%s: XML section, line %lu: a tag or comment of more than %d bytes", r->name,
                    (unsigned long)XML_GetCurrentLineNumber(r->parser), TAG);
    }
    return BRIO_OK;
}

brio_status brio_e57_xml_read(brio_e57_pages *p, brio_builder *b, brio_e57_scans *out) {
    brio_status status = BRIO_OK;
    brio_context *ctx = p->stream->ctx, *before = running;
    xml_reader r = {.ctx = ctx, .builder = b, .name = p->stream->name, .scans = out};
    *out = (brio_e57_scans){.scans = NULL};
    running = ctx;
    BRIO_REQUIRE(ctx, p->xml_length && p->xml_length <= LONGEST, BRIO_ERR_FORMAT,
                 "%s: byte 32: an XML section of %" PRIu64 " bytes, expected 1 to %d", p->stream->name, p->xml_length,
                 LONGEST);
    BRIO_TRY(start(&r));
    BRIO_TRY(parse(&r, p));
done:
    if (r.parser) XML_ParserFree(r.parser);
    brio_release(ctx, r.system);
    running = before;
    return status;
}

#else

brio_status brio_e57_xml_read(brio_e57_pages *p, brio_builder *b, brio_e57_scans *out) {
    (void)b;
    *out = (brio_e57_scans){.scans = NULL};
    return brio_fail(p->stream->ctx, BRIO_ERR_FORMAT,
                     "%s: this build of brio cannot read E57 files: it was built without the library expat",
                     p->stream->name);
}

#endif

void brio_e57_scans_free(brio_context *ctx, brio_e57_scans *scans) {
    brio_release(ctx, scans->scans);
    brio_release(ctx, scans->fields);
    *scans = (brio_e57_scans){.scans = NULL};
}
