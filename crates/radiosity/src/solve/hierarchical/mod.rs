//! Hierarchical radiosity with clustering (Hanrahan, Salzman, Aupperle 1991; Smits, Arvo, Greenberg 1994; Sillion 1995).
//!
//! Light goes over *links* between the nodes of a hierarchy: elements lie below the cells of their face, faces
//! below clusters. Everything begins with one link, from the root to itself. A step
//!
//! 1. lowers the error that a link may have, and refines those that have more (`oracle`),
//! 2. gathers over all links, pulling radiosity up and pushing irradiance down (`push_pull`), until little is unshot.
//!
//! It ends where the errors of all links together are as small as wanted. So far things exchange light by few links, near
//! ones by many; the number of links grows with that of the elements, not with its square, also where a scene is made of
//! many small faces.
//!
//! Energy is kept: rays from where light leaves tell what is lost to backs and escapes, and what arrives is scaled to
//! the rest, since factors and visibility that are sampled do not sum to it exactly.

mod cluster;
mod harmonics;
mod link;
mod lost;
mod oracle;
mod push_pull;
mod refine;
mod statistics;
mod transport;

use crate::cast::to_f32;
pub use statistics::{DrawnLink, LinkCounts};

use self::cluster::Hierarchy;
use self::link::{Link, Seen};
use self::lost::Lost;
use self::oracle::Oracle;
use self::push_pull::Radiosity;
use self::transport::Transport;
use crate::error::RadiosityError;
use crate::patch::PatchMesh;
use crate::sampling::hash;
use crate::solution::{BANDS, Solution};
use crate::solve::{Progress, Solver};
use rayon::prelude::*;
use std::sync::Arc;

/// How exact the light is to be.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct HierarchicalOptions {
    /// Finished at this relative error of the irradiance, estimated, root mean square over the area; of elements that
    /// receive less than a twentieth of the mean it is more and more relative to the mean instead
    /// ([`Hierarchical::error`]). Default value: 0.03.
    pub error: f64,
    /// Unshot share of the emitted flux at which gathering ends. Default value: 5e-4.
    pub tolerance: f64,
    /// Most rays that tell what stands between the two nodes of a link. Default value: 256.
    pub rays: u32,
    /// Most bytes of links. Default value: 2 GiB.
    pub memory_limit: usize,
    /// Seed of the sequences. Default value: 0.
    pub seed: u64,
}

impl Default for HierarchicalOptions {
    fn default() -> Self {
        Self {
            error: 0.03,
            tolerance: 5e-4,
            rays: 256,
            memory_limit: 2 << 30,
            seed: 0,
        }
    }
}

/// Share of the mean squared error that a link may have in the first step.
const FIRST_THRESHOLD: f32 = 0.1;
/// What it is divided by from step to step.
const LOWERED_BY: f32 = 4.0;
/// Below this share only the rounding of numbers is left.
const LEAST_THRESHOLD: f32 = 1e-14;
/// Where irradiance is below this share of the mean, errors count the less the darker it is.
const DIM: f32 = 0.05;
/// Sweeps of one step.
const MOST_SWEEPS: u32 = 64;
/// Unshot light is gathered down to this share of the error.
const SHARE_OF_ERROR: f64 = 0.05;
/// Unshot share of which most is the rounding of numbers.
const ROUNDING: f64 = 1e-6;
/// Rays that tell what is lost of light as it starts, and of reflected light in each step.
const FIRST_PROBES: u32 = 1 << 17;
const PROBES: u32 = 1 << 16;
/// Standard errors of what rays say is lost within which factors are believed: where nothing stands between anything, and
/// where something does.
const BELIEVED: [f64; 2] = [5.0, 0.5];
/// Largest relative correction of what arrives by what rays say is lost.
const TRUSTED_CORRECTION: f64 = 0.2;
/// Bytes of a node with its light, beside its channels.
const NODE_BYTES: usize = 160;
/// Links of an element, at least: a mesh for which these do not fit is refused.
const LEAST_LINKS: usize = 4;

