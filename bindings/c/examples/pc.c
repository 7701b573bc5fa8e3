/* A PC: text goes to the standard output. */
#include <stdio.h>

#include "platform.h"

void platform_write(const char *text) { (void)fputs(text, stdout); }
