/* What the fuzz targets share: bytes that become arguments, memory between guards, pictures, and what is asked of outputs.
 *
 * A target turns the bytes of libFuzzer into calls. Bytes that are used up read as zero, and zero is always the plain choice, so short
 * inputs are plain calls. Whatever breaks the contract of the header ends the program by fail(). */
#ifndef FUZZ_H
#define FUZZ_H

#include <float.h>
#include <math.h>
#include <ofc.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

_Noreturn void fail(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* ---- bytes.c: arguments ----------------------------------------------------------------------------------------- */

void bytes_begin(const uint8_t *data, size_t size);
size_t bytes_left(void);
uint8_t byte(void);
uint32_t word32(void);
uint64_t word64(void);
/* A number below `limit`, which is at most 256. */
int below(int limit);
/* Whether something rare happens, once in about `n` times. */
int one_in(int n);
/* Numbers of any bits, most of them from the ends of ranges. */
int32_t any_int(void);
double any_double(void);
float any_float(void);
/* A plain number from `low` to `high`, and once in a while any. */
double some_double(double low, double high);
/* Random numbers that cost no bytes: of 64 bits, and in [0, 1). */
void random_begin(uint64_t seed);
uint64_t random_bits(void);
double random_unit(void);
/* Overwrites a few numbers of a struct, more often none. */
void change_some(void *object, size_t bytes);
void change(void *object, size_t bytes, int times);

/* ---- memory.c: buffers ------------------------------------------------------------------------------------------ */

/* Forgets all buffers. */
void memory_begin(void);
/* So many bytes, aligned so, with memory right behind them that cannot be touched. */
void *take(size_t bytes, size_t alignment);
#define TAKE(type, count) ((type *)take(sizeof(type) * (size_t)(count), _Alignof(type)))
/* A workspace: a refused call may write to it, and what it holds before a call does not matter. */
void *workspace_of(size_t bytes);
void make_dirty(void *workspace);
/* The same of a buffer that was taken. */
void is_scratch(void *buffer);
/* A buffer of rows with gaps that no call may write. */
void *take_rows(size_t row_bytes, size_t stride, int32_t rows, size_t alignment);
/* A stride of at least a row, a multiple of `unit`. */
size_t stride_of(size_t row_bytes, size_t unit);

/* The pointer, or rarely one that must be refused: null, misaligned or, with `other`, one that overlaps. */
void *bad_sometimes(void *pointer, size_t alignment, void *other);
#define BAD(pointer, other) bad_sometimes((void *)(pointer), _Alignof(__typeof__(*(pointer))), other)
/* The next call must be refused. */
void must_be_refused(void);

/* Makes a call that may write the buffers that are named: checks that it writes nothing else, nothing outside of any buffer, and on a
 * refusal nothing but workspaces. */
void call_begin(void);
ofc_status call_end(const char *call, ofc_status status, void *const *written);
#define CALL(call, ...) (call_begin(), call_end(#call, (call), (void *const[]){__VA_ARGS__ __VA_OPT__(, ) NULL}))

/* ---- pictures.c ------------------------------------------------------------------------------------------------- */

struct picture {
    ofc_image *image;
    int32_t width, height; /* What its memory holds, whatever the struct says. */
    int bad;               /* Whether the struct must be refused. */
};

/* A picture of sides up to these. */
struct picture picture_of(int max_width, int max_height);
/* A picture of this very size. */
struct picture picture_sized(int32_t width, int32_t height);
/* What each pixel of a format takes. */
size_t pixel_bytes(ofc_pixel_format format);
size_t sample_bytes(ofc_pixel_format format);
/* A test for inliers: none (NULL), one that accepts all, or one of any numbers. */
ofc_inlier_test *any_inlier_test(void);
/* Keeps the time of a fit short. 0 where it cannot. */
int shorten(ofc_lmeds_params *params);

/* ---- outputs.c: what outputs must hold ---------------------------------------------------------------------------- */

void all_finite(const char *what, const double *numbers, size_t count);
/* Finite or the one NaN of the header. */
void finite_or_nan(const char *what, const double *numbers, size_t count);
void floats_finite(const char *what, const float *numbers, size_t count);
void floats_finite_or_nan(const char *what, const float *numbers, size_t count);
/* Unit normals, or zeros for none. */
void unit_normals(const char *what, const float *normals, size_t stride, int32_t width, int32_t height);
void check_fit(const char *what, const ofc_color_fit *fit);
void check_inlier_test(const char *what, const ofc_inlier_test *test);
void check_solution(const char *what, const ofc_solution *solution, ofc_status status);

/* The doubles of a struct from one field to before another. */
#define DOUBLES(object, first, end)                                                                                    \
    (const double *)((const char *)(object) + offsetof(__typeof__(*(object)), first)),                                 \
        (offsetof(__typeof__(*(object)), end) - offsetof(__typeof__(*(object)), first)) / sizeof(double)

/* ---- the target ------------------------------------------------------------------------------------------------- */

/* One input. */
void target(void);

#endif
