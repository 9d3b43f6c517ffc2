//! Stages 2 and 3: from a net of curvature lines to the cyclide spline and all
//! that is asked of it.

use super::cyclide::{self, Certificate, certificates, closure, patches};
use super::net::Net;
use super::outcome::{CyclideFigures, Cyclides, Spread};
use super::request::Options;
use super::structure::{bill, offset, strips, supports};
use crate::geometry::CyclidePatch;
use crate::methods::{Control, FitError};
use crate::solver::Stop;

/// The cyclide spline nearest to a net, with strips, offsets, supports and the
/// bill of its arcs.
///
/// # Errors
/// [`FitError::Stopped`] when the control says so.
pub(super) fn build(
    start: &Net,
    options: &Options,
    control: &dyn Control,
) -> Result<Cyclides, FitError> {
    let spline = cyclide::solve(start, control)?;
    control.progress("proving", 75.0);
    let net = spline.net;
    let patches: Vec<_> = patches(&net).into_iter().map(Result::ok).collect();
    control.check()?;
    let certificates: Vec<_> = certificates(&net).into_iter().map(Result::ok).collect();
    let figures = figures(start, &net, &certificates, spline.iterations);
    control.progress("strips", 85.0);
    let built = Cyclides {
        strips: all_strips(&net, &patches, options, control)?,
        offsets: all_offsets(&net, &patches, options, control)?,
        supports: options
            .supports
            .map_or_else(Vec::new, |s| supports(&net, s.height)),
        members: bill(&net),
        net,
        patches,
        certificates,
        figures,
    };
    Ok(built)
}

fn all_strips(
    net: &Net,
    patches: &[Option<CyclidePatch>],
    options: &Options,
    control: &dyn Control,
) -> Result<Vec<super::structure::Strip>, Stop> {
    let mut all = Vec::new();
    for direction in &options.strips {
        control.check()?;
        all.extend(strips(net, patches, *direction));
    }
    Ok(all)
}

fn all_offsets(
    net: &Net,
    patches: &[Option<CyclidePatch>],
    options: &Options,
    control: &dyn Control,
) -> Result<Vec<super::structure::Offset>, Stop> {
    let one = |distance: &f64| {
        control.check()?;
        Ok(offset(net, patches, *distance))
    };
    options.offsets.iter().map(one).collect()
}

fn figures(
    start: &Net,
    net: &Net,
    certificates: &[Option<Certificate>],
    iterations: usize,
) -> CyclideFigures {
    let columns = net.layout().patch_counts()[1];
    let nothing = Certificate {
        mirror: 0.0,
        orthogonality: 0.0,
        tangency: 0.0,
        circularity: 0.0,
        reality: 0.0,
    };
    let (mut worst, mut worst_patch, mut largest) = (nothing, [0, 0], 0.0);
    for (index, certificate) in certificates.iter().enumerate() {
        let Some(certificate) = certificate else {
            continue;
        };
        worst = worst.or_worse(certificate);
        if certificate.worst() > largest {
            largest = certificate.worst();
            worst_patch = [index / columns, index % columns];
        }
    }
    let ways: Vec<f64> = (net.points.iter().zip(&start.points))
        .map(|(now, before)| (now - before).norm())
        .collect();
    let turns: Vec<f64> = (net.normals.iter().zip(&start.normals))
        .map(|(now, before)| now.cross(before).norm().atan2(now.dot(before)))
        .collect();
    CyclideFigures {
        worst,
        worst_patch,
        missing: certificates.iter().filter(|c| c.is_none()).count(),
        closure: closure(net),
        mean_edge: net.mean_edge(),
        moved: Spread::of(&ways, net.columns),
        turned: Spread::of(&turns, net.columns),
        iterations,
    }
}
