//! The numbers that the paper prints: Table 1, Figure 1 and Figure 2.

use ofc_core::color::ellipsoid::{self, Ellipsoid};
use ofc_core::light::constrained_slant::roots;
use ofc_core::orientation::matrix;
use ofc_tests::linear::{Matrix, degrees_between, inverse, length, multiply, transpose};
use ofc_tests::linear_scenes::{direction, table_1_f};
use ofc_tests::tolerances::{LAST_PRINTED_DIGIT, ONE_DECIMAL, TWO_DECIMALS};

const TILTS: [f64; 3] = [-36.80, -149.91, -136.55];
const SLANTS: [f64; 3] = [23.26, 30.63, 10.87];
const NORMS: [f64; 3] = [156.06, 164.96, 145.68];

#[track_caller]
fn assert_close(got: [f64; 3], wanted: [f64; 3], tolerance: f64) {
    for (got, wanted) in got.iter().zip(wanted) {
        assert!((got - wanted).abs() <= tolerance, "{got} is not {wanted}");
    }
}

/// What the core makes of C = (F F^T)^-1.
fn decomposed(f: Matrix) -> Ellipsoid {
    let c = inverse(multiply(f, transpose(f)));
    ellipsoid::decompose(&[c[0][0], c[1][1], c[2][2], c[0][1], c[0][2], c[1][2]]).expect("an ellipsoid")
}

fn true_tilts() -> [f64; 3] {
    table_1_f().map(|row| row[1].atan2(row[0]))
}

#[test]
fn the_correct_rows_follow_from_lights_and_colors() {
    // "The image was scaled uniformly such that the maximum value of the modulus of rho is 255": only the ratios of the
    // norms are known beforehand.
    let factor = NORMS[0] / length(table_1_f()[0]);
    let f = table_1_f().map(|row| row.map(|entry| factor * entry));
    assert_close(true_tilts().map(f64::to_degrees), TILTS, LAST_PRINTED_DIGIT);
    assert_close(f.map(|row| (row[2] / length(row)).acos().to_degrees()), SLANTS, TWO_DECIMALS);
    let ellipsoid = decomposed(f);
    assert_close(ellipsoid.norms, NORMS, LAST_PRINTED_DIGIT);
    let angles =
        [(0, 1), (0, 2), (1, 2)].map(|(i, j): (usize, usize)| degrees_between(f[i], f[j]).to_radians().cos());
    assert_close(ellipsoid.cosines, angles, 1e-12);
    // And back: F from the printed numbers.
    let again = matrix::compose(NORMS, SLANTS.map(f64::to_radians), TILTS.map(f64::to_radians));
    for (row, wanted) in again.iter().zip(f) {
        // A row's length times what the printed angles leave open, and what the printed norm does.
        assert_close(*row, wanted, NORMS[1] * 2.0 * LAST_PRINTED_DIGIT.to_radians() + LAST_PRINTED_DIGIT);
    }
}

#[test]
fn the_color_matrix_as_printed_does_not_give_them() {
    let mut colors = ofc_tests::linear_scenes::TABLE_1_COLORS;
    colors[2][2] = 50.0;
    let f = multiply(colors, ofc_tests::linear_scenes::table_1_lights());
    let ratio = length(f[2]) / length(f[0]);
    assert!((ratio - NORMS[2] / NORMS[0]).abs() > 0.05, "the misprint is none: {ratio}");
}

#[test]
fn true_tilts_give_the_true_slants() {
    let found = roots(true_tilts(), decomposed(table_1_f()).cosines);
    assert!(
        found
            .iter()
            .any(|root| (0..3).all(|i| (root.slants[i].to_degrees() - SLANTS[i]).abs() <= TWO_DECIMALS)),
        "{found:?}"
    );
}

#[test]
fn pentland_s_tilts_of_table_1_with_exact_cosines() {
    let tilts = [-30.0, -154.60, -141.01].map(f64::to_radians);
    let found = roots(tilts, decomposed(table_1_f()).cosines);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_close(found[0].slants.map(f64::to_degrees), [24.03, 26.75, 6.80], TWO_DECIMALS);
}

#[test]
fn figures_1_and_2() {
    let tilts = [20.0, -120.0, 0.0];
    let e = [direction(40.0, tilts[0]), direction(30.0, tilts[1]), direction(5.0, tilts[2])];
    let pairs = [(0, 1), (1, 2), (2, 0)].map(|(i, j): (usize, usize)| degrees_between(e[i], e[j]));
    assert_close(pairs, [65.3, 32.8, 35.3], ONE_DECIMAL);
    let found = roots(tilts.map(f64::to_radians), decomposed(e).cosines);
    assert_eq!(found.len(), 2, "{found:?}");
    assert_close(found[0].slants.map(f64::to_degrees), [40.0, 30.0, 5.0], 1e-6);
    assert_close(found[1].slants.map(f64::to_degrees), [64.63, 0.93, 32.29], TWO_DECIMALS);
}
