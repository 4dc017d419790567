/* What the simulated scanner scans: three linked rings that rise from a plinth, a smooth body of genus 3. */
#ifndef BRIO_TESTDATA_SCULPTURE_H
#define BRIO_TESTDATA_SCULPTURE_H

/** Negative inside, positive outside, and nowhere larger in size than the distance to the surface; smooth near the
 *  surface.   user  unused. */
double brio_sculpture(const double *p, const void *user);

/** A box that holds the sculpture with some room round it. */
void brio_sculpture_box(double low[3], double high[3]);

#endif
