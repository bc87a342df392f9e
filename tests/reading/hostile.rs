//! Files that lie about themselves: each is refused with one message, soon, and without the
//! memory that it claims to need; beside others it keeps none of them from being read.

#[cfg(any(feature = "mat", feature = "mcap"))]
use crate::bytes;
use crate::log_text::log_text;
mod run;
#[cfg(feature = "xlsx")]
pub(crate) mod workbook;
#[cfg(feature = "xlsx")]
mod workbooks;

use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use run::{refused, tauscope};
use tempfile::TempDir;

/// A file of these bytes.
fn file(folder: &TempDir, name: &str, bytes: &[u8]) -> PathBuf {
    let path = folder.path().join(name);
    fs::write(&path, bytes).unwrap();
    path
}

/// Whether the message holds this.
fn assert_says(path: &Path, arguments: &[&str], expected: &str) {
    let said = refused(path, arguments);
    assert!(said.contains(expected), "`{expected}` is not in: {said}");
}

#[cfg(feature = "mcap")]
const JOINT: [&str; 2] = ["--joint", "j=/j.input:/j.output"];

#[test]
#[cfg(feature = "mcap")]
fn a_chunk_of_another_size_than_it_says_is_refused() {
    use bytes::mcap;
    let folder = TempDir::new().unwrap();
    for compression in ["zstd", "lz4", ""] {
        let of = |more: i64| {
            let records = [mcap::topic(mcap::JOINT), mcap::messages()].concat();
            mcap::file(&mcap::chunk(&records, compression, more))
        };
        let whole = file(&folder, "whole.mcap", &of(0));
        let name = whole.to_str().unwrap();
        assert_eq!(tauscope(&["estimate", name, JOINT[0], JOINT[1]]).status, Some(0));
        for more in [1, -1, 255, 1 << 40, i64::MAX] {
            refused(&file(&folder, "wrong.mcap", &of(more)), &JOINT);
        }
    }
}

#[test]
#[cfg(feature = "mcap")]
fn a_summary_that_leads_into_a_chunk_of_another_size_has_an_end() {
    use bytes::mcap;
    let records = [mcap::topic(mcap::JOINT), mcap::messages()].concat();
    let mut bytes = mcap::file(&mcap::chunk(&records, "zstd", 1));
    let start = 8 + mcap::record(1, &[mcap::string("ros2"), mcap::string("x")].concat()).len();
    let summary = bytes.len() - 8 - 20;
    bytes[summary..summary + 8].copy_from_slice(&(start as u64).to_le_bytes());
    let folder = TempDir::new().unwrap();
    refused(&file(&folder, "summary.mcap", &bytes), &JOINT);
}

#[test]
#[cfg(feature = "mcap")]
fn a_record_longer_than_its_file_or_its_chunk_is_refused() {
    use bytes::mcap;
    let long = [&[5][..], &(1_u64 << 30).to_le_bytes(), &[0; 30]].concat();
    let folder = TempDir::new().unwrap();
    refused(&file(&folder, "long.mcap", &mcap::file(&long)), &JOINT);
    let inside = mcap::file(&mcap::chunk(&long, "zstd", 1 << 31));
    refused(&file(&folder, "inside.mcap", &inside), &JOINT);
}

#[test]
#[cfg(feature = "mcap")]
fn a_definition_that_contains_itself_or_has_no_bytes_has_an_end() {
    use bytes::mcap;
    const LINE: &str = "\n================================================================\n";
    let folder = TempDir::new().unwrap();
    let definitions = [
        ("itself", format!("A a{LINE}MSG: demo/A\nA a\n")),
        ("each other", format!("A a{LINE}MSG: demo/A\nB b{LINE}MSG: demo/B\nA a\n")),
        ("twice", format!("A a\nA b{LINE}MSG: demo/A\nA a\nA b\n")),
        ("empty", format!("A[] a{LINE}MSG: demo/A\nuint8[0] x\n")),
        ("fixed", format!("A[4000000000] a{LINE}MSG: demo/A\nuint8[0] x\n")),
        ("largest", format!("float64[{}] a\n", u64::MAX)),
        (
            "halves",
            (0..40).fold("T0[2] a".to_owned(), |text, k| {
                format!("{text}{LINE}MSG: demo/T{k}\nT{n} a\nT{n} b", n = k + 1)
            }),
        ),
    ];
    for (what, definition) in definitions {
        // As many elements as the message may say that it has.
        let message = mcap::message(0, &100_000_000_u32.to_le_bytes());
        let records = [mcap::topic(&definition), message].concat();
        let said = refused(&file(&folder, "definition.mcap", &mcap::file(&records)), &JOINT);
        assert!(said.contains("MCAP"), "{what}: {said}");
    }
}

