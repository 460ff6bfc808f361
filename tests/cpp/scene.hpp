// A ball that the programs beside this file solve, and how they say what is wrong.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <vector>

constexpr std::int32_t width = 96, height = 80;

inline int failures = 0;

inline void expect(bool holds, const char *what, int line)
{
    if (!holds) {
        std::printf("line %d: not %s\n", line, what);
        failures++;
    }
}
#define EXPECT(condition) expect(condition, #condition, __LINE__)

// Whether a call throws an ofc::Error of this status.
template <class Status, class Call> bool throws(Status status, Call call)
{
    try {
        call();
    } catch (const ofc::Error &error) {
        return error.status() == status && std::strcmp(error.what(), ofc_status_message(status)) == 0;
    }
    return false;
}

template <class T> bool same_bits(const T &a, const T &b)
{
    return std::memcmp(&a, &b, sizeof(T)) == 0;
}

// A ball under three lights, RGB without gaps.
inline std::vector<std::uint8_t> ball()
{
    constexpr double lights[3][3] = {{110, 15, 95}, {-65, 90, 100}, {-40, -95, 90}};
    std::vector<std::uint8_t> pixels;
    for (std::int32_t y = 0; y < height; y++)
        for (std::int32_t x = 0; x < width; x++) {
            const double p = (x - (width - 1) / 2.0) / 60, q = ((height - 1) / 2.0 - y) / 60;
            const double n[3] = {p, q, std::sqrt(1 - p * p - q * q)};
            for (const auto &light : lights)
                pixels.push_back(static_cast<std::uint8_t>(
                    std::fmax(0, light[0] * n[0] + light[1] * n[1] + light[2] * n[2])));
        }
    return pixels;
}
