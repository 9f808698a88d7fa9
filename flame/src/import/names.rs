//! Choice of grids by name, including the usual names for flame and velocity.

use super::error::{FormatFault, shown};
use super::model::{GridInfo, Selected, Selection, listed};
use super::vocabulary::{CARRIED, DIVERGENCES, FIELDS, VELOCITIES};

/// The grids that match a selection.
///
/// A name is matched exactly, otherwise without regard to case. The usual names (`flame`, `velocity`) match any of
/// their kind; a velocity may consist of three grids named after its components.
pub(super) fn select(grids: &[GridInfo], selection: &Selection) -> Result<Selected, FormatFault> {
    let field = select_field(grids, selection)?;
    let stems = candidates(&selection.velocity, &VELOCITIES);
    let whole = stems.iter().find_map(|name| named(grids, name, 3)).map(|grid| [grid; 3]);
    let split = || stems.iter().find_map(|stem| components(grids, stem));
    let velocity = whole.or_else(split);
    let velocity =
        velocity.ok_or_else(|| absent(grids, "vector grid (or grids of components)", &selection.velocity))?;
    Ok(Selected { field, velocity })
}

/// The scalar grid of a selection's field.
pub(super) fn select_field(grids: &[GridInfo], selection: &Selection) -> Result<usize, FormatFault> {
    let usual: &[&str] = if DIVERGENCES[0].eq_ignore_ascii_case(&selection.field) { &DIVERGENCES } else { &FIELDS };
    let field = candidates(&selection.field, usual).into_iter().find_map(|name| named(grids, name, 1));
    field.ok_or_else(|| absent(grids, "scalar grid", &selection.field))
}

/// The field that shows the gas's motion best: not the flame, which does not move with it.
pub(super) fn carried(grids: &[GridInfo]) -> Option<usize> {
    CARRIED.iter().find_map(|name| named(grids, name, 1))
}

/// The requested name and, if it is the usual one, all its synonyms.
fn candidates<'a>(wanted: &'a str, usual: &[&'a str]) -> Vec<&'a str> {
    if usual[0].eq_ignore_ascii_case(wanted) {
        return [wanted].iter().chain(&usual[1..]).copied().collect();
    }
    vec![wanted]
}

/// The first readable grid of that name: matched exactly, otherwise without regard to case.
fn named(grids: &[GridInfo], name: &str, components: usize) -> Option<usize> {
    let find =
        |fits: &dyn Fn(&str) -> bool| grids.iter().position(|grid| grid.components == components && fits(&grid.name));
    find(&|found| found == name).or_else(|| find(&|found| found.eq_ignore_ascii_case(name)))
}

/// The other readable grids of the same name and kind, which belong to the same field.
pub(super) fn namesakes(grids: &[GridInfo], index: usize) -> Vec<usize> {
    let Some(own) = grids.get(index) else { return vec![] };
    let is_alike = |grid: &GridInfo| grid.name == own.name && grid.components == own.components;
    (0..grids.len()).filter(|other| *other != index && is_alike(&grids[*other])).collect()
}

/// The grids of the components of `stem`: `stem.x`, `stem_x`, `stemx`, `x_stem`, and so for y and z.
fn components(grids: &[GridInfo], stem: &str) -> Option<[usize; 3]> {
    let patterns: [fn(&str, char) -> String; 4] = [
        |stem, axis| format!("{stem}.{axis}"),
        |stem, axis| format!("{stem}_{axis}"),
        |stem, axis| format!("{stem}{axis}"),
        |stem, axis| format!("{axis}_{stem}"),
    ];
    patterns.iter().find_map(|pattern| {
        let [x, y, z] = ['x', 'y', 'z'].map(|axis| named(grids, &pattern(stem, axis), 1));
        Some([x?, y?, z?])
    })
}

fn absent(grids: &[GridInfo], what: &str, name: &str) -> FormatFault {
    FormatFault::NoGrid { wanted: format!("{what} \"{}\"", shown(name)), there: listed(grids) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grids(names: &[(&str, usize)]) -> Vec<GridInfo> {
        let info = |(name, components): &(&str, usize)| GridInfo {
            name: (*name).into(),
            kind: if *components == 3 { "vec3s".into() } else { "float".into() },
            components: *components,
            ..GridInfo::default()
        };
        names.iter().map(info).collect()
    }

    fn selection(field: &str, velocity: &str) -> Selection {
        Selection { field: field.into(), velocity: velocity.into(), ..Selection::default() }
    }

    fn check(names: &[(&str, usize)], wanted: (&str, &str), expected: Option<(usize, [usize; 3])>) {
        let found = select(&grids(names), &selection(wanted.0, wanted.1));
        assert_eq!(found.ok().map(|found| (found.field, found.velocity)), expected, "{names:?} {wanted:?}");
    }

    #[test]
    fn usual_names() {
        let usual = ("flame", "velocity");
        check(&[("velocity", 3), ("density", 1), ("flame", 1)], usual, Some((2, [0; 3])));
        check(&[("Fuel", 1), ("FLAMES", 1), ("Vel", 3)], usual, Some((1, [2; 3])));
        check(&[("temperature", 1), ("fuel", 1), ("v", 3), ("vel", 3)], usual, Some((1, [3; 3])));
        check(&[("density", 1), ("velocity", 3)], usual, None);
        check(&[("flame", 1), ("velocity", 1)], usual, None);
        check(&[("flame", 3), ("burn", 1), ("velocity", 3)], usual, Some((1, [2; 3])));
    }

    #[test]
    fn a_name_of_ones_own_has_no_substitute() {
        let there = [("flame", 1), ("Smoke", 1), ("velocity", 3), ("wind", 3)];
        check(&there, ("smoke", "wind"), Some((1, [3; 3])));
        check(&there, ("fuel", "velocity"), None);
        check(&there, ("flame", "vel"), None);
        check(&[("Flame", 1), ("flame", 1), ("velocity", 3)], ("flame", "velocity"), Some((1, [2; 3])));
    }

    #[test]
    fn components_of_every_spelling() {
        for names in [["vel.x", "vel.y", "vel.z"], ["velocity_X", "velocity_Y", "velocity_Z"], ["velX", "velY", "velZ"]]
        {
            let there = [(names[2], 1), ("flame", 1), (names[0], 1), (names[1], 1)];
            check(&there, ("flame", "velocity"), Some((1, [2, 3, 0])));
        }
        check(&[("x_vel", 1), ("y_vel", 1), ("z_vel", 1), ("flame", 1)], ("flame", "velocity"), Some((3, [0, 1, 2])));
        check(&[("u.x", 1), ("u.y", 1), ("u.z", 1), ("flame", 1)], ("flame", "u"), Some((3, [0, 1, 2])));
        check(&[("vel.x", 1), ("vel.y", 1), ("vel_z", 1), ("flame", 1)], ("flame", "velocity"), None);
    }

    #[test]
    fn error_lists_the_grids_that_exist() {
        let there = grids(&[("density", 1), ("v\u{1b}[2Jel", 3)]);
        let message = select(&there, &Selection::default()).unwrap_err().to_string();
        assert!(message.contains("\"flame\"") && message.contains("density (float), v?[2Jel (vec3s)"), "{message}");
    }
}
