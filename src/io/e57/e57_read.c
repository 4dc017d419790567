/* Reads E57 files: the points of all scans, each in the pose of its scan.
 *
 * The XML section, at the end, says where the points are. All sections are checked against the file's size before memory
 * is taken for their points. The bytes of a field are decoded to their places in the mesh at once.
 *
 * Based on: ASTM E2807-11. Standard specification for 3D imaging data exchange, version 1.0. Huber. The ASTM E57 file
 * format for 3D imaging data exchange. SPIE 7864, 2011. */
#include "base/memory.h"
#include "io/e57/e57_place.h"
#include "io/e57/e57_plan.h"
#include "io/e57/e57_section.h"
#include "io/formats.h"
#include "io/origins.h"
#include "io/scalar.h"
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct {
    brio_builder *builder;
    brio_e57_pages pages;
    brio_e57_scans scans;
    brio_e57_plan plan;
    brio_e57_section *sections; /* of each scan */
    brio_e57_decoder *decoders; /* of the scan that is read */
    uint8_t *invalid;           /* of each of its points */
    size_t first;               /* its first vertex */
} e57_reader;

bool brio_e57_starts(const char *bytes, size_t size) {
    return size >= 8 && !memcmp(bytes, "ASTM-E57", 8);
}

static int compare_places(const void *a, const void *b) {
    uint64_t i = *(const uint64_t *)a, j = *(const uint64_t *)b;
    return (i > j) - (i < j);
}

/* Ends the sections whose length is not known at the next section behind them, or at the XML section, or at the file's end. */
static brio_status end_sections(e57_reader *r) {
    brio_status status = BRIO_OK;
    size_t count = 0, num_scans = r->scans.num_scans;
    uint64_t *places = NULL;
    BRIO_TRY(BRIO_ALLOC(r->builder->ctx, places, num_scans + 1));
    for (size_t i = 0; i < num_scans; i++)
        if (r->scans.scans[i].records) places[count++] = r->sections[i].begin;
    places[count++] = r->pages.xml;
    qsort(places, count, sizeof *places, compare_places);
    for (size_t i = 0; i < num_scans; i++) {
        brio_e57_section *s = &r->sections[i];
        if (!s->endless) continue;
        size_t low = 0, high = count;
        while (low < high) {
            size_t middle = (low + high) / 2;
            if (places[middle] > s->begin)
                high = middle;
            else
                low = middle + 1;
        }
        s->end = low < count ? places[low] : brio_e57_size(&r->pages);
    }
done:
    brio_release(r->builder->ctx, places);
    return status;
}

/* Finds and checks all sections, and makes room for their points. Sections may not lie upon one another: together they
 * are not longer than the file. */
static brio_status open_sections(e57_reader *r) {
    brio_status status = BRIO_OK;
    brio_context *ctx = r->builder->ctx;
    uint64_t points = 0, bytes = 0;
    BRIO_TRY(BRIO_ALLOC(ctx, r->sections, r->scans.num_scans));
    for (size_t i = 0; i < r->scans.num_scans; i++)
        BRIO_TRY(brio_e57_section_open(&r->pages, &r->scans, i, &r->sections[i]));
    BRIO_TRY(end_sections(r));
    for (size_t i = 0; i < r->scans.num_scans; i++) {
        BRIO_TRY(brio_e57_section_check(&r->pages, &r->scans, &r->sections[i]));
        points += r->scans.scans[i].records;
        bytes += r->sections[i].end - r->sections[i].begin;
        BRIO_REQUIRE(ctx, bytes <= brio_e57_size(&r->pages), BRIO_ERR_FORMAT,
                     "%s: scan %zu (counted from 0): the points of the scans up to this one have more bytes than the "
                     "file",
                     r->builder->name, i);
    }
    BRIO_TRY(brio_builder_expect_vertices(r->builder, points));
done:
    return status;
}

/* --- one scan --- */

static void aim(e57_reader *r, uint32_t role, brio_e57_decoder *d) {
    brio_mesh *m = r->builder->mesh;
    if (role >= BRIO_E57_PROPERTY) {
        const brio_property *p = &m->properties[role - BRIO_E57_PROPERTY];
        d->type = p->type;
        d->stride = brio_scalar_size(p->type);
        d->target = (char *)p->data + r->first * d->stride;
    } else if (role == BRIO_E57_INVALID) {
        d->type = BRIO_SCALAR_UINT8;
        d->tests = true;
        d->stride = 1;
        d->target = (char *)r->invalid;
    } else if (role >= BRIO_E57_AXIS) {
        d->type = BRIO_SCALAR_FLOAT64;
        d->stride = 3 * sizeof *m->vertices;
        d->target = (char *)(m->vertices + 3 * r->first + role - BRIO_E57_AXIS);
    }
}

