/* Lines of text for the examples, without the C library. */
#ifndef PRINT_H
#define PRINT_H

#include <stdint.h>

#include "platform.h"

/* First value of `digest`. */
#define DIGEST_BEGIN 2166136261u

static inline void print_hexadecimal(uint32_t number) {
  char text[9];
  unsigned int i;
  for (i = 0u; i < 8u; i++) {
    uint32_t nibble = (number >> (28u - 4u * i)) & 15u;
    text[i] = (char)(nibble < 10u ? '0' + (char)nibble : 'a' + (char)(nibble - 10u));
  }
  text[8] = '\0';
  platform_write(text);
}

static inline void print_number(uint32_t number) {
  char text[11];
  unsigned int i = 10u;
  text[10] = '\0';
  do {
    i--;
    text[i] = (char)('0' + (char)(number % 10u));
    number /= 10u;
  } while (number > 0u);
  platform_write(&text[i]);
}

static inline void print_line(const char *name, uint32_t count, uint32_t bits) {
  platform_write(name);
  platform_write(" ");
  print_number(count);
  platform_write(" bits ");
  print_hexadecimal(bits);
  platform_write("\n");
}

/* Adds the bytes of memory to a digest (FNV-1a). */
static inline uint32_t digest(uint32_t sum, const void *memory, uint32_t size) {
  const unsigned char *bytes = (const unsigned char *)memory;
  uint32_t i;
  for (i = 0u; i < size; i++) {
    sum = (sum ^ bytes[i]) * 16777619u;
  }
  return sum;
}

#endif
