//! Every file of the corpus keeps the laws: the fuzzer's finds as plain tests, on stable Rust.

use std::fs;
use std::path::PathBuf;

fn corpus(target: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("corpus").join(target)
}

#[test]
fn every_target_keeps_its_laws_on_its_corpus() {
    for (target, laws) in leafbrdf_fuzz::TARGETS {
        let folder = corpus(target);
        let mut files: Vec<PathBuf> = fs::read_dir(&folder)
            .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
            .map(|entry| entry.expect("a readable folder").path())
            .collect();
        files.sort();
        assert!(!files.is_empty(), "{} is empty: nothing was replayed", folder.display());
        for file in files {
            let data = fs::read(&file).unwrap_or_else(|error| panic!("{}: {error}", file.display()));
            // names the file should a law be broken
            let replayed = std::panic::catch_unwind(|| laws(&data));
            assert!(replayed.is_ok(), "{} breaks a law: see above", file.display());
        }
    }
}

#[test]
fn every_folder_of_the_corpus_belongs_to_a_target() {
    for entry in fs::read_dir(corpus("")).expect("the corpus is there") {
        let name = entry.expect("a readable folder").file_name().into_string().expect("names are ASCII");
        assert!(leafbrdf_fuzz::TARGETS.iter().any(|(target, _)| *target == name), "no target reads corpus/{name}");
    }
}
