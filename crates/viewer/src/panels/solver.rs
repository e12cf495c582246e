//! Solving: where it is, and how it came there.

use crate::desk::Desk;
use crate::format::{number, share, thousands};
use crate::panels::plot::{Curve, plot};
use crate::panels::toolbar::solver_label;
use crate::panels::{fact, row, section};
use crate::session::{LaneView, Moment, Settings, Snapshot};
use crate::theme::LINES;
use egui::{ComboBox, DragValue, RichText, Slider, Ui};
use hemicube_radiosity::patch::MAX_ELEMENTS;
use hemicube_radiosity::{Quality, SolverKind};

/// Smallest edge that is offered first.
const SMALLEST: f32 = 0.1;

pub fn show(ui: &mut Ui, desk: &mut Desk) {
    section(ui, "Solver", true, |ui| {
        settings(ui, desk);
        ui.add_space(4.0);
        lanes(ui, desk);
        ui.add_space(4.0);
        curves(ui, desk);
    });
}

fn settings(ui: &mut Ui, desk: &mut Desk) {
    let mut settings = desk.prefs.settings;
    let before = settings.mesh.is_none().then_some(settings.quality());
    let mut quality = before;
    row(ui, "Mesh", |ui| {
        ComboBox::from_id_salt("quality")
            .selected_text(quality.map_or("as asked", Quality::name))
            .show_ui(ui, |ui| {
                for other in Quality::ALL {
                    ui.selectable_value(&mut quality, Some(other), other.name());
                }
            })
            .response
            .on_hover_text("How fine the mesh is; another one starts anew");
    });
    ui.checkbox(&mut settings.side_by_side, "Four variants side by side")
        .on_hover_text("Gathering, shooting, sorted, sorted + ambient: from the same start, with the same number of steps");
    refinement(ui, &mut settings);
    if let Some(quality) = quality.filter(|_| quality != before) {
        settings = settings.with_quality(quality);
    }
    desk.configure(settings);
}

/// Where the mesh becomes finer once the light is found.
fn refinement(ui: &mut Ui, settings: &mut Settings) {
    let mut is_wanted = settings.refinement.is_some();
    let switch = egui::Checkbox::new(&mut is_wanted, "Refine where light varies");
    ui.add_enabled(!settings.side_by_side, switch)
        .on_hover_text("Once the light is found, elements with more contrast are cut; restart to have the first mesh again");
    let known = settings.refinement.unwrap_or_default();
    settings.refinement = is_wanted.then_some(known);
    let Some(refinement) = &mut settings.refinement else {
        return;
    };
    row(ui, "Contrast", |ui| {
        let contrast = Slider::new(&mut refinement.contrast, 0.02..=0.5).max_decimals(2);
        ui.add(contrast)
            .on_hover_text("Largest difference of light over an element, as a share of the light")
    });
    row(ui, "Smallest", |ui| {
        let mut is_auto = refinement.smallest.is_none();
        ui.checkbox(&mut is_auto, "auto")
            .on_hover_text("Edges down to a sixteenth of the longest one are cut");
        refinement.smallest = (!is_auto).then_some(refinement.smallest.unwrap_or(SMALLEST));
        if let Some(smallest) = &mut refinement.smallest {
            let field = DragValue::new(smallest).range(1e-4..=1e4).speed(0.01);
            ui.add(field)
                .on_hover_text("In units of the scene; shorter edges are not cut");
        }
    });
    row(ui, "At most", |ui| {
        let most = DragValue::new(&mut refinement.most_elements);
        let most = most.range(1..=MAX_ELEMENTS).speed(1000).suffix(" elements");
        ui.add(most)
            .on_hover_text("If more are wanted, those with the largest error are cut")
    });
}

fn lanes(ui: &mut Ui, desk: &Desk) {
    let Some(snapshot) = &desk.snapshot else {
        return;
    };
    let mesh = snapshot.mesh();
    let (elements, patches) = (mesh.elements().len() as f64, mesh.patches().len() as f64);
    fact(
        ui,
        "Elements",
        format!("{} on {} patches", thousands(elements), thousands(patches)),
    );
    for (i, lane) in snapshot.lanes.iter().enumerate() {
        if snapshot.lanes.len() > 1 {
            ui.label(
                RichText::new(solver_label(lane.kind))
                    .color(LINES[i % LINES.len()])
                    .strong(),
            );
        } else {
            fact(ui, "Solver", solver_label(lane.kind));
        }
        fact(ui, "Steps", thousands(lane.progress.iteration as f64));
        fact(ui, "Unshot", share(lane.progress.unshot));
        if let Some(noise) = lane.progress.noise {
            fact(ui, "Noise", share(noise));
        }
        if let Some(error) = lane
            .history
            .moments()
            .last()
            .and_then(|moment| moment.error)
        {
            fact(ui, "Error", share(error));
        }
    }
    let balance = (0..3)
        .map(|band| snapshot.lanes[0].solution.total_balance(band).emitted)
        .sum::<f64>()
        / 3.0;
    fact(ui, "Emitted flux", number(balance));
}

fn curves(ui: &mut Ui, desk: &Desk) {
    let Some(snapshot) = &desk.snapshot else {
        return;
    };
    let lanes = || snapshot.lanes.iter().enumerate();
    let color = |i: usize| LINES[i % LINES.len()];
    let unshot: Vec<Curve> = lanes()
        .map(|(i, lane)| Curve {
            color: color(i),
            points: lane
                .history
                .moments()
                .iter()
                .map(|m| [m.seconds, m.unshot])
                .collect(),
        })
        .collect();
    ui.label(RichText::new("Unshot share over seconds").small().weak());
    plot(ui, "unshot", 110.0, &unshot);
    errors(ui, snapshot);
}

/// The error where it is known, else what can be said of it.
fn errors(ui: &mut Ui, snapshot: &Snapshot) {
    let curves = |of: fn(&Moment) -> Option<f64>| -> Vec<Curve> {
        let curve = |(i, lane): (usize, &LaneView)| Curve {
            color: LINES[i % LINES.len()],
            points: lane
                .history
                .moments()
                .iter()
                .filter_map(|moment| Some([moment.seconds, of(moment)?]))
                .collect(),
        };
        snapshot.lanes.iter().enumerate().map(curve).collect()
    };
    // Two points of one moment, as a mesh that was refined leaves them, make no curve.
    let is_long = |curve: &Curve| match curve.points[..] {
        [[first, _], .., [last, _]] => last > first,
        _ => false,
    };
    let is_there = |curves: &[Curve]| curves.iter().any(is_long);
    let known = curves(|moment| moment.error);
    let estimates = curves(|moment| moment.estimate);
    let is_by_rays = snapshot.lanes[0].kind == SolverKind::Stochastic;
    let (name, shown, hint) = if is_there(&known) {
        (
            "Error against the finished light",
            known,
            "Root mean square of radiosity by area, relative",
        )
    } else if is_there(&estimates) && is_by_rays {
        (
            "Noise of the rays",
            estimates,
            "Relative standard error of irradiance, root mean square over the elements",
        )
    } else if is_there(&estimates) {
        (
            "Light still to come, as the ambient estimate says",
            estimates,
            "Share of the mean irradiance; the error itself is known once the light is found: restart then",
        )
    } else {
        let why =
            "The error is known once the light is found: restart then, or choose another way.";
        ui.label(RichText::new(why).small().weak());
        return;
    };
    ui.label(RichText::new(name).small().weak())
        .on_hover_text(hint);
    plot(ui, "error", 110.0, &shown);
}
