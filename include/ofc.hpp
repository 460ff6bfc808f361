/// @file
/// ofc for C++17: the calls of ofc.h with exceptions, views that know their sizes, and workspaces that are kept.
///
///     ofc::Workspace workspace;
///     const ofc_image photo = ofc::image(rgb, width, height, 3 * width, OFC_PIXEL_RGB8);
///     const ofc_solution solution = ofc::solve(photo, ofc::defaults<ofc_solve_params>(), workspace);
///     const ofc::Array<float, 3> normals = ofc::normals(photo, solution);
///
/// Everything is in this header. The structs, the constants and the calls that are not repeated here are those of
/// ofc.h, whose documentation holds: ofc::ensure_ok() turns the status of any call into an exception.
///
/// Where <opencv2/core.hpp> is included before this header, ofc::opencv has views of cv::Mat, regions of interest among
/// them. It may be included once more after OpenCV.
#ifndef OFC_HPP
#define OFC_HPP

#include <ofc.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <thread>
#include <type_traits>
#include <utility>
#include <vector>

namespace ofc {

// ---- Errors ---------------------------------------------------------------------------------------------------------

/// A call did not do what it was asked for. what() is ofc_status_message().
class Error : public std::runtime_error {
  public:
    /// Of a status that is not OFC_STATUS_OK.
    explicit Error(ofc_status status) : std::runtime_error(ofc_status_message(status)), status_(status) {}

    /// One of OFC_STATUS_*, never OFC_STATUS_OK.
    ofc_status status() const noexcept { return status_; }

  private:
    ofc_status status_;
};

/// The picture is sound, but it does not determine F.
class Undetermined : public Error {
  public:
    /// Of a positive status of ofc_solve(), and what it wrote.
    Undetermined(ofc_status status, const ofc_solution &solution)
        : Error(status), solution_(std::make_shared<const ofc_solution>(solution))
    {
    }

    /// What was found on the way.
    const ofc_solution &solution() const noexcept { return *solution_; }

  private:
    std::shared_ptr<const ofc_solution> solution_; // copying an exception must not throw
};

/// Throws Error for every status but OFC_STATUS_OK.
inline void ensure_ok(ofc_status status)
{
    if (status != OFC_STATUS_OK)
        throw Error(status);
}

// ---- Views and memory -----------------------------------------------------------------------------------------------

/// Rows of pixels in memory of somebody else, each of `Channels` values of type T. A view without data stands for none.
template <class T, std::size_t Channels = 1> struct View {
    T *data = nullptr;            ///< The first value of the first pixel, or null.
    std::int32_t width = 0;       ///< How many pixels are in a row.
    std::int32_t height = 0;      ///< How many rows there are.
    std::size_t stride_bytes = 0; ///< How many bytes lie from one row to the next.

    View() = default;
    /// Rows a stride apart, in bytes.
    View(T *first, std::int32_t columns, std::int32_t rows, std::size_t stride)
        : data(first), width(columns), height(rows), stride_bytes(stride)
    {
    }
    /// Rows without gaps.
    View(T *first, std::int32_t columns, std::int32_t rows)
        : View(first, columns, rows, OFC_SIZE(columns) * Channels * sizeof(T))
    {
    }
    /// A view to write through is one to read through.
    operator View<const T, Channels>() const { return {data, width, height, stride_bytes}; }

    /// The first value of a row; the row is not checked.
    T *row(std::int32_t y) const
    {
        using Byte = std::conditional_t<std::is_const_v<T>, const unsigned char, unsigned char>;
        return reinterpret_cast<T *>(reinterpret_cast<Byte *>(data) + OFC_SIZE(y) * stride_bytes);
    }
    /// The first value of a pixel; the place is not checked.
    T *at(std::int32_t x, std::int32_t y) const { return row(y) + OFC_SIZE(x) * Channels; }

    /// Whether nothing is viewed.
    bool empty() const noexcept { return data == nullptr; }
};

/// Rows of pixels that belong to this object, without gaps and zero at first.
template <class T, std::size_t Channels = 1> class Array {
  public:
    Array() = default;
    /// So many pixels in a row and so many rows, neither of them negative.
    Array(std::int32_t width, std::int32_t height)
        : width_(width), height_(height), values_(OFC_PIXELS(width, height) * Channels)
    {
    }

    /// How many pixels are in a row.
    std::int32_t width() const noexcept { return width_; }
    /// How many rows there are.
    std::int32_t height() const noexcept { return height_; }
    /// The first value.
    T *data() noexcept { return values_.data(); }
    /// The first value.
    const T *data() const noexcept { return values_.data(); }
    /// How many values there are: width x height x Channels.
    std::size_t size() const noexcept { return values_.size(); }

    /// A view to write through.
    View<T, Channels> view() { return {data(), width_, height_}; }
    /// A view to read through.
    View<const T, Channels> view() const { return {data(), width_, height_}; }
    /// The first value of a pixel; the place is not checked.
    const T *at(std::int32_t x, std::int32_t y) const { return view().at(x, y); }

  private:
    std::int32_t width_ = 0, height_ = 0;
    std::vector<T> values_;
};

/// Memory for the calls that need some. It is kept from call to call, and grows when a call needs more; one thread at a
/// time may use it.
class Workspace {
  public:
    Workspace() = default;
    /// Of so many bytes from the start.
    explicit Workspace(std::size_t bytes) : words_(bytes / sizeof(std::uint64_t) + 1) {}

