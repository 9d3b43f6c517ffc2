//! From the request to profiles in unit scale: the model's longest side is 1
//! and its middle the origin, so that every tolerance means the same on a
//! kayak in millimetres and a tanker in feet, far from its origin or near.

use super::cubic_fit::{Pieces, Rail, Side, fit_pair};
use super::profile::Profile;
use super::request::{Options, ProfileShape, Request};
use super::task::{Limits, Pins};
use super::twist::ratio_of_clearance;
use crate::geometry::{BSplineCurve, CurveIndex, Parametrization, interpolate};
use crate::methods::{FitError, Issue};
use nalgebra::{Point3, Vector3};

/// A request that can be fitted.
#[derive(Debug)]
pub(super) struct Task {
    /// unit = (user − middle) / size.
    pub(super) middle: Vector3<f64>,
    pub(super) size: f64,
    pub(super) profiles: Vec<Profile>,
    /// Given points of each profile: index in the request, place in unit scale.
    pub(super) given: Vec<Given>,
    pub(super) limits: Limits,
    /// The same for boundaries that move.
    pub(super) moved_limits: Limits,
    /// Largest extension, unit scale, where ends are extended.
    pub(super) longest_extension: Option<f64>,
    pub(super) pins: Vec<Pins>,
    /// The plane of symmetry y = 0, unit scale.
    pub(super) centreline: f64,
    pub(super) warnings: Vec<String>,
}

/// Profiles shorter than this share of the model are mistakes.
const SHORTEST_PROFILE: f64 = 1e-4;
/// Points nearer than this share of the model are one point.
const REPEATED: f64 = 1e-12;
/// A pinned point must lie this near its profile, as share of the model.
const NEAR_PIN: f64 = 0.01;
/// Distance, unit scale, to which a curve that is not a cubic is taken over.
const TAKEN_OVER: f64 = 1e-9;

impl Task {
    /// Reads a request.
    ///
    /// # Errors
    /// [`FitError::Invalid`] with every issue found.
    pub(super) fn new(request: &Request) -> Result<Self, FitError> {
        let mut issues = check_options(request);
        if request.profiles.len() < 2 {
            issues.push(too_few(request.profiles.len()));
        }
        let (low, high) = extent(request, &mut issues);
        if !issues.is_empty() {
            return Err(FitError::Invalid(issues));
        }
        let side = (0..3).map(|k| high[k] - low[k]).fold(0.0, f64::max);
        let middle = 0.5 * (low + high);
        let mut reader = Reader {
            middle,
            size: side,
            issues,
            warnings: Vec::new(),
        };
        if side <= 0.0 || !side.is_finite() {
            reader.issue(
                &["input", "profiles"],
                "no-extent",
                "all points are equal",
                None,
            );
            return Err(FitError::Invalid(reader.issues));
        }
        let read: Vec<_> = request
            .profiles
            .iter()
            .enumerate()
            .map(|(k, p)| reader.profile(k, &p.shape))
            .collect();
        if !reader.issues.is_empty() {
            return Err(FitError::Invalid(reader.issues));
        }
        let (profiles, given): (Vec<_>, Vec<_>) = read.into_iter().flatten().unzip();
        reader.check_neighbours(request, &profiles);
        let pins = reader.pins(&request.options, &profiles);
        if !reader.issues.is_empty() {
            return Err(FitError::Invalid(reader.issues));
        }
        let may_move = matches!(
            request.options.boundary,
            super::request::Boundary::Tolerance(_)
        );
        let (exact, longest_extension) = limits(&request.options, &profiles, may_move);
        let (moved, _) = limits(&request.options, &profiles, true);
        Ok(Task {
            middle,
            size: side,
            profiles,
            given,
            limits: exact,
            moved_limits: moved,
            longest_extension,
            pins,
            centreline: -middle.y / side,
            warnings: reader.warnings,
        })
    }

    /// A point in the user's scale.
    pub(super) fn to_user(&self, p: &Point3<f64>) -> Point3<f64> {
        Point3::from(p.coords * self.size + self.middle)
    }
}

