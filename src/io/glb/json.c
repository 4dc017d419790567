/* JSON as a tree, by cJSON.
 *
 * cJSON takes its memory from malloc, and calls itself for every level. Therefore a text is first looked over: its
 * values are counted, and a block that is as large as their tree at most is taken from the counted memory and kept
 * beside the tree; and a text of more than MOST_LEVELS levels is refused, so that a small stack suffices.
 *
 * Based on: Bray. The JavaScript object notation (JSON) data interchange format. RFC 8259, 2017. */
#ifdef BRIO_HAS_CJSON
#include "io/glb/json.h"
#include "base/memory.h"
#include "io/limits.h"
#include <cjson/cJSON.h>
#include <errno.h>

/* BLOCK: bytes of malloc for a block of its own. Both chosen. */
enum { BLOCK = 32 };

typedef struct {
    size_t values, levels;
} extent;

/* Counts the values, or a few more, and the levels. What is no JSON is found by the parser. */
static extent look_over(const char *text, size_t size) {
    extent e = {1, 0};
    size_t level = 0;
    bool quoted = false;
    for (size_t i = 0; i < size; i++) {
        char c = text[i];
        if (quoted && c == '\\')
            i++;
        else if (c == '"')
            quoted = !quoted;
        if (quoted) continue;
        e.values += c == ',' || c == '[' || c == '{';
        if (c == '[' || c == '{') level++;
        if ((c == ']' || c == '}') && level) level--;
        if (level > e.levels) e.levels = level;
    }
    return e;
}

brio_status brio_json_parse(brio_json_document *d, const char *text, size_t size) {
    char *reserve = NULL;
    const char *end = NULL;
    extent e = look_over(text, size);
    BRIO_FORWARD(brio_limit_levels(d->ctx, d->name, "the JSON", e.levels));
    /* a value, its key and its string, which together are no longer than the text */
    BRIO_FORWARD(BRIO_ALLOC(d->ctx, reserve, e.values * (sizeof(cJSON) + 3 * BLOCK) + size));
    d->reserve = reserve;
    errno = 0; /* by which malloc tells, as the parser does not */
    d->root = cJSON_ParseWithLengthOpts(text, size, &end, 0);
    BRIO_EXPECT(d->ctx, d->root || errno != ENOMEM, BRIO_ERR_NO_MEMORY, "%s: no memory for the JSON", d->name);
    BRIO_EXPECT(d->ctx, d->root, BRIO_ERR_FORMAT, "%s: byte %zu of the JSON: expected JSON", d->name,
                end ? (size_t)(end - text) : 0);
    return BRIO_OK;
}

void brio_json_free(brio_json_document *d) {
    cJSON_Delete(d->root);
    brio_release(d->ctx, d->reserve);
    d->root = d->reserve = NULL;
}

const brio_json *brio_json_get(const brio_json *object, const char *key) {
    return cJSON_IsObject(object) ? cJSON_GetObjectItemCaseSensitive(object, key) : NULL;
}

const brio_json *brio_json_first(const brio_json *array) {
    return cJSON_IsArray(array) || cJSON_IsObject(array) ? array->child : NULL;
}

const brio_json *brio_json_next(const brio_json *item) {
    return item->next;
}

const char *brio_json_key(const brio_json *item) {
    return item->string ? item->string : "";
}

const char *brio_json_string(const brio_json *item) {
    return cJSON_IsString(item) ? item->valuestring : NULL;
}

bool brio_json_number(const brio_json *item, double *value) {
    if (!cJSON_IsNumber(item)) return false;
    *value = item->valuedouble;
    return true;
}

bool brio_json_is_true(const brio_json *item) {
    return cJSON_IsTrue(item);
}

bool brio_json_is_array(const brio_json *item) {
    return cJSON_IsArray(item);
}

bool brio_json_is_object(const brio_json *item) {
    return cJSON_IsObject(item);
}

#endif
