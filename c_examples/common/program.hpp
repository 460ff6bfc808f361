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

// Runs a program's body and returns the exit status: its own, 2 for a UsageError, 1 for any other exception.
int guarded(const char *program, const std::function<int()> &body);

// Makes the folder for the results, or throws UsageError.
void make_folder(const std::filesystem::path &folder);

// Tells the user where the results are, and which of them to look at first.
void say_where(const std::filesystem::path &folder, const char *first);

void write_json(const std::filesystem::path &path, const nlohmann::json &report);
