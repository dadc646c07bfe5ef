/* commands.h - the commands of the program that need no script. Each returns the exit code. */
#ifndef CLI_COMMANDS_H
#define CLI_COMMANDS_H

#include "options.h"

/* For each file a block on standard output: sizes, and what is right and wrong. Surfaces by sn_mesh_check,
 * tet meshes by their parts and volumes. A file that cannot be read is named on standard error, and the rest
 * go on. */
int cli_info(const cli_options *o);

/* Compares two pictures: max, count and rmse of the differences, then "equal" or "differs". Pictures of
 * different sizes differ. */
int cli_compare(const cli_options *o);

#endif
