#include "common/image_file.hpp"

#include "common/program.hpp"

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <iostream>
#include <iterator>
#include <limits>
#include <memory>
#include <opencv2/core/utils/logger.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>
#include <turbojpeg.h>

namespace {

// Nothing that is written to std::cerr is seen while there is one.
struct Quiet {
    std::ostringstream words;
    std::streambuf *const before = std::cerr.rdbuf(words.rdbuf());
    Quiet() = default;
    Quiet(const Quiet &) = delete;
    Quiet &operator=(const Quiet &) = delete;
    ~Quiet() { std::cerr.rdbuf(before); }
};

// A file is read once: what reads it in parts takes a part that cannot be read for its end.
std::vector<unsigned char> bytes_of(const std::string &path)
{
    const std::unique_ptr<std::FILE, int (*)(std::FILE *)> file(std::fopen(path.c_str(), "rb"), std::fclose);
    const auto words = [&] { return "cannot read " + path + ": " + std::strerror(errno); };
    const auto is_one_of = [](std::initializer_list<int> errors) { return std::find(errors.begin(), errors.end(), errno) != errors.end(); };
    if (!file && is_one_of({ENOENT, ENOTDIR, EACCES, ENAMETOOLONG, ELOOP}))
        throw UsageError(words());
    if (!file)
        throw std::runtime_error(words());
    constexpr std::size_t block = 1 << 20;
    std::vector<unsigned char> bytes;
    std::error_code failure;
    if (const auto size = std::filesystem::file_size(path, failure); !failure)
        bytes.reserve(size + block);
    std::size_t count;
    do {
        const std::size_t before = bytes.size();
        bytes.resize(before + block);
        count = std::fread(bytes.data() + before, 1, block, file.get());
        bytes.resize(before + count);
    } while (count == block);
    if (std::ferror(file.get()) != 0 && is_one_of({EISDIR}))
        throw UsageError(words());
    if (std::ferror(file.get()) != 0)
        throw std::runtime_error(words());
    if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
        throw UsageError("cannot read " + path + ": it is larger than 2 GiB");
    return bytes;
}

// OpenCV's reader fills a JPEG that is cut with gray and says nothing; libjpeg says what is wrong.
cv::Mat read_jpeg(const std::string &path, const std::vector<unsigned char> &bytes)
{
    const std::unique_ptr<void, int (*)(tjhandle)> decoder(tjInitDecompress(), tjDestroy);
    int width = 0, height = 0, subsampling = 0, colors = 0;
    const auto check = [&](int failure) {
        if (failure != 0)
            throw UsageError(path + " is cut or damaged: " + tjGetErrorStr2(decoder.get()));
    };
    check(tjDecompressHeader3(decoder.get(), bytes.data(), bytes.size(), &width, &height, &subsampling, &colors));
    if (colors == TJCS_CMYK || colors == TJCS_YCCK)
        throw UsageError(path + " holds printing colors (CMYK): ofc needs red, green and blue");
    const bool is_gray = colors == TJCS_GRAY;
    cv::Mat pixels(height, width, is_gray ? CV_8UC1 : CV_8UC3);
    check(tjDecompress2(decoder.get(), bytes.data(), bytes.size(), pixels.data, width, static_cast<int>(pixels.step), height,
                        is_gray ? TJPF_GRAY : TJPF_BGR, 0));
    return pixels;
}

// The page with the most pixels, of which the first.
cv::Mat largest_page(const std::string &path, std::size_t pages, std::vector<std::string> &notes)
{
    cv::Mat largest;
    std::size_t chosen = 0;
    std::string first;
    for (std::size_t page = 0; page < pages; page++) {
        std::vector<cv::Mat> read;
        if (!cv::imreadmulti(path, read, static_cast<int>(page), 1, cv::IMREAD_UNCHANGED) || read.empty())
            throw UsageError(path + " is cut or damaged: page " + std::to_string(page + 1) + " of " + std::to_string(pages) +
                             " cannot be read");
        if (page == 0)
            first = size_text(read[0].size());
        if (read[0].total() > largest.total()) {
            largest = read[0];
            chosen = page;
        }
    }
    notes.push_back(std::to_string(pages) + " pages, of which the first is " + first + ": took page " + std::to_string(chosen + 1) +
                    (chosen == 0 ? "" : ", the largest, " + size_text(largest.size())));
    return largest;
}

cv::Mat read_other(const std::string &path, const std::vector<unsigned char> &bytes, const FileFacts &facts, std::vector<std::string> &notes)
{
    // What is wrong is said below; OpenCV's own words are about its sources.
    cv::utils::logging::setLogLevel(cv::utils::logging::LOG_LEVEL_SILENT);
    const Quiet quiet;
    cv::Mat pixels;
    try {
        const std::size_t pages = facts.is_tiff ? cv::imcount(path) : 1;
        pixels = pages > 1 ? largest_page(path, pages, notes) : cv::imdecode(bytes, cv::IMREAD_UNCHANGED);
    } catch (const cv::Exception &) {
        throw UsageError("cannot read " + path + " as an image: it is damaged, or larger than 2^30 pixels");
    }
    if (pixels.empty())
        throw UsageError("cannot read " + path + " as an image" +
                         (facts.is_png || facts.is_tiff ? ": it is cut or damaged, or of a kind that is not read" : ""));
    return pixels;
}

bool is_named_as_picture(const std::filesystem::path &path)
{
    // What OpenCV reads, where it is built with all it can be built with.
    static const char *const endings[] = {".png", ".jpg", ".jpeg", ".jpe", ".jp2", ".tif", ".tiff", ".bmp", ".dib", ".webp", ".avif", ".ppm",
                                          ".pgm", ".pbm", ".pnm", ".pam", ".pfm", ".exr", ".hdr", ".pic", ".sr", ".ras"};
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::find(std::begin(endings), std::end(endings), ending) != std::end(endings);
}

} // namespace

