//! Logs that other programs wrote read as the CSV of the same data does; damaged ones are
//! refused with what to do. The files are made by `tests/golden/formats.py`.

use std::path::{Path, PathBuf};

use tauscope::experiment::{Experiment, ReadOptions};

fn golden(name: &str) -> PathBuf {
    Path::new("tests/golden/formats").join(name)
}

/// How a log is read.
#[cfg(any(feature = "mat", feature = "mcap", feature = "parquet"))]
fn mapped(joints: &[(&str, &str, &str)]) -> ReadOptions {
    use tauscope::experiment::JointColumns;
    let joint = |(name, input, output): &(&str, &str, &str)| JointColumns::new(name, input, output);
    let mut options = ReadOptions::default();
    options.columns.joints = joints.iter().map(joint).collect();
    options
}

fn read(path: PathBuf, options: &ReadOptions) -> Experiment {
    Experiment::read(&[path], options)
}

/// Reads a log that has nothing wrong with it.
#[cfg(any(feature = "mat", feature = "mcap", feature = "parquet"))]
fn read_whole(name: &str, options: &ReadOptions) -> Experiment {
    let found = read(golden(name), options);
    assert!(found.failures.is_empty(), "{name}: {:?}", found.failures);
    found
}

/// The message on the only thing that is wrong with a log.
fn refusal(path: PathBuf, options: &ReadOptions) -> String {
    let found = read(path, options);
    assert_eq!(found.failures.len(), 1, "{:?}", found.failures);
    assert!(found.joints.is_empty());
    found.failures[0].error.to_string()
}

/// A file with these bytes, which is there as long as its folder.
fn written(name: &str, bytes: &[u8]) -> (tempfile::TempDir, PathBuf) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join(name);
    std::fs::write(&path, bytes).unwrap();
    (folder, path)
}

#[test]
fn a_file_that_is_not_what_its_name_says_is_refused_with_the_remedy() {
    for (name, format) in [("log.parquet", "Parquet"), ("log.mat", "MATLAB"), ("log.mcap", "MCAP")]
    {
        let (_folder, path) = written(name, b"time_s,a.input,a.output\n0,1,2\n");
        let message = refusal(path, &ReadOptions::default());
        assert!(message.contains(&format!("cannot be read as {format}")), "{message}");
        assert!(message.contains("rename it"), "{message}");
    }
}

#[test]
#[cfg(unix)]
fn a_log_may_come_through_a_pipe() {
    use std::process::{Command, Stdio};
    let mut cat =
        Command::new("cat").arg(golden("log.csv")).stdout(Stdio::piped()).spawn().unwrap();
    let estimate = |log: &str, input: Stdio| {
        Command::new(env!("CARGO_BIN_EXE_tauscope"))
            .args(["estimate", log])
            .stdin(input)
            .output()
            .unwrap()
    };
    let piped = estimate("/dev/stdin", cat.stdout.take().unwrap().into());
    cat.wait().unwrap();
    let file = estimate(golden("log.csv").to_str().unwrap(), Stdio::null());
    assert!(piped.status.success(), "{}", String::from_utf8_lossy(&piped.stderr));
    assert_eq!(piped.stdout, file.stdout);
}

#[test]
fn a_build_without_a_format_says_which_feature_reads_it() {
    for (name, feature, is_there) in [
        ("zstd.parquet", "parquet", cfg!(feature = "parquet")),
        ("v7.mat", "mat", cfg!(feature = "mat")),
        ("zstd.mcap", "mcap", cfg!(feature = "mcap")),
    ] {
        if !is_there {
            let message = refusal(golden(name), &ReadOptions::default());
            assert!(
                message.ends_with(&format!("build it with `--features {feature}`")),
                "{message}"
            );
        }
    }
}

#[cfg(feature = "parquet")]
mod parquet {
    use super::*;

    #[test]
    fn every_compression_reads_as_the_csv_does() {
        let csv = read_whole("log.csv", &ReadOptions::default());
        for compression in ["zstd", "snappy", "gzip", "lz4", "none"] {
            let found = read_whole(&format!("{compression}.parquet"), &ReadOptions::default());
            assert_eq!(found.joints, csv.joints, "{compression}");
            assert_eq!(found.sources[0].sha256.len(), 64);
        }
        assert_eq!(csv.joints[0].trials.len(), 2);
        assert_eq!(csv.joints[0].covariates.len(), 1);
    }

