/* Chemical elements: symbols, atomic numbers and van der Waals radii. */
#ifndef BRIO_IO_ELEMENTS_H
#define BRIO_IO_ELEMENTS_H

#include <stddef.h>

enum { BRIO_LAST_ELEMENT = 118 };

/** Returns the atomic number of a symbol of `length` letters, in capitals or not; D and T are hydrogen. 0 if there is
 *  no such element. */
int brio_element_of(const char *symbol, size_t length);

/** Returns the van der Waals radius in angstrom of an element, 1.8 where the table has none (mostly metals) and for
 *  0. */
double brio_van_der_waals_radius(int atomic_number);

#endif
