// From a photograph to normals, depth and the checks of both.
#pragma once

#include "photo/result.hpp"

// Solves the picture; where it can be solved, computes normals, their uncertainty and depth, and checks the answer against
// the picture. The uncertainty of a large picture is that of some of its pixels, unless that of each is wanted.
Result solve(const Picture &picture, const ofc_solve_params &params, const ShadowOption &shadows, const DepthOptions &depth,
             bool uncertainty_of_each);

// Runs the stages of a solved picture one by one, to say what each of them costs.
void time_stages(const Picture &picture, Result &result);

// The picture divided by `background`, which `path` names: the same flat surface without the object.
Picture flattened(const Picture &picture, const Picture &background, const std::string &path);
