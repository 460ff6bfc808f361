// The figures of the paper, but the real image's.
#pragma once

#include "table1/experiment.hpp"

// One figure: the file it goes to, its title on the sheet, and how many columns of the sheet it takes.
struct Figure {
    std::string file, title;
    cv::Mat image;
    int span = 1;
};

// Figures 1 and 2 of the paper's own example, and Figures 3, 4, 5 and 7 of the experiment.
std::vector<Figure> figures(const Relief &relief, const Experiment &experiment);

// The angles between the vectors of Figures 1 and 2, and the slants that solve eqs. 25.
nlohmann::json example_report();
