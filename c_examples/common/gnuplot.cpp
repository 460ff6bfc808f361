#include "common/gnuplot.hpp"

#include <cmath>
#include <cstdio>
#include <memory>
#include <opencv2/imgcodecs.hpp>
#include <spawn.h>
#include <stdexcept>
#include <sys/wait.h>
#include <unistd.h>

namespace {

using File = std::unique_ptr<std::FILE, int (*)(std::FILE *)>;

// An open file without a name, gone when it is closed.
File temporary_file()
{
    File file(std::tmpfile(), std::fclose);
    if (!file)
        throw std::runtime_error("cannot make a temporary file");
    return file;
}

std::vector<uchar> content_of(std::FILE *file)
{
    std::vector<uchar> content;
    uchar block[4096];
    std::rewind(file);
    while (const std::size_t count = std::fread(block, 1, sizeof block, file))
        content.insert(content.end(), block, block + count);
    return content;
}

} // namespace

Gnuplot::Gnuplot(cv::Size size, Background background)
{
    const std::string dimensions = std::to_string(size.width) + "," + std::to_string(size.height);
    (*this)("set terminal pngcairo enhanced font 'DejaVu Sans,10' size " + dimensions +
            (background == Background::transparent ? " transparent" : " background rgb 'white'"));
    (*this)("set encoding utf8");
}

void Gnuplot::operator()(const std::string &command)
{
    script += command + '\n';
}

void Gnuplot::data(const std::string &name, const std::vector<std::vector<double>> &rows)
{
    script += "$" + name + " << END\n";
    for (const std::vector<double> &row : rows) {
        for (const double value : row) {
            char text[32];
            std::snprintf(text, sizeof text, "%.6g ", value);
            script += std::isfinite(value) ? text : "NaN ";
        }
        script += '\n';
    }
    script += "END\n";
}

cv::Mat Gnuplot::draw() const
{
    const File input = temporary_file(), output = temporary_file();
    if (std::fwrite(script.data(), 1, script.size(), input.get()) != script.size() || std::fflush(input.get()) != 0)
        throw std::runtime_error("cannot write a temporary file");
    std::rewind(input.get());

    char program[] = "gnuplot", without_settings[] = "-d";
    char *arguments[] = {program, without_settings, nullptr};
    posix_spawn_file_actions_t files;
    posix_spawn_file_actions_init(&files);
    posix_spawn_file_actions_adddup2(&files, fileno(input.get()), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&files, fileno(output.get()), STDOUT_FILENO);
    pid_t child = 0;
    const int failure = posix_spawnp(&child, program, &files, nullptr, arguments, environ);
    posix_spawn_file_actions_destroy(&files);
    if (failure != 0)
        throw std::runtime_error("the plots need the program gnuplot (Debian's package gnuplot-nox)");
    int status = 0;
    if (waitpid(child, &status, 0) != child || status != 0)
        throw std::runtime_error("gnuplot failed");
    const cv::Mat picture = cv::imdecode(content_of(output.get()), cv::IMREAD_UNCHANGED);
    if (picture.empty())
        throw std::runtime_error("gnuplot drew nothing");
    return picture;
}

std::string Gnuplot::quoted(const std::string &text)
{
    std::string result = "'";
    for (const char character : text)
        result += character == '\'' ? "''" : std::string(1, character);
    return result + "'";
}
