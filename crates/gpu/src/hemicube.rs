//! Form factors by hemicubes on the GPU: twin of `radiosity/src/form_factor/hemicube.rs`.
//!
//! ```text
//! for each batch of hemicubes, one submission:
//!     place:    vertices into their frames               compute, vertices × hemicubes
//!     classify: what each receiver may be seen as        compute, receivers × hemicubes
//!     arrange:  lists of what each face shows            compute, receivers × hemicubes
//!     draw:     item buffers, five faces in a picture     one render pass a hemicube
//!     sum:      delta form factors by item               compute, segments of rows × hemicubes
//!     read one number for each element and hemicube
//! ```
//!
//! Where panes let light through, draw and sum are done for each layer (depth peeling), by band.
//!
//! Where hemicubes stand, how many a patch gets and what is done about receivers of few cells is decided by the CPU's
//! [`Hemicube`], whose row this is but for who draws it. Delta form factors are rounded to multiples of 2⁻³¹, so that sums
//! are exact and every run gives the same bits.

mod batch;
mod counts;
mod geometry;
mod pass;

pub(crate) use self::batch::Batch;
use self::counts::Probe;
pub use self::counts::{DrawCounts, ShotCounts, StageSeconds};
pub(crate) use self::geometry::{Geometry, count};
use self::pass::places;
pub(crate) use self::pass::{HemicubePass, compute_pass};
use crate::backend::Report;
use crate::context::Context;
use crate::error::GpuError;
use bytemuck::Zeroable;
use core::fmt;
use hemicube_radiosity::form_factor::hemicube::{
    Hemicube, HemicubeOptions, ItemBuffers, Projection, Sums, Viewpoint,
};
use hemicube_radiosity::form_factor::{FormFactors, Row};
use hemicube_radiosity::patch::{NodeId, PatchMesh};
use hemicube_shaders::hemicube as twins;
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use wgpu::CommandEncoder;

/// Most hemicubes of a submission.
const MOST_VIEWS: u64 = 16;

/// Form factors by hemicubes on the GPU.
///
/// When the device is lost or its memory runs out, rows go on with the CPU's hemicubes; [`GpuHemicube::failure`] says so.
pub struct GpuHemicube {
    context: Arc<Context>,
    cpu: Hemicube,
    pass: HemicubePass,
    geometry: Geometry,
    batch: Mutex<Batch>,
    failure: OnceLock<GpuError>,
    report: Option<Report>,
}

impl fmt::Debug for GpuHemicube {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("GpuHemicube")
            .field("context", &self.context)
            .field("failure", &self.failure)
            .finish_non_exhaustive()
    }
}

impl GpuHemicube {
    /// Factors between the nodes of a mesh.
    ///
    /// # Errors
    /// Options out of their range, another projection than the hemicube, a mesh or a resolution that does not fit the
    /// adapter's limits or its memory.
    pub fn new(
        context: Arc<Context>,
        mesh: Arc<PatchMesh>,
        options: HemicubeOptions,
    ) -> Result<Self, GpuError> {
        if options.projection != Projection::Hemicube {
            return Err(GpuError::Option(String::from(
                "the GPU draws hemicubes only; use the CPU for other projections",
            )));
        }
        let cpu = Hemicube::new(mesh, options).map_err(|e| GpuError::Option(e.to_string()))?;
        let (geometry, pass, batch) = context.guard(|| {
            let geometry = Geometry::new(&context, &cpu)?;
            let pass = HemicubePass::new(&context, geometry.layers > 1);
            let batch = Batch::new(&context, &pass, &geometry, MOST_VIEWS)?;
            Ok((geometry, pass, batch))
        })?;
        Ok(Self {
            batch: Mutex::new(batch),
            failure: OnceLock::new(),
            report: None,
            context,
            cpu,
            pass,
            geometry,
        })
    }

    /// `report` hears why rows come from the CPU.
    pub(crate) fn with_report(self, report: Report) -> Self {
        Self {
            report: Some(report),
            ..self
        }
    }

    /// Why rows come from the CPU since then, if they do.
    pub fn failure(&self) -> Option<&GpuError> {
        self.failure.get()
    }

    fn batch(&self) -> MutexGuard<'_, Batch> {
        self.batch.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Hemicubes of one submission.
    pub fn batch_size(&self) -> usize {
        self.batch().views
    }

    /// Bytes on the device.
    pub fn bytes(&self) -> u64 {
        self.geometry.bytes() + self.batch().bytes()
    }

    /// Number of hemicubes over which the row of a node is averaged.
    pub fn points(&self, source: NodeId) -> usize {
        self.cpu.points(source)
    }

