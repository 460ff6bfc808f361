#include "start.h"

#include "semihosting.h"

void start(void)
{
    const uint32_t *from = data_load;
    for (uint32_t *to = data_start; to < data_end; to++)
        *to = *from++;
    for (uint32_t *word = bss_start; word < bss_end; word++)
        *word = 0;
    board_exit(main());
}

/* Where the caller's frame ends, and the most that was in use below the top. */
static uintptr_t callers;
static uint32_t peak;

void __attribute__((noinline)) board_stack_paint(void)
{
    /* Up to a little below this function's own frame. */
    callers = (uintptr_t)__builtin_frame_address(0);
    const uintptr_t end = callers - 128;
    for (uint32_t *word = stack_bottom; (uintptr_t)word < end; word++)
        *word = STACK_PATTERN;
}

uint32_t board_stack_taken(void)
{
    const uint32_t *word = stack_bottom;
    while (word < stack_top && *word == STACK_PATTERN)
        word++;
    const uint32_t used = (uint32_t)((uintptr_t)stack_top - (uintptr_t)word);
    if (used > peak)
        peak = used;
    return (uint32_t)(callers - (uintptr_t)word);
}

uint32_t board_stack_peak(void)
{
    return peak;
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
