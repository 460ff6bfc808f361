// Figures 2, 4(a) and 6(d) of the paper: eqs. 25 as a fixed-point problem.
#pragma once

#include "common/estimates.hpp"

#include <optional>

// What eqs. 25 are asked, and which answer is marked.
struct FixedPointProblem {
    Triple tilts;                      // radians
    Triple cosines;                    // h12, h13, h23
    std::vector<ofc_slants> solutions; // all that are valid
    std::optional<double> marked;      // the first slant of the answer, radians
    std::string mark;                  // what is written beside it

    // The problem of a solution, with its answer as S; "no root" where the answer is no solution of eqs. 25.
    static FixedPointProblem of(const ofc_solution &solution);

    // The problem of unit vectors at these slants and tilts; the answer is the correct first slant.
    static FixedPointProblem of(const Triple &slants, const Triple &tilts);
};

// The curves f(slant 1) of the eight branches. Where one meets the diagonal it has a solution, unless another slant is
// outside [0, 90] degrees.
cv::Mat plot_slants(const FixedPointProblem &problem, cv::Size size);
