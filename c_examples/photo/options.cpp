#include "photo/options.hpp"

#include <CLI/CLI.hpp>
#include <ofc.h>

Options parse_options(int argc, char **argv)
{
    Options options;
    CLI::App app("Surface normals from one color picture of a matte, uniformly colored object under colored lights.\n"
                 "Without IMAGE it renders a scene of its own and compares with the truth.",
                 "ofc_photo");
    app.set_version_flag("--version", ofc_version_string());
    auto *image = app.add_option("IMAGE", options.image, "Color picture of 8 or 16 bits a channel (PNG, TIFF, ...)");
    app.add_option("--planes", options.planes, "Three grayscale pictures, one a light, instead of IMAGE")
        ->expected(3)
        ->type_name("R.png G.png B.png")
        ->excludes(image);
    app.add_option("--mask", options.mask, "Gray picture, 0 where pixels are to be left out")->type_name("MASK.png");
    app.add_option("--background", options.background, "The same flat surface without the object: divides by it (near lights)")
        ->type_name("BG.png");
    app.add_option("--seed", options.seed, "Seed of the random subsets (default 0)");
    app.add_option("--subsets", options.subsets, "Random subsets to draw (default: as many as needed)")
        ->check(CLI::Range(1, 10000000));
    app.add_option("--truth", options.truth, "True normals to compare with: TIFF of 3 x float32, x right, y up, z out")
        ->type_name("NORMALS.tiff");
    std::string fit = "median", report = "short", orientation = "joint";
    app.add_option("--orientation", orientation, "How F is oriented: by the joint method, or by the direct method of the paper (default: joint)")
        ->check(CLI::IsMember({"joint", "direct"}));
    app.add_option("--fit", fit, "How C is fitted: least median of squares, or least squares over every pixel (default: median)")
        ->check(CLI::IsMember({"median", "squares"}));
    app.add_flag("--save-planes", options.save_planes, "Write the channels as three gray pictures, as --planes takes them");
    app.add_option("--report", report, "What is printed: paper is Table 2 and section 5's checks (default: short)")
        ->check(CLI::IsMember({"short", "paper"}));
    options.depth.add_to(app);
    app.add_option("--out", options.out, "Folder for the results (default: out)")->type_name("DIR");
    try {
        app.parse(argc, argv);
        if (options.image.empty() && options.planes.empty() && (!options.mask.empty() || !options.truth.empty() || !options.background.empty()))
            throw CLI::RequiredError("IMAGE or --planes, to which --mask, --truth and --background belong,");
    } catch (const CLI::ParseError &error) {
        std::exit(app.exit(error) == 0 ? 0 : 2);
    }
    options.direct_method = orientation == "direct";
    options.least_squares = fit == "squares";
    options.paper_report = report == "paper";
    return options;
}
