// The command line of ofc_photo.
#pragma once

#include "common/depth_options.hpp"
#include "photo/light.hpp"
#include "photo/paint.hpp"

#include <cstdint>
#include <string>
#include <vector>

// What --save-planes writes, which may be the next run's input.
constexpr const char *const saved_planes[] = {"plane_r.png", "plane_g.png", "plane_b.png"};

struct Options {
    std::vector<std::string> images;     // what to solve, folders by their pictures; none: the program renders its own scene
    std::string image;                   // the one that a run solves, or empty
    std::vector<std::string> planes;     // none, or red, green, blue
    std::string mask, truth, background; // empty where not given
    std::uint64_t seed = 0;
    std::uint32_t subsets = 0; // as many as needed
    std::string fit = "median", orientation = "joint", report = "short";
    std::string model = "auto"; // auto, ellipsoid or relief
    double ball_radius = 0;     // in pixels; 0 where not given
    ShadowOption shadows;
    LightOptions light;
    PaintOption paint;
    DepthOptions depth;
    bool convex = false, hollow = false; // what the caller knows of the surface
    bool lit_only = false;    // normals of pixels that see all lights, and nothing else
    bool save_planes = false; // the channels as three gray pictures
    std::vector<std::string> outputs; // what to write beside the report; empty: everything
    std::size_t mesh_faces = 2000000; // at most; 0: as many as there are
    std::string out;
    bool quiet = false; // nothing is printed but what is wrong
    std::string json;   // "-": the report is printed, and nothing else

    // Whether this is wanted: normals, uncertainty, depth, mesh, overview, inliers, classes or albedo.
    bool wants(const char *output) const;
    // The files that a run may write beside its report.
    std::vector<std::string> results() const;
    // The files that are read.
    std::vector<std::string> inputs() const;

    bool direct() const { return orientation == "direct"; }
    // Shadows and all else that the mask holds. How to span gaps is a question of lit pixels alone.
    bool whole() const { return !lit_only && depth.method == "poisson"; }
    bool wants_each_uncertainty() const { return whole() || wants("uncertainty") || wants("overview"); }
    bool paper_report() const { return report == "paper"; }

    // What is known of a relief on a plane.
    ofc_relief_params relief_params() const;
    // How to solve with this orientation method.
    ofc_solve_params solve_params(ofc_orientation_method method) const;
};

// Parses the command line; on --help, or with a message where it is wrong, exits with status 0 or 2.
Options parse_options(int argc, char **argv);
