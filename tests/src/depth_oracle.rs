//! Depth from slopes the plain way: a list of edges, f64, conjugate gradients with the diagonal as preconditioner to
//! twelve digits. Written from the equations; shares no code with the core.

/// Slopes over a rectangle, row 0 at the top, y up.
#[derive(Clone)]
pub struct Field {
    /// Pixels in a row.
    pub width: usize,
    /// Rows.
    pub height: usize,
    /// dz/dx of each pixel.
    pub p: Vec<f64>,
    /// dz/dy of each pixel.
    pub q: Vec<f64>,
    /// Weight of each pixel, zero where there is none.
    pub weight: Vec<f64>,
}

/// `A` as edges and a mass for every pixel.
struct System {
    edges: Vec<(usize, usize, f64)>,
    mass: Vec<f64>,
}

impl System {
    fn apply(&self, z: &[f64]) -> Vec<f64> {
        let mut out: Vec<f64> = z.iter().zip(&self.mass).map(|(z, m)| z * m).collect();
        for &(a, b, w) in &self.edges {
            let flow = w * (z[a] - z[b]);
            out[a] += flow;
            out[b] -= flow;
        }
        out
    }

    fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut diagonal = self.mass.clone();
        for &(a, b, w) in &self.edges {
            diagonal[a] += w;
            diagonal[b] += w;
        }
        let precondition = |r: &[f64]| -> Vec<f64> {
            r.iter().zip(&diagonal).map(|(r, d)| if *d > 0.0 { r / d } else { 0.0 }).collect()
        };
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let mut z = vec![0.0; right.len()];
        let mut residual = right.to_vec();
        let mut direction = precondition(&residual);
        let mut product = dot(&residual, &direction);
        let goal = dot(right, right) * 1e-24;
        for _ in 0..200_000 {
            if dot(&residual, &residual) <= goal {
                return z;
            }
            let applied = self.apply(&direction);
            let step = product / dot(&direction, &applied);
            for i in 0..z.len() {
                z[i] += step * direction[i];
                residual[i] -= step * applied[i];
            }
            let next = precondition(&residual);
            let next_product = dot(&residual, &next);
            let factor = next_product / product;
            product = next_product;
            for (d, n) in direction.iter_mut().zip(next) {
                *d = n + factor * *d;
            }
        }
        panic!("the oracle did not converge");
    }
}

/// Pairs of neighbors: (left, right) and (lower, upper).
fn neighbors(width: usize, height: usize) -> [Vec<(usize, usize)>; 2] {
    let mut pairs = [Vec::new(), Vec::new()];
    for i in 0..width * height {
        if (i + 1) % width != 0 {
            pairs[0].push((i, i + 1));
        }
        if i + width < width * height {
            pairs[1].push((i + width, i));
        }
    }
    pairs
}

/// The region of every pixel of weight, by flood fill, and their number.
pub fn regions(field: &Field) -> (Vec<Option<usize>>, usize) {
    let mut labels = vec![None; field.p.len()];
    let mut count = 0;
    for seed in 0..labels.len() {
        if field.weight[seed] == 0.0 || labels[seed].is_some() {
            continue;
        }
        let mut stack = vec![seed];
        labels[seed] = Some(count);
        while let Some(i) = stack.pop() {
            let (x, y) = (i % field.width, i / field.width);
            let around = [
                (x > 0).then(|| i - 1),
                (x + 1 < field.width).then(|| i + 1),
                (y > 0).then(|| i - field.width),
                (y + 1 < field.height).then(|| i + field.width),
            ];
            for j in around.into_iter().flatten() {
                if field.weight[j] > 0.0 && labels[j].is_none() {
                    labels[j] = Some(count);
                    stack.push(j);
                }
            }
        }
        count += 1;
    }
    (labels, count)
}

/// Frees every region, but those with a prior, of its mean over the pixels that `counted` names; NaN outside regions.
pub fn free_of_means(field: &Field, mut z: Vec<f64>, prior: Option<&[f64]>, counted: &[bool]) -> Vec<f64> {
    let (labels, count) = regions(field);
    let mut sums = vec![(0.0, 0.0); count];
    let mut anchored = vec![false; count];
    for (i, label) in labels.iter().enumerate() {
        if let Some(label) = *label {
            if counted[i] {
                sums[label].0 += z[i];
                sums[label].1 += 1.0;
            }
            anchored[label] |= prior.is_some_and(|prior| prior[i].is_finite());
        }
    }
    for (z, label) in z.iter_mut().zip(labels) {
        *z = match label {
            Some(label) if anchored[label] => *z,
            Some(label) => *z - sums[label].0 / sums[label].1,
            None => f64::NAN,
        };
    }
    z
}

/// Least squares: `z_right - z_left = mean p`, `z_upper - z_lower = mean q`, an edge weighing the geometric mean of its
/// pixels' weights, and `z = prior` with weight `prior_weight` where the prior is finite.
pub fn poisson(field: &Field, prior: Option<(&[f64], f64)>) -> Vec<f64> {
    let mut system = System { edges: Vec::new(), mass: vec![0.0; field.p.len()] };
    let mut right = vec![0.0; field.p.len()];
    for (pairs, slope) in neighbors(field.width, field.height).iter().zip([&field.p, &field.q]) {
        for &(from, to) in pairs {
            let weight = (field.weight[from] * field.weight[to]).sqrt();
            if weight > 0.0 {
                let rise = weight * 0.5 * (slope[from] + slope[to]);
                right[to] += rise;
                right[from] -= rise;
                system.edges.push((from, to, weight));
            }
        }
    }
    if let Some((prior, weight)) = prior {
        for (i, &depth) in prior.iter().enumerate() {
            if depth.is_finite() && field.weight[i] > 0.0 {
                system.mass[i] = weight;
                right[i] += weight * depth;
            }
        }
    }
    let counted = vec![true; field.p.len()];
    free_of_means(field, system.solve(&right), prior.map(|(prior, _)| prior), &counted)
}

