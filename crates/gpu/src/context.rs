//! Adapters and devices.

use crate::error::GpuError;
use crate::ray_queries::{RayQueries, with_ray_queries};
use core::fmt;
use std::sync::{Arc, Mutex, PoisonError};
use wgpu::{Adapter, Backends, Device, DeviceType, Features, Instance, Limits, Queue};

/// Name of the environment variable that chooses an adapter where no option does.
pub const ADAPTER_VARIABLE: &str = "HEMICUBE_ADAPTER";

/// An adapter, as `hemicube adapters` lists it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct AdapterReport {
    /// Name of the device.
    pub name: String,
    /// Through which interface: `vulkan`, `metal`, `dx12`, `gl`.
    pub backend: String,
    /// `discrete`, `integrated`, `virtual`, `software` or `other`.
    pub kind: &'static str,
    /// Driver and its version.
    pub driver: String,
    /// Whether everything here runs on it; why not otherwise.
    pub usable: Result<(), String>,
    /// What it can do beyond that, which makes some things faster.
    pub extras: Vec<&'static str>,
    /// Whether rays are cast by its own queries, as the environment says ([`RayQueries`]).
    pub uses_ray_queries: bool,
    /// Largest buffer that a shader may read, in bytes.
    pub max_binding: u64,
    /// Longest side of a picture.
    pub max_side: u32,
}

impl fmt::Display for AdapterReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{} ({}, {})", self.name, self.backend, self.kind)
    }
}

/// Features that are used where they are there, with their names in reports.
const EXTRAS: [(Features, &str); 4] = [
    (Features::TIMESTAMP_QUERY, "timestamps"),
    (Features::PIPELINE_STATISTICS_QUERY, "statistics"),
    (Features::SUBGROUP, "subgroups"),
    (Features::EXPERIMENTAL_RAY_QUERY, "ray queries"),
];

/// What everything here needs.
fn needed() -> Limits {
    Limits {
        max_storage_buffers_per_shader_stage: 8,
        ..Limits::downlevel_defaults()
    }
}

fn instance() -> Instance {
    Instance::new(wgpu::InstanceDescriptor::new_without_display_handle())
}

fn adapters_of(instance: &Instance) -> Vec<Adapter> {
    pollster::block_on(instance.enumerate_adapters(Backends::all()))
}

/// All adapters of this machine, the best first.
pub fn adapters() -> Vec<AdapterReport> {
    let mut all = adapters_of(&instance());
    all.sort_by_key(rank);
    all.iter().map(report).collect()
}

/// Discrete before integrated before software; OpenGL last.
fn rank(adapter: &Adapter) -> (bool, u8) {
    let info = adapter.get_info();
    let kind = match info.device_type {
        DeviceType::DiscreteGpu => 0,
        DeviceType::IntegratedGpu => 1,
        DeviceType::VirtualGpu => 2,
        DeviceType::Other => 3,
        DeviceType::Cpu => 4,
    };
    (info.backend == wgpu::Backend::Gl, kind)
}

fn report(adapter: &Adapter) -> AdapterReport {
    let (info, limits, features) = (adapter.get_info(), adapter.limits(), adapter.features());
    AdapterReport {
        backend: info.backend.to_string(),
        kind: match info.device_type {
            DeviceType::DiscreteGpu => "discrete",
            DeviceType::IntegratedGpu => "integrated",
            DeviceType::VirtualGpu => "virtual",
            DeviceType::Cpu => "software",
            DeviceType::Other => "other",
        },
        driver: format!("{} {}", info.driver, info.driver_info)
            .trim()
            .to_owned(),
        usable: lack(&limits).map_or(Ok(()), Err),
        extras: EXTRAS
            .iter()
            .filter(|(feature, _)| features.contains(*feature))
            .map(|&(_, name)| name)
            .collect(),
        uses_ray_queries: RayQueries::of_environment().is_ok_and(|when| when.are_used(adapter)),
        max_binding: limits.max_storage_buffer_binding_size,
        max_side: limits.max_texture_dimension_2d,
        name: info.name,
    }
}

/// The first limit that is too low, in words.
fn lack(limits: &Limits) -> Option<String> {
    let mut lack = None;
    needed().check_limits_with_fail_fn(limits, true, |name, wanted, has| {
        lack = Some(format!("{name} is {has}, {wanted} are needed"));
    });
    lack
}