    /// The item buffers of a node's first hemicube, as [`Hemicube::item_buffers`] gives them.
    ///
    /// # Errors
    /// The device was lost or its memory ran out.
    pub fn item_buffers(&self, source: NodeId) -> Result<ItemBuffers, GpuError> {
        let batch = self.batch();
        let views = &self.cpu.viewpoints(source)[..1];
        self.begin(&batch, views);
        let mut encoder = self.encoder();
        self.pass
            .encode_first_layer(&mut encoder, &self.geometry, &batch);
        self.context.queue.submit([encoder.finish()]);
        let picture = batch.read_picture(&self.context)?;
        let resolution = self.cpu.options().resolution;
        let public = |item: u32| match item {
            twins::ITEM_EMPTY => ItemBuffers::NOTHING,
            back if back & 1 == 1 => ItemBuffers::ABSORBED,
            front => front >> 1,
        };
        let face = |[left, top, width, height]: [u32; 4]| {
            let rows = top..top + height;
            rows.flat_map(|y| {
                let first = (y * 2 * resolution + left) as usize;
                picture[first..first + width as usize].iter()
            })
            .map(|&item| public(item))
            .collect()
        };
        Ok(ItemBuffers {
            resolution: resolution as usize,
            faces: places(resolution).into_iter().map(face).collect(),
        })
    }

    /// Draws the hemicubes of some nodes for nothing but to know what it costs; stages are measured one submission after
    /// the other, so seconds are those of an otherwise idle device.
    ///
    /// # Errors
    /// The device was lost or its memory ran out.
    pub fn shot_counts(&self, sources: &[NodeId]) -> Result<ShotCounts, GpuError> {
        let batch = self.batch();
        let views: Vec<Viewpoint> = sources
            .iter()
            .flat_map(|&source| self.cpu.viewpoints(source))
            .collect();
        let mut counts = ShotCounts::default();
        for views in views.chunks(batch.views) {
            let n = count(views.len());
            let probe = Probe::new(&self.context, n * self.geometry.layers);
            self.begin(&batch, views);
            let mut encoder = self.encoder();
            self.pass
                .encode(&mut encoder, &self.geometry, &batch, n, Some(&probe));
            probe.resolve(&mut encoder);
            let submission = self.context.queue.submit([encoder.finish()]);
            counts.add(&probe, &self.context, submission)?;
            counts.hemicubes += u64::from(n);
            counts.bytes += u64::from(n) * counts::bytes(&self.geometry);
            counts.read_back += batch.sum_bytes(views.len());
        }
        Ok(counts)
    }

    /// What some hemicubes see.
    fn sums(&self, views: &[Viewpoint]) -> Result<Vec<Sums>, GpuError> {
        self.context.check()?;
        let batch = self.batch();
        let mut sums = Vec::with_capacity(views.len());
        for views in views.chunks(batch.views) {
            self.begin(&batch, views);
            let mut encoder = self.encoder();
            let n = count(views.len());
            self.pass
                .encode(&mut encoder, &self.geometry, &batch, n, None);
            batch.copy_sums(&mut encoder, views.len());
            let submission = self.context.queue.submit([encoder.finish()]);
            sums.extend(batch.read_sums(&self.context, views.len(), submission)?);
        }
        Ok(sums)
    }

    /// Brings viewpoints to the device.
    fn begin(&self, batch: &Batch, views: &[Viewpoint]) {
        let mesh = self.cpu.mesh();
        let twins: Vec<twins::Viewpoint> = views.iter().map(|view| viewpoint(mesh, view)).collect();
        let bytes = bytemuck::cast_slice(&twins);
        self.context.queue.write_buffer(&batch.viewpoints, 0, bytes);
    }

    fn encoder(&self) -> CommandEncoder {
        let descriptor = wgpu::CommandEncoderDescriptor {
            label: Some("hemicubes"),
        };
        self.context.device.create_command_encoder(&descriptor)
    }

    /// Remembers what went wrong and says so once.
    fn fail(&self, failure: GpuError) {
        // Another thread may have been first; either reason is true.
        if let (Ok(()), Some(report)) = (self.failure.set(failure.clone()), &self.report) {
            report(&failure);
        }
    }
}

impl FormFactors for GpuHemicube {
    fn mesh(&self) -> &Arc<PatchMesh> {
        self.cpu.mesh()
    }

    fn fill_row(&self, source: NodeId, row: &mut Row) {
        self.fill_rows(&[source], core::slice::from_mut(row));
    }

    fn rows_at_once(&self) -> usize {
        // One hemicube a row, if all is far.
        self.batch_size()
    }

    fn fill_rows(&self, sources: &[NodeId], rows: &mut [Row]) {
        if self.failure.get().is_some() {
            return self.cpu.fill_rows(sources, rows);
        }
        let views: Vec<Vec<Viewpoint>> = sources.iter().map(|&s| self.cpu.viewpoints(s)).collect();
        let sums = match self.sums(&views.concat()) {
            Ok(sums) => sums,
            Err(failure) => {
                self.fail(failure);
                return self.cpu.fill_rows(sources, rows);
            }
        };
        let mut rest = &sums[..];
        for ((&source, row), views) in sources.iter().zip(rows).zip(&views) {
            let (sums, others) = rest.split_at(views.len());
            self.cpu.row_of_sums(source, views, sums, row);
            rest = others;
        }
    }
}

/// A viewpoint as the shaders know it.
fn viewpoint(mesh: &PatchMesh, view: &Viewpoint) -> twins::Viewpoint {
    let [tangent, bitangent, normal] = view.axes.map(|axis| axis.to_array());
    twins::Viewpoint {
        origin: view.origin.to_array(),
        least_near: mesh.visibility().offset(view.origin),
        tangent,
        farthest: mesh.visibility().diameter(),
        bitangent,
        normal,
        ..twins::Viewpoint::zeroed()
    }
}
