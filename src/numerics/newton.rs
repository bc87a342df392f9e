//! Newton's step of a function that is known by its values alone.

use nalgebra::{SMatrix, SVector};

/// A function about one point, by differences over `h` in the first `order` of `N` parameters; the others
/// do not move.
pub(crate) struct Differences<const N: usize> {
    /// The gradient, in units of `1/h`.
    pub(crate) gradient: SVector<f64, N>,
    /// The second derivatives, in units of `1/h²`; those of the others are 1.
    curvature: SMatrix<f64, N, N>,
}

impl<const N: usize> Differences<N> {
    /// Where the function is evaluated, from the point: at `−h` and `h` of each parameter, and at `h` of
    /// each two.
    pub(crate) fn places(order: usize, h: f64) -> Vec<[f64; N]> {
        let place = |of: &[(usize, f64)]| {
            let mut place = [0.0; N];
            for (index, value) in of {
                place[*index] = *value;
            }
            place
        };
        let axes = (0..order).flat_map(|i| [place(&[(i, -h)]), place(&[(i, h)])]);
        axes.chain(pairs(order).map(|(i, j)| place(&[(i, h), (j, h)]))).collect()
    }

    /// From the value `here` and those at the [`places`](Self::places).
    pub(crate) fn of(order: usize, here: f64, there: &[f64]) -> Self {
        let (mut gradient, mut curvature) = (SVector::zeros(), SMatrix::identity());
        for i in 0..order {
            let (left, right) = (there[2 * i], there[2 * i + 1]);
            gradient[i] = (right - left) / 2.0;
            curvature[(i, i)] = left - 2.0 * here + right;
        }
        for ((i, j), both) in pairs(order).zip(&there[2 * order..]) {
            let cross = both - there[2 * i + 1] - there[2 * j + 1] + here;
            (curvature[(i, j)], curvature[(j, i)]) = (cross, cross);
        }
        Self { gradient, curvature }
    }

    /// `H⁻¹ g`; none where the function is not convex.
    pub(crate) fn solved(&self, gradient: &SVector<f64, N>) -> Option<SVector<f64, N>> {
        Some(self.curvature.cholesky()?.solve(gradient))
    }

    /// The step to the least value, in units of `h`; two units downhill where the function is not convex.
    pub(crate) fn step(&self) -> SVector<f64, N> {
        let downhill = |slope: f64| if slope == 0.0 { 0.0 } else { -2.0 * slope.signum() };
        self.solved(&self.gradient).map_or_else(|| self.gradient.map(downhill), |step| -step)
    }
}

/// Each two of so many parameters.
fn pairs(order: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..order).flat_map(move |i| (i + 1..order).map(move |j| (i, j)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step_of(order: usize, f: impl Fn([f64; 3]) -> f64) -> [f64; 3] {
        let h = 0.1;
        let there: Vec<f64> = Differences::places(order, h).into_iter().map(&f).collect();
        (Differences::<3>::of(order, f([0.0; 3]), &there).step() * h).into()
    }

    #[test]
    fn a_quadratic_function_takes_one_step() {
        let f = |[x, y, z]: [f64; 3]| {
            let (x, y, z) = (x - 0.3, y + 0.2, z - 0.5);
            2.0 * x * x + y * y + 3.0 * z * z + x * y - 0.5 * y * z + x * z
        };
        let [x, y, z] = step_of(3, f);
        assert!((x - 0.3).abs() + (y + 0.2).abs() + (z - 0.5).abs() < 1e-9, "{x} {y} {z}");
    }

    #[test]
    fn without_a_bowl_it_goes_downhill_in_the_parameters_that_there_are() {
        let step = step_of(2, |[x, y, _]| x - y * y - 3.0 * y);
        assert!((step[0] + 0.2).abs() < 1e-9 && (step[1] - 0.2).abs() < 1e-9, "{step:?}");
        assert!(step[2].abs() < 1e-12);
    }
}
