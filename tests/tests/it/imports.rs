//! No circle of imports inside a crate: whoever reads a module finds everything it builds on below it.
//!
//! What counts as an import is a `use` of another module of the same crate, as it is written. Re-exports (`pub use`) and
//! names that are taken from the crate's front (`use crate::Error`) do not count: a front only hands on. Tests may import
//! what they like.
//!
//! In the engines' crate there are floors besides: a module imports nothing of its own floor or of one above. There, paths
//! without `use` count too.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// A module's path within its crate, without the crate: `["texture", "search"]`. The root is empty.
type Module = Vec<String>;

/// Modules, and which others each of them imports.
type Imports = BTreeMap<Module, BTreeSet<Module>>;

/// The project's folder.
fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// Folders of the workspace's crates, from its manifest.
fn crates() -> Vec<String> {
    let manifest = std::fs::read_to_string(root().join("Cargo.toml")).expect("the workspace's manifest");
    let members = manifest.lines().find_map(|line| line.strip_prefix("members = [")).expect("its members, on one line");
    members.split('"').skip(1).step_by(2).map(str::to_owned).collect()
}

/// All Rust files below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).expect("a crate's folder").map(|entry| entry.expect("an entry").path());
    let (folders, files): (Vec<_>, Vec<_>) = entries.partition(|path| path.is_dir());
    let is_rust = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "rs");
    files.into_iter().filter(is_rust).chain(folders.iter().flat_map(|folder| sources(folder))).collect()
}

/// The module that a file holds.
fn module_of(file: &Path, source_folder: &Path) -> Module {
    let path = file.strip_prefix(source_folder).expect("a file of this folder").with_extension("");
    let mut module: Module = path.iter().map(|part| part.to_string_lossy().into_owned()).collect();
    module.pop_if(|last| ["lib", "main", "mod"].contains(&last.as_str()));
    module
}

/// The private `use` statements of a file outside its tests, without `use` and `;`.
fn uses(source: &str) -> Vec<String> {
    let code = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let mut statements = vec![];
    let mut lines = code.lines();
    while let Some(line) = lines.next() {
        let Some(rest) = line.trim_start().strip_prefix("use ") else { continue };
        let mut statement = rest.to_owned();
        while !statement.contains(';') {
            let Some(next) = lines.next() else { break };
            statement.push_str(next.trim());
        }
        statements.extend(statement.split(';').next().map(str::to_owned));
    }
    statements
}

/// The single paths of a tree: `a::{b, c::{d, e}}` are `a::b`, `a::c::d`, `a::c::e`.
fn paths(tree: &str) -> Vec<String> {
    let Some((before, inner)) = tree.split_once('{') else {
        let path = tree.split(" as ").next().unwrap_or_default().trim();
        return if path.is_empty() { vec![] } else { vec![path.to_owned()] };
    };
    let inner = inner.trim_end().strip_suffix('}').unwrap_or(inner);
    let (mut depth, mut begin, mut branches) = (0, 0, vec![]);
    for (at, letter) in inner.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                branches.push(&inner[begin..at]);
                begin = at + 1;
            }
            _ => {}
        }
    }
    branches.push(&inner[begin..]);
    branches.into_iter().flat_map(paths).map(|path| format!("{}{path}", before.trim())).collect()
}

/// The module that a path in `own` leads to; none where it is of another crate, of the root, or `own` itself.
fn target(path: &str, own: &Module, modules: &BTreeSet<Module>) -> Option<Module> {
    let mut full = own.clone();
    let mut parts = path.split("::").peekable();
    match *parts.peek()? {
        "crate" => full.clear(),
        "self" => {}
        "super" => {
            full.pop();
        }
        child => {
            full.push(child.to_owned());
            // A name without `crate`, `self` or `super` is a child module's, or of another crate.
            modules.contains(&full).then_some(())?;
        }
    }
    parts.next();
    for part in parts {
        match part {
            "super" => drop(full.pop()),
            "self" => {}
            name => full.push(name.to_owned()),
        }
    }
    while !modules.contains(&full) {
        full.pop()?;
    }
    (!full.is_empty() && full != *own).then_some(full)
}

