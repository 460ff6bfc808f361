/* What a program without operating system and C library gets from its board. Each board calls main(), and ends with what
 * it returns. */
#ifndef BOARD_H
#define BOARD_H

#include <stdint.h>

void board_print(const char *text);

/* Ends the program; does not return. */
void board_exit(int status);

/* Instructions since the start, where the emulator counts them (-icount shift=0). On a real board this is time: a tick of
 * the system timer, or a cycle. */
uint64_t board_instructions(void);

/* Before a call whose stack is to be measured: paints what is free. */
void board_stack_paint(void);

/* After it: the bytes of stack it took, below the frame of its caller. */
uint32_t board_stack_taken(void);

/* The most bytes of stack that have been in use at once, as far as was measured. */
uint32_t board_stack_peak(void);

#endif
