// Table 2, the checks of section 5, and the figures that belong to them.
#pragma once

#include "photo/result.hpp"

#include <filesystem>

// The files that write_paper_figures() writes.
constexpr const char *const paper_figures[] = {"directions.png", "curves.png", "ellipsoid.png", "channels.png"};

// Prints Table 2 and the checks of section 5 for a picture that was solved by the direct method.
void print_paper_report(const Picture &picture, const Result &direct);

// Writes Figures 1, 6(d), 6(b) and 7 for that solution.
void write_paper_figures(const std::filesystem::path &folder, const Picture &picture, const Result &direct);
