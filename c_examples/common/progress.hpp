// What a program is at, on a terminal, for as long as it takes.
#pragma once

#include <string>

// One line on the terminal that standard error is, and nothing where it is none.
class Progress {
  public:
    Progress();
    Progress(const Progress &) = delete;
    Progress &operator=(const Progress &) = delete;
    ~Progress() { clear(); }

    // Says what comes now, in place of what came before.
    void stage(const std::string &what);

    // Leaves nothing of the line, so that other text may follow.
    void clear();

  private:
    bool is_terminal, is_shown = false;
};