/* Fills what no field of the scan fills: properties that it lacks, and its number. */
static void fill_rest(e57_reader *r, size_t scan) {
    brio_mesh *m = r->builder->mesh;
    const brio_e57_scan *s = &r->scans.scans[scan];
    for (size_t i = 0; i < m->num_properties; i++) {
        brio_property *p = &m->properties[i];
        bool number = i == r->plan.num_columns, there = false;
        for (size_t f = s->first_field; f < s->first_field + s->num_fields; f++)
            there |= r->plan.roles[f] == BRIO_E57_PROPERTY + i;
        size_t size = brio_scalar_size(p->type);
        for (size_t v = r->first; v < m->num_vertices && !there; v++)
            brio_scalar_store((char *)p->data + v * size, p->type, number ? (double)scan : (double)NAN);
    }
}

static brio_status decode_scan(e57_reader *r, size_t scan) {
    brio_status status = BRIO_OK;
    const brio_e57_scan *s = &r->scans.scans[scan];
    const brio_e57_field *fields = r->scans.fields + s->first_field;
    BRIO_TRY(BRIO_ALLOC_ZERO(r->builder->ctx, r->decoders, s->num_fields));
    for (size_t i = 0; i < s->num_fields; i++) {
        uint32_t role = r->plan.roles[s->first_field + i];
        r->decoders[i] = (brio_e57_decoder){.code = fields[i].code, .count = s->records};
        if (role == BRIO_E57_INVALID) BRIO_TRY(BRIO_ALLOC(r->builder->ctx, r->invalid, s->records));
        aim(r, role, &r->decoders[i]);
    }
    BRIO_TRY(brio_e57_section_read(&r->pages, &r->sections[scan], fields, r->decoders, s->num_fields));
    for (size_t i = 0; i < s->num_fields; i++)
        if (r->decoders[i].rounded) BRIO_TRY(brio_builder_leave_out(r->builder, "integers beyond 2^53"));
done:
    return status;
}

static brio_status read_scan(e57_reader *r, size_t scan) {
    brio_status status = BRIO_OK;
    brio_mesh *m = r->builder->mesh;
    const brio_e57_scan *s = &r->scans.scans[scan];
    brio_e57_pose pose;
    if (!s->records) return BRIO_OK;
    brio_e57_pose_make(&pose, s);
    if (pose.turns && r->builder->has_origins) BRIO_TRY(brio_builder_leave_out(r->builder, "turns of scanners"));
    if ((pose.turns || pose.moves) && !r->builder->has_origins) BRIO_TRY(brio_builder_leave_out(r->builder, "poses"));
    r->first = m->num_vertices;
    BRIO_TRY(brio_builder_add_vertices(r->builder, (size_t)s->records));
    BRIO_TRY(decode_scan(r, scan));
    fill_rest(r, scan);
    if (r->invalid) brio_e57_drop(m, r->first, r->invalid);
    double *points = m->vertices + 3 * r->first;
    if (r->plan.spherical[scan]) brio_e57_from_spherical(points, m->num_vertices - r->first);
    brio_e57_move(&pose, points, m->num_vertices - r->first);
    brio_e57_turn_normals(&pose, m, r->first);
    bool known = pose.turns || pose.moves || r->plan.spherical[scan];
    brio_set_origins(r->builder, r->first, known ? pose.translation : NULL);
done:
    brio_release(r->builder->ctx, r->decoders);
    brio_release(r->builder->ctx, r->invalid);
    r->decoders = NULL;
    r->invalid = NULL;
    return status;
}

brio_status brio_e57_read(brio_stream *s, brio_builder *b) {
    brio_status status = BRIO_OK;
    e57_reader r = {.builder = b};
    BRIO_TRY(brio_e57_pages_open(&r.pages, s));
    BRIO_TRY(brio_e57_xml_read(&r.pages, b, &r.scans));
    BRIO_TRY(brio_e57_plan_make(&r.plan, b, &r.scans));
    BRIO_TRY(brio_plan_origins(b));
    BRIO_TRY(open_sections(&r));
    r.pages.reports = true;
    for (size_t i = 0; i < r.scans.num_scans; i++) BRIO_TRY(read_scan(&r, i));
done:
    brio_release(b->ctx, r.sections);
    brio_e57_plan_free(b->ctx, &r.plan);
    brio_e57_scans_free(b->ctx, &r.scans);
    brio_e57_pages_close(&r.pages);
    return status;
}
