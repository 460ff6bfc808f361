// Files that are whole or not there.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

// The folder for the results of a run: what an earlier run left is removed, and of a run that fails nothing is left.
class ResultFolder {
  public:
    // Makes the folder and removes the files of these names. `inputs` are the files that the run reads: UsageError where one of
    // them would be overwritten.
    ResultFolder(const std::filesystem::path &folder, std::vector<std::string> names, const std::vector<std::string> &inputs);
    ResultFolder(const ResultFolder &) = delete;
    ResultFolder &operator=(const ResultFolder &) = delete;
    // Removes what the run has written, unless keep() was called.
    ~ResultFolder();

    const std::filesystem::path &path() const { return folder; }
    std::filesystem::path operator/(const std::string &name) const { return folder / name; }

    // The run has ended, whether with an answer or with a refusal that its report explains.
    void keep() { is_kept = true; }

  private:
    std::filesystem::path folder;
    std::vector<std::string> names;
    bool is_new = false, is_kept = false;

    void remove_results() const;
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

  private:
    std::filesystem::path place, aside; // without `aside` the file has no name yet
    std::vector<unsigned char> buffer;
    int descriptor = -1;

    void flush();
    [[noreturn]] void fail() const;
};
