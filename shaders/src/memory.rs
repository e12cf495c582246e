//! Bytes that a scene takes on a device, without one.
//!
//! What drivers add for themselves is left out; buffers and pictures are counted as they are asked for.

use crate::hemicube as h;
use crate::shooting as s;

/// Most steps of a solver on the device that are under way at a time; each is read from a buffer of its own.
pub const STEPS_UNDER_WAY: usize = 2;

/// Bytes that the device's clock adds to a step: two readings.
pub const CLOCK_BYTES: u64 = 16;

/// Distance of two sets of parameters that are chosen by dynamic offsets: the most that an adapter may ask for.
pub const STRIDE: u32 = 256;
/// Bytes of the arguments of an indexed draw call.
pub const DRAW_BYTES: u64 = 20;

/// What decides how much memory a scene takes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SceneSize {
    /// Elements.
    pub elements: u64,
    /// Elements, and cells of faces that only block.
    pub receivers: u64,
    /// Vertices of the mesh.
    pub vertices: u64,
    /// Indices that draw a receiver: 6, or 3 where all are triangles.
    pub indices: u64,
    /// Layers that are drawn where panes let light through, else 1.
    pub layers: u64,
    /// Cells along an edge of the top face.
    pub resolution: u64,
}

/// What shooting adds.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct ShootingSize {
    /// Patches.
    pub patches: u64,
    /// Hemicubes of all patches.
    pub hemicubes: u64,
    /// Groups of luminaires times bands.
    pub channels: u64,
}

/// Bytes of one hemicube, by what is bound at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct HemicubeSize {
    /// Vertices in its frame.
    pub placed: u64,
    /// What receivers may be seen as.
    pub masks: u64,
    /// Where groups of receivers begin in lists.
    pub starts: u64,
    /// Lists of receivers by face.
    pub lists: u64,
    /// Sums by element.
    pub sums: u64,
    /// What waits behind panes.
    pub through: u64,
    /// Items and, where panes let light through, depths of its cells.
    pub pictures: u64,
}

fn bytes_of<T>() -> u64 {
    size_of::<T>() as u64
}

/// What a buffer takes at least: empty ones cannot be bound.
fn buffer(bytes: u64) -> u64 {
    bytes.max(16).next_multiple_of(4)
}

impl SceneSize {
    /// Sums of each hemicube: one for each band where panes let light through.
    pub fn bands(&self) -> u64 {
        if self.layers > 1 { 3 } else { 1 }
    }

    /// Groups of 64 receivers.
    pub fn groups(&self) -> u64 {
        self.receivers.div_ceil(64)
    }

    /// Cells of all faces.
    pub fn cells(&self) -> u64 {
        3 * self.resolution * self.resolution
    }

    /// Bytes of the geometry.
    pub fn geometry(&self) -> u64 {
        let half = self.resolution / 2;
        let of_receiver = 16 + bytes_of::<h::Receiver>() + 4 * self.indices;
        let panes = if self.layers > 1 {
            16 * self.elements
        } else {
            16
        };
        let deltas = 4 * 2 * half * (half + 1);
        bytes_of::<h::HemicubeParams>()
            + 16 * self.vertices
            + of_receiver * self.receivers
            + deltas
            + panes
    }

    /// Bytes of one hemicube.
    pub fn hemicube(&self) -> HemicubeSize {
        let (faces, masks) = (u64::from(h::FACES), u64::from(h::MASKS));
        let cells = self.cells();
        let is_layered = self.layers > 1;
        HemicubeSize {
            placed: 16 * self.vertices,
            masks: masks * 8 * self.groups(),
            starts: faces * 4 * self.groups(),
            lists: faces * 4 * self.receivers,
            sums: self.bands() * 4 * (self.elements + 2),
            through: if is_layered { 16 * cells } else { 0 },
            pictures: if is_layered { 8 } else { 4 } * cells,
        }
    }

    /// Bytes of so many hemicubes that are drawn in one submission.
    pub fn batch(&self, hemicubes: u64) -> u64 {
        let one = self.hemicube();
        let faces = u64::from(h::FACES);
        let each = [
            bytes_of::<h::Viewpoint>(),
            one.placed,
            one.masks,
            4,
            one.starts,
            one.lists,
            faces * DRAW_BYTES,
            one.sums,
            // Where the CPU reads them.
            one.sums,
            faces * u64::from(STRIDE),
        ];
        let buffers: u64 = each.iter().map(|bytes| buffer(hemicubes * bytes)).sum();
        let (depth, panes) = if self.layers > 1 {
            let waits = hemicubes * 4 * u64::from(h::MAX_LAYERS);
            let through = buffer(hemicubes * one.through);
            (0, through + buffer(waits) + self.layers * u64::from(STRIDE))
        } else {
            // One for all.
            (4 * self.cells(), 0)
        };
        buffers + hemicubes * one.pictures + depth + panes
    }

    /// Bytes of solving on the device: geometry, one hemicube, and the light.
    pub fn shooting(&self, shooting: &ShootingSize) -> u64 {
        let ShootingSize {
            patches,
            hemicubes,
            channels,
        } = *shooting;
        let words = u64::from(s::CHANNEL_WORDS);
        let light = 4 * channels * (2 * self.elements + words);
        let of_step = 4 * channels * (words + u64::from(s::MOST_WATCHED));
        let buffers = [
            bytes_of::<s::ShootingParams>(),
            bytes_of::<s::ElementLight>() * self.elements,
            bytes_of::<s::ShootingPatch>() * patches,
            bytes_of::<s::ShotView>() * hemicubes,
            // State and light are read by the CPU.
            bytes_of::<s::ShotState>(),
            4 * patches,
            light,
            light,
        ];
        let to_read = bytes_of::<s::ShotState>() + of_step + CLOCK_BYTES;
        let own: u64 = buffers.into_iter().map(buffer).sum();
        self.geometry() + self.batch(1) + own + STEPS_UNDER_WAY as u64 * buffer(to_read)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 512 cells along an edge, a tenth as many patches as elements with four hemicubes each, one group of luminaires.
    #[test]
    fn a_million_elements_take_less_than_a_gibibyte() {
        let n = 1_000_000;
        let scene = SceneSize {
            elements: n,
            receivers: n,
            vertices: n,
            indices: 6,
            layers: 1,
            resolution: 512,
        };
        let shooting = ShootingSize {
            patches: n / 10,
            hemicubes: 4 * n / 10,
            channels: 3,
        };
        let bytes = scene.shooting(&shooting);
        assert!((200 << 20..300 << 20).contains(&bytes), "{bytes}");
        let glass = SceneSize { layers: 8, ..scene };
        let bytes = glass.shooting(&shooting);
        assert!(bytes < 1 << 30, "{bytes} with panes");
    }

    /// The largest mesh that there may be (4,000,000 elements) fits bindings of 128 MiB, the least that WebGPU promises.
    #[test]
    fn no_binding_of_the_largest_mesh_is_larger_than_promised() {
        let n = 4_000_000;
        let scene = SceneSize {
            elements: n,
            receivers: n,
            vertices: n,
            indices: 6,
            layers: 1,
            resolution: 4096,
        };
        let one = scene.hemicube();
        let light = 4 * 3 * 2 * n;
        for bytes in [
            one.placed,
            one.lists,
            one.sums,
            light,
            bytes_of::<h::Receiver>() * n,
            bytes_of::<s::ElementLight>() * n,
        ] {
            assert!(bytes <= 128 << 20, "{bytes}");
        }
    }
}
