use super::*;

/// A diagonally dominant test matrix in the given envelope.
fn sample(first: Vec<usize>) -> EnvelopeMatrix {
    let mut a = EnvelopeMatrix::new(first);
    let n = a.order();
    for i in 0..n {
        for j in a.first_column(i)..i {
            let v = ((i * 7 + j * 13) % 11) as f64 / 11.0 - 0.5;
            a.add(i, j, v);
            a.add_to_diagonal(i, v.abs());
            a.add_to_diagonal(j, v.abs());
        }
        a.add_to_diagonal(i, 0.1);
    }
    a
}

fn check(first: Vec<usize>) {
    let a = sample(first);
    let x: Vec<f64> = (0..a.order())
        .map(|i| (i as f64 * 0.7).sin() + 0.2)
        .collect();
    let mut b = a.multiply(&x);
    a.factor().expect("dominant").solve_in_place(&mut b);
    for (i, (got, want)) in b.iter().zip(&x).enumerate() {
        assert!((got - want).abs() < 1e-11, "row {i}: {got} for {want}");
    }
}

#[test]
fn solves_band_arrow_and_ragged_matrices() {
    check((0..50).map(|i: usize| i.saturating_sub(5)).collect());
    check((0..200).map(|i: usize| i.saturating_sub(23)).collect());
    check((0..40).map(|i| if i >= 38 { 0 } else { i }).collect());
    check(
        (0..60)
            .map(|i: usize| i.saturating_sub(i * 7 % 13))
            .collect(),
    );
    check(vec![0]);
    check(vec![]);
}

#[test]
fn an_indefinite_matrix_is_refused_with_its_row() {
    let mut a = EnvelopeMatrix::banded(3, 1);
    a.add(0, 0, 1.0);
    a.add(1, 1, 1.0);
    a.add(1, 0, 2.0);
    a.add(2, 2, 1.0);
    assert_eq!(
        a.factor(),
        Err(NotPositiveDefinite {
            row: 1,
            pivot: -3.0
        })
    );
    let mut nan = EnvelopeMatrix::banded(1, 0);
    nan.add(0, 0, f64::NAN);
    assert_eq!(nan.factor().map_err(|e| e.row), Err(0));
}

#[test]
fn outer_products_equal_single_additions() {
    let mut a = EnvelopeMatrix::banded(6, 3);
    let mut b = a.clone();
    let row = [1.0, -2.0, 0.5];
    a.add_outer(2, &row, 3.0);
    for i in 0..3 {
        for j in 0..=i {
            b.add(2 + i, 2 + j, 3.0 * row[i] * row[j]);
        }
    }
    assert_eq!(a, b);
    assert_eq!(a.get(2, 4), a.get(4, 2));
    assert_eq!(a.get(5, 0), 0.0);
    assert_eq!(
        a.diagonal().collect::<Vec<_>>(),
        [0.0, 0.0, 3.0, 12.0, 0.75, 0.0]
    );
}

#[test]
fn memory_is_reused_without_a_change_of_result() {
    let a = sample((0..30).map(|i: usize| i.saturating_sub(4)).collect());
    let b = sample((0..30).map(|i: usize| i.saturating_sub(i % 3)).collect());
    let mut f = a.factor().expect("dominant");
    b.factor_into(&mut f).expect("dominant");
    assert_eq!(f, b.factor().expect("dominant"));
}
