//! The bust that stands in for the paper's marble head: the surface of `c_examples/common/scene.cpp`.

/// How many half heights of the picture one unit of the surface's coordinates is.
const UNIT: f64 = 1.05;

/// The depth of the bust in a picture of that height, for `Scene::new`; `None` beside it.
pub fn bust(height: f64) -> impl Fn(f64, f64) -> Option<f64> {
    let unit = 0.5 * height / UNIT;
    move |x, y| {
        let z = surface(x / unit, y / unit);
        (z > 0.0).then_some(z * unit)
    }
}

fn gaussian(u: f64, v: f64, [cu, cv]: [f64; 2], [wu, wv]: [f64; 2]) -> f64 {
    (-((u - cu) / wu).powi(2) - ((v - cv) / wv).powi(2)).exp()
}

/// The front of an ellipsoid; where it gets too steep it goes on along its tangent.
fn ellipsoid(u: f64, v: f64, [cu, cv]: [f64; 2], [au, av, az]: [f64; 3]) -> f64 {
    let edge: f64 = 0.82;
    let squared = ((u - cu) / au).powi(2) + ((v - cv) / av).powi(2);
    if squared < edge {
        return az * (1.0 - squared).sqrt();
    }
    let height = (1.0 - edge).sqrt();
    az * (height - edge.sqrt() / height * (squared.sqrt() - edge.sqrt()))
}

/// The higher of two surfaces with a rounded seam.
fn blend(a: f64, b: f64, radius: f64) -> f64 {
    0.5 * (a + b + (a - b).hypot(radius))
}

fn face(u: f64, v: f64) -> f64 {
    let side = u.hypot(0.03);
    let features = [
        (0.075, u, [0.0, 0.13], [0.05, 0.085]),
        (0.045, u, [0.0, 0.24], [0.038, 0.11]),
        (0.020, side, [0.06, 0.095], [0.03, 0.03]),
        (0.026, side, [0.13, 0.385], [0.10, 0.035]),
        (-0.045, side, [0.14, 0.30], [0.075, 0.05]),
        (0.030, side, [0.14, 0.295], [0.04, 0.028]),
        (0.022, side, [0.17, 0.13], [0.09, 0.09]),
        (0.022, u, [0.0, -0.005], [0.075, 0.02]),
        (0.024, u, [0.0, -0.062], [0.065, 0.022]),
        (-0.018, u, [0.0, -0.033], [0.085, 0.012]),
        (0.035, u, [0.0, -0.16], [0.08, 0.06]),
    ];
    let relief: f64 =
        features.iter().map(|&(height, u, center, width)| height * gaussian(u, v, center, width)).sum();
    ellipsoid(u, v, [0.0, 0.22], [0.35, 0.50, 0.44]) + relief
}

fn surface(u: f64, v: f64) -> f64 {
    let lock = |at| ellipsoid(u, v, [at, 0.16], [0.16, 0.34, 0.17]);
    let waves =
        0.011 * (24.0 * (u.hypot(0.03) + 0.35 * v) + 2.0 * (5.0 * v).sin()).sin() * (1.0 + (7.0 * v).cos());
    let locks = blend(lock(-0.37), lock(0.37), 0.02);
    let hair = blend(ellipsoid(u, v, [0.0, 0.44], [0.46, 0.47, 0.30]), locks, 0.06) + waves;
    let head = blend(face(u, v), hair, 0.05);
    let chest = 0.03 * gaussian(u, v, [0.0, -0.75], [0.10, 0.25]);
    let shoulders = ellipsoid(u, v, [0.0, -1.12], [0.88, 0.68, 0.34]) + chest;
    let body = blend(ellipsoid(u, v, [0.0, -0.38], [0.20, 0.42, 0.20]), shoulders, 0.10);
    blend(head, body, 0.06)
}
