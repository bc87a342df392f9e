//! The low-pass against SciPy's numbers; `golden/low_pass.py` made them.

use tauscope::numerics::LowPass;
use tauscope::units::SamplePeriod;

#[test]
fn every_order_and_rate_agrees_to_1e_9_of_the_range() {
    let mut table = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .from_path("tests/golden/low_pass.csv")
        .unwrap();
    let headers: Vec<String> = table.headers().unwrap().iter().map(str::to_owned).collect();
    let rows: Vec<Vec<f64>> = table.deserialize().map(Result::unwrap).collect();
    let column = |index: usize| rows.iter().map(|row| row[index]).collect::<Vec<f64>>();
    let signal = column(0);
    let highest = signal.iter().copied().fold(f64::MIN, f64::max);
    let lowest = signal.iter().copied().fold(f64::MAX, f64::min);
    assert_eq!(headers.len(), 8);
    for (index, header) in headers.iter().enumerate().skip(1) {
        let case: Vec<f64> = header.split('/').map(|part| part.parse().unwrap()).collect();
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 to 8")]
        let filter = LowPass { cutoff_hz: case[1], order: case[0] as usize };
        let period = SamplePeriod::from_seconds(1.0 / case[2]).unwrap();
        let ours = filter.smooth(&signal, period).unwrap();
        let differences = ours.iter().zip(column(index)).map(|(a, b)| (a - b).abs());
        let worst = differences.fold(0.0, f64::max);
        assert!(worst <= 1e-9 * (highest - lowest), "{header}: {worst:e}");
    }
}
