/* A program that must not link: it calls a function that can panic. */
#include <stddef.h>
#include <stdint.h>

uint8_t fmc_can_panic(const uint8_t *elements, size_t count, size_t index);

static volatile size_t number;

int main(void) {
  static const uint8_t elements[3] = {1u, 2u, 3u};
  return fmc_can_panic(elements, number, number);
}
