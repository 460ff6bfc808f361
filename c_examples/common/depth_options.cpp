#include "common/depth_options.hpp"

#include "common/draw.hpp"

#include <nlohmann/json.hpp>

void DepthOptions::add_to(CommandLine &line)
{
    line.add_option("--integrate", method,
                    "How to span pixels without a normal: poisson leaves them out, paper sets them flat, coupled bridges\n"
                    "them smoothly (default: poisson)")
        ->check(CLI::IsMember({"poisson", "paper", "coupled"}));
    line.add_pixel_pitch(pixel_pitch, "Width of a pixel on the surface in millimeters (default: depth in pixels)", "MM");
}

ofc_depth_params DepthOptions::params() const
{
    ofc_depth_params params;
    ofc_depth_params_default(&params);
    params.method = method == "coupled" ? OFC_DEPTH_COUPLED : method == "paper" ? OFC_DEPTH_PAPER : OFC_DEPTH_POISSON;
    params.pixel_pitch = pixel_pitch > 0 ? pixel_pitch : 1;
    return params;
}

cv::Mat DepthOptions::picture(const Surface &surface) const
{
    return color_picture(surface.depth, range_of(surface.depth), std::string("depth toward the camera, ") + unit());
}

nlohmann::json DepthOptions::report(const Surface &surface) const
{
    const ofc_depth_result &r = surface.result;
    nlohmann::json report = {{"status", ofc_status_message(surface.status)},
                             {"method", method},
                             {"pixel_pitch", surface.params.pixel_pitch},
                             {"unit", unit()},
                             {"converged", r.converged == 1},
                             {"cycles", r.cycles},
                             {"residual", r.residual},
                             {"tolerance", surface.params.tolerance},
                             {"regions", r.regions},
                             {"pixels", r.pixel_count},
                             {"excluded", r.excluded_count},
                             {"ms", surface.milliseconds}};
    if (surface.integrated()) {
        const cv::Vec2d range = range_of(surface.depth);
        report["range"] = {range[0], range[1]};
    }
    return report;
}
