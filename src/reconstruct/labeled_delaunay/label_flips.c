/* Labels of tetrahedra that change one at a time. A flip changes the energy at the four facets of the tetrahedron and
 * at its samples: a sample with the votes a for outer and b for inner costs min(a, b). */
#include "reconstruct/labeled_delaunay/label_flips.h"
#include "base/memory.h"
#include <stdlib.h>
#include <string.h>

brio_status brio_label_flips_new(const brio_vote_graph *g, uint8_t *label, brio_label_flips *out) {
    brio_status status = BRIO_OK;
    brio_context *ctx = g->ctx;
    const brio_pole_vectors *v = g->dual;
    *out = (brio_label_flips){.ctx = ctx,
                              .g = g,
                              .num_tets = v->t.count,
                              .num_finite = v->num_finite,
                              .num_samples = v->num_points,
                              .label = label};
    BRIO_TRY(BRIO_ALLOC(ctx, out->outer, out->num_samples));
    BRIO_TRY(BRIO_ALLOC(ctx, out->place, out->num_tets));
    memset(out->place, 255, out->num_tets * sizeof *out->place);
    BRIO_TRY(brio_sum_votes(g, BRIO_FLIP_VOTES, label, out->outer, NULL));
done:
    return status;
}

void brio_label_flips_free(brio_label_flips *f) {
    brio_release(f->ctx, f->outer);
    brio_release(f->ctx, f->place);
    brio_release(f->ctx, f->flipped);
    *f = (brio_label_flips){.ctx = f->ctx};
}

/* Flips a finite tetrahedron and returns what it costs. */
static int64_t turn(brio_label_flips *f, uint32_t tet) {
    const brio_tetrahedron *t = &f->g->dual->t.tet[tet];
    int64_t cost = 0, sign = f->label[tet] != BRIO_LABEL_OUTER ? 2 : -2;
    for (int i = 0; i < 4; i++) {
        int64_t *outer = &f->outer[t->vertex[i]], before = llabs(*outer), facet = brio_vote_of(f->g->facet[tet][i]);
        bool alike = f->label[brio_tet_of(t->mate[i])] == f->label[tet];
        *outer += sign * brio_vote_of(f->g->vote[tet][i]);
        cost += (alike ? facet : -facet) - (llabs(*outer) - before) / 2;
        f->faces += alike ? 1 : -1;
    }
    f->label[tet] = brio_other_label(f->label[tet]);
    return cost;
}

brio_status brio_flip(brio_label_flips *f, uint32_t tet) {
    brio_status status = BRIO_OK;
    BRIO_TRY(BRIO_RESERVE(f->ctx, f->flipped, f->capacity, f->size + 1));
    f->energy += turn(f, tet);
    f->flipped[f->size++] = tet;
done:
    return status;
}

void brio_take_back(brio_label_flips *f, size_t size) {
    while (f->size > size) f->energy += turn(f, f->flipped[--f->size]);
}

int64_t brio_flip_cost(const brio_label_flips *f, uint32_t tet) {
    const brio_tetrahedron *t = &f->g->dual->t.tet[tet];
    int64_t cost = 0, sign = f->label[tet] != BRIO_LABEL_OUTER ? 2 : -2;
    for (int i = 0; i < 4; i++) {
        int64_t outer = f->outer[t->vertex[i]], facet = brio_vote_of(f->g->facet[tet][i]);
        cost += f->label[brio_tet_of(t->mate[i])] == f->label[tet] ? facet : -facet;
        cost -= (llabs(outer + sign * brio_vote_of(f->g->vote[tet][i])) - llabs(outer)) / 2;
    }
    return cost;
}

void brio_label_samples(const brio_label_flips *f) {
    for (size_t p = 0; p < f->num_samples; p++)
        if (f->outer[p] != 0) f->label[f->num_tets + p] = f->outer[p] > 0 ? BRIO_LABEL_OUTER : BRIO_LABEL_INNER;
}

size_t brio_list_samples(const brio_label_flips *f, size_t from, size_t to, uint32_t *sample) {
    size_t count = 0;
    for (size_t i = from; i < to; i++)
        for (int k = 0; k < 4; k++) {
            uint32_t p = f->g->dual->t.tet[f->flipped[i]].vertex[k];
            size_t n = 0;
            while (n < count && sample[n] != p) n++;
            if (n == count) sample[count++] = p;
        }
    return count;
}

/* --- stars --- */

/* Gives the part of an entry of a star its number. */
static void flood(const brio_label_flips *f, brio_star_parts *s, int first) {
    int16_t stack[BRIO_STAR_ROOM];
    int size = 1;
    uint8_t label = f->label[brio_star_tet(s->at[first])];
    stack[0] = (int16_t)first;
    s->part[first] = (int16_t)s->count;
    while (size > 0) {
        uint32_t entry = s->at[stack[--size]];
        const uint32_t *mate = f->g->dual->t.tet[brio_star_tet(entry)].mate;
        for (int i = 0; i < 4; i++) {
            uint32_t other = brio_tet_of(mate[i]);
            uint16_t place = f->place[other];
            if (i == brio_slot_of(entry) || f->label[other] != label || s->part[place] >= 0) continue;
            s->part[place] = (int16_t)s->count;
            stack[size++] = (int16_t)place;
        }
    }
    s->of[label == BRIO_LABEL_INNER]++;
    s->count++;
}

bool brio_find_parts(brio_label_flips *f, uint32_t sample, brio_star_parts *out) {
    const size_t *first = f->g->first + sample;
    out->size = first[1] - first[0];
    out->at = f->g->star + first[0];
    out->count = out->of[0] = out->of[1] = 0;
    if (out->size > BRIO_STAR_ROOM) return false;
    for (size_t i = 0; i < out->size; i++) {
        f->place[brio_star_tet(out->at[i])] = (uint16_t)i;
        out->part[i] = -1;
    }
    for (size_t i = 0; i < out->size; i++)
        if (out->part[i] < 0) flood(f, out, (int)i);
    for (size_t i = 0; i < out->size; i++) f->place[brio_star_tet(out->at[i])] = BRIO_NOT_IN_STAR;
    return true;
}