#[test]
#[cfg(feature = "mat")]
fn a_dataset_larger_than_its_file_can_be_is_refused() {
    use bytes::mat;
    let folder = TempDir::new().unwrap();
    for size in [100_000_000_000, 1 << 60, u64::MAX] {
        let path = file(&folder, "large.mat", &mat::v73_with(400, size));
        assert_says(&path, &[], "larger than a file of");
    }
}

#[test]
#[cfg(feature = "mat")]
fn groups_that_lie_in_one_another_have_an_end() {
    let folder = TempDir::new().unwrap();
    assert_says(&file(&folder, "circle.mat", &bytes::mat::v73_in_a_circle()), &[], "in a circle");
}

#[test]
#[cfg(feature = "mat")]
fn what_is_packed_is_refused_when_it_grows_past_the_limit() {
    use bytes::mat;
    let zeros = mat::packed(&mat::array("a", 60_000_000, &vec![0; 60_000_000]));
    assert!(zeros.len() < 100_000);
    let folder = TempDir::new().unwrap();
    let path = file(&folder, "bomb.mat", &mat::file(&zeros));
    assert_says(&path, &["--max-memory", "100MB"], "--max-memory");
    let few = mat::file(&mat::packed(&mat::array("a", 1 << 30, &[1, 2, 3])));
    assert_says(&file(&folder, "few.mat", &few), &[], "it has 3 values but should have");
    let long = mat::file(&mat::array(&"a".repeat(100_000), 1, &[1]));
    assert_says(&file(&folder, "long.mat", &long), &[], "too long");
}

#[test]
#[cfg(feature = "mat")]
fn more_variables_than_can_be_told_apart_are_refused_and_not_waited_for() {
    let folder = TempDir::new().unwrap();
    let mut file_builder = hdf5_pure::FileBuilder::new();
    let head = [b"MATLAB 7.3 MAT-file".as_slice(), &[b' '; 105], b"\x00\x02IM"].concat();
    file_builder.with_userblock(512).with_userblock_content(&head);
    for number in 0..3001 {
        file_builder.create_dataset(&format!("v{number}")).with_f64_data(&[1.0]);
    }
    let many = file(&folder, "many.mat", &file_builder.finish().unwrap());
    assert_says(&many, &[], "3001 variables are in one group");
}

#[test]
#[cfg(feature = "mat")]
fn a_header_that_names_its_parts_twice_is_refused_and_not_followed() {
    let folder = TempDir::new().unwrap();
    let bytes = fs::read("fuzz/found/mat73/header_that_names_its_parts_twice").unwrap();
    assert_says(&file(&folder, "twice.mat", &bytes), &[], "refers to its own parts without end");
}

#[test]
fn rows_of_words_longer_than_any_remark_are_not_held_back() {
    let folder = TempDir::new().unwrap();
    let words = "a,".repeat(100_000);
    let log = format!("time_s,a.input,a.output\n0,1,2\n{}", format!("{words}\n").repeat(10));
    let path = file(&folder, "words.csv", log.as_bytes());
    assert_says(&path, &["--max-memory", "8MB"], "row 3: 100001 cells");
}

