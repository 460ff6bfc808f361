// Memory for the calls of ofc that need some.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

// So many bytes, aligned for any call.
class Workspace {
  public:
    explicit Workspace(std::size_t bytes) : words(bytes / sizeof(std::uint64_t) + 1), size(bytes) {}

    void *data() { return words.data(); }
    std::size_t bytes() const { return size; }

  private:
    std::vector<std::uint64_t> words;
    std::size_t size;
};