/// Imports of each module of a crate.
fn imports(source_folder: &Path) -> Imports {
    let files = sources(source_folder);
    let modules: BTreeSet<Module> = files.iter().map(|file| module_of(file, source_folder)).collect();
    let of_file = |file: &PathBuf| {
        let own = module_of(file, source_folder);
        let source = std::fs::read_to_string(file).expect("a source file");
        let found = uses(&source).iter().flat_map(|tree| paths(tree)).collect::<Vec<_>>();
        let found = found.iter().filter_map(|path| target(path, &own, &modules)).collect();
        (own, found)
    };
    files.iter().map(of_file).filter(|(own, _)| !own.is_empty()).collect()
}

/// All modules reached from one by imports; itself only by way of a circle.
fn reached<'a>(from: &'a Module, imports: &'a Imports) -> BTreeSet<&'a Module> {
    let (mut found, mut waiting) = (BTreeSet::new(), vec![from]);
    while let Some(module) = waiting.pop() {
        waiting.extend(imports.get(module).into_iter().flatten().filter(|next| found.insert(*next)));
    }
    found
}

/// Sets of modules each of which reaches all others of its set.
fn circles(imports: &Imports) -> BTreeSet<BTreeSet<&Module>> {
    let all: BTreeMap<&Module, BTreeSet<&Module>> =
        imports.keys().map(|module| (module, reached(module, imports))).collect();
    let meets = |module: &Module, other: &Module| all[module].contains(other) && all[other].contains(module);
    let in_circle = |module: &&&Module| all[**module].contains(**module);
    all.keys()
        .filter(in_circle)
        .map(|module| all.keys().copied().filter(|other| meets(module, other)).collect())
        .collect()
}

/// A circle and the imports that make it one, for messages.
fn shown(crate_folder: &str, circle: &BTreeSet<&Module>, imports: &Imports) -> String {
    let arrows = circle.iter().flat_map(|from| {
        let within = imports[*from].iter().filter(|to| circle.contains(to));
        within.map(move |to| format!("  {} -> {}", from.join("::"), to.join("::")))
    });
    std::iter::once(crate_folder.to_owned()).chain(arrows).collect::<Vec<_>>().join("\n")
}

/// The engines' modules from the ground up.
const FLOORS: [&[&str]; 8] = [
    &["bulk", "error"],
    &["dsp"],
    &["controls", "structure"],
    &["crackle", "drive", "extend", "tone"],
    &["fuel", "texture", "vortex"],
    &["companding"],
    &["mix", "recording"],
    &["chain"],
];

/// The floor of a module of the engines.
fn floor(module: &str) -> Option<usize> {
    FLOORS.iter().position(|floor| floor.contains(&module))
}

/// Modules at the top of a crate that a file's code names by a path from `crate`, with or without `use`.
fn named_from_the_top(source: &str) -> BTreeSet<String> {
    let code = source.split("#[cfg(test)]\nmod ").next().unwrap_or_default();
    let lines = code.lines().filter(|line| !line.trim_start().starts_with("//"));
    let code = lines.collect::<Vec<_>>().join("\n");
    let is_name = |letter: char| letter.is_alphanumeric() || letter == '_';
    let mut found = BTreeSet::new();
    for (at, start) in code.match_indices("crate::") {
        let is_macro = code[..at].ends_with('$');
        let rest = &code[at + start.len()..];
        let names = match rest.strip_prefix('{') {
            Some(inner) => paths(&format!("{{{}}}", inner.split(';').next().unwrap_or_default().trim_end_matches('}'))),
            None => vec![rest.split(|letter| !is_name(letter)).next().unwrap_or_default().to_owned()],
        };
        let names = names.iter().filter_map(|name| name.split("::").next()).map(str::to_owned);
        found.extend(names.filter(|_| !is_macro));
    }
    found
}

/// Imports of a module at the top of the engines, or of one below it, that do not lead downwards.
fn upward_imports(module: &str, named: &BTreeSet<String>) -> Vec<String> {
    let own = floor(module);
    let is_upward = |other: &&String| *other != module && floor(other).is_some() && floor(other) >= own;
    named.iter().filter(is_upward).map(|other| format!("{module} -> {other}")).collect()
}

