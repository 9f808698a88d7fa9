//! Links between the documents: every file and every heading that one of them leads to exists.

use std::path::{Path, PathBuf};

/// The project's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The documents: those of the project, those in `docs`, and each crate's own.
fn documents() -> Vec<PathBuf> {
    let is_document = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "md");
    let files = |folder: &Path| {
        let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path());
        entries.collect::<Vec<_>>()
    };
    let folders = files(&root()).into_iter().filter(|path| path.is_dir() && path.join("Cargo.toml").is_file());
    let of_crates = folders.map(|folder| folder.join("README.md")).filter(|path| path.is_file());
    [files(&root()), files(&root().join("docs"))].concat().into_iter().filter(is_document).chain(of_crates).collect()
}

/// A document without the blocks of code in it, whose brackets are no links.
fn prose(text: &str) -> String {
    text.split("```").step_by(2).collect()
}

/// The targets of all links and pictures.
fn targets(text: &str) -> Vec<String> {
    let parts = text.split("](").skip(1);
    parts.filter_map(|rest| rest.split_once(')')).map(|(target, _)| target.to_owned()).collect()
}

/// A heading's anchor, as web sites for code make it.
fn anchor(heading: &str) -> String {
    let kept =
        heading.trim().to_lowercase().chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c)).collect::<String>();
    kept.replace(' ', "-")
}

fn anchors(text: &str) -> Vec<String> {
    let headings = text.lines().filter(|line| line.starts_with('#'));
    headings.map(|line| anchor(line.trim_start_matches('#'))).collect()
}

/// The fault of a link in a document; none where it leads somewhere, or out of the project.
fn fault(document: &Path, target: &str) -> Option<String> {
    if target.contains("://") || target.starts_with("crate::") {
        return None;
    }
    let (path, heading) = target.split_once('#').map_or((target, None), |(path, heading)| (path, Some(heading)));
    let file = if path.is_empty() { document.to_owned() } else { document.parent()?.join(path) };
    if !file.exists() {
        return Some(format!("{}: {target} does not exist", document.display()));
    }
    let text = prose(&std::fs::read_to_string(file).ok()?);
    let is_there = heading.is_none_or(|heading| anchors(&text).iter().any(|anchor| anchor == heading));
    (!is_there).then(|| format!("{}: {target} has no such heading", document.display()))
}

#[test]
fn every_link_leads_to_a_file_and_a_heading() {
    let documents = documents();
    assert!(documents.len() >= 15, "{} documents: is this the project?", documents.len());
    let mut links = 0;
    let mut faults = vec![];
    for document in &documents {
        let text = prose(&std::fs::read_to_string(document).expect("a document"));
        for target in targets(&text) {
            links += 1;
            faults.extend(fault(document, &target));
        }
    }
    assert!(links >= 80, "{links} links were found");
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_broken_link_is_found() {
    let readme = root().join("README.md");
    assert!(fault(&readme, "docs/nowhere.md").is_some());
    assert!(fault(&readme, "docs/manual.md#no-such-heading").is_some());
    assert_eq!(fault(&readme, "docs/manual.md#command-line"), None);
    assert_eq!(fault(&readme, "https://example.org/nowhere"), None);
    assert_eq!(anchor(" What it costs, in `ms`"), "what-it-costs-in-ms");
}