fn limits(options: &Options, profiles: &[Profile], may_move: bool) -> (Limits, Option<f64>) {
    let clearance = options.clearance_percent(may_move) / 100.0;
    let speed_ratio = ratio_of_clearance(clearance);
    let fan = options.max_fan_percent / 100.0;
    match options.ends {
        super::request::Ends::Fan => (
            Limits {
                end_limit: fan,
                speed_ratio,
            },
            None,
        ),
        super::request::Ends::Extend => {
            // A cone whose apex lies c behind its corner extends the standing
            // curve by c/(1+c) of the swept length.
            let cap = options.max_extension_percent / 100.0;
            let longest = profiles.iter().map(Profile::length).fold(0.0, f64::max);
            let reach = cap * (1.0 + clearance) / clearance / longest;
            (
                Limits {
                    end_limit: fan.min(reach),
                    speed_ratio,
                },
                Some(cap),
            )
        }
    }
}

fn too_few(count: usize) -> Issue {
    Issue {
        path: path(&["input", "profiles"]),
        code: "too-few-profiles",
        message: format!("{count} profile(s) given; a plate lies between two"),
        hint: Some("give at least two neighbouring curves, such as a chine and the sheer".into()),
    }
}

fn path(segments: &[&str]) -> Vec<String> {
    segments.iter().map(|s| (*s).to_string()).collect()
}

fn check_options(request: &Request) -> Vec<Issue> {
    let o = &request.options;
    let mut issues = Vec::new();
    let mut check = |name: &str, value: f64, low: f64, high: f64| {
        if !(value >= low && value <= high) {
            issues.push(Issue {
                path: path(&["options", name]),
                code: "out-of-range",
                message: format!("{name} is {value}; it must lie between {low} and {high}"),
                hint: None,
            });
        }
    };
    check("max_twist_deg", o.max_twist_deg, 1e-3, 45.0);
    check("max_fan_percent", o.max_fan_percent, 0.0, 50.0);
    check("max_extension_percent", o.max_extension_percent, 0.0, 20.0);
    let clearance = o.clearance_percent(false);
    check("min_clearance_percent", clearance, 1.0, 50.0);
    check(
        "thickness",
        o.thickness.unwrap_or(1.0),
        f64::MIN_POSITIVE,
        f64::MAX,
    );
    check(
        "min_bend_radius",
        o.min_bend_radius.unwrap_or(1.0),
        f64::MIN_POSITIVE,
        f64::MAX,
    );
    if let super::request::Boundary::Tolerance(value) = o.boundary
        && !(value > 0.0 && value.is_finite())
    {
        issues.push(Issue {
            path: path(&["options", "boundary", "value"]),
            code: "out-of-range",
            message: format!("the tolerance is {value}; it must be positive"),
            hint: Some("use {\"mode\":\"exact\"} to leave the profiles alone".into()),
        });
    }
    issues
}

/// Bounding box of all points; issues for numbers that are not finite.
fn extent(request: &Request, issues: &mut Vec<Issue>) -> (Vector3<f64>, Vector3<f64>) {
    let (mut low, mut high) = (
        Vector3::repeat(f64::INFINITY),
        Vector3::repeat(f64::NEG_INFINITY),
    );
    for (k, profile) in request.profiles.iter().enumerate() {
        let points: &[Point3<f64>] = match &profile.shape {
            ProfileShape::Points(points) => points,
            ProfileShape::BSpline(curve) => curve.control_points(),
        };
        for (i, p) in points.iter().enumerate() {
            if p.coords.iter().any(|c| !c.is_finite()) {
                issues.push(Issue {
                    path: path(&[
                        "input",
                        "profiles",
                        &k.to_string(),
                        "points",
                        &i.to_string(),
                    ]),
                    code: "not-finite",
                    message: format!("point {i} has a coordinate that is not a finite number"),
                    hint: None,
                });
            }
            low = low.inf(&p.coords);
            high = high.sup(&p.coords);
        }
    }
    (low, high)
}

/// Given points: index in the request, place in unit scale.
type Given = Vec<(usize, Point3<f64>)>;
type Read = (Profile, Given);

