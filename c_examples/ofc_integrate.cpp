// Depth from anyone's normal map.
//
// Shows ofc_depth_integrate() alone: normals in a cv::Mat, an optional mask and known depths, a status that can be
// "not converged", and the depth's own normals against those that came in.

#include "common/depth_options.hpp"
#include "common/picture.hpp"
#include "common/surface_view.hpp"

#include <cstdio>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

namespace {

struct Options {
    std::string normals, mask, known, out;
    bool y_down = false;
    DepthOptions depth;
    double tolerance = 0; // 0 where not given
};

Options parse(int argc, char **argv)
{
    Options options;
    CommandLine line("ofc_integrate",
                     "Integrates a normal map into depth.\n"
                     "NORMALS is a TIFF of 3 x float32 (x right, y up, z toward the camera; zero or NaN where there is none), or\n"
                     "an 8- or 16-bit picture with (n + 1) / 2 of full scale in r, g, b for x, y, z, black where there is none.");
    line.add_option("NORMALS", options.normals, "The normal map (TIFF or PNG)")->required();
    line.add_option("--mask", options.mask, "Gray picture, 0 where no depth is wanted")->type_name("MASK.png");
    line.add_option("--known", options.known, "Known depths: TIFF of float32, NaN where unknown")->type_name("DEPTH.tiff");
    line.add_flag("--y-down", options.y_down, "The map's y points down (as in DirectX)");
    options.depth.add_to(line);
    line.add_option("--tolerance", options.tolerance, "Relative residual to reach (default: 1e-4)")
        ->check(CLI::Range(1e-6, 1.0))
        ->type_name("T");
    line.parse_or_exit(argc, argv);
    options.out = line.out;
    return options;
}

cv::Mat read_known(const std::string &path, cv::Size size)
{
    cv::Mat known = cv::imread(path, cv::IMREAD_UNCHANGED);
    if (known.type() != CV_32F || known.size() != size)
        throw UsageError(path + " is not a TIFF of one 32-bit float a pixel of the normals' size");
    return known;
}

int run(const Options &options)
{
    cv::Mat normals = read_normal_map(options.normals);
    if (options.y_down)
        for (auto n = normals.begin<cv::Vec3f>(); n != normals.end<cv::Vec3f>(); ++n)
            (*n)[1] = -(*n)[1];
    const cv::Mat mask = options.mask.empty() ? cv::Mat() : read_mask(options.mask, normals.size());
    const cv::Mat known = options.known.empty() ? cv::Mat() : read_known(options.known, normals.size());
    ofc_depth_params params = options.depth.params();
    if (options.tolerance > 0)
        params.tolerance = options.tolerance;
    const Surface surface = integrate(normals, mask, params, known);
    if (!surface.integrated()) {
        std::fprintf(stderr, "ofc_integrate: %s\n", ofc_status_message(surface.status));
        return 1;
    }
    const std::filesystem::path out = options.out;
    make_folder(out);
    write_tiff(out / "depth.tiff", surface.depth);
    write_image(out / "depth.png", options.depth.picture(surface));
    write_image(out / "mesh.png", mesh_picture(surface, {960, 720}));
    write_mesh(out / "mesh.ply", surface, normal_map(normals));
    nlohmann::json report = options.depth.report(surface);
    const std::optional<double> bent = median_angle_deg(normals_of(surface.view()), normals);
    if (bent)
        report["median_angle_deg"] = *bent;
    write_json(out / "report.json", report);

    const ofc_depth_result &r = surface.result;
    std::printf("%d pixels in %d region%s; %d more have no usable normal\n", r.pixel_count, r.regions, r.regions == 1 ? "" : "s",
                r.excluded_count);
    std::printf("%s: residual %.1e after %d cycles, %.1f ms\n", ofc_status_message(surface.status), r.residual, r.cycles,
                surface.milliseconds);
    if (bent)
        std::printf("median angle between the normals given and those of the depth: %.2f degrees\n", *bent);
    say_where(out, "depth.png and mesh.png");
    return 0;
}

} // namespace

int main(int argc, char **argv)
{
    const Options options = parse(argc, argv);
    return guarded("ofc_integrate", [&] { return run(options); });
}
