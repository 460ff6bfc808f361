#include "table1/experiment.hpp"

#include "common/reason.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace {

ofc_status solve(const ofc_image &image, const ofc_solve_params &params, cv::Mat *inliers, ofc_solution &solution)
{
    ofc::Workspace workspace(ofc_solve_workspace_size(image.width, image.height, &params));
    return ofc_solve(&image, &params, workspace.data(), workspace.bytes(), inliers ? inliers->data : nullptr, &solution);
}

// Unit normals of the inliers by a matrix (F^-1, or the root of C).
cv::Mat normals_by(const ofc_image &image, const ofc_inlier_test &inliers, const double *matrix)
{
    cv::Mat normals = cv::Mat::zeros(image.height, image.width, CV_32FC3);
    ofc_normals_from_matrix(&image, &inliers, matrix, OFC_NORMALIZATION_UNIT, normals.ptr<float>(), normals.step);
    return normals;
}

Answer answer(const std::string &name, const cv::Mat &normals, const cv::Mat &truth)
{
    return {name, normals, median_angle_deg(normals, truth), ""};
}

Answer refusal(const std::string &name, ofc_status status)
{
    return {name, cv::Mat(), std::nullopt, ofc_status_message(status)};
}

// `from` turned by the orthogonal matrix that brings it nearest to `to` in the sum of distances: Procrustes, repeated
// with weights, because plain least squares is decided by the shadowed pixels that the rejection let through.
cv::Mat turned_to(const cv::Mat &from, const cv::Mat &to)
{
    cv::Matx33d best = cv::Matx33d::zeros(); // all distances alike: the first round is least squares
    constexpr int rounds = 20;
    for (int round = 0; round < rounds; round++) {
        cv::Matx33d sum = cv::Matx33d::zeros();
        for (int y = 0; y < from.rows; y++)
            for (int x = 0; x < from.cols; x++) {
                const cv::Vec3d n = from.at<cv::Vec3f>(y, x), t = to.at<cv::Vec3f>(y, x);
                sum += t * n.t() * (1 / std::max(cv::norm(best * n - t), 1e-3)); // zero where either has no normal
            }
        cv::Matx33d u, vt;
        cv::Matx31d values;
        cv::SVD::compute(sum, values, u, vt);
        best = u * vt;
    }
    cv::Mat turned;
    cv::transform(from, turned, best);
    return turned;
}

// Fig. 4(b): the integral along the branch of the solution, slants 2 and 3 by one iteration of eqs. 25.
std::vector<cv::Vec2d> along_branch(const ofc_image &image, const ofc_solution &s)
{
    std::vector<cv::Vec2d> points;
    if (s.slant_source != OFC_SLANTS_ROOT)
        return points;
    constexpr int samples = 181;
    std::vector<cv::Vec3d> slants(samples);
    std::vector<double> f(samples);
    ofc_slant_curve_sample(s.tilts.tilt_rad, s.ellipsoid.cosines, s.candidates[s.chosen].branch, samples, slants[0].val,
                           f.data());
    for (const cv::Vec3d &slant : slants) {
        ofc_orientation orientation;
        ofc_integrability integral;
        if (ofc_orientation_compose(s.ellipsoid.norms, s.tilts.tilt_rad, slant.val, 1e-3, &orientation) == OFC_STATUS_OK &&
            orientation.rank == 3 &&
            ofc_integrability_integral(&image, &s.inlier_test, orientation.f_inverse, &integral) == OFC_STATUS_OK &&
            integral.mean > 0)
            points.emplace_back(degrees(slant[0]), std::log10(integral.mean));
    }
    return points;
}

// Table 1; `given` is the solution with the correct tilts, or null where there is none.
Table table_of(const ofc_image &image, const Directions &correct, const ofc_solution &s, const ofc_solution *given)
{
    const Estimates estimates = estimates_of(image, s.inlier_test);
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    Table table;
    table.angles("tilt", "correct", correct.tilts);
    table.angles("tilt", "Pentland", triple(s.tilts.tilt_rad));
    table.angles("slant", "correct", correct.slants);
    table.angles("slant", "OFC", triple(s.slant_rad));
    table.angles("slant", "OFC (correct tilts)", given ? triple(given->slant_rad) : Triple{none, none, none});
    table.angles("slant", "Pentland", estimates.pentland_slants);
    table.angles("slant", "Lee-Rosenfeld", estimates.lee_rosenfeld_slants);
    table.angles("slant", "Zheng-Chellappa", estimates.zheng_chellappa_slants);
    table.numbers("norm", "correct", correct.norms);
    table.numbers("norm", "OFC", triple(s.ellipsoid.norms));
    table.numbers("norm", "channel maxima", estimates.channel_maxima);
    return table;
}

} // namespace

