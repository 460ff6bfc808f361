// Text for people.
#pragma once

#include <string>

// printf into a string.
std::string text(const char *format, ...) __attribute__((format(printf, 1, 2)));