std::vector<std::string> pictures_in(const std::vector<std::string> &names)
{
    std::vector<std::string> pictures;
    for (const std::string &name : names) {
        if (!std::filesystem::is_directory(name)) {
            pictures.push_back(name);
            continue;
        }
        // A picture that cannot be read is an error then, and not passed over.
        std::vector<std::string> found;
        for (const auto &entry : std::filesystem::directory_iterator(name))
            if (is_named_as_picture(entry.path()))
                found.push_back(entry.path().string());
        if (found.empty())
            throw UsageError(name + " has no pictures");
        std::sort(found.begin(), found.end());
        pictures.insert(pictures.end(), found.begin(), found.end());
    }
    return pictures;
}

std::string size_text(cv::Size size)
{
    return std::to_string(size.width) + " x " + std::to_string(size.height);
}

cv::Mat upright(const cv::Mat &stored, int orientation)
{
    cv::Mat turned = stored;
    if (orientation >= 5)
        turned = stored.t();
    // About which axes to mirror it then, as cv::flip has them.
    constexpr int both = -1, rows = 0, columns = 1;
    switch (orientation) {
    case 2:
    case 6:
        cv::flip(turned, turned, columns);
        break;
    case 3:
    case 7:
        cv::flip(turned, turned, both);
        break;
    case 4:
    case 8:
        cv::flip(turned, turned, rows);
        break;
    default:
        break;
    }
    return turned;
}

std::string ImageFile::in_words() const
{
    static const char *const depths[] = {"8 bits", "8 bits", "16 bits", "16 bits", "32 bits", "32-bit floats", "64-bit floats"};
    std::string words = size_text(pixels.size()) + ", " + depths[pixels.depth()] + " in " + std::to_string(pixels.channels()) +
                        (pixels.channels() == 1 ? " channel" : " channels");
    for (const std::string &note : notes)
        words += "; " + note;
    return words;
}

ImageFile read_image_file(const std::string &path)
{
    const std::vector<unsigned char> bytes = bytes_of(path);
    ImageFile file;
    file.path = path;
    file.facts = facts_of(bytes);
    file.pixels = file.facts.is_jpeg ? read_jpeg(path, bytes) : read_other(path, bytes, file.facts, file.notes);
    if (file.facts.orientation > 1) {
        // OpenCV turns what it reads of a TIFF.
        if (!file.facts.is_tiff)
            file.pixels = upright(file.pixels, file.facts.orientation);
        file.notes.push_back(std::string("its orientation is ") + orientation_in_words(file.facts.orientation) + ", and that was done");
    }
    return file;
}
