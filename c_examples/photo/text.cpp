#include "photo/text.hpp"

#include <cstdarg>
#include <cstdio>
#include <vector>

std::string text(const char *format, ...)
{
    va_list arguments, again;
    va_start(arguments, format);
    va_copy(again, arguments);
    std::vector<char> line(static_cast<std::size_t>(std::vsnprintf(nullptr, 0, format, again)) + 1);
    va_end(again);
    std::vsnprintf(line.data(), line.size(), format, arguments);
    va_end(arguments);
    return line.data();
}
