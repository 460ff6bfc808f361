#include "common/command_line.hpp"

CommandLine::CommandLine(const std::string &program, const std::string &purpose) : CLI::App(purpose, program)
{
    set_version_flag("--version", ofc_version_string());
    add_option("--out", out, "Folder for the results (default: out)")->type_name("DIR");
}

void CommandLine::add_seed(std::uint64_t &seed, const std::string &of)
{
    add_option("--seed", seed, "Seed of " + of + " (default: 0)")->type_name("N");
}

void CommandLine::add_pixel_pitch(double &pitch, const std::string &description, const std::string &unit)
{
    add_option("--pixel-pitch", pitch, description)->check(CLI::Range(1e-9, 1e9))->type_name(unit);
}

void CommandLine::parse_or_exit(int argc, char **argv, const std::function<void()> &check)
{
    try {
        parse(argc, argv);
        if (check)
            check();
    } catch (const CLI::ParseError &error) {
        std::exit(exit(error) == 0 ? 0 : 2);
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
