/* What the examples need of the machine: a place for text. */
#ifndef PLATFORM_H
#define PLATFORM_H

#ifdef __cplusplus
extern "C" {
#endif

/* Writes a text that ends with a zero. */
void platform_write(const char *text);

#ifdef __cplusplus
}
#endif

#endif
