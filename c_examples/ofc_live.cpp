// A tactile sensor, live: normals, depth and contact of a camera, a video or a folder of frames.
//
// Shows ofc_rig_*: a rig that calibrates itself while it runs, a background that follows drift, contacts in millimeters, and models
// that are kept in files.

#include "common/draw.hpp"
#include "live/frames.hpp"
#include "live/sensor.hpp"

#include "common/command_line.hpp"

#include <chrono>
#include <csignal>
#include <cstdio>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <sstream>
#ifdef OFC_HIGHGUI
#include <opencv2/highgui.hpp>
#endif

using json = nlohmann::ordered_json;

namespace {

struct Options {
    std::string source, background, model, save_model, record, out;
    double ball_radius = 0, pixel_size = 1;
    int frames = 0;
    bool window = false;
};

Options parse(int argc, char **argv)
{
    Options options;
    CommandLine line("ofc_live", "Normals, depth and contact of a tactile sensor, frame by frame. It calibrates itself while it runs: press round\n"
                                 "things into it. Writes live.avi, contacts.csv and report.json.");
    line.add_option("SOURCE", options.source, "The number of a camera, a video, or a folder of pictures")->required();
    line.add_option("--background", options.background, "A frame that nothing touches (default: found in the frames)")->type_name("FILE");
    line.add_option("--ball-radius", options.ball_radius, "The radius in pixels of the ball that is pressed in")
        ->check(CLI::PositiveNumber)
        ->type_name("PX");
    line.add_option("--pixel-size", options.pixel_size, "The length of a pixel on the gel, for contacts in that unit (default: 1)")
        ->check(CLI::PositiveNumber)
        ->type_name("MM");
    line.add_option("--model", options.model, "A model that --save-model wrote, instead of calibrating")->type_name("FILE");
    line.add_option("--save-model", options.save_model, "Where to keep the model at the end")->type_name("FILE");
    line.add_option("--record", options.record, "Where to keep the frames as they come")->type_name("FILE.avi");
    line.add_option("--frames", options.frames, "Stop after so many frames")->check(CLI::PositiveNumber)->type_name("N");
#ifdef OFC_HIGHGUI
    line.add_flag("--window", options.window, "Show it; keys: b takes the background, s saves the model, l loads it, q ends");
#endif
    line.parse_or_exit(argc, argv);
    options.out = line.out;
    return options;
}

// The frame with the contact's border, its normals and its depth, side by side, over a line of text.
cv::Mat drawn(const cv::Mat &frame, const Touch &touch, const Sensor &sensor, double rate)
{
    cv::Mat picture = frame.clone();
    std::string said = sensor.has_model() ? "" : "press something round into the gel";
    if (touch.status == OFC_STATUS_OK) {
        std::vector<std::vector<cv::Point>> borders;
        cv::findContours(touch.mask, borders, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
        cv::drawContours(picture, borders, -1, white);
        const cv::Point center(cvRound(touch.contact.center[0]), cvRound(touch.contact.center[1]));
        cv::drawMarker(picture, center, white, cv::MARKER_CROSS, 9);
        char text[80];
        std::snprintf(text, sizeof text, "area %.4g  peak %.3g", touch.contact.area, touch.contact.peak);
        said = text;
    }
    const cv::Mat none(frame.size(), CV_8UC3, dark);
    const cv::Mat normals = touch.normals.empty() ? none : normal_map(touch.normals);
    const cv::Mat depth = touch.depth.empty() ? none : colors_of(touch.depth, range_of(touch.depth));
    cv::Mat all;
    cv::hconcat(std::vector<cv::Mat>{picture, normals, depth}, all);
    cv::copyMakeBorder(all, all, 0, 24, 0, 0, cv::BORDER_CONSTANT, dark);
    char text[120];
    std::snprintf(text, sizeof text, "%3.0f frames/s  learned %d  drift %.1f %%  %s%s", rate, sensor.learned(), 100 * sensor.drift(),
                  said.c_str(), sensor.has_model() && sensor.solved().scale_source == OFC_SCALE_UNKNOWN ? "  (scale unknown)" : "");
    cv::putText(all, text, {6, all.rows - 8}, cv::FONT_HERSHEY_SIMPLEX, 0.4, white);
    return all;
}

// Whether an AVI, which is a row of chunks that each say how long they are, ends where the last of them does.
bool is_whole(const std::filesystem::path &path)
{
    const std::uintmax_t size = std::filesystem::file_size(path);
    std::ifstream file(path, std::ios::binary);
    std::uintmax_t end = 0;
    unsigned char head[8];
    while (end < size && file.seekg(static_cast<std::streamoff>(end)).read(reinterpret_cast<char *>(head), sizeof head))
        end += sizeof head + (head[4] | head[5] << 8 | head[6] << 16 | static_cast<std::uintmax_t>(head[7]) << 24);
    return end == size && size > 0;
}

// Puts a video, if there is one, in its place, whose writer says nothing of what could not be written.
void close(cv::VideoWriter &video, FileAside &file, int frames)
{
    video.release();
    if (frames == 0)
        return;
    if (!is_whole(file.path()) || static_cast<int>(cv::VideoCapture(file.path()).get(cv::CAP_PROP_FRAME_COUNT)) != frames)
        throw std::runtime_error("cannot write all frames into " + file.path().string());
    file.finish();
}

// Ends the run as the last frame does.
volatile std::sig_atomic_t is_interrupted = 0;

int run(const Options &options)
{
    // A folder with live.avi in it is no folder of frames, but its own may be.
    ResultFolder out(options.out, "report.json", {"live.avi", "contacts.csv"},
                     {options.source, options.background, options.model, options.record, options.save_model});
    std::signal(SIGINT, [](int) { is_interrupted = 1; });
    std::signal(SIGTERM, [](int) { is_interrupted = 1; });
    Frames frames(options.source);
    cv::Mat frame = frames.next();
    if (frame.empty())
        throw UsageError(options.source + " has no frames");
    Sensor sensor(frame.size(), options.pixel_size, options.ball_radius);
    if (!options.background.empty()) {
        const cv::Mat bare = as_frame(read_picture(options.background));
        if (bare.size() != frame.size())
            throw UsageError(options.background + " has another size than the frames");
        sensor.set_background(bare);
    }
    if (!options.model.empty())
        sensor.load(options.model);
    const auto motion_jpeg = cv::VideoWriter::fourcc('M', 'J', 'P', 'G');
    const auto open = [&](const std::string &path, cv::Size size) {
        cv::VideoWriter writer(path, motion_jpeg, 25, size);
        if (!writer.isOpened())
            throw UsageError(path + " cannot be written");
        writer.set(cv::VIDEOWRITER_PROP_QUALITY, 95);
        return writer;
    };
    cv::VideoWriter video, record;
    FileAside video_file(out / "live.avi");
    std::optional<FileAside> record_file;
    if (!options.record.empty())
        record_file.emplace(options.record);
    std::ostringstream contacts;
    contacts << "frame,touched,x_px,y_px,area,peak,peak_deviation,volume\n";
    int count = 0, touched = 0;
    double seconds = 0;
    const cv::Size size = frame.size();
    for (; !frame.empty() && is_interrupted == 0 && (options.frames == 0 || count < options.frames); frame = frames.next(), count++) {
        if (frame.size() != size)
            throw UsageError("frame " + std::to_string(count) + " is " + size_text(frame.size()) + ", the first one " + size_text(size));
        const auto start = std::chrono::steady_clock::now();
        const Touch touch = sensor.take(frame);
        const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
        seconds += elapsed.count();
        const bool is_touched = touch.status == OFC_STATUS_OK;
        touched += is_touched ? 1 : 0;
        const ofc_rig_contact &c = touch.contact;
        contacts << count << ',' << is_touched << ',' << c.center[0] << ',' << c.center[1] << ',' << c.area << ',' << c.peak << ','
                 << (is_touched ? c.peak * sensor.solved().scale_deviation : 0) << ',' << c.volume << '\n';
        const cv::Mat shown = drawn(frame, touch, sensor, 1 / elapsed.count());
        if (!video.isOpened())
            video = open(video_file.path(), shown.size());
        video.write(shown);
        if (record_file) {
            if (!record.isOpened())
                record = open(record_file->path(), frame.size());
            record.write(frame);
        }
#ifdef OFC_HIGHGUI
        if (options.window) {
            cv::imshow("ofc_live", shown);
            const int key = cv::waitKey(1);
            const std::string path = options.save_model.empty() ? options.out + "/sensor.ofc" : options.save_model;
            if (key == 'q')
                break;
            if (key == 'b')
                sensor.set_background(frame);
            if (key == 's' && sensor.has_model())
                sensor.save(path);
            if (key == 'l')
                sensor.load(path);
        }
#endif
    }
    const ofc_rig_model &model = sensor.solved();
    json report = {{"frames", count}, {"touched", touched}, {"learned", sensor.learned()}, {"frames_per_second", count / seconds},
                   {"drift", sensor.drift()}, {"has_model", sensor.has_model()}};
    if (sensor.has_model())
        report["model"] = {{"terms", model.terms}, {"scale_source", model.scale_source}, {"scale_deviation", model.scale_deviation},
                           {"expected_error_deg", degrees(model.expected_error)}, {"circulation", model.circulation},
                           {"circulation_ratio", model.circulation_ratio}, {"balls", model.balls}, {"advice", model.advice},
                           {"region", model.region}};
    close(video, video_file, count);
    if (record_file)
        close(record, *record_file, count);
    WholeFile table(out / "contacts.csv");
    table.write(contacts.str().data(), contacts.str().size());
    table.finish();
    out.keep(report);
    if (!options.save_model.empty()) {
        if (!sensor.has_model())
            throw UsageError("there is no model to save: nothing round was pressed in");
        sensor.save(options.save_model);
    }
    say_where(options.out, count > 0 ? "live.avi" : "report.json");
    return sensor.has_model() ? 0 : 1;
}

} // namespace

int main(int argc, char **argv)
{
    return guarded("ofc_live", [&] { return run(parse(argc, argv)); });
}
