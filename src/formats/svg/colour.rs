//! Twist as colour: lightness falls evenly from pale green (none) to dark blue
//! (the limit), and what lies above the limit is red.
//!
//! The ramp is a straight line in OKLCH, so equal steps of twist look equally
//! far apart, also to most colour-blind eyes, and a black-and-white print still
//! reads: darker is more. Source: B. Ottosson, "A perceptual color space for
//! image processing" (2020).

/// Lightness, chroma and hue (degrees) at no twist.
const NO_TWIST: [f64; 3] = [0.84, 0.09, 168.0];
/// The same at the limit.
const AT_LIMIT: [f64; 3] = [0.32, 0.14, 270.0];
/// Twist above the limit.
pub(super) const ABOVE_LIMIT: &str = "#d0021b";

/// The same as bytes.
pub(in crate::formats) const ABOVE_LIMIT_RGB: [u8; 3] = [0xd0, 0x02, 0x1b];

/// Colour of a share of the limit in linear sRGB; `None` above the limit and
/// for what is not a number.
pub(in crate::formats) fn linear_of_share(share: f64) -> Option<[f64; 3]> {
    (share <= 1.0).then(|| linear_srgb(ramp(share.max(0.0))))
}

/// Colour of a twist that is `share` of the limit (0 none, 1 the limit), as
/// `#rrggbb`. Shares above 1 and what is not a number get the warning colour.
pub(super) fn of_share(share: f64) -> String {
    let Some(linear) = linear_of_share(share) else {
        return ABOVE_LIMIT.to_owned();
    };
    let [r, g, b] = linear.map(encode);
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// A place on the ramp in OKLab.
fn ramp(share: f64) -> [f64; 3] {
    let [l, c, h] = [0, 1, 2].map(|i| NO_TWIST[i] + share * (AT_LIMIT[i] - NO_TWIST[i]));
    let (sin, cos) = h.to_radians().sin_cos();
    [l, c * cos, c * sin]
}

/// OKLab to linear sRGB; outside 0 to 1 where no screen can show the colour.
fn linear_srgb([lightness, a, b]: [f64; 3]) -> [f64; 3] {
    let l = (lightness + 0.396_337_777_4 * a + 0.215_803_757_3 * b).powi(3);
    let m = (lightness - 0.105_561_345_8 * a - 0.063_854_172_8 * b).powi(3);
    let s = (lightness - 0.089_484_177_5 * a - 1.291_485_548_0 * b).powi(3);
    [
        4.076_741_662_1 * l - 3.307_711_591_3 * m + 0.230_969_929_2 * s,
        -1.268_438_004_6 * l + 2.609_757_401_1 * m - 0.341_319_396_5 * s,
        -0.004_196_086_3 * l - 0.703_418_614_7 * m + 1.707_614_701_0 * s,
    ]
}

/// The transfer function of sRGB (IEC 61966-2-1), to 8 bits.
pub(in crate::formats) fn encode(linear: f64) -> u8 {
    let linear = linear.clamp(0.0, 1.0);
    let encoded = if linear <= 0.003_130_8 {
        12.92 * linear
    } else {
        1.055 * linear.powf(1.0 / 2.4) - 0.055
    };
    (encoded * 255.0).round() as u8
}

/// Its inverse.
pub(in crate::formats) fn decode(encoded: u8) -> f64 {
    let encoded = f64::from(encoded) / 255.0;
    if encoded <= 0.040_45 {
        encoded / 12.92
    } else {
        ((encoded + 0.055) / 1.055).powf(2.4)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn encoding_and_decoding_undo_each_other() {
        for byte in 0..=255 {
            assert_eq!(encode(decode(byte)), byte);
        }
        assert_eq!(ABOVE_LIMIT, {
            let [r, g, b] = ABOVE_LIMIT_RGB;
            format!("#{r:02x}{g:02x}{b:02x}")
        });
    }

    fn luminance(colour: &str) -> f64 {
        let channel = |at: usize| f64::from(u8::from_str_radix(&colour[at..at + 2], 16).unwrap());
        0.2126 * channel(1) + 0.7152 * channel(3) + 0.0722 * channel(5)
    }

    #[test]
    fn more_twist_is_darker() {
        let ramp: Vec<f64> = (0..=10)
            .map(|i| luminance(&of_share(f64::from(i) / 10.0)))
            .collect();
        assert!(ramp.windows(2).all(|w| w[1] < w[0]), "{ramp:?}");
    }

    #[test]
    fn above_the_limit_and_nonsense_warn() {
        assert_eq!(of_share(1.0 + 1e-12), ABOVE_LIMIT);
        assert_eq!(of_share(f64::NAN), ABOVE_LIMIT);
        assert_ne!(of_share(1.0), ABOVE_LIMIT);
    }

    #[test]
    fn the_ramp_stays_where_screens_can_follow() {
        for i in 0..=100 {
            let linear = linear_srgb(ramp(f64::from(i) / 100.0));
            assert!(
                linear.iter().all(|c| (-0.02..=1.0).contains(c)),
                "{i} %: {linear:?}"
            );
        }
    }

    #[test]
    fn known_colours_come_out() {
        assert_eq!(linear_srgb([1.0, 0.0, 0.0]).map(encode), [255, 255, 255]);
        // Ottosson's table: sRGB red.
        assert_eq!(
            linear_srgb([0.627_955, 0.224_863, 0.125_846]).map(encode),
            [255, 0, 0]
        );
    }
}
