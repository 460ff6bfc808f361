/* Buffers at the end of slots of memory that nothing may touch behind. */
#include "fuzz.h"

#include <sys/mman.h>
#include <unistd.h>

enum { SLOTS = 96, ROOM = 512 * 1024, BEFORE = 64 };

struct buffer {
    uint8_t *start;
    size_t bytes;
    uint8_t *end;                   /* Of the slot: less than `alignment` bytes behind the buffer. */
    size_t row_bytes, stride, rows; /* Zero for a buffer without gaps. */
    int is_workspace;
};

static uint8_t *slots[SLOTS];
static uint8_t copies[SLOTS][ROOM];
static struct buffer buffers[SLOTS];
static size_t used;
static int refused;

static uint8_t pattern(const uint8_t *at)
{
    return (uint8_t)(0xa5 ^ ((uintptr_t)at & 0xff) * 37);
}

static void fill(uint8_t *from, const uint8_t *to)
{
    for (; from < to; from++)
        *from = pattern(from);
}

static int is_filled(const uint8_t *from, const uint8_t *to)
{
    while (from < to && *from == pattern(from))
        from++;
    return from == to;
}

static void reserve(void)
{
    const size_t page = (size_t)sysconf(_SC_PAGESIZE);
    for (size_t i = 0; i < SLOTS; i++) {
        uint8_t *slot = mmap(NULL, ROOM + 2 * page, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (slot == MAP_FAILED || mprotect(slot + page, ROOM, PROT_READ | PROT_WRITE) != 0)
            fail("no memory for buffers");
        slots[i] = slot + page;
    }
}

void memory_begin(void)
{
    if (slots[0] == NULL)
        reserve();
    used = 0;
    refused = 0;
}

void *take(size_t bytes, size_t alignment)
{
    if (used == SLOTS || bytes + BEFORE > ROOM)
        fail("the target asks for too much memory: %zu bytes, buffer %zu", bytes, used);
    uint8_t *const end = slots[used] + ROOM;
    uint8_t *const start = end - (bytes + alignment - 1) / alignment * alignment;
    fill(start - BEFORE, end);
    buffers[used++] = (struct buffer){.start = start, .bytes = bytes, .end = end};
    return start;
}

void make_dirty(void *workspace)
{
    for (size_t i = 0; i < used; i++) {
        uint8_t *const start = buffers[i].start;
        if (start != workspace)
            continue;
        const int kind = below(3);
        for (size_t at = 0; at < buffers[i].bytes; at++)
            start[at] = kind == 0 ? 0xff : kind == 1 ? 0 : (uint8_t)random_bits();
    }
}

void is_scratch(void *buffer)
{
    for (size_t i = 0; i < used; i++)
        buffers[i].is_workspace |= buffers[i].start == buffer;
}

void *workspace_of(size_t bytes)
{
    void *const start = take(bytes, OFC_WORKSPACE_ALIGNMENT);
    buffers[used - 1].is_workspace = 1;
    make_dirty(start);
    return start;
}

void *take_rows(size_t row_bytes, size_t stride, int32_t rows, size_t alignment)
{
    void *const start = take(stride * (size_t)(rows - 1) + row_bytes, alignment);
    struct buffer *const buffer = &buffers[used - 1];
    buffer->row_bytes = row_bytes;
    buffer->stride = stride;
    buffer->rows = (size_t)rows;
    return start;
}

size_t stride_of(size_t row_bytes, size_t unit)
{
    return row_bytes + (one_in(4) ? (size_t)below(12) * unit : 0);
}

void *bad_sometimes(void *pointer, size_t alignment, void *other)
{
    /* Two at once could be two that fit each other. */
    if (refused || !one_in(64))
        return pointer;
    const int kind = below(3);
    if (kind == 1 && alignment > 1) {
        refused = 1;
        return (char *)pointer + 1;
    }
    if (kind == 2 && other != NULL && (uintptr_t)other % alignment == 0) {
        refused = 1;
        return other;
    }
    refused = 1;
    return NULL;
}

void must_be_refused(void)
{
    refused = 1;
}

void call_begin(void)
{
    for (size_t i = 0; i < used; i++)
        memcpy(copies[i], buffers[i].start, buffers[i].bytes);
}

static int gaps_are_kept(const struct buffer *buffer, const uint8_t *copy)
{
    for (size_t row = 0; row + 1 < buffer->rows; row++) {
        const size_t gap = row * buffer->stride + buffer->row_bytes;
        if (memcmp(buffer->start + gap, copy + gap, buffer->stride - buffer->row_bytes) != 0)
            return 0;
    }
    return 1;
}

ofc_status call_end(const char *call, ofc_status status, void *const *written)
{
    if (refused && status >= 0)
        fail("%s took what it must refuse: %d", call, status);
    refused = 0;
    for (size_t i = 0; i < used; i++) {
        const struct buffer *const buffer = &buffers[i];
        if (!is_filled(buffer->start - BEFORE, buffer->start) || !is_filled(buffer->start + buffer->bytes, buffer->end))
            fail("%s wrote outside of buffer %zu of %zu bytes", call, i, buffer->bytes);
        int may_write = 0;
        for (void *const *one = written; *one != NULL; one++)
            may_write |= *one == buffer->start;
        if (may_write && buffer->is_workspace)
            continue;
        if (!(may_write && status >= 0) && memcmp(buffer->start, copies[i], buffer->bytes) != 0)
            fail("%s with status %d changed buffer %zu of %zu bytes", call, status, i, buffer->bytes);
        if (!gaps_are_kept(buffer, copies[i]))
            fail("%s wrote between the rows of buffer %zu", call, i);
    }
    return status;
}
