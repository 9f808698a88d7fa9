//! The bill of materials: every crate in a package, in CycloneDX 1.5, for users who must document their software.

use std::collections::BTreeMap;

use anyhow::{Context, Result};

use super::licences::{Crate, crates};
use crate::project;

/// The bill of the packages for these targets. The same sources give the same bill.
pub fn bill(triples: &[&str]) -> Result<String> {
    let lock = std::fs::read_to_string(project::root().join("Cargo.lock")).context("Cargo.lock")?;
    let checksums = checksums(&lock);
    let components: Vec<String> = crates(triples)?.iter().map(|about| component(about, &checksums)).collect();
    let subject = object(&[
        ("type", quoted("application")),
        ("name", quoted("pyrophone")),
        ("version", quoted(env!("CARGO_PKG_VERSION"))),
    ]);
    let bill = object(&[
        ("bomFormat", quoted("CycloneDX")),
        ("specVersion", quoted("1.5")),
        ("version", "1".to_owned()),
        ("metadata", object(&[("component", subject)])),
        ("components", format!("[\n{}\n]", components.join(",\n"))),
    ]);
    Ok(bill + "\n")
}

/// Checksums of crates by name and version, from the lock file.
fn checksums(lock: &str) -> BTreeMap<(&str, &str), &str> {
    fn entry(package: &str) -> Option<((&str, &str), &str)> {
        let field = |name: &str| package.lines().find_map(|line| line.strip_prefix(name)?.split('"').nth(1));
        Some(((field("name = ")?, field("version = ")?), field("checksum = ")?))
    }
    lock.split("[[package]]").filter_map(entry).collect()
}

fn component(Crate { name, version, licence, .. }: &Crate, checksums: &BTreeMap<(&str, &str), &str>) -> String {
    let address = quoted(&format!("pkg:cargo/{name}@{version}"));
    // Older crates separate alternatives by a slash.
    let licence = object(&[("expression", quoted(&licence.replace('/', " OR ")))]);
    let mut fields = vec![
        ("type", quoted("library")),
        ("bom-ref", address.clone()),
        ("name", quoted(name)),
        ("version", quoted(version)),
        ("purl", address),
        ("licenses", format!("[{licence}]")),
    ];
    if let Some(checksum) = checksums.get(&(name.as_str(), version.as_str())) {
        let checksum = object(&[("alg", quoted("SHA-256")), ("content", quoted(checksum))]);
        fields.push(("hashes", format!("[{checksum}]")));
    }
    object(&fields)
}

fn object(fields: &[(&str, String)]) -> String {
    let fields: Vec<String> = fields.iter().map(|(name, value)| format!("\"{name}\": {value}")).collect();
    format!("{{{}}}", fields.join(", "))
}

/// A JSON string. Names, versions and licences contain no other characters that need escaping.
fn quoted(text: &str) -> String {
    format!("\"{}\"", text.replace('\\', "\\\\").replace('"', "\\\""))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::package::TARGETS;

    #[test]
    fn crates_carry_their_checksums() {
        let lock = "version = 4\n\n[[package]]\nname = \"own\"\nversion = \"1.0.0\"\n\n[[package]]\nname = \"rayon\"\n\
                    version = \"1.2.3\"\nsource = \"registry\"\nchecksum = \"ab12\"\n";
        assert_eq!(checksums(lock), BTreeMap::from([(("rayon", "1.2.3"), "ab12")]));
        let about = Crate {
            name: "rayon".into(),
            version: "1.2.3".into(),
            licence: "MIT/Apache-2.0".into(),
            source: String::new(),
        };
        let found = component(&about, &checksums(lock));
        let expected = r#"{"type": "library", "bom-ref": "pkg:cargo/rayon@1.2.3", "name": "rayon", "version": "1.2.3", "purl": "pkg:cargo/rayon@1.2.3", "licenses": [{"expression": "MIT OR Apache-2.0"}], "hashes": [{"alg": "SHA-256", "content": "ab12"}]}"#;
        assert_eq!(found, expected);
    }

    #[test]
    fn every_crate_of_the_licence_page_is_on_the_bill() {
        for triples in TARGETS {
            let (bill, crates) = (bill(triples).unwrap(), crates(triples).unwrap());
            assert_eq!(bill.matches("\"purl\"").count(), crates.len());
            assert_eq!(bill.matches("\"SHA-256\"").count(), crates.len(), "a crate without a checksum");
        }
    }
}
