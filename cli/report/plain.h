/* Texts from files and names, before they reach a terminal or a reader of JSON.
 *
 * A control is a character that a terminal obeys or that turns the order of what is shown: U+0000 to U+001F, U+007F to
 * U+009F (C1: U+009B begins a command as ESC [ does), the separators U+2028 and U+2029, and the marks of direction
 * U+202A to U+202E and U+2066 to U+2069. Bytes that are no UTF-8 count as controls: 8-bit terminals read commands in
 * them. */
#ifndef BRIO_CLI_PLAIN_H
#define BRIO_CLI_PLAIN_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

enum { NO_CHARACTER = 0xfffd }; /* U+FFFD, for a byte that begins no character of UTF-8 */

/** Returns the character at `text`, and its bytes in *length: 1 for NO_CHARACTER, which is one wrong byte. */
uint32_t cli_character(const char *text, size_t *length);

bool cli_is_control(uint32_t character);

/** Prints a text with '?' for controls and for wrong bytes. */
void cli_print_plain(FILE *out, const char *text);

/** Copies what cli_print_plain prints, as far as it fits with the 0 at the end. */
void cli_copy_plain(char *to, size_t room, const char *text);

#endif
