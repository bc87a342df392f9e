//! Modules import downward only, no files import in a circle, and each library stays in its
//! place: the order is part of the design.

mod imports;

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

use imports::{House, Import, Module};

/// The modules; each may use those before it.
const ORDER: [&str; 19] = [
    "units",
    "numerics",
    "experiment",
    "synthetic",
    "effect",
    "delay",
    "model",
    "export",
    "fit",
    "diagnosis",
    "explain",
    "design",
    "study",
    "batch",
    "wording",
    "figure",
    "report",
    "recording",
    "cli",
];

pub(super) fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            found.extend(sources(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// This project's files.
fn project() -> House {
    files_of(Path::new("src"))
}

/// The files below `folder`.
fn files_of(folder: &Path) -> House {
    let read = |path: &PathBuf| {
        let inside = path.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
        (inside, fs::read_to_string(path).unwrap())
    };
    let files: Vec<_> = sources(folder).iter().map(read).collect();
    House::of(files.iter().map(|(path, text)| (path.as_str(), text.clone())))
}

/// Imports of a module from one after it in [`ORDER`], as sentences.
fn upward(house: &House) -> Vec<String> {
    let place =
        |module: &Module| ORDER.iter().position(|name| module.first().is_some_and(|m| m == name));
    let wrong = |import: &Import| match (place(&import.from), place(&import.to)) {
        (Some(from), Some(to)) => to > from,
        // What stands in no order is the root: it uses all, and nothing uses it.
        (Some(_), None) => true,
        (None, _) => false,
    };
    house.imports().iter().filter(|import| wrong(import)).map(told).collect()
}

fn told(import: &Import) -> String {
    format!("{} uses {}", import.from.join("/"), import.what)
}

/// Circles among files and folders: in each folder, what stands beside each other must have
/// an order. A folder's own `mod.rs` stands beside its parts.
fn circles(house: &House) -> Vec<String> {
    let mut folders: BTreeMap<Module, BTreeMap<(String, String), String>> = BTreeMap::new();
    for import in house.imports() {
        let shared = import.from.iter().zip(&import.to).take_while(|(a, b)| a == b).count();
        let part = |module: &Module| module.get(shared).map_or("mod.rs", String::as_str).to_owned();
        let pair = (part(&import.from), part(&import.to));
        let folder = folders.entry(import.from[..shared].to_vec()).or_default();
        folder.entry(pair).or_insert_with(|| told(&import));
    }
    folders.iter().flat_map(|(folder, pairs)| circle(folder, pairs)).collect()
}

/// What of a folder's imports is part of a circle: whatever remains when everything that
/// imports nothing, or is imported by nothing, is taken away again and again.
fn circle(folder: &Module, pairs: &BTreeMap<(String, String), String>) -> Vec<String> {
    let mut left: BTreeSet<&(String, String)> = pairs.keys().collect();
    loop {
        let tied = |(from, to): &(String, String)| {
            left.iter().any(|pair| pair.1 == *from) && left.iter().any(|pair| pair.0 == *to)
        };
        let next: BTreeSet<_> = left.iter().copied().filter(|pair| tied(pair)).collect();
        if next.len() == left.len() {
            break;
        }
        left = next;
    }
    let folder = folder.join("/");
    left.iter().map(|pair| format!("{folder}: {} → {} ({})", pair.0, pair.1, pairs[pair])).collect()
}

#[test]
fn no_module_imports_upward() {
    let house = project();
    assert!(house.len() > 100);
    let wrong = upward(&house);
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn no_files_import_in_a_circle() {
    for house in [project(), files_of(Path::new("crates/synthetic/src"))] {
        assert!(house.len() > 10);
        let wrong = circles(&house);
        assert!(wrong.is_empty(), "{wrong:#?}");
    }
}

/// The files of `sources`, as `path: text`.
fn house(sources: &[(&str, &str)]) -> House {
    House::of(sources.iter().map(|(path, text)| (*path, (*text).to_owned())))
}

#[test]
fn an_upward_import_is_seen_in_each_way_to_write_it() {
    for fault in [
        "use crate::delay::Settings;",
        "use crate::{units::Hz, delay::Settings};",
        "use crate::{delay::{estimate, Settings as Other}};",
        "use crate::delay;\nfn f() { delay::estimate() }",
        "fn f() -> crate::delay::Settings { loop {} }",
        "fn f() { use crate::delay::Settings; }",
        "fn f() { println!(\"{}\", crate::delay::estimate()) }",
    ] {
        let delay = ("delay/mod.rs", "pub struct Settings; pub fn estimate() {}");
        let units = ("units.rs", "pub struct Hz;");
        let low = house(&[units, delay, ("experiment/read.rs", fault)]);
        assert_eq!(upward(&low).len(), 1, "{fault}");
        let high = house(&[units, delay, ("batch.rs", fault)]);
        assert_eq!(upward(&high), [""; 0], "{fault}");
        let test = format!("#[cfg(test)] mod tests {{ {fault} }}");
        assert_eq!(upward(&house(&[units, delay, ("experiment/read.rs", &test)])), [""; 0]);
    }
}

/// The program's root is not the library's, which it would hide.
#[test]
fn an_upward_import_by_way_of_the_root_is_seen_beside_a_program() {
    let files = [
        ("lib.rs", "pub mod delay; mod experiment; pub use delay::Settings;"),
        ("main.rs", "fn main() { tauscope::delay::estimate() }"),
        ("delay/mod.rs", "pub struct Settings; pub fn estimate() {}"),
        ("experiment/read.rs", "use crate::Settings;"),
    ];
    let house = house(&files);
    assert_eq!(house.len(), files.len());
    assert_eq!(upward(&house).len(), 1);
}

#[test]
fn a_circle_is_seen_wherever_it_runs() {
    for (kind, files) in [
        (
            "two files",
            [
                ("delay/mod.rs", "mod a; mod b;"),
                ("delay/a.rs", "use super::b::B; pub struct A;"),
                ("delay/b.rs", "use super::a::A; pub struct B;"),
            ],
        ),
        (
            "through a re-export",
            [
                ("delay/mod.rs", "mod a; mod b; pub use a::A; pub use b::B as Other;"),
                ("delay/a.rs", "use super::Other; pub struct A;"),
                ("delay/b.rs", "use crate::delay::A; pub struct B;"),
            ],
        ),
        (
            "through a glob",
            [
                ("delay/mod.rs", "mod a; mod b; pub use a::*;"),
                ("delay/a.rs", "use super::b; pub struct A; fn f() { b::g() }"),
                ("delay/b.rs", "use super::A; pub fn g() {}"),
            ],
        ),
        (
            "a file and its folder's own",
            [
                ("delay/mod.rs", "mod a; mod b; use a::A; pub struct Limits; fn f() -> A { A }"),
                ("delay/a.rs", "use super::Limits; pub struct A;"),
                ("delay/b.rs", ""),
            ],
        ),
        (
            "two folders by way of different files",
            [
                ("delay/lag/one.rs", "use crate::delay::method::x::X; pub struct One;"),
                ("delay/lag/two.rs", "pub struct Two;"),
                ("delay/method/x.rs", "use super::super::lag::two::Two; pub struct X;"),
            ],
        ),
    ] {
        let files: Vec<_> = [("delay/lag/mod.rs", ""), ("delay/method/mod.rs", "")]
            .into_iter()
            .chain(files)
            .collect();
        assert!(!circles(&house(&files)).is_empty(), "{kind}");
    }
    let facade = house(&[
        ("delay/mod.rs", "mod a; mod b; pub use a::A; pub use b::B;"),
        ("delay/a.rs", "pub struct A;"),
        ("delay/b.rs", "use super::A; pub struct B;"),
    ]);
    assert_eq!(circles(&facade), [""; 0]);
}

#[test]
fn a_circle_by_way_of_methods_is_seen() {
    let methods = |call: &str| {
        let folder = format!("mod a; mod b; impl b::B {{ pub fn f(&self) {{ {call} }} }}");
        circles(&house(&[
            ("delay/mod.rs", &folder),
            ("delay/a.rs", "use super::b::B; impl B { fn g(&self) { self.f() } fn new() {} }"),
            ("delay/b.rs", "pub struct B;"),
        ]))
    };
    for call in ["self.g()", "println!(\"{}\", self.g())", "Self::new()", "b::B::new()"] {
        assert!(!methods(call).is_empty(), "by methods of one type in two files: {call}");
    }
    assert_eq!(methods("self.of_a_trait()"), [""; 0]);
}

/// What ties the maker of test data to what is tested with it, as sentences. It is a crate of its
/// own, which cannot use the library; the library's door to it may use only validated scalars and
/// logs, and only the command line may use the door.
fn ties_of_test_data(house: &House) -> Vec<String> {
    let first = |module: &Module| module.first().map_or("", String::as_str).to_owned();
    let ties = |import: &Import| match (first(&import.from).as_str(), first(&import.to).as_str()) {
        ("synthetic", to) => !["synthetic", "units", "experiment"].contains(&to),
        (from, "synthetic") => from != "cli",
        _ => false,
    };
    house.imports().iter().filter(|import| ties(import)).map(told).collect()
}

#[test]
fn the_maker_of_test_data_stands_apart() {
    assert_eq!(ties_of_test_data(&project()), [""; 0]);
}

#[test]
fn a_tie_of_the_maker_of_test_data_is_seen() {
    for (path, fault) in [
        ("synthetic.rs", "use crate::numerics::mean; pub fn simulate() {}"),
        ("synthetic.rs", "pub fn simulate() { crate::effect::by_id() }"),
        ("fit/mod.rs", "use crate::synthetic::simulate;"),
    ] {
        let others = [
            ("numerics/mod.rs", "pub fn mean() {}"),
            ("effect/mod.rs", "pub fn by_id() {}"),
            ("synthetic.rs", "pub fn simulate() {}"),
        ];
        let seen = house(&[&others[..], &[(path, fault)]].concat());
        assert_eq!(ties_of_test_data(&seen).len(), 1, "{fault}");
    }
}

/// Libraries, and the places that may name them.
const PLACES: [(&str, &[&str]); 21] = [
    ("tauscope_synthetic", &["src/synthetic.rs"]),
    ("rayon", &["src/batch.rs"]),
    ("rerun", &["src/recording"]),
    ("sci_rs", &["src/numerics/filter.rs"]),
    ("statrs", &["src/numerics/statistics"]),
    ("winnow", &["src/effect/expression"]),
    ("toml_edit", &["src/model/file"]),
    ("ctrlc", &["src/cli/console/terminal.rs"]),
    ("signal_hook", &["src/cli/output/file.rs"]),
    ("flate2", &["src/experiment/format"]),
    ("encoding_rs", &["src/experiment/format/text.rs"]),
    ("jiff", &["src/experiment/format/date.rs"]),
    ("arrow_array", &["src/experiment/format/parquet.rs", "src/report/table.rs"]),
    ("arrow_cast", &["src/experiment/format/parquet.rs"]),
    ("arrow_schema", &["src/experiment/format/parquet.rs"]),
    ("calamine", &["src/experiment/format/xlsx.rs"]),
    ("hdf5_pure", &["src/experiment/format/mat"]),
    ("minijinja", &["src/export", "src/report/lookup.rs"]),
    ("zip", &["src/export/fmu.rs", "src/experiment/format/xlsx.rs"]),
    ("re_cdr", &["src/experiment/format/mcap"]),
    ("re_ros_msg", &["src/experiment/format/mcap"]),
];

/// What of [`PLACES`] a source names that lies elsewhere.
fn misplaced(path: &Path, text: &str) -> Vec<&'static str> {
    let code = text.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code: Vec<&str> = code.collect();
    let names = |library: &str| {
        let ways = [format!("{library}::"), format!("use {library};"), format!("use {library} as")];
        code.iter().any(|line| ways.iter().any(|way| line.contains(way)))
    };
    let elsewhere = PLACES.iter().filter(|(_, own)| !own.iter().any(|own| path.starts_with(own)));
    elsewhere.map(|(library, _)| *library).filter(|library| names(library)).collect()
}

#[test]
fn each_library_is_named_in_its_own_place_only() {
    for (library, places) in PLACES {
        for place in places {
            assert!(Path::new(place).exists(), "{library}: {place}");
        }
    }
    for path in sources(Path::new("src")) {
        let text = fs::read_to_string(&path).unwrap();
        assert_eq!(misplaced(&path, &text), [""; 0], "{}", path.display());
    }
}

#[test]
fn a_library_out_of_its_place_is_seen() {
    for fault in [
        "use rayon::prelude::*;",
        "use rayon;",
        "use rayon as threads;",
        "fn f() { rayon::join(g, h); }",
    ] {
        assert_eq!(misplaced(Path::new("src/fit/run.rs"), fault), ["rayon"], "{fault}");
        assert_eq!(misplaced(Path::new("src/batch.rs"), fault), [""; 0], "{fault}");
    }
    assert_eq!(misplaced(Path::new("src/fit/run.rs"), "// rayon::join is elsewhere"), [""; 0]);
}

/// Where equations may be solved by a decomposition of `nalgebra` outside `numerics`: there,
/// rank and projection have their one tolerance, and a caller asks them.
const DECOMPOSED: [(&str, &str); 2] = [
    ("delay/onset_model/dynamics", "a few states, whose size is known when the program is built"),
    ("fit/descent", "a damped step: its matrix is positive definite by the damping"),
];

/// The decompositions and inverses that `nalgebra` has, as methods and as types.
const DECOMPOSITIONS: [&str; 24] = [
    "cholesky",
    "lu",
    "full_piv_lu",
    "qr",
    "col_piv_qr",
    "svd",
    "svd_unordered",
    "udu",
    "schur",
    "hessenberg",
    "bidiagonalize",
    "symmetric_eigen",
    "symmetric_eigenvalues",
    "complex_eigenvalues",
    "singular_values",
    "pseudo_inverse",
    "try_inverse",
    "Cholesky",
    "LU",
    "QR",
    "ColPivQR",
    "SVD",
    "SymmetricEigen",
    "Schur",
];

/// Files that decompose a matrix, though they may not.
fn decomposed_elsewhere(house: &House) -> BTreeSet<String> {
    let is_one = |name: &String| DECOMPOSITIONS.contains(&name.as_str());
    let called = house.called().filter(|(_, names)| names.iter().any(is_one)).map(|(file, _)| file);
    // A variable may be called as a method is.
    let is_type = |name: &String| is_one(name) && name.starts_with(char::is_uppercase);
    let named = house.named().filter(|(_, paths)| paths.iter().flatten().any(is_type));
    let files = called.chain(named.map(|(file, _)| file)).map(|file| file.join("/"));
    let may = |file: &String| {
        file.starts_with("numerics/") || DECOMPOSED.iter().any(|(place, _)| place == file)
    };
    files.filter(|file| !may(file)).collect()
}

#[test]
fn matrices_are_decomposed_in_stated_places_only() {
    let project = project();
    assert_eq!(decomposed_elsewhere(&project), BTreeSet::new());
    for (place, reason) in DECOMPOSED {
        let of_file = |(file, _): &(&Module, _)| file.join("/") == place;
        let (_, called) = project.called().find(of_file).unwrap_or_else(|| panic!("no {place}"));
        assert!(called.iter().any(|name| DECOMPOSITIONS.contains(&name.as_str())), "{place}");
        assert!(!reason.is_empty());
    }
}

#[test]
fn a_decomposition_elsewhere_is_seen() {
    for fault in [
        "fn f(a: Matrix3<f64>) { a.lu().solve(&b); }",
        "fn f() { format!(\"{}\", a.try_inverse()) }",
        "use nalgebra::linalg::SVD; fn f() { SVD::new(a, true, true); }",
    ] {
        let seen = decomposed_elsewhere(&house(&[("model/start.rs", fault)]));
        assert_eq!(seen.len(), 1, "{fault}");
        assert!(decomposed_elsewhere(&house(&[("numerics/rank.rs", fault)])).is_empty());
        let test = format!("#[cfg(test)] mod tests {{ {fault} }}");
        assert!(decomposed_elsewhere(&house(&[("model/start.rs", &test)])).is_empty());
    }
}
