#include "fuzz.h"

#include <stdarg.h>
#include <stdio.h>

static const uint8_t *next;
static size_t left;
static uint64_t state;

void fail(const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    fputs("FINDING: ", stderr);
    vfprintf(stderr, format, arguments);
    fputc('\n', stderr);
    va_end(arguments);
    abort();
}

void bytes_begin(const uint8_t *data, size_t size)
{
    next = data;
    left = size;
    random_begin(0);
}

size_t bytes_left(void)
{
    return left;
}

uint8_t byte(void)
{
    if (left == 0)
        return 0;
    left--;
    return *next++;
}

uint32_t word32(void)
{
    uint32_t word = byte();
    for (int i = 0; i < 3; i++)
        word = word << 8 | byte();
    return word;
}

uint64_t word64(void)
{
    const uint64_t high = word32();
    return high << 32 | word32();
}

int below(int limit)
{
    return byte() % limit;
}

int one_in(int n)
{
    return byte() >= 256 - 256 / n;
}

int32_t any_int(void)
{
    static const int32_t numbers[] = {0,  1,   -1,  2,    3,    4,         5,         7,        8,     12,       16,
                                      24, 32,  64,  100,  500,  1000,      2000,      10000,    65535, 65536,    1024,
                                      1025, 2, -2, 46341, 23170, INT32_MAX, INT32_MIN, 10000000, 10000001, 1000000, 1000001};
    const uint8_t kind = byte();
    if (kind < 200)
        return numbers[kind % (sizeof numbers / sizeof *numbers)];
    if (kind < 232)
        return (int8_t)byte();
    return (int32_t)word32();
}

double any_double(void)
{
    static const double numbers[] = {0,      1,        -1,     0.5,        NAN,        INFINITY,    -INFINITY,  -0.0,
                                     5e-324, 2.2e-308, 1e-300, 1e300,      DBL_MAX,    -DBL_MAX,    1e-38,      1e-45,
                                     3.4e38, -3.4e38,  1e38,   1e-30,      1e30,       255,         65535,      1e6,
                                     1e-6,   1e-16,    1e-3,   3.14159265358979, 1.5707963267948966, 0.9999999999999999, 1e100, 1e-100,
                                     1e154,  1e-154,   1e19,   2147483648.0};
    const uint8_t kind = byte();
    if (kind < 190)
        return numbers[kind % (sizeof numbers / sizeof *numbers)];
    if (kind < 220) {
        const uint64_t bits = word64();
        double number;
        memcpy(&number, &bits, sizeof number);
        return number;
    }
    const int mantissa = (int8_t)byte();
    return ldexp(mantissa / 16.0, (int8_t)byte() / (kind < 240 ? 16 : 1));
}

float any_float(void)
{
    if (byte() < 230)
        return (float)any_double();
    const uint32_t bits = word32();
    float number;
    memcpy(&number, &bits, sizeof number);
    return number;
}

double some_double(double low, double high)
{
    const uint8_t kind = byte();
    return kind >= 232 ? any_double() : low + (high - low) * (kind + byte() / 256.0) / 232;
}

void random_begin(uint64_t seed)
{
    state = seed * 0x9e3779b97f4a7c15u + 0x2545f4914f6cdd1du;
    state = state == 0 ? 1 : state;
}

uint64_t random_bits(void)
{
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return state * 0x2545f4914f6cdd1du;
}

double random_unit(void)
{
    return (double)(random_bits() >> 11) * 0x1p-53;
}

void change(void *object, size_t bytes, int times)
{
    while (times-- > 0) {
        const size_t at = byte() | (size_t)byte() << 8;
        if (byte() & 1) {
            const int32_t number = any_int();
            memcpy((char *)object + at % (bytes / sizeof number) * sizeof number, &number, sizeof number);
        } else {
            const double number = any_double();
            memcpy((char *)object + at % (bytes / sizeof number) * sizeof number, &number, sizeof number);
        }
    }
}

void change_some(void *object, size_t bytes)
{
    const uint8_t kind = byte();
    change(object, bytes, kind < 160 ? 0 : kind < 230 ? 1 : kind < 250 ? 2 : 6);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);
int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
    bytes_begin(data, size);
    memory_begin();
    target();
    return 0;
}

/* What the library would do in a panic, instead of a loop without an end: the linker puts it there. */
_Noreturn void PANIC(void);
_Noreturn void PANIC(void)
{
    fail("a panic");
}
