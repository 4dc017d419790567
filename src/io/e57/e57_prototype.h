/* One field of the prototype of an E57 file's points: how its numbers are stored. */
#ifndef BRIO_IO_E57_PROTOTYPE_H
#define BRIO_IO_E57_PROTOTYPE_H

#include "io/e57/e57_xml.h"

enum { BRIO_E57_REASON = 160 };

/** Reads what the attributes of a field say. Returns false, with the reason, if they are wrong.
 *  attributes  names and values by turns, ended by NULL. */
bool brio_e57_field_read(brio_e57_field *field, const char *const *attributes, char reason[BRIO_E57_REASON]);

#endif
