// Why a picture was refused or its answer is to be doubted, in words.
#pragma once

#include "common/picture.hpp"

// What became of the pixels, one number for each fate.
std::string counts_in_words(const ofc_solution &solution);

// The reason, the channel that it is about, and the numbers behind it; empty where there is none.
std::string reason_in_words(const ofc_solution &solution);

// Of a picture that was refused without a solution, with a status below zero: puts the numbers of pixels and the reason there.
void explain_refusal(const ofc_image &image, const ofc_solve_params &params, ofc_solution &solution);
