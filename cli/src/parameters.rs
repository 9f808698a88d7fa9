//! `pyrophone parameters`: the vocabulary of presets, automation and `--set`.

use pyrophone_settings::{PARAMETERS, Parameter, ParameterKind};
use serde::Serialize;

use crate::summary::{json, print};

/// A parameter as printed by `--json`; values are in the form that presets and automation use.
#[derive(Serialize)]
struct Listed {
    id: &'static str,
    name: &'static str,
    group: &'static str,
    unit: &'static str,
    /// `float`, `int`, `choice` or `toggle`.
    kind: &'static str,
    low: f64,
    high: f64,
    /// True if the lowest value means "off".
    off_at_low: bool,
    default: String,
    /// Names of a choice's values.
    choices: &'static [&'static str],
    automatable: bool,
    /// The published value, if there is one.
    paper: Option<String>,
    help: &'static str,
}

#[derive(Serialize)]
struct List {
    command: &'static str,
    parameters: Vec<Listed>,
}

/// Lists all parameters on standard output.
pub fn run(as_json: bool) {
    if as_json {
        let parameters = PARAMETERS.iter().map(Listed::new).collect();
        print(&json(&List { command: "parameters", parameters }));
        return;
    }
    let widest = PARAMETERS.iter().map(|parameter| parameter.id.len()).max().unwrap_or(0);
    let lines = |parameter: &Parameter| {
        let fixed = if parameter.automatable { "" } else { " Cannot be automated." };
        let Parameter { id, help, .. } = parameter;
        format!("{id:widest$}  {}\n{:widest$}  {help}{fixed}\n", range(parameter), "")
    };
    print(&PARAMETERS.iter().map(lines).collect::<String>());
}

/// The allowed values and the default.
fn range(parameter: &Parameter) -> String {
    let default = parameter.to_text(parameter.default_value());
    let allowed = match parameter.kind {
        ParameterKind::Choice { names, .. } => names.join(", "),
        ParameterKind::Toggle { .. } => "off, on".to_owned(),
        ParameterKind::Float { .. } | ParameterKind::Int { .. } => {
            format!("{} to {}", parameter.to_text(parameter.low()), parameter.to_text(parameter.high()))
        }
    };
    format!("{allowed} [default: {default}]")
}

impl Listed {
    fn new(parameter: &Parameter) -> Self {
        let (kind, choices, off_at_low): (_, &[&str], _) = match parameter.kind {
            ParameterKind::Float { off_at_low, .. } => ("float", &[], off_at_low),
            ParameterKind::Int { .. } => ("int", &[], false),
            ParameterKind::Choice { names, .. } => ("choice", names, false),
            ParameterKind::Toggle { .. } => ("toggle", &[], false),
        };
        Self {
            id: parameter.id,
            name: parameter.name,
            group: parameter.group.name(),
            unit: parameter.unit,
            kind,
            low: parameter.low(),
            high: parameter.high(),
            off_at_low,
            default: parameter.to_text(parameter.default_value()),
            choices,
            automatable: parameter.automatable,
            paper: parameter.paper.map(|plain| parameter.to_text(plain)),
            help: parameter.help,
        }
    }
}
