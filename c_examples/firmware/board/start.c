#include "start.h"

#include "semihosting.h"

void start(void)
{
    const uint32_t *from = data_load;
    for (uint32_t *to = data_start; to < data_end; to++)
        *to = *from++;
    for (uint32_t *word = bss_start; word < bss_end; word++)
        *word = 0;
    /* Up to a little below this function's own frame. */
    const uint32_t here = 0;
    const uint32_t *end = (const uint32_t *)((uintptr_t)&here - 256);
    for (uint32_t *word = stack_bottom; word < end; word++)
        *word = STACK_PATTERN;
    board_exit(main());
}

uint32_t board_stack_peak(void)
{
    const uint32_t *word = stack_bottom;
    while (word < stack_top && *word == STACK_PATTERN)
        word++;
    return (uint32_t)((uintptr_t)stack_top - (uintptr_t)word);
}

void fault(void)
{
    board_print("fault\n");
    board_exit(99);
}

void board_print(const char *text)
{
    enum { SYS_WRITE0 = 4 };
    semihosting_call(SYS_WRITE0, text);
}

void board_exit(int status)
{
    enum { SYS_EXIT_EXTENDED = 0x20, APPLICATION_EXIT = 0x20026 };
    const uintptr_t reason[2] = {APPLICATION_EXIT, (uintptr_t)status};
    for (;;)
        semihosting_call(SYS_EXIT_EXTENDED, reason);
}
