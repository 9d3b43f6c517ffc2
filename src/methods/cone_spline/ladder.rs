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
    allowed: 0.0,
    power: None,
    slowest: None,
};
/// With few patches for its shape a strip is easily rolled up round an apex
/// beside it: then the apices are held off at first.
const CAREFUL: Effort = Effort {
    iterations: 30,
    slowest: Some(0.5),
    ..RACE
};
/// A root mean square below this is rounding.
const EXACT: f64 = 1e-13;

/// Patches that are split, and pairs that are made one, to leave a minimum.
const TRIED: usize = 3;
/// Other minima that are kept.
const OTHERS: usize = 5;
/// Minima whose errors differ by less than this share are one.
const SAME: f64 = 1e-3;

/// Chains by their number of patches, solved on demand.
pub(super) struct Ladder<'a> {
    pub(super) sample: &'a Sample,
    pub(super) segments: &'a Segments,
    /// Whether patches may have a g and a k.
    pub(super) free: [bool; 2],
    pub(super) control: &'a dyn Control,
    rungs: Vec<Option<Rung>>,
    /// Whether a number was tried from its neighbours.
    improved: Vec<bool>,
}

/// What was found for one number of patches.
#[derive(Debug, Clone)]
pub(super) struct Rung {
    /// By least squares.
    pub(super) fitted: Fitted,
    /// Other minima, the best first.
    pub(super) others: Vec<Fitted>,
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
            improved: vec![false; segments.most()],
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
        if !wanted.is_empty() {
            for k in 2..=self.most() {
                self.keep_order(k)?;
            }
        }
        Ok(())
    }

    /// Where more patches are worse, the better chain is split instead.
    fn keep_order(&mut self, patches: usize) -> Result<(), Stop> {
        let (Some(below), Some(here)) = (&self.rungs[patches - 2], &self.rungs[patches - 1]) else {
            return Ok(());
        };
        let [low, high] = [below, here].map(|r| r.fitted.worth(self.sample));
        if high <= low || low < EXACT {
            return Ok(());
        }
        // The cut chain itself is as good as the one below.
        let worst = below.fitted.worst(self.sample)[0];
        let cut = below.fitted.split(self.sample, worst);
        let freedom = self.freedom(patches);
        let relaxed = cut.relaxed(self.sample, &freedom, Effort::FULL, self.control)?;
        self.add(patches, vec![relaxed, cut]);
        Ok(())
    }

    /// Tries what the neighbours in number lead to: a patch of the one below
    /// split, two patches of the one above made one.
    ///
    /// # Errors
    /// When the control says so.
    pub(super) fn improve(&mut self, patches: usize) -> Result<(), Stop> {
        let around = [patches.saturating_sub(1), patches, patches + 1];
        let known: Vec<usize> = around
            .into_iter()
            .filter(|k| (1..=self.most()).contains(k))
            .collect();
        self.solve(&known)?;
        let at = |k: usize| k.checked_sub(1).and_then(|i| self.rungs.get(i)?.as_ref());
        if self.improved[patches - 1]
            || at(patches).is_some_and(|r| r.fitted.worth(self.sample) < EXACT)
        {
            return Ok(());
        }
        self.improved[patches - 1] = true;
        let mut starts: Vec<Fitted> = Vec::new();
        if let Some(below) = at(patches - 1) {
            let worst = below.fitted.worst(self.sample);
            let cut = |i: &usize| below.fitted.split(self.sample, *i);
            starts.extend(worst.iter().take(TRIED).map(cut));
        }
        if let Some(above) = at(patches + 1) {
            let alike = alike(&above.fitted);
            let merged = |i: &usize| above.fitted.merged(self.sample, *i);
            starts.extend(alike.iter().take(TRIED).map(merged));
        }
        let freedom = self.freedom(patches);
        let race = |start: &Fitted| start.relaxed(self.sample, &freedom, RACE, self.control);
        let raced = starts
            .par_iter()
            .map(race)
            .collect::<Result<Vec<_>, Stop>>()?;
        let promising = self.distinct(raced);
        let follow = |f: &Fitted| f.relaxed(self.sample, &freedom, Effort::FULL, self.control);
        let mut followed = promising
            .par_iter()
            .take(2)
            .map(follow)
            .collect::<Result<Vec<_>, Stop>>()?;
        followed.extend(promising);
        self.add(patches, followed);
        Ok(())
    }

    /// Takes up more chains for a number of patches.
    fn add(&mut self, patches: usize, more: Vec<Fitted>) {
        let mut all = more;
        if let Some(rung) = self.rungs[patches - 1].take() {
            all.push(rung.fitted);
            all.extend(rung.others);
        }
        let mut distinct = self.distinct(all).into_iter();
        self.rungs[patches - 1] = distinct.next().map(|fitted| Rung {
            fitted,
            others: distinct.take(OTHERS).collect(),
        });
    }

    /// Chains by worth, each minimum once.
    fn distinct(&self, mut chains: Vec<Fitted>) -> Vec<Fitted> {
        let key = |f: &Fitted| (f.worth(self.sample), f.rms(self.sample));
        chains.sort_by(|a, b| {
            let (a, b) = (key(a), key(b));
            a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1))
        });
        let mut distinct: Vec<Fitted> = Vec::with_capacity(chains.len());
        for chain in chains {
            let same = |f: &Fitted| {
                let [a, b] = [f, &chain].map(|f| f.rms(self.sample));
                let [c, d] = [f, &chain].map(Fitted::max);
                (a - b).abs() <= SAME * a && (c - d).abs() <= SAME * c
            };
            if !distinct.iter().any(same) {
                distinct.push(chain);
            }
        }
        distinct
    }

    /// The best of several starts, followed to its minimum.
    fn race(&self, patches: usize) -> Result<Rung, Stop> {
        let freedom = self.freedom(patches);
        let run = |(chain, homes): (Chain, Vec<u32>), effort: Effort| {
            let chain = self.restricted(chain);
            Fitted::settle(self.sample, &chain, &homes).relaxed(
                self.sample,
                &freedom,
                effort,
                self.control,
            )
        };
        let all = |effort: Effort| {
            let starts = [(Aim::Sum, true), (Aim::Max, true), (Aim::Sum, false)];
            let run = |(aim, averaged)| run(self.segments.chain(aim, patches, averaged), effort);
            starts
                .into_iter()
                .map(run)
                .collect::<Result<Vec<_>, Stop>>()
        };
        let mut raced = all(RACE)?;
        if raced.iter().all(|f| f.worth(self.sample).is_infinite()) {
            raced.extend(all(CAREFUL)?);
        }
        let least = |value: &dyn Fn(&Fitted) -> f64| {
            (0..raced.len()).min_by(|a, b| value(&raced[*a]).total_cmp(&value(&raced[*b])))
        };
        let follow = |i: usize| raced[i].relaxed(self.sample, &freedom, Effort::FULL, self.control);
        let first = least(&|f| f.worth(self.sample)).unwrap_or(0);
        let second = least(&|f| f.max().max(f.worth(self.sample))).filter(|i| *i != first);
        let mut followed = std::iter::once(first)
            .chain(second)
            .map(follow)
            .collect::<Result<Vec<_>, Stop>>()?;
        let any = raced[first].clone();
        // Where squares are not yet least, the largest distance may be smaller.
        followed.extend(raced);
        let mut distinct = self.distinct(followed).into_iter();
        let fitted = distinct.next().unwrap_or(any);
        Ok(Rung {
            fitted,
            others: distinct.take(OTHERS).collect(),
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

/// Joints by what it would move to make one patch of the two, least first.
fn alike(fitted: &Fitted) -> Vec<usize> {
    let chain = &fitted.chain;
    let length = |i: usize| chain.reach[i][1] - chain.reach[i][0];
    let width = |i: usize| fitted.lambda[i][1] - fitted.lambda[i][0];
    let harm = |i: &usize| {
        let (a, b) = (chain.strains[*i], chain.strains[i + 1]);
        let whole = length(*i) + length(i + 1);
        (a.k - b.k).abs() * whole * whole + (a.g - b.g).abs() * whole * width(*i)
    };
    let mut order: Vec<usize> = (0..chain.len() - 1).collect();
    order.sort_by(|a, b| harm(a).total_cmp(&harm(b)));
    order
}
