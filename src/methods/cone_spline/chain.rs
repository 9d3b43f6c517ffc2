//! The chain of patches: a frame in the middle patch, carried to both sides.
//!
//! The frame sits in the middle patch, so that what a strain or a joint moves
//! is at most half of the strip. Each other patch is anchored at the ruling
//! that it shares with its neighbour towards the middle.

use crate::geometry::cone::{Foot, Frame, Strain};
use nalgebra::{Point3, Vector3};
use std::cmp::Ordering;

/// A G¹ chain of patches.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Chain {
    /// On a ruling inside the middle patch.
    pub(super) root: Frame,
    /// Which patch holds the root.
    pub(super) middle: usize,
    /// Of each patch at its anchor.
    pub(super) strains: Vec<Strain>,
    /// Arcs from each patch's anchor to its first and last ruling. The first
    /// of all and the last of all say how far the strip goes.
    pub(super) reach: Vec<[f64; 2]>,
    /// Slide along the ruling at each joint, going away from the middle.
    pub(super) slides: Vec<f64>,
}

/// One patch by itself: what a chain is linked from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Part {
    /// Any frame of its surface.
    pub(super) frame: Frame,
    /// The strain there.
    pub(super) strain: Strain,
    /// Arcs to its first and last ruling.
    pub(super) arc: [f64; 2],
    /// λ of its base line.
    pub(super) base: f64,
    /// λ of the point of its first ruling that it shares with the patch
    /// before, and of the point of its last that it shares with the next.
    pub(super) shared: [f64; 2],
}

impl Chain {
    /// The patches' anchors.
    pub(super) fn frames(&self) -> Vec<Frame> {
        let mut frames = vec![self.root; self.strains.len()];
        for i in self.middle + 1..frames.len() {
            let there = frames[i - 1].carried(self.strains[i - 1], self.reach[i - 1][1]);
            frames[i] = there.slid(self.slides[i - 1]);
        }
        for i in (0..self.middle).rev() {
            let there = frames[i + 1].carried(self.strains[i + 1], self.reach[i + 1][0]);
            frames[i] = there.slid(self.slides[i]);
        }
        frames
    }

    /// λ on a joint's ruling as the patch before it counts, less that as the
    /// patch after it does.
    pub(super) fn offset(&self, joint: usize) -> f64 {
        if joint >= self.middle {
            self.slides[joint]
        } else {
            -self.slides[joint]
        }
    }

    /// Number of patches.
    pub(super) fn len(&self) -> usize {
        self.strains.len()
    }

    /// The patches one by one, base lines as they are.
    pub(super) fn parts(&self) -> Vec<Part> {
        let part = |(i, frame): (usize, Frame)| Part {
            frame,
            strain: self.strains[i],
            arc: self.reach[i],
            base: 0.0,
            shared: [
                if 0 < i && i <= self.middle {
                    self.slides[i - 1]
                } else {
                    0.0
                },
                if self.middle <= i && i < self.slides.len() {
                    self.slides[i]
                } else {
                    0.0
                },
            ],
        };
        self.frames().into_iter().enumerate().map(part).collect()
    }

    /// Links patches: each is moved so that it shares its ruling and its point
    /// with its neighbour towards the middle; the middle one stays.
    pub(super) fn link(parts: &[Part]) -> Chain {
        let middle = middle(parts);
        let anchors: Vec<f64> = (0..parts.len())
            .map(|i| anchor(&parts[i], i, middle))
            .collect();
        let root = &parts[middle];
        let slide = |(i, pair): (usize, &[Part])| {
            let [a, b] = [&pair[0], &pair[1]];
            let along = (a.shared[1] - a.base) - (b.shared[0] - b.base);
            if i >= middle { along } else { -along }
        };
        let at_base = |part: &Part| part.strain.slid(part.base);
        let reach = |(part, anchor): (&Part, &f64)| {
            let speed = part.strain.speed(part.base);
            part.arc.map(|a| (a - anchor) * speed)
        };
        Chain {
            root: root
                .frame
                .carried(root.strain, anchors[middle])
                .slid(root.base),
            middle,
            strains: parts.iter().map(at_base).collect(),
            reach: parts.iter().zip(&anchors).map(reach).collect(),
            slides: parts.windows(2).enumerate().map(slide).collect(),
        }
    }

