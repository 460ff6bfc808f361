#include "common/results.hpp"

#include "common/program.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace fs = std::filesystem;

namespace {

constexpr std::size_t buffer_bytes = 1 << 20;

// Who wrote a report, as it says itself.
constexpr const char *const program = "ofc";

fs::path folder_of(const fs::path &path)
{
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

// The name of a file that is not yet in its place.
fs::path beside(const fs::path &path)
{
    return folder_of(path) / ("." + path.stem().string() + ".part" + path.extension().string());
}

// Whether a report may name it: a file in the folder itself.
bool is_file_name(const std::string &name)
{
    return !name.empty() && name != "." && name != ".." && fs::path(name).filename() == name;
}

// Whether the file is on its device, as far as that can be asked for: files of some systems cannot be flushed, and say so.
bool flushed(int descriptor)
{
    return fsync(descriptor) == 0 || errno == EINVAL || errno == ENOSYS || errno == EROFS;
}

} // namespace

ResultFolder::ResultFolder(const fs::path &folder, const std::string &report, std::vector<std::string> names,
                           const std::vector<std::string> &inputs)
    : folder(folder), report(report), names(std::move(names))
{
    std::error_code failure;
    is_new = fs::create_directories(folder, failure);
    if (failure)
        throw UsageError("cannot make the folder " + folder.string() + ": " + failure.message());
    old = listed();
    check_inputs(inputs);
    // Named before they are there: a run that is killed leaves no result that is no one's.
    std::vector<std::string> files = spared;
    files.insert(files.end(), old.begin(), old.end());
    files.insert(files.end(), this->names.begin(), this->names.end());
    try {
        write_unfinished(files);
    } catch (const std::exception &) {
        if (spared.empty())
            old.push_back(report);
        remove(old);
        throw;
    }
    std::vector<std::string> parts;
    for (const std::string &name : files)
        parts.push_back(beside(name).filename().string());
    if (!remove(parts) || !remove(old))
        throw std::runtime_error("cannot remove from " + folder.string() + " what an earlier run left");
}

ResultFolder::~ResultFolder()
{
    try {
        if (is_kept)
            return;
        std::vector<std::string> files = names;
        if (spared.empty())
            files.push_back(report);
        if (!remove(files))
            std::fprintf(stderr, "cannot remove what was written into %s: it is not the whole result of a run\n", folder.c_str());
        if (!spared.empty())
            write_unfinished(spared); // without it they would be no one's
        std::error_code is_not_empty;
        if (is_new)
            fs::remove(folder, is_not_empty);
    } catch (const std::exception &) { // a destructor has no one to tell
    }
}

void ResultFolder::keep(nlohmann::ordered_json contents)
{
    std::vector<std::string> files = spared;
    for (const std::string &name : names)
        if (fs::exists(folder / name))
            files.push_back(name);
    contents["program"] = program;
    contents["files"] = files;
    write_json(folder / report, contents);
    is_kept = true;
}

void ResultFolder::write_unfinished(const std::vector<std::string> &files) const
{
    write_json(folder / report, {{"program", program}, {"status", "not finished"}, {"files", files}});
}

// The results that the report in the folder names; none where it is no report, or of something else.
std::vector<std::string> ResultFolder::listed() const
{
    std::vector<std::string> files;
    std::ifstream file(folder / report);
    if (!file)
        return files;
    const nlohmann::json found = nlohmann::json::parse(file, nullptr, false);
    if (!found.is_object() || found.value("program", nlohmann::json()) != program)
        throw UsageError((folder / report).string() + " is not a report of this program's: move it, or give another folder with --out");
    for (const nlohmann::json &name : found.value("files", nlohmann::json::array()))
        if (name.is_string() && is_file_name(name.get<std::string>()))
            files.push_back(name.get<std::string>());
    return files;
}

void ResultFolder::check_inputs(const std::vector<std::string> &inputs)
{
    std::error_code failure;
    const auto is_input = [&](const std::string &name) {
        return std::any_of(inputs.begin(), inputs.end(), [&](const std::string &input) {
            return !input.empty() && fs::equivalent(input, folder / name, failure);
        });
    };
    names.push_back(report);
    for (const std::string &name : names)
        if (is_input(name))
            throw UsageError((folder / name).string() + " is an input, and the results would overwrite it: give another folder with --out");
    names.pop_back();
    const auto first_spared = std::stable_partition(old.begin(), old.end(), [&](const std::string &name) { return !is_input(name); });
    spared.assign(first_spared, old.end());
    for (const std::string &name : names)
        if (fs::exists(folder / name, failure) && std::find(old.begin(), first_spared, name) == first_spared)
            throw UsageError((folder / name).string() + " is there, and no result that " + report +
                             " names: move it, or give another folder with --out");
    old.erase(first_spared, old.end());
}

// Whether all of them are gone.
bool ResultFolder::remove(const std::vector<std::string> &files) const
{
    bool are_gone = true;
    for (const std::string &name : files) {
        std::error_code failure;
        fs::remove(folder / name, failure);
        are_gone = are_gone && !failure;
    }
    return are_gone;
}

FileAside::FileAside(const fs::path &path) : place(path), aside(beside(path)) {}

FileAside::~FileAside()
{
    if (!aside.empty())
        unlink(aside.c_str());
}

void FileAside::finish()
{
    const int descriptor = open(aside.c_str(), O_RDONLY | O_CLOEXEC);
    const bool is_flushed = descriptor >= 0 && flushed(descriptor);
    if (descriptor >= 0)
        close(descriptor);
    if (!is_flushed || std::rename(aside.c_str(), place.c_str()) != 0)
        throw std::runtime_error("cannot write " + place.string() + ": " + std::strerror(errno));
    aside.clear();
}

WholeFile::WholeFile(const fs::path &path) : place(path)
{
    constexpr mode_t mode = 0666;
    buffer.reserve(buffer_bytes);
    // A file without a name is gone when the program is killed. Not every file system has them.
    descriptor = open(folder_of(place).c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, mode);
    if (descriptor < 0) {
        aside = beside(place);
        descriptor = open(aside.c_str(), O_CREAT | O_TRUNC | O_RDWR | O_CLOEXEC, mode);
    }
    if (descriptor < 0)
        fail();
}

WholeFile::~WholeFile()
{
    if (descriptor >= 0)
        close(descriptor);
    if (!aside.empty())
        unlink(aside.c_str());
}

void WholeFile::write(const void *bytes, std::size_t count)
{
    const auto *next = static_cast<const unsigned char *>(bytes);
    while (count > 0) {
        const std::size_t part = std::min(count, buffer_bytes - buffer.size());
        buffer.insert(buffer.end(), next, next + part);
        next += part;
        count -= part;
        if (buffer.size() == buffer_bytes)
            flush();
    }
}

void WholeFile::flush()
{
    for (std::size_t done = 0; done < buffer.size();) {
        const ssize_t written = ::write(descriptor, buffer.data() + done, buffer.size() - done);
        if (written < 0 && errno == EINTR)
            continue;
        if (written <= 0)
            fail();
        done += static_cast<std::size_t>(written);
    }
    buffer.clear();
}

void WholeFile::finish()
{
    flush();
    if (!flushed(descriptor))
        fail();
    if (aside.empty()) {
        // A link replaces nothing, which renaming does.
        const fs::path name = beside(place);
        unlink(name.c_str());
        const std::string self = "/proc/self/fd/" + std::to_string(descriptor);
        if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) != 0)
            fail();
        aside = name;
    }
    if (std::rename(aside.c_str(), place.c_str()) != 0)
        fail();
    aside.clear();
    const int closed = close(descriptor);
    descriptor = -1;
    if (closed != 0)
        fail();
}

void WholeFile::fail() const
{
    throw std::runtime_error("cannot write " + place.string() + ": " + std::strerror(errno));
}
