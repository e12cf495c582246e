//! Buffers and bindings in few words.

use crate::context::Context;
use crate::error::GpuError;
use bytemuck::Pod;
use hemicube_shaders::Shader;
use std::sync::mpsc::{Receiver, TryRecvError, channel};
use std::time::Duration;
use wgpu::{
    BindGroup, BindGroupLayout, BindGroupLayoutEntry, BindingResource, BindingType, Buffer,
    BufferBindingType, BufferUsages, ComputePipeline, Device, ShaderStages, SubmissionIndex,
};

/// How long another thread may take to tell that a buffer is mapped.
const NEWS: Duration = Duration::from_secs(5);

/// How often is looked whether a submission is done that nobody waits for.
const LOOK: Duration = Duration::from_micros(500);

/// Whether a buffer was mapped.
type Mapped = Result<(), wgpu::BufferAsyncError>;

/// A buffer that shaders read, filled now; of a lost device it is empty, and of no use.
pub fn filled(device: &Device, label: &str, data: &[impl Pod], usage: BufferUsages) -> Buffer {
    let bytes: &[u8] = bytemuck::cast_slice(data);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: buffer_size(bytes.len() as u64),
        usage,
        mapped_at_creation: true,
    });
    if let Ok(mut mapped) = buffer.get_mapped_range_mut(..) {
        mapped.slice(..bytes.len()).copy_from_slice(bytes);
        drop(mapped);
        buffer.unmap();
    }
    buffer
}

/// Bytes of a buffer: at least 16, because empty ones cannot be bound, and whole words.
fn buffer_size(bytes: u64) -> u64 {
    bytes.max(16).next_multiple_of(4)
}

/// A buffer of so many bytes.
pub fn empty(device: &Device, label: &str, bytes: u64, usage: BufferUsages) -> Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: buffer_size(bytes),
        usage,
        mapped_at_creation: false,
    })
}

/// What is bound at a place.
pub fn binding(binding: u32, visibility: ShaderStages, ty: BindingType) -> BindGroupLayoutEntry {
    BindGroupLayoutEntry {
        binding,
        visibility,
        ty,
        count: None,
    }
}

/// A uniform buffer; `dynamic` if its offset is given when it is bound.
pub fn uniform(dynamic: bool) -> BindingType {
    BindingType::Buffer {
        ty: BufferBindingType::Uniform,
        has_dynamic_offset: dynamic,
        min_binding_size: None,
    }
}

/// A storage buffer.
pub fn storage(read_only: bool) -> BindingType {
    BindingType::Buffer {
        ty: BufferBindingType::Storage { read_only },
        has_dynamic_offset: false,
        min_binding_size: None,
    }
}

/// A layout whose bindings are numbered as they come.
pub fn layout(
    device: &Device,
    label: &str,
    visibility: ShaderStages,
    types: &[BindingType],
) -> BindGroupLayout {
    let entries: Vec<BindGroupLayoutEntry> = (0..)
        .zip(types)
        .map(|(i, &ty)| binding(i, visibility, ty))
        .collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &entries,
    })
}

/// Resources for a layout, numbered as they come.
pub fn bind(
    device: &Device,
    label: &str,
    layout: &BindGroupLayout,
    resources: &[BindingResource<'_>],
) -> BindGroup {
    let entries: Vec<wgpu::BindGroupEntry<'_>> = (0..)
        .zip(resources)
        .map(|(binding, resource)| wgpu::BindGroupEntry {
            binding,
            resource: resource.clone(),
        })
        .collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: Some(label),
        layout,
        entries: &entries,
    })
}

/// A shader as the device takes it.
pub fn module(device: &Device, shader: &Shader) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(shader.name),
        source: wgpu::ShaderSource::Wgsl(shader.source.into()),
    })
}

/// A compute pipeline of one entry point.
pub fn compute(
    device: &Device,
    module: &wgpu::ShaderModule,
    entry_point: &str,
    layouts: &[&BindGroupLayout],
) -> ComputePipeline {
    let layouts: Vec<Option<&BindGroupLayout>> = layouts.iter().copied().map(Some).collect();
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some(entry_point),
        bind_group_layouts: &layouts,
        immediate_size: 0,
    });
    device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
        label: Some(entry_point),
        layout: Some(&layout),
        module,
        entry_point: Some(entry_point),
        compilation_options: wgpu::PipelineCompilationOptions::default(),
        cache: None,
    })
}

/// Workgroups along x and z for so many invocations of `size` each: a dimension holds at most 65,535.
pub fn groups(invocations: u32, size: u32) -> (u32, u32) {
    const MOST: u32 = 65_535;
    let groups = invocations.div_ceil(size).max(1);
    let z = groups.div_ceil(MOST);
    (groups.div_ceil(z), z)
}

/// Waits for a submission and reads the words of a mappable buffer that it has filled.
pub fn read(
    context: &Context,
    buffer: &Buffer,
    bytes: u64,
    submission: SubmissionIndex,
) -> Result<Vec<u32>, GpuError> {
    let news = map(buffer, bytes);
    context.wait_for(submission)?;
    // Another thread that polls the device may have taken the news and not told it yet.
    let mapped = news.recv_timeout(NEWS);
    take(context, buffer, bytes, mapped.ok())
}

/// Reads the words of a mappable buffer that a submission has filled, and leaves the device to others until it is done:
/// while somebody waits in wgpu 30, no window of the device is presented.
pub fn read_beside_others(
    context: &Context,
    buffer: &Buffer,
    bytes: u64,
) -> Result<Vec<u32>, GpuError> {
    let news = map(buffer, bytes);
    loop {
        context.look()?;
        match news.try_recv() {
            Ok(mapped) => return take(context, buffer, bytes, Some(mapped)),
            Err(TryRecvError::Empty) => std::thread::sleep(LOOK),
            Err(TryRecvError::Disconnected) => return take(context, buffer, bytes, None),
        }
    }
}

/// Asks for a buffer to be mapped; what comes of it is told when the device is polled.
fn map(buffer: &Buffer, bytes: u64) -> Receiver<Mapped> {
    let (send, receive) = channel();
    buffer.map_async(wgpu::MapMode::Read, 0..bytes, move |result| {
        // The receiver is there until the result has come or the device is lost.
        let _ = send.send(result);
    });
    receive
}

/// The words of a buffer, if it was mapped.
fn take(
    context: &Context,
    buffer: &Buffer,
    bytes: u64,
    mapped: Option<Mapped>,
) -> Result<Vec<u32>, GpuError> {
    let lost = |why: String| GpuError::Lost {
        adapter: context.name.clone(),
        why,
    };
    match mapped {
        Some(Ok(())) => {}
        Some(Err(e)) => return Err(lost(e.to_string())),
        None => return Err(lost(String::from("nothing came back"))),
    }
    let words = {
        let view = buffer
            .get_mapped_range(0..bytes)
            .map_err(|e| lost(e.to_string()))?;
        bytemuck::pod_collect_to_vec(&view)
    };
    buffer.unmap();
    Ok(words)
}
