/* Draws triangles, lines and discs into samples, and the means of these into pixels.
 *
 * The picture is divided into bands of rows. A thread takes a band and goes through all shapes in their order, so
 * that each sample sees them in one order, whatever the number of threads: the nearest one is kept, of equally near
 * ones the first.
 *
 * Based on: Pineda. A parallel algorithm for polygon rasterization. SIGGRAPH 1988.
 * Differs from it: lines are all samples near a segment, discs are balls that look at the eye. */
#include "base/memory.h"
#include "base/team.h"
#include "picture/picture.h"
#include <math.h>

/* ROWS, MOST_ROWS: rows of pixels of a band; BANDS: bands of pictures that are not high. All chosen. */
enum { ROWS = 16, MOST_ROWS = 64, BANDS = 64 };

/* Lines: half their width, by how much they are nearer than what they lie on; both in pixels. */
static const double LINE = 0.75, LINE_ON_FACES = 0.4, EDGE_LINE = 0.55, MARK = 1.25, NEARER = 1.5;

static const brio_rgb KINDS[] = {[BRIO_LINE_BOUNDARY] = {{26, 158, 255}},
                                 [BRIO_LINE_NONMANIFOLD] = {{255, 61, 166}},
                                 [BRIO_LINE_FLIPPED] = {{242, 217, 26}}};
static const brio_rgb BACK = {{184, 128, 117}}, CROSSING = {{235, 41, 61}};

typedef struct {
    float z;
    brio_rgb colour;
} point_of_band;

typedef struct {
    point_of_band *at;   /* row by row */
    int width, from, to; /* samples: of a row, and the rows */
    float line;          /* light of lines that have no colours: they stand out from the background */
} band;

static uint8_t clamped(float x) {
    return x <= 0 ? 0 : x >= 255 ? 255 : (uint8_t)(x + 0.5F);
}

static void put(band *b, int x, int y, double z, brio_rgb colour) {
    point_of_band *s = b->at + (size_t)(y - b->from) * (size_t)b->width + x;
    if ((float)z <= s->z) return;
    s->z = (float)z;
    s->colour = colour;
}

/* Finds the samples between two places along an axis, of [least, most). Sample i is at i + 1/2. */
static void between(double low, double high, int least, int most, int *from, int *to) {
    double first = ceil(low - 0.5), end = floor(high - 0.5) + 1;
    *from = first < least ? least : first > most ? most : (int)first;
    *to = end > most ? most : end < least ? least : (int)end;
}

/* --- light --- */

static brio_rgb lit(const float colour[3], float light) {
    brio_rgb out;
    for (int k = 0; k < 3; k++) out.c[k] = clamped(colour[k] * light);
    return out;
}

/* Returns the light on a face with a normal that looks at the eye: two lights at the eye's side, as on
 * pages, and a weak one at the eye. y is downwards. */
static float light_on(const float n[3]) {
    const float a[3] = {-0.3393F, -0.5332F, 0.7755F}, b[3] = {0.7683F, 0.3293F, 0.5488F};
    float left = n[0] * a[0] + n[1] * a[1] + n[2] * a[2], right = n[0] * b[0] + n[1] * b[1] + n[2] * b[2];
    return 0.27F + 0.56F * fmaxf(0, left) + 0.2F * fmaxf(0, right) + 0.12F * fabsf(n[2]);
}

static void colour_of(const brio_paint *p, size_t row, float out[3]) {
    brio_rgb c = p->rgb ? p->rgb[row] : p->value ? brio_map_colour(p->value[row]) : p->plain;
    for (int k = 0; k < 3; k++) out[k] = c.c[k];
}

/* --- triangles --- */

typedef struct {
    const double *p[3];
    double twice; /* its area, above 0 */
    float normal[3][3], colour[3][3], value[3],
        height[3]; /* of the corners; of the corners over the edges behind them */
    bool by_value;
    unsigned drawn; /* bit k: the edge from corner k to the next one */
} facet;

/* The least cosine between a face and the normal at its corner, about 25 degrees. Chosen. */
static const float SMOOTH = 0.9F;

/* Slivers: how high they are at most, as parts of their longest side, and how long, in pixels. Chosen. */
static const double THIN = 0.25, SHORT = 24;

