#include "common/file_facts.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <exiv2/exiv2.hpp>
#include <lcms2.h>
#include <memory>
#include <new>
#include <png.h>

namespace {

using Kind = FileTransfer::Kind;

constexpr int curve_steps = 1024;

bool begins_with(const std::vector<unsigned char> &bytes, const std::vector<std::string> &marks)
{
    return std::any_of(marks.begin(), marks.end(), [&](const std::string &mark) {
        return bytes.size() >= mark.size() && std::memcmp(bytes.data(), mark.data(), mark.size()) == 0;
    });
}

// The stored values of light to the power of 1 / gamma.
FileTransfer of_gamma(double gamma, const std::string &source)
{
    if (std::abs(gamma - 1) < 0.02)
        return {Kind::linear, source, 1, {}};
    FileTransfer transfer = {Kind::curve, source, gamma, {}};
    for (int i = 0; i < curve_steps; i++)
        transfer.curve.push_back(static_cast<float>(std::pow(i / (curve_steps - 1.0), gamma)));
    return transfer;
}

// sRGB's own curve is a thousandth from what profiles of it hold.
bool is_srgb(const std::vector<float> &curve)
{
    for (std::size_t i = 0; i < curve.size(); i++) {
        const double stored = static_cast<double>(i) / static_cast<double>(curve.size() - 1);
        const double light = stored <= 0.04045 ? stored / 12.92 : std::pow((stored + 0.055) / 1.055, 2.4);
        if (std::abs(curve[i] - light) > 0.004)
            return false;
    }
    return true;
}

FileTransfer of_profile(const unsigned char *bytes, std::size_t count)
{
    const std::unique_ptr<void, cmsBool (*)(cmsHPROFILE)> profile(cmsOpenProfileFromMem(bytes, static_cast<cmsUInt32Number>(count)),
                                                                  cmsCloseProfile);
    if (!profile)
        return {};
    char name[128] = "";
    cmsGetProfileInfoASCII(profile.get(), cmsInfoDescription, "en", "US", name, sizeof name);
    const std::string source = std::string("its ICC profile (") + name + ")";
    const auto *curve = static_cast<const cmsToneCurve *>(cmsReadTag(profile.get(), cmsSigGreenTRCTag));
    if (curve == nullptr)
        curve = static_cast<const cmsToneCurve *>(cmsReadTag(profile.get(), cmsSigGrayTRCTag));
    if (curve == nullptr)
        return {};
    FileTransfer transfer = {Kind::curve, source, cmsEstimateGamma(curve, 0.1), {}};
    for (int i = 0; i < curve_steps; i++)
        transfer.curve.push_back(cmsEvalToneCurveFloat(curve, static_cast<float>(i / (curve_steps - 1.0))));
    if (cmsIsToneCurveLinear(curve))
        return {Kind::linear, source, 1, {}};
    if (is_srgb(transfer.curve))
        return {Kind::srgb, source, 2.2, {}};
    return transfer;
}

// What libpng has not read yet.
struct Source {
    const unsigned char *next;
    std::size_t left;
};

void take(png_structp png, png_bytep to, png_size_t count)
{
    auto *const source = static_cast<Source *>(png_get_io_ptr(png));
    if (count > source->left)
        png_error(png, "");
    std::memcpy(to, source->next, count);
    source->next += count;
    source->left -= count;
}

// PNG's own chunks sRGB and gAMA, and nothing where the file has neither.
FileTransfer of_png_chunks(const std::vector<unsigned char> &bytes)
{
    png_structp png = png_create_read_struct(
        PNG_LIBPNG_VER_STRING, nullptr, [](png_structp failed, png_const_charp) { longjmp(png_jmpbuf(failed), 1); },
        [](png_structp, png_const_charp) {});
    png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
    if (info == nullptr) {
        png_destroy_read_struct(&png, nullptr, nullptr);
        throw std::bad_alloc();
    }
    Source source = {bytes.data(), bytes.size()};
    volatile double gamma = 0;
    volatile bool is_srgb = false;
    if (setjmp(png_jmpbuf(png)) == 0) {
        png_set_read_fn(png, &source, take);
        png_read_info(png, info);
        int intent = 0;
        double stored = 0;
        is_srgb = png_get_sRGB(png, info, &intent) != 0;
        // libpng derives a gamma from sRGB as well.
        if (!is_srgb && png_get_gAMA(png, info, &stored) != 0)
            gamma = stored;
    }
    png_destroy_read_struct(&png, &info, nullptr);
    if (is_srgb)
        return {Kind::srgb, "its chunk sRGB", 2.2, {}};
    return gamma > 0 ? of_gamma(1 / gamma, "its chunk gAMA") : FileTransfer();
}

// The integer of an EXIF entry, or a default.
int exif_number(const Exiv2::ExifData &exif, const char *key, int otherwise)
{
    const auto entry = exif.findKey(Exiv2::ExifKey(key));
    return entry != exif.end() && entry->count() > 0 ? static_cast<int>(entry->toLong()) : otherwise;
}

} // namespace

FileFacts facts_of(const std::vector<unsigned char> &bytes)
{
    FileFacts facts;
    facts.is_jpeg = begins_with(bytes, {"\xff\xd8\xff"});
    facts.is_png = begins_with(bytes, {"\x89PNG"});
    facts.is_tiff = begins_with(bytes, {std::string("II*\0", 4), std::string("MM\0*", 4), "II+", std::string("MM\0+", 4)});
    if (facts.is_png)
        facts.transfer = of_png_chunks(bytes);
    try {
        Exiv2::LogMsg::setLevel(Exiv2::LogMsg::mute);
        const auto image = Exiv2::ImageFactory::open(bytes.data(), static_cast<long>(bytes.size()));
        image->readMetadata();
        const Exiv2::ExifData &exif = image->exifData();
        const int orientation = exif_number(exif, "Exif.Image.Orientation", 1);
        facts.orientation = orientation >= 1 && orientation <= 8 ? orientation : 1;
        if (image->iccProfileDefined()) {
            const FileTransfer profile = of_profile(image->iccProfile()->pData_, static_cast<std::size_t>(image->iccProfile()->size_));
            if (profile.kind != Kind::unsaid)
                facts.transfer = profile;
        }
        if (facts.transfer.kind == Kind::unsaid && exif_number(exif, "Exif.Photo.ColorSpace", 0) == 1)
            facts.transfer = {Kind::srgb, "its EXIF color space", 2.2, {}};
    } catch (const Exiv2::AnyError &) { // not a kind of file that has such data, or damaged data
    }
    if (facts.is_jpeg && facts.transfer.kind == Kind::unsaid)
        facts.transfer = {Kind::srgb, "its format, as a JPEG holds sRGB unless it says otherwise", 2.2, {}};
    return facts;
}

const char *orientation_in_words(int orientation)
{
    static const char *const words[] = {"as it is stored",
                                        "as it is stored",
                                        "mirrored left to right",
                                        "turned by 180 degrees",
                                        "mirrored top to bottom",
                                        "mirrored and turned by 90 degrees counter-clockwise",
                                        "turned by 90 degrees clockwise",
                                        "mirrored and turned by 90 degrees clockwise",
                                        "turned by 90 degrees counter-clockwise"};
    return words[orientation >= 1 && orientation <= 8 ? orientation : 0];
}
