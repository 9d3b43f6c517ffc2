//! The entities of the data section, numbered as they are added.

use super::text::{bracketed, real, reals, string};
use crate::formats::brep::{Edge, Face, Sewn};
use crate::formats::length_unit::LengthUnit;
use crate::geometry::{Axis, BSplineCurve, BSplineSurface, Knots};
use nalgebra::Point3;
use std::fmt::{Arguments, Write as _};

/// The data section under construction.
#[derive(Default)]
pub(super) struct Entities {
    text: String,
    count: usize,
    /// The context of curves in the parameters of a surface.
    parameters: Option<usize>,
}

impl Entities {
    /// Adds an entity and tells its number.
    pub fn add(&mut self, what: Arguments<'_>) -> usize {
        self.count += 1;
        // Writing to a String cannot fail.
        let _ = writeln!(self.text, "#{}={what};", self.count);
        self.count
    }

    /// What was added.
    pub fn text(&self) -> &str {
        &self.text
    }

    /// The product, and the definition that its shape is given to.
    pub fn product(&mut self, title: &str, description: &str) -> usize {
        let application = self.add(format_args!(
            "APPLICATION_CONTEXT('core data for automotive mechanical design processes')"
        ));
        self.add(format_args!(
            "APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,#{application})"
        ));
        let context = self.add(format_args!(
            "PRODUCT_CONTEXT('',#{application},'mechanical')"
        ));
        let (title, description) = (string(title), string(description));
        let product = self.add(format_args!(
            "PRODUCT({title},{title},{description},(#{context}))"
        ));
        self.add(format_args!(
            "PRODUCT_RELATED_PRODUCT_CATEGORY('part',$,(#{product}))"
        ));
        let formation = self.add(format_args!(
            "PRODUCT_DEFINITION_FORMATION('','',#{product})"
        ));
        let design = self.add(format_args!(
            "PRODUCT_DEFINITION_CONTEXT('part definition',#{application},'design')"
        ));
        let definition = self.add(format_args!(
            "PRODUCT_DEFINITION('design','',#{formation},#{design})"
        ));
        self.add(format_args!(
            "PRODUCT_DEFINITION_SHAPE('','',#{definition})"
        ))
    }

    /// Units, and the distance within which places are one.
    pub fn context(&mut self, units: LengthUnit, uncertainty: f64) -> usize {
        let length = self.length_unit(units);
        let angle = self.add(format_args!(
            "(NAMED_UNIT(*)PLANE_ANGLE_UNIT()SI_UNIT($,.RADIAN.))"
        ));
        let solid = self.add(format_args!(
            "(NAMED_UNIT(*)SI_UNIT($,.STERADIAN.)SOLID_ANGLE_UNIT())"
        ));
        let uncertainty = self.add(format_args!(
            "UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{length},'distance_accuracy_value','')",
            real(uncertainty)
        ));
        self.add(format_args!(
            "(GEOMETRIC_REPRESENTATION_CONTEXT(3)GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT((#{uncertainty}))\
             GLOBAL_UNIT_ASSIGNED_CONTEXT((#{length},#{angle},#{solid}))REPRESENTATION_CONTEXT('',''))"
        ))
    }

    fn length_unit(&mut self, units: LengthUnit) -> usize {
        let (si, foreign) = match units {
            LengthUnit::Millimetre => (".MILLI.", None),
            LengthUnit::Centimetre => (".CENTI.", None),
            LengthUnit::Metre => ("$", None),
            LengthUnit::Inch => ("$", Some("INCH")),
            LengthUnit::Foot => ("$", Some("FOOT")),
        };
        let base = self.add(format_args!(
            "(LENGTH_UNIT()NAMED_UNIT(*)SI_UNIT({si},.METRE.))"
        ));
        let Some(name) = foreign else { return base };
        let size = self.add(format_args!("DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)"));
        let factor = self.add(format_args!(
            "LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE({}),#{base})",
            real(units.metres())
        ));
        self.add(format_args!(
            "(CONVERSION_BASED_UNIT('{name}',#{factor})LENGTH_UNIT()NAMED_UNIT(#{size}))"
        ))
    }

