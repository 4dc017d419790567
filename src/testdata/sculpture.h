/* The body that the simulated scanner scans: three linked rings that rise from a plinth, smooth and of genus 3. */
#ifndef BRIO_TESTDATA_SCULPTURE_H
#define BRIO_TESTDATA_SCULPTURE_H

/** Returns a value negative inside and positive outside, with magnitude at most the distance to the surface; smooth
 *  near the surface.   user  unused. */
double brio_sculpture(const double *p, const void *user);

/** Returns a box that contains the sculpture with some room round it. */
void brio_sculpture_box(double low[3], double high[3]);

#endif
