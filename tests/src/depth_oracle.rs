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

/// Smooth slopes over the pixels of `domain` from data of `field.weight`, then [`poisson`] on these.
pub fn coupled(field: &Field, domain: &[bool], smoothness: f64) -> Vec<f64> {
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
