// Several pictures: each by itself, and a table of them all.
#pragma once

#include "photo/options.hpp"

#include <functional>

// Runs the program's body for each of the pictures, in processes of their own, as many at once as there are processors: one that
// fails stops no other. Each has a folder of its name in the folder of the options, beside summary.csv. 0 where all were solved.
int run_each(const Options &options, const std::function<int(const Options &)> &body);
