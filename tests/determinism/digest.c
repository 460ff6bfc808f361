#include "digest.h"

#include "board.h"

#define EMPTY 0xcbf29ce484222325u

static uint64_t hash = EMPTY;
static uint32_t numbers;

static void mix(uint64_t bits, int bytes)
{
#ifdef CONTROL /* a negative control: one bit of one number in each group is another */
    bits ^= numbers == CONTROL;
#endif
    for (int i = 0; i < bytes; i++)
        hash = (hash ^ (bits >> (8 * i) & 0xff)) * 0x100000001b3u;
    numbers++;
}

void digest_print(const char *name)
{
    char line[] = "................ .......... ";
    for (int i = 0; i < 16; i++)
        line[i] = "0123456789abcdef"[hash >> (60 - 4 * i) & 15];
    for (int i = 26; i > 16; i--, numbers /= 10)
        line[i] = numbers > 0 ? (char)('0' + numbers % 10) : ' ';
    board_print(line);
    board_print(name);
    board_print("\n");
    hash = EMPTY;
}

void mix_integer(uint64_t value)
{
    mix(value, 8);
}

void mix_status(ofc_status status)
{
    mix((uint32_t)status, 4);
}

void mix_text(const char *text)
{
    for (; *text != 0; text++)
        mix((uint8_t)*text, 1);
}

void mix_doubles(const double *values, int count)
{
    for (int i = 0; i < count; i++) {
        const union {
            double value;
            uint64_t bits;
        } number = {values[i]};
        mix(number.bits, 8);
    }
}

void mix_floats(const float *values, int count)
{
    for (int i = 0; i < count; i++) {
        const union {
            float value;
            uint32_t bits;
        } number = {values[i]};
        mix(number.bits, 4);
    }
}

void mix_bytes(const uint8_t *values, int count)
{
    for (int i = 0; i < count; i++)
        mix(values[i], 1);
}

void mix_shorts(const uint16_t *values, int count)
{
    for (int i = 0; i < count; i++)
        mix(values[i], 2);
}

void mix_words(const uint32_t *values, int count)
{
    for (int i = 0; i < count; i++)
        mix(values[i], 4);
}