    #[test]
    fn times_structures_dictionaries_and_short_numbers_are_read() {
        let found = read_whole("typed.parquet", &ReadOptions::default());
        assert_eq!(found.joints, read_whole("typed.csv", &ReadOptions::default()).joints);
    }

    #[test]
    fn durations_decimals_and_half_precision_are_read() {
        let found = read_whole("narrow.parquet", &ReadOptions::default());
        assert_eq!(found.joints, read_whole("narrow.csv", &ReadOptions::default()).joints);
    }

    #[test]
    fn durations_have_the_unit_that_arrow_notes_without_pandas() {
        let found = read_whole("durations.parquet", &ReadOptions::default());
        assert_eq!(found.joints, read_whole("narrow.csv", &ReadOptions::default()).joints);
    }

    /// A file with these columns of 100 rows, by their names.
    fn table(folder: &Path, columns: Vec<(&str, ::arrow_array::ArrayRef)>) -> PathBuf {
        let path = folder.join("log.parquet");
        let batch = ::arrow_array::RecordBatch::try_from_iter(columns).unwrap();
        let file = std::fs::File::create(&path).unwrap();
        let writer = ::parquet::arrow::ArrowWriter::try_new(file, batch.schema(), None);
        let mut writer = writer.unwrap();
        writer.write(&batch).unwrap();
        writer.close().unwrap();
        path
    }

    #[test]
    fn the_type_of_a_column_says_its_unit_and_not_its_name() {
        use std::sync::Arc;

        use ::arrow_array::{ArrayRef, DurationMicrosecondArray, Float64Array};
        let folder = tempfile::tempdir().unwrap();
        let numbers = |of: fn(i32) -> f64| -> ArrayRef {
            Arc::new(Float64Array::from_iter_values((0..100).map(of)))
        };
        let times = DurationMicrosecondArray::from_iter_values((0..100).map(|k| k * 20_000));
        let path = table(
            folder.path(),
            vec![
                ("time [ms]", Arc::new(times) as ArrayRef),
                ("a.input", numbers(|k| f64::from(k / 20 % 2))),
                ("a.output", numbers(f64::from)),
            ],
        );
        let found = read(path, &ReadOptions::default());
        assert!(
            (found.joints[0].trials[0].period().seconds() - 0.02).abs() < 1e-12,
            "{:?}",
            found.failures
        );
    }

    #[test]
    fn times_of_96_bits_are_read() {
        use std::sync::Arc;

        use ::parquet::data_type::{DoubleType, Int96, Int96Type};
        use ::parquet::file::writer::SerializedFileWriter;
        /// Days from the origin of these times to 1970.
        const JULIAN: u32 = 2_440_588;
        let folder = tempfile::tempdir().unwrap();
        let schema = "message log { optional int96 time; optional double input; optional double \
                      output; }";
        let schema = ::parquet::schema::parser::parse_message_type(schema).unwrap();
        let path = folder.path().join("log.parquet");
        let file = std::fs::File::create(&path).unwrap();
        let mut writer = SerializedFileWriter::new(file, schema.into(), Arc::default()).unwrap();
        let mut group = writer.next_row_group().unwrap();
        let time = |k: u64| {
            let mut time = Int96::new();
            let nanoseconds = k * 20_000_000;
            time.set_data((nanoseconds & 0xffff_ffff) as u32, (nanoseconds >> 32) as u32, JULIAN);
            time
        };
        let mut column = group.next_column().unwrap().unwrap();
        let times: Vec<Int96> = (0..100).map(time).collect();
        column.typed::<Int96Type>().write_batch(&times, Some(&[1; 100]), None).unwrap();
        column.close().unwrap();
        for of in [|k: i32| f64::from(k / 20 % 2), f64::from] {
            let mut column = group.next_column().unwrap().unwrap();
            let values: Vec<f64> = (0..100).map(of).collect();
            column.typed::<DoubleType>().write_batch(&values, Some(&[1; 100]), None).unwrap();
            column.close().unwrap();
        }
        group.close().unwrap();
        writer.close().unwrap();
        let found = read(path, &mapped(&[("a", "input", "output")]));
        assert!(
            (found.joints[0].trials[0].period().seconds() - 0.02).abs() < 1e-12,
            "{:?}",
            found.failures
        );
    }

