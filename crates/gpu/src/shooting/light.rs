//! Light that stays on a device.

use crate::context::Context;
use crate::error::GpuError;
use core::fmt;
use std::sync::Arc;
use wgpu::Buffer;

/// Light that a solver keeps on a device: `[group][band][element]` irradiance.
///
/// It is the solver's own buffer, not a copy: pictures that are drawn between two of its steps show what it has found so
/// far. It stays as it is when the solver has ended.
#[derive(Clone)]
pub struct DeviceLight {
    context: Arc<Context>,
    buffer: Buffer,
    elements: usize,
    groups: usize,
}

impl fmt::Debug for DeviceLight {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("DeviceLight")
            .field("context", &self.context)
            .field("elements", &self.elements)
            .field("groups", &self.groups)
            .finish_non_exhaustive()
    }
}

impl DeviceLight {
    pub(super) fn new(
        context: Arc<Context>,
        buffer: Buffer,
        elements: usize,
        groups: usize,
    ) -> Self {
        Self {
            context,
            buffer,
            elements,
            groups,
        }
    }

    /// Elements, and groups of luminaires.
    pub fn size(&self) -> [usize; 2] {
        [self.elements, self.groups]
    }

    /// Whether it is in the memory of that device, so that pictures there can be made of it.
    pub fn is_on(&self, context: &Arc<Context>) -> bool {
        Arc::ptr_eq(&self.context, context)
    }

    /// The buffer, for a device.
    ///
    /// # Errors
    /// It is on another one.
    pub(crate) fn buffer_on(&self, context: &Arc<Context>) -> Result<&Buffer, GpuError> {
        if self.is_on(context) {
            return Ok(&self.buffer);
        }
        Err(GpuError::Option(format!(
            "light on {} for a picture on {} by another context; make both with one context",
            self.context.name, context.name
        )))
    }
}

/// Fluxes of a channel, in lm or W: what the sums over all elements are, without the elements.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ChannelFlux {
    /// That elements have received: `Σ A H`.
    pub received: f64,
    /// Signed, that is still to be shot; with that of the patch that shoots.
    pub unshot: f64,
    /// That sides which only absorb have absorbed since light came to the CPU.
    pub backs: f64,
    /// That has left the scene since light came to the CPU.
    pub escaped: f64,
}

impl ChannelFlux {
    /// Of a channel's words, as `shooting.wgsl` keeps them; sums without what they have lost to rounding.
    pub(super) fn of_words(words: &[f32]) -> Self {
        let number = |at: usize| f64::from(words[at]);
        Self {
            backs: number(1) - number(2),
            escaped: number(3) - number(4),
            received: number(5),
            unshot: number(6),
        }
    }
}
