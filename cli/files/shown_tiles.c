/* The tetrahedra of tiles that a page and a picture show: all of them, or an even choice. */
#include "cli/files/read_write.h"
#include "cli/run/interrupt.h"
#include <stdlib.h>
#include <string.h>

/* Tetrahedra on a page or in a picture. Chosen: their corners are fewer than the vertices of a page with all digits. */
enum { MOST_SHOWN = 200000 };

/* Bytes of a tetrahedron that is shown, its share of the page or picture included: measured. */
static const double SHOWN_BYTES = 400;

/* A corner of a tetrahedron that is shown. */
typedef struct {
    uint64_t point; /* in the input */
    size_t corner;
    double place[3], weight;
} shown_corner;

/* The tetrahedra that are shown: all of them, or an even choice. */
typedef struct {
    uint64_t all, most, seen;
    size_t count; /* of the corners so far */
    shown_corner *corner;
} showing;

static void choose_tetrahedra(showing *s, const brio_tile_part *p) {
    for (size_t i = 0; i < p->num_tetrahedra; i++, s->seen++) {
        if (s->seen * s->most / s->all == (s->seen + 1) * s->most / s->all) continue;
        for (int k = 0; k < 4; k++, s->count++) {
            size_t v = p->tetrahedra[i][k];
            shown_corner *c = &s->corner[s->count];
            *c = (shown_corner){.point = p->index[v], .corner = s->count, .weight = p->weights ? p->weights[v] : 0};
            memcpy(c->place, p->points + 3 * v, sizeof c->place);
        }
    }
}

static int compare_corners(const void *a, const void *b) {
    const shown_corner *x = a, *y = b;
    if (x->point != y->point) return x->point < y->point ? -1 : 1;
    return x->corner < y->corner ? -1 : x->corner > y->corner;
}

/* Sorts the corners by their points, numbers the points, and keeps one corner of each. Returns the number of points. */
static size_t number_points(showing *s, uint32_t *tetrahedra) {
    size_t n = 0;
    qsort(s->corner, s->count, sizeof *s->corner, compare_corners);
    for (size_t i = 0; i < s->count; i++) {
        shown_corner c = s->corner[i];
        if (!n || c.point != s->corner[n - 1].point) s->corner[n++] = c;
        tetrahedra[c.corner] = (uint32_t)(n - 1);
    }
    return n;
}

/* Makes the mesh of the tetrahedra that are shown. It has their vertices alone, as the files of tiles. */
static brio_status fill_shown(run *r, showing *s, bool weighted, brio_mesh *mesh) {
    brio_status status = BRIO_OK;
    uint32_t *tetrahedra = malloc((s->count + 1) * sizeof *tetrahedra);
    double *places = malloc((3 * s->count + 1) * sizeof *places);
    void *data;
    if (!tetrahedra || !places) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for what is shown");
    size_t n = number_points(s, tetrahedra);
    for (size_t i = 0; i < n; i++) memcpy(places + 3 * i, s->corner[i].place, sizeof s->corner[i].place);
    TRY(brio_mesh_set_vertices(mesh, places, n));
    TRY(brio_mesh_set_tetrahedra(mesh, tetrahedra, 4, s->count / 4));
    TRY(brio_mesh_add_property(mesh, "point", BRIO_SCALAR_FLOAT64, &data));
    for (size_t i = 0; i < n; i++) ((double *)data)[i] = (double)s->corner[i].point;
    if (weighted) {
        TRY(brio_mesh_add_property(mesh, "weight", BRIO_SCALAR_FLOAT64, &data));
        for (size_t i = 0; i < n; i++) ((double *)data)[i] = s->corner[i].weight;
    }
done:
    free(tetrahedra);
    free(places);
    return status;
}

brio_status cli_show_tiles(run *r, brio_tiles *t, uint32_t tiles) {
    brio_status status = BRIO_OK;
    showing s = {.all = brio_tiles_facts(t)->tetrahedra};
    brio_mesh *mesh = NULL;
    if (!cli_showing(r)) return BRIO_OK;
    s.most = cli_most_shown(r, s.all, MOST_SHOWN, SHOWN_BYTES);
    s.corner = malloc((4 * (size_t)s.most + 1) * sizeof *s.corner);
    if (!s.corner) FAIL(r, BRIO_ERR_NO_MEMORY, "out of memory for what is shown");
    for (uint32_t i = 0; i < tiles; i++) {
        brio_tile_part part = {.size = sizeof part};
        TRY(brio_tiles_part(r->ctx, t, i, &part));
        choose_tetrahedra(&s, &part);
        brio_tile_part_free(r->ctx, &part);
        TRY(cli_check_interrupt(r));
    }
    TRY(brio_mesh_new(r->ctx, &mesh));
    TRY(fill_shown(r, &s, brio_tiles_facts(t)->weighted, mesh));
    if (s.most < s.all) cli_warn(r, WARNING_CHOSEN, cli_showing(r), (size_t)s.most, (size_t)s.all);
    status = cli_show(r, mesh);
done:
    brio_mesh_free(mesh);
    free(s.corner);
    return status;
}