    #[test]
    fn a_compression_that_is_not_built_in_is_named_with_its_column() {
        let message = refusal(golden("brotli.parquet"), &ReadOptions::default());
        for part in ["column `time_s` is compressed by brotli", "write it with zstd or snappy"] {
            assert!(message.contains(part), "{message}");
        }
    }

    #[test]
    fn where_a_structure_is_missing_its_fields_are() {
        use std::sync::Arc;

        use ::arrow_array::{ArrayRef, Float64Array, StructArray};
        use ::arrow_schema::{DataType, Field};
        let folder = tempfile::tempdir().unwrap();
        let numbers = |of: fn(i32) -> f64| -> ArrayRef {
            Arc::new(Float64Array::from_iter_values((0..100).map(of)))
        };
        let fields = ["input", "output"].map(|name| Field::new(name, DataType::Float64, false));
        let parts = vec![numbers(|k| f64::from(k / 20 % 2)), numbers(f64::from)];
        let present: Vec<bool> = (0..100).map(|k| !(50..65).contains(&k)).collect();
        let joint = StructArray::try_new(fields.to_vec().into(), parts, Some(present.into()));
        let columns = vec![
            ("time_s", numbers(|k| 0.02 * f64::from(k))),
            ("boom", Arc::new(joint.unwrap()) as ArrayRef),
        ];
        let found = read(table(folder.path(), columns), &ReadOptions::default());
        for column in ["boom.input", "boom.output"] {
            let note = format!("15 cells are empty or NaN in `{column}`");
            assert!(found.notes.iter().any(|said| said.contains(&note)), "{:?}", found.notes);
        }
    }

    #[test]
    fn text_in_place_of_numbers_is_named_with_its_column() {
        let options = mapped(&[("boom", "boom.input", "note")]);
        let message = refusal(golden("typed.parquet"), &options);
        assert!(message.ends_with(
            "typed.parquet, column `note`: it holds text, not numbers; choose another column, or \
             write it as numbers"
        ), "{message}");
    }

    #[test]
    fn dates_without_a_time_of_day_are_no_times() {
        let message = refusal(golden("dated.parquet"), &ReadOptions::default());
        assert!(
            message.contains("column `time`: it holds dates without a time of day"),
            "{message}"
        );
    }

    #[test]
    fn a_column_that_is_missing_is_offered_in_its_right_spelling() {
        let options = mapped(&[("boom", "boom.inptu", "boom.output")]);
        let message = refusal(golden("typed.parquet"), &options);
        let expected = "typed.parquet: column `boom.inptu` is missing (did you mean `boom.input`?)";
        assert!(message.contains(expected), "{message}");
    }

    /// The cells of a Parquet file as CSV would show them, and the types of its columns.
    fn cells(path: &Path) -> (Vec<Vec<String>>, Vec<String>) {
        use ::parquet::file::reader::{FileReader as _, SerializedFileReader};
        use ::parquet::record::Field;
        let reader = SerializedFileReader::new(std::fs::File::open(path).unwrap()).unwrap();
        let schema = reader.metadata().file_metadata().schema_descr();
        let types = schema.columns().iter().map(|column| column.physical_type().to_string());
        let types = types.collect();
        let cell = |field: &Field| match field {
            Field::Null => String::new(),
            Field::Long(number) => number.to_string(),
            Field::Double(number) => number.to_string(),
            Field::Str(text) => text.clone(),
            other => format!("{other:?}"),
        };
        let row =
            |row: ::parquet::record::Row| row.get_column_iter().map(|(_, f)| cell(f)).collect();
        (reader.get_row_iter(None).unwrap().map(|found| row(found.unwrap())).collect(), types)
    }

    /// The cells of a CSV file, numbers as they would be printed.
    fn csv_cells(path: &Path) -> Vec<Vec<String>> {
        let mut reader = csv::Reader::from_path(path).unwrap();
        let cell = |cell: &str| cell.parse::<f64>().map_or(cell.to_owned(), |n| n.to_string());
        reader.records().map(|row| row.unwrap().iter().map(cell).collect()).collect()
    }

