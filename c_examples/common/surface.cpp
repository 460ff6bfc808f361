#include "common/surface.hpp"

#include "common/picture.hpp"

#include <assimp/Exporter.hpp>
#include <assimp/scene.h>
#include <chrono>
#include <cmath>
#include <limits>

ofc_depth_map Surface::view() const
{
    ofc_depth_map map = {};
    map.depth = depth.ptr<float>();
    map.width = depth.cols;
    map.height = depth.rows;
    map.row_stride_bytes = depth.step;
    map.pixel_pitch = params.pixel_pitch;
    return map;
}

cv::Vec2d Surface::range() const
{
    cv::Vec2d range(HUGE_VAL, -HUGE_VAL);
    for (int y = 0; y < depth.rows; y++)
        for (int x = 0; x < depth.cols; x++) {
            const double z = depth.at<float>(y, x);
            if (std::isfinite(z))
                range = {std::min(range[0], z), std::max(range[1], z)};
        }
    return range;
}

ofc_depth_params DepthOptions::params() const
{
    ofc_depth_params params;
    ofc_depth_params_default(&params);
    params.method = method == "coupled" ? OFC_DEPTH_COUPLED : method == "paper" ? OFC_DEPTH_PAPER : OFC_DEPTH_POISSON;
    params.pixel_pitch = pixel_pitch > 0 ? pixel_pitch : 1;
    return params;
}

Surface integrate(const cv::Mat &normals, const cv::Mat &mask, const ofc_depth_params &params, const cv::Mat &known)
{
    ofc_depth_input input = {};
    input.normals = normals.ptr<float>();
    input.normals_stride_bytes = normals.step;
    input.mask = mask.data;
    input.mask_stride_bytes = mask.empty() ? 0 : mask.step[0];
    input.prior = known.empty() ? nullptr : known.ptr<float>();
    input.prior_stride_bytes = known.empty() ? 0 : known.step[0];
    input.width = normals.cols;
    input.height = normals.rows;
    Surface surface;
    surface.params = params;
    surface.depth = cv::Mat(normals.size(), CV_32F, cv::Scalar(std::numeric_limits<float>::quiet_NaN()));
    const std::size_t bytes = ofc_depth_workspace_size(input.width, input.height);
    std::vector<std::uint64_t> workspace(bytes / sizeof(std::uint64_t) + 1);
    const auto start = std::chrono::steady_clock::now();
    surface.status = ofc_depth_integrate(&input, &params, workspace.data(), bytes, surface.depth.ptr<float>(),
                                         surface.depth.step, &surface.result);
    const std::chrono::duration<double, std::milli> elapsed = std::chrono::steady_clock::now() - start;
    surface.milliseconds = elapsed.count();
    return surface;
}

void write_depth_tiff(const std::string &path, const cv::Mat &depth)
{
    constexpr int no_compression = 1;
    write_image(path, depth, {cv::IMWRITE_TIFF_COMPRESSION, no_compression});
}

cv::Mat normals_of(const Surface &surface)
{
    cv::Mat normals = cv::Mat::zeros(surface.depth.size(), CV_32FC3);
    const ofc_depth_map map = surface.view();
    ofc_depth_normals(&map, normals.ptr<float>(), normals.step);
    return normals;
}

void write_mesh(const std::string &path, const Surface &surface, const cv::Mat &bgr)
{
    const cv::Mat &depth = surface.depth;
    const cv::Mat normals = normals_of(surface);
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

    auto *mesh = new aiMesh; // the scene owns all that follows
    const auto count = static_cast<unsigned>(pixels.size());
    mesh->mNumVertices = count;
    mesh->mVertices = new aiVector3D[count];
    mesh->mNormals = new aiVector3D[count];
    mesh->mColors[0] = new aiColor4D[count];
    for (unsigned i = 0; i < count; i++) {
        const cv::Point at = pixels[i];
        const cv::Vec3f n = normals.at<cv::Vec3f>(at);
        const cv::Vec3b color = bgr.at<cv::Vec3b>(at);
        mesh->mVertices[i] = {static_cast<float>((at.x - (depth.cols - 1) / 2.0) * pitch),
                              static_cast<float>(((depth.rows - 1) / 2.0 - at.y) * pitch), depth.at<float>(at)};
        mesh->mNormals[i] = {n[0], n[1], n[2]};
        mesh->mColors[0][i] = {color[2] / 255.0F, color[1] / 255.0F, color[0] / 255.0F, 1};
    }
    mesh->mPrimitiveTypes = aiPrimitiveType_TRIANGLE;
    mesh->mNumFaces = static_cast<unsigned>(triangles.size());
    mesh->mFaces = new aiFace[triangles.size()];
    for (std::size_t i = 0; i < triangles.size(); i++) {
        const cv::Vec3i &t = triangles[i];
        mesh->mFaces[i].mNumIndices = 3;
        mesh->mFaces[i].mIndices =
            new unsigned[3]{static_cast<unsigned>(t[0]), static_cast<unsigned>(t[1]), static_cast<unsigned>(t[2])};
    }
    aiScene scene;
    scene.mNumMeshes = 1;
    scene.mMeshes = new aiMesh *[1]{mesh};
    scene.mNumMaterials = 1;
    scene.mMaterials = new aiMaterial *[1]{new aiMaterial};
    scene.mRootNode = new aiNode;
    scene.mRootNode->mNumMeshes = 1;
    scene.mRootNode->mMeshes = new unsigned[1]{0};
    if (Assimp::Exporter().Export(&scene, "plyb", path) != aiReturn_SUCCESS)
        throw std::runtime_error("cannot write " + path);
}
