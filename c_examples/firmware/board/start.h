/* What the boards share between reset and main(). The linker scripts define the symbols. */
#ifndef START_H
#define START_H

#include "board.h"

extern uint32_t data_load[], data_start[], data_end[], bss_start[], bss_end[], stack_bottom[], stack_top[];

enum { STACK_PATTERN = 0x5ac7ac7a };

int main(void);

/* Sets up memory as C expects it, and runs main(). */
void start(void);

/* Of every exception: there is no good one. */
void fault(void);

#endif