/// Radiosity by links between clusters, faces and parts of faces.
#[derive(Debug)]
pub struct Hierarchical {
    solution: Solution,
    options: HierarchicalOptions,
    /// `None` if no element is exposed.
    transport: Option<Transport>,
    /// Of each node.
    links: Vec<Vec<Link>>,
    /// Irradiance before the first step: sun, sky and points, or what another solver brought.
    before: Vec<f32>,
    /// Radiosity that was unshot before the first step.
    start: Vec<f32>,
    /// Irradiance that came over links.
    gathered: Vec<f32>,
    /// Radiosity that it came from.
    shot: Vec<f32>,
    /// Whether all links are between cells that see all of each other.
    is_clear: bool,
    is_positive: bool,
    /// Whether all its light is of this solver.
    is_new: bool,
    /// Lost shares of what was unshot at the start and of reflected light.
    lost: [Lost; 2],
    /// Flux to backs and to nowhere that was booked, by channel.
    booked: [Vec<f64>; 2],
    /// The same as it should be.
    due: [Vec<f64>; 2],
    threshold: f32,
    error: f64,
    /// Links before the last refinement.
    links_before: usize,
    is_at_limit: bool,
    is_exhausted: bool,
}

impl Hierarchical {
    /// Goes on with a solution: what is unshot is spread.
    ///
    /// # Errors
    /// No rays, an error that is not positive, a mesh that takes more memory than allowed.
    pub fn new(
        mut solution: Solution,
        options: HierarchicalOptions,
    ) -> Result<Self, RadiosityError> {
        let mesh = solution.mesh().clone();
        let channels = solution.groups().len() * BANDS;
        check(&mesh, channels, &options)?;
        solution.provenance.solver = "hierarchical".into();
        let tree = Hierarchy::new(&mesh);
        let nodes = tree.as_ref().map_or(0, Hierarchy::len);
        let start = all_channels(&solution, Solution::unshot);
        let seed = hash(options.seed, 1);
        let lost = Lost::probe(&mesh, &start, channels, FIRST_PROBES, hash(seed, 0));
        let transport =
            tree.map(|tree| Transport::new(mesh.clone(), tree, options.rays, hash(seed, 1)));
        let mut links = vec![Vec::new(); nodes];
        if let Some(transport) = &transport {
            links[0].extend(transport.link(0, 0, None, 0));
        }
        Ok(Self {
            before: all_channels(&solution, Solution::irradiance),
            gathered: vec![0.0; start.len()],
            shot: vec![0.0; start.len()],
            is_clear: false,
            is_new: solution.provenance.steps == 0,
            is_positive: start.iter().all(|&b| b >= 0.0),
            lost: [lost, Lost::nothing(channels)],
            booked: [vec![0.0; channels], vec![0.0; channels]],
            due: [vec![0.0; channels], vec![0.0; channels]],
            threshold: FIRST_THRESHOLD * LOWERED_BY,
            error: f64::INFINITY,
            links_before: 1,
            is_at_limit: false,
            is_exhausted: false,
            start,
            links,
            transport,
            options,
            solution,
        })
    }

    /// Estimated relative error of the irradiance, root mean square over the area; infinite before the first step. The
    /// error of light that was there before is not in it.
    pub fn error(&self) -> f64 {
        self.error
    }

    /// The error, if this solver made all the light and knows it.
    pub fn known_error(&self) -> Option<f64> {
        (self.is_new && self.error.is_finite()).then_some(self.error)
    }

    /// Whether links fill the memory that they may take, so that none is refined any more.
    pub fn is_at_limit(&self) -> bool {
        self.is_at_limit
    }

    /// Rays that were cast between nodes.
    pub fn rays(&self) -> u64 {
        self.transport.as_ref().map_or(0, Transport::rays)
    }

    fn mesh(&self) -> &Arc<PatchMesh> {
        self.solution.mesh()
    }

    fn channels(&self) -> usize {
        self.solution.groups().len() * BANDS
    }

    fn link_count(&self) -> usize {
        self.links.iter().map(Vec::len).sum()
    }

    /// What leaves the elements and is or will be carried by links, `[channel][element]`.
    fn outgoing(&self) -> Vec<f32> {
        let reflectance = self.mesh().reflectance();
        let elements = reflectance.len();
        let lit = self.start.par_iter().zip(&self.gathered).enumerate();
        lit.map(|(i, (start, gathered))| {
            start + gathered * reflectance[i % elements][i / elements % BANDS]
        })
        .collect()
    }

    /// One iteration: gathers what leaves the elements now.
    fn sweep(&mut self, transport: &Transport) {
        let outgoing = self.outgoing();
        let radiosity = Radiosity::pull(transport.tree(), &outgoing, self.channels());
        let mut gathered = radiosity.gather(transport, self.mesh(), &self.links);
        if self.is_positive {
            // Nine harmonics may be below zero behind a surface.
            gathered.par_iter_mut().for_each(|h| *h = h.max(0.0));
        }
        self.close(&outgoing, &mut gathered);
        self.gathered = gathered;
        self.shot = outgoing;
    }

