/* Descriptions of extra bytes: the numbers of a record behind the fields of its format.
 *
 * Descriptions come in records of variable length, of which there may be several, before the points or behind them: all of
 * them are one list, and the numbers lie in its order. What a description does not give, or the record has no room for, is
 * left out and named.
 *
 * Based on: ASPRS. LAS specification 1.4 R15. 2019. */
#include "base/memory.h"
#include "base/utf8.h"
#include "io/las/las_header.h"
#include "io/little_endian.h"
#include <stdio.h>

enum { TYPES = 10 /* of one number; the next ten are two numbers, the last ten three */, MOST_TYPE = 3 * TYPES };
/* no-data, least, greatest value, scale, offset: three numbers of 8 bytes each */
enum { TRIPLES = 40, TRIPLE = 24, NUM_TRIPLES = 5 };

size_t brio_las_extra_bytes(unsigned type) {
    static const uint8_t bytes[] = {0, 1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
    return type < sizeof bytes ? bytes[type] : 0;
}

/* Names what is not read: NAME (WHY). */
static brio_status leave_out(brio_builder *b, const char *bytes, const char *why) {
    char name[BRIO_LAS_NAME + 1], text[128];
    snprintf(name, sizeof name, "%.32s", bytes + BRIO_EXTRA_NAME);
    snprintf(text, sizeof text, "%s (%s)", name[0] ? name : "extra bytes", why);
    return brio_builder_leave_out(b, text);
}

/* Adds number `which` of the `count` numbers of one description. */
static brio_status add_extra(brio_builder *b, brio_las_header *h, const char *bytes, unsigned which, unsigned count) {
    brio_status status = BRIO_OK;
    unsigned options = (uint8_t)bytes[BRIO_EXTRA_OPTIONS];
    brio_las_extra e = {.type = ((uint8_t)bytes[BRIO_EXTRA_TYPE] - 1u) % TYPES + 1, .scale = 1};
    char name[BRIO_LAS_NAME + 1];
    memcpy(e.description, bytes, sizeof e.description);
    e.description[BRIO_EXTRA_TYPE] = (char)e.type;
    for (size_t i = 0; i < NUM_TRIPLES; i++) {
        char *triple = e.description + TRIPLES + TRIPLE * i;
        memcpy(triple, bytes + TRIPLES + TRIPLE * i + 8 * which, 8);
        memset(triple + 8, 0, TRIPLE - 8);
    }
    e.scaled = options & (BRIO_EXTRA_SCALED | BRIO_EXTRA_SHIFTED);
    if (options & BRIO_EXTRA_SCALED) e.scale = brio_le_double(e.description + BRIO_EXTRA_SCALE);
    if (options & BRIO_EXTRA_SHIFTED) e.offset = brio_le_double(e.description + BRIO_EXTRA_OFFSET);
    e.at = h->described + which * brio_las_extra_bytes(e.type);
    snprintf(name, sizeof name, "%.32s", bytes + BRIO_EXTRA_NAME);
    brio_utf8_copy(e.name, sizeof e.name, name[0] ? name : "extra_bytes");
    if (count > 1) brio_numbered_name(e.name, sizeof e.name, name[0] ? name : "extra_bytes", which);
    BRIO_TRY(BRIO_RESERVE(b->ctx, h->extras, h->extra_capacity, h->num_extras + 1));
    h->extras[h->num_extras++] = e;
done:
    return status;
}

brio_status brio_las_take_extras(brio_builder *b, brio_las_header *h, const char *bytes, size_t size) {
    brio_status status = BRIO_OK;
    size_t room = h->record - brio_las_record_bytes(h->format);
    for (; size >= BRIO_LAS_EXTRA; size -= BRIO_LAS_EXTRA, bytes += BRIO_LAS_EXTRA) {
        unsigned type = (uint8_t)bytes[BRIO_EXTRA_TYPE], count = type ? (type - 1) / TYPES + 1 : 1;
        size_t width = type ? brio_las_extra_bytes((type - 1) % TYPES + 1) : (uint8_t)bytes[BRIO_EXTRA_OPTIONS];
        h->closed |= type > MOST_TYPE || count * width > room - h->described;
        if (h->closed) {
            BRIO_TRY(leave_out(b, bytes, type > MOST_TYPE ? "extra bytes of a reserved type" : "not in the records"));
            continue;
        }
        for (unsigned i = 0; i < count && type; i++) BRIO_TRY(add_extra(b, h, bytes, i, count));
        if (!type) BRIO_TRY(leave_out(b, bytes, "extra bytes without a type"));
        h->described += count * width;
    }
done:
    return status;
}

brio_status brio_las_end_extras(brio_builder *b, const brio_las_header *h) {
    if (h->record - brio_las_record_bytes(h->format) == h->described) return BRIO_OK;
    return brio_builder_leave_out(b, "extra bytes that nothing describes");
}
