// Whether the unit of a range map's depth is that of its pixels.
#pragma once

#include "common/scene.hpp"

// Throws UsageError, which asks for --pixel-pitch, where the slopes are not those of a surface that a camera could see:
// more than 15 % of the pixels steeper than 80 degrees, or nearly all within 1 degree of flat but not exactly flat.
void require_usable_slopes(const Relief &relief, const std::string &name);
