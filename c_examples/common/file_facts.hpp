// What a picture's file says of itself beside its pixels.
#pragma once

#include <string>
#include <vector>

// How the file says that light was stored.
struct FileTransfer {
    enum class Kind { unsaid, linear, srgb, curve };
    Kind kind = Kind::unsaid;
    std::string source;       // where it says so, as "its ICC profile (Display P3)"
    double gamma = 0;         // of a curve, as far as one number says it
    std::vector<float> curve; // 1024 steps of a curve, from 0 to 1, the light of stored values from 0 to 1
};

struct FileFacts {
    int orientation = 1; // EXIF's, from 1 to 8
    FileTransfer transfer;
    bool is_jpeg = false, is_png = false, is_tiff = false;
};

// Reads it; what a file does not say stays as above.
FileFacts facts_of(const std::vector<unsigned char> &bytes);

// EXIF's orientations in words: how the picture was turned.
const char *orientation_in_words(int orientation);
