/* The list of commands as an array. */
#include "cli/run/commands.h"
#include <string.h>

#define COMMAND_ADDRESS(name) &cli_##name,
const command *const cli_commands[] = {COMMANDS(COMMAND_ADDRESS) NULL};

const command *cli_find_command(const char *name) {
    for (size_t i = 0; cli_commands[i]; i++)
        if (!strcmp(cli_commands[i]->name, name)) return cli_commands[i];
    return NULL;
}