/// How a device is chosen.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct ContextOptions {
    /// A part of the adapter's name, in any case. Default value: none, what the environment variable [`ADAPTER_VARIABLE`]
    /// says, else the best adapter.
    pub adapter: Option<String>,
    /// When rays are cast by the adapter's own queries. Default value: none, what the environment variable
    /// [`RAY_QUERY_VARIABLE`](crate::RAY_QUERY_VARIABLE) says, else where the adapter has circuits for them.
    pub ray_queries: Option<RayQueries>,
}

impl ContextOptions {
    /// The adapter whose name contains this.
    pub fn with_adapter(self, adapter: impl Into<Option<String>>) -> Self {
        Self {
            adapter: adapter.into(),
            ..self
        }
    }

    /// When rays are cast by the adapter's own queries.
    pub fn with_ray_queries(self, ray_queries: RayQueries) -> Self {
        Self {
            ray_queries: Some(ray_queries),
            ..self
        }
    }
}

/// A device with its queue, of its own or that of a window.
pub struct Context {
    /// The adapter's name, for messages.
    pub name: String,
    /// Makes things.
    pub device: Device,
    /// Runs them.
    pub queue: Queue,
    /// What the device may do.
    pub limits: Limits,
    /// What went wrong outside of a call: the device was lost, its memory ran out.
    failure: Arc<Mutex<Option<GpuError>>>,
}

impl fmt::Debug for Context {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Context")
            .field("name", &self.name)
            .finish_non_exhaustive()
    }
}

impl Context {
    /// A device of the adapter whose name contains `wanted` in any case, else of the one that the environment variable
    /// [`ADAPTER_VARIABLE`] names, else of the best.
    ///
    /// # Errors
    /// No adapter fits, or its driver gives no device.
    pub fn headless(wanted: Option<&str>) -> Result<Self, GpuError> {
        let options = ContextOptions::default().with_adapter(wanted.map(str::to_owned));
        Self::with_options(&options)
    }

    /// A device that was chosen by options.
    ///
    /// # Errors
    /// No adapter fits, or its driver gives no device; the environment says nothing that is known.
    pub fn with_options(options: &ContextOptions) -> Result<Self, GpuError> {
        let when = match options.ray_queries {
            Some(when) => when,
            None => RayQueries::of_environment()?,
        };
        let adapter = best(options.adapter.as_deref())?;
        Self::open(&adapter, adapter.limits(), when)
    }

    /// As [`Self::headless`], with the limits that `lower` makes of the adapter's: to see how a scene fares on a smaller
    /// one.
    ///
    /// # Errors
    /// No adapter fits, or its driver gives no device, which is so if limits were raised.
    pub fn headless_within(
        wanted: Option<&str>,
        lower: impl FnOnce(Limits) -> Limits,
    ) -> Result<Self, GpuError> {
        let adapter = best(wanted)?;
        let when = RayQueries::of_environment()?;
        Self::open(&adapter, lower(adapter.limits()), when)
    }

    /// A device of an adapter that the caller has chosen, for example one that can draw into a window.
    ///
    /// # Errors
    /// The driver gives no device; the environment says nothing that is known.
    pub fn of_adapter(adapter: &Adapter) -> Result<Self, GpuError> {
        Self::open(adapter, adapter.limits(), RayQueries::of_environment()?)
    }