cv::Vec2d Experiment::least_on_branch() const
{
    return *std::min_element(branch.begin(), branch.end(), [](const cv::Vec2d &a, const cv::Vec2d &b) { return a[1] < b[1]; });
}

Experiment run_experiment(const Relief &relief, const ExperimentParams &wanted)
{
    Experiment e;
    e.scene = render(relief, wanted.noise, wanted.seed);
    const cv::Mat &truth = e.scene.normals;
    const ofc_image image = e.scene.picture.view();
    e.inliers = cv::Mat::zeros(truth.size(), CV_8U);
    ofc_solve_params params;
    ofc_solve_params_default(&params);
    params.lmeds.seed = wanted.seed;
    params.orientation_method = OFC_ORIENTATION_DIRECT;
    wanted.shadows.apply_to(params);
    ofc_solution &s = e.solution;
    e.status = solve(image, params, &e.inliers, s);
    e.shadows = wanted.shadows.in_words(params, s);
    if (e.status < 0)
        explain_refusal(image, params, s);
    if (e.status != OFC_STATUS_OK)
        return e;
    ofc::Workspace for_check(ofc_check_workspace_size(image.width, image.height));
    ofc_check_result check;
    if (ofc_check(&image, &s, nullptr, for_check.data(), for_check.bytes(), &check) == OFC_STATUS_OK)
        std::copy_n(check.correlation, 3, e.correlation);

    const Directions correct = directions_of(e.scene.f);
    ofc_solution given = {};
    params.tilt_estimator = OFC_TILT_GIVEN;
    std::copy(correct.tilts.begin(), correct.tilts.end(), params.tilt_rad);
    const ofc_status with_tilts = solve(image, params, nullptr, given);
    ofc_solution joint = {};
    params.tilt_estimator = OFC_TILT_PENTLAND;
    params.orientation_method = OFC_ORIENTATION_JOINT;
    const ofc_status jointly = solve(image, params, nullptr, joint);
    e.joint_shadows = wanted.shadows.in_words(params, joint);
    e.table = table_of(image, correct, s, with_tilts == OFC_STATUS_OK ? &given : nullptr);

    const auto add = [&](const std::string &name, ofc_status status, const double *f_inverse) {
        e.answers.push_back(status == OFC_STATUS_OK ? answer(name, normals_by(image, s.inlier_test, f_inverse), truth)
                                                    : refusal(name, status));
    };
    add("direct method (OFC)", OFC_STATUS_OK, s.orientation.f_inverse);
    add("direct method, correct tilts", with_tilts, given.orientation.f_inverse);
    add("joint method", jointly, joint.orientation.f_inverse);
    ofc_annealing_params annealing;
    ofc_annealing_params_default(&annealing);
    annealing.seed = wanted.seed;
    ofc::Workspace workspace(ofc_orthogonal_annealing_workspace_size(image.width, image.height, &annealing));
    ofc_orthogonal found;
    const ofc_status annealed = ofc_orthogonal_annealing(&image, &s.inlier_test, s.ellipsoid.root, correct.tilts.data(),
                                                         &annealing, workspace.data(), workspace.bytes(), &found);
    add("least integral (15), annealing", annealed, found.chosen.f_inverse);
    const ofc_status closed =
        ofc_orthogonal_closed_form(&image, &s.inlier_test, s.ellipsoid.root, correct.tilts.data(), 60, &found);
    add("least integral (15), closed form", closed, found.chosen.f_inverse);
    e.answers.push_back(answer("best orthogonal matrix", turned_to(normals_by(image, s.inlier_test, s.ellipsoid.root), truth), truth));
    e.branch = along_branch(image, s);
    return e;
}
