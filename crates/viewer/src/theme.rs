//! Look and feel: spacing, corners and colours of both themes.

use egui::{Color32, Context, CornerRadius, FontId, Margin, Stroke, TextStyle, Theme, Vec2};

/// Colour of what is on, in both themes.
pub const ACCENT: Color32 = Color32::from_rgb(232, 158, 62);

/// Colours of lines in plots and of lanes side by side; told apart by people who see red and green alike too (Okabe,
/// Ito 2008).
pub const LINES: [Color32; 4] = [
    Color32::from_rgb(230, 159, 0),
    Color32::from_rgb(86, 180, 233),
    Color32::from_rgb(0, 158, 115),
    Color32::from_rgb(204, 121, 167),
];

/// Gives a context the viewer's look.
pub fn apply(ctx: &Context) {
    ctx.all_styles_mut(|style| {
        style.spacing.item_spacing = Vec2::new(8.0, 6.0);
        style.spacing.button_padding = Vec2::new(8.0, 4.0);
        style.spacing.window_margin = Margin::same(12);
        style.spacing.slider_width = 130.0;
        style.spacing.combo_width = 140.0;
        style.spacing.scroll.floating = true;
        style.spacing.scroll.floating_allocated_width = 6.0;
        let sizes = [
            (TextStyle::Heading, FontId::proportional(17.0)),
            (TextStyle::Body, FontId::proportional(13.5)),
            (TextStyle::Button, FontId::proportional(13.5)),
            (TextStyle::Small, FontId::proportional(11.0)),
            (TextStyle::Monospace, FontId::monospace(12.5)),
        ];
        style.text_styles.extend(sizes);
        style.interaction.selectable_labels = false;
        let visuals = &mut style.visuals;
        for widget in [
            &mut visuals.widgets.inactive,
            &mut visuals.widgets.hovered,
            &mut visuals.widgets.active,
            &mut visuals.widgets.open,
            &mut visuals.widgets.noninteractive,
        ] {
            widget.corner_radius = CornerRadius::same(5);
        }
        visuals.window_corner_radius = CornerRadius::same(8);
        visuals.menu_corner_radius = CornerRadius::same(6);
        visuals.slider_trailing_fill = true;
    });
    ctx.style_mut_of(Theme::Dark, |style| {
        let visuals = &mut style.visuals;
        visuals.panel_fill = Color32::from_rgb(30, 32, 36);
        visuals.window_fill = Color32::from_rgb(36, 38, 43);
        visuals.extreme_bg_color = Color32::from_rgb(20, 21, 24);
        visuals.faint_bg_color = Color32::from_rgb(38, 40, 45);
        visuals.selection.bg_fill = Color32::from_rgb(128, 84, 28);
        visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(255, 226, 184));
        visuals.widgets.noninteractive.fg_stroke.color = Color32::from_rgb(206, 208, 212);
        visuals.hyperlink_color = ACCENT;
    });
    ctx.style_mut_of(Theme::Light, |style| {
        let visuals = &mut style.visuals;
        visuals.panel_fill = Color32::from_rgb(246, 246, 244);
        visuals.window_fill = Color32::from_rgb(252, 252, 250);
        visuals.selection.bg_fill = Color32::from_rgb(250, 208, 148);
        visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(92, 54, 6));
        visuals.widgets.noninteractive.fg_stroke.color = Color32::from_rgb(44, 46, 50);
        visuals.hyperlink_color = Color32::from_rgb(168, 96, 8);
    });
}
