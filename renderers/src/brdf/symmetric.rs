//! Small symmetric matrices: solving, inverting, eigenvalues.

/// A square matrix by rows.
pub(super) type Matrix<const N: usize> = [[f64; N]; N];

/// Solves (A + λ diag A) x = b over the rows and columns that are used; x is 0 elsewhere. `None` unless the matrix is
/// positive definite. The diagonal of A is scaled to 1 first, so that units don't matter.
pub(super) fn solve<const N: usize>(a: &Matrix<N>, b: &[f64; N], used: &[bool; N], lambda: f64) -> Option<[f64; N]> {
    let scale = scales(a, used);
    let mut normal = normalised(a, used);
    for (i, row) in normal.iter_mut().enumerate() {
        row[i] += lambda;
    }
    let factor = cholesky(&normal)?;
    let mut x: [f64; N] = core::array::from_fn(|i| if used[i] { b[i] * scale[i] } else { 0.0 });
    for i in 0..N {
        let known: f64 = (0..i).map(|k| factor[i][k] * x[k]).sum();
        x[i] = (x[i] - known) / factor[i][i];
    }
    for i in (0..N).rev() {
        let known: f64 = (i + 1..N).map(|k| factor[k][i] * x[k]).sum();
        x[i] = (x[i] - known) / factor[i][i];
    }
    Some(core::array::from_fn(|i| x[i] * scale[i]))
}

/// The inverse over the rows and columns that are used, 0 elsewhere; `None` unless that part is positive definite.
pub(super) fn inverse<const N: usize>(a: &Matrix<N>, used: &[bool; N]) -> Option<Matrix<N>> {
    let mut inverse = [[0.0; N]; N];
    for k in (0..N).filter(|&k| used[k]) {
        let unit: [f64; N] = core::array::from_fn(|i| if i == k { 1.0 } else { 0.0 });
        inverse[k] = solve(a, &unit, used, 0.0)?;
    }
    Some(inverse)
}

/// The product a b.
pub(super) fn product<const N: usize>(a: &Matrix<N>, b: &Matrix<N>) -> Matrix<N> {
    core::array::from_fn(|i| core::array::from_fn(|k| (0..N).map(|m| a[i][m] * b[m][k]).sum()))
}

/// 1/√(diagonal) where used, 0 elsewhere.
fn scales<const N: usize>(a: &Matrix<N>, used: &[bool; N]) -> [f64; N] {
    core::array::from_fn(|i| if used[i] && a[i][i] > 0.0 { 1.0 / a[i][i].sqrt() } else { 0.0 })
}

/// The matrix scaled to a diagonal of ones; rows and columns that are not used are those of the identity.
pub(super) fn normalised<const N: usize>(a: &Matrix<N>, used: &[bool; N]) -> Matrix<N> {
    let scale = scales(a, used);
    core::array::from_fn(|i| core::array::from_fn(|k| if i == k { 1.0 } else { a[i][k] * scale[i] * scale[k] }))
}

/// L with L Lᵀ = A; `None` unless A is positive definite.
fn cholesky<const N: usize>(a: &Matrix<N>) -> Option<Matrix<N>> {
    let mut factor = [[0.0; N]; N];
    for i in 0..N {
        for k in 0..=i {
            let rest = a[i][k] - (0..k).map(|m| factor[i][m] * factor[k][m]).sum::<f64>();
            if i > k {
                factor[i][k] = rest / factor[k][k];
            } else if rest > 0.0 {
                factor[i][i] = rest.sqrt();
            } else {
                return None;
            }
        }
    }
    Some(factor)
}

/// The eigenvalues, by Jacobi's rotations; exact but for rounding of about ε times the largest.
pub(super) fn eigenvalues<const N: usize>(mut a: Matrix<N>) -> [f64; N] {
    // Convergence is quadratic: a few sweeps do.
    for _ in 0..30 {
        for p in 0..N {
            for q in p + 1..N {
                rotate(&mut a, p, q);
            }
        }
    }
    core::array::from_fn(|i| a[i][i])
}

/// Makes a[p][q] zero.
fn rotate<const N: usize>(a: &mut Matrix<N>, p: usize, q: usize) {
    if a[p][q] == 0.0 {
        return;
    }
    let ratio = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    let tangent = ratio.signum() / (ratio.abs() + ratio.hypot(1.0));
    let cosine = 1.0 / tangent.hypot(1.0);
    let sine = tangent * cosine;
    for row in a.iter_mut() {
        (row[p], row[q]) = (cosine * row[p] - sine * row[q], sine * row[p] + cosine * row[q]);
    }
    let (first, second) = (a[p], a[q]);
    a[p] = core::array::from_fn(|k| cosine * first[k] - sine * second[k]);
    a[q] = core::array::from_fn(|k| sine * first[k] + cosine * second[k]);
}

#[cfg(test)]
mod tests {
    use super::*;

    const A: Matrix<3> = [[4.0, 1.0, -2.0], [1.0, 9.0, 0.5], [-2.0, 0.5, 1e4]];
    const ALL: [bool; 3] = [true; 3];

    #[test]
    fn the_inverse_times_the_matrix_is_the_identity() {
        let identity = product(&inverse(&A, &ALL).unwrap(), &A);
        for (i, row) in identity.iter().enumerate() {
            for (k, &value) in row.iter().enumerate() {
                let expected = f64::from(u8::from(i == k));
                assert!((value - expected).abs() <= 1e-11, "{i} {k}: {value}");
            }
        }
    }

    #[test]
    fn what_is_not_used_is_left_out() {
        let x = solve(&A, &[4.0, 7.0, 2e4], &[true, false, false], 0.0).unwrap();
        assert!((x[0] - 1.0).abs() <= 1e-15 && x[1] == 0.0 && x[2] == 0.0);
        assert!(solve(&[[1.0, 2.0], [2.0, 1.0]], &[1.0, 1.0], &[true, true], 0.0).is_none());
    }

    #[test]
    fn eigenvalues_have_the_trace_and_the_determinant() {
        let values = eigenvalues(A);
        assert!((values.iter().sum::<f64>() - 10_013.0).abs() <= 1e-10);
        let determinant = 4.0 * (9.0 * 1e4 - 0.25) - (1e4 + 1.0) - 2.0 * (0.5 + 18.0);
        assert!((values.iter().product::<f64>() / determinant - 1.0).abs() <= 1e-13);
        let two = eigenvalues([[2.0, 1.0], [1.0, 2.0]]);
        assert!((two[0] - 1.0).abs() <= 1e-15 && (two[1] - 3.0).abs() <= 1e-15);
    }
}
