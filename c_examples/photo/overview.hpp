// One picture that shows a whole run.
#pragma once

#include "photo/report.hpp"

cv::Mat overview(const Picture &picture, const Result &result);