    /// Makes what arrives account for what leaves.
    fn close(&mut self, outgoing: &[f32], gathered: &mut [f32]) {
        let mesh = self.mesh().clone();
        let elements = mesh.elements().len();
        let believed = BELIEVED[usize::from(!self.is_clear)];
        for channel in 0..self.channels() {
            let range = channel * elements..(channel + 1) * elements;
            let flux = |values: &[f32], kept: &dyn Fn(usize) -> f64| -> f64 {
                let of = |(e, &b): (usize, &f32)| {
                    f64::from(b) * kept(e) * f64::from(mesh.exposed_area(e))
                };
                values.iter().enumerate().map(of).sum()
            };
            let kept = |e: usize| 1.0 - f64::from(mesh.transmittance()[e][channel % BANDS]);
            let sent = flux(&outgoing[range.clone()], &|_| 1.0);
            let started = flux(&self.start[range.clone()], &|_| 1.0);
            let received = flux(&gathered[range.clone()], &kept);
            let fluxes = [started, sent - started];
            let [backs, escaped] = [0, 1].map(|way| -> f64 {
                let share = |lost: &Lost| [&lost.backs, &lost.escaped][way][channel];
                let pairs = self.lost.iter().zip(fluxes);
                pairs.map(|(lost, flux)| flux * share(lost)).sum()
            });
            // Factors are believed as far as rays do not speak against them.
            let errors = self.lost.iter().zip(fluxes);
            let reach = errors.fold(0.0, |sum: f64, (lost, flux)| {
                sum.hypot(believed * flux * lost.error(channel))
            });
            let (least, most) = (backs + escaped - reach, backs + escaped + reach);
            let gone = (sent - received).max(least).min(most);
            let scale = (sent - gone) / received;
            let (scale, gone) = if (scale - 1.0).abs() <= TRUSTED_CORRECTION {
                (scale, gone)
            } else {
                (1.0, sent - received)
            };
            let lost = split(gone, [backs, escaped]);
            let scale = to_f32(scale);
            gathered[range].iter_mut().for_each(|h| *h *= scale);
            self.due[0][channel] = lost[0];
            self.due[1][channel] = lost[1];
        }
    }

    /// `A_r / (A H_r²)` of each node, where `H` is the magnitude of irradiance over all channels; see [`weight`].
    fn weights(&self, tree: &Hierarchy) -> Vec<f32> {
        let elements = self.mesh().elements().len();
        let magnitude = |e: usize| {
            let total = |c: usize| self.before[c * elements + e] + self.gathered[c * elements + e];
            let sum: f32 = (0..self.channels()).map(|c| total(c).abs()).sum();
            sum / BANDS as f32
        };
        let mut irradiance = vec![0.0; tree.len()];
        for id in (0..crate::index32(tree.len())).rev() {
            let node = tree.node(id);
            irradiance[id as usize] = match node.element {
                Some(element) => magnitude(element as usize),
                None => {
                    let children = tree.children(id);
                    let flux = |child: u32| irradiance[child as usize] * tree.node(child).area;
                    children.map(flux).sum::<f32>() / node.area
                }
            };
        }
        let is_first = self.gathered.iter().all(|&h| h == 0.0);
        let expected = self.expected_irradiance(tree.node(0).area);
        let mean = irradiance[0].max(if is_first { expected } else { 0.0 });
        let all = tree.node(0).area;
        let nodes = tree.nodes().iter().zip(irradiance);
        nodes
            .map(|(node, h)| node.area / all * weight(if is_first { mean } else { h }, mean))
            .collect()
    }

    /// Mean irradiance by what starts, as if the scene were closed and equally bright.
    fn expected_irradiance(&self, area: f32) -> f32 {
        let mesh = self.mesh();
        let elements = mesh.elements().len();
        let mean = |of: &dyn Fn(usize) -> f32| -> f32 {
            let flux = (0..elements).map(|e| f64::from(of(e) * mesh.exposed_area(e)));
            to_f32(flux.sum::<f64>() / f64::from(area))
        };
        let started = mean(&|e| {
            let values = (0..self.channels()).map(|c| self.start[c * elements + e].abs());
            values.sum::<f32>() / BANDS as f32
        });
        let reflectance = mean(&|e| mesh.reflectance()[e].to_array().iter().sum::<f32>() / 3.0);
        started / (1.0 - reflectance).max(0.05)
    }

