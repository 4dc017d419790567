/* Translates of points: the vertices of a periodic triangulation.
 *
 * I1  Image i < num_points is the translate of point i in the domain, with the shift 0.
 * I2  Shifts are in the reduced basis of the lattice, relative to the domain. No two images are equal. */
#ifndef BRIO_PERIODIC_IMAGES_H
#define BRIO_PERIODIC_IMAGES_H

#include "periodic/lattice.h"

typedef struct brio_images {
    brio_context *ctx;
    const brio_lattice *lattice;
    size_t num_points, count, capacity;
    brio_image *list; /* I1, I2 */
    double (*x)[3];   /* #count: positions, relative to the lattice's origin */
    double *weight;   /* #count, or NULL */
    uint32_t *slot;   /* hash table of the images behind the points: one more than the image, 0 is empty */
    size_t num_slots, num_entered;
} brio_images;

/** Makes the images of the points alone.   home  #points.   weights  #points, or NULL.
 *  Returns BRIO_OK or BRIO_ERR_NO_MEMORY; freed with brio_images_free in any case. */
brio_status brio_images_new(brio_context *ctx, const brio_lattice *lattice, const double (*home)[3],
                            const double *weights, size_t num_points, brio_images *images);
void brio_images_free(brio_images *images);

/** Makes a copy, to which images can be added.   lattice  of the copy.   Errors as above; freed as above. */
brio_status brio_images_copy(brio_context *ctx, const brio_images *from, const brio_lattice *lattice, brio_images *to);

/** Appends images, of which brio_images_set says which they are.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY,
 *  BRIO_ERR_TOO_LARGE. */
brio_status brio_images_extend(brio_images *images, size_t more);

/** Sets image i behind the points. Threads may set images at once. */
void brio_images_set(brio_images *images, size_t i, uint32_t point, const int32_t shift[3]);

/** Appends an image that is not in the list.   Returns BRIO_OK, BRIO_ERR_NO_MEMORY, BRIO_ERR_TOO_LARGE. */
brio_status brio_images_add(brio_images *images, uint32_t point, const int32_t shift[3]);

/** Finds the index of an image, and appends the image where the list does not have it. */
brio_status brio_images_find(brio_images *images, uint32_t point, const int32_t shift[3], uint32_t *index);

/** Returns the point of which an image is a translate. */
static inline uint32_t brio_images_point(const brio_images *m, uint32_t image) {
    return image < m->num_points ? image : m->list[image].point;
}

/** Returns the lexicographic order of two images: -1, 0 or 1. */
static inline int brio_images_compare(const brio_images *m, uint32_t a, uint32_t b) {
    for (int k = 0; k < 3; k++)
        if (m->x[a][k] != m->x[b][k]) return m->x[a][k] < m->x[b][k] ? -1 : 1;
    return 0;
}

/** Returns the slot of the lexicographically least finite vertex of a tetrahedron, leaving out slot `but` (4: none). */
static inline int brio_images_least(const brio_images *m, const uint32_t vertex[4], int but) {
    int least = -1;
    for (int i = 0; i < 4; i++) {
        if (i == but || vertex[i] == BRIO_INFINITE) continue;
        if (least < 0 || brio_images_compare(m, vertex[i], vertex[least]) < 0) least = i;
    }
    return least;
}

#endif
