#include "common/program.hpp"

#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>

int guarded(const char *program, const std::function<int()> &body)
{
    try {
        return body();
    } catch (const UsageError &error) {
        std::fprintf(stderr, "%s: %s\n", program, error.what());
        return 2;
    } catch (const std::exception &error) {
        std::fprintf(stderr, "%s: %s\n", program, error.what());
        return 1;
    }
}

void make_folder(const std::filesystem::path &folder)
{
    std::error_code failure;
    std::filesystem::create_directories(folder, failure);
    if (failure)
        throw UsageError("cannot make the folder " + folder.string() + ": " + failure.message());
}

void say_where(const std::filesystem::path &folder, const char *first)
{
    std::printf("wrote %s: look at %s\n", std::filesystem::absolute(folder).lexically_normal().c_str(), first);
}

void write_json(const std::filesystem::path &path, const nlohmann::json &report)
{
    std::ofstream file(path);
    file << report.dump(2) << '\n';
    if (!file)
        throw std::runtime_error("cannot write " + path.string());
}
