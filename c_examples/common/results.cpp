#include "common/results.hpp"

#include "common/program.hpp"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace fs = std::filesystem;

namespace {

constexpr std::size_t buffer_bytes = 1 << 20;

fs::path folder_of(const fs::path &path)
{
    return path.has_parent_path() ? path.parent_path() : fs::path(".");
}

} // namespace

ResultFolder::ResultFolder(const fs::path &folder, std::vector<std::string> names, const std::vector<std::string> &inputs)
    : folder(folder), names(std::move(names))
{
    std::error_code failure;
    is_new = fs::create_directories(folder, failure);
    if (failure)
        throw UsageError("cannot make the folder " + folder.string() + ": " + failure.message());
    for (const std::string &input : inputs)
        for (const std::string &name : this->names)
            if (!input.empty() && fs::equivalent(input, folder / name, failure))
                throw UsageError(input + " is an input, and the results in " + folder.string() +
                                 " would overwrite it: give another folder with --out");
    remove_results();
}

ResultFolder::~ResultFolder()
{
    try {
        if (is_kept)
            return;
        remove_results();
        std::error_code is_not_empty;
        if (is_new)
            fs::remove(folder, is_not_empty);
    } catch (const std::exception &) { // a destructor has no one to tell
    }
}

void ResultFolder::remove_results() const
{
    for (const std::string &name : names) {
        std::error_code failure;
        fs::remove(folder / name, failure);
        if (failure)
            throw std::runtime_error("cannot remove " + (folder / name).string() + ", which an earlier run left: " + failure.message());
    }
}

WholeFile::WholeFile(const fs::path &path) : place(path)
{
    constexpr mode_t mode = 0666;
    // A file without a name is gone when the program is killed. Not every file system has them.
    descriptor = open(folder_of(place).c_str(), O_TMPFILE | O_WRONLY | O_CLOEXEC, mode);
    if (descriptor < 0) {
        aside = folder_of(place) / ("." + place.filename().string() + ".part");
        descriptor = open(aside.c_str(), O_CREAT | O_TRUNC | O_WRONLY | O_CLOEXEC, mode);
    }
    if (descriptor < 0)
        fail();
    buffer.reserve(buffer_bytes);
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
    // Files of some systems cannot be flushed, and say so.
    if (fsync(descriptor) != 0 && errno != EINVAL && errno != ENOSYS && errno != EROFS)
        fail();
    if (aside.empty()) {
        // There is nothing at the place: the folder was cleared. What came there since is not ours.
        unlink(place.c_str());
        const std::string self = "/proc/self/fd/" + std::to_string(descriptor);
        if (linkat(AT_FDCWD, self.c_str(), AT_FDCWD, place.c_str(), AT_SYMLINK_FOLLOW) != 0)
            fail();
    } else {
        if (std::rename(aside.c_str(), place.c_str()) != 0)
            fail();
        aside.clear();
    }
    const int closed = close(descriptor);
    descriptor = -1;
    if (closed != 0)
        fail();
}

void WholeFile::fail() const
{
    throw std::runtime_error("cannot write " + place.string() + ": " + std::strerror(errno));
}
