/* Families of random solids. Each function draws one and returns its node. */
#ifndef BRIO_TESTDATA_SOLID_FAMILIES_H
#define BRIO_TESTDATA_SOLID_FAMILIES_H

#include "testdata/solid_maker.h"

typedef uint32_t (*brio_solid_family)(brio_solid_maker *m);

/* Makes an organic solid: bodies */
uint32_t brio_solid_creature(brio_solid_maker *m);
uint32_t brio_solid_bust(brio_solid_maker *m);
uint32_t brio_solid_blobs(brio_solid_maker *m);
uint32_t brio_solid_hand(brio_solid_maker *m);
uint32_t brio_solid_flower(brio_solid_maker *m);
/* Makes an organic solid: tubes */
uint32_t brio_solid_coral(brio_solid_maker *m);
uint32_t brio_solid_knot(brio_solid_maker *m);
uint32_t brio_solid_tangle(brio_solid_maker *m);
uint32_t brio_solid_snail(brio_solid_maker *m);
uint32_t brio_solid_rings(brio_solid_maker *m);
/* Makes an organic solid: sheets */
uint32_t brio_solid_vase(brio_solid_maker *m);
uint32_t brio_solid_sponge(brio_solid_maker *m);
uint32_t brio_solid_perforated(brio_solid_maker *m);
uint32_t brio_solid_mask(brio_solid_maker *m);
uint32_t brio_solid_ribbon(brio_solid_maker *m);
/* Makes a machined solid from plates and blocks */
uint32_t brio_solid_bracket(brio_solid_maker *m);
uint32_t brio_solid_housing(brio_solid_maker *m);
uint32_t brio_solid_block(brio_solid_maker *m);
uint32_t brio_solid_lever(brio_solid_maker *m);
/* Makes a machined solid: turned */
uint32_t brio_solid_shaft(brio_solid_maker *m);
uint32_t brio_solid_gear(brio_solid_maker *m);
uint32_t brio_solid_pipe(brio_solid_maker *m);
uint32_t brio_solid_wheel(brio_solid_maker *m);
uint32_t brio_solid_screw(brio_solid_maker *m);
uint32_t brio_solid_crank(brio_solid_maker *m);
uint32_t brio_solid_drum(brio_solid_maker *m);
/* Makes a machined solid: profiles and frames */
uint32_t brio_solid_profile(brio_solid_maker *m);
uint32_t brio_solid_frame(brio_solid_maker *m);
uint32_t brio_solid_sink(brio_solid_maker *m);
uint32_t brio_solid_impeller(brio_solid_maker *m);
uint32_t brio_solid_bent_sheet(brio_solid_maker *m);

#endif
