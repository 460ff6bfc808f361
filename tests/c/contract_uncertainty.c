/* Covariances, and the 1-sigma angles of normals. */
#include "contract.h"

enum { PADDED = WIDTH + 5 };

static struct {
    ofc_covariance covariance;
    float angles[HEIGHT * PADDED + 8];
} out;

/* The default method knows how sure it is. */
static ofc_solution solution;

static int prepare(void **state)
{
    return prepare_jointly(state, &solution) || solution.confidence.evidence == OFC_EVIDENCE_TILTS_ALONE;
}

static const size_t row = WIDTH * sizeof(float);

static ofc_status angles(const ofc_image *image)
{
    return ofc_normals_uncertainty(image, &solution, out.angles, row);
}

static void refused(void **state)
{
    (void)state;
    refuses_bad_images(angles, &out, sizeof out);
    const ofc_image image = ball_image();
#define ANGLES(solution, angles, stride) ofc_normals_uncertainty(&image, solution, angles, stride)
    REFUSED(OFC_STATUS_NULL_POINTER, out, ANGLES(NULL, out.angles, row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ANGLES(&solution, NULL, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, ANGLES(MISALIGNED(&solution), out.angles, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, ANGLES(&solution, MISALIGNED(out.angles), row));
    REFUSED(OFC_STATUS_MISALIGNED, out, ANGLES(&solution, out.angles, row + 2));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, ANGLES(&solution, out.angles, row - 4));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, ANGLES(&solution, out.angles, 0));
    REFUSED(OFC_STATUS_TOO_LARGE, out, ANGLES(&solution, out.angles, SIZE_MAX - 3));
    static union {
        uint8_t pixels[HEIGHT][WIDTH][3];
        float angles[PIXELS];
    } shared;
    ofc_image same = image;
    same.pixels = shared.pixels;
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_normals_uncertainty(&same, &solution, shared.angles, row));
    static union {
        ofc_solution solution;
        ofc_covariance covariance;
        float angles[PIXELS];
    } mixed;
    mixed.solution = solution;
    REFUSED(OFC_STATUS_OVERLAP, out, ANGLES(&mixed.solution, mixed.angles, row));
    REFUSED(OFC_STATUS_OVERLAP, out, ofc_solution_covariance(&mixed.solution, &mixed.covariance));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_solution_covariance(NULL, &out.covariance));
    REFUSED(OFC_STATUS_NULL_POINTER, out, ofc_solution_covariance(&solution, NULL));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_solution_covariance(MISALIGNED(&solution), &out.covariance));
    REFUSED(OFC_STATUS_MISALIGNED, out, ofc_solution_covariance(&solution, MISALIGNED(&out.covariance)));
}

/* A solution that must be refused, by both calls. */
static void refuses(ofc_status status, const ofc_solution *bad)
{
    const ofc_image image = ball_image();
    REFUSED(status, out, ANGLES(bad, out.angles, row));
    REFUSED(status, out, ofc_solution_covariance(bad, &out.covariance));
}

static void bad_solutions_refused(void **state)
{
    (void)state;
    ofc_solution bad;
    memset(&bad, 0, sizeof bad);
    refuses(OFC_STATUS_NOT_SOLVED, &bad);
    bad = solution;
    bad.outcome = OFC_STATUS_NO_TILT;
    refuses(OFC_STATUS_NOT_SOLVED, &bad);
    assert_int_equal(stages.solution.confidence.evidence, OFC_EVIDENCE_TILTS_ALONE);
    refuses(OFC_STATUS_NO_COVARIANCE, &stages.solution);
#define BAD(field, value)                                                                                              \
    do {                                                                                                               \
        bad = solution;                                                                                                \
        bad.field = (value);                                                                                           \
        refuses(OFC_STATUS_INVALID_PARAMETER, &bad);                                                                   \
    } while (0)
    BAD(orientation.f[4], NAN);
    BAD(orientation.f_inverse[0], INFINITY);
    BAD(confidence.covariance[8], NAN);
    BAD(fit.covariance[20], NAN);
    BAD(fit.pixel_noise, NAN);
    BAD(fit.pixel_noise, -1);
}

static void angles_written(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    static uint8_t mask[PIXELS];
    assert_int_equal(ofc_inlier_test_apply(&image, &solution.inlier_test, mask, NULL), OFC_STATUS_OK);
    memset(&out, PATTERN, sizeof out);
    assert_int_equal(ANGLES(&solution, out.angles, PADDED * sizeof(float)), OFC_STATUS_OK);
    for (int y = 0; y < HEIGHT; y++) {
        for (int x = 0; x < WIDTH; x++) {
            const float angle = out.angles[y * PADDED + x];
            assert_true(mask[y * WIDTH + x] ? angle > 0 && angle < 0.5F : angle == 3.14159265F);
        }
        assert_true(is_untouched(out.angles + y * PADDED + WIDTH, 5 * sizeof(float)));
    }
    assert_true(is_untouched(out.angles + HEIGHT * PADDED, 8 * sizeof(float)));
    /* Nothing finite makes a number that is none. */
    ofc_solution wild = solution;
    for (int i = 0; i < 9; i++)
        wild.confidence.covariance[i] = i % 2 ? -1e300 : 1e300;
    assert_int_equal(angles(&image), OFC_STATUS_OK);
    assert_int_equal(ANGLES(&wild, out.angles, row), OFC_STATUS_OK);
    for (int i = 0; i < PIXELS; i++)
        assert_true(out.angles[i] >= 0 && out.angles[i] <= 3.14159275F);
}

#define WEIGHTS(solution, index, weights, stride) ofc_normals_matte_weight(&image, solution, index, weights, stride)

static ofc_status weights(const ofc_image *image)
{
    return ofc_normals_matte_weight(image, &solution, 1.5, out.angles, row);
}