    /// Lowers the threshold and refines by it.
    fn refine(&mut self, transport: &Transport) {
        let count = self.link_count();
        let growth = count as f64 / self.links_before as f64;
        let most = self.options.memory_limit / size_of::<Link>();
        if count as f64 * growth.clamp(1.0, 8.0) > most as f64 {
            self.is_at_limit = true;
            return;
        }
        self.threshold /= LOWERED_BY;
        self.links_before = count;
        let (radiosity, weights) = self.light(transport);
        let oracle = Oracle {
            transport,
            radiosity: &radiosity,
            weights: &weights,
            threshold: self.threshold,
        };
        refine::refine(&oracle, &mut self.links);
    }

    /// Whether nothing stands between anything that is linked.
    fn sees_everything(&self, tree: &Hierarchy) -> bool {
        let is_cell = |node: u32| !tree.node(node).is_cluster();
        let sees = |link: &Link| is_cell(link.source) && link.seen().0 == Seen::Clear;
        let mut of_nodes = (0..crate::index32(tree.len())).zip(&self.links);
        of_nodes.all(|(id, links)| links.is_empty() || is_cell(id) && links.iter().all(sees))
    }

    /// What the oracle looks at.
    fn light(&self, transport: &Transport) -> (Radiosity, Vec<f32>) {
        let tree = transport.tree();
        let radiosity = Radiosity::pull(tree, &self.outgoing(), self.channels());
        (radiosity, self.weights(tree))
    }

    /// The error of all links.
    fn estimate(&mut self, transport: &Transport) {
        let (radiosity, weights) = self.light(transport);
        let oracle = Oracle {
            transport,
            radiosity: &radiosity,
            weights: &weights,
            threshold: self.threshold,
        };
        let of_node = |(id, links): (usize, &Vec<Link>)| -> f64 {
            let parts = |link| oracle.parts(crate::index32(id), link);
            let shares = links.iter().flat_map(parts).map(f64::from);
            shares.sum()
        };
        let squares: Vec<f64> = self.links.par_iter().enumerate().map(of_node).collect();
        self.error = squares.iter().sum::<f64>().sqrt();
    }

    /// Gathers until little is unshot beside the error.
    fn gather(&mut self, transport: &Transport) {
        let wanted = if self.error <= self.options.error {
            self.options.tolerance
        } else {
            self.options
                .tolerance
                .max(SHARE_OF_ERROR * self.error.min(1.0))
        };
        let mut left = f64::INFINITY;
        for sweep in 0..MOST_SWEEPS {
            self.sweep(transport);
            if sweep == 0 {
                self.probe();
            }
            let unshot = self.unshot();
            if unshot <= wanted.max(ROUNDING) || (unshot > 0.99 * left && unshot < 1e-3) {
                break;
            }
            left = unshot;
        }
    }

    /// Rays tell what is lost of reflected light.
    fn probe(&mut self) {
        let outgoing = self.outgoing();
        let reflected: Vec<f32> = outgoing
            .iter()
            .zip(&self.start)
            .map(|(b, s)| b - s)
            .collect();
        let seed = hash(self.options.seed, 2);
        let mesh = self.mesh().clone();
        self.lost[1] = Lost::probe(&mesh, &reflected, self.channels(), PROBES, seed);
    }

    /// Unshot share of the emitted flux.
    fn unshot(&self) -> f64 {
        let mesh = self.mesh();
        let elements = mesh.elements().len();
        let pairs = self.outgoing();
        let flux = |(i, (new, old)): (usize, (&f32, &f32))| {
            f64::from((new - old).abs()) * f64::from(mesh.exposed_area(i % elements))
        };
        let unshot: f64 = pairs.iter().zip(&self.shot).enumerate().map(flux).sum();
        let reference = self.solution.reference_flux();
        if reference > 0.0 {
            unshot / reference
        } else {
            0.0
        }
    }

    /// Brings the solution up to date.
    fn write(&mut self) {
        let add = |(a, b): (&f32, &f32)| a + b;
        let irradiance: Vec<f32> = self.before.iter().zip(&self.gathered).map(add).collect();
        let outgoing = self.outgoing();
        let left = |(new, old): (&f32, &f32)| new - old;
        let unshot: Vec<f32> = outgoing.iter().zip(&self.shot).map(left).collect();
        let change = |way: usize| -> Vec<f64> {
            let pairs = self.due[way].iter().zip(&self.booked[way]);
            pairs.map(|(due, booked)| due - booked).collect()
        };
        let (backs, escaped) = (change(0), change(1));
        self.solution
            .replace_light(&irradiance, &unshot, &backs, &escaped);
        self.booked = self.due.clone();
    }

