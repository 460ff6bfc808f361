// What every example program does.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <stdexcept>

// What the user gave does not fit: the program says so and exits with status 2.
struct UsageError : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Runs a program's body and returns the exit status: its own, 2 for a UsageError, 1 for any other exception and where standard
// output did not take all that was printed, because it is closed or full.
int guarded(const char *program, const std::function<int()> &body);

// Tells the user where the results are, and which of them to look at first.
void say_where(const std::filesystem::path &folder, const char *first);

// Ends a program whose command line asked for no more than a text: 0, or 1 where standard output did not take it.
int status_of_output();

void write_json(const std::filesystem::path &path, const nlohmann::json &report);