    #[test]
    fn results_as_parquet_are_those_of_the_csv() {
        let folder = tempfile::tempdir().unwrap();
        for (option, method) in
            [("decisions", "two-line"), ("decisions", "hinge"), ("delays", "two-line")]
        {
            let paths =
                ["csv", "parquet"].map(|ending| folder.path().join(format!("{option}.{ending}")));
            for path in &paths {
                let status = std::process::Command::new(env!("CARGO_BIN_EXE_tauscope"))
                    .args(["estimate", "tests/golden/formats/log.csv", "-q", "--method", method])
                    .arg(format!("--{option}"))
                    .arg(path)
                    .output()
                    .unwrap()
                    .status;
                assert!(status.success());
            }
            let (found, types) = cells(&paths[1]);
            let expected = csv_cells(&paths[0]);
            assert!(found.len() > 20 && found == expected, "{option} {method}");
            let numbers = types.iter().filter(|kind| *kind == "DOUBLE").count();
            let expected = match (option, method) {
                ("delays", _) => 3,
                (_, "hinge") => 12,
                _ => 8,
            };
            assert_eq!(numbers, expected, "{option} {method}: {types:?}");
        }
    }

    #[test]
    fn a_file_that_is_cut_or_damaged_is_refused() {
        let whole = std::fs::read(golden("zstd.parquet")).unwrap();
        for length in [4, 100, whole.len() / 2, whole.len() - 1] {
            let (_folder, path) = written("log.parquet", &whole[..length]);
            let message = refusal(path, &ReadOptions::default());
            assert!(message.contains("cannot be read as Parquet"), "{message}");
            assert!(message.contains("write it again"), "{message}");
        }
        for place in (4..whole.len()).step_by(173) {
            let mut damaged = whole.clone();
            damaged[place] ^= 0x55;
            let (_folder, path) = written("log.parquet", &damaged);
            // Parquet has no checksums by default: what counts is that nothing panics.
            read(path, &ReadOptions::default());
        }
    }
}

#[cfg(feature = "mat")]
mod mat {
    use super::*;

    /// The joints of the fixtures: a structure, and a vector with a column of a matrix.
    fn both() -> ReadOptions {
        mapped(&[("boom", "boom.input", "boom.output"), ("arm", "u", "y(2)")])
    }

    #[test]
    fn an_object_is_named_with_what_to_save_instead() {
        use crate::bytes::mat::{array, file, object};

        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("log.mat");
        for (class, remedy) in [("timeseries", "`.Time` and `.Data`"), ("mine", "its parts")] {
            // A gain beside it is no log.
            let variables = [array("gain", 1, &[3]), object("out", class)].concat();
            std::fs::write(&path, file(&variables)).unwrap();
            let found = Experiment::read(std::slice::from_ref(&path), &ReadOptions::default());
            let message = found.failures[0].error.to_string();
            for part in ["`out`", &format!("`{class}`"), remedy] {
                assert!(message.contains(part), "{message}");
            }
        }
    }

    #[test]
    fn versions_6_and_7_read_as_the_csv_does() {
        let csv = read_whole("mat.csv", &both());
        for name in ["v6.mat", "v7.mat"] {
            assert_eq!(read_whole(name, &both()).joints, csv.joints, "{name}");
        }
        assert_eq!(csv.joints[1].trials[1].label(), "second");
    }

    #[test]
    fn version_7_3_reads_as_the_csv_does() {
        let mut options = both();
        options.columns.trial = Some("none".to_owned());
        let csv = read_whole("mat.csv", &options);
        assert_eq!(read_whole("v73.mat", &options).joints, csv.joints);
    }

    #[test]
    fn what_is_not_as_long_as_the_times_stands_in_no_way() {
        let found = read_whole("workspace.mat", &ReadOptions::default());
        assert_eq!(found.joints.len(), 1);
        assert_eq!(found.joints[0].trials[0].len(), 400);
        assert!(
            found.notes.iter().any(|note| note.contains("output `angle`")),
            "{:?}",
            found.notes
        );
    }

    #[test]
    fn a_structure_per_joint_needs_no_mapping() {
        let found = read_whole("v7.mat", &ReadOptions::default());
        assert_eq!(found.joints.len(), 1);
        assert_eq!(found.joints[0].name, "boom");
    }

