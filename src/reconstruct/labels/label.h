/* The label of a pole or of a tetrahedron: inner, outer, or none yet. */
#ifndef BRIO_RECONSTRUCT_LABEL_H
#define BRIO_RECONSTRUCT_LABEL_H

#include <stdint.h>

typedef enum { BRIO_LABEL_NONE = 0, BRIO_LABEL_OUTER = 1, BRIO_LABEL_INNER = 2 } brio_label;

/** Returns outer for inner, inner for all other labels. */
static inline uint8_t brio_other_label(uint8_t label) {
    return label == BRIO_LABEL_INNER ? BRIO_LABEL_OUTER : BRIO_LABEL_INNER;
}

#endif