    /// How a device is asked for: with all that the adapter has, because scenes are as large as they are. For those who
    /// make devices themselves and hand them to [`Self::from_wgpu`]. Ray queries are left out.
    pub fn descriptor(adapter: &Adapter) -> wgpu::DeviceDescriptor<'static> {
        let optional = EXTRAS
            .iter()
            .fold(Features::empty(), |all, (feature, _)| all | *feature);
        let optional = optional - Features::EXPERIMENTAL_RAY_QUERY;
        wgpu::DeviceDescriptor {
            label: Some("hemicube"),
            required_features: adapter.features() & optional,
            required_limits: adapter.limits(),
            ..Default::default()
        }
    }

    fn open(
        adapter: &Adapter,
        required_limits: Limits,
        ray_queries: RayQueries,
    ) -> Result<Self, GpuError> {
        let name = adapter.get_info().name;
        let mut descriptor = wgpu::DeviceDescriptor {
            required_limits,
            ..Self::descriptor(adapter)
        };
        if ray_queries.are_used(adapter) {
            descriptor = with_ray_queries(descriptor);
        }
        let (device, queue) =
            pollster::block_on(adapter.request_device(&descriptor)).map_err(|e| {
                GpuError::NoDevice {
                    adapter: name.clone(),
                    why: one_line(&e),
                }
            })?;
        let failure = Arc::new(Mutex::new(None));
        watch(&device, &name, &failure);
        Ok(Self {
            limits: device.limits(),
            name,
            device,
            queue,
            failure,
        })
    }

    /// A device that somebody else has made, for example the owner of a window; the name is for messages.
    ///
    /// From now on its loss and its errors are heard here: callbacks that were set before are replaced.
    ///
    /// # Errors
    /// The device was made with limits below what is needed.
    pub fn from_wgpu(name: &str, device: Device, queue: Queue) -> Result<Self, GpuError> {
        let limits = device.limits();
        if let Some(lack) = lack(&limits) {
            return Err(GpuError::NoAdapter(format!(
                "'{name}' cannot be used: {lack}"
            )));
        }
        let failure = Arc::new(Mutex::new(None));
        watch(&device, name, &failure);
        Ok(Self {
            name: name.to_owned(),
            device,
            queue,
            limits,
            failure,
        })
    }

    /// Whether rays are cast by the adapter's own queries.
    pub fn has_ray_queries(&self) -> bool {
        let features = self.device.features();
        features.contains(Features::EXPERIMENTAL_RAY_QUERY)
    }

    /// What went wrong since the device was made; it stays so.
    pub fn failure(&self) -> Option<GpuError> {
        self.failure
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .clone()
    }

    /// Makes things on the device; if its memory does not hold them, that is the caller's error alone, and the device
    /// goes on with others.
    ///
    /// # Errors
    /// Those of `make`; the memory ran out; the device was lost.
    pub fn guard<T>(&self, make: impl FnOnce() -> Result<T, GpuError>) -> Result<T, GpuError> {
        self.check()?;
        // What is made of a buffer that there is no memory for is invalid, which is no news then.
        let invalid = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let made = make();
        let (memory, invalid) = (
            pollster::block_on(memory.pop()),
            pollster::block_on(invalid.pop()),
        );
        if let Some(error) = memory {
            return Err(GpuError::OutOfMemory {
                adapter: self.name.clone(),
                why: one_line(&error),
            });
        }
        if let Some(error) = invalid {
            self.wait()?;
            panic!("GPU calls are valid: {}", one_line(&error));
        }
        let made = made?;
        self.wait()?;
        Ok(made)
    }

    /// Asks whether the device still works; before work is prepared for it, which would be in vain.
    ///
    /// # Errors
    /// The device was lost or its memory ran out.
    pub fn check(&self) -> Result<(), GpuError> {
        // What was lost is told while polling.
        let _ = self.device.poll(wgpu::PollType::Poll);
        self.failure().map_or(Ok(()), Err)
    }

    /// Waits until everything that was submitted is done.
    ///
    /// # Errors
    /// The device was lost or its memory ran out.
    pub fn wait(&self) -> Result<(), GpuError> {
        self.poll(wgpu::PollType::wait_indefinitely())
    }

    /// Waits until a submission is done; what others have submitted after it may go on.
    ///
    /// While somebody waits, wgpu 30 presents no window of the device. Waiting for a short time again and again is no way
    /// out: a wait that ends early panics in wgpu if another thread polls just then. [`Self::look`] is one.
    ///
    /// # Errors
    /// The device was lost or its memory ran out.
    pub fn wait_for(&self, submission: wgpu::SubmissionIndex) -> Result<(), GpuError> {
        self.poll(wgpu::PollType::Wait {
            submission_index: Some(submission),
            timeout: None,
        })
    }

    /// Has told what is done by now, without waiting for anything.
    ///
    /// # Errors
    /// The device was lost or its memory ran out.
    pub fn look(&self) -> Result<(), GpuError> {
        self.poll(wgpu::PollType::Poll)
    }

    fn poll(&self, until: wgpu::PollType) -> Result<(), GpuError> {
        let polled = self.device.poll(until);
        match (self.failure(), polled) {
            (Some(failure), _) => Err(failure),
            (None, Err(e)) => Err(GpuError::Lost {
                adapter: self.name.clone(),
                why: one_line(&e),
            }),
            (None, Ok(_)) => Ok(()),
        }
    }

    /// Refuses what does not fit a limit of the adapter.
    ///
    /// # Errors
    /// It does not.
    pub fn allow(&self, what: &str, needed: u64, allowed: u64, unit: &str) -> Result<(), GpuError> {
        if needed <= allowed {
            return Ok(());
        }
        Err(GpuError::Limit {
            adapter: self.name.clone(),
            what: what.to_owned(),
            needed: format!("{needed} {unit}"),
            allowed: format!("{allowed} {unit}"),
        })
    }
}

