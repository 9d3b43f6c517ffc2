//! The paper's solver (Jing, Xi & Tang 1998, §2): a spline of the energy
//! ∫ α|r′|² + β|r″|² + γ|r‴|² du held by one spring stiffness K for all
//! points, with their feet projected after every solution, K raised while the
//! largest distance exceeds ε and lowered while it is far below.
//!
//! One thing is changed. The paper says that γ|r‴|² makes for arcs; but r‴ of
//! an arc is not 0, it is −ω² r′, and minimising all of it bends the ends of
//! the half circle by 16 to 30 per cent (r‴ = 0 is the natural end condition).
//! So γ weighs r‴ + ω² r′ with the turning ω of the shape before: 0 on arcs,
//! and every system stays linear. (`energy` in the own solver is eq. 1 as it
//! is.)
//!
//! What the paper leaves open, and how it is closed here: the first shape is
//! the spline of the energy at the chord-length parameters (or those of
//! [`super::trace`]) instead of one through the boundary points alone; K moves
//! by decades until ε is bracketed, then by bisection to the smallest K that
//! keeps it, each K from the first shape; springs at the ends are 100 times as stiff as within, the ratio
//! that the paper found best for surfaces. Knots are uniform, four spans an
//! interval between points: a cubic's r″ is piecewise linear, and with one
//! span an interval its curvature on a half circle of 13 points sags by 0.6 %
//! between knots.

use super::bounded::worst;
use super::energy::{Energy, Quadratic};
use super::free::{Shape, first_shape};
use super::holds::Holds;
use super::input::{Task, degree_of};
use super::request::Request;
use super::solve::{Solved, Traced};
use super::space::Space;
use super::springs::Springs;
use super::stiffness::Choice;
use crate::methods::FitError;
use crate::solver::{Control, Stop};

/// Springs at the ends against those within.
const BOUNDARY: f64 = 100.0;
/// Spans an interval between points, and at most.
const SPANS_PER_INTERVAL: usize = 4;
const MOST_SPANS: usize = 128;
/// ε where none is asked, unit scale: the points are passed to the eye.
const TOLERANCE: f64 = 2e-7;
/// Energy where none is asked: that of the paper's third example curve.
const ENERGY: Quadratic = [0.1, 0.1, 100.0];
/// Decades of K looked at, and halvings of the last.
const DECADES: [i32; 2] = [-4, 16];
const HALVINGS: usize = 12;
/// Solutions with feet projected anew at one K.
const ROUNDS: usize = 10;
/// Longest step of a foot, as a share of the domain.
const REACH: f64 = 0.05;

/// Solves a task as the paper does.
///
/// # Errors
/// When the control says stop, or where a system cannot be solved.
pub(super) fn solve<const D: usize>(
    request: &Request,
    task: &Task<D>,
    traced: &Traced,
    control: &dyn Control,
) -> Result<Solved<D>, FitError> {
    let mut tolerances = task.tolerances.clone();
    let asked = tolerances.iter().any(|t| t.is_finite());
    for t in &mut tolerances {
        // A common K cannot hold one point alone: a lock is a tolerance here.
        *t = if asked { t.max(LOCKED) } else { TOLERANCE };
    }
    let first = begin(request, task, traced)?;
    let mut solutions = 0;
    let mut try_at = |log: f64| -> Result<(f64, (Shape<D>, Springs<D>)), Stop> {
        solutions += ROUNDS;
        let (mut shape, mut springs) = first.clone();
        at_stiffness(10f64.powf(log), &mut shape, &mut springs, control)?;
        Ok((worst(&shape, &springs, &tolerances), (shape, springs)))
    };
    let mut good = f64::from(DECADES[0]);
    let mut kept = try_at(good)?;
    while kept.0 > 1.0 && good < f64::from(DECADES[1]) {
        good += 1.0;
        kept = try_at(good)?;
    }
    let mut bad = good - 1.0;
    for _ in 0..HALVINGS {
        let middle = 0.5 * (good + bad);
        let tried = try_at(middle)?;
        if tried.0 <= 1.0 {
            (good, kept) = (middle, tried);
        } else {
            bad = middle;
        }
    }
    let (shape, springs) = kept.1;
    let used = worst(&shape, &springs, &tolerances);
    Ok(Solved {
        choice: Choice::given(10f64.powf(-good)),
        duals: Vec::new(),
        gap: None,
        steps: solutions,
        net: if request.options.control_points.is_some() {
            "asked"
        } else {
            "four a point"
        },
        suspects: Vec::new(),
        used,
        trade_off: Vec::new(),
        tolerances: if asked {
            tolerances
        } else {
            vec![f64::INFINITY; task.points.len()]
        },
        shape,
        springs,
    })
}

/// Tolerance that stands for a lock.
const LOCKED: f64 = 1e-8;

fn begin<const D: usize>(
    request: &Request,
    task: &Task<D>,
    traced: &Traced,
) -> Result<(Shape<D>, Springs<D>), FitError> {
    let degree = degree_of(&request.options);
    let intervals = task.points.len() - usize::from(!traced.closed);
    let free = (SPANS_PER_INTERVAL * intervals).min(MOST_SPANS);
    let asked = request
        .options
        .control_points
        .map(|n| n.saturating_sub(degree));
    let least = if traced.closed { 2 * degree + 2 } else { 1 };
    let spans = asked.unwrap_or(free).max(least);
    let [a, b] = traced.domain;
    let even = |k: usize| a + (b - a) * k as f64 / spans as f64;
    let inner: Vec<f64> = (1..spans).map(even).collect();
    let space = if traced.closed {
        Space::closed(degree, traced.domain, &inner)
    } else {
        Space::open(degree, traced.domain, &inner)
    };
    let space = space.map_err(|e| FitError::Numerical(e.to_string()))?;
    let weights = task.weights.clone();
    let feet = traced.parameters.clone();
    let mut springs = Springs::new(task.points.clone(), weights, feet, task.metric);
    if !traced.closed {
        let by = |i: &usize, j: &usize| traced.parameters[*i].total_cmp(&traced.parameters[*j]);
        let all = || 0..traced.parameters.len();
        for i in all().min_by(by).into_iter().chain(all().max_by(by)) {
            springs.pin([i]);
            springs.weights[i] *= BOUNDARY;
        }
    }
    let weights = request
        .options
        .energy
        .map(|e| [e.tension, e.bending, e.jerk]);
    let energy = Energy::new(&space, Some(weights.unwrap_or(ENERGY)));
    let broken = || FitError::Numerical("the points do not determine a curve".into());
    let mut shape = first_shape(space, &springs, None).ok_or_else(broken)?;
    shape.energy = energy;
    Ok((shape, springs))
}

/// The equilibrium at one K: K P = f, feet, and again.
fn at_stiffness<const D: usize>(
    stiffness: f64,
    shape: &mut Shape<D>,
    springs: &mut Springs<D>,
    control: &dyn Control,
) -> Result<(), Stop> {
    let [a, b] = shape.space.domain();
    for _ in 0..ROUNDS {
        control.check()?;
        let gram = springs.gram(&shape.space, &shape.x);
        shape.balance(&gram, &Holds::none(), 1.0 / stiffness);
        shape.energy.spare_arcs(&shape.space, &shape.x);
        springs.refresh(&shape.space, &shape.x, REACH * (b - a));
    }
    Ok(())
}
