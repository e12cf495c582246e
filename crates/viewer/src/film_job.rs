//! A film of a recorded way, drawn on the CPU beside everything else.

use crate::display::{Display, Quantity};
use crate::session::background_pool;
use crate::walk::{FRAMES_PER_SECOND, Film, FilmFormat, Path};
use hemicube_radiosity::Solution;
use hemicube_raster::color::srgb8_from_linear;
use hemicube_raster::tonemap::Exposure;
use hemicube_raster::{Image, Rgb};
use hemicube_render::{RenderOptions, Renderer, Shading};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU32, Ordering};
use std::sync::{Arc, Mutex};

/// What a film shows.
pub struct FilmPlan {
    /// Light, as dimmed.
    pub solution: Solution,
    /// The way.
    pub path: Path,
    /// Speed along it in scene units a second.
    pub speed: f32,
    /// How it looks. Films show light, whatever the window shows.
    pub display: Display,
    /// Factor on all light, the same for all frames: nothing flickers.
    pub exposure: f32,
    /// Width and height in pixels.
    pub size: [usize; 2],
    /// How frames are kept.
    pub format: FilmFormat,
    /// File or folder.
    pub target: PathBuf,
}

/// A film on its way.
pub struct FilmJob {
    done: Arc<AtomicU32>,
    frames: u32,
    is_cancelled: Arc<AtomicBool>,
    result: Arc<Mutex<Option<Result<PathBuf, String>>>>,
}

impl FilmJob {
    /// Starts to draw.
    pub fn start(plan: FilmPlan, wake: impl Fn() + Send + 'static) -> Self {
        let job = Self {
            done: Arc::default(),
            frames: frames(&plan),
            is_cancelled: Arc::default(),
            result: Arc::default(),
        };
        let (done, cancelled, result) = (
            job.done.clone(),
            job.is_cancelled.clone(),
            job.result.clone(),
        );
        let count = job.frames;
        std::thread::spawn(move || {
            let film = background_pool().install(|| draw(&plan, count, &done, &cancelled));
            *crate::session::lock(&result) = Some(film);
            wake();
        });
        job
    }

    /// Frames that are drawn, and how many there will be.
    pub fn progress(&self) -> (u32, u32) {
        (self.done.load(Ordering::Relaxed), self.frames)
    }

    /// Where the film is, or why there is none; once.
    pub fn take(&self) -> Option<Result<PathBuf, String>> {
        crate::session::lock(&self.result).take()
    }
}

impl Drop for FilmJob {
    fn drop(&mut self) {
        self.is_cancelled.store(true, Ordering::Relaxed);
    }
}

/// Frames of the whole way, one at least.
#[expect(
    clippy::cast_possible_truncation,
    clippy::cast_sign_loss,
    reason = "hours of film fit"
)]
fn frames(plan: &FilmPlan) -> u32 {
    let seconds = plan.path.duration(plan.speed).clamp(0.0, 36_000.0);
    (seconds * FRAMES_PER_SECOND as f32).ceil() as u32 + 1
}

fn draw(
    plan: &FilmPlan,
    frames: u32,
    done: &AtomicU32,
    cancelled: &AtomicBool,
) -> Result<PathBuf, String> {
    let mut film =
        Film::create(&plan.target, plan.format, plan.size, frames).map_err(|e| e.to_string())?;
    for i in 0..frames {
        if cancelled.load(Ordering::Relaxed) {
            return Err(String::from("the film was not finished"));
        }
        let seconds = i as f32 / FRAMES_PER_SECOND as f32;
        film.push(&frame(plan, seconds)?)
            .map_err(|e| e.to_string())?;
        done.store(i + 1, Ordering::Relaxed);
    }
    film.finish().map_err(|e| e.to_string())
}

fn frame(plan: &FilmPlan, seconds: f32) -> Result<Image<[u8; 3]>, String> {
    let eye = plan
        .path
        .at(seconds, plan.speed)
        .ok_or("the way has no stops")?;
    let options = picture_options(&plan.display, plan.size);
    let camera = eye.camera("film");
    let renderer = Renderer::new(&plan.solution, &camera, &options).map_err(|e| e.to_string())?;
    Ok(srgb8(&renderer.display(
        Exposure::Ev(plan.exposure.log2()),
        plan.display.tone_map(),
    )))
}

/// The CPU's options for what the window shows.
fn picture_options(display: &Display, [width, height]: [usize; 2]) -> RenderOptions {
    let is_flat = display.flat && display.quantity == Quantity::Light;
    RenderOptions::default()
        .with_size(width, height)
        .with_shading(if is_flat {
            Shading::Flat
        } else {
            Shading::Gouraud
        })
        .with_samples(2)
        .with_ambient(display.ambient)
}

/// A picture of display colours in 8 bits.
pub fn srgb8(picture: &Image<Rgb>) -> Image<[u8; 3]> {
    picture.map(|color| color.to_array().map(srgb8_from_linear))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::walk::Eye;
    use hemicube_radiosity::{Quality, solve};
    use hemicube_scene::builtin;
    use std::time::{Duration, Instant};

    #[test]
    fn a_film_of_two_stops_is_lit_and_moves() {
        let scene = Arc::new(builtin::scene("cornell").expect("it is built in"));
        let camera = scene.cameras[0].clone();
        let solution = solve(scene, &Quality::Draft.into(), |p, _| p.iteration < 60)
            .expect("it can be solved");
        let first = Eye::of_camera(&camera, 500.0);
        let mut last = first;
        last.position.x += 40.0;
        let folder = tempfile::tempdir().expect("there is room");
        let plan = FilmPlan {
            solution,
            path: Path {
                stops: vec![first, last],
            },
            speed: 400.0,
            display: Display::default(),
            exposure: 1.0,
            size: [48, 36],
            format: FilmFormat::PngFrames,
            target: folder.path().join("film"),
        };
        let job = FilmJob::start(plan, || {});
        let begin = Instant::now();
        let path = loop {
            if let Some(result) = job.take() {
                break result.expect("it can be drawn");
            }
            assert!(begin.elapsed() < Duration::from_secs(60), "it ends");
            std::thread::sleep(Duration::from_millis(5));
        };
        let (done, frames) = job.progress();
        assert!(
            done == frames && frames >= 8,
            "a quarter of a second at least: {frames}"
        );
        let read = |i: u32| {
            let file = std::fs::File::open(path.join(format!("{i:05}.png"))).expect("a file each");
            let mut reader = png::Decoder::new(std::io::BufReader::new(file))
                .read_info()
                .expect("a PNG");
            let mut pixels = vec![0; reader.output_buffer_size().expect("it fits")];
            reader.next_frame(&mut pixels).expect("a frame");
            pixels
        };
        let (a, b) = (read(0), read(frames - 1));
        let mean = a.iter().map(|&x| u64::from(x)).sum::<u64>() / a.len() as u64;
        assert!((20..235).contains(&mean), "lit and not burnt out: {mean}");
        assert_ne!(a, b, "the eye has moved");
    }
}
