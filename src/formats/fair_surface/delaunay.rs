//! Delaunay triangulation of points in the plane (Bowyer 1981, Watson 1981),
//! exact: coordinates are whole numbers below [`RANGE`], so that both
//! predicates are computed without rounding and no position of the points can
//! break it.

/// A point with whole coordinates in `0..=RANGE`.
pub(super) type Site = [i64; 2];

/// Largest coordinate: 2²². Differences to the surrounding triangle stay below
/// 2²⁸, the in-circle determinant below 2¹¹⁵.
pub(super) const RANGE: i64 = 1 << 22;
/// How far out the surrounding triangle reaches: so far that its corners do
/// not disturb the edges along the border.
const FAR: i64 = 1 << 26;
/// No neighbour.
const NONE: usize = usize::MAX;

/// A triangle: corners counter-clockwise, and the neighbour opposite each.
#[derive(Debug, Clone, Copy)]
struct Triangle {
    corners: [usize; 3],
    neighbours: [usize; 3],
    alive: bool,
}

/// A triangulation under construction. The first three sites are the corners
/// of the surrounding triangle.
pub(super) struct Delaunay {
    sites: Vec<Site>,
    triangles: Vec<Triangle>,
    /// Where the last site went in: the next one is mostly near.
    last: usize,
    /// Triangles that were given up, to be used again.
    free: Vec<usize>,
}

/// An edge of the hole that a new site opens: its ends, counter-clockwise as
/// seen from the site, and the triangle beyond.
struct Rim {
    from: usize,
    to: usize,
    beyond: usize,
}

impl Delaunay {
    pub fn new() -> Self {
        Delaunay {
            sites: vec![[-FAR, -FAR], [2 * FAR, -FAR], [-FAR, 2 * FAR]],
            triangles: vec![Triangle {
                corners: [0, 1, 2],
                neighbours: [NONE; 3],
                alive: true,
            }],
            last: 0,
            free: Vec::new(),
        }
    }

    /// Adds a site (moved into the range if need be) and returns its number;
    /// for a site that is already there, the number it has.
    pub fn insert(&mut self, site: Site) -> usize {
        let site = site.map(|c| c.clamp(0, RANGE));
        let start = self.locate(site);
        let corners = self.triangles[start].corners;
        if let Some(known) = corners.iter().find(|c| self.sites[**c] == site) {
            return known - 3;
        }
        let number = self.sites.len();
        self.sites.push(site);
        let rims = self.open(start, site);
        self.close(&rims, number);
        number - 3
    }

    /// The triangles between sites, by the sites' numbers.
    pub fn triangles(&self) -> Vec<[usize; 3]> {
        let inner = self.triangles.iter().filter(|t| t.alive);
        inner
            .filter(|t| t.corners.iter().all(|c| *c >= 3))
            .map(|t| t.corners.map(|c| c - 3))
            .collect()
    }

    /// The triangle that holds a site, inside or on its border.
    fn locate(&self, site: Site) -> usize {
        let mut at = self.last;
        // A walk in a Delaunay triangulation cannot turn in circles; the bound
        // only spares a proof.
        for _ in 0..self.triangles.len() + 1 {
            let t = &self.triangles[at];
            let beyond = (0..3).find(|i| {
                let [a, b] = [t.corners[(i + 1) % 3], t.corners[(i + 2) % 3]];
                turn(self.sites[a], self.sites[b], site) < 0
            });
            match beyond.map(|i| t.neighbours[i]) {
                Some(next) if next != NONE => at = next,
                _ => return at,
            }
        }
        at
    }

    /// Takes out all triangles whose circumcircle holds the site; returns the
    /// rim of the hole.
    fn open(&mut self, start: usize, site: Site) -> Vec<Rim> {
        let mut hole = vec![start];
        self.triangles[start].alive = false;
        let mut rims = Vec::new();
        let mut next = 0;
        while let Some(&index) = hole.get(next) {
            next += 1;
            let t = self.triangles[index];
            for i in 0..3 {
                let beyond = t.neighbours[i];
                let is_alive = beyond != NONE && self.triangles[beyond].alive;
                if is_alive && self.circle_holds(beyond, site) {
                    self.triangles[beyond].alive = false;
                    hole.push(beyond);
                } else if beyond == NONE || is_alive {
                    rims.push(Rim {
                        from: t.corners[(i + 1) % 3],
                        to: t.corners[(i + 2) % 3],
                        beyond,
                    });
                }
            }
        }
        self.free.extend(hole);
        rims
    }

