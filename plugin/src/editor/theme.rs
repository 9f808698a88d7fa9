//! The common look: an ember's colours on charcoal, sizes and spacing.

use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Vec2, Visuals};

/// Window background.
pub const GROUND: Color32 = Color32::from_rgb(0x13, 0x10, 0x0f);
/// Background of a panel.
pub const PANEL: Color32 = Color32::from_rgb(0x1e, 0x1a, 0x18);
/// Background of a plot.
pub const WELL: Color32 = Color32::from_rgb(0x0d, 0x0b, 0x0a);
/// Rules and tracks.
pub const LINE: Color32 = Color32::from_rgb(0x3d, 0x34, 0x2f);
/// Words; 14:1 on the panel.
pub const TEXT: Color32 = Color32::from_rgb(0xf2, 0xe8, 0xdf);
/// Names and units; 6.5:1 on the panel.
pub const WEAK: Color32 = Color32::from_rgb(0xb3, 0xa3, 0x95);
/// The output, and set values.
pub const EMBER: Color32 = Color32::from_rgb(0xff, 0x82, 0x38);
/// The drive: a flame's blue foot.
pub const BLUE: Color32 = Color32::from_rgb(0x6c, 0xb0, 0xff);
/// The recording.
pub const ASH: Color32 = Color32::from_rgb(0xd8, 0xc6, 0xb2);
/// Errors; contrast 6:1 on the panel.
pub const ALARM: Color32 = Color32::from_rgb(0xff, 0x7d, 0x66);

/// Crackle.
pub const SPARK: Color32 = Color32::from_rgb(0xff, 0xd0, 0x6b);
/// Vortex sound.
pub const VIOLET: Color32 = Color32::from_rgb(0xb5, 0x97, 0xff);
/// Good result.
pub const WELL_DONE: Color32 = Color32::from_rgb(0x7f, 0xd8, 0x8f);

/// Background of text over curves and pictures, which may show through without competing with it.
pub fn text_background() -> Color32 {
    WELL.gamma_multiply(0.92)
}

/// Corners of panels and buttons.
pub const ROUNDING: u8 = 5;

/// Text of plots and units.
pub fn small() -> FontId {
    FontId::new(10.5, FontFamily::Proportional)
}

/// Heads of groups.
pub fn head() -> FontId {
    FontId::new(11.5, FontFamily::Proportional)
}

/// Font of prominent names.
pub fn strong() -> FontId {
    FontId::new(12.5, FontFamily::Proportional)
}

/// Applies the look to a window.
pub fn apply(context: &egui::Context) {
    context.all_styles_mut(|style| {
        style.text_styles = [
            (TextStyle::Small, small()),
            (TextStyle::Body, FontId::new(12.5, FontFamily::Proportional)),
            (TextStyle::Button, FontId::new(12.5, FontFamily::Proportional)),
            (TextStyle::Heading, FontId::new(18.0, FontFamily::Proportional)),
            (TextStyle::Monospace, FontId::new(12.0, FontFamily::Monospace)),
        ]
        .into();
        style.spacing.item_spacing = Vec2::new(6.0, 4.0);
        style.spacing.button_padding = Vec2::new(8.0, 3.0);
        style.spacing.interact_size.y = 22.0;
        let visuals = &mut style.visuals;
        *visuals = Visuals::dark();
        visuals.override_text_color = Some(TEXT);
        visuals.panel_fill = GROUND;
        visuals.window_fill = PANEL;
        visuals.extreme_bg_color = WELL;
        visuals.weak_text_color = Some(WEAK);
        visuals.window_stroke = Stroke::new(1.0, LINE);
        visuals.selection.bg_fill = EMBER.gamma_multiply(0.45);
        visuals.selection.stroke = Stroke::new(1.0, EMBER);
        let corner = CornerRadius::same(ROUNDING);
        let states = &mut visuals.widgets;
        for state in [
            &mut states.noninteractive,
            &mut states.inactive,
            &mut states.hovered,
            &mut states.active,
            &mut states.open,
        ] {
            state.corner_radius = corner;
            state.expansion = 0.0;
            state.bg_stroke = Stroke::new(1.0, LINE);
        }
        states.inactive.weak_bg_fill = Color32::from_rgb(0x2a, 0x24, 0x20);
        states.inactive.bg_fill = LINE;
        states.hovered.weak_bg_fill = Color32::from_rgb(0x38, 0x2f, 0x29);
        states.hovered.bg_stroke = Stroke::new(1.0, EMBER.gamma_multiply(0.6));
        states.active.weak_bg_fill = Color32::from_rgb(0x4a, 0x38, 0x2c);
        states.active.bg_stroke = Stroke::new(1.0, EMBER);
    });
}

/// The colour of a spectrogram at a level, 0-1: black, red, ember, yellow, white.
pub fn glow(level: f32) -> Color32 {
    const STOPS: [[f32; 3]; 6] = [
        [13.0, 11.0, 10.0],
        [54.0, 16.0, 24.0],
        [140.0, 32.0, 22.0],
        [240.0, 104.0, 34.0],
        [255.0, 190.0, 84.0],
        [255.0, 250.0, 228.0],
    ];
    let place = level.clamp(0.0, 1.0) * (STOPS.len() - 1) as f32;
    let below = (place as usize).min(STOPS.len() - 2);
    let part = place - below as f32;
    let [r, g, b] = [0, 1, 2].map(|n| (STOPS[below][n] + part * (STOPS[below + 1][n] - STOPS[below][n])) as u8);
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Relative luminance (WCAG 2).
    fn luminance(color: Color32) -> f64 {
        let linear = |x: u8| {
            let x = f64::from(x) / 255.0;
            if x <= 0.04045 { x / 12.92 } else { ((x + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b())
    }

    #[test]
    fn words_can_be_read() {
        for words in [TEXT, WEAK, EMBER, BLUE, ASH, ALARM, SPARK, VIOLET, WELL_DONE] {
            for behind in [GROUND, PANEL, WELL] {
                let contrast = (luminance(words) + 0.05) / (luminance(behind) + 0.05);
                assert!(contrast >= 4.5, "{words:?} on {behind:?}: {contrast}");
            }
        }
    }

    #[test]
    fn louder_is_lighter() {
        let lights: Vec<f64> = (0..=50).map(|n| luminance(glow(n as f32 / 50.0))).collect();
        assert!(lights.is_sorted() && lights[50] > 0.9);
    }
}