    #[test]
    fn what_is_no_column_is_named_with_what_it_is() {
        for name in ["v6.mat", "v7.mat", "v73.mat"] {
            let message = refusal(golden(name), &mapped(&[("boom", "note", "y(1)")]));
            assert!(message.contains("column `note`: it holds text, not numbers"), "{message}");
            let message = refusal(golden(name), &mapped(&[("boom", "gain", "y(1)")]));
            assert!(message.contains("column `gain` is missing"), "{message}");
        }
    }

    #[test]
    fn version_4_is_refused_with_what_to_save_instead() {
        let message = refusal(golden("v4.mat"), &ReadOptions::default());
        assert!(message.contains("save it with `save -v7`"), "{message}");
    }

    #[test]
    fn a_file_that_is_cut_is_refused_and_a_damaged_one_does_no_harm() {
        for name in ["v6.mat", "v7.mat", "v73.mat"] {
            let whole = std::fs::read(golden(name)).unwrap();
            for part in 1..20 {
                let (_folder, path) = written(name, &whole[..whole.len() * part / 20]);
                let found = read(path, &both());
                let cut_between_variables = name != "v73.mat" && found.joints.is_empty();
                assert!(cut_between_variables || !found.failures.is_empty(), "{name} {part}");
            }
            for place in (128..whole.len()).step_by(331) {
                let mut damaged = whole.clone();
                damaged[place] ^= 0x55;
                let (_folder, path) = written(name, &damaged);
                read(path, &both());
            }
        }
    }

    #[test]
    fn a_field_and_a_column_of_a_matrix_make_a_joint() {
        let found = read(golden("v7.mat"), &mapped(&[("boom", "boom.input", "y(1)")]));
        assert!(found.failures.is_empty());
    }
}

#[cfg(feature = "xlsx")]
mod xlsx {
    use super::*;
    use crate::hostile::workbook::of_sheets;

    const COVER: &[&[&str]] = &[&["made", "by"], &["some", "body"]];
    const LEVELS: &[&[&str]] = &[&["No", "Level"], &["1", "0.5"], &["2", "1.5"]];
    const LOG: &[&[&str]] = &[
        &["Rig 3"],
        &["time_s", "boom.input", "boom.output", "arm.input", "arm.output"],
        &["0", "0", "0", "0", "0"],
        &["0.1", "0", "0", "1", "="],
        &["0.2", "1", "1", "1", "="],
        &["0.3", "1", "2", "1", "="],
    ];

    fn read_sheets(sheets: &[&[&[&str]]]) -> Experiment {
        let (_folder, path) = written("log.xlsx", &of_sheets(sheets));
        read(path, &ReadOptions::default())
    }

    #[test]
    fn the_sheet_with_a_column_of_times_is_read_else_one_with_numbers() {
        let found = read_sheets(&[COVER, LEVELS, LOG]);
        assert_eq!(found.joints.len(), 1);
        assert!(found.notes.iter().any(|n| n.contains("the sheet `s3` of 3")), "{:?}", found.notes);
        let message = read_sheets(&[COVER, LEVELS]).failures[0].error.to_string();
        assert!(message.contains("Level"), "{message}");
    }

    #[test]
    fn a_formula_without_a_value_is_named_with_what_to_do() {
        let found = read_sheets(&[COVER, LOG]);
        assert_eq!(found.joints.len(), 1, "{:?}", found.failures);
        assert_eq!(found.joints[0].name, "boom");
        let message = found.failures[0].error.to_string();
        for part in ["`arm.output`", "row 4", "a formula without a value: open and save"] {
            assert!(message.contains(part), "{message}");
        }
    }
}

#[cfg(feature = "mcap")]
mod mcap {
    use super::*;

    /// The joints of the fixtures.
    fn both() -> ReadOptions {
        mapped(&[
            ("boom", "/valve.data[0]", "/joint_states.position[boom]"),
            ("arm", "/valve.data[1]", "/joint_states.position[arm]"),
        ])
    }

    fn assert_equal(name: &str, options: &ReadOptions, csv: &str) {
        let expected = read_whole(csv, &ReadOptions::default());
        assert!(read_whole(name, options).joints == expected.joints, "{name} differs");
    }

