// Pictures that gnuplot draws.
#pragma once

#include <opencv2/core.hpp>
#include <string>
#include <vector>

class Gnuplot {
  public:
    // What is behind the drawing.
    enum class Background { white, transparent };

    explicit Gnuplot(cv::Size size, Background background = Background::white);

    // Appends a line of gnuplot's language.
    void operator()(const std::string &command);

    // Gives rows of numbers the name `$name`. A NaN interrupts a line that is drawn through them.
    void data(const std::string &name, const std::vector<std::vector<double>> &rows);

    // Runs gnuplot and returns what it drew: CV_8UC3, or CV_8UC4 where the background is transparent. Throws
    // std::runtime_error where gnuplot is not installed or refuses the script.
    cv::Mat draw() const;

    // A text in quotes, as gnuplot takes it.
    static std::string quoted(const std::string &text);

  private:
    std::string script;
};
