//! Sums of products over samples, in lanes that a processor adds at the same time.

use nalgebra::DMatrix;

/// The products of all columns with each other, `AᵀA`.
pub(crate) fn column_products(columns: &DMatrix<f64>) -> DMatrix<f64> {
    /// Rows at a time: those of 30 columns fill half of a first-level cache.
    const ROWS: usize = 128;
    let (rows, size) = columns.shape();
    let mut products = DMatrix::zeros(size, size);
    let values = columns.as_slice();
    for first in (0..rows).step_by(ROWS) {
        let part = first..(first + ROWS).min(rows);
        let column = |index: usize| &values[index * rows..(index + 1) * rows][part.clone()];
        for i in 0..size {
            for j in 0..=i {
                products[(i, j)] += dot(column(i), column(j));
            }
        }
    }
    products.fill_upper_triangle_with_lower_triangle();
    products
}

/// The sum of products, in lanes that a processor adds at the same time.
pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    const LANES: usize = 8;
    let length = a.len().min(b.len());
    let (a, b) = (&a[..length], &b[..length]);
    let mut sums = [0.0; LANES];
    let (heads_a, heads_b) = (a.chunks_exact(LANES), b.chunks_exact(LANES));
    let rest: f64 = heads_a.remainder().iter().zip(heads_b.remainder()).map(|(a, b)| a * b).sum();
    for (a, b) in heads_a.zip(heads_b) {
        for ((sum, a), b) in sums.iter_mut().zip(a).zip(b) {
            *sum += a * b;
        }
    }
    sums.iter().sum::<f64>() + rest
}

/// The sums of products of `a` with four others, in one pass.
fn dots(a: &[f64], others: [&[f64]; 4]) -> [f64; 4] {
    const LANES: usize = 4;
    let length = others.iter().map(|other| other.len()).fold(a.len(), usize::min);
    let a = &a[..length];
    let others = others.map(|other| &other[..length]);
    let [b, c, d, e] = others.map(|other| other.chunks_exact(LANES));
    let mut sums = [[0.0; LANES]; 4];
    for ((a, (b, c)), (d, e)) in a.chunks_exact(LANES).zip(b.zip(c)).zip(d.zip(e)) {
        for (sums, other) in sums.iter_mut().zip([b, c, d, e]) {
            sums.iter_mut().zip(a).zip(other).for_each(|((sum, a), b)| *sum += a * b);
        }
    }
    // What no full set of lanes is left for.
    let heads = length - length % LANES;
    let mut products = sums.map(|lanes| lanes.iter().sum::<f64>());
    for (product, other) in products.iter_mut().zip(others) {
        let rest = a.iter().zip(other).skip(heads);
        *product += rest.map(|(a, b)| a * b).sum::<f64>();
    }
    products
}

/// The products of a column with each of up to four others; 0 where there are fewer.
pub(crate) fn with_each(column: &[f64], others: &[&[f64]]) -> [f64; 4] {
    if let &[a, b, c, d] = others {
        return dots(column, [a, b, c, d]);
    }
    let mut products = [0.0; 4];
    for (slot, other) in products.iter_mut().zip(others) {
        *slot = dot(column, other);
    }
    products
}

/// Mean products of the values in `windows` with those 0, 1, … `longest` samples before.
pub(crate) fn autocovariances<W: AsRef<[f64]>>(windows: &[W], longest: usize) -> Vec<f64> {
    let windows = || windows.iter().map(AsRef::as_ref);
    let samples: usize = windows().map(<[f64]>::len).sum();
    let covariance = |lag: usize| -> f64 {
        windows().map(|w| w.get(lag..).map_or(0.0, |later| dot(w, later))).sum::<f64>()
            // Divided by all samples, not by the pairs: the covariances stay positive definite.
            / samples.max(1) as f64
    };
    (0..=longest).map(covariance).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_sums_of_products_are_those_of_each() {
        let values = |by: i32| (0..23).map(|k| f64::from(k * by % 7)).collect::<Vec<_>>();
        let others = [values(2), values(3), values(4), values(5)];
        let found = dots(&values(1), others.each_ref().map(Vec::as_slice));
        let each = others.map(|other| dot(&values(1), &other));
        assert!(found.iter().zip(each).all(|(one, other)| (one - other).abs() < 1e-9));
    }
}
