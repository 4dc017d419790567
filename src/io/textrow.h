/* Rows of numbers in a text: the next line that is not empty, its words, and errors that name line and word. A row can
 * continue in the next line.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY or
 * BRIO_ERR_CANCELLED. */
#ifndef BRIO_IO_TEXTROW_H
#define BRIO_IO_TEXTROW_H

#include "io/stream.h"

typedef struct brio_text {
    brio_stream *stream;
    char comment; /* the character that starts a comment, or 0 */
    char *at;     /* the place in the current line; NULL at the end of the file */
} brio_text;

/** A word of the file in a form that messages can show. */
typedef struct brio_excerpt {
    char text[32];
} brio_excerpt;
brio_excerpt brio_excerpt_of(const char *word);

/** Returns whether a comment begins here in a text of points. */
static inline bool brio_starts_comment(const char *p) {
    return *p == '#' || *p == '%' || (*p == '/' && p[1] == '/');
}

static inline bool brio_is_blank(char c) {
    return c == ' ' || (c >= '\t' && c <= '\r');
}
static inline char *brio_skip_blanks(char *p) {
    while (brio_is_blank(*p)) p++;
    return p;
}

/** Moves to the next line that has more than blanks and a comment. t->at becomes NULL if there is none. */
brio_status brio_text_next_line(brio_text *t);

/** Returns whether the current line has another word, and moves to the word. */
bool brio_text_more(brio_text *t);

/** Reads the next number, from the next line if the current one has no more. Fails at any other word and at the end of
 *  the file. */
brio_status brio_text_number(brio_text *t, double *value);

/** Reads the next number. Fails unless it is an integer from 0 to `most`.   what  names the number in the message. */
brio_status brio_text_count(brio_text *t, const char *what, uint64_t most, uint64_t *value);

/** Fails if the current line has another word. */
brio_status brio_text_row_end(brio_text *t);

/** Fails if the current line has another word or the text another line: a row beyond those that it announced. */
brio_status brio_text_end(brio_text *t);

/** Returns the error of a line in which `what` was expected. */
brio_status brio_text_expected(const brio_text *t, const char *what);

#endif
