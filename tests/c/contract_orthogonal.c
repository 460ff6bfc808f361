/* The orthogonal transformation by other methods, and slants from tilts and integrability. */
#include "contract.h"

static struct {
    ofc_orthogonal found;
    ofc_slants slants;
    ofc_annealing_params params;
} out;

static ofc_annealing_params params;
static uint64_t cells[OFC_ORTHOGONAL_ANNEALING_WORKSPACE_SIZE(WIDTH, HEIGHT, 2000) / 8];
static double root[9], tilts[3], norms[3], cosines[3];

static int prepare(void **state)
{
    if (prepare_stages(state) != 0)
        return -1;
    memcpy(root, stages.solution.ellipsoid.root, sizeof root);
    memcpy(norms, stages.solution.ellipsoid.norms, sizeof norms);
    memcpy(cosines, stages.solution.ellipsoid.cosines, sizeof cosines);
    memcpy(tilts, stages.solution.tilts.tilt_rad, sizeof tilts);
    return ofc_annealing_params_default(&params) == OFC_STATUS_OK ? 0 : -1;
}

/* F of both twins is a root of the same C, and the twin is the mirror of the first two rows. */
static void is_sound(const ofc_orthogonal *found)
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            double product = 0;
            for (int k = 0; k < 3; k++)
                product += found->chosen.f[3 * i + k] * found->chosen.f[3 * j + k];
            assert_true(fabs(product / stages.solution.ellipsoid.f_f_transposed[3 * i + j] - 1) < 1e-9);
            const double sign = i < 2 ? -1 : 1;
            assert_true(fabs(found->twin.rows[3 * i + j] - sign * found->chosen.rows[3 * i + j]) < 1e-12);
        }
    assert_true(found->integral.mean <= found->unpolished.mean && found->integral.cells > 1000);
    assert_true(found->margin >= 0 && found->margin <= 1);
}

static ofc_status anneal(const ofc_image *image)
{
    return ofc_orthogonal_annealing(image, &stages.solution.inlier_test, root, tilts, &params, cells, sizeof cells,
                                    &out.found);
}

static void annealing(void **state)
{
    (void)state;
    refuses_bad_images(anneal, &out, sizeof out);
    const ofc_image image = ball_image();
    ofc_inlier_test *inliers = &stages.solution.inlier_test;
    const size_t need = ofc_orthogonal_annealing_workspace_size(WIDTH, HEIGHT, &params);
    assert_int_equal(need, sizeof cells);
    assert_int_equal(ofc_orthogonal_annealing_workspace_size(10, 10, &params),
                     OFC_ORTHOGONAL_ANNEALING_WORKSPACE_SIZE(10, 10, 2000));
    assert_int_equal(ofc_orthogonal_annealing_workspace_size(-1, 10, &params), 0);
    assert_int_equal(ofc_orthogonal_annealing_workspace_size(10, 10, NULL), 0);
#define ANNEAL(inliers, root, tilts, params, space, bytes, found)                                                      \
    ofc_orthogonal_annealing(&image, inliers, root, tilts, params, space, bytes, found)
    REFUSED(OFC_STATUS_NULL_POINTER, out, ANNEAL(inliers, NULL, tilts, &params, cells, need, &out.found));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ANNEAL(inliers, root, tilts, NULL, cells, need, &out.found));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ANNEAL(inliers, root, tilts, &params, NULL, need, &out.found));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ANNEAL(inliers, root, tilts, &params, cells, need, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ANNEAL(MISALIGNED(inliers), root, tilts, &params, cells, need, &out.found));
    REFUSED(OFC_STATUS_MISALIGNED, out, ANNEAL(inliers, MISALIGNED(root), tilts, &params, cells, need, &out.found));
    REFUSED(OFC_STATUS_MISALIGNED, out, ANNEAL(inliers, root, MISALIGNED(tilts), &params, cells, need, &out.found));
    REFUSED(OFC_STATUS_MISALIGNED, out, ANNEAL(inliers, root, tilts, MISALIGNED(&params), cells, need, &out.found));
    REFUSED(OFC_STATUS_MISALIGNED, out, ANNEAL(inliers, root, tilts, &params, MISALIGNED(cells), need, &out.found));
    REFUSED(OFC_STATUS_MISALIGNED, out, ANNEAL(inliers, root, tilts, &params, cells, need, MISALIGNED(&out.found)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, ANNEAL(inliers, root, tilts, &params, cells, need - 1, &out.found));
    REFUSED(OFC_STATUS_OVERLAP, out, ANNEAL(inliers, root, tilts, &params, cells, need, (ofc_orthogonal *)cells));
    REFUSED(OFC_STATUS_OVERLAP, out, ANNEAL(inliers, (double *)cells, tilts, &params, cells, need, &out.found));
    const double nan[9] = {NAN}, zero[9] = {0};
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ANNEAL(inliers, nan, tilts, &params, cells, need, &out.found));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ANNEAL(inliers, zero, tilts, &params, cells, need, &out.found));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, ANNEAL(inliers, root, nan, &params, cells, need, &out.found));
    ofc_annealing_params bad;