/* Returns whether a triangle is so thin and short that its normal says nothing: it would be a speck in the picture. */
static bool is_speck(const facet *f, double area) {
    double longest = 0;
    for (int k = 0; k < 3; k++) {
        const double *a = f->p[k], *b = f->p[(k + 1) % 3];
        longest = fmax(longest,
                       (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]));
    }
    return area < THIN * longest && longest < SHORT * SHORT * BRIO_SAMPLES * BRIO_SAMPLES;
}

/* Takes a normal for each corner: the vertex's, where the face does not bend away from it, and else the face's own.
 * own  the face's.   area  twice that of the face. */
static void take_normals(const brio_drawn_mesh *d, const uint32_t *corner, const float *own, double area, float sign,
                         facet *f) {
    bool speck = is_speck(f, area);
    for (int k = 0; k < 3; k++) {
        const float *of = d->normal && !d->shapes.flat ? d->normal[corner[k]] : own;
        float cosine = of[0] * own[0] + of[1] * own[1] + of[2] * own[2];
        if (cosine < SMOOTH && !(speck && of[0] * of[0] + of[1] * of[1] + of[2] * of[2] > 0.5F)) of = own;
        for (int x = 0; x < 3; x++) f->normal[k][x] = sign * of[x];
    }
}

static void take_colours(const brio_drawn_mesh *d, size_t t, bool turned, facet *f) {
    const brio_paint *p = &d->paint;
    const brio_shapes *s = &d->shapes;
    bool plain = !p->rgb && !p->value, crosses = s->crossing && s->crossing[s->of[t]];
    f->by_value = p->value && !p->of_faces && !crosses;
    for (int k = 0; k < 3; k++) {
        size_t row = p->of_faces ? s->of[t] : s->corner[t][k];
        if (f->by_value) f->value[k] = p->value[row];
        colour_of(p, row, f->colour[k]);
        for (int x = 0; x < 3; x++) {
            if (crosses) f->colour[k][x] = CROSSING.c[x];
            if (turned && !crosses) f->colour[k][x] = plain ? BACK.c[x] : 0.65F * f->colour[k][x] + 0.35F * BACK.c[x];
        }
    }
}

/* Prepares a triangle; returns whether it is seen at all. */
static bool set_up(const brio_drawn_mesh *d, size_t t, facet *f) {
    const uint32_t *corner = d->shapes.corner[t];
    for (int k = 0; k < 3; k++) f->p[k] = d->place[corner[k]];
    double u[3], v[3], n[3];
    for (int k = 0; k < 3; k++) u[k] = f->p[1][k] - f->p[0][k], v[k] = f->p[2][k] - f->p[0][k];
    for (int k = 0; k < 3; k++) n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    if (!(n[2] != 0)) return false;
    /* y is downwards: what is counterclockwise to the eye has n[2] < 0 */
    bool turned = n[2] > 0;
    double length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    float own[3];
    f->twice = n[2];
    for (int k = 0; k < 3; k++) own[k] = (float)(-n[k] / length);
    take_normals(d, corner, own, length, turned ? -1 : 1, f);
    take_colours(d, t, turned && !d->shapes.flat, f);
    f->drawn = d->shapes.lined ? d->shapes.drawn[t] : 0;
    for (int k = 0; k < 3; k++) {
        const double *a = f->p[(k + 1) % 3], *b = f->p[(k + 2) % 3];
        f->height[k] = (float)(fabs(f->twice) / hypot(b[0] - a[0], b[1] - a[1]));
    }
    return true;
}

/* Returns the colour at a place of a triangle.   w  its barycentric coordinates. */
static brio_rgb colour_at(const facet *f, const double w[3]) {
    float n[3], colour[3], size;
    for (int x = 0; x < 3; x++) {
        n[x] = colour[x] = 0;
        for (int k = 0; k < 3; k++) {
            n[x] += (float)w[k] * f->normal[k][x];
            colour[x] += (float)w[k] * f->colour[k][x];
        }
    }
    if (f->by_value) {
        brio_rgb c = brio_map_colour((float)w[0] * f->value[0] + (float)w[1] * f->value[1] + (float)w[2] * f->value[2]);
        for (int x = 0; x < 3; x++) colour[x] = c.c[x];
    }
    size = sqrtf(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int x = 0; x < 3 && size > 0; x++) n[x] /= size;
    float light = light_on(n);
    for (int k = 0; k < 3; k++)
        if (f->drawn >> (k + 1) % 3 & 1 && (float)w[k] * f->height[k] < EDGE_LINE * BRIO_SAMPLES) light *= 0.45F;
    return lit(colour, light);
}