static void matte_weights_refused(void **state)
{
    (void)state;
    refuses_bad_images(weights, &out, sizeof out);
    const ofc_image image = ball_image();
    REFUSED(OFC_STATUS_NULL_POINTER, out, WEIGHTS(NULL, 1.5, out.angles, row));
    REFUSED(OFC_STATUS_NULL_POINTER, out, WEIGHTS(&solution, 1.5, NULL, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, WEIGHTS(MISALIGNED(&solution), 1.5, out.angles, row));
    REFUSED(OFC_STATUS_MISALIGNED, out, WEIGHTS(&solution, 1.5, MISALIGNED(out.angles), row));
    REFUSED(OFC_STATUS_MISALIGNED, out, WEIGHTS(&solution, 1.5, out.angles, row + 2));
    REFUSED(OFC_STATUS_STRIDE_TOO_SMALL, out, WEIGHTS(&solution, 1.5, out.angles, row - 4));
    REFUSED(OFC_STATUS_TOO_LARGE, out, WEIGHTS(&solution, 1.5, out.angles, SIZE_MAX - 3));
    const double bad[] = {0.999, 0, -1.5, NAN, INFINITY};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        REFUSED(OFC_STATUS_INVALID_PARAMETER, out, WEIGHTS(&solution, bad[i], out.angles, row));
    static union {
        ofc_solution solution;
        float weights[PIXELS];
    } mixed;
    mixed.solution = solution;
    REFUSED(OFC_STATUS_OVERLAP, out, WEIGHTS(&mixed.solution, 1.5, mixed.weights, row));
    ofc_solution wrong = solution;
    wrong.outcome = OFC_STATUS_NO_TILT;
    REFUSED(OFC_STATUS_NOT_SOLVED, out, WEIGHTS(&wrong, 1.5, out.angles, row));
    wrong = solution;
    wrong.orientation.f_inverse[4] = NAN;
    REFUSED(OFC_STATUS_INVALID_PARAMETER, out, WEIGHTS(&wrong, 1.5, out.angles, row));
}

static void matte_weights_written(void **state)
{
    (void)state;
    const ofc_image image = ball_image();
    static uint8_t mask[PIXELS];
    static float normals[PIXELS * 3];
    assert_int_equal(ofc_inlier_test_apply(&image, &solution.inlier_test, mask, NULL), OFC_STATUS_OK);
    assert_int_equal(ofc_normals_compute(&image, &solution, normals, 3 * row), OFC_STATUS_OK);
    for (int n = 0; n < 2; n++) {
        const double index = n == 0 ? 1 : 1.5;
        memset(&out, PATTERN, sizeof out);
        assert_int_equal(WEIGHTS(&solution, index, out.angles, PADDED * sizeof(float)), OFC_STATUS_OK);
        for (int y = 0; y < HEIGHT; y++) {
            for (int x = 0; x < WIDTH; x++) {
                const double weight = (double)out.angles[y * PADDED + x];
                const double toward = (double)normals[(y * WIDTH + x) * 3 + 2];
                /* Fresnel's reflectances for light across and along the plane of incidence. */
                const double inside = sqrt(1 - (1 - toward * toward) / (index * index));
                const double across = (toward - index * inside) / (toward + index * inside);
                const double along = (index * toward - inside) / (index * toward + inside);
                const double upright = (index - 1) / (index + 1);
                const double wanted = (1 - (across * across + along * along) / 2) / (1 - upright * upright);
                assert_true(mask[y * WIDTH + x] ? toward > 0 && fabs(weight - wanted) < 1e-5 : weight == 0);
            }
            assert_true(is_untouched(out.angles + y * PADDED + WIDTH, 5 * sizeof(float)));
        }
        assert_true(is_untouched(out.angles + HEIGHT * PADDED, 8 * sizeof(float)));
    }
}

static void covariances_written(void **state)
{
    (void)state;
    assert_int_equal(ofc_solution_covariance(&solution, &out.covariance), OFC_STATUS_OK);
    const ofc_covariance *found = &out.covariance;
    assert_true(found->pixel_noise == solution.fit.pixel_noise && found->pixel_noise > 0);
    assert_memory_equal(found->rotation, solution.confidence.covariance, sizeof found->rotation);
    for (int i = 0, k = 0; i < 6; i++) {
        /* At least what least squares alone says. */
        const double error = solution.fit.coefficients[i].standard_error;
        assert_true(found->c[7 * i] > 0.999 * error * error);
        for (int j = i; j < 6; j++, k++) {
            assert_true(found->c[6 * i + j] == solution.fit.covariance[k]);
            assert_true(found->c[6 * i + j] == found->c[6 * j + i]);
        }
    }
    for (int i = 0; i < 9; i++) {
        assert_true(found->f[10 * i] > 0 && found->f_inverse[10 * i] > 0);
        for (int j = 0; j < 9; j++) {
            const double f = sqrt(found->f[10 * i] * found->f[10 * j]);
            const double f_inverse = sqrt(found->f_inverse[10 * i] * found->f_inverse[10 * j]);
            assert_true(fabs(found->f[9 * i + j] - found->f[9 * j + i]) <= 1e-9 * f);
            assert_true(fabs(found->f[9 * i + j]) <= 1.000001 * f);
            assert_true(fabs(found->f_inverse[9 * i + j]) <= 1.000001 * f_inverse);
        }
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(refused),
        cmocka_unit_test(bad_solutions_refused),
        cmocka_unit_test(angles_written),
        cmocka_unit_test(matte_weights_refused),
        cmocka_unit_test(matte_weights_written),
        cmocka_unit_test(covariances_written),
    };
    return cmocka_run_group_tests(tests, prepare, NULL);
}