    /// At least so many bytes, aligned for any call and valid until the next call of get().
    void *get(std::size_t bytes)
    {
        const std::size_t words = bytes / sizeof(std::uint64_t) + 1;
        if (words > words_.size()) {
            words_.clear(); // what it held before need not be copied
            words_.resize(words);
        }
        return words_.data();
    }

    /// The bytes that it has.
    void *data() noexcept { return words_.data(); }

    /// How many bytes it has grown to.
    std::size_t bytes() const noexcept { return words_.size() * sizeof(std::uint64_t); }

  private:
    std::vector<std::uint64_t> words_;
};

// ---- Parameters -----------------------------------------------------------------------------------------------------

namespace detail {
inline ofc_status set_defaults(ofc_solve_params *params) { return ofc_solve_params_default(params); }
inline ofc_status set_defaults(ofc_depth_params *params) { return ofc_depth_params_default(params); }
inline ofc_status set_defaults(ofc_stream_params *params) { return ofc_stream_params_default(params); }
inline ofc_status set_defaults(ofc_lmeds_params *params) { return ofc_lmeds_params_default(params); }
inline ofc_status set_defaults(ofc_annealing_params *params) { return ofc_annealing_params_default(params); }
inline ofc_status set_defaults(ofc_render_params *params) { return ofc_render_params_default(params); }
inline ofc_status set_defaults(ofc_segment_params *params) { return ofc_segment_params_default(params); }
} // namespace detail

/// The default parameters, such as defaults<ofc_solve_params>().
template <class Params> Params defaults()
{
    Params params = {};
    ensure_ok(detail::set_defaults(&params));
    return params;
}

// ---- A picture ------------------------------------------------------------------------------------------------------

namespace detail {
// A view of another size than that of the picture is a mistake that C could not see.
template <class T, std::size_t Channels>
void ensure_size(const View<T, Channels> &view, std::int32_t width, std::int32_t height)
{
    if (view.width != width || view.height != height)
        throw Error(OFC_STATUS_INVALID_PARAMETER);
}
} // namespace detail

/// Interleaved pixels, with a mask where there is one.
/// @throws Error with OFC_STATUS_INVALID_PARAMETER for a mask of another size.
inline ofc_image image(const void *pixels, std::int32_t width, std::int32_t height, std::size_t row_stride_bytes,
                       ofc_pixel_format format, View<const std::uint8_t> mask = {})
{
    ofc_image image = {};
    image.pixels = pixels;
    image.width = width;
    image.height = height;
    image.row_stride_bytes = row_stride_bytes;
    image.format = format;
    if (!mask.empty())
        detail::ensure_size(mask, width, height);
    image.mask = mask.data;
    image.mask_stride_bytes = mask.stride_bytes;
    return image;
}

/// Three planes of one stride as the channels, such as three gray photographs under three lights.
/// The format is one of OFC_PIXEL_PLANES*.
/// @throws Error with OFC_STATUS_INVALID_PARAMETER for a mask of another size.
inline ofc_image planes(const void *red, const void *green, const void *blue, std::int32_t width, std::int32_t height,
                        std::size_t row_stride_bytes, ofc_pixel_format format, View<const std::uint8_t> mask = {})
{
    ofc_image image = ofc::image(red, width, height, row_stride_bytes, format, mask);
    image.green_plane = green;
    image.blue_plane = blue;
    return image;
}

// ---- Threads ----------------------------------------------------------------------------------------------------------

/// Runs parts of a call on so many threads, that of the call among them, which are started for each batch of parts. A program that
/// has a pool of threads gives parts to that: ofc::opencv::parallel() does with OpenCV's.
class Threads {
  public:
    /// Of all processors of the machine, or of so many threads.
    explicit Threads(unsigned count = std::thread::hardware_concurrency()) : count_(std::clamp(count, 1U, 32U)) {}

