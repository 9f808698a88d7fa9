//! Third-party code in packages, and its licences.

use std::collections::BTreeSet;

use anyhow::{Context, Result, ensure};

use crate::cargo;

/// Licences compatible with distribution in a program under MIT or Apache-2.0.
const PERMITTED: [&str; 14] = [
    "0BSD",
    "Apache-2.0",
    "Apache-2.0 WITH LLVM-exception",
    "BSD-2-Clause",
    "BSD-3-Clause",
    "BSL-1.0",
    "CC0-1.0",
    "ISC",
    "MIT",
    "MIT-0",
    "MPL-2.0",
    "OFL-1.1",
    "Unicode-3.0",
    "Zlib",
];
/// Licences of the fonts in the window, whose crate names them beside its own licence.
const FONTS: [&str; 1] = ["Ubuntu-font-1.0"];

/// A page that names every crate in the packages for these targets, with its licence and origin.
pub fn page(triples: &[&str]) -> Result<String> {
    let mut page = "# Third-party components\n\nEach under its own licence; sources are at the addresses given.\n\n\
        | crate | licence | source |\n|---|---|---|\n"
        .to_owned();
    for Crate { name, version, licence, source } in crates(triples)? {
        ensure!(is_permitted(&licence), "{name} is under {licence:?}, which may not be passed on; see licences.rs");
        page.push_str(&format!("| {name} {version} | {licence} | {source} |\n"));
    }
    Ok(page)
}

/// A crate in the packages.
#[derive(Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Crate {
    /// Its name.
    pub name: String,
    /// Its version.
    pub version: String,
    /// Its licence, as it states it.
    pub licence: String,
    /// Address of its source.
    pub source: String,
}

/// All crates linked into plugin and command line for any of these targets, except our own.
pub fn crates(triples: &[&str]) -> Result<BTreeSet<Crate>> {
    let mut tree = cargo::command();
    tree.args(["tree", "--package", "pyrophone-plugin", "--package", "pyrophone-cli", "--edges", "normal"]);
    tree.args(["--prefix", "none", "--format", "{p}|{l}|{r}"]);
    tree.args(triples.iter().flat_map(|triple| ["--target", triple]));
    let output = tree.output().context("calling cargo tree")?;
    ensure!(output.status.success(), "cargo tree failed: {}", String::from_utf8_lossy(&output.stderr));
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    Ok(text.lines().filter_map(parse).collect())
}

/// A line of the tree; none for our own crates and empty lines.
fn parse(line: &str) -> Option<Crate> {
    let mut fields = line.trim_end_matches(" (*)").split('|');
    let (package, licence, source) = (fields.next()?, fields.next()?, fields.next()?);
    // Such as "rayon v1.12.0", or "xtask v0.1.0 (/path)" for those of the workspace.
    let mut words = package.split_whitespace();
    let (name, version) = (words.next()?, words.next()?.trim_start_matches('v'));
    let is_ours = package.contains("(/") || package.contains(":\\");
    (!is_ours).then(|| Crate {
        name: name.to_owned(),
        version: version.to_owned(),
        licence: licence.to_owned(),
        source: source.to_owned(),
    })
}

/// True if one of an expression's alternatives is permitted in all its parts.
fn is_permitted(expression: &str) -> bool {
    let plain = expression.replace(['(', ')'], "").replace('/', " OR ");
    let is_known = |licence: &str| PERMITTED.contains(&licence) || FONTS.contains(&licence);
    // An expression in brackets, such as "(MIT OR Apache-2.0) AND Unicode-3.0": each part of it must have an
    // alternative.
    let joined: Vec<&str> = if expression.contains('(') { expression.split(" AND ").collect() } else { vec![&plain] };
    joined.iter().all(|part| {
        let part = part.replace(['(', ')'], "");
        part.split(" OR ").any(|alternative| alternative.split(" AND ").all(|licence| is_known(licence.trim())))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::package::TARGETS;

    #[test]
    fn expressions_are_read_as_they_are_meant() {
        for good in ["MIT", "MIT OR GPL-3.0", "MIT/Apache-2.0", "(MIT OR Apache-2.0) AND Unicode-3.0", "ISC AND MIT"] {
            assert!(is_permitted(good), "{good}");
        }
        for bad in ["GPL-3.0", "", "MIT AND GPL-3.0", "(MIT OR Apache-2.0) AND LGPL-2.1", "GPL-3.0/AGPL-3.0"] {
            assert!(!is_permitted(bad), "{bad}");
        }
    }

    #[test]
    fn cargo_deny_permits_the_same() {
        let settings = std::fs::read_to_string(crate::project::root().join("deny.toml")).unwrap();
        let list = settings.split_once("allow = [").and_then(|(_, rest)| rest.split_once(']')).unwrap().0;
        let allowed: BTreeSet<&str> = list.split('"').skip(1).step_by(2).collect();
        assert_eq!(allowed, PERMITTED.into_iter().chain(FONTS).collect());
    }

    #[test]
    fn everything_in_the_packages_may_be_passed_on() {
        for triples in TARGETS {
            let page = page(triples).unwrap();
            assert!(page.lines().count() > 100, "{page}");
            assert!(page.contains("| egui 0.") && !page.contains("| pyrophone"), "{page}");
        }
    }
}