    /// The same surface with its root in the middle and the base line of each
    /// patch at a given λ.
    pub(super) fn rebased(&self, bases: &[f64]) -> Chain {
        let mut parts = self.parts();
        parts.iter_mut().zip(bases).for_each(|(p, b)| p.base = *b);
        Chain::link(&parts)
    }

    /// The same surface with one patch cut in two.
    pub(super) fn split(&self, patch: usize) -> Chain {
        let mut parts = self.parts();
        let whole = parts[patch];
        let half = 0.5 * (whole.arc[0] + whole.arc[1]);
        parts[patch].arc[1] = half;
        parts[patch].shared[1] = 0.0;
        let mut second = whole;
        second.arc[0] = half;
        second.shared[0] = 0.0;
        parts.insert(patch + 1, second);
        Chain::link(&parts)
    }

    /// A patch and the next as one that turns and bends by as much as both.
    pub(super) fn merged(&self, patch: usize) -> Chain {
        let mut parts = self.parts();
        let second = parts.remove(patch + 1);
        let first = &mut parts[patch];
        let length = |p: &Part| p.arc[1] - p.arc[0];
        let (a, b) = (length(first), length(&second));
        // λ on the second of the first's base line.
        let offset = second.shared[0] - first.shared[1];
        let whole = a + b * second.strain.speed(offset);
        *first = Part {
            frame: first.frame.carried(first.strain, first.arc[0]),
            strain: Strain {
                g: (first.strain.g * a + second.strain.g * b) / whole,
                k: (first.strain.k * a + second.strain.k * b) / whole,
            },
            arc: [0.0, whole],
            base: 0.0,
            shared: [first.shared[0], second.shared[1] - offset],
        };
        Chain::link(&parts)
    }

    /// The chain moved, turned and scaled: `x ↦ scale·(R x) + shift` by its
    /// effect on points and directions.
    pub(super) fn scaled(&self, scale: f64, shift: &Vector3<f64>) -> Chain {
        let strain = |s: &Strain| Strain {
            g: s.g / scale,
            k: s.k / scale,
        };
        Chain {
            root: Frame {
                point: self.root.point * scale + shift,
                ..self.root
            },
            middle: self.middle,
            strains: self.strains.iter().map(strain).collect(),
            reach: self.reach.iter().map(|r| r.map(|a| a * scale)).collect(),
            slides: self.slides.iter().map(|d| d * scale).collect(),
        }
    }
}

/// The patch that holds half of the length.
fn middle(parts: &[Part]) -> usize {
    let lengths = || parts.iter().map(|p| p.arc[1] - p.arc[0]);
    let half = 0.5 * lengths().sum::<f64>();
    let mut before = 0.0;
    lengths()
        .position(|length| {
            before += length;
            before >= half
        })
        .unwrap_or(parts.len() / 2)
}

/// Arc of a patch's anchor.
fn anchor(part: &Part, i: usize, middle: usize) -> f64 {
    match i.cmp(&middle) {
        Ordering::Less => part.arc[1],
        Ordering::Greater => part.arc[0],
        Ordering::Equal => 0.5 * (part.arc[0] + part.arc[1]),
    }
}

/// A chain with its frames worked out, to look for feet on.
#[derive(Debug, Clone)]
pub(super) struct Placed {
    pub(super) frames: Vec<Frame>,
    pub(super) strains: Vec<Strain>,
    pub(super) reach: Vec<[f64; 2]>,
}

impl Placed {
    pub(super) fn new(chain: &Chain) -> Self {
        Placed {
            frames: chain.frames(),
            strains: chain.strains.clone(),
            reach: chain.reach.clone(),
        }
    }

    /// The foot of a point on one patch, the turn nearest to its middle.
    pub(super) fn foot_on(&self, point: &Point3<f64>, patch: usize) -> Foot {
        let [low, high] = self.reach[patch];
        Foot::of(
            point,
            &self.frames[patch],
            self.strains[patch],
            0.5 * (low + high),
        )
    }

