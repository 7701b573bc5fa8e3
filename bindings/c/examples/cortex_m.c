/* A Cortex-M in QEMU: start-up, and text by semihosting. On a board, the start-up of its vendor and
 * a serial line take their place. */
#include <stdint.h>

#include "platform.h"

/* Not a function: the end of the stack, of the type of the vectors. */
void stack_top(void);
extern uint32_t data_load;
extern uint32_t data_begin;
extern uint32_t data_end;
extern uint32_t bss_begin;
extern uint32_t bss_end;

int main(void);
void reset(void);
void stop(void);

/* Numbers of semihosting. */
#define SYS_OPEN 0x01
#define SYS_WRITE 0x05
#define SYS_EXIT 0x18
#define APPLICATION_EXIT 0x20026
#define RUN_TIME_ERROR 0x20023

static uint32_t semihosting(uint32_t operation, uint32_t argument) {
  register uint32_t r0 __asm__("r0") = operation;
  register uint32_t r1 __asm__("r1") = argument;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
  return r0;
}

static uint32_t length_of(const char *text) {
  uint32_t length = 0u;
  while (text[length] != '\0') {
    length++;
  }
  return length;
}

void platform_write(const char *text) {
  /* The name of the console, opened for writing: the standard output. */
  static const char console[] = ":tt";
  static uint32_t handle;
  uint32_t block[3];
  if (handle == 0u) {
    block[0] = (uint32_t)console;
    block[1] = 4u;
    block[2] = 3u;
    handle = semihosting(SYS_OPEN, (uint32_t)block);
  }
  block[0] = handle;
  block[1] = (uint32_t)text;
  block[2] = length_of(text);
  (void)semihosting(SYS_WRITE, (uint32_t)block);
}

/* Every exception ends the program with an error. */
void stop(void) {
  platform_write("stopped by an exception\n");
  (void)semihosting(SYS_EXIT, RUN_TIME_ERROR);
  for (;;) {
  }
}

void reset(void) {
  volatile uint32_t *cpacr = (volatile uint32_t *)0xE000ED88u;
  uint32_t *from = &data_load;
  uint32_t *to;
  /* Full access to the floating-point unit, before code that uses it. */
  *cpacr |= 0x00F00000u;
  __asm__ volatile("dsb\n isb" ::: "memory");
  for (to = &data_begin; to < &data_end; to++) {
    *to = *from;
    from++;
  }
  for (to = &bss_begin; to < &bss_end; to++) {
    *to = 0u;
  }
  (void)semihosting(SYS_EXIT, main() == 0 ? APPLICATION_EXIT : RUN_TIME_ERROR);
  for (;;) {
  }
}

typedef void (*handler)(void);

__attribute__((section(".vectors"), used)) static const handler vectors[16] = {
    stack_top, reset, stop, stop, stop, stop, stop, stop,
    stop,                stop,  stop, stop, stop, stop, stop, stop,
};
