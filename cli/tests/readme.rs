//! The repository's README.md: its commands run, and the result it shows is the one that comes out.
#![cfg(unix)]

use std::collections::HashMap;
use std::fs;
use std::path::Path;
use std::process::Command;

fn readme() -> String {
    fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("../README.md")).unwrap()
}

/// The lines inside ``` fences of a language, all blocks together.
fn blocks(text: &str, language: &str) -> Vec<String> {
    let mut inside = HashMap::from([(language, false)]);
    let mut lines = Vec::new();
    for line in text.lines() {
        if let Some(fence) = line.strip_prefix("```") {
            let open = inside.get_mut(language).unwrap();
            *open = !*open && fence == language;
        } else if inside[language] {
            lines.push(line.to_string());
        }
    }
    lines
}

#[test]
fn the_result_shown_is_the_demos_and_the_commands_shown_work() {
    let folder = tempfile::tempdir().unwrap();
    let binary = Path::new(env!("CARGO_BIN_EXE_leafbrdf"));
    let path = format!("{}:{}", binary.parent().unwrap().display(), std::env::var("PATH").unwrap());
    let shell = |line: &str| {
        let output = Command::new("sh").args(["-c", line]).current_dir(&folder).env("PATH", &path).output().unwrap();
        assert!(output.status.success(), "{line}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };

    let demo = shell("leafbrdf demo");
    let printed: Vec<&str> = demo.lines().collect();
    let shown = blocks(&readme(), "text");
    assert!(shown.len() > 5);
    for line in &shown {
        assert!(printed.contains(&line.as_str()), "README.md shows {line:?}, the demo prints\n{demo}");
    }

    let commands: Vec<String> =
        blocks(&readme(), "sh").into_iter().filter(|line| line.starts_with("leafbrdf ")).collect();
    assert_eq!(commands.len(), 3);
    for line in &commands {
        shell(line);
    }
    assert!(folder.path().join("leafbrdf-fits/leaves.csv").is_file());
}

/// The documents of the repository, by their path from its root.
const DOCUMENTS: [&str; 13] = [
    "README.md",
    "CONTRIBUTING.md",
    "CHANGELOG.md",
    "docs/model.md",
    "docs/formats.md",
    "docs/inversion.md",
    "docs/retrieval-study.md",
    "docs/coming-from.md",
    "firmware/README.md",
    "model-core/README.md",
    "prospect/README.md",
    "fit/README.md",
    "cli/README.md",
];

#[test]
fn every_local_link_leads_to_a_file() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut links = 0;
    for document in DOCUMENTS {
        let text = fs::read_to_string(root.join(document)).unwrap();
        for target in text.split("](").skip(1).filter_map(|rest| rest.split(')').next()) {
            // the front page of a crate also links to its items, which rustdoc checks
            if target.contains('.') && !target.starts_with("http") {
                links += 1;
                let file = target.split('#').next().unwrap();
                let place = root.join(document).parent().unwrap().join(file);
                assert!(place.exists(), "{document}: {target}");
            }
        }
    }
    assert!(links > 15, "{links}");
}

#[test]
fn every_law_in_the_model_document_has_the_test_it_names() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut sources = String::new();
    let mut folders: Vec<_> = ["model-core", "prospect", "fit", "cli", "fuzz"]
        .iter()
        .flat_map(|package| ["src", "tests"].map(|part| root.join(package).join(part)))
        .collect();
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                sources.push_str(&fs::read_to_string(path).unwrap());
            }
        }
    }
    let text = fs::read_to_string(root.join("docs/model.md")).unwrap();
    // a test's name is a sentence: four words at least
    let is_name =
        |word: &&str| word.matches('_').count() >= 3 && word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
    let named: Vec<&str> = text.split('`').skip(1).step_by(2).filter(is_name).collect();
    assert!(named.len() > 15, "{named:?}");
    for name in named {
        assert!(sources.contains(&format!("fn {name}(")), "docs/model.md names {name}, which is no test");
    }
}
