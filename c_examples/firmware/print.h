/* Text on the board's output without a C library. */
#ifndef PRINT_H
#define PRINT_H

#include <stdint.h>

void print_text(const char *text);
void print_integer(uint32_t value);
/* With two decimals. */
void print_decimal(float value);

#endif