    /// For calls that take an ofc_parallel, valid for as long as this object is.
    ofc_parallel parallel() const { return {run, const_cast<unsigned *>(&count_)}; }

  private:
    static void run(void *context, ofc_part part, void *work, std::int32_t count) noexcept
    {
        std::atomic<std::int32_t> next{0};
        const auto take = [&] {
            for (std::int32_t i = next++; i < count; i = next++)
                part(work, i);
        };
        std::array<std::thread, 32> threads;
        const unsigned wanted = std::min(*static_cast<const unsigned *>(context), static_cast<unsigned>(count));
        try {
            for (unsigned i = 1; i < wanted; i++)
                threads[i] = std::thread(take);
        } catch (...) {
            // There are no more threads: those that have started do all.
        }
        take();
        for (std::thread &thread : threads)
            if (thread.joinable())
                thread.join();
    }

    unsigned count_;
};

// ---- From a picture to normals --------------------------------------------------------------------------------------

/// ofc_solve(). Where there is a view of inliers, it has rows without gaps, and becomes 255 for an inlier and 0
/// elsewhere.
/// @throws Undetermined where the picture does not determine F; Error for any other status.
inline ofc_solution solve(const ofc_image &image, const ofc_solve_params &params, Workspace &workspace,
                          View<std::uint8_t> inliers = {})
{
    if (!inliers.empty()) {
        detail::ensure_size(inliers, image.width, image.height);
        if (inliers.stride_bytes != OFC_SIZE(image.width))
            throw Error(OFC_STATUS_INVALID_PARAMETER);
    }
    const std::size_t bytes = ofc_solve_workspace_size(image.width, image.height, &params);
    ofc_solution solution = {};
    const ofc_status status = ofc_solve(&image, &params, workspace.get(bytes), bytes, inliers.data, &solution);
    if (status > OFC_STATUS_OK)
        throw Undetermined(status, solution);
    ensure_ok(status);
    return solution;
}

/// ofc_solve() with the default parameters and with memory of its own.
inline ofc_solution solve(const ofc_image &image)
{
    Workspace workspace;
    return solve(image, defaults<ofc_solve_params>(), workspace);
}

/// ofc_normals_compute() into memory of the caller, on threads where there are some.
inline void normals(const ofc_image &image, const ofc_solution &solution, View<float, 3> out,
                    const ofc_parallel *parallel = nullptr)
{
    detail::ensure_size(out, image.width, image.height);
    ensure_ok(ofc_normals_compute_parallel(&image, &solution, out.data, out.stride_bytes, parallel));
}

/// ofc_normals_compute().
inline Array<float, 3> normals(const ofc_image &image, const ofc_solution &solution)
{
    Array<float, 3> out(image.width, image.height);
    normals(image, solution, out.view());
    return out;
}

/// ofc_normals_uncertainty() into memory of the caller, on threads where there are some.
inline void uncertainty(const ofc_image &image, const ofc_solution &solution, View<float> angle_rad,
                        const ofc_parallel *parallel = nullptr)
{
    detail::ensure_size(angle_rad, image.width, image.height);
    const std::size_t stride = angle_rad.stride_bytes;
    ensure_ok(ofc_normals_uncertainty_parallel(&image, &solution, angle_rad.data, stride, parallel));
}

/// ofc_normals_uncertainty().
inline Array<float> uncertainty(const ofc_image &image, const ofc_solution &solution)
{
    Array<float> angle_rad(image.width, image.height);
    uncertainty(image, solution, angle_rad.view());
    return angle_rad;
}

/// ofc_check(), with the depth where it is known.
inline ofc_check_result check(const ofc_image &image, const ofc_solution &solution, Workspace &workspace,
                              const ofc_depth_map *depth = nullptr)
{
    const std::size_t bytes = ofc_check_workspace_size(image.width, image.height);
    ofc_check_result result = {};
    ensure_ok(ofc_check(&image, &solution, depth, workspace.get(bytes), bytes, &result));
    return result;
}

// ---- Depth ----------------------------------------------------------------------------------------------------------

/// Normals to be integrated, over a mask where there is one. Weights and known depths are set in the result.
inline ofc_depth_input depth_input(View<const float, 3> normals, View<const std::uint8_t> mask = {})
{
    ofc_depth_input input = {};
    input.normals = normals.data;
    input.normals_stride_bytes = normals.stride_bytes;
    input.width = normals.width;
    input.height = normals.height;
    if (!mask.empty())
        detail::ensure_size(mask, normals.width, normals.height);
    input.mask = mask.data;
    input.mask_stride_bytes = mask.stride_bytes;
    return input;
}

/// ofc_depth_integrate(). Where its iteration ended early, `converged` of the result is 0 and the depth is what it had
/// reached.
inline ofc_depth_result integrate(const ofc_depth_input &input, const ofc_depth_params &params, Workspace &workspace,
                                  View<float> depth)
{
    detail::ensure_size(depth, input.width, input.height);
    const std::size_t bytes = ofc_depth_workspace_size(input.width, input.height);
    ofc_depth_result result = {};
    const ofc_status status =
        ofc_depth_integrate(&input, &params, workspace.get(bytes), bytes, depth.data, depth.stride_bytes, &result);
    if (status != OFC_STATUS_NOT_CONVERGED)
        ensure_ok(status);
    return result;
}

// ---- Streams --------------------------------------------------------------------------------------------------------

/// An ofc_stream with its memory: rows of a camera go in, rows of normals come out.
class Stream {
  public:
    /// ofc_stream_init() in memory that the object keeps.
    Stream(std::int32_t width, std::int32_t height, ofc_pixel_format format,
           const ofc_stream_params &params = defaults<ofc_stream_params>())
    {
        const std::size_t bytes = ofc_stream_size(width, height, &params);
        ensure_ok(ofc_stream_init(width, height, format, &params, memory_.get(bytes), bytes, &stream_));
    }
    /// The memory moves with the stream; the other object has none then, and its calls throw.
    Stream(Stream &&other) noexcept
        : memory_(std::move(other.memory_)), stream_(std::exchange(other.stream_, nullptr))
    {
    }
    /// The memory moves with the stream; the other object has none then, and its calls throw.
    Stream &operator=(Stream &&other) noexcept
    {
        memory_ = std::move(other.memory_);
        stream_ = std::exchange(other.stream_, nullptr);
        return *this;
    }
    Stream(const Stream &) = delete;
    Stream &operator=(const Stream &) = delete;
    ~Stream() = default;

