/* From the address of a unit's resources to the path of a file in them. */
#ifndef RESOURCE_PATH_H
#define RESOURCE_PATH_H

#include <stddef.h>

/* Write the path of `name` below `location`, a file URI (RFC 8089) or a plain path; 0, or 1 if it is too long. */
int resource_path(const char *location, const char *name, char *path, size_t size);

#endif