    #[test]
    fn every_compression_reads_as_the_csv_does() {
        for name in ["zstd.mcap", "lz4.mcap", "none.mcap"] {
            assert_equal(name, &both(), "ros.csv");
        }
    }

    #[test]
    fn a_file_without_a_summary_or_out_of_order_reads_the_same() {
        for name in ["no_summary.mcap", "backwards.mcap"] {
            assert_equal(name, &both(), "ros.csv");
        }
    }

    #[test]
    fn times_may_be_those_of_publishing_or_of_the_messages() {
        let options = |time: &str, joint: (&str, &str, &str)| {
            let mut options = mapped(&[joint]);
            options.columns.time = Some(time.to_owned());
            options
        };
        let boom = ("boom", "/valve.data[0]", "/joint_states.position[boom]");
        assert_eq!(
            read_whole("zstd.mcap", &options("publish_time", boom)).joints,
            read_whole("zstd.mcap", &options("log_time", boom)).joints
        );
        let states = ("boom", "/joint_states.position[arm]", "/joint_states.position[boom]");
        assert_eq!(
            read_whole("zstd.mcap", &options("header.stamp", states)).joints[0].trials[0].len(),
            400
        );
        let message = refusal(golden("zstd.mcap"), &options("header.stamp", boom));
        assert!(message.contains("the messages of `/valve` have no header.stamp"), "{message}");
    }

    #[test]
    fn joints_of_two_topics_keep_their_own_times() {
        let options = mapped(&[
            ("boom", "/valve.data[0]", "/joint_states.position[boom]"),
            ("grip", "/valve.data[0]", "/gripper_states.position[grip]"),
        ]);
        let found = read_whole("zstd.mcap", &options);
        let states = read_whole("ros.csv", &ReadOptions::default());
        let grip = read_whole("grip.csv", &ReadOptions::default());
        assert_eq!(found.joints, [states.joints[0].clone(), grip.joints[0].clone()]);
        assert_eq!(found.sources.len(), 1);
    }

    #[test]
    fn nodes_that_take_turns_on_one_topic_are_told_apart() {
        let boom = mapped(&[("boom", "/valve.data[0]", "/joint_states.position[boom]")]);
        let trial = &read_whole("turns.mcap", &boom).joints[0].trials[0];
        // Every second message, and as many between two of these as the steps of the valve need.
        assert_eq!(trial.len(), 198 * 4 + 1);
        assert!((trial.period().seconds() - 0.01).abs() < 1e-12);
    }

    #[test]
    fn a_clock_that_is_set_back_is_refused() {
        let boom = mapped(&[("boom", "/valve.data[0]", "/joint_states.position[boom]")]);
        let message = refusal(golden("set_back.mcap"), &boom);
        assert!(message.contains("its clock starts anew"), "{message}");
    }

    #[test]
    fn a_topic_that_pauses_is_named() {
        let boom = mapped(&[("boom", "/valve.data[0]", "/joint_states.position[boom]")]);
        let notes = read_whole("pauses.mcap", &boom).notes;
        let said =
            |note: &String| note.contains("`/valve` pauses once, for up to 0.36 s: the last");
        assert!(notes.iter().any(said), "{notes:?}");
    }

    #[test]
    fn a_command_that_comes_late_takes_no_rows_from_other_joints() {
        let boom = ("boom", "/valve.data[0]", "/joint_states.position[boom]");
        let arm = ("arm", "/arm_valve.data[1]", "/joint_states.position[arm]");
        let alone = read_whole("zstd.mcap", &mapped(&[boom])).joints.remove(0);
        let both = read_whole("late_command.mcap", &mapped(&[boom, arm]));
        assert_eq!(both.joints[0].trials, alone.trials);
        assert_eq!(both.joints[1].trials[0].len(), alone.trials[0].len());
        let said = |words: &str| both.notes.iter().any(|note| note.contains(words));
        assert!(
            said("before the first value, the first one is used, so a step to it is not known"),
            "{both:?}"
        );
        assert!(!said("later messages"), "{both:?}");
    }

