#include "photo/options.hpp"

#include "photo/paper_report.hpp"

#include <algorithm>

namespace {

struct Output {
    const char *name; // as --outputs has it
    std::vector<std::string> files;
};

const std::vector<Output> all_outputs = {{"normals", {"normals.png", "normals.tiff"}}, {"uncertainty", {"uncertainty.png", "uncertainty.tiff"}},
                                         {"depth", {"depth.tiff", "depth.png"}},       {"mesh", {"mesh.ply"}},
                                         {"overview", {"overview.png"}},               {"inliers", {"inliers.png"}},
                                         {"classes", {"classes.png"}},                 {"albedo", {"albedo.png"}}};

std::vector<std::string> names_of_outputs()
{
    std::vector<std::string> names;
    for (const Output &output : all_outputs)
        names.emplace_back(output.name);
    return names;
}

void check_together(const Options &options)
{
    const bool own_scene = options.images.empty() && options.planes.empty();
    if (own_scene && (!options.mask.empty() || !options.truth.empty() || !options.background.empty()))
        throw CLI::RequiredError("IMAGE or --planes, to which --mask, --truth and --background belong,");
    if (options.light.fits_ambient() && (!options.background.empty() || options.model == "relief"))
        throw CLI::ExcludesError("--ambient fit", "--background and --model relief");
}

} // namespace

bool Options::wants(const char *output) const
{
    return outputs.empty() || std::find(outputs.begin(), outputs.end(), output) != outputs.end();
}

std::vector<std::string> Options::results() const
{
    std::vector<std::string> names;
    const auto add = [&](const auto &files) { names.insert(names.end(), std::begin(files), std::end(files)); };
    for (const Output &output : all_outputs)
        if (wants(output.name))
            add(output.files);
    if (save_planes)
        add(saved_planes);
    if (paper_report())
        add(paper_figures);
    return names;
}

std::vector<std::string> Options::inputs() const
{
    std::vector<std::string> files = {image, mask, truth, background, light.dark};
    files.insert(files.end(), planes.begin(), planes.end());
    return files;
}

ofc_solve_params Options::solve_params(ofc_orientation_method method) const
{
    ofc_solve_params params;
    ofc_solve_params_default(&params);
    params.lmeds.seed = seed;
    params.lmeds.subsets = subsets;
    params.lmeds.method = fit == "squares" ? OFC_FIT_LEAST_SQUARES : OFC_FIT_LEAST_MEDIAN;
    params.orientation_method = method;
    params.convexity = hollow ? OFC_CONVEXITY_HOLLOW : convex ? OFC_CONVEXITY_CONVEX : OFC_CONVEXITY_AUTO;
    return params;
}

ofc_relief_params Options::relief_params() const
{
    ofc_relief_params params;
    ofc_relief_params_default(&params);
    params.seed = seed;
    params.ball_radius = ball_radius;
    params.convexity = hollow ? OFC_CONVEXITY_HOLLOW : OFC_CONVEXITY_AUTO;
    return params;
}

Options parse_options(int argc, char **argv)
{
    Options options;
    CommandLine line("ofc_photo",
                     "Surface normals from one color picture of a matte, uniformly colored object under colored lights.\n"
                     "Without IMAGE it renders a scene of its own and compares with the truth.");
    auto *image = line.add_option("IMAGE", options.images,
                                  "Color picture of 8 or 16 bits or floats a channel (PNG, JPEG, TIFF, ...), or several, or folders of them:\n"
                                  "each has a folder of its own then, beside summary.csv");
    image->expected(1, -1)->check(not_empty);
    line.add_option("--planes", options.planes, "Three grayscale pictures, each under one light, instead of IMAGE")
        ->expected(3)
        ->check(not_empty)
        ->type_name("R.png G.png B.png")
        ->excludes(image);
    line.add_option("--mask", options.mask, "Picture of any depth and color, 0 where pixels are to be left out (default: the alpha channel of IMAGE)")
        ->check(not_empty)
        ->type_name("MASK.png");
    line.add_option("--background", options.background,
                    "Picture of the same flat surface without the object, to divide by: for near lights")
        ->check(not_empty)
        ->type_name("BG.png");
    line.add_option("--truth", options.truth, "True normals to compare with: TIFF of 3 x float32, x right, y up, z out")
        ->check(not_empty)
        ->type_name("NORMALS.tiff");
    line.add_seed(options.seed, "the random subsets");
    line.add_option("--subsets", options.subsets, "Random subsets to draw (default: as many as needed)")
        ->check(CLI::Range(1, 10000000))
        ->type_name("N");
    line.add_option("--fit", options.fit,
                    "How C is fitted: least median of squares, or least squares over every pixel (default: median)")
        ->check(CLI::IsMember({"median", "squares"}));
    line.add_option("--orientation", options.orientation,
                    "How F is oriented: joint weighs integrability and normals that point outward, direct is the paper's method,\n"
                    "slants from tilts (default: joint)")
        ->check(CLI::IsMember({"joint", "direct"}));
    auto *convex = line.add_flag("--convex", options.convex, "The surface is raised: no doubt about it");
    line.add_flag("--hollow", options.hollow, "The surface is hollow: an engraving, a mold, a pit")->excludes(convex);
    line.add_option("--model", options.model,
                    "What turns colors into normals: ellipsoid is the paper's, relief is that of a picture most of which is one flat\n"
                    "surface, as the frame of a tactile sensor; auto takes it where the first refuses (default: auto)")
        ->check(CLI::IsMember({"auto", "ellipsoid", "relief"}));
    line.add_option("--ball-radius", options.ball_radius,
                    "Radius in pixels of the one ball that is pressed into the surface: it gives a relief its scale")
        ->check(finite_between(1e-3, 1e6))
        ->type_name("PX");
    options.light.add_to(line);
    options.shadows.add_to(line);
    options.paint.add_to(line);
    options.depth.add_to(line);
    line.add_option("--report", options.report,
                    "What is printed: a summary, or Table 2 and the checks of section 5 for the paper's direct method, whose\n"
                    "figures are then written too (default: short)")
        ->check(CLI::IsMember({"short", "paper"}));
    line.add_flag("--lit-only", options.lit_only,
                  "Normals and depth of the pixels that see all lights and obey the model; without it the whole surface in the\n"
                  "mask, shadows too. --integrate with anything but poisson includes it");
    line.add_option("--outputs", options.outputs,
                    "What to write beside report.json, with commas: normals, uncertainty, depth, mesh, overview, inliers, classes,\n"
                    "albedo (default: all of them)")
        ->delimiter(',')
        ->allow_extra_args(false)
        ->check(CLI::IsMember(names_of_outputs()))
        ->type_name("LIST");
    line.add_option("--mesh-faces", options.mesh_faces, "Triangles of the mesh at most, 0 for all (default: 2000000)")
        ->check(whole_number)
        ->type_name("N");
    line.add_flag("--save-planes", options.save_planes, "Write the channels as three gray pictures, as --planes takes them");
    line.add_flag("--quiet", options.quiet, "Print nothing but what is wrong");
    line.add_option("--json", options.json, "With -, print the report and nothing else")->check(CLI::IsMember({"-"}));
    line.parse_or_exit(argc, argv, [&] { check_together(options); });
    options.images = pictures_in(options.images);
    if (options.images.size() == 1)
        options.image = options.images.front();
    options.out = line.out;
    options.depth.is_wanted = options.wants("depth") || options.wants("mesh") || options.wants("overview");
    return options;
}