    /// Fills the hole with triangles about the new site.
    fn close(&mut self, rims: &[Rim], number: usize) {
        let mut fresh: Vec<usize> = Vec::with_capacity(rims.len());
        for rim in rims {
            let triangle = Triangle {
                corners: [rim.from, rim.to, number],
                neighbours: [NONE, NONE, rim.beyond],
                alive: true,
            };
            let index = match self.free.pop() {
                Some(index) => {
                    self.triangles[index] = triangle;
                    index
                }
                None => {
                    self.triangles.push(triangle);
                    self.triangles.len() - 1
                }
            };
            fresh.push(index);
            self.last = index;
            if rim.beyond != NONE {
                let outer = &mut self.triangles[rim.beyond];
                let shared = |c: &usize| *c != rim.from && *c != rim.to;
                if let Some(i) = outer.corners.iter().position(shared) {
                    outer.neighbours[i] = index;
                }
            }
        }
        // The rim is one closed line: the triangle that begins where this one
        // ends is its neighbour.
        for (i, rim) in rims.iter().enumerate() {
            let follows = rims.iter().position(|r| r.from == rim.to);
            if let Some(j) = follows {
                self.triangles[fresh[i]].neighbours[0] = fresh[j];
                self.triangles[fresh[j]].neighbours[1] = fresh[i];
            }
        }
    }

    /// Whether a site lies strictly inside the circumcircle of a triangle.
    fn circle_holds(&self, triangle: usize, site: Site) -> bool {
        let [a, b, c] = self.triangles[triangle].corners.map(|i| {
            let [x, y] = self.sites[i];
            let [dx, dy] = [i128::from(x - site[0]), i128::from(y - site[1])];
            [dx, dy, dx * dx + dy * dy]
        });
        let minor = |p: [i128; 3], q: [i128; 3]| p[0] * q[1] - p[1] * q[0];
        a[2] * minor(b, c) + b[2] * minor(c, a) + c[2] * minor(a, b) > 0
    }
}

/// Twice the area of the triangle `a b c`: positive when it turns left.
pub(super) fn turn(a: Site, b: Site, c: Site) -> i128 {
    let [abx, aby] = [0, 1].map(|i| i128::from(b[i] - a[i]));
    let [acx, acy] = [0, 1].map(|i| i128::from(c[i] - a[i]));
    abx * acy - aby * acx
}

#[cfg(test)]
mod tests {
    use super::*;

    fn check(sites: &[Site]) {
        let mut delaunay = Delaunay::new();
        let numbers: Vec<usize> = sites.iter().map(|s| delaunay.insert(*s)).collect();
        for (index, number) in numbers.iter().enumerate() {
            assert_eq!(delaunay.sites[number + 3], sites[index]);
        }
        let alive: Vec<usize> = (0..delaunay.triangles.len())
            .filter(|i| delaunay.triangles[*i].alive)
            .collect();
        for &i in &alive {
            let t = delaunay.triangles[i];
            let [a, b, c] = t.corners.map(|k| delaunay.sites[k]);
            assert!(turn(a, b, c) > 0, "no area: {a:?} {b:?} {c:?}");
            for n in t.neighbours.iter().filter(|n| **n != NONE) {
                assert!(delaunay.triangles[*n].neighbours.contains(&i));
            }
            assert!(sites.iter().all(|s| !delaunay.circle_holds(i, *s)));
        }
        // Euler: 2 n + 1 triangles about n distinct sites inside one triangle.
        let distinct = delaunay.sites.len() - 3;
        assert_eq!(alive.len(), 2 * distinct + 1);
    }

    #[test]
    fn lattices_lines_circles_and_repeats() {
        let lattice = |i: i64| [i % 12 * 1000, i / 12 * 1000];
        check(&(0..144).map(lattice).collect::<Vec<_>>());
        check(&(0..50).map(|i| [i * 7, i * 7]).collect::<Vec<_>>());
        check(&[
            [0, 0],
            [RANGE, 0],
            [RANGE, RANGE],
            [0, RANGE],
            [0, 0],
            [5, 5],
            [5, 5],
        ]);
        let circle = |i: i32| {
            let (sin, cos) = (f64::from(i) * 0.1).sin_cos();
            [(1e6 + 1e6 * cos) as i64, (1e6 + 1e6 * sin) as i64]
        };
        check(&(0..60).map(circle).collect::<Vec<_>>());
    }

    #[test]
    fn scattered_sites() {
        // A multiplicative sequence: scattered, and the same in every run.
        let mut state = 12345_i64;
        let mut next = || {
            state = state * 48_271 % 2_147_483_647;
            state % (RANGE + 1)
        };
        check(&(0..400).map(|_| [next(), next()]).collect::<Vec<_>>());
    }
}
