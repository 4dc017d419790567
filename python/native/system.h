/* What the module asks of the system: a file for POSIX, one for Windows. */
#ifndef BRIO_PYTHON_SYSTEM_H
#define BRIO_PYTHON_SYSTEM_H

#include <stddef.h>

/* Returns the seconds since some moment, by a clock that nobody sets. */
double seconds_now(void);

/* Returns the number of this process. */
long process_now(void);

/* Memory for a copy: of large ones in large pages, where the system has them, since clearing small ones costs more than
 * copying. Returns NULL if there is none. */
void *place_new(size_t bytes);
void place_free(void *place);

#endif
