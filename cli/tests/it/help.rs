//! The flags are a promise: a change of the help text is a decision, not an accident.

#[test]
fn flags() {
    for command in [
        "texture",
        "extend",
        "render",
        "flux",
        "flux-merge",
        "flux-plan",
        "simulate",
        "vortex-texture",
        "presets",
        "parameters",
        "completions",
        "man",
    ] {
        let output = crate::common::pyrophone(std::path::Path::new("."), &format!("{command} --help"));
        assert!(output.status.success());
        let text: Vec<String> =
            String::from_utf8(output.stdout).unwrap().lines().map(|line| line.trim_end().to_string()).collect();
        insta::assert_snapshot!(command, text.join("\n"));
    }
}
