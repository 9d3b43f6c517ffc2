//! Student's t, which judges a residual by a σ that is itself an estimate: of
//! few points, or of noise with longer tails than the normal distribution's.

/// P(|t| ≥ size) with `freedom` degrees of freedom: t as a normal deviate
/// (Wallace 1959), and the bound of Abramowitz & Stegun 7.1.13 for the normal
/// tail, sharp at both ends. Within 8 % for nine degrees of freedom and more,
/// too large for fewer.
pub(super) fn two_sided(size: f64, freedom: f64) -> f64 {
    let z = (8.0 * freedom + 1.0) / (8.0 * freedom + 3.0)
        * (freedom * (size * size / freedom).ln_1p()).sqrt();
    let x = z / std::f64::consts::SQRT_2;
    let pi = std::f64::consts::PI;
    2.0 / pi.sqrt() * (-x * x).exp() / (x + (x * x + 4.0 / pi).sqrt())
}

/// Degrees of freedom of the t whose 90th percentile of |t| is `ratio` times
/// its median; infinite for the normal distribution's 2.44 and less.
pub(super) fn freedom_of_tails(ratio: f64) -> f64 {
    /// Median and 90th percentile of |t| with 1, 2, … degrees of freedom.
    const RATIOS: [(f64, f64); 9] = [
        (1.0, 6.314),
        (2.0, 3.576),
        (3.0, 3.077),
        (4.0, 2.878),
        (5.0, 2.773),
        (7.0, 2.665),
        (10.0, 2.591),
        (20.0, 2.511),
        (50.0, 2.467),
    ];
    if ratio <= RATIOS[RATIOS.len() - 1].1 {
        return f64::INFINITY;
    }
    let above = RATIOS.iter().rposition(|(_, r)| *r >= ratio);
    above.map_or(1.0, |k| {
        let [(a, high), (b, low)] = [RATIOS[k], RATIOS[k + 1]];
        // Nearly linear in 1/ν.
        let t = (ratio - low) / (high - low);
        1.0 / (t / a + (1.0 - t) / b)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Tables: t₉(3.250) two-sided 0.01, t₃₀(2.042) 0.05; normal 1.96 0.05,
    /// 5 5.73e-7.
    #[test]
    fn tails_agree_with_tables() {
        for (t, freedom, want) in [
            (3.250, 9.0, 0.01),
            (2.042, 30.0, 0.05),
            (1.96, f64::from(1u32 << 30), 0.05),
            (5.0, f64::from(1u32 << 30), 5.733e-7),
        ] {
            let got = two_sided(t, freedom);
            assert!((got / want - 1.0).abs() < 0.08, "{got} for {want}");
        }
        // Cauchy: P(|t| ≥ 100) = 0.006366.
        let cauchy = two_sided(100.0, 1.0);
        assert!((0.006..0.03).contains(&cauchy), "{cauchy}");
    }

    #[test]
    fn long_tails_are_told_by_their_percentiles() {
        assert_eq!(freedom_of_tails(2.4387), f64::INFINITY);
        assert!((freedom_of_tails(2.773) - 5.0).abs() < 1e-9);
        // |t₆|: median 0.7176, 90th percentile 1.9432.
        assert!((freedom_of_tails(1.9432 / 0.7176) - 6.0).abs() < 0.3);
        assert_eq!(freedom_of_tails(1e9), 1.0);
    }
}
