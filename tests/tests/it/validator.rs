//! The project's own validator over both bundles.

use pyrophone_host::Format;
use pyrophone_host::validator::checks;
use pyrophone_tests::bundle;

/// One check after the other, all failures told at the end: a check that crashes takes the others with it, and its
/// name is the last one printed.
#[test]
fn the_bundles_pass_every_check_of_the_projects_own_validator() {
    let mut failures = vec![];
    for format in Format::ALL {
        assert!(checks(format).len() >= 8, "{format} has lost its checks");
        for check in checks(format) {
            println!("{format}: {}", check.name);
            if let Err(found) = check.run(&bundle(format)) {
                failures.push(format!("{format}: {}: {found}", check.name));
            }
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}