#[test]
fn engines_import_downwards_only() {
    let source_folder = root().join("synthesis/src");
    let imports = imports(&source_folder);
    let mut faults = vec![];
    for file in sources(&source_folder) {
        let own = module_of(&file, &source_folder);
        let Some(top) = own.first() else { continue };
        assert!(floor(top).is_some(), "{top} has no floor: add it to FLOORS");
        let source = std::fs::read_to_string(&file).expect("a source file");
        let mut named = named_from_the_top(&source);
        named.extend(imports[&own].iter().filter_map(|target| target.first().cloned()));
        faults.extend(upward_imports(top, &named).into_iter().map(|fault| format!("{}: {fault}", file.display())));
    }
    assert!(faults.is_empty(), "imports that do not lead downwards:\n{}", faults.join("\n"));
}

#[test]
fn an_import_from_above_is_found() {
    let source = "use crate::{Error, drive::{Drive, self}, mix};\n// crate::chain\nlet x = crate::fuel::bank();\n\
        $crate::vortex!()\nuse crate::dsp::Svf;\n#[cfg(test)]\nmod tests {\n    use crate::tone;\n}";
    let named = named_from_the_top(source);
    assert_eq!(named, ["Error", "drive", "dsp", "fuel", "mix"].map(str::to_owned).into());
    assert_eq!(upward_imports("dsp", &named), ["dsp -> drive", "dsp -> fuel", "dsp -> mix"]);
    assert_eq!(upward_imports("extend", &named), ["extend -> drive", "extend -> fuel", "extend -> mix"], "one floor");
    assert!(upward_imports("chain", &named).is_empty());
    assert_eq!(upward_imports("texture", &["companding".to_owned()].into()), ["texture -> companding"]);
    assert!(upward_imports("companding", &["texture".to_owned()].into()).is_empty());
}

#[test]
fn no_circle_of_imports() {
    let mut found = vec![];
    for folder in crates() {
        let source_folder = root().join(&folder).join("src");
        let imports = imports(&source_folder);
        let is_small = ["assets", "settings", "fires", "keyboard"].contains(&folder.as_str());
        assert!(imports.len() > 2 || is_small, "{folder} has hardly a module: is this its folder?");
        found.extend(circles(&imports).iter().map(|circle| shown(&folder, circle, &imports)));
    }
    assert!(
        found.is_empty(),
        "circles of imports; move what both sides need into a module of its own:\n{}",
        found.join("\n")
    );
}

#[test]
fn a_circle_is_found_through_every_kind_of_path() {
    let module = |path: &str| path.split("::").map(str::to_owned).collect::<Module>();
    let modules: BTreeSet<Module> = ["a", "a::b", "a::c", "d"].into_iter().map(module).chain([vec![]]).collect();
    let found = |own: &str, source: &str| -> BTreeSet<String> {
        let targets = uses(source).into_iter().flat_map(|tree| paths(&tree)).collect::<Vec<_>>();
        targets.iter().filter_map(|path| target(path, &module(own), &modules)).map(|to| to.join("::")).collect()
    };
    assert_eq!(found("a", "use b::Thing;\nuse self::c::{Other, self};"), ["a::b", "a::c"].map(str::to_owned).into());
    assert_eq!(
        found("a::b", "    use super::{Thing,\n        c::{X as Y, Z}};"),
        ["a", "a::c"].map(str::to_owned).into()
    );
    assert_eq!(
        found("d", "use crate::a::b::{\n    Thing,\n};\nuse std::path::Path;"),
        ["a::b"].map(str::to_owned).into()
    );
    assert_eq!(
        found("d", "pub use crate::a::Thing;\nuse crate::Error;\n#[cfg(test)]\nmod tests {\n    use crate::a::X;\n}"),
        BTreeSet::new()
    );
    let mut imports = Imports::from([(module("a"), [module("d")].into()), (module("d"), BTreeSet::new())]);
    assert_eq!(circles(&imports).len(), 0);
    imports.insert(module("d"), [module("a")].into());
    assert_eq!(circles(&imports).len(), 1);
}