    /// Begins a frame, and says what it is for.
    ofc_stream_pass begin()
    {
        ofc_stream_pass pass = 0;
        ensure_ok(ofc_stream_begin(stream_, &pass));
        return pass;
    }
    /// Takes the next row of the frame, a picture of one row.
    void row(std::int32_t y, const ofc_image &pixels) { ensure_ok(ofc_stream_row(stream_, y, &pixels)); }
    /// Ends the frame, and says what the next one is for.
    /// @throws Error where the pass did not succeed; the stream goes on with what ofc_stream_end() says.
    ofc_stream_pass end()
    {
        ofc_stream_pass pass = 0;
        ensure_ok(ofc_stream_end(stream_, &pass));
        return pass;
    }
    /// Forgets the model: the next frame is for colors.
    void restart() { ensure_ok(ofc_stream_restart(stream_)); }

    /// What the last cold start or frame came to.
    ofc_solution solution()
    {
        ofc_solution solution = {};
        ensure_ok(ofc_stream_solution(stream_, &solution));
        return solution;
    }
    /// How far the model moved with the last frame that refined it.
    ofc_stream_drift drift()
    {
        ofc_stream_drift drift = {};
        ensure_ok(ofc_stream_drift_get(stream_, &drift));
        return drift;
    }
    /// The normals of any row, 3 floats for each of its pixels.
    void normals(const ofc_image &pixels, float *out) { ensure_ok(ofc_stream_normals_row(stream_, &pixels, out)); }
    /// 255 for each pixel of a row that is an inlier, else 0.
    void inliers(const ofc_image &pixels, std::uint8_t *out)
    {
        ensure_ok(ofc_stream_inliers_row(stream_, &pixels, out));
    }

    /// The stream itself, for the calls that are not here.
    ofc_stream *get() noexcept { return stream_; }

  private:
    Workspace memory_;
    ofc_stream *stream_ = nullptr;
};

} // namespace ofc

#endif // OFC_HPP

// ---- OpenCV ---------------------------------------------------------------------------------------------------------

#if defined(OPENCV_CORE_HPP) && !defined(OFC_HPP_OPENCV)
#define OFC_HPP_OPENCV

