//! Minimum spanning trees of points and the longest path in them.

use super::space::Vector;

/// A spanning tree.
#[derive(Debug, Clone)]
pub(super) struct Tree {
    /// Neighbours of each node with the lengths of the edges.
    neighbours: Vec<Vec<(usize, f64)>>,
}

impl Tree {
    /// The minimum spanning tree by Prim's algorithm, O(n²).
    pub(super) fn spanning<const D: usize>(points: &[Vector<D>]) -> Self {
        let n = points.len();
        let mut neighbours = vec![Vec::new(); n];
        let mut nearest = vec![(f64::INFINITY, 0_usize); n];
        let mut outside: Vec<usize> = (1..n).collect();
        let mut last = 0;
        while !outside.is_empty() {
            let mut best = (f64::INFINITY, 0);
            for (slot, k) in outside.iter().enumerate() {
                let distance = (points[*k] - points[last]).norm_squared();
                if distance < nearest[*k].0 {
                    nearest[*k] = (distance, last);
                }
                if nearest[*k].0 < best.0 {
                    best = (nearest[*k].0, slot);
                }
            }
            let k = outside.swap_remove(best.1);
            let (distance, from) = nearest[k];
            let length = distance.sqrt();
            neighbours[k].push((from, length));
            neighbours[from].push((k, length));
            last = k;
        }
        Tree { neighbours }
    }

    /// Every edge once: its nodes and length.
    pub(super) fn edges(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        let of = |(a, list): (usize, &Vec<(usize, f64)>)| {
            let list = list.clone();
            list.into_iter()
                .filter(move |(b, _)| a < *b)
                .map(move |(b, l)| (a, b, l))
        };
        self.neighbours.iter().enumerate().flat_map(of)
    }

    /// The tree without its edges longer than `most`: the nodes of each part.
    pub(super) fn parts(&self, most: f64) -> Vec<Vec<usize>> {
        let mut seen = vec![false; self.neighbours.len()];
        let mut parts = Vec::new();
        for start in 0..seen.len() {
            if seen[start] {
                continue;
            }
            let mut part = vec![start];
            seen[start] = true;
            let mut next = 0;
            while next < part.len() {
                for (b, length) in &self.neighbours[part[next]] {
                    if !seen[*b] && *length <= most {
                        seen[*b] = true;
                        part.push(*b);
                    }
                }
                next += 1;
            }
            parts.push(part);
        }
        parts
    }

    /// The nodes of the longest path, from end to end.
    pub(super) fn longest_path(&self) -> Vec<usize> {
        let (far, ..) = self.walk(0);
        let (end, before) = self.walk(far);
        let mut path = vec![end];
        let mut at = end;
        while let Some(k) = before[at] {
            path.push(k);
            at = k;
        }
        path
    }

    /// The node farthest from `start`, and for each node the one before it.
    fn walk(&self, start: usize) -> (usize, Vec<Option<usize>>) {
        let n = self.neighbours.len();
        let mut before = vec![None; n];
        let mut distance = vec![f64::INFINITY; n];
        distance[start] = 0.0;
        let mut stack = vec![start];
        let mut far = (0.0, start);
        while let Some(a) = stack.pop() {
            if distance[a] > far.0 {
                far = (distance[a], a);
            }
            for (b, length) in &self.neighbours[a] {
                if distance[*b].is_infinite() {
                    distance[*b] = distance[a] + length;
                    before[*b] = Some(a);
                    stack.push(*b);
                }
            }
        }
        (far.1, before)
    }

    /// For each node its nearest node on `path` along the tree, as a position
    /// in the path, and how far along the tree that is.
    pub(super) fn hang_on(&self, path: &[usize]) -> Vec<(usize, f64)> {
        let mut at = vec![(usize::MAX, 0.0); self.neighbours.len()];
        for (k, node) in path.iter().enumerate() {
            at[*node] = (k, 0.0);
        }
        let mut queue: Vec<usize> = path.to_vec();
        let mut next = 0;
        while next < queue.len() {
            let a = queue[next];
            next += 1;
            for (b, length) in &self.neighbours[a] {
                if at[*b].0 == usize::MAX {
                    at[*b] = (at[a].0, at[a].1 + length);
                    queue.push(*b);
                }
            }
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_path_of_a_comb_is_its_back_with_the_end_teeth() {
        // Back (0..=9, 0), a tooth of length 2 at x = 4.
        let mut points: Vec<Vector<2>> = (0..10).map(|k| Vector::<2>::new(k as f64, 0.0)).collect();
        points.push(Vector::<2>::new(4.0, 1.0));
        points.push(Vector::<2>::new(4.0, 2.0));
        let tree = Tree::spanning(&points);
        let path = tree.longest_path();
        assert_eq!(path.len(), 10);
        let hung = tree.hang_on(&path);
        assert!((hung[11].1 - 2.0).abs() < 1e-12);
        assert_eq!(tree.edges().count(), 11);
        assert_eq!(tree.parts(0.5).len(), 12);
        assert_eq!(tree.parts(1.5).len(), 1);
    }
}
