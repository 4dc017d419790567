/* Tags of an XML file, read one after the other. Text between tags is skipped, unless the caller reads it from the
 * stream.
 *
 * All functions that return a status return BRIO_OK, BRIO_ERR_OPEN, BRIO_ERR_FORMAT, BRIO_ERR_NO_MEMORY or
 * BRIO_ERR_CANCELLED. */
#ifndef BRIO_IO_XML_TAG_H
#define BRIO_IO_XML_TAG_H

#include "io/stream.h"

enum { BRIO_XML_VALUE = 64 }; /* bytes of the value of an attribute, with the 0 at its end; the rest is cut off */

/** Skips to the next `mark`. Fails if there is none.   expected  what the mark announces, for the message. */
brio_status brio_xml_skip_to(brio_stream *s, char mark, const char *expected);

/** Returns the next tag in *tag, without < and >, with a 0 at its end. It is valid until the next call with the stream.
 *  Fails if there is none.   expected  the tag that the caller waits for, for the message. */
brio_status brio_xml_next_tag(brio_stream *s, const char *expected, const char **tag);

/** Returns whether the tag has this name. That of an end tag begins with a slash. */
bool brio_xml_is(const char *tag, const char *name);
/** Returns whether the tag ends its element: <name/>. */
bool brio_xml_is_empty(const char *tag);

/** Copies the value of an attribute of a tag. Returns false if the tag has no such attribute. */
bool brio_xml_attribute(const char *tag, const char *name, char value[BRIO_XML_VALUE]);
/** Returns whether an attribute has this value. */
bool brio_xml_attribute_is(const char *tag, const char *name, const char *value);
/** Reads an attribute that is a number. Fails if the tag has no such attribute, or one of 2^63 or more, which
 *  no file has, so that sums of two have room. */
brio_status brio_xml_count(brio_stream *s, const char *tag, const char *name, uint64_t *count);

/** Returns the error of a place, which it names, where something else was expected. */
brio_status brio_xml_bad(brio_stream *s, const char *expected);

#endif
