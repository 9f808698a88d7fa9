//! Pages of eight parameters for hosts' controllers.

use nice_plug::prelude::*;
use pyrophone_settings::index_of;

use crate::parameters::{EffectParams, Slot};

/// A page: its name, and ids of up to eight parameters in the order of the knobs.
type Page = (&'static str, [&'static str; 8]);

/// From the most used to the least used parameters.
pub const PAGES: [Page; 6] = [
    (
        "Character",
        [
            "macro_size",
            "macro_fury",
            "macro_crackle",
            "macro_sharpness",
            "macro_hiss",
            "macro_whoosh",
            "macro_tightness",
            "macro_distance",
        ],
    ),
    (
        "Fire",
        [
            "output_level",
            "texture_level",
            "extension_level",
            "vortex_level",
            "low_level",
            "dynamics",
            "drive_match",
            "spectrum_match",
        ],
    ),
    (
        "Flame",
        [
            "drive_gain",
            "attack",
            "release",
            "threshold",
            "flame_scene",
            "flame_intensity",
            "flame_wind",
            "flame_offset",
        ],
    ),
    (
        "Shape",
        [
            "alpha",
            "cutoff",
            "blend_width",
            "noise_amount",
            "extension_width",
            "scaling_alpha",
            "low_end",
            "texture_width",
        ],
    ),
    (
        "Whoosh",
        [
            "vortex_speed",
            "vortex_curve",
            "vortex_range",
            "vortex_sources",
            "vortex_distance",
            "vortex_spread",
            "vortex_azimuth",
            "vortex_elevation",
        ],
    ),
    (
        "Fuel",
        [
            "fuel",
            "crackle_level",
            "crackle_density",
            "crackle_sharpness",
            "hiss_level",
            "hiss_tone",
            "body_level",
            "body_tone",
        ],
    ),
];

/// Defines the pages for the framework.
pub fn define(params: &EffectParams, context: &mut impl RemoteControlsContext) {
    context.add_section("Pyrophone", |section| {
        for (name, ids) in PAGES {
            section.add_page(name, |page| {
                for id in ids {
                    match index_of(id).map(|index| params.slot(index)) {
                        Ok(Slot::Float(float)) => page.add_param(float),
                        Ok(Slot::Int(int)) => page.add_param(int),
                        Ok(Slot::Toggle(toggle)) => page.add_param(toggle),
                        Err(_) => page.add_spacer(),
                    }
                }
            });
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pages_hold_automatable_parameters_once() {
        let mut ids: Vec<&str> = PAGES.iter().flat_map(|(_, ids)| *ids).collect();
        for id in &ids {
            let index = index_of(id).unwrap_or_else(|error| panic!("{error}"));
            assert!(pyrophone_settings::PARAMETERS[index].automatable, "{id}");
        }
        ids.sort_unstable();
        ids.dedup();
        assert_eq!(ids.len(), 48);
    }
}
