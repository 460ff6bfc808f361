#include "common/image_writer.hpp"

#include "common/results.hpp"

#include <algorithm>
#include <csetjmp>
#include <exception>
#include <memory>
#include <png.h>
#include <stdexcept>
#include <tiffio.h>
#include <unistd.h>

namespace {

// A file that libpng writes to, which is of C: what is thrown waits until it has returned.
struct Sink {
    WholeFile file;
    std::exception_ptr failure;
};

void put(png_structp png, png_bytep bytes, png_size_t count)
{
    auto *const sink = static_cast<Sink *>(png_get_io_ptr(png));
    try {
        sink->file.write(bytes, count);
        return;
    } catch (const std::exception &) {
        sink->failure = std::current_exception();
    }
    png_error(png, "");
}

// Whether it was written. Nothing here has a destructor, as longjmp() calls none.
bool encode(png_structp png, png_infop info, Sink *sink, const cv::Mat &image)
{
    if (setjmp(png_jmpbuf(png)) != 0)
        return false;
    static constexpr int kinds[] = {PNG_COLOR_TYPE_GRAY, PNG_COLOR_TYPE_GRAY_ALPHA, PNG_COLOR_TYPE_RGB, PNG_COLOR_TYPE_RGB_ALPHA};
    png_set_write_fn(png, sink, put, [](png_structp) {});
    // Fast, and as small as other settings make maps that are smooth.
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_compression_level(png, 1);
    png_set_compression_strategy(png, 3); // runs: Z_RLE of zlib
    png_set_IHDR(png, info, static_cast<png_uint_32>(image.cols), static_cast<png_uint_32>(image.rows),
                 image.depth() == CV_16U ? 16 : 8, kinds[image.channels() - 1], PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    png_write_info(png, info);
    png_set_bgr(png);
    if (image.depth() == CV_16U && __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__)
        png_set_swap(png);
    for (int y = 0; y < image.rows; y++)
        png_write_row(png, image.ptr(y));
    png_write_end(png, info);
    return true;
}

} // namespace

void write_png(const std::string &path, const cv::Mat &image)
{
    Sink sink = {WholeFile(path), nullptr};
    png_structp png = png_create_write_struct(
        PNG_LIBPNG_VER_STRING, nullptr, [](png_structp failed, png_const_charp) { longjmp(png_jmpbuf(failed), 1); },
        [](png_structp, png_const_charp) {});
    png_infop info = png == nullptr ? nullptr : png_create_info_struct(png);
    const bool is_written = info != nullptr && encode(png, info, &sink, image);
    png_destroy_write_struct(&png, &info);
    if (sink.failure)
        std::rethrow_exception(sink.failure);
    if (!is_written)
        throw std::runtime_error("cannot write " + path);
    sink.file.finish();
}

void write_tiff(const std::string &path, const cv::Mat &floats)
{
    WholeFile file(path);
    // What is wrong is said here, and libtiff closes what it is given.
    TIFFSetErrorHandler(nullptr);
    const bool is_large = floats.total() * floats.elemSize() > 4000000000U;
    const int handle = dup(file.handle());
    const std::unique_ptr<TIFF, void (*)(TIFF *)> tiff(handle < 0 ? nullptr : TIFFFdOpen(handle, path.c_str(), is_large ? "w8" : "w"),
                                                       [](TIFF *open) {
                                                           if (open != nullptr)
                                                               TIFFClose(open);
                                                       });
    if (!tiff) {
        if (handle >= 0)
            close(handle);
        file.fail();
    }
    TIFFSetField(tiff.get(), TIFFTAG_IMAGEWIDTH, floats.cols);
    TIFFSetField(tiff.get(), TIFFTAG_IMAGELENGTH, floats.rows);
    TIFFSetField(tiff.get(), TIFFTAG_BITSPERSAMPLE, 32);
    TIFFSetField(tiff.get(), TIFFTAG_SAMPLEFORMAT, SAMPLEFORMAT_IEEEFP);
    TIFFSetField(tiff.get(), TIFFTAG_SAMPLESPERPIXEL, floats.channels());
    TIFFSetField(tiff.get(), TIFFTAG_PHOTOMETRIC, floats.channels() == 3 ? PHOTOMETRIC_RGB : PHOTOMETRIC_MINISBLACK);
    TIFFSetField(tiff.get(), TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff.get(), TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    constexpr std::size_t strip_bytes = 1 << 16;
    TIFFSetField(tiff.get(), TIFFTAG_ROWSPERSTRIP,
                 static_cast<std::uint32_t>(std::max<std::size_t>(1, strip_bytes / (static_cast<std::size_t>(floats.cols) * floats.elemSize()))));
    for (int y = 0; y < floats.rows; y++)
        // Not written to: libtiff takes rows that it may swap bytes in, and swaps none of a file in the machine's own order.
        if (TIFFWriteScanline(tiff.get(), const_cast<unsigned char *>(floats.ptr(y)), static_cast<std::uint32_t>(y), 0) != 1)
            file.fail();
    if (TIFFFlush(tiff.get()) != 1)
        file.fail();
    file.finish();
}