    /// The patch that a point belongs to, walked to from another, and its
    /// foot there. The first and the last patch go on past their ends.
    pub(super) fn foot(&self, point: &Point3<f64>, from: usize) -> (usize, Foot) {
        let (mut patch, mut heading) = (from, 0_i8);
        let last = self.frames.len() - 1;
        loop {
            let foot = self.foot_on(point, patch);
            let [low, high] = self.reach[patch];
            // Once it turns back, the point lies at the joint.
            if foot.arc < low && patch > 0 && heading <= 0 {
                (patch, heading) = (patch - 1, -1);
            } else if foot.arc > high && patch < last && heading >= 0 {
                (patch, heading) = (patch + 1, 1);
            } else {
                return (patch, foot);
            }
        }
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    pub(in super::super) fn chain() -> Chain {
        let root = Frame::new(
            Point3::new(0.1, 0.2, 0.3),
            Vector3::new(0.3, 1.0, -0.2),
            Vector3::new(0.8, 0.1, 0.6),
        );
        let strain = |[g, k]: [f64; 2]| Strain { g, k };
        Chain {
            root: root.expect("not parallel"),
            middle: 1,
            strains: [[0.5, 1.5], [0.0, 0.9], [-0.4, -1.1], [0.3, 0.0]]
                .map(strain)
                .to_vec(),
            reach: vec![[-0.5, 0.0], [-0.3, 0.4], [0.0, 0.6], [0.0, 0.4]],
            slides: vec![0.2, -0.1, 0.15],
        }
    }

    /// Both joint rulings of each patch, as lines: where they lie and whither.
    fn rulings(chain: &Chain) -> Vec<(Point3<f64>, Vector3<f64>)> {
        let frames = chain.frames();
        let ends = (0..chain.len()).flat_map(|i| {
            let end = |e: usize| frames[i].carried(chain.strains[i], chain.reach[i][e]);
            [end(0), end(1)]
        });
        ends.map(|f| (f.at(-f.point.coords.dot(&f.ruling)), f.ruling))
            .collect()
    }

    fn agree(a: &[(Point3<f64>, Vector3<f64>)], b: &[(Point3<f64>, Vector3<f64>)]) -> bool {
        let near = |(i, (p, r)): (usize, &(Point3<f64>, Vector3<f64>))| {
            (p - b[i].0).norm() + (r - b[i].1).norm() < 1e-13
        };
        a.len() == b.len() && a.iter().enumerate().all(near)
    }

    #[test]
    fn neighbours_share_their_ruling() {
        let lines = rulings(&chain());
        for joint in lines[1..7].chunks(2) {
            assert!(agree(&joint[..1], &joint[1..]));
        }
    }

    #[test]
    fn offsets_lead_from_one_base_line_to_the_next() {
        let c = chain();
        let frames = c.frames();
        for joint in 0..3 {
            let end = frames[joint].carried(c.strains[joint], c.reach[joint][1]);
            let start = frames[joint + 1].carried(c.strains[joint + 1], c.reach[joint + 1][0]);
            let apart = end.at(0.3) - start.at(0.3 - c.offset(joint));
            assert!(apart.norm() < 1e-14, "{joint}");
        }
    }

    #[test]
    fn parts_link_to_the_same_chain_whatever_the_base_lines() {
        let c = chain();
        let same = Chain::link(&c.parts());
        assert!(agree(&rulings(&c), &rulings(&same)));
        let moved = c.rebased(&[0.1, -0.2, 0.3, 0.05]);
        assert!(agree(&rulings(&c), &rulings(&moved)));
        let speed = c.strains[2].speed(0.3);
        assert!((moved.strains[2].k - c.strains[2].k / speed).abs() < 1e-15);
    }

    #[test]
    fn a_cut_patch_is_the_same_surface() {
        for patch in 0..4 {
            let cut = chain().split(patch);
            assert_eq!(cut.len(), 5);
            let mut lines = rulings(&cut);
            lines.drain(2 * patch + 1..2 * patch + 3);
            assert!(agree(&rulings(&chain()), &lines), "patch {patch}");
        }
    }

    #[test]
    fn two_halves_merge_to_the_patch_that_was_cut() {
        for patch in 0..4 {
            let merged = chain().split(patch).merged(patch);
            assert!(agree(&rulings(&chain()), &rulings(&merged)), "{patch}");
        }
    }
}