static void draw_triangle(band *b, const brio_drawn_mesh *d, size_t t) {
    static const double INSIDE = -1e-9; /* samples on an edge belong to both of its triangles */
    const uint32_t *corner = d->shapes.corner[t];
    double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
    for (int k = 0; k < 3; k++)
        for (int x = 0; x < 2; x++) {
            double at = d->place[corner[k]][x];
            low[x] = at < low[x] ? at : low[x];
            high[x] = at > high[x] ? at : high[x];
        }
    int x0, x1, y0, y1;
    between(low[1], high[1], b->from, b->to, &y0, &y1);
    if (y0 >= y1) return;
    between(low[0], high[0], 0, b->width, &x0, &x1);
    facet f;
    if (x0 >= x1 || !set_up(d, t, &f)) return;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            double w[3], px = x + 0.5, py = y + 0.5;
            for (int k = 0; k < 2; k++) {
                const double *a = f.p[(k + 1) % 3], *c = f.p[(k + 2) % 3];
                w[k] = ((c[0] - a[0]) * (py - a[1]) - (c[1] - a[1]) * (px - a[0])) / f.twice;
            }
            w[2] = 1 - w[0] - w[1];
            if (w[0] < INSIDE || w[1] < INSIDE || w[2] < INSIDE) continue;
            double z = w[0] * f.p[0][2] + w[1] * f.p[1][2] + w[2] * f.p[2][2];
            point_of_band *s = b->at + (size_t)(y - b->from) * (size_t)b->width + x;
            if ((float)z > s->z) put(b, x, y, z, colour_at(&f, w));
        }
}

/* --- lines and discs --- */

static void draw_line(band *b, const brio_drawn_mesh *d, size_t i) {
    const double *p = d->place[d->shapes.end[i][0]], *q = d->place[d->shapes.end[i][1]];
    brio_line_kind kind = (brio_line_kind)d->shapes.kind[i];
    const double line = d->shapes.num_triangles ? LINE_ON_FACES : LINE;
    const double half = BRIO_SAMPLES * (kind == BRIO_LINE_EDGE ? line : MARK), dx = q[0] - p[0], dy = q[1] - p[1];
    const double square = dx * dx + dy * dy;
    double ends[2][3];
    float colour[2][3];
    int x0, x1, y0, y1;
    between(fmin(p[1], q[1]) - half, fmax(p[1], q[1]) + half, b->from, b->to, &y0, &y1);
    for (int k = 0; k < 2; k++) colour_of(&d->paint, d->paint.of_faces ? 0 : d->shapes.end[i][k], colour[k]);
    for (int k = 0; k < 3; k++) ends[0][k] = p[k], ends[1][k] = q[k];
    for (int y = y0; y < y1; y++) {
        double middle = y + 0.5, left = fmin(p[0], q[0]) - half, right = fmax(p[0], q[0]) + half;
        if (fabs(dy) > 1e-6) { /* the strip about the line, in this row */
            double at = p[0] + (middle - p[1]) / dy * dx, wide = half * sqrt(square) / fabs(dy);
            left = fmax(left, at - wide);
            right = fmin(right, at + wide);
        }
        between(left, right, 0, b->width, &x0, &x1);
        for (int x = x0; x < x1; x++) {
            double u = x + 0.5 - p[0], v = middle - p[1], t = square > 0 ? (u * dx + v * dy) / square : 0;
            t = t < 0 ? 0 : t > 1 ? 1 : t;
            double fx = u - t * dx, fy = v - t * dy;
            if (fx * fx + fy * fy > half * half) continue;
            brio_rgb c = kind == BRIO_LINE_EDGE ? lit(colour[t > 0.5], d->paint.rgb || d->paint.value ? 1 : b->line)
                                                : KINDS[kind];
            put(b, x, y, (1 - t) * ends[0][2] + t * ends[1][2] + NEARER * BRIO_SAMPLES, c);
        }
    }
}

