//! What hemicubes cost the device, by its own counters where it has them.

use super::geometry::Geometry;
use crate::buffer::{empty, read};
use crate::context::Context;
use crate::error::GpuError;
use wgpu::{
    Buffer, BufferUsages, CommandEncoder, ComputePassTimestampWrites, Features,
    PipelineStatisticsTypes, QuerySet, QueryType, RenderPass, RenderPassTimestampWrites,
    SubmissionIndex,
};

/// What some hemicubes cost the device.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct ShotCounts {
    /// Hemicubes drawn.
    pub hemicubes: u64,
    /// Submissions to the queue.
    pub submissions: u64,
    /// Of the draw calls; none where the adapter does not count.
    pub drawing: Option<DrawCounts>,
    /// Seconds of the device; none where the adapter has no clock.
    pub seconds: Option<StageSeconds>,
    /// Bytes that stages read and write in the device's memory if its caches keep what a stage reads twice and nothing
    /// from stage to stage; without drawing, see [`DrawCounts::bytes`].
    pub bytes: u64,
    /// Bytes that come back to the CPU.
    pub read_back: u64,
}

impl ShotCounts {
    /// Adds what the counters of a submission say.
    pub(super) fn add(
        &mut self,
        probe: &Probe,
        context: &Context,
        submission: SubmissionIndex,
    ) -> Result<(), GpuError> {
        let (drawing, seconds) = probe.read(context, submission)?;
        self.submissions += 1;
        if let Some(more) = drawing {
            let sum = self.drawing.get_or_insert_default();
            sum.vertices += more.vertices;
            sum.triangles += more.triangles;
            sum.visible_triangles += more.visible_triangles;
            sum.fragments += more.fragments;
        }
        if let Some(more) = seconds {
            let sum = self.seconds.get_or_insert_default();
            sum.arrange += more.arrange;
            sum.draw += more.draw;
            sum.sum += more.sum;
        }
        Ok(())
    }
}

/// What draw calls did.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct DrawCounts {
    /// Runs of the vertex shader.
    pub vertices: u64,
    /// Triangles before clipping.
    pub triangles: u64,
    /// Triangles that are at least partly in the picture.
    pub visible_triangles: u64,
    /// Runs of the fragment shader.
    pub fragments: u64,
}

impl DrawCounts {
    /// Bytes of depth and items: each fragment reads a depth, and writes both.
    pub fn bytes(&self) -> u64 {
        12 * self.fragments
    }
}

/// Seconds by stage.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct StageSeconds {
    /// Vertices into frames, and lists of what each face shows.
    pub arrange: f64,
    /// Item buffers; of several layers, with what is done between them.
    pub draw: f64,
    /// Delta form factors by item.
    pub sum: f64,
}

/// Bytes of one hemicube but for fragments, as [`ShotCounts::bytes`] states them.
pub(super) fn bytes(geometry: &Geometry) -> u64 {
    let params = &geometry.params;
    let [receivers, vertices, elements] =
        [params.receivers, params.vertices, params.elements].map(u64::from);
    // A vertex is read, and written in the frame; a receiver and its corners are read; masks and lists are written.
    let arrange = 32 * vertices + (48 + 1 + 4) * receivers;
    // Lists, corners and placed vertices are read again.
    let draw = (4 + 16) * receivers + 16 * vertices;
    // Depth and items are cleared, items are read; sums are cleared and written.
    let cells = 12 * geometry.size.cells();
    arrange + draw + cells + 8 * (elements + 2)
}

/// Counters of one submission.
#[derive(Debug)]
pub(crate) struct Probe {
    /// Beginning and end of each stage.
    times: Option<QuerySet>,
    /// Of each draw pass.
    statistics: Option<QuerySet>,
    draws: u32,
    /// Nanoseconds of a tick.
    period: f64,
    resolved: Buffer,
    read: Buffer,
}

/// Ticks of a submission: two for each of three stages.
const TIMES: u32 = 6;
/// Where statistics begin behind the times, in bytes: a multiple of `wgpu::QUERY_RESOLVE_BUFFER_ALIGNMENT`.
const STATISTICS: usize = 256;
/// Numbers of each draw pass.
const NUMBERS: usize = 4;

