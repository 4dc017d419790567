/* What `brio help formats` prints: the formats of files, for people and for programs. The library's table has them. */
#include "cli/help/help.h"
#include <string.h>

enum { COLUMN = 28 };

static const struct {
    unsigned bit;
    const char *key, *words; /* in JSON, and in a sentence */
} held[] = {{BRIO_HOLDS_FACES, "faces", "polygons"},
            {BRIO_HOLDS_FACE_PROPERTIES, "face_properties", "properties of polygons"},
            {BRIO_HOLDS_FACE_COLOURS, "face_colours", "colours of polygons"},
            {BRIO_HOLDS_TETRAHEDRA, "tetrahedra", "tetrahedra"},
            {BRIO_HOLDS_EDGES, "edges", "edges"},
            {BRIO_HOLDS_PROPERTIES, "properties", "properties"},
            {BRIO_HOLDS_NAMES, "names", "their names"},
            {BRIO_HOLDS_COLOURS, "colours", "colours"},
            {BRIO_HOLDS_NORMALS, "normals", "normals"},
            {BRIO_HOLDS_DOUBLES, "doubles", "double precision"},
            {BRIO_HOLDS_SINGLES, "singles", "single precision"},
            {BRIO_HOLDS_ORIGIN, "origin", "an origin"},
            {BRIO_HOLDS_TEXT, "text", "as text"},
            {BRIO_HOLDS_BINARY, "binary", "binary"},
            {BRIO_HOLDS_COMPRESSED, "compressed", "compressed"},
            {BRIO_HOLDS_PLACES, "places", "no pipes"},
            {BRIO_HOLDS_PARTS, "parts", "all tiles in one file"},
            {BRIO_HOLDS_RARE_DOUBLES, "rare_doubles", "--float32 for most readers"}};

enum { NUM_HELD = sizeof held / sizeof *held };

/* Returns word i of what a written format holds, for programs or for a sentence; NULL after the last. Single properties
 * that it holds come after the normals, by their names.   name  room for one. */
static const char *word_of(const brio_format_info *info, size_t i, bool json, char name[32]) {
    for (size_t k = 0; k < NUM_HELD && info->written[0]; k++) {
        if (info->holds & held[k].bit && i-- == 0) return json ? held[k].key : held[k].words;
        const char *at = held[k].bit == BRIO_HOLDS_NORMALS && info->properties ? info->properties : "";
        for (; *at; at += *at == ' ') {
            size_t length = strcspn(at, " ");
            snprintf(name, 32, "%.*s", (int)length, at);
            if (i-- == 0) return name;
            at += length;
        }
    }
    return NULL;
}

/* Adds a list of extensions, "ply vtu", as .ply and .vtu. */
static void list_extensions(facts *f, const char *name, const char *extensions) {
    cli_fact_open(f, name, FACT_LIST);
    for (const char *at = extensions; *at; at += *at == ' ') {
        char extension[32];
        size_t length = strcspn(at, " ");
        snprintf(extension, sizeof extension, ".%.*s", (int)length, at);
        cli_fact_text(f, NULL, extension);
        at += length;
    }
    cli_fact_close(f);
}

static void print_formats_for_programs(FILE *out) {
    facts f = {0};
    cli_fact_open(&f, "formats", FACT_LIST);
    for (int i = 1; i <= BRIO_FORMAT_MOST; i++) {
        const brio_format_info *info = brio_format_facts((brio_format)i);
        char name[32];
        const char *word;
        if (!info) continue;
        snprintf(name, sizeof name, "%.*s", (int)strcspn(info->extensions, " "), info->extensions);
        cli_fact_open(&f, NULL, FACT_OBJECT);
        cli_fact_text(&f, "format", name);
        cli_fact_text(&f, "name", info->name);
        cli_fact_integer(&f, "number", i);
        list_extensions(&f, "read", info->extensions);
        list_extensions(&f, "written", info->written);
        cli_fact_open(&f, "holds", FACT_LIST);
        for (size_t k = 0; (word = word_of(info, k, true, name)); k++) cli_fact_text(&f, NULL, word);
        cli_fact_close(&f);
        cli_fact_close(&f);
    }
    cli_fact_close(&f);
    cli_json_write(out, &f, "");
    cli_facts_free(&f);
}

static void print_format(FILE *out, const brio_format_info *info) {
    char left[128] = "", meaning[512], name[32];
    const char *word;
    size_t used = 0, length = 0;
    for (const char *e = info->extensions; *e && used + 3 < sizeof left; e++) {
        if (e == info->extensions || e[-1] == ' ') left[used++] = '.';
        left[used++] = *e;
    }
    length = (size_t)snprintf(meaning, sizeof meaning, "%s", info->name);
    const char *separator = ": ";
    for (size_t k = 0; (word = word_of(info, k, false, name)); k++) {
        length += (size_t)snprintf(meaning + length, sizeof meaning - length, "%s%s", separator, word);
        separator = ", ";
    }
    if (!info->written[0]) snprintf(meaning + length, sizeof meaning - length, ", read only");
    cli_print_entry(out, left, meaning, 2, COLUMN);
}

void cli_print_formats(FILE *out, bool json) {
    if (json) {
        print_formats_for_programs(out);
        return;
    }
    fputs("The formats of files, and what those that brio writes hold beside points:\n\n", out);
    for (int i = 1; i <= BRIO_FORMAT_MOST; i++)
        if (brio_format_facts((brio_format)i)) print_format(out, brio_format_facts((brio_format)i));
    fputc('\n', out);
    cli_print_wrapped(out,
                      "Each can be compressed by gzip or zstd where it is read. What a format keeps and loses is in "
                      "formats.md, among the documents "
                      "that come with brio (docs/). --json prints this list for programs.",
                      0, 0, cli_columns(out));
}