struct Reader {
    middle: Vector3<f64>,
    size: f64,
    issues: Vec<Issue>,
    warnings: Vec<String>,
}

impl Reader {
    fn issue(&mut self, at: &[&str], code: &'static str, message: &str, hint: Option<&str>) {
        self.issues.push(Issue {
            path: path(at),
            code,
            message: message.into(),
            hint: hint.map(Into::into),
        });
    }

    fn to_unit(&self, p: &Point3<f64>) -> Point3<f64> {
        Point3::from((p.coords - self.middle) / self.size)
    }

    fn profile(&mut self, k: usize, shape: &ProfileShape) -> Option<Read> {
        let name = k.to_string();
        let (curve, given) = match shape {
            ProfileShape::Points(points) => self.through_points(k, points)?,
            ProfileShape::BSpline(curve) => (self.in_unit(curve)?, Vec::new()),
        };
        let curve = match as_cubic(&curve) {
            Ok(curve) => curve,
            Err(e) => {
                self.issue(
                    &["input", "profiles", &name],
                    "unusable-curve",
                    &e.to_string(),
                    None,
                );
                return None;
            }
        };
        let profile = Profile::new(curve);
        if profile.length() < SHORTEST_PROFILE {
            let message = format!(
                "the profile is {:.3e} long, {:.1e} of the model's longest side",
                profile.length() * self.size,
                profile.length()
            );
            let hint = "give a curve that runs along the whole plate";
            self.issue(
                &["input", "profiles", &name],
                "too-short",
                &message,
                Some(hint),
            );
            return None;
        }
        Some((profile, given))
    }

    fn in_unit(&self, curve: &BSplineCurve) -> Option<BSplineCurve> {
        let points = curve
            .control_points()
            .iter()
            .map(|p| self.to_unit(p))
            .collect();
        let weights = curve.weights().map(<[f64]>::to_vec);
        BSplineCurve::new(curve.degree(), curve.knots().to_vec(), points, weights).ok()
    }

    /// The cubic through the points; repeated neighbours count once.
    fn through_points(
        &mut self,
        k: usize,
        points: &[Point3<f64>],
    ) -> Option<(BSplineCurve, Given)> {
        let mut given: Given = Vec::with_capacity(points.len());
        for (i, p) in points.iter().enumerate() {
            let unit = self.to_unit(p);
            match given.last() {
                Some((before, q)) if (unit - q).norm() <= REPEATED => {
                    self.warnings.push(format!(
                        "/input/profiles/{k}/points/{i} repeats point {before}; it counts once."
                    ));
                }
                _ => given.push((i, unit)),
            }
        }
        let at = k.to_string();
        if given.len() < 2 {
            let message = format!(
                "{} point(s) given, {} distinct; a curve needs two",
                points.len(),
                given.len()
            );
            self.issue(
                &["input", "profiles", &at, "points"],
                "too-few-points",
                &message,
                None,
            );
            return None;
        }
        let places: Vec<Point3<f64>> = given.iter().map(|g| g.1).collect();
        match interpolate(&places, 3, Parametrization::ChordLength) {
            Ok(curve) => Some((curve, given)),
            Err(e) => {
                let message = e.to_string();
                self.issue(
                    &["input", "profiles", &at, "points"],
                    "unusable-curve",
                    &message,
                    None,
                );
                None
            }
        }
    }

    /// Neighbours must run the same way and must not be one curve.
    fn check_neighbours(&mut self, request: &Request, profiles: &[Profile]) {
        for k in 0..profiles.len().saturating_sub(1) {
            let [a, b] = [&profiles[k], &profiles[k + 1]];
            let ends = |p: &Profile| (p.curve.start(), p.curve.end());
            let ((a0, a1), (b0, b1)) = (ends(a), ends(b));
            let along = (a0 - b0).norm() + (a1 - b1).norm();
            let across = (a0 - b1).norm() + (a1 - b0).norm();
            let names = (&request.profiles[k].name, &request.profiles[k + 1].name);
            let at = (k + 1).to_string();
            if (a1 - a0).dot(&(b1 - b0)) < 0.0 && across < along {
                let message = format!("\"{}\" runs against \"{}\"", names.1, names.0);
                let hint = "give all profiles in the same direction: reverse this one's points";
                self.issue(
                    &["input", "profiles", &at],
                    "opposite-direction",
                    &message,
                    Some(hint),
                );
            } else if coincide(a, b) {
                let message = format!("\"{}\" and \"{}\" are the same curve", names.0, names.1);
                self.issue(&["input", "profiles", &at], "same-curve", &message, None);
            }
        }
    }

