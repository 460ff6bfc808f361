// Figures 3-5 of the paper.
#pragma once

#include "table1/experiment.hpp"

// One figure: the file it goes to and its title on the sheet.
struct Figure {
    std::string file, title;
    cv::Mat image;
};

std::vector<Figure> figures(const Relief &relief, const Experiment &experiment);
