//! Many segments at once.

use super::ray::Ray;
use super::wide_bvh::{Stack, WideBvh};
use glam::Vec3;

/// Rays on their way at the same time.
const RAYS: usize = 32;

/// Ray numbers in the order in which they came.
#[derive(Debug, Clone, Copy)]
struct Queue {
    /// At most half of it is used.
    rays: [u8; 2 * RAYS],
    len: usize,
}

impl Queue {
    const EMPTY: Self = Self {
        rays: [0; 2 * RAYS],
        len: 0,
    };

    /// Adds a ray if a condition holds. Written it is in any case, which spares a branch.
    #[inline(always)]
    fn push_if(&mut self, condition: bool, ray: u8) {
        self.rays[self.len % (2 * RAYS)] = ray;
        self.len += usize::from(condition);
    }
}

/// The rays under way, by what each has to do next.
struct Rays {
    rays: [Ray; RAYS],
    stacks: [Stack; RAYS],
    /// Number of the segment of each.
    segments: [usize; RAYS],
    at_nodes: Queue,
    at_packs: Queue,
    done: Queue,
}

impl Rays {
    /// Puts a ray into the queue of its next step.
    #[inline(always)]
    fn enqueue(&mut self, ray: u8) {
        let next = self.stacks[usize::from(ray) % RAYS].next_is_pack();
        self.at_nodes.push_if(next == Some(false), ray);
        self.at_packs.push_if(next == Some(true), ray);
        self.done.push_if(next.is_none(), ray);
    }
}

impl WideBvh {
    /// Whether nothing lies between the two points of each segment.
    ///
    /// ```text
    /// while rays are left
    ///     start new rays in place of those that are done
    ///     every ray that is at a node tests its boxes, every ray that is at a pack tests its quads
    /// ```
    ///
    /// What a ray meets next cannot be foreseen, and a processor that follows one ray stalls at every step, for the
    /// guess that was wrong and for the memory that was not at hand. Here a step of one ray does not wait for that of
    /// the next. Sorting the segments by octant and Morton code of their origins makes the walk a few
    /// percent faster and costs more than that.
    pub(super) fn clear_segments(&self, segments: &[(Vec3, Vec3)], clear: &mut [bool]) {
        clear.fill(true);
        let mut rays = Box::new(Rays {
            rays: [Ray::default(); RAYS],
            stacks: [Stack::EMPTY; RAYS],
            segments: [0; RAYS],
            at_nodes: Queue::EMPTY,
            at_packs: Queue::EMPTY,
            done: Queue::EMPTY,
        });
        for ray in (0..).take(RAYS) {
            rays.done.push_if(true, ray);
        }
        let mut waiting = segments.iter().enumerate();
        loop {
            self.start(&mut rays, &mut waiting);
            if rays.at_nodes.len + rays.at_packs.len == 0 {
                break;
            }
            let at_nodes = core::mem::replace(&mut rays.at_nodes, Queue::EMPTY);
            for &ray in &at_nodes.rays[..at_nodes.len] {
                let slot = usize::from(ray) % RAYS;
                self.visit_node(&rays.rays[slot], &mut rays.stacks[slot]);
                rays.enqueue(ray);
            }
            let at_packs = core::mem::replace(&mut rays.at_packs, Queue::EMPTY);
            for &ray in &at_packs.rays[..at_packs.len] {
                let slot = usize::from(ray) % RAYS;
                if self.visit_pack(&rays.rays[slot], &mut rays.stacks[slot]) {
                    clear[rays.segments[slot]] = false;
                    rays.stacks[slot].clear();
                }
                rays.enqueue(ray);
            }
        }
    }

    fn start<'a>(
        &self,
        rays: &mut Rays,
        waiting: &mut impl Iterator<Item = (usize, &'a (Vec3, Vec3))>,
    ) {
        while rays.done.len > 0 {
            let Some((number, &(from, to))) = waiting.next() else {
                return;
            };
            rays.done.len -= 1;
            let ray = rays.done.rays[rays.done.len % RAYS];
            let slot = usize::from(ray) % RAYS;
            rays.rays[slot] = Ray::between(from, to, self.extent());
            rays.stacks[slot].restart();
            rays.segments[slot] = number;
            rays.at_nodes.push_if(true, ray);
        }
    }
}