#define BAD(status, field, value)                                                                                      \
    (bad = params, bad.field = (value));                                                                               \
    REFUSED(status, out, ANNEAL(inliers, root, tilts, &bad, cells, need, &out.found));                                 \
    assert_int_equal(ofc_orthogonal_annealing_workspace_size(WIDTH, HEIGHT, &bad), 0)
    BAD(OFC_STATUS_INVALID_PARAMETER, proposals, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, proposals, UINT32_MAX);
    BAD(OFC_STATUS_INVALID_PARAMETER, chains, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, sample_cells, 0);
    BAD(OFC_STATUS_INVALID_PARAMETER, polish_evaluations, UINT32_MAX);
    BAD(OFC_STATUS_INVALID_PARAMETER, temperatures[0], NAN);
    BAD(OFC_STATUS_INVALID_PARAMETER, angles_rad[1], 0);
    BAD(OFC_STATUS_RESERVED_NOT_ZERO, reserved[3], 1);
#undef BAD
    ofc_image row = image;
    row.height = 1;
    assert_int_equal(anneal(&row), OFC_STATUS_NO_CELLS);
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_annealing_params_default(NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_annealing_params_default(MISALIGNED(&out.params)));

    assert_int_equal(anneal(&image), OFC_STATUS_OK);
    assert_int_equal(out.found.choice, OFC_TWIN_TILTS);
    is_sound(&out.found);
    /* The ball is convex: without tilts the convex twin is the same one. */
    static ofc_orthogonal convex;
    memset(cells, 0xff, sizeof cells);
    assert_int_equal(ANNEAL(inliers, root, NULL, &params, cells, need, &convex), OFC_STATUS_OK);
    assert_int_equal(convex.choice, OFC_TWIN_CONVEX);
    assert_memory_equal(&convex.chosen, &out.found.chosen, sizeof convex.chosen);
}

static ofc_status closed(const ofc_image *image)
{
    return ofc_orthogonal_closed_form(image, &stages.solution.inlier_test, root, tilts, 60, &out.found);
}

static void closed_form(void **state)
{
    (void)state;
    refuses_bad_images(closed, &out, sizeof out);
    ofc_image image = ball_image();
    ofc_inlier_test *inliers = &stages.solution.inlier_test;
#define CLOSED(inliers, root, tilts, evaluations, found)                                                               \
    ofc_orthogonal_closed_form(&image, inliers, root, tilts, evaluations, found)
    REFUSED(OFC_STATUS_NULL_POINTER, out, CLOSED(inliers, NULL, tilts, 60, &out.found));
    REFUSED(OFC_STATUS_NULL_POINTER, out, CLOSED(inliers, root, tilts, 60, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, CLOSED(MISALIGNED(inliers), root, tilts, 60, &out.found));
    REFUSED(OFC_STATUS_MISALIGNED, out, CLOSED(inliers, MISALIGNED(root), tilts, 60, &out.found));
    REFUSED(OFC_STATUS_MISALIGNED, out, CLOSED(inliers, root, MISALIGNED(tilts), 60, &out.found));
    REFUSED(OFC_STATUS_MISALIGNED, out, CLOSED(inliers, root, tilts, 60, MISALIGNED(&out.found)));
    static ofc_orthogonal shared;
    REFUSED(OFC_STATUS_OVERLAP, out, CLOSED(inliers, shared.chosen.f, tilts, 60, &shared));
    const double infinite[9] = {INFINITY};
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, CLOSED(inliers, infinite, tilts, 60, &out.found));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, CLOSED(inliers, root, infinite, 60, &out.found));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, CLOSED(inliers, root, tilts, UINT32_MAX, &out.found));
    assert_int_equal(closed(&image), OFC_STATUS_OK);
    is_sound(&out.found);
    const double polished = out.found.integral.mean;
    assert_int_equal(anneal(&image), OFC_STATUS_OK);
    assert_true(fabs(out.found.integral.mean / polished - 1) < 0.01);
    assert_int_equal(CLOSED(inliers, root, NULL, 0, &out.found), OFC_STATUS_OK);
    assert_true(out.found.integral.mean == out.found.unpolished.mean && out.found.integral.mean >= polished);
    image.height = 1;
    assert_int_equal(closed(&image), OFC_STATUS_NO_CELLS);
}

