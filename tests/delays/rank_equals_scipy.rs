//! Rank statistics against SciPy's numbers, and what must hold for any values;
//! `golden/rank.py` made the numbers.

use proptest::prelude::*;
use tauscope::numerics::spearman;

fn numbers(text: &str) -> Vec<f64> {
    text.split(' ').map(|number| number.parse().unwrap()).collect()
}

#[test]
fn statistics_and_p_values_agree_to_1e_9() {
    let mut table =
        csv::ReaderBuilder::new().comment(Some(b'#')).from_path("tests/golden/rank.csv").unwrap();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert!(rows.len() > 25);
    for row in rows {
        let (x, y) = (numbers(&row[4]), numbers(&row[5]));
        let (test, statistic, p_value) =
            (spearman(&x, &y).unwrap(), numbers(&row[2])[0], numbers(&row[3])[0]);
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
    }
}
