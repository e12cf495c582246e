//! Several maps, taken at different places.

use super::EnvironmentMap;
use crate::Rgb;
use glam::Vec3;

/// A box along the axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Corner of the smallest coordinates.
    pub low: Vec3,
    /// Corner of the largest coordinates.
    pub high: Vec3,
}

impl Bounds {
    /// Whether a point lies in it.
    pub fn contains(&self, point: Vec3) -> bool {
        point.cmpge(self.low).all() && point.cmple(self.high).all()
    }

    /// Direction from a place in the box to what a ray from another point of it meets there: box projection (Lagarde and
    /// Zanuttini 2012), exact for bare walls. The ray's own direction for a point outside, and for one that leads nowhere.
    #[inline]
    pub fn projected(&self, place: Vec3, point: Vec3, direction: Vec3) -> Vec3 {
        let wall = self.exit(point, direction);
        wall.map_or(direction, |wall| wall - place)
    }

    /// Where a ray from inside leaves it; `None` for a point outside, and for a direction that leads nowhere.
    pub fn exit(&self, point: Vec3, direction: Vec3) -> Option<Vec3> {
        if !self.contains(point) {
            return None;
        }
        let mut distance = f32::INFINITY;
        for axis in 0..3 {
            let d = direction[axis];
            let wall = if d > 0.0 {
                self.high[axis]
            } else {
                self.low[axis]
            };
            if d != 0.0 {
                distance = distance.min((wall - point[axis]) / d);
            }
        }
        distance.is_finite().then(|| point + distance * direction)
    }
}

/// A map and where it was taken.
#[derive(Debug, Clone, PartialEq)]
pub struct Probe {
    /// Where the eye was.
    pub position: Vec3,
    /// What it saw.
    pub map: EnvironmentMap,
    /// The room around it, if it is one: what it saw are the walls.
    pub room: Option<Bounds>,
}

impl Probe {
    /// What is seen from a point in a direction, as far as this probe knows.
    ///
    /// In its room the ray is followed to the wall and looked up in the direction from the probe to there
    /// ([`Bounds::projected`]). Elsewhere everything is taken to be far away.
    pub fn radiance(&self, point: Vec3, direction: Vec3) -> Rgb {
        let seen = self.room.map_or(direction, |room| {
            room.projected(self.position, point, direction)
        });
        self.map.radiance(seen)
    }
}

/// How an [`EnvironmentSet`] chooses among its maps.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Choice {
    /// The nearest probe's map, as if all were far away: jumps half-way between two.
    Nearest,
    /// All of them, each by the inverse square of its distance (Shepard 1968): no jumps, but ghosts.
    Blend,
    /// As `Blend`, each with its parallax mended by its room ([`Probe::radiance`]).
    #[default]
    BoxProjected,
}

/// Maps of several places, for light that changes from one to the other.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct EnvironmentSet {
    probes: Vec<Probe>,
}

impl EnvironmentSet {
    /// A set of probes; those at positions that are not finite are left out.
    pub fn new(probes: Vec<Probe>) -> Self {
        let probes = probes.into_iter().filter(|p| p.position.is_finite());
        Self {
            probes: probes.collect(),
        }
    }

    /// The probes.
    pub fn probes(&self) -> &[Probe] {
        &self.probes
    }

    /// The probe next to a point; the first of equals, `None` of an empty set.
    pub fn nearest(&self, point: Vec3) -> Option<&Probe> {
        let distance = |probe: &&Probe| probe.position.distance_squared(point);
        self.probes
            .iter()
            .min_by(|a, b| distance(a).total_cmp(&distance(b)))
    }

    /// What is seen from a point in a direction of any length; black in an empty set.
    pub fn radiance(&self, point: Vec3, direction: Vec3, choice: Choice) -> Rgb {
        match choice {
            Choice::Nearest => self
                .nearest(point)
                .map_or(Rgb::BLACK, |probe| probe.map.radiance(direction)),
            Choice::Blend => self.blended(point, |probe| probe.map.radiance(direction)),
            Choice::BoxProjected => self.blended(point, |probe| probe.radiance(point, direction)),
        }
    }

    /// Mean over the probes by the inverse square of their distance; at one of them that one alone. If rooms are given,
    /// only those that the point lies in count.
    fn blended(&self, point: Vec3, light: impl Fn(&Probe) -> Rgb) -> Rgb {
        let is_in = |probe: &Probe| probe.room.is_some_and(|room| room.contains(point));
        let inside = self.probes.iter().any(is_in);
        let (mut sum, mut weights) = (Rgb::BLACK, 0.0);
        for probe in self.probes.iter().filter(|probe| !inside || is_in(probe)) {
            let square = probe.position.distance_squared(point);
            if square < 1e-20 {
                return light(probe);
            }
            sum += light(probe) * square.recip();
            weights += square.recip();
        }
        if weights > 0.0 {
            sum / weights
        } else {
            Rgb::BLACK
        }
    }
}
