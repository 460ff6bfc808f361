#include "common/surface.hpp"

#include "common/picture.hpp"
#include "common/thin.hpp"

#include <chrono>
#include <cmath>
#include <limits>
#include <sstream>

ofc_depth_map depth_map_of(const cv::Mat &depth, double pixel_pitch, const cv::Mat &mask)
{
    ofc_depth_map map = {};
    map.depth = depth.ptr<float>();
    map.width = depth.cols;
    map.height = depth.rows;
    map.row_stride_bytes = depth.step;
    map.pixel_pitch = pixel_pitch;
    map.mask = mask.data;
    map.mask_stride_bytes = mask.empty() ? 0 : mask.step[0];
    return map;
}

Surface integrate(const cv::Mat &normals, const cv::Mat &mask, const ofc_depth_params &params, const cv::Mat &known)
{
    using ofc::opencv::view;
    ofc_depth_input input = ofc::depth_input(view<const float, 3>(normals), view<const uint8_t>(mask));
    const ofc::View<const float> prior = view<const float>(known);
    input.prior = prior.data;
    input.prior_stride_bytes = prior.stride_bytes;
    Surface surface;
    surface.params = params;
    surface.depth = cv::Mat(normals.size(), CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    const std::size_t bytes = ofc_depth_workspace_size(input.width, input.height);
    ofc::Workspace workspace;
    void *const memory = workspace.get(bytes);
    const auto start = std::chrono::steady_clock::now();
    surface.status = ofc_depth_integrate(&input, &params, memory, bytes, surface.depth.ptr<float>(), surface.depth.step,
                                         &surface.result);
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    surface.milliseconds = elapsed.count();
    return surface;
}

cv::Mat normals_of(const ofc_depth_map &map)
{
    cv::Mat normals = cv::Mat::zeros(map.height, map.width, CV_32FC3);
    ofc_depth_normals(&map, normals.ptr<float>(), normals.step);
    return normals;
}

void write_mesh(const std::string &path, const Surface &surface, const cv::Mat &bgr, std::size_t most_faces)
{
    // Two triangles a pixel.
    const double faces = 2.0 * cv::countNonZero(surface.depth == surface.depth);
    if (most_faces > 0 && faces > static_cast<double>(most_faces)) {
        const int step = static_cast<int>(std::ceil(std::sqrt(faces / static_cast<double>(most_faces))));
        // In the middle of the picture, as the mesh is.
        const cv::Point first((surface.depth.cols - 1) % step / 2, (surface.depth.rows - 1) % step / 2);
        Surface few = surface;
        few.depth = thin(surface.depth, step, first);
        few.params.pixel_pitch *= step;
        write_mesh(path, few, thin(bgr, step, first), 0);
        return;
    }
    const cv::Mat &depth = surface.depth;
    const cv::Mat normals = normals_of(surface.view());
    const double pitch = surface.params.pixel_pitch;
    cv::Mat index(depth.size(), CV_32S, cv::Scalar(-1));
    std::vector<cv::Point> pixels;
    for (int y = 0; y < depth.rows; y++)
        for (int x = 0; x < depth.cols; x++)
            if (std::isfinite(depth.at<float>(y, x))) {
                index.at<int>(y, x) = static_cast<int>(pixels.size());
                pixels.emplace_back(x, y);
            }
    // Two triangles a square of pixels, counter-clockwise from the camera; one where a corner is missing.
    std::vector<cv::Vec3i> triangles;
    for (int y = 0; y + 1 < depth.rows; y++)
        for (int x = 0; x + 1 < depth.cols; x++) {
            const int a = index.at<int>(y, x), b = index.at<int>(y + 1, x), c = index.at<int>(y + 1, x + 1),
                      d = index.at<int>(y, x + 1);
            const bool falling = a >= 0 && c >= 0; // the diagonal
            for (const cv::Vec3i &t : {falling ? cv::Vec3i(a, b, c) : cv::Vec3i(a, b, d),
                                       falling ? cv::Vec3i(a, c, d) : cv::Vec3i(b, c, d)})
                if (t[0] >= 0 && t[1] >= 0 && t[2] >= 0)
                    triangles.push_back(t);
        }

    WholeFile file(path);
    const auto put = [&](const auto &value) { file.write(&value, sizeof value); };
    const bool little = __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__;
    std::ostringstream head;
    head << "ply\nformat " << (little ? "binary_little_endian" : "binary_big_endian") << " 1.0\nelement vertex " << pixels.size()
         << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
            "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face "
         << triangles.size() << "\nproperty list uchar int vertex_indices\nend_header\n";
    file.write(head.str().data(), head.str().size());
    for (const cv::Point &at : pixels) {
        const cv::Vec3b color = bgr.at<cv::Vec3b>(at);
        put(cv::Vec3f(static_cast<float>((at.x - (depth.cols - 1) / 2.0) * pitch),
                      static_cast<float>(((depth.rows - 1) / 2.0 - at.y) * pitch), depth.at<float>(at)));
        put(normals.at<cv::Vec3f>(at));
        put(cv::Vec3b(color[2], color[1], color[0]));
    }
    for (const cv::Vec3i &triangle : triangles) {
        put(uchar(3));
        put(triangle);
    }
    file.finish();
}
