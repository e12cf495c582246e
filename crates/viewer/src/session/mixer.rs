//! Luminaires as a lighting desk sees them: levels and tints of groups, and scenes to come back to.
//!
//! Light is linear and every source is solved on its own, so all of this is a weighted sum: nothing is solved again.

use hemicube_raster::Rgb;
use serde::{Deserialize, Serialize};

/// A source: what emits with one material, or all lights without an area and the sky.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MixSource {
    /// Name of the light group of the solution.
    pub name: String,
    /// Position of the group that it is dimmed with.
    pub group: usize,
    /// Factor on its light; 1 as solved.
    pub level: f32,
}

/// Sources that are dimmed and tinted together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MixGroup {
    /// Its name.
    pub name: String,
    /// Factor on the light of its sources; 1 as solved.
    pub level: f32,
    /// Colour that multiplies it; white as solved.
    pub tint: Rgb,
}

/// A lighting that is kept by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mix {
    /// Its name: day, evening.
    pub name: String,
    sources: Vec<MixSource>,
    groups: Vec<MixGroup>,
}

/// All levels and tints as they are set, and the scenes that are kept.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Mixer {
    /// One for each light group of the solution, in its order.
    pub sources: Vec<MixSource>,
    /// Groups of them; never empty where there are sources.
    pub groups: Vec<MixGroup>,
    /// Kept lightings.
    pub scenes: Vec<Mix>,
}

/// Parts of names that tell light from outside.
const DAYLIGHT: [&str; 5] = ["daylight", "sky", "sun", "window", "outdoor"];

fn is_daylight(name: &str) -> bool {
    let name = name.to_lowercase();
    DAYLIGHT.iter().any(|part| name.contains(part))
}

impl MixGroup {
    fn new(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            level: 1.0,
            tint: Rgb::WHITE,
        }
    }
}

impl Mixer {
    /// Sources of those names, as solved: in a group for daylight and one for lamps. Three scenes are there to start
    /// from: day (no lamps), evening (no daylight, lamps at 60 %) and cleaning (everything).
    pub fn new<'a>(names: impl IntoIterator<Item = &'a str>) -> Self {
        let source = |name: &str| MixSource {
            name: name.to_owned(),
            group: usize::from(!is_daylight(name)),
            level: 1.0,
        };
        let mut mixer = Self {
            sources: names.into_iter().map(source).collect(),
            groups: vec![MixGroup::new("Daylight"), MixGroup::new("Lamps")],
            scenes: Vec::new(),
        };
        for (name, daylight, lamps) in [
            ("Day", 1.0, 0.0),
            ("Evening", 0.0, 0.6),
            ("Cleaning", 1.0, 1.0),
        ] {
            (mixer.groups[0].level, mixer.groups[1].level) = (daylight, lamps);
            mixer.keep(name);
        }
        mixer.reset();
        mixer
    }

    /// Follows a solution whose light groups may be others than before; those that stay keep their levels.
    pub fn follow<'a>(&mut self, names: impl ExactSizeIterator<Item = &'a str> + Clone) {
        let same = names.len() == self.sources.len()
            && names
                .clone()
                .zip(&self.sources)
                .all(|(name, source)| name == source.name);
        if same {
            return;
        }
        let fresh = Self::new(names);
        let shared = fresh
            .sources
            .iter()
            .any(|new| self.source(&new.name).is_some());
        if !shared || self.groups.is_empty() {
            *self = fresh;
            return;
        }
        let last = self.groups.len() - 1;
        let old = |new: MixSource| self.source(&new.name).cloned().unwrap_or(new);
        let clamp = |source: MixSource| MixSource {
            group: source.group.min(last),
            ..source
        };
        self.sources = fresh.sources.into_iter().map(old).map(clamp).collect();
    }

    fn source(&self, name: &str) -> Option<&MixSource> {
        self.sources.iter().find(|source| source.name == name)
    }

    /// Everything as solved.
    pub fn reset(&mut self) {
        self.sources
            .iter_mut()
            .for_each(|source| source.level = 1.0);
        for group in &mut self.groups {
            (group.level, group.tint) = (1.0, Rgb::WHITE);
        }
    }

    /// Factors on the light of each source.
    pub fn dims(&self) -> Vec<Rgb> {
        dims(&self.sources, &self.groups)
    }

    /// Factors of a kept lighting, in the order of the sources; a source that it does not know is as solved.
    pub fn dims_of(&self, scene: &Mix) -> Vec<Rgb> {
        let kept = dims(&scene.sources, &scene.groups);
        let of = |source: &MixSource| {
            let at = scene
                .sources
                .iter()
                .position(|kept| kept.name == source.name);
            at.map_or(Rgb::WHITE, |at| kept[at])
        };
        self.sources.iter().map(of).collect()
    }

    /// Keeps the lighting by a name; one of that name is replaced.
    pub fn keep(&mut self, name: &str) {
        let mix = Mix {
            name: name.to_owned(),
            sources: self.sources.clone(),
            groups: self.groups.clone(),
        };
        match self.scenes.iter_mut().find(|scene| scene.name == name) {
            Some(scene) => *scene = mix,
            None => self.scenes.push(mix),
        }
    }

    /// Goes back to a kept lighting. Sources that it does not know stay as they are.
    pub fn recall(&mut self, scene: usize) {
        let Some(scene) = self.scenes.get(scene).cloned() else {
            return;
        };
        if !scene.groups.is_empty() {
            self.groups = scene.groups;
        }
        let last = self.groups.len().saturating_sub(1);
        for source in &mut self.sources {
            if let Some(kept) = scene.sources.iter().find(|kept| kept.name == source.name) {
                source.clone_from(kept);
            }
            source.group = source.group.min(last);
        }
    }

    /// Another group, empty so far; its position.
    pub fn add_group(&mut self, name: &str) -> usize {
        self.groups.push(MixGroup::new(name));
        self.groups.len() - 1
    }

    /// Removes a group; its sources go to the first of the others. The last one stays.
    pub fn remove_group(&mut self, group: usize) {
        if self.groups.len() < 2 || group >= self.groups.len() {
            return;
        }
        self.groups.remove(group);
        for source in &mut self.sources {
            source.group = match source.group {
                of if of == group => 0,
                of if of > group => of - 1,
                of => of,
            };
        }
    }
}

