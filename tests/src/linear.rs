//! The little linear algebra that oracles need, naive and in f64.

/// A 3x3 matrix, row-major.
pub type Matrix = [[f64; 3]; 3];

/// The dot product.
#[must_use]
pub fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// A vector's length.
#[must_use]
pub fn length(a: [f64; 3]) -> f64 {
    dot(a, a).sqrt()
}

/// A vector of length 1 with the direction of `a`.
#[must_use]
pub fn unit(a: [f64; 3]) -> [f64; 3] {
    a.map(|component| component / length(a))
}

/// The angle between two vectors in degrees.
#[must_use]
pub fn degrees_between(a: [f64; 3], b: [f64; 3]) -> f64 {
    // From sine and cosine: the arc cosine alone knows small angles to half the digits only.
    let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    length(cross).atan2(dot(a, b)).to_degrees()
}

/// A matrix times a vector.
#[must_use]
pub fn apply(m: Matrix, v: [f64; 3]) -> [f64; 3] {
    m.map(|row| dot(row, v))
}

/// The transpose.
#[must_use]
pub fn transpose(m: Matrix) -> Matrix {
    [0, 1, 2].map(|j| [0, 1, 2].map(|i: usize| m[i][j]))
}

/// The product.
#[must_use]
pub fn multiply(a: Matrix, b: Matrix) -> Matrix {
    let columns = transpose(b);
    a.map(|row| columns.map(|column| dot(row, column)))
}

/// The inverse by cofactors.
#[must_use]
pub fn inverse(m: Matrix) -> Matrix {
    let minor = |i: usize, j: usize| {
        let (i1, i2, j1, j2) = ((i + 1) % 3, (i + 2) % 3, (j + 1) % 3, (j + 2) % 3);
        m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1]
    };
    let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| minor(j, i) / determinant))
}

/// The orthogonal matrix nearest to `m`, by Newton's iteration for the polar decomposition.
#[must_use]
pub fn nearest_orthogonal(m: Matrix) -> Matrix {
    let mut x = m;
    for _ in 0..100 {
        let other = transpose(inverse(x));
        for (row, other_row) in x.iter_mut().zip(other) {
            for (entry, other_entry) in row.iter_mut().zip(other_row) {
                *entry = 0.5 * (*entry + other_entry);
            }
        }
    }
    x
}

/// The lower triangular L with L L^T = m: with C = L L^T, L^T is a root of C.
#[must_use]
pub fn cholesky(m: Matrix) -> Matrix {
    let mut l = [[0.0; 3]; 3];
    for i in 0..3 {
        for j in 0..=i {
            let rest = m[i][j] - (0..j).map(|k| l[i][k] * l[j][k]).sum::<f64>();
            l[i][j] = if i == j { rest.sqrt() } else { rest / l[j][j] };
        }
    }
    l
}

/// The x of A x = b by elimination with partial pivoting; `None` where a pivot is below 1e-12 of the largest entry.
#[must_use]
pub fn eliminate<const N: usize>(mut a: [[f64; N]; N], mut b: [f64; N]) -> Option<[f64; N]> {
    let largest = a.iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
    for column in 0..N {
        let pivot = (column..N).max_by(|&i, &j| a[i][column].abs().total_cmp(&a[j][column].abs()))?;
        a.swap(column, pivot);
        b.swap(column, pivot);
        if a[column][column].abs() <= 1e-12 * largest {
            return None;
        }
        for row in column + 1..N {
            let factor = a[row][column] / a[column][column];
            let pivot_row = a[column];
            a[row].iter_mut().zip(pivot_row).for_each(|(entry, above)| *entry -= factor * above);
            b[row] -= factor * b[column];
        }
    }
    let mut x = [0.0; N];
    for row in (0..N).rev() {
        let known: f64 = (row + 1..N).map(|k| a[row][k] * x[k]).sum();
        x[row] = (b[row] - known) / a[row][row];
    }
    Some(x)
}

/// Least squares of `rows` x = `response` by modified Gram-Schmidt, done twice: x and (A^T A)^-1.
///
/// # Panics
/// When there are no rows.
#[must_use]
pub fn least_squares<const N: usize>(rows: &[[f64; N]], response: &[f64]) -> ([f64; N], [[f64; N]; N]) {
    let mut columns: Vec<Vec<f64>> = (0..N).map(|j| rows.iter().map(|row| row[j]).collect()).collect();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let mut r = [[0.0; N]; N];
    for j in 0..N {
        for _ in 0..2 {
            for i in 0..j {
                let along = product(&columns[i], &columns[j]);
                r[i][j] += along;
                let (before, rest) = columns.split_at_mut(j);
                rest[0].iter_mut().zip(&before[i]).for_each(|(a, q)| *a -= along * q);
            }
        }
        r[j][j] = product(&columns[j], &columns[j]).sqrt();
        let norm = r[j][j];
        columns[j].iter_mut().for_each(|a| *a /= norm);
    }
    let q_response: Vec<f64> = columns.iter().map(|q| product(q, response)).collect();
    let back = |right: &[f64]| {
        let mut x = [0.0; N];
        for i in (0..N).rev() {
            let known: f64 = (i + 1..N).map(|k| r[i][k] * x[k]).sum();
            x[i] = (right[i] - known) / r[i][i];
        }
        x
    };
    // The columns of R^-1; (A^T A)^-1 is R^-1 R^-T.
    let inverse: Vec<[f64; N]> = (0..N)
        .map(|j| {
            let mut e = [0.0; N];
            e[j] = 1.0;
            back(&e)
        })
        .collect();
    let mut covariance = [[0.0; N]; N];
    for (i, row) in covariance.iter_mut().enumerate() {
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = inverse.iter().map(|column| column[i] * column[j]).sum();
        }
    }
    (back(&q_response), covariance)
}

/// The median: of an even number of values the upper one of the middle two.
///
/// # Panics
/// When there are no values.
#[must_use]
pub fn median(values: &[f64]) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    sorted[sorted.len() / 2]
}