#[test]
#[cfg(feature = "parquet")]
fn a_text_that_many_rows_share_is_held_once_and_no_longer_than_a_name() {
    use parquet::data_type::{ByteArray, ByteArrayType, DoubleType};
    use parquet::file::properties::WriterProperties;
    use parquet::file::writer::SerializedFileWriter;

    let folder = TempDir::new().unwrap();
    let schema = "message log { required double time_s; required double a.input; required double \
                  a.output; required binary trial (UTF8); }";
    let schema = schema.replace("a.input", "a_input").replace("a.output", "a_output");
    let schema = parquet::schema::parser::parse_message_type(&schema).unwrap();
    let compression = parquet::basic::Compression::SNAPPY;
    let properties = WriterProperties::builder().set_compression(compression).build();
    let path = folder.path().join("long.parquet");
    let file = fs::File::create(&path).unwrap();
    let mut writer = SerializedFileWriter::new(file, schema.into(), properties.into()).unwrap();
    let mut group = writer.next_row_group().unwrap();
    let columns: [fn(u32) -> f64; 3] =
        [|k| 0.01 * f64::from(k), |k| f64::from(k / 50 % 2), f64::from];
    for of in columns {
        let mut column = group.next_column().unwrap().unwrap();
        let values: Vec<f64> = (0..300).map(of).collect();
        column.typed::<DoubleType>().write_batch(&values, None, None).unwrap();
        column.close().unwrap();
    }
    let mut column = group.next_column().unwrap().unwrap();
    let names = vec![ByteArray::from(vec![b'x'; 500_000]); 300];
    column.typed::<ByteArrayType>().write_batch(&names, None, None).unwrap();
    column.close().unwrap();
    group.close().unwrap();
    writer.close().unwrap();
    let joint = ["--joint", "a=a_input:a_output", "--trial", "trial"];
    assert_says(&path, &joint, "longer than 1000 bytes");
    let limited = [&joint[..], &["--max-memory", "400kB"]].concat();
    assert_says(&path, &limited, "--max-memory");
}

#[test]
fn a_name_that_is_none_is_refused() {
    let folder = TempDir::new().unwrap();
    let name = "b".repeat(100_000);
    let text = format!("time_s,{name}.input,{name}.output\n0,0,0\n0.01,1,1\n0.02,1,2\n");
    let path = file(&folder, "long.csv", text.as_bytes());
    assert_says(
        &path,
        &[],
        "row 1: the name `bbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbbb…` is longer",
    );
    let text = format!("time_s,trial,b.input,b.output\n0,a,0,0\n0,{name},1,1\n");
    let path = file(&folder, "trial.csv", text.as_bytes());
    assert_says(&path, &[], "row 3: the name");
}

#[test]
fn a_trial_in_each_row_counts_before_it_is_held() {
    let folder = TempDir::new().unwrap();
    let mut log = "time_s,trial,a.input,a.output\n".to_owned();
    for row in 0..100_000_u32 {
        writeln!(log, "{row},t{row},{},{row}", row / 50 % 2).unwrap();
    }
    let path = file(&folder, "trials.csv", log.as_bytes());
    assert_says(&path, &["--max-memory", "20MB"], "or allow more with `--max-memory`");
    assert_says(&path, &["--max-memory", "100MB"], "trial `t0` has one row only");
}

#[test]
fn what_columns_are_taken_for_takes_time_with_their_number() {
    let folder = TempDir::new().unwrap();
    for [input, output] in [[".input", ".output"], ["_cmd", "_angle"]] {
        let mut text = "time_s".to_owned();
        for joint in 0..20_000 {
            write!(text, ",j{joint}{input},j{joint}{output}").unwrap();
        }
        for row in 0..6 {
            let cells = format!(",{},{row}", row / 3).repeat(20_000);
            write!(text, "\n{row}{cells}").unwrap();
        }
        let path = file(&folder, "wide.csv", text.as_bytes());
        let ended = tauscope(&["columns", path.to_str().unwrap()]);
        assert_eq!(ended.status, Some(0), "{ended:?}");
    }
}

/// A model of joint `a` with so many expressions.
fn model_of(count: usize, expression: &str) -> Vec<u8> {
    let mut model = "schema = \"tauscope/model/1\"\n[joint.a]\nstructure = \"integrator\"\n\
                     parameters = { gain = 1.0, delay = 0.1 }\n"
        .to_owned();
    for k in 0..count {
        write!(
            model,
            "[[joint.a.effect]]\nkind = \"expression\"\nid = \"z{k}\"\nstage = \"input\"\n\
             expression = \"{expression}\"\nparameters = {{ a = 1.0 }}\n"
        )
        .unwrap();
    }
    model.into_bytes()
}

