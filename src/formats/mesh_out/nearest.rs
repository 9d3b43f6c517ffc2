//! Numbers known at scattered places, carried to other places.

use nalgebra::Point3;

/// Neighbours that a place takes its number from.
const NEIGHBOURS: usize = 4;

/// Places with numbers, as a tree: the middle of a range splits it along x, y
/// and z in turn.
pub(super) struct Scattered {
    places: Vec<(Point3<f64>, f64)>,
}

impl Scattered {
    /// Those with finite coordinates and numbers.
    pub fn new(known: &[(Point3<f64>, f64)]) -> Self {
        let finite =
            |(p, v): &&(Point3<f64>, f64)| v.is_finite() && p.iter().all(|c: &f64| c.is_finite());
        let mut places: Vec<_> = known.iter().filter(finite).copied().collect();
        arrange(&mut places, 0);
        Scattered { places }
    }

    /// The mean of the nearest numbers, weighted by one over the distance
    /// squared (Shepard 1968): at a known place its own number.
    pub fn at(&self, place: &Point3<f64>) -> Option<f64> {
        let mut nearest = Vec::with_capacity(NEIGHBOURS + 1);
        search(&self.places, 0, place, &mut nearest);
        let (mut sum, mut weights) = (0.0, 0.0);
        for (squared, value) in &nearest {
            if *squared == 0.0 {
                return Some(*value);
            }
            sum += value / squared;
            weights += 1.0 / squared;
        }
        (weights > 0.0).then(|| sum / weights)
    }
}

/// Sorts a range so that its middle splits it along the axis of its depth.
fn arrange(places: &mut [(Point3<f64>, f64)], depth: usize) {
    if places.len() < 2 {
        return;
    }
    let middle = places.len() / 2;
    places.select_nth_unstable_by(middle, |a, b| {
        let axes = (0..3).map(|k| (depth + k) % 3);
        // All coordinates and the number, so that equal ones lie in one order.
        axes.map(|k| a.0[k].total_cmp(&b.0[k]))
            .find(|order| order.is_ne())
            .unwrap_or_else(|| a.1.total_cmp(&b.1))
    });
    let (low, high) = places.split_at_mut(middle);
    arrange(low, depth + 1);
    arrange(&mut high[1..], depth + 1);
}

/// Puts the nearest of a range among those found, nearest first.
fn search(
    places: &[(Point3<f64>, f64)],
    depth: usize,
    place: &Point3<f64>,
    nearest: &mut Vec<(f64, f64)>,
) {
    let middle = places.len() / 2;
    let Some((here, value)) = places.get(middle) else {
        return;
    };
    let squared = (here - place).norm_squared();
    let at = nearest.partition_point(|(known, _)| *known <= squared);
    nearest.insert(at, (squared, *value));
    nearest.truncate(NEIGHBOURS);
    let ahead = place[depth % 3] - here[depth % 3];
    let halves = [&places[..middle], &places[middle + 1..]];
    let [near, far] = if ahead < 0.0 { [0, 1] } else { [1, 0] };
    search(halves[near], depth + 1, place, nearest);
    let full = nearest.len() == NEIGHBOURS;
    if !full
        || nearest
            .last()
            .is_some_and(|(most, _)| ahead * ahead <= *most)
    {
        search(halves[far], depth + 1, place, nearest);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_finds_what_a_look_at_all_finds() {
        let place = |i: u32| {
            let x = |k: u32| f64::from((i * 7919 + k * 104_729) % 1009) / 1009.0;
            Point3::new(x(1), x(2) * 0.3, x(3))
        };
        let known: Vec<_> = (0..400).map(|i| (place(i), f64::from(i))).collect();
        let tree = Scattered::new(&known);
        for i in 1000..1100 {
            let query = place(i) + nalgebra::Vector3::new(1e-3, 2e-3, 0.0);
            let mut all: Vec<_> = (known.iter())
                .map(|(p, v)| ((p - query).norm_squared(), *v))
                .collect();
            all.sort_by(|a, b| a.0.total_cmp(&b.0));
            let nearest = &all[..NEIGHBOURS];
            let weights: f64 = nearest.iter().map(|(d, _)| 1.0 / d).sum();
            let expected = nearest.iter().map(|(d, v)| v / d).sum::<f64>() / weights;
            assert!((tree.at(&query).unwrap() - expected).abs() < 1e-9 * expected.abs().max(1.0));
        }
        assert_eq!(tree.at(&known[17].0), Some(17.0));
        assert_eq!(Scattered::new(&[]).at(&Point3::origin()), None);
    }
}
