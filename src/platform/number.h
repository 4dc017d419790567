/* Numbers of text in the locale of C, whatever that of the process is. */
#ifndef BRIO_PLATFORM_NUMBER_H
#define BRIO_PLATFORM_NUMBER_H

/** Returns the number that a text begins with, correctly rounded; its decimal mark is a point. */
double brio_number_of_text(const char *text);

#endif
