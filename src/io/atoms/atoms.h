/* What readers of atoms share: lines as words, elements, and the cell in which points repeat.
 *
 * The cell is metadata of the mesh: "cell.vectors" has the nine numbers ax ay az bx by bz cx cy cz, and "cell.periodic"
 * the letters of the directions that repeat, or "none". brio_mesh_cell reads both. */
#ifndef BRIO_IO_ATOMS_H
#define BRIO_IO_ATOMS_H

#include "io/builder.h"

/* Chosen: words of a line that are told apart. */
enum { BRIO_MOST_WORDS = 256 };

/* --- lines as words --- */

/** A line, split at its blanks: each word ends with a 0. Words behind the BRIO_MOST_WORDS-th are not there. */
typedef struct brio_words {
    char *of[BRIO_MOST_WORDS];
    size_t count;
} brio_words;

/** Splits a line, which is changed and has to stay.   comment  the character that begins a comment, or 0. */
void brio_words_split(char *line, char comment, brio_words *words);

/** Reads the next line that has a word.   Sets words->count to 0 at the end of the file.
 *  Returns BRIO_OK, and as brio_stream_line. */
brio_status brio_words_next(brio_stream *s, char comment, brio_words *words);

/** Returns the error of a line in which `what` was expected.   word  what stands there, NULL for the line's end. */
brio_status brio_word_expected(const brio_stream *s, const char *word, const char *what);

/** Reads word i of a line as a number.   what  names it in the message.   Fails unless the number is finite. */
brio_status brio_word_number(const brio_stream *s, const brio_words *words, size_t i, const char *what, double *value);

/** Reads word i of a line as a whole number from 0 to `most`. */
brio_status brio_word_count(const brio_stream *s, const brio_words *words, size_t i, const char *what, uint64_t most,
                            uint64_t *value);

/* --- elements --- */

/** Finds the element of a word: a symbol, a label such as C12 or Fe3+, or an atomic number. 0 if it is none. */
int brio_element_of_word(const char *word);

/** Adds the properties atomic_number and radius. They have to be the first properties.
 *  Returns as brio_builder_property. */
brio_status brio_atoms_plan(brio_builder *b);

/** Gives the last vertex its element.   element  0: not known. */
void brio_atoms_set_element(brio_builder *b, int element);

/* --- cells --- */

/** Makes the vectors of a cell of lengths and angles (in degrees: between b and c, c and a, a and b): a along x, b in
 *  the plane of x and y. Right angles, 60 and 120 degrees are exact. Returns false if there is no such cell. */
bool brio_cell_of_lengths(const double lengths[3], const double angles[3], double cell[9]);

/** Keeps a cell as metadata of the mesh. Vectors that are 0 do not repeat. A cell of three such vectors is none, and
 *  nothing is kept.   Returns BRIO_OK or BRIO_ERR_NO_MEMORY. */
brio_status brio_cell_keep(brio_builder *b, const double cell[9], const bool periodic[3]);

/** Returns the volume of a cell, 0 if its vectors are in a plane. */
double brio_cell_volume(const double cell[9]);

/** Writes the position that has these coordinates in the vectors of a cell.   x  may be `fraction`. */
void brio_cell_position(const double cell[9], const double fraction[3], double x[3]);

/** Returns whether the name of a space group is P1, however it is spelled. An empty name is taken for it. */
bool brio_is_p1(const char *group);

/* --- boxes of LAMMPS --- */

/** The box of a simulation. It is a cell from a corner on: tilted by xy, xz and yz, or of any vectors. */
typedef struct brio_lammps_box {
    double low[3], high[3], tilt[3]; /* xy, xz, yz */
    double vectors[9], corner[3];    /* with `general` */
    bool general;
    bool periodic[3];
} brio_lammps_box;

/** Makes the vectors of a box, and keeps them as the cell of the mesh.   cell, corner  receive them.
 *  Returns as brio_cell_keep, and BRIO_ERR_FORMAT if the box has no volume. */
brio_status brio_lammps_keep_box(const brio_stream *s, brio_builder *b, const brio_lammps_box *box, double cell[9],
                                 double corner[3]);

#endif
