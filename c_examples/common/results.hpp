// Files that are whole or not there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

// The folder for the results of a run. Its report, a JSON file, names the others as "files": those of an earlier run are removed, and
// nothing else is. While the program runs its report says that it has not finished. Of a run that fails nothing is left, but for results of
// an earlier one that it read, which its report goes on to name.
class ResultFolder {
  public:
    // Makes the folder and removes what an earlier run left. `names` are the files that the run may write beside its report, and
    // `inputs` those that it reads: UsageError where a file of such a name is an input, or is there and no result.
    ResultFolder(const std::filesystem::path &folder, const std::string &report, std::vector<std::string> names,
                 const std::vector<std::string> &inputs);
    ResultFolder(const ResultFolder &) = delete;
    ResultFolder &operator=(const ResultFolder &) = delete;
    // Removes what the run has written, unless keep() was called.
    ~ResultFolder();

    const std::filesystem::path &path() const { return folder; }
    std::filesystem::path operator/(const std::string &name) const { return folder / name; }

    // Writes the report, after all other files, and keeps them: the run has ended, whether with an answer or with a refusal that its
    // report explains.
    void keep(nlohmann::ordered_json report);

  private:
    std::filesystem::path folder;
    std::string report;
    std::vector<std::string> names; // of this run
    std::vector<std::string> old;   // of an earlier one
    std::vector<std::string> spared; // of an earlier one, as this one reads them
    bool is_new = false, is_kept = false;

    std::vector<std::string> listed() const;
    void write_unfinished(const std::vector<std::string> &files) const;
    void check_inputs(const std::vector<std::string> &inputs);
    bool remove(const std::vector<std::string> &files) const;
};

// A file that a library writes, under a name beside its place, and that is put there when it is whole.
class FileAside {
  public:
    explicit FileAside(const std::filesystem::path &path);
    FileAside(const FileAside &) = delete;
    FileAside &operator=(const FileAside &) = delete;
    // Removes what is not in its place.
    ~FileAside();

    // Where to write it.
    const std::filesystem::path &path() const { return aside; }

    // Flushes what was written to the device and puts it in its place; std::runtime_error where that fails.
    void finish();

  private:
    std::filesystem::path place, aside;
};

// A file that is written beside its place and put there when it is whole.
class WholeFile {
  public:
    explicit WholeFile(const std::filesystem::path &path);
    WholeFile(const WholeFile &) = delete;
    WholeFile &operator=(const WholeFile &) = delete;
    ~WholeFile();

    // Appends bytes; std::runtime_error where they cannot be written.
    void write(const void *bytes, std::size_t count);

    // Flushes the file to the device and puts it in its place; std::runtime_error where that fails.
    void finish();

    // For who writes by himself, and the error where that failed.
    int handle() const { return descriptor; }
    [[noreturn]] void fail() const;

  private:
    std::filesystem::path place, aside; // without `aside` the file has no name yet
    std::vector<unsigned char> buffer;
    int descriptor = -1;

    void flush();
};
