//! The best chain for each number of patches.

use super::chain::Chain;
use super::engine::{Effort, Fitted, Sample};
use super::problem::Freedom;
use super::segments::{Aim, Segments};
use crate::methods::Control;
use crate::solver::Stop;
use rayon::prelude::*;

/// All starts go so far; the best goes on.
const RACE: Effort = Effort {
    iterations: 12,
    reduction: 1e-3,
    smoothing: 0.0,
};
/// A root mean square below this is rounding.
const EXACT: f64 = 1e-13;

/// Chains by their number of patches, solved on demand.
pub(super) struct Ladder<'a> {
    pub(super) sample: &'a Sample,
    pub(super) segments: &'a Segments,
    /// Whether patches may have a g and a k.
    pub(super) free: [bool; 2],
    pub(super) control: &'a dyn Control,
    rungs: Vec<Option<Rung>>,
}

/// What was found for one number of patches.
#[derive(Debug, Clone)]
pub(super) struct Rung {
    /// By least squares.
    pub(super) fitted: Fitted,
    /// Another minimum, with a smaller largest distance in the race.
    pub(super) other: Option<Fitted>,
}

impl<'a> Ladder<'a> {
    pub(super) fn new(
        (sample, segments): (&'a Sample, &'a Segments),
        free: [bool; 2],
        control: &'a dyn Control,
    ) -> Self {
        Ladder {
            sample,
            segments,
            free,
            control,
            rungs: vec![None; segments.most()],
        }
    }

    /// The most patches there can be.
    pub(super) fn most(&self) -> usize {
        self.rungs.len()
    }

    /// Which unknowns a chain of so many patches has.
    pub(super) fn freedom(&self, patches: usize) -> Freedom {
        Freedom {
            strains: vec![self.free; patches],
            joints: true,
        }
    }

    /// What was solved, by number of patches.
    pub(super) fn solved(&self) -> impl Iterator<Item = (usize, &Rung)> {
        (1..)
            .zip(&self.rungs)
            .filter_map(|(k, r)| r.as_ref().map(|r| (k, r)))
    }

    /// The chain of so many patches.
    ///
    /// # Errors
    /// When the control says so.
    pub(super) fn rung(&mut self, patches: usize) -> Result<Rung, Stop> {
        self.solve(&[patches])?;
        match &self.rungs[patches - 1] {
            Some(rung) => Ok(rung.clone()),
            None => self.race(patches),
        }
    }

    /// Solves several numbers of patches in parallel; then none is worse than
    /// the one below it, where that is known.
    ///
    /// # Errors
    /// When the control says so.
    pub(super) fn solve(&mut self, counts: &[usize]) -> Result<(), Stop> {
        let missing = |k: &&usize| self.rungs[**k - 1].is_none();
        let wanted: Vec<usize> = counts.iter().filter(missing).copied().collect();
        let solved = wanted
            .par_iter()
            .map(|k| self.race(*k))
            .collect::<Result<Vec<_>, Stop>>()?;
        for (k, rung) in wanted.iter().zip(solved) {
            self.rungs[k - 1] = Some(rung);
        }
        for k in 2..=self.most() {
            self.keep_order(k)?;
        }
        Ok(())
    }

    /// Where more patches are worse, the better chain is split instead.
    fn keep_order(&mut self, patches: usize) -> Result<(), Stop> {
        let (Some(below), Some(here)) = (&self.rungs[patches - 2], &self.rungs[patches - 1]) else {
            return Ok(());
        };
        let worse = here.fitted.worth(self.sample) > below.fitted.worth(self.sample);
        if !worse || below.fitted.worth(self.sample) < EXACT {
            return Ok(());
        }
        let start = below.fitted.split_at_worst(self.sample);
        let fitted = start.relaxed(
            self.sample,
            &self.freedom(patches),
            Effort::FULL,
            self.control,
        )?;
        // The cut chain itself is as good as the one below.
        let candidates = [fitted, start];
        let [relaxed, cut] = candidates.each_ref().map(|f| f.worth(self.sample));
        let [fitted, start] = candidates;
        let better = if relaxed <= cut { fitted } else { start };
        if better.worth(self.sample) < here.fitted.worth(self.sample) {
            self.rungs[patches - 1] = Some(Rung {
                fitted: better,
                other: None,
            });
        }
        Ok(())
    }

    /// The best of several starts, followed to its minimum.
    fn race(&self, patches: usize) -> Result<Rung, Stop> {
        let freedom = self.freedom(patches);
        let run = |(chain, homes): (Chain, Vec<u32>)| {
            let chain = self.restricted(chain);
            Fitted::settle(self.sample, &chain, &homes).relaxed(
                self.sample,
                &freedom,
                RACE,
                self.control,
            )
        };
        let starts = [(Aim::Sum, true), (Aim::Max, true), (Aim::Sum, false)];
        let raced = starts
            .iter()
            .map(|(aim, averaged)| run(self.segments.chain(*aim, patches, *averaged)))
            .collect::<Result<Vec<_>, Stop>>()?;
        let least = |value: &dyn Fn(&Fitted) -> f64| {
            (0..raced.len()).min_by(|a, b| value(&raced[*a]).total_cmp(&value(&raced[*b])))
        };
        let follow = |i: usize| raced[i].relaxed(self.sample, &freedom, Effort::FULL, self.control);
        let first = least(&|f| f.worth(self.sample)).unwrap_or(0);
        let second = least(&|f| f.max().max(f.worth(self.sample))).filter(|i| *i != first);
        let fitted = follow(first)?;
        let other = second.map(follow).transpose()?;
        Ok(match other {
            Some(o) if o.worth(self.sample) < fitted.worth(self.sample) => Rung {
                fitted: o,
                other: Some(fitted),
            },
            other => Rung { fitted, other },
        })
    }

    /// A start without what is not allowed.
    fn restricted(&self, mut chain: Chain) -> Chain {
        for strain in &mut chain.strains {
            if !self.free[0] {
                strain.g = 0.0;
            }
            if !self.free[1] {
                strain.k = 0.0;
            }
        }
        chain
    }
}
