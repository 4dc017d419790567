/* Writes the pages of an E57 file: 1,020 bytes of content and a checksum each. The first page, which has the header, is
 * written last, and so are the headers of sections: each stands at the beginning of a page, which is kept for it.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_WRITE, BRIO_ERR_NO_MEMORY or BRIO_ERR_CANCELLED. */
#ifndef BRIO_IO_E57_PEN_H
#define BRIO_IO_E57_PEN_H

#include "io/e57/e57_pages.h"
#include "io/output.h"

typedef struct brio_e57_pen {
    brio_output *out;       /* set by the caller before every call */
    uint32_t (*table)[256]; /* for the checksum */
    char page[BRIO_E57_PAGE], kept[BRIO_E57_PAGE];
    size_t used;        /* bytes of content in `page` */
    uint64_t pages;     /* that are complete */
    uint64_t kept_page; /* the page that is or will be in `kept` */
    uint64_t sum;       /* of the checksums so far: the same bytes have the same one */
} brio_e57_pen;

/** Begins a file: its first page is empty. Call brio_e57_pen_free even if this fails. */
brio_status brio_e57_pen_begin(brio_e57_pen *p);
void brio_e57_pen_free(brio_e57_pen *p, brio_context *ctx);

/** Returns the logical offset of the next byte. */
uint64_t brio_e57_pen_offset(const brio_e57_pen *p);
brio_status brio_e57_put(brio_e57_pen *p, const void *bytes, size_t size);
/** Writes a text as printf does: at most 511 bytes. */
brio_status brio_e57_put_text(brio_e57_pen *p, const char *format, ...) __attribute__((format(printf, 2, 3)));

/** Fills the page with zeros, so that the next byte begins a page, which is kept until the next call. */
brio_status brio_e57_pen_turn(brio_e57_pen *p);
/** Replaces the first bytes of the page that is kept. */
brio_status brio_e57_pen_patch(brio_e57_pen *p, const void *bytes, size_t size);
/** Fills the last page with zeros and gives the first one its bytes. */
brio_status brio_e57_pen_end(brio_e57_pen *p, const void *header, size_t size);

#endif