    fn pins(&mut self, options: &Options, profiles: &[Profile]) -> Vec<Pins> {
        let mut pins: Vec<Pins> = vec![Vec::new(); profiles.len().saturating_sub(1)];
        for (n, pin) in options.pinned_rulings.iter().enumerate() {
            let at = n.to_string();
            if pin.plate + 1 >= profiles.len() {
                let message = format!(
                    "plate {} does not exist; there are {}",
                    pin.plate,
                    pins.len()
                );
                self.issue(
                    &["options", "pinned_rulings", &at, "plate"],
                    "no-such-plate",
                    &message,
                    None,
                );
                continue;
            }
            let ends = [("from", pin.from, pin.plate), ("to", pin.to, pin.plate + 1)];
            let fractions = ends.map(|(name, point, k)| {
                let foot = CurveIndex::new(&profiles[k].curve).closest(&self.to_unit(&point));
                if foot.distance > NEAR_PIN {
                    let message = format!(
                        "the point is {:.4} away from its profile",
                        foot.distance * self.size
                    );
                    let hint = "pin a ruling by points on the two profiles";
                    self.issue(
                        &["options", "pinned_rulings", &at, name],
                        "off-the-profile",
                        &message,
                        Some(hint),
                    );
                }
                profiles[k].fraction_of(foot.parameter)
            });
            let crossing = pins[pin.plate]
                .iter()
                .any(|(s, t)| (s - fractions[0]) * (t - fractions[1]) < 0.0);
            if crossing {
                let message = format!(
                    "pinned ruling {n} crosses another one of plate {}",
                    pin.plate
                );
                self.issue(
                    &["options", "pinned_rulings", &at],
                    "crossing-pins",
                    &message,
                    None,
                );
            }
            pins[pin.plate].push((fractions[0], fractions[1]));
        }
        pins
    }
}

/// Whether two profiles are the same everywhere, within a millionth of the
/// model.
fn coincide(a: &Profile, b: &Profile) -> bool {
    const SAME: f64 = 1e-6;
    const PROBES: usize = 17;
    (0..PROBES).all(|i| {
        let s = i as f64 / (PROBES - 1) as f64;
        (a.at(s).point - b.at(s).point).norm() < SAME
    })
}

/// The curve as a polynomial cubic: itself, raised, or fitted.
fn as_cubic(curve: &BSplineCurve) -> Result<BSplineCurve, FitError> {
    let numerical = |e: crate::geometry::SplineError| FitError::Numerical(e.to_string());
    if curve.weights().is_none() && curve.degree() <= 3 {
        return curve.elevated_to(3).map_err(numerical);
    }
    let [a, b] = curve.domain();
    let mut breaks = vec![a];
    breaks.extend(curve.kinks(1e-6));
    breaks.push(b);
    let seeds: Vec<f64> = curve
        .knot_vector()
        .breakpoints()
        .into_iter()
        .filter(|u| *u > a && *u < b)
        .collect();
    let rails = |u: f64, side: Side| {
        let jet = if side == Side::Left {
            curve.derivatives_left(u)
        } else {
            curve.derivatives(u)
        };
        [Rail {
            point: jet.point,
            d1: jet.d1,
        }; 2]
    };
    let pieces = Pieces {
        breaks: &breaks,
        seeds: &seeds,
        distance: TAKEN_OVER,
        angle: 1e-6,
        rails: &rails,
    };
    let [cubic, _] = fit_pair(&pieces)?;
    Ok(cubic)
}
