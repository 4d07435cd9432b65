#include "resource_path.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* What follows "file:" and an authority: file:/a, file:///a and file://host/a all name /a. */
static const char *without_scheme(const char *location) {
    const char *rest = location;
    if (strncmp(rest, "file:", 5) != 0) return rest;
    rest += 5;
    if (strncmp(rest, "//", 2) == 0) {
        const char *path = strchr(rest + 2, '/');
        if (path != NULL) rest = path;
    }
    if (rest[0] == '/' && isalpha((unsigned char)rest[1]) && rest[2] == ':') rest++; /* /C:/a */
    return rest;
}

static char unescaped(const char *escape) {
    const char digits[3] = {escape[1], escape[2], '\0'};
    return (char)strtol(digits, NULL, 16);
}

int resource_path(const char *location, const char *name, char *path, size_t size) {
    const int escaped = strncmp(location, "file:", 5) == 0;
    const char *next = without_scheme(location);
    size_t length = 0;
    while (*next != '\0') {
        const int escape = escaped && next[0] == '%' && isxdigit((unsigned char)next[1]) &&
                           isxdigit((unsigned char)next[2]);
        if (length + strlen(name) + 2 >= size) return 1;
        path[length++] = escape ? unescaped(next) : *next;
        next += escape ? 3 : 1;
    }
    if (length > 0 && path[length - 1] != '/') path[length++] = '/';
    strcpy(path + length, name);
    return 0;
}