    /// The axes of the model.
    pub fn axes(&mut self) -> usize {
        let origin = self.point(&Point3::origin());
        let z = self.add(format_args!("DIRECTION('',(0.,0.,1.))"));
        let x = self.add(format_args!("DIRECTION('',(1.,0.,0.))"));
        self.add(format_args!("AXIS2_PLACEMENT_3D('',#{origin},#{z},#{x})"))
    }

    /// A point.
    pub fn point(&mut self, p: &Point3<f64>) -> usize {
        self.add(format_args!(
            "CARTESIAN_POINT('',{})",
            reals(p.coords.as_slice())
        ))
    }

    fn points(&mut self, points: &[Point3<f64>]) -> Vec<String> {
        points
            .iter()
            .map(|p| format!("#{}", self.point(p)))
            .collect()
    }

    /// A B-spline curve.
    pub fn curve(&mut self, name: &str, curve: &BSplineCurve) -> usize {
        let poles = bracketed(self.points(curve.control_points()).into_iter());
        let closed = truth(curve.start() == curve.end());
        let shape = format!("{},{poles},.UNSPECIFIED.,{closed},.U.", curve.degree());
        let (counts, values) = knots(curve.knot_vector());
        let name = string(name);
        match curve.weights() {
            None => self.add(format_args!(
                "B_SPLINE_CURVE_WITH_KNOTS({name},{shape},{counts},{values},.UNSPECIFIED.)"
            )),
            Some(weights) => self.add(format_args!(
                "(BOUNDED_CURVE()B_SPLINE_CURVE({shape})\
                 B_SPLINE_CURVE_WITH_KNOTS({counts},{values},.UNSPECIFIED.)CURVE()\
                 GEOMETRIC_REPRESENTATION_ITEM()RATIONAL_B_SPLINE_CURVE({})\
                 REPRESENTATION_ITEM({name}))",
                reals(weights)
            )),
        }
    }

    fn surface(&mut self, name: &str, surface: &BSplineSurface) -> usize {
        let columns = surface.counts()[1];
        let poles = self.points(surface.control_points());
        let rows = bracketed(poles.chunks(columns).map(|row| bracketed(row.iter())));
        let [p, q] = surface.degrees();
        let shape = format!("{p},{q},{rows},.UNSPECIFIED.,.U.,.U.,.U.");
        let [(u_counts, u_values), (v_counts, v_values)] =
            [Axis::U, Axis::V].map(|axis| knots(&surface.knot_vector(axis)));
        let knots = format!("{u_counts},{v_counts},{u_values},{v_values},.UNSPECIFIED.");
        let name = string(name);
        match surface.weights() {
            None => self.add(format_args!(
                "B_SPLINE_SURFACE_WITH_KNOTS({name},{shape},{knots})"
            )),
            Some(weights) => self.add(format_args!(
                "(BOUNDED_SURFACE()B_SPLINE_SURFACE({shape})\
                 B_SPLINE_SURFACE_WITH_KNOTS({knots})GEOMETRIC_REPRESENTATION_ITEM()\
                 RATIONAL_B_SPLINE_SURFACE({})REPRESENTATION_ITEM({name})SURFACE())",
                bracketed(weights.chunks(columns).map(reals))
            )),
        }
    }