#[test]
fn a_model_larger_than_any_is_refused_and_one_without_end() {
    let folder = TempDir::new().unwrap();
    let log = file(&folder, "log.csv", log_text().as_bytes());
    let effects = file(&folder, "effects.toml", &model_of(300, "signal * a"));
    let long = format!("signal{}", " * a".repeat(200));
    let long = file(&folder, "long.toml", &model_of(5, &long));
    let endless = if cfg!(unix) { Path::new("/dev/zero") } else { &effects };
    for (model, expected) in [
        (effects.as_path(), "300 effects; at most 60 are allowed"),
        (&long, "4030 characters of expressions; at most 4000 are allowed"),
        (endless, if cfg!(unix) { "256 MB" } else { "300" }),
    ] {
        let model = model.to_str().unwrap();
        let ended = tauscope(&["compare", log.to_str().unwrap(), "--model", model]);
        assert_eq!(ended.status, Some(2), "{ended:?}");
        assert!(ended.said.contains(expected), "{ended:?}");
    }
}

#[test]
fn a_plan_is_for_a_machine_of_so_many_joints() {
    let folder = TempDir::new().unwrap();
    let mut model = "schema = \"tauscope/model/1\"\n".to_owned();
    for k in 0..1001 {
        writeln!(model, "[joint.j{k}]\nstructure = \"integrator\"").unwrap();
        writeln!(model, "parameters = {{ gain = 1.0, delay = 0.1 }}").unwrap();
    }
    let model = file(&folder, "model.toml", model.as_bytes());
    let ended = tauscope(&["design", "--model", model.to_str().unwrap()]);
    assert_eq!(ended.status, Some(2), "{ended:?}");
    assert!(ended.said.contains("1001 joints; a plan is for 1000 at most"), "{ended:?}");
}

#[test]
#[cfg(feature = "rrd")]
fn a_recording_of_a_sweep_is_for_so_many_joints() {
    let folder = TempDir::new().unwrap();
    let mut log = "time_s".to_owned();
    (0..201).for_each(|k| write!(log, ",j{k}.input,j{k}.output").unwrap());
    for k in 0..30 {
        write!(log, "\n{}", f64::from(k) * 0.01).unwrap();
        (0..201).for_each(|_| write!(log, ",{},{}", k / 10, k).unwrap());
    }
    let log = file(&folder, "log.csv", log.as_bytes());
    let recording = folder.path().join("x.rrd");
    let ended = tauscope(&["sweep", log.to_str().unwrap(), "-o", recording.to_str().unwrap()]);
    assert_eq!(ended.status, Some(2), "{ended:?}");
    assert!(ended.said.contains("201 joints; a recording of a sweep is for 200"), "{ended:?}");
}

#[test]
fn a_model_file_of_many_joints_is_written_once() {
    let folder = TempDir::new().unwrap();
    let mut log = "time_s".to_owned();
    (0..100).for_each(|k| write!(log, ",j{k}.input,j{k}.output").unwrap());
    for k in 0..30_u32 {
        write!(log, "\n{}", f64::from(k) * 0.01).unwrap();
        (0..100).for_each(|_| write!(log, ",{},{}", k / 9, k.saturating_sub(12)).unwrap());
    }
    let log = file(&folder, "log.csv", log.as_bytes());
    let model = folder.path().join("model.toml");
    let (log, model) = (log.to_str().unwrap(), model.to_str().unwrap());
    let ended = tauscope(&["improve", log, "-w", model, "--max-effects", "1"]);
    assert!(matches!(ended.status, Some(0 | 1)), "{ended:?}");
    let text = fs::read_to_string(model).unwrap();
    assert_eq!(text.matches("structure = ").count(), 100);
    assert_eq!(text.matches("schema = ").count(), 1);
}

/// Steps every 20 samples, none of which the output answers.
#[test]
fn steps_that_nothing_answers_take_time_with_their_number() {
    let folder = TempDir::new().unwrap();
    let mut log = "time_s,a.input,a.output\n".to_owned();
    for k in 0..40_000_u32 {
        let level = (k / 20).wrapping_mul(2_654_435_761) >> 30;
        writeln!(log, "{},{level},{}", f64::from(k) * 0.01, k % 7).unwrap();
    }
    let log = file(&folder, "log.csv", log.as_bytes());
    let ended = tauscope(&["estimate", log.to_str().unwrap(), "--method", "hinge"]);
    assert_eq!(ended.status, Some(0), "{ended:?}");
}

