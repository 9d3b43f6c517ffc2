//! Stage 1 as a whole: from the request to the smooth surface and what can be
//! said about it, in the user's scale.

use super::diagnose::{At, BorderFigures, ShapeFigures, Smoothed, TargetFigures, UmbilicFigures};
use super::input::Task;
use super::lines::{Step, solve};
use super::paper;
use super::reasons::{Crossing, Moved, Nets, crossing, moved};
use super::request::{Request, Solver};
use super::surface::Surface;
use crate::methods::{Control, FitError};
use nalgebra::Point3;

/// A smooth surface whose patch borders are lines of curvature.
#[derive(Debug, Clone, PartialEq)]
pub struct Smooth {
    /// The surface.
    pub surface: Surface,
    /// The start, through the given points, split like it.
    pub start: Surface,
    /// Index in the request of the vertices of the coarse net, row after row;
    /// after `levels` splits they are every 2^levels-th of the surface.
    pub given: Vec<usize>,
    /// How often patches were split in four.
    pub levels: usize,
    /// How far its borders are from lines of curvature.
    pub borders: BorderFigures,
    /// Where its curvatures come near each other.
    pub umbilics: UmbilicFigures,
    /// How far it is from the start.
    pub shape: ShapeFigures,
    /// How far it is from the target, where there is one.
    pub target: Option<TargetFigures>,
    /// How far the given points were smoothed before, where they were: as they
    /// were given they made umbilics.
    pub smoothed: Option<Smoothed>,
    /// The vertices that went further than usual, with reasons.
    pub moved: Vec<Moved>,
    /// Where the start itself makes umbilics unavoidable: the curvatures pass
    /// each other somewhere between these places.
    pub crossing: Option<Crossing>,
    /// What every minimisation did.
    pub steps: Vec<Step>,
}

/// The smooth surface for a request.
///
/// # Errors
/// [`FitError::Invalid`] for unusable input, [`FitError::Stopped`] when the
/// control says so, [`FitError::Numerical`] where the start folds between its
/// vertices.
pub fn smooth(request: &Request, control: &dyn Control) -> Result<Smooth, FitError> {
    control.progress("reading", 0.0);
    let task = Task::new(request)?;
    let (lines, paper) = match request.options.solver {
        Solver::Own => (solve(&task, &request.options, control)?, None),
        Solver::Paper => {
            let net = paper::solve(&task, control)?;
            (net.lines.clone(), Some(net))
        }
    };
    control.check()?;
    let umbilics = UmbilicFigures::of(&lines.surface);
    let mut borders = BorderFigures::of(&lines.surface, umbilics.mean_difference);
    if let Some(net) = paper {
        net.correct(&mut borders);
    }
    if !borders.mean_torsion.is_finite() {
        // Only where a border of the start has no tangent plane between its
        // ends, which no check of the vertices sees.
        return Err(FitError::Numerical(
            "the surface through the net has no tangent plane somewhere along a border".to_owned(),
        ));
    }
    let shape = ShapeFigures::of(&lines.surface, &lines.start);
    let (size, middle) = (task.size, &task.middle);
    let in_user_scale = |net: &Surface| net.mapped(size, middle);
    let (surface, start) = (in_user_scale(&lines.surface), in_user_scale(&lines.start));
    let held = in_user_scale(&lines.held);
    Ok(Smooth {
        target: task
            .target
            .as_ref()
            .map(|target| TargetFigures::of(&lines.surface, target).in_user_scale(&task)),
        moved: moved(
            &Nets {
                surface: &surface,
                start: &start,
                held: &held,
            },
            &shape,
            &task.given,
        ),
        smoothed: lines.is_calmed.then(|| Smoothed::of(&held, &start)),
        crossing: crossing(&start),
        borders: borders.in_user_scale(&task),
        umbilics: umbilics.in_user_scale(&task),
        shape: shape.in_user_scale(&task),
        surface,
        start,
        given: task.given,
        levels: lines.levels,
        steps: lines.steps,
    })
}

impl At {
    fn in_user_scale(self, task: &Task) -> At {
        At {
            point: Point3::from(task.to_user(&self.point.coords)),
            ..self
        }
    }
}

impl BorderFigures {
    fn in_user_scale(self, task: &Task) -> Self {
        BorderFigures {
            max_torsion: self.max_torsion.in_user_scale(task),
            max_skew: self.max_skew.in_user_scale(task),
            max_off_principal: self.max_off_principal.in_user_scale(task),
            ..self
        }
    }
}

impl UmbilicFigures {
    fn in_user_scale(self, task: &Task) -> Self {
        let curvatures = self.curvatures.iter().map(|k| k.map(|k| k / task.size));
        UmbilicFigures {
            least_difference: self.least_difference.in_user_scale(task),
            mean_difference: self.mean_difference / task.size,
            curvatures: curvatures.collect(),
            patches: self.patches,
            flat: self.flat,
        }
    }
}

impl TargetFigures {
    fn in_user_scale(self, task: &Task) -> Self {
        let max = self.max_distance.in_user_scale(task);
        TargetFigures {
            mean_distance: self.mean_distance * task.size,
            max_distance: At {
                value: max.value * task.size,
                ..max
            },
        }
    }
}

impl ShapeFigures {
    fn in_user_scale(self, task: &Task) -> Self {
        ShapeFigures {
            max_move: self.max_move.in_user_scale(task),
            max_turn_deg: self.max_turn_deg.in_user_scale(task),
            ..self
        }
    }
}
