//! What irradiance is made of: direct light and reflected light, each with what is known of its error.

use super::estimates::Estimates;
use super::shoot::Arrived;

/// Direct light of the elements.
pub(super) struct DirectLight {
    /// From emitters that nearly touch, `[element][channel]`; empty before the first round.
    pub(super) near: Vec<f32>,
    /// From the others.
    pub(super) far: Estimates,
    /// Factor by channel, which makes it account for all that is emitted.
    pub(super) scale: Vec<f64>,
}

impl DirectLight {
    /// Nothing is known yet.
    pub(super) fn new(elements: usize, channels: usize) -> Self {
        Self {
            near: Vec::new(),
            far: Estimates::new(elements, channels),
            scale: vec![1.0; channels],
        }
    }

    /// Irradiance of an element in a channel.
    pub(super) fn irradiance(&self, element: usize, channel: usize) -> f64 {
        let near = self.near.get(element * self.scale.len() + channel);
        let near = f64::from(near.copied().unwrap_or(0.0));
        // Less than nothing is found where more was expected than there is.
        (self.far.irradiance(element, channel).max(0.0) + near) * self.scale[channel]
    }

    /// Squared standard error of the irradiance summed over channels.
    pub(super) fn square(&self, element: usize) -> f64 {
        self.far.square(element)
    }
}

/// Reflected light of the receivers: by shots, and better by gathering.
pub(super) struct Reflected {
    /// Exposed areas.
    pub(super) areas: Vec<f64>,
    /// By shots, `[channel][receiver]`.
    shot: Vec<f64>,
    /// By gathering; none before the first round.
    pub(super) gathered: Option<Gathered>,
    /// Factor by channel on what was gathered, which makes it account for all that is reflected.
    pub(super) scale: Vec<f64>,
}

/// What was gathered: the two kinds of rays see different light.
pub(super) struct Gathered {
    pub(super) highlights: Estimates,
    pub(super) rest: Estimates,
}

impl Reflected {
    /// Nothing is known yet.
    pub(super) fn new(areas: Vec<f64>, channels: usize) -> Self {
        Self {
            shot: vec![0.0; channels * areas.len()],
            gathered: None,
            scale: vec![1.0; channels],
            areas,
        }
    }

    /// What was gathered, to be added to.
    pub(super) fn gathered(&mut self) -> &mut Gathered {
        let receivers = self.areas.len();
        let nothing = || Estimates::new(receivers, self.scale.len());
        self.gathered.get_or_insert_with(|| Gathered {
            highlights: nothing(),
            rest: nothing(),
        })
    }

    /// Adds what shots brought.
    pub(super) fn add_shots(&mut self, arrived: &Arrived) {
        let received = self.shot.iter_mut().zip(&arrived.received);
        for ((old, new), area) in received.zip(self.areas.iter().cycle()) {
            *old += if *area > 0.0 { new / area } else { 0.0 };
        }
    }

    /// Irradiance of a receiver in a channel.
    pub(super) fn irradiance(&self, receiver: usize, channel: usize) -> f64 {
        let irradiance = match &self.gathered {
            Some(gathered) => gathered.irradiance(receiver, channel),
            None => self.shot[channel * self.areas.len() + receiver],
        };
        irradiance * self.scale[channel]
    }

    /// Squared standard error of the irradiance summed over channels; infinite before the first gathering.
    pub(super) fn square(&self, receiver: usize) -> f64 {
        let of = |gathered: &Gathered| gathered.square(receiver);
        self.gathered.as_ref().map_or(f64::INFINITY, of)
    }
}

impl Gathered {
    fn irradiance(&self, receiver: usize, channel: usize) -> f64 {
        // What was taken for highlights at first may be more than what is there by now.
        let sum =
            self.rest.irradiance(receiver, channel) + self.highlights.irradiance(receiver, channel);
        sum.max(0.0)
    }

    fn square(&self, receiver: usize) -> f64 {
        self.rest.square(receiver) + self.highlights.square(receiver)
    }
}
