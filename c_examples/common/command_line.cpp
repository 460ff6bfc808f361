#include "common/command_line.hpp"

#include "common/program.hpp"

#include <charconv>
#include <cmath>
#include <csignal>
#include <optional>

namespace {

// The whole text as a number, or nothing.
template <typename Number> std::optional<Number> number_of(const std::string &text)
{
    Number number = {};
    const char *const end = text.data() + text.size();
    const auto [last, failure] = std::from_chars(text.data(), end, number);
    return failure == std::errc() && last == end && !text.empty() ? std::make_optional(number) : std::nullopt;
}

} // namespace

// CLI11's own checks let NaN pass, which is neither below nor above anything, and make -1 a large number.
CLI::Validator finite_between(double low, double high)
{
    return CLI::Validator(
        [low, high](const std::string &text) {
            const auto number = number_of<double>(text);
            const bool is_within = number && std::isfinite(*number) && *number >= low && *number <= high;
            return is_within ? std::string() : text + " is not a number from " + CLI::detail::to_string(low) + " to " + CLI::detail::to_string(high);
        },
        "");
}

const CLI::Validator whole_number(
    [](const std::string &text) {
        return number_of<std::uint64_t>(text) ? std::string() : text + " is not a whole number from 0 to 2^64 - 1";
    },
    "");

const CLI::Validator not_empty([](const std::string &text) { return text.empty() ? "the name is empty" : std::string(); }, "");

CommandLine::CommandLine(const std::string &program, const std::string &purpose) : CLI::App(purpose, program)
{
    set_version_flag("--version", ofc_version_string());
    add_option("--out", out, "Folder for the results (default: out)")->check(not_empty)->type_name("DIR");
}

void CommandLine::add_seed(std::uint64_t &seed, const std::string &of)
{
    add_option("--seed", seed, "Seed of " + of + " (default: 0)")->check(whole_number)->type_name("N");
}

void CommandLine::add_pixel_pitch(double &pitch, const std::string &description, const std::string &unit)
{
    add_option("--pixel-pitch", pitch, description)->check(finite_between(1e-9, 1e9))->type_name(unit);
}

void CommandLine::parse_or_exit(int argc, char **argv, const std::function<void()> &check)
{
    // A reader that went away is an error of writing, like a disk that is full.
    std::signal(SIGPIPE, SIG_IGN);
    try {
        parse(argc, argv);
        if (check)
            check();
    } catch (const CLI::ParseError &error) {
        const bool was_asked = exit(error) == 0;
        std::exit(was_asked ? status_of_output() : 2);
    }
}

void ShadowOption::add_to(CLI::App &app)
{
    app.add_option("--shadows", choice,
                   "Pixels in the shadow of one of the lights: reject finds them by their colors and leaves them out, keep\n"
                   "does not look for them, auto rejects with the joint method and keeps with the direct one (default: auto)")
        ->check(CLI::IsMember({"auto", "reject", "keep"}));
}

void ShadowOption::apply_to(ofc_solve_params &params) const
{
    params.shadow_rejection = choice == "reject" ? OFC_SHADOW_REJECTION_ON
                              : choice == "keep" ? OFC_SHADOW_REJECTION_OFF
                                                 : OFC_SHADOW_REJECTION_AUTO;
}

std::string ShadowOption::in_words(const ofc_solve_params &params, const ofc_solution &solution) const
{
    const bool joint = params.orientation_method == OFC_ORIENTATION_JOINT && params.tilt_estimator != OFC_TILT_GIVEN;
    const std::string asked = choice == "auto" ? " (auto)" : "";
    if (choice == "keep" || (choice == "auto" && !joint))
        return "kept" + asked + ": left out no pixel for being in the shadow of a light";
    const int count = solution.pixel_counts.shadowed;
    return "rejected" + asked + ": left out " + std::to_string(count) + (count == 1 ? " pixel" : " pixels") +
           " in the shadow of a light";
}
