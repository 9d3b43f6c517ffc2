//! The lines plan: profile, plan and body view to one scale, the rulings
//! coloured by twist, the limit marked in the legend, the verdict in words.
//!
//! A self-contained SVG 1.1 page, A4 wide: no script, no style sheet, no
//! reference to anything outside. x runs to the right, z up, y up in the plan
//! and to the right in the body view.
//!
//! Limits: rulings that would run together on paper are thinned out (never a
//! plate's worst); plates are drawn as wires, so in the body view fore and aft
//! body overlap.

mod canvas;
pub(super) mod colour;
pub(super) mod fair_curve;
pub(super) mod fair_surface;
mod key;
mod layout;
mod legend;
mod moves;
pub(super) mod offsets;
mod page;
mod panel;
pub(super) mod patterns;
mod sample;
mod text;
mod views;

use super::patterns::PatternSheet;
use super::plates::{HullDrawing, bounds};
use canvas::Canvas;
use layout::{MARGIN, PAGE_WIDTH};
use page::Words;

/// The lines plan, and below it the flat patterns of the plates.
#[must_use]
pub fn lines_plan(hull: &HullDrawing, flat: Option<&PatternSheet>) -> String {
    let mut canvas = Canvas::default();
    let words = Words {
        title: &hull.title,
        units: &hull.units,
        verdict: &hull.verdict,
        good: hull.plates.iter().all(|p| p.within_limits),
        summary: &hull.summary,
    };
    let mut y = page::heading(&mut canvas, &words);
    if let Some(corners) = bounds(hull) {
        let layout = layout::arrange(corners, y + 9.0);
        for view in &layout.views {
            views::draw(&mut canvas, hull, &layout, view);
        }
        let bottom = layout
            .views
            .iter()
            .map(layout::View::bottom)
            .fold(y, f64::max);
        y = legend::draw(&mut canvas, hull, bottom + 13.0, layout.views[0].scale);
    }
    if let Some(flat) = flat {
        y = patterns::all(&mut canvas, flat, PAGE_WIDTH - 2.0 * MARGIN, y + 12.0);
    }
    y = page::sentences(&mut canvas, &words, y + 7.0);
    canvas.finish([PAGE_WIDTH, page::height(y)], &hull.title)
}

#[cfg(test)]
mod tests {
    use super::super::plates::{PlateDrawing, ProfileLine, RulingLine};
    use super::*;
    use nalgebra::Point3;

    fn hull(twist_deg: f64) -> HullDrawing {
        let curves = [
            |x: f64| Point3::new(x, 3.0 - x * x / 60.0, 4.0),
            |x: f64| Point3::new(x, 2.0 - x * x / 70.0, 0.02 * x),
        ];
        let at = |i: i32| f64::from(i) / 4.0;
        let rulings = (0..=40).map(at).map(|x| RulingLine {
            u: x / 10.0,
            from: curves[0](x),
            to: curves[1](x),
            twist_deg: twist_deg * (x / 10.0),
            bend_radius_from: 1.0,
            bend_radius_to: 1.0,
        });
        let line = |k: usize| ProfileLine {
            name: format!("curve {k}"),
            points: (0..=40).map(at).map(curves[k]).collect(),
        };
        HullDrawing {
            title: "A <hull> & more".into(),
            units: "m".into(),
            twist_limit_deg: 6.0,
            plates: vec![PlateDrawing {
                name: "deck – keel".into(),
                rulings: rulings.collect(),
                rolls: Vec::new(),
                within_limits: twist_deg <= 6.0,
            }],
            profiles: vec![line(0), line(1)],
            verdict: "within_limits".into(),
            summary: vec!["One plate.".into()],
        }
    }

    #[test]
    fn the_page_shows_views_legend_and_words() {
        let page = lines_plan(&hull(5.0), None);
        for expected in [
            "Profile (x–z)",
            "Plan (x–y)",
            "Body (y–z)",
            "limit 6°",
            "A &lt;hull&gt; &amp; more",
            "within limits · lengths in m",
            "One plate.",
            "deck – keel",
            "viewBox=\"0 0 297 ",
        ] {
            assert!(page.contains(expected), "no {expected:?}");
        }
        assert!(!page.contains("<script") && !page.contains("href") && !page.contains("NaN"));
    }

    #[test]
    fn twist_above_the_limit_is_red_and_heavy() {
        let heavy = format!("stroke=\"{}\" stroke-width=\"0.38\"", colour::ABOVE_LIMIT);
        assert!(lines_plan(&hull(9.0), None).contains(&heavy));
        assert!(!lines_plan(&hull(5.0), None).contains(&heavy));
    }

    #[test]
    fn nothing_to_draw_is_still_a_page() {
        let mut empty = hull(1.0);
        empty.plates.clear();
        empty.profiles.clear();
        assert!(lines_plan(&empty, None).contains("One plate."));
        let mut broken = hull(f64::NAN);
        broken.plates[0].rulings[3].from.x = f64::INFINITY;
        broken.profiles[0].points[3].y = f64::NAN;
        let page = lines_plan(&broken, None);
        assert!(!page.contains("NaN") && !page.contains("inf"));
    }

    #[test]
    fn flat_patterns_stand_below_the_views() {
        let corner = |x: f64, y: f64| nalgebra::Point2::new(x, y);
        let pattern = super::super::patterns::Pattern {
            name: "deck, flat".into(),
            kind: "Flat patterns".into(),
            outline: vec![corner(0.0, 0.0), corner(10.0, 0.0), corner(10.0, 2.0)],
            rulings: vec![[corner(9.0, 0.0), corner(9.0, 1.8)]],
            twist_shares: vec![1.2],
            ..Default::default()
        };
        let sheet = PatternSheet {
            title: String::new(),
            unit_name: "m".into(),
            units: crate::formats::length_unit::LengthUnit::Metre,
            patterns: vec![pattern],
            none: "",
            verdict: String::new(),
            summary: Vec::new(),
        };
        let page = lines_plan(&hull(5.0), Some(&sheet));
        assert!(page.contains(">deck, flat<") && page.contains("flat patterns, 1 : 50<"));
        let above = format!("stroke=\"{}\" stroke-width=\"0.15\"", colour::ABOVE_LIMIT);
        assert!(page.contains(&above), "a ruling that twists too much");
        let tall = |page: &str| -> f64 {
            let height = page.split("height=\"").nth(1).unwrap();
            height.split("mm").next().unwrap().parse().unwrap()
        };
        assert!(tall(&page) > tall(&lines_plan(&hull(5.0), None)) + 40.0);
    }

    #[test]
    fn the_same_drawing_gives_the_same_bytes() {
        assert_eq!(lines_plan(&hull(5.0), None), lines_plan(&hull(5.0), None));
    }
}