/// The adapter whose name contains `wanted`, else what the environment says, or the best.
fn best(wanted: Option<&str>) -> Result<Adapter, GpuError> {
    let variable = std::env::var(ADAPTER_VARIABLE)
        .ok()
        .filter(|name| !name.is_empty());
    let wanted = wanted.map(str::to_owned).or(variable);
    let mut all = adapters_of(&instance());
    all.sort_by_key(rank);
    choose(&all, wanted.as_deref())
}

/// The adapter whose name contains `wanted`, or the first that can be used.
fn choose(all: &[Adapter], wanted: Option<&str>) -> Result<Adapter, GpuError> {
    let names = || {
        all.iter()
            .map(|a| format!("'{}'", a.get_info().name))
            .collect::<Vec<_>>()
    };
    let fits = |adapter: &&Adapter| match wanted {
        Some(wanted) => {
            let name = adapter.get_info().name.to_lowercase();
            name.contains(&wanted.to_lowercase())
        }
        None => lack(&adapter.limits()).is_none(),
    };
    let Some(adapter) = all.iter().find(fits) else {
        return Err(GpuError::NoAdapter(match (all.is_empty(), wanted) {
            (true, _) => String::from(
                "this machine shows no adapter; install its Vulkan driver (Mesa's lavapipe draws in software)",
            ),
            (false, Some(wanted)) => {
                format!(
                    "no adapter's name contains '{wanted}'; there are {}",
                    names().join(", ")
                )
            }
            (false, None) => format!("none of {} can do all that is needed", names().join(", ")),
        }));
    };
    match lack(&adapter.limits()) {
        Some(lack) => Err(GpuError::NoAdapter(format!(
            "'{}' cannot be used: {lack}",
            adapter.get_info().name
        ))),
        None => Ok(adapter.clone()),
    }
}

/// Keeps the first thing that goes wrong outside of a call.
fn watch(device: &Device, name: &str, failure: &Arc<Mutex<Option<GpuError>>>) {
    let keep = |failure: &Mutex<Option<GpuError>>, error: GpuError| {
        failure
            .lock()
            .unwrap_or_else(PoisonError::into_inner)
            .get_or_insert(error);
    };
    let (lost, adapter) = (failure.clone(), name.to_owned());
    device.set_device_lost_callback(move |reason, why| {
        let why = match reason {
            wgpu::DeviceLostReason::Destroyed => String::from("it was destroyed"),
            wgpu::DeviceLostReason::Unknown => one_line(&why),
        };
        let adapter = adapter.clone();
        keep(&lost, GpuError::Lost { adapter, why });
    });
    let (uncaptured, adapter) = (failure.clone(), name.to_owned());
    device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
        let (adapter, why) = (adapter.clone(), one_line(&error));
        match error {
            wgpu::Error::OutOfMemory { .. } => {
                keep(&uncaptured, GpuError::OutOfMemory { adapter, why });
            }
            // A window that is resized waits until nothing is submitted, and is refused if a solver submits just then: the
            // next frame asks again.
            wgpu::Error::Validation { .. } if why.contains(SURFACE_IS_BUSY) => {}
            // After a failure everything that is made is invalid.
            wgpu::Error::Validation { .. } => {
                let failure = uncaptured.lock().unwrap_or_else(PoisonError::into_inner);
                assert!(failure.is_some(), "GPU calls are valid: {why}");
            }
            wgpu::Error::Internal { .. } => keep(&uncaptured, GpuError::Lost { adapter, why }),
        }
    }));
}

/// What wgpu says when a surface cannot be configured because another thread submits.
const SURFACE_IS_BUSY: &str = "come idle before reconfiguring the Surface";

fn one_line(error: &impl fmt::Display) -> String {
    error
        .to_string()
        .split_whitespace()
        .collect::<Vec<_>>()
        .join(" ")
}
