/* Cortex-M4F and Cortex-M7: vectors, reset, and the system timer as a counter. */
#include "start.h"

#define CPACR (*(volatile uint32_t *)0xe000ed88u)
#define SYST_CSR (*(volatile uint32_t *)0xe000e010u)
#define SYST_RVR (*(volatile uint32_t *)0xe000e014u)
#define SYST_CVR (*(volatile uint32_t *)0xe000e018u)

enum {
    FPU_ACCESS = 0xf << 20,
    TIMER_ON_PROCESSOR_CLOCK_WITH_INTERRUPT = 7,
    TIMER_PERIOD = 0x1000000,
    /* QEMU runs the boards' clock at 25 MHz, and with -icount shift=0 an instruction takes a nanosecond. */
    INSTRUCTIONS_PER_TICK = 40
};

static volatile uint32_t periods;

void reset(void);
void reset(void)
{
    CPACR |= FPU_ACCESS;
    SYST_RVR = TIMER_PERIOD - 1;
    SYST_CVR = 0;
    SYST_CSR = TIMER_ON_PROCESSOR_CLOCK_WITH_INTERRUPT;
    __asm__ volatile("dsb\nisb" ::: "memory");
    start();
}

static void tick(void)
{
    periods++;
}

uint64_t board_instructions(void)
{
    uint32_t before, now;
    do {
        before = periods;
        now = SYST_CVR;
    } while (before != periods);
    return ((uint64_t)before * TIMER_PERIOD + (TIMER_PERIOD - 1 - now)) * INSTRUCTIONS_PER_TICK;
}

__attribute__((section(".start"), used)) static const struct {
    uint32_t *stack;
    void (*handlers[15])(void);
} vectors = {
    stack_top,
    {reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, tick},
};
