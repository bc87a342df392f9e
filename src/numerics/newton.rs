//! Newton's step of a function that is known by its values alone.

use nalgebra::{Cholesky, Const, SMatrix, SVector};

/// A function about one point, by differences along axes in the first `order` of `N` parameters; the
/// others do not move.
pub(crate) struct Differences<const N: usize> {
    /// Its gradient along each axis.
    pub(crate) gradient: SVector<f64, N>,
    /// Its second derivatives along these; those of the others are 1.
    curvature: SMatrix<f64, N, N>,
}

/// Directions of differences, a column each, as long as their distances.
pub(crate) type Axes<const N: usize> = SMatrix<f64, N, N>;

impl<const N: usize> Differences<N> {
    /// Where the function is evaluated, from the point: at both ends of each axis, and at the sum of
    /// each two.
    pub(crate) fn places(order: usize, axes: &Axes<N>) -> Vec<[f64; N]> {
        let axis = |i: usize| axes.column(i).into_owned();
        let ends = (0..order).flat_map(|i| [-axis(i), axis(i)]);
        ends.chain(pairs(order).map(|(i, j)| axis(i) + axis(j))).map(Into::into).collect()
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

    /// The curvature, and enlarged in all directions more and more (K. Levenberg, "A method for the
    /// solution of certain non-linear problems in least squares", Quarterly of Applied Mathematics 2
    /// (1944)), as far as it is convex.
    fn convex(&self) -> impl Iterator<Item = Cholesky<f64, Const<N>>> {
        /// The first enlargement in parts of the largest curvature, how it grows, and how often.
        const FIRST: f64 = 1e-3;
        const GROWS: f64 = 3.0;
        const TIMES: usize = 60;
        let first = FIRST * self.curvature.amax().max(self.gradient.amax());
        let more = std::iter::successors(Some(first), |by| Some(by * GROWS)).take(TIMES);
        let curvature = self.curvature;
        std::iter::once(0.0)
            .chain(more)
            .filter_map(move |by| (curvature + SMatrix::identity() * by).cholesky())
    }

    /// The step to the least value, no farther than so much in a parameter.
    pub(crate) fn step(&self, axes: &Axes<N>, farthest: f64) -> [f64; N] {
        let steps = self.convex().map(|curvature| -(axes * curvature.solve(&self.gradient)));
        let mut near = steps.filter(|step| step.amax() <= farthest);
        near.next().unwrap_or_else(SVector::zeros).into()
    }

    /// Axes from these `axes`, along which the function grows alike and independently: by ½ at their
    /// ends, but none shorter or longer than so much in a parameter.
    pub(crate) fn axes(&self, axes: &Axes<N>, (least, most): (f64, f64)) -> Axes<N> {
        let inverse = self.convex().next().and_then(|it| it.l().try_inverse());
        let mut found = inverse.map_or(*axes, |inverse| axes * inverse.transpose());
        for mut axis in found.column_iter_mut() {
            let length = axis.amax();
            if length > 0.0 {
                axis *= length.clamp(least, most) / length;
            }
        }
        found
    }
}

/// Each two of so many parameters.
fn pairs(order: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..order).flat_map(move |i| (i + 1..order).map(move |j| (i, j)))
}

#[cfg(test)]
mod tests {
    use super::*;

    const H: f64 = 0.1;

    fn differences(order: usize, axes: &Axes<3>, f: impl Fn([f64; 3]) -> f64) -> Differences<3> {
        let there: Vec<f64> = Differences::places(order, axes).into_iter().map(&f).collect();
        Differences::of(order, f([0.0; 3]), &there)
    }

    fn quadratic([x, y, z]: [f64; 3]) -> f64 {
        let (x, y, z) = (x - 0.3, y + 0.2, z - 0.5);
        2.0 * x * x + y * y + 3.0 * z * z + x * y - 0.5 * y * z + x * z
    }

    #[test]
    fn a_quadratic_function_takes_one_step() {
        let axes = Axes::identity() * H;
        let [x, y, z] = differences(3, &axes, quadratic).step(&axes, 1.0);
        assert!((x - 0.3).abs() + (y + 0.2).abs() + (z - 0.5).abs() < 1e-9, "{x} {y} {z}");
    }

    #[test]
    fn a_step_that_is_too_far_keeps_in_the_valley() {
        // Along x + y it falls slowly, across it is steep.
        let f = |[x, y, _]: [f64; 3]| 1e4 * (x - y).powi(2) + (x + y - 4.0).powi(2);
        let axes = Axes::identity() * H;
        let [x, y, _] = differences(2, &axes, f).step(&axes, 0.4);
        assert!(x > 0.05 && x <= 0.4 && (x - y).abs() < 0.01, "{x} {y}");
    }

    #[test]
    fn along_the_next_axes_a_function_grows_alike() {
        let axes = Axes::identity() * H;
        let next = differences(3, &axes, quadratic).axes(&axes, (1e-6, 10.0));
        let found = differences(3, &next, quadratic);
        assert!((found.curvature - SMatrix::identity()).norm() < 1e-9, "{}", found.curvature);
        let short = differences(3, &axes, quadratic).axes(&axes, (1e-6, 0.1));
        assert!(short.amax() < 0.1 + 1e-12);
    }

    #[test]
    fn without_a_bowl_it_goes_downhill_in_the_parameters_that_there_are() {
        let axes = Axes::identity() * H;
        let f = |[x, y, _]: [f64; 3]| x - y * y - 3.0 * y;
        let [x, y, z] = differences(2, &axes, f).step(&axes, 0.3);
        assert!((-0.3..-0.01).contains(&x) && (0.1..0.31).contains(&y), "{x} {y}");
        assert!(z.abs() < 1e-12);
    }
}
