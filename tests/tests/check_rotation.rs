//! Which number of the self-checks sees that all normals are turned, or that they are those of the convex/concave twin.

use ofc_core::check::{Check, check, workspace_len};
use ofc_core::math::mat3;
use ofc_core::orientation::matrix::Orientation;
use ofc_core::picture::Window;
use ofc_core::render::DepthMap;
use ofc_core::solve::{self, Solution};
use ofc_core::surface::depth::{self, DepthInput, DepthParams, Plane, Slopes};
use ofc_core::surface::normals::{self, Length};
use ofc_tests::depth_workspace::Workspace;
use ofc_tests::shaded_scenes::{CLEAN, Light, Matrix, OTHER, Scene, cap, lopsided};

const SIZE: usize = 160;

/// A surface, and its name.
type Surface = (&'static str, Box<dyn Fn(f64, f64) -> Option<f64>>);

fn egg(x: f64, y: f64) -> Option<f64> {
    let (u, v) = (x / 60.0, y / 75.0);
    let width = 1.0 - 0.25 * v;
    let square = 1.0 - v * v - u * u / (width * width);
    (square > 0.35).then(|| 60.0 * square.sqrt())
}

fn surfaces() -> [Surface; 3] {
    [("egg", Box::new(egg)), ("cap", Box::new(cap(90.0, 65.0))), ("lopsided", Box::new(lopsided(80.0)))]
}

fn checked(scene: &Scene, solution: &Solution, f: Matrix) -> Check {
    let image = scene.image();
    let orientation = Orientation::new(f, 1e-6);
    let inliers = |window: &Window| solution.inliers.bits(window);
    let mut normals = vec![0.0_f32; 3 * SIZE * SIZE];
    normals::compute(&image, inliers, &orientation.f_inverse, Length::Unit, &mut normals, 3 * SIZE).unwrap();
    let input = DepthInput {
        slopes: Slopes::Normals(Plane::new(&normals, SIZE, SIZE, 3, 3 * SIZE).unwrap()),
        mask: None,
        weights: None,
        prior: None,
    };
    let mut workspace = Workspace::new(SIZE, SIZE, 0.0);
    let mut depths = vec![0.0_f32; SIZE * SIZE];
    let params = DepthParams::default();
    let integrated = depth::integrate(&input, &params, workspace.arena(), &mut depths, SIZE);
    let bytes: Vec<u8> = depths.iter().flat_map(|z| z.to_ne_bytes()).collect();
    let surface = DepthMap::new(&bytes, SIZE, SIZE, 4 * SIZE, 1.0).unwrap();
    let mut workspace = vec![f32::NAN; workspace_len(SIZE * SIZE)];
    let coefficients = solution.fit.expect("a fit").coefficients;
    let surface = integrated.is_ok().then_some(&surface);
    check(&image, &solution.inliers, &orientation, &coefficients, surface, &mut workspace).unwrap()
}

fn turn(axis: usize, degrees: f64) -> Matrix {
    let (s, c) = degrees.to_radians().sin_cos();
    let mut turn = mat3::IDENTITY;
    let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
    (turn[i][i], turn[j][j], turn[i][j], turn[j][i]) = (c, c, -s, s);
    turn
}

/// The root mean square angle, over all directions, of a turn by so many degrees.
fn mean_angle(degrees: f64) -> f64 {
    2.0 * ((2.0_f64 / 3.0).sqrt() * (0.5 * degrees.to_radians()).sin()).asin()
}

/// Calls `visit` with scenes, their true F and what the regression found of their colors.
fn for_each_scene(visit: impl Fn(&str, &Scene, &Solution)) {
    let lights: [(&str, [Light; 3]); 2] = [("clean", CLEAN), ("other", OTHER)];
    for (light, lights) in lights {
        for (name, surface) in surfaces() {
            for noise in [0.0, 1.0] {
                let scene = Scene::new(SIZE, SIZE, &lights, &surface).with_noise(noise, 3);
                let params = solve::Params::default();
                let mut workspace = vec![0.0; solve::workspace_len(SIZE * SIZE, params.lmeds.sample_size)];
                let solution = solve::solve(&scene.image(), &params, &mut workspace).unwrap();
                visit(&format!("{name}, {light} lights, noise {noise}"), &scene, &solution);
            }
        }
    }
}

/// What integrability, and colors that are rendered with noise of 1 of 255, leave open.
const TOLERANCE: f64 = 0.03;

#[test]
fn a_wrong_rotation_and_a_wrong_twin_show_by_their_angle() {
    for_each_scene(|name, scene, solution| {
        let turn_of = |f: Matrix| checked(scene, solution, f).turn.expect("a turn");
        let right = turn_of(scene.f);
        println!(
            "{name}: {:.3} degrees, expected {:.3}",
            right.angle.to_degrees(),
            right.expected.to_degrees()
        );
        assert!(right.angle < TOLERANCE && right.angle < 3.0 * right.expected, "{name}: {right:?}");
        assert!(right.convexity > 0.99);
        for degrees in [10.0, 25.0, 40.0, 180.0] {
            for axis in 0..3 {
                let found = turn_of(mat3::multiply(&scene.f, &turn(axis, degrees)));
                let wanted = mean_angle(degrees);
                assert!(
                    (found.angle - wanted).abs() < TOLERANCE,
                    "{name}, {degrees} about {axis}: {found:?}"
                );
                assert!(found.angle > 5.0 * found.expected, "{name}, {degrees} about {axis}: {found:?}");
            }
        }
        for mirrored in 0..3 {
            let mut mirror = mat3::IDENTITY;
            mirror[mirrored][mirrored] = -1.0;
            let found = turn_of(mat3::multiply(&scene.f, &mirror));
            let wanted = 2.0 * (1.0_f64 / 3.0).sqrt().asin();
            assert!((found.angle - wanted).abs() < TOLERANCE, "{name}, {mirrored} mirrored: {found:?}");
        }
    });
}

#[test]
fn the_other_numbers_see_what_the_documentation_says() {
    for_each_scene(|name, scene, solution| {
        let right = checked(scene, solution, scene.f);
        let largest =
            |angles: Option<[f64; 3]>| angles.unwrap().into_iter().fold(0.0_f64, |a, b| a.max(b.abs()));
        let surface = |check: &Check| check.depth.expect("a surface");
        for (axis, degrees) in [(0, 25.0_f64), (1, 25.0), (2, 25.0), (2, 180.0)] {
            let found = checked(scene, solution, mat3::multiply(&scene.f, &turn(axis, degrees)));
            let angle = |check| surface(check).median_angle.expect("a surface");
            let bent = angle(&found) - angle(&right);
            let depth_tilts = largest(surface(&found).tilt_differences);
            println!("{name}, {degrees} about {axis}: bent by {bent:.4}, depth tilts {depth_tilts:.4}");
            // The relit picture is the same whatever the orthogonal transformation is.
            for (a, b) in found.relit_tilts.unwrap().tilts.iter().zip(right.relit_tilts.unwrap().tilts) {
                assert!((a - b).abs() < 1e-9);
            }
            for (a, b) in found.correlations.iter().zip(right.correlations) {
                assert!((a - b).abs() < 1e-9);
            }
            let residuals = found.tilt_residuals.unwrap().into_iter().zip(right.tilt_residuals.unwrap());
            let changes = residuals.map(|(a, b)| ((a - b).to_degrees() + 360.0).rem_euclid(360.0));
            match (axis, degrees) {
                // The twin is as good a surface, which looks the same.
                (2, 180.0) => {
                    assert!(
                        bent.abs() < 1e-4 && depth_tilts < largest(surface(&right).tilt_differences) + 1e-3
                    );
                    assert!(changes.into_iter().all(|change| (change - 180.0).abs() < 1e-6));
                }
                // About the line of sight.
                (2, _) => {
                    assert!(bent > 0.09 && depth_tilts > 0.25);
                    assert!(changes.into_iter().all(|change| (change - 335.0).abs() < 1e-6));
                }
                _ => assert!(bent < 0.03 && depth_tilts < 0.1),
            }
        }
    });
}
