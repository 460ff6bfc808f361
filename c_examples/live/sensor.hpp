// A tactile sensor that calibrates itself while it runs.
#pragma once

#include "common/picture.hpp"
#include "common/surface.hpp"

#include <string>

// What one frame showed.
struct Touch {
    ofc_status status = OFC_STATUS_NO_RELIEF; // OFC_STATUS_OK where something is pressed in and was measured
    ofc_rig_contact contact = {};
    cv::Mat classes, normals, depth, mask; // empty without a model
    bool learned = false;                  // whether the frame was added to the rig
};

class Sensor {
  public:
    // Frames of this size. `pixel_size` is the length of a pixel, `ball_radius` in pixels that of the ball that is pressed in, or 0.
    Sensor(cv::Size size, double pixel_size, double ball_radius);

    // Takes a picture of the gel that nothing touches.
    void set_background(const cv::Mat &frame);

    // Learns from the frame, follows the background, and measures.
    Touch take(const cv::Mat &frame);

    // Reads and writes the model. Throws UsageError.
    void load(const std::string &path);
    void save(const std::string &path) const;

    bool has_model() const { return model.terms != 0; }
    const ofc_rig_model &solved() const { return model; }
    int learned() const { return static_cast<int>(rig.frames); }
    // How far the background is from the first one: the mean, relative to it.
    double drift() const;

  private:
    // Adds the frame to sums, and says what its pixels are part of.
    bool learn(ofc_rig &sums, ofc_rig_balls &of_balls, const ofc_image &image, const ofc_image *plane, cv::Mat &classes);
    void follow(const ofc_image &image, const cv::Mat &classes, double rate);

    double pixel_size;
    ofc_relief_params params = {};
    ofc_rig rig = {};
    ofc_rig_balls balls = {};
    ofc_rig_model model = {};
    bool is_loaded = false;
    int since_learned = 0;
    cv::Mat background, first; // CV_32FC3 in r, g, b; NaN where not known
    mutable ofc::Workspace workspace;
};
