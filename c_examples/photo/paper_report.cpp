#include "photo/paper_report.hpp"

#include "common/channels.hpp"
#include "common/draw.hpp"
#include "common/plot_colors.hpp"
#include "common/plot_directions.hpp"
#include "common/plot_slants.hpp"

#include <cstdio>

void print_paper_report(const Picture &picture, const Result &direct)
{
    const ofc_solution &s = direct.solution;
    const Estimates estimates = estimates_of(picture.view(), s.inlier_test);
    std::printf("the direct method of the paper; shadows %s\n\n", direct.shadows.c_str());
    Table table;
    table.angles("tilt", "Pentland", triple(s.tilts.tilt_rad));
    table.angles("slant", "OFC", triple(s.slant_rad));
    table.angles("slant", "Pentland", estimates.pentland_slants);
    table.angles("slant", "Lee-Rosenfeld", estimates.lee_rosenfeld_slants);
    table.numbers("norm", "OFC", triple(s.ellipsoid.norms));
    table.numbers("norm", "channel maxima", estimates.channel_maxima);
    table.print();
    std::printf("\nrobust R² %.4f, location of norms %.4f\n", s.fit.r_squared, s.norm_location.location);
    for (const auto &c : s.fit.coefficients)
        std::printf("  coefficient %12.4e, t %8.1f, p %.2g\n", c.value, c.t, c.p);
    std::printf("ranks: colors %d, normals %d\n", s.rank.colors, s.rank.normals);
    if (direct.median_error_deg)
        std::printf("median angular error: %.2f degrees\n", *direct.median_error_deg);
    if (!direct.check)
        return;
    const ofc_check_result &check = *direct.check;
    std::printf("norms of normals: median %.4f, from %.4f to %.4f\n", check.norm_median, check.norm_min, check.norm_max);
    std::printf("correlation of input and relit channels: %.5f, %.5f, %.5f\n", check.correlation[0], check.correlation[1],
                check.correlation[2]);
    const auto angles = [](const char *what, const double *values) {
        std::printf("%s: %.2f, %.2f, %.2f degrees\n", what, degrees(values[0]), degrees(values[1]), degrees(values[2]));
    };
    angles("Pentland's tilts on the relit channels, minus the input's", check.tilt_difference_rad);
    angles("Pentland's tilts on the shaded depth, minus the input's", check.depth_tilt_difference_rad);
    std::printf("median angle between the normals and those of the depth: %.2f degrees\n",
                degrees(check.depth_angle_median_rad));
    if (check.has_turn)
        std::printf("turn that integrability and outward normals ask for: %.2f degrees, of %.2f expected for a right F; "
                    "convexity %.2f\n",
                    degrees(check.turn_rad), degrees(check.turn_expected_rad), check.convexity);
}

void write_paper_figures(const std::filesystem::path &folder, const Picture &picture, const Result &direct)
{
    const ofc_solution &s = direct.solution;
    write_png(folder / paper_figures[0], plot_directions(triple(s.slant_rad), triple(s.tilts.tilt_rad),
                                                         triple(s.ellipsoid.cosines), Sheet::panel(3)));
    write_png(folder / paper_figures[1], plot_slants(FixedPointProblem::of(s), Sheet::panel()));
    write_png(folder / paper_figures[2], plot_colors(picture, s, direct.inliers, Sheet::panel()));
    if (direct.check)
        write_png(folder / paper_figures[3], channels_picture(picture, direct.inliers, direct.normals, s.orientation.f,
                                                              direct.check->correlation));
}