    /// A step with the transport taken out.
    fn advance(&mut self, transport: &Transport) {
        let wants_more = self.error > self.options.error;
        if wants_more && !self.is_at_limit {
            self.refine(transport);
        }
        self.is_clear = self.sees_everything(transport.tree());
        self.gather(transport);
        self.estimate(transport);
        self.write();
        let cannot_refine = self.is_at_limit || self.threshold < LEAST_THRESHOLD;
        self.is_exhausted = self.is_done() || (wants_more && cannot_refine);
    }

    fn is_done(&self) -> bool {
        let unshot = self.solution.unshot_fraction();
        self.error <= self.options.error && unshot <= self.options.tolerance.max(ROUNDING)
    }
}

impl Solver for Hierarchical {
    fn step(&mut self) -> Progress {
        if let (Some(transport), false) = (self.transport.take(), self.is_exhausted) {
            self.advance(&transport);
            self.transport = Some(transport);
        }
        self.solution.provenance.steps += 1;
        self.progress()
    }

    fn progress(&self) -> Progress {
        let unshot = self.solution.unshot_fraction();
        Progress {
            iteration: self.solution.provenance.steps,
            unshot,
            residual: if self.is_exhausted {
                0.0
            } else {
                f64::MIN_POSITIVE.max(unshot)
            },
            noise: Some(self.error),
        }
    }

    /// It is at its error, not at a share of unshot light alone.
    fn is_finished(&self, _tolerance: f64) -> bool {
        self.is_exhausted || self.transport.is_none() || self.solution.reference_flux() <= 0.0
    }

    fn is_exhausted(&self) -> bool {
        self.is_exhausted
    }

    fn solution(&self) -> &Solution {
        &self.solution
    }

    fn into_solution(self) -> Solution {
        self.solution
    }
}

/// Refuses options that are none, and meshes whose hierarchy does not fit.
fn check(
    mesh: &PatchMesh,
    channels: usize,
    options: &HierarchicalOptions,
) -> Result<(), RadiosityError> {
    let fail = |message: String| Err(RadiosityError::Option(message));
    if options.rays == 0 {
        return fail(String::from(
            "a hierarchical solver needs at least one ray for each link",
        ));
    }
    if options.error.is_nan() || options.error <= 0.0 {
        return fail(String::from("the error to stop at must be more than 0"));
    }
    let elements = mesh.elements().len();
    // Interior nodes are a third of those of a quadtree, and one more for each face.
    let of_element = 2 * (NODE_BYTES + channels * 20) + LEAST_LINKS * size_of::<Link>();
    let needed = elements.saturating_mul(of_element);
    if needed > options.memory_limit {
        let mib = |bytes: usize| bytes.div_ceil(1 << 20);
        return fail(format!(
            "a hierarchy over {elements} elements takes {} MiB or more, {} MiB are allowed; use at most {} elements",
            mib(needed),
            mib(options.memory_limit),
            options.memory_limit / of_element
        ));
    }
    Ok(())
}

/// `1 / H²`: errors are relative to the light that is there. In the dark they are relative to the mean: backs of walls
/// and insides of things that nobody sees are not worth the work that they would take.
fn weight(irradiance: f32, mean: f32) -> f32 {
    let least = DIM * mean;
    let relative = if irradiance >= least {
        irradiance
    } else {
        // It goes on from the limit, and falls to that of the mean.
        least * least / irradiance.max(least * DIM)
    };
    1.0 / (relative * relative).max(1e-30)
}

/// A flux in proportion to two others that are known roughly; all of it to the second where they are not.
fn split(flux: f64, roughly: [f64; 2]) -> [f64; 2] {
    let share = flux / (roughly[0] + roughly[1]);
    let parts = roughly.map(|part| part * share);
    if parts.iter().all(|part| part.is_finite()) {
        parts
    } else {
        [0.0, flux]
    }
}

/// All channels of something, one after the other.
fn all_channels(solution: &Solution, of: fn(&Solution, usize, usize) -> &[f32]) -> Vec<f32> {
    let channels = 0..solution.groups().len() * BANDS;
    channels
        .flat_map(|c| of(solution, c / BANDS, c % BANDS).iter().copied())
        .collect()
}
