//! The figures of a result as a table for the terminal, read from the result
//! document as any client would read it.

use serde_json::Value;

/// The columns, with their headings.
const HEADINGS: [&str; 8] = [
    "plate",
    "max twist",
    "mean",
    "limit",
    "least possible",
    "boundary moved",
    "clearance",
    "fans",
];

/// One row a plate: largest and mean twist, the limit, the bounded discrete
/// optimum, how far the boundary was moved (of the model's longest side), the
/// distance of the edge of regression in ruling lengths, the share of the two
/// curves that fans sweep. What the document does not tell is a dash.
pub fn table(result: &Value) -> String {
    let limit = &result["method_specific"]["options"]["max_twist_deg"];
    let size = result["diagnostics"]["model_size"]
        .as_f64()
        .unwrap_or(f64::NAN);
    let profiles = &result["method_specific"]["profiles"];
    let plates = result["diagnostics"]["plates"]
        .as_array()
        .map_or(&[][..], Vec::as_slice);
    let mut rows = vec![HEADINGS.map(str::to_owned)];
    for (index, plate) in plates.iter().enumerate() {
        rows.push([
            plate["name"].as_str().unwrap_or("–").to_owned(),
            degrees(&plate["twist_max_deg"]),
            degrees(&plate["twist_mean_deg"]),
            degrees(limit),
            degrees(&plate["bottleneck_deg"]),
            moved(profiles, index, size),
            share(&plate["regression_clearance"]),
            fans(&plate["fan_percent"]),
        ]);
    }
    align(&rows)
}

fn degrees(value: &Value) -> String {
    value.as_f64().map_or("–".to_owned(), |d| {
        // Below a hundredth of a degree the leading digits are what matters.
        if d.abs() < 0.01 && d != 0.0 {
            format!("{d:.1e}°")
        } else {
            format!("{d:.2}°")
        }
    })
}

/// A distance in ruling lengths; null where there is no edge of regression.
fn share(value: &Value) -> String {
    match value {
        Value::Null => "∞".to_owned(),
        number => number
            .as_f64()
            .map_or("–".to_owned(), |n| format!("{n:.3}")),
    }
}

/// Largest move of the two profiles beside a plate, percent of the model size.
fn moved(profiles: &Value, plate: usize, size: f64) -> String {
    let of = |k: usize| profiles[k]["deviation"]["curve_max"].as_f64();
    match (of(plate), of(plate + 1)) {
        (Some(a), Some(b)) => {
            let percent = 100.0 * a.max(b) / size;
            // An exact boundary is met to 1e-6 of the model size.
            if percent < 1e-4 {
                "unchanged".to_owned()
            } else {
                format!("{percent:.4} %")
            }
        }
        _ => "–".to_owned(),
    }
}

fn fans(value: &Value) -> String {
    let of = |k: usize| {
        value[k]
            .as_f64()
            .map_or("–".to_owned(), |p| format!("{p:.1}"))
    };
    format!("{} / {} %", of(0), of(1))
}

/// Columns under one another: words to the left, figures to the right.
fn align(rows: &[[String; 8]]) -> String {
    let width = |column: usize| {
        rows.iter()
            .map(|r| r[column].chars().count())
            .max()
            .unwrap_or(0)
    };
    let widths: [usize; 8] = std::array::from_fn(width);
    let line = |row: &[String; 8]| {
        let mut text = format!("{:<1$}", row[0], widths[0]);
        for (cell, width) in row.iter().zip(widths).skip(1) {
            text += &format!("  {cell:>width$}");
        }
        text + "\n"
    };
    rows.iter().map(line).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_plate_has_its_row() {
        let result = json!({
            "method_specific": {
                "options": {"max_twist_deg": 6.0},
                "profiles": [
                    {"deviation": {"curve_max": 1e-9}},
                    {"deviation": {"curve_max": 2e-9}},
                    {"deviation": {"curve_max": 0.035}},
                ],
            },
            "diagnostics": {
                "model_size": 70.0,
                "plates": [
                    {"name": "deck – chine", "twist_max_deg": 2.688, "twist_mean_deg": 0.004,
                     "bottleneck_deg": 2.69, "regression_clearance": null, "fan_percent": [0, 20]},
                    {"name": "chine – keel", "twist_max_deg": 5.28, "twist_mean_deg": 0.9,
                     "bottleneck_deg": 5.3, "regression_clearance": 0.143, "fan_percent": [3.06, 0]},
                ],
            },
        });
        let table = table(&result);
        let rows: Vec<&str> = table.lines().collect();
        assert_eq!(rows.len(), 3);
        for word in [
            "deck – chine",
            "2.69°",
            "4.0e-3°",
            "6.00°",
            "unchanged",
            "∞",
            "0.0 / 20.0 %",
        ] {
            assert!(rows[1].contains(word), "{word} in {:?}", rows[1]);
        }
        for word in ["0.0500 %", "0.143", "3.1 / 0.0 %"] {
            assert!(rows[2].contains(word), "{word} in {:?}", rows[2]);
        }
        let widths: Vec<usize> = rows.iter().map(|r| r.chars().count()).collect();
        assert!(widths.iter().all(|w| *w == widths[0]), "{table}");
    }

    #[test]
    fn an_empty_document_is_an_empty_table() {
        assert_eq!(table(&Value::Null).lines().count(), 1);
    }
}
