//! What a trial tells.

use crate::frames::FrameTimes;
use crate::session::OnDevice;
use crate::trial::Figures;
use core::fmt;
use std::collections::BTreeMap;
use std::time::{Duration, Instant};

/// Processor time of a part of the trial, thread by thread.
#[derive(Debug, Default)]
pub struct Cpu {
    begin: Option<(Instant, BTreeMap<String, f64>)>,
    /// Seconds by the clock.
    seconds: f64,
    /// Seconds by threads' names, most first.
    threads: Vec<(String, f64)>,
}

impl Cpu {
    /// With what was used so far.
    pub fn begin(&mut self, used: BTreeMap<String, f64>) {
        self.begin = Some((Instant::now(), used));
    }

    /// With what was used until now.
    pub fn end(&mut self, used: &BTreeMap<String, f64>) {
        let Some((begin, before)) = self.begin.take() else {
            return;
        };
        self.seconds = begin.elapsed().as_secs_f64();
        let since = |(name, &after): (&String, &f64)| {
            let time = after - before.get(name).copied().unwrap_or(0.0);
            (name.clone(), time)
        };
        self.threads = used.iter().map(since).filter(|t| t.1 > 0.0).collect();
        self.threads.sort_by(|a, b| b.1.total_cmp(&a.1));
    }
}

/// Everything that was measured.
pub struct Report<'a> {
    pub first: Option<Duration>,
    pub rest: &'a Figures,
    pub walk: &'a Figures,
    pub waits: &'a FrameTimes,
    pub edits: &'a [Duration],
    /// Since when a change is waited for that was not seen yet.
    pub unseen: Option<Duration>,
    pub memory: &'a [(Duration, u64)],
    /// What is known of light that a device keeps.
    pub on_device: Option<&'a OnDevice>,
}

impl fmt::Display for Report<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.first {
            Some(first) => writeln!(
                f,
                "first lit picture  {:.2} s after the window",
                first.as_secs_f64()
            )?,
            None => writeln!(f, "first lit picture  none")?,
        }
        part(f, "standing", self.rest)?;
        part(f, "walking", self.walk)?;
        if let Some(waits) = self.waits.report() {
            let [median, p95, longest] = [waits.median, waits.p95, waits.longest].map(ms);
            writeln!(
                f,
                "input waits        median {median:.1} ms, 95 % {p95:.1}, longest {longest:.1}"
            )?;
        }
        edits(f, self.edits, self.unseen)?;
        if let Some(device) = self.on_device {
            writeln!(
                f,
                "light on device    {} bytes back after each of {} steps, {} KiB with all light",
                device.step_bytes.checked_div(device.steps).unwrap_or(0),
                device.steps,
                device.light_bytes >> 10
            )?;
        }
        memory(f, self.memory)
    }
}

fn part(f: &mut fmt::Formatter<'_>, name: &str, figures: &Figures) -> fmt::Result {
    let Some(frames) = figures.frames.report() else {
        return Ok(());
    };
    writeln!(f, "{name:<19}{frames}")?;
    let new = 1.0 / figures.cpu.seconds.max(1e-9) * f64::from(figures.pictures);
    let width = f64::from(figures.widths) / f64::from(figures.pictures.max(1));
    write!(
        f,
        "{:<19}{new:.1} new pictures a second, their pixels {width:.1} wide",
        ""
    )?;
    if let Some((rate, what)) = figures.solving.rate() {
        write!(f, "; {rate:.1} {what} of the solver a second")?;
    }
    let count = frames.frames as f64;
    let threads = figures.cpu.threads.iter().take(6);
    let threads: Vec<String> = threads
        .map(|(name, seconds)| format!("{name} {:.1}", 1e3 * seconds / count))
        .collect();
    if !threads.is_empty() {
        write!(f, "; CPU-ms a frame: {}", threads.join(", "))?;
    }
    writeln!(f)
}

fn edits(f: &mut fmt::Formatter<'_>, times: &[Duration], unseen: Option<Duration>) -> fmt::Result {
    let longest = times.iter().max();
    match (longest, unseen) {
        (Some(&longest), _) => {
            let mean = times.iter().sum::<Duration>() / u32::try_from(times.len()).unwrap_or(1);
            let (count, mean, longest) = (times.len(), ms(mean), ms(longest));
            writeln!(
                f,
                "lamp changed       half of it in the picture after {mean:.0} ms, longest {longest:.0} ({count} times)"
            )
        }
        (None, Some(time)) => {
            let seconds = time.as_secs_f64();
            writeln!(
                f,
                "lamp changed       not in the picture after {seconds:.1} s"
            )
        }
        (None, None) => Ok(()),
    }
}

fn memory(f: &mut fmt::Formatter<'_>, readings: &[(Duration, u64)]) -> fmt::Result {
    if readings.is_empty() {
        return Ok(());
    }
    let mib = |bytes: u64| bytes as f64 / f64::from(1 << 20);
    let readings: Vec<String> = readings
        .iter()
        .map(|(time, bytes)| format!("{:.0} s {:.0}", time.as_secs_f64(), mib(*bytes)))
        .collect();
    write!(f, "MiB resident at    {}", readings.join(", "))
}

fn ms(time: Duration) -> f64 {
    1e3 * time.as_secs_f64()
}
