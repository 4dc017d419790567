/* Rows of numbers in a text: the next line that holds something, its words, and the errors that name line and word. A
 * row that runs out of numbers goes on in the next line. */
#ifndef BRIO_IO_TEXTROW_H
#define BRIO_IO_TEXTROW_H

#include "io/stream.h"

typedef struct brio_text {
    brio_stream *stream;
    char comment; /* what starts a comment, 0 for nothing */
    char *at;     /* place in the current line; NULL at the end of the file */
} brio_text;

/** Words of the file as messages may show them. */
typedef struct brio_excerpt {
    char text[32];
} brio_excerpt;
brio_excerpt brio_excerpt_of(const char *word);

static inline bool brio_is_blank(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}
static inline char *brio_skip_blanks(char *p) {
    while (brio_is_blank(*p)) p++;
    return p;
}

/** Moves to the next line that holds more than blanks and comment; at becomes NULL when there is none. */
brio_status brio_text_next_line(brio_text *t);

/** True when the current line holds another word. */
bool brio_text_more(brio_text *t);

/** The next number, if need be of the next line; errors for another word and for the end of the file. */
brio_status brio_text_number(brio_text *t, double *value);

/** The next number, which is to be whole and in 0 .. most.   what  it is, for the message. */
brio_status brio_text_count(brio_text *t, const char *what, uint64_t most, uint64_t *value);

/** Fails when the current line holds another word. */
brio_status brio_text_row_end(brio_text *t);

/** The error of a line where something else was expected. */
brio_status brio_text_expected(const brio_text *t, const char *what);

#endif
