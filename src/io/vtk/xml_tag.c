/* Tags of an XML file. No parser of XML can read a file of VTK, because the bytes behind its tags are no XML.
 *
 * Based on: Bray, Paoli, Sperberg-McQueen, Maler, Yergeau. Extensible markup language (XML) 1.0. W3C 2008. */
#include "io/vtk/xml_tag.h"
#include "io/number.h"
#include "io/textrow.h"
#include <inttypes.h>
#include <string.h>

/* Most bytes of a tag. Chosen. */
enum { MAX_TAG = 1 << 20 };

brio_status brio_xml_bad(brio_stream *s, const char *expected) {
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected %s", s->name, brio_stream_offset(s),
                     expected);
}

brio_status brio_xml_skip_to(brio_stream *s, char mark, const char *expected) {
    brio_status status = BRIO_OK;
    for (;;) {
        BRIO_TRY(brio_stream_fill(s, 1));
        size_t left = brio_stream_left(s);
        if (!left) return brio_xml_bad(s, expected);
        const char *start = s->buffer + s->begin, *found = memchr(start, mark, left);
        s->begin += found ? (size_t)(found - start) : left;
        if (found) return BRIO_OK;
    }
done:
    return status;
}

/* Finds the length of the tag that begins here, up to its '>', which does not count between quotes. The tag of a
 * comment ends with "-->". */
static brio_status tag_length(brio_stream *s, size_t *length) {
    brio_status status = BRIO_OK;
    char quote = 0;
    for (size_t n = 1;; n++) {
        if (brio_stream_left(s) <= n) BRIO_TRY(brio_stream_fill(s, n + 1));
        if (brio_stream_left(s) <= n || n > MAX_TAG) return brio_xml_bad(s, "a tag with its end");
        const char *tag = s->buffer + s->begin;
        bool comment = n >= 3 && !memcmp(tag, "<!--", 4);
        if (!comment && quote && tag[n] == quote)
            quote = 0;
        else if (!comment && !quote && (tag[n] == '"' || tag[n] == '\''))
            quote = tag[n];
        if (tag[n] != '>' || (quote && !comment)) continue;
        if (comment && (n < 6 || tag[n - 1] != '-' || tag[n - 2] != '-')) continue;
        *length = n;
        return BRIO_OK;
    }
done:
    return status;
}

brio_status brio_xml_next_tag(brio_stream *s, const char *expected, const char **tag) {
    brio_status status = BRIO_OK;
    size_t length = 0;
    BRIO_TRY(brio_xml_skip_to(s, '<', expected));
    BRIO_TRY(tag_length(s, &length));
    char *start = s->buffer + s->begin;
    start[length] = 0;
    *tag = start + 1;
    s->begin += length + 1;
done:
    return status;
}

bool brio_xml_is(const char *tag, const char *name) {
    size_t length = strlen(name);
    return !strncmp(tag, name, length) && (!tag[length] || brio_is_blank(tag[length]) || tag[length] == '/');
}

bool brio_xml_is_empty(const char *tag) {
    size_t length = strlen(tag);
    return length && tag[length - 1] == '/';
}

/* Copies one character of a value, which may be written as an entity, and returns the place behind it. */
static const char *unescape(const char *p, char *out) {
    static const char *const escapes[] = {"&amp;", "&lt;", "&gt;", "&quot;", "&apos;"};
    for (int i = 0; i < 5; i++) {
        size_t length = strlen(escapes[i]);
        if (strncmp(p, escapes[i], length) != 0) continue;
        *out = "&<>\"'"[i];
        return p + length;
    }
    *out = *p;
    return p + 1;
}

bool brio_xml_attribute(const char *tag, const char *name, char value[BRIO_XML_VALUE]) {
    size_t length = strlen(name), n = 0;
    const char *p = tag + strcspn(tag, " \t\r\n");
    for (;;) {
        while (brio_is_blank(*p)) p++;
        const char *found = p;
        p += strcspn(p, "= \t\r\n");
        size_t found_length = (size_t)(p - found);
        if (p[0] != '=' || (p[1] != '"' && p[1] != '\'')) return false;
        const char *end = strchr(p + 2, p[1]);
        if (!end) return false;
        if (found_length == length && !memcmp(found, name, length)) {
            for (p += 2; p < end && n < BRIO_XML_VALUE - 1; n++) p = unescape(p, &value[n]);
            value[n] = 0;
            return true;
        }
        p = end + 1;
    }
}

bool brio_xml_attribute_is(const char *tag, const char *name, const char *expected) {
    char value[BRIO_XML_VALUE];
    return brio_xml_attribute(tag, name, value) && !strcmp(value, expected);
}

brio_status brio_xml_count(brio_stream *s, const char *tag, const char *name, uint64_t *count) {
    char value[BRIO_XML_VALUE] = "";
    const char *p = value;
    if (brio_xml_attribute(tag, name, value) && brio_parse_count(&p, count) && !*p && *count <= UINT64_MAX >> 1)
        return BRIO_OK;
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: byte %" PRIu64 ": expected a number %s, found \"%s\"", s->name,
                     brio_stream_offset(s), name, brio_excerpt_of(value).text);
}
