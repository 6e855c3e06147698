/* What runs before main, and output to the emulator (Arm semihosting). */
#include "board.h"

#include <stdint.h>
#include <string.h>

enum { WRITE0 = 0x04, EXIT_EXTENDED = 0x20, APPLICATION_EXIT = 0x20026 };

extern char bss_start, bss_end, data_start, data_end, data_in_flash;
extern uint32_t stack_end;

int main(void);

static void call_host(uintptr_t operation, const void *argument)
{
  register uintptr_t r0 __asm__("r0") = operation;
  register const void *r1 __asm__("r1") = argument;
  __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void print(const char *text)
{
  call_host(WRITE0, text);
}

static void stop(int code)
{
  const uint32_t arguments[2] = {APPLICATION_EXIT, (uint32_t)code};
  call_host(EXIT_EXTENDED, arguments);
  for (;;) {
  }
}

void reset(void)
{
  memcpy(&data_start, &data_in_flash, (size_t)(&data_end - &data_start));
  memset(&bss_start, 0, (size_t)(&bss_end - &bss_start));
  stop(main());
}

static void fault(void)
{
  print("fault\n");
  stop(99);
}

__attribute__((section(".vectors"), used)) static const void *const vectors[16] = {
  &stack_end, (void *)reset, (void *)fault, (void *)fault};
