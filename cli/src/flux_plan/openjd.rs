//! Jobs for Open Job Description, as run by Deadline Cloud and others (specification 2023-09, with chunks of tasks).

use serde_json::{Value, json};

use super::Job;

/// Placeholder for a chunk's frames: the engine fills in `1-30`, or `7` for a chunk of one.
const FRAMES: &str = "{{Task.Param.Frames}}";

/// The template in JSON, a subset of YAML.
pub fn template(job: &Job) -> String {
    let (first, last) = job.frames;
    let frames = json!({
        "name": "Frames",
        "type": "CHUNK[INT]",
        "range": format!("{first}-{last}"),
        "chunks": { "defaultTaskCount": job.chunk, "rangeConstraint": "CONTIGUOUS" },
    });
    let template = json!({
        "specificationVersion": "jobtemplate-2023-09",
        "extensions": ["TASK_CHUNKING"],
        "name": "Pyrophone flux",
        "steps": [
            {
                "name": "Measure",
                "parameterSpace": { "taskParameterDefinitions": [frames] },
                "stepEnvironments": [folder(job)],
                "script": { "actions": { "onRun": call(job, &job.measure_arguments(FRAMES)) } },
            },
            {
                "name": "Merge",
                "dependencies": [{ "dependsOn": "Measure" }],
                "script": { "actions": { "onRun": call(job, &job.merge_arguments()) } },
            },
        ],
    });
    serde_json::to_string_pretty(&template).unwrap_or_default() + "\n"
}

/// Command of a task, with progress lines of the kind that the engine displays.
fn call(job: &Job, arguments: &[String]) -> Value {
    let with_progress: Vec<&str> =
        ["--progress", "openjd"].into_iter().chain(arguments.iter().map(String::as_str)).collect();
    json!({ "command": job.program.display().to_string(), "args": with_progress })
}

/// The parts' folder, created by whichever worker comes first.
fn folder(job: &Job) -> Value {
    let make = json!({ "command": "mkdir", "args": ["-p", job.parts.display().to_string()] });
    json!({ "name": "Folder", "script": { "actions": { "onEnter": make } } })
}
