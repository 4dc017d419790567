/* Writes pages with their checksums, see e57_pen.h.
 *
 * Based on: ASTM E2807-11, 7 (physical and logical offsets, checksums). */
#include "io/e57/e57_pen.h"
#include "base/memory.h"
#include <assert.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

brio_status brio_e57_pen_begin(brio_e57_pen *p) {
    brio_status status = BRIO_OK;
    const char header[1] = {0};
    BRIO_TRY(brio_e57_checksum_table(p->out->ctx, &p->table));
    p->kept_page = UINT64_MAX;
    BRIO_TRY(brio_e57_put(p, header, sizeof header));
    BRIO_TRY(brio_e57_pen_turn(p));
done:
    return status;
}

void brio_e57_pen_free(brio_e57_pen *p, brio_context *ctx) {
    brio_release(ctx, p->table);
    p->table = NULL;
}

uint64_t brio_e57_pen_offset(const brio_e57_pen *p) {
    return p->pages * BRIO_E57_CONTENT + p->used;
}

/* Writes the checksum of a page behind its content. Returns the checksum. */
static uint32_t sign(const brio_e57_pen *p, char page[BRIO_E57_PAGE]) {
    uint32_t sum = brio_e57_checksum(p->table, page);
    for (int i = 0; i < 4; i++) page[BRIO_E57_CONTENT + i] = (char)(sum >> (24 - 8 * i) & 255);
    return sum;
}

static brio_status write_page(brio_e57_pen *p) {
    assert(p->used == BRIO_E57_CONTENT);
    p->sum = (p->sum ^ sign(p, p->page)) * UINT64_C(0x100000001b3);
    if (p->pages == p->kept_page) memcpy(p->kept, p->page, BRIO_E57_PAGE);
    p->pages++;
    p->used = 0;
    return brio_output_bytes(p->out, p->page, BRIO_E57_PAGE);
}

brio_status brio_e57_put(brio_e57_pen *p, const void *bytes, size_t size) {
    brio_status status = BRIO_OK;
    const char *at = bytes;
    while (size) {
        size_t part = size < BRIO_E57_CONTENT - p->used ? size : BRIO_E57_CONTENT - p->used;
        memcpy(p->page + p->used, at, part);
        p->used += part;
        at += part;
        size -= part;
        if (p->used == BRIO_E57_CONTENT) BRIO_TRY(write_page(p));
    }
done:
    return status;
}

brio_status brio_e57_put_text(brio_e57_pen *p, const char *format, ...) {
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    int length = vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    assert(length >= 0 && (size_t)length < sizeof text);
    return brio_e57_put(p, text, (size_t)length);
}

brio_status brio_e57_pen_turn(brio_e57_pen *p) {
    brio_status status = BRIO_OK;
    if (p->used) {
        memset(p->page + p->used, 0, BRIO_E57_CONTENT - p->used);
        p->used = BRIO_E57_CONTENT;
        BRIO_TRY(write_page(p));
    }
    p->kept_page = p->pages;
done:
    return status;
}

brio_status brio_e57_pen_patch(brio_e57_pen *p, const void *bytes, size_t size) {
    if (p->pages == p->kept_page) { /* the page is not written yet */
        memcpy(p->page, bytes, size);
        return BRIO_OK;
    }
    memcpy(p->kept, bytes, size);
    sign(p, p->kept);
    return brio_output_patch(p->out, p->kept_page * BRIO_E57_PAGE, p->kept, BRIO_E57_PAGE);
}

brio_status brio_e57_pen_end(brio_e57_pen *p, const void *header, size_t size) {
    brio_status status = BRIO_OK;
    BRIO_TRY(brio_e57_pen_turn(p));
    memset(p->kept, 0, BRIO_E57_PAGE);
    p->kept_page = 0;
    BRIO_TRY(brio_e57_pen_patch(p, header, size));
done:
    return status;
}
