/* The inner loops in AVX-512: eight doubles a register. */
#if defined(__x86_64__)
#include "predicates/lanes_avx512.h"

#include "triangulation/conflict_lanes.h"
#include "triangulation/sound_lanes.h"
#include "triangulation/walk_lanes.h"

/* --- what find_rows does (sound_lanes.h) ---
 *
 * Eight tetrahedra are transposed, and one instruction gathers the vertices behind a facet of each. */

_Static_assert(sizeof(brio_record) == 32 && sizeof(brio_tetrahedron) == 32, "addresses are made by shifts");

/* Writes to word[k] word k of each tetrahedron: four vertices, four mates. */
static inline void load_tetrahedra(const brio_tetrahedra *t, const uint32_t tets[LANES], __m256i word[8]) {
    __m256i r[8], pair[8], four[8];
    for (int i = 0; i < 8; i++) r[i] = _mm256_loadu_si256((const __m256i *)&t->tet[tets[i]]);
    for (int i = 0; i < 4; i++) {
        pair[2 * i] = _mm256_unpacklo_epi32(r[2 * i], r[2 * i + 1]);
        pair[2 * i + 1] = _mm256_unpackhi_epi32(r[2 * i], r[2 * i + 1]);
    }
    for (int i = 0; i < 8; i += 4)
        for (int k = 0; k < 2; k++) {
            four[i + 2 * k] = _mm256_unpacklo_epi64(pair[i + k], pair[i + k + 2]);
            four[i + 2 * k + 1] = _mm256_unpackhi_epi64(pair[i + k], pair[i + k + 2]);
        }
    for (int k = 0; k < 4; k++) {
        word[k] = _mm256_permute2x128_si256(four[k], four[k + 4], 0x20);
        word[k + 4] = _mm256_permute2x128_si256(four[k], four[k + 4], 0x31);
    }
}

/* Writes the addresses of the records of rows. */
static inline void point_to(const brio_tetrahedra *t, __m256i names, const double *out[LANES]) {
    __m512i offset = _mm512_slli_epi64(_mm512_cvtepu32_epi64(names), 5);
    _mm512_storeu_si512(out, _mm512_add_epi64(offset, _mm512_set1_epi64((long long)(intptr_t)t->record)));
}

static inline void gather_rows(const brio_tetrahedra *t, const uint32_t tets[LANES], star_rows *r) {
    __m256i word[8];
    load_tetrahedra(t, tets, word);
    __m256i last = _mm256_or_si256(_mm256_slli_epi32(_mm256_loadu_si256((const __m256i *)tets), 2),
                                   _mm256_set1_epi32(3)); /* the last facets */
    for (int s = 0; s < 4; s++) {
        __m512i mate = _mm512_cvtepu32_epi64(word[4 + s]);
        __m512i tet = _mm512_srli_epi64(mate, 2), place = _mm512_add_epi64(mate, _mm512_slli_epi64(tet, 2));
        __mmask8 ask = _mm256_cmpgt_epu32_mask(word[4 + s], last); /* what is not asked for is not loaded */
        __m256i apex = _mm512_mask_i64gather_epi32(word[0], ask, place, t->tet, 4);
        __mmask8 infinite = _mm256_cmpeq_epi32_mask(apex, _mm256_set1_epi32((int)t->infinite));
        point_to(t, word[s], r->vertex[s]);
        point_to(t, _mm256_mask_blend_epi32(infinite, apex, word[0]), r->apex[s]);
        r->asked[s] = ask & (unsigned)~infinite;
    }
}

#define WALK      walk
#define ABREAST   walk_abreast
#define ENGINE    brio_engine_avx512
#define FIND_ROWS gather_rows
#include "triangulation/engine_body.h"
#else
typedef int brio_no_avx512;
#endif
