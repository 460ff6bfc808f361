// Depth from anyone's normal map.
//
// Shows ofc_depth_integrate() alone: normals in a cv::Mat, an optional mask and known depths, a status that can be
// "not converged", and the depth's own normals against those that came in.

#include "common/depth_options.hpp"
#include "common/normal_map.hpp"
#include "common/progress.hpp"
#include "common/surface_view.hpp"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>

namespace {

struct Options {
    std::string normals, mask, known, out;
    NormalMapOptions map;
    DepthOptions depth;
    std::size_t mesh_faces = 2000000; // at most; 0: as many as there are
    double tolerance = 0; // 0 where not given
};

Options parse(int argc, char **argv)
{
    Options options;
    CommandLine line("ofc_integrate",
                     "Integrates a normal map into depth.\n"
                     "NORMALS is a TIFF of 3 x float32 (x right, y up, z toward the camera; zero or NaN where there is none), or\n"
                     "an 8- or 16-bit picture with (n + 1) / 2 of full scale in r, g, b for x, y, z, black or transparent where there\n"
                     "is none, and where vectors are far from length 1.");
    line.add_option("NORMALS", options.normals, "The normal map (TIFF or PNG)")->required()->check(not_empty);
    line.add_option("--mask", options.mask, "Picture of any depth and color, 0 where no depth is wanted")->check(not_empty)->type_name("MASK.png");
    line.add_option("--known", options.known, "Known depths: TIFF of float32, NaN where unknown")->check(not_empty)->type_name("DEPTH.tiff");
    line.add_flag("--y-down", options.map.y_down, "The map's y points down (as in DirectX)");
    line.add_flag("--z-inward", options.map.z_inward, "The map's z points into the scene");
    line.add_option("--transfer", options.map.transfer, "How a picture of 8 or 16 bits stores numbers: linear or srgb (default: linear)")
        ->check(CLI::IsMember({"linear", "srgb"}));
    options.depth.add_to(line);
    line.add_option("--tolerance", options.tolerance, "Relative residual to reach (default: 1e-4)")
        ->check(finite_between(1e-6, 1))
        ->type_name("T");
    line.add_option("--mesh-faces", options.mesh_faces, "Triangles of the mesh at most, 0 for all (default: 2000000)")
        ->check(whole_number)
        ->type_name("N");
    line.parse_or_exit(argc, argv);
    options.out = line.out;
    return options;
}

cv::Mat read_known(const std::string &path, cv::Size size)
{
    const cv::Mat known = read_image_file(path).pixels;
    if (known.type() != CV_32F || known.size() != size)
        throw UsageError(path + " is not a TIFF of one 32-bit float a pixel of the normals' size");
    return known;
}

// Zero is a depth like any other, and seldom that of most of a map.
std::optional<std::string> doubt_of_known(const cv::Mat &known, const cv::Mat &normals)
{
    if (known.empty())
        return std::nullopt;
    std::vector<cv::Mat> xyz;
    cv::split(normals, xyz);
    const cv::Mat has_normal = (xyz[0] != 0) | (xyz[1] != 0) | (xyz[2] != 0);
    const int zeros = cv::countNonZero((known == 0) & has_normal), all = cv::countNonZero(has_normal);
    if (2 * zeros < all)
        return std::nullopt;
    return "the known depths are exactly 0 at " + std::to_string(100LL * zeros / std::max(all, 1)) +
           " % of the normals, which pins the surface there: where a depth is unknown it must be NaN";
}

int run(const Options &options)
{
    ResultFolder out(options.out, "report.json", {"depth.tiff", "depth.png", "mesh.png", "mesh.ply"},
                     {options.normals, options.mask, options.known});
    Progress progress;
    progress.stage("reading");
    NormalMap map = read_normal_map(options.normals, options.map);
    const cv::Mat &normals = map.normals;
    const cv::Mat mask = options.mask.empty() ? cv::Mat() : read_mask(options.mask, normals.size());
    const cv::Mat known = options.known.empty() ? cv::Mat() : read_known(options.known, normals.size());
    if (const auto doubt = doubt_of_known(known, normals))
        map.doubts.push_back(*doubt);
    progress.clear();
    std::printf("normals: %s\n", map.words.c_str());
    for (const std::string &doubt : map.doubts)
        std::printf("doubt: %s\n", doubt.c_str());
    std::fflush(stdout);
    progress.stage("integrating");
    ofc_depth_params params = options.depth.params();
    if (options.tolerance > 0)
        params.tolerance = options.tolerance;
    const Surface surface = integrate(normals, mask, params, known);
    progress.clear();
    if (!surface.integrated()) {
        std::fprintf(stderr, "ofc_integrate: %s\n", ofc_status_message(surface.status));
        return 1;
    }
    progress.stage("writing");
    write_tiff(out / "depth.tiff", surface.depth);
    write_png(out / "depth.png", options.depth.picture(surface));
    write_png(out / "mesh.png", mesh_picture(surface, {960, 720}));
    write_mesh(out / "mesh.ply", surface, normal_map(normals), options.mesh_faces);
    nlohmann::json report = options.depth.report(surface);
    report["doubts"] = map.doubts;
    const std::optional<double> bent = median_angle_deg(normals_of(surface.view()), normals);
    if (bent)
        report["median_angle_deg"] = *bent;
    out.keep(report);
    progress.clear();

    const ofc_depth_result &r = surface.result;
    std::printf("%d pixels in %d region%s; %d more have no usable normal\n", r.pixel_count, r.regions, r.regions == 1 ? "" : "s",
                r.excluded_count);
    std::printf("%s: residual %.1e after %d cycles, %.1f ms\n", ofc_status_message(surface.status), r.residual, r.cycles,
                surface.milliseconds);
    if (bent)
        std::printf("median angle between the normals given and those of the depth: %.2f degrees\n", *bent);
    say_where(out.path(), "depth.png and mesh.png");
    return 0;
}

} // namespace

int main(int argc, char **argv)
{
    return guarded("ofc_integrate", [&] { return run(parse(argc, argv)); });
}
