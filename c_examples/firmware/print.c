#include "print.h"

#include "board.h"

void print_text(const char *text)
{
    board_print(text);
}

void print_integer(uint32_t value)
{
    char digits[11];
    int at = sizeof digits - 1;
    digits[at] = 0;
    do {
        digits[--at] = (char)('0' + value % 10);
        value /= 10;
    } while (value > 0);
    board_print(digits + at);
}

void print_decimal(float value)
{
    if (value < 0) {
        board_print("-");
        value = -value;
    }
    const uint32_t hundredths = (uint32_t)(value * 100 + 0.5f);
    print_integer(hundredths / 100);
    board_print(hundredths % 100 < 10 ? ".0" : ".");
    print_integer(hundredths % 100);
}
