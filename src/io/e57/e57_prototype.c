/* Reads how the numbers of a field are stored: integers with the least bits that their bounds allow, scaled or not, and
 * floating-point numbers as they are.
 *
 * Based on: ASTM E2807-11, 8.3 (data types). */
#include "io/e57/e57_prototype.h"
#include "io/number.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static const char *find(const char *const *attributes, const char *name) {
    for (; *attributes; attributes += 2)
        if (!strcmp(attributes[0], name)) return attributes[1];
    return NULL;
}

/* Some programs write 0.0 for 0. */
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

bool brio_e57_field_read(brio_e57_field *field, const char *const *attributes, char reason[BRIO_E57_REASON]) {
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
