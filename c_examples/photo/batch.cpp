#include "photo/batch.hpp"

#include "common/progress.hpp"

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <memory>
#include <set>
#include <sstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>
#include <utility>

using json = nlohmann::json;

namespace {

struct Job {
    Options options;
    std::unique_ptr<std::FILE, int (*)(std::FILE *)> errors = {nullptr, std::fclose}; // while the process runs
    pid_t process = -1;
    int status = 1;
    bool has_report = false; // of this run
    std::string error;
};

// Added to the status of a process that ends without a report.
constexpr int without_report = 64;

// The program for one picture, whose output no one reads and whose errors are kept; false, with the error, where it cannot begin.
bool begin(Job &job, const std::function<int(const Options &)> &body)
{
    std::fflush(stdout);
    job.errors.reset(std::tmpfile());
    job.process = job.errors ? fork() : -1;
    if (job.process < 0) {
        job.error = std::string("cannot begin another process: ") + std::strerror(errno);
        job.errors.reset();
    }
    if (job.process != 0)
        return job.process > 0;
    dup2(fileno(job.errors.get()), STDERR_FILENO);
    int missing = without_report;
    const int status = guarded("ofc_photo", [&] {
        if (std::freopen("/dev/null", "w", stdout) == nullptr)
            throw std::runtime_error("standard output cannot be put aside");
        const int answer = body(job.options);
        missing = 0;
        return answer;
    });
    std::fflush(stderr);
    _exit(status + missing);
}

// The last line of what went wrong: libraries speak first.
std::string last_error(std::FILE *errors)
{
    std::string line, last;
    std::rewind(errors);
    for (int c = std::fgetc(errors); c != EOF; c = std::fgetc(errors))
        if (c != '\n')
            line += static_cast<char>(c);
        else if (!line.empty())
            last = std::exchange(line, "");
    return last;
}

// A field of the table: quoted, as names and sentences may have commas.
std::string field(std::string text)
{
    for (std::size_t at = text.find('"'); at != std::string::npos; at = text.find('"', at + 2))
        text.insert(at, 1, '"');
    return '"' + text + '"';
}

// What became of a process that has ended.
void end(Job &job, int status)
{
    job.error = last_error(job.errors.get());
    job.errors.reset();
    if (WIFEXITED(status)) {
        job.status = WEXITSTATUS(status) % without_report;
        job.has_report = WEXITSTATUS(status) < without_report;
    } else {
        job.error = std::string("ended by a signal: ") + strsignal(WTERMSIG(status));
    }
}

std::string number(const json &report, const json::json_pointer &where)
{
    const json value = report.value(where, json());
    return value.is_number() ? value.dump() : "";
}

// What a run says of its picture; nothing where it failed, whatever an earlier one left in its folder.
json report_of(const Job &job)
{
    std::ifstream file(job.options.out + "/report.json");
    const json report = file && job.has_report ? json::parse(file, nullptr, false) : json();
    return report.is_object() ? report : json::object();
}

std::string row_of(const Job &job)
{
    const json report = report_of(job);
    const std::string trust = report.value(json::json_pointer("/confidence/in_words"), json()).is_string()
                                  ? report["confidence"]["in_words"].get<std::string>()
                                  : job.error;
    std::ostringstream row;
    row << field(job.options.image) << ',' << job.status << ',' << field(job.has_report ? report.value("model", "ellipsoid") : "") << ','
        << number(report, json::json_pointer("/confidence/expected_error_deg")) << ','
        << number(report, json::json_pointer("/uncertainty/median_deg")) << ','
        << number(report, json::json_pointer("/inliers/after_norms")) << ',' << field(trust) << '\n';
    return row.str();
}

} // namespace

int run_each(const Options &options, const std::function<int(const Options &)> &body)
{
    std::vector<Job> jobs;
    std::set<std::string> names;
    for (const std::string &image : options.images) {
        Job job;
        job.options = options;
        job.options.image = image;
        job.options.images = {image};
        const std::string stem = std::filesystem::path(image).stem();
        std::string name = stem;
        for (int i = 2; !names.insert(name).second; i++)
            name = stem + "-" + std::to_string(i);
        job.options.out = options.out + "/" + name;
        jobs.push_back(std::move(job));
    }
    ResultFolder out(options.out, "report.json", {"summary.csv"}, options.images);
    Progress progress;
    const std::size_t most = std::max(1U, std::thread::hardware_concurrency());
    std::size_t begun = 0, ended = 0;
    const auto wait = [&] {
        int status = 0;
        const pid_t process = ::wait(&status);
        if (process < 0 && errno != EINTR)
            throw std::runtime_error(std::string("cannot wait for a process: ") + std::strerror(errno));
        for (Job &job : jobs)
            if (job.process == process && process > 0) {
                end(job, status);
                ended++;
            }
    };
    // Who starts the program may have ignored it, and then no process can be waited for.
    std::signal(SIGCHLD, SIG_DFL);
    while (ended < jobs.size()) {
        progress.stage(std::to_string(ended) + " of " + std::to_string(jobs.size()) + " pictures");
        if (begun == jobs.size() || begun - ended == most)
            wait();
        else if (!begin(jobs[begun++], body))
            ended++;
    }
    progress.clear();
    std::string table = "picture,status,model,expected_error_deg,median_sigma_deg,inliers,in_words\n";
    int solved = 0;
    for (const Job &job : jobs) {
        table += row_of(job);
        solved += job.status == 0;
        std::printf("%s: %s\n", job.options.image.c_str(), job.status == 0 ? "solved" : job.error.c_str());
    }
    WholeFile file(out / "summary.csv");
    file.write(table.data(), table.size());
    file.finish();
    out.keep({{"pictures", jobs.size()}, {"solved", solved}});
    say_where(out.path(), "summary.csv");
    return solved == static_cast<int>(jobs.size()) ? 0 : 1;
}
