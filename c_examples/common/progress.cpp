#include "common/progress.hpp"

#include <cstdio>
#include <unistd.h>

Progress::Progress() : is_terminal(isatty(STDERR_FILENO) == 1) {}

void Progress::stage(const std::string &what)
{
    if (!is_terminal)
        return;
    clear();
    std::fprintf(stderr, "%s ...", what.c_str());
    std::fflush(stderr);
    is_shown = true;
}

void Progress::clear()
{
    if (is_shown)
        std::fputs("\r\033[K", stderr);
    is_shown = false;
}
