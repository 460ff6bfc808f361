/* RISC-V in machine mode: the first instructions, and the counter of retired ones. */
#include "start.h"

__asm__(".section .start, \"ax\"\n"
        ".globl reset\n"
        "reset:\n"
        ".option push\n"
        ".option norelax\n"
        "la gp, __global_pointer$\n"
        ".option pop\n"
        "la sp, stack_top\n"
        "la t0, trap\n"
        "csrw mtvec, t0\n"
        "li t0, 0x2000\n" /* mstatus.FS: the floating-point unit is on */
        "csrs mstatus, t0\n"
        "csrw fcsr, zero\n"
        "j start\n"
        ".balign 4\n"
        "trap: j fault\n"
        ".previous\n");

uint64_t board_instructions(void)
{
    uint32_t high, low, again;
    do {
        __asm__ volatile("csrr %0, minstreth\ncsrr %1, minstret\ncsrr %2, minstreth"
                         : "=r"(high), "=r"(low), "=r"(again));
    } while (high != again);
    return (uint64_t)high << 32 | low;
}