static ofc_status integrable(const ofc_image *image)
{
    return ofc_constrained_slants_integrable(image, &stages.solution.inlier_test, norms, tilts, cosines, 0.05, 2000, cells,
                                             sizeof cells, &out.slants);
}

static void constrained_slants_integrable(void **state)
{
    (void)state;
    refuses_bad_images(integrable, &out, sizeof out);
    ofc_image image = ball_image();
    ofc_inlier_test *inliers = &stages.solution.inlier_test;
    const size_t need = ofc_constrained_slants_integrable_workspace_size(WIDTH, HEIGHT, 2000);
    assert_int_equal(need, OFC_CONSTRAINED_SLANTS_INTEGRABLE_WORKSPACE_SIZE(WIDTH, HEIGHT, 2000));
    assert_int_equal(ofc_constrained_slants_integrable_workspace_size(WIDTH, 0, 2000), 0);
#define SLANTS(inliers, n, t, h, slack, samples, space, bytes, out)                                                    \
    ofc_constrained_slants_integrable(&image, inliers, n, t, h, slack, samples, space, bytes, out)
    REFUSED(OFC_STATUS_NULL_POINTER, out, SLANTS(inliers, NULL, tilts, cosines, 0.05, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SLANTS(inliers, norms, NULL, cosines, 0.05, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SLANTS(inliers, norms, tilts, NULL, 0.05, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SLANTS(inliers, norms, tilts, cosines, 0.05, 2000, NULL, need, &out.slants));
    REFUSED(OFC_STATUS_NULL_POINTER, out, SLANTS(inliers, norms, tilts, cosines, 0.05, 2000, cells, need, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, SLANTS(MISALIGNED(inliers), norms, tilts, cosines, 0.05, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_MISALIGNED, out, SLANTS(inliers, MISALIGNED(norms), tilts, cosines, 0.05, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_MISALIGNED, out, SLANTS(inliers, norms, tilts, cosines, 0.05, 2000, MISALIGNED(cells), need, &out.slants));
    REFUSED(OFC_STATUS_MISALIGNED, out, SLANTS(inliers, norms, tilts, cosines, 0.05, 2000, cells, need, MISALIGNED(&out.slants)));
    REFUSED(OFC_STATUS_WORKSPACE_TOO_SMALL, out, SLANTS(inliers, norms, tilts, cosines, 0.05, 2000, cells, need - 1, &out.slants));
    REFUSED(OFC_STATUS_OVERLAP, out, SLANTS(inliers, norms, tilts, cosines, 0.05, 2000, cells, need, (ofc_slants *)cells));
    REFUSED(OFC_STATUS_OVERLAP, out, SLANTS(inliers, (double *)cells, tilts, cosines, 0.05, 2000, cells, need, &out.slants));
    const double nan[3] = {NAN, 1, 1}, zero[3] = {0, 1, 1}, large[3] = {2, 0, 0};
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SLANTS(inliers, nan, tilts, cosines, 0.05, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SLANTS(inliers, zero, tilts, cosines, 0.05, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SLANTS(inliers, norms, nan, cosines, 0.05, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SLANTS(inliers, norms, tilts, large, 0.05, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SLANTS(inliers, norms, tilts, cosines, -1, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SLANTS(inliers, norms, tilts, cosines, NAN, 2000, cells, need, &out.slants));
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, SLANTS(inliers, norms, tilts, cosines, 0.05, 0, cells, need, &out.slants));
    assert_int_equal(integrable(&image), OFC_STATUS_OK);
    for (int c = 0; c < 3; c++)
        assert_true(out.slants.slant_rad[c] >= 0 && out.slants.slant_rad[c] <= 1.5708);
    assert_true(out.slants.residual <= 0.0501 && out.slants.integral > 0);
    image.height = 1;
    REFUSED(OFC_STATUS_NO_CELLS, out, integrable(&image));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(annealing),
        cmocka_unit_test(closed_form),
        cmocka_unit_test(constrained_slants_integrable),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