#[test]
fn a_quotation_that_swallows_rows_is_no_remark() {
    let folder = TempDir::new().unwrap();
    for end in ["", "\n"] {
        let mut log = "time_s,a.input,a.output\n".to_owned();
        for k in 0..600 {
            let mark = if k == 99 { "\"" } else { "" };
            writeln!(log, "{mark}{},{},{k}", f64::from(k) * 0.01, k / 50).unwrap();
        }
        let log = file(&folder, "log.csv", format!("{}{end}", log.trim_end()).as_bytes());
        assert_says(&log, &[], "row 101");
    }
}

#[test]
fn a_comma_between_thousands_is_not_taken_for_that_of_decimals() {
    let folder = TempDir::new().unwrap();
    for (rows, expected) in [
        ("0.00;0;900\n0.01;0;1,100\n0.02;0;1,200\n", "row 3, column `a.output`: `1,100` beside"),
        ("0,00;0;900\n0,01;0;1.100\n0,02;0;1.200\n", "row 3, column `a.output`: `1.100` beside"),
    ] {
        let log = file(&folder, "log.csv", format!("t;a.input;a.output\n{rows}").as_bytes());
        assert_says(&log, &[], expected);
    }
}

#[test]
#[cfg(unix)]
fn an_earlier_result_without_end_is_refused() {
    let folder = TempDir::new().unwrap();
    let log = file(&folder, "log.csv", log_text().as_bytes());
    let ended = tauscope(&["estimate", log.to_str().unwrap(), "--against", "/dev/zero"]);
    assert_eq!(ended.status, Some(2), "{ended:?}");
    assert!(ended.said.contains("/dev/zero: `--against` takes"), "{ended:?}");
}

#[test]
fn a_plant_of_a_few_bytes_asks_for_so_much_work_only() {
    let folder = TempDir::new().unwrap();
    let output = folder.path().join("log.csv");
    let plant = |top: &str, hold: &str| {
        format!(
            "schema = \"tauscope/plant/1\"\nseed = 1\n{top}\n[[joint]]\nname = \"boom\"\n\
             input = {{ levels = [-2.0, 0.0, 2.0], hold_s = [{hold}, {hold}] }}\n\
             delay = {{ law = \"constant\", seconds = 0.15 }}\n"
        )
    };
    for (top, hold, expected) in [
        ("duration_s = 490000.0", "1e-3", "five million steps"),
        ("duration_s = 490000.0\nsubsteps = 100", "1.0", "two thousand million time steps"),
    ] {
        let plant = file(&folder, "p.toml", plant(top, hold).as_bytes());
        let (plant, output) = (plant.to_str().unwrap(), output.to_str().unwrap());
        let ended = run::run(&["simulate", plant, "-o", output]);
        assert_eq!(ended.status, Some(2), "{ended:?}");
        assert!(ended.said.contains(expected), "{ended:?}");
    }
}

#[test]
fn gaps_are_filled_within_the_limit_only() {
    let folder = TempDir::new().unwrap();
    let text =
        "time_s,a.input,a.output\n0,0,0\n0.01,1,1\n0.02,1,1\n0.03,1,1\n0.04,1,1\n9999999,1,1\n";
    let path = file(&folder, "fill.csv", text.as_bytes());
    assert_says(&path, &["--fill", "1e7", "--max-memory", "4GB"], "--max-memory");
    assert_says(&path, &["--resample", "1e-7", "--fill", "1e7"], "samples");
}

#[test]
fn a_limit_that_is_too_small_is_said_of_each_format() {
    let folder = TempDir::new().unwrap();
    let csv = file(&folder, "log.csv", log_text().as_bytes());
    assert_says(&csv, &["--max-memory", "5kB"], "or allow more with `--max-memory`");
    #[cfg(feature = "mat")]
    assert_says(&whole("v7.mat"), &["--max-memory", "2kB"], "--max-memory");
    #[cfg(feature = "mat")]
    assert_says(&whole("v73.mat"), &["--max-memory", "1kB"], "--max-memory");
    #[cfg(feature = "mcap")]
    assert_says(&whole("zstd.mcap"), &["--max-memory", "2kB"], "--max-memory");
    #[cfg(feature = "parquet")]
    assert_says(
        &whole("zstd.parquet"),
        &["--max-memory", "2kB", "--joint", "boom=boom.input:boom.output"],
        "--max-memory",
    );
}