/* Draws a vertex as a ball, darker towards its rim; one with a normal has the light of that. */
static void draw_disc(band *b, const brio_drawn_mesh *d, size_t v) {
    const double *p = d->place[v], r = d->radius;
    int x0, x1, y0, y1;
    between(p[1] - r, p[1] + r, b->from, b->to, &y0, &y1);
    if (y0 >= y1) return;
    between(p[0] - r, p[0] + r, 0, b->width, &x0, &x1);
    float colour[3], light = d->normal ? 0.35F + 0.65F * fabsf(d->normal[v][2]) : 1;
    colour_of(&d->paint, d->paint.of_faces ? 0 : v, colour);
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            double u = x + 0.5 - p[0], w = y + 0.5 - p[1], rest = r * r - u * u - w * w;
            if (rest < 0) continue;
            double high = sqrt(rest);
            put(b, x, y, p[2] + high, lit(colour, light * (float)(0.72 + 0.28 * high / r)));
        }
}

/* --- bands --- */

typedef struct {
    const brio_drawn_mesh *drawn;
    size_t count;
    const brio_raster *out;
    point_of_band **room; /* of each thread */
    int rows;
} work;

/* Writes the means of the samples as pixels. */
static void resolve(const band *b, const brio_raster *out, int first, int end) {
    for (int y = first; y < end; y++)
        for (int x = 0; x < out->width; x++)
            for (int k = 0; k < 3; k++) {
                int sum = 0;
                for (int i = 0; i < BRIO_SAMPLES * BRIO_SAMPLES; i++) {
                    int row = (y - first) * BRIO_SAMPLES + i / BRIO_SAMPLES;
                    sum += b->at[(size_t)row * (size_t)b->width + (size_t)(x * BRIO_SAMPLES + i % BRIO_SAMPLES)]
                               .colour.c[k];
                }
                out->pixels[3 * ((size_t)y * (size_t)out->width + (size_t)x) + (size_t)k] =
                    (uint8_t)((sum + BRIO_SAMPLES * BRIO_SAMPLES / 2) / (BRIO_SAMPLES * BRIO_SAMPLES));
            }
}

static void draw_band(const work *w, size_t i, point_of_band *room) {
    int first = (int)i * w->rows, end = first + w->rows < w->out->height ? first + w->rows : w->out->height;
    band b = {room, w->out->width * BRIO_SAMPLES, first * BRIO_SAMPLES, end * BRIO_SAMPLES,
              w->out->background.c[0] > 127 ? 0.5F : 1};
    const point_of_band nothing = {-INFINITY, w->out->background};
    for (size_t k = 0; k < (size_t)b.width * (size_t)(b.to - b.from); k++) room[k] = nothing;
    for (size_t m = 0; m < w->count; m++) {
        const brio_drawn_mesh *d = w->drawn + m;
        for (size_t t = 0; t < d->shapes.num_triangles; t++) draw_triangle(&b, d, t);
        for (size_t l = 0; l < d->shapes.num_lines; l++) draw_line(&b, d, l);
        for (size_t v = 0; v < d->mesh->num_vertices && d->shapes.discs; v++) draw_disc(&b, d, v);
    }
    resolve(&b, w->out, first, end);
}

static void draw_bands(void *user, size_t begin, size_t end, int thread) {
    const work *w = user;
    for (size_t i = begin; i < end; i++) draw_band(w, i, w->room[thread]);
}

brio_status brio_raster_draw(brio_context *ctx, const brio_drawn_mesh *drawn, size_t count, brio_raster *out) {
    brio_status status = BRIO_OK;
    int rows = out->height / BANDS, threads;
    rows = rows < ROWS ? ROWS : rows > MOST_ROWS ? MOST_ROWS : rows;
    size_t bands = ((size_t)out->height + (size_t)rows - 1) / (size_t)rows;
    size_t size = (size_t)rows * BRIO_SAMPLES * BRIO_SAMPLES * (size_t)out->width;
    work w = {drawn, count, out, NULL, rows};
    threads = brio_threads(ctx, bands, 1);
    BRIO_TRY(BRIO_ALLOC_ZERO(ctx, w.room, (size_t)threads));
    for (int i = 0; i < threads; i++) BRIO_TRY(BRIO_ALLOC(ctx, w.room[i], size));
    BRIO_TRY(brio_for_chunks(ctx, threads, bands, 1, draw_bands, &w));
done:
    for (int i = 0; w.room && i < threads; i++) brio_release(ctx, w.room[i]);
    brio_release(ctx, w.room);
    return status;
}