fn dims(sources: &[MixSource], groups: &[MixGroup]) -> Vec<Rgb> {
    let of = |source: &MixSource| match groups.get(source.group) {
        Some(group) => group.tint * (group.level * source.level),
        None => Rgb::splat(source.level),
    };
    sources.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn office() -> Mixer {
        Mixer::new(["daylight", "panel", "cove", "lights and sky"])
    }

    #[test]
    fn levels_and_tints_multiply() {
        let mut mixer = office();
        mixer.groups[1].level = 0.5;
        mixer.groups[1].tint = Rgb::new(1.0, 0.8, 0.6);
        mixer.sources[2].level = 0.25;
        let dims = mixer.dims();
        assert_eq!(dims[0], Rgb::WHITE, "daylight is in the other group");
        assert_eq!(dims[1], Rgb::new(0.5, 0.4, 0.3), "0.5 of the tint");
        assert_eq!(dims[2], Rgb::new(0.125, 0.1, 0.075), "a quarter of that");
    }

    #[test]
    fn scenes_come_back_as_they_were_kept() {
        let mut mixer = office();
        mixer.recall(0);
        assert_eq!(mixer.dims()[1], Rgb::BLACK, "no lamps by day");
        assert_eq!(mixer.dims()[0], Rgb::WHITE, "daylight by day");
        mixer.sources[1].level = 0.3;
        mixer.keep("Mine");
        mixer.recall(2);
        assert_eq!(mixer.dims(), [Rgb::WHITE; 4], "cleaning has everything");
        mixer.recall(3);
        assert_eq!(mixer.sources[1].level, 0.3, "as kept");
        let kept = mixer.scenes[1].clone();
        assert_eq!(
            mixer.dims_of(&kept)[1],
            Rgb::splat(0.6),
            "the evening's lamps"
        );
        mixer.recall(99);
        assert_eq!(mixer.sources[1].level, 0.3, "there is no such scene");
    }

    #[test]
    fn a_new_source_leaves_the_levels_of_the_others() {
        let mut mixer = office();
        mixer.sources[1].level = 0.3;
        mixer.follow(["daylight", "panel", "cove", "green wall", "lights and sky"].into_iter());
        let levels: Vec<f32> = mixer.sources.iter().map(|s| s.level).collect();
        assert_eq!(levels, [1.0, 0.3, 1.0, 1.0, 1.0], "the panel's stays");
        mixer.follow(["other", "room"].into_iter());
        assert_eq!(mixer.sources.len(), 2, "another scene starts as solved");
        assert_eq!(
            mixer.dims(),
            [Rgb::WHITE; 2],
            "another scene starts as solved"
        );
    }

    #[test]
    fn a_removed_group_hands_on_its_sources() {
        let mut mixer = office();
        let desk = mixer.add_group("Desk");
        mixer.sources[2].group = desk;
        mixer.remove_group(1);
        let groups: Vec<usize> = mixer.sources.iter().map(|s| s.group).collect();
        assert_eq!(groups, [0, 0, 1, 0], "of three groups two are left");
        mixer.remove_group(1);
        mixer.remove_group(0);
        assert_eq!(mixer.groups.len(), 1, "one stays");
        assert!(mixer.sources.iter().all(|s| s.group == 0), "all in it");
    }
}
