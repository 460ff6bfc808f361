// ofc.hpp gives what the calls of C give, bit for bit, and throws what they return.
#include <ofc.hpp>

#include "scene.hpp"

namespace {

constexpr std::size_t pixel_count = std::size_t(width) * height;

void solves_as_c_does(const ofc_image &photo)
{
    ofc_solve_params params;
    ofc_solve_params_default(&params);
    EXPECT(same_bits(params, ofc::defaults<ofc_solve_params>()));
    const std::size_t bytes = ofc_solve_workspace_size(width, height, &params);
    std::vector<std::uint64_t> memory(bytes / sizeof(std::uint64_t) + 1);
    std::vector<std::uint8_t> mask(pixel_count);
    ofc_solution expected = {};
    EXPECT(ofc_solve(&photo, &params, memory.data(), bytes, mask.data(), &expected) == OFC_STATUS_OK);
    std::vector<float> normals(3 * pixel_count), angles(pixel_count);
    ofc_normals_compute(&photo, &expected, normals.data(), 3 * sizeof(float) * width);
    ofc_normals_uncertainty(&photo, &expected, angles.data(), sizeof(float) * width);

    ofc::Workspace workspace;
    ofc::Array<std::uint8_t> inliers(width, height);
    const ofc_solution solution = ofc::solve(photo, params, workspace, inliers.view());
    EXPECT(same_bits(solution, expected));
    EXPECT(same_bits(ofc::solve(photo), expected));
    EXPECT(std::memcmp(inliers.data(), mask.data(), pixel_count) == 0);
    const ofc::Array<float, 3> found = ofc::normals(photo, solution);
    EXPECT(found.size() == normals.size());
    EXPECT(std::memcmp(found.data(), normals.data(), normals.size() * sizeof(float)) == 0);
    EXPECT(found.at(5, 7) == found.data() + 3 * (7 * width + 5));
    const ofc::Array<float> uncertainty = ofc::uncertainty(photo, solution);
    EXPECT(std::memcmp(uncertainty.data(), angles.data(), angles.size() * sizeof(float)) == 0);

    // The workspace is kept, and a larger call makes it grow.
    void *const before = workspace.get(bytes);
    ofc::solve(photo, params, workspace);
    EXPECT(workspace.get(bytes) == before);
    const std::size_t grown = workspace.bytes();
    workspace.get(grown + 1);
    EXPECT(workspace.bytes() > grown);

    ofc_check_result checked;
    std::vector<std::uint64_t> for_check(ofc_check_workspace_size(width, height) / sizeof(std::uint64_t) + 1);
    ofc_check(&photo, &expected, nullptr, for_check.data(), ofc_check_workspace_size(width, height), &checked);
    EXPECT(same_bits(ofc::check(photo, solution, workspace), checked));

    // Depth, into every second row of something larger.
    const auto depth_params = ofc::defaults<ofc_depth_params>();
    ofc::Array<float> depth(width, height), tall(width, 2 * height);
    const ofc_depth_input input = ofc::depth_input(found.view());
    const ofc_depth_result result = ofc::integrate(input, depth_params, workspace, depth.view());
    const ofc::View<float> sparse(tall.data(), width, height, 2 * sizeof(float) * width);
    EXPECT(same_bits(ofc::integrate(input, depth_params, workspace, sparse), result));
    bool equal = true, untouched = true;
    for (std::int32_t y = 0; y < height; y++) {
        equal &= std::memcmp(sparse.row(y), depth.view().row(y), sizeof(float) * width) == 0;
        for (std::int32_t x = 0; x < width; x++)
            untouched &= *tall.at(x, 2 * y + 1) == 0;
    }
    EXPECT(equal && untouched);
    EXPECT(result.converged == 1 && result.pixel_count > 5000);
}

void any_number_of_threads_gives_the_same_bits(const ofc_image &photo)
{
    // Balls one below the other, so that there is work for more than one thread.
    constexpr std::int32_t balls = 9, tall = balls * height;
    std::vector<std::uint8_t> pixels;
    for (int i = 0; i < balls; i++) {
        const auto *const first = static_cast<const std::uint8_t *>(photo.pixels);
        pixels.insert(pixels.end(), first, first + 3 * pixel_count);
    }
    const ofc_image all = ofc::image(pixels.data(), width, tall, 3 * width, OFC_PIXEL_RGB8);
    const ofc_solution solution = ofc::solve(photo);
    const ofc::Array<float, 3> normals = ofc::normals(all, solution);
    const ofc::Array<float> angles = ofc::uncertainty(all, solution);
    for (const unsigned count : {0U, 1U, 2U, 16U, 1000U}) {
        const ofc::Threads threads(count);
        const ofc_parallel parallel = threads.parallel();
        ofc::Array<float, 3> found(width, tall);
        ofc::Array<float> found_angles(width, tall);
        ofc::normals(all, solution, found.view(), &parallel);
        ofc::uncertainty(all, solution, found_angles.view(), &parallel);
        EXPECT(std::memcmp(found.data(), normals.data(), found.size() * sizeof(float)) == 0);
        EXPECT(std::memcmp(found_angles.data(), angles.data(), angles.size() * sizeof(float)) == 0);
    }
}

void throws_what_c_returns(const ofc_image &photo)
{
    ofc::Workspace workspace;
    const auto params = ofc::defaults<ofc_solve_params>();
    EXPECT(throws(OFC_STATUS_UNKNOWN_FORMAT, [&] {
        ofc_image wrong = photo;
        wrong.format = 99;
        ofc::solve(wrong);
    }));
    EXPECT(throws(OFC_STATUS_INVALID_PARAMETER, [&] {
        auto wrong = params;
        wrong.rank_threshold = 2;
        ofc::solve(photo, wrong, workspace);
    }));
    EXPECT(throws(OFC_STATUS_NOT_SOLVED, [&] { ofc::normals(photo, ofc_solution{}); }));
    // Views of another size, which C could not see.
    ofc::Array<float, 3> normals(width, height - 1);
    ofc::Array<std::uint8_t> mask(width - 1, height);
    ofc::Array<float> depth(width, height);
    EXPECT(throws(OFC_STATUS_INVALID_PARAMETER, [&] { ofc::normals(photo, ofc::solve(photo), normals.view()); }));
    EXPECT(throws(OFC_STATUS_INVALID_PARAMETER, [&] { ofc::solve(photo, params, workspace, mask.view()); }));
    EXPECT(throws(OFC_STATUS_INVALID_PARAMETER,
                  [&] { ofc::image(photo.pixels, width, height, 3 * width, OFC_PIXEL_RGB8, mask.view()); }));
    EXPECT(throws(OFC_STATUS_INVALID_PARAMETER, [&] {
        ofc::integrate(ofc::depth_input(normals.view()), ofc::defaults<ofc_depth_params>(), workspace, depth.view());
    }));
    ofc::ensure_ok(OFC_STATUS_OK);
    EXPECT(throws(OFC_STATUS_DARK, [] { ofc::ensure_ok(OFC_STATUS_DARK); }));

    // One color does not determine F: what was found on the way comes with the exception.
    const std::vector<std::uint8_t> gray(3 * pixel_count, 100);
    const ofc_image flat = ofc::image(gray.data(), width, height, 3 * width, OFC_PIXEL_RGB8);
    bool caught = false;
    try {
        ofc::solve(flat, params, workspace);
    } catch (const ofc::Undetermined &undetermined) {
        const ofc::Undetermined copy = undetermined;
        caught = copy.status() > OFC_STATUS_OK && copy.solution().pixel_counts.usable == width * height;
    }
    EXPECT(caught);
}

void streams_as_c_does(const ofc_image &photo)
{
    const auto params = ofc::defaults<ofc_stream_params>();
    const std::size_t bytes = ofc_stream_size(width, height, &params);
    std::vector<std::uint64_t> memory(bytes / sizeof(std::uint64_t) + 1);
    ofc_stream *c = nullptr;
    EXPECT(ofc_stream_init(width, height, photo.format, &params, memory.data(), bytes, &c) == OFC_STATUS_OK);
    ofc::Stream first(width, height, photo.format);
    ofc::Stream stream = std::move(first);
    EXPECT(throws(OFC_STATUS_NULL_POINTER, [&] { first.begin(); }));
    EXPECT(throws(OFC_STATUS_NO_FRAME, [&] { stream.end(); }));
    const auto row = [&](std::int32_t y) {
        return ofc::image(static_cast<const std::uint8_t *>(photo.pixels) + std::size_t(y) * photo.row_stride_bytes, width, 1,
                          photo.row_stride_bytes, photo.format);
    };
    ofc_stream_pass pass = 0, next = 0;
    for (int frame = 0; frame < 4; frame++) {
        EXPECT(ofc_stream_begin(c, &pass) == OFC_STATUS_OK && stream.begin() == pass);
        for (std::int32_t y = 0; y < height; y++) {
            const ofc_image pixels = row(y);
            ofc_stream_row(c, y, &pixels);
            stream.row(y, pixels);
        }
        EXPECT(ofc_stream_end(c, &next) == OFC_STATUS_OK && stream.end() == next);
    }
    ofc_solution expected = {};
    EXPECT(ofc_stream_solution(c, &expected) == OFC_STATUS_OK && same_bits(stream.solution(), expected));
    ofc_stream_drift drift;
    EXPECT(ofc_stream_drift_get(c, &drift) == OFC_STATUS_OK && same_bits(stream.drift(), drift));
    std::vector<float> a(3 * width), b(3 * width);
    std::vector<std::uint8_t> flags(width), marks(width);
    const ofc_image middle = row(height / 2);
    ofc_stream_normals_row(c, &middle, a.data());
    stream.normals(middle, b.data());
    EXPECT(std::memcmp(a.data(), b.data(), a.size() * sizeof(float)) == 0);
    ofc_stream_inliers_row(stream.get(), &middle, flags.data());
    stream.inliers(middle, marks.data());
    EXPECT(flags == marks);
    stream.restart();
    EXPECT(throws(OFC_STATUS_NOT_SOLVED, [&] { stream.solution(); }));
}

} // namespace

int main()
{
    const std::vector<std::uint8_t> pixels = ball();
    const ofc_image photo = ofc::image(pixels.data(), width, height, 3 * width, OFC_PIXEL_RGB8);
    solves_as_c_does(photo);
    any_number_of_threads_gives_the_same_bits(photo);
    throws_what_c_returns(photo);
    streams_as_c_does(photo);
    return failures == 0 ? 0 : 1;
}