    #[test]
    fn a_joint_that_is_added_late_is_a_column() {
        let bucket = ("bucket", "/valve.data[0]", "/joint_states.position[bucket]");
        let found = read_whole("late_command.mcap", &mapped(&[bucket]));
        let [trial] = &found.joints[0].trials[..] else { panic!("{found:?}") };
        assert_eq!(trial.len(), 199, "the states of the second half");
        let note = "of 400 messages of `/joint_states` have none of its values and are left out";
        assert!(found.notes.iter().any(|said| said.contains(note)), "{:?}", found.notes);
    }

    #[test]
    fn steps_between_the_messages_of_a_slow_output_keep_their_times() {
        let boom = mapped(&[("boom", "/valve.data[0]", "/joint_states.position[boom]")]);
        let steps_s = |name: &str| {
            let found = read_whole(name, &boom);
            let trial = &found.joints[0].trials[0];
            let pairs = trial.input().windows(2).zip(2..);
            let steps = pairs.filter(|(pair, _)| (pair[1] - pair[0]).abs() > 0.0);
            let steps: Vec<f64> = steps.map(|(_, sample)| trial.logged_time_s(sample)).collect();
            (steps, found.notes)
        };
        let ((whole, _), (slow, notes)) = (steps_s("zstd.mcap"), steps_s("slow_states.mcap"));
        assert_eq!(slow.len(), whole.len());
        // Where all states are there, a step is at the first of them after the command.
        assert!(
            slow.iter().zip(&whole).all(|(slow, whole)| (slow - whole).abs() < 0.011),
            "{slow:?}"
        );
        assert!(
            notes.iter().any(|note| note.contains("it is interpolated between them")),
            "{notes:?}"
        );
    }

    #[test]
    fn a_file_without_chunks_is_compared_with_its_checksum() {
        // Its data end with the record 15 of four bytes, which are zero where nothing was summed up.
        const END: [u8; 13] = [15, 4, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0];
        let mut bytes = std::fs::read(golden("no_summary.mcap")).unwrap();
        let end = bytes.windows(END.len()).rposition(|text| text == END).unwrap();
        let sum = crc32fast::hash(&bytes[..end]);
        bytes[end + 9..end + 13].copy_from_slice(&sum.to_le_bytes());
        let (_folder, path) = written("log.mcap", &bytes);
        assert_eq!(read(path, &both()).joints.len(), 2);
        let angle = bytes[..end].windows(4).rposition(|text| text == b"grip").unwrap() + 18;
        bytes[angle] ^= 0x10;
        let (_folder, path) = written("log.mcap", &bytes);
        let message = refusal(path, &both());
        assert!(message.contains("`mcap recover FILE` saves what is whole"), "{message}");
    }

    #[test]
    fn what_is_held_and_where_time_starts_is_told() {
        let notes = read_whole("zstd.mcap", &both()).notes;
        assert!(
            notes[0].ends_with("times are log_time from 1700000000.000000000 s on"),
            "{notes:?}"
        );
        assert!(notes[1].ends_with(
            "`/valve` is held from its latest message at each message of `/joint_states`, of which \
             the first 2 come too early and are left out"
        ), "{notes:?}");
    }

    #[test]
    fn without_a_mapping_the_columns_are_listed() {
        let message = refusal(golden("zstd.mcap"), &ReadOptions::default());
        assert!(message.contains("a joint needs the columns"), "{message}");
        assert!(message.contains("/joint_states.position[boom]"), "{message}");
        let misspelt = mapped(&[("boom", "/valve.data[0]", "/joint_states.position[bom]")]);
        let message = refusal(golden("zstd.mcap"), &misspelt);
        assert!(message.contains("did you mean `/joint_states.position[boom]`?"), "{message}");
    }

    #[test]
    fn a_file_that_is_cut_or_damaged_is_refused() {
        let whole = std::fs::read(golden("zstd.mcap")).unwrap();
        for part in 1..20 {
            let (_folder, path) = written("log.mcap", &whole[..whole.len() * part / 20]);
            let message = refusal(path, &both());
            assert!(message.contains("`mcap recover FILE` saves what is whole"), "{message}");
        }
        for place in (8..whole.len()).step_by(211) {
            let mut damaged = whole.clone();
            damaged[place] ^= 0x55;
            let (_folder, path) = written("log.mcap", &damaged);
            read(path, &both());
        }
    }
}
