//! Curves on a logarithmic scale.

use crate::format::share;
use egui::{Align2, Color32, FontId, Pos2, Rect, Role, Sense, Shape, Stroke, Ui, Vec2, WidgetInfo};

/// A line of a plot.
pub struct Curve {
    pub color: Color32,
    /// Seconds, and a share above 0.
    pub points: Vec<[f64; 2]>,
}

/// Least share that is shown.
const FLOOR: f64 = 1e-6;

/// Shares over seconds, from 0 to the last second, and over as many decades as there are.
pub fn plot(ui: &mut Ui, name: &str, height: f32, curves: &[Curve]) {
    let size = Vec2::new(ui.available_width(), height);
    let (response, painter) = ui.allocate_painter(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Image, true, format!("plot of {name}")));
    let visuals = ui.visuals();
    painter.rect_filled(response.rect, 4.0, visuals.extreme_bg_color);
    let axes = Axes::new(response.rect, curves);
    let (grid, text) = (
        visuals.widgets.noninteractive.bg_stroke.color,
        visuals.weak_text_color(),
    );
    let font = FontId::proportional(9.5);
    for decade in axes.decades() {
        let y = axes.at(0.0, 10_f64.powi(decade)).y;
        painter.hline(axes.inner.x_range(), y, Stroke::new(0.5, grid));
        let label = if decade >= -4 {
            share(10_f64.powi(decade))
        } else {
            format!("1e{decade}")
        };
        painter.text(
            Pos2::new(axes.inner.left() - 4.0, y),
            Align2::RIGHT_CENTER,
            label,
            font.clone(),
            text,
        );
    }
    let right = Pos2::new(axes.inner.right(), response.rect.bottom() - 1.0);
    painter.text(
        right,
        Align2::RIGHT_BOTTOM,
        format!("{:.1} s", axes.seconds),
        font,
        text,
    );
    for curve in curves {
        let points: Vec<Pos2> = curve.points.iter().map(|&[x, y]| axes.at(x, y)).collect();
        painter.add(Shape::line(points, Stroke::new(1.6, curve.color)));
    }
}

struct Axes {
    inner: Rect,
    seconds: f64,
    /// Decimal exponents at the bottom and at the top.
    low: i32,
    high: i32,
}

impl Axes {
    fn new(rect: Rect, curves: &[Curve]) -> Self {
        let all = || curves.iter().flat_map(|curve| &curve.points);
        let values = || {
            all()
                .map(|p| p[1])
                .filter(|y| *y > 0.0)
                .map(|y| y.max(FLOOR).log10())
        };
        let (low, high) = (values().fold(-1.0, f64::min), values().fold(-1.0, f64::max));
        // A whole that is off by the last digit opens no decade of its own.
        let high = high - 1e-6;
        #[expect(clippy::cast_possible_truncation, reason = "a few decades")]
        let (low, high) = (low.floor() as i32, high.ceil().min(6.0) as i32);
        Self {
            inner: Rect::from_min_max(
                rect.min + Vec2::new(40.0, 8.0),
                rect.max - Vec2::new(8.0, 14.0),
            ),
            seconds: all().map(|p| p[0]).fold(0.1, f64::max),
            low,
            high: high.max(low + 1),
        }
    }

    fn decades(&self) -> impl Iterator<Item = i32> + use<> {
        self.low..=self.high
    }

    #[expect(clippy::cast_possible_truncation, reason = "pixels")]
    fn at(&self, seconds: f64, value: f64) -> Pos2 {
        let x = (seconds / self.seconds).clamp(0.0, 1.0) as f32;
        let exponent = value.max(FLOOR).log10() - f64::from(self.low);
        let y = (exponent / f64::from(self.high - self.low)).clamp(0.0, 1.0) as f32;
        Pos2::new(
            self.inner.left() + x * self.inner.width(),
            self.inner.bottom() - y * self.inner.height(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decades_cover_the_curves() {
        let rect = Rect::from_min_size(Pos2::ZERO, Vec2::new(200.0, 100.0));
        let curve = Curve {
            color: Color32::WHITE,
            points: vec![[0.0, 1.0], [2.0, 3e-4], [4.0, 0.0]],
        };
        let axes = Axes::new(rect, &[curve]);
        assert_eq!(
            (axes.low, axes.high, axes.seconds),
            (-4, 0, 4.0),
            "from 1e-4 to 1"
        );
        assert_eq!(axes.at(0.0, 1.0), axes.inner.left_top(), "the start");
        assert_eq!(
            axes.at(4.0, 0.0),
            axes.inner.right_bottom(),
            "nothing left lies on the floor"
        );
        let whole = Curve {
            color: Color32::WHITE,
            points: vec![[0.0, 1.000_000_1], [2.0, 0.2]],
        };
        assert_eq!(Axes::new(rect, &[whole]).high, 0, "nearly 1 is 1");
        let none = Axes::new(rect, &[]);
        assert!(
            none.high > none.low && none.seconds > 0.0,
            "an empty plot has axes"
        );
    }
}
