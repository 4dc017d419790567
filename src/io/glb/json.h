/* JSON as a tree. The parser is cJSON; a build without it has none of these functions. */
#ifndef BRIO_IO_JSON_H
#define BRIO_IO_JSON_H

#include "base/context.h"

typedef struct brio_json_document {
    brio_context *ctx;
    const char *name; /* of the file, for messages */
    void *root;       /* cJSON */
    void *reserve;    /* a block as large as the tree at most: the parser's memory is counted by it */
} brio_json_document;

/* A value of the tree; NULL where there is none. */
typedef struct cJSON brio_json;

/** Parses a text of `size` bytes.   document  {0}; call brio_json_free even if this fails.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT (the message has the byte), BRIO_ERR_NO_MEMORY. */
brio_status brio_json_parse(brio_json_document *document, const char *text, size_t size);
void brio_json_free(brio_json_document *document);

/** Returns the value of a key; NULL if `object` is NULL, no object, or has no such key. */
const brio_json *brio_json_get(const brio_json *object, const char *key);
/** Return the first item of an array or object, and the one behind an item; NULL at the end. */
const brio_json *brio_json_first(const brio_json *array);
const brio_json *brio_json_next(const brio_json *item);
/** Returns the key of an item of an object. */
const char *brio_json_key(const brio_json *item);
/** Returns the text of a string; NULL for other values. */
const char *brio_json_string(const brio_json *item);
/** Returns whether the value is a number, and which one. */
bool brio_json_number(const brio_json *item, double *value);
bool brio_json_is_true(const brio_json *item);
bool brio_json_is_array(const brio_json *item);
bool brio_json_is_object(const brio_json *item);

#endif
