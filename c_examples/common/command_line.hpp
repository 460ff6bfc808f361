// What the command lines of the programs have in common.
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <ofc.h>
#include <string>

// What numbers and names of files must be.
CLI::Validator finite_between(double low, double high);
extern const CLI::Validator whole_number; // from 0 to 2^64 - 1, in digits
extern const CLI::Validator not_empty;

// A command line with --help, --version and --out.
class CommandLine : public CLI::App {
  public:
    // The folder that --out names.
    std::string out = "out";

    CommandLine(const std::string &program, const std::string &purpose);

    // Adds --seed; `of` says what it fixes.
    void add_seed(std::uint64_t &seed, const std::string &of);

    // Adds --pixel-pitch in the unit `unit`.
    void add_pixel_pitch(double &pitch, const std::string &description, const std::string &unit);

    // Parses the arguments and runs `check`, which may throw a CLI::ParseError. Ends the program with status 0 after --help
    // and --version, and with status 2 after a message where the command line is wrong.
    void parse_or_exit(int argc, char **argv, const std::function<void()> &check = {});
};

// What becomes of colors in the shadow of one of the lights.
struct ShadowOption {
    std::string choice = "auto"; // auto, reject or keep

    // Adds --shadows.
    void add_to(CLI::App &app);

    // Sets the parameter.
    void apply_to(ofc_solve_params &params) const;

    // What a solve with these parameters did with the shadows, in a few words.
    std::string in_words(const ofc_solve_params &params, const ofc_solution &solution) const;
};
