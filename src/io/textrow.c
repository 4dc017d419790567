/* Rows of numbers in a text. */
#include "io/textrow.h"
#include "io/number.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

brio_excerpt brio_excerpt_of(const char *word) {
    brio_excerpt e;
    size_t n = 0;
    for (; n + 4 < sizeof e.text && word[n] && !brio_is_blank(word[n]); n++)
        e.text[n] = word[n] > ' ' && word[n] <= '~' ? word[n] : '?';
    bool cut = word[n] && !brio_is_blank(word[n]);
    strcpy(e.text + n, cut ? "..." : "");
    return e;
}

brio_status brio_text_next_line(brio_text *t) {
    do {
        BRIO_FORWARD(brio_stream_line(t->stream, &t->at));
        if (!t->at) return BRIO_OK;
        char *comment = t->comment ? strchr(t->at, t->comment) : NULL;
        if (comment) *comment = 0;
        t->at = brio_skip_blanks(t->at);
    } while (!*t->at);
    return BRIO_OK;
}

bool brio_text_more(brio_text *t) {
    if (!t->at) return false;
    t->at = brio_skip_blanks(t->at);
    return *t->at != 0;
}

brio_status brio_text_expected(const brio_text *t, const char *what) {
    return brio_fail(t->stream->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected %s, found \"%s\"", t->stream->name,
                     t->stream->line, what, t->at ? brio_excerpt_of(t->at).text : "");
}

brio_status brio_text_number(brio_text *t, double *value) {
    if (!brio_text_more(t)) {
        BRIO_FORWARD(brio_text_next_line(t));
        if (!t->at) return brio_stream_truncated(t->stream);
    }
    const char *p = t->at;
    if (!brio_parse_number(&p, value) || (*p && !brio_is_blank(*p))) return brio_text_expected(t, "a number");
    t->at += p - t->at;
    return BRIO_OK;
}

brio_status brio_text_count(brio_text *t, const char *what, uint64_t most, uint64_t *value) {
    double number = 0;
    BRIO_FORWARD(brio_text_number(t, &number));
    BRIO_EXPECT(t->stream->ctx, number >= 0 && number < 0x1p63 && number == floor(number) && (uint64_t)number <= most,
                BRIO_ERR_FORMAT, "%s: line %zu: %s is %g, expected a whole number from 0 to %" PRIu64, t->stream->name,
                t->stream->line, what, number, most);
    *value = (uint64_t)number;
    return BRIO_OK;
}

brio_status brio_text_row_end(brio_text *t) {
    if (!brio_text_more(t)) return BRIO_OK;
    brio_stream *s = t->stream;
    return brio_fail(s->ctx, BRIO_ERR_FORMAT, "%s: line %zu: expected the end of %s %" PRIu64 ", found \"%s\"", s->name,
                     s->line, s->element ? s->element : "row", s->row, brio_excerpt_of(t->at).text);
}

brio_status brio_text_end(brio_text *t) {
    brio_status status = BRIO_OK;
    brio_stream *s = t->stream;
    if (!brio_text_more(t)) BRIO_TRY(brio_text_next_line(t));
    if (!t->at) return BRIO_OK;
    status =
        brio_fail(s->ctx, BRIO_ERR_FORMAT,
                  "%s: line %zu: a row behind %s %" PRIu64 " of %" PRIu64 ", where the file should end: \"%s\"",
                  s->name, s->line, s->element ? s->element : "row", s->rows, s->rows, brio_excerpt_of(t->at).text);
done:
    return status;
}
