// Section 4: a range map under three lights, and what every method makes of its picture.
#pragma once

#include "common/command_line.hpp"
#include "common/estimates.hpp"
#include "common/scene.hpp"

#include <optional>

struct ExperimentParams {
    double noise = 1; // gray levels
    std::uint64_t seed = 0;
    ShadowOption shadows;
};

// The normals that one method finds, and how far they are from the truth.
struct Answer {
    std::string name;
    cv::Mat normals; // CV_32FC3 over the inliers, empty where the method has no answer
    std::optional<double> median_deg;
    std::string refusal;
};

struct Experiment {
    Scene scene;
    ofc_status status = OFC_STATUS_OK;
    ofc_solution solution = {};   // by the direct method with Pentland's tilts
    cv::Mat inliers;              // CV_8U, of that solution
    double correlation[3] = {};   // of the channels and the normals lit from that solution's F
    std::string shadows;          // what the direct method did with them
    std::string joint_shadows;    // what the joint method did with them
    Table table;
    // The direct method, the same with the correct tilts, the joint method, the least integral by annealing and in closed
    // form, the best orthogonal matrix; all over the inliers of the direct method.
    std::vector<Answer> answers;
    // log10 of the integral (15) over the first slant in degrees, along the solution's branch.
    std::vector<cv::Vec2d> branch;

    bool solved() const { return status == OFC_STATUS_OK; }

    // The point of a branch that is not empty where the integral is least. In the paper's Figure 4(b) it is the solution;
    // but elsewhere on the branch F does not agree with C, so that the integral may as well be smaller there.
    cv::Vec2d least_on_branch() const;
};

Experiment run_experiment(const Relief &relief, const ExperimentParams &params);
