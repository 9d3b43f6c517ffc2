//! The chain of patches: a frame in the middle patch, carried to both sides.
//!
//! The frame sits in the middle patch, so that what a strain or a joint moves
//! is at most half of the strip. Each other patch is anchored at the ruling
//! that it shares with its neighbour towards the middle.

use crate::geometry::cone::{Foot, Frame, Strain};
use nalgebra::{Point3, Vector3};

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
    /// Where on these two rulings the base line should pass.
    pub(super) lambda: [f64; 2],
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
            lambda: [0.0; 2],
        };
        self.frames().into_iter().enumerate().map(part).collect()
    }

    /// Links patches: each is moved so that its first ruling lies on the last
    /// of its neighbour towards the middle, the middle one stays.
    pub(super) fn link(parts: &[Part]) -> Chain {
        let middle = middle(parts);
        let mut chain = Chain {
            root: parts[middle].frame,
            middle,
            strains: Vec::with_capacity(parts.len()),
            reach: Vec::with_capacity(parts.len()),
            slides: vec![0.0; parts.len() - 1],
        };
        for (i, part) in parts.iter().enumerate() {
            let anchor = anchor(part, i, middle);
            let speed = part.strain.speed(anchor.1);
            chain.strains.push(part.strain.slid(anchor.1));
            chain.reach.push(part.arc.map(|a| (a - anchor.0) * speed));
            if i >= middle && i + 1 < parts.len() {
                chain.slides[i] = part.lambda[1] - anchor.1;
            }
            if i <= middle && i > 0 {
                chain.slides[i - 1] = part.lambda[0] - anchor.1;
            }
            if i == middle {
                chain.root = part.frame.carried(part.strain, anchor.0).slid(anchor.1);
            }
        }
        chain
    }

    /// The same surface with its root in the middle and its base lines where
    /// `lambda` says, at the first and last ruling of each patch.
    pub(super) fn rebased(&self, lambda: &[[f64; 2]]) -> Chain {
        let mut parts = self.parts();
        parts
            .iter_mut()
            .zip(lambda)
            .for_each(|(p, l)| p.lambda = *l);
        Chain::link(&parts)
    }

    /// The same surface with one patch cut in two.
    pub(super) fn split(&self, patch: usize) -> Chain {
        let mut parts = self.parts();
        let whole = parts[patch];
        let half = 0.5 * (whole.arc[0] + whole.arc[1]);
        parts[patch].arc[1] = half;
        let mut second = whole;
        second.arc[0] = half;
        parts.insert(patch + 1, second);
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

/// Arc and λ of a patch's anchor.
fn anchor(part: &Part, i: usize, middle: usize) -> (f64, f64) {
    match i.cmp(&middle) {
        std::cmp::Ordering::Less => (part.arc[1], part.lambda[1]),
        std::cmp::Ordering::Greater => (part.arc[0], part.lambda[0]),
        std::cmp::Ordering::Equal => {
            let half = |a: [f64; 2]| 0.5 * (a[0] + a[1]);
            (half(part.arc), half(part.lambda))
        }
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
