/* LASzip's record, without which compressed points cannot be read: how they are compressed.
 *
 * Based on: Isenburg. LASzip. 2013. */
#include "io/las/las_header.h"
#include "io/little_endian.h"
#include <inttypes.h>
#include <string.h>

typedef struct {
    uint16_t type, size, version;
} laz_item;

/* The items that LASzip's record lists. */
enum { HEAD = 34, ITEM = 6 }; /* bytes of the record before its items, and of an item */
enum { ITEM_BYTES = 0, POINT10 = 6, TIME11, RGB12, WAVE13, POINT14, RGB14, RGBNIR14, WAVE14, BYTES14, MOST_ITEMS = 5 };

/* Lists the items of a format; returns their number. */
static size_t items_of(unsigned format, size_t record, laz_item *items) {
    static const uint8_t types[BRIO_LAS_FORMATS][3] = {
        {POINT10},        {POINT10, TIME11},   {POINT10, RGB12},  {POINT10, TIME11, RGB12},   {0}, {0}, {POINT14},
        {POINT14, RGB14}, {POINT14, RGBNIR14}, {POINT14, WAVE14}, {POINT14, RGBNIR14, WAVE14}};
    static const uint8_t sizes[] = {
        [POINT10] = 20, [TIME11] = 8, [RGB12] = 6, [POINT14] = 30, [RGB14] = 6, [RGBNIR14] = 8, [WAVE14] = 29};
    size_t count = 0;
    for (int i = 0; i < 3 && types[format][i]; i++) {
        uint16_t type = types[format][i];
        items[count++] = (laz_item){type, sizes[type], 0};
    }
    size_t extra = record - brio_las_record_bytes(format);
    if (count && extra) items[count++] = (laz_item){format < 6 ? ITEM_BYTES : BYTES14, (uint16_t)extra, 0};
    return count;
}

brio_laz_form brio_laz_form_of(unsigned format, size_t record) {
    return (brio_laz_form){.format = format,
                           .record = record,
                           .num_extra = record - brio_las_record_bytes(format),
                           .layered = format >= 6};
}

/* --- reading --- */

static brio_status check_items(brio_stream *s, brio_las_header *h, const char *bytes, size_t count) {
    brio_status status = BRIO_OK;
    laz_item items[MOST_ITEMS];
    size_t expected = items_of(h->format, h->record, items);
    bool layered = h->format >= 6, own_colours = false;
    BRIO_REQUIRE(s->ctx, expected, BRIO_ERR_FORMAT, "%s: compressed points of format %u: waveforms are not read",
                 s->name, h->format);
    BRIO_REQUIRE(s->ctx, count == expected, BRIO_ERR_FORMAT,
                 "%s: LASzip's record lists %zu items, point format %u has %zu", s->name, count, h->format, expected);
    for (size_t i = 0; i < count; i++, bytes += ITEM) {
        unsigned type = brio_le16(bytes), size = brio_le16(bytes + 2), version = brio_le16(bytes + 4);
        BRIO_REQUIRE(s->ctx, type == items[i].type && size == items[i].size, BRIO_ERR_FORMAT,
                     "%s: LASzip's record: item %zu has type %u and %u bytes, expected type %u and %u bytes", s->name,
                     i, type, size, items[i].type, items[i].size);
        BRIO_REQUIRE(s->ctx, version != 1, BRIO_ERR_FORMAT,
                     "%s: compressed by LASzip 1, whose form of points is not read: decompress the file with LASzip or "
                     "LAStools first",
                     s->name);
        BRIO_REQUIRE(s->ctx, layered ? version == 3 || version == 4 : version == 2, BRIO_ERR_FORMAT,
                     "%s: LASzip's record: item %zu has version %u, expected %s", s->name, i, version,
                     layered ? "3 or 4" : "2");
        own_colours = version == 4;
    }
    h->form = brio_laz_form_of(h->format, h->record);
    h->form.own_colours = own_colours;
done:
    return status;
}

brio_status brio_laz_form_read(brio_stream *s, brio_las_header *h, const char *bytes, size_t size) {
    brio_status status = BRIO_OK;
    BRIO_REQUIRE(s->ctx, size >= HEAD, BRIO_ERR_FORMAT, "%s: LASzip's record has %zu bytes, expected %d or more",
                 s->name, size, (int)HEAD);
    unsigned compressor = brio_le16(bytes), coder = brio_le16(bytes + 2);
    size_t count = brio_le16(bytes + 32);
    BRIO_REQUIRE(s->ctx,
                 coder == 0 && compressor == (h->format >= 6    ? 3
                                              : compressor == 1 ? 1
                                                                : 2),
                 BRIO_ERR_FORMAT, "%s: LASzip's record: compressor %u with coder %u for point format %u is not known",
                 s->name, compressor, coder, h->format);
    BRIO_REQUIRE(s->ctx, size >= HEAD + ITEM * count, BRIO_ERR_FORMAT,
                 "%s: LASzip's record has %zu bytes, %zu items need %zu", s->name, size, count, HEAD + ITEM * count);
    h->chunked = compressor != 1;
    h->chunk = brio_le32(bytes + 12);
    if (!h->chunk) h->chunk = UINT32_MAX; /* so LAStools writes COPC */
    BRIO_TRY(check_items(s, h, bytes + HEAD, count));
done:
    return status;
}

/* --- writing --- */

size_t brio_laz_form_write(const brio_laz_form *form, uint32_t chunk, char record[BRIO_LAZ_FORM]) {
    laz_item items[MOST_ITEMS];
    size_t count = items_of(form->format, form->record, items);
    memset(record, 0, BRIO_LAZ_FORM);
    brio_put_le16(record, form->layered ? 3 : 2);
    record[4] = 2; /* the version of LASzip that wrote first what this is: 2.2, and 3.0 for layers */
    record[5] = 2;
    if (form->layered) record[4] = 3, record[5] = 0;
    brio_put_le32(record + 12, chunk);
    brio_put_le64(record + 16, UINT64_MAX); /* no records of other programs, as LASzip writes it */
    brio_put_le64(record + 24, UINT64_MAX);
    brio_put_le16(record + 32, (uint16_t)count);
    for (size_t i = 0; i < count; i++) {
        char *item = record + HEAD + ITEM * i;
        brio_put_le16(item, items[i].type);
        brio_put_le16(item + 2, items[i].size);
        brio_put_le16(item + 4, form->layered ? 3 : 2);
    }
    return HEAD + ITEM * count;
}