    /// All shells, as a list of references.
    pub fn shells(&mut self, sewn: &Sewn) -> String {
        let vertices: Vec<usize> = (sewn.vertices.iter())
            .map(|p| {
                let point = self.point(p);
                self.add(format_args!("VERTEX_POINT('',#{point})"))
            })
            .collect();
        let surfaces: Vec<usize> = (sewn.faces.iter())
            .map(|f| self.surface(&f.name, &f.surface))
            .collect();
        let mut grounds = vec![None; sewn.edges.len()];
        for (face, surface) in sewn.faces.iter().zip(&surfaces) {
            for user in &face.bound {
                // An edge between two faces is told in space alone.
                grounds[user.edge] = match grounds[user.edge] {
                    None => Some(Some(*surface)),
                    Some(_) => Some(None),
                };
            }
        }
        let edges: Vec<usize> = (sewn.edges.iter().zip(grounds))
            .map(|(e, ground)| self.edge(e, &vertices, ground.flatten()))
            .collect();
        let faces: Vec<usize> = (sewn.faces.iter().zip(surfaces))
            .map(|(f, surface)| self.face(f, surface, &edges))
            .collect();
        let shells: Vec<String> = (sewn.shells.iter())
            .map(|shell| {
                let list = bracketed(shell.iter().map(|i| format!("#{}", faces[*i])));
                format!("#{}", self.add(format_args!("OPEN_SHELL('',{list})")))
            })
            .collect();
        bracketed(shells.into_iter())
    }

    fn edge(&mut self, edge: &Edge, vertices: &[usize], ground: Option<usize>) -> usize {
        let mut curve = self.curve("", &edge.curve);
        if let (Some(under), Some(ground)) = (&edge.under, ground) {
            let under = self.curve_in_parameters(under, ground);
            curve = self.add(format_args!(
                "SURFACE_CURVE('',#{curve},(#{under}),.CURVE_3D.)"
            ));
        }
        let [start, end] = edge.ends.map(|i| vertices[i]);
        self.add(format_args!("EDGE_CURVE('',#{start},#{end},#{curve},.T.)"))
    }

    /// A polynomial curve in the parameters of a surface.
    fn curve_in_parameters(&mut self, curve: &BSplineCurve, surface: usize) -> usize {
        let context = match self.parameters {
            Some(context) => context,
            None => self.add(format_args!(
                "(GEOMETRIC_REPRESENTATION_CONTEXT(2)PARAMETRIC_REPRESENTATION_CONTEXT()\
                 REPRESENTATION_CONTEXT('parameters',''))"
            )),
        };
        self.parameters = Some(context);
        let poles: Vec<usize> = (curve.control_points().iter())
            .map(|p| self.add(format_args!("CARTESIAN_POINT('',{})", reals(&[p.x, p.y]))))
            .collect();
        let poles = bracketed(poles.iter().map(|id| format!("#{id}")));
        let (counts, values) = knots(curve.knot_vector());
        let id = self.add(format_args!(
            "B_SPLINE_CURVE_WITH_KNOTS('',{},{poles},.UNSPECIFIED.,.F.,.U.,{counts},{values},.UNSPECIFIED.)",
            curve.degree()
        ));
        let definition = self.add(format_args!(
            "DEFINITIONAL_REPRESENTATION('',(#{id}),#{context})"
        ));
        self.add(format_args!("PCURVE('',#{surface},#{definition})"))
    }

    fn face(&mut self, face: &Face, surface: usize, edges: &[usize]) -> usize {
        let uses: Vec<String> = (face.bound.iter())
            .map(|user| {
                let id = self.add(format_args!(
                    "ORIENTED_EDGE('',*,*,#{},{})",
                    edges[user.edge],
                    truth(user.forward)
                ));
                format!("#{id}")
            })
            .collect();
        let bound = self.add(format_args!(
            "EDGE_LOOP('',{})",
            bracketed(uses.into_iter())
        ));
        let bound = self.add(format_args!("FACE_OUTER_BOUND('',#{bound},.T.)"));
        self.add(format_args!(
            "ADVANCED_FACE({},(#{bound}),#{surface},{})",
            string(&face.name),
            truth(face.same_sense)
        ))
    }
}

/// Multiplicities and values.
fn knots(knots: &Knots) -> (String, String) {
    let distinct = knots.distinct();
    (
        bracketed(distinct.iter().map(|(_, count)| count)),
        bracketed(distinct.iter().map(|(u, _)| real(*u))),
    )
}

fn truth(yes: bool) -> &'static str {
    if yes { ".T." } else { ".F." }
}