/// Views of cv::Mat, which may be regions of interest. They are valid for as long as the Mats are.
namespace ofc::opencv {

/// A Mat of `Channels` values of type T, such as view<float, 3>(normals) of a CV_32FC3. An empty Mat is an empty view.
/// @throws Error with OFC_STATUS_UNKNOWN_FORMAT for a Mat of another type.
template <class T, std::size_t Channels = 1> View<T, Channels> view(const cv::Mat &mat)
{
    if (mat.empty())
        return {};
    const int type = CV_MAKETYPE(cv::DataType<std::remove_const_t<T>>::depth, static_cast<int>(Channels));
    if (mat.dims != 2 || mat.type() != type)
        throw Error(OFC_STATUS_UNKNOWN_FORMAT);
    return {const_cast<cv::Mat &>(mat).ptr<T>(), mat.cols, mat.rows, mat.step[0]};
}

namespace detail {
/// OFC_PIXEL_RGB8, _RGB16 or _RGB32F by the depth of a Mat.
inline ofc_pixel_format samples(const cv::Mat &mat)
{
    switch (mat.depth()) {
    case CV_8U:
        return OFC_PIXEL_RGB8;
    case CV_16U:
        return OFC_PIXEL_RGB16;
    case CV_32F:
        return OFC_PIXEL_RGB32F;
    default:
        throw Error(OFC_STATUS_UNKNOWN_FORMAT);
    }
}
} // namespace detail

/// A picture as cv::imread() gives it, BGR or BGRA of 8 bits, 16 bits or floats, with a mask of CV_8U or without one.
inline ofc_image image(const cv::Mat &pixels, const cv::Mat &mask = cv::Mat())
{
    if (pixels.channels() != 3 && pixels.channels() != 4)
        throw Error(OFC_STATUS_UNKNOWN_FORMAT);
    const ofc_pixel_format bgr =
        detail::samples(pixels) + (pixels.channels() == 3 ? OFC_PIXEL_BGR8 : OFC_PIXEL_BGRA8) - OFC_PIXEL_RGB8;
    return ofc::image(pixels.data, pixels.cols, pixels.rows, pixels.empty() ? 0 : pixels.step[0], bgr,
                      view<const std::uint8_t>(mask));
}

/// Three Mats of one channel, size, type and step as red, green and blue.
inline ofc_image planes(const cv::Mat &red, const cv::Mat &green, const cv::Mat &blue, const cv::Mat &mask = cv::Mat())
{
    for (const cv::Mat *other : {&red, &green, &blue})
        if (other->channels() != 1 || other->type() != red.type())
            throw Error(OFC_STATUS_UNKNOWN_FORMAT);
        else if (other->size() != red.size() || (!red.empty() && other->step[0] != red.step[0]))
            throw Error(OFC_STATUS_INVALID_PARAMETER);
    return ofc::planes(red.data, green.data, blue.data, red.cols, red.rows, red.empty() ? 0 : red.step[0],
                       detail::samples(red) + OFC_PIXEL_PLANES8 - OFC_PIXEL_RGB8, view<const std::uint8_t>(mask));
}

/// Runs parts of a call by cv::parallel_for_(), such as `const ofc_parallel parallel = ofc::opencv::parallel();`.
inline ofc_parallel parallel()
{
    const auto run = [](void *, ofc_part part, void *work, std::int32_t count) {
        cv::parallel_for_(cv::Range(0, count), [=](const cv::Range &range) {
            for (int i = range.start; i < range.end; i++)
                part(work, i);
        });
    };
    return {run, nullptr};
}

/// The normals as CV_32FC3 in the order x, y, z; zero where there is none.
inline cv::Mat normals(const ofc_image &image, const ofc_solution &solution)
{
    cv::Mat out(image.height, image.width, CV_32FC3);
    ofc::normals(image, solution, view<float, 3>(out));
    return out;
}

/// The usual 8-bit picture of normals (CV_32FC3), as BGR for cv::imwrite(): (n + 1) / 2 of full scale in r, g, b, and
/// black where there is no normal.
inline cv::Mat normal_map(const cv::Mat &normals)
{
    const View<const float, 3> from = view<const float, 3>(normals);
    cv::Mat map = cv::Mat::zeros(normals.size(), CV_8UC3);
    for (std::int32_t y = 0; y < from.height; y++)
        for (std::int32_t x = 0; x < from.width; x++) {
            const float *n = from.at(x, y);
            if (n[0] != 0 || n[1] != 0 || n[2] != 0)
                map.at<cv::Vec3b>(y, x) = {cv::saturate_cast<uchar>((n[2] + 1) * 127.5F),
                                           cv::saturate_cast<uchar>((n[1] + 1) * 127.5F),
                                           cv::saturate_cast<uchar>((n[0] + 1) * 127.5F)};
        }
    return map;
}

} // namespace ofc::opencv

#endif
