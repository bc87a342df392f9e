//! Rank statistics against SciPy's numbers, and what must hold for any values;
//! `golden/rank.py` made the numbers.

use proptest::prelude::*;
use tauscope::numerics::{mann_whitney, spearman};

fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').map(|number| number.parse().unwrap()).collect()
}

#[test]
fn statistics_and_p_values_agree_to_1e_9() {
    let mut table =
        csv::ReaderBuilder::new().comment(Some(b'#')).from_path("tests/golden/rank.csv").unwrap();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert!(rows.len() > 50);
    for row in rows {
        let (x, y) = (numbers(&row[4]), numbers(&row[5]));
        let test = if &row[0] == "spearman" { spearman(&x, &y) } else { mann_whitney(&x, &y) };
        let (test, statistic, p_value) = (test.unwrap(), numbers(&row[2])[0], numbers(&row[3])[0]);
        assert!((test.statistic - statistic).abs() < 1e-9, "{row:?}: {test:?}");
        // Down to 1e-300 the p-values are small numbers, not zeros.
        assert!((test.p_value - p_value).abs() <= 1e-9 * p_value, "{row:?}: {test:?}");
    }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() < 1e-9
}

proptest! {
    #[test]
    fn a_monotone_transform_changes_no_correlation(
        pairs in prop::collection::vec((-50_i32..50, -50_i32..50), 4..30),
    ) {
        let x: Vec<f64> = pairs.iter().map(|pair| f64::from(pair.0)).collect();
        let y: Vec<f64> = pairs.iter().map(|pair| f64::from(pair.1)).collect();
        let bent: Vec<f64> = x.iter().map(|x| (x / 7.0).exp()).collect();
        let down: Vec<f64> = x.iter().map(|x| -x * x * x).collect();
        prop_assert_eq!(spearman(&x, &y), spearman(&bent, &y));
        if let (Some(a), Some(b)) = (spearman(&x, &y), spearman(&down, &y)) {
            prop_assert!(near(a.statistic, -b.statistic) && near(a.p_value, b.p_value));
        }
    }

    #[test]
    fn the_order_of_variables_pairs_and_groups_does_not_matter(
        pairs in prop::collection::vec((-9_i32..9, -9_i32..9), 4..30),
    ) {
        let x: Vec<f64> = pairs.iter().map(|pair| f64::from(pair.0)).collect();
        let y: Vec<f64> = pairs.iter().map(|pair| f64::from(pair.1)).collect();
        let back = |values: &[f64]| values.iter().rev().copied().collect::<Vec<f64>>();
        if let Some(test) = spearman(&x, &y) {
            let swapped = spearman(&y, &x).unwrap();
            let reversed = spearman(&back(&x), &back(&y)).unwrap();
            for other in [swapped, reversed] {
                prop_assert!(near(test.statistic, other.statistic));
                prop_assert!(near(test.p_value, other.p_value));
            }
        }
        if let (Some(a), Some(b)) = (mann_whitney(&x, &y), mann_whitney(&y, &x)) {
            prop_assert!(near(a.p_value, b.p_value));
            prop_assert!(near(a.statistic + b.statistic, (x.len() * y.len()) as f64));
        }
    }
}

#[test]
fn exact_and_approximate_p_values_meet() {
    let x: Vec<f64> = (0..20).map(f64::from).collect();
    let y: Vec<f64> = (0..20).map(|k| f64::from(k * 7 % 20) + 3.5).collect();
    let exact = mann_whitney(&x, &y).unwrap().p_value;
    let one_more = mann_whitney(&[&x[..], &[10.0]].concat(), &y).unwrap().p_value;
    assert!((exact - one_more).abs() < 0.05, "{exact} {one_more}");
}
