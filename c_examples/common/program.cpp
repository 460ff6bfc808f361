#include "common/program.hpp"

#include "common/results.hpp"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <iostream>
#include <nlohmann/json.hpp>

int guarded(const char *program, const std::function<int()> &body)
{
    try {
        const int status = body();
        return status_of_output() == 0 ? status : 1;
    } catch (const UsageError &error) {
        std::fprintf(stderr, "%s: %s\n", program, error.what());
        return 2;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s: %s\n", program, error.what());
        return 1;
    }
}

int status_of_output()
{
    std::cout.flush();
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0 && std::cout)
        return 0;
    std::fprintf(stderr, "cannot write to standard output: %s\n", std::strerror(errno));
    return 1;
}

void say_where(const std::filesystem::path &folder, const char *first)
{
    std::printf("wrote %s: look at %s\n", std::filesystem::absolute(folder).lexically_normal().c_str(), first);
}

void write_json(const std::filesystem::path &path, const nlohmann::json &report)
{
    const std::string text = report.dump(2) + '\n';
    WholeFile file(path);
    file.write(text.data(), text.size());
    file.finish();
}
