//! Pages that lead to the code: every place that they name exists.

use std::path::{Path, PathBuf};

/// The project's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The paths between back-quotes in a text, each of a file, or of a file and a function in it.
fn places(text: &str) -> impl Iterator<Item = (&str, Option<&str>)> {
    let quoted = text.split('`').skip(1).step_by(2);
    let is_path = |place: &&str| place.contains('/') && !place.contains(' ');
    quoted.filter(is_path).map(|place| match place.split_once(".rs:") {
        Some((file, function)) => (&place[..file.len() + ".rs".len()], Some(function)),
        None => (place, None),
    })
}

/// The fault of a place; none where it exists.
fn fault((path, function): (&str, Option<&str>)) -> Option<String> {
    let file = root().join(path);
    let Some(function) = function else { return (!file.exists()).then(|| format!("{path} does not exist")) };
    let Ok(source) = std::fs::read_to_string(&file) else { return Some(format!("{path} cannot be read")) };
    let is_defined = ["(", "<"].iter().any(|next| source.contains(&format!("fn {function}{next}")));
    (!is_defined).then(|| format!("{path} has no function {function}"))
}

/// Checks that all places on a page exist, and that it names at least so many functions.
fn check_places(page: &str, least_functions: usize) {
    let text = std::fs::read_to_string(root().join(page)).expect("the page");
    let places: Vec<_> = places(&text).collect();
    let functions = places.iter().filter(|(_, function)| function.is_some()).count();
    assert!(functions >= least_functions, "{page} names {functions} functions: is this the page?");
    let faults: Vec<String> = places.into_iter().filter_map(fault).collect();
    assert!(faults.is_empty(), "{page}:\n{}", faults.join("\n"));
}

#[test]
fn every_place_that_the_papers_page_names_exists() {
    check_places("docs/papers.md", 60);
}

#[test]
fn every_step_of_the_walks_through_the_code_exists() {
    check_places("docs/architecture.md", 60);
}

#[test]
fn every_walk_is_there_and_numbers_its_steps() {
    let page = std::fs::read_to_string(root().join("docs/architecture.md")).expect("the page");
    let walks = page.split("\n## ").find(|section| section.starts_with("Three walks")).expect("the walks");
    for walk in ["An audio block", "A recording from disk to the audio thread", "A VDB to a WAV"] {
        let steps = walks.split("\n### ").find(|section| section.starts_with(walk)).expect(walk);
        let numbers =
            steps.lines().filter_map(|line| line.strip_prefix("| ")?.split(" |").next()?.parse::<usize>().ok());
        let numbers: Vec<usize> = numbers.collect();
        assert!(numbers.len() >= 10, "{walk} has {} steps", numbers.len());
        assert!(numbers.iter().copied().eq(1..=numbers.len()), "{walk}: {numbers:?}");
    }
}

#[test]
fn every_numbered_equation_has_a_row() {
    let page = std::fs::read_to_string(root().join("docs/papers.md")).expect("the page");
    // Equations of each source by number, in the order of the page's sections.
    for (heading, equations) in [("## Chadwick", 1..=17), ("## Dobashi", 1..=5)] {
        let section = page.split("\n## ").find(|section| section.starts_with(&heading[3..])).expect(heading);
        let rows: Vec<&str> = section.lines().filter_map(|line| line.strip_prefix("| ")?.split(" |").next()).collect();
        for number in equations {
            let is_named = |row: &&str| {
                let Some((_, numbers)) = row.split_once("eq. ") else { return false };
                numbers.split(", ").any(|found| found == number.to_string())
            };
            assert!(rows.iter().any(is_named), "{heading} has no row for equation {number}");
        }
    }
}

#[test]
fn a_wrong_place_is_found() {
    assert!(fault(("synthesis/src/nowhere.rs", Some("new"))).is_some());
    assert!(fault(("synthesis/src/lib.rs", Some("no_such_function"))).is_some());
    assert!(fault(("synthesis/src/no_such_folder", None)).is_some());
    assert_eq!(fault(("synthesis/src/error.rs", None)), None);
}
