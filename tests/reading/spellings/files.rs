//! Several files, and folders.

use super::*;

#[test]
fn several_files_add_trials_named_after_them() {
    let text = "time_s,trial,boom.input,boom.output\n0,x,0,0\n1,x,0,0\n0,y,0,0\n1,y,0,0\n";
    let other = PLAIN.replace("boom", "arm");
    let reading =
        Reading::nothing().and("one.csv", text).and("two.csv", PLAIN).and("three.csv", other);
    let joints = reading.joints();
    let [boom, arm] = joints.as_slice() else { panic!("{joints:?}") };
    assert_eq!(labels(boom), ["one/x", "one/y", "two"]);
    assert_eq!(labels(arm), ["three"]);
    let sources = reading.read().sources;
    assert_eq!(sources.len(), 3);
    assert_eq!(sources[1].bytes, PLAIN.len() as u64);
}

#[test]
fn files_of_one_name_are_told_apart() {
    let (mut reading, others) = (Reading::of(PLAIN), [Reading::of(PLAIN), Reading::of(PLAIN)]);
    reading.paths.extend(others.iter().map(|other| other.paths[0].clone()));
    assert_eq!(labels(&reading.the_joint()), ["log", "log~2", "log~3"]);
}

#[test]
fn a_file_that_is_given_twice_counts_once() {
    let mut reading = Reading::of(PLAIN);
    let path = reading.paths[0].clone();
    // Through the folder and back.
    let folder = path.parent().unwrap();
    reading.paths.push(folder.join("..").join(folder.file_name().unwrap()).join("log.csv"));
    assert_eq!(labels(&reading.the_joint()), ["log"]);
    let notes = reading.read().notes;
    assert!(notes.len() == 1 && notes[0].ends_with("read once"), "{notes:?}");
}

#[test]
fn a_joint_in_other_units_is_not_mixed_with_the_first_ones() {
    let radians = PLAIN.replace("boom.output", "boom.output [rad]");
    let reading = Reading::of(PLAIN).and("other.csv", radians);
    assert!(
        reading.error().to_string().contains("in [no unit, rad] here but in [no unit, no unit]")
    );
    assert_eq!(labels(&reading.read().joints[0]), ["log"]);
}

#[test]
fn of_a_folder_the_logs_are_read_in_order_and_the_truth_is_left_out() {
    let reading = Reading::nothing();
    for name in
        ["b.csv", "a.CSV", "c.tsv", "d.txt", "b.truth.csv", "notes.md", "e.csv.bak", "._b.csv"]
    {
        reading.file(name, PLAIN);
    }
    fs::create_dir(reading.folder.path().join("f.csv")).unwrap();
    let extra = Reading::of(PLAIN);
    let paths = [extra.paths[0].clone(), reading.folder.path().to_owned()];
    let (found, failures) = expand_folders(&paths);
    assert!(failures.is_empty());
    let names: Vec<_> =
        found.iter().map(|path| path.file_name().unwrap().to_str().unwrap()).collect();
    assert_eq!(names, ["log.csv", "a.CSV", "b.csv", "c.tsv", "d.txt"]);
    let joints = Reading { paths: found, ..reading }.joints();
    assert_eq!(labels(&joints[0]), ["log", "a", "b", "c", "d"]);
}

/// A shell's `*.csv` names the truth, too.
#[test]
fn beside_a_log_the_truth_is_left_out_and_alone_it_is_not() {
    let reading = Reading::of(PLAIN);
    let truth = reading.file("log.truth.csv", "joint,trial,i,p\n");
    let log = reading.paths[0].clone();
    let (found, failures) = expand_folders(&[log.clone(), truth.clone()]);
    assert!(failures.is_empty());
    assert_eq!(found, [log], "as if it had not been named");
    let (found, _) = expand_folders(std::slice::from_ref(&truth));
    assert_eq!(found, [truth], "a message tells what it is");
}