impl Probe {
    /// Counters for so many draw passes.
    pub(super) fn new(context: &Context, draws: u32) -> Self {
        let features = context.device.features();
        let queries = |feature, kind, count| {
            features.contains(feature).then(|| {
                context.device.create_query_set(&wgpu::QuerySetDescriptor {
                    label: Some("hemicubes"),
                    ty: kind,
                    count,
                })
            })
        };
        let counted =
            PipelineStatisticsTypes::all() - PipelineStatisticsTypes::COMPUTE_SHADER_INVOCATIONS;
        let bytes = STATISTICS as u64 + u64::from(draws) * 8 * NUMBERS as u64;
        Self {
            times: queries(Features::TIMESTAMP_QUERY, QueryType::Timestamp, TIMES),
            statistics: queries(
                Features::PIPELINE_STATISTICS_QUERY,
                QueryType::PipelineStatistics(counted),
                draws,
            ),
            draws,
            period: f64::from(context.queue.get_timestamp_period()),
            resolved: empty(
                &context.device,
                "counters",
                bytes,
                BufferUsages::QUERY_RESOLVE | BufferUsages::COPY_SRC,
            ),
            read: empty(
                &context.device,
                "counters to read",
                bytes,
                BufferUsages::MAP_READ | BufferUsages::COPY_DST,
            ),
        }
    }

    fn of_compute(&self, first: u32) -> Option<ComputePassTimestampWrites<'_>> {
        Some(ComputePassTimestampWrites {
            query_set: self.times.as_ref()?,
            beginning_of_pass_write_index: Some(first),
            end_of_pass_write_index: Some(first + 1),
        })
    }

    pub(super) fn of_arranging(&self) -> Option<ComputePassTimestampWrites<'_>> {
        self.of_compute(0)
    }

    pub(super) fn of_summing(&self) -> Option<ComputePassTimestampWrites<'_>> {
        self.of_compute(4)
    }

    /// From the beginning of the first draw pass to the end of the last.
    pub(super) fn of_drawing(
        &self,
        number: u32,
        is_last: bool,
    ) -> Option<RenderPassTimestampWrites<'_>> {
        if number > 0 && !is_last {
            return None;
        }
        Some(RenderPassTimestampWrites {
            query_set: self.times.as_ref()?,
            beginning_of_pass_write_index: (number == 0).then_some(2),
            end_of_pass_write_index: is_last.then_some(3),
        })
    }

    /// Begins to count; false where the adapter does not.
    pub(super) fn begin_drawing(&self, pass: &mut RenderPass<'_>, number: u32) -> bool {
        let Some(statistics) = &self.statistics else {
            return false;
        };
        pass.begin_pipeline_statistics_query(statistics, number);
        true
    }

    pub(super) fn resolve(&self, encoder: &mut CommandEncoder) {
        if let Some(times) = &self.times {
            encoder.resolve_query_set(times, 0..TIMES, &self.resolved, 0);
        }
        if let Some(statistics) = &self.statistics {
            encoder.resolve_query_set(statistics, 0..self.draws, &self.resolved, STATISTICS as u64);
        }
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &self.read, 0, self.read.size());
    }

    pub(super) fn read(
        &self,
        context: &Context,
        submission: SubmissionIndex,
    ) -> Result<(Option<DrawCounts>, Option<StageSeconds>), GpuError> {
        let words = read(context, &self.read, self.read.size(), submission)?;
        let numbers: Vec<u64> = bytemuck::pod_collect_to_vec(&words);
        let seconds = |stage: usize| {
            (numbers[2 * stage + 1] - numbers[2 * stage]) as f64 * self.period * 1e-9
        };
        let sum = |number: usize| {
            let all = &numbers[STATISTICS / 8..];
            all.chunks(NUMBERS).map(|draw| draw[number]).sum()
        };
        let drawing = self.statistics.as_ref().map(|_| DrawCounts {
            vertices: sum(0),
            triangles: sum(1),
            visible_triangles: sum(2),
            fragments: sum(3),
        });
        let seconds = self.times.as_ref().map(|_| StageSeconds {
            arrange: seconds(0),
            draw: seconds(1),
            sum: seconds(2),
        });
        Ok((drawing, seconds))
    }
}