/// Slopes over the pixels of `domain` from data of `field.weight`, p and q smoothed each for itself, then [`poisson`] on
/// these: what the coupled model is without the coupling.
pub fn uncoupled(field: &Field, domain: &[bool], smoothness: f64) -> Vec<f64> {
    let inside = |i: usize| if domain[i] { 1.0 } else { 0.0 };
    let mut system = System { edges: Vec::new(), mass: Vec::new() };
    for pairs in neighbors(field.width, field.height) {
        for (a, b) in pairs {
            if domain[a] && domain[b] {
                system.edges.push((a, b, smoothness));
            }
        }
    }
    system.mass = field.weight.iter().enumerate().map(|(i, w)| w * inside(i)).collect();
    let smooth = |data: &[f64]| {
        let right: Vec<f64> = data.iter().zip(&system.mass).map(|(d, m)| d * m).collect();
        system.solve(&right)
    };
    let smooth_field = Field {
        p: smooth(&field.p),
        q: smooth(&field.q),
        weight: (0..domain.len()).map(inside).collect(),
        ..*field
    };
    poisson(&smooth_field, None)
}

/// One square in an energy: `weight * (sum of factor * unknown - wanted)^2`.
struct Square {
    weight: f64,
    sum: Vec<(usize, f64)>,
    wanted: f64,
}

/// The unknowns that minimize a sum of squares, by conjugate gradients on the normal equations, square after square.
fn minimize(unknowns: usize, squares: &[Square]) -> Vec<f64> {
    let value = |square: &Square, x: &[f64]| square.sum.iter().map(|&(i, factor)| factor * x[i]).sum::<f64>();
    let spread = |out: &mut [f64], square: &Square, value: f64| {
        for &(i, factor) in &square.sum {
            out[i] += square.weight * factor * value;
        }
    };
    let mut diagonal = vec![0.0; unknowns];
    let mut residual = vec![0.0; unknowns];
    for square in squares {
        for &(i, factor) in &square.sum {
            diagonal[i] += square.weight * factor * factor;
        }
        spread(&mut residual, square, square.wanted);
    }
    let precondition = |r: &[f64]| -> Vec<f64> {
        r.iter().zip(&diagonal).map(|(r, d)| if *d > 0.0 { r / d } else { 0.0 }).collect()
    };
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut x = vec![0.0; unknowns];
    let mut direction = precondition(&residual);
    let mut product = dot(&residual, &direction);
    let goal = product * 1e-24;
    for _ in 0..100_000 {
        if product <= goal {
            return x;
        }
        let mut applied = vec![0.0; unknowns];
        for square in squares {
            spread(&mut applied, square, value(square, &direction));
        }
        let step = product / dot(&direction, &applied);
        for i in 0..unknowns {
            x[i] += step * direction[i];
            residual[i] -= step * applied[i];
        }
        let next = precondition(&residual);
        let next_product = dot(&residual, &next);
        for (d, n) in direction.iter_mut().zip(next) {
            *d = n + next_product / product * *d;
        }
        product = next_product;
    }
    panic!("the oracle did not converge");
}

/// Depth, p and q over the pixels of `domain` that minimize Harris's energy: slopes near the data with `field.weight`,
/// `smoothness` times their squared differences, and `misfit` times the squared differences between the rise of depth along
/// an edge and the mean of its slopes, and, with their own weight on top, those of depth from a prior where it is finite.
pub fn coupled(
    field: &Field,
    domain: &[bool],
    smoothness: f64,
    misfit: f64,
    prior: Option<(&[f64], f64)>,
) -> Vec<f64> {
    let pixels = domain.len();
    let mut squares = Vec::new();
    for (k, (pairs, slope)) in
        neighbors(field.width, field.height).iter().zip([&field.p, &field.q]).enumerate()
    {
        let slope_of = |i: usize| (k + 1) * pixels + i;
        for i in (0..pixels).filter(|&i| domain[i] && field.weight[i] > 0.0) {
            squares.push(Square { weight: field.weight[i], sum: vec![(slope_of(i), 1.0)], wanted: slope[i] });
        }
        for &(from, to) in pairs.iter().filter(|&&(a, b)| domain[a] && domain[b]) {
            for slopes in [pixels, 2 * pixels] {
                let sum = vec![(slopes + to, 1.0), (slopes + from, -1.0)];
                squares.push(Square { weight: smoothness, sum, wanted: 0.0 });
            }
            let sum = vec![(to, 1.0), (from, -1.0), (slope_of(from), -0.5), (slope_of(to), -0.5)];
            squares.push(Square { weight: misfit, sum, wanted: 0.0 });
        }
    }
    if let Some((prior, weight)) = prior {
        for i in (0..pixels).filter(|&i| domain[i] && prior[i].is_finite()) {
            squares.push(Square { weight: misfit * weight, sum: vec![(i, 1.0)], wanted: prior[i] });
        }
    }
    let mut depth = minimize(3 * pixels, &squares);
    depth.truncate(pixels);
    let whole = Field { weight: domain.iter().map(|&d| f64::from(u8::from(d))).collect(), ..field.clone() };
    free_of_means(&whole, depth, prior.map(|(prior, _)| prior), &vec![true; pixels])
}
