/* A Linux process without a C library: its first instruction, and two system calls. */
#include "board.h"

#include <stddef.h>

int main(void);

static long system_call(long number, long a, long b, long c)
{
#if defined(__x86_64__)
    long result;
    __asm__ volatile("syscall" : "=a"(result) : "a"(number), "D"(a), "S"(b), "d"(c) : "rcx", "r11", "memory");
    return result;
#elif defined(__aarch64__)
    register long x8 __asm__("x8") = number;
    register long x0 __asm__("x0") = a;
    register long x1 __asm__("x1") = b;
    register long x2 __asm__("x2") = c;
    __asm__ volatile("svc 0" : "+r"(x0) : "r"(x8), "r"(x1), "r"(x2) : "memory");
    return x0;
#elif defined(__arm__)
    register long r7 __asm__("r7") = number;
    register long r0 __asm__("r0") = a;
    register long r1 __asm__("r1") = b;
    register long r2 __asm__("r2") = c;
    __asm__ volatile("svc 0" : "+r"(r0) : "r"(r7), "r"(r1), "r"(r2) : "memory");
    return r0;
#endif
}

#if defined(__x86_64__)
enum { WRITE = 1, EXIT = 60 };
__asm__(".globl _start\n_start: xor %ebp, %ebp\nand $-16, %rsp\ncall run\n");
#elif defined(__aarch64__)
enum { WRITE = 64, EXIT = 93 };
__asm__(".globl _start\n_start: bl run\n");
#elif defined(__arm__)
enum { WRITE = 4, EXIT = 1 };
__asm__(".globl _start\n_start: bl run\n");
#else
#error "no system calls for this target"
#endif

void board_print(const char *text)
{
    size_t length = 0;
    while (text[length] != 0)
        length++;
    for (long written; length > 0; text += written, length -= (size_t)written) {
        written = system_call(WRITE, 1, (long)(intptr_t)text, (long)length);
        if (written <= 0)
            board_exit(98);
    }
}

void board_exit(int status)
{
    for (;;)
        system_call(EXIT, status, 0, 0);
}

void run(void);
void run(void)
{
    board_exit(main());
}
