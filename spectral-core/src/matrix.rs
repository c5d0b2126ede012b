//! Three linear equations, solved by orthogonal rotations: backward stable without pivoting.

use crate::Real;
use crate::array::transposed;

/// A 3 × 3 matrix, row by row.
pub(crate) type Matrix<R> = [[R; 3]; 3];

/// A · v.
#[inline]
pub(crate) fn apply<R: Real>(matrix: &Matrix<R>, [x, y, z]: [R; 3]) -> [R; 3] {
    matrix.map(|[a, b, c]| a * x + b * y + c * z)
}

/// The largest magnitude in a vector; NaN and infinities come back as infinity.
pub(crate) fn largest<R: Real>(vector: [R; 3]) -> R {
    vector.into_iter().fold(R::ZERO, |m, v| if v.is_finite() { m.max(v.abs()) } else { R::INFINITY })
}

/// The factors of A = Q U with Q orthogonal and U upper triangular, by Givens's rotations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Factored<R> {
    /// Qᵀ, row by row.
    transposed: Matrix<R>,
    upper: Matrix<R>,
}

impl<R: Real> Factored<R> {
    /// The factors of a matrix, singular or not.
    pub(crate) fn new(matrix: &Matrix<R>) -> Self {
        let (o, i) = (R::ZERO, R::ONE);
        let [mut a, mut b, mut c] = *matrix;
        let [mut p, mut q, mut r] = [[i, o, o], [o, i, o], [o, o, i]];
        rotate(0, (&mut a, &mut b), (&mut p, &mut q));
        rotate(0, (&mut a, &mut c), (&mut p, &mut r));
        rotate(1, (&mut b, &mut c), (&mut q, &mut r));
        Self { transposed: [p, q, r], upper: [a, b, c] }
    }

    /// The solution x of A x = `right`; infinite or NaN when A is singular.
    #[inline]
    pub(crate) fn solve(&self, right: [R; 3]) -> [R; 3] {
        let [y0, y1, y2] = apply(&self.transposed, right);
        let [a, b, c] = self.upper;
        let x2 = y2 / c[2];
        let x1 = (y1 - b[2] * x2) / b[1];
        let x0 = (y0 - a[1] * x1 - a[2] * x2) / a[0];
        [x0, x1, x2]
    }

    /// A⁻¹, row by row; infinite or NaN when A is singular.
    pub(crate) fn inverse(&self) -> Matrix<R> {
        let (o, i) = (R::ZERO, R::ONE);
        let columns = [[i, o, o], [o, i, o], [o, o, i]].map(|unit| self.solve(unit));
        transposed(columns)
    }
}

/// The largest sum of magnitudes in a row: ‖A‖∞; infinite when an entry is not finite.
pub(crate) fn norm<R: Real>(matrix: &Matrix<R>) -> R {
    largest(matrix.map(|row| row.into_iter().fold(R::ZERO, |sum, entry| sum + entry.abs())))
}

/// Rotates two rows, and two of Qᵀ along with them, so that the second one has 0 at `column`.
#[inline]
fn rotate<R: Real>(column: usize, (a, b): (&mut [R; 3], &mut [R; 3]), (p, q): (&mut [R; 3], &mut [R; 3])) {
    let length = a[column].hypot(b[column]);
    if b[column] == R::ZERO || !(length > R::ZERO) {
        return;
    }
    let (cosine, sine) = (a[column] / length, b[column] / length);
    for (a, b) in [(&mut *a, &mut *b), (p, q)] {
        for (a, b) in a.iter_mut().zip(b.iter_mut()) {
            (*a, *b) = (cosine * *a + sine * *b, cosine * *b - sine * *a);
        }
    }
    b[column] = R::ZERO;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_system_is_solved_to_rounding() {
        let matrix = [[0.0, 2.0, -1.0], [3.0, 1e-3, 4.0], [-5.0, 0.5, 0.0]];
        let x = [1.5, -2.0, 0.25];
        for (solved, x) in Factored::new(&matrix).solve(apply(&matrix, x)).into_iter().zip(x) {
            assert!((solved - x).abs() <= 32.0 * f64::EPSILON, "{solved} {x}");
        }
        let product: Matrix<f64> = Factored::new(&matrix).inverse().map(|row| {
            core::array::from_fn(|column| {
                row[0] * matrix[0][column] + row[1] * matrix[1][column] + row[2] * matrix[2][column]
            })
        });
        for (row, entries) in product.iter().enumerate() {
            for (column, entry) in entries.iter().enumerate() {
                let unit: f64 = if row == column { 1.0 } else { 0.0 };
                assert!((entry - unit).abs() <= 32.0 * f64::EPSILON, "{row} {column} {entry}");
            }
        }
    }

    #[test]
    fn a_singular_matrix_has_an_infinite_inverse() {
        for matrix in [[[0.0_f32; 3]; 3], [[1.0, 0.0, 0.0], [0.0, 0.0, 0.0], [0.0, 0.0, 1.0]]] {
            assert_eq!(norm(&Factored::new(&matrix).inverse()), f32::INFINITY);
        }
    }
}