#[cfg(any(feature = "mat", feature = "mcap", feature = "parquet"))]
fn whole(name: &str) -> PathBuf {
    Path::new("tests/golden/formats").join(name)
}

#[test]
fn a_packed_text_and_a_row_without_end_are_refused() {
    let folder = TempDir::new().unwrap();
    let mut packed = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    packed.write_all(b"time_s,a.input,a.output\n").unwrap();
    for row in 0..500_000_u32 {
        packed.write_all(format!("{row},1,1\n").as_bytes()).unwrap();
    }
    let path = file(&folder, "bomb.csv.gz", &packed.finish().unwrap());
    assert_says(&path, &["--max-memory", "20MB"], "--max-memory");
    let commas = |count| format!("time_s,a.input,a.output{}\n0,1,1\n", ",".repeat(count));
    let wide = file(&folder, "wide.csv", commas(3_000_000).as_bytes());
    assert_says(&wide, &[], "3000003 cells");
    let wide = file(&folder, "limited.csv", commas(300_000).as_bytes());
    assert_says(&wide, &["--max-memory", "20MB"], "--max-memory");
    let endless = format!("time_s,a.input,a.output\n0,1,1\n1,\"{}", "\n".repeat(18 << 20));
    assert_says(&file(&folder, "quoted.csv", endless.as_bytes()), &[], "quotation mark");
}

#[test]
#[cfg(unix)]
fn a_device_without_end_is_no_log() {
    assert_says(Path::new("/dev/zero"), &[], "/dev/zero");
    assert_says(Path::new("/dev/urandom"), &[], "/dev/urandom");
}

#[test]
fn the_other_logs_of_a_folder_are_done() {
    let folder = TempDir::new().unwrap();
    let logs = folder.path().join("logs");
    fs::create_dir(&logs).unwrap();
    fs::write(logs.join("whole.csv"), log_text()).unwrap();
    #[cfg(feature = "mcap")]
    {
        let records = [bytes::mcap::topic(bytes::mcap::JOINT), bytes::mcap::messages()].concat();
        let chunk = bytes::mcap::file(&bytes::mcap::chunk(&records, "zstd", 1));
        fs::write(logs.join("chunk.mcap"), chunk).unwrap();
    }
    #[cfg(feature = "mat")]
    {
        fs::write(logs.join("circle.mat"), bytes::mat::v73_in_a_circle()).unwrap();
        fs::write(logs.join("large.mat"), bytes::mat::v73_with(400, 1 << 60)).unwrap();
    }
    fs::write(logs.join("other.csv"), "time_s,a.input,a.output\n0,0,\"").unwrap();
    let logs = logs.to_str().unwrap();
    assert_eq!(tauscope(&["estimate", logs]).status, Some(1));
    let results = folder.path().join("results");
    let ended = tauscope(&["estimate", logs, "--results", results.to_str().unwrap()]);
    assert_eq!(ended.status, Some(1), "{ended:?}");
    assert_eq!(fs::read_dir(&results).unwrap().count(), 1);
}

/// Files that broke an earlier version and are no part of this project: in `hostile` of the
/// folder `TAUSCOPE_REAL_LOGS`, or of `../shared/data`.
#[test]
#[cfg(all(feature = "mat", feature = "mcap"))]
fn files_that_broke_an_earlier_version_are_refused() {
    let folder = std::env::var_os("TAUSCOPE_REAL_LOGS");
    let folder = folder.map_or_else(|| PathBuf::from("../shared/data"), PathBuf::from);
    let folder = ["", ".."].iter().map(|up| Path::new(up).join(&folder).join("hostile"));
    let Some(folder) = folder.into_iter().find(|folder| folder.is_dir()) else {
        // Not `eprintln`, which the test runner keeps to itself.
        writeln!(std::io::stderr(), "skipped: the folder of hostile files is not here").unwrap();
        return;
    };
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder).unwrap().map(|f| f.unwrap().path()).collect();
    files.retain(|file| file.extension().is_some_and(|ending| ending != "md"));
    assert!(!files.is_empty());
    for path in files {
        refused(&path, &["--fill", "1e7"]);
    }
}
