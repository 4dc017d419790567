/* Atoms of molecules in the format of the Protein Data Bank; chemical elements: symbols, atomic numbers and van der
 * Waals radii. */
#ifndef BRIO_IO_PDB_H
#define BRIO_IO_PDB_H

#include "io/stream.h"
#include "iso/density.h"

/** Reads the atoms of the first model, each with the van der Waals radius of its element. Of alternate locations, reads
 *  those marked blank, A or 1. Leaves out water.
 *  atoms  *num_atoms atoms, owned by the caller (brio_release).
 *  Returns BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT (with file and line; also for a file without atoms),
 *  BRIO_ERR_NOT_FINITE, BRIO_ERR_NO_MEMORY, BRIO_ERR_CANCELLED. */
brio_status brio_pdb_read(brio_stream *s, brio_atom **atoms, size_t *num_atoms);

/* --- records --- */

/** Returns whether a line is ATOM or HETATM. */
bool brio_pdb_is_atom(const char *line);

/** Returns whether an atom's alternate location is blank, A or 1.   line  an atom that brio_pdb_atom took. */
bool brio_pdb_is_first_location(const char *line);

/** Reads position and element of an atom.   atomic_number  0 if the element is not known.
 *  Returns BRIO_OK, BRIO_ERR_FORMAT, BRIO_ERR_NOT_FINITE. */
brio_status brio_pdb_atom(const brio_stream *s, const char *line, double position[3], int *atomic_number);

/* --- elements --- */

enum { BRIO_LAST_ELEMENT = 118 };

/** Returns the atomic number of a symbol of `length` letters, in capitals or not; D and T are hydrogen. 0 if there is
 *  no such element. */
int brio_element_of(const char *symbol, size_t length);

/** Returns the van der Waals radius in angstrom of an element, 1.8 where the table has none (mostly metals) and for
 *  0. */
double brio_van_der_waals_radius(int atomic_number);

#endif
