#include "live/sensor.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

namespace {

// A frame in so many is learned from: what follows at once shows the same contact again.
constexpr int learning_pause = 5;
// Contacts that a rig learns without a ball; more change little.
constexpr unsigned enough_frames = 40;
// The background moves by this share a frame toward what is untouched.
constexpr double following_rate = 0.03;

ofc_image view_of(const cv::Mat &frame)
{
    Picture picture;
    picture.pixels = frame;
    return picture.view();
}

ofc_image background_view(const cv::Mat &background)
{
    ofc_image image = {};
    image.pixels = background.data;
    image.width = background.cols;
    image.height = background.rows;
    image.row_stride_bytes = background.step;
    image.format = OFC_PIXEL_RGB32F;
    return image;
}

void check(ofc_status status)
{
    if (status < 0)
        throw std::runtime_error(ofc_status_message(status));
}

} // namespace

Sensor::Sensor(cv::Size size, double pixel_size, double ball_radius)
    : pixel_size(pixel_size), background(size, CV_32FC3, cv::Scalar::all(std::nan("")))
{
    check(ofc_relief_params_default(&params));
    params.ball_radius = ball_radius;
    if (ofc_rig_init(size.width, size.height, &rig, &balls) != OFC_STATUS_OK)
        throw UsageError("frames of this size are too small or too large");
}

void Sensor::set_background(const cv::Mat &frame)
{
    background.setTo(cv::Scalar::all(std::nan("")));
    follow(view_of(frame), {}, 1);
    first = background.clone();
}

void Sensor::follow(const ofc_image &image, const cv::Mat &classes, double rate)
{
    check(ofc_rig_background_follow(&image, classes.data, params.saturation, rate, background.ptr<float>(), background.step));
    if (first.empty() && cv::checkRange(background))
        first = background.clone();
}

bool Sensor::learn(ofc_rig &sums, ofc_rig_balls &of_balls, const ofc_image &image, const ofc_image *plane, cv::Mat &classes)
{
    const std::size_t bytes = ofc_relief_workspace_size(image.width, image.height);
    ofc_relief_params given = params;
    ofc_no_relief why = 0;
    const auto add = [&] {
        return ofc_rig_add(&sums, given.ball_radius > 0 ? &of_balls : nullptr, &image, plane, &given, nullptr, workspace.get(bytes),
                           bytes, classes.data, &why);
    };
    ofc_status status = add();
    if (status == OFC_STATUS_NO_RELIEF && why == OFC_NO_RELIEF_NOT_DETERMINED && given.ball_radius > 0) {
        // Not the ball, perhaps: then a contact like any other.
        given.ball_radius = 0;
        status = add();
    }
    check(status);
    if (status == OFC_STATUS_NO_RELIEF)
        classes.setTo(why == OFC_NO_RELIEF_UNTOUCHED ? OFC_RELIEF_PLANE : OFC_RELIEF_NONE);
    return status == OFC_STATUS_OK;
}

Touch Sensor::take(const cv::Mat &frame)
{
    Touch touch;
    const ofc_image image = view_of(frame), below = background_view(background);
    const ofc_image *const plane = first.empty() ? nullptr : &below;
    touch.classes = cv::Mat::zeros(frame.size(), CV_8U);
    const bool is_enough = is_loaded || rig.frames >= enough_frames;
    if (!has_model() || (!is_enough && ++since_learned >= learning_pause)) {
        touch.learned = learn(rig, balls, image, plane, touch.classes);
        if (touch.learned) {
            since_learned = 0;
            ofc_rig_model better;
            const ofc_status solved = ofc_rig_solve(&rig, balls.count > 0 ? &balls : nullptr, &params, &better);
            if (solved == OFC_STATUS_OK || solved == OFC_STATUS_SCALE_UNKNOWN)
                model = better;
        }
    } else if (plane == nullptr) {
        // The plane that a loaded model has is that of other days: what is untouched follows from the frame itself.
        ofc_rig unused = rig;
        ofc_rig_balls of_balls = balls;
        learn(unused, of_balls, image, nullptr, touch.classes);
    }
    if (has_model() && (plane != nullptr || !is_loaded)) {
        const std::size_t bytes = ofc_relief_workspace_size(image.width, image.height);
        check(ofc_rig_classify(&model, &image, plane, workspace.get(bytes), bytes, touch.classes.data));
        touch.normals.create(frame.size(), CV_32FC3);
        check(ofc_rig_normals(&model, &image, plane, touch.classes.data, touch.normals.ptr<float>(), touch.normals.step, nullptr, 0));
        cv::patchNaNs(touch.normals, 0);
        if (cv::countNonZero(touch.classes == OFC_RELIEF_CONTACT) > 0) {
            ofc_depth_params depth;
            check(ofc_depth_params_default(&depth));
            touch.depth = integrate(touch.normals, {}, depth).depth;
            touch.mask = cv::Mat::zeros(frame.size(), CV_8U);
            touch.status = ofc_rig_contact_measure(touch.classes.data, image.width, image.height, touch.depth.ptr<float>(),
                                                   touch.depth.step, pixel_size, touch.mask.data, &touch.contact);
            check(touch.status);
        }
    }
    follow(image, touch.classes, following_rate);
    return touch;
}

double Sensor::drift() const
{
    if (first.empty())
        return 0;
    cv::Mat change;
    cv::absdiff(background, first, change);
    const cv::Scalar sums = cv::sum(change), all = cv::sum(first);
    return (sums[0] + sums[1] + sums[2]) / (all[0] + all[1] + all[2]);
}

void Sensor::load(const std::string &path)
{
    std::ifstream file(path, std::ios::binary);
    const std::vector<char> bytes{std::istreambuf_iterator<char>(file), {}};
    const ofc_status status = ofc_rig_model_load(reinterpret_cast<const std::uint8_t *>(bytes.data()), bytes.size(), &model);
    if (!file || status != OFC_STATUS_OK)
        throw UsageError(path + ": " + (file ? ofc_status_message(status) : "cannot be read"));
    if (model.width != background.cols || model.height != background.rows)
        throw UsageError(path + " is for frames of another size");
    is_loaded = true;
}

void Sensor::save(const std::string &path) const
{
    std::array<std::uint8_t, OFC_RIG_MODEL_BYTES> bytes;
    check(ofc_rig_model_save(&model, bytes.data(), bytes.size()));
    WholeFile file(path);
    file.write(bytes.data(), bytes.size());
    file.finish();
}
